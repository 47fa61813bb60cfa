#include "observe/summary.hpp"

#include "observe/fragments.hpp"
#include "observe/strength.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {

double Summary::operator[](const std::string& name) const {
    for (const auto& [key, value] : values)
        if (key == name) return value;
    return std::nan("");
}

namespace {

/// The reaction of the first load or obstacle that moves, or else of the first that holds anything.
struct Driver {
    Vec2 force = Vec2::Constant(std::nan(""));  // [N] at the end
    double largest = std::nan("");              // [N] over the lines of reactions.csv
};

Driver driver(const Recorder& recorder, const State& end) {
    if (recorder.reactions().empty()) return {};
    const std::vector<Reaction> all = recorder.reactions().at(end);
    const auto moves = [](const Reaction& reaction) { return !reaction.displacement.isZero(0); };
    const std::size_t found = std::find_if(all.begin(), all.end(), moves) - all.begin(), load = found < all.size() ? found : 0;
    Driver driver{.force = all[load].force, .largest = all[load].force.norm()};
    for (const std::vector<double>& row : recorder.histories().reactions.rows)
        driver.largest = std::max(driver.largest, std::hypot(row[1 + 4 * load], row[2 + 4 * load]));
    return driver;
}

/// [m/s] slope of the length of the main crack over the second half of its growth.
double mean_tip_speed(const Recorder& recorder) {
    const History& cracks = recorder.histories().cracks;
    if (cracks.rows.empty()) return std::nan("");
    const std::vector<double> time = cracks.column("time"), length = cracks.column("length");
    std::vector<std::pair<double, double>> samples;
    for (std::size_t i = 0; i < time.size() && (i == 0 || length[i - 1] < length.back()); ++i)
        if (length[i] >= 0.5 * length.back()) samples.emplace_back(time[i], length[i]);
    if (samples.size() < 2) return std::nan("");
    return speed_over_window(samples, samples.back().second - samples.front().second);
}

using Values = std::vector<std::pair<std::string, double>>;

void add_breaks(const Recorder& recorder, Values& values) {
    const History& breaks = recorder.histories().breaks;
    if (breaks.columns.empty()) return;
    const std::vector<double> shear = breaks.column("shear");
    const auto n_shear = static_cast<double>(std::count_if(shear.begin(), shear.end(), is_shear));
    values.insert(values.end(), {{"tensile_breaks", static_cast<double>(shear.size()) - n_shear}, {"shear_breaks", n_shear}});
}

void add_strength(const Recorder& recorder, PlaneModel plane, Values& values) {
    if (!recorder.options().specimen) return;
    const SpecimenOptions& specimen = *recorder.options().specimen;
    const Strength s = strength_of(recorder.histories().stress_strain, specimen.modulus_between);
    values.insert(values.end(), {{"peak_stress", s.peak_stress}, {"peak_strain", s.peak_strain}, {"tangent_modulus", s.tangent_modulus}});
    if (specimen.lateral) {
        const MaterialConstants material = material_constants(s, plane);
        values.insert(values.end(), {{"youngs_modulus", material.E}, {"poisson_ratio", material.nu}});
    }
    values.emplace_back("crack_initiation_stress", s.crack_initiation);
    if (specimen.lateral && specimen.test == SpecimenOptions::Test::compression)
        values.insert(values.end(), {{"dilatancy_stress", s.dilatancy}, {"crack_damage_stress", s.crack_damage}});
}

}  // namespace

Summary summarise(const Model& model, const State& end, const Recorder& recorder, double rayleigh_speed) {
    const EnergyLedger& ledger = recorder.ledger();
    const EnergyRow& energy = ledger.row();
    const CrackHistory& cracks = recorder.cracks();
    const CrackPattern& pattern = cracks.pattern();
    const double scale = ledger.largest_energy() > 0 ? ledger.largest_energy() : 1;
    constexpr double never = std::numeric_limits<double>::quiet_NaN();
    const auto branching = cracks.first_branching();

    const Driver driven = driver(recorder, end);
    Vec2 momentum = Vec2::Zero(), moment = Vec2::Zero();
    double mass = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        momentum += model.corner_mass[c] * end.velocity[end.node_of_corner[c]];
        moment += model.corner_mass[c] * end.displacement[end.node_of_corner[c]];
        mass += model.corner_mass[c];
    }
    const History fragments = fragment_table(find_fragments(model, end));
    Summary summary{{
        {"energy_residual", ledger.largest_residual() / scale},
        {"law_lag", ledger.largest_law_lag() / scale},
        {"crossing_loss", energy.crossing_loss / scale},
        {"external_work", energy.external_work},
        {"dissipated", energy.surface},
        {"friction_work", energy.friction_work},
        {"impact_work", energy.impact_work},
        {"scheme_dissipation", energy.scheme_dissipation},
        {"kinetic_energy", energy.kinetic},
        {"strain_energy", energy.strain},
        {"momentum_x", momentum.x()},
        {"momentum_y", momentum.y()},
        {"mean_displacement_x", moment.x() / mass},
        {"mean_displacement_y", moment.y() / mass},
        {"reaction_x", driven.force.x()},
        {"reaction_y", driven.force.y()},
        {"largest_reaction", driven.largest},
        {"broken_length", pattern.broken_length},
        {"crack_length", pattern.crack_length},
        {"first_growth_time", cracks.first_growth_time().value_or(never)},
        {"max_tip_speed", cracks.max_tip_speed()},
        {"mean_tip_speed", mean_tip_speed(recorder)},
        {"max_tip_speed_over_cR", rayleigh_speed > 0 ? cracks.max_tip_speed() / rayleigh_speed : never},
        {"tips", static_cast<double>(pattern.tips.size())},
        {"branches", static_cast<double>(pattern.n_branches())},
        {"first_branch_time", branching ? branching->time : never},
        {"first_branch_x", branching ? branching->position.x() : never},
        {"first_branch_y", branching ? branching->position.y() : never},
        {"fragments", static_cast<double>(fragments.rows.size())},
        {"largest_fragment", fragments.column("mass_part").front()},
        {"median_fragment", diameter_passing(fragments, 0.5)},
        {"largest_penetration", ledger.worst().penetration},
        {"largest_speed", ledger.worst().largest_speed},
    }};
    add_breaks(recorder, summary.values);
    add_strength(recorder, model.plane, summary.values);
    return summary;
}

}  // namespace knap
