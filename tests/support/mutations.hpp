#pragma once
// Mistakes in a scenario: every key deleted, empty, with a wrong unit, of a wrong type.
#include "base/error.hpp"
#include "scenario/keys.hpp"
#include "scenario/read_scenario.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace knap::tests {

struct Mutation {
    std::string path, value;  // value empty: deleted
    Place place;              // of a value in one line, which is replaced in the text; else the command line does it
};

/// Of a value, of the entries at the ends of a list, and of all that is in them.
inline void add_mutations(const Node& node, const std::string& path, std::vector<Mutation>& found) {
    const auto add = [&](const std::string& value, const Place& place = {}) { found.push_back({path, value, place}); };
    add("");
    if (node.type == Node::Type::table || node.type == Node::Type::array) {
        for (const char* value : {"{}", "[]", "true", "\"1 mmm\"", "[\"1 mmm\", \"1 mmm\"]"}) add(value);
        for (std::size_t i = 0; i < node.children.size(); ++i) {
            const bool in_list = node.type == Node::Type::array;
            if (in_list && i > 0 && i + 1 < node.children.size()) continue;
            add_mutations(node.children[i], in_list ? item(path, i) : joined_path(path, node.children[i].name), found);
        }
        return;
    }
    for (const char* value : {"\"\"", "\"1 mmm\"", "true", "[]", "0", "-1"}) add(value, node.place);
}

inline std::vector<Mutation> mutations_of(const std::string& text) {
    Node root;
    parse_toml(text, root);
    std::vector<Mutation> found;
    for (const Node& child : root.children) add_mutations(child, child.name, found);
    return found;
}

inline std::string mutated(std::string text, const Mutation& mutation) {
    std::size_t begin = 0;
    for (int line = 1; line < mutation.place.line; ++line) begin = text.find('\n', begin) + 1;
    const auto advance = [&](std::size_t at, int n) {  // characters
        while (n-- > 0 && at < text.size())
            for (++at; at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;) ++at;
        return at;
    };
    begin = advance(begin, mutation.place.column - 1);
    return text.replace(begin, advance(begin, mutation.place.length) - begin, mutation.value);
}

/// Reads a scenario with a mistake; files that it names are in `directory`.
inline ReadResult read_mutated(const std::string& text, const Mutation& mutation,
                               const std::filesystem::path& directory) {
    const bool in_text = mutation.place.line > 0;
    std::vector<std::string> overrides;
    if (!in_text) overrides = {mutation.path + "=" + mutation.value};
    return read_scenario_text(in_text ? mutated(text, mutation) : text, "mutated.toml", overrides, directory);
}

/// Whether a mistake is shown at a place of the scenario, or is a key that is not there.
inline bool has_place(const UserError& error, const Mutation& mutation) {
    return std::ranges::any_of(error.diagnostics, [&](const Diagnostic& d) {
        return d.line > 0 || d.file.starts_with("--set") || (mutation.value.empty() && d.code == "missing-key");
    });
}

}  // namespace knap::tests
