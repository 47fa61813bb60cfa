#include "analysis/gates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

// Rates are exact to what the solvers leave, which is rounding times the condition of what they solve. Usual is 1e-16; of 20 000 random runs with
// friction up to 1000, solved vertex by vertex, three were above 1e-14, the worst had 4.5e-14.
constexpr double most_injected = 1e-12;

constexpr std::string_view step_or_load = "Usual cause: a step beyond the stable one, or a load that is absurd in its unit; try a smaller time.step";
constexpr std::string_view at_rounding =
    "Usual cause: an interface problem at the limit of rounding (very large friction, slivers); try a smaller time.step, a better mesh, or less friction";

/// [J]
double energy_scale(const EnergyLedger& ledger) { return ledger.largest_energy() > 0 ? ledger.largest_energy() : 1; }

/// A loss [J] over what the interfaces dissipated, once that is known; where they dissipated nothing there is nothing to compare with.
GateValue over_dissipated(const GateView& run, double loss) {
    return {.value = std::abs(run.ledger.over_dissipated(loss)), .judged = run.ended && run.ledger.row().dissipated > 1e-6 * run.ledger.largest_energy()};
}

// Each step rounds a displacement by up to 2^-53 of it. What is driven steadily adds the same small length at each, and is rounded the same way as long as its
// last place has the same weight; by then its displacement u is wrong by n 2^-53 u at most, and the work F u of what drives it by n 2^-53 F u, which is up to
// 2^-52 n of the strain energy F u/2 that it made. Twice that, for two ends that are driven apart. (20 mm of rock pressed steadily through 3.6 million steps: 1.2e-10,
// and this is 1.6e-9.)
double rounding_of(std::int64_t n_steps) { return std::ldexp(static_cast<double>(n_steps), -51); }

// [m/s] In a step that is s of the stable one the strain energy of the leapfrog, 1/2 u_n' K u_{n+1}, is at least -s^2 times the kinetic one, and the kinetic one at
// most 1/(1 - s^2) of all that was put in: 2.8 of it with a safety of 0.8. No part has more of it than all. What grows without a limit has it from nowhere.
double speed_of_all_energy(const EnergyLedger& ledger) { return std::sqrt(2 * 10 * ledger.given() / ledger.smallest_mass()); }

// [m/s] What comes no farther than 1e-10 of the body in all the time so far moves by rounding, also before anything was put in.
double speed_of_rounding(const GateView& run) { return run.ledger.row().time > 0 ? 1e-10 * run.size / run.ledger.row().time : 0; }

// A triangle that turns by an angle a in linear kinematics grows by tan^2 a: a third at 30 degrees. From a twentieth on the linear strain is off by some 2 %
// of itself.
constexpr double odd_area = 0.05, absurd_area = 1. / 3;

GateValue of(const DeformationWatch* watch, const Extreme& (DeformationWatch::*extreme)() const) {
    if (watch == nullptr) return {.value = 0, .judged = false};
    const Extreme& found = (watch->*extreme)();
    return {.value = found.value, .place = found.value == 0 ? std::nullopt : std::optional(found.place)};
}

