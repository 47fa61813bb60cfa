// [[probe]], and figures of what a run does not have.
#include <algorithm>
#include <set>

#include "scenario/assemble.hpp"

namespace knap {

namespace {

void check_figure(const Assembly& assembly, const std::string& path) {
    const auto drives = [](const Load& load) { return load.kind == Load::Kind::velocity || load.kind == Load::Kind::displacement; };
    const std::vector<Load>& loads = assembly.scenario.loads;
    const std::string show = assembly.values.text(path + ".show").value_or("");
    if (show == "reactions" && assembly.scenario.obstacles.empty() && std::none_of(loads.begin(), loads.end(), drives))
        assembly.findings.error("nothing-to-show", "`" + path + "` shows reactions, but no load prescribes a motion and there is no obstacle", assembly.at(path + ".show")).note =
            "a reaction is the force of a load with velocity or displacement";
    if (show == "probes" && assembly.values.count("probe") == 0)
        assembly.findings.error("nothing-to-show", "`" + path + "` shows probes, but there is none", assembly.at(path + ".show")).note = "add a [[probe]]";
}

}  // namespace

void assemble_probes(Assembly& assembly) {
    const Values& values = assembly.values;
    std::set<std::string> names;
    for (std::size_t i = 0; i < values.count("probe"); ++i) {
        const std::string path = item("probe", i);
        if (!values.given(path + ".name")) assembly.values.compute(path + ".name", Node::of_text("probe" + std::to_string(i + 1)));
        const std::string name = values.text(path + ".name").value_or("");
        const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
        if (name.empty() || !std::all_of(name.begin(), name.end(), plain))
            assembly.findings.error("bad-name", "`" + name + "` cannot be the name of a probe", assembly.at(path + ".name")).note = "letters, digits, _ and -";
        if (!names.insert(name).second) assembly.findings.error("duplicate-name", "two probes are called `" + name + "`", assembly.at(path));
        if (const auto at = values.pair(path + ".at")) assembly.scenario.probes.push_back({.name = name, .at = *at, .interface = values.text(path + ".watch") == "interface"});
    }
    for (std::size_t i = 0; i < values.count("figure"); ++i) check_figure(assembly, item("figure", i));
}

}  // namespace knap
