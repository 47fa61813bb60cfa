#include "scenario/resolve.hpp"

#include "figures/figures.hpp"
#include "record/outputs.hpp"
#include "scenario/formulas.hpp"
#include "scenario/keys.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

std::string in_quotes(const std::string& text) { return "\"" + text + "\""; }

/// "the number 3", "a list of 2"
std::string type_name(const Node& node) {
    switch (node.type) {
        case Node::Type::table: return "a table";
        case Node::Type::array: return "a list of " + std::to_string(node.children.size());
        case Node::Type::text: return "the text " + in_quotes(node.text);
        case Node::Type::integer: return "the number " + std::to_string(node.integer);
        case Node::Type::number: return "the number " + shortest(node.number);
        case Node::Type::boolean: return node.boolean ? "true" : "false";
        case Node::Type::date: return "a date";
    }
    return "";
}

/// Checks the value of one key, plain numbers in `unit`, and reports every mistake in it. Its parts convert a node to
/// SI; none if it is wrong.
class ValueCheck {
public:
    ValueCheck(Findings& findings, const Key& key, const std::string& path, std::string_view unit)
        : findings_(findings), key_(key), path_(path), unit_(unit) {}

    std::optional<Node> checked(const Node& node) {
        const bool array = node.type == Node::Type::array;
        const auto is_array = [](const Node& child) { return child.type == Node::Type::array; };
        if (key_.takes_formulas && node.text.ends_with(".csv")) {
            Node file = Node::of_text(node.text);
            file.take_place(node);
            return file;
        }
        if (key_.form == Form::one) return scalar(node, unit_);
        if (key_.form == Form::one_or_list && !array) {
            auto one = scalar(node, unit_);
            return one ? std::optional(Node::of_list({std::move(*one)})) : std::nullopt;
        }
        const FormRule rule = key_.rule();
        const std::size_t n = node.children.size();
        const bool too_few = n < rule.min;
        if (!array || (too_few && key_.min_points == 1) || (rule.max > 0 && n > rule.max)) return wrong(node);
        if (key_.form == Form::points && std::ranges::none_of(node.children, is_array)) return wrong(node);
        if (too_few)
            return error("out-of-range", " needs at least " + std::to_string(rule.min) + " points", node,
                         std::string(key_.doc));
        return key_.form == Form::box ? box(node, list(node)) : list(node);
    }

private:
    std::optional<Node> list(const Node& node) {
        Node found{.type = Node::Type::array};
        for (const Node& child : node.children)
            if (auto value = key_.form == Form::points ? point(child) : scalar(child, unit_))
                found.children.push_back(std::move(*value));
        return found.children.size() == node.children.size() ? std::optional(std::move(found)) : std::nullopt;
    }

    std::optional<Node> point(const Node& node) {
        if (node.type != Node::Type::array || node.children.size() != 2) return wrong(node);
        auto a = scalar(node.children[0], unit_);
        auto b = scalar(node.children[1], key_.second_unit == "=" ? unit_ : key_.second_unit);
        if (!a || !b) return std::nullopt;
        Node found = Node::of_list({std::move(*a), std::move(*b)});
        found.take_place(node);
        return found;
    }

    std::optional<Node> box(const Node& node, std::optional<Node> found) {
        const auto box = found ? value_as<Box>(*found) : std::nullopt;
        if (!box || (box->low.array() < box->high.array()).all()) return found;
        return error("out-of-range", " has no area", node, "a box is [xmin, ymin, xmax, ymax], with min < max");
    }

