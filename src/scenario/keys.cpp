// Properties of keys, paths and names.
#include "scenario/keys.hpp"

#include "base/text.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <map>

namespace knap {

FormRule Key::rule() const {
    if (min_points > 1) return {"a list of pairs [[a, b], ...], at least " + std::to_string(min_points), min_points, 0};
    static const FormRule rules[] = {{"", 1, 1},
                                     {"two values [a, b]", 2, 2},
                                     {"three values [a, b, c]", 3, 3},
                                     {"a box [xmin, ymin, xmax, ymax]", 4, 4},
                                     {"a list [a, b, ...]", 1, 0},
                                     {"", 1, 0},
                                     {"a list of pairs [[a, b], ...]", 1, 0}};
    return rules[static_cast<int>(form)];
}

bool Range::contains(double value) const {
    return (low_included ? value >= low : value > low) && (high_included ? value <= high : value < high);
}

std::string Range::text() const {
    std::vector<std::string> parts;
    if (low > -infinity) parts.push_back((low_included ? "at least " : "greater than ") + shortest(low));
    if (high < infinity) parts.push_back((high_included ? "at most " : "less than ") + shortest(high));
    return joined(parts, " and ");
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
        if (word.ends_with('*')) return text.size() >= word.size() && text.starts_with(word.substr(0, word.size() - 1));
        return word.starts_with('*') ? text.size() >= word.size() && text.ends_with(word.substr(1)) : text == word;
    });
}

const Key* find_key(std::string_view pattern) {
    const auto found = std::ranges::find(keys(), pattern, [](const Key& key) { return std::string_view(key.path); });
    return found == keys().end() ? nullptr : &*found;
}

const std::vector<const Key*>& keys_below(std::string_view pattern) {
    static const auto rows = [] {
        std::map<std::string_view, std::vector<const Key*>> below;
        for (const Key& key : keys()) below[key.path], below[key.parent()].push_back(&key);
        return below;
    }();
    return rows.at(pattern);
}

std::string pattern_of(std::string_view path) {
    std::string pattern;
    while (!path.empty()) {
        const std::size_t dot = std::min(path.find('.'), path.size());
        std::string part(path.substr(0, dot));
        path.remove_prefix(std::min(dot + 1, path.size()));
        if (const std::size_t bracket = part.find('['); bracket != std::string::npos) part.replace(bracket, -1, "[]");
        const Key* parent = find_key(pattern);
        pattern = joined_path(pattern, parent && parent->kind == Kind::names ? "*" : part);
        if (const std::string list = pattern + "[]"; !path.empty() && !find_key(pattern) && find_key(list)) {
            path.remove_prefix(std::min(path.find('.', 1), path.size() - 1) + 1);  // the name of an entry
            pattern = list;
        }
    }
    return pattern;
}

const Key* key_at(std::string_view path) {
    const std::string pattern = pattern_of(path);
    if (const Key* key = find_key(pattern)) return key;
    for (const char* component : {".x", ".y", "[]"})
        if (const std::size_t n = std::string_view(component).size(); pattern.ends_with(component))
            if (const Key* key = find_key(pattern.substr(0, pattern.size() - n)); key && key->form == Form::pair)
                return key;
    return nullptr;
}

std::string pair_without_component(std::string_view path) {
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos || key_at(path)) return "";
    const Key* above = find_key(pattern_of(path.substr(0, dot)));
    return above && above->form == Form::pair ? std::string(path.substr(0, dot)) : "";
}

std::string joined_path(std::string_view table, std::string_view key) {
    return std::string(table) + (table.empty() || key.empty() ? "" : ".") + std::string(key);
}

std::string describe_unit(std::string_view unit) {
    if (unit == "*") return "a number or a text with a unit";
    return unit.empty() ? "a number" : kind_name(dimension_of(unit)) + " [" + std::string(unit) + "]";
}

std::string describe_one(const Key& key, std::string_view unit) {
    switch (key.kind) {
        case Kind::boolean: return "true or false";
        case Kind::integer: return "a whole number";
        case Kind::text:
            return key.takes_values ? "a value" : key.words.empty() ? "a text" : "one of " + joined(key.words);
        case Kind::number: break;
        default: return "a table";
    }
    std::string text = describe_unit(unit);
    for (const std::string& word : key.words) text += " or \"" + word + "\"";
    if (key.takes_formulas) text += " or a formula of x, y, t";
    return text;
}

std::string describe(const Key& key, std::string_view unit) {
    const std::string one = describe_one(key, unit), text = key.rule().text;
    if (key.takes_formulas) return text + (text.empty() ? "" : ", each ") + one + "; or a csv file";
    if (key.form == Form::one_or_list) return one + ", or a list of them";
    if (key.form != Form::points || key.second_unit == "=") return text + (text.empty() ? "" : ", each ") + one;
    return text + ", a being " + one + " and b " + describe_unit(key.second_unit);
}

bool is_name(std::string_view text) {
    const auto allowed = [](char c) {
        return (is_plain(c) && c != '.') || c == ' ' || static_cast<unsigned char>(c) >= 0x80;
    };
    return !text.empty() && text.front() != ' ' && text.back() != ' ' && std::ranges::all_of(text, allowed);
}

}  // namespace knap
