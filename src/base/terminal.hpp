#pragma once
// Messages in colour where they are read on a terminal.
#include <cstdio>
#include <string>

namespace knap {

/// Writes messages as `format` makes them (base/error.hpp), on a terminal with the words `error`, `warning` and `note`,
/// places, marks, and lines of gates and expectations that failed in colour, unless the environment has NO_COLOR
/// (no-color.org) or TERM=dumb.
void print_messages(const std::string& text, std::FILE* file = stderr);

}  // namespace knap
