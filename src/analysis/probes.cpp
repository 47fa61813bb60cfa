#include "analysis/probes.hpp"

#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "element/shape_functions.hpp"
#include "mesh/polygon.hpp"
#include "model/selections.hpp"

namespace knap {
namespace {

/// Barycentric coordinates of a place in a triangle.
Eigen::Vector3d barycentric(const Mesh& mesh, Index t, const Vec2& place) {
    const Vec2 a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a, ap = place - a;
    const double area = cross(ab, ac), b = cross(ap, ac) / area, c = cross(ab, ap) / area;
    return {1 - b - c, b, c};
}

/// Shape function of corner k at barycentric coordinates l.
double shape_function(Index order, Index k, const Eigen::Vector3d& l) {
    if (order == 1) return l[k];
    const double bubble = 27 * l[0] * l[1] * l[2];
    const double quadratic = k < 3 ? l[k] * (2 * l[k] - 1) : k < 6 ? 4 * l[k - 3] * l[(k - 2) % 3] : 0;
    return quadratic + bubble_weight[k] * bubble;
}

InterfaceMean mean_of(const Model& model, const State& state, Index interface) {
    const Index n = model.points_per_interface();
    InterfaceMean mean;
    for (Index p = n * interface; p < n * (interface + 1); ++p) {
        const double part =
            model.fan_points[model.fan_point_of[p]].area / (model.interfaces[interface].length * model.thickness);
        const Vec2 jump = opening(model, state, p);
        mean.opening += part * jump.x();
        mean.slip += part * jump.y();
        mean.cohesion += part * cohesion(model, state, p);
    }
    return mean;
}

}  // namespace

CornerMean::CornerMean(const Mesh& mesh, const Vec2& place, std::span<const std::uint8_t> vanished) {
    int n_triangles = 0;
    bool is_inside = false;
    const auto add_triangles_at = [&](const Vec2& point) {
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const Eigen::Vector3d parts = barycentric(mesh, t, point);
            if (parts.minCoeff() < -1e-9) continue;
            is_inside = true;
            if (!vanished.empty() && vanished[t]) continue;
            ++n_triangles;
            for (Index k = 0; k < mesh.corners_per_triangle(); ++k)
                weights_.push_back({mesh.corners_per_triangle() * t + k, shape_function(mesh.order, k, parts)});
        }
    };
    add_triangles_at(place);
    if (!is_inside) add_triangles_at(nearest_boundary(mesh, place).point);
    for (Weight& weight : weights_) weight.part /= n_triangles;
}

CornerMean::CornerMean(const Mesh& mesh, const std::string& boundary) {
    double length = 0;
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        if (mesh.boundary_names[edge.boundary] != boundary) continue;
        const Index first = mesh.corners_per_triangle() * edge.triangle, a = edge.side, b = (edge.side + 1) % 3;
        const double l = (mesh.corner(edge.triangle, b) - mesh.corner(edge.triangle, a)).norm();
        length += l;
        // trapezoidal rule, for second order Simpson's: exact for the displacement on the edge
        const double at_ends = mesh.order == 1 ? 0.5 : 1. / 6;
        for (const Index k : {a, b}) weights_.push_back({first + k, at_ends * l});
        if (mesh.order == 2) weights_.push_back({first + 3 + edge.side, 4. / 6 * l});
    }
    for (Weight& weight : weights_) weight.part /= length;
}

template <class Value>
auto CornerMean::mean(Value value) const {
    std::decay_t<decltype(value(0))> sum{};
    if constexpr (requires { sum.setZero(); }) sum.setZero();
    for (const Weight& weight : weights_) sum += weight.part * value(weight.corner);
    return sum;
}

Vec2 CornerMean::place(const Mesh& mesh) const {
    return mean([&](Index corner) -> Vec2 { return mesh.corner(corner); });
}

Vec2 CornerMean::displacement(const State& state) const {
    return mean([&](Index corner) -> Vec2 { return state.displacement[state.node_of_corner[corner]]; });
}

Vec2 CornerMean::velocity(const State& state) const {
    return mean([&](Index corner) -> Vec2 { return state.velocity[state.node_of_corner[corner]]; });
}

double CornerMean::temperature(const State& state) const {
    return mean([&](Index corner) -> double { return state.temperature->of_corner[corner]; });
}

