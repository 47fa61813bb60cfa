// knap bench: what contact between free faces costs a step, in rubble, broken pieces and dust.
#include "app/bench_contact.hpp"

#include "app/setup/setup.hpp"
#include "app/setup/step_plan.hpp"
#include "base/random.hpp"
#include "scenario/read_scenario.hpp"
#include "stepper/contact/face_contacts.hpp"
#include "stepper/moreau_jean.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// Soft rock: the end of every scenario here. Its law goes on with one of the two below.
constexpr const char* rock = R"([material.rock]
density = "2400 kg/m3"
E       = "0.2 GPa"
nu      = 0.25
[contact]
[interface.default]
friction = 0.5
)";
/// It does not break.
constexpr const char* whole_rock = "breakable = false\n";
/// It breaks.
constexpr const char* breakable_rock = R"(sigma_c = "0.2 MPa"
G_c     = "100 J/m2"
)";

/// Fifty stones that do not break fall into a box; at 0.6 s all of them move, at 1.5 s they lie.
constexpr const char* rubble = R"(knap = 1
name = "rubble"
[domain]
rotation = "large"
[mesh]
size = "60 mm"
[[bodies]]
pattern = "heap"
box     = ["0 m", "0 m", "2 m", "3 m"]
size    = "0.25 m"
number  = 50
[[obstacle]]
shape  = "half plane"
at     = ["0 m", "0 m"]
normal = [0, 1]
friction = 0.5
[[obstacle]]
shape  = "half plane"
at     = ["-10 mm", "0 m"]
normal = [1, 0]
[[obstacle]]
shape  = "half plane"
at     = ["2.01 m", "0 m"]
normal = [-1, 0]
[[load]]
acceleration = ["0 m/s2", "-9.81 m/s2"]
[time]
end     = "1.5 s"
damping = "2 Hz"
)";

/// A block that falls into pieces on the ground: at 0.5 s they move, at 1.6 s they lie.
constexpr const char* breaking = R"(knap = 1
name = "breaking"
[domain]
rotation = "large"
[mesh]
size = "0.15 m"
[[body]]
name     = "block"
shape    = "rectangle"
size     = ["1.5 m", "1 m"]
velocity = ["0 m/s", "-2 m/s"]
[[obstacle]]
shape  = "half plane"
at     = ["0 m", "-1 mm"]
normal = [0, 1]
friction = 0.5
[[load]]
acceleration = ["0 m/s2", "-9.81 m/s2"]
[time]
end     = "2 s"
damping = "5 Hz"
)";

/// A block on a support that goes on beyond its ends.
constexpr const char* sliding = R"(knap = 1
name = "sliding"
[domain]
shape    = "rectangle"
size     = ["0.3 m", "0.2 m"]
rotation = "large"
[mesh]
size = "10 mm"
[time]
end = "1 s"
)";

/// [s] Of a call, the best of some trials.
template <class Call>
double time_of(int n_trials, const Call& call) {
    double best = INFINITY;
    for (int trial = 0; trial < n_trials; ++trial) {
        const Stopwatch watch;
        call();
        best = std::min(best, one_thread_time(watch));
    }
    return best;
}

Model without_contact(Model model) {
    model.contact_of_pair.clear();
    return model;
}

/// Pieces of a scenario that meet.
class Pieces {
public:
    explicit Pieces(const std::string& text) : scenario_(read_scenario_text(text, "pieces", {}).scenario) {}

    /// Adds what a contact costs in the steps to `until` [s] from 1000 steps before.
    void measure(double until, const std::string& name, std::vector<Measurement>& measured) {
        const StepLimits limits = plan_steps(scenario_.time, scenario_.adapt, model_, until).limits;
        StepControl control(limits);
        double with = 0, without = 0, contacts = 0, finding = 0, edges = 0;
        FaceContacts faces(model_);
        for (int n = 0; !StepControl::has_reached(now_, until);) {
            const double h = control.next(now_);
            if (now_.time > until - 1000 * limits.largest && n++ % 10 == 0) {  // the same step, taken both ways
                State alone = now_, end = now_;
                alone.face_contacts.clear();
                with += time_of(3, [&] { contacts_ = stepper_.step(now_, h, end).face_contacts; });
                without += time_of(3, [&] { of_free_.step(alone, h, end); });
                faces.find(now_, h);
                finding += time_of(3, [&] { faces.find(now_, h); });
                contacts += static_cast<double>(contacts_);
                edges += static_cast<double>(faces.boundary().edges().size());
            }
            const StepReport report = stepper_.step(now_, h, next_);
            if (!control.judge(now_, h, report)) std::swap(now_, next_);
        }
        measured.push_back({name + ": all work for a contact [ns]", 1e9 * (with - without) / contacts});
        measured.push_back({name + ": without detection [ns]", 1e9 * (with - without - finding) / contacts});
        measured.push_back({name + ": detection for a free edge [ns]", 1e9 * finding / edges});
    }

