#include "app/check/mesh_surplus.hpp"

#include "app/check/findings.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "mesh/polygon.hpp"
#include "scenario/built_in.hpp"
#include "scenario/keys.hpp"
#include "scenario/specimen_strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {
namespace {

// Widths of the plates in the table, in edges: in tension, of the bar that expands, under compression.
constexpr double tension_edges = 10, spall_edges = 8, compression_edges = 12.5;

// Discs of less compressive strength, in sigma_c, are crushed before they split. The ratio up to which a size counts as
// that of the discs that were measured.
constexpr double splits_from = 6.5, same_disc = 2.1;

// A run is slow that lasts as many passages of a shear wave through the body: it bears its loads like one at rest.
constexpr double slow_passages = 100;

// [-] Over the Rayleigh speed: below `even_crack` one costs less with the norm, above it with the sum; the fast crack
// whose cost is told.
constexpr double even_crack = 0.6, fast_crack = 0.66;

/// A surplus, and whether it is that of rows of the table or between them; else it is that of the nearest one.
struct Found {
    Surplus surplus;  // deviation 0: of a closed form
    bool has_rows;
    std::string remark;

    std::string text() const {
        return surplus.deviation > 0 ? formatted("%.2f +- %.2f", surplus.mean, surplus.deviation)
                                     : formatted("%.2f", surplus.mean);
    }
};

/// "measured with 12.5 edges alone": where all rows that differ from this one in their edges alone have more of them
/// than the law, or fewer, and the number is that of the last one.
template <class Row, class Law>
std::string measured_edges(std::span<const Row> rows, const Row& row, const Law& law) {
    double least = row.law.edges, most = least;
    for (const Row& other : rows) {
        Law same = other.law;
        same.edges = row.law.edges;
        if (!distance(same, row.law) || !differences(same, row.law, 1).empty()) continue;
        least = std::min(least, other.law.edges), most = std::max(most, other.law.edges);
    }
    if (law.edges >= least / same_size && law.edges <= most * same_size) return {};
    return least == most ? formatted("measured with %.3g edges alone", least)
                         : formatted("measured with %.3g to %.3g edges", least, most);
}

template <class Table, class Law>
std::optional<Found> look_up(const Table& table, const Law& law) {
    const auto* row = table.nearest(law);
    if (row == nullptr) return {};
    const std::optional<Surplus> surplus = table.find(law);
    Found found{surplus.value_or(Surplus{row->surplus, row->deviation}), surplus.has_value(), {}};
    Law near = row->law;
    if (surplus) found.remark = measured_edges(table.rows(), *row, law);
    if (!found.remark.empty()) near.edges = law.edges;
    const std::string other = joined(differences(near, law), " and ");
    if (!surplus) found.remark = "no row; that of " + (other.empty() ? "the nearest" : other);
    else if (!other.empty())
        found.remark +=
            formatted("%sbetween rows; %s: %.2f", found.remark.empty() ? "" : "; ", other.c_str(), row->surplus);
    return found;
}

double compressive_strength(CohesiveLaw law, Coupling coupling) {
    law.coupling = coupling;
    return law.compressive_strength().stress / law.sigma_c;
}

bool crushes_discs(const CohesiveLaw& law, Coupling coupling) {
    return compressive_strength(law, coupling) < splits_from;
}

const std::string& table_of_program(const char* name) {
    return std::ranges::find(built_in_files(), name, &BuiltIn::name)->text;
}

const StrengthTable& strength_of_program() {
    static const StrengthTable table(table_of_program("mesh_strength.csv"));
    return table;
}

/// What a disc bears over its load with cracks along a given path, by its compressive strength in sigma_c: the friction
/// and either coupling of the rows count by that alone. Beyond them that of the next one. Of the rows those of the
/// nearest size.
Found disc_of(const TestedLaw& law, double strength) {
    double zones = 0;  // farther than any
    for (const StrengthRow& disc : strength_of_program().rows())
        if (disc.law.test == "disc" && apart(disc.law.zones, law.zones) <= apart(zones, law.zones))
            zones = disc.law.zones;
    std::vector<SurplusPoint> discs;
    TestedLaw row = law;
    const auto has_norm = [](const TestedLaw& of) { return of.softening.ends_with(" norm"); };
    for (const bool own : {false, true})  // of two with one strength the last counts
        for (const StrengthRow& disc : strength_of_program().rows()) {
            if (disc.law.test != "disc" || disc.law.zones != zones) continue;
            if ((has_norm(disc.law) == has_norm(law)) != own) continue;
            const CohesiveLaw of_disc{.sigma_c = 1, .gamma = disc.law.gamma, .friction = disc.law.friction};
            const Coupling coupling = has_norm(disc.law) ? Coupling::norm : Coupling::sum;
            discs.push_back({{compressive_strength(of_disc, coupling)}, {disc.surplus, disc.deviation}});
            if (own) row = disc.law, row.gamma = law.gamma, row.friction = law.friction;
        }
    const auto [least, most] = std::ranges::minmax(discs, {}, [](const SurplusPoint& point) { return point.at[0]; });
    const double within = std::clamp(strength, least.at[0], most.at[0]);
    std::vector<std::string> other = differences(row, law, same_disc);
    if (within != strength) other.push_back(formatted("a compressive strength of %.3g sigma_c", within));
    return {*interpolated(discs, {within}, {0}), other.empty(),
            other.empty() ? "" : "no row; that of " + joined(other, " and ")};
}

/// Below the table's gammas a plate in tension bears little more than what damages its worst facets.
void limit_tension(std::optional<Found>& tension, const CohesiveLaw& law, Coupling coupling) {
    const double weakest = weakest_facet(law, coupling);
    if (!tension || tension->has_rows || weakest >= std::min(1., tension->surplus.mean)) return;
    tension = Found{{weakest, 0}, false, "no row; a facet in the worst direction is damaged"};
}

/// The cost of a fast crack, else that of a law that was measured at several speeds.
std::optional<Found> fast_of(const ToughnessTable& table, const MeshedLaw& law, Coupling coupling) {
    if (const std::optional<Surplus> found = table.at_speed(law, fast_crack)) return Found{*found, true, {}};
    const MeshedLaw other = MeshedLaw{"linear", "constant", 1, 1, 6}.with(coupling);
    const std::optional<Surplus> found = table.at_speed(other, fast_crack);
    if (!found) return {};
    return Found{*found, false, "no row; that of " + joined(differences(other, law), " and ")};
}

/// The surplus of a law with one coupling.
struct WithCoupling {
    std::optional<Found> slowest, fast, panel, beam, sheared, tension, spall, compression, disc;
};
using Column = std::optional<Found> WithCoupling::*;

bool has_test(const Scenario& scenario, SpecimenOptions::Test test) {
    return scenario.specimen && scenario.specimen->test == test;
}

struct Line {
    Column of;
    const char* words;
    bool of_crack = false;  // else of a body's load
};
constexpr Line lines[] = {{&WithCoupling::slowest, "the slowest crack that runs costs, over G_c", true},
                          {&WithCoupling::fast, "a crack at 0.66 c_R costs, over G_c", true},
                          {&WithCoupling::panel, "a notched panel bears"},
                          {&WithCoupling::beam, "a notched beam bears"},
                          {&WithCoupling::sheared, "a notched square in shear bears"},
                          {&WithCoupling::tension, "a plate in tension bears"},
                          {&WithCoupling::spall, "a bar that expands fast bears"},
                          {&WithCoupling::compression, "a plate under compression bears"},
                          {&WithCoupling::disc, "a Brazilian disc bears"}};

/// `key`: [interface.NAME] of the law; `ligament` [m] of a notched body.
WithCoupling with_coupling(const Scenario& scenario, const Node& key, const LawWithin& within, double ligament,
                           Coupling coupling) {
    static const ToughnessTable toughness(table_of_program("mesh_toughness.csv"));
    const MeshedLaw coupled = within.meshed.with(coupling);
    const CohesiveLaw& law = scenario.laws[within.law].law;
    const auto tested = [&](const char* test, double size) {
        TestedLaw made = tested_law(scenario, within, test, size);
        made.softening = coupled.softening;
        return made;
    };
    const auto specimen = [&](const char* test, double size) {
        return look_up(strength_of_program(), tested(test, size));
    };
    const bool compressed = has_test(scenario, SpecimenOptions::Test::compression);
    WithCoupling found{.slowest = look_up(toughness, coupled),
                       .fast = fast_of(toughness, coupled, coupling),
                       .panel = specimen("panel", ligament),
                       .beam = specimen("beam", ligament),
                       .sheared = specimen("sheared", ligament),
                       .tension = specimen("tension", tension_edges * within.edge),
                       .spall = specimen("spall", spall_edges * within.edge),
                       .compression = {},
                       .disc = {}};
    limit_tension(found.tension, law, coupling);
    if (compressed && scenario.strength.size > 0) found.compression = specimen("compression", scenario.strength.size);
    else if (law.friction > 0) found.compression = specimen("compression", compression_edges * within.edge);
    if (has_test(scenario, SpecimenOptions::Test::brazilian))
        found.disc = disc_of(tested("disc", scenario.strength.size), compressive_strength(law, coupling));
    const std::string no_toughness = given_keys(key, without_toughness),
                      no_strength = given_keys(key, without_strength);
    for (const Line& line : lines)
        if (const std::string& keys = line.of_crack ? no_toughness : no_strength; !keys.empty())
            if (auto& number = found.*line.of)
                number->has_rows = false, number->remark = "no row; that without " + keys;
    return found;
}

std::string text_of(const Line& line, const WithCoupling& of_sum, const WithCoupling& of_norm) {
    const auto &sum = of_sum.*line.of, &norm = of_norm.*line.of;
    if (!sum && !norm) return {};
    std::string text =
        formatted("    %-44s %-13s %s", line.words, sum ? sum->text().c_str() : "-", norm ? norm->text().c_str() : "-");
    const std::string a = sum ? sum->remark : "", b = norm ? norm->remark : "";
    if (a == b) return text + (a.empty() ? "" : "  (" + a + ")") + "\n";
    std::vector<std::string> remarks;
    if (!a.empty()) remarks.push_back("sum: " + a);
    if (!b.empty()) remarks.push_back("norm: " + b);
    return text + "  (" + joined(remarks, "; ") + ")\n";
}

bool has_rows(const WithCoupling& of) {
    return std::ranges::all_of(lines, [&](const Line& line) { return !(of.*line.of) || (of.*line.of)->has_rows; });
}

/// What tells the coupling that fits a run, or its cracks of one speed.
struct Fits {
    std::string what, bodies;
    std::vector<Column> columns;
    bool costs = false;  // of two costs the less fits, of two loads that nearer to the one along a given path
};

/// How long it runs does not tell how fast a crack will be, so that both speeds are told.
std::vector<Fits> what_fits(const Scenario& scenario, const Mesh& mesh, const StepPlan& plan) {
    const double passages = plan.limits.end / plan.limits.passage;
    const std::string lasts = formatted("run (%.3g passages of a wave)", passages);
    if (has_test(scenario, SpecimenOptions::Test::compression))
        return {{"this run under compression", "plates bear", {&WithCoupling::compression}}};
    if (has_test(scenario, SpecimenOptions::Test::brazilian))
        return {{"this run of a disc", "discs bear", {&WithCoupling::disc}}};
    if (passages >= slow_passages)
        return {{"this slow " + lasts,
                 "notched structures bear",
                 {&WithCoupling::panel, &WithCoupling::beam, &WithCoupling::sheared}}};
    if (std::ranges::any_of(mesh.interior_edges, &InteriorEdge::cracked)) {
        const std::string speed = formatted("than %.3g c_R (max_tip_speed_over_cR)", even_crack);
        return {{"a crack slower " + speed, "the slowest that run cost", {&WithCoupling::slowest}, true},
                {"a faster one", formatted("those at %.3g c_R cost", fast_crack), {&WithCoupling::fast}, true}};
    }
    return {{"this fast " + lasts + " without a crack", "bars that expand bear", {&WithCoupling::spall}}};
}

/// The range of the numbers of one coupling; none where one is missing.
struct Range {
    double least, most;

