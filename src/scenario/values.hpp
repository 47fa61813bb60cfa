#pragma once
// The values of all keys of one scenario: a tree of nodes in SI, with defaults and origins.
#include "scenario/toml_tree.hpp"

namespace knap {

class Values {
public:
    Node root;

    /// The node of a key or a table, valid or not; null if there is none.
    const Node* find(std::string_view path) const { return const_cast<Values*>(this)->deepest(path, false); }
    /// The node at which a message about `path` is placed: itself, or the nearest table above it that has a place.
    const Node& place_of(std::string_view path) const { return *const_cast<Values*>(this)->deepest(path, true); }
    /// Whether there is a valid value.
    bool has(std::string_view path) const {
        const Node* node = find(path);
        return node && node->valid;
    }
    template <class T>
    std::optional<T> get(std::string_view path) const {
        return has(path) ? value_as<T>(*find(path)) : std::nullopt;
    }
    /// Number of tables of a list [[path]].
    std::size_t count(std::string_view path) const {
        const Node* node = find(path);
        return node ? node->children.size() : 0;
    }
    /// Replaces a value, if there is such a key; place and origin stay.
    void set(std::string_view path, Node value);

private:
    Node* deepest(std::string_view path, bool placed);
};

/// Gives `node` the contents of `value`; name, place, row of the key table and origin stay.
void assign(Node& node, Node value);

}  // namespace knap