    /// One number, text or truth value.
    std::optional<Node> scalar(const Node& node, std::string_view unit) {
        Node value{.type = node.type, .number = node.number, .integer = node.integer, .boolean = node.boolean};
        value.take_place(node);
        switch (key_.kind) {
            case Kind::boolean: return node.type == Node::Type::boolean ? std::optional(value) : wrong(node);
            case Kind::integer: return node.type == Node::Type::integer ? in_range(std::move(value)) : wrong(node);
            case Kind::text: break;
            default: return number(node, std::move(value), unit);
        }
        // a bare text of the command line that is read as another type: name=2026
        const bool raw = !node.set_by.empty() && node.type != Node::Type::text && key_.form == Form::one;
        if (key_.takes_values && node.type != Node::Type::text && node.type != Node::Type::table) {
            value.text = toml_text(node), value.type = Node::Type::text;
            return value;
        }
        if (!raw && node.type != Node::Type::text) return wrong(node);
        value.text = raw ? node.set_by.substr(node.set_by.find('=') + 1) : node.text;
        value.type = Node::Type::text;
        if (key_.is_a_name && !is_name(value.text))
            return error("bad-name", " = " + in_quotes(value.text) + " is not allowed as a name", node, rule_for_names);
        if (key_.words.empty() || is_word(key_.words, value.text)) return value;
        return error("unknown-word", " cannot be " + in_quotes(value.text), node, "allowed: " + joined(key_.words),
                     did_you_mean(value.text, key_.words));
    }

    std::optional<Node> number(const Node& node, Node value, std::string_view unit) {
        value.type = Node::Type::number;
        if (node.is_number()) return in_range(std::move(value));
        if (node.type != Node::Type::text) return wrong(node);
        if (std::ranges::count(key_.words, node.text) > 0) {
            value.type = Node::Type::text;
            value.text = node.text;
            return value;
        }
        const Quantity quantity = parse_quantity(node.text);
        if (key_.takes_formulas && !quantity.problem.empty() && looks_like_formula(node.text)) {
            value.type = Node::Type::text, value.text = node.text;
            try {
                parse_formula(node.text, unit);
                return value;
            } catch (const UserError& wrong) {
                return error("bad-formula", " is no formula: " + wrong.diagnostics.front().message, node,
                             wrong.diagnostics.front().note + ", in " + std::string(unit) +
                                 " or with a unit behind it; or \"FILE.csv\" for all components");
            }
        }
        if (!quantity.problem.empty()) {
            std::string hint = did_you_mean(node.text, key_.words);
            if (hint.empty() && quantity.unknown_unit) hint = unit_suggestion(quantity.unit, unit);
            return error("wrong-unit", ": " + in_quotes(node.text) + " " + quantity.problem, node,
                         "expected: " + describe_one(key_, unit), hint);
        }
        const bool kept = std::ranges::count(key_.multiples, quantity.unit) > 0;
        if (kept && (quantity.unit != "cR" || unit == "m/s")) {
            value.number = quantity.number;
            value.unit = quantity.unit;
        } else if (quantity.dimension == dimension_of(unit)) {
            value.number = quantity.value;
            if (unit == "K") value.is_kelvin = !(quantity.unit == "C");
            if (unit == "K" && quantity.unit == "C") value.unit = "C";  // another zero: no factor
        } else {
            const std::string found = quantity.unit.empty() ? "has no unit" : "is " + kind_name(quantity.dimension);
            return error("wrong-unit",
                         " must be " + describe_unit(unit) + ", and " + in_quotes(node.text) + " " + found, node);
        }
        return in_range(std::move(value));
    }

    std::optional<Node> in_range(Node value) {
        const bool finite = std::isfinite(value.number);
        if (finite && key_.range.contains(value.number)) return value;
        const std::string allowed = finite ? key_.range.text() : "finite";
        const std::string unit = key_.has_fixed_unit() ? " " + std::string(key_.unit) : "";
        return error("out-of-range", " must be " + allowed + ", not " + shortest(value.number) + unit, value);
    }

    std::optional<Node> wrong(const Node& node) {
        return error("wrong-type", " must be " + describe(key_, unit_) + ", not " + type_name(node), node,
                     std::string(key_.doc));
    }

    std::optional<Node> error(const std::string& code, const std::string& text, const Node& at,
                              const std::string& note = {}, const std::string& hint = {}) {
        findings_.error(code, "`" + path_ + "`" + text, at, note, hint);
        return std::nullopt;
    }

