#pragma once
// A TOML text as a tree of nodes that know their place in the text. Only toml_tree.cpp uses the TOML library.
#include "mesh/polygon.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace knap {

struct Key;

/// A part of one line of the source text; columns count characters from 1. Line 0: no place.
struct Place {
    int line = 0, column = 0;
    int length = 0;
};

/// Where a value comes from. A computed default depends on other keys.
enum class Origin { file, command_line, constant_default, computed_default };

struct Node {
    enum class Type { table, array, text, integer, number, boolean, date };
    Type type = Type::table;
    std::string name;            // of a member of a table
    Place name_place;            // of that name
    Place place;                 // of the value; of a table: its header
    std::string text;            // type text
    double number = 0;           // types number and integer
    std::int64_t integer = 0;    // type integer
    bool boolean = false;        // type boolean
    std::string set_by;          // "--set KEY=VALUE" if the node comes from the command line
    std::vector<Node> children;  // of an array, or of a table in the order of the file

    // of a resolved scenario (resolve.hpp), whose numbers are in SI and whose tables are in the order of the key table
    const Key* key = nullptr;  // row of the key table
    std::string unit;          // "cR", "CFL" or "%" if the number is a multiple of that instead; "C" of temperatures
    bool is_kelvin = false;    // a temperature with the unit K
    Origin origin = Origin::file;
    bool valid = true;  // false: wrong and reported, or a computed default without a value (yet)

    bool is_number() const { return type == Type::number || type == Type::integer; }
    bool is_placed() const { return place.line > 0 || !set_by.empty(); }
    bool is_given() const { return origin == Origin::file || origin == Origin::command_line; }
    const Node* find(std::string_view member) const {
        for (const Node& child : children)
            if (child.name == member) return &child;
        return nullptr;
    }
    Node* find(std::string_view member) { return const_cast<Node*>(std::as_const(*this).find(member)); }
    /// Copies place and name of another node.
    void take_place(const Node& other) {
        name = other.name;
        name_place = other.name_place;
        place = other.place;
        set_by = other.set_by;
    }

    static Node of_text(std::string value) { return {.type = Type::text, .text = std::move(value)}; }
    static Node of_number(double value) { return {.type = Type::number, .number = value}; }
    static Node of_integer(int value) {
        return {.type = Type::integer, .number = static_cast<double>(value), .integer = value};
    }
    static Node of_boolean(bool value) { return {.type = Type::boolean, .boolean = value}; }
    static Node of_list(std::vector<Node> items) { return {.type = Type::array, .children = std::move(items)}; }
};

/// A node as a C++ value; none if it is of another type (a word in place of a number).
template <class T>
std::optional<T> value_as(const Node& node) {
    const auto number = [&](std::size_t i) { return node.children[i].number; };
    const auto only_if = [](bool good, auto&& value) { return good ? std::optional<T>(value()) : std::nullopt; };
    if constexpr (std::is_same_v<T, bool>) {
        return only_if(node.type == Node::Type::boolean, [&] { return node.boolean; });
    } else if constexpr (std::is_integral_v<T>) {
        return only_if(node.type == Node::Type::integer, [&] { return static_cast<T>(node.integer); });
    } else if constexpr (std::is_same_v<T, double>) {
        return only_if(node.is_number(), [&] { return node.number; });
    } else if constexpr (std::is_same_v<T, std::string>) {
        return only_if(node.type == Node::Type::text, [&] { return node.text; });
    } else if constexpr (std::is_same_v<T, Vec2>) {
        return only_if(node.children.size() == 2, [&] { return Vec2(number(0), number(1)); });
    } else if constexpr (std::is_same_v<T, Box>) {
        return only_if(node.children.size() == 4, [&] { return Box{{number(0), number(1)}, {number(2), number(3)}}; });
    } else if constexpr (requires { std::tuple_size<T>::value; }) {
        T values{};
        for (std::size_t i = 0; i < values.size() && i < node.children.size(); ++i) values[i] = number(i);
        return only_if(node.children.size() == values.size(), [&] { return values; });
    } else {
        T list;
        for (const Node& child : node.children)
            if (const auto value = value_as<typename T::value_type>(child)) list.push_back(*value);
        return list;
    }
}

/// One part of a path: "load[2]" of "load[2].on". Its index counts from 0.
struct PathPart {
    std::string name;
    std::optional<std::size_t> index;
};
/// The parts of a path; none if it is malformed.
std::optional<std::vector<PathPart>> path_parts(std::string_view path);
/// The node at a part below a table; below a list of tables that with this name ("boulder" of "body.boulder.velocity"),
/// below a pair its component x or y. Null if there is none.
Node* find_part(Node& above, const PathPart& part);

/// "load", 2 -> "load[2]"
inline std::string item(const std::string& list, std::size_t i) { return list + "[" + std::to_string(i) + "]"; }

/// Limit of the number of parts of a key (a.b.c has three), which bounds the recursion over a tree. Keys of a scenario
/// have at most five.
inline constexpr std::size_t max_key_parts = 16;

struct TomlError {
    std::string message;
    Place place;
};

/// Parses TOML text into `root`; returns the error, if any.
std::optional<TomlError> parse_toml(const std::string& text, Node& root);

/// The value in `x = TOML`; a table without members if that is not TOML.
Node parse_toml_value(std::string_view toml);

/// A value as TOML, numbers with the fewest digits that read back as the same double.
std::string toml_text(const Node& value);
/// A text in quotes, with escapes.
std::string toml_quoted(const std::string& text);

}  // namespace knap
