#include "scenario/values.hpp"

#include <algorithm>

namespace knap {

const Entry* Values::find(const std::string& path) const {
    const auto found = index_.find(path);
    return found == index_.end() ? nullptr : &entries_[found->second];
}

bool Values::given(const std::string& path) const {
    const Entry* entry = find(path);
    return entry && (entry->origin == Origin::file || entry->origin == Origin::set);
}

const Node* Values::good(const std::string& path) const {
    const Entry* entry = find(path);
    return entry && entry->valid ? &entry->node : nullptr;
}

bool Values::has(const std::string& path) const { return good(path) != nullptr; }

std::optional<double> Values::number(const std::string& path) const {
    const Node* node = good(path);
    return node && node->is_number() ? std::optional(node->number) : std::nullopt;
}

std::optional<std::string> Values::text(const std::string& path) const {
    const Node* node = good(path);
    return node && node->type == Node::Type::text ? std::optional(node->text) : std::nullopt;
}

std::optional<bool> Values::flag(const std::string& path) const {
    const Node* node = good(path);
    return node && node->type == Node::Type::boolean ? std::optional(node->boolean) : std::nullopt;
}

std::optional<Vec2> Values::pair(const std::string& path) const {
    const Node* node = good(path);
    if (!node || node->children.size() != 2) return std::nullopt;
    return Vec2(node->children[0].number, node->children[1].number);
}

std::optional<Box> Values::box(const std::string& path) const {
    const Node* node = good(path);
    if (!node || node->children.size() != 4) return std::nullopt;
    const auto& n = node->children;
    return Box{{n[0].number, n[1].number}, {n[2].number, n[3].number}};
}

std::vector<Vec2> Values::points(const std::string& path) const {
    std::vector<Vec2> list;
    for (const Node* point : items(path)) list.emplace_back(point->children[0].number, point->children[1].number);
    return list;
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

void Values::add(Entry entry) {
    if (const auto found = index_.find(entry.path); found != index_.end()) {
        entries_[found->second] = std::move(entry);
        return;
    }
    if (entry.key && entry.key->kind == Kind::list) ++counts_[entry.path.substr(0, entry.path.rfind('['))];
    if (entry.key && entry.key->path.ends_with(".*")) {
        const std::size_t dot = entry.path.find('.');
        names_[entry.path.substr(0, dot)].push_back(entry.path.substr(dot + 1));
    }
    index_[entry.path] = entries_.size();
    entries_.push_back(std::move(entry));
}

void Values::compute(const std::string& path, Node node) {
    const auto found = index_.find(path);
    if (found == index_.end() || entries_[found->second].origin != Origin::computed) return;
    entries_[found->second].node = std::move(node);
    entries_[found->second].valid = true;
}

void Values::leave_out(const std::string& path) {
    if (const auto found = index_.find(path); found != index_.end() && entries_[found->second].origin == Origin::standard)
        entries_[found->second].valid = false;
}

void Values::replace(const std::string& path, const std::string& new_path, Node node) {
    const auto found = index_.find(path);
    if (found == index_.end()) return;
    const std::size_t i = found->second;
    index_.erase(found);
    node.name_place = entries_[i].node.name_place;
    node.place = entries_[i].node.place;
    node.set_by = entries_[i].node.set_by;
    entries_[i].path = new_path;
    entries_[i].key = find_key(pattern_of(new_path));
    entries_[i].node = std::move(node);
    index_[new_path] = i;
}

}  // namespace knap
