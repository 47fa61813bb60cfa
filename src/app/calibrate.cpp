// knap calibrate: the surplus of a mesh with the laws of a scenario, by cracks in strips (mesh_toughness.toml).
#include "app/commands.hpp"
#include "app/ensemble/ensemble.hpp"
#include "app/run/setup.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "scenario/keys.hpp"
#include "scenario/toughness.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

constexpr const char* strip_scenario = "mesh_toughness";
// The strip in process zones: height, length, initial crack, straight line behind it, end and half height of the part
// with small triangles, size of the others.
constexpr double strip_height = 40. / 3, strip_length = 40, crack_end = 10, line_end = 40. / 3, fine_start = 28. / 3,
                 fine_end = 104. / 3, fine_half = 2;
constexpr double ramp_passages = 4, end_passages = 13.3;  // of a dilatational wave over the height
constexpr double through_at = 0.9;                        // of the way to the end of the small triangles

std::string pair_text(double x, double y) { return "[" + shortest(x) + ", " + shortest(y) + "]"; }

std::string box_text(double x0, double y0, double x1, double y1) {
    return "[" + shortest(x0) + ", " + shortest(y0) + ", " + shortest(x1) + ", " + shortest(y1) + "]";
}

/// The law as an inline table, without random strength and what belongs to temperatures. The strip has the G_c as
/// given, also if the scenario calls it that of a specimen.
std::string law_table_text(const Node& law, double G_c) {
    Texts keys{"G_c = " + shortest(G_c)};
    for (const Node& key : law.children) {
        const bool other = key.name == "G_c" || key.name == "delta_c" || key.name == "strength_table" ||
                           key.name == "friction_table" || key.name == "csv" || key.name == "scatter";
        if (key.valid && key.is_given() && !other && !key.key->is_table())
            keys.push_back(key.name + " = " + toml_text(key));
    }
    return "{ " + joined(keys) + " }";
}

/// A law in one material on the mesh of the scenario.
struct Candidate {
    const NamedLaw& law;
    const NamedMaterial& material;
    MeshedLaw meshed;
    double zone;  // [m] process zone
};

/// The strip of a law: KEY=VALUE for scenarios/mesh_toughness.toml. `loads`: energy release rates over G_c.
Texts strip_of(const ReadResult& read, const Candidate& candidate, const std::vector<double>& loads, int seeds) {
    const Scenario& scenario = read.scenario;
    const double z = candidate.zone, half = 0.5 * strip_height * z,
                 edge = candidate.zone / candidate.law.law.steepness() / candidate.meshed.edges * scenario.order;
    const Elastic& elastic = candidate.material.elastic;
    const double speed = elastic.dilatational_speed(scenario.plane),
                 modulus = elastic.density * speed * speed,  // [Pa] of uniaxial strain, in the plane
        passage = strip_height * z / speed;
    const std::string matter = "={ density = " + shortest(elastic.density) + ", E = " + shortest(elastic.E) +
                               ", nu = " + shortest(elastic.nu) + " }",
                      law = "=" +
                            law_table_text(*read.values.find("interface." + candidate.law.name), candidate.law.law.G_c),
                      fine = box_text(fine_start * z, -fine_half * z, fine_end * z, fine_half * z);
    Texts set{"name=" + scenario.name + "-" + candidate.law.name,
              "domain.size=" + pair_text(strip_length * z, 2 * half),
              "domain.origin=" + pair_text(0, -half),
              std::string("domain.model=plane ") + (scenario.plane == PlaneModel::strain ? "strain" : "stress"),
              "domain.crack[0].points=[" + pair_text(0, 0) + ", " + pair_text(crack_end * z, 0) + "]",
              "domain.region[0].box=" + fine,
              "domain.region[1].box=" + box_text(fine_start * z, 0, line_end * z, fine_half * z),
              "mesh.order=" + std::to_string(scenario.order),
              "mesh.size=" + shortest(std::max(z, edge)),
              "mesh.refine[0].inside=" + fine,
              "mesh.refine[0].size=" + shortest(edge),
              "material.glass" + matter,
              "material.free" + matter,
              "material.start" + matter,
              "interface.free-free" + law,
              "interface.free-start" + law,
              "load[0].ramp=" + shortest(ramp_passages * passage),
              "load[1].displacement=" + pair_text(0, 0),
              "load[1].ramp=",
              "time.end=" + shortest(end_passages * passage),
              "time.safety=" + shortest(scenario.time.safety),
              "output.every=" + shortest(passage),
              "output.history_every=" + shortest(0.04 * passage),
              "output.report=false",
              "figure=",
              "expect=",
              "sweep={ seeds = " + std::to_string(seeds) +
                  ", quantities = [\"steady_work_per_advance\", \"main_length\", \"mean_tip_speed\"] }"};
    // G = M d^2/(2 H), all of it by the upper side
    std::string displacements;
    for (const double load : loads) {
        const double d = std::sqrt(2 * strip_height * z * load * candidate.law.law.G_c / modulus);
        displacements += (displacements.empty() ? "" : ",") + pair_text(0, d);
    }
    set.push_back("load[0].displacement=" + displacements);
    return set;
}

