#pragma once
// Every key of one scenario with its value in SI and the origin of the value.
#include "scenario/keys.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace knap {

enum class Origin { file, set, standard, computed };

struct Entry {
    std::string path;  // "load[0].traction"
    const Key* key = nullptr;
    Node node;  // of a table: only its place
    Origin origin = Origin::file;
    bool valid = true;  // false: reported as wrong, or not computed (yet)
};

class Values {
public:
    const std::vector<Entry>& entries() const { return entries_; }  // in the order of the key table
    const Entry* find(const std::string& path) const;
    /// The node that says where a message about `path` belongs: there, or at the nearest table above it.
    const Node& place_of(std::string path) const;
    /// In the file or by --set, be it right or wrong.
    bool given(const std::string& path) const;
    bool has(const std::string& path) const { return good(path) != nullptr; }  // there is a good value

    // values; nothing where there is no good one of that type
    template <class T>
    std::optional<T> get(const std::string& path) const {
        const Node* node = good(path);
        return node ? value_as<T>(*node) : std::nullopt;
    }
    std::optional<double> number(const std::string& path) const { return get<double>(path); }
    std::optional<std::string> text(const std::string& path) const { return get<std::string>(path); }
    std::optional<bool> flag(const std::string& path) const { return get<bool>(path); }
    std::optional<Vec2> pair(const std::string& path) const { return get<Vec2>(path); }
    std::optional<Box> box(const std::string& path) const { return get<Box>(path); }
    std::vector<Vec2> points(const std::string& path) const {
        return get<std::vector<Vec2>>(path).value_or(std::vector<Vec2>());
    }
    std::vector<const Node*> items(const std::string& path) const;

    /// Members of `object` take the values of the keys of `table` that are bound to them (Key::to).
    template <class T>
    void fill(const std::string& table, T& object) const {
        for (const Key* key : keys_below(pattern_of(table)))
            if (key->owner && *key->owner == typeid(T))
                if (const Node* node = good((table.empty() ? "" : table + ".") + std::string(key->name())))
                    key->store(&object, *node);
    }

    std::size_t count(const std::string& list) const;             // of [[list]]
    std::vector<std::string> names(const std::string& of) const;  // of a table of tables, in the order of the file

    void add(Entry entry);
    /// Gives a key that was not set its value.
    void compute(const std::string& path, Node node);
    /// Forgets the default of a key that has no meaning in this scenario.
    void leave_out(const std::string& path);
    /// Puts another key in the place of one.
    void replace(const std::string& path, const std::string& new_path, Node node);

private:
    const Node* good(const std::string& path) const;
    Entry* entry(const std::string& path);
    std::vector<Entry> entries_;
    std::map<std::string, std::size_t> index_;
    std::map<std::string, std::size_t> counts_;
    std::map<std::string, std::vector<std::string>> names_;
};

/// "load", 2 -> "load[2]"
inline std::string item(const std::string& list, std::size_t i) { return list + "[" + std::to_string(i) + "]"; }

}  // namespace knap
