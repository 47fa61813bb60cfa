#pragma once
// A TOML text as a tree that knows where everything stands in the text. Nothing beyond this file sees the TOML library.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace knap {

/// A part of one line of the source text; columns count characters from 1. Line 0: nowhere.
struct Place {
    int line = 0, column = 0;
    int length = 0;
};

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
    std::string unit;            // after resolving: "cR", "CFL" or "%" where the number is not in SI
    std::string set_by;          // "--set KEY=VALUE" where the node comes from the command line
    std::vector<Node> children;  // of an array, or of a table in the order of the file

    bool is_number() const { return type == Type::number || type == Type::integer; }
    bool is_placed() const { return place.line > 0 || !set_by.empty(); }
    const Node* find(std::string_view member) const {
        for (const Node& child : children)
            if (child.name == member) return &child;
        return nullptr;
    }
    Node* find(std::string_view member) { return const_cast<Node*>(std::as_const(*this).find(member)); }
    /// Takes over where another node stands.
    void take_place(const Node& other) {
        name_place = other.name_place;
        place = other.place;
        set_by = other.set_by;
    }

    static Node of_text(std::string value) { return {.type = Type::text, .text = std::move(value)}; }
    static Node of_number(double value) { return {.type = Type::number, .number = value}; }
    static Node of_boolean(bool value) { return {.type = Type::boolean, .boolean = value}; }
    static Node of_list(std::vector<Node> items) { return {.type = Type::array, .children = std::move(items)}; }
};

/// No key of a scenario has nearly as many parts (a.b.c has three). It bounds the recursion over a tree.
inline constexpr std::size_t max_key_parts = 16;

struct TomlError {
    std::string message;
    Place place;
};

/// Parses TOML text into `root`; returns what is wrong, if anything.
std::optional<TomlError> parse_toml(const std::string& text, Node& root);

/// The value in `x = TOML`; a table without members where that is no TOML.
Node parse_toml_value(std::string_view toml);

/// A value as TOML, numbers with the fewest digits that read back as the same double.
std::string toml_text(const Node& value);
/// A text in quotes, with escapes.
std::string toml_quoted(const std::string& text);

}  // namespace knap
