#include "app/check/mesh_surplus.hpp"

#include "app/check/findings.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "scenario/built_in.hpp"
#include "scenario/keys.hpp"
#include "scenario/specimen_strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {
namespace {

// The notched structure of the table is about as large as its process zone; its plates are ten edges wide in tension,
// 12.5 under compression.
constexpr double notched_zones = 0.886, tension_edges = 10, compression_edges = 12.5;

// Discs of less compressive strength, in sigma_c, are crushed before they split. The ratio up to which a size counts as
// that of the discs that were measured.
constexpr double splits_from = 6.5, same_disc = 2.1;

// A run is slow where its steps are larger than the stable one by this factor, and last as many passages of a wave
// through the body.
constexpr double slow_steps = 10, slow_passages = 100;

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
/// and either coupling of the rows count by that alone. Beyond them that of the next one.
Found disc_of(const TestedLaw& law, double strength) {
    std::vector<SurplusPoint> discs;
    TestedLaw row = law;
    const auto has_norm = [](const TestedLaw& of) { return of.softening.ends_with(" norm"); };
    for (const bool own : {false, true})  // of two with one strength the last counts
        for (const StrengthRow& disc : strength_of_program().rows()) {
            if (disc.law.test != "disc" || (has_norm(disc.law) == has_norm(law)) != own) continue;
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

/// The measured number alone, for any law with this compressive strength.
std::string disc_text(double strength) { return disc_of({.test = "disc", .softening = "linear"}, strength).text(); }

/// Below the table's gammas a plate in tension bears little more than what damages its worst facets.
void limit_tension(std::optional<Found>& tension, const CohesiveLaw& law, Coupling coupling) {
    const double weakest = weakest_facet(law, coupling);
    if (!tension || tension->has_rows || weakest >= std::min(1., tension->surplus.mean)) return;
    tension = Found{{weakest, 0}, false, "no row; a facet in the worst direction is damaged"};
}

/// The surplus of a law with one coupling.
struct WithCoupling {
    std::optional<Found> running, notched, tension, compression, disc;
};

bool has_test(const Scenario& scenario, SpecimenOptions::Test test) {
    return scenario.specimen && scenario.specimen->test == test;
}

struct Line {
    std::optional<Found> WithCoupling::*of;
    const char* words;
};
constexpr Line lines[] = {{&WithCoupling::running, "the slowest crack that runs costs, over G_c"},
                          {&WithCoupling::notched, "a slow notched structure bears"},
                          {&WithCoupling::tension, "a plate in tension bears"},
                          {&WithCoupling::compression, "a plate under compression bears"},
                          {&WithCoupling::disc, "a Brazilian disc bears"}};

/// `key`: [interface.NAME] of the law.
WithCoupling with_coupling(const Scenario& scenario, const Node& key, const LawWithin& within, Coupling coupling) {
    static const ToughnessTable toughness(table_of_program("mesh_toughness.csv"));
    const MeshedLaw coupled = within.meshed.with(coupling);
    const CohesiveLaw& law = scenario.laws[within.law].law;
    const double zone = law.process_zone(scenario.materials[within.material].elastic.plane_modulus(scenario.plane));
    const auto tested = [&](const char* test, double size) {
        TestedLaw made = tested_law(scenario, within, test, size);
        made.softening = coupled.softening;
        return made;
    };
    const auto specimen = [&](const char* test, double size) {
        return look_up(strength_of_program(), tested(test, size));
    };
    const bool compressed = has_test(scenario, SpecimenOptions::Test::compression);
    WithCoupling found{.running = look_up(toughness, coupled),
                       .notched = specimen("notched", notched_zones * zone),
                       .tension = specimen("tension", tension_edges * within.edge),
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
        if (const std::string& keys = line.of == &WithCoupling::running ? no_toughness : no_strength; !keys.empty())
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

/// What tells the coupling of a run: its own test, else the notched structure.
std::optional<Found> WithCoupling::*column_of(const Scenario& scenario) {
    if (has_test(scenario, SpecimenOptions::Test::compression)) return &WithCoupling::compression;
    if (has_test(scenario, SpecimenOptions::Test::brazilian)) return &WithCoupling::disc;
    return &WithCoupling::notched;
}

/// Explicit steps may have either coupling: what slow bodies bear tells nothing of cracks above 0.6 c_R.
bool is_slow(const StepPlan& plan) {
    return plan.limits.largest >= slow_steps * plan.stable_step &&
           plan.limits.end >= slow_passages * plan.limits.passage;
}

/// The coupling that fits a slow run where the law has the other one: that whose bodies bear what they bear along a
/// given path.
std::string advice(const std::array<WithCoupling, 2>& couplings, const Scenario& scenario, const CohesiveLaw& law) {
    const auto column = column_of(scenario);
    const auto &sum = couplings[0].*column, &norm = couplings[1].*column;
    if (!sum || !norm) return {};
    const auto misses = [](const Found& found) { return std::abs(found.surplus.mean - 1); };
    const bool norm_fits = misses(*norm) < misses(*sum);
    if (norm_fits == (law.coupling == Coupling::norm)) return {};
    if (norm_fits && column == &WithCoupling::disc && crushes_discs(law, Coupling::norm)) return {};
    if (norm_fits && weakest_facet(law, Coupling::norm) < 1) return {};  // too weak where facets lie badly
    return std::string("this run is slow (large implicit steps): coupling = \"") + (norm_fits ? "norm" : "sum") +
           "\" fits it" +
           (norm_fits && law.friction > 0 ? ", but the shear strength falls from gamma + friction to gamma" : "");
}

}  // namespace

std::string mesh_surplus_text(const ReadResult& read, const StepPlan& plan) {
    const Scenario& scenario = read.scenario;
    const bool slow = is_slow(plan);
    std::string text;
    bool all_have_rows = true;
    for (const LawWithin& within : laws_within(scenario, read.values)) {
        const NamedLaw& named = scenario.laws[within.law];
        if (named.measured_G_c > 0) continue;
        const Node& key = *read.values.find("interface." + named.name);
        const std::array couplings{with_coupling(scenario, key, within, Coupling::sum),
                                   with_coupling(scenario, key, within, Coupling::norm)};
        text += formatted("  %-46s sum           norm\n", ("law " + named.name + " on this mesh, coupling =").c_str());
        for (const Line& line : lines) text += text_of(line, couplings[0], couplings[1]);
        all_have_rows = all_have_rows && std::ranges::all_of(couplings, has_rows);
        if (const std::string line = slow ? advice(couplings, scenario, named.law) : ""; !line.empty())
            text += "    " + line + "\n";
    }
    if (!text.empty()) text += "    (what bodies bear: over their load with cracks along a given path)\n";
    if (!text.empty() && !slow)  // BENCHMARKS.md, Fast cracks
        text +=
            "    cracks above 0.6 c_R cost less with the sum, slower ones and structures under slow loads with the "
            "norm\n";
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
                           named.name.c_str(), bears, disc_text(bears).c_str()),
             .note = (has_table ? std::string("a larger gamma or more friction over pressure")
                                : formatted("gamma = %.2g, which gives %.2g sigma_c", gamma, splits_from)) +
                     (named.law.coupling == Coupling::norm && sum_splits ? ", or coupling = \"sum\"" : "")}));
    }
    return found;
}

}  // namespace knap
