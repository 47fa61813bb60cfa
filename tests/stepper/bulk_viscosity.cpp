// Artificial viscosity: decay of a standing wave, energy balance, stable step, rigid spin, threads.
#include "element/triangle_matrices.hpp"
#include "properties/wild_body.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace bulk_viscosity_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double pi = 3.14159265358979324;

ModelInput body_of(Mesh mesh, std::array<double, 2> bulk, double shear, PlaneModel plane = PlaneModel::strain,
                   double nu = 0.2) {
    ModelInput input = body_with(
        std::move(mesh), {.density = 2500, .E = 40e9, .nu = nu, .bulk_viscosity = bulk, .shear_viscosity = shear},
        CohesiveLaw::unbreakable());
    input.plane = plane;
    return input;
}

/// Starts with velocities by place.
template <class At>
void set_velocity(Run& run, const At& at) {
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        run.now.velocity[run.now.node_of_corner[c]] = at(run.model.mesh.corner(c));
    run.ledger = EnergyLedger(run.model, run.now);
}

double energy(const Run& run) { return run.ledger.row().kinetic + run.ledger.row().strain; }

/// [-] ln of the energy at the start over that after five periods of the lowest mode of a free bar of n cells, over
/// 2 gamma t of an amplitude exp(-gamma t) with gamma = eta k^2/(2 rho) = b c h k^2/2. With nu = 0 the wave stretches
/// nothing across, and the viscous stress pulls nothing across where b3 = 0, b = b1, or b3 = b1, b = b1 + b3.
double decay_over_exact(int n, Index order, double b1, double b3) {
    constexpr double length = 1;
    Mesh mesh = bar_mesh(n, 1, length, length / n);
    mesh.order = order;
    Run run(body_of(std::move(mesh), {b1, 0}, b3, PlaneModel::stress, 0));
    const double k = pi / length, c = run.model.materials[0].dilatational_speed(PlaneModel::stress),
                 h = length / n / order, end = 5 * 2 * length / c;
    set_velocity(run, [&](const Vec2& x) { return Vec2(1e-3 * std::cos(k * x.x()), 0); });
    const double start = energy(run), step = end / std::ceil(end / (0.5 * run.stepper.stable_step()));
    while (run.now.time < end - 0.5 * step) run.step(step);
    CHECK(run.ledger.largest_residual() <= 1e-12 * start);
    const double lost = run.ledger.row().bulk_viscosity_work + run.ledger.row().step_change_work;
    CHECK(lost == relative(energy(run) - start, 1e-9));
    return std::log(start / energy(run)) / ((b1 + b3) * c * h * k * k * end);
}

}  // namespace

TEST_CASE("bulk viscosity: a standing wave decays at the rate of the linear terms") {
    for (const Index order : {1, 2})
        for (const int n : {20, 40})
            for (const double b3 : {0., 0.06}) {
                const double ratio = decay_over_exact(n, order, 0.06, b3);
                MESSAGE("order ", order, ", ", n, " cells, b3 = ", b3, ": decay over exact ", ratio);
                CHECK(std::abs(ratio - 1) < 0.5 * std::pow(pi / n, 2));
            }
}

TEST_CASE("bulk viscosity: random bodies with cracks and friction and rotations close their energy balance") {
    int n = 0, n_broken = 0, n_turned = 0, n_quadratic = 0;
    double largest = 0, worst = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        WildBody wild = WildBodies(seed).body();
        if (wild.body.scheme.bulk != BulkScheme::explicit_lumped) continue;
        for (Elastic& material : wild.body.input.materials) {
            material.bulk_viscosity = {0.06 * (1 + seed % 3), 1.2};
            material.shear_viscosity = 0.1 * static_cast<double>(seed % 4);
        }
        if (seed % 3 == 0 && !wild.body.input.large_rotation && wild.body.input.contact_of_pair.empty())
            wild.body.input.mesh.order = 2;
        Run run(wild.body.input, wild.body.scheme);
        const double h = wild.safety * run.stepper.stable_step(), start = energy(run);
        double sum = 0, size = std::abs(start), error = 0;
        for (int i = 0; i < wild.n_steps && run.step_if_taken(i % 3 ? h : 0.6 * h); ++i) {
            sum += run.last.bulk_viscosity_work;
            size = std::max({size, run.ledger.largest_energy(), -sum});
            error = std::max(error, run.ledger.largest_residual());
        }
        INFO("seed " << seed);
        CHECK(error <= 1e-12 * size);
        CHECK(sum <= 1e-12 * size);
        worst = std::max(worst, error / size), largest = std::max(largest, -sum / size);
        for (const PointState& point : run.now.points) n_broken += point.cohesion == 0;
        n_turned += run.model.large_rotation, n_quadratic += run.model.mesh.order == 2, ++n;
    }
    MESSAGE(n, " bodies, ", n_turned, " with large rotations, ", n_quadratic, " of second order, ", n_broken,
            " broken points; error of the balance ", worst, ", largest loss ", largest);
    CHECK(n > 50);
    CHECK(n_turned > 3);
    CHECK(n_quadratic > 10);
    CHECK(n_broken > 50);
    CHECK(largest > 0.1);
}

