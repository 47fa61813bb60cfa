// [material.NAME], [interface.NAME] and [[foundation]]: which law acts between which materials and under which foundation.
#include <algorithm>
#include <set>

#include "scenario/assemble.hpp"

namespace knap {
namespace {

std::vector<std::string> material_names(const Scenario& scenario) {
    std::vector<std::string> names;
    for (const NamedMaterial& material : scenario.materials) names.push_back(material.name);
    return names;
}

CohesiveLaw law(const Assembly& assembly, const std::string& path) {
    const Values& values = assembly.values;
    CohesiveLaw law;
    law.gamma = values.number(path + ".gamma").value_or(law.gamma);
    law.friction = values.number(path + ".friction").value_or(0);
    law.restitution = values.number(path + ".restitution").value_or(0);
    if (!values.flag(path + ".breakable").value_or(true)) {
        law.sigma_c = CohesiveLaw::unbreakable().sigma_c;
        return law;
    }
    if (!values.given(path + ".sigma_c"))
        assembly.findings.error("missing-key", "`" + path + ".sigma_c` is missing", assembly.at(path)).note =
            "0 for contact and friction only; breakable = false for what never breaks";
    law.sigma_c = values.number(path + ".sigma_c").value_or(0);
    const bool has_cohesion = !values.has(path + ".sigma_c") || law.sigma_c > 0;
    const std::optional<std::string> which = assembly.the_one(path, {"G_c", "delta_c"}, has_cohesion && values.given(path + ".sigma_c"));
    if (which && !has_cohesion)
        assembly.findings.error_at_name("exclusive-keys", "`" + path + "` has no strength, so it has no " + *which, assembly.at(path + "." + *which));
    law.G_c = which == "delta_c" ? 0.5 * law.sigma_c * values.number(path + ".delta_c").value_or(0) : values.number(path + ".G_c").value_or(0);
    return law;
}

Scatter scatter(const Assembly& assembly, const std::string& law) {
    const Values& values = assembly.values;
    const std::string path = law + ".scatter";
    Scatter scatter;
    if (!values.has(path + ".kind")) return scatter;
    const std::string kind = *values.text(path + ".kind");
    scatter.kind = kind == "weibull"     ? Scatter::Kind::weibull
                   : kind == "normal"    ? Scatter::Kind::normal
                   : kind == "lognormal" ? Scatter::Kind::lognormal
                                         : Scatter::Kind::uniform;
    scatter.modulus = values.number(path + ".modulus").value_or(scatter.modulus);
    scatter.deviation = values.number(path + ".deviation").value_or(scatter.deviation);
    assembly.the_one(path, {"length", "area", "correlation"}, false);
    scatter.length = values.number(path + ".length").value_or(0);
    scatter.area = values.number(path + ".area").value_or(0);
    scatter.correlation = values.number(path + ".correlation").value_or(0);
    scatter.lowest = values.number(path + ".lowest").value_or(0);
    scatter.highest = values.number(path + ".highest").value_or(scatter.highest);
    scatter.of_strength = false;
    for (const Node* of : values.items(path + ".of")) (of->text == "G_c" ? scatter.of_energy : scatter.of_strength) = true;
    if (!values.flag(law + ".breakable").value_or(true))
        assembly.findings.error_at_name("exclusive-keys", "`" + path + "` belongs to a law that never breaks", assembly.at(path));
    else if (values.has(law + ".sigma_c") && values.number(law + ".sigma_c") == 0)
        assembly.findings.error_at_name("exclusive-keys", "`" + path + "` belongs to a law without strength", assembly.at(path));
    return scatter;
}

/// The pair of materials that a law's name joins by "-".
std::optional<std::pair<Index, Index>> pair_of(const std::string& name, const std::vector<std::string>& materials) {
    const std::size_t dash = name.find('-');
    if (dash == std::string::npos) return std::nullopt;
    const auto a = std::find(materials.begin(), materials.end(), name.substr(0, dash));
    const auto b = std::find(materials.begin(), materials.end(), name.substr(dash + 1));
    if (a == materials.end() || b == materials.end()) return std::nullopt;
    return std::pair(static_cast<Index>(a - materials.begin()), static_cast<Index>(b - materials.begin()));
}

std::vector<std::string> names_for_laws(const std::vector<std::string>& materials, bool with_grains) {
    std::vector<std::string> names{"default"};
    if (with_grains) names.push_back("within");
    if (with_grains) names.insert(names.end(), materials.begin(), materials.end());
    for (std::size_t a = 0; a < materials.size(); ++a)
        for (std::size_t b = a; b < materials.size(); ++b) names.push_back(materials[a] + "-" + materials[b]);
    return names;
}

void name_pair(Assembly& assembly, const std::string& name, const std::pair<Index, Index>& pair, Index number) {
    auto& of_pair = assembly.scenario.law_of_pair;
    const std::string path = "interface." + name;
    if (of_pair[pair.first][pair.second] >= 0)
        assembly.findings.error_at_name("duplicate-name", "`" + path + "` is the second law of this pair of materials", assembly.at(path));
    of_pair[pair.first][pair.second] = of_pair[pair.second][pair.first] = number;
}

/// Pairs without a law of their own take the default.
void fill_pairs(Assembly& assembly, Index standard, const std::vector<std::string>& materials) {
    if (!assembly.values.has("interface")) return;  // reported as missing, or as without a name
    auto& of_pair = assembly.scenario.law_of_pair;
    std::vector<std::string> without;
    for (std::size_t a = 0; a < of_pair.size(); ++a)
        for (std::size_t b = 0; b < of_pair.size(); ++b) {
            if (of_pair[a][b] >= 0) continue;
            if (standard < 0 && a <= b) without.push_back(materials[a] + "-" + materials[b]);
            of_pair[a][b] = standard;
        }
    if (!without.empty())
        assembly.findings.error("missing-key", "no law for interfaces " + joined(without), assembly.at("interface")).note =
            "add [interface.default]; breakable = false in it if nothing shall break";
}

}  // namespace

void assemble_materials(Assembly& assembly) {
    const Values& values = assembly.values;
    for (const std::string& name : values.names("material")) {
        const std::string path = "material." + name;
        if (name.find('-') != std::string::npos)
            assembly.findings.error_at_name("bad-name", "the name of material `" + name + "` has a `-`", assembly.at(path)).note =
                "- joins two materials in [interface.A-B]; use _";
        assembly.scenario.materials.push_back({name,
                                               {.density = values.number(path + ".density").value_or(0),
                                                .E = values.number(path + ".E").value_or(0),
                                                .nu = values.number(path + ".nu").value_or(0)}});
    }
    if (values.has("material") && assembly.scenario.materials.empty())
        assembly.findings.error("missing-key", "there is no material", assembly.at("material")).note = "write [material.NAME]";
}

void assemble_laws(Assembly& assembly) {
    Scenario& scenario = assembly.scenario;
    const std::vector<std::string> materials = material_names(scenario);
    scenario.law_of_pair.assign(materials.size(), std::vector<Index>(materials.size(), -1));
    std::set<std::string> free_names;
    for (std::size_t i = 0; i < assembly.values.count("foundation"); ++i)
        if (const auto name = assembly.values.text(item("foundation", i) + ".interface")) free_names.insert(*name);

    for (std::size_t i = 0; i < assembly.values.count("joints"); ++i)
        if (const auto name = assembly.values.text(item("joints", i) + ".interface")) free_names.insert(*name);

    Index standard = -1, within = -1;
    const bool with_grains = assembly.values.count("grains") > 0;
    scenario.law_within.assign(materials.size(), -1);
    for (const std::string& name : assembly.values.names("interface")) {
        const auto number = static_cast<Index>(scenario.laws.size());
        const std::string path = "interface." + name;
        scenario.laws.push_back({name, law(assembly, path), scatter(assembly, path)});
        const auto pair = pair_of(name, materials);
        const auto material = std::find(materials.begin(), materials.end(), name);
        if (name == "default") {
            standard = number;
        } else if (with_grains && material != materials.end()) {
            scenario.law_within[material - materials.begin()] = number;
        } else if (with_grains && name == "within") {
            within = number;
        } else if (pair) {
            name_pair(assembly, name, *pair, number);
        } else if (!free_names.contains(name)) {
            Diagnostic& d = assembly.findings.error_at_name("unknown-name", "`" + path + "` belongs to no pair of materials and no foundation or set of joints", assembly.at(path));
            d.hint = did_you_mean(name, names_for_laws(materials, with_grains));
            d.note = "known: " + joined(names_for_laws(materials, with_grains));
        }
    }
    fill_pairs(assembly, standard, materials);
    for (std::size_t i = 0; i < materials.size(); ++i)
        if (scenario.law_within[i] < 0) scenario.law_within[i] = within >= 0 ? within : scenario.law_of_pair[i][i];

    std::vector<std::string> names;
    for (const NamedLaw& named : scenario.laws) names.push_back(named.name);
    for (std::size_t i = 0, joint = 0; i < assembly.values.count("joints"); ++i) {
        const std::string path = item("joints", i) + ".interface";
        const std::optional<std::string> name = assembly.values.text(path);
        if (!name) continue;
        const auto found = std::find(names.begin(), names.end(), *name);
        if (found == names.end() && assembly.values.has("interface")) assembly.unknown_name(path, "interface law", *name, names);
        if (joint < scenario.law_of_joint.size()) scenario.law_of_joint[joint++] = found == names.end() ? 0 : static_cast<Index>(found - names.begin());
    }
    for (std::size_t i = 0; i < scenario.foundations.size(); ++i) {
        const std::string path = item("foundation", i);
        const std::optional<std::string> name = assembly.values.text(path + ".interface");
        if (!name) continue;
        const auto found = std::find(names.begin(), names.end(), *name);
        if (found == names.end()) {
            if (assembly.values.has("interface")) assembly.unknown_name(path + ".interface", "interface law", *name, names);
            continue;
        }
        Foundation& foundation = scenario.foundations[i];
        foundation.law = static_cast<Index>(found - names.begin());
        if (foundation.glued && assembly.values.has("interface." + *name + ".sigma_c") && scenario.laws[foundation.law].law.sigma_c == 0)
            assembly.findings.error("exclusive-keys", "`" + path + "` is glued by the law `" + *name + "`, which has no strength", assembly.at(path + ".glued"));
    }
}

}  // namespace knap
