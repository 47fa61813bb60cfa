#include "stepper/common/pieces_of_body.hpp"

#include "base/union_find.hpp"

#include <algorithm>

namespace knap {
namespace {

/// [0/1] Per point: it holds its sides together.
std::vector<std::uint8_t> joining_points(const Model& model, const State& state, Hinges hinges) {
    std::vector<std::uint8_t> joins(model.n_points(), 0);
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Index rank = state.split_rank[f];
        const auto points = model.points(model.fans[f]);
        for (std::size_t j = 0; j < points.size(); ++j)
            joins[points[j].point] =
                unbreakable(model, points[j]) ||
                (rank < 0 ? !points[j].cracked && model.laws[points[j].law].sigma_c > 0
                          : state.points[state.first_point[rank] + static_cast<Index>(j)].cohesion > 0);
    }
    if (hinges == Hinges::part)
        for (std::size_t p = 0; p < state.retired.size(); ++p)
            if (state.retired[p] == Retirement::parted) joins[p] = 0;
    return joins;
}

}  // namespace

PiecesOfBody pieces_of_body(const Model& model, const State& state, std::span<const Dashpot> dashpots, Hinges hinges) {
    const Mesh& mesh = model.mesh;
    const Index n = mesh.n_triangles(), n_points = model.points_per_interface();
    UnionFind sets(n);
    // [0/1] at first of the triangles that something holds, then of the lowest one of their piece
    std::vector<std::uint8_t> held(n, 0);
    const std::vector<std::uint8_t> joins = joining_points(model, state, hinges);
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
        if (std::ranges::none_of(std::span(joins).subspan(i * n_points, n_points), [](auto joined) { return joined; }))
            continue;
        const auto [a, b] = model.interfaces[i].triangle;
        if (a != rigid_support && b != rigid_support) sets.join(a, b);
        else held[std::max(a, b)] = 1;
    }
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {  // one node, whatever its points bear
        const auto parts = [&](const FanPoint& point) {
            return hinges == Hinges::part && !state.retired.empty() && state.retired[point.point] == Retirement::parted;
        };
        if (state.split_rank[f] >= 0 || std::ranges::any_of(model.points(model.fans[f]), parts)) continue;
        const auto corners = model.corners(model.fans[f]);
        for (const Index corner : corners) sets.join(mesh.triangle_of(corners[0]), mesh.triangle_of(corner));
    }
    for (Index c = 0; c < mesh.n_corners(); ++c)
        if (model.motion_of(c) != nullptr) held[mesh.triangle_of(c)] = 1;
    for (const Dashpot& dashpot : dashpots) held[mesh.triangle_of(dashpot.corner)] = 1;
    for (Index t = 0; t < n; ++t)
        if (held[t] || model.has_vanished(t)) held[sets.find(t)] = 1;
    PiecesOfBody pieces{.first = std::vector<Index>(n), .held = std::vector<std::uint8_t>(n)};
    for (Index t = 0; t < n; ++t) pieces.first[t] = sets.find(t), pieces.held[t] = held[pieces.first[t]];
    return pieces;
}

}  // namespace knap