const GateRule rules[] = {
    {.name = "energy_residual", .unit = "", .warning = none, .limit = none, .allowed = false,
     .measure = [](const GateView& run) {
         return GateValue{.value = run.ledger.largest_residual() / energy_scale(run.ledger), .limit = 1e-10 + rounding_of(run.ledger.n_steps())};
     },
     .meaning = "error of the discrete energy identity over the largest energy",
     .cure = step_or_load},
    {.name = "impact_injection", .unit = "", .warning = none, .limit = most_injected, .allowed = false,
     .measure = [](const GateView& run) { return GateValue{run.ledger.worst().worst_impact_work / energy_scale(run.ledger)}; },
     .meaning = "largest work of one impact in one step over the largest energy; a positive one injects energy",
     .cure = at_rounding},
    {.name = "friction_injection", .unit = "", .warning = none, .limit = most_injected, .allowed = false,
     .measure = [](const GateView& run) { return GateValue{run.ledger.worst().worst_friction_work / energy_scale(run.ledger)}; },
     .meaning = "largest work of one sliding point in one step over the largest energy; a positive one injects energy",
     .cure = at_rounding},
    {.name = "cohesion_growth", .unit = "", .warning = none, .limit = 0, .allowed = false,
     .measure = [](const GateView& run) { return GateValue{run.ledger.worst().largest_beta_growth}; },
     .meaning = "largest growth of the cohesion; it never heals",
     .cure = at_rounding},
    {.name = "interface_residual", .unit = "", .warning = none, .limit = max_residual, .allowed = false,
     .measure = [](const GateView& run) { return GateValue{run.ledger.worst().residual}; },
     .meaning = "worst violation of the interface laws, scaled",
     .cure = "The solver of the interfaces found no lawful motion. Usual cause: a body driven into what does not give way, very large friction, or slivers; try a "
             "smaller time.step, less friction, a better mesh, and look at the prescribed motions"},
    {.name = "largest_speed", .unit = "m/s", .warning = none, .limit = none, .allowed = false,
     .measure = [](const GateView& run) {
         return GateValue{.value = run.ledger.worst().largest_speed, .limit = std::max(speed_of_all_energy(run.ledger), speed_of_rounding(run))};
     },
     .meaning = "largest speed; the limit is that of the lightest part of the body if it had ten times the energy that was ever put in",
     .cure = step_or_load},
    {.name = "penetration", .unit = "m", .warning = none, .limit = none, .allowed = true,
     .measure = [](const GateView& run) {
         return GateValue{.value = run.ledger.worst().penetration, .limit = std::max(run.critical_opening, 1e-3 * run.size)};
     },
     .meaning = "largest overlap of two sides in contact; the limit is the critical opening, or a thousandth of the body",
     .cure = "Usual cause: a body driven against itself faster than a step can follow; try a smaller time.step, and look at the prescribed motions"},
    {.name = "law_lag", .unit = "", .warning = 0.02, .limit = 0.2, .allowed = true,
     .measure = [](const GateView& run) {
         return GateValue{std::max(std::abs(run.ledger.largest_law_lag()), run.ended ? std::abs(run.ledger.law_lag()) : 0),
                          run.deformation == nullptr ? std::nullopt : run.deformation->place_of(run.ledger.worst().drop_corner)};
     },
     .meaning = "largest work of the interfaces beside what their law takes (law lag), over the dissipated energy: the crack does not cost G_c "
                "(place: the point whose energy a step missed most)",
     .cure = "Usual cause: points that lose most of their cohesion within one step, where largest_law_lag of run.json is positive; where it is negative, cohesion = "
             "\"implicit\" with theta beyond 0.5 or with the explicit bulk, or damaged sides that overlap since the implicit bulk stops them within a step; "
             "try a smaller time.step_cracking or time.safety, theta = 0.5, a mesh with more edges in the process zone; or allow it by limits.law_lag"},
    {.name = "crossing_loss", .unit = "", .warning = 0.05, .limit = none, .allowed = false,
     .measure = [](const GateView& run) { return over_dissipated(run, run.ledger.row().crossing_loss); },
     .meaning = "energy lost where slips cross zero (crossing loss), over the dissipated energy",
     .cure = "Damaged interfaces rattle; try a smaller time.step_cracking or time.safety, mesh.order = 2, a load that sets in gently (ramp), restitution = 0"},
    {.name = "scheme_dissipation_part", .unit = "", .warning = 0.05, .limit = none, .allowed = false,
     .measure = [](const GateView& run) { return over_dissipated(run, run.ledger.row().scheme_dissipation); },
     .meaning = "energy damped by theta > 1/2 (scheme dissipation), over the dissipated energy",
     .cure = "Try a theta nearer 1/2, or a smaller time.step and time.step_cracking"},
    {.name = "step_change_part", .unit = "", .warning = 0.05, .limit = none, .allowed = false,
     .measure = [](const GateView& run) { return over_dissipated(run, run.ledger.row().step_change_work); },
     .meaning = "energy made or lost by changes of the step, over the dissipated energy",
     .cure = "Try a time.step_cracking nearer to time.step"},
    {.name = "rotation", .unit = "deg", .warning = 5, .limit = 30, .allowed = true,
     .measure = [](const GateView& run) { return of(run.deformation, &DeformationWatch::rotation); },
     .meaning = "largest rotation of a triangle; knap computes small ones, and a body that turns by an angle a grows by tan a squared",
     .cure = "Where the question of the run is over by then, end it earlier; where only pieces turn that no longer matter, say so: [limits] rotation = \"none\" "
             "and area_change = \"none\""},
    {.name = "area_change", .unit = "", .warning = odd_area, .limit = absurd_area, .allowed = true,
     .measure = [](const GateView& run) { return of(run.deformation, &DeformationWatch::area_change); },
     .meaning = "largest change of the area of a triangle over its area; knap computes small strains and rotations",
     .cure = "Usual cause: a body that turns (see rotation), or loads beyond what a linear elastic body bears; look at units of loads and E; [limits] area_change "
             "allows it"},
    {.name = "slip", .unit = "", .warning = 0.5, .limit = 1, .allowed = true,
     .measure = [](const GateView& run) { return of(run.deformation, &DeformationWatch::slip); },
     .meaning = "largest slip of a point under pressure, in lengths of its edge; contact stays with the partner it had at first, who is no longer there",
     .cure = "End the run earlier, use larger triangles where faces slide, or, where that contact does not matter, [limits] slip = \"none\""},
    {.name = "overlap", .unit = "m2", .warning = none, .limit = none, .allowed = true,
     .measure = [](const GateView& run) {
         GateValue found = of(run.deformation, &DeformationWatch::overlap);
         if (!found.judged) return found;
         found.warning = 0.1 * run.deformation->triangle_area();  // as much as a picture shows
         found.limit = std::max(10 * run.deformation->triangle_area(), 1e-3 * run.deformation->body_area());
         return found;
     },
     .meaning = "largest area that the deformed body covers twice (place in the deformed body); only faces that were neighbours from the start feel each other",
     .cure = "End the run before faces meet that were apart, or lay a crack or an obstacle between them; where that place does not matter, [limits] overlap allows it"},
};

}  // namespace

