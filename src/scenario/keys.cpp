// What the key table says of a path.
#include "scenario/keys.hpp"

#include "base/text.hpp"

#include <algorithm>

namespace knap {

bool Range::contains(double value) const {
    return (low_included ? value >= low : value > low) && (high_included ? value <= high : value < high);
}

std::string Range::text() const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::vector<std::string> parts;
    if (low > -infinity) parts.push_back((low_included ? "at least " : "greater than ") + shortest(low));
    if (high < infinity) parts.push_back((high_included ? "at most " : "less than ") + shortest(high));
    return joined(parts, " and ");
}

std::string Condition::text() const {
    return values.empty() ? "" : std::string(neighbour) + "=" + joined(values, " or ");
}

std::string_view Key::name() const {
    std::string_view name = std::string_view(path).substr(path.rfind('.') + 1);
    if (name.ends_with("[]")) name.remove_suffix(2);
    return name;
}

std::string_view Key::parent() const {
    const std::size_t dot = path.rfind('.');
    return std::string_view(path).substr(0, dot == std::string::npos ? 0 : dot);
}

bool is_word(const std::vector<std::string>& words, std::string_view text) {
    return std::ranges::any_of(words, [&](const std::string& word) {
        return word.starts_with('*') ? text.size() >= word.size() && text.ends_with(word.substr(1)) : text == word;
    });
}

const Key* find_key(std::string_view pattern) {
    for (const Key& key : keys())
        if (key.path == pattern) return &key;
    return nullptr;
}

std::vector<const Key*> keys_below(std::string_view pattern) {
    std::vector<const Key*> below;
    for (const Key& key : keys())
        if (key.parent() == pattern) below.push_back(&key);
    return below;
}

std::string pattern_of(std::string_view path) {
    std::string pattern;
    while (!path.empty()) {
        const std::size_t dot = path.find('.');
        std::string part(path.substr(0, dot));
        path.remove_prefix(dot == std::string_view::npos ? path.size() : dot + 1);
        if (const std::size_t bracket = part.find('['); bracket != std::string::npos)
            part = part.substr(0, bracket) + "[]";
        const Key* parent = find_key(pattern);
        if (parent && parent->kind == Kind::names) part = "*";
        pattern += (pattern.empty() ? "" : ".") + part;
    }
    return pattern;
}

bool is_name(std::string_view text) {
    const auto allowed = [](char c) {
        return (is_plain(c) && c != '.') || c == ' ' || static_cast<unsigned char>(c) >= 0x80;
    };
    return !text.empty() && text.front() != ' ' && text.back() != ' ' && std::ranges::all_of(text, allowed);
}

}  // namespace knap
