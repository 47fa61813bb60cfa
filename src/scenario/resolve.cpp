#include "scenario/resolve.hpp"

#include "figures/figures.hpp"
#include "record/outputs.hpp"
#include "scenario/check_value.hpp"

#include <algorithm>
#include <cassert>
#include <set>

namespace knap {
namespace {

void forget_places(Node& node) {
    node.place = node.name_place = {};
    for (Node& child : node.children) forget_places(child);
}

std::string below(const std::string& path, std::string_view name) {
    return path.empty() ? std::string(name) : path + "." + std::string(name);
}

std::vector<std::string> in_quotes(std::vector<std::string> texts) {
    for (std::string& text : texts) text = knap::quoted(text);
    return texts;
}

/// Of what a [[study.quantity]] is compared with: a time, or as what it is made of.
std::string_view unit_of_quantity(const Key& key, const Node& table) {
    if (table.find("reaches") && key.name() != "reaches") return "s";
    const Node* of = table.find("of");
    if (!of) return "";
    if (table.find("slope")) return unit_of_slope(of->text);
    const bool from_history = table.find("at") || table.find("reaches") || table.find("largest");
    const bool in_summary = find_output("summary", of->text) && !from_history;
    return in_summary ? unit_of("summary", of->text) : unit_of_column(of->text);
}

/// The unit of a key's plain numbers, also where it depends on a neighbour or on a name.
std::string_view unit_of_key(const Key& key, const Node& table, const std::string& path) {
    if (key.unit != "*") return key.unit;
    if (path.starts_with("expect.")) return unit_of("summary", path.substr(7, path.rfind('.') - 7));
    if (path.starts_with("study.")) return unit_of_quantity(key, table);
    const Node *show = table.find("show"), *colour = table.find("colour");
    return unit_of_figure(show ? show->text : "cracks", colour ? colour->text : "opening");
}

enum class Applies { no, perhaps, yes };

/// The condition of a key, held against its neighbours. Beside a missing or wrong neighbour it may apply.
Applies applies(const Key& key, const Node& table) {
    const Condition& condition = key.condition;
    if (condition.values.empty()) return Applies::yes;
    const Node* neighbour = table.find(condition.neighbour);
    if (!neighbour) return Applies::perhaps;
    const auto is_one_of = [&](const std::vector<std::string>& texts) {
        return std::ranges::count(texts, neighbour->text) > 0;
    };
    if (!is_one_of(find_key(below(std::string(key.parent()), condition.neighbour))->words)) return Applies::perhaps;
    return is_one_of(condition.values) ? Applies::yes : Applies::no;
}

std::string own_table_of(const std::string& name) {
    for (const Key& key : keys())
        if (key.name() == name && !key.parent().empty()) return "there is `" + key.path + "`";
    return "";
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
    void add(const Key& key, const std::string& path, Node node, bool valid) {
        const Origin origin = node.set_by.empty() ? Origin::file : Origin::set;
        values.add({path, &key, std::move(node), origin, valid});
    }

    void add_table(const Key& key, const std::string& path, const Node& table) {
        Node place;
        place.take_place(table);
        add(key, path, std::move(place), true);
    }

    Diagnostic& unknown_key(const Node& node, const std::string& path, const std::vector<std::string>& known) {
        Diagnostic& d = findings_.error_at_name("unknown-key", "`" + path + "` is not a key of a scenario", node);
        d.hint = did_you_mean(node.name, known);
        d.note = "known here: " + joined(known);
        return d;
    }

    void report_unknown(const Node& table, std::string_view pattern, const std::string& path) {
        const auto rows = keys_below(pattern);
        std::vector<std::string> known;
        for (const Key* key : rows)
            if (applies(*key, table) != Applies::no) known.emplace_back(key->name());
        for (const Node& child : table.children) {
            if (std::ranges::any_of(rows, [&](const Key* key) { return key->name() == child.name; })) continue;
            Diagnostic& d = unknown_key(child, below(path, child.name), known);
            if (d.hint.empty()) d.hint = own_table_of(child.name);
            // the key that was meant counts as given, so that it is not reported as missing too
            if (const std::string* meant = nearest(child.name, known); meant && !table.find(*meant)) {
                const std::string meant_path = below(path, *meant);
                misspelt_.insert(meant_path);
                if (const Key* key = find_key(pattern_of(meant_path))) add(*key, meant_path, {}, false);
            }
        }
    }

    void member(const Key& key, const Node& table, const std::string& path) {
        const Node* node = table.find(key.name());
        const std::string here = below(path, key.name());
        const Applies fits = applies(key, table);
        if (node && fits == Applies::no) {
            const std::string neighbour(key.condition.neighbour), all = joined(in_quotes(key.condition.values), " or ");
            findings_.error_at_name("exclusive-keys", "`" + here + "` belongs to " + neighbour + " = " + all, *node)
                .note = "here " + neighbour + " = " + quoted(table.find(neighbour)->text);
        } else if (node) {
            present(key, *node, table, here);
        } else if (fits == Applies::yes && !misspelt_.contains(here)) {
            absent(key, table, here);
        }
    }

    void absent(const Key& key, const Node& table, const std::string& path) {
        if (key.is_required) {
            Diagnostic& d = findings_.error("missing-key", "`" + path + "` is missing", table);
            if (table.place.line == 0 || path.find('.') == std::string::npos)
                d = {.code = d.code, .message = d.message, .file = d.file};
            d.note = std::string(key.name()) + ": " + std::string(key.doc) +
                     (key.kind == Kind::table ? "" : "; " + describe(key));
        } else if (key.kind == Kind::table) {
            // a table that needs something in it is there for a choice; of others the defaults count
            const auto needed = [](const Key* k) { return k->is_required && k->condition.values.empty(); };
            if (std::ranges::none_of(keys_below(key.path), needed)) members(Node{}, key.path, path);
        } else if (!key.default_toml.empty()) {
            std::optional<Node> value = check_value(findings_, key, parse_toml_value(key.default_toml), path, key.unit);
            assert(value);  // a default that the table itself refuses
            forget_places(*value);
            values.add({path, &key, std::move(*value), Origin::standard});
        } else if (!key.default_doc.empty()) {
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
        std::optional<Node> value = check_value(findings_, key, node, path, unit_of_key(key, table, path));
        Node kept = value ? *value : Node{};
        kept.take_place(node);
        add(key, path, std::move(kept), value.has_value());
    }

    void present_table(const Key& key, const Node& node, const std::string& path) {
        if (node.type == Node::Type::text && !key.text_key.empty()) {
            Node table{.children = {node}};
            table.take_place(node);
            table.children[0].name = std::string(key.text_key);
            return present_table(key, table, path);
        }
        if (node.type != Node::Type::table) {
            const std::string form = key.text_key.empty() ? "a table" : "a text or a table";
            findings_.error("wrong-type", "`" + path + "` must be " + form + ", not " + type_name(node), node);
            return add(key, path, node, false);
        }
        add_table(key, path, node);
        members(node, key.path, path);
    }

    void present_list(const Key& key, const Node& node, const std::string& path) {
        const auto is_table = [](const Node& child) { return child.type == Node::Type::table; };
        if (node.type != Node::Type::array || !std::ranges::all_of(node.children, is_table)) {
            findings_.error("wrong-type", "`" + path + "` must be a list of tables, not " + type_name(node), node)
                .note = "write [[" + path + "]]";
            return;
        }
        for (std::size_t i = 0; i < node.children.size(); ++i) present_table(key, node.children[i], item(path, i));
    }

    /// [interface] with the keys of an [interface.NAME].
    static bool lacks_name(const Key& row, const Node& node) {
        const auto rows = keys_below(row.path);
        return std::ranges::any_of(node.children, [&](const Node& child) {
            const auto is_it = [&](const Key* key) { return key->name() == child.name; };
            return child.type != Node::Type::table && std::ranges::any_of(rows, is_it);
        });
    }

    void present_names(const Key& key, const Node& node, const std::string& path) {
        if (node.type != Node::Type::table) {
            findings_.error("wrong-type", "`" + path + "` must be a table, not " + type_name(node), node).note =
                "write [" + path + ".NAME]";
            return;
        }
        const Key& row = *find_key(key.path + ".*");
        if (lacks_name(row, node)) {
            const std::string name = key.path == "interface" ? "default" : "NAME";
            findings_.error_at_name("missing-name", "`[" + path + "]` has no name", node).note =
                "write [" + path + "." + name + "]: " + std::string(key.doc);
            return add(key, path, node, false);
        }
        add_table(key, path, node);
        for (const Node& child : node.children) {
            const std::string here = below(path, child.name);
            if (!row.words.empty() && !is_word(row.words, child.name)) {
                unknown_key(child, here, row.words);
            } else if (!is_name(child.name)) {
                findings_.error_at_name("bad-name", "`" + child.name + "` cannot be a name here", child).note =
                    rule_for_names;
            } else {
                present_table(row, child, here);
            }
        }
    }

    Findings& findings_;
    std::set<std::string> misspelt_;
};

}  // namespace

Values resolve(const Node& root, Findings& findings) {
    Resolver resolver(findings);
    resolver.members(root, "", "");
    return std::move(resolver.values);
}

}  // namespace knap
