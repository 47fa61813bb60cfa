#pragma once
// What a scenario file says, as a tree that remembers where everything stood. The TOML library does not reach beyond it.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

/// A stretch of one line of the source text; columns count characters from 1. Line 0: nowhere.
struct Place {
    int line = 0, column = 0;
    int length = 0;
};

struct Node {
    enum class Type { table, array, text, integer, number, boolean, date };
    Type type = Type::table;
    std::string name;             // of a table's member
    Place name_place;             // where that name stands
    Place place;                  // of the value; of a table: its header
    std::string text;             // type text
    double number = 0;            // types number and integer
    std::int64_t integer = 0;     // type integer
    bool boolean = false;         // type boolean
    std::string unit;             // after resolving: "cR", "CFL" or "%" when the number is not in SI
    std::string set_by;           // "--set KEY=VALUE" when it came from there
    std::vector<Node> children;   // of an array, or of a table in the order of the file

    bool is_number() const { return type == Type::number || type == Type::integer; }
    const Node* find(std::string_view member) const {
        for (const Node& child : children)
            if (child.name == member) return &child;
        return nullptr;
    }
    Node* find(std::string_view member) { return const_cast<Node*>(static_cast<const Node*>(this)->find(member)); }

    static Node of_text(std::string value) { return {.type = Type::text, .text = std::move(value)}; }
    static Node of_number(double value) { return {.type = Type::number, .number = value}; }
    static Node of_boolean(bool value) { return {.type = Type::boolean, .boolean = value}; }
};

}  // namespace knap
