#pragma once
// The key table: every key that a scenario may have, declared once (key_table.cpp, key_table_run.cpp). The reader,
// `check --full`, `schema` and scenarios/KEYS.md all use it.
//
// Patterns of paths: `domain.size` is a key of the table [domain]; `load[]` a list of tables [[load]]; `material.*` a
// table [material.NAME]. The row of a table precedes the rows of its keys.
#include "scenario/toml_tree.hpp"

#include <functional>
#include <span>
#include <typeinfo>

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

struct FormRule {
    std::string text;
    std::size_t min, max;  // number of entries; max 0: unlimited
};

struct Range {
    double low = -infinity, high = infinity;
    bool low_included = true, high_included = true;
    bool contains(double value) const;
    std::string text() const;  // "greater than 0"; empty if unbounded
};

/// A key that exists only with some values of a neighbouring key of its table.
struct Condition {
    std::string_view neighbour;  // empty: no condition
    std::vector<std::string> values;
};

template <class T>
T without_optional(T);
template <class T>
T without_optional(std::optional<T>);

struct Key {
    std::string path;
    Kind kind;
    std::string_view doc;
    Form form = Form::one;
    std::string_view unit = {};          // of plain numbers; "*": depends on other keys
    std::string_view second_unit = "=";  // of the second number of a point; "=": the same unit
    std::vector<std::string> multiples;  // units that are kept instead of converted: "CFL", "cR", "%"
    std::size_t min_points = 1;          // of the form points
    Range range = {};
    std::vector<std::string> words =
        {};  // allowed texts ("*_force_x", "run:*": with any text there); of a number: besides numbers
    std::string default_toml = {};      // a constant default
    std::string_view default_doc = {};  // a computed default, in words
    bool is_required = false;           // within its table
    bool is_a_name = false;             // of a text: it must be a name (is_name)
    bool takes_values = false;          // of a text: numbers and lists stand for their text
    bool takes_formulas = false;        // of a number: also a formula, or a csv file in the place of all numbers
    Condition condition = {};
    std::string_view text_key = {};                      // of a table: the key that a text in place of the table gives
    const std::type_info* owner = nullptr;               // the options struct that has a member for the value
    std::function<void(void*, const Node&)> store = {};  // writes the value into such a struct

    std::string_view name() const;    // the last part of the path, without []
    std::string_view parent() const;  // pattern of the table that has the key, "" at the top
    FormRule rule() const;
    bool is_table() const { return kind == Kind::table || kind == Kind::list || kind == Kind::names; }
    /// Whether plain numbers have a unit that does not depend on other keys.
    bool has_fixed_unit() const { return kind == Kind::number && !unit.empty() && unit != "*"; }

    // further properties of a row of the key table
    Key& pair() { return form = Form::pair, *this; }
    Key& triple() { return form = Form::triple, *this; }
    Key& box() { return form = Form::box, *this; }
    Key& list() { return form = Form::list, *this; }
    Key& one_or_list() { return form = Form::one_or_list, *this; }
    Key& points(std::size_t at_least = 1) { return form = Form::points, min_points = at_least, *this; }
    Key& second(std::string_view of_second) { return second_unit = of_second, *this; }
    Key& or_multiple_of(std::vector<std::string> units) { return multiples = std::move(units), *this; }
    Key& above(double x) { return range.low = x, range.low_included = false, *this; }
    Key& at_least(double x) { return range.low = x, *this; }
    Key& below(double x) { return range.high = x, range.high_included = false, *this; }
    Key& at_most(double x) { return range.high = x, *this; }
    Key& or_formula() { return takes_formulas = true, *this; }
    Key& any_value() { return takes_values = true, *this; }
    Key& a_name() { return is_a_name = true, *this; }
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
    /// Table::fill writes the value, a number through `convert`, to this member of an options struct.
    template <class T, class M>
    Key& to(M T::*member, double (*convert)(double) = nullptr) {
        using Value = decltype(without_optional(std::declval<M>()));
        owner = &typeid(T);
        store = [=](void* object, const Node& node) {
            std::optional<Value> value = value_as<Value>(node);
            if (!value) return;
            if constexpr (std::is_same_v<Value, double>) value = convert ? convert(*value) : *value;
            static_cast<T*>(object)->*member = std::move(*value);
        };
        return *this;
    }
    /// The member becomes the element of `of_words` that has the position of the text among `words`.
    template <class T, class M>
    Key& to(M T::*member, std::initializer_list<M> of_words) {
        owner = &typeid(T);
        store = [member, names = words, values = std::vector<M>(of_words)](void* object, const Node& node) {
            for (std::size_t i = 0; i < names.size(); ++i)
                if (names[i] == node.text) static_cast<T*>(object)->*member = values[i];
        };
        return *this;
    }
};

/// All rows, in the order in which a scenario is printed.
std::span<const Key> keys();

/// The row of a pattern such as "load[].on"; null if there is none.
const Key* find_key(std::string_view pattern);
/// Rows directly below the row of a table.
const std::vector<const Key*>& keys_below(std::string_view pattern);
/// "load[2].on.box" -> "load[].on.box", "material.glass.E" -> "material.*.E", "body.boulder.spin" -> "body[].spin"
std::string pattern_of(std::string_view path);
/// The row of the value at a path: of "body.boulder.velocity.x" and "body[0].velocity[0]" that of the pair. Null if
/// there is none.
const Key* key_at(std::string_view path);
/// Of a path to what is no component of a pair, as body.b.shift.z: the path of the pair; empty otherwise.
std::string pair_without_component(std::string_view path);

/// "a", "b" -> "a.b"
std::string joined_path(std::string_view table, std::string_view key);

/// Whether a text is one of the words of a key.
bool is_word(const std::vector<std::string>& words, std::string_view text);

/// The values that a key accepts, plain numbers in `unit`: "a length [m]", "two values [a, b], each a pressure [Pa]".
std::string describe(const Key& key, std::string_view unit);
std::string describe_one(const Key& key, std::string_view unit);  // one value of a list or a pair
std::string describe_unit(std::string_view unit);                 // "a length [m]"

/// Whether a text may be the name of a material, interface, boundary, load, probe or obstacle. (The name of a scenario
/// and file names are parts of paths and have narrower rules.)
bool is_name(std::string_view text);
inline constexpr const char* rule_for_names = "a name has letters, digits, blanks, _ and -, and no blank at either end";

}  // namespace knap