/// The rows of a finished sweep: one for each load.
std::vector<ToughnessRow> rows_of(const Ensemble& sweep, const Candidate& candidate, const std::vector<double>& loads,
                                  double rayleigh) {
    std::vector<ToughnessRow> rows;
    const double way = (fine_end - crack_end) * candidate.zone;
    for (std::size_t v = 0; v < sweep.variants.size(); ++v) {
        const auto went_through = [&](const EnsembleRun& run) {
            return run.result.status == "done" && run.result.values[1] >= through_at * way;
        };
        const auto runs = sweep.runs_of(v);
        const auto spread_of = [&](std::size_t quantity) {
            return sweep.spread(
                v, [&](const EnsembleRun& run) { return went_through(run) ? run.result.values[quantity] : NAN; });
        };
        const Spread work = spread_of(0), speed = spread_of(2);
        ToughnessRow row{.law = candidate.meshed,
                         .load = loads[v],
                         .through = static_cast<double>(std::ranges::count_if(runs, went_through)) /
                                    static_cast<double>(runs.size()),
                         .seeds = static_cast<int>(runs.size())};
        if (work.n > 0)
            row.surplus = work.mean / candidate.law.law.G_c, row.deviation = work.deviation / candidate.law.law.G_c;
        if (speed.n > 0) row.speed = speed.mean / rayleigh;
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

ExitCode calibrate(const std::string& scenario, Texts overrides, const CalibrateOptions& options) {
    // the scenario may ask for the table that does not exist yet
    overrides.emplace_back("toughness=");
    const ReadResult read = open_scenario(scenario, overrides);
    const fs::path file = options.table.empty() ? fs::path(read.scenario.name + "_toughness.csv") : options.table;
    if (!options.batch.force) refuse_existing(file);
    const Scenario& base = read.scenario;
    const std::vector<LawWithin> found = laws_within(base, read.values);
    if (found.empty())
        throw UserError("nothing-to-calibrate", "no law with cohesion acts within a material of `" + scenario + "`",
                        "cracks between two materials, along joints and supports run along given lines and cost G_c");
    std::vector<ToughnessRow> rows;
    for (const auto& [law, material, meshed] : found) {
        const Candidate candidate{
            base.laws[law], base.materials[material], meshed,
            base.laws[law].law.process_zone(base.materials[material].elastic.plane_modulus(base.plane))};
        if (!(meshed.edges >= 1))
            throw UserError("resolution",
                            formatted("the process zone of `%s` is covered by %.2g edges: no strip can be made of it",
                                      candidate.law.name.c_str(), candidate.meshed.edges),
                            "at least one edge, better five: a smaller mesh.size");
        Ensemble sweep = plan_sweep(strip_scenario, strip_of(read, candidate, options.loads, options.seeds));
        BatchOptions batch = options.batch;
        batch.output = (options.batch.output.empty() ? fs::path("calibrations") : options.batch.output) /
                       (base.name + "-" + candidate.law.name);
        if (const ExitCode code = run_ensemble(sweep, strip_scenario, batch); code == exit_interrupted) return code;
        for (EnsembleRun& run : sweep.runs)
            run.result = read_result(batch.output / "runs" / run.name, sweep.quantities);
        std::ranges::move(
            rows_of(sweep, candidate, options.loads, candidate.material.elastic.rayleigh_speed(base.plane)),
            std::back_inserter(rows));
    }
    const std::string table = toughness_csv(rows);
    write_new_file(file, table);
    std::printf("%stable:   %s\n", table.c_str(), file.string().c_str());
    std::printf("to use it: [toughness] with meaning = \"as measured\" and table = \"%s\"\n", file.string().c_str());
    if (std::ranges::none_of(rows, &ToughnessRow::breaks))
        std::printf("warning: under no load did four of five cracks run through; larger ones by --loads\n");
    return exit_done;
}

}  // namespace knap
