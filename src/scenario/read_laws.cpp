// [material.NAME], [interface.NAME] and [[support]]: which law acts between which materials and under which
// support.
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace knap {
namespace {

CohesiveLaw read_law(const Table& table) {
    CohesiveLaw law;
    table.fill(law);
    if (!table.flag("breakable").value_or(true)) {
        law.sigma_c = CohesiveLaw::unbreakable().sigma_c;
        return law;
    }
    const bool given = table.given("sigma_c");
    if (!given)
        table.report("missing-key", "", "`" + table.path("sigma_c") + "` is missing").note =
            "0 for contact and friction only; breakable = false for what never breaks";
    law.sigma_c = table.number("sigma_c").value_or(0);
    const bool has_cohesion = !table.has("sigma_c") || law.sigma_c > 0;
    const std::optional<std::string> which = table.the_one({"G_c", "delta_c"}, has_cohesion && given);
    if (which && !has_cohesion)
        table.reading().findings.error_at_name("exclusive-keys",
                                               "`" + table.path() + "` has no strength, so it has no " + *which,
                                               table.reading().at(table.path(*which)));
    law.G_c =
        which == "delta_c" ? 0.5 * law.sigma_c * table.number("delta_c").value_or(0) : table.number("G_c").value_or(0);
    return law;
}

Scatter read_scatter(const Table& law) {
    const Table table = law.table("scatter");
    Scatter scatter;
    if (!table.has("kind")) return scatter;
    constexpr std::array kinds{std::pair{"weibull", Scatter::Kind::weibull}, std::pair{"normal", Scatter::Kind::normal},
                               std::pair{"lognormal", Scatter::Kind::lognormal},
                               std::pair{"uniform", Scatter::Kind::uniform}};
    for (const auto& [word, kind] : kinds)
        if (table.text("kind") == word) scatter.kind = kind;
    table.fill(scatter);
    table.the_one({"length", "area", "correlation"}, false);
    scatter.of_strength = false;
    for (const Node* of : table.items("of")) (of->text == "G_c" ? scatter.of_energy : scatter.of_strength) = true;
    if (!law.flag("breakable").value_or(true))
        table.error_at_name("exclusive-keys", "", "belongs to a law that never breaks");
    else if (law.number("sigma_c") == 0.)
        table.error_at_name("exclusive-keys", "", "belongs to a law without strength");
    return scatter;
}

/// The pair of materials that a law's name joins by "-".
std::optional<std::pair<Index, Index>> pair_of(const std::string& name, const std::vector<std::string>& materials) {
    const std::size_t dash = name.find('-');
    if (dash == std::string::npos) return std::nullopt;
    const Index a = index_in(materials, name.substr(0, dash)), b = index_in(materials, name.substr(dash + 1));
    const auto n = static_cast<Index>(materials.size());
    return a < n && b < n ? std::optional(std::pair(a, b)) : std::nullopt;
}

std::vector<std::string> names_for_laws(const std::vector<std::string>& materials, bool with_grains) {
    std::vector<std::string> names{"default"};
    if (with_grains) names.push_back("within");
    if (with_grains) names.insert(names.end(), materials.begin(), materials.end());
    for (std::size_t a = 0; a < materials.size(); ++a)
        for (std::size_t b = a; b < materials.size(); ++b) names.push_back(materials[a] + "-" + materials[b]);
    return names;
}

/// Pairs without a law of their own take the default (-1: there is none).
void fill_pairs(Reading& reading, Index standard, const std::vector<std::string>& materials) {
    if (!reading.values.has("interface")) return;  // reported as missing, or as without a name
    auto& of_pair = reading.scenario.law_of_pair;
    std::vector<std::string> without;
    for (std::size_t a = 0; a < of_pair.size(); ++a)
        for (std::size_t b = 0; b < of_pair.size(); ++b) {
            if (of_pair[a][b] >= 0) continue;
            if (standard < 0 && a <= b) without.push_back(materials[a] + "-" + materials[b]);
            of_pair[a][b] = standard;
        }
    if (!without.empty())
        reading.findings.error("missing-key", "no law for interfaces " + joined(without), reading.at("interface"))
            .note = "add [interface.default]; breakable = false in it if nothing shall break";
}

/// Reads all laws and puts each where its name says: the default, a pair of materials, a grain, or a free name that
/// supports and joints use.
void read_interfaces(Reading& reading, const std::vector<std::string>& materials) {
    Scenario& scenario = reading.scenario;
    std::set<std::string> free_names;
    for (const char* list : {"support", "joints"})
        for (const Table& table : reading.list(list)) free_names.insert(table.text("interface"));
    const auto n = static_cast<Index>(materials.size());
    scenario.law_of_pair.assign(n, std::vector<Index>(n, -1));
    scenario.law_within.assign(n, -1);
    Index standard = -1, within = -1;
    const bool with_grains = !reading.list("grains").empty();
    for (const std::string& name : reading.values.names("interface")) {
        const auto number = static_cast<Index>(scenario.laws.size());
        const Table table = reading.table("interface." + name);
        scenario.laws.push_back({name, read_law(table), read_scatter(table)});
        const Index material = index_in(materials, name);
        if (name == "default") {
            standard = number;
        } else if (with_grains && material < n) {
            scenario.law_within[material] = number;
        } else if (with_grains && name == "within") {
            within = number;
        } else if (const auto pair = pair_of(name, materials)) {
            const auto [a, b] = *pair;
            if (scenario.law_of_pair[a][b] >= 0)
                table.error_at_name("duplicate-name", "", "is the second law of this pair of materials");
            scenario.law_of_pair[a][b] = scenario.law_of_pair[b][a] = number;
        } else if (!free_names.contains(name)) {
            const std::string text = "belongs to no pair of materials and no support or set of joints";
            Diagnostic& d = reading.findings.error_at_name("unknown-name", "`" + table.path() + "` " + text,
                                                           reading.at(table.path()));
            d.hint = did_you_mean(name, names_for_laws(materials, with_grains));
            d.note = "known: " + joined(names_for_laws(materials, with_grains));
        }
    }
    fill_pairs(reading, standard, materials);
    for (Index i = 0; i < n; ++i)
        if (scenario.law_within[i] < 0) scenario.law_within[i] = within >= 0 ? within : scenario.law_of_pair[i][i];
}

/// The number of the law that `interface` names; nothing, and a finding, where there is none.
std::optional<Index> law_of(const Table& table) {
    if (!table.has("interface")) return std::nullopt;
    std::vector<std::string> names;
    for (const NamedLaw& named : table.reading().scenario.laws) names.push_back(named.name);
    const Index found = index_in(names, table.text("interface"));
    if (found < static_cast<Index>(names.size())) return found;
    if (table.reading().values.has("interface"))
        table.reading().unknown_name(table.path("interface"), "interface law", table.text("interface"), names);
    return std::nullopt;
}

}  // namespace

void read_materials(Reading& reading) {
    std::vector<NamedMaterial>& materials = reading.scenario.materials;
    for (const std::string& name : reading.values.names("material")) {
        const Table table = reading.table("material." + name);
        if (name.find('-') != std::string::npos)
            reading.findings
                .error_at_name("bad-name", "the name of material `" + name + "` has a `-`", reading.at(table.path()))
                .note = "- joins two materials in [interface.A-B]; use _";
        table.fill(materials.emplace_back(NamedMaterial{.name = name, .elastic = {}}).elastic);
    }
    if (reading.values.has("material") && materials.empty())
        reading.findings.error("missing-key", "there is no material", reading.at("material")).note =
            "write [material.NAME]";
}

void read_laws(Reading& reading) {
    Scenario& scenario = reading.scenario;
    read_interfaces(reading, scenario.material_names());
    std::size_t joint = 0;
    for (const Table& table : reading.list("joints")) {
        if (!table.has("interface")) continue;
        const Index law = law_of(table).value_or(0);
        if (joint < scenario.law_of_joint.size()) scenario.law_of_joint[joint++] = law;
    }
    for (std::size_t i = 0; i < scenario.supports.size(); ++i) {
        const Table table = reading.table(item("support", i));
        Support& support = scenario.supports[i];
        const std::optional<Index> law = law_of(table);
        if (!law) continue;
        support.law = *law;
        const NamedLaw& named = scenario.laws[*law];
        if (support.glued && reading.values.has("interface." + named.name + ".sigma_c") && named.law.sigma_c == 0)
            table.report("exclusive-keys", "glued",
                         "`" + table.path() + "` is glued by the law `" + named.name + "`, which has no strength");
    }
}

}  // namespace knap
