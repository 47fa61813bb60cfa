// The program without its output, for the page: functions that JavaScript calls. One run at a time; texts and arrays
// stay where they are until the next call.
#include "app/check/findings.hpp"
#include "app/run/run_text.hpp"
#include "app/setup/setup.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "output/frame.hpp"
#include "scenario/read_scenario.hpp"
#include "stepper/moreau_jean.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#define KNAP_FOR_PAGE(name) extern "C" __attribute__((export_name(#name)))

namespace knap {
namespace {

/// What a call answers; page.js has the same numbers.
enum Answer { answer_running = 0, answer_done = 1, answer_bad_scenario = 2, answer_failed = 3 };

/// What a run without files has no use for.
const std::vector<std::string> without_output{"figure=[]", "expect={}", "study={}", "sweep={}"};

std::string text;  // of the last call: errors, warnings, reason of the end

/// Numbers of the page, in the order of the names in page.js. [s], [J], [-], [m]
struct Numbers {
    double time, end, steps, triangles, kinetic, strain, dissipated, recoverable, external_work, friction_work,
        residual, broken_length, body_thickness;
};

/// A scenario from its text to the last step: the steps of app/run without checkpoints, excavations and refinement.
class PageRun {
public:
    explicit PageRun(const std::string& toml)
        : read_(read_scenario_text(toml, "scenario.toml", without_output)),
          model_(checked_model(read_)),
          plan_(plan_of(read_, model_, infinity)),
          stepper_(model_, scheme()),
          control_(plan_.limits) {
        for (const auto& found : {check_model(read_, model_), findings_of_model(read_, model_, plan_), read_.warnings})
            for (const Diagnostic& warning : found) text += format(warning);
        stepper_.resolve_islands(plan_.limits);
        now_ = initial_state(model_);
        if (read_.scenario.time.start_in_equilibrium) stepper_.start_in_equilibrium(now_);
        stepper_.begin(now_);
        next_ = now_;
        Scenario shown = read_.scenario;
        shown.figures.clear(), shown.output.fields = false;
        recorder_.emplace(model_, now_, recorder_options(shown, model_, shown.works(), {}, false, false));
    }
    PageRun(const PageRun&) = delete;

    bool is_over() const { return StepControl::has_reached(now_, read_.scenario.time.end) || recorder_->at_rest(); }
    double time() const { return now_.time; }
    void step();
    void finish() { recorder_->finish(now_); }
    void show(double deform) const;
    Numbers numbers() const;
    std::string summary() const;

private:
    static Model checked_model(ReadResult& read) {
        const Scenario& scenario = read.scenario;
        for (const auto& [asks, key] :
             {std::pair{!scenario.excavations.empty(), "excavation"}, {scenario.adapt.active(), "adapt"}})
            if (asks)
                throw UserError({read.at(key, {.code = "not-in-browser",
                                               .message = std::string("the page cannot compute `") + key + "`",
                                               .note = "the program for the command line can: knap run FILE.toml"})});
        return model_of(read);
    }
    const SchemeOptions& scheme() const { return read_.scenario.time.scheme; }
    void count(const StepReport& report);

