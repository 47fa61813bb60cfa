#include "record/summary.hpp"

#include "analysis/fragments.hpp"
#include "base/formatted.hpp"
#include "figures/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace knap {

double Summary::operator[](const std::string& name) const {
    const auto found = std::ranges::find(values, name, &std::pair<std::string, double>::first);
    return found == values.end() ? std::nan("") : found->second;
}

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A load or obstacle that drives the body.
struct Driver {
    std::size_t number;
    const Reaction& at_end;
    double largest_force;  // [N] over all steps
};

/// Cracks where edges are too long for their process zone, as beyond a place of small triangles.
struct Unresolved {
    double part = not_a_number;                     // [-] of the length of all cracks
    Vec2 place = Vec2(not_a_number, not_a_number);  // [m] where it began
};

/// On edges longer than `longest` [m]; 0: no law has a process zone.
Unresolved unresolved(const CrackHistory& cracks, double longest) {
    if (longest == 0) return {};
    const CrackedEdges& edges = cracks.arms().edges();
    const InterfaceGraph& graph = edges.graph();
    Unresolved found;
    double all = 0, coarse = 0, first = CrackedEdges::never;
    for (Index e = 0; e < static_cast<Index>(graph.length.size()); ++e) {
        if (!edges.cracked(e)) continue;
        all += graph.length[e];
        if (graph.length[e] <= longest) continue;
        coarse += graph.length[e];
        if (edges.since(e) >= first) continue;
        first = edges.since(e);
        found.place = 0.5 * (graph.vertices[graph.ends[e][0]] + graph.vertices[graph.ends[e][1]]);
    }
    if (all > 0) found.part = coarse / all;
    return found;
}

/// The data from which the numbers are computed.
struct Facts {
    Facts(const Model& model, const State& end, const Recorder& recorder);

    const Recorder& recorder;
    const EnergyLedger& ledger = recorder.ledger();
    const EnergyRow& energy = ledger.row();
    const DeformationWatch& deformation = recorder.deformation();
    const Extreme& overlap = deformation.overlap();
    const CrackHistory& cracks = recorder.cracks();
    const CrackPattern& pattern = cracks.pattern();
    double rayleigh_speed = recorder.options().context.rayleigh_speed;  // [m/s]
    const std::optional<SpecimenOptions>& specimen = recorder.options().specimen;
    const RecorderOptions::Calibrated& toughness = recorder.options().toughness;
    const RecorderOptions::Calibrated& sigma_c = recorder.options().strength;
    Vec2 momentum = Vec2::Zero(), mean_displacement = Vec2::Zero();  // [kg m/s], [m]
    double largest_displacement = 0;                                 // [m]
    bool has_moved_mass;
    double moved_kinetic = 0;         // [J]
    std::vector<Reaction> reactions;  // at the end
    std::optional<Driver> driver;     // the first load or obstacle that moves, or else the first one
    History fragments;
    Unresolved unresolved;
    double incubation;  // [J]
    double thickness;   // [m]
    double n_tensile = not_a_number, n_shear = not_a_number;
    Vec2 first_break = Vec2::Constant(not_a_number);  // [m]
    Strength strength;
    MaterialConstants material{not_a_number, not_a_number};
};

Facts::Facts(const Model& model, const State& end, const Recorder& of)
    : recorder(of),
      has_moved_mass(!model.mass_factor.empty()),
      incubation(incubation_energy(model, end)),
      thickness(model.thickness) {
    double mass = 0;
    Vec2 moment = Vec2::Zero();
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        if (model.has_vanished(model.mesh.triangle_of(c))) continue;
        momentum += model.corner_mass[c] * end.velocity[end.node_of_corner[c]];
        moment += model.corner_mass[c] * end.displacement[end.node_of_corner[c]];
        mass += model.corner_mass[c];
        if (has_moved_mass)
            moved_kinetic += 0.5 * model.corner_mass[c] * (1 - 1 / model.mass_factor[model.mesh.triangle_of(c)]) *
                             end.velocity[end.node_of_corner[c]].squaredNorm();
        largest_displacement = std::max(largest_displacement, end.displacement_of(c).norm());
    }
    mean_displacement = moment / mass;
    unresolved = knap::unresolved(cracks, recorder.options().cracks.speed_length);
    fragments = fragment_table(find_fragments(model, end));
    if (!recorder.reactions().empty()) {
        reactions = recorder.reactions().at(end);
        const auto moving =
            std::ranges::find_if(reactions, [](const Reaction& r) { return !r.displacement.isZero(0); });
        const std::size_t number = moving == reactions.end() ? 0 : moving - reactions.begin();
        driver.emplace(Driver{number, reactions[number], recorder.reactions().largest_forces()[number]});
    }
    if (!recorder.histories().breaks.columns.empty()) {
        const std::vector<double> shear = recorder.histories().breaks.column("shear");
        n_shear = static_cast<double>(std::ranges::count_if(shear, is_shear));
        n_tensile = static_cast<double>(shear.size()) - n_shear;
        if (!shear.empty())
            first_break = {recorder.histories().breaks.column("x").front(),
                           recorder.histories().breaks.column("y").front()};
    }
    if (!specimen) return;
    strength = recorder.strength();
    if (specimen->lateral) material = material_constants(strength, model.plane);
}

