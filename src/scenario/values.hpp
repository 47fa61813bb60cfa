#pragma once
// Every key of one scenario with its value in SI and where that came from.
#include "model/loads.hpp"
#include "scenario/keys.hpp"
#include "scenario/node.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace knap {

enum class Origin { file, set, standard, computed };

struct Entry {
    std::string path;  // "load[0].traction"
    const Key* key = nullptr;
    Node node;  // tables: only their place
    Origin origin = Origin::file;
    bool valid = true;  // false: reported as wrong, or not computed (yet)
};

class Values {
public:
    const std::vector<Entry>& entries() const { return entries_; }  // in the order of the key table
    const Entry* find(const std::string& path) const;
    /// In the file or by --set, be it right or wrong.
    bool given(const std::string& path) const;
    bool has(const std::string& path) const;  // there is a good value

    // values; nothing where there is no good one
    std::optional<double> number(const std::string& path) const;
    std::optional<std::string> text(const std::string& path) const;
    std::optional<bool> flag(const std::string& path) const;
    std::optional<Vec2> pair(const std::string& path) const;
    std::optional<Box> box(const std::string& path) const;
    std::vector<Vec2> points(const std::string& path) const;
    std::vector<const Node*> items(const std::string& path) const;

    std::size_t count(const std::string& list) const;             // of [[list]]
    std::vector<std::string> names(const std::string& of) const;  // members of a table of tables, in the order of the file

    void add(Entry entry);
    /// Gives a key that was not set its value.
    void compute(const std::string& path, Node node);
    /// Forgets the default of a key that has no meaning in this scenario.
    void leave_out(const std::string& path);
    /// Puts another key in the place of one.
    void replace(const std::string& path, const std::string& new_path, Node node);

private:
    const Node* good(const std::string& path) const;
    std::vector<Entry> entries_;
    std::map<std::string, std::size_t> index_;
    std::map<std::string, std::size_t> counts_;
    std::map<std::string, std::vector<std::string>> names_;
};

/// "load", 2 -> "load[2]"
inline std::string item(const std::string& list, std::size_t i) { return list + "[" + std::to_string(i) + "]"; }

}  // namespace knap