    std::string text() const {
        const std::string a = formatted("%.2f", least), b = formatted("%.2f", most);
        return a == b ? a : a + " to " + b;
    }
    double misses() const { return std::max(std::abs(least - 1), std::abs(most - 1)); }
};

/// The coupling that fits, and why.
std::string advice(const std::array<WithCoupling, 2>& couplings, const Fits& fits, const CohesiveLaw& law) {
    std::array<Range, 2> range;
    bool all_have_rows = true;
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<double> numbers;
        for (const Column column : fits.columns)
            if (const auto& found = couplings[k].*column) {
                numbers.push_back(found->surplus.mean);
                all_have_rows = all_have_rows && found->has_rows;
            }
        if (numbers.empty()) return {};
        const auto [least, most] = std::ranges::minmax(numbers);
        range[k] = {least, most};
    }
    const auto& [sum, norm] = range;
    const double weakest = weakest_facet(law, Coupling::norm);
    const bool crushed = fits.columns.front() == &WithCoupling::disc && crushes_discs(law, Coupling::norm),
               fewer = fits.costs ? norm.most < sum.most : norm.misses() < sum.misses(),
               norm_fits = fewer && weakest == 1 && !crushed;
    const Coupling best = norm_fits ? Coupling::norm : Coupling::sum;
    std::string text = formatted("coupling = \"%s\"%s fits %s: %s %s with the sum, %s with the norm",
                                 norm_fits ? "norm" : "sum", law.coupling == best ? ", which it has," : "",
                                 fits.what.c_str(), fits.bodies.c_str(), sum.text().c_str(), norm.text().c_str());
    if (fewer && weakest < 1) text += formatted(", but there a facet in the worst direction bears %.2f", weakest);
    if (fewer && crushed) text += ", but there discs are crushed";
    if (norm_fits && law.friction > 0) text += ", but the shear strength falls from gamma + friction to gamma";
    return text + (all_have_rows ? "" : "; not all of that was measured (no row)");
}

}  // namespace

