// knap bench: the edge-cracked block as fixed work. Prints triangle-steps per core-second, all interface work included, and ratios of one run.
#include "app/commands.hpp"
#include "app/step_plan.hpp"
#include "app/threads.hpp"
#include "base/stopwatch.hpp"
#include "stepper/moreau_jean.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace knap {
namespace {

struct Measured {
    double per_core_second, wall, mesh_wall, released;
    std::uint64_t hash;
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

Measured measure(double size, double until, int threads) {
    char override_size[64];
    std::snprintf(override_size, sizeof override_size, "mesh.size=%.9g", size);
    const ReadResult read = read_scenario_text(built_in_scenario("edge_cracked_block"), "edge_cracked_block", {override_size});
    use_threads(threads);
    const Stopwatch meshing;
    const Model model = model_of(read);
    const double mesh_wall = meshing.wall();
    MoreauJean stepper(model);
    const StepPlan plan = plan_steps(read.scenario, stepper.stable_step(), until);
    State now = initial_state(model), next = now;
    const Stopwatch watch;
    for (std::int64_t i = 0; i < plan.n_steps; ++i) stepper.step(now, plan.limits.largest, next), std::swap(now, next);
    const double work = static_cast<double>(plan.n_steps) * model.mesh.n_triangles();
    const Measured measured{.per_core_second = work / watch.cpu(),
                            .wall = watch.wall(),
                            .mesh_wall = mesh_wall,
                            .released = static_cast<double>(now.split_fans.size()),
                            .hash = hash_of(now)};
    std::printf("%9d triangles  %d thread%s %7lld steps  %.3g triangle-steps/core-second  wall %.2f s  mesh and model %.2f s  fans apart %5.0f  hash %016llx\n",
                model.mesh.n_triangles(), threads, threads == 1 ? " " : "s", static_cast<long long>(plan.n_steps), measured.per_core_second,
                measured.wall, measured.mesh_wall, measured.released, static_cast<unsigned long long>(measured.hash));
    return measured;
}

}  // namespace

ExitCode bench(const BenchOptions& options) {
    const double until = options.full ? 80e-6 : options.until;
    std::printf("edge_cracked_block to %.3g s, default step\n", until);
    const Measured coarse = measure(1e-3, until, 1);
    const Measured block = measure(0.5e-3, until, 1);
    const Measured twice = measure(0.5e-3, until, 2);
    std::printf("ratio  cost of a triangle-step, 0.5 mm to 1 mm:    %.3f\n", coarse.per_core_second / block.per_core_second);
    std::printf("ratio  wall time, 1 thread to 2:                   %.3f\n", block.wall / twice.wall);
    std::printf("same bits with 1 and 2 threads:                    %s\n", block.hash == twice.hash ? "yes" : "NO");
    if (options.full) {
        const Measured fine = measure(0.25e-3, 20e-6, 1), same_time = measure(0.5e-3, 20e-6, 1);
        std::printf("ratio  cost of a triangle-step, 0.25 mm to 0.5 mm: %.3f\n", same_time.per_core_second / fine.per_core_second);
    }
    return block.hash == twice.hash ? exit_done : exit_failed;
}

}  // namespace knap
