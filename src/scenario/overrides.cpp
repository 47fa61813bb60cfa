#include "scenario/overrides.hpp"

#include <charconv>
#include <optional>

#include "scenario/keys.hpp"
#include "scenario/toml_depth.hpp"
#include "scenario/toml_tree.hpp"

namespace knap {
namespace {

void mark(Node& node, const std::string& set_by) {
    node.set_by = set_by;
    node.place = node.name_place = {};
    for (Node& child : node.children) mark(child, set_by);
}

Node value_of(const std::string& text) {
    Node root;
    if (!parse_toml("x = " + text, root) && root.children.size() == 1 && root.children[0].type != Node::Type::date) return root.children[0];
    return Node::of_text(text);
}

/// "load[2]" -> name "load", index 2
struct Part {
    std::string name;
    std::optional<std::size_t> index;
    bool good = false;
};

Part part_of(std::string text) {
    Part part;
    const std::size_t bracket = text.find('[');
    part.name = text.substr(0, bracket);
    part.good = !part.name.empty();
    if (bracket == std::string::npos) return part;
    std::size_t index = 0;
    const char* end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data() + bracket + 1, end, index);
    part.good = part.good && error == std::errc() && last + 1 == end && *last == ']';
    part.index = index;
    return part;
}

std::vector<Part> parts_of(const std::string& path) {
    std::vector<Part> parts;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t dot = std::min(path.find('.', begin), path.size());
        parts.push_back(part_of(path.substr(begin, dot - begin)));
        begin = dot + 1;
    }
    return parts;
}

/// Takes a key out, so that it has its default again; a key that is not there must at least be one.
void leave_out(Node& root, const std::string& path, const std::string& set_by, Findings& findings) {
    const Node here{.set_by = set_by};
    Node* table = &root;
    const std::vector<Part> parts = parts_of(path);
    for (std::size_t i = 0; i < parts.size() && table; ++i) {
        Node* list = parts[i].good ? table->find(parts[i].name) : nullptr;
        Node* child = list;
        if (list && parts[i].index) child = list->type == Node::Type::array && *parts[i].index < list->children.size() ? &list->children[*parts[i].index] : nullptr;
        if (child && i + 1 == parts.size()) {
            std::vector<Node>& from = parts[i].index ? list->children : table->children;
            from.erase(from.begin() + (child - from.data()));
            return;
        }
        table = child;
    }
    const std::string pattern = pattern_of(path);
    const Key* known = find_key(pattern);
    if (!known) known = find_key(pattern + "[]");
    if (!known) findings.error("bad-override", "`" + path + "` cannot be left out: it is not a key of a scenario", here).note = "write it like mesh.size= or figure=";
}

void set(Node& root, const std::string& path, const std::string& text, const std::string& set_by, Findings& findings) {
    const Node here{.set_by = set_by};
    Node* node = &root;
    const std::vector<Part> parts = parts_of(path);
    if (parts.size() > deepest_nesting) {
        findings.error("bad-override", "the path has " + std::to_string(parts.size()) + " keys in each other, more than " + std::to_string(deepest_nesting), here);
        return;
    }
    for (const Part& part : parts) {
        if (!part.good) {
            findings.error("bad-override", "`" + path + "` is not a path of keys", here).note = "write it like mesh.size or load[0].traction";
            return;
        }
        if (node->type != Node::Type::table) {
            findings.error("bad-override", "`" + path + "`: there is no table above `" + part.name + "`", here);
            return;
        }
        Node* child = node->find(part.name);
        if (!child) {
            node->children.push_back({.name = part.name, .set_by = set_by});
            child = &node->children.back();
        }
        if (part.index && (child->type != Node::Type::array || *part.index >= child->children.size())) {
            const std::size_t n = child->type == Node::Type::array ? child->children.size() : 0;
            findings.error("bad-override", "`" + path + "`: there is no `" + part.name + "[" + std::to_string(*part.index) + "]`", here).note =
                "the scenario has " + std::to_string(n) + ", counted from 0";
            return;
        }
        node = part.index ? &child->children[*part.index] : child;
    }
    Node value = value_of(text);
    mark(value, set_by);
    value.name = node->name;
    *node = std::move(value);
}

}  // namespace

void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings) {
    for (const std::string& text : overrides) {
        const std::string set_by = "--set " + text;
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0)
            findings.error("bad-override", "`" + text + "` is not KEY=VALUE", Node{.set_by = set_by});
        else if (!is_utf8(text))
            findings.error("bad-override", "this is not text in UTF-8", Node{.set_by = set_by});
        else if (const std::string path(trimmed(std::string_view(text).substr(0, equals))), value(trimmed(std::string_view(text).substr(equals + 1))); value.empty())
            leave_out(root, path, set_by, findings);
        else
            set(root, path, value, set_by, findings);
    }
}

}  // namespace knap
