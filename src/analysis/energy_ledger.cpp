#include "analysis/energy_ledger.hpp"

#include "analysis/free_motion.hpp"
#include "element/triangle_matrices.hpp"
#include "stepper/adapt/excavation.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "stepper/common/surface_energy.hpp"
#include "stepper/scheme_change.hpp"

#include <Eigen/LU>

#include <cassert>
#include <climits>
#include <cmath>
#include <vector>

namespace knap {
namespace {

/// 1/2 v' M v [J]
double kinetic_energy(const Model& model, const State& state, MassMatrix mass) {
    const auto velocity = [&](Index corner) -> const Vec2& { return state.velocity[state.node_of_corner[corner]]; };
    double energy = 0;
    if (mass == MassMatrix::lumped) {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            energy += 0.5 * model.corner_mass[c] * velocity(c).squaredNorm();
        return energy;
    }
    const ElementMatrix& parts = mass_matrix(model.mesh.order, mass);
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j)
                energy += 0.5 * parts(i, j) * model.triangle_mass(t) * velocity(n * t + i).dot(velocity(n * t + j));
    return energy;
}

template <double EnergyRow::*member>
constexpr EnergyTerm number(const char* name, const char* unit, const char* doc, const EnergyTerm::Use& use = {}) {
    return {{{name, unit, doc}, [](const EnergyRow& row) { return row.*member; }}, member, use};
}

enum CurveColour { blue, vermilion, green, orange, purple, sky };  // in the order of curve_colour()

/// [J] Of the stress s of the undeformed body: the integral of 1/2 s : D^-1 s.
double initial_stress_energy(const Model& model) {
    const Index n = model.mesh.order == 1 ? 1 : 3;  // places in a triangle
    double energy = 0;
    for (Index i = 0; i < std::ssize(model.initial_stress); ++i) {
        const Eigen::Vector3d s(model.initial_stress[i].data());
        const Eigen::Matrix3d D = model.elastic(i / n).stiffness(model.plane);
        energy += 0.5 * model.mesh.area(i / n) * model.thickness / n * s.dot(D.inverse() * s);
    }
    return energy;
}

}  // namespace

double weakest_point(const Model& model) {
    double smallest = infinity;
    for (const FanPoint& point : model.fan_points)
        if (const CohesiveLaw& law = model.laws[point.law]; law.breakable() && !point.cracked && law.G_c > 0)
            smallest = std::min(smallest, law.G_c * point.area);
    return std::isinf(smallest) ? 0 : smallest;
}

EnergyLedger::EnergyLedger(const Model& model, const State& start, MassMatrix mass, double weakest_point)
    : smallest_mass_(*std::ranges::min_element(model.corner_mass)), weakest_point_(weakest_point) {
    row_ = {.time = start.time, .step = start.last_step};
    time_of_look_ = start.time;
    row_.kinetic = kinetic_energy(model, start, mass);
    std::vector<Vec2> force;
    row_.strain = elastic_energy(model, start, force);
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        row_.kinetic += kinetic_energy(model.obstacles[o], start.obstacles[o].velocity);
    start_energy_ = row_.kinetic + row_.strain;
    largest_energy_ = start_energy_ + initial_stress_energy(model);  // at rest nothing else has a size
    const StepReport surface = surface_energy(model, start);
    row_.dissipated = surface.dissipated, row_.recoverable = surface.recoverable;
    row_.interface_elastic = surface.interface_elastic;
    start_surface_ = row_.surface();
    largest_recoverable_ = row_.recoverable + row_.interface_elastic;
    supplied_ = start_energy_ + largest_recoverable_;
}

