#include "scenario/check_value.hpp"

#include <algorithm>
#include <cmath>

#include "scenario/units.hpp"

namespace knap {
namespace {

/// "a length [m]", for one number of a key.
std::string kind_of_number(std::string_view unit) {
    if (unit == "*") return "a number or a text with a unit";
    if (unit.empty()) return "a number";
    return kind_name(dimension_of(unit)) + " [" + std::string(unit) + "]";
}

std::string kind_of_value(const Key& key, std::string_view unit) {
    std::string text;
    switch (key.kind) {
        case Kind::boolean: return "true or false";
        case Kind::integer: return "a whole number";
        case Kind::text: return key.words.empty() ? "a text" : "one of " + joined(key.words);
        case Kind::number: text = kind_of_number(unit); break;
        default: return "a table";
    }
    for (const std::string& word : key.words) text += " or " + quoted(word);
    return text;
}

std::string describe_with(const Key& key, std::string_view unit) {
    const std::string each = kind_of_value(key, unit);
    switch (key.form) {
        case Form::one: return each;
        case Form::pair: return "two values [a, b], each " + each;
        case Form::triple: return "three values [a, b, c], each " + each;
        case Form::box: return "a box [xmin, ymin, xmax, ymax], each " + each;
        case Form::list: return "a list [a, b, ...], each " + each;
        case Form::one_or_list: return each + ", or a list of them";
        case Form::points:
            if (key.second_unit != "=") return "a list of pairs [[a, b], ...], a being " + each + " and b " + kind_of_number(key.second_unit);
            return "a list of pairs [[a, b], ...], each " + each;
    }
    return each;
}

/// One key's value, with all that is wrong in it.
class ValueCheck {
public:
    explicit ValueCheck(Findings& findings) : findings_(findings) {}

    std::optional<Node> checked(const Key& key, const Node& node, const std::string& path, std::string_view unit) {
        const bool array = node.type == Node::Type::array;
        const std::size_t n = node.children.size();
        switch (key.form) {
            case Form::one: return scalar(key, node, path, unit, unit);
            case Form::one_or_list:
                if (!array) {
                    std::optional<Node> one = scalar(key, node, path, unit, unit);
                    if (!one) return std::nullopt;
                    Node list{.type = Node::Type::array};
                    list.children.push_back(*one);
                    return list;
                }
                [[fallthrough]];
            case Form::list:
                if (array && n > 0) return each(key, node, path, unit);
                break;
            case Form::pair:
                if (array && n == 2) return each(key, node, path, unit);
                break;
            case Form::triple:
                if (array && n == 3) return each(key, node, path, unit);
                break;
            case Form::box:
                if (array && n == 4) return box(key, node, path, unit);
                break;
            case Form::points:
                if (array && std::any_of(node.children.begin(), node.children.end(), [](const Node& child) { return child.type == Node::Type::array; }))
                    return points(key, node, path, unit);
                break;
        }
        wrong_type(key, node, path, unit);
        return std::nullopt;
    }

private:
    std::optional<Node> each(const Key& key, const Node& node, const std::string& path, std::string_view unit) {
        Node list{.type = Node::Type::array};
        for (const Node& child : node.children)
            if (std::optional<Node> value = scalar(key, child, path, unit, unit)) list.children.push_back(std::move(*value));
        if (list.children.size() != node.children.size()) return std::nullopt;
        return list;
    }

    std::optional<Node> box(const Key& key, const Node& node, const std::string& path, std::string_view unit) {
        std::optional<Node> value = each(key, node, path, unit);
        if (!value) return std::nullopt;
        const auto& n = value->children;
        if (n[0].number < n[2].number && n[1].number < n[3].number) return value;
        findings_.error("out-of-range", "`" + path + "` has no area", node).note = "a box is [xmin, ymin, xmax, ymax]: lower left and upper right corner";
        return std::nullopt;
    }

    std::optional<Node> points(const Key& key, const Node& node, const std::string& path, std::string_view unit) {
        Node list{.type = Node::Type::array};
        for (const Node& child : node.children) {
            if (child.type != Node::Type::array || child.children.size() != 2) {
                wrong_type(key, child, path, unit);
                continue;
            }
            Node point{.type = Node::Type::array, .place = child.place, .set_by = child.set_by};
            for (std::size_t i = 0; i < 2; ++i) {
                const std::string_view of_this = i == 1 && key.second_unit != "=" ? key.second_unit : unit;
                if (std::optional<Node> value = scalar(key, child.children[i], path, of_this, unit)) point.children.push_back(std::move(*value));
            }
            if (point.children.size() == 2) list.children.push_back(std::move(point));
        }
        if (list.children.size() != node.children.size()) return std::nullopt;
        return list;
    }

