#include "app/setup/excavations.hpp"

#include "analysis/probes.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "mesh/polygon.hpp"
#include "model/selections.hpp"
#include "model/successor.hpp"
#include "stepper/step_control.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

constexpr double far_from_outline = 0.25;  // [-] of an edge: the mesh may move an outline by less, to fit other lines

std::string path_of(const PlannedExcavation& planned) { return item("excavation", planned.number); }

/// In the order of time; with the regions of all triangles.
std::vector<PlannedExcavation> regions_of(const std::vector<Excavation>& excavations, const Mesh& mesh) {
    std::vector<PlannedExcavation> planned;
    for (std::size_t i = 0; i < excavations.size(); ++i)
        planned.push_back({i, excavations[i].at, excavations[i].ramp, triangles_in(mesh, excavations[i].outline)});
    std::ranges::stable_sort(planned, {}, &PlannedExcavation::at);
    return planned;
}

/// Triangles that vanish, over the whole run.
std::vector<std::uint8_t> all_vanished(const std::vector<PlannedExcavation>& planned, const Mesh& mesh) {
    std::vector<std::uint8_t> vanished(mesh.n_triangles(), 0);
    for (const PlannedExcavation& one : planned)
        for (const Index t : one.triangles) vanished[t] = 1;
    return vanished;
}

void refuse_lost_probes(const ReadResult& read, const Model& rest) {
    using Watch = ProbeOptions::Watch;
    for (std::size_t i = 0; i < read.scenario.probes.size(); ++i) {
        const ProbeOptions& probe = read.scenario.probes[i];
        const std::string path = item("probe", i);
        const auto refuse = [&](const std::string& message) {
            throw UserError({read.at(path, {.code = "excavated",
                                            .message = message,
                                            .note = "another place, or time.end before the excavation"})});
        };
        try {
            if (!Probes(rest, {probe}).first_lost()) continue;
        } catch (const SimulationError& error) {
            refuse(std::string("after the excavations ") + error.what());
        }
        refuse(formatted("`%s` `%s` watches %s that an excavation removes", path.c_str(), probe.name.c_str(),
                         probe.watch == Watch::interface ? "an interface" : "a place"));
    }
}

void refuse_lost_absorption(const ReadResult& read, const Model& rest) {
    const std::vector<Selection>& absorbing = read.scenario.time.scheme.absorbing;
    for (std::size_t i = 0; i < absorbing.size(); ++i)
        if (selected_edges(rest.mesh, absorbing[i]).empty())
            throw UserError({read.at(item("absorb", i),
                                     {.code = "excavated",
                                      .message = "`" + item("absorb", i) + "` loses all of its boundary to excavations",
                                      .note = "remove it, or make the region smaller"})});
}

/// Largest distance between a polygon and the middle of an edge between triangles in it and others [edge].
double distance_from_outline(const Mesh& mesh, const std::vector<Vec2>& outline, const std::vector<Index>& triangles) {
    const std::vector<Segment> sides = sides_of(outline, true);
    double largest = 0;
    for (const InteriorEdge& edge : edges_around(mesh, triangles)) {
        const Vec2 along = mesh.side_vector(edge.triangle[0], edge.side[0]),
                   middle = mesh.corner(edge.triangle[0], edge.side[0]) + 0.5 * along;
        double distance = infinity;
        for (const Segment& side : sides) distance = std::min(distance, distance_to_segment(side.a, side.b, middle));
        largest = std::max(largest, distance / along.norm());
    }
    return largest;
}

/// The boundary, along which drivers act and gauges are, and single places of gauges.
bool measures_at(const SpecimenOptions& specimen, const Mesh& mesh, const std::vector<Index>& triangles,
                 const std::vector<Vec2>& outline) {
    for (const auto& gauge : {specimen.axial, specimen.lateral})
        if (gauge && std::ranges::any_of(*gauge, [&](const GaugeEnd& end) {
                return end.kind == GaugeEnd::Kind::place && contains(outline, end.at);
            }))
            return true;
    return std::ranges::any_of(mesh.boundary_edges, [&](const BoundaryEdge& edge) {
        return std::ranges::find(triangles, edge.triangle) != triangles.end();
    });
}

}  // namespace

