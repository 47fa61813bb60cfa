// knap bench: the edge-cracked block as fixed work. Prints triangle-steps per core-second with all interface work,
// ratios within one run, and the time of the kernels of a step compared with the capacity of the machine.
#include "app/bench_contact.hpp"
#include "app/commands.hpp"
#include "app/setup/process.hpp"
#include "app/setup/setup.hpp"
#include "app/setup/step_plan.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "element/elastic_forces.hpp"
#include "figures/canvas.hpp"
#include "figures/figures.hpp"
#include "output/vtk_series.hpp"
#include "stepper/explicit/mesh_blocks.hpp"
#include "stepper/moreau_jean.hpp"

#include <omp.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace knap {
namespace {

constexpr int n_trials = 3;

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

Scenario built_in(const std::string& name, const std::vector<std::string>& overrides) {
    return read_scenario_text(built_in_scenario(name).text, name, overrides).scenario;
}

// ---- the machine, by one thread with the compiler and flags of the program

constexpr double long_enough = 0.3;  // [s] of trials: on a busy machine some of them are alone

/// [byte/s] By a = b + s c over three arrays that take up `footprint` [byte] together, which decides in which cache
/// they are: 32 bytes per entry, since a line that is written is read first.
double memory_rate(double footprint) {
    const auto n = static_cast<Index>(footprint / 24);
    Eigen::ArrayXd a = Eigen::ArrayXd::Zero(n), b = Eigen::ArrayXd::Ones(n), c = Eigen::ArrayXd::Constant(n, 2);
    double best = 0;
    const Stopwatch all;
    for (int trial = 0; all.wall() < long_enough; ++trial) {
        const Stopwatch watch;
        a = b + static_cast<double>(trial) * c;
        best = std::max(best, 32.0 * n / one_thread_time(watch));
        b[trial % n] = a[n - 1 - trial % n];  // prevents elimination of the loop
    }
    return best;
}

struct Two {
    typedef double Lanes __attribute__((vector_size(16)));
};
struct Four {
    typedef double Lanes __attribute__((vector_size(32)));
};
/// [1/s] Independent multiplications and additions in registers of so many numbers.
template <class Register>
[[gnu::always_inline]] inline double flop_rate_of() {
    using Lanes = typename Register::Lanes;
    constexpr int n_chains = 12;  // as many as the registers hold; fewer would wait for each other
    double best = 0, sum = 0;
    const Stopwatch all;
    for (int trial = 0; all.wall() < long_enough; ++trial) {
        Lanes x[n_chains];
        for (int i = 0; i < n_chains; ++i) x[i] = Lanes{} + (i + trial);
        const Lanes factor = Lanes{} + (0.5 + 1e-6 * trial), added = Lanes{} + 0.25;
        constexpr int n = 100000;
        const Stopwatch watch;
        for (int k = 0; k < n; ++k) {
#pragma GCC unroll 12  // else they are not in registers
            for (int i = 0; i < n_chains; ++i) x[i] = factor * x[i] + added;
        }
        best = std::max(best, 2.0 * sizeof(Lanes) / sizeof(double) * n_chains * n / one_thread_time(watch));
        for (const Lanes& chain : x) sum += chain[0];
    }
    return sum > 0 ? best : 0;
}
#ifdef __x86_64__
[[gnu::target("avx2")]] double flop_rate_of_avx2() { return flop_rate_of<Four>(); }
#endif
/// Of the widest registers that the kernels use.
double flop_rate() {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) return flop_rate_of_avx2();
#endif
    return flop_rate_of<Two>();
}

/// [s] Until one processor sees a value that another one wrote, the best mean of 1000 alternating writes: some 30 ns
/// with a common cache, more than 100 ns without; 0 with one processor.
double handover_time() {
    alignas(64) static std::atomic<int> turn;
    constexpr int n_turns = 1000;
    double best = INFINITY;
    for (int trial = 0; trial < 50 && omp_get_num_procs() > 1; ++trial) {
        turn.store(-2);
#pragma omp parallel num_threads(2)
        if (omp_get_num_threads() == 2) {
            const int mine = omp_get_thread_num();
            turn.fetch_add(1);
            while (turn.load() < 0) {
            }  // the other thread has started
            const double start = omp_get_wtime();
            for (int i = mine; i < n_turns; i += 2) {
                while (turn.load() != i) {
                }
                turn.store(i + 1);
            }
            if (mine == 0) best = std::min(best, (omp_get_wtime() - start) / n_turns);
        }
    }
    return std::isfinite(best) ? best : 0;
}

// ---- the block

