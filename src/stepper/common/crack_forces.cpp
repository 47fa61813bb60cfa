#include "stepper/common/crack_forces.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "stepper/common/surface_energy.hpp"

#include <algorithm>

namespace knap {

CrackForces::CrackForces(const Model& model) : model_(model) {
    if (model.crack_fluids.empty()) return;
    interfaces_at_ = {model.mesh.vertices.size(), [&](const auto& visit) {
                          for (std::size_t i = 0; i < model.interfaces.size(); ++i)
                              for (const Index v : model.interfaces[i].vertex) visit(v, static_cast<Index>(i));
                      }};
    for (const CrackFluid& fluid : model.crack_fluids) {
        Reached& reached = fluids_.emplace_back();
        reached.vertices = fluid.is_source, reached.points = fluid.joint_points;
        reached.is_point.assign(model.n_points(), 0);
        reached.is_open = reached.is_point;
        for (const Index p : reached.points) reached.is_point[p] = 1;
    }
    if (model.has_injected_fluids()) of_corner_.assign(model.mesh.n_corners(), Vec2::Zero());
}

void CrackForces::take_open(const State& state, bool damaged, Reached& reached, std::vector<Index>& taken) const {
    taken.clear();
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const auto points = model_.points(model_.fans[state.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Index p = points[j].point;
            const double cohesion = state.points[state.first_point[s] + j].cohesion;
            if (reached.is_open[p] || points[j].on_support() || (damaged ? cohesion >= 1 : cohesion > 0)) continue;
            reached.is_open[p] = 1;
            taken.push_back(p);
        }
    }
}

bool CrackForces::is_passable(Index interface, const Reached& reached) const {
    const Index n = model_.points_per_interface();
    const auto first = reached.is_open.begin() + n * interface;
    return std::all_of(first, first + n, [](auto open) { return open; });
}

/// From the vertices of an interface that are reached, and on through others.
void CrackForces::enter(Index interface, Reached& reached) const {
    std::vector<Index> next{interface};
    const Index n = model_.points_per_interface();
    while (!next.empty()) {
        const Index i = next.back();
        next.pop_back();
        const auto& [a, b] = model_.interfaces[i].vertex;
        if (!reached.vertices[a] && !reached.vertices[b]) continue;
        const bool passes = is_passable(i, reached);
        for (Index k = 0; k < n; ++k) {
            const bool at_reached_vertex =
                k < 2 ? reached.vertices[k == 0 ? a : b] != 0 : true;  // places: the ends, the middle
            if (!reached.is_open[n * i + k] || !(at_reached_vertex || passes) || reached.is_point[n * i + k]) continue;
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

void CrackForces::follow(const State& state) {
    bool grows = false;
    for (std::size_t f = 0; f < fluids_.size(); ++f) {
        Reached& reached = fluids_[f];
        take_open(state, model_.crack_fluids[f].given.in_process_zone, reached, new_);
        for (const Index p : new_) enter(model_.interface_of(p), reached);
        if (new_.empty()) continue;
        std::ranges::sort(reached.points);
        grows = true;
    }
    if (fluids_.size() < 2 || !model_.has_injected_fluids() || (are_apart_ && !grows)) return;
    keep_apart();
    are_apart_ = true;
}

/// An injected fluid is alone in its cracks: its volume is that of all of them.
void CrackForces::keep_apart() const {
    for (std::size_t f = 0; f < fluids_.size(); ++f) {
        if (!model_.crack_fluids[f].given.is_injected()) continue;
        for (std::size_t g = 0; g < fluids_.size(); ++g) {
            if (g == f) continue;
            for (const Index p : fluids_[f].points)
                if (fluids_[g].is_point[p])
                    throw SimulationError(
                        "the fluids of two `[[pressure]]` meet at " +
                        place_text(model_.mesh.vertices[model_.interfaces[model_.interface_of(p)].vertex[0]]) +
                        ", and one of them has a `rate`: its volume is that of the whole crack. Give one "
                        "`[[pressure]]` with the sum of the rates, or end the run before they meet");
        }
    }
}

double CrackForces::injected(std::size_t fluid, double time) const {
    const CrackFluid& of = model_.crack_fluids[fluid];
    return of.given.rate * model_.thickness * of.given.history.integral(of.only_time.value_or(time));
}

double CrackForces::volume(std::size_t fluid, const State& state) const {
    double sum = 0;
    for_each_point(fluid, state, [&](const FanPoint& point, double) {
        sum += point.area * state.opening_of(point, point_frame(model_, state, point)).x();
    });
    return sum;
}

double CrackForces::length(std::size_t fluid, const State& state) const {
    double sum = 0;
    for_each_point(fluid, state, [&](const FanPoint& point, double) { sum += point.area / model_.thickness; });
    return sum;
}

/// A sharp crack takes G_c times its growth. A point counts by what it has taken of that, also in the process zone,
/// wet or not.
double CrackForces::sharp_crack(std::size_t fluid, const State& state) const {
    Reached entered = fluids_[fluid];
    std::vector<Index> damaged;
    if (!model_.crack_fluids[fluid].given.in_process_zone) take_open(state, true, entered, damaged);
    for (const Index p : damaged) enter(model_.interface_of(p), entered);
    std::ranges::sort(entered.points);
    double sum = 0;
    for (const Index p : entered.points) {
        const FanPoint& point = model_.fan_points[model_.fan_point_of[p]];
        sum += point.area / model_.thickness * taken_part(model_, state, point);
    }
    return sum;
}

Vec2 CrackForces::place(std::size_t fluid, const State& state) const {
    double widest = -infinity;
    Vec2 found = Vec2::Zero();
    for_each_point(fluid, state, [&](const FanPoint& point, double) {
        const double opening = state.opening_of(point, point_frame(model_, state, point)).x();
        if (opening > widest) widest = opening, found = model_.mesh.corner(point.corner());
    });
    return found;
}

std::vector<std::size_t> CrackForces::injected_fluids() const {
    std::vector<std::size_t> found;
    for (std::size_t f = 0; f < fluids_.size(); ++f)
        if (model_.crack_fluids[f].given.is_injected()) found.push_back(f);
    return found;
}

/// visit(point, pressure for an amplitude of 1) of one fluid; `injected` [Pa]: its pressure, if it is injected.
template <class Visit>
void CrackForces::for_each_pressed(std::size_t fluid, const State& state, double time, double injected,
                                   const Visit& visit) const {
    const CrackFluid& of = model_.crack_fluids[fluid];
    const CrackPressure& given = of.given;
    const auto without_gradient = [&](const FanPoint& point) {
        if (given.is_injected()) return injected;
        if (!given.over_temperature.empty()) return given.over_temperature(temperature_at(*state.temperature, point));
        if (!given.field) return given.pressure;
        return given.field->at(model_.mesh.corner(point.corner()), of.only_time.value_or(time))[0];
    };
    for_each_point(fluid, state, [&](const FanPoint& point, double offset) {
        const double pressure = without_gradient(point) + offset;
        if (given.gradient == 0) visit(point, pressure);
        else if (pressure > 0 || given.is_injected()) visit(point, std::max(0.0, pressure));  // above the water is none
    });
}

const std::vector<CornerLoad>& CrackForces::find(const State& state, double time, const std::vector<double>* given) {
    follow(state);
    return find_there(state, time, given);
}

const std::vector<CornerLoad>& CrackForces::find_there(const State& state, double time,
                                                       const std::vector<double>* given) {
    forces_.clear(), pressure_.clear();
    for (std::size_t f = 0; f < fluids_.size(); ++f) {
        const CrackFluid& fluid = model_.crack_fluids[f];
        pressure_.push_back(!fluid.given.is_injected() ? 0 : given ? (*given)[f] : pressure(f, volume(f, state), time));
        for_each_pressed(f, state, time, pressure_[f], [&](const FanPoint& point, double pressure) {
            const Vec2 force = pressure * point.area * point_frame(model_, state, point).turned(point.normal);
            forces_.push_back({point.after, fluid.history, force});
            forces_.push_back({point.before, fluid.history, -force});
        });
    }
    return forces_;
}

double CrackForces::mobility(std::size_t fluid, const State& state) const {
    const auto visit_parts = [&](const auto& visit) {
        for_each_point(fluid, state, [&](const FanPoint& point, double) {
            const Vec2 part = point.area * point_frame(model_, state, point).turned(point.normal);
            visit(point.after, part), visit(point.before, Vec2(-part));
        });
    };
    visit_parts([&](Index corner, const Vec2& part) { of_corner_[corner] += part; });
    double sum = 0;
    visit_parts([&](Index corner, const Vec2&) {
        sum += of_corner_[corner].squaredNorm() / model_.corner_mass[corner];
        of_corner_[corner].setZero();
    });
    return sum;
}

FluidBalance CrackForces::balance(std::size_t fluid, double volume, double time) const {
    const double entered = injected(fluid, time), compressed = storage(fluid) * pressure_[fluid];
    return {.excess = compressed + volume - entered, .scale = std::max({entered, std::abs(volume), compressed})};
}

/// [Pa] Of an injected fluid over the last step; at the start that of the state.
double CrackForces::shown_pressure(std::size_t fluid, const State& state) const {
    if (!model_.crack_fluids[fluid].given.is_injected()) return 0;
    return state.fluid_pressure.empty() ? pressure(fluid, volume(fluid, state), state.time)
                                        : state.fluid_pressure[fluid];
}

std::vector<double> CrackForces::pressures(const State& state) {
    std::vector<double> found(model_.n_points(), 0.0);
    follow(state);
    for (std::size_t f = 0; f < fluids_.size(); ++f) {
        const double amplitude = model_.histories[model_.crack_fluids[f].history](state.time);
        for_each_pressed(f, state, state.time, shown_pressure(f, state),
                         [&](const FanPoint& point, double pressure) { found[point.point] += amplitude * pressure; });
    }
    return found;
}

std::vector<FluidMoment> CrackForces::moments(const State& state) {
    std::vector<FluidMoment> found(fluids_.size());
    follow(state);
    for (std::size_t f = 0; f < fluids_.size(); ++f) {
        const CrackFluid& fluid = model_.crack_fluids[f];
        FluidMoment& moment = found[f];
        const double amplitude = model_.histories[fluid.history](state.time);
        for_each_pressed(f, state, state.time, shown_pressure(f, state), [&](const FanPoint& point, double pressure) {
            const double length = point.area / model_.thickness,
                         opening = state.opening_of(point, point_frame(model_, state, point)).x();
            moment.pressure += amplitude * pressure * length;
            moment.length += length;
            moment.volume += point.area * opening;
            moment.aperture = std::max(moment.aperture, opening);
        });
        moment.sharp_crack = sharp_crack(f, state);
        if (moment.length > 0) moment.pressure /= moment.length;
        if (!fluid.given.is_injected()) continue;
        moment.injected = injected(f, state.time);
        moment.pressure = shown_pressure(f, state);
    }
    return found;
}

}  // namespace knap
