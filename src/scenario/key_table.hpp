#pragma once
// Builder of the rows of the key table.
#include "scenario/keys.hpp"

namespace knap {

class KeyTable {
public:
    std::vector<Key> rows;

    // tables, by path; the rows that follow are keys of the table
    Key& table(const std::string& path, std::string_view doc) { return head(path, Kind::table, doc); }
    Key& list(const std::string& path, std::string_view doc) { return head(path, Kind::list, doc); }
    Key& names(const std::string& path, std::string_view doc) { return head(path, Kind::names, doc); }
    /// The rows that follow are keys of this table again.
    void in(const std::string& path) { table_ = path; }

    Key& flag(std::string_view name, std::string_view doc) { return row(name, Kind::boolean, doc); }
    Key& integer(std::string_view name, std::string_view doc) { return row(name, Kind::integer, doc); }
    Key& text(std::string_view name, std::string_view doc) { return row(name, Kind::text, doc); }
    Key& word(std::string_view name, std::vector<std::string> words, std::string_view doc) {
        Key& key = text(name, doc);
        key.words = std::move(words);
        return key;
    }
    Key& number(std::string_view name, std::string_view unit, std::string_view doc) {
        Key& key = row(name, Kind::number, doc);
        key.unit = unit;
        return key;
    }

private:
    Key& row(std::string_view name, Kind kind, std::string_view doc) {
        return rows.emplace_back(Key{.path = joined_path(table_, name), .kind = kind, .doc = doc});
    }
    Key& head(const std::string& path, Kind kind, std::string_view doc) {
        in(path);
        return rows.emplace_back(Key{.path = path, .kind = kind, .doc = doc});
    }
    std::string table_;
};

/// Of an interface, or an obstacle.
template <class Law>
void add_contact(KeyTable& t) {
    t.number("friction", "", "Coulomb friction coefficient").at_least(0).otherwise("0").to(&Law::friction);
    t.number("restitution", "",
             "Newton's coefficient of restitution of the faces that touch: 0 plastic, 1 elastic impact. A deformable "
             "body springs back by its own elasticity, whatever this is, with 0.8 to 0.98 of its speed (a few "
             "triangles with 0.3 to 0.6): R_N of an obstacle or [contact] is the rebound of bodies")
        .at_least(0)
        .at_most(1)
        .otherwise("0")
        .to(&Law::restitution);
}

/// `on`, or `key`, of `table`, whose keys follow: a selection by boundary, box and body.
void add_place(KeyTable& t, const std::string& table, std::string_view doc, std::string_view key = "on");
inline constexpr std::string_view factor_csv =
    "file with lines `time, factor` instead of a table, relative to the scenario file; times in s, or as the line of "
    "names says: `time [us], factor`; # starts a comment";
/// ramp, table and csv of a factor over time.
void add_history(KeyTable& t, std::string_view what, std::string_view csv = factor_csv);
/// Thermal keys of [material.NAME].
void add_thermal(KeyTable& t);
void add_keys_of_laws(KeyTable& t);
void add_keys_of_heat(KeyTable& t);
void add_keys_of_run(KeyTable& t);
void add_keys_of_calibration(KeyTable& t);
void add_keys_of_ensembles(KeyTable& t);

}  // namespace knap
