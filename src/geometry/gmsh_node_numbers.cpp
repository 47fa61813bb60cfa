#include "geometry/gmsh_node_numbers.hpp"

#include <algorithm>

namespace knap {

GmshNodeNumbers::GmshNodeNumbers(const GmshSource& source, const std::vector<GmshNode>& nodes) : source_(source) {
    by_tag_.reserve(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) by_tag_.emplace_back(nodes[i].tag, static_cast<Index>(i));
    if (by_tag_.empty()) return;
    if (!std::is_sorted(by_tag_.begin(), by_tag_.end())) std::sort(by_tag_.begin(), by_tag_.end());
    const auto twice = std::adjacent_find(by_tag_.begin(), by_tag_.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != by_tag_.end()) source.fail(source.at(), "$Nodes has node " + std::to_string(twice->first) + " twice");
    const auto reach = static_cast<std::uint64_t>(by_tag_.back().first) - static_cast<std::uint64_t>(by_tag_.front().first);
    without_gaps_ = reach == by_tag_.size() - 1;
}

Index GmshNodeNumbers::of(std::int64_t tag, std::size_t where) const {
    if (without_gaps_ && tag >= by_tag_.front().first && tag <= by_tag_.back().first)
        return by_tag_[static_cast<std::size_t>(tag - by_tag_.front().first)].second;
    const auto found = std::lower_bound(by_tag_.begin(), by_tag_.end(), std::pair<std::int64_t, Index>(tag, 0));
    if (found == by_tag_.end() || found->first != tag) source_.fail(where, "$Nodes has no node " + std::to_string(tag));
    return found->second;
}

}  // namespace knap
