#include "base/error.hpp"

#include "base/text.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr int max_line = 160;      // characters shown of a source line
constexpr int max_message = 1000;  // of a message, which may quote the user's input

int whole(const std::string& text, int i) { return static_cast<int>(character_begin(text, i)); }

/// The part of the source line that is shown, and the column of the mistake in it.
std::pair<std::string, int> excerpt(const std::string& line, int column) {
    const int size = static_cast<int>(line.size());
    if (size <= max_line) return {line, column};
    const int first = whole(line, std::clamp(column - 1 - max_line / 2, 0, size - max_line)),
              end = whole(line, std::min(first + max_line, size));
    const std::string before = first > 0 ? "..." : "", after = end < size ? "..." : "";
    return {before + line.substr(first, end - first) + after, column - first + static_cast<int>(before.size())};
}

/// Without its middle where it is too long to be read.
std::string shortened(const std::string& message) {
    const int size = static_cast<int>(message.size()), half = max_message / 2;
    if (size <= max_message) return message;
    return message.substr(0, whole(message, half)) + " ... " + message.substr(whole(message, size - half));
}

/// The text of all mistakes; where mistakes of one kind follow each other, the allowed values stand once. Of many the
/// first ones have their source lines, the others a line each.
std::string all(const std::vector<Diagnostic>& found) {
    constexpr std::size_t max_shown = 50, max_listed = 5000;
    std::string text;
    for (std::size_t i = 0; i < std::min(found.size(), max_shown); ++i) {
        Diagnostic shown = found[i];
        if (i > 0 && shown.note == found[i - 1].note) shown.note.clear();
        text += format(shown);
    }
    if (found.size() > max_shown) text += concatenated("the other ", found.size() - max_shown, ", a line each:\n");
    for (std::size_t i = max_shown; i < std::min(found.size(), max_listed); ++i) {
        const std::string place = found[i].line > 0 ? concatenated(found[i].line, ": ") : "";
        text += printable(place + shortened(found[i].message) + "\n");
    }
    return text;
}

}  // namespace

std::string format(const Diagnostic& d) {
    const std::string number = d.line > 0 ? std::to_string(d.line) : "",
                      margin(number.size() + 1, ' ');  // left of the bars
    std::string text = concatenated(d.severity == Diagnostic::Severity::error ? "error" : "warning", "[", d.code,
                                    "]: ", shortened(d.message), "\n");
    if (!d.file.empty()) {
        text += margin.substr(1) + "--> " + shortened(d.file);
        if (d.line > 0) text += concatenated(":", number, ":", std::max(d.column, 1));
        text += "\n";
    }
    if (!d.source_line.empty()) {
        const auto [line, column] = excerpt(d.source_line, d.column);
        text += concatenated(
            margin, "|\n", number, " | ", line, "\n", margin, "| ", std::string(std::max(column - 1, 0), ' '),
            std::string(std::clamp(d.length, 1, max_line), '^'), d.hint.empty() ? "" : " ", d.hint, "\n");
    } else if (!d.hint.empty()) {
        text += margin + "= " + d.hint + "\n";
    }
    if (!d.note.empty()) text += margin + "= " + d.note + "\n";
    return printable(text);
}

UserError::UserError(std::vector<Diagnostic> found) : std::runtime_error(all(found)), diagnostics(std::move(found)) {}

UserError::UserError(const std::string& code, const std::string& message, const std::string& note)
    : UserError(std::vector<Diagnostic>{{.code = code, .message = message, .note = note}}) {}

}  // namespace knap
