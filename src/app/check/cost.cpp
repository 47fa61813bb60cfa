#include "app/check/cost.hpp"

#include "app/setup/adaptation.hpp"
#include "base/display_unit.hpp"
#include "base/stopwatch.hpp"
#include "figures/figures.hpp"
#include "model/part_of_body.hpp"
#include "stepper/moreau_jean.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace knap {
namespace {

// [s] of processor time on the machine of the gallery
constexpr double kernel_there = 0.8e-3;                          // of the loop in machine_slowness()
constexpr double of_frame = 1.5e-3, of_frame_triangle = 0.4e-6;  // a frame
constexpr double of_figure = 0.035, of_figure_triangle = 5e-6;   // a figure; of the body
constexpr double of_rebuilds = 1.4;                              // [-] of steps with refinements over those without
constexpr double of_line = 2e-5, of_line_interface = 6e-9;       // a line of the tables

// [1/s] With [rigid]; each makes a body deformable for `hold`. Within a factor of 2 for boulders on slopes.
constexpr double blows_a_second = 1;

// [-] With bulk = "auto": stages of explicit steps of a run, and what they cost over the shortest, in which nothing
// rubs yet; fitted to the gallery (17 stages of slow_crush, one of permafrost_collapse as long as the fall)
constexpr double most_stages = 30, mean_over_shortest_stage = 500;
// [-] Of steps whose contacts change over those at rest, in solves: 50 over 4 (walls of blocks that begin to slide)
constexpr double of_changing_contacts = 12;

// A search for an equilibrium takes some steps of hundreds of stable ones. Walls of 22 and 55 blocks that stand or
// slide are within these numbers, and one of 210 blocks that slides (61 s).
constexpr double steps_of_search = 5, most_steps_of_search = 20, stable_steps_of_search = 200;

constexpr double longest_measurement = 200;  // [-] in units of measure_for

/// [s] processor time of the process at which a measured step is given up.
thread_local double deadline = infinity;
bool is_late() { return Stopwatch::seconds(CLOCK_PROCESS_CPUTIME_ID) > deadline; }

/// [s] Processor time of a step at the start, after the first one: the minimum over some batches, since other load on
/// the machine only adds. Throws StepGivenUp.
double measured_step(const Model& model, MoreauJean& stepper, double step, double at_least_for,
                     Motion motion = Motion::deformable) {
    State now = initial_state(model), next = now;
    stepper.begin(now);
    now.motion = motion;
    stepper.give_up_when(is_late);
    stepper.step(now, step, next);
    const Stopwatch all;
    double fastest = infinity;
    for (int batch = 0; batch < 3 || all.cpu() < at_least_for; ++batch) {
        const Stopwatch watch;
        int n = 0;
        do {
            if (stepper.step(now, step, next).rejection == Rejection::none) std::swap(now, next);
            ++n;
        } while (watch.cpu() < at_least_for / 10);
        fastest = std::min(fastest, watch.cpu() / n);
        if (batch == 0 && fastest > at_least_for) break;
    }
    return fastest;
}

/// How much slower this machine is than that of the gallery, by a fixed loop of some milliseconds.
double machine_slowness() {
    std::array<double, 2048> values{};
    double fastest = infinity;
    for (int batch = 0; batch < 5; ++batch) {
        const Stopwatch watch;
        for (int repeat = 0; repeat < 200; ++repeat)
            for (std::size_t i = 0; i < values.size(); ++i)
                values[i] = std::sqrt(0.5 * values[i] + static_cast<double>(i + repeat));
        fastest = std::min(fastest, watch.cpu());
    }
    return values[7] > 0 ? fastest / kernel_there : 1;
}

/// Number of breakable interfaces, and whether existing or later crack faces rub.
struct Faces {
    double n_breakable = 0;
    bool rub = false, rub_at_start = false;  // at the start: pre-cracks and joints
};

Faces faces_of(const Model& model) {
    Faces faces;
    for (const Interface& interface : model.interfaces) {
        const CohesiveLaw& law = model.laws[interface.law];
        const bool open = interface.cracked || (law.breakable() && law.sigma_c <= 0),
                   breaks = law.breakable() && !open;  // joints are open, too
        const bool rubs = law.friction_range()[1] > 0;
        faces.n_breakable += breaks ? 1 : 0;
        faces.rub = faces.rub || ((breaks || open) && rubs);
        faces.rub_at_start = faces.rub_at_start || (open && rubs);
    }
    return faces;
}

/// Fraction of the area in the smaller half of the triangles: about 0.4 for a uniform mesh, near 0 where most triangles
/// lie in boxes around one or two crack tips.
double area_of_finer_half(const Mesh& mesh) {
    std::vector<double> areas(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) areas[t] = mesh.area(t);
    const auto half = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
    std::nth_element(areas.begin(), half, areas.end());
    const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
    return all > 0 ? std::accumulate(areas.begin(), half, 0.0) / all : 0;
}

/// Ratio of the mean to the first steps, fitted to the gallery. Explicit, all interfaces breakable: 1.4 to 3.2 without
/// friction; with friction 2 to 8, since broken faces go on rubbing, but 1.1 where joints rub from the start. Implicit,
/// in solves of the whole body: 1.1 to 5 for a breakable line, 5.5 for 7 000 interfaces in 3 000 steps, 114 for 56 000
/// in 61; 9 for a long slip front with friction. Where most triangles lie in small boxes a crack passes through them,
/// a line of as many interfaces as the square root of their number: explicit 1, implicit 4.4 for 5 000 interfaces in
/// 900 steps.
double mean_over_first(bool implicit, const Model& model, double n_steps) {
    const Faces faces = faces_of(model);
    const bool breaks_everywhere = faces.n_breakable >= 0.1 * static_cast<double>(model.interfaces.size());
    const double all_over =
        breaks_everywhere ? std::min(1.0, 5 * area_of_finer_half(model.mesh)) : 0;  // 1: everywhere, 0: along lines
    if (implicit) {
        if (!breaks_everywhere) return faces.rub ? 9 : 2.4;
        const double n_breaking = all_over * faces.n_breakable + (1 - all_over) * std::sqrt(faces.n_breakable);
        return 2.4 + 4 * std::sqrt(n_breaking / n_steps);
    }
    const double where_all_breaks = !faces.rub ? 2 : faces.rub_at_start ? 1.3 : 4.5;
    return 1 + (where_all_breaks - 1) * all_over;
}

/// All pieces are rigid, and none of them can break.
bool stays_rigid(const Model& model, const RigidOptions& options) {
    if (!options.active()) return false;
    State start = initial_state(model);
    return std::ranges::none_of(freeze(model, start).body->pieces,
                                [&](const FrozenBody::Piece& piece) { return can_break(piece, options); });
}

/// [s] Processor time of an explicit step of bulk = "auto", on average where the body breaks.
double explicit_step_of_auto(const Scenario& scenario, const Model& model, double step, double measure_for) {
    SchemeOptions leapfrog = scenario.time.scheme;
    leapfrog.bulk = BulkScheme::explicit_lumped, leapfrog.cohesion = CohesionScheme::explicit_beta;
    MoreauJean stepper(model, leapfrog);
    return measured_step(model, stepper, step, measure_for) * mean_over_first(false, model, scenario.time.end / step);
}

}  // namespace

