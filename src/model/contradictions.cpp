#include "model/contradictions.hpp"

#include "model/selections.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace knap {
namespace {

/// Two piecewise linear functions are equal if they are at all points of both.
bool same_motion(const Load& a, const Load& b, int k) {
    const double va = *a.value[k], vb = *b.value[k];
    if (va == 0 && vb == 0) return true;  // at rest, as a displacement or as a velocity
    if (a.kind != b.kind) return false;
    const auto equal = [&](double t) {
        return std::abs(va * a.history(t) - vb * b.history(t)) <= 1e-12 * std::max(std::abs(va), std::abs(vb));
    };
    return equal(0) && std::ranges::all_of(a.history.time, equal) && std::ranges::all_of(b.history.time, equal);
}

class Search {
public:
    Search(const Model& model, const std::vector<Load>& loads)
        : model_(model),
          mesh_(model.mesh),
          loads_(loads),
          driver_(mesh_.n_corners(), {no_index, no_index}),
          driver_of_edge_(mesh_.boundary_edges.size(), {no_index, no_index}) {}

    std::vector<Contradiction> found() {
        const Index n = static_cast<Index>(loads_.size());
        for (Index i = 0; i < n; ++i)
            if (loads_[i].drives()) add_motion(i);
        for (Index i = 0; i < n; ++i) {
            if (loads_[i].kind == Load::Kind::traction || loads_[i].kind == Load::Kind::stress) check_traction(i);
            if (loads_[i].kind == Load::Kind::force) check_force(i);
        }
        return std::move(found_);
    }

private:
    using Drivers = std::array<Index, 2>;  // the load that prescribes x and y, or none

    void add_motion(Index number) {
        const Load& load = loads_[number];
        const std::vector<char> held = held_corners(model_, load.on), selected = selected_corners(mesh_, load.on);
        std::vector<std::size_t> edges = selected_edges(mesh_, load.on);
        if (load.on.boundary.empty()) {
            edges.clear();
            for (std::size_t e = 0; e < mesh_.boundary_edges.size(); ++e) {
                const auto& [triangle, side, boundary] = mesh_.boundary_edges[e];
                const Index first = mesh_.corners_per_triangle() * triangle;
                if (selected[first + side] && selected[first + (side + 1) % 3]) edges.push_back(e);
            }
        }
        for (int k = 0; k < 2; ++k) {
            if (!load.value[k]) continue;
            for (const std::size_t e : edges) driver_of_edge_[e][k] = number;
            for (Index c = 0; c < mesh_.n_corners(); ++c) {
                if (!held[c]) continue;
                const Index other = std::exchange(driver_[c][k], number);
                if (other == no_index) continue;
                const auto [equal, is_new] = same_motion_.try_emplace({other, number, k});
                if (is_new) equal->second = same_motion(loads_[other], load, k);
                if (!equal->second) report(Contradiction::Kind::motions, other, number, k, mesh_.corner(c));
            }
        }
    }

    void check_traction(Index number) {
        const Load& load = loads_[number];
        for (const std::size_t e : selected_edges(mesh_, load.on)) {
            const auto& [triangle, side, boundary] = mesh_.boundary_edges[e];
            const Vec2 along = mesh_.side_vector(triangle, side), middle = mesh_.corner(triangle, side) + 0.5 * along,
                       traction = load.traction_on(-turned_left(along.normalized()), middle, 0);
            const double size = std::max(load.traction_on({1, 0}, middle, 0).norm(),
                                         load.traction_on({0, 1}, middle, 0).norm());  // [Pa]
            for (int k = 0; k < 2; ++k)
                if (driver_of_edge_[e][k] != no_index && std::abs(traction[k]) > 1e-9 * size)
                    report(Contradiction::Kind::traction, driver_of_edge_[e][k], number, k, middle);
        }
    }

    /// A force all of whose corners are driven.
    void check_force(Index number) {
        const std::vector<char> selected = selected_corners(mesh_, loads_[number].on);
        for (int k = 0; k < 2; ++k) {
            if (loads_[number].vector()[k] == 0) continue;
            Index first = no_index;
            bool all_driven = true;
            for (Index c = 0; c < mesh_.n_corners() && all_driven; ++c) {
                if (!selected[c]) continue;
                if (first == no_index) first = c;
                all_driven = driver_[c][k] != no_index;
            }
            if (all_driven && first != no_index)
                report(Contradiction::Kind::force, driver_[first][k], number, k, mesh_.corner(first));
        }
    }

    void report(Contradiction::Kind kind, Index driver, Index number, int k, const Vec2& where) {
        const std::array<std::size_t, 2> pair{static_cast<std::size_t>(std::min(driver, number)),
                                              static_cast<std::size_t>(std::max(driver, number))};
        const auto same = [&](const Contradiction& c) { return c.load == pair && c.component == k && c.kind == kind; };
        if (std::ranges::none_of(found_, same)) found_.push_back({kind, pair, k, where});
    }

    const Model& model_;
    const Mesh& mesh_;
    const std::vector<Load>& loads_;
    std::vector<Drivers> driver_, driver_of_edge_;      // per corner, per boundary edge
    std::map<std::array<Index, 3>, bool> same_motion_;  // of two loads and a component
    std::vector<Contradiction> found_;
};

}  // namespace

std::vector<Contradiction> find_contradictions(const Model& model, const std::vector<Load>& loads) {
    return Search(model, loads).found();
}

}  // namespace knap
