#pragma once
// run.json: what was run, how it ended, and its results. Other programs rely on its members: new ones may be added,
// none is removed.
#include "analysis/gates.hpp"
#include "model/mass_scaling.hpp"
#include "record/recorder.hpp"
#include "record/summary.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/step_control.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace knap {

/// Time spent on a run by all commands that had a part in it.
struct TimeSpent {
    double cpu = 0, wall = 0;                  // [s] in all
    double model = 0, preload = 0, steps = 0;  // [s] processor time: mesh and model, start in equilibrium, steps

    template <class Archive>
    void serialize(Archive& archive) {
        archive(cpu, wall, model, preload, steps);
    }
};

struct RunRecord {
    std::string status;          // starting, running, done, failed, interrupted
    std::string reason;          // of a failure
    std::string ended;           // "rest" where the run ended before time.end because the body was at rest
    bool output_failed = false;  // a file could not be written; the simulation itself can go on
    std::string name, title;
    std::vector<std::string> command;
    std::uint64_t seed = 0;
    int threads = 1;
    TimeSpent spent;
    OutputTime output;
    Index triangles = 0, interfaces = 0;
    double thickness = 0;  // [m]
    std::int64_t steps = 0;
    double step = 0, time = 0;                                      // [s] planned step, time reached
    double smallest_step = 0, largest_step = 0;                     // [s] accepted steps
    std::array<std::int64_t, cutback_reasons.size()> n_cutbacks{};  // in the order of cutback_reasons
    std::vector<SchemeChangeEvent> scheme_changes;                  // with BulkScheme::automatic
    /// With [rigid], at the end.
    struct Pieces {
        std::array<std::int64_t, 3> n{};  // by PieceState
        std::int64_t n_never_break = 0;   // smaller than `smallest`, though they have points that could
        double mass_never_break = 0;      // [kg] of these
        double thawed_time = 0;           // [s] in which all were deformable
    };
    std::optional<Pieces> pieces;
    SchemeOptions scheme;
    std::optional<MovedMass> mass_scaling;
    double mean_edge = 0;                // [m]
    double rayleigh_speed = 0;           // [m/s]
    std::vector<std::string> materials;  // names, by region
    std::string temperature_unit;        // "K" or "C", with heat
    std::vector<FigureContext::Line> collectors;
    StepReport counts;  // of vertex problems and linear solves
    FactorSize factor;  // of the implicit bulk, at the end
    std::int64_t triangle_steps = 0;
    AdaptationCounts adaptation;
    double adaptation_gain = 0;  // [-] 0: no [adapt]; NaN: the mesh stayed coarse
    Summary summary;
    Gates gates;
    std::vector<ExpectResult> expect;
    std::size_t n_not_judged = 0;      // numbers of [expect] of a run that failed
    std::vector<ProbeSubject> probes;  // what they watched at the end
    std::vector<std::filesystem::path> figures;
    std::vector<std::string> warnings;

    /// Counts of the steps that were taken, and of those that the control rejected.
    void set_counts(const StepReport& counted, const StepControl& control);

    /// [s] Processor time of all else: reading, checkpoints, the end.
    double cpu_other() const { return spent.cpu - spent.model - spent.preload - spent.steps - output.cpu; }
};

std::string run_json(const RunRecord& record);

/// The members of run.json with units and meanings.
OutputTable run_json_outputs();

/// run.json of a run directory; every member that the commands use is present and of the right type. Throws UserError
/// where it is not.
nlohmann::ordered_json read_run_json(const std::filesystem::path& run);

/// The runs in the directory of a study or sweep, or in one of runs, by name.
std::vector<std::filesystem::path> runs_in(const std::filesystem::path& directory);

/// The state of a directory according to its run.json; the default where there is none.
struct EarlierRecord {
    bool is_of_a_run = false;    // also where the file is damaged
    std::string status;          // empty where it cannot be read
    bool output_failed = false;  // the run ended because a file could not be written
};
EarlierRecord earlier_record(const std::filesystem::path& directory);

}  // namespace knap