void EnergyLedger::add(const State& end, const StepReport& report) {
    assert(report.rejection == Rejection::none);
    const double surface_before = row_.surface(), lag_before = row_.law_lag;
    ++n_steps_;
    path_ += end.last_step * report.largest_speed;
    supplied_ += std::max(0.0, report.external_work) + std::max(0.0, report.excavation_work) +
                 std::max(0.0, report.thermal_work);
    row_.time = end.time, row_.step = end.last_step;
    row_.kinetic = report.kinetic;
    row_.strain = report.strain;
    consumed_change_ += report.consumed_change;
    row_.dissipated = report.dissipated - consumed_change_ + excavated_dissipated_;
    row_.recoverable = report.recoverable;
    row_.interface_elastic = report.interface_elastic;
    double work = 0;
    for (const EnergyTerm& term : energy_terms()) {
        if (term.use.step != nullptr) row_.*term.value += report.*term.use.step;
        if (term.use.work != 0) work += term.use.work * row_.*term.value;
    }
    row_.residual = row_.kinetic + row_.strain - start_energy_ - work;
    row_.law_lag = row_.cohesive_work + row_.law_change - row_.crossing_loss - row_.viscous_dissipation -
                   row_.mixed_dissipation - (row_.surface() - start_surface_) - row_.excavated_recoverable;
    largest_energy_ = std::max(
        {largest_energy_, row_.kinetic, row_.strain, std::abs(row_.external_work), row_.surface(), report.kick_energy});
    largest_recoverable_ = std::max(largest_recoverable_, row_.recoverable + row_.interface_elastic);
    // comparisons with NaN are false: NaN counts as the largest value
    if (!(std::abs(row_.residual) <= largest_residual_)) largest_residual_ = std::abs(row_.residual);
    largest_rotation_work_ = std::max(largest_rotation_work_, std::abs(row_.rotation_work));
    // Psi of constant unloading belongs to the end of a step, works of the leapfrog to its middle; those of secant
    // unloading both belong to the middle. Where pieces are rigid works of cohesion go to the end: it falls in islands
    // alone, whose leapfrog is closed
    const bool half_later = !end.has_end_velocities() && end.motion != Motion::rigid && row_.interface_elastic == 0;
    const double lag = row_.law_lag + (half_later ? 0.5 * (row_.surface() - surface_before - report.law_change) : 0);
    law_lag_ = lag;
    const auto judge = [&](double at) {
        if (const double now = over_dissipated(at, 1e-2); !(std::abs(now) <= std::abs(largest_law_lag_)))
            largest_law_lag_ = now;
    };
    judge(lag);
    if (report.micro_lag > 0) judge(lag_before + report.micro_lag);
    if (report.micro_lead > 0) judge(lag_before - report.micro_lead);

    if (end.temperature) largest_free_thermal_ = std::max(largest_free_thermal_, end.temperature->free_energy);
    if (const SharedTemperatures& heat = end.temperature; heat && heat->heat_scale > 0) {
        row_.heat = heat->heat, row_.heat_in = heat->heat_in;
        largest_heat_residual_ = std::max(largest_heat_residual_,
                                          std::abs(heat->heat - heat->heat_in) / (heat->heat_scale + heat->heat_moved));
        if (heat->range > 0) largest_overshoot_ = std::max(largest_overshoot_, heat->overshoot / heat->range);
    }
    StepReport extremes = report;
    extremes.largest_speed = std::max(worst_.largest_speed, report.largest_speed);
    worst_ += extremes;
}

void EnergyLedger::look_at(const FreeMotion& pieces, double braking) {
    const double vibration = std::max(0.0, row_.kinetic - pieces.energy);
    if (row_.strain > 0) kinetic_part_.add(vibration / row_.strain, row_.time - time_of_look_);
    time_of_look_ = row_.time;
    braked_ += braking * pieces.squared_spins;
    largest_angular_momentum_ = std::max(largest_angular_momentum_, pieces.angular_momentum);
}

void EnergyLedger::excavate(const ExcavationEnergies& energies) {
    row_.excavated_energy += row_.kinetic + row_.strain - (energies.kinetic + energies.strain);
    row_.excavated_recoverable += energies.recoverable + energies.interface_elastic;
    row_.kinetic = energies.kinetic, row_.strain = energies.strain;
    row_.recoverable -= energies.recoverable;
    row_.interface_elastic -= energies.interface_elastic;
    excavated_dissipated_ += energies.dissipated;
}

void EnergyLedger::adapt(const Renumbering& numbers, const LeapfrogEnergies& energies) {
    row_.adaptation += energies.kinetic + energies.strain - (row_.kinetic + row_.strain);
    row_.kinetic = energies.kinetic, row_.strain = energies.strain;
    if (Index& corner = worst_.drop_corner; corner >= 0) {
        const std::vector<Index>& before = numbers.triangle_before;
        const Index now = static_cast<Index>(std::ranges::find(before, corner / 3) - before.begin());
        corner = 3 * now + corner % 3;  // a point that softens keeps its triangles
    }
}

/// The frames in which openings are measured may have turned.
void EnergyLedger::assume(const Model& model, const State& now, std::size_t n_obstacles) {
    for (std::size_t o = n_obstacles; o < model.obstacles.size(); ++o) {
        const double added = kinetic_energy(model.obstacles[o], now.obstacles[o].velocity);
        row_.assumptions += added, row_.kinetic += added, supplied_ += added;
    }
    std::vector<Vec2> force;
    const double strain =
        now.has_end_velocities() ? elastic_energy(model, now, force) : leapfrog_energies(model, now).strain;
    row_.assumptions += strain - row_.strain;
    row_.strain = strain;
    const double recoverable = surface_energy(model, now).recoverable;
    start_surface_ += recoverable - row_.recoverable;
    row_.recoverable = recoverable;
}

