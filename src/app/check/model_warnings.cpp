// Warnings about a scenario on its mesh.
#include "app/check/findings.hpp"

#include "analysis/free_motion.hpp"
#include "app/check/heat_scales.hpp"
#include "app/check/stress_balance.hpp"
#include "app/setup/excavations.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "mesh/polygon.hpp"
#include "mesh/size_field.hpp"
#include "model/selections.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>

namespace knap {
namespace {

std::string extent_text(const Box& box) { return "from " + place_text(box.low) + " to " + place_text(box.high); }

// ---- jumps of prescribed displacements

struct Jump {
    double size = 0, time = 0;  // [m], [s]
    void include(double other, double when) {
        if (other > size) size = other, time = when;
    }
};

/// The largest jump of a history times a value [m] before the end: from zero at t = 0, unless the run starts in
/// equilibrium; between two values at one time; and within less than a step where it is faster than `fast` [m/s].
Jump largest_jump(const TimeFunction& history, double value, const TimeOptions& time, double step, double fast) {
    Jump jump;
    if (!time.start_in_equilibrium && time.start_run.empty()) jump.include(std::abs(value * history(0)), 0);
    for (std::size_t i = 0; i + 1 < history.time.size(); ++i) {
        const double from = history.time[i], duration = history.time[i + 1] - from;
        if (from < 0 || from >= time.end || duration >= step) continue;
        const double moved =
            std::abs(value * ((duration > 0 ? history(from + step) : history.value[i + 1]) - history.value[i]));
        if (duration == 0 || moved > fast * step) jump.include(moved, from);
    }
    return jump;
}

// ---- places

bool in_mesh(const Mesh& mesh, const Vec2& x) {
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (in_triangle(mesh, t, x)) return true;
    return false;
}

// ---- details that reduce the stable step

constexpr double fewest_large_steps = 100;  // of a run; the strength is met to half a step over the time until then
constexpr std::size_t max_details = 5;      // that are named

/// A step far below the usual one. The worst triangle of a good mesh has a third of it; two lines a tenth of an edge
/// apart give less than this in every mesh.
constexpr double far_below = 1. / 7;

/// [s] The stable step of the median triangle, in passages of a wave through the mesh size at its place, times the
/// shortest of these passages. `size(t)` [m] is the mesh size at a triangle.
template <class Size>
double usual_step(const Model& model, const Size& size, const std::vector<double>& stable) {
    std::vector<double> in_passages;
    double shortest = infinity;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const double speed = model.materials[model.mesh.region[t]].dilatational_speed(model.plane),
                     passage = size(t) / speed;
        shortest = std::min(shortest, passage);
        in_passages.push_back(stable[t] / passage);
    }
    const auto middle = in_passages.begin() + static_cast<std::ptrdiff_t>(in_passages.size() / 2);
    std::ranges::nth_element(in_passages, middle);
    return *middle * shortest;
}

double distance_to_line(const std::vector<Vec2>& line, bool closed, const Vec2& x) {
    double smallest = infinity;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i)
        smallest = std::min(smallest, distance_to_segment(line[i], line[(i + 1) % line.size()], x));
    return smallest;
}

/// A part of the shape near a place.
struct NearPart {
    double distance;   // [m]
    std::string path;  // of its table
    bool is_crack;
};

/// The parts of the shape within `reach` of a place, nearest first.
std::vector<NearPart> parts_near(const Scenario& scenario, const Vec2& x, double reach) {
    std::vector<NearPart> parts;
    const auto add = [&](const std::string& path, const std::vector<Vec2>& line, bool closed) {
        if (const double d = distance_to_line(line, closed, x); d < reach) parts.push_back({d, path, !closed});
    };
    for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
        const Body& body = scenario.bodies[b];
        const auto add_all = [&](PlacedSet::Part part, const std::string& list, const auto& lines, bool closed) {
            for (std::size_t i = 0; i < lines.size(); ++i)
                add(scenario.table_of_part(b, part, i, body.path + list), lines[i].points, closed);
        };
        add(body.path, body.shape.outer.points, true);
        add_all(PlacedSet::Part::holes, ".hole", body.shape.holes, true);
        add_all(PlacedSet::Part::cracks, ".crack", body.shape.cracks, false);
        add_all(PlacedSet::Part::regions, ".region", body.shape.regions, true);
    }
    std::ranges::stable_sort(parts, {}, &NearPart::distance);
    return parts;
}

