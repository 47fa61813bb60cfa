#pragma once
// The key table: every key that a scenario may have, declared once. The reader, `check --full`, `schema` and the documentation all
// come from it.
//
// Paths: `domain.size` is a key of the table [domain]; `load[]` a list of tables [[load]]; `material.*` a table with a name of the
// user's choice. A row stands below the row of the table that it belongs to.
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

enum class Kind {
    table,    // [domain]
    list,     // [[load]], or an array of tables
    names,    // [material.NAME]: a table of tables
    boolean,
    integer,
    number,   // with a unit, or plain in SI
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

struct Key {
    std::string_view path;
    Kind kind;
    Form form = Form::one;
    std::string_view unit = {};         // of plain numbers; "*" where it depends on another key (unit_of)
    std::string_view second_unit = "="; // of the second number of a point, where it is another one
    Range range = {};
    std::vector<std::string> words = {};  // the texts that are allowed, "*_force_x" with any begin; of a number: besides numbers
    std::string_view standard = {};       // the default, as TOML
    std::string_view otherwise = {};      // the default in words, where it is computed
    bool required = false;                // within its table
    std::string_view when = {};           // "shape=polygon", "kind=a or b": only beside such a value of a neighbour
    std::string_view shorthand = {};      // of a table: the key that a bare text stands for
    std::string_view doc;

    std::string_view name() const;    // the last part of the path, without []
    std::string_view parent() const;  // path of the table it belongs to, "" at the top
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

}  // namespace knap
