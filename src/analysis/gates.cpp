#include "analysis/gates.hpp"

#include "analysis/deformation_watch.hpp"
#include "analysis/energy_ledger.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr bool fixed = false, allowed = true;

// Rates are exact up to the error of the solvers: rounding times the condition number. 1e-16 is usual; of 20 000 random
// runs with friction up to 1000, solved vertex by vertex, three exceeded 1e-14, the largest was 4.5e-14.
constexpr double max_injected = 1e-12;

// A triangle that turns by an angle a in linear kinematics grows by tan^2(a): by a third at 30 degrees. At 1/20 the
// linear strain has an error of about 2 %.
constexpr double area_warning = 0.05, area_limit = 1. / 3;

// Green's strain with a linear law (large rotations): at 5 % its terms of second order are some 10 % of the stress. In
// compression a triangle softens from 42 % on, and none must come near to losing its area.
constexpr double strain_warning = 0.05, area_limit_of_green = 0.7;

constexpr std::string_view step_or_load =
    "Usual cause: a step above the stable one, or a load with a wrong unit. Try a smaller time.step.";
constexpr std::string_view at_rounding =
    "Usual cause: an interface problem at the limit of rounding (very large friction, slivers). Try a smaller "
    "time.step, a better mesh, or less friction.";

// [-] Of the energy that thermal strains would have if they were held: a body that expands so freely has no stress.
constexpr double negligible_stress = 1e-4;

double energy_scale(const EnergyLedger& ledger) { return ledger.largest_energy() > 0 ? ledger.largest_energy() : 1; }

/// At the end of a run in which the interfaces dissipated anything.
bool judges_losses(const GateView& run) {
    return run.ended && run.ledger.row().dissipated > 1e-6 * run.ledger.largest_energy();
}

/// A loss [J] over the dissipated energy, or over that of the weakest point where less was dissipated.
GateValue over_dissipated(const GateView& run, double loss) {
    return {.value = std::abs(run.ledger.over_dissipated(loss)), .judged = judges_losses(run)};
}

// Each step rounds a displacement by up to 2^-53 of it. A steady motion adds the same small length at each step,
// rounded in the same direction while its last bit has the same weight. Then the displacement u has an error of up to n
// 2^-53 u, and the work F u of its drive one of n 2^-53 F u, which is up to 2^-52 n of the strain energy F u/2. Twice
// that for two driven ends. (20 mm of rock, compressed steadily in 3.6 million steps: 1.2e-10; this bound: 1.6e-9.)
double rounding_of(std::int64_t n_steps) { return std::ldexp(static_cast<double>(n_steps), -51); }

// Thermal strains e that are free leave no energy, but the work on the stress D (eps - e) rounds D eps and D e: their
// energies 1/2 e : D e take the place of the scale. (A free plate of alumina that warms by 1000 K in 1 ms: 20 000 times
// its largest energy.)
double rounding_of_energy(const EnergyLedger& ledger) {
    return rounding_of(ledger.n_steps()) * (1 + ledger.largest_free_thermal() / energy_scale(ledger));
}

// [J] and over the largest energy: where a body only moves, all its energy is rounding.
double rounding_energy(const GateView& run) {
    return run.deformation == nullptr ? 0 : run.deformation->rounding_energy(run.ledger.path());
}
double rounding_part(const GateView& run) { return rounding_energy(run) / energy_scale(run.ledger); }

// The defect of the elastic energy by large rotations stays bounded in one flight; impacts and contacts begin new ones,
// and in each turn of the body the stresses go once round. A part of 1e-3 a turn is allowed, counted by the path of the
// fastest point along the circle round the body.
constexpr double rotation_work_a_turn = 1e-3;
double turns(const GateView& run) { return run.ledger.path() / (std::numbers::pi * run.size); }

// [m/s] With a step of s times the stable step, the strain energy of the leapfrog, 1/2 u_n' K u_{n+1}, is at least -s^2
// times the kinetic energy, which so is at most 1/(1 - s^2) of the supplied energy: 2.8 times with a safety of 0.8. No
// part can have more. Kinetic energy that grows without bound has no supply.
double speed_of_supplied_energy(const EnergyLedger& ledger) {
    return std::sqrt(2 * 10 * ledger.supplied() / ledger.smallest_mass());
}