void EnergyLedger::renew(const Model& model, double weakest_point) {
    smallest_mass_ = std::min(smallest_mass_, std::ranges::min(model.corner_mass));
    weakest_point_ = std::min(weakest_point_, weakest_point);
}

std::span<const EnergyTerm> energy_terms() {
    using R = EnergyRow;
    using S = StepReport;
    using W = RareWorks;
    static constexpr EnergyTerm terms[] = {
        number<&R::time>("time", "s", "end of the step"),
        number<&R::kinetic>("kinetic", "J", "kinetic energy; with the explicit bulk at the middle of the step",
                            {.drawn = 1, .label = "kinetic", .colour = blue, .always = true}),
        number<&R::strain>("strain", "J",
                           "elastic energy; with the explicit bulk 1/2 u_n' K u_{n+1}, with large rotations U_n - 1/2 "
                           "f_n . (u_{n+1} - u_n)",
                           {.drawn = 1, .label = "strain", .colour = orange, .always = true}),
        {{{"surface", "J", "energy Psi of broken and damaged interfaces: dissipated + recoverable + interface_elastic"},
          [](const R& r) { return r.surface(); }},
         nullptr,
         {}},
        number<&R::dissipated>("dissipated", "J",
                               "energy that damage has consumed irreversibly: G_c (1 - beta)^2 over all interface "
                               "points with linear softening",
                               {.drawn = 1, .label = "dissipated", .colour = vermilion, .always = true}),
        number<&R::recoverable>("recoverable", "J",
                                "energy that damaged interfaces return when they close: beta sigma_c s",
                                {.drawn = 1, .label = "recoverable", .colour = green}),
        number<&R::interface_elastic>(
            "interface_elastic", "J",
            "energy that damaged interfaces with secant unloading return when they close: beta sigma_c s^2/(2 kappa); "
            "where there is some",
            {.with = &W::secant, .drawn = 1, .label = "recoverable, secant", .colour = sky, .dash = 1}),
        number<&R::external_work>("external_work", "J", "work of loads and prescribed motions so far",
                                  {.step = &S::external_work, .work = 1}),
        number<&R::cohesive_work>("cohesive_work", "J", "work against the cohesion so far",
                                  {.step = &S::cohesive_work, .work = -1}),
        number<&R::friction_work>(
            "friction_work", "J", "work of friction so far, never positive",
            {.step = &S::friction_work, .work = 1, .drawn = -1, .label = "lost in friction", .colour = purple}),
        number<&R::cohesive_friction_work>(
            "cohesive_friction_work", "J",
            "part of friction_work on the pressure by which contact balances the cohesion: it acts without any "
            "pressure "
            "between the sides, so that sliding alone costs G_c (1 + friction/gamma); where cohesion has friction",
            {.with = &W::cohesive_friction, .step = &S::cohesive_friction_work}),
        number<&R::impact_work>(
            "impact_work", "J", "work of impacts so far, never positive",
            {.step = &S::impact_work, .work = 1, .drawn = -1, .label = "lost in impact", .colour = sky}),
        number<&R::residual>("residual", "J", "error of the discrete energy balance"),
        number<&R::law_lag>("law_lag_energy", "J",
                            "law lag (staggering error of beta): cohesive_work + law_change - crossing_loss_energy - "
                            "viscous_dissipation - surface - excavated_recoverable; decreases with the step",
                            {.drawn = 1, .label = "law lag", .colour = vermilion, .dash = 1}),
        number<&R::crossing_loss>(
            "crossing_loss_energy", "J",
            "crossing loss (slip-reversal loss): part of the cohesive work that is lost where slips cross zero, so far",
            {.step = &S::crossing_loss, .drawn = 1, .label = "crossing loss", .colour = purple, .dash = 1}),
        number<&R::scheme_dissipation>("scheme_dissipation", "J",
                                       "energy that theta > 1/2 has damped so far, never negative",
                                       {.step = &S::scheme_dissipation,
                                        .work = -1,
                                        .drawn = 1,
                                        .label = "damped by the scheme",
                                        .colour = green,
                                        .dash = 1}),
        number<&R::step_change_work>("step_change_work", "J",
                                     "change of the leapfrog energy by changes of the step so far",
                                     {.step = &S::step_change_work,
                                      .work = 1,
                                      .drawn = -1,
                                      .label = "lost in changes of step",
                                      .colour = blue,
                                      .dash = 1}),
        number<&R::rotation_work>("rotation_work", "J",
                                  "defect of the elastic energy in the leapfrog energy so far, of second order in the "
                                  "step; with large rotations only",
                                  {.with = &W::rotation,
                                   .step = &S::rotation_work,
                                   .work = 1,
                                   .drawn = -1,
                                   .label = "defect of rotation",
                                   .colour = orange,
                                   .dash = 1}),
        number<&R::damping_work>("damping_work", "J",
                                 "work of mass-proportional damping so far; where there is damping",
                                 {.with = &W::damping,
                                  .step = &S::damping_work,
                                  .work = 1,
                                  .drawn = -1,
                                  .label = "damped",
                                  .colour = green,
                                  .dash = 2}),
        number<&R::bulk_viscosity_work>("bulk_viscosity_work", "J",
                                        "work of bulk and shear viscosity so far; where a material has some",
                                        {.with = &W::viscosity,
                                         .step = &S::bulk_viscosity_work,
                                         .work = 1,
                                         .drawn = -1,
                                         .label = "lost in viscosity",
                                         .colour = green,
                                         .dash = 1}),
        number<&R::radiated_work>("radiated_work", "J",
                                  "work of absorbing boundaries so far, never positive; where there are some",
                                  {.with = &W::radiation,
                                   .step = &S::radiated_work,
                                   .work = 1,
                                   .drawn = -1,
                                   .label = "radiated",
                                   .colour = purple,
                                   .dash = 2}),
        number<&R::excavation_work>(
            "excavation_work", "J",
            "work so far of the forces that excavated regions had on the rest, while they decrease; with excavations",
            {.with = &W::excavation,
             .step = &S::excavation_work,
             .work = 1,
             .drawn = -1,
             .label = "taken by released forces",
             .colour = blue,
             .dash = 2}),
        number<&R::excavated_energy>(
            "excavated_energy", "J",
            "kinetic and elastic energy that left with excavated regions so far; likewise",
            {.with = &W::excavation, .work = -1, .drawn = 1, .label = "excavated", .colour = sky, .dash = 2}),
        number<&R::excavated_recoverable>(
            "excavated_recoverable", "J",
            "recoverable energy of their interfaces that left with them; likewise",
            {.with = &W::excavation, .drawn = 1, .label = "excavated, recoverable", .colour = orange, .dash = 2}),
        number<&R::adaptation>("adaptation", "J",
                               "change of the energy by refinements of the mesh so far: short waves that the old "
                               "vertices carried alone; with [adapt]",
                               {.with = &W::adaptation,
                                .work = 1,
                                .drawn = -1,
                                .label = "lost in refinements",
                                .colour = green,
                                .dash = 1}),
        number<&R::assumptions>("assumptions", "J",
                                "change of the energy where the run went on from another one with large instead of "
                                "small rotations, without heat, or with more obstacles; in such runs",
                                {.with = &W::new_assumptions,
                                 .work = 1,
                                 .drawn = -1,
                                 .label = "lost by other assumptions",
                                 .colour = sky,
                                 .dash = 1}),
        number<&R::thermal_work>("thermal_work", "J", "work of thermal strains that change so far; with heat",
                                 {.with = &W::heat, .step = &S::thermal_work, .work = 1}),
        number<&R::law_change>("law_change", "J",
                               "change of the recoverable and elastic energy of interfaces by strengths that follow "
                               "the temperature, so far; where there are some",
                               {.with = &W::law_change,
                                .step = &S::law_change,
                                .drawn = -1,
                                .label = "lost in changes of strength",
                                .colour = purple,
                                .dash = 2}),
        number<&R::viscous_dissipation>("viscous_dissipation", "J",
                                        "energy that delayed softening has dissipated so far in addition to "
                                        "`dissipated`, never negative; with a relaxation_time",
                                        {.with = &W::delay,
                                         .step = &S::viscous_dissipation,
                                         .drawn = 1,
                                         .label = "dissipated by delay",
                                         .colour = vermilion,
                                         .dash = 2}),
        number<&R::mixed_dissipation>("mixed_dissipation", "J",
                                      "energy that slip has dissipated so far in addition to `dissipated`, since it "
                                      "costs another fracture energy than opening; with a G_II",
                                      {.with = &W::mode_mix,
                                       .step = &S::mixed_dissipation,
                                       .drawn = 1,
                                       .label = "dissipated by slip beyond G_c",
                                       .colour = green,
                                       .dash = 2}),
        number<&R::vibration_booked>("vibration_booked", "J",
                                     "kinetic energy of the vibration of pieces that became rigid so far, taken from "
                                     "the body: never positive; with [rigid]",
                                     {.with = &W::rigid,
                                      .step = &S::vibration_booked,
                                      .work = 1,
                                      .drawn = -1,
                                      .label = "vibration booked",
                                      .colour = orange,
                                      .dash = 2}),
        number<&R::sleep_work>("sleep_work", "J",
                               "kinetic energy of rigid pieces that fell asleep so far, never positive; with [rigid]",
                               {.with = &W::rigid,
                                .step = &S::sleep_work,
                                .work = 1,
                                .drawn = -1,
                                .label = "lost in falling asleep",
                                .colour = blue,
                                .dash = 2}),
        number<&R::exchange_work>(
            "exchange_work", "J",
            "work so far of contacts between rigid pieces and deformable ones, which take their own steps meanwhile: "
            "mostly a loss, of impact and friction; with [rigid]",
            {.with = &W::rigid,
             .step = &S::exchange_work,
             .work = 1,
             .drawn = -1,
             .label = "rigid against deformable",
             .colour = green,
             .dash = 2}),
        number<&R::projection_work>(
            "projection_work", "J",
            "work so far of loads (weight) against which positions of rigid pieces that overlapped were corrected; no "
            "term of the balance, which has no energy of place; with [rigid]",
            {.with = &W::rigid, .step = &S::projection_work}),
        number<&R::rigid_injection>(
            "rigid_injection", "J",
            "positive works so far of contacts of rigid pieces, by the residual of their laws; with [rigid]",
            {.with = &W::rigid, .step = &S::rigid_injection}),
        number<&R::thaw_dissipation>(
            "thaw_dissipation", "J",
            "part of dissipated that fell into the first step of pieces that a blow had made deformable; with [rigid]",
            {.with = &W::rigid, .step = &S::thaw_dissipation}),
        number<&R::heat>("heat", "J", "heat stored since the start, sum of C (T - T at the start); with conduction",
                         {.with = &W::conduction}),
        number<&R::heat_in>("heat_in", "J",
                            "heat that came through boundaries and from sources so far; with conduction",
                            {.with = &W::conduction}),
        number<&R::step>("step", "s", "size of the last step")};
    static_assert(
        std::ranges::count_if(terms, [](const EnergyTerm& term) { return term.value != nullptr; }) * sizeof(double) ==
            sizeof(R),
        "every member of EnergyRow has a row");
    return terms;
}

