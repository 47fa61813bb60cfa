// knap calibrate: what a mesh adds to the fracture energy and to the strength of specimens, with the laws of a
// scenario.
#include "app/calibrate.hpp"
#include "app/ensemble/ensemble.hpp"
#include "app/setup/setup.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "scenario/keys.hpp"

#include <algorithm>

namespace knap {

namespace fs = std::filesystem;

std::string pair_text(double x, double y) { return "[" + shortest(x) + ", " + shortest(y) + "]"; }

std::string matter_text(const CalibratedLaw& of) {
    const Elastic& elastic = of.material.elastic;
    std::string text =
        "={ density = " + shortest(elastic.density) + ", E = " + shortest(elastic.E) + ", nu = " + shortest(elastic.nu);
    if (const auto& layers = elastic.bedding)
        text += ", bedding = { E = " + shortest(layers->E) + ", nu = " + shortest(layers->nu) +
                ", G = " + shortest(layers->G) + ", angle = " + shortest(layers->angle / degree) + " }";
    return text + " }";
}

std::string law_text(const CalibratedLaw& of, double sigma_c, double G_c) {
    std::vector<std::string> keys{"sigma_c = " + shortest(sigma_c), "G_c = " + shortest(G_c)};
    for (const Node& key : of.read.values.find("interface." + of.law.name)->children) {
        // files are tables by now
        const bool other = key.name == "sigma_c" || key.name == "G_c" || key.name == "delta_c" || key.name == "csv" ||
                           key.name == "friction_csv" ||
                           std::ranges::find(not_calibrated, key.name) != not_calibrated.end();
        if (key.valid && key.is_given() && !other && !key.key->is_table())
            keys.push_back(key.name + " = " + toml_text(key));
    }
    return "={ " + joined(keys) + " }";
}

std::string model_text(const Scenario& scenario) {
    return scenario.plane == PlaneModel::strain ? "plane strain" : "plane stress";
}

std::optional<Ensemble> calibration_sweep(const std::string& scenario, const std::vector<std::string>& set,
                                          const BatchOptions& options, const std::string& name) {
    Ensemble sweep = plan_sweep(scenario, set);
    BatchOptions batch = options;
    batch.output = (options.output.empty() ? fs::path("calibrations") : options.output) / name;
    if (run_ensemble(sweep, scenario, batch) == exit_interrupted) return {};
    for (EnsembleRun& run : sweep.runs) run.result = read_result(batch.output / "runs" / run.name, sweep.quantities);
    return sweep;
}

ExitCode calibrate(const std::string& scenario, std::vector<std::string> overrides, const CalibrateOptions& options) {
    using Of = CalibrateOptions::Of;
    const bool strength = options.of == Of::strength;
    const std::string word = strength ? "strength" : "toughness";
    // the scenario may ask for the table that does not exist yet
    overrides.emplace_back("toughness=");
    if (strength) {
        overrides.emplace_back("strength.table=");
        overrides.emplace_back("strength.meaning=of interfaces");
    }
    const ReadResult read = open_scenario(scenario, overrides);
    const Scenario& base = read.scenario;
    const fs::path file = options.table.empty() ? fs::path(base.name + "_" + word + ".csv") : options.table;
    if (!options.batch.force) refuse_existing(file);
    std::vector<CalibratedLaw> laws;
    for (const LawWithin& within : laws_within(base, read.values))
        laws.push_back({read, base.laws[within.law], base.materials[within.material], within});
    if (laws.empty())
        throw UserError("nothing-to-calibrate", "no law with cohesion acts within a material of `" + scenario + "`",
                        "cracks between two materials, along joints and supports run along given lines and cost G_c");
    const Calibration found = strength ? calibrate_strength(laws, options) : calibrate_toughness(laws, options);
    if (found.table.empty()) return exit_interrupted;
    write_new_file(file, found.table);
    std::printf("%stable:   %s\n", found.table.c_str(), file.string().c_str());
    std::printf("to use it: [%s] with meaning = \"as measured\" and table = \"%s\"\n", word.c_str(),
                file.string().c_str());
    if (!found.warning.empty()) std::printf("warning: %s\n", found.warning.c_str());
    return exit_done;
}

}  // namespace knap
