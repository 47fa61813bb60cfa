#include "model/contradictions.hpp"

#include "model/selections.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr Index nobody = -1;

bool prescribes_motion(const Load& load) { return load.kind == Load::Kind::velocity || load.kind == Load::Kind::displacement; }
bool is_traction(const Load& load) { return load.kind == Load::Kind::traction || load.kind == Load::Kind::stress; }

/// Two piecewise linear functions agree when they do at all points of both.
bool same_motion(const Load& a, const Load& b, int k) {
    const double va = *a.value[k], vb = *b.value[k];
    if (va == 0 && vb == 0) return true;  // at rest, as a displacement or as a velocity
    if (a.kind != b.kind) return false;
    const auto differ = [&](double t) {
        const double x = va * a.history(t), y = vb * b.history(t);
        return std::abs(x - y) > 1e-12 * std::max(std::abs(va), std::abs(vb));
    };
    for (const TimeFunction* history : {&a.history, &b.history})
        if (std::any_of(history->time.begin(), history->time.end(), differ)) return false;
    return !differ(0);
}

class Search {
public:
    Search(const Model& model, const std::vector<Load>& loads) : model_(model), mesh_(model.mesh), loads_(loads) {
        driver_.assign(mesh_.n_corners(), {nobody, nobody});
        driver_of_edge_.assign(mesh_.boundary_edges.size(), {nobody, nobody});
    }

    std::vector<Contradiction> found() {
        for (std::size_t i = 0; i < loads_.size(); ++i)
            if (prescribes_motion(loads_[i])) add_motion(i);
        for (std::size_t i = 0; i < loads_.size(); ++i) {
            if (is_traction(loads_[i])) check_traction(i);
            if (loads_[i].kind == Load::Kind::force) check_force(i);
        }
        return std::move(found_);
    }

private:
    using Drivers = std::array<Index, 2>;  // load that prescribes x, y

    void add_motion(std::size_t number) {
        const Load& load = loads_[number];
        const std::vector<char> held = held_corners(model_, load.on), selected = selected_corners(mesh_, load.on);
        for (int k = 0; k < 2; ++k) {
            if (!load.value[k]) continue;
            for (Index c = 0; c < mesh_.n_corners(); ++c) {
                if (!held[c]) continue;
                Index& driver = driver_[c][k];
                if (driver != nobody && !agree(driver, number, k)) report(Contradiction::Kind::motions, driver, number, k, mesh_.corner(c));
                driver = static_cast<Index>(number);
            }
        }
        if (!load.on.boundary.empty()) {
            for (const std::size_t e : selected_edges(mesh_, load.on)) take_edge(e, number);
            return;
        }
        for (std::size_t e = 0; e < mesh_.boundary_edges.size(); ++e) {
            const auto& [triangle, side, boundary] = mesh_.boundary_edges[e];
            const Index first = mesh_.corners_per_triangle() * triangle;
            if (selected[first + side] && selected[first + (side + 1) % 3]) take_edge(e, number);
        }
    }

    void take_edge(std::size_t edge, std::size_t number) {
        for (int k = 0; k < 2; ++k)
            if (loads_[number].value[k]) driver_of_edge_[edge][k] = static_cast<Index>(number);
    }

    /// [Pa] with which a load acts on an edge, and its size in any direction.
    std::pair<Vec2, double> traction_on(const Load& load, Index triangle, Index side) const {
        if (load.kind == Load::Kind::traction) {
            const Vec2 traction(load.value[0].value_or(0), load.value[1].value_or(0));
            return {traction, traction.norm()};
        }
        const auto& [xx, yy, xy] = load.stress;
        const Vec2 normal = -turned_left((mesh_.corner(triangle, (side + 1) % 3) - mesh_.corner(triangle, side)).normalized());
        return {Vec2(xx * normal.x() + xy * normal.y(), xy * normal.x() + yy * normal.y()), std::max({std::abs(xx), std::abs(yy), std::abs(xy)})};
    }

    void check_traction(std::size_t number) {
        for (const std::size_t e : selected_edges(mesh_, loads_[number].on)) {
            const auto& [triangle, side, boundary] = mesh_.boundary_edges[e];
            const auto [traction, size] = traction_on(loads_[number], triangle, side);
            for (int k = 0; k < 2; ++k)
                if (driver_of_edge_[e][k] != nobody && std::abs(traction[k]) > 1e-9 * size)
                    report(Contradiction::Kind::traction, driver_of_edge_[e][k], number, k, 0.5 * (mesh_.corner(triangle, side) + mesh_.corner(triangle, (side + 1) % 3)));
        }
    }

    /// A force that acts on nothing but what is driven.
    void check_force(std::size_t number) {
        const std::vector<char> selected = selected_corners(mesh_, loads_[number].on);
        for (int k = 0; k < 2; ++k) {
            if (loads_[number].value[k].value_or(0) == 0) continue;
            Index driver = nobody, corner = 0;
            bool some_free = false;
            for (Index c = 0; c < mesh_.n_corners() && !some_free; ++c) {
                if (!selected[c]) continue;
                if (driver_[c][k] == nobody) some_free = true;
                else if (driver == nobody) driver = driver_[c][k], corner = c;
            }
            if (!some_free && driver != nobody) report(Contradiction::Kind::force, driver, number, k, mesh_.corner(corner));
        }
    }

    /// Asked at every node that two loads share, mostly for the same two.
    bool agree(Index driver, std::size_t number, int k) {
        if (driver != last_.driver || number != last_.number || k != last_.k)
            last_ = {driver, number, k, same_motion(loads_[driver], loads_[number], k)};
        return last_.agree;
    }

    void report(Contradiction::Kind kind, Index driver, std::size_t number, int k, const Vec2& where) {
        const std::array<std::size_t, 2> pair{std::min<std::size_t>(driver, number), std::max<std::size_t>(driver, number)};
        const auto same = [&](const Contradiction& c) { return c.load == pair && c.component == k && c.kind == kind; };
        if (std::none_of(found_.begin(), found_.end(), same)) found_.push_back({kind, pair, k, where});
    }

    struct Pair {
        Index driver = nobody;
        std::size_t number = 0;
        int k = 0;
        bool agree = true;
    };

    const Model& model_;
    const Mesh& mesh_;
    const std::vector<Load>& loads_;
    std::vector<Drivers> driver_, driver_of_edge_;  // per corner, per boundary edge
    Pair last_;
    std::vector<Contradiction> found_;
};

}  // namespace

std::vector<Contradiction> find_contradictions(const Model& model, const std::vector<Load>& loads) {
    const auto n = std::count_if(loads.begin(), loads.end(), prescribes_motion);
    if (n == 0 || loads.size() < 2) return {};
    return Search(model, loads).found();
}

}  // namespace knap