double incubation_energy(const Model& model, const State& state) {
    double sum = 0;
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const double phi = state.strength_factor(state.split_fans[s]);
        if (phi == 1) continue;
        const auto points = model.points(model.fans[state.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const CohesiveLaw& law = law_of(model, state, points[j]);
            if (points[j].cracked || !law.breakable() || law.sigma_c <= 0) continue;
            const PointState& known = state.points[state.first_point[s] + j];
            sum += (phi - 1) * points[j].area *
                   law.consumed(known.cohesion, law.ramp(known.cohesion, known.largest_opening));
        }
    }
    return sum;
}

namespace {
constexpr double bins_per_octave = 64;
}

void MedianOverTime::add(double value, double duration) {
    const int bin = value > 0 ? static_cast<int>(std::floor(bins_per_octave * std::log2(value))) : INT_MIN;
    const auto at = std::ranges::lower_bound(bins_, bin);
    const auto i = at - bins_.begin();
    if (at == bins_.end() || *at != bin) bins_.insert(at, bin), durations_.insert(durations_.begin() + i, 0.0);
    durations_[i] += duration;
}

double MedianOverTime::median() const {
    double all = 0, below = 0;
    for (const double duration : durations_) all += duration;
    for (std::size_t i = 0; i < bins_.size(); ++i)
        if (below += durations_[i]; below >= 0.5 * all)
            return bins_[i] == INT_MIN ? 0 : std::exp2((bins_[i] + 0.5) / bins_per_octave);
    return std::nan("");
}

std::vector<Measure<EnergyRow>> energy_columns(const RareWorks& works) {
    std::vector<Measure<EnergyRow>> columns;
    for (const EnergyTerm& term : energy_terms())
        if (term.use.with == nullptr || works.*term.use.with) columns.push_back(term);
    return columns;
}

}  // namespace knap
