// knap bench: the edge-cracked block as fixed work. Prints triangle-steps per core-second, all interface work included, ratios of one run, and what
// the kernels of a step take against what the machine could do.
#include "app/bench_beside.hpp"
#include "app/bench_machine.hpp"
#include "app/commands.hpp"
#include "app/new_file.hpp"
#include "app/run/step_plan.hpp"
#include "app/run/threads.hpp"
#include "base/stopwatch.hpp"
#include "element/elastic_forces.hpp"
#include "stepper/explicit/mesh_blocks.hpp"
#include "stepper/moreau_jean.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace knap {
namespace {

/// What was measured, by name: printed by those who measure, written at the end.
class Table {
public:
    void add(const std::string& name, double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%.6g", value);
        text_ += name + "," + text + "\n";
    }
    const std::string& text() const { return text_; }

private:
    std::string text_ = "quantity,value\n";
};

/// FNV-1a over the bits of the state.
std::uint64_t hash_of(const State& state) {
    std::uint64_t hash = 14695981039346656037ull;
    const auto add = [&](double value) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        for (int i = 0; i < 8; ++i) hash = (hash ^ (bits >> 8 * i & 255)) * 1099511628211ull;
    };
    for (const Vec2& u : state.displacement) add(u.x()), add(u.y());
    for (const Vec2& v : state.velocity) add(v.x()), add(v.y());
    for (const PointState& p : state.points) add(p.cohesion);
    return hash;
}

ReadResult block_of(double size, bool cracked) {
    char override_size[64];
    std::snprintf(override_size, sizeof override_size, "mesh.size=%.9g", size);
    std::vector<std::string> overrides{override_size};
    if (!cracked) overrides.emplace_back("domain.crack=[]");
    return read_scenario_text(built_in_scenario("edge_cracked_block"), "edge_cracked_block", overrides);
}

constexpr int n_trials = 3;

/// The block, its steps, and the time that they take.
class Block {
public:
    explicit Block(double size, bool cracked = true) : read_(block_of(size, cracked)), model_(model_of(read_)), stepper_(model_), now_(initial_state(model_)), next_(now_) {
        step_ = plan_steps(read_.scenario, stepper_.stable_step(), read_.scenario.time.end).limits.largest;
    }
    struct Times {
        double cpu, wall;  // [s]
    };
    /// From the start; the best of some, since others may use the machine too.
    Times run(double until) {
        Times best{INFINITY, INFINITY};
        for (int trial = 0; trial < n_trials; ++trial) {
            now_ = initial_state(model_);
            n_solves_ = 0;
            const Stopwatch watch;
            for (const std::int64_t end = steps_to(until); now_.n_steps < end; std::swap(now_, next_)) n_solves_ += stepper_.step(now_, step_, next_).fan_solves;
            best = {.cpu = std::min(best.cpu, watch.cpu()), .wall = std::min(best.wall, watch.wall())};
        }
        return best;
    }
    double work(double until) const { return static_cast<double>(steps_to(until)) * model_.mesh.n_triangles(); }  // triangle-steps
    double n_solves() const { return static_cast<double>(n_solves_); }  // of the last run, of fans that are apart
    const Model& model() const { return model_; }
    const State& now() const { return now_; }

private:
    std::int64_t steps_to(double time) const { return static_cast<std::int64_t>(std::ceil(time / step_ * (1 - 1e-9))); }

    ReadResult read_;
    Model model_;
    MoreauJean stepper_;
    State now_, next_;
    std::int64_t n_solves_ = 0;
    double step_ = 0;
};

struct Measured {
    double per_core_second, wall;
    std::uint64_t hash;
};

Measured measure(double size, double until, int threads, Table& table) {
    use_threads(threads);
    const Stopwatch meshing;
    Block block(size);
    const double making = meshing.cpu();
    const Block::Times times = block.run(until);
    const Measured measured{.per_core_second = block.work(until) / times.cpu, .wall = times.wall, .hash = hash_of(block.now())};
    const int n = block.model().mesh.n_triangles();
    std::printf("%9d triangles  %d thread%s %7lld steps  %.3g triangle-steps/core-second  wall %.2f s  mesh and model %.2f s  fans apart %5zu  hash %016llx\n", n,
                threads, threads == 1 ? " " : "s", static_cast<long long>(block.now().n_steps), measured.per_core_second, measured.wall, making,
                block.now().split_fans.size(), static_cast<unsigned long long>(measured.hash));
    char name[80];
    std::snprintf(name, sizeof name, "%d triangles to %.3g us with %d threads", n, 1e6 * until, threads);
    table.add(std::string(name) + ": triangle-steps per core-second", measured.per_core_second);
    table.add(std::string(name) + ": mesh and model [s]", making);
    return measured;
}

