#pragma once
// The key table: every key that a scenario may have, declared once. The reader, `check --full`, `schema` and the
// documentation all come from it.
//
// Paths: `domain.size` is a key of the table [domain]; `load[]` a list of tables [[load]]; `material.*` a table with a
// name of the user's choice. The row of a table stands above the rows of its keys.
#include "model/loads.hpp"
#include "scenario/toml_tree.hpp"

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <vector>

namespace knap {

enum class Kind {
    table,  // [domain]
    list,   // [[load]], or an array of tables
    names,  // [material.NAME]: a table of tables
    boolean,
    integer,
    number,  // with a unit, or plain in SI
    text,
};

enum class Form {
    one,
    pair,         // [a, b]
    triple,       // [a, b, c]
    box,          // [xmin, ymin, xmax, ymax]
    list,         // [a, b, ...]
    one_or_list,  // a, or [a, b, ...]
    points,       // [[a, b], [a, b], ...]
};

struct Range {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool low_included = true, high_included = true;
    bool contains(double value) const;
    std::string text() const;  // "greater than 0"; empty for everything
};

/// A key that belongs to some values of a neighbour.
struct Condition {
    std::string_view neighbour;  // its name; empty: no condition
    std::vector<std::string> values;
    std::string text() const;  // "kind=normal or lognormal"
};

/// A node as a C++ value; nothing where it is of another type (a word in the place of a number).
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
    } else {
        T list;
        for (const Node& child : node.children)
            if (const auto value = value_as<typename T::value_type>(child)) list.push_back(*value);
        return list;
    }
}

struct Key {
    std::string path;
    Kind kind;
    std::string_view doc;
    Form form = Form::one;
    std::string_view unit = {};          // of plain numbers; "*" where it depends on another key
    std::string_view second_unit = "=";  // of the second number of a point; "=": the same
    Range range = {};
    std::vector<std::string> words =
        {};  // the texts that are allowed ("*_force_x": with any begin); of a number: besides numbers
    std::string default_toml = {};      // the default, as TOML
    std::string_view default_doc = {};  // the default in words, where it is computed
    bool is_required = false;           // within its table
    Condition condition = {};
    std::string_view text_key = {};                      // of a table: the key that a bare text stands for
    const std::type_info* owner = nullptr;               // the options struct to which the value is bound
    std::function<void(void*, const Node&)> store = {};  // writes the value into an object of that type

    std::string_view name() const;    // the last part of the path, without []
    std::string_view parent() const;  // path of the table it belongs to, "" at the top
    bool is_table() const { return kind == Kind::table || kind == Kind::list || kind == Kind::names; }

    // what a row of the table says besides path, kind and doc
    Key& pair() { return form = Form::pair, *this; }
    Key& triple() { return form = Form::triple, *this; }
    Key& box() { return form = Form::box, *this; }
    Key& list() { return form = Form::list, *this; }
    Key& one_or_list() { return form = Form::one_or_list, *this; }
    Key& points() { return form = Form::points, *this; }
    Key& second(std::string_view of_second) { return second_unit = of_second, *this; }
    Key& above(double x) { return range.low = x, range.low_included = false, *this; }
    Key& at_least(double x) { return range.low = x, *this; }
    Key& below(double x) { return range.high = x, range.high_included = false, *this; }
    Key& at_most(double x) { return range.high = x, *this; }
    Key& or_word(const char* word) { return words = {word}, *this; }
    Key& required() { return is_required = true, *this; }
    Key& otherwise(const std::string& toml) {
        return default_toml = kind == Kind::text ? toml_quoted(toml) : toml, *this;
    }
    Key& computed(std::string_view in_words) { return default_doc = in_words, *this; }
    Key& only_with(std::string_view key, std::vector<std::string> values) {
        return condition = {key, std::move(values)}, *this;
    }
    Key& or_text(std::string_view of_key) { return text_key = of_key, *this; }
    /// The value goes to this member of an options struct (Values::fill).
    template <class T, class M>
    Key& to(M T::*member) {
        owner = &typeid(T);
        store = [member](void* object, const Node& node) {
            if constexpr (requires {
                              typename M::value_type;
                              requires std::is_same_v<M, std::optional<typename M::value_type>>;
                          })
                static_cast<T*>(object)->*member = value_as<typename M::value_type>(node);
            else if (const std::optional<M> value = value_as<M>(node)) static_cast<T*>(object)->*member = *value;
        };
        return *this;
    }
};

/// All rows, in the order in which a scenario is printed.
std::span<const Key> keys();

/// The row of a pattern such as "load[].on"; null when there is none.
const Key* find_key(std::string_view pattern);

/// Rows directly below a table's row.
std::vector<const Key*> keys_below(std::string_view pattern);

/// Whether a text is one of the words of a key.
bool is_word(const std::vector<std::string>& words, std::string_view text);

/// "load[2].on.box" -> "load[].on.box", "material.glass.E" -> "material.*.E"
std::string pattern_of(std::string_view path);

/// Materials, interfaces, boundaries, loads, probes, obstacles: letters of any script, digits, blanks, _ and -; no
/// blank at an end. (The scenario's own name and names of files are parts of paths and have narrower rules.)
bool is_name(std::string_view text);
inline constexpr const char* rule_for_names = "a name has letters, digits, blanks, _ and -, and no blank at its ends";

}  // namespace knap