std::string mesh_surplus_text(const ReadResult& read, const Mesh& mesh, const StepPlan& plan) {
    const Scenario& scenario = read.scenario;
    const std::vector<Fits> all_fits = what_fits(scenario, mesh, plan);
    const double ligament = bounding_box(mesh.vertices).extent().minCoeff() / 2;
    std::string text;
    bool all_have_rows = true;
    for (const LawWithin& within : laws_within(scenario, read.values)) {
        const NamedLaw& named = scenario.laws[within.law];
        if (named.measured_G_c > 0) continue;
        const Node& key = *read.values.find("interface." + named.name);
        const std::array couplings{with_coupling(scenario, key, within, ligament, Coupling::sum),
                                   with_coupling(scenario, key, within, ligament, Coupling::norm)};
        text += formatted("  %-46s sum           norm\n", ("law " + named.name + " on this mesh, coupling =").c_str());
        for (const Line& line : lines) text += text_of(line, couplings[0], couplings[1]);
        all_have_rows = all_have_rows && std::ranges::all_of(couplings, has_rows);
        for (const Fits& fits : all_fits)
            if (const std::string line = advice(couplings, fits, named.law); !line.empty())
                text += "    " + line + "\n";
    }
    if (text.empty()) return {};
    text += formatted(
        "    (what bodies bear: over their load with cracks along a given path, the bar over sigma_c; notched ones "
        "with a ligament of %s, half of the body)\n",
        readable(ligament, "m", 3).c_str());
    if (!all_have_rows)
        text +=
            "    without a row it was not measured: the number is that of another law and may err by all that it "
            "differs from 1. `knap calibrate` measures the cost\n    of cracks and the strength of rock specimens; of "
            "a structure a run with cracks along a given path tells it\n";
    return text;
}