    /// [-] Processor time per simulated time until then.
    double cost(double until) {
        const StepLimits limits = plan_steps(scenario_.time, scenario_.adapt, model_, until).limits;
        StepControl control(limits);
        stepper_.resolve_islands(limits);
        if (now_.n_steps == 0) stepper_.begin(now_);
        const double start = now_.time;
        const Stopwatch watch;
        while (!StepControl::has_reached(now_, until)) {
            if (control.may_freeze(now_)) now_.motion = Motion::rigid;
            const double h = control.next(now_);
            const auto cut = control.judge(now_, h, stepper_.step(now_, h, next_));
            if (!cut || (cut->thaws && stepper_.thaw(now_, next_))) std::swap(now_, next_);
        }
        return one_thread_time(watch) / (until - start);
    }

private:
    Scenario scenario_;
    Model model_ = build_model(scenario_), free_ = without_contact(model_);
    MoreauJean stepper_{model_, scenario_.time.scheme}, of_free_{free_, scenario_.time.scheme};
    State now_ = initial_state(model_), next_ = now_;
    std::int64_t contacts_ = 0;
};

/// Triangles of the block, all of them apart by a tenth of their size, at random velocities.
void measure_dust(std::vector<Measurement>& measured) {
    const Scenario scenario = read_scenario_text(built_in_scenario("edge_cracked_block").text, "edge_cracked_block",
                                                 {"mesh.size=1 mm", "domain.rotation=large", "contact={}"})
                                  .scenario;
    const Model model = build_model(scenario);
    const Mesh& mesh = model.mesh;
    State state = initial_state(model);
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f)
        if (state.split_rank[f] < 0) split(model, f, state);
    std::ranges::fill(state.retired, Retirement::retired);
    Random random(1, "dust");
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Vec2 moved = 0.1 / 3 * (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2));
        const Vec2 velocity(random.uniform(-1, 1), random.uniform(-1, 1));
        for (Index k = 0; k < 3; ++k) {
            const Index node = state.node_of_corner[3 * t + k];
            state.displacement[node] = moved, state.velocity[node] = velocity;
        }
    }
    FaceContacts faces(model);
    const double h = 1e-7;  // [s] a thousandth of the way between two triangles
    faces.find(state, h);
    const auto n_edges = static_cast<double>(faces.boundary().edges().size());
    constexpr int n_steps = 500;
    const Stopwatch watch;
    for (int step = 0; step < n_steps; ++step) {
        for (std::size_t n = 0; n < state.displacement.size(); ++n) state.displacement[n] += h * state.velocity[n];
        faces.find(state, h);
    }
    measured.push_back({"dust: detection for a free edge [ns]", 1e9 * one_thread_time(watch) / (n_steps * n_edges)});
}

/// A block that slides over a ground of 40 000 edges, of which it touches about thirty: it reaches a new one every
/// fifty steps, and repeats the search meanwhile.
void measure_ground(std::vector<Measurement>& measured) {
    const auto time_of_find = [](const std::string& beyond, double& n_edges) {
        const Scenario scenario = read_scenario_text(std::string(sliding) + rock + whole_rock, "sliding",
                                                     {"support=[{on = \"bottom\", beyond = \"" + beyond + "\"}]"})
                                      .scenario;
        const Model model = build_model(scenario);
        State state = initial_state(model);
        for (Index p = 0; p < model.n_points(); ++p)
            state.retired[p] = model.ground.of_point[p] >= 0 ? Retirement::retired : Retirement::none;
        std::ranges::fill(state.velocity, Vec2(2, 0));
        FaceContacts faces(model);
        const double h = 1e-5;  // [s]
        faces.find(state, h);
        n_edges = static_cast<double>(faces.boundary().edges().size());
        constexpr int n_steps = 2000;
        const Stopwatch watch;
        for (int step = 0; step < n_steps; ++step) {
            for (std::size_t n = 0; n < state.displacement.size(); ++n) state.displacement[n] += h * state.velocity[n];
            faces.find(state, h);
        }
        return one_thread_time(watch) / n_steps;
    };
    double few = 0, many = 0;
    const double without = time_of_find("1 m", few), with = time_of_find("200 m", many);
    measured.push_back(
        {"ground: detection for an edge of it that nothing is near [ns]", 1e9 * (with - without) / (many - few)});
    measured.push_back({"ground: detection with 40 000 edges to 200 of them", with / without});
}

}  // namespace

double one_thread_time(const Stopwatch& watch) {
    static const bool is_coarse = [] {
        const auto now = [] { return Stopwatch::seconds(CLOCK_PROCESS_CPUTIME_ID); };
        const double start = now();
        double then = start;
        while (then == start) then = now();
        return then - start > 1e-5;
    }();
    return is_coarse ? watch.wall() : watch.cpu();
}

std::vector<Measurement> measure_contact() {
    std::vector<Measurement> measured;
    Pieces stones(std::string(rubble) + rock + whole_rock);
    stones.measure(0.6, "rubble in motion", measured);
    Pieces rigid(std::string(rubble) + rock + whole_rock + "[rigid]\n");
    rigid.cost(0.6);
    measured.push_back({"rubble in motion: deformable over rigid pieces", stones.cost(0.62) / rigid.cost(0.7)});
    stones.measure(1.5, "rubble at rest", measured);
    Pieces broken(std::string(breaking) + rock + breakable_rock),
        islands(std::string(breaking) + rock + breakable_rock + "[rigid]\n");
    measured.push_back({"block that breaks: deformable over rigid pieces", broken.cost(0.1) / islands.cost(0.1)});
    broken.measure(0.5, "broken pieces in motion", measured);
    islands.cost(0.5);
    measured.push_back(
        {"broken pieces in motion: deformable over rigid pieces", broken.cost(0.52) / islands.cost(0.6)});
    broken.measure(1.6, "broken pieces at rest", measured);
    measure_dust(measured);
    measure_ground(measured);
    return measured;
}

}  // namespace knap