using F = const Facts&;

bool always(F) { return true; }
bool as_measured(F f) { return f.toughness.measured > 0; }
bool with_measured_strength(F f) { return f.sigma_c.measured > 0; }
bool with_breaks(F f) { return !std::isnan(f.n_shear); }
bool with_moved_mass(F f) { return f.has_moved_mass; }
bool excavates(F f) { return f.recorder.options().works.excavation; }
bool with_heat(F f) { return f.recorder.options().works.heat; }
bool mixes_modes(F f) { return f.recorder.options().works.mode_mix; }
bool delays(F f) { return f.recorder.options().works.delay; }
bool incubates(F f) { return f.recorder.options().works.incubation; }
bool with_cohesive_friction(F f) { return f.recorder.options().works.cohesive_friction; }
bool may_rest(F f) { return f.recorder.rest() != nullptr; }
bool of_specimen(F f) { return f.specimen.has_value(); }
bool with_law_strength(F f) { return of_specimen(f) && f.recorder.options().law_strength.of_interfaces > 0; }
bool with_measured_specimen(F f) { return of_specimen(f) && f.recorder.options().law_strength.measured > 0; }
bool with_gauge(F f) { return f.specimen && f.specimen->lateral; }
bool in_compression(F f) { return with_gauge(f) && f.specimen->test == SpecimenOptions::Test::compression; }

double farthest_law_lag(F f) {
    const double last = f.ledger.law_lag(), largest = f.ledger.largest_law_lag();
    return std::abs(last) > std::abs(largest) ? last : largest;
}
FirstBranching branching(F f) {
    return f.cracks.first_branching().value_or(FirstBranching{not_a_number, {not_a_number, not_a_number}});
}
Vec2 overlap_place(F f) { return f.overlap.value > 0 ? f.overlap.place : Vec2(not_a_number, not_a_number); }
double over(double value, double scale) { return scale > 0 ? value / scale : not_a_number; }

/// [J/m2] Over the growth of the main crack between a quarter and nine tenths of its length.
double steady_work_per_advance(F f) {
    const auto advance = f.cracks.advance_between(0.25, 0.9);
    return advance ? over(advance->work, advance->length * f.thickness) : not_a_number;
}

struct SummaryRow {
    std::string_view name, unit, doc;
    double (*of)(F);             // NaN: never happened
    bool (*exists)(F) = always;  // whether a run has this number at all
};

