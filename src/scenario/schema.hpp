#pragma once
// The key table as text.
#include <string>

namespace knap {

/// Every key of a scenario, for the terminal.
std::string schema_text();

/// As JSON Schema (draft 2020-12), for editors.
std::string json_schema();

/// As Markdown (scenarios/KEYS.md): for each block a heading with an anchor, an example and a table of its keys.
std::string schema_markdown();

}  // namespace knap