    /// One number, text or truth value. `key_unit` is for messages about the whole.
    std::optional<Node> scalar(const Key& key, const Node& node, const std::string& path, std::string_view unit, std::string_view key_unit) {
        Node value{.place = node.place, .set_by = node.set_by};
        value.type = node.type;
        switch (key.kind) {
            case Kind::boolean:
                value.boolean = node.boolean;
                if (node.type == Node::Type::boolean) return value;
                break;
            case Kind::integer:
                value.integer = node.integer;
                value.number = node.number;
                if (node.type == Node::Type::integer) return in_range(key, value, path) ? std::optional(value) : std::nullopt;
                break;
            case Kind::text: {
                const bool raw = !node.set_by.empty() && node.type != Node::Type::text && key.form == Form::one;
                value.text = raw ? node.set_by.substr(node.set_by.find('=') + 1) : node.text;
                value.type = Node::Type::text;
                if (raw || node.type == Node::Type::text) return word(key, value, path);
                break;
            }
            default: return number(key, node, path, unit, key_unit);
        }
        wrong_type(key, node, path, key_unit);
        return std::nullopt;
    }

    std::optional<Node> word(const Key& key, const Node& node, const std::string& path) {
        if (key.words.empty() || is_word(key.words, node.text)) return node;
        Diagnostic& d = findings_.error("unknown-word", "`" + path + "` cannot be " + quoted(node.text), node);
        d.hint = did_you_mean(node.text, key.words);
        d.note = "allowed: " + joined(key.words);
        return std::nullopt;
    }

    std::optional<Node> number(const Key& key, const Node& node, const std::string& path, std::string_view unit, std::string_view key_unit) {
        Node value{.type = Node::Type::number, .place = node.place, .number = node.number, .set_by = node.set_by};
        if (node.type == Node::Type::text) {
            if (std::find(key.words.begin(), key.words.end(), node.text) != key.words.end()) {
                value.type = Node::Type::text;
                value.text = node.text;
                return value;
            }
            if (!with_unit(key, node, path, unit, value)) return std::nullopt;
        } else if (!node.is_number()) {
            wrong_type(key, node, path, key_unit);
            return std::nullopt;
        }
        return in_range(key, value, path) ? std::optional(value) : std::nullopt;
    }

    /// Reads the text of `node` into `value`.
    bool with_unit(const Key& key, const Node& node, const std::string& path, std::string_view unit, Node& value) {
        const Quantity quantity = parse_quantity(node.text);
        const std::string wanted = kind_of_number(unit);
        if (!quantity.problem.empty()) {
            Diagnostic& d = findings_.error("wrong-unit", "`" + path + "`: " + quoted(node.text) + " " + quantity.problem, node);
            d.hint = did_you_mean(node.text, key.words);
            if (d.hint.empty() && quantity.unknown_unit) d.hint = unit_meant(quantity.unit, unit);
            d.note = "wanted: " + kind_of_value(key, unit);
            return false;
        }
        value.number = quantity.value;
        if (quantity.unit == "%" && key.path == "expect.*.within") {
            value.number = parse_quantity(node.text.substr(0, node.text.find('%'))).value;
            value.unit = "%";
        } else if (quantity.unit == "cR" && unit == "m/s" && key.path.starts_with("expect.")) {
            value.unit = "cR";
        } else if (quantity.unit == "CFL" && key.path.starts_with("time.step")) {
            value.unit = "CFL";
        } else if (quantity.dimension != dimension_of(unit)) {
            const std::string what = quantity.unit.empty() ? "has no unit" : "is " + kind_name(quantity.dimension);
            findings_.error("wrong-unit", "`" + path + "` must be " + wanted + ", and " + quoted(node.text) + " " + what, node);
            return false;
        }
        return true;
    }

    bool in_range(const Key& key, const Node& value, const std::string& path) {
        if (std::isfinite(value.number) && key.range.contains(value.number)) return true;
        const std::string allowed = std::isfinite(value.number) ? key.range.text() : "finite";
        const std::string unit = key.unit.empty() || key.unit == "*" ? "" : " " + std::string(key.unit);
        findings_.error("out-of-range", "`" + path + "` must be " + allowed + ", not " + shortest(value.number) + unit, value);
        return false;
    }

    void wrong_type(const Key& key, const Node& node, const std::string& path, std::string_view unit) {
        findings_.error("wrong-type", "`" + path + "` must be " + describe_with(key, unit) + ", not " + type_name(node), node);
    }

    Findings& findings_;
};

}  // namespace

std::optional<Node> check_value(Findings& findings, const Key& key, const Node& node, const std::string& path, std::string_view unit) {
    return ValueCheck(findings).checked(key, node, path, unit);
}

std::string type_name(const Node& node) {
    switch (node.type) {
        case Node::Type::table: return "a table";
        case Node::Type::array: return "a list of " + std::to_string(node.children.size());
        case Node::Type::text: return "the text " + quoted(node.text);
        case Node::Type::integer: return "the number " + std::to_string(node.integer);
        case Node::Type::number: return "the number " + shortest(node.number);
        case Node::Type::boolean: return node.boolean ? "true" : "false";
        case Node::Type::date: return "a date";
    }
    return "";
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::string describe(const Key& key) { return describe_with(key, key.unit); }

}  // namespace knap
