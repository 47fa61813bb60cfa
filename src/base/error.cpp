#include "base/error.hpp"

#include "base/text.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr std::size_t most_shown = 50;  // messages
constexpr int widest = 160;             // characters of a source line
constexpr int longest = 1000;           // of a message, which may quote what somebody wrote

/// The part of a source line that is shown, and the column in it that is meant.
struct Excerpt {
    std::string text;
    int column;
};

int whole(const std::string& text, int i) { return static_cast<int>(character_begin(text, i)); }

Excerpt excerpt(const std::string& line, int column) {
    if (static_cast<int>(line.size()) <= widest) return {line, column};
    const int size = static_cast<int>(line.size());
    const int begin = whole(line, std::clamp(column - 1 - widest / 2, 0, size - widest)), end = whole(line, std::min(begin + widest, size));
    const std::string before = begin > 0 ? "..." : "", after = end < size ? "..." : "";
    return {before + line.substr(begin, end - begin) + after, column - begin + static_cast<int>(before.size())};
}

/// Its begin and its end, where it is too long to be read.
std::string readable(const std::string& message) {
    const int size = static_cast<int>(message.size());
    if (size <= longest) return message;
    return message.substr(0, whole(message, longest / 2)) + " ... " + message.substr(whole(message, size - longest / 2));
}

}  // namespace

std::string format(const Diagnostic& d) {
    std::string text = d.severity == Diagnostic::Severity::error ? "error" : "warning";
    text += "[" + d.code + "]: " + readable(d.message) + "\n";
    const std::string number = d.line > 0 ? std::to_string(d.line) : "";
    const std::string margin(number.size() + 1, ' ');
    if (!d.file.empty()) {
        text += margin + "--> " + readable(d.file);
        if (d.line > 0) text += ":" + number + ":" + std::to_string(std::max(d.column, 1));
        text += "\n";
    }
    if (!d.source_line.empty()) {
        const auto [line, column] = excerpt(d.source_line, d.column);
        text += margin + " |\n" + number + " | " + line + "\n" + margin + "| ";
        text += std::string(std::max(column - 1, 0), ' ') + std::string(std::clamp(d.length, 1, widest), '^');
        if (!d.hint.empty()) text += " " + d.hint;
        text += "\n";
    } else if (!d.hint.empty()) {
        text += margin + "= help: " + d.hint + "\n";
    }
    if (!d.note.empty()) text += margin + "= " + d.note + "\n";
    return printable(text);
}

namespace {
std::string all(const std::vector<Diagnostic>& found) {
    std::string text;
    for (std::size_t i = 0; i < std::min(found.size(), most_shown); ++i) text += format(found[i]);
    if (found.size() > most_shown) text += "... and " + std::to_string(found.size() - most_shown) + " more\n";
    return text;
}
}  // namespace

UserError::UserError(std::vector<Diagnostic> found) : std::runtime_error(all(found)), diagnostics(std::move(found)) {}

UserError::UserError(const std::string& code, const std::string& message, const std::string& note)
    : UserError(std::vector<Diagnostic>{{.code = code, .message = message, .note = note}}) {}

}  // namespace knap