std::span<const Measure<PlaceMotion>> place_columns() {
    using M = PlaceMotion;
    static constexpr Measure<M> columns[] = {
        {"_u_x", "m", "displacement of the place of a probe, x", [](const M& m) { return m.displacement.x(); }},
        {"_u_y", "m", "displacement of the place of a probe, y", [](const M& m) { return m.displacement.y(); }},
        {"_v_x", "m/s", "velocity of the place of a probe, x", [](const M& m) { return m.velocity.x(); }},
        {"_v_y", "m/s", "velocity of the place of a probe, y", [](const M& m) { return m.velocity.y(); }},
        {"_T", "K", "temperature of the place of a probe; with heat", [](const M& m) { return m.temperature; }}};
    return columns;
}

std::span<const Measure<InterfaceMean>> interface_columns() {
    using M = InterfaceMean;
    static constexpr Measure<M> columns[] = {
        {"_opening", "m", "opening of the interface of a probe, mean over its points",
         [](const M& m) { return m.opening; }},
        {"_slip", "m", "slip of the interface, mean over its points", [](const M& m) { return m.slip; }},
        {"_cohesion", "", "cohesion beta of the interface, mean over its points: 1 intact, 0 broken",
         [](const M& m) { return m.cohesion; }}};
    return columns;
}

std::span<const Measure<MeanStress>> stress_columns() {
    using M = MeanStress;
    static constexpr Measure<M> columns[] = {
        {"_stress_xx", "Pa", "mean stress in the box of a probe, or in the whole body; tension is positive",
         [](const M& m) { return m[0]; }},
        {"_stress_yy", "Pa", "likewise", [](const M& m) { return m[1]; }},
        {"_stress_xy", "Pa", "likewise", [](const M& m) { return m[2]; }}};
    return columns;
}

std::span<const Measure<TipFactors>> tip_columns() {
    using M = TipFactors;
    static constexpr Measure<M> columns[] = {
        {"_K_I", "Pa m^0.5",
         "stress intensity factor of opening of the tip of a probe; empty once an interface within its radius is "
         "damaged",
         [](const M& m) { return m.K_I; }},
        {"_K_II", "Pa m^0.5", "likewise of sliding: positive where the left face moves in the direction of the crack",
         [](const M& m) { return m.K_II; }},
        {"_J", "J/m2", "energy release rate of the same tip if it went straight on", [](const M& m) { return m.J; }}};
    return columns;
}

MeanStress Probes::mean_stress(const State& state, std::span<const Index> triangles) const {
    MeanStress sum = MeanStress::Zero();
    double area = 0;
    for (const Index t : triangles) {
        if (model_.has_vanished(t)) continue;
        sum += model_.mesh.area(t) * stress(model_, state, t);
        area += model_.mesh.area(t);
    }
    return sum / area;
}

namespace {

std::span<const Measure<PlaceMotion>> columns_of_place(const ProbeOptions& probe) {
    return place_columns().first(place_columns().size() - !probe.heat);
}

}  // namespace

std::vector<std::string> probe_columns(const ProbeOptions& probe) {
    switch (probe.watch) {
        case ProbeOptions::Watch::interface: return names_of(interface_columns(), probe.name);
        case ProbeOptions::Watch::stress: return names_of(stress_columns(), probe.name);
        case ProbeOptions::Watch::tip: return names_of(tip_columns(), probe.name);
        case ProbeOptions::Watch::place: break;
    }
    return names_of(columns_of_place(probe), probe.name);
}

Probes::Probes(const Model& model, const std::vector<ProbeOptions>& probes) : model_(model) {
    for (const ProbeOptions& probe : probes) probes_.push_back(placed(probe));
}

Probes::Probe Probes::placed(const ProbeOptions& probe) const {
    Probe made{.options = probe};
    switch (probe.watch) {
        case ProbeOptions::Watch::place: made.place = {model_.mesh, probe.at, model_.vanished}; break;
        case ProbeOptions::Watch::interface:
            made.interface = nearest_interface(model_, probe.at).interface;
            if (made.interface < 0)
                throw SimulationError("probe `" + probe.name + "` watches an interface, but no interface can open");
            break;
        case ProbeOptions::Watch::stress:
            made.triangles = selected_triangles(model_.mesh, {.boundary = "", .box = probe.box, .body = ""});
            if (made.triangles.empty())
                throw SimulationError("probe `" + probe.name + "` watches a box that contains no triangle");
            break;
        case ProbeOptions::Watch::tip:
            made.tip = std::make_unique<TipIntegral>(model_, probe.at, probe.radius, probe.name);
    }
    return made;
}