/// "`joints[0]` and `domain.hole[0]`", "two parts of `joints[0]`"
std::string culprits(const std::vector<NearPart>& parts) {
    if (parts.empty()) return "the mesh";
    if (parts.size() == 1) return "a detail of `" + parts[0].path + "`";
    if (parts[0].path == parts[1].path) return "two parts of `" + parts[0].path + "`";
    const auto [first, second] = std::minmax(parts[0].path, parts[1].path);  // one name, whichever is nearer
    return "`" + first + "` and `" + second + "`";
}

/// The snap that would join what lies side by side, for cracks among the two nearest parts.
std::string snap_cure(const Body& body, const std::vector<NearPart>& parts, double size) {
    constexpr double joins = 0.2;  // [mesh size]
    const bool of_crack = std::ranges::any_of(parts | std::views::take(2), &NearPart::is_crack);
    if (!of_crack || body.shape.snap >= joins * size) return "";
    return body.path + ".snap = \"" + readable(joins * size, "m") + "\" joins them; ";
}

// ---- numbers
constexpr double surely_short = 1e9;    // triangle-steps
constexpr double longest = 5 * 86400.;  // [s] of one core
constexpr double max_frames = 1e4, max_lines = 1e6, max_figure_times = 1e3;
constexpr double frame_bytes = 85;  // per triangle

/// The warnings on one scenario and its mesh.
class Warnings {
public:
    Warnings(const ReadResult& read, const Model& model) : read_(read), scenario_(read.scenario), model_(model) {}

    void on_resolution() {
        const char* const size = scenario_.given                  ? "mesh.file"
                                 : read_.values.has("adapt.size") ? "adapt.size"
                                                                  : "mesh.size";
        for (const Resolution& r : judge_resolution(scenario_, mesh_))
            if (r.steep_zone() == 0)
                add(size, "resolution",
                    formatted(
                        "the traction of the law `%s` (`%s`) drops at once, which no mesh resolves: crack speed and "
                        "branching will depend on the mesh",
                        r.law.c_str(), r.material.c_str()),
                    "a short slope instead of the drop, as plateau = 0.9, or accept the dependence on the mesh");
            else if (r.n_edges < 5)
                add(size, "resolution",
                    formatted("the process zone of `%s` (%s for a crack at rest%s) is covered by %.1f edges; crack "
                              "speed and branching will depend on the mesh",
                              r.material.c_str(), readable(r.steep_zone(), "m").c_str(),
                              r.steepness != 1 ? ", where the traction falls fastest" : "", r.n_edges),
                    "use a size of at most " + readable(r.steep_zone() / 5, "m", 2) +
                        " where cracks run, or accept the dependence on the mesh");
    }

