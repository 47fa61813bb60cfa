#include "scenario/findings.hpp"

#include <algorithm>
#include <tuple>

namespace knap {

namespace {
constexpr std::size_t max_quoted = 10'000'000;  // characters: a line of a megabyte may be wrong in 100 000 places
}

Source::Source(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
    std::string line;
    for (const char c : text_) {
        if (c == '\n') lines_.push_back(std::exchange(line, {}));
        else if (c != '\r') line += c == '\t' ? ' ' : c;  // a tab is one column wide, as the marks need
    }
    if (!line.empty()) lines_.push_back(std::move(line));
}

void Source::set_place(Diagnostic& d, const Node& node) const {
    d.file = node.set_by.empty() ? name_ : node.set_by;
    if (!node.set_by.empty()) return;
    const bool about_name = d.code == "unknown-key" || d.code == "exclusive-keys" ||
                            (node.type == Node::Type::table && d.code.ends_with("-name"));
    const Place& place = about_name && node.name_place.line > 0 ? node.name_place : node.place;
    std::tie(d.line, d.column, d.length) = std::tie(place.line, place.column, place.length);
}

void Source::quote(Diagnostic& d) const {
    if (d.file != name_ || d.line < 1 || d.line > static_cast<int>(lines_.size())) return;
    d.source_line = lines_[d.line - 1];
    const int to_the_end = static_cast<int>(n_characters(d.source_line)) - d.column + 1;
    d.length = std::max(1, std::min(d.length, to_the_end));
}

Diagnostic at_line(Diagnostic d, const std::filesystem::path& file, const std::string& bytes, int line) {
    std::istringstream in(bytes);
    std::string quoted;
    for (int i = 0; i < line && std::getline(in, quoted); ++i) {
    }
    if (quoted.ends_with('\r')) quoted.pop_back();
    d.file = file.string(), d.line = line, d.column = line > 0 ? 1 : 0;
    d.length = std::max(1, static_cast<int>(quoted.size()));
    d.source_line = quoted;
    return d;
}

void Findings::error(const std::string& code, const std::string& message, const Node& at, const std::string& note,
                     const std::string& hint) {
    found_.push_back({.code = code, .message = message, .hint = hint, .note = note});
    source_.set_place(found_.back(), at);
}

void Findings::warning(const std::string& code, const std::string& message, const Node& at, const std::string& note,
                       const std::string& hint) {
    error(code, message, at, note, hint);
    found_.back().severity = Diagnostic::Severity::warning;
}

bool Findings::has_errors() const {
    return std::ranges::count(found_, Diagnostic::Severity::error, &Diagnostic::severity) > 0;
}

std::vector<Diagnostic> Findings::sorted(Diagnostic::Severity severity) const {
    std::vector<Diagnostic> list;
    std::ranges::copy_if(found_, std::back_inserter(list), [&](const Diagnostic& d) { return d.severity == severity; });
    std::ranges::stable_sort(list, {}, [](const Diagnostic& d) { return std::tuple(d.line == 0, d.line, d.column); });
    std::size_t n_quoted = 0;  // characters
    for (auto d = list.begin(); d != list.end() && n_quoted < max_quoted; ++d) {
        source_.quote(*d);
        n_quoted += d->source_line.size();
    }
    return list;
}

}  // namespace knap
