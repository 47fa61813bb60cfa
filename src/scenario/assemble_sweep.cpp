// [sweep].
#include <algorithm>

#include "scenario/assemble.hpp"

namespace knap {
namespace {

std::vector<std::string> texts(const Values& values, const std::string& path) {
    std::vector<std::string> list;
    for (const Node* node : values.items(path)) list.push_back(node->text);
    return list;
}

/// What the table shows where nothing else is said.
std::vector<std::string> standard_quantities(const Scenario& scenario) {
    std::vector<std::string> names;
    if (scenario.specimen) names = {"peak_stress", "tangent_modulus"};
    names.insert(names.end(), {"broken_length", "dissipated", "fragments"});
    return names;
}

}  // namespace

void assemble_sweep(Assembly& assembly) {
    const Values& values = assembly.values;
    SweepOptions& sweep = assembly.scenario.sweep;
    sweep.set = texts(values, "sweep.set");
    sweep.n_seeds = values.has("sweep.seeds") ? static_cast<int>(values.find("sweep.seeds")->node.integer) : 0;
    sweep.quantities = texts(values, "sweep.quantities");
    sweep.show = values.text("sweep.show").value_or(sweep.show);
    for (const std::string& name : sweep.quantities) assembly.check_summary_number("sweep.quantities", name);
    if (sweep.quantities.empty()) sweep.quantities = standard_quantities(assembly.scenario);
}

}  // namespace knap
