#pragma once
// The source text of a scenario, and the errors and warnings about it.
#include "base/error.hpp"
#include "base/text.hpp"
#include "scenario/toml_tree.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

class Source {
public:
    Source() = default;
    Source(std::string name, std::string text);
    const std::string& name() const { return name_; }  // as the user wrote it, for messages
    const std::string& text() const { return text_; }  // verbatim

    /// Fills in file, line, column and length of a node, or the `--set` that the node comes from. The place is that of
    /// the node's name for errors about the name (unknown or excluded keys, names of tables), otherwise of its value.
    void set_place(Diagnostic& diagnostic, const Node& node) const;
    /// Adds the source line, and shortens the marks to its end.
    void quote(Diagnostic& diagnostic) const;

private:
    std::string name_, text_;
    std::vector<std::string> lines_;
};

/// A message at a line of a file that the scenario names; line 0: about all of it.
Diagnostic at_line(Diagnostic message, const std::filesystem::path& file, const std::string& bytes, int line);

class Findings {
public:
    explicit Findings(const Source& source) : source_(source) {}

    /// A message at the place of a node; without a place for Node{}. `note`: the allowed values or the cure; `hint`: a
    /// suggestion under the marks.
    void error(const std::string& code, const std::string& message, const Node& at, const std::string& note = {},
               const std::string& hint = {});
    void warning(const std::string& code, const std::string& message, const Node& at, const std::string& note = {},
                 const std::string& hint = {});
    void add(Diagnostic found) { found_.push_back(std::move(found)); }

    bool has_errors() const;
    /// In the order of the file, with source lines; findings without a line come last.
    std::vector<Diagnostic> sorted(Diagnostic::Severity severity) const;

private:
    const Source& source_;
    std::vector<Diagnostic> found_;
};

}  // namespace knap