// [m/s] A motion by less than 1e-10 of the body in all the time so far is rounding, even before any energy was
// supplied.
double speed_of_rounding(const GateView& run) {
    return run.ledger.row().time > 0 ? 1e-10 * run.size / run.ledger.row().time : 0;
}

template <auto extreme>
GateValue of_deformation(const GateView& run) {
    if (run.deformation == nullptr) return {.value = 0, .judged = false};
    const Extreme& found = (run.deformation->*extreme)();
    return {.value = found.value, .place = found.value == 0 ? std::nullopt : std::optional(found.place)};
}

bool turns_freely(const GateView& run) { return run.deformation != nullptr && run.deformation->large_rotation(); }

const GateRule rules[] = {
    {{"energy_residual", "", "error of the discrete energy balance over the largest energy of the run", step_or_load},
     {infinity, infinity, fixed},
     [](const GateView& run) {
         return GateValue{.value = run.ledger.largest_residual() / energy_scale(run.ledger),
                          .limit = 1e-10 + rounding_of_energy(run.ledger) + rounding_part(run)};
     }},
    {{"impact_injection", "",
      "largest work of one impact in one step over the largest energy; a positive work injects energy", at_rounding},
     {infinity, max_injected, fixed},
     [](const GateView& run) {
         return GateValue{.value = run.ledger.worst().worst_impact_work / energy_scale(run.ledger),
                          .limit = max_injected + rounding_part(run)};
     }},
    {{"friction_injection", "",
      "largest work of friction at one point in one step over the largest energy; a positive work injects energy",
      at_rounding},
     {infinity, max_injected, fixed},
     [](const GateView& run) {
         return GateValue{.value = run.ledger.worst().worst_friction_work / energy_scale(run.ledger),
                          .limit = max_injected + rounding_part(run)};
     }},
    {{"cohesion_growth", "", "largest increase of the cohesion beta of a point; cohesion never heals", at_rounding},
     {infinity, 0, fixed},
     [](const GateView& run) { return GateValue{run.ledger.worst().largest_beta_growth}; }},
    {{"interface_residual", "", "largest violation of the interface laws, scaled",
      "The solver of the interfaces found no motion that satisfies all interface laws. Usual cause: a body driven "
      "against an obstacle or support that cannot give way, very large friction, slivers, or more than ten thousand "
      "triangles round one vertex of which some came apart and others cannot (rounding). Try a smaller time.step, less "
      "friction, a better mesh, and check the prescribed motions."},
     {infinity, max_residual, fixed},
     [](const GateView& run) { return GateValue{run.ledger.worst().residual}; }},
    {{"largest_speed", "m/s",
      "largest speed of the body; the limit is the speed of its lightest corner if that had ten times all energy "
      "supplied so far",
      step_or_load},
     {infinity, infinity, fixed},
     [](const GateView& run) {
         return GateValue{.value = run.ledger.worst().largest_speed,
                          .limit = std::max(speed_of_supplied_energy(run.ledger), speed_of_rounding(run))};
     }},
    {{"penetration", "m",
      "largest penetration of two sides in contact; the limit is the critical opening or a thousandth of the body, "
      "whichever is larger",
      "Usual cause: a body driven against itself faster than the step resolves. Try a smaller time.step, and check the "
      "prescribed motions."},
     {infinity, infinity, allowed},
     [](const GateView& run) {
         return GateValue{.value = run.ledger.worst().penetration,
                          .limit = std::max(run.critical_opening, 1e-3 * run.size)};
     }},
    {{"contact_depth", "", "largest penetration of two free faces over the length of the edge",
      "Usual cause: faces that meet faster than the step resolves, thin pieces, or points that cohesion held while "
      "they turned. Try a smaller time.safety or smaller triangles there; [limits] contact_depth sets another limit."},
     {0.02, max_contact_depth, allowed},
     [](const GateView& run) {
         const StepReport& worst = run.ledger.worst();
         return GateValue{worst.contact_depth,
                          worst.contact_depth > 0 ? std::optional(worst.depth_place) : std::nullopt};
     }},
    {{"contact_injection", "",
      "positive works of contacts of free faces and obstacles, by the residual of their laws, over the work of impact "
      "and friction",
      "Usual cause: pieces wedged by friction. Try less friction, or a smaller time.safety."},
     {1e-6, 1e-5, fixed},
     [](const GateView& run) {
         const double scale = -run.ledger.row().impact_work - run.ledger.row().friction_work;
         const double least = std::max(1e-3 * run.ledger.largest_energy(), 1e6 * rounding_energy(run));  // few have met
         return GateValue{run.ledger.worst().contact_injection > 0
                              ? run.ledger.worst().contact_injection / std::max(scale, least)
                              : 0.0};
     }},
    {{"rigid_injection", "",
      "positive works of contacts of rigid pieces, by the residual of their laws, over the work of impact and "
      "friction; "
      "momentum and energy are exact all the same",
      "Usual cause: many pieces wedged by friction. Try a smaller rigid.step."},
     {1e-3, infinity, fixed},
     [](const GateView& run) {
         const EnergyRow& row = run.ledger.row();
         const double least = std::max(1e-3 * run.ledger.largest_energy(), 1e6 * rounding_energy(run));
         return GateValue{.value = row.rigid_injection / std::max(-row.impact_work - row.friction_work, least),
                          .judged = run.ended && row.rigid_injection > 0};
     }},
    {{"exchange_injection", "",
      "energy that contacts between rigid pieces and deformable ones gave (exchange_work, where it is positive), over "
      "the work of impact and friction",
      "Usual cause: the impulse of a large step acts late on a deformable piece. Try a smaller rigid.step or "
      "rigid.thaw."},
     {1e-3, infinity, fixed},
     [](const GateView& run) {
         const EnergyRow& row = run.ledger.row();
         const double least = std::max(1e-3 * run.ledger.largest_energy(), 1e6 * rounding_energy(run));
         return GateValue{.value = row.exchange_work / std::max(-row.impact_work - row.friction_work, least),
                          .judged = run.ended && row.exchange_work > 0};
     }},
    {{"rebound_lack", "",
      "part of the energy that R_N takes of an impact of a deformable piece which the surface could not take, since it "
      "gives way by a part of an edge alone; the piece rebounds faster",
      "The impact is too fast for the mesh (check says up to which speed it is not). Try a larger mesh.size, a smaller "
      "speed, or breakable = false with [rigid], where R_N is exact."},
     {0.1, infinity, fixed},
     [](const GateView& run) {
         const StepReport& worst = run.ledger.worst();
         return GateValue{.value = worst.rebound_lack, .place = worst.lack_place, .judged = worst.rebound_lack > 0};
     }},
    {{"fluttering_friction", "",
      "mean friction coefficient of what slid under a friction over pressure or slip in explicit steps or with theta "
      "below 1: faces that slide fast flutter, so that a friction over pressure is less than that of the mean pressure "
      "(scenarios/results/friction_lack.csv), and slips forth and back use up the slip_distance",
      "What stands, its strength and slow slides are not concerned. Compare with implicit steps and theta = 1, or try "
      "shear_viscosity = 0.3 and bulk_viscosity = [0, 1.2] in [material.*] where they are not on."},
     {0.2, infinity, fixed},
     [](const GateView& run) {
         const StepReport& sum = run.ledger.worst();
         const bool slid = sum.fluttering_work > 1e-3 * run.ledger.largest_energy();
         return GateValue{.value = slid ? sum.fluttering_work / sum.fluttering_slip : 0, .judged = run.ended && slid};
     }},
    {{"missed_blow", "",
      "energy dissipated in the first step of pieces that a blow made deformable, over the dissipated energy: no wave "
      "has run in it, so what breaks bore its strength or more while it was rigid",
      "A load grew, or blows followed each other, unseen. Try a smaller rigid.thaw or rigid.step."},
     {0.01, infinity, fixed},
     [](const GateView& run) {
         GateValue value = over_dissipated(run, run.ledger.row().thaw_dissipation);
         value.judged = value.judged && run.ledger.row().thaw_dissipation > 0;
         return value;
     }},
    {{"contact_residual", "",
      "largest error of the rates of contacts of free faces and obstacles over their speeds; momentum and energy are "
      "exact all the same, but single contacts may do positive work",
      "Usual cause: pieces wedged by friction. Try less friction, or a smaller time.safety."},
     {1e-8, max_contact_residual, fixed},
     [](const GateView& run) {
         const StepReport& worst = run.ledger.worst();
         return GateValue{worst.contact_residual,
                          worst.contact_residual > 0 ? std::optional(worst.residual_place) : std::nullopt};
     }},
    {{"law_lag", "",
      "law lag (staggering error of beta): difference between the work of the interfaces and the energy that their "
      "law requires, over the dissipated energy; with it a crack does not cost G_c (place: the point with the largest "
      "error in one step)",
      "Where largest_law_lag of run.json is positive, usual cause: points that lose most of their cohesion within one "
      "step. Where it is negative: cohesion = \"implicit\" with theta above 0.5 (a point that breaks within a step "
      "has no traction at its end, and the scheme dissipation takes its G_c: the sum of both is what jumps radiate) "
      "or with the explicit bulk, or damaged sides that penetrate because the implicit bulk stops them within a "
      "step. Where the implicit bulk snaps back within a step, time.bulk = \"auto\" resolves it by explicit steps. "
      "Try a smaller time.step_cracking or time.safety, theta = 0.5, or a mesh with more edges in the process zone; "
      "limits.law_lag sets another limit."},
     {0.02, 0.2, allowed},
     [](const GateView& run) {
         const double now = run.ended ? std::abs(run.ledger.law_lag()) : 0;
         return GateValue{
             std::max(std::abs(run.ledger.largest_law_lag()), now),
             run.deformation == nullptr ? std::nullopt : run.deformation->place_of(run.ledger.worst().drop_corner)};
     }},
    {{"crossing_loss", "",
      "crossing loss (slip-reversal loss): energy lost where slips cross zero within a step, over the dissipated "
      "energy",
      "Usual cause: damaged interfaces that vibrate. Try a smaller time.step_cracking or time.safety, mesh.order = 2, "
      "a load that rises gradually (ramp), or a smaller restitution. Pieces that rattle with restitution 0 have it "
      "with every step: it is a loss, and in the works of the interfaces."},
     {0.05, infinity, fixed},
     [](const GateView& run) { return over_dissipated(run, run.ledger.row().crossing_loss); }},
    {{"scheme_dissipation_part", "",
      "energy damped by the time scheme with theta above 0.5 (scheme dissipation), over the dissipated energy",
      "Try a theta nearer to 0.5, or a smaller time.step and time.step_cracking."},
     {0.05, infinity, fixed},
     [](const GateView& run) { return over_dissipated(run, run.ledger.row().scheme_dissipation); }},
    {{"step_change_part", "", "energy gained or lost by changes of the step, over the dissipated energy",
      "Try a time.step_cracking nearer to time.step; after a hard impact bulk_viscosity, which damps the waves whose "
      "leapfrog energy depends on the step."},
     {0.05, infinity, fixed},
     [](const GateView& run) { return over_dissipated(run, run.ledger.row().step_change_work); }},
    {{"lost_part", "",
      "energy lost by the steps (law lag, crossing loss, scheme dissipation and changes of the step together) over the "
      "energy supplied",
      "Each of them has a gate of its own over the dissipated energy, with its cause. Try a smaller time.safety or "
      "time.step_cracking, or more triangles; pieces that rattle lose a part with every step."},
     {0.05, infinity, fixed},
     [](const GateView& run) {
         const EnergyRow& row = run.ledger.row();
         const double lost = row.law_lag + row.crossing_loss + row.scheme_dissipation - row.step_change_work;
         return GateValue{.value = run.ledger.supplied() > 0 ? std::abs(lost) / run.ledger.supplied() : 0,
                          .judged = judges_losses(run)};
     }},
    {{"rotation_work_part", "",
      "largest defect of the elastic energy by large rotations (rotation_work) over the largest energy; it decreases "
      "with the square of the step; the limit is 1e-3 and as much for each turn, by the path of the fastest point over "
      "the circumference of the body (place: of the largest strain)",
      "Try a smaller time.step or time.safety, or a slower motion."},
     {infinity, infinity, allowed},
     [](const GateView& run) {
         return GateValue{.value = run.ledger.largest_rotation_work() / energy_scale(run.ledger),
                          .place = of_deformation<&DeformationWatch::strain>(run).place,
                          .limit = rotation_work_a_turn * (1 + turns(run))};
     }},
    {{"heat_residual", "", "error of the balance of heat over its contents and flows; with conduction",
      "The equations of heat conduction were not solved to rounding: look for flat triangles (mesh.quality) and "
      "conductivities that differ by many powers of ten."},
     {infinity, 1e-10, fixed},
     [](const GateView& run) { return GateValue{run.ledger.largest_heat_residual()}; }},
    {{"temperature_overshoot", "",
      "largest excess of a temperature over those around it and before, over the largest difference of temperatures, "
      "where nothing is heated: conduction has none (maximum principle)",
      "Usual cause: obtuse triangles at inner borders or in a mesh from a file, also beside cracks. Use a finer or "
      "better mesh there; [limits] temperature_overshoot sets another limit."},
     {1e-3, 0.05, allowed},
     [](const GateView& run) { return GateValue{run.ledger.largest_overshoot()}; }},
    {{"kinetic_part", "",
      "kinetic over strain energy, without that of pieces that fly and spin, median over the run, where temperatures "
      "do most of the work and heat runs faster than in reality (time_factor, or a fast field): the motion is not "
      "quasi-static",
      "Cracks that run at a speed v, or jump, radiate about v/c_R of the energy that they release, and the waves "
      "stay in a free body. Try time.damping (1/s, some 10 over time.end or more), a smaller heat.time_factor or a "
      "slower field with a later time.end. Where waves are the question the number is an answer, and no error."},
     {0.01, infinity, fixed},
     [](const GateView& run) {
         const EnergyRow& row = run.ledger.row();
         return GateValue{
             .value = run.kinetic_part,
             .judged = !std::isnan(run.kinetic_part) && std::abs(row.thermal_work) > std::abs(row.external_work) &&
                       run.ledger.largest_energy() > negligible_stress * run.ledger.largest_free_thermal()};
     }},
    {{"braked_spin", "",
      "part of the angular momentum of pieces that theta above 0.5 took from them as they turned in implicit steps: "
      "(theta - 0.5) step w^2 of itself per time at a spin w, and twice that of the energy of the spin "
      "(scheme_dissipation)",
      "Try a smaller time.step, theta = 0.5, or bulk = \"explicit\", which keep it."},
     {0.01, infinity, fixed},
     [](const GateView& run) {
         const double part = run.ledger.braked_spin();
         return GateValue{.value = part, .judged = part > 0};
     }},
    {{"rotation", "deg",
      "largest rotation of a triangle; knap assumes small rotations, and a body that turns by an angle a grows by "
      "tan^2(a)",
      "Set domain.rotation = \"large\", where nothing else excludes it (mesh.order = 1, start at rest), "
      "or end the run earlier if its question is answered by then. If only fragments turn that no longer matter, allow "
      "it: [limits] rotation = \"none\" and area_change = \"none\"."},
     {5, 30, allowed},
     [](const GateView& run) {
         GateValue found = of_deformation<&DeformationWatch::rotation>(run);
         found.judged = found.judged && !turns_freely(run);
         return found;
     }},
    {{"strain", "",
      "largest principal strain of a triangle with large rotations; the elastic law is that of small strains",
      "Usual cause: loads far above sigma_c, an impact that is too fast, or single triangles that "
      "are crushed. Check the units of loads and E."},
     {strain_warning, infinity, allowed},
     [](const GateView& run) {
         GateValue found = of_deformation<&DeformationWatch::strain>(run);
         found.judged = found.judged && turns_freely(run);
         return found;
     }},
    {{"area_change", "",
      "largest change of the area of a triangle over its area; knap assumes small strains, and small rotations unless "
      "domain.rotation = \"large\"",
      "Usual cause: a body that turns (see rotation), or loads far above sigma_c. Check the units "
      "of loads and E; [limits] area_change sets another limit."},
     {area_warning, area_limit, allowed},
     [](const GateView& run) {
         GateValue found = of_deformation<&DeformationWatch::area_change>(run);
         if (turns_freely(run)) found.warning = found.limit = area_limit_of_green;  // `strain` warns
         return found;
     }},
    {{"obstacle_overlap", "m",
      "largest depth of a free obstacle in another obstacle or a support; what lands in implicit steps overlaps by "
      "1 - theta of its path in a step, or less",
      "Take smaller steps or a larger theta; where it does not matter, [limits] obstacle_overlap sets another limit."},
     {infinity, infinity, allowed},
     [](const GateView& run) {
         GateValue found = of_deformation<&DeformationWatch::obstacle_overlap>(run);
         found.warning = 1e-4 * run.size, found.limit = 1e-3 * run.size;
         return found;
     }},
    {{"obstacle_depth", "",
      "largest depth of an edge of the body in an obstacle over the length of the edge, or half the width of the "
      "obstacle if that is less (place in the deformed body)",
      "Usual cause: an obstacle that is driven against what is held. Let one of them give way; [limits] "
      "obstacle_depth sets another limit."},
     {0.05, 0.1, allowed},
     [](const GateView& run) {
         GateValue found = of_deformation<&DeformationWatch::obstacle_depth>(run);
         found.judged = found.judged && run.deformation->has_obstacles();
         return found;
     }},
    {{"slip", "",
      "largest slip of a point under pressure over the length of its edge; contact is computed with the initial "
      "neighbour, which is no longer opposite",
      "Let free faces meet: [contact] with domain.rotation = \"large\". Or end the run earlier, use larger triangles "
      "where faces slide, or, where that contact does not matter, set [limits] slip = \"none\"."},
     {0.5, 1, allowed},
     of_deformation<&DeformationWatch::slip>},
    {{"overlap", "m2",
      "largest area that the deformed body covers twice (place in the deformed body); only faces that were neighbours "
      "at the start are in contact",
      "Let free faces meet: [contact] with domain.rotation = \"large\". Or end the run before separate faces meet, or "
      "place a crack or an obstacle between them; where that place does not matter, [limits] overlap sets another "
      "limit."},
     {infinity, infinity, allowed},
     [](const GateView& run) {
         GateValue found = of_deformation<&DeformationWatch::overlap>(run);
         if (!found.judged) return found;
         found.warning = 0.1 * run.deformation->triangle_area();  // about what is visible in a picture
         found.limit = std::max(10 * run.deformation->triangle_area(), 1e-3 * run.deformation->body_area());
         return found;
     }}};

}  // namespace