/// The block, its steps, and the time that they take.
class Block {
public:
    using Overrides = std::vector<std::string>;
    explicit Block(double size, bool cracked = true, bool large_rotation = false, const Overrides& others = {})
        : scenario_(scenario_of(size, cracked, large_rotation, others)) {}
    struct Times {
        double cpu, wall;  // [s]
    };
    /// From the start; the best of some trials, since others may use the machine too.
    Times run(double until) {
        Times best{INFINITY, INFINITY};
        for (int trial = 0; trial < n_trials; ++trial) {
            now = initial_state(model);
            n_solves = 0;
            const Stopwatch watch;
            for (const std::int64_t end = steps_to(until); now.n_steps < end; std::swap(now, next_))
                n_solves += static_cast<double>(stepper_.step(now, step_, next_).fan_solves);
            const double cpu = omp_get_max_threads() == 1 ? one_thread_time(watch) : watch.cpu();
            best = {.cpu = std::min(best.cpu, cpu), .wall = std::min(best.wall, watch.wall())};
        }
        return best;
    }
    /// Triangle-steps.
    double work(double until) const { return static_cast<double>(steps_to(until)) * model.mesh.n_triangles(); }

private:
    Scenario scenario_;

public:
    const Model model = build_model(scenario_);
    State now = initial_state(model);
    double n_solves = 0;  // of vertices that have split, in the last run

private:
    static Scenario scenario_of(double size, bool cracked, bool large_rotation, const Overrides& others) {
        Overrides overrides{formatted("mesh.size=%.9g", size)};
        if (!cracked) overrides.emplace_back("domain.crack=[]");
        if (large_rotation) overrides.emplace_back("domain.rotation=large");
        overrides.insert(overrides.end(), others.begin(), others.end());
        return built_in("edge_cracked_block", overrides);
    }
    std::int64_t steps_to(double time) const { return static_cast<std::int64_t>(std::ceil(time / step_ * (1 - 1e-9))); }

    MoreauJean stepper_{model};
    State next_ = now;
    double step_ = plan_steps(scenario_.time, stepper_.stable_step(), scenario_.time.end).limits.largest;  // [s]
};

/// [s] Processor time of the forces of all triangles, block by block as in a step; the best of many trials.
double time_of_forces(const Model& model, const State& state) {
    ElasticForces forces(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation);
    const std::vector<MeshBlock> blocks = make_blocks(model);
    std::vector<Vec2> force(model.mesh.corners_per_triangle() * blocks.front().last);
    std::vector<std::uint8_t> candidate(model.fans.size(), 0);
    double best = INFINITY;
    for (int trial = 0; trial < 20; ++trial) {
        const Stopwatch watch;
        for (const MeshBlock& block : blocks)
            forces.evaluate(block.first, block.last, state.displacement, state.node_of_corner, force.data(), candidate);
        best = std::min(best, one_thread_time(watch));
    }
    return best;
}

/// A directory that is removed with its contents.
struct TemporaryDirectory {
    ~TemporaryDirectory() {
        std::error_code error;
        std::filesystem::remove_all(path, error);
    }
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("knap_bench_" + std::to_string(getpid()));
};

struct Measured {
    double per_core_second, wall;
    std::uint64_t hash;
};

/// The measurements; each is printed at once and collected in a table.
struct Bench {
    std::string table = "quantity,value\n";

    void add(const std::string& name, double value) { table += '"' + name + '"' + formatted(",%.6g\n", value); }

    void ratio(const char* name, double value) {
        std::printf("ratio  %-50s %.3f\n", (std::string(name) + ":").c_str(), value);
        add(name, value);
    }

    Measured measure(double size, double until, int threads) {
        use_threads(threads);
        const Stopwatch meshing;
        Block block(size);
        const double making = meshing.cpu();
        const Block::Times times = block.run(until);
        const Measured measured{
            .per_core_second = block.work(until) / times.cpu, .wall = times.wall, .hash = hash_of(block.now)};
        const int n = block.model.mesh.n_triangles();
        std::printf(
            "%9d triangles  %d thread%s %7lld steps  %.3g triangle-steps/core-second  wall %.2f s  mesh and model %.2f "
            "s  fans apart %5zu  hash %016llx\n",
            n, threads, threads == 1 ? " " : "s", static_cast<long long>(block.now.n_steps), measured.per_core_second,
            measured.wall, making, block.now.split_fans.size(), static_cast<unsigned long long>(measured.hash));
        const std::string name = formatted("%d triangles to %.3g us with %d threads", n, 1e6 * until, threads);
        add(name + ": triangle-steps per core-second", measured.per_core_second);
        add(name + ": mesh and model [s]", making);
        return measured;
    }

