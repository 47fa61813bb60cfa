#include "stepper/contact/nearby_edges.hpp"

#include "base/parallel.hpp"
#include "base/placed_edge.hpp"
#include "mesh/polygon.hpp"

#include <bit>
#include <cmath>

namespace knap {
namespace {

constexpr std::size_t max_late = 200;    // vertices that are compared one by one with each changed edge
constexpr double cells_per_longest = 8;  // bounds the number of cells of a long edge among short ones

/// Calls visit(x, y) for every cell of a box.
template <class Visit>
void for_cells(const std::array<std::int32_t, 2>& low, const std::array<std::int32_t, 2>& high, const Visit& visit) {
    for (std::int32_t y = low[1]; y <= high[1]; ++y)
        for (std::int32_t x = low[0]; x <= high[0]; ++x) visit(x, y);
}

}  // namespace

/// It leaves a contact piece, and not from support to support.
bool NearbyEdges::is_vertex(std::span<const FreeEdge> edges, Index i) {
    return edges[i].touches && !(edges[i].passive && edges[edges[i].entering].passive);
}

bool NearbyEdges::may_meet(std::span<const FreeEdge> edges, Index i, Index e) {
    const FreeEdge& edge = edges[e];
    const auto is_beside = [&](Index group) { return group == edge.group_start || group == edge.group_end; };
    if (is_beside(edges[i].group_start) || std::ranges::any_of(edges[i].joined, is_beside) || edge.passive)
        return false;
    return !(edge.ground && (edges[i].ground || edges[i].starts_on_support));
}

std::array<std::int32_t, 2> NearbyEdges::cell(const Vec2& x) const {
    constexpr double limit = 1e9;  // of an int
    const auto at = [&](double value) {
        const double place = std::floor(value / cell_size_);
        return static_cast<std::int32_t>(place < limit ? std::max(place, -limit) : limit);  // not a number: limit
    };
    return {at(x.x()), at(x.y())};
}

namespace {

std::size_t bucket_of(std::int32_t x, std::int32_t y, std::size_t n_buckets) {
    const std::uint64_t key =
        static_cast<std::uint32_t>(x) * 0x9e3779b97f4a7c15u + static_cast<std::uint32_t>(y) * 0xc2b2ae3d27d4eb4fu;
    return (key ^ (key >> 32)) & (n_buckets - 1);
}

}  // namespace

/// The cells whose vertices may be near the edge.
NearbyEdges::CellBox NearbyEdges::cells_of(const FreeEdge& edge) const {
    const Vec2 room = Vec2::Constant(edge.depth + margin_);
    const Vec2 &a = x_[edge.start_place], &b = x_[edge.end_place];
    if (!(a.allFinite() && b.allFinite())) return {{0, 0}, {-1, -1}};
    return {cell(a.cwiseMin(b) - room), cell(a.cwiseMax(b) + room)};
}

/// Ground outside of them is near nothing, however long it is; what appears later lies between what is there.
NearbyEdges::CellBox NearbyEdges::cells_of_moving(std::span<const FreeEdge> edges) const {
    Vec2 low = Vec2::Constant(INFINITY), high = -low;
    for (const FreeEdge& edge : edges)
        if (!edge.ground) low = low.cwiseMin(x_[edge.start_place]), high = high.cwiseMax(x_[edge.start_place]);
    CellBox cells{cell(low), cell(high)};
    for (int k = 0; k < 2; ++k) --cells.low[k], ++cells.high[k];
    return cells;
}

template <class ForEntries>
void NearbyEdges::fill(Cells& cells, std::size_t n, const ForEntries& for_entries) const {
    const std::size_t n_buckets = std::bit_ceil(n);
    std::vector<Index>& end = cells.bucket_end;
    std::vector<Entry>& entries = cells.entries;
    end.assign(n_buckets + 1, 0);
    for_entries([&](const Entry& entry) { ++end[bucket_of(entry.x, entry.y, n_buckets) + 1]; });
    for (std::size_t b = 1; b < end.size(); ++b) end[b] += end[b - 1];
    entries.resize(end.back());
    for_entries([&](const Entry& entry) { entries[end[bucket_of(entry.x, entry.y, n_buckets)]++] = entry; });
}

template <class Visit>
void NearbyEdges::for_entries_at(const Cells& cells, std::int32_t x, std::int32_t y, const Visit& visit) const {
    const std::size_t at = bucket_of(x, y, cells.bucket_end.size() - 1);
    for (Index k = at == 0 ? 0 : cells.bucket_end[at - 1]; k < cells.bucket_end[at]; ++k)
        if (cells.entries[k].x == x && cells.entries[k].y == y) visit(cells.entries[k].edge);
}

void NearbyEdges::fill_grid(std::span<const FreeEdge> edges) {
    double sum = 0, longest = 0;
    for (const FreeEdge& edge : edges) {
        const double length = (x_[edge.end_place] - x_[edge.start_place]).norm();
        sum += length, longest = std::max(longest, length);
    }
    cell_size_ = std::max(2 * sum / static_cast<double>(edges.size()), longest / cells_per_longest) + margin_;
    const auto n = static_cast<Index>(edges.size());
    const CellBox moving = cells_of_moving(edges);
    fill(edge_cells_, 2 * n, [&](const auto& visit) {
        for (Index e = 0; e < n; ++e) {
            const CellBox cells = cells_of(edges[e]);
            const auto misses = [&](int k) { return cells.high[k] < moving.low[k] || cells.low[k] > moving.high[k]; };
            if (edges[e].ground && (misses(0) || misses(1))) continue;
            for_cells(cells.low, cells.high, [&](std::int32_t x, std::int32_t y) { visit(Entry{x, y, e}); });
        }
    });
    fill(vertex_cells_, n, [&](const auto& visit) {
        for (Index i = 0; i < n; ++i) {
            if (!is_vertex(edges, i)) continue;
            const auto [x, y] = cell(place_of_vertex(edges, i));
            visit(Entry{x, y, i});
        }
    });
}

Vec2 NearbyEdges::place_of_vertex(std::span<const FreeEdge> edges, Index i) const {
    return 0.5 * (x_[edges[edges[i].entering].end_place] + x_[edges[i].start_place]);
}

/// [-] Of the direction of an edge, until its ends have moved by margin/motion_margin.
double NearbyEdges::largest_turn(double length) const {
    const double ends = 2 * margin_ / motion_margin;
    return length > 2 * ends ? ends / (length - ends) : 2;
}

NearbyEdges::Corner NearbyEdges::corner(std::span<const FreeEdge> edges, Index i) const {
    const FreeEdge &out = edges[i], &in = edges[out.entering];
    const Vec2 along_in = x_[in.end_place] - x_[in.start_place], along_out = x_[out.end_place] - x_[out.start_place];
    const double l_in = along_in.norm(), l_out = along_out.norm();
    return {.x = place_of_vertex(edges, i),
            .t_in = along_in / l_in,
            .t_out = along_out / l_out,
            .turn_in = largest_turn(l_in),
            .turn_out = largest_turn(l_out)};
}

bool NearbyEdges::is_near(std::span<const FreeEdge> edges, Index i, const Corner& at, Index e) const {
    if (!may_meet(edges, i, e)) return false;
    const FreeEdge& edge = edges[e];
    const Vec2& a = x_[edge.start_place];
    const Vec2 along = x_[edge.end_place] - a, from_a = at.x - a;
    const double length = along.norm();
    if (!(length > 0) || cross(from_a, along) > margin_ * length ||
        distance_to_segment(a, x_[edge.end_place], at.x) > edge.depth + margin_)
        return false;
    const double least = VertexCone::widened + largest_turn(length);
    const Vec2 normal = -turned_left(along) / length;
    return !(normal.dot(at.t_in) > least + at.turn_in || normal.dot(at.t_out) < -least - at.turn_out);
}

void NearbyEdges::find(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners, double margin) {
    margin_ = margin, n_listed_ = edges.size();
    n_blocks_ = (edges.size() + block - 1) / block + 1;
    if (pairs_.size() < n_blocks_) pairs_.resize(n_blocks_);
    pairs_[n_blocks_ - 1].clear(), late_edges_.clear(), late_vertices_.clear();
    is_late_.assign(edges.size(), 0), is_changed_.assign(edges.size(), 0);
    x_.resize(corners.size());
    for (std::size_t c = 0; c < corners.size(); ++c) x_[c] = corners[c].x;
    fill_grid(edges);
    for_blocks(static_cast<std::ptrdiff_t>(n_blocks_) - 1, [&](std::ptrdiff_t b) {
        std::vector<NearbyEdge>& pairs = pairs_[b];
        pairs.clear();
        for (auto i = static_cast<Index>(b * block); i < static_cast<Index>(std::min(n_listed_, (b + 1) * block));
             ++i) {
            if (!is_vertex(edges, i)) continue;
            const Corner at = corner(edges, i);
            const auto [cell_x, cell_y] = cell(at.x);
            for_entries_at(edge_cells_, cell_x, cell_y, [&](Index e) {
                if (is_near(edges, i, at, e)) pairs.push_back({i, e});
            });
        }
    });
}

bool NearbyEdges::add(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners,
                      std::span<const Index> changed) {
    if (late_vertices_.size() + changed.size() > max_late + n_listed_ / 20) return false;
    for (std::size_t c = x_.size(); c < corners.size(); ++c) x_.push_back(corners[c].x);
    is_late_.resize(edges.size(), 0), is_changed_.resize(edges.size(), 0);
    for (const Index e : changed) {
        is_changed_[e] = 1;
        if (!is_late_[e]) late_vertices_.push_back(e);
        if (!is_late_[e] && e >= static_cast<Index>(n_listed_)) late_edges_.push_back(e);
        is_late_[e] = 1;
    }
    for (std::size_t b = 0; b < n_blocks_; ++b)
        std::erase_if(pairs_[b],
                      [&](const NearbyEdge& pair) { return is_changed_[pair.vertex] || is_changed_[pair.edge]; });
    const auto try_pair = [&](Index i, const Corner& at, Index e) {
        if (is_near(edges, i, at, e)) pairs_[n_blocks_ - 1].push_back({i, e});
    };
    for (const Index i : changed) {
        if (!is_vertex(edges, i)) continue;
        const Corner at = corner(edges, i);
        const auto [cell_x, cell_y] = cell(at.x);
        for_entries_at(edge_cells_, cell_x, cell_y, [&](Index e) { try_pair(i, at, e); });
        for (const Index e : late_edges_) try_pair(i, at, e);
    }
    for (const Index e : changed) {  // with the vertices that have not changed
        const auto try_vertex = [&](Index i) {
            if (!is_changed_[i] && is_vertex(edges, i)) try_pair(i, corner(edges, i), e);
        };
        const auto [low, high] = cells_of(edges[e]);
        for_cells(low, high, [&](std::int32_t x, std::int32_t y) {
            for_entries_at(vertex_cells_, x, y, [&](Index i) {
                if (!is_late_[i]) try_vertex(i);
            });
        });
        for (const Index i : late_vertices_) try_vertex(i);
    }
    for (const Index e : changed) is_changed_[e] = 0;
    return true;
}

}  // namespace knap
