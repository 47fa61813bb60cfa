#include "scenario/resolve.hpp"

#include <algorithm>
#include <cassert>
#include <set>

#include "observe/outputs.hpp"
#include "observe/figures.hpp"
#include "scenario/check_value.hpp"
#include "scenario/names.hpp"
#include "scenario/toml_tree.hpp"

namespace knap {
namespace {

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
        const auto values = alternatives(key.when.substr(equals + 1));
        return std::find(values.begin(), values.end(), neighbour->text) != values.end() ? Applies::yes : Applies::no;
    }

    /// "a or b" -> a, b
    static std::vector<std::string> alternatives(std::string_view text) {
        std::vector<std::string> values;
        constexpr std::string_view between = " or ";
        for (std::size_t at = text.find(between); at != std::string_view::npos; at = text.find(between)) {
            values.emplace_back(text.substr(0, at));
            text.remove_prefix(at + between.size());
        }
        values.emplace_back(text);
        return values;
    }

    void member(const Key& key, const Node& table, const std::string& path) {
        const Node* node = table.find(key.name());
        const std::string here = below(path, key.name());
        if (node && applies(key, table) == Applies::no) {
            const std::string when(key.when);
            const std::size_t equals = when.find('=');
            std::vector<std::string> values = alternatives(std::string_view(when).substr(equals + 1));
            for (std::string& value : values) value = knap::quoted(value);
            findings_.error_at_name("exclusive-keys", "`" + here + "` belongs to " + when.substr(0, equals) + " = " + joined(values, " or "), *node)
                .note = "here " + when.substr(0, equals) + " = " + knap::quoted(table.find(when.substr(0, equals))->text);
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
            d.note = std::string(key.name()) + ": " + std::string(key.doc) + (key.kind == Kind::table ? "" : "; " + describe(key));
        } else if (key.kind == Kind::table) {
            // a table that needs something in it is there for a choice; of others the defaults count
            const auto rows = keys_below(key.path);
            if (std::none_of(rows.begin(), rows.end(), [](const Key* k) { return k->required && k->when.empty(); })) members(Node{}, key.path, path);
        } else if (!key.standard.empty()) {
            std::optional<Node> value = check_value(findings_, key, value_of_text(key.standard), path, key.unit);
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
        std::optional<Node> value = check_value(findings_, key, node, path, unit_of(key, table, path));
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

    /// [interface] with the keys of an [interface.NAME].
    static bool lacks_name(const Key& row, const Node& node) {
        const auto rows = keys_below(row.path);
        return std::any_of(node.children.begin(), node.children.end(), [&](const Node& child) {
            return child.type != Node::Type::table && std::any_of(rows.begin(), rows.end(), [&](const Key* key) { return key->name() == child.name; });
        });
    }

    void present_names(const Key& key, const Node& node, const std::string& path) {
        if (node.type != Node::Type::table) {
            findings_.error("wrong-type", "`" + path + "` must be a table, not " + type_name(node), node).note = "write [" + path + ".NAME]";
            return;
        }
        const Key& row = *find_key(std::string(key.path) + ".*");
        if (lacks_name(row, node)) {
            const std::string name = key.path == "interface" ? "default" : "NAME";
            findings_.error_at_name("missing-name", "`[" + path + "]` has no name", node).note = "write [" + path + "." + name + "]: " + std::string(key.doc);
            return add(key, path, node, false);
        }
        add_table(key, path, node);
        for (const Node& child : node.children) {
            const std::string here = below(path, child.name);
            if (!row.words.empty() && !is_word(row.words, child.name)) {
                Diagnostic& d = findings_.error_at_name("unknown-key", "`" + here + "` is not a key of a scenario", child);
                d.hint = did_you_mean(child.name, row.words);
                d.note = "known here: " + joined(row.words);
            } else if (!is_name(child.name)) {
                findings_.error_at_name("bad-name", "`" + child.name + "` cannot be a name here", child).note = rule_for_names;
            } else {
                present_table(row, child, here);
            }
        }
    }

    /// The unit of a key's plain numbers, also where it depends on a neighbour or on a name.
    static std::string_view unit_of(const Key& key, const Node& table, const std::string& path) {
        if (key.unit != "*") return key.unit;
        if (path.starts_with("expect.")) return unit_of_summary(path.substr(7, path.rfind('.') - 7));
        if (path.starts_with("study.")) return unit_of_quantity(key, table);
        const Node *show = table.find("show"), *colour = table.find("colour");
        return unit_of_figure(show ? show->text : "cracks", colour ? colour->text : "opening");
    }

    static std::string_view unit_of_summary(std::string_view name) {
        return knap::unit_of("summary", name);
    }

    /// Of what a [[study.quantity]] is compared with: a time, or as what it is made of.
    static std::string_view unit_of_quantity(const Key& key, const Node& table) {
        if (table.find("reaches") && key.name() != "reaches") return "s";
        const Node* of = table.find("of");
        if (!of) return "";
        if (table.find("slope")) return unit_of_slope(of->text);
        const bool in_summary = find_output("summary", of->text) != nullptr;
        const bool from_history = table.find("at") || table.find("reaches") || table.find("largest");
        return in_summary && !from_history ? unit_of_summary(of->text) : unit_of_column(of->text);
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