/// What a frame and a figure cost, as they are after some steps.
void measure_output(double size, double until, Table& table) {
    Block block(size);
    block.run(until);
    const OutputTimes times = time_output(block.model(), block.now());
    const int n = block.model().mesh.n_triangles();
    std::printf("%9d triangles  a frame of fields %.4f s  a figure %.3f s\n", n, times.frame, times.figure);
    table.add(std::to_string(n) + " triangles: a frame of fields [s]", times.frame);
    table.add(std::to_string(n) + " triangles: a figure [s]", times.figure);
}

void measure_implicit(Table& table) {
    const ImplicitWork work = implicit_work();
    const auto of = [&](std::int64_t n) { return static_cast<double>(n); };
    std::printf("implicit bulk and cohesion, 1 mm, to 40 us: %lld steps, %.3g s each: %.3g solves, %.3g factors a step, %.3g ms a solve; factor of %lld unknowns: %lld entries\n",
                static_cast<long long>(work.steps), work.seconds / of(work.steps), of(work.linear_solves) / of(work.steps), of(work.factorisations) / of(work.steps),
                1e3 * work.seconds / of(work.linear_solves), static_cast<long long>(work.unknowns), static_cast<long long>(work.entries));
    table.add("implicit 1 mm to 40 us: steps", of(work.steps));
    table.add("implicit 1 mm to 40 us: a step [s]", work.seconds / of(work.steps));
    table.add("implicit 1 mm to 40 us: linear solves a step", of(work.linear_solves) / of(work.steps));
    table.add("implicit 1 mm to 40 us: factorisations a step", of(work.factorisations) / of(work.steps));
    table.add("implicit 1 mm to 40 us: all that a solve takes [ms]", 1e3 * work.seconds / of(work.linear_solves));
    table.add("implicit 1 mm to 40 us: unknowns of the factor", of(work.unknowns));
    table.add("implicit 1 mm to 40 us: entries of the factor", of(work.entries));
}

/// [s] of processor time for the forces of all triangles, block by block as in a step; the best of many.
double time_of_forces(const Model& model, const State& state) {
    ElasticForces forces(model.mesh, model.materials, model.plane, model.thickness);
    const std::vector<MeshBlock> blocks = make_blocks(model);
    std::vector<Vec2> force(model.mesh.corners_per_triangle() * blocks.front().last);
    std::vector<std::uint8_t> candidate(model.fans.size(), 0);
    double best = INFINITY;
    for (int trial = 0; trial < 20; ++trial) {
        const Stopwatch watch;
        for (const MeshBlock& block : blocks)
            forces.evaluate(block.first, block.last, state.displacement, state.node_of_corner, force.data(), candidate);
        best = std::min(best, watch.cpu());
    }
    return best;
}

/// Bytes that a triangle-step moves to and from memory where no cache holds the body, and its operations, counted in the source.
struct Kernel {
    const char* name;
    double seconds, bytes, flops;  // per triangle-step
};

void print(const Kernel& kernel, const Machine& machine, Table& table) {
    const double by_memory = kernel.bytes / machine.bytes, by_flops = kernel.flops / machine.flops;
    std::printf("  %-28s %6.2f ns  %4.0f bytes  %4.0f flops   at least %5.2f ns by memory, %5.2f ns by flops: %3.0f %% of the bound\n", kernel.name,
                1e9 * kernel.seconds, kernel.bytes, kernel.flops, 1e9 * by_memory, 1e9 * by_flops, 100 * std::max(by_memory, by_flops) / kernel.seconds);
    table.add(std::string(kernel.name) + " [ns a triangle-step]", 1e9 * kernel.seconds);
    table.add(std::string(kernel.name) + " [part of the bound]", std::max(by_memory, by_flops) / kernel.seconds);
}

