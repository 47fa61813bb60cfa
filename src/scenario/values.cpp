#include "scenario/values.hpp"

namespace knap {

const Entry* Values::find(const std::string& path) const {
    const auto found = index_.find(path);
    return found == index_.end() ? nullptr : &entries_[found->second];
}

Entry* Values::entry(const std::string& path) { return const_cast<Entry*>(find(path)); }

const Node& Values::place_of(std::string path) const {
    static const Node nowhere;
    while (!path.empty()) {
        if (const Entry* entry = find(path); entry && entry->node.is_placed()) return entry->node;
        const std::size_t end = path.find_last_of(".[");
        path.resize(end == std::string::npos ? 0 : end);
    }
    return nowhere;
}

bool Values::given(const std::string& path) const {
    const Entry* entry = find(path);
    return entry && (entry->origin == Origin::file || entry->origin == Origin::set);
}

const Node* Values::good(const std::string& path) const {
    const Entry* entry = find(path);
    return entry && entry->valid ? &entry->node : nullptr;
}

std::vector<const Node*> Values::items(const std::string& path) const {
    std::vector<const Node*> list;
    if (const Node* node = good(path))
        for (const Node& child : node->children) list.push_back(&child);
    return list;
}

std::size_t Values::count(const std::string& list) const {
    const auto found = counts_.find(list);
    return found == counts_.end() ? 0 : found->second;
}

std::vector<std::string> Values::names(const std::string& of) const {
    const auto found = names_.find(of);
    return found == names_.end() ? std::vector<std::string>() : found->second;
}

void Values::add(Entry added) {
    if (Entry* known = entry(added.path)) {
        *known = std::move(added);
        return;
    }
    if (added.key && added.key->kind == Kind::list) ++counts_[added.path.substr(0, added.path.rfind('['))];
    if (added.key && added.key->path.ends_with(".*")) {
        const std::size_t dot = added.path.find('.');
        names_[added.path.substr(0, dot)].push_back(added.path.substr(dot + 1));
    }
    index_[added.path] = entries_.size();
    entries_.push_back(std::move(added));
}

void Values::compute(const std::string& path, Node node) {
    Entry* known = entry(path);
    if (!known || known->origin != Origin::computed) return;
    known->node = std::move(node);
    known->valid = true;
}

void Values::leave_out(const std::string& path) {
    if (Entry* known = entry(path); known && known->origin == Origin::standard) known->valid = false;
}

void Values::replace(const std::string& path, const std::string& new_path, Node node) {
    Entry* known = entry(path);
    if (!known) return;
    node.take_place(known->node);
    known->path = new_path;
    known->key = find_key(pattern_of(new_path));
    known->node = std::move(node);
    const std::size_t i = index_.at(path);
    index_.erase(path);
    index_[new_path] = i;
}

}  // namespace knap
