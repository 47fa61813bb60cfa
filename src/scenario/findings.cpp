#include "scenario/findings.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <tuple>

namespace knap {
namespace {

constexpr std::size_t most_quoted = 10'000'000;  // a line of a megabyte may be wrong in a hundred thousand places

int n_characters(std::string_view utf8) {
    return static_cast<int>(std::count_if(utf8.begin(), utf8.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Levenshtein distance in which a change of case costs nothing and a swap of neighbours costs one (optimal string alignment).
int edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = static_cast<int>(i);
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const int change = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

}  // namespace

Source::Source(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
    std::string line;
    for (const char c : text_) {
        if (c == '\n') {
            lines_.push_back(std::move(line));
            line.clear();
        } else if (c != '\r') {
            line += c == '\t' ? ' ' : c;  // one character wide, so that the marks stand right
        }
    }
    if (!line.empty()) lines_.push_back(std::move(line));
}

void Source::point(Diagnostic& d, const Node& node) const { point(d, node, node.place); }

void Source::point_at_name(Diagnostic& d, const Node& node) const { point(d, node, node.name_place.line > 0 ? node.name_place : node.place); }

void Source::point(Diagnostic& d, const Node& node, const Place& place) const {
    d.file = node.set_by.empty() ? name_ : node.set_by;
    if (!node.set_by.empty()) return;
    d.line = place.line;
    d.column = place.column;
    d.length = place.length;
}

void Source::quote(Diagnostic& d) const {
    if (d.file != name_ || d.line < 1 || d.line > static_cast<int>(lines_.size())) return;
    d.source_line = lines_[d.line - 1];
    const int to_the_end = n_characters(d.source_line) - d.column + 1;
    d.length = std::max(1, std::min(d.length, to_the_end));
}

Diagnostic& Findings::error(const std::string& code, const std::string& message, const Node& at) {
    source_.point(error(code, message), at);
    return found_.back();
}

Diagnostic& Findings::error_at_name(const std::string& code, const std::string& message, const Node& at) {
    source_.point_at_name(error(code, message), at);
    return found_.back();
}

Diagnostic& Findings::error(const std::string& code, const std::string& message) {
    found_.push_back({.code = code, .message = message, .file = source_.name()});
    return found_.back();
}

Diagnostic& Findings::warning(const std::string& code, const std::string& message, const Node& at) {
    found_.push_back({.severity = Diagnostic::Severity::warning, .code = code, .message = message});
    source_.point(found_.back(), at);
    return found_.back();
}

bool Findings::has_errors() const {
    return std::any_of(found_.begin(), found_.end(), [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::error; });
}

std::vector<Diagnostic> Findings::sorted(Diagnostic::Severity severity) const {
    std::vector<Diagnostic> list;
    std::copy_if(found_.begin(), found_.end(), std::back_inserter(list), [&](const Diagnostic& d) { return d.severity == severity; });
    const auto rank = [](const Diagnostic& d) { return std::make_tuple(d.line == 0, d.line, d.column); };
    std::stable_sort(list.begin(), list.end(), [&](const Diagnostic& a, const Diagnostic& b) { return rank(a) < rank(b); });
    std::size_t n_quoted = 0;  // characters
    for (auto d = list.begin(); d != list.end() && n_quoted < most_quoted; ++d) {
        source_.quote(*d);
        n_quoted += d->source_line.size();
    }
    return list;
}

const std::string* nearest(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string* best = nullptr;
    int least = 2 + static_cast<int>(word.size()) / 3;  // a third of the letters may be wrong
    for (const std::string& candidate : candidates) {
        if (std::abs(static_cast<int>(word.size()) - static_cast<int>(candidate.size())) >= least) continue;  // so many are missing
        const int distance = edit_distance(word, candidate);
        const bool nothing_alike = distance > 0 && distance >= static_cast<int>(std::min(word.size(), candidate.size()));
        if (distance >= least || nothing_alike) continue;
        best = &candidate;
        least = distance;
    }
    return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string* meant = nearest(word, candidates);
    return meant ? "did you mean `" + *meant + "`?" : "";
}

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : std::string(separator)) + word;
    return text;
}

}  // namespace knap