std::string_view name_of(GateLevel level) {
    return level == GateLevel::ok ? "ok" : level == GateLevel::warning ? "warning" : "violated";
}

std::span<const GateRule> gate_rules() { return rules; }

void judge(const GateView& view, std::span<const AllowedLimit> limits, Gates& gates) {
    gates.clear();
    for (const GateRule& rule : rules) {
        const GateValue found = rule.measure(view);
        double limit = found.limit.value_or(rule.limit);
        for (const AllowedLimit& other : limits)
            if (rule.allowed && other.gate == rule.name) limit = other.limit;
        const double warning = std::min(found.warning.value_or(rule.warning), limit);
        const GateLevel level = !found.judged || found.value <= warning ? GateLevel::ok
                                : found.value <= limit                  ? GateLevel::warning
                                                                        : GateLevel::violated;  // NaN, too
        gates.push_back({rule, found.judged ? found.value : std::nan(""), warning, limit, level, found.place});
    }
}

void GateKeeper::judge_end(const EnergyLedger& ledger, const DeformationWatch& deformation) {
    knap::judge({ledger, critical_opening_, size_, true, &deformation, ledger.kinetic_part()}, allowed_, gates_);
}

bool GateKeeper::pass() const { return std::ranges::all_of(gates_, &Gate::pass); }

std::vector<const Gate*> GateKeeper::new_warnings() const {
    std::vector<const Gate*> found;
    for (const Gate& gate : gates_)
        if (gate.level == GateLevel::warning &&
            std::ranges::count(warnings_, gate.name, [](const auto& s) { return std::string_view(s.first); }) == 0)
            found.push_back(&gate);
    return found;
}

}  // namespace knap
