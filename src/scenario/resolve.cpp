#include "scenario/resolve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "scenario/toml_tree.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

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

std::string describe(const Key& key, std::string_view unit) {
    const std::string each = kind_of_value(key, unit);
    switch (key.form) {
        case Form::one: return each;
        case Form::pair: return "two values [a, b], each " + each;
        case Form::box: return "a box [xmin, ymin, xmax, ymax], each " + each;
        case Form::list: return "a list [a, b, ...], each " + each;
        case Form::one_or_list: return each + ", or a list of them";
        case Form::points:
            if (key.second_unit != "=") return "a list of pairs [[a, b], ...], a being " + each + " and b " + kind_of_number(key.second_unit);
            return "a list of pairs [[a, b], ...], each " + each;
    }
    return each;
}

void forget_places(Node& node) {
    node.place = node.name_place = {};
    for (Node& child : node.children) forget_places(child);
}

Node value_of_text(std::string_view toml) {
    Node root;
    parse_toml("x = " + std::string(toml), root);
    return root.children.empty() ? Node{} : root.children.front();
}

/// One walk over the tree.
class Resolver {
public:
    explicit Resolver(Findings& findings) : findings_(findings) {}

    void members(const Node& table, std::string_view pattern, const std::string& path) {
        report_unknown(table, pattern, path);
        for (const Key* key : keys_below(pattern)) member(*key, table, path);
    }

    Values values;

private:
    static std::string below(const std::string& path, std::string_view name) { return path.empty() ? std::string(name) : path + "." + std::string(name); }

    static Origin origin_of(const Node& node) { return node.set_by.empty() ? Origin::file : Origin::set; }

    void add(const Key& key, const std::string& path, Node node, bool valid) {
        const Origin origin = origin_of(node);
        values.add({path, &key, std::move(node), origin, valid});
    }

    void add_table(const Key& key, const std::string& path, const Node& table) {
        add(key, path, {.name_place = table.name_place, .place = table.place, .set_by = table.set_by}, true);
    }

    void report_unknown(const Node& table, std::string_view pattern, const std::string& path) {
        const auto rows = keys_below(pattern);
        std::vector<std::string> known;
        for (const Key* key : rows)
            if (applies(*key, table) != Applies::no) known.emplace_back(key->name());
        for (const Node& child : table.children) {
            const auto same = [&](const Key* key) { return key->name() == child.name; };
            if (std::any_of(rows.begin(), rows.end(), same)) continue;
            Diagnostic& d = findings_.error_at_name("unknown-key", "`" + below(path, child.name) + "` is not a key of a scenario", child);
            d.hint = did_you_mean(child.name, known);
            if (d.hint.empty()) d.hint = its_own_table(child.name);
            d.note = "known here: " + joined(known);
            // the key that was meant counts as given, so that it is not reported as missing too
            if (const std::string* meant = nearest(child.name, known); meant && !table.find(*meant)) {
                const std::string meant_path = below(path, *meant);
                misspelt_.insert(meant_path);
                if (const Key* key = find_key(pattern_of(meant_path))) values.add({meant_path, key, {}, Origin::file, false});
            }
        }
    }

    static std::string its_own_table(const std::string& name) {
        for (const Key& key : keys())
            if (key.name() == name && !key.parent().empty()) return "there is `" + std::string(key.path) + "`";
        return "";
    }

    enum class Applies { no, perhaps, yes };

    /// `when` of a key, held against its neighbours. Beside a missing or wrong neighbour it may apply.
    static Applies applies(const Key& key, const Node& table) {
        if (key.when.empty()) return Applies::yes;
        const std::size_t equals = key.when.find('=');
        const Node* neighbour = table.find(key.when.substr(0, equals));
        if (!neighbour) return Applies::perhaps;
        const auto& words = find_key(std::string(key.parent()) + "." + std::string(key.when.substr(0, equals)))->words;
        if (std::find(words.begin(), words.end(), neighbour->text) == words.end()) return Applies::perhaps;
        return neighbour->text == key.when.substr(equals + 1) ? Applies::yes : Applies::no;
    }

    void member(const Key& key, const Node& table, const std::string& path) {
        const Node* node = table.find(key.name());
        const std::string here = below(path, key.name());
        if (node && applies(key, table) == Applies::no) {
            const std::string when(key.when);
            const std::size_t equals = when.find('=');
            findings_.error_at_name("exclusive-keys", "`" + here + "` belongs to " + when.substr(0, equals) + " = " + quoted(when.substr(equals + 1)), *node)
                .note = "here " + when.substr(0, equals) + " = " + quoted(table.find(when.substr(0, equals))->text);
        } else if (node) {
            present(key, *node, table, here);
        } else if (applies(key, table) == Applies::yes && !misspelt_.contains(here)) {
            absent(key, table, here);
        }
    }