    Findings& findings_;
    const Key& key_;
    const std::string& path_;
    std::string_view unit_;
};

/// Unit of a number of a [[study.quantity]]: that of a time, or of the quantity.
std::string_view unit_of_quantity(const Key& key, const Node& table) {
    if (table.find("reaches") && key.name() != "reaches") return "s";
    const Node* of = table.find("of");
    if (!of) return "";
    if (table.find("slope")) return unit_of_slope(of->text);
    const bool from_history = table.find("at") || table.find("reaches") || table.find("largest");
    const bool in_summary = find_output("summary", of->text) && !from_history;
    return in_summary ? unit_of("summary", of->text) : unit_of_column(of->text);
}

/// The unit of plain numbers of a key, also if it depends on a neighbour or on the name of the table.
std::string_view unit_of_key(const Key& key, const Node& table) {
    if (key.unit != "*") return key.unit;
    if (key.path.starts_with("expect.")) return unit_of("summary", table.name);
    if (key.path.starts_with("study.")) return unit_of_quantity(key, table);
    if (key.path.starts_with("sweep.")) {
        const Node* of = table.find("key");
        const Key* varied = of ? key_at(of->text) : nullptr;
        return varied && varied->has_fixed_unit() ? varied->unit : "";
    }
    const Node *show = table.find("show"), *colour = table.find("colour");
    const FigureOptions usual;
    if (key.path == "figure[].measured") return shows_body(show ? show->text : usual.show) ? "m" : "";
    return unit_of_figure(show ? show->text : usual.show, colour ? colour->text : usual.colour);
}

enum class Applies { no, perhaps, yes };

/// The text of the neighbour of a key with a condition, given or by default; "" if it has none.
std::string text_of_neighbour(const Key& key, const Node& table) {
    if (const Node* given = table.find(key.condition.neighbour)) return given->text;
    const Key& neighbour = *find_key(joined_path(key.parent(), key.condition.neighbour));
    return neighbour.default_toml.empty() ? "" : parse_toml_value(neighbour.default_toml).text;
}

/// The condition of a key, checked against its neighbours. With a missing or wrong neighbour it is undecided.
Applies applies(const Key& key, const Node& table) {
    const Condition& condition = key.condition;
    if (condition.values.empty()) return Applies::yes;
    const std::string text = text_of_neighbour(key, table);
    const auto is_one_of = [&](const auto& texts) { return std::ranges::count(texts, text) > 0; };
    if (!is_one_of(find_key(joined_path(key.parent(), condition.neighbour))->words)) return Applies::perhaps;
    return is_one_of(condition.values) ? Applies::yes : Applies::no;
}

/// Walks over the tree of a file along the key table and builds the tree of values.
class Resolver {
public:
    explicit Resolver(Findings& findings) : findings_(findings) {}

    /// Fills the table `found` with the keys of `given` and with defaults.
    void members(Node& found, const Node& given, std::string_view pattern, const std::string& path) {
        report_unknown(found, given, pattern, path);
        for (const Key* key : keys_below(pattern)) {
            if (found.find(key->name())) continue;  // misspelt: reported, and counted as given
            Node child{.name = std::string(key->name()), .key = key};
            const Node* node = given.find(child.name);
            const std::string here = joined_path(path, child.name);
            const Applies fits = applies(*key, given);
            if (node && fits == Applies::no) report_excluded(*key, *node, given, here);
            else if (node) present(child, *node, given, here), found.children.push_back(std::move(child));
            else if (fits == Applies::yes && absent(child, given, here)) found.children.push_back(std::move(child));
        }
    }

private:
    void report_excluded(const Key& key, const Node& node, const Node& table, const std::string& path) {
        const std::string neighbour(key.condition.neighbour), value = text_of_neighbour(key, table);
        std::vector<std::string> instead;  // keys that this value has in place of this one
        for (const Key* other : keys_below(key.parent()))
            if (other->condition.neighbour == neighbour && std::ranges::count(other->condition.values, value) > 0 &&
                !table.find(other->name()))
                instead.push_back("`" + std::string(other->name()) + "`");
        findings_.error(
            "exclusive-keys",
            "`" + path + "` belongs to " + neighbour + " = \"" + joined(key.condition.values, "\" or \"") + "\"", node,
            "here " + neighbour + " = " + in_quotes(value) + (table.find(neighbour) ? "" : ", its default") +
                (instead.empty() ? "" : ", which has " + joined(instead)));
    }