TEST_CASE("bulk viscosity: the stable step is shorter and enough") {
    for (const Index order : {1, 2})
        for (const bool turns : {false, true}) {
            if (turns && order == 2) continue;
            Mesh mesh = bar_mesh(6, 6, 1, 0.7);
            mesh.order = order;
            const double undamped = Run(body_of(mesh, {0, 0}, 0)).stepper.stable_step();
            for (const auto [b1, b3] : {std::array{0.06, 0.}, std::array{0.5, 0.}, std::array{0., 0.1}}) {
                ModelInput input = body_of(mesh, {b1, 1.2}, b3);
                input.large_rotation = turns;
                Run run(std::move(input));
                const double h = run.stepper.stable_step();
                CHECK(h < undamped / (1 + 0.5 * (b1 + b3)));
                CHECK(h > undamped / (1 + 4 * (b1 + b3)));
                double i = 0;
                set_velocity(run, [&](const Vec2&) -> Vec2 {
                    i += 1;
                    return 0.01 * Vec2(std::sin(37 * i), std::cos(53 * i));
                });
                const double start = energy(run);
                for (int k = 0; k < 500; ++k) run.step(h);
                CHECK(energy(run) < start);
                CHECK(run.ledger.largest_residual() <= 1e-11 * start);
            }
        }
}

TEST_CASE("bulk viscosity: a rigid spin has none with large rotations") {
    ModelInput input = body_of(bar_mesh(3, 3, 1, 1), {0.06, 1.2}, 0.1);
    input.large_rotation = true;
    Run run(std::move(input));
    const double h = 0.9 * run.stepper.stable_step(), angle = 0.01, rate = 2 * std::sin(0.5 * angle) / h;
    // positions turn by the angle in a step, velocities belong to its middle
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        const Vec2 x = run.model.mesh.corner(c);
        run.now.displacement[node] = std::cos(angle) * x + std::sin(angle) * turned_left(x) - x;
        run.now.velocity[node] = rate * (std::cos(0.5 * angle) * turned_left(x) - std::sin(0.5 * angle) * x);
    }
    run.now.last_step = h;
    run.step(h);
    const double c = run.model.materials[0].dilatational_speed(PlaneModel::strain);
    for (const double s : run.now.viscous_stress) CHECK(std::abs(s) <= 1e-14 * 2500 * c * c);
}

TEST_CASE("bulk viscosity: the same bits with one thread and with two") {
    std::vector<State> ends;
    for (const int n_threads : {1, 2}) {
        omp_set_num_threads(n_threads);
        ModelInput input = body_of(bar_mesh(30, 30, 1, 1), {0.06, 1.2}, 0.1);
        input.laws = {{.sigma_c = 1e6, .G_c = 3, .gamma = 1}};
        input.loads = {load(Load::Kind::traction, "right", 2e6, std::nullopt)};
        Run run(std::move(input));
        const double h = 0.9 * run.stepper.stable_step();
        for (int i = 0; i < 80; ++i) run.step(h);
        CHECK(!run.now.split_fans.empty());
        ends.push_back(run.now);
    }
    omp_set_num_threads(1);
    CHECK(ends[0].viscous_stress == ends[1].viscous_stress);
    CHECK(ends[0].velocity == ends[1].velocity);
}

}  // namespace bulk_viscosity_test
