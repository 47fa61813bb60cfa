#include "app/check/mesh_surplus.hpp"

#include "base/formatted.hpp"
#include "base/text.hpp"
#include "scenario/built_in.hpp"
#include "scenario/specimen_strength.hpp"

#include <algorithm>
#include <array>

namespace knap {
namespace {

// The notched structure of the table is about as large as its process zone, its plate in tension ten edges wide.
constexpr double notched_zones = 0.886, tension_edges = 10;

/// The surplus of a law with one coupling.
struct WithCoupling {
    std::string word;
    std::optional<Surplus> running, notched, tension;
};

const std::string& table_of_program(const char* name) {
    return std::ranges::find(built_in_files(), name, &BuiltIn::name)->text;
}

WithCoupling with_coupling(const MeshedLaw& law, Coupling coupling) {
    static const ToughnessTable toughness(table_of_program("mesh_toughness.csv"));
    static const StrengthTable strength(table_of_program("mesh_strength.csv"));
    const MeshedLaw coupled = law.with(coupling);
    const auto specimen = [&](const char* test, double zones) {
        return strength.find({.test = test,
                              .softening = coupled.softening,
                              .unloading = coupled.unloading,
                              .order = coupled.order,
                              .gamma = coupled.gamma,
                              .zones = zones,
                              .edges = zones * coupled.edges});
    };
    return {.word = coupling == Coupling::norm ? "norm" : "sum",
            .running = toughness.find(coupled),
            .notched = specimen("notched", notched_zones),
            .tension = specimen("tension", tension_edges / coupled.edges)};
}

std::string text_of(const WithCoupling& of) {
    std::vector<std::string> parts;
    const auto add = [&](const std::optional<Surplus>& surplus, const char* words) {
        if (surplus) parts.push_back(formatted(words, surplus->mean, surplus->deviation));
    };
    add(of.running, "the slowest crack that runs costs %.2f +- %.2f G_c");
    add(of.notched, "a slow notched structure bears %.2f +- %.2f");
    add(of.tension, "a plate in tension %.2f +- %.2f of the load along a given path");
    return parts.empty() ? "" : "coupling = \"" + of.word + "\": " + joined(parts);
}

/// The coupling that fits the run where the law has the other one. Slow structures: that which adds less to their load.
/// Explicit steps may have either: the least load that drives a crack tells nothing of those above 0.6 c_R.
std::string advice(const std::array<WithCoupling, 2>& couplings, const CohesiveLaw& law, bool slow) {
    const auto& [sum, norm] = couplings;
    const bool is_norm = law.coupling == Coupling::norm;
    if (!slow)
        return is_norm ? "cracks above 0.6 c_R cost less with coupling = \"sum\"; for a slow load in explicit steps "
                         "\"norm\" fits"
                       : "";
    if (!sum.notched || !norm.notched) return {};
    const bool norm_fits = std::abs(norm.notched->mean - 1) < std::abs(sum.notched->mean - 1);
    if (norm_fits == is_norm) return {};
    return "this run is slow (large implicit steps): coupling = \"" + (norm_fits ? norm : sum).word + "\" fits it" +
           (norm_fits && law.friction > 0 ? ", but the shear strength falls from gamma + friction to gamma" : "");
}

}  // namespace

std::string mesh_surplus_text(const ReadResult& read) {
    const Scenario& scenario = read.scenario;
    const bool slow = scenario.time.scheme.bulk != BulkScheme::explicit_lumped;
    std::string text;
    for (const LawWithin& within : laws_within(scenario, read.values)) {
        const NamedLaw& named = scenario.laws[within.law];
        if (named.measured_G_c > 0) continue;
        const std::array couplings{with_coupling(within.meshed, Coupling::sum),
                                   with_coupling(within.meshed, Coupling::norm)};
        for (const WithCoupling& of : couplings)
            if (const std::string line = text_of(of); !line.empty())
                text += "  law " + named.name + " on this mesh, " + line + "\n";
        if (const std::string line = advice(couplings, named.law, slow); !line.empty()) text += "    " + line + "\n";
    }
    return text;
}

}  // namespace knap