    /// Returns the key that was meant; null where none is like it, or where nobody reads so many hints.
    const std::string* report_unknown_key(const Node& node, const std::string& path,
                                          const std::vector<std::string>& known) {
        const std::string* meant = ++n_unknown_ > max_hints ? nullptr : nearest(node.name, known);
        std::string hint = meant ? "did you mean `" + *meant + "`?" : "";
        for (const Key& key : keys().first(n_unknown_ > max_hints ? 0 : keys().size()))
            if (hint.empty() && key.name() == node.name && !key.parent().empty()) hint = "there is `" + key.path + "`";
        findings_.error("unknown-key", "`" + path + "` is not a key of a scenario", node, "keys here: " + joined(known),
                        hint);
        return meant;
    }

    void report_unknown(Node& found, const Node& given, std::string_view pattern, const std::string& path) {
        std::vector<std::string> known;
        for (const Key* key : keys_below(pattern))
            if (applies(*key, given) != Applies::no || !given.find(key->condition.neighbour))  // given: not by default
                known.emplace_back(key->name());
        for (const Node& child : given.children) {
            if (std::ranges::count(keys_below(pattern), child.name, &Key::name) > 0) continue;
            const std::string* meant = report_unknown_key(child, joined_path(path, child.name), known);
            // the key that was meant is present and invalid, so that it is not reported as missing, too
            if (meant && !given.find(*meant)) {
                const auto key = std::ranges::find(keys_below(pattern), *meant, &Key::name);
                found.children.push_back({.name = *meant, .key = *key, .valid = false});
            }
        }
    }

    /// Gives an absent key its default; false if it has none.
    bool absent(Node& child, const Node& table, const std::string& path) {
        const Key& key = *child.key;
        const auto needed = [](const Key* k) { return k->is_required && k->condition.values.empty(); };
        child.origin = key.default_doc.empty() ? Origin::constant_default : Origin::computed_default;
        if (key.is_required) {
            const bool at_top = table.place.line == 0 || path.find('.') == std::string::npos;
            findings_.error("missing-key", "`" + path + "` is missing", at_top && table.set_by.empty() ? Node{} : table,
                            std::string(key.name()) + ": " + std::string(key.doc) +
                                (key.kind == Kind::table ? "" : "; " + describe(key, key.unit)));
            return false;
        }
        if (key.kind == Kind::table) {  // one with required keys is an option
            const bool optional = std::ranges::any_of(keys_below(key.path), needed);
            if (!optional) members(child, Node{}, key.path, path);
            return !optional;
        }
        child.valid = key.default_doc.empty();
        if (!key.default_toml.empty())
            assign(child, *ValueCheck(findings_, key, path, key.unit).checked(parse_toml_value(key.default_toml)));
        return !key.default_toml.empty() || !key.default_doc.empty();
    }

    void present(Node& child, const Node& node, const Node& table, const std::string& path) {
        const Key& key = *child.key;
        child.take_place(node);
        child.origin = origin_of(node);
        if (key.kind == Kind::table) return present_table(child, node, path);
        if (key.kind == Kind::list) return present_list(child, node, path);
        if (key.kind == Kind::names) return present_names(child, node, path);
        auto value = ValueCheck(findings_, key, path, unit_of_key(key, table)).checked(node);
        child.valid = value.has_value();
        if (value) assign(child, std::move(*value));
    }