    void on_heat(double step) {
        const bool is_explicit = !scenario_.time.scheme.takes_implicit_steps();
        const bool changes = scenario_.heat && scenario_.heat->changes();
        if (is_explicit && changes && 20 * scenario_.heat->every * step > scenario_.time.end)
            add("heat.every", "heat", "temperatures change fewer than 20 times until `time.end`",
                formatted("at most %.2g", std::max(1.0, scenario_.time.end / (20 * step))));
        for (const HeatScales& s : judge_heat(scenario_, mesh_, step)) {
            const double factor = scenario_.heat->time_factor, size_of_layer = s.layer() / 5;
            const char* const name = s.material.c_str();
            const std::string size = scenario_.given ? "mesh.file" : "mesh.size";
            if (factor > std::max(1.0, s.largest_time_factor()))
                add("heat.time_factor", "heat",
                    formatted("with `heat.time_factor` = %.6g cracks in `%s` that follow the heat over an edge of %s "
                              "run at %.2g of the Rayleigh speed, and radiate that part of their energy: inertia, "
                              "which no real crack has here, will count",
                              factor, name, readable(s.edge, "m").c_str(), s.radiated(factor)),
                    formatted("at most %.2g%s; the summary's kinetic_part tells afterwards",
                              std::max(1.0, s.largest_time_factor()), s.damped ? "" : " without time.damping"));
            if (!scenario_.heat->exchanges.empty() && s.layer() < 3 * s.edge)
                add(size, "heat",
                    formatted(
                        "heat enters `%s` by %s until `time.end`, %.1f edges: its temperature depends on the mesh",
                        name, readable(s.layer(), "m").c_str(), s.layer() / s.edge),
                    "a size of at most " + readable(size_of_layer, "m", 2) + " where it enters");
            if (s.convection > 0 && s.convection < s.edge)
                add(size, "heat",
                    formatted(
                        "convection cools a face of `%s` within a depth k/transfer of %s, %.1f edges: temperature "
                        "and stress of the face are wrong until %s of heat",
                        name, readable(s.convection, "m").c_str(), s.convection / s.edge,
                        readable(s.edge * s.edge / s.diffusivity, "s", 2).c_str()),
                    "a size of at most " + readable(s.convection, "m", 2) +
                        " at this face, or accept a later first crack");
            if (factor * s.step > s.passage / 20)
                add("time.step", "heat",
                    formatted("a step of %s is %.2g of the time in which heat crosses `%s`",
                              readable(step, "s").c_str(), factor * s.step / s.passage, name),
                    "some " + readable(s.passage / 200 / factor, "s", 2) + ", a 200th of it");
        }
    }

    void on_jumps(double step) {
        double wave = 0;
        for (const Elastic& material : model_.materials)
            wave = std::max(wave, material.dilatational_speed(model_.plane));
        const double fast = 0.1 * wave;  // beyond what a solid withstands
        const auto check = [&](const std::string& path, const Jump& jump) {
            if (jump.size > 0)
                add(path + ".displacement", "jump",
                    formatted("`%s.displacement` jumps by %s at t = %s: in a step of %s this is a velocity of %s, %.2g "
                              "times the wave speed",
                              path.c_str(), readable(jump.size, "m").c_str(), readable(jump.time, "s").c_str(),
                              readable(step, "s").c_str(), readable(jump.size / step, "m/s").c_str(),
                              jump.size / step / wave),
                    formatted("ramp = \"%s\" would move it at 1 m/s; or use a table that starts at 0; or time.start = "
                              "\"equilibrium\" for a displacement that exists before t = 0",
                              readable(jump.size, "s", 2).c_str()));
        };
        for (std::size_t i = 0; i < scenario_.loads.size(); ++i) {
            const Load& load = scenario_.loads[i];
            if (load.kind != Load::Kind::displacement) continue;
            const Vec2 value(load.value[0].value_or(0), load.value[1].value_or(0));
            check(item("load", i), largest_jump(load.history, value.norm(), scenario_.time, step, fast));
        }
        for (std::size_t i = 0; i < scenario_.obstacles.size(); ++i) {
            Jump jump;
            for (const Drive& drive : scenario_.obstacles[i].drive) {
                if (drive.kind != Drive::Kind::displacement) continue;
                const Jump other = largest_jump(drive.history, drive.value, scenario_.time, step, fast);
                jump.include(other.size, other.time);
            }
            check(item("obstacle", i), jump);
        }
    }