const ProbeOptions* Probes::first_lost() const {
    const auto is_lost = [&](const Probe& probe) {
        switch (probe.options.watch) {
            case ProbeOptions::Watch::interface: return model_.is_gone(model_.interfaces[probe.interface]);
            case ProbeOptions::Watch::stress:
                return std::ranges::all_of(probe.triangles, [&](Index t) { return model_.has_vanished(t); });
            case ProbeOptions::Watch::tip: return probe.tip->has_vanished();
            case ProbeOptions::Watch::place: break;
        }
        return probe.place.empty();
    };
    const auto lost = std::ranges::find_if(probes_, is_lost);
    return lost == probes_.end() ? nullptr : &lost->options;
}

void Probes::renew() {
    for (Probe& probe : probes_) {
        Probe renewed = placed(probe.options);
        renewed.interface = probe.interface;
        if (renewed.tip) renewed.tip->continue_from(std::move(*probe.tip));
        probe = std::move(renewed);
    }
}

std::vector<ProbeSubject> Probes::renumber(const State& now, const Renumbering& numbers) {
    std::vector<ProbeSubject> changed;
    for (Probe& probe : probes_) {
        const Index before = probe.interface, kept = before < 0 ? -1 : numbers.interface[before];
        probe = placed(probe.options);
        if (kept >= 0 &&
            (is_open_from_start(model_, model_.interfaces[kept]) || mean_of(model_, now, kept).cohesion < 1))
            probe.interface = kept;
        if (before >= 0 && probe.interface != kept) changed.push_back(subject(probe));
        if (probe.tip) probe.tip->after_step(now);  // accelerations are known again after one step
    }
    return changed;
}

ProbeSubject Probes::subject(const Probe& probe) const {
    const Mesh& mesh = model_.mesh;
    const ProbeOptions& options = probe.options;
    ProbeSubject subject{.probe = options.name};
    const auto set = [&](const char* watch, std::string kind, std::vector<Vec2> place, double distance) {
        subject.watch = watch, subject.kind = std::move(kind), subject.place = std::move(place);
        subject.distance = distance;
    };
    switch (options.watch) {
        case ProbeOptions::Watch::place: {
            const Vec2 place = probe.place.place(mesh);
            // rounding of the shape functions is no distance
            const double distance = (place - options.at).norm();
            set("place", "place", {place}, distance > 1e-9 * bounding_box(mesh.vertices).diagonal() ? distance : 0);
            break;
        }
        case ProbeOptions::Watch::interface: {
            const Interface& interface = model_.interfaces[probe.interface];
            const Vec2 a = mesh.vertices[interface.vertex[0]], b = mesh.vertices[interface.vertex[1]];
            set("interface", kind_of(model_, interface), {a, b}, distance_to_segment(a, b, options.at));
            break;
        }
        case ProbeOptions::Watch::stress:
            set("stress", "triangles", {}, 0);
            subject.n_triangles = static_cast<Index>(probe.triangles.size());
            break;
        case ProbeOptions::Watch::tip:
            set("tip", "tip of a pre-crack", {probe.tip->tip()}, (probe.tip->tip() - options.at).norm());
    }
    return subject;
}

std::vector<ProbeSubject> Probes::subjects() const {
    std::vector<ProbeSubject> all;
    for (const Probe& probe : probes_) all.push_back(subject(probe));
    return all;
}

std::string text_of(const ProbeSubject& subject) {
    if (subject.place.empty()) return formatted("%d triangles", subject.n_triangles);
    const std::string at = subject.place.size() == 1
                               ? " at " + place_text(subject.place[0])
                               : " from " + place_text(subject.place[0]) + " to " + place_text(subject.place[1]);
    return subject.kind + at +
           (subject.distance > 0 ? formatted(", %s from its place", readable(subject.distance, "m").c_str()) : "");
}

void Probes::after_step(const State& state) {
    for (Probe& probe : probes_)
        if (probe.tip) probe.tip->after_step(state);
}

std::vector<std::string> Probes::columns() const {
    std::vector<std::string> names{"time"};
    for (const Probe& probe : probes_)
        for (const std::string& column : probe_columns(probe.options)) names.push_back(column);
    return names;
}

std::vector<double> Probes::line(const State& state) const {
    std::vector<double> row{state.time};
    for (const Probe& probe : probes_) {
        if (probe.options.watch == ProbeOptions::Watch::interface)
            add_values(interface_columns(), mean_of(model_, state, probe.interface), row);
        else if (probe.options.watch == ProbeOptions::Watch::stress)
            add_values(stress_columns(), mean_stress(state, probe.triangles), row);
        else if (probe.tip) add_values(tip_columns(), probe.tip->factors(state), row);
        else
            add_values(columns_of_place(probe.options),
                       {probe.place.displacement(state), probe.place.velocity(state),
                        probe.options.heat ? probe.place.temperature(state) : 0},
                       row);
    }
    return row;
}

}  // namespace knap