    void absent(const Key& key, const Node& table, const std::string& path) {
        if (key.required) {
            Diagnostic& d = findings_.error("missing-key", "`" + path + "` is missing", table);
            if (table.place.line == 0 || path.find('.') == std::string::npos) d = {.code = d.code, .message = d.message, .file = d.file};
            d.note = std::string(key.name()) + ": " + std::string(key.doc) + (key.kind == Kind::table ? "" : "; " + describe(key, key.unit));
        } else if (key.kind == Kind::table) {
            members(Node{}, key.path, path);
        } else if (!key.standard.empty()) {
            std::optional<Node> value = checked(key, value_of_text(key.standard), path, key.unit);
            assert(value);  // a default that the table itself refuses
            forget_places(*value);
            values.add({path, &key, std::move(*value), Origin::standard});
        } else if (!key.otherwise.empty()) {
            values.add({path, &key, {}, Origin::computed, false});
        }
    }

    void present(const Key& key, const Node& node, const Node& table, const std::string& path) {
        switch (key.kind) {
            case Kind::table: return present_table(key, node, path);
            case Kind::list: return present_list(key, node, path);
            case Kind::names: return present_names(key, node, path);
            default: break;
        }
        std::optional<Node> value = checked(key, node, path, unit_of(key, table, path));
        Node kept = value ? *value : Node{};
        kept.name_place = node.name_place;
        kept.place = node.place;
        kept.set_by = node.set_by;
        add(key, path, std::move(kept), value.has_value());
    }

    void present_table(const Key& key, const Node& node, const std::string& path) {
        if (node.type == Node::Type::text && !key.shorthand.empty()) {
            Node table{.name_place = node.name_place, .place = node.place, .set_by = node.set_by};
            table.children.push_back(node);
            table.children.back().name = std::string(key.shorthand);
            return present_table(key, table, path);
        }
        if (node.type != Node::Type::table) {
            const std::string form = key.shorthand.empty() ? "a table" : "a text or a table";
            findings_.error("wrong-type", "`" + path + "` must be " + form + ", not " + type_name(node), node);
            return add(key, path, node, false);
        }
        add_table(key, path, node);
        members(node, key.path, path);
    }

    void present_list(const Key& key, const Node& node, const std::string& path) {
        const std::string name(key.name());
        const bool good = node.type == Node::Type::array && std::all_of(node.children.begin(), node.children.end(), [](const Node& child) {
                              return child.type == Node::Type::table;
                          });
        if (!good) {
            findings_.error("wrong-type", "`" + path + "` must be a list of tables, not " + type_name(node), node).note = "write [[" + path + "]]";
            return;
        }
        for (std::size_t i = 0; i < node.children.size(); ++i) {
            add_table(key, item(path, i), node.children[i]);
            members(node.children[i], key.path, item(path, i));
        }
    }

    void present_names(const Key& key, const Node& node, const std::string& path) {
        if (node.type != Node::Type::table) {
            findings_.error("wrong-type", "`" + path + "` must be a table, not " + type_name(node), node).note = "write [" + path + ".NAME]";
            return;
        }
        add_table(key, path, node);
        const Key& row = *find_key(std::string(key.path) + ".*");
        for (const Node& child : node.children) {
            const std::string here = below(path, child.name);
            if (!row.words.empty() && std::find(row.words.begin(), row.words.end(), child.name) == row.words.end()) {
                Diagnostic& d = findings_.error_at_name("unknown-key", "`" + here + "` is not a key of a scenario", child);
                d.hint = did_you_mean(child.name, row.words);
                d.note = "known here: " + joined(row.words);
            } else if (!is_plain_name(child.name)) {
                findings_.error_at_name("bad-name", "`" + child.name + "` cannot be a name here", child).note = "letters, digits, _ and -";
            } else {
                present_table(row, child, here);
            }
        }
    }

    static bool is_plain_name(const std::string& name) {
        return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
        });
    }

    /// The unit of a key's plain numbers, also where it depends on a neighbour or on a name.
    static std::string_view unit_of(const Key& key, const Node& table, const std::string& path) {
        if (key.unit != "*") return key.unit;
        if (path.starts_with("expect.")) {
            const std::string name = path.substr(7, path.rfind('.') - 7);
            for (const SummaryKey& summary : summary_keys())
                if (summary.name == name) return summary.unit;
            return "";
        }
        const Node *show = table.find("show"), *colour = table.find("colour");
        if (colour && colour->text == "beta" && (!show || show->text == "cracks")) return "";
        return unit_of_field(show ? show->text : "cracks");
    }

    // ---- one value

    void wrong_type(const Key& key, const Node& node, const std::string& path, std::string_view unit) {
        findings_.error("wrong-type", "`" + path + "` must be " + describe(key, unit) + ", not " + type_name(node), node);
    }

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
        if (key.words.empty() || std::find(key.words.begin(), key.words.end(), node.text) != key.words.end()) return node;
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
            d.note = "wanted: " + kind_of_value(key, unit);
            return false;
        }
        value.number = quantity.value;
        if (quantity.unit == "%" && key.path == "expect.*.within") {
            value.number = parse_quantity(node.text.substr(0, node.text.find('%'))).value;
            value.unit = "%";
        } else if (quantity.unit == "cR" && unit == "m/s" && key.path.starts_with("expect.")) {
            value.unit = "cR";
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

    Findings& findings_;
    std::set<std::string> misspelt_;
};

}  // namespace

std::string describe(const Key& key) { return describe(key, key.unit); }

Values resolve(const Node& root, Findings& findings) {
    Resolver resolver(findings);
    resolver.members(root, "", "");
    return std::move(resolver.values);
}

}  // namespace knap