std::vector<Diagnostic> findings_of_crushed_discs(const ReadResult& read) {
    const Scenario& scenario = read.scenario;
    std::vector<Diagnostic> found;
    if (!has_test(scenario, SpecimenOptions::Test::brazilian)) return found;
    for (const LawWithin& within : laws_within(scenario, read.values)) {
        const NamedLaw& named = scenario.laws[within.law];
        if (!crushes_discs(named.law, named.law.coupling)) continue;
        const double bears = compressive_strength(named.law, named.law.coupling);
        const bool sum_splits = !crushes_discs(named.law, Coupling::sum),
                   has_table = named.law.over_pressure != nullptr;
        // 2 gamma/(sqrt(1 + mu^2) - mu) of the norm, with the sum gamma + mu in place of gamma
        const double mu = named.law.friction, shear = splits_from * (std::hypot(1, mu) - mu) / 2,
                     gamma = named.law.coupling == Coupling::norm ? shear : shear - mu;
        found.push_back(read.at(
            "interface." + named.name + ".gamma",
            {.severity = Diagnostic::Severity::warning,
             .code = "crushed-disc",
             .message =
                 formatted("`interface.%s.gamma` gives a compressive strength of %.2g sigma_c: a Brazilian disc is "
                           "crushed below its platens before it splits. Discs with this strength bear %s of their "
                           "splitting load, whatever the coupling",
                           named.name.c_str(), bears,
                           disc_of(tested_law(scenario, within, "disc", scenario.strength.size), bears).text().c_str()),
             .note = (has_table ? std::string("a larger gamma or more friction over pressure")
                                : formatted("gamma = %.2g, which gives %.2g sigma_c", gamma, splits_from)) +
                     (named.law.coupling == Coupling::norm && sum_splits ? ", or coupling = \"sum\"" : "")}));
    }
    return found;
}

}  // namespace knap