Cost estimate_cost(const Scenario& scenario, const Model& model, const StepPlan& plan, double model_seconds,
                   double measure_for) {
    const bool implicit = scenario.time.scheme.takes_implicit_steps();
    const double triangles = model.mesh.n_triangles(), drawn = triangles * (model.mesh.order == 2 ? 6 : 1),
                 slowness = machine_slowness();
    Cost cost{.model = model_seconds};

    // steps may be smaller after the first loss of cohesion, which is early in the gallery
    const double largest = static_cast<double>(plan.n_steps);
    cost.n_steps =
        plan.limits.changes() ? largest : std::max(largest, std::ceil(scenario.time.end / plan.limits.cracking));
    const double rigid = plan.limits.rigid.step;
    const bool is_rigid = rigid > 0 && stays_rigid(model, scenario.time.scheme.rigid);
    if (is_rigid) cost.n_steps = scenario.time.end / rigid;
    MoreauJean stepper(model, scenario.time.scheme);
    deadline = Stopwatch::seconds(CLOCK_PROCESS_CPUTIME_ID) + longest_measurement * measure_for;
    try {
        cost.first_step = is_rigid ? measured_step(model, stepper, rigid, measure_for, Motion::rigid)
                                   : measured_step(model, stepper, plan.limits.largest, measure_for);
        if (rigid > 0)
            cost.rigid_steps =
                scenario.time.end / rigid *
                (is_rigid ? cost.first_step : measured_step(model, stepper, rigid, measure_for, Motion::rigid));
        if (scenario.time.start_in_equilibrium) {
            MoreauJean search(model, {.bulk = BulkScheme::implicit_theta, .theta = 1});
            const double step = measured_step(model, search, stable_steps_of_search * plan.stable_step, measure_for);
            cost.least_search = steps_of_search * step;
            cost.search = model.faces_meet() ? most_steps_of_search * of_changing_contacts * step : cost.least_search;
        }
    } catch (const StepGivenUp&) {
        cost.given_up_after = longest_measurement * measure_for;
        cost.first_step = NAN;
    }
    cost.mean_over_first = is_rigid ? 1 : mean_over_first(implicit, model, cost.n_steps);
    double growth = 1, largest_growth = 1;  // of the number of triangles, at the end
    if (scenario.adapt.active()) {
        const AdaptationForecast expected = forecast(scenario, model.mesh);
        growth = expected.at_end / triangles, largest_growth = expected.at_most / triangles;
        cost.mean_over_first *= 0.5 * (1 + growth) * of_rebuilds;
    }
    cost.steps = cost.least_steps = cost.deformable_steps = cost.n_steps * cost.first_step * cost.mean_over_first;
    if (implicit && !is_rigid && cost.given_up_after == 0) {
        cost.least_steps = cost.n_steps * cost.first_step;
        if (const SchemeChangeOptions& change = plan.limits.change; plan.limits.changes()) {
            const double of_one =
                explicit_step_of_auto(scenario, model, change.explicit_step, measure_for) / change.explicit_step;
            cost.stage = change.quiet_for * of_one;
            cost.steps = cost.least_steps +
                         std::min(scenario.time.end * of_one, most_stages * mean_over_shortest_stage * cost.stage);
        } else if (model.faces_meet()) {
            cost.steps *= of_changing_contacts;
        }
    }
    if (rigid > 0 && !is_rigid && may_be_parted(model))
        cost.steps = cost.least_steps = cost.rigid_steps + std::min(1.0, blows_a_second * plan.limits.rigid.hold) *
                                                               (cost.deformable_steps - cost.rigid_steps);

    if (scenario.output.fields)
        cost.n_frames = std::min(std::ceil(scenario.time.end / scenario.output.between_frames()), largest) + 1;
    cost.frames = slowness * cost.n_frames * (of_frame + of_frame_triangle * drawn);
    double n_body = 0, n_curves = 0, picture = 0;  // [MB] the largest
    const Vec2 extent = bounding_box(model.mesh.vertices).extent();
    for (const FigureOptions& figure : scenario.figures)
        picture = std::max(picture, 1e-6 * drawing_memory(figure, figure.box ? figure.box->extent() : extent));
    for (const FigureOptions& figure : scenario.figures)
        if (shows_body(figure.show)) n_body += std::max<double>(1, static_cast<double>(figure.at.size()));
        else ++n_curves;
    cost.figures = slowness * ((n_body + n_curves) * of_figure + n_body * of_figure_triangle * drawn);
    const double n_lines = std::min(std::ceil(scenario.time.end / scenario.output.history_every), largest);
    cost.lines = slowness * n_lines * (of_line + of_line_interface * static_cast<double>(model.interfaces.size()));

    // refinements hold the model before and after them, but nothing else: 1.8 to 2.2 kB a triangle of the last one
    const double of_triangle = implicit ? scenario.large_rotation ? 5.2e-3 : 4.2e-3 : 2.2e-3;
    const double of_program = 75 + std::max(0.0, picture - 40);  // with a usual picture
    cost.memory = of_program + of_triangle * largest_growth * drawn;
    cost.least_memory = of_program + of_triangle * growth * drawn;
    constexpr double of_compression[] = {206e-6, 85e-6, 65e-6};  // [MB] a triangle
    cost.disk = cost.n_frames *
                (6e-3 + of_compression[static_cast<int>(scenario.output.compression)] * 0.5 * (1 + growth) * drawn);
    return cost;
}

std::string unknown_text(const Cost& cost, double step) {
    return "how long it takes is not known: the first step, of " + readable(step, "s") + ", was not solved in " +
           readable(cost.given_up_after, "s") + " of one core";
}

}  // namespace knap