    ReadResult read_;
    Model model_;
    StepPlan plan_;
    MoreauJean stepper_;
    StepControl control_;
    State now_, next_;
    std::optional<Recorder> recorder_;
};

/// One attempt of a step, as Run::step (app/run/run.cpp).
void PageRun::step() {
    if (control_.may_freeze(now_)) now_.motion = Motion::rigid;
    const double h = stepper_.step_size(now_, control_.next(now_));
    const StepReport report = stepper_.step(now_, h, next_);
    if (const std::optional<Cutback> cut = control_.judge(now_, h, report)) {
        if (control_.is_stuck())
            throw SimulationError(
                stuck_text(*cut, place_of(*cut, model_, now_, next_), control_.smallest_against(cut->reason)));
        if (cut->changes_to_explicit) begin_leapfrog(now_);
        if (const auto thawed = cut->thaws ? stepper_.thaw(now_, next_) : std::nullopt) count(*thawed);
        return;
    }
    count(report);
    if (!control_.ends_explicit_stage(now_)) return;
    const StepReport closing = stepper_.close_leapfrog(now_, next_);
    if (closing.rejection != Rejection::none) return control_.stay_explicit(now_);
    control_.begin_implicit_stage(next_, closing);
    count(closing);
}

void PageRun::count(const StepReport& report) {
    std::swap(now_, next_);
    recorder_->after_step(now_, report);
    GateKeeper& gates = recorder_->gates();
    for (const Gate* gate : gates.new_warnings()) {
        const std::string warning = warning_text(*gate, now_);
        text += warning, gates.warned(*gate, warning);
    }
    if (!gates.pass()) throw SimulationError(violated_text(gates.gates(), now_, place_of_largest_speed(model_, now_)));
}

Numbers PageRun::numbers() const {
    const EnergyRow& row = recorder_->ledger().row();
    const double largest = recorder_->ledger().largest_energy();
    return {.time = now_.time,
            .end = read_.scenario.time.end,
            .steps = static_cast<double>(now_.n_steps),
            .triangles = static_cast<double>(model_.mesh.n_triangles()),
            .kinetic = row.kinetic,
            .strain = row.strain,
            .dissipated = row.dissipated,
            .recoverable = row.recoverable + row.interface_elastic,
            .external_work = row.external_work,
            .friction_work = row.friction_work,
            .residual = largest > 0 ? recorder_->ledger().largest_residual() / largest : 0,
            .broken_length = recorder_->cracks().pattern().broken_length,
            .body_thickness = model_.thickness};
}

/// As `summary` of run.json.
std::string PageRun::summary() const {
    std::string json = "{";
    for (const auto& [name, value] : summarise(model_, now_, *recorder_).values)
        json += (json.size() > 1 ? ",\"" : "\"") + name + "\":" + (std::isfinite(value) ? shortest(value) : "null");
    return json + "}";
}

std::unique_ptr<PageRun> run;
Numbers numbers;

// a frame as the page draws it
std::vector<float> corners;        // [m] x, y in turns, three corners a triangle
std::vector<float> tensions;       // [Pa] largest principal stress of a triangle
std::vector<float> cracks;         // [m] per face of an interface that is not intact x, y of both ends
std::vector<std::uint8_t> states;  // InterfaceStatus of each
std::vector<float> obstacles;      // [m] x, y in turns, n_outline points an obstacle
struct Sizes {
    std::int32_t corners, cracks, obstacles, outline;
} sizes;

void add(std::vector<float>& list, const Vec2& place) {
    list.push_back(static_cast<float>(place.x())), list.push_back(static_cast<float>(place.y()));
}

void PageRun::show(double deform) const {
    const Frame frame = make_frame(model_, now_, false);
    corners.clear(), tensions.clear(), cracks.clear(), states.clear(), obstacles.clear();
    for (std::size_t k = 0; k < frame.position.size(); ++k)
        add(corners, frame.position[k] + deform * frame.displacement[k]);
    for (const Eigen::Vector3d& s : frame.stress) tensions.push_back(static_cast<float>(largest_principal(s)));
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        if (frame.status_of_interface(i) == InterfaceStatus::intact) continue;
        for (const auto* side : {&frame.side_a[i], &frame.side_b[i]}) {  // a face each
            if ((*side)[0] < 0) continue;
            for (const Index corner : *side) add(cracks, frame.position[corner] + deform * frame.displacement[corner]);
            states.push_back(static_cast<std::uint8_t>(frame.status_of_interface(i)));
        }
    }
    for (std::size_t k = 0; k < frame.obstacle_position.size(); ++k)
        add(obstacles, frame.obstacle_position[k] + frame.obstacle_displacement[k]);
    sizes = {static_cast<std::int32_t>(corners.size() / 2), static_cast<std::int32_t>(states.size()),
             frame.n_obstacles(), frame.n_outline()};
}

/// Calls work() and turns what it throws into an answer with a text.
Answer answer(const auto& work) {
    text.clear();
    try {
        return work();
    } catch (const UserError& error) {
        for (const Diagnostic& one : error.diagnostics) text += format(one);
        run.reset();
        return answer_bad_scenario;
    } catch (const std::bad_alloc&) {
        text += "out of memory: increase mesh.size\n";
        run.reset();
        return answer_failed;
    } catch (const std::exception& error) {
        text += std::string(error.what()) + "\n";
        return answer_failed;
    }
}

}  // namespace

KNAP_FOR_PAGE(knap_memory) char* knap_memory(std::int32_t size) {
    static std::string memory;
    memory.resize(size);
    return memory.data();
}

/// Reads, meshes and checks the scenario in the `size` bytes at `toml`. Warnings are in the text.
KNAP_FOR_PAGE(knap_start) int knap_start(const char* toml, std::int32_t size) {
    return answer([&] {
        run.reset();  // two of them need memory
        run = std::make_unique<PageRun>(std::string(toml, size));
        return answer_running;
    });
}

/// Steps for about so many milliseconds, or up to the time `until` [s].
KNAP_FOR_PAGE(knap_advance) int knap_advance(double milliseconds, double until) {
    return answer([&] {
        const Stopwatch watch;
        do {
            if (run->is_over()) {
                run->finish();
                return answer_done;
            }
            run->step();
        } while (watch.wall() < milliseconds / 1000 && run->time() < until);
        return answer_running;
    });
}

/// Whether there is a state to show: not after errors of a scenario.
KNAP_FOR_PAGE(knap_has_run) int knap_has_run() { return run != nullptr; }
/// Fills the arrays and numbers below; displacements are drawn `deform` times as large.
KNAP_FOR_PAGE(knap_show) void knap_show(double deform) { run->show(deform); }
KNAP_FOR_PAGE(knap_summary) void knap_summary() { text = run->summary(); }

KNAP_FOR_PAGE(knap_text) const char* knap_text() { return text.c_str(); }
KNAP_FOR_PAGE(knap_numbers) const Numbers* knap_numbers() {
    numbers = run->numbers();
    return &numbers;
}
KNAP_FOR_PAGE(knap_sizes) const Sizes* knap_sizes() { return &sizes; }
KNAP_FOR_PAGE(knap_corners) const float* knap_corners() { return corners.data(); }
KNAP_FOR_PAGE(knap_stress) const float* knap_stress() { return tensions.data(); }
KNAP_FOR_PAGE(knap_cracks) const float* knap_cracks() { return cracks.data(); }
KNAP_FOR_PAGE(knap_states) const std::uint8_t* knap_states() { return states.data(); }
KNAP_FOR_PAGE(knap_obstacles) const float* knap_obstacles() { return obstacles.data(); }

}  // namespace knap
