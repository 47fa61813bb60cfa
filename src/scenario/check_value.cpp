#include "scenario/check_value.hpp"

#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// "a length [m]", for one number of a key.
std::string kind_of_number(std::string_view unit) {
    if (unit == "*") return "a number or a text with a unit";
    if (unit.empty()) return "a number";
    return kind_name(dimension_of(unit)) + " [" + std::string(unit) + "]";
}

std::string kind_of_value(const Key& key, std::string_view unit) {
    switch (key.kind) {
        case Kind::boolean: return "true or false";
        case Kind::integer: return "a whole number";
        case Kind::text: return key.words.empty() ? "a text" : "one of " + joined(key.words);
        case Kind::number: break;
        default: return "a table";
    }
    std::string text = kind_of_number(unit);
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
        case Form::points: break;
    }
    if (key.second_unit == "=") return "a list of pairs [[a, b], ...], each " + each;
    return "a list of pairs [[a, b], ...], a being " + each + " and b " + kind_of_number(key.second_unit);
}

/// One key's value, with all that is wrong in it.
class ValueCheck {
public:
    ValueCheck(Findings& findings, const Key& key, const std::string& path, std::string_view unit)
        : findings_(findings), key_(key), path_(path), unit_(unit) {}

    std::optional<Node> checked(const Node& node) {
        const bool array = node.type == Node::Type::array;
        const std::size_t n = node.children.size();
        const auto is_array = [](const Node& child) { return child.type == Node::Type::array; };
        const auto list_of = [&](std::size_t length) { return array && n == length ? each(node) : wrong_type(node); };
        switch (key_.form) {
            case Form::one: return scalar(node, unit_);
            case Form::one_or_list:
                if (!array) {
                    std::optional<Node> one = scalar(node, unit_);
                    return one ? std::optional(Node::of_list({std::move(*one)})) : std::nullopt;
                }
                [[fallthrough]];
            case Form::list: return array && n > 0 ? each(node) : wrong_type(node);
            case Form::pair: return list_of(2);
            case Form::triple: return list_of(3);
            case Form::box: return box(node, list_of(4));
            case Form::points:
                return array && std::ranges::any_of(node.children, is_array) ? points(node) : wrong_type(node);
        }
        return std::nullopt;
    }

private:
    std::optional<Node> each(const Node& node) {
        Node list{.type = Node::Type::array};
        for (const Node& child : node.children)
            if (std::optional<Node> value = scalar(child, unit_)) list.children.push_back(std::move(*value));
        return list.children.size() == node.children.size() ? std::optional(std::move(list)) : std::nullopt;
    }

    std::optional<Node> box(const Node& node, std::optional<Node> value) {
        if (!value) return std::nullopt;
        const auto& n = value->children;
        if (n[0].number < n[2].number && n[1].number < n[3].number) return value;
        findings_.error("out-of-range", "`" + path_ + "` has no area", node).note =
            "a box is [xmin, ymin, xmax, ymax]: lower left and upper right corner";
        return std::nullopt;
    }

    std::optional<Node> points(const Node& node) {
        Node list{.type = Node::Type::array};
        for (const Node& child : node.children) {
            if (child.type != Node::Type::array || child.children.size() != 2) {
                wrong_type(child);
                continue;
            }
            const std::optional<Node> a = scalar(child.children[0], unit_);
            const std::optional<Node> b = scalar(child.children[1], key_.second_unit == "=" ? unit_ : key_.second_unit);
            if (!a || !b) continue;
            list.children.push_back(Node::of_list({*a, *b}));
            list.children.back().take_place(child);
        }
        return list.children.size() == node.children.size() ? std::optional(std::move(list)) : std::nullopt;
    }

