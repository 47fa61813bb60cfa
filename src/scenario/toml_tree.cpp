// The only file that knows toml++.
#include "scenario/toml_tree.hpp"

#include "scenario/toml_depth.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <limits>

namespace knap {
namespace {

Place place_of(const toml::source_region& region) {
    Place place{.line = static_cast<int>(region.begin.line), .column = static_cast<int>(region.begin.column)};
    const bool one_line = region.begin.line == region.end.line && region.end.column > region.begin.column;
    // over several lines: marked to the end of the first (the source shortens it)
    place.length = one_line ? static_cast<int>(region.end.column - region.begin.column) : std::numeric_limits<int>::max();
    return place;
}

bool stands_before(const Node& a, const Node& b) {
    return a.name_place.line != b.name_place.line ? a.name_place.line < b.name_place.line : a.name_place.column < b.name_place.column;
}

Node node_of(const toml::node& value) {
    Node node{.place = place_of(value.source())};
    if (const toml::table* table = value.as_table()) {
        node.type = Node::Type::table;
        for (const auto& [key, member] : *table) {
            Node child = node_of(member);
            child.name = std::string(key.str());
            child.name_place = place_of(key.source());
            node.children.push_back(std::move(child));
        }
        std::stable_sort(node.children.begin(), node.children.end(), stands_before);  // the library sorts by name
    } else if (const toml::array* array = value.as_array()) {
        node.type = Node::Type::array;
        for (const toml::node& item : *array) node.children.push_back(node_of(item));
    } else if (const auto* text = value.as_string()) {
        node.type = Node::Type::text;
        node.text = text->get();
    } else if (const auto* integer = value.as_integer()) {
        node.type = Node::Type::integer;
        node.integer = integer->get();
        node.number = static_cast<double>(node.integer);
    } else if (const auto* number = value.as_floating_point()) {
        node.type = Node::Type::number;
        node.number = number->get();
    } else if (const auto* boolean = value.as_boolean()) {
        node.type = Node::Type::boolean;
        node.boolean = boolean->get();
    } else {
        node.type = Node::Type::date;
    }
    return node;
}

}  // namespace

std::optional<TomlError> parse_toml(const std::string& text, Node& root) {
    if (const std::optional<Place> place = too_deep(text))
        return TomlError{"keys and brackets go deeper than " + std::to_string(deepest_nesting) + " levels", *place};
    try {
        root = node_of(toml::parse(std::string_view(text)));
        return std::nullopt;
    } catch (const toml::parse_error& error) {
        Place place = place_of(error.source());
        place.length = 1;
        return TomlError{std::string(error.description()), place};
    }
}

}  // namespace knap