    /// A frame (gathered and written) and a figure of the cracks, after some steps.
    void measure_output(double size, double until) {
        Block block(size);
        block.run(until);
        const TemporaryDirectory directory;
        VtkSeries series(directory.path);
        double frame_time = INFINITY, figure_time = INFINITY;
        for (int trial = 0; trial < n_trials; ++trial) {
            const Stopwatch writing;
            const Frame frame = make_frame(block.model, block.now, false);
            series.write(frame);
            frame_time = std::min(frame_time, one_thread_time(writing));
            const Stopwatch drawing;
            draw_figure({.file = "cracks.png"}, frame, {}, {}, directory.path);
            figure_time = std::min(figure_time, one_thread_time(drawing));
        }
        const int n = block.model.mesh.n_triangles();
        std::printf("%9d triangles  a frame of fields %.4f s  a figure %.3f s\n", n, frame_time, figure_time);
        add(formatted("%d triangles: a frame of fields [s]", n), frame_time);
        add(formatted("%d triangles: a figure [s]", n), figure_time);
    }

    /// The block at 1 mm with both schemes implicit and ten times the stable step of the explicit bulk, to 40 us.
    void measure_implicit() {
        const Scenario scenario =
            built_in("edge_cracked_block_implicit", {"mesh.size=0.001", "time.end=4e-5", "time.step=\"10 CFL\""});
        const Model model = build_model(scenario);
        MoreauJean stepper(model, scenario.time.scheme);
        StepControl control(plan_steps(scenario.time, scenario.adapt, model, scenario.time.end).limits);
        State now = initial_state(model), next = now;
        StepReport all;
        const Stopwatch watch;
        while (!StepControl::has_reached(now, scenario.time.end) && !control.is_stuck()) {
            const double h = control.next(now);
            const StepReport report = stepper.step(now, h, next);
            all.linear_solves += report.linear_solves, all.factorisations += report.factorisations;
            if (!control.judge(now, h, report)) std::swap(now, next);
        }
        const double seconds = watch.cpu(), steps = static_cast<double>(now.n_steps),
                     solves = static_cast<double>(all.linear_solves), factors = static_cast<double>(all.factorisations);
        const auto [unknowns, entries] = stepper.factor_size();
        std::printf(
            "implicit bulk and cohesion, 1 mm, to 40 us: %.0f steps, %.3g s each: %.3g solves, %.3g factors a step, "
            "%.3g ms a solve; factor of %lld unknowns: %lld entries\n",
            steps, seconds / steps, solves / steps, factors / steps, 1e3 * seconds / solves,
            static_cast<long long>(unknowns), static_cast<long long>(entries));
        for (const auto& [name, value] : {std::pair{"steps", steps},
                                          {"a step [s]", seconds / steps},
                                          {"linear solves a step", solves / steps},
                                          {"factorisations a step", factors / steps},
                                          {"all that a solve takes [ms]", 1e3 * seconds / solves},
                                          {"unknowns of the factor", static_cast<double>(unknowns)},
                                          {"entries of the factor", static_cast<double>(entries)}})
            add(std::string("implicit 1 mm to 40 us: ") + name, value);
    }

    /// A kernel per triangle-step of n triangles: [s], bytes to and from the cache or memory that holds the body,
    /// operations; both counted in the source.
    void kernel(const char* name, double seconds, int n, double n_bytes, double n_flops) {
        const double bytes = memory_rate(n * n_bytes), flops = flop_rate(), by_memory = n_bytes / bytes,
                     by_flops = n_flops / flops, bound = std::max(by_memory, by_flops);
        std::printf(
            "  %-28s %6.2f ns  %4.0f bytes  %4.0f flops   at least %5.2f ns by memory, %5.2f ns by flops: %3.0f %% of "
            "the bound\n",
            name, 1e9 * seconds, n_bytes, n_flops, 1e9 * by_memory, 1e9 * by_flops, 100 * bound / seconds);
        add(std::string(name) + " [ns a triangle-step]", 1e9 * seconds);
        add(std::string(name) + " [part of the bound]", bound / seconds);
        add(std::string(name) + ": machine [bytes/s]", bytes), add(std::string(name) + ": machine [flops/s]", flops);
    }