std::vector<PlannedExcavation> plan_excavations(const ReadResult& read, const Model& model) {
    std::vector<PlannedExcavation> planned = regions_of(read.scenario.excavations, model.mesh);
    if (planned.empty()) return planned;
    std::vector<std::uint8_t> vanished(model.mesh.n_triangles(), 0);
    Index n_left = model.mesh.n_triangles();
    const auto refuse = [&](const PlannedExcavation& at, const char* problem, const char* cure) {
        const std::string path = path_of(at);
        throw UserError(
            {read.at(path, {.code = "empty-selection", .message = "`" + path + "` " + problem, .note = cure})});
    };
    for (PlannedExcavation& one : planned) {
        std::erase_if(one.triangles, [&](Index t) { return vanished[t] != 0; });
        for (const Index t : one.triangles) vanished[t] = 1;
        n_left -= static_cast<Index>(one.triangles.size());
        if (one.triangles.empty())
            refuse(one, "covers no triangle of the body that is there at its time",
                   "a region in the body, at least as large as a triangle; coordinates without a unit are in metres");
        if (n_left == 0) refuse(one, "leaves nothing of the body", "a smaller region");
        if (const auto& specimen = read.scenario.specimen;
            specimen &&
            measures_at(*specimen, model.mesh, one.triangles, read.scenario.excavations[one.number].outline))
            refuse(
                one, "takes a place at which the stress or the strains of the specimen are measured",
                "a region inside the specimen and beside its gauges, or probes and reactions in place of [specimen]");
    }
    std::vector<Index> all;
    for (const PlannedExcavation& one : planned) all.insert(all.end(), one.triangles.begin(), one.triangles.end());
    const Model rest = without(model, all);
    refuse_lost_probes(read, rest);
    refuse_lost_absorption(read, rest);
    return planned;
}

std::vector<Diagnostic> findings_of_excavations(const ReadResult& read, const Model& model) {
    const Mesh& mesh = model.mesh;
    const std::vector<PlannedExcavation> planned = regions_of(read.scenario.excavations, mesh);
    std::vector<Diagnostic> found;
    const auto warn = [&](const std::string& path, std::string text, const char* note) {
        found.push_back(read.at(path, {.severity = Diagnostic::Severity::warning,
                                       .code = "excavated",
                                       .message = "`" + path + "` " + std::move(text),
                                       .note = note}));
    };
    for (const PlannedExcavation& one : planned) {
        const std::vector<Vec2>& outline = read.scenario.excavations[one.number].outline;
        if (const double off = distance_from_outline(mesh, outline, one.triangles); off > far_from_outline)
            warn(path_of(one),
                 formatted("does not follow edges of the mesh: its faces are off by up to %.2g edges", off),
                 "a mesh with edges along the outline");
    }
    const std::vector<std::uint8_t> vanished = all_vanished(planned, mesh);
    const auto is_lost = [&](Index corner) { return vanished[mesh.triangle_of(corner)] != 0; };
    std::vector<Index> lost(model.histories.size(), 0);  // corners, per load
    for (const CornerLoad& load : model.corner_loads) lost[load.history] += is_lost(load.corner);
    for (Index c = 0; c < mesh.n_corners(); ++c)
        if (const PrescribedMotion* motion = model.motion_of(c); motion && is_lost(c))
            for (int k = 0; k < 2; ++k) lost[motion->history[k]] += motion->component[k];
    for (std::size_t i = 0; i < read.scenario.loads.size(); ++i) {  // histories behind them are those of fluids
        const Load::Kind kind = read.scenario.loads[i].kind;
        if (lost[i] > 0 && kind != Load::Kind::body_force && kind != Load::Kind::acceleration)
            warn(item("load", i), "acts on a region that vanishes: that part of it ends there",
                 "the rest of the load stays as it is");
    }
    const auto is_gone = [&](const Interface& interface) {
        return interface.triangle[0] == rigid_support && vanished[interface.triangle[1]] != 0;
    };
    if (!planned.empty() && std::ranges::any_of(model.interfaces, is_gone))
        warn(path_of(planned.front()), "or another one takes a part of a support with it", "");
    return found;
}

