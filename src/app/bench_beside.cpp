#include "app/bench_beside.hpp"

#include "app/run/setup.hpp"
#include "app/run/step_plan.hpp"
#include "base/stopwatch.hpp"
#include "figures/canvas.hpp"
#include "figures/figures.hpp"
#include "output/vtk_series.hpp"
#include "stepper/moreau_jean.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// Taken away with all that is in it.
class OwnDirectory {
public:
    OwnDirectory() : path_(std::filesystem::temp_directory_path() / ("knap_bench_" + std::to_string(getpid()))) {}
    ~OwnDirectory() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    OwnDirectory(const OwnDirectory&) = delete;
    OwnDirectory& operator=(const OwnDirectory&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace

OutputTimes time_output(const Model& model, const State& state) {
    constexpr int n_trials = 3;
    const OwnDirectory directory;
    VtkSeries series(directory.path());
    OutputTimes best{.frame = INFINITY, .figure = INFINITY};
    for (int trial = 0; trial < n_trials; ++trial) {
        const Stopwatch writing;
        const Frame frame = make_frame(model, state, false);
        series.write(frame);
        best.frame = std::min(best.frame, writing.cpu());
        const Stopwatch drawing;
        draw_figure({.file = "cracks.png"}, frame, {}, {}, directory.path());
        best.figure = std::min(best.figure, drawing.cpu());
    }
    return best;
}

ImplicitWork implicit_work() {
    const ReadResult read = read_scenario_text(built_in_scenario("edge_cracked_block_implicit"), "edge_cracked_block_implicit",
                                               {"mesh.size=0.001", "time.end=4e-5", "time.step=\"10 CFL\""});
    const Model model = build_model(read.scenario);
    MoreauJean stepper(model, read.scenario.time.scheme);
    StepControl control(plan_of(read, model, read.scenario.time.end).limits);
    State now = initial_state(model), next = now;
    ImplicitWork work;
    const Stopwatch watch;
    while (!StepControl::has_reached(now, read.scenario.time.end) && !control.is_stuck()) {
        const double h = control.next(now);
        const StepReport report = stepper.step(now, h, next);
        work.linear_solves += report.linear_solves, work.factorisations += report.factorisations;
        if (control.judge(now, h, report)) continue;
        std::swap(now, next);
        ++work.steps;
    }
    work.seconds = watch.cpu();
    work.unknowns = stepper.factor_size().unknowns, work.entries = stepper.factor_size().entries;
    return work;
}

}  // namespace knap
