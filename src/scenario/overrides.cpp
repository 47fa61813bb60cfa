// KEY=VALUE of the command line's --set.
#include "scenario/resolve.hpp"

#include <charconv>

namespace knap {
namespace {

void mark(Node& node, const std::string& set_by) {
    node.set_by = set_by;
    node.place = node.name_place = {};
    for (Node& child : node.children) mark(child, set_by);
}

Node value_of(const std::string& text) {
    const Node value = parse_toml_value(text);
    const bool is_toml = !value.name.empty() && value.type != Node::Type::date;
    return is_toml ? value : Node::of_text(text);
}

/// "load[2]" -> name "load", index 2
struct Part {
    std::string name;
    std::optional<std::size_t> index;
    bool good = false;
};

Part part_of(const std::string& text) {
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

Node* item_of(Node& list, std::size_t index) {
    return list.type == Node::Type::array && index < list.children.size() ? &list.children[index] : nullptr;
}

/// Takes a key out, so that it has its default again; a key that is not there must at least be one.
void leave_out(Node& root, const std::string& path, const Node& here, Findings& findings) {
    Node* table = &root;
    const std::vector<Part> parts = parts_of(path);
    for (std::size_t i = 0; i < parts.size() && table; ++i) {
        Node* list = parts[i].good ? table->find(parts[i].name) : nullptr;
        Node* child = list && parts[i].index ? item_of(*list, *parts[i].index) : list;
        if (child && i + 1 == parts.size()) {
            std::vector<Node>& from = parts[i].index ? list->children : table->children;
            from.erase(from.begin() + (child - from.data()));
            return;
        }
        table = child;
    }
    const std::string pattern = pattern_of(path);
    if (find_key(pattern) || find_key(pattern + "[]")) return;
    findings.error("bad-override", "`" + path + "` cannot be left out: it is not a key of a scenario", here).note =
        "write it like mesh.size= or figure=";
}

void set(Node& root, const std::string& path, const std::string& text, const Node& here, Findings& findings) {
    const auto refuse = [&](const std::string& message, const std::string& note = {}) {
        findings.error("bad-override", message, here).note = note;
    };
    Node* node = &root;
    const std::vector<Part> parts = parts_of(path);
    if (parts.size() > max_key_parts)
        return refuse("the path has " + std::to_string(parts.size()) + " keys in each other, more than " +
                      std::to_string(max_key_parts));
    for (const Part& part : parts) {
        if (!part.good)
            return refuse("`" + path + "` is not a path of keys", "write it like mesh.size or load[0].traction");
        if (node->type != Node::Type::table)
            return refuse("`" + path + "`: there is no table above `" + part.name + "`");
        Node* child = node->find(part.name);
        if (!child) child = &node->children.emplace_back(Node{.name = part.name, .set_by = here.set_by});
        Node* chosen = part.index ? item_of(*child, *part.index) : child;
        if (!chosen) {
            const std::size_t n = child->type == Node::Type::array ? child->children.size() : 0;
            return refuse("`" + path + "`: there is no `" + part.name + "[" + std::to_string(*part.index) + "]`",
                          "the scenario has " + std::to_string(n) + ", counted from 0");
        }
        node = chosen;
    }
    Node value = value_of(text);
    mark(value, here.set_by);
    value.name = node->name;
    *node = std::move(value);
}

}  // namespace

void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings) {
    for (const std::string& text : overrides) {
        const Node here{.set_by = "--set " + text};
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            findings.error("bad-override", "`" + text + "` is not KEY=VALUE", here);
        } else if (!is_utf8(text)) {
            findings.error("bad-override", "this is not text in UTF-8", here);
        } else {
            const std::string path(trimmed(std::string_view(text).substr(0, equals)));
            const std::string value(trimmed(std::string_view(text).substr(equals + 1)));
            if (value.empty()) leave_out(root, path, here, findings);
            else set(root, path, value, here, findings);
        }
    }
}

}  // namespace knap
