#include "record/summary.hpp"

#include "analysis/fragments.hpp"
#include "analysis/strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace knap {

double Summary::operator[](const std::string& name) const {
    for (const auto& [key, value] : values)
        if (key == name) return value;
    return std::nan("");
}

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// The largest force [N] of a load or obstacle over the lines of reactions.csv, and at the end.
double largest_force(const Recorder& recorder, std::size_t number, const Reaction& at_end) {
    double largest = at_end.force.norm();
    for (const std::vector<double>& row : recorder.histories().reactions.rows)
        largest = std::max(largest, std::hypot(row[1 + 4 * number], row[2 + 4 * number]));
    return largest;
}

/// What a summary is made of.
struct Facts {
    Facts(const Model& model, const State& end, const Recorder& recorder, double rayleigh_speed);

    double part(double energy) const { return energy / (ledger.largest_energy() > 0 ? ledger.largest_energy() : 1); }
    bool overlaps() const { return deformation.overlap().value > 0; }
    bool has_breaks() const { return !recorder.histories().breaks.columns.empty(); }
    const SpecimenOptions* specimen() const { return recorder.options().specimen ? &*recorder.options().specimen : nullptr; }

    const Recorder& recorder;
    const EnergyLedger& ledger;
    const EnergyRow& energy;
    const DeformationWatch& deformation;
    const CrackHistory& cracks;
    const CrackPattern& pattern;
    double rayleigh_speed;  // [m/s]
    Vec2 momentum = Vec2::Zero(), mean_displacement = Vec2::Zero();  // [kg m/s], [m]
    std::vector<Reaction> reactions;  // at the end
    std::optional<std::size_t> driver;  // the first load or obstacle that moves, or else the first one
    History fragments;
    double n_tensile = none, n_shear = none;
    Strength strength;
    MaterialConstants material{none, none};
};

Facts::Facts(const Model& model, const State& end, const Recorder& of, double speed)
    : recorder(of), ledger(of.ledger()), energy(ledger.row()), deformation(of.deformation()), cracks(of.cracks()), pattern(cracks.pattern()), rayleigh_speed(speed) {
    double mass = 0;
    Vec2 moment = Vec2::Zero();
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        momentum += model.corner_mass[c] * end.velocity[end.node_of_corner[c]];
        moment += model.corner_mass[c] * end.displacement[end.node_of_corner[c]];
        mass += model.corner_mass[c];
    }
    mean_displacement = moment / mass;
    fragments = fragment_table(find_fragments(model, end));
    if (!recorder.reactions().empty()) {
        reactions = recorder.reactions().at(end);
        const auto moves = [](const Reaction& reaction) { return !reaction.displacement.isZero(0); };
        const std::size_t found = std::find_if(reactions.begin(), reactions.end(), moves) - reactions.begin();
        driver = found < reactions.size() ? found : 0;
    }
    if (has_breaks()) {
        const std::vector<double> shear = recorder.histories().breaks.column("shear");
        n_shear = static_cast<double>(std::count_if(shear.begin(), shear.end(), is_shear));
        n_tensile = static_cast<double>(shear.size()) - n_shear;
    }
    if (!specimen()) return;
    strength = strength_of(recorder.histories().stress_strain, specimen()->modulus_between);
    if (specimen()->lateral) material = material_constants(strength, model.plane);
}

using F = Facts;

bool always(const F&) { return true; }
bool with_breaks(const F& f) { return f.has_breaks(); }
bool of_specimen(const F& f) { return f.specimen() != nullptr; }
bool with_gauge(const F& f) { return f.specimen() != nullptr && f.specimen()->lateral; }
bool in_compression(const F& f) { return with_gauge(f) && f.specimen()->test == SpecimenOptions::Test::compression; }

double farthest_law_lag(const F& f) {
    const double last = f.ledger.law_lag(), largest = f.ledger.largest_law_lag();
    return std::abs(last) > std::abs(largest) ? last : largest;
}

struct SummaryRow {
    std::string_view name, unit, doc;
    double (*of)(const F&);         // NaN: never happened
    bool (*is_there)(const F&) = always;  // whether a run has this number at all
};

