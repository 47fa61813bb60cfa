#pragma once
// The source text of a scenario and all that is found wrong with it.
#include "base/error.hpp"
#include "base/text.hpp"
#include "scenario/node.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace knap {

class Source {
public:
    Source() = default;
    Source(std::string name, std::string text);
    const std::string& name() const { return name_; }  // as the user wrote it, for messages
    const std::string& text() const { return text_; }  // verbatim

    /// Fills in file, line, column and length, or the `--set` that the node came from.
    void point(Diagnostic& diagnostic, const Node& node) const;
    void point_at_name(Diagnostic& diagnostic, const Node& node) const;
    /// Adds the line that it points at, and ends the marks with it.
    void quote(Diagnostic& diagnostic) const;

private:
    void point(Diagnostic& diagnostic, const Node& node, const Place& place) const;
    std::string name_, text_;
    std::vector<std::string> lines_;
};

class Findings {
public:
    explicit Findings(const Source& source) : source_(source) {}

    /// The returned reference is for adding a hint or a note at once; the next call ends its life.
    Diagnostic& error(const std::string& code, const std::string& message, const Node& at);
    Diagnostic& error_at_name(const std::string& code, const std::string& message, const Node& at);
    Diagnostic& error(const std::string& code, const std::string& message);
    Diagnostic& warning(const std::string& code, const std::string& message, const Node& at);

    bool has_errors() const;
    /// In the order of the file, each with its line as far as all can be; what has no line comes last.
    std::vector<Diagnostic> sorted(Diagnostic::Severity severity) const;
    const Source& source() const { return source_; }

private:
    const Source& source_;
    std::vector<Diagnostic> found_;
};

}  // namespace knap
