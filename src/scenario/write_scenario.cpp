#include "scenario/write_scenario.hpp"

#include "scenario/built_in.hpp"

#include <algorithm>

namespace knap {
namespace {

std::string last_part(const std::string& path) { return path.substr(path.rfind('.') + 1); }

std::string parent(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    return dot == std::string::npos ? "" : path.substr(0, dot);
}

/// As TOML has it: in quotes where it has blanks or letters that are not those of English.
std::string key_text(const std::string& name) {
    const bool bare = std::ranges::all_of(name, [](char c) { return is_plain(c) && c != '.'; });
    return bare ? name : toml_quoted(name);
}

/// "domain.hole[1]" -> "[[domain.hole]]", "load[0].on" -> "[load.on]", "material.hard rock" -> "[material."hard rock"]"
std::string header(const std::string& path) {
    std::string plain;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        const std::string part = path.substr(begin, end - begin);
        plain += (plain.empty() ? "" : ".") + key_text(part.substr(0, part.find('[')));
        begin = end + 1;
    }
    return path.ends_with(']') ? "[[" + plain + "]]" : "[" + plain + "]";
}

/// Small tables are written as { a = 1, b = 2 }.
bool is_inline(const Key& key) { return !key.text_key.empty() || key.path == "expect.*"; }

std::string inline_table(const Values& values, const std::string& table) {
    std::vector<std::string> members;
    for (const Entry& entry : values.entries())
        if (entry.valid && parent(entry.path) == table)
            members.push_back(last_part(entry.path) + " = " + toml_text(entry.node));
    return "{ " + joined(members) + " }";
}

/// Keys that belong to `table` directly; then the tables below it, in order. Tables of which only defaults are known
/// have no entry of their own, so they are found by their keys.
void write_table(const Values& values, const std::string& table, std::string& out) {
    std::string keys;
    std::vector<std::string> tables;
    for (const Entry& entry : values.entries()) {
        if (!entry.valid) continue;
        const bool directly_below = parent(entry.path) == table;
        if (directly_below && !entry.key->is_table()) {
            keys += last_part(entry.path) + " = " + toml_text(entry.node) + "\n";
        } else if (directly_below && is_inline(*entry.key)) {
            keys += last_part(entry.path) + " = " + inline_table(values, entry.path) + "\n";
        } else if (table.empty() || entry.path.starts_with(table + ".")) {
            const std::string child = entry.path.substr(0, entry.path.find('.', table.empty() ? 0 : table.size() + 1));
            const Entry* row = values.find(child);
            const bool done =
                (row && is_inline(*row->key)) || std::find(tables.begin(), tables.end(), child) != tables.end();
            if (!done) tables.push_back(child);
        }
    }
    if (!table.empty() && (!keys.empty() || tables.empty())) out += "\n" + header(table) + "\n";
    out += keys;
    for (const std::string& child : tables) write_table(values, child, out);
}

std::string origin(const Entry& entry, const Source& source) {
    switch (entry.origin) {
        case Origin::file: return source.name() + ":" + std::to_string(entry.node.place.line);
        case Origin::set: return entry.node.set_by;
        case Origin::standard: return "default";
        case Origin::computed: return "default, " + std::string(entry.key->default_doc);
    }
    return "";
}

}  // namespace

std::string resolved_toml(const ReadResult& result) {
    std::string out;
    write_table(result.values, "", out);
    return out;
}

std::string full_listing(const ReadResult& result) {
    struct Line {
        std::string key, value, origin;
    };
    std::vector<Line> lines;
    std::size_t key_width = 0, value_width = 0;
    for (const Entry& entry : result.values.entries()) {
        if (!entry.key || entry.key->is_table() || (!entry.valid && entry.origin != Origin::computed)) continue;
        const bool unset = !entry.valid;  // a default that is no value: "from the data"
        std::string value = unset ? "-" : toml_text(entry.node);
        const Key& key = *entry.key;
        const bool has_unit = !unset && key.kind == Kind::number && !key.unit.empty() && key.unit != "*";
        if (has_unit && entry.node.type != Node::Type::text) value += " " + std::string(key.unit);
        key_width = std::max(key_width, entry.path.size());
        value_width = std::max(value_width, std::min<std::size_t>(value.size(), 40));
        lines.push_back({entry.path, value, origin(entry, result.source)});
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

}  // namespace knap