constexpr std::array rows{
    SummaryRow{"energy_residual", "", "largest error of the energy balance over the run, relative to the largest energy",
               [](const F& f) { return f.part(f.ledger.largest_residual()); }},
    SummaryRow{"law_lag_at_end", "", "work of the interfaces beyond what their law takes, over the dissipated energy", [](const F& f) { return f.ledger.law_lag(); }},
    SummaryRow{"largest_law_lag", "",
               "the same where it was farthest from zero over the run, less than a hundredth of the largest energy counting as that; its size is the gate law_lag",
               farthest_law_lag},
    SummaryRow{"crossing_loss", "", "energy lost where slips cross zero, over the dissipated energy", [](const F& f) { return f.ledger.over_dissipated(f.energy.crossing_loss); }},
    SummaryRow{"external_work", "J", "work of loads and prescribed motions", [](const F& f) { return f.energy.external_work; }},
    SummaryRow{"dissipated", "J", "energy that broken and damaged interfaces have taken for ever: G_c (1 - beta)^2, at the end", [](const F& f) { return f.energy.dissipated; }},
    SummaryRow{"recoverable", "J", "energy that damaged interfaces give back when they close: beta sigma_c s, at the end", [](const F& f) { return f.energy.recoverable; }},
    SummaryRow{"friction_work", "J", "work of friction, never positive", [](const F& f) { return f.energy.friction_work; }},
    SummaryRow{"impact_work", "J", "work of all impacts, never positive", [](const F& f) { return f.energy.impact_work; }},
    SummaryRow{"scheme_dissipation", "J", "what theta > 1/2 took away, never negative", [](const F& f) { return f.energy.scheme_dissipation; }},
    SummaryRow{"kinetic_energy", "J", "at the end", [](const F& f) { return f.energy.kinetic; }},
    SummaryRow{"strain_energy", "J", "at the end", [](const F& f) { return f.energy.strain; }},
    SummaryRow{"momentum_x", "kg m/s", "of the whole body at the end", [](const F& f) { return f.momentum.x(); }},
    SummaryRow{"momentum_y", "kg m/s", "likewise", [](const F& f) { return f.momentum.y(); }},
    SummaryRow{"mean_displacement_x", "m", "of the centre of mass at the end", [](const F& f) { return f.mean_displacement.x(); }},
    SummaryRow{"mean_displacement_y", "m", "likewise", [](const F& f) { return f.mean_displacement.y(); }},
    SummaryRow{"reaction_x", "N", "force on the body, at the end, of the load or obstacle that run.json calls reaction_of: the first that moves",
               [](const F& f) { return f.driver ? f.reactions[*f.driver].force.x() : none; }},
    SummaryRow{"reaction_y", "N", "likewise", [](const F& f) { return f.driver ? f.reactions[*f.driver].force.y() : none; }},
    SummaryRow{"largest_reaction", "N", "its largest size over the run",
               [](const F& f) { return f.driver ? largest_force(f.recorder, *f.driver, f.reactions[*f.driver]) : none; }},
    SummaryRow{"broken_length", "m", "length of all broken interfaces", [](const F& f) { return f.pattern.broken_length; }},
    SummaryRow{"crack_length", "m", "length of all arms of cracks, along edges, without twigs and single broken interfaces", [](const F& f) { return f.pattern.crack_length; }},
    SummaryRow{"main_length", "m", "length of the main crack, along chords", [](const F& f) { return f.pattern.main_length; }},
    SummaryRow{"first_growth_time", "s", "first edge of a crack that counts", [](const F& f) { return f.cracks.first_growth_time().value_or(none); }},
    SummaryRow{"max_tip_speed", "m/s", "largest speed of any crack tip, over half a window of growth or more",
               [](const F& f) { return f.cracks.max_tip_speed(); }},
    SummaryRow{"mean_tip_speed", "m/s", "of the tip of the main crack, its mean over the second half of the growth", [](const F& f) { return f.cracks.mean_tip_speed(); }},
    SummaryRow{"max_tip_speed_over_cR", "", "max_tip_speed over the Rayleigh speed",
               [](const F& f) { return f.rayleigh_speed > 0 ? f.cracks.max_tip_speed() / f.rayleigh_speed : none; }},
    SummaryRow{"tips", "", "number of crack tips at the end that have not arrived at a boundary or at another crack",
               [](const F& f) { return static_cast<double>(f.pattern.tips.size()); }},
    SummaryRow{"branches", "", "number of branchings at the end", [](const F& f) { return static_cast<double>(f.pattern.n_branches); }},
    SummaryRow{"first_branch_time", "s", "first branching", [](const F& f) { return f.cracks.first_branching() ? f.cracks.first_branching()->time : none; }},
    SummaryRow{"first_branch_x", "m", "where it was", [](const F& f) { return f.cracks.first_branching() ? f.cracks.first_branching()->position.x() : none; }},
    SummaryRow{"first_branch_y", "m", "likewise", [](const F& f) { return f.cracks.first_branching() ? f.cracks.first_branching()->position.y() : none; }},
    SummaryRow{"fragments", "", "number of pieces at the end", [](const F& f) { return static_cast<double>(f.fragments.rows.size()); }},
    SummaryRow{"largest_fragment", "", "its part of the mass, at the end", [](const F& f) { return f.fragments.column("mass_part").front(); }},
    SummaryRow{"median_fragment", "m", "diameter that half of the mass does not exceed (circle of the same area), at the end",
               [](const F& f) { return diameter_passing(f.fragments, 0.5); }},
    SummaryRow{"tensile_breaks", "", "number of interfaces that broke more by opening than by sliding; with output.breaks",
               [](const F& f) { return f.n_tensile; }, with_breaks},
    SummaryRow{"shear_breaks", "", "number of interfaces that broke more by sliding; with output.breaks",
               [](const F& f) { return f.n_shear; }, with_breaks},
    SummaryRow{"peak_stress", "Pa", "largest stress of the specimen: its strength", [](const F& f) { return f.strength.peak_stress; }, of_specimen},
    SummaryRow{"peak_strain", "", "axial strain there", [](const F& f) { return f.strength.peak_strain; }, of_specimen},
    SummaryRow{"tangent_modulus", "Pa", "slope of stress over axial strain, in the plane, of a specimen",
               [](const F& f) { return f.strength.tangent_modulus; }, of_specimen},
    SummaryRow{"youngs_modulus", "Pa", "of the material of a specimen: in plane strain the tangent modulus times 1 - nu^2, which needs a lateral gauge",
               [](const F& f) { return f.material.E; }, with_gauge},
    SummaryRow{"poisson_ratio", "", "of the material of a specimen with a lateral gauge", [](const F& f) { return f.material.nu; }, with_gauge},
    SummaryRow{"crack_initiation_stress", "Pa", "stress of a specimen with 1 % of the breaks of the peak (Potyondy and Cundall 2004)",
               [](const F& f) { return f.strength.crack_initiation; }, of_specimen},
    SummaryRow{"dilatancy_stress", "Pa", "stress from which the crack volumetric strain leaves zero (Martin and Chandler 1994); compression with a lateral gauge",
               [](const F& f) { return f.strength.dilatancy; }, in_compression},
    SummaryRow{"crack_damage_stress", "Pa", "stress at which the volumetric strain turns from shrinking to growing (Martin and Chandler 1994); likewise",
               [](const F& f) { return f.strength.crack_damage; }, in_compression},
    SummaryRow{"largest_penetration", "m", "largest overlap of two sides in contact over the run",
               [](const F& f) { return f.ledger.worst().penetration; }},
    SummaryRow{"largest_speed", "m/s", "largest speed of any corner over the run", [](const F& f) { return f.ledger.worst().largest_speed; }},
    SummaryRow{"largest_rotation", "deg", "largest rotation of a triangle over the run", [](const F& f) { return f.deformation.rotation().value; }},
    SummaryRow{"largest_area_change", "", "largest change of the area of a triangle over its area, over the run", [](const F& f) { return f.deformation.area_change().value; }},
    SummaryRow{"largest_slip", "", "largest slip of a point under pressure over the run, in lengths of its edge; along a straight support none",
               [](const F& f) { return f.deformation.slip().value; }},
    SummaryRow{"overlap_area", "m2", "largest area that the deformed body covers twice, looked for at frames and each time the fastest vertex has gone about a tenth of an edge",
               [](const F& f) { return f.deformation.overlap().value; }},
    SummaryRow{"overlap_x", "m", "where its largest part is, in the deformed body", [](const F& f) { return f.overlaps() ? f.deformation.overlap().place.x() : none; }},
    SummaryRow{"overlap_y", "m", "likewise", [](const F& f) { return f.overlaps() ? f.deformation.overlap().place.y() : none; }},
};