    /// A free body that starts with a spin turns in the end by the spin times the time, whatever happens inside; and
    /// theta above 1/2 brakes it.
    void on_spins(double step) {
        if (scenario_.initial_velocities.empty()) return;
        double spin = 0;  // [rad/s] the fastest
        for (const Fragment& body : free_fragments(model_, initial_state(model_)))
            if (std::abs(body.spin()) > std::abs(spin)) spin = body.spin();
        const std::size_t n = read_.values.count("initial");
        const std::string key = n > 0 ? item("initial", n - 1) : "body[0].spin";
        if (scenario_.large_rotation) return on_braked_spin(key, spin, step);
        constexpr double from = 5;  // [deg] where the gate warns
        const double angle = std::abs(spin) / degree * scenario_.time.end;
        if (angle >= from && std::ranges::count(scenario_.allowed_limits, "rotation", &AllowedLimit::gate) == 0)
            add(key, "spin",
                formatted("a free body starts with a spin of %.3g deg/s and turns by %.3g degrees until `time.end`; "
                          "small rotations are those below %.3g degrees",
                          spin / degree, angle, from),
                "domain.rotation = \"large\" (mesh.order = 1)");
    }

    void on_places() {
        std::ranges::move(findings_of_probes(read_, model_), std::back_inserter(found));
        std::ranges::move(findings_of_collectors(read_, model_), std::back_inserter(found));
        std::ranges::move(findings_of_crushed_discs(read_), std::back_inserter(found));
        for (const Body& body : scenario_.bodies) {
            const std::string list = body.path + ".region";
            const std::size_t n = std::min(read_.values.count(list), body.shape.regions.size());
            for (std::size_t i = 0; i < n; ++i) check_region(item(list, i), body.shape.regions[i]);
        }
        for (std::size_t i = 0; const RefinedPlace& place : scenario_.mesh.refine)
            check_box(item("mesh.refine", i++) + (place.line.empty() ? ".inside" : ".along"), place.box);
        for (const char* list : {"map", "figure"})
            for (std::size_t i = 0; i < read_.values.count(list); ++i)
                check_box(item(list, i) + ".box", read_.values.get<Box>(item(list, i) + ".box"));
    }

    /// Each detail once, by its slowest triangle.
    void on_details(const std::vector<double>& stable) {
        if (scenario_.given) return;
        const auto size = [&](Index t) { return SizeField(body_of(t).mesh, 1)(mesh_.centroid(t)); };
        const double usual = usual_step(model_, size, stable);
        std::vector<Index> slow;
        for (Index t = 0; t < mesh_.n_triangles(); ++t)
            if (stable[t] < far_below * usual) slow.push_back(t);
        std::ranges::stable_sort(slow, {}, [&](Index t) { return stable[t]; });
        std::vector<std::string> named;
        for (const Index t : slow) {
            const Vec2 a = mesh_.corner(t, 0), b = mesh_.corner(t, 1), c = mesh_.corner(t, 2), x = (a + b + c) / 3;
            const std::vector<NearPart> parts = parts_near(scenario_, x, 2 * size(t));
            const std::string who = culprits(parts);
            if (std::ranges::find(named, who) != named.end()) continue;
            named.push_back(who);
            if (named.size() > max_details) return;
            add(parts.empty() ? "mesh.size" : parts[0].path, "small-step",
                formatted(
                    "a triangle at %s has an edge of %s where the mesh size is %s; its stable step of %s is %.3g times "
                    "smaller than the %s of that size, and all triangles use the smallest one. Next to it: %s",
                    place_text(x).c_str(),
                    readable(std::min({(b - a).norm(), (c - b).norm(), (a - c).norm()}), "m").c_str(),
                    readable(size(t), "m").c_str(), readable(stable[t], "s").c_str(), usual / stable[t],
                    readable(usual, "s").c_str(), who.c_str()),
                std::string(who.find(" and ") != who.npos || who.starts_with("two parts")
                                ? "move one of them, let them meet, or remove the detail; "
                                : "enlarge or remove it; ") +
                    snap_cure(body_of(t), parts, size(t)) +
                    (std::ranges::any_of(scenario_.placed_sets, &PlacedSet::is_random)
                         ? "another seed places random traces elsewhere; "
                         : "") +
                    (may_scale_masses(scenario_)
                         ? "time.mass_scaling = \"1 %\" gives such triangles mass of their neighbours; "
                         : "") +
                    "bulk = \"implicit\" allows larger steps");
        }
    }

