#include "stepper/contact/nearby_edges.hpp"

#include "base/parallel.hpp"

#include <bit>
#include <cmath>

namespace knap {
namespace {

constexpr double cells_per_longest = 8;  // bounds the number of cells of a long edge among short ones

/// Calls visit(x, y) for every cell of a box.
template <class Visit>
void for_cells(const std::array<std::int32_t, 2>& low, const std::array<std::int32_t, 2>& high, const Visit& visit) {
    for (std::int32_t y = low[1]; y <= high[1]; ++y)
        for (std::int32_t x = low[0]; x <= high[0]; ++x) visit(x, y);
}

double distance_to_segment(const Vec2& x, const Vec2& a, const Vec2& along, double length) {
    const double s = std::clamp(along.dot(x - a) / (length * length), 0.0, 1.0);
    return (x - a - s * along).norm();
}

}  // namespace

std::array<std::int32_t, 2> NearbyEdges::cell(const Vec2& x) const {
    constexpr double limit = 1e9;  // of an int
    const auto at = [&](double value) {
        const double place = std::floor(value / cell_size_);
        return static_cast<std::int32_t>(place < limit ? std::max(place, -limit) : limit);  // not a number: limit
    };
    return {at(x.x()), at(x.y())};
}

std::size_t NearbyEdges::bucket(std::int32_t x, std::int32_t y) const {
    const std::uint64_t key =
        static_cast<std::uint32_t>(x) * 0x9e3779b97f4a7c15u + static_cast<std::uint32_t>(y) * 0xc2b2ae3d27d4eb4fu;
    return (key ^ (key >> 32)) & (bucket_end_.size() - 2);
}

void NearbyEdges::fill_grid(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners) {
    double sum = 0, longest = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const double length = (corners[edges[e].end_place].x - corners[e].x).norm();
        sum += length, longest = std::max(longest, length);
    }
    cell_size_ = std::max(2 * sum / static_cast<double>(edges.size()), longest / cells_per_longest) + margin_;
    bucket_end_.assign(std::bit_ceil(2 * edges.size()) + 1, 0);
    const auto for_entries = [&](const auto& visit) {
        for (std::size_t e = 0; e < edges.size(); ++e) {
            if (edges[e].on_support) continue;
            const Vec2 room = Vec2::Constant(edges[e].depth + margin_);
            const Vec2 &a = corners[e].x, &b = corners[edges[e].end_place].x;
            const Vec2 low = a.cwiseMin(b) - room, high = a.cwiseMax(b) + room;
            if (!(low.allFinite() && high.allFinite())) continue;
            for_cells(cell(low), cell(high), [&](std::int32_t x, std::int32_t y) {
                visit(Entry{x, y, static_cast<Index>(e)});
            });
        }
    };
    for_entries([&](const Entry& entry) { ++bucket_end_[bucket(entry.x, entry.y) + 1]; });
    for (std::size_t b = 1; b < bucket_end_.size(); ++b) bucket_end_[b] += bucket_end_[b - 1];
    entries_.resize(bucket_end_.back());
    for_entries([&](const Entry& entry) { entries_[bucket_end_[bucket(entry.x, entry.y)]++] = entry; });
}

void NearbyEdges::find(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners, double margin) {
    margin_ = margin;
    n_blocks_ = (edges.size() + block - 1) / block;
    if (pairs_.size() < n_blocks_) pairs_.resize(n_blocks_);
    x_.resize(corners.size());
    for (std::size_t c = 0; c < corners.size(); ++c) x_[c] = corners[c].x;
    fill_grid(edges, corners);
    for_blocks(static_cast<std::ptrdiff_t>(n_blocks_), [&](std::ptrdiff_t b) {
        std::vector<NearbyEdge>& pairs = pairs_[b];
        pairs.clear();
        for (std::size_t i = b * block; i < std::min(edges.size(), (b + 1) * block); ++i) {
            if (edges[i].entering < 0 || (edges[i].on_support && edges[edges[i].entering].on_support)) continue;
            const Vec2 x = 0.5 * (corners[edges[edges[i].entering].end_place].x + corners[i].x);
            const auto [cell_x, cell_y] = cell(x);
            const std::size_t at = bucket(cell_x, cell_y);
            for (Index k = at == 0 ? 0 : bucket_end_[at - 1]; k < bucket_end_[at]; ++k) {
                const auto& [entry_x, entry_y, e] = entries_[k];
                if (entry_x != cell_x || entry_y != cell_y) continue;
                if (edges[e].piece_start == Index(i) || edges[e].piece_end == Index(i)) continue;
                const Vec2& a = corners[e].x;
                const Vec2 along = corners[edges[e].end_place].x - a, from_a = x - a;
                const double length = along.norm();
                if (!(length > 0) || cross(from_a, along) > margin * length) continue;
                if (distance_to_segment(x, a, along, length) <= edges[e].depth + margin)
                    pairs.push_back({static_cast<Index>(i), e});
            }
        }
    });
}

}  // namespace knap