    /// One number, text or truth value.
    std::optional<Node> scalar(const Node& node, std::string_view unit) {
        Node value{.type = node.type, .number = node.number, .integer = node.integer, .boolean = node.boolean};
        value.place = node.place;
        value.set_by = node.set_by;
        switch (key_.kind) {
            case Kind::boolean: return node.type == Node::Type::boolean ? std::optional(value) : wrong_type(node);
            case Kind::integer: return node.type == Node::Type::integer ? in_range(value) : wrong_type(node);
            case Kind::text: break;
            default: return number(node, std::move(value), unit);
        }
        // a bare text of the command line that looks like something else: name=2026
        const bool raw = !node.set_by.empty() && node.type != Node::Type::text && key_.form == Form::one;
        if (!raw && node.type != Node::Type::text) return wrong_type(node);
        value.text = raw ? node.set_by.substr(node.set_by.find('=') + 1) : node.text;
        value.type = Node::Type::text;
        if (key_.words.empty() || is_word(key_.words, value.text)) return value;
        Diagnostic& d = findings_.error("unknown-word", "`" + path_ + "` cannot be " + quoted(value.text), node);
        d.hint = did_you_mean(value.text, key_.words);
        d.note = "allowed: " + joined(key_.words);
        return std::nullopt;
    }

    std::optional<Node> number(const Node& node, Node value, std::string_view unit) {
        if (node.is_number()) {
            value.type = Node::Type::number;
            return in_range(value);
        }
        if (node.type != Node::Type::text) return wrong_type(node);
        if (std::ranges::find(key_.words, node.text) != key_.words.end()) {
            value.text = node.text;
            return value;
        }
        value.type = Node::Type::number;
        return with_unit(node, unit, value) ? in_range(value) : std::nullopt;
    }

    /// Reads the text of `node` into `value`.
    bool with_unit(const Node& node, std::string_view unit, Node& value) {
        const Quantity quantity = parse_quantity(node.text);
        if (!quantity.problem.empty()) {
            Diagnostic& d =
                findings_.error("wrong-unit", "`" + path_ + "`: " + quoted(node.text) + " " + quantity.problem, node);
            d.hint = did_you_mean(node.text, key_.words);
            if (d.hint.empty() && quantity.unknown_unit) d.hint = unit_meant(quantity.unit, unit);
            d.note = "wanted: " + kind_of_value(key_, unit);
            return false;
        }
        value.number = quantity.value;
        if (quantity.unit == "%" && key_.path == "expect.*.within") {
            value.number = parse_quantity(node.text.substr(0, node.text.find('%'))).value;
            value.unit = "%";
        } else if (quantity.unit == "cR" && unit == "m/s" && key_.path.starts_with("expect.")) {
            value.unit = "cR";
        } else if (quantity.unit == "CFL" && key_.path.starts_with("time.step")) {
            value.unit = "CFL";
        } else if (quantity.dimension != dimension_of(unit)) {
            const std::string what = quantity.unit.empty() ? "has no unit" : "is " + kind_name(quantity.dimension);
            const std::string text = "must be " + kind_of_number(unit) + ", and " + quoted(node.text) + " " + what;
            findings_.error("wrong-unit", "`" + path_ + "` " + text, node);
            return false;
        }
        return true;
    }

    std::optional<Node> in_range(const Node& value) {
        const bool finite = std::isfinite(value.number);
        if (finite && key_.range.contains(value.number)) return value;
        const std::string allowed = finite ? key_.range.text() : "finite";
        const std::string unit = key_.unit.empty() || key_.unit == "*" ? "" : " " + std::string(key_.unit);
        findings_.error("out-of-range", "`" + path_ + "` must be " + allowed + ", not " + shortest(value.number) + unit,
                        value);
        return std::nullopt;
    }

    std::optional<Node> wrong_type(const Node& node) {
        findings_.error("wrong-type",
                        "`" + path_ + "` must be " + describe_with(key_, unit_) + ", not " + type_name(node), node);
        return std::nullopt;
    }

    Findings& findings_;
    const Key& key_;
    const std::string& path_;
    std::string_view unit_;
};

}  // namespace

std::optional<Node> check_value(Findings& findings, const Key& key, const Node& node, const std::string& path,
                                std::string_view unit) {
    return ValueCheck(findings, key, path, unit).checked(node);
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

std::string describe(const Key& key) { return describe_with(key, key.unit); }

}  // namespace knap