    void on_numbers(const StepPlan& plan, const Cost* cost) {
        const double end = scenario_.time.end, n_steps = static_cast<double>(plan.n_steps),
                     triangles = mesh_.n_triangles();
        const double seconds = cost != nullptr ? cost->least()
                               : n_steps * triangles > surely_short
                                   ? estimate_cost(scenario_, model_, plan, 0, 0.05).least()
                                   : 0;
        if (seconds > longest)
            add("time.end", "too-long",
                formatted("`time.end` = %s is %.3g steps of %s: about %s of one core", readable(end, "s", 6).c_str(),
                          n_steps, readable(plan.limits.largest, "s").c_str(), readable(seconds, "s", 2).c_str()),
                "use a smaller time.end (waves cross a body in micro- to milliseconds), larger triangles, or bulk = "
                "\"implicit\"");
        if (plan.limits.changes() && n_steps < fewest_large_steps)
            add("time.bulk", "few-steps",
                formatted("`time.bulk` = \"auto\" makes %.3g steps of %s of this run, at least 200 stable ones each: a "
                          "body that reaches its strength in one of the first bears up to twice of it at its end",
                          n_steps, readable(plan.limits.largest, "s").c_str()),
                formatted("bulk = \"explicit\" makes %.3g steps", end / plan.limits.change.explicit_step));
        const double explicit_step = plan.limits.changes() ? plan.limits.change.explicit_step : plan.limits.largest;
        if (const double part = scenario_.time.scheme.damping * explicit_step;
            part > 1 && scenario_.time.scheme.takes_explicit_steps())
            add("time.damping", "too-large",
                formatted("`time.damping` = %.6g Hz takes %.3g times the velocity in a step of %.3g s%s",
                          scenario_.time.scheme.damping, part, explicit_step,
                          part > 2 ? ", which then reverses in every step" : ""),
                "use a rate far below one over the step; vibrations decay as exp(-damping t/2)");
        const auto check = [&](const char* key, double every, double max, const char* what, double bytes) {
            const double n = every > 0 ? std::min(end / every, n_steps) : 0;
            if (n > max)
                add(key, "too-many",
                    formatted("`%s` = %s in a run of %s makes %.3g %s, some %.2g GB", key,
                              readable(every, "s", 6).c_str(), readable(end, "s", 6).c_str(), n, what,
                              1e-9 * n * bytes),
                    formatted("%s of %s makes a thousand", key, readable(end / 1000, "s", 1).c_str()));
        };
        check(scenario_.output.frame_every > 0 ? "output.frame_every" : "output.every",
              scenario_.output.between_frames(), max_frames, "frames", frame_bytes * triangles);
        check("output.history_every", scenario_.output.history_every, max_lines, "lines in each table", 500);
        for (std::size_t i = 0; i < scenario_.figures.size(); ++i)
            if (const auto n = static_cast<double>(scenario_.figures[i].at.size()); n > max_figure_times)
                add(item("figure", i) + ".at", "too-many", formatted("`figure[%zu]` draws %.6g pictures", i, n),
                    "use fewer times, or frames (output.every) and `knap render` for those of interest");
    }

    std::vector<Diagnostic> found;

private:
    void add(const std::string& key, const char* code, std::string message, std::string note) {
        found.push_back(read_.at(key, {.severity = Diagnostic::Severity::warning,
                                       .code = code,
                                       .message = std::move(message),
                                       .note = std::move(note)}));
    }

