#pragma once
// How the rows of the key table are written.
#include "scenario/keys.hpp"

#include <utility>

namespace knap {

class KeyTable {
public:
    std::vector<Key> rows;

    // tables: by path; the rows that follow are keys of it
    Key& table(const std::string& path, std::string_view doc) { return head(path, Kind::table, doc); }
    Key& list(const std::string& path, std::string_view doc) { return head(path, Kind::list, doc); }
    Key& names(const std::string& path, std::string_view doc) { return head(path, Kind::names, doc); }
    /// Rows that follow are keys of this table again.
    void in(const std::string& path) { prefix_ = path + "."; }

    Key& flag(const std::string& name, std::string_view doc) { return row(name, Kind::boolean, doc); }
    Key& integer(const std::string& name, std::string_view doc) { return row(name, Kind::integer, doc); }
    Key& text(const std::string& name, std::string_view doc) { return row(name, Kind::text, doc); }
    Key& word(const std::string& name, std::vector<std::string> words, std::string_view doc) {
        Key& key = text(name, doc);
        key.words = std::move(words);
        return key;
    }
    Key& number(const std::string& name, std::string_view unit, std::string_view doc) {
        Key& key = row(name, Kind::number, doc);
        key.unit = unit;
        return key;
    }

private:
    Key& row(const std::string& name, Kind kind, std::string_view doc) {
        return rows.emplace_back(Key{prefix_ + name, kind, doc});
    }
    Key& head(const std::string& path, Kind kind, std::string_view doc) {
        in(path);
        return rows.emplace_back(Key{path, kind, doc});
    }
    std::string prefix_;
};

void add_keys_of_body(KeyTable& t);
void add_keys_of_materials(KeyTable& t);
void add_keys_of_loads(KeyTable& t);
void add_keys_of_run(KeyTable& t);
void add_keys_of_ensembles(KeyTable& t);

}  // namespace knap