constexpr SummaryRow rows[]{
    {"energy_residual", "", "largest error of the energy balance, relative to the largest energy",
     [](F f) {
         const double energy = f.ledger.largest_energy();
         return f.ledger.largest_residual() / (energy > 0 ? energy : 1);
     }},
    {"law_lag_at_end", "",
     "work of the interfaces in excess of what their law dissipates, over the dissipated energy, at the end; one below "
     "the fracture energy of the weakest point counts as that",
     [](F f) { return f.ledger.law_lag(); }},
    {"largest_law_lag", "",
     "the same where it was farthest from zero over the run; a dissipated energy below a hundredth of the "
     "largest energy counts as that hundredth; its absolute value is the gate law_lag",
     farthest_law_lag},
    {"crossing_loss", "", "energy lost in steps in which a slip changes its sign, over the dissipated energy",
     [](F f) { return f.ledger.over_dissipated(f.energy.crossing_loss); }},
    {"external_work", "J", "work of loads and prescribed motions", [](F f) { return f.energy.external_work; }},
    {"dissipated", "J", "energy dissipated by broken and damaged interfaces, G_c (1 - beta)^2, at the end",
     [](F f) { return f.energy.dissipated; }},
    {"recoverable", "J", "energy that damaged interfaces return when they close, beta sigma_c s, at the end",
     [](F f) { return f.energy.recoverable; }},
    {"viscous_dissipation", "J", "energy that delayed softening dissipated in addition; with a relaxation_time",
     [](F f) { return f.energy.viscous_dissipation; }, delays},
    {"mixed_dissipation", "J",
     "energy that slip dissipated in addition, since it costs another fracture energy than opening; with a G_II",
     [](F f) { return f.energy.mixed_dissipation; }, mixes_modes},
    {"incubation_dissipation", "J",
     "part of `dissipated` beyond the fracture energy of the laws, by incubated strengths; with an incubation_time",
     [](F f) { return f.incubation; }, incubates},
    {"largest_strength_factor", "",
     "largest factor on strength and fracture energy of a vertex that split; with an incubation_time; 0: none split",
     [](F f) { return f.ledger.worst().largest_strength_factor; }, incubates},
    {"friction_work", "J", "work of friction, never positive", [](F f) { return f.energy.friction_work; }},
    {"cohesive_friction_work", "J",
     "part of friction_work that acts without pressure between the sides, on what balances the cohesion; where "
     "cohesion "
     "has friction",
     [](F f) { return f.energy.cohesive_friction_work; }, with_cohesive_friction},
    {"impact_work", "J", "work of all impacts, never positive", [](F f) { return f.energy.impact_work; }},
    {"excavation_work", "J", "work of the forces of excavated regions while they decrease; with excavations",
     [](F f) { return f.energy.excavation_work; }, excavates},
    {"excavated_energy", "J", "kinetic and elastic energy that left with excavated regions; likewise",
     [](F f) { return f.energy.excavated_energy; }, excavates},
    {"scheme_dissipation", "J", "energy dissipated by theta > 1/2, never negative",
     [](F f) { return f.energy.scheme_dissipation; }},
    {"kinetic_energy", "J", "at the end", [](F f) { return f.energy.kinetic; }},
    {"moved_kinetic_energy", "J",
     "part of it that mass has where it moved, less what it would have where it was taken; with time.mass_scaling",
     [](F f) { return f.moved_kinetic; }, with_moved_mass},
    {"strain_energy", "J", "at the end", [](F f) { return f.energy.strain; }},
    {"kinetic_part", "",
     "kinetic over strain energy, without that of pieces that fly and spin, median over the time, within 1 %; with "
     "heat, where time_factor or a fast field adds inertia that the real process has not: small where the motion is "
     "quasi-static",
     [](F f) { return f.ledger.kinetic_part(); }, with_heat},
    {"momentum_x", "kg m/s", "of the whole body at the end", [](F f) { return f.momentum.x(); }},
    {"momentum_y", "kg m/s", "likewise", [](F f) { return f.momentum.y(); }},
    {"mean_displacement_x", "m", "of the centre of mass at the end", [](F f) { return f.mean_displacement.x(); }},
    {"mean_displacement_y", "m", "likewise", [](F f) { return f.mean_displacement.y(); }},
    {"largest_displacement", "m", "of any vertex at the end", [](F f) { return f.largest_displacement; }},
    {"reaction_x", "N",
     "force on the body, at the end, of the load or obstacle named by reaction_of in run.json: the first one "
     "that moves",
     [](F f) { return f.driver ? f.driver->at_end.force.x() : not_a_number; }},
    {"reaction_y", "N", "likewise", [](F f) { return f.driver ? f.driver->at_end.force.y() : not_a_number; }},
    {"largest_reaction", "N", "largest magnitude of this force over all steps; of a blow, its impulse over the step",
     [](F f) { return f.driver ? f.driver->largest_force : not_a_number; }},
    {"broken_length", "m", "length of all broken interfaces", [](F f) { return f.pattern.broken_length; }},
    {"crack_length", "m", "length of all crack arms along edges, without side twigs and single broken interfaces",
     [](F f) { return f.pattern.crack_length; }},
    {"main_length", "m", "length of the main crack along chords", [](F f) { return f.pattern.main_length; }},
    {"main_angle", "deg", "acute angle between the x axis and the least-squares line through the main crack",
     [](F f) { return f.cracks.main_angle(); }},
    {"work_per_advance", "J/m2",
     "work of all interfaces over length of the main crack and thickness. In a run in which a single crack runs in "
     "one direction, without branches, this is what its advance costs, with the zigzag and the damage beside it; other "
     "cracks (such as two from a hole) and branches count in the work, not in the length",
     [](F f) { return over(f.energy.cohesive_work, f.pattern.main_length * f.thickness); }},
    {"steady_work_per_advance", "J/m2",
     "the same between a quarter and nine tenths of the growth of the main crack, without the work of its start and of "
     "the process zone that it takes along",
     steady_work_per_advance},
    {"measured_G_c", "J/m2", "G_c of the first law with toughness = \"as measured\", as given",
     [](F f) { return f.toughness.measured; }, as_measured},
    {"interface_G_c", "J/m2", "G_c that its interfaces have: the same over the surplus of the mesh",
     [](F f) { return f.toughness.of_interfaces; }, as_measured},
    {"measured_sigma_c", "Pa", "sigma_c of the first law with strength = \"as measured\", as given",
     [](F f) { return f.sigma_c.measured; }, with_measured_strength},
    {"interface_sigma_c", "Pa", "sigma_c that its interfaces have: the same over the surplus of a specimen",
     [](F f) { return f.sigma_c.of_interfaces; }, with_measured_strength},
    {"unresolved_part", "",
     "part of the length of all cracks on edges longer than 1.5 process zones (of a crack at rest, of the law with the "
     "longest): there path and branches follow the mesh",
     [](F f) { return f.unresolved.part; }},
    {"unresolved_x", "m",
     "place of the first of these edges that cracked, such as where a crack left its small triangles",
     [](F f) { return f.unresolved.place.x(); }},
    {"unresolved_y", "m", "likewise", [](F f) { return f.unresolved.place.y(); }},
    {"first_growth_time", "s",
     "first broken edge of a crack that counts; before the start of a run that starts from another one it is negative",
     [](F f) { return f.cracks.first_growth_time().value_or(not_a_number); }},
    {"max_tip_speed", "m/s", "largest speed of a crack tip, fitted over half a window of growth or more",
     [](F f) { return f.cracks.max_tip_speed(); }},
    {"mean_tip_speed", "m/s", "mean speed of the main tip over the second half of its growth",
     [](F f) { return f.cracks.mean_tip_speed(); }},
    {"max_tip_speed_over_cR", "", "max_tip_speed over the Rayleigh speed",
     [](F f) { return over(f.cracks.max_tip_speed(), f.rayleigh_speed); }},
    {"tips", "", "number of crack tips at the end that have not reached a boundary or another crack",
     [](F f) { return static_cast<double>(f.pattern.tips.size()); }},
    {"branches", "", "number of branchings at the end", [](F f) { return static_cast<double>(f.pattern.n_branches); }},
    {"first_branch_time", "s", "time of the first branching", [](F f) { return branching(f).time; }},
    {"first_branch_x", "m", "its place", [](F f) { return branching(f).position.x(); }},
    {"first_branch_y", "m", "likewise", [](F f) { return branching(f).position.y(); }},
    {"fragments", "", "number of fragments at the end",
     [](F f) { return static_cast<double>(f.fragments.rows.size()); }},
    {"largest_fragment", "", "mass of the largest fragment over that of the body, at the end",
     [](F f) { return f.fragments.column("mass_part").front(); }},
    {"median_fragment", "m", "diameter that half of the mass does not exceed (circle of the same area), at the end",
     [](F f) { return diameter_passing(f.fragments, 0.5); }},
    {"tensile_breaks", "", "interfaces that broke more by opening than by sliding; with output.breaks",
     [](F f) { return f.n_tensile; }, with_breaks},
    {"shear_breaks", "", "interfaces that broke more by sliding; with output.breaks", [](F f) { return f.n_shear; },
     with_breaks},
    {"first_break_x", "m", "place of the first interface that broke; likewise", [](F f) { return f.first_break.x(); },
     with_breaks},
    {"first_break_y", "m", "likewise", [](F f) { return f.first_break.y(); }, with_breaks},
    {"rest_time", "s", "time since which the body is at rest; with until = \"rest\"",
     [](F f) { return f.recorder.at_rest() ? f.recorder.rest()->since() : not_a_number; }, may_rest},
    {"peak_stress", "Pa", "largest stress of the specimen, mean over specimen.window",
     [](F f) { return f.strength.peak_stress; }, of_specimen},
    {"strength", "Pa",
     "peak_stress of a specimen that failed: the stress then fell by 5 % while interfaces broke. None: it still rose, "
     "or "
     "nothing broke, and the specimen is stronger",
     [](F f) { return f.strength.strength; }, of_specimen},
    {"law_strength", "Pa",
     "stress at which interfaces in all directions would break, by the first law within a material: sigma_c; in a test "
     "of compression, without confinement, 2 (gamma + mu) sigma_c/(sqrt(1 + mu^2) - mu)",
     [](F f) { return f.recorder.options().law_strength.of_interfaces; }, with_law_strength},
    {"strength_ratio", "", "strength over law_strength: what the specimen, its size and the mesh add",
     [](F f) { return f.strength.strength / f.recorder.options().law_strength.of_interfaces; }, with_law_strength},
    {"measured_strength", "Pa",
     "strength by the law with measured_sigma_c, which `strength` should meet; with strength = \"as measured\"",
     [](F f) { return f.recorder.options().law_strength.measured; }, with_measured_specimen},
    {"peak_strain", "", "axial strain at that stress", [](F f) { return f.strength.peak_strain; }, of_specimen},
    {"tangent_modulus", "Pa",
     "slope of stress over axial strain of a specimen, in the plane; only for loading that is slow against the wave "
     "transit, and where nothing was excavated",
     [](F f) { return f.strength.tangent_modulus; }, of_specimen},
    {"youngs_modulus", "Pa",
     "of the material of a specimen; in plane strain the tangent modulus times 1 - nu^2, which needs a "
     "lateral gauge",
     [](F f) { return f.material.E; }, with_gauge},
    {"poisson_ratio", "", "of the material of a specimen with a lateral gauge", [](F f) { return f.material.nu; },
     with_gauge},
    {"crack_initiation_stress", "Pa",
     "stress at which a specimen has 1 % of the breaks that it has at the peak (Potyondy and Cundall 2004)",
     [](F f) { return f.strength.crack_initiation; }, of_specimen},
    {"dilatancy_stress", "Pa",
     "stress at which the crack volumetric strain departs from zero (Martin and Chandler 1994); compression "
     "with a lateral gauge",
     [](F f) { return f.strength.dilatancy; }, in_compression},
    {"crack_damage_stress", "Pa",
     "stress at which the volumetric strain turns from contraction to dilation (Martin and Chandler 1994); likewise",
     [](F f) { return f.strength.crack_damage; }, in_compression},
    {"largest_penetration", "m", "largest overlap of two sides in contact over the run",
     [](F f) { return f.ledger.worst().penetration; }},
    {"largest_speed", "m/s", "largest speed of any element node over the run",
     [](F f) { return f.ledger.worst().largest_speed; }},
    {"largest_rotation", "deg",
     "largest rotation of a triangle over the run, at most 180: whole turns do not count (rotation of "
     "fragments.csv has them)",
     [](F f) { return f.deformation.rotation().value; }},
    {"largest_strain", "", "largest principal strain of a triangle over the run; with large rotations only",
     [](F f) { return f.deformation.large_rotation() ? f.deformation.strain().value : not_a_number; }},
    {"largest_area_change", "", "largest relative change of the area of a triangle over the run",
     [](F f) { return f.deformation.area_change().value; }},
    {"largest_slip", "",
     "largest slip of a point under pressure over the run, in lengths of its edge; slip along a straight "
     "support does not count",
     [](F f) { return f.deformation.slip().value; }},
    {"overlap_area", "m2",
     "largest area that the deformed body covers twice; searched each time the fastest vertex has moved about a tenth "
     "of an edge, and at the end",
     [](F f) { return f.overlap.value; }},
    {"overlap_x", "m", "place of its largest part in the deformed body", [](F f) { return overlap_place(f).x(); }},
    {"overlap_y", "m", "likewise", [](F f) { return overlap_place(f).y(); }},
};