    void on_braked_spin(const std::string& key, double spin, double step) {
        const SchemeOptions& scheme = scenario_.time.scheme;
        constexpr double negligible = 0.01;  // as of the gate
        const double rate = braked_per_time(scheme.theta, step, spin), part = 1 - std::exp(-rate * scenario_.time.end);
        // (what spins moves, and bulk = "auto" resolves that by explicit steps)
        if (!scheme.takes_implicit_steps() || scheme.takes_explicit_steps() || part <= negligible) return;
        add(key, "braked-spin",
            formatted(
                "theta = %.6g takes %.2g %% of the spin of %.3g deg/s of a free body until `time.end` in implicit "
                "steps of %s, and more of its energy; the gate braked_spin tells how much it was",
                scheme.theta, 100 * part, spin / degree, readable(step, "s").c_str()),
            formatted("time.step = \"%s\" (1 %%), theta = 0.5, or bulk = \"explicit\"",
                      readable(step * negligible / (rate * scenario_.time.end), "s", 2).c_str()));
    }

    const Body& body_of(Index triangle) const {
        const auto part = std::ranges::find_if(
            mesh_.parts, [&](const MeshPart& p) { return triangle < p.first_triangle + p.n_triangles; });
        return scenario_.bodies[mesh_.parts.empty() ? 0 : part - mesh_.parts.begin()];
    }

    void check_region(const std::string& path, const Region& region) {
        const std::vector<Vec2>& points = region.points;
        const Box box = bounding_box(points);
        for (Index t = 0; t < mesh_.n_triangles(); ++t)
            if (const Vec2 middle = mesh_.centroid(t); box.contains(middle) && contains(points, middle)) return;
        add(path, "outside", "`" + path + "` covers no triangle of the body: it extends " + extent_text(box),
            "the body extends " + extent_text(box_) + "; a region must be at least as large as a triangle");
    }

    void check_box(const std::string& key, const std::optional<Box>& box) {
        if (!box ||
            (box->meets(box_) &&
             (std::ranges::any_of(mesh_.vertices, [&](const Vec2& x) { return box->contains(x); }) ||
              in_mesh(mesh_, 0.5 * (box->low + box->high)) || in_mesh(mesh_, box->low) || in_mesh(mesh_, box->high))))
            return;
        add(key, "outside", "`" + key + "` lies outside the body: " + extent_text(*box),
            "the body extends " + extent_text(box_) + "; coordinates without a unit are in metres");
    }

    const ReadResult& read_;
    const Scenario& scenario_;
    const Model& model_;
    const Mesh& mesh_ = model_.mesh;
    const Box box_ = bounding_box(mesh_.vertices);
};

}  // namespace

std::vector<Diagnostic> findings_of_places(const ReadResult& read, const Model& model) {
    Warnings warnings(read, model);
    warnings.on_places();
    return std::move(warnings.found);
}

std::vector<Diagnostic> findings_of_model(const ReadResult& read, const Model& model, const StepPlan& plan,
                                          const Cost* cost) {
    Warnings warnings(read, model);
    warnings.on_resolution();
    warnings.on_heat(plan.limits.largest);
    warnings.on_jumps(plan.limits.largest);
    warnings.on_spins(plan.limits.largest);
    warnings.on_places();
    warnings.on_details(plan.stable_of_triangle);
    warnings.on_numbers(plan, cost);
    for (const auto& others : {findings_of_excavations(read, model), findings_of_supports(read, model),
                               findings_of_fluids(read, model), findings_of_impacts(read, model, plan),
                               findings_of_steep_loads(read, model), findings_of_hot_start(read, model),
                               findings_of_initial_stress(read, model), findings_of_resting_bodies(read, model, plan),
                               findings_of_tables(read, model, plan), findings_of_bending(read, model)})
        warnings.found.insert(warnings.found.end(), others.begin(), others.end());
    return std::move(warnings.found);
}

}  // namespace knap
