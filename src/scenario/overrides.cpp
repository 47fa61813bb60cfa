// KEY=VALUE of the command line's --set.
#include "scenario/keys.hpp"
#include "scenario/resolve.hpp"

namespace knap {
namespace {

void mark(Node& node, const std::string& set_by) {
    node.set_by = set_by;
    node.place = node.name_place = {};
    for (Node& child : node.children) mark(child, set_by);
}

/// Removes a key, which then has its default. False if the tree has no such key.
bool remove(Node& root, const std::vector<PathPart>& parts) {
    Node *parent = nullptr, *child = &root;
    for (const PathPart& part : parts) {
        parent = child;
        child = find_part(*parent, part);
        if (!child) return false;
        if (part.index) parent = parent->find(part.name);
    }
    if (parent) parent->children.erase(parent->children.begin() + (child - parent->children.data()));
    return parent;
}

/// "named: boulder, slab"
std::string names_in(const Node& list) {
    std::vector<std::string> names;
    for (const Node& entry : list.children)
        if (const Node* name = entry.find("name")) names.push_back(name->text);
    return names.empty() ? "it has no names; [0] is its first entry" : "named: " + joined(names);
}

/// Applies one KEY=VALUE. `error` takes a message and a note.
void apply(Node& root, const std::string& text, const auto& error) {
    const std::string set_by = "--set " + text;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) return error("`" + text + "` is not KEY=VALUE", "");
    if (!is_utf8(text)) return error("this text is not UTF-8", "");
    const std::string path(trimmed(std::string_view(text).substr(0, equals)));
    const std::string value(trimmed(std::string_view(text).substr(equals + 1)));
    const auto parts = path_parts(path);
    if (value.empty()) {
        const bool removed = parts && remove(root, *parts);
        if (const std::string key = removed ? "" : pattern_of(path);
            !removed && !find_key(key) && !find_key(key + "[]"))
            error("`" + path + "` cannot be left out: it is not a key of a scenario", "examples: mesh.size=, figure=");
        return;
    }
    if (!parts) return error("`" + path + "` is not a path of keys", "examples: mesh.size, load[0].traction");
    if (parts->size() > max_key_parts)
        return error("the path has more than " + std::to_string(max_key_parts) + " parts", "");
    if (const std::string pair = pair_without_component(path); !pair.empty())
        return error("`" + path + "`: `" + pair + "` has the components x and y", "");
    Node* node = &root;
    for (const PathPart& part : *parts) {
        if (node->type == Node::Type::array) {
            Node* entry = find_part(*node, part);
            if (!entry) return error("`" + path + "`: there is no `" + part.name + "` in this list", names_in(*node));
            node = entry;
            continue;
        }
        if (node->type != Node::Type::table)
            return error("`" + path + "`: there is no table above `" + part.name + "`", "");
        if (const bool last = &part == &parts->back();
            last && (part.name == "x" || part.name == "y") && node->children.empty() && !node->set_by.empty())
            if (const Key* key = key_at(path); key && key->form == Form::pair) {  // the other component is zero
                node->type = Node::Type::array;
                node->children = {Node::of_integer(0), Node::of_integer(0)};
                node = &node->children[part.name == "y"];
                continue;
            }
        const Node* list = node->find(part.name);
        if (!list) list = &node->children.emplace_back(Node{.name = part.name, .set_by = set_by});
        node = find_part(*node, part);
        if (!node) {
            const std::size_t n = list->type == Node::Type::array ? list->children.size() : 0;
            return error("`" + path + "`: there is no `" + item(part.name, *part.index) + "`",
                         "the scenario has " + std::to_string(n) + ", counted from 0");
        }
    }
    Node found = parse_toml_value(value);
    if (found.name.empty() || found.type == Node::Type::date) found = Node::of_text(value);
    mark(found, set_by);
    found.name = node->name;
    *node = std::move(found);
}

}  // namespace

void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings) {
    for (const std::string& text : overrides)
        apply(root, text, [&](const std::string& message, const std::string& note) {
            findings.error("bad-override", message, Node{.set_by = "--set " + text}, note);
        });
}

}  // namespace knap