bool Excavations::is_due(const State& now) const {
    return done_.size() < planned_.size() && StepControl::has_reached(now, planned_[done_.size()].at);
}

std::string Excavations::moved_warning(const Model& model, const State& now) const {
    const PlannedExcavation& planned = planned_[done_.size()];
    double largest = 0, moved = 0;  // [-] of an edge, [m]
    Vec2 place = Vec2::Zero();
    for (const Index t : planned.triangles) {
        const Index corner = model.mesh.corners_per_triangle() * t;
        const Vec2& u = now.displacement_of(corner);
        const double in_edges = u.norm() / model.mesh.side_vector(t, 0).norm();
        if (in_edges > largest) largest = in_edges, moved = u.norm(), place = model.mesh.corner(corner) + u;
    }
    if (largest <= 1) return "";
    return formatted(
        "warning[excavated]: at t = %s `%s` removes what was in its region at the start, which has moved by up to %s "
        "since, to %s; what is in the region now stays\n",
        readable(now.time, "s", 6).c_str(), path_of(planned).c_str(), readable(moved, "m").c_str(),
        place_text(place).c_str());
}

double Excavations::step_size(const State& now, double h) const {
    constexpr double nearly = 1e-3;  // [-] of a step
    const double left = done_.size() < planned_.size() ? planned_[done_.size()].at - now.time : infinity;
    return left > nearly * h && left < h ? left : h;
}

/// [0/1] Per triangle: it vanishes next.
std::vector<std::uint8_t> Excavations::next_region(const Model& model) const {
    std::vector<std::uint8_t> vanishes(model.mesh.n_triangles(), 0);
    for (const Index t : planned_[done_.size()].triangles) vanishes[t] = 1;
    return vanishes;
}

std::string Excavations::prepare(const Model& model, MoreauJean& stepper, const State& now, const State& trial,
                                 double h) {
    contacts_ = lasting_contacts(model, stepper, now, trial, h, next_region(model));
    return moved_warning(model, now);
}

std::string Excavations::perform(const State& trial, const SchemeOptions& scheme, Model& model, State& now,
                                 ExcavationEnergies& energies) {
    const PlannedExcavation& planned = planned_[done_.size()];
    Done done{.time = now.time};
    double area = 0;
    for (const Index t : planned.triangles) area += model.mesh.area(t);
    std::vector<CornerLoad> forces = released_forces(model, now, trial, scheme, next_region(model), contacts_);
    Excavated rest = excavate(model, now, planned.triangles, scheme.mass);
    std::ranges::copy(released_pressures(model, now, rest.model, rest.state), std::back_inserter(forces));
    Vec2 total = Vec2::Zero();
    for (const CornerLoad& at : forces) {
        total += at.force;
        if (planned.ramp > 0) done.corner.push_back(at.corner), done.force.push_back(at.force);
    }
    model = std::move(rest.model), now = std::move(rest.state), energies = rest.energies;
    done_.push_back(std::move(done));
    release_forces(done_.size() - 1, model);
    return formatted(
        "excavation[%zu]: %zu triangles, %.6g m2, vanish at t = %s, step %lld; the resultant of their forces, (%.6g, "
        "%.6g) N, ends in %s\n",
        planned.number, planned.triangles.size(), area, readable(now.time, "s", 9).c_str(),
        static_cast<long long>(now.n_steps), total.x(), total.y(), readable(planned.ramp, "s", 6).c_str());
}

void Excavations::release_forces(std::size_t number, Model& model) const {
    const Done& done = done_[number];
    std::vector<CornerLoad> loads;
    for (std::size_t i = 0; i < done.corner.size(); ++i)
        loads.push_back({.corner = done.corner[i], .history = -1, .force = done.force[i]});
    if (planned_[number].ramp > 0) release(loads, done.time, planned_[number].ramp, model);
}

void Excavations::repeat(Model& model) const {
    for (std::size_t i = 0; i < done_.size(); ++i) {
        model = without(std::move(model), planned_[i].triangles);
        release_forces(i, model);
    }
}

}  // namespace knap
