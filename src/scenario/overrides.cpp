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

/// One override of a tree.
class Override {
public:
    Override(Node& root, const std::string& text, Findings& findings)
        : root_(root), here_{.set_by = "--set " + text}, findings_(findings) {}

    void apply(const std::string& text) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) return error("`" + text + "` is not KEY=VALUE");
        if (!is_utf8(text)) return error("this text is not UTF-8");
        const std::string path(trimmed(std::string_view(text).substr(0, equals)));
        const std::string value(trimmed(std::string_view(text).substr(equals + 1)));
        const auto parts = path_parts(path);
        if (value.empty()) remove(path, parts.value_or(std::vector<PathPart>()));
        else if (!parts) error("`" + path + "` is not a path of keys", "examples: mesh.size, load[0].traction");
        else set(path, *parts, value);
    }

private:
    void error(const std::string& message, const std::string& note = {}) {
        findings_.error("bad-override", message, here_, note);
    }

    /// Removes a key, which then has its default; a key that is absent must at least exist in the key table.
    void remove(const std::string& path, const std::vector<PathPart>& parts) {
        Node *parent = parts.empty() ? nullptr : &root_, *child = nullptr;
        for (std::size_t i = 0; i < parts.size() && parent; ++i) {
            child = find_part(*parent, parts[i]);
            if (i + 1 < parts.size()) parent = child;
        }
        if (parent && child) {
            if (parts.back().index) parent = parent->find(parts.back().name);
            parent->children.erase(parent->children.begin() + (child - parent->children.data()));
        } else if (const std::string pattern = pattern_of(path); !find_key(pattern) && !find_key(pattern + "[]")) {
            error("`" + path + "` cannot be left out: it is not a key of a scenario", "examples: mesh.size=, figure=");
        }
    }

    void set(const std::string& path, const std::vector<PathPart>& parts, const std::string& text) {
        if (parts.size() > max_key_parts)
            return error("the path has " + std::to_string(parts.size()) + " parts, more than " +
                         std::to_string(max_key_parts));
        Node* node = &root_;
        for (const PathPart& part : parts) {
            if (node->type != Node::Type::table)
                return error("`" + path + "`: there is no table above `" + part.name + "`");
            Node* child = node->find(part.name);
            if (!child) child = &node->children.emplace_back(Node{.name = part.name, .set_by = here_.set_by});
            node = find_part(*node, part);
            if (!node) {
                const std::size_t n = child->type == Node::Type::array ? child->children.size() : 0;
                return error("`" + path + "`: there is no `" + item(part.name, *part.index) + "`",
                             "the scenario has " + std::to_string(n) + ", counted from 0");
            }
        }
        Node value = parse_toml_value(text);
        if (value.name.empty() || value.type == Node::Type::date) value = Node::of_text(text);
        mark(value, here_.set_by);
        value.name = node->name;
        *node = std::move(value);
    }

    Node& root_;
    const Node here_;
    Findings& findings_;
};

}  // namespace

void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings) {
    for (const std::string& text : overrides) Override(root, text, findings).apply(text);
}

}  // namespace knap
