#include "base/error.hpp"

#include <algorithm>

namespace knap {

std::string format(const Diagnostic& d) {
    std::string text = d.severity == Diagnostic::Severity::error ? "error" : "warning";
    text += "[" + d.code + "]: " + d.message + "\n";
    const std::string number = d.line > 0 ? std::to_string(d.line) : "";
    const std::string margin(number.size() + 1, ' ');
    if (!d.file.empty()) {
        text += margin + "--> " + d.file;
        if (d.line > 0) text += ":" + number + ":" + std::to_string(std::max(d.column, 1));
        text += "\n";
    }
    if (!d.source_line.empty()) {
        text += margin + " |\n" + number + " | " + d.source_line + "\n" + margin + "| ";
        text += std::string(std::max(d.column - 1, 0), ' ') + std::string(std::max(d.length, 1), '^');
        if (!d.hint.empty()) text += " " + d.hint;
        text += "\n";
    } else if (!d.hint.empty()) {
        text += margin + "= help: " + d.hint + "\n";
    }
    if (!d.note.empty()) text += margin + "= " + d.note + "\n";
    return text;
}

namespace {
std::string all(const std::vector<Diagnostic>& found) {
    std::string text;
    for (const Diagnostic& d : found) text += format(d);
    return text;
}
}  // namespace

UserError::UserError(std::vector<Diagnostic> found) : std::runtime_error(all(found)), diagnostics(std::move(found)) {}

UserError::UserError(const std::string& code, const std::string& message, const std::string& note)
    : UserError(std::vector<Diagnostic>{{.code = code, .message = message, .note = note}}) {}

}  // namespace knap
