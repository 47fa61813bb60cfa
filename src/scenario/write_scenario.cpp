#include "scenario/write_scenario.hpp"

#include "scenario/built_in.hpp"
#include "scenario/keys.hpp"

#include <algorithm>

namespace knap {
namespace {

/// A name as TOML: in quotes if it has blanks or non-ASCII letters.
std::string key_text(const std::string& name) {
    const bool bare = std::ranges::all_of(name, [](char c) { return is_plain(c) && c != '.'; });
    return bare ? name : toml_quoted(name);
}

/// Small tables are written as { a = 1, b = 2 }.
bool is_inline(const Node& table) { return !table.key->text_key.empty() || table.key->path == "expect.*"; }

std::string assignment(const Node& node) {
    if (!node.key->is_table()) return node.name + " = " + toml_text(node);
    std::vector<std::string> members;
    for (const Node& member : node.children)
        if (member.valid) members.push_back(assignment(member));
    return node.name + " = { " + joined(members) + " }";
}

/// The keys of a table, then the tables below it. `path` is in TOML; an entry of a list has the header [[path]].
void write_table(const Node& table, const std::string& path, bool is_entry, std::string& out) {
    std::string keys, tables;
    for (const Node& node : table.children) {
        const std::string here = joined_path(path, key_text(node.name));
        if (!node.valid || (node.key->is_table() && node.children.empty() && !node.is_given())) continue;
        if (!node.key->is_table() || is_inline(node)) keys += assignment(node) + "\n";
        else if (node.type != Node::Type::array) write_table(node, here, false, tables);
        else
            for (const Node& entry : node.children) write_table(entry, here, true, tables);
    }
    const bool empty = tables.empty() && table.is_given();
    if (!path.empty() && (!keys.empty() || empty)) out += is_entry ? "\n[[" + path + "]]\n" : "\n[" + path + "]\n";
    out += keys + tables;
}

std::string origin(const Node& node, const Source& source) {
    switch (node.origin) {
        case Origin::file: return source.name() + ":" + std::to_string(node.place.line);
        case Origin::command_line: return node.set_by;
        case Origin::constant_default: return "default";
        case Origin::computed_default: return "default, " + std::string(node.key->default_doc);
    }
    return "";
}

bool has_own_unit(const Node& node) { return !node.unit.empty() || std::ranges::any_of(node.children, has_own_unit); }

struct Line {
    std::string key, value, origin;
};

void list_keys(const Node& node, const std::string& path, const Source& source, std::vector<Line>& lines) {
    for (std::size_t i = 0; i < node.children.size(); ++i) {
        const Node& child = node.children[i];
        const Key& key = *child.key;
        const std::string here = node.type == Node::Type::array ? item(path, i) : joined_path(path, child.name);
        if (key.is_table()) {
            list_keys(child, here, source, lines);
        } else if (!child.valid) {  // a default that is no value: "from the data"
            if (child.origin == Origin::computed_default) lines.push_back({here, "-", origin(child, source)});
        } else {
            const bool has_unit = key.has_fixed_unit() && child.type != Node::Type::text && !has_own_unit(child);
            const std::string unit = has_unit ? " " + std::string(key.unit) : "";
            lines.push_back({here, toml_text(child) + unit, origin(child, source)});
        }
    }
}

}  // namespace

std::string resolved_toml(const ReadResult& result) {
    std::string out;
    write_table(result.values.root, "", false, out);
    return out;
}

std::string full_listing(const ReadResult& result) {
    std::vector<Line> lines;
    list_keys(result.values.root, "", result.source, lines);
    std::size_t key_width = 0, value_width = 0;
    for (const Line& line : lines) {
        key_width = std::max(key_width, line.key.size());
        value_width = std::max(value_width, std::min<std::size_t>(line.value.size(), 40));
    }
    std::string out;
    for (Line& line : lines) {
        line.key.resize(std::max(line.key.size(), key_width), ' ');
        line.value.resize(std::max(line.value.size(), value_width), ' ');
        out += line.key + "  " + line.value + "  " + line.origin + "\n";
    }
    return out;
}

std::string new_scenario(const std::string& name) {
    std::string text = scenario_template();
    return text.replace(text.find("NAME"), 4, name);
}

std::string renamed(const BuiltIn& scenario, const std::string& name) {
    std::string text = scenario.text;
    const std::size_t at = text.find("\nname ") + 1, first = text.find('"', at) + 1;
    return text.replace(first, text.find('"', first) - first, name);
}

std::string question(const BuiltIn& scenario) {
    return std::string(trimmed(std::string_view(scenario.text).substr(1, scenario.text.find('\n') - 1)));
}

}  // namespace knap
