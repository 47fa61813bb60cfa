// The list of all outputs.
#include "analysis/collectors.hpp"
#include "analysis/fluids.hpp"
#include "analysis/fragments.hpp"
#include "output/vtk_series.hpp"
#include "record/outputs.hpp"
#include "record/run_record.hpp"
#include "record/summary.hpp"

#include <algorithm>
#include <map>

namespace knap {
namespace {

template <class Source>
std::vector<Output> rows_of(std::span<const Measure<Source>> measures) {
    return {measures.begin(), measures.end()};
}

/// The time, then columns after names that the scenario gives.
template <class... Sources>
std::vector<Output> rows_after_names(std::span<const Measure<Sources>>... lists) {
    static std::map<std::string_view, std::string> patterns;  // rows point into it
    std::vector<Output> rows{{"time", "s", "of the line"}};
    const auto add = [&](const Output& column) {
        const std::string& pattern = patterns.emplace(column.name, "*" + std::string(column.name)).first->second;
        rows.push_back({pattern, column.unit, column.doc});
    };
    (std::ranges::for_each(lists, add), ...);
    return rows;
}

std::vector<Output> gate_rows() {
    std::vector<Output> rows;
    for (const GateRule& rule : gate_rules()) rows.push_back({rule.name, rule.unit, rule.meaning});
    return rows;
}

std::vector<OutputTable> all_tables() {
    std::vector<OutputTable> tables{
        {"summary",
         "numbers of a run: `summary` of run.json, log.txt, stdout, `knap info`; [expect], studies and sweeps refer to "
         "them by name",
         summary_outputs()},
        {"energy.csv",
         "energies and works since the start; a line every output.history_every",
         {energy_terms().begin(), energy_terms().end()}},
        {"cracks.csv", "cracks; a line at the same times", rows_of(crack_columns())},
        {"reactions.csv",
         "forces and motions of all that drives the body, at the same times; each column starts with the name of a "
         "load (load0, load1, ... where it has none) or of an obstacle",
         rows_after_names(driver_columns(), obstacle_columns())},
        {"fluids.csv",
         "fluids in cracks, at the same times; each column starts with the name of a [[pressure]] (fluid0, fluid1, ... "
         "where it has none)",
         rows_after_names(fluid_columns())},
        {"probes.csv",
         "probed places, interfaces and stresses, at the same times; each column starts with the name of a probe",
         rows_after_names(place_columns(), interface_columns(), stress_columns(), tip_columns())},
        {"breaks.csv", "a line for every interface when it breaks; with output.breaks", rows_of(break_columns())},
        {"stress_strain.csv", "the specimen of a rock test, at the same times", rows_of(stress_strain_columns())},
        {"arms.csv", "a line for the start of every crack arm and for each of its edges; written at the end",
         rows_of(arm_columns())},
        {"fragments.csv", "a line per fragment of the body, the heaviest first; written at the end",
         rows_of(fragment_columns())},
        {"fragment_history.csv",
         "numbers of all fragments together; a line at the start, every output.every, and at the end",
         rows_of(fragment_moment_columns())},
        {"fragment_paths.csv", "the columns of fragments.csv of the thousand heaviest fragments, at the same times",
         fragment_path_columns()},
        {"trajectories.csv",
         "places, heights and energies of the hundred heaviest fragments and of free obstacles, at the same times; "
         "with "
         "output.trajectories, in place of fragment_paths.csv",
         rows_of(trajectory_columns())},
        {"passages.csv",
         "a line for every passage of a fragment or of a free obstacle through a [[collector]], when it is a "
         "thousandth "
         "of its diameter beyond the line",
         rows_of(passage_columns())},
        {"gates",
         "checks of the validity of a run: `gates` of run.json, each with value, unit, warning, limit, level, pass, "
         "place_m, meaning and cure",
         gate_rows()}};
    tables.insert(tables.end(), frame_outputs().begin(), frame_outputs().end());
    tables.push_back(run_json_outputs());
    tables.push_back({"study.csv",
                      "a line per run of `knap study`; after these columns each quantity with its unit, its error "
                      "(relative, or over its scale) and its order of convergence",
                      {{"line", "", "scheme or variant"},
                       {"level", "", "divisor of step, mesh size or both"},
                       {"seed", "", "of the run"},
                       {"status", "", "of the run"},
                       {"bulk", "", "scheme of the bulk"},
                       {"cohesion", "", "scheme of the cohesion"},
                       {"size", "m", "mesh size"},
                       {"step", "s", "planned step, the largest"},
                       {"triangles", "", "number of triangles"},
                       {"steps", "", "number of steps"},
                       {"cuts", "", "number of steps that were repeated with a smaller size"},
                       {"linear_solves", "", "number"},
                       {"factorisations", "", "number"},
                       {"cpu", "s", "processor time without output"}}});
    tables.push_back({"safety.csv",
                      "a line per run of `knap study --safety`; each quantity with its unit comes last",
                      {{"run", "", "name of its directory; the factor of safety of the run follows"},
                       {"verdict", "", "whether the body stands"},
                       {"status", "", "of the run"},
                       {"triangles", "", "number of triangles"},
                       {"steps", "", "number of steps"},
                       {"cpu", "s", "processor time without output"},
                       {"at_rest", "", "1: the run ended at rest, 0: time.end came before"}}});
    tables.push_back({"statistics.csv",
                      "a line per quantity and variant, over the seeds, of `knap study` and `knap sweep`; a sweep has "
                      "its keys in front",
                      {{"line", "", "scheme or variant"},
                       {"level", "", "divisor of step, mesh size or both"},
                       {"runs", "", "number of runs"},
                       {"quantity", "", "name"},
                       {"unit", "", "of the following columns"},
                       {"happened", "", "number of runs that have a value"},
                       {"mean", "", "over these runs, in the unit of the line"},
                       {"deviation", "", "standard deviation of the sample"},
                       {"smallest", "", "smallest value"},
                       {"largest", "", "largest value"}}});
    tables.push_back(
        {"sweep.csv",
         "a line per run of `knap sweep`; the varied keys and what is drawn at random follow its name, "
         "each quantity with its unit comes last",
         {{"run", "", "name of its directory"},
          {"seed", "", "of the run"},
          {"status", "", "of the run"},
          {"triangles", "", "number of triangles"},
          {"steps", "", "number of steps"},
          {"cpu", "s", "processor time without output"},
          {"at_rest", "", "1: the run ended at rest, 0: time.end came before; only with until = \"rest\""}}});
    return tables;
}

}  // namespace

const std::vector<OutputTable>& output_tables() {
    static const std::vector<OutputTable> tables = all_tables();
    return tables;
}

}  // namespace knap