/// Rows of every load and obstacle that drives, after its name.
constexpr Measure<Driver> driver_rows[]{
    {"*_force_x", "N",
     "force on the body, at the end, of each load that prescribes a motion and of each obstacle, by name",
     [](const Driver& d) { return d.at_end.force.x(); }},
    {"*_force_y", "N", "likewise", [](const Driver& d) { return d.at_end.force.y(); }},
    {"*_largest_force", "N", "its largest magnitude over all steps", [](const Driver& d) { return d.largest_force; }},
};

}  // namespace

std::vector<Output> summary_outputs() {
    std::vector<Output> outputs;
    for (const SummaryRow& row : rows) outputs.push_back({row.name, row.unit, row.doc});
    for (const auto& row : driver_rows) outputs.push_back({row.name, row.unit, row.doc});
    outputs.insert(outputs.end(), fluid_numbers().begin(), fluid_numbers().end());
    outputs.insert(outputs.end(), collector_numbers().begin(), collector_numbers().end());
    return outputs;
}

Summary summarise(const Model& model, const State& end, const Recorder& recorder) {
    const Facts facts(model, end, recorder);
    Summary summary;
    for (const SummaryRow& row : rows)
        if (row.exists(facts)) summary.values.emplace_back(row.name, row.of(facts));
    const std::vector<std::string> names = recorder.reactions().names();
    for (std::size_t i = 0; i < facts.reactions.size(); ++i)
        for (const auto& row : driver_rows)
            summary.values.emplace_back(names[i] + std::string(row.name.substr(1)),
                                        row.of({i, facts.reactions[i], recorder.reactions().largest_forces()[i]}));
    const std::vector<std::string> fluids = recorder.fluids().names();
    const std::vector<FluidOfRun> of_fluids = recorder.fluids().at(end);
    for (std::size_t f = 0; f < fluids.size(); ++f)
        for (const auto& row : fluid_numbers())
            summary.values.emplace_back(fluids[f] + std::string(row.name.substr(1)), row.of(of_fluids[f]));
    for (std::size_t k = 0; k < recorder.options().collectors.size(); ++k) {
        const Passages passages = passages_of(recorder.histories().passages, k);
        for (const auto& row : collector_numbers())
            summary.values.emplace_back(recorder.options().collectors[k].name + std::string(row.name.substr(1)),
                                        row.of(passages));
    }
    if (facts.driver) summary.reaction_of = names[facts.driver->number];
    return summary;
}