/// Of every load and obstacle that drives, after its name.
struct Driver {
    const Recorder& recorder;
    std::size_t number;
    const Reaction& at_end;
};
constexpr std::array driver_rows{
    Measure<Driver>{"*_force_x", "N", "force on the body, at the end, of each load that prescribes a motion and each obstacle, by its name",
                    [](const Driver& d) { return d.at_end.force.x(); }},
    Measure<Driver>{"*_force_y", "N", "likewise", [](const Driver& d) { return d.at_end.force.y(); }},
    Measure<Driver>{"*_largest_force", "N", "its largest size over the lines of reactions.csv",
                    [](const Driver& d) { return largest_force(d.recorder, d.number, d.at_end); }},
};

}  // namespace

std::vector<Output> summary_outputs() {
    std::vector<Output> outputs;
    for (const SummaryRow& row : rows) outputs.push_back({row.name, row.unit, row.doc});
    for (const auto& row : driver_rows) outputs.push_back({row.name, row.unit, row.doc});
    return outputs;
}

Summary summarise(const Model& model, const State& end, const Recorder& recorder, double rayleigh_speed) {
    const Facts facts(model, end, recorder, rayleigh_speed);
    Summary summary;
    for (const SummaryRow& row : rows)
        if (row.is_there(facts)) summary.values.emplace_back(row.name, row.of(facts));
    const std::vector<std::string> names = recorder.reactions().names();
    for (std::size_t i = 0; i < facts.reactions.size(); ++i)
        for (const auto& row : driver_rows) summary.values.emplace_back(names[i] + std::string(row.name.substr(1)), row.of({recorder, i, facts.reactions[i]}));
    if (facts.driver) summary.reaction_of = names[*facts.driver];
    return summary;
}

}  // namespace knap