    /// The parts of a step: forces and motion of a block without a crack, before any point is near its strength; the
    /// additional time of a cracked one is that of the interfaces.
    void measure_kernels(double size, double until) {
        use_threads(1);
        constexpr double quiet = 5e-6;  // [s] the waves of the loads have not met yet
        Block whole(size, false), cracked(size), turning(size, false, true);
        const int n = whole.model.mesh.n_triangles();
        const double both = whole.run(quiet).cpu / whole.work(quiet),
                     forces = time_of_forces(whole.model, whole.now) / n;
        const double turning_both = turning.run(quiet).cpu / turning.work(quiet),
                     turning_forces = time_of_forces(turning.model, turning.now) / n;
        const double all = cracked.run(until).cpu / cracked.work(until),
                     solves = cracked.n_solves / cracked.work(until);
        std::printf("a triangle-step of %d triangles on one thread\n", n);
        add(formatted("%d triangles, kernels of a triangle-step to [us]", n), 1e6 * until);
        // material 48, nodes 12, half a displacement 8; the forces on the corners stay in the cache
        kernel("forces, stress criterion", forces, n, 68, 52);
        // half of: lists 28, partition 5, velocity and displacement read and written 64, and read before writing 32
        kernel("motion, ledger", both - forces, n, 65, 19);
        kernel("both", both, n, 133, 71);
        std::printf(
            "  %-28s %6.2f ns  mean to %.3g us: tests of candidate fans, %.3g fans apart a step; at most %.0f ns for "
            "one of these\n",
            "interfaces", 1e9 * (all - both), 1e6 * until, solves * n, solves > 0 ? 1e9 * (all - both) / solves : 0);
        add("interfaces [ns a triangle-step]", 1e9 * (all - both));
        if (solves > 0) add("interfaces [ns a fan that is apart]", 1e9 * (all - both) / solves);
        ratio("forces, large rotations to small ones", turning_forces / forces);
        ratio("forces and motion, large rotations to small ones", turning_both / both);
    }

    void measure_contacts() {
        use_threads(1);
        Block elastic(1e-3, true, true), with_contact(1e-3, true, true, {"contact={}"}),
            viscous(1e-3, true, true, {"material.glass.bulk_viscosity=[0, 1.2]", "material.glass.shear_viscosity=0.1"});
        const double until = 20e-6, n_elastic = elastic.work(until), n_viscous = viscous.work(until),
                     without = viscous.run(until).cpu / n_viscous;
        ratio("a step with the viscosity that [contact] has by default",
              without / (elastic.run(until).cpu / n_elastic));
        ratio("a step with [contact] where hardly any faces meet", with_contact.run(until).cpu / n_viscous / without);
        for (const Measurement& of : measure_contact()) ratio(of.name.c_str(), of.value);
    }
};

}  // namespace

ExitCode bench(const BenchOptions& options) {
    if (!options.csv.empty()) refuse_existing(options.csv, "choose another name, or remove it first");
    const double until = options.full ? 80e-6 : options.until;
    Bench bench;
    std::printf("edge_cracked_block to %.3g s, default step\n", until);
    const Measured coarse = bench.measure(1e-3, until, 1), block = bench.measure(0.5e-3, until, 1),
                   twice = bench.measure(0.5e-3, until, 2);
    bench.ratio("cost of a triangle-step, 0.5 mm to 1 mm", coarse.per_core_second / block.per_core_second);
    bench.ratio("wall time, 1 thread to 2", block.wall / twice.wall);
    if (const double handover = handover_time(); handover > 0)
        bench.ratio("one processor sees what the other wrote after [ns]", 1e9 * handover);
    std::printf("same bits with 1 and 2 threads:                     %s\n", block.hash == twice.hash ? "yes" : "NO");
    if (options.full) {
        constexpr double early = 4e-6;
        const Measured late = bench.measure(0.25e-3, until, 1);
        bench.ratio("cost of a triangle-step, 0.25 mm to 1 mm", coarse.per_core_second / late.per_core_second);
        const Measured small = bench.measure(1e-3, early, 1), middle = bench.measure(0.5e-3, early, 1),
                       large = bench.measure(0.25e-3, early, 1), million = bench.measure(0.0972e-3, 1e-6, 1);
        bench.ratio("cost before the crack runs, 0.5 mm to 1 mm", small.per_core_second / middle.per_core_second);
        bench.ratio("cost before the crack runs, 0.25 mm to 1 mm", small.per_core_second / large.per_core_second);
        bench.ratio("cost before the crack runs, 0.1 mm to 1 mm", small.per_core_second / million.per_core_second);
        bench.measure_output(0.5e-3, 20e-6);
        bench.measure_output(0.0972e-3, 0);
        bench.measure_implicit();
    }
    bench.measure_kernels(0.5e-3, until);
    if (options.full) bench.measure_kernels(0.25e-3, 20e-6);
    bench.measure_contacts();
    if (!options.csv.empty()) write_new_file(options.csv, bench.table);
    return block.hash == twice.hash ? exit_done : exit_failed;
}

}  // namespace knap