std::vector<ExpectResult> judge_expectations(const std::vector<Expectation>& expectations, const Summary& summary,
                                             double rayleigh_speed) {
    std::vector<ExpectResult> results;
    for (const Expectation& expected : expectations) {
        const double unit = expected.unit == "cR" ? rayleigh_speed : 1, value = summary[expected.key];
        const std::string_view si = unit_of("summary", expected.key);
        using Text = std::function<std::string(double)>;
        /// `limit_with` writes the bound by a text of its numbers.
        const auto add = [&](double bound, const std::function<std::string(const Text&)>& limit_with, bool pass) {
            const DisplayUnit as_given{1, std::string(expected.unit.empty() ? si : expected.unit)},
                read = expected.unit.empty() ? display_unit(std::abs(bound == 0 ? value : bound), std::string(si))
                                             : as_given;
            const auto text_in = [](const DisplayUnit& in) -> Text {
                return [in](double number) { return value_text(number * in.factor, in.unit); };
            };
            results.push_back({expected.key, limit_with(text_in(as_given)), value,
                               value_text(value / unit * read.factor, read.unit), limit_with(text_in(read)), pass});
        };
        const auto bound = [&](const std::optional<double>& limit, const std::string& word, auto holds) {
            if (limit)
                add(
                    *limit, [&](const Text& text) { return word + " " + text(*limit); }, holds(value, *limit * unit));
        };
        bound(expected.below, "below", std::less());
        bound(expected.above, "above", std::greater());
        bound(expected.at_least, "at least", std::greater_equal());
        bound(expected.at_most, "at most", std::less_equal());
        if (!expected.value) continue;
        const double target = *expected.value * unit;
        const double allowed = expected.relative ? expected.within * std::abs(target) : expected.within * unit;
        const auto limit = [&](const Text& text) {
            return text(*expected.value) + " within " +
                   (expected.relative ? formatted("%.6g %%", 100 * expected.within) : text(expected.within));
        };
        add(*expected.value == 0 ? expected.within : *expected.value, limit, std::abs(value - target) <= allowed);
    }
    return results;
}

}  // namespace knap
