#include "base/terminal.hpp"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <string_view>

namespace knap {
namespace {

bool has_colour(std::FILE* file) {
    const char *const none = std::getenv("NO_COLOR"), *const terminal = std::getenv("TERM");
    return isatty(fileno(file)) && !(none && *none) && !(terminal && std::string_view(terminal) == "dumb");
}

/// A line of a message: its first word, the arrow before a place, or the marks below a source line.
std::string coloured(const std::string& line) {
    constexpr const char *red = "\033[1;31m", *yellow = "\033[1;33m", *cyan = "\033[1;36m", *end = "\033[0m";
    const auto first = [&](std::size_t n, const char* colour) {
        return colour + line.substr(0, n) + end + line.substr(n);
    };
    if (line.ends_with(" FAILED") || (line.starts_with("  gate ") && line.find(" VIOLATED") != line.npos))
        return red + line + end;
    const std::size_t word = line.find_first_of("]:");
    if (line.starts_with("error[")) return first(word + 1, red);
    if (line.starts_with("warning[")) return first(word + 1, yellow);
    if (line.starts_with("note:")) return first(word + 1, cyan);
    const std::size_t text = line.find_first_not_of(" |");
    if (text == std::string::npos) return line;
    if (line[text] == '^' || line.compare(text, 4, "--> ") == 0)
        return line.substr(0, text) + (line[text] == '^' ? red : cyan) + line.substr(text) + end;
    return line;
}

}  // namespace

void print_messages(const std::string& text, std::FILE* file) {
    if (!has_colour(file)) {
        std::fputs(text.c_str(), file);
        return;
    }
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        std::fprintf(file, "%s%s", coloured(line).c_str(), lines.eof() ? "" : "\n");
}

}  // namespace knap