    void wrong_type(Node& child, const Node& node, const std::string& path, const char* form, const std::string& note) {
        findings_.error("wrong-type", "`" + path + "` must be " + form + ", not " + type_name(node), node, note);
        child.valid = false;
    }

    void present_table(Node& child, const Node& node, const std::string& path) {
        const Key& key = *child.key;
        if (node.type == Node::Type::text && !key.text_key.empty()) {
            Node table{.children = {node}};
            table.take_place(node);
            table.children[0].name = std::string(key.text_key);
            return members(child, table, key.path, path);
        }
        if (node.type == Node::Type::table) members(child, node, key.path, path);
        else if (key.path == "expect.*") wrong_type(child, node, path, "a table such as { at_least = 2 }", "");
        else wrong_type(child, node, path, key.text_key.empty() ? "a table" : "a text or a table", "");
    }

    /// Adds one table to a list or to a table of names.
    void add_entry(Node& child, const Key& row, const Node& node, const std::string& path) {
        Node& entry = child.children.emplace_back(Node{.key = &row, .origin = origin_of(node)});
        entry.take_place(node);
        present_table(entry, node, path);
    }

    void present_list(Node& child, const Node& node, const std::string& path) {
        const auto is_table = [](const Node& entry) { return entry.type == Node::Type::table; };
        if (node.type != Node::Type::array || !std::ranges::all_of(node.children, is_table))
            return wrong_type(child, node, path, "a list of tables", "write [[" + path + "]]");
        child.type = Node::Type::array;
        for (std::size_t i = 0; i < node.children.size(); ++i)
            add_entry(child, *child.key, node.children[i], item(path, i));
    }

    void present_names(Node& child, const Node& node, const std::string& path) {
        if (node.type != Node::Type::table)
            return wrong_type(child, node, path, "a table", "write [" + path + ".NAME]");
        const Key& row = *find_key(child.key->path + ".*");
        // [interface] with the keys of an [interface.NAME]
        child.valid = std::ranges::none_of(node.children, [&](const Node& entry) {
            return entry.type != Node::Type::table &&
                   std::ranges::count(keys_below(row.path), entry.name, &Key::name) > 0;
        });
        if (!child.valid)
            return findings_.error(
                "missing-name", "`[" + path + "]` has no name", node,
                "write [" + path + (path == "interface" ? ".default" : ".NAME") + "]: " + std::string(child.key->doc));
        for (const Node& entry : node.children) {
            const std::string here = joined_path(path, entry.name);
            if (!row.words.empty() && !is_word(row.words, entry.name)) report_unknown_key(entry, here, row.words);
            else if (is_name(entry.name)) add_entry(child, row, entry, here);
            else findings_.error("bad-name", "`" + entry.name + "` cannot be a name here", entry, rule_for_names);
        }
    }

    static Origin origin_of(const Node& node) { return node.set_by.empty() ? Origin::file : Origin::command_line; }

    Findings& findings_;
    int n_unknown_ = 0;
    static constexpr int max_hints = 1000;  // searching what was meant takes 20 us
};

}  // namespace

void assign(Node& node, Node value) {
    value.take_place(node);
    value.key = node.key;
    value.origin = node.origin;
    node = std::move(value);
}

Node* Values::deepest(std::string_view path, bool placed) {
    static Node nowhere;
    Node *node = &root, *found = &nowhere;
    for (const PathPart& part : path_parts(path).value_or(std::vector<PathPart>())) {
        node = find_part(*node, part);
        if (!node) return placed ? found : nullptr;
        if (node->is_placed()) found = node;
    }
    return placed ? found : node;
}

void Values::set(std::string_view path, Node value) {
    if (Node* node = deepest(path, false)) assign(*node, std::move(value));
}

Values resolve(const Node& root, Findings& findings) {
    Values values;
    Resolver(findings).members(values.root, root, "", "");
    return values;
}

}  // namespace knap