std::string_view name_of(GateLevel level) {
    return level == GateLevel::ok ? "ok" : level == GateLevel::warning ? "warning" : "violated";
}

std::span<const GateRule> gate_rules() { return rules; }

void judge(const GateView& view, std::span<const AllowedLimit> allowed, Gates& gates) {
    gates.clear();
    for (const GateRule& rule : rules) {
        const GateValue found = rule.measure(view);
        double limit = found.limit.value_or(rule.limit);
        if (rule.allowed)
            for (const AllowedLimit& other : allowed)
                if (other.gate == rule.name) limit = other.limit;
        const double warning = std::min(found.warning.value_or(rule.warning), limit);
        // what is no number keeps no limit
        const GateLevel level = !found.judged || found.value <= warning ? GateLevel::ok : found.value <= limit ? GateLevel::warning : GateLevel::violated;
        gates.push_back({.name = rule.name,
                         .unit = rule.unit,
                         .value = found.judged ? found.value : std::nan(""),
                         .warning = warning,
                         .limit = limit,
                         .level = level,
                         .place = found.place,
                         .meaning = rule.meaning,
                         .cure = rule.cure});
    }
}

bool GateKeeper::pass() const {
    return std::all_of(gates_.begin(), gates_.end(), [](const Gate& gate) { return gate.pass(); });
}

std::vector<const Gate*> GateKeeper::new_warnings() const {
    std::vector<const Gate*> found;
    for (const Gate& gate : gates_)
        if (gate.level == GateLevel::warning && std::none_of(said_.begin(), said_.end(), [&](const auto& said) { return said.first == gate.name; }))
            found.push_back(&gate);
    return found;
}

}  // namespace knap
