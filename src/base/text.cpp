#include "base/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace knap {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Levenshtein distance in which a change of case costs nothing and a swap of neighbours costs one (optimal string
/// alignment).
int edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = static_cast<int>(i);
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const int change = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

}  // namespace

std::string shortest(double value) { return value == 0 && std::signbit(value) ? "-0.0" : decimal(value); }

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : std::string(separator)) + word;
    return text;
}

bool is_plain(char c) {
    const char l = lower(c);
    return (l >= 'a' && l <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

const std::string* nearest(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string* best = nullptr;
    int limit = 2 + static_cast<int>(word.size()) / 3;  // a third of the letters may be wrong
    for (const std::string& candidate : candidates) {
        const auto [shorter, longer] = std::minmax({std::ssize(word), std::ssize(candidate)});
        if (longer - shorter >= limit) continue;
        const int distance = edit_distance(word, candidate);
        if (distance >= limit || 2 * distance > shorter) continue;  // more differs than is alike
        best = &candidate;
        limit = distance;
    }
    return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t min_letters = 3, max_meant = 4;
    std::vector<std::string> meant;
    if (const std::string* best = nearest(word, candidates)) meant = {"`" + *best + "`"};
    else if (n_characters(word) >= min_letters)  // those of which it is the beginning
        for (const std::string& candidate : candidates)
            if (candidate.starts_with(word)) meant.push_back("`" + candidate + "`");
    return meant.empty() || meant.size() > max_meant ? "" : "did you mean " + joined(meant, " or ") + "?";
}

std::size_t n_characters(std::string_view utf8) {
    return utf8.size() - static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), continues_character));
}

std::string padded(const std::string& utf8, std::size_t width) {
    return utf8 + std::string(width - std::min(width, n_characters(utf8)), ' ');
}

std::size_t character_begin(std::string_view utf8, std::size_t i) {
    while (i < utf8.size() && continues_character(utf8[i])) ++i;
    return i;
}

bool is_utf8(std::string_view text) {
    while (!text.empty()) {
        const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
        const unsigned first = byte(0), second = byte(1);
        const std::size_t n = first < 0x80   ? 1
                              : first < 0xC2 ? 0
                              : first < 0xE0 ? 2
                              : first < 0xF0 ? 3
                              : first < 0xF5 ? 4
                                             : 0;
        for (std::size_t i = 1; i < n; ++i)
            if ((byte(i) & 0xC0) != 0x80) return false;
        const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
        const bool no_character = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
        if (n == 0 || overlong || no_character) return false;
        text.remove_prefix(n);
    }
    return true;
}

std::string xml_text(std::string_view text) {
    std::string escaped;
    for (const char c : text) escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
    return escaped;
}

std::string printable(const std::string& message) {
    std::string shown;
    for (std::size_t i = 0; i < message.size(); ++i) {
        const auto c = static_cast<unsigned char>(message[i]);
        const auto next = static_cast<unsigned char>(i + 1 < message.size() ? message[i + 1] : 0);
        const bool second_set = c == 0xC2 && next >= 0x80 && next < 0xA0;  // U+0080 to U+009F in UTF-8
        const bool is_control = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F || second_set;
        shown += is_control ? '?' : message[i];
        if (second_set) ++i;
    }
    return shown;
}

}  // namespace knap