/// What a step consists of: of a block without a crack, before anything is near its strength, forces and motion; what more a cracked one takes is the
/// interfaces.
void measure_kernels(double size, double until, const Machine& machine, Table& table) {
    use_threads(1);
    constexpr double quiet = 5e-6;  // the waves of the loads have not met yet
    Block whole(size, false), cracked(size);
    const int n = whole.model().mesh.n_triangles();
    const double both = whole.run(quiet).cpu / whole.work(quiet), forces = time_of_forces(whole.model(), whole.now()) / n;
    const double all = cracked.run(until).cpu / cracked.work(until), solves = cracked.n_solves() / cracked.work(until);
    std::printf("a triangle-step of %d triangles on one thread; the machine: %.3g bytes/s, %.3g flops/s\n", n, machine.bytes, machine.flops);
    table.add(std::to_string(n) + " triangles, kernels of a triangle-step to [us]", 1e6 * until);
    // material 48, nodes 12, half a displacement 8; the forces on the corners stay in the cache
    print({"forces, stress criterion", forces, 68, 52}, machine, table);
    // half of: lists 28, partition 5, velocity and displacement read and written 64, and read before they are written 32
    print({"motion, ledger", both - forces, 65, 19}, machine, table);
    print({"both", both, 133, 71}, machine, table);
    std::printf("  %-28s %6.2f ns  mean to %.3g us: tests of candidate fans, %.3g fans apart a step; at most %.0f ns for one of these\n", "interfaces", 1e9 * (all - both),
                1e6 * until, solves * n, 1e9 * (all - both) / solves);
    table.add("interfaces [ns a triangle-step]", 1e9 * (all - both));
    table.add("interfaces [ns a fan that is apart]", 1e9 * (all - both) / solves);
}

}  // namespace

ExitCode bench(const BenchOptions& options) {
    if (!options.csv.empty()) refuse_existing(options.csv, "choose another name, or take it away first");
    const double until = options.full ? 80e-6 : options.until;
    Table table;
    std::printf("edge_cracked_block to %.3g s, default step\n", until);
    const Measured coarse = measure(1e-3, until, 1, table);
    const Measured block = measure(0.5e-3, until, 1, table);
    const Measured twice = measure(0.5e-3, until, 2, table);
    const auto ratio = [&](const std::string& name, double value) {
        std::printf("ratio  %-50s %.3f\n", (name + ":").c_str(), value);
        table.add(name, value);
    };
    ratio("cost of a triangle-step, 0.5 mm to 1 mm", coarse.per_core_second / block.per_core_second);
    ratio("wall time, 1 thread to 2", block.wall / twice.wall);
    ratio("one processor sees what the other wrote after [ns]", 1e9 * handover_time());
    std::printf("same bits with 1 and 2 threads:                     %s\n", block.hash == twice.hash ? "yes" : "NO");
    if (options.full) {
        constexpr double early = 4e-6;
        const Measured late = measure(0.25e-3, until, 1, table);
        ratio("cost of a triangle-step, 0.25 mm to 1 mm", coarse.per_core_second / late.per_core_second);
        const Measured small = measure(1e-3, early, 1, table), middle = measure(0.5e-3, early, 1, table), large = measure(0.25e-3, early, 1, table);
        const Measured million = measure(0.0972e-3, 1e-6, 1, table);
        ratio("cost before the crack runs, 0.5 mm to 1 mm", small.per_core_second / middle.per_core_second);
        ratio("cost before the crack runs, 0.25 mm to 1 mm", small.per_core_second / large.per_core_second);
        ratio("cost before the crack runs, 0.1 mm to 1 mm", small.per_core_second / million.per_core_second);
        measure_output(0.5e-3, 20e-6, table);
        measure_output(0.0972e-3, 0, table);
        measure_implicit(table);
    }
    const Machine machine = measure_machine();
    table.add("machine [bytes/s]", machine.bytes), table.add("machine [flops/s]", machine.flops);
    measure_kernels(0.5e-3, until, machine, table);
    if (options.full) measure_kernels(0.25e-3, 20e-6, machine, table);
    if (!options.csv.empty()) write_new_file(options.csv, table.text());
    return block.hash == twice.hash ? exit_done : exit_failed;
}

}  // namespace knap
