// [[probe]], and figures of what a run does not have.
#include <algorithm>

#include "scenario/assemble.hpp"

namespace knap {

namespace {

void check_figure(const Assembly& assembly, const std::string& path) {
    const std::string show = assembly.values.text(path + ".show").value_or("");
    if (show == "reactions" && assembly.drivers().empty())
        assembly.findings.error("nothing-to-show", "`" + path + "` shows reactions, but no load prescribes a motion and there is no obstacle", assembly.at(path + ".show")).note =
            "a reaction is the force of a load with velocity or displacement";
    if ((show == "probes" || show == "probe_velocities") && assembly.values.count("probe") == 0)
        assembly.findings.error("nothing-to-show", "`" + path + "` shows probes, but there is none", assembly.at(path + ".show")).note = "add a [[probe]]";
    const std::vector<ProbeOptions>& probes = assembly.scenario.probes;
    if (show == "probe_velocities" && !probes.empty() && std::all_of(probes.begin(), probes.end(), [](const ProbeOptions& probe) { return probe.interface; }))
        assembly.findings.error("nothing-to-show", "`" + path + "` shows velocities, but all probes watch interfaces", assembly.at(path + ".show")).note =
            "add a [[probe]] that watches a place";
}

}  // namespace

void assemble_probes(Assembly& assembly) {
    const Values& values = assembly.values;
    for (std::size_t i = 0; i < values.count("probe"); ++i) {
        const std::string path = item("probe", i);
        if (!values.given(path + ".name")) assembly.values.compute(path + ".name", Node::of_text("probe" + std::to_string(i + 1)));
        const std::string name = values.text(path + ".name").value_or("");
        assembly.check_column_name(path + ".name", name, "a probe");
        if (const auto at = values.pair(path + ".at")) assembly.scenario.probes.push_back({.name = name, .at = *at, .interface = values.text(path + ".watch") == "interface"});
    }
    for (std::size_t i = 0; i < values.count("figure"); ++i) check_figure(assembly, item("figure", i));
}

}  // namespace knap
