#include "stepper/common/crack_forces.hpp"

#include <algorithm>

namespace knap {

CrackForces::CrackForces(const Model& model) : model_(model) {
    if (model.crack_fluids.empty()) return;
    interfaces_at_ = {model.mesh.vertices.size(), [&](const auto& visit) {
                          for (std::size_t i = 0; i < model.interfaces.size(); ++i)
                              for (const Index v : model.interfaces[i].vertex) visit(v, static_cast<Index>(i));
                      }};
    is_broken_.assign(model.n_points(), 0);
    for (const CrackFluid& fluid : model.crack_fluids) {
        Reached& reached = fluids_.emplace_back(Reached{.vertices = fluid.is_source, .points = fluid.joint_points});
        reached.is_point.assign(model.n_points(), 0);
        for (const Index p : reached.points) reached.is_point[p] = 1;
    }
}

void CrackForces::take_broken(const State& state) {
    new_.clear();
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const auto points = model_.points(model_.fans[state.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Index p = points[j].point;
            if (is_broken_[p] || points[j].on_support() || state.points[state.first_point[s] + j].cohesion > 0)
                continue;
            is_broken_[p] = 1;
            new_.push_back(p);
        }
    }
}

bool CrackForces::is_passable(Index interface) const {
    const Index n = model_.points_per_interface();
    return std::all_of(&is_broken_[n * interface], &is_broken_[n * interface] + n, [](auto broken) { return broken; });
}

/// From the vertices of an interface that are reached, and on through others.
void CrackForces::enter(Index interface, Reached& reached) {
    std::vector<Index> next{interface};
    const Index n = model_.points_per_interface();
    while (!next.empty()) {
        const Index i = next.back();
        next.pop_back();
        const auto& [a, b] = model_.interfaces[i].vertex;
        if (!reached.vertices[a] && !reached.vertices[b]) continue;
        const bool passes = is_passable(i);
        for (Index k = 0; k < n; ++k) {
            const bool at_reached_vertex =
                k < 2 ? reached.vertices[k == 0 ? a : b] != 0 : true;  // places: the ends, the middle
            if (!is_broken_[n * i + k] || !(at_reached_vertex || passes) || reached.is_point[n * i + k]) continue;
            reached.is_point[n * i + k] = 1;
            reached.points.push_back(n * i + k);
        }
        for (const Index v : {a, b}) {
            if (!passes || reached.vertices[v]) continue;
            reached.vertices[v] = 1;
            for (const Index other : interfaces_at_[v]) next.push_back(other);
        }
    }
}

/// visit(point, pressure for an amplitude of 1, fluid)
template <class Visit>
void CrackForces::for_each_pressed(const State& state, const Visit& visit) {
    if (empty()) return;
    take_broken(state);
    for (std::size_t f = 0; f < fluids_.size(); ++f) {
        Reached& reached = fluids_[f];
        for (const Index p : new_) enter(model_.interface_of(p), reached);
        if (!new_.empty()) std::ranges::sort(reached.points);
        const CrackFluid& fluid = model_.crack_fluids[f];
        for (const Index p : reached.points) {
            if (state.has_retired(p)) continue;
            const FanPoint& point = model_.fan_points[model_.fan_point_of[p]];
            visit(point,
                  fluid.over_temperature.empty() ? fluid.pressure
                                                 : fluid.over_temperature(temperature_at(*state.temperature, point)),
                  fluid);
        }
    }
}

const std::vector<CornerLoad>& CrackForces::find(const State& state) {
    forces_.clear();
    for_each_pressed(state, [&](const FanPoint& point, double pressure, const CrackFluid& fluid) {
        const Vec2 force = pressure * point.area * point_frame(model_, state, point).turned(point.normal);
        forces_.push_back({point.after, fluid.history, force});
        forces_.push_back({point.before, fluid.history, -force});
    });
    return forces_;
}

std::vector<double> CrackForces::pressures(const State& state) {
    std::vector<double> found(model_.n_points(), 0.0);
    for_each_pressed(state, [&](const FanPoint& point, double pressure, const CrackFluid& fluid) {
        found[point.point] += model_.histories[fluid.history](state.time) * pressure;
    });
    return found;
}

std::vector<double> CrackForces::wetted(const State& state) {
    std::vector<double> length(fluids_.size(), 0.0);
    for_each_pressed(state, [&](const FanPoint& point, double, const CrackFluid& fluid) {
        length[&fluid - model_.crack_fluids.data()] += point.area / model_.thickness;
    });
    return length;
}

}  // namespace knap
