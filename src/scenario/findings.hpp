#pragma once
// The source text of a scenario and everything that is found wrong with it.
#include "base/error.hpp"
#include "base/text.hpp"
#include "scenario/toml_tree.hpp"

#include <string>
#include <vector>

namespace knap {

class Source {
public:
    Source() = default;
    Source(std::string name, std::string text);
    const std::string& name() const { return name_; }  // as the user wrote it, for messages
    const std::string& text() const { return text_; }  // verbatim

    /// Fills in file, line, column and length of a node, or the `--set` that the node comes from.
    void point(Diagnostic& diagnostic, const Node& node) const { point(diagnostic, node, node.place); }
    void point_at_name(Diagnostic& diagnostic, const Node& node) const;
    /// Adds the source line, and ends the marks with it.
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
    /// In the order of the file, with source lines; findings without a line come last.
    std::vector<Diagnostic> sorted(Diagnostic::Severity severity) const;

private:
    const Source& source_;
    std::vector<Diagnostic> found_;
};

}  // namespace knap
