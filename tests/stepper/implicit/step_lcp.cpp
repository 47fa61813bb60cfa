// The full, unreduced problem of an implicit step, by itself: exact solutions, the energy identity, and every step
// judged by the equations.
#include "base/random.hpp"
#include "lcp/spurious_breaking.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"
#include "support/step_lcp_run.hpp"

#include <Eigen/Eigenvalues>

#include <doctest/doctest.h>

#include <cmath>

namespace step_lcp_test {

using namespace knap;
using namespace knap::tests;

namespace {

const CohesiveLaw glue{.sigma_c = 1, .G_c = 0.5, .gamma = 1, .friction = 0.5};

/// A square of four triangles round a vertex (symmetric_bar_mesh, one cell), all edges cohesive, of size 1.
ModelInput square(const CohesiveLaw& law, int n_cells = 1) {
    ModelInput input = body_with(symmetric_bar_mesh(n_cells, n_cells, 1), {.density = 1, .E = 10, .nu = 0.25}, law);
    return input;
}

/// Six triangles round one vertex.
ModelInput hexagon(const CohesiveLaw& law) {
    ModelInput input;
    input.mesh.vertices = {{0, 0}};
    for (int i = 0; i < 6; ++i)
        input.mesh.vertices.push_back({std::cos(i * M_PI / 3 + 0.1), (1 + 0.05 * i) * std::sin(i * M_PI / 3 + 0.1)});
    for (Index i = 0; i < 6; ++i) input.mesh.triangles.push_back({0, i + 1, (i + 1) % 6 + 1});
    input.mesh.region.assign(6, 0);
    input.mesh.boundary_names = {"rim"};
    find_edges(input.mesh);
    input.materials = {{.density = 1, .E = 10, .nu = 0.25}};
    input.laws = {law};
    input.law_of_pair = {{0}};
    return input;
}

}  // namespace

TEST_CASE("step LCP: B1 one mass under constant force follows the exact discrete solution until it breaks") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5, .gamma = 0};
    const double F = 1.5, A = F - 1;
    for (const double h : {0.1, 0.05, 0.025, 0.0123}) {
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * F)};  // area 1 shared by three corners
        StepLcpRun run(input);
        const double a = 2 * std::atanh(h / 2);
        double worst = 0;
        int n = 0;
        while (true) {
            REQUIRE(run.step(h));
            ++n;
            CHECK(run.verdict.worst() < 1e-12);
            if (run.cohesion_of(0) == 0) break;
            worst = std::max(worst, std::abs(run.opening_of(0).x() / (A * (std::cosh(n * a) - 1)) - 1));
            REQUIRE(n < 1000);
        }
        CHECK(worst < 1e-12);
        CHECK(std::abs(n * h - 1.7627471740) < 2 * h);
        // the breaking step overshoots by a known part: 0 <= G/w - 1 <= (v h/delta_c)^2/4
        const double v = run.v(0).y();
        CHECK(v == relative(std::sqrt(2), h));
        // afterwards it flies freely; the LCP has no row left but contact
        REQUIRE(run.step(h));
        CHECK(run.n_rows == 2);
        CHECK(run.v(0).y() == relative(v + h * F, 1e-12));
    }
}

TEST_CASE("step LCP: B1 with theta above one half neither rings nor refuses") {
    for (const double theta : {0.5, 0.75, 1.0})
        for (const double h : {0.1, 0.025}) {
            ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5, .gamma = 0}, true);
            input.loads = {load(Load::Kind::body_force, "", 0.0, 4.5)};
            SchemeOptions options = implicit_scheme;
            options.theta = theta;
            StepLcpRun run(input, options);
            double last = 0;
            for (int n = 0; n < static_cast<int>(2.5 / h); ++n) {
                REQUIRE(run.step(h));
                CHECK(run.verdict.worst() < 1e-12);
                CHECK(run.v(0).y() > last);
                last = run.v(0).y();
            }
            CHECK(run.cohesion_of(0) == 0);
        }
}

TEST_CASE("step LCP: the strength of a point is the polygon of tension and friction") {
    // pulled and sheared: tension up to sigma_c, shear up to (gamma + mu) sigma_c + mu r_N
    for (int i = 0; i < 36; ++i) {
        const double angle = (i + 0.5) * M_PI / 18;
        const Vec2 direction(std::cos(angle), std::sin(angle));  // of the load; r_N = -its y
        const double tension = direction.y() > 0 ? 1 / direction.y() : INFINITY;
        const double slope = std::abs(direction.x()) + glue.friction * direction.y();
        const double shear = slope > 0 ? (glue.gamma + glue.friction) / slope : INFINITY;
        const double strength = std::min(tension, shear);
        for (const double part : {0.999, 1.001}) {
            if (std::isinf(strength)) continue;
            ModelInput input = point_masses(glue, true);
            input.loads = {load(Load::Kind::body_force, "", 3 * part * strength * direction.x(),
                                3 * part * strength * direction.y())};
            StepLcpRun run(input);
            REQUIRE(run.step(0.1));
            CHECK(run.verdict.worst() < 1e-12);
            CAPTURE(angle);
            if (part < 1) CHECK(run.u(0).norm() < 1e-13);
            else CHECK(run.u(0).norm() > 1e-7);
        }
    }
}

TEST_CASE("step LCP: the strength of a point with the norm is a polygon of 8 sides round the half ellipse") {
    const double friction = 0.5;
    for (const CohesionScheme cohesion : {CohesionScheme::explicit_beta, CohesionScheme::implicit_beta})
        for (const double gamma : {0.8, 1.0, 2.0})
            for (int i = 0; i < 36; ++i) {
                const double angle = (i + 0.5) * M_PI / 18, tension = std::sin(angle),
                             shear = std::abs(std::cos(angle)), scaled = shear / gamma;
                const double polygon = 1 / std::max({tension, scaled, (tension + scaled) / std::sqrt(2)}),
                             rubs = shear + friction * tension;
                if (tension < 0 && rubs <= 0) continue;
                const double strength = tension > 0 ? polygon : gamma / rubs;
                if (tension > 0) {
                    CHECK(polygon * std::hypot(tension, scaled) >= 1 - 1e-15);
                    CHECK(polygon * std::hypot(tension, scaled) <= 1 / std::cos(M_PI / 8) + 1e-15);
                }
                for (const double part : {0.999, 1.001}) {
                    ModelInput input = point_masses(
                        {.sigma_c = 1, .G_c = 0.5, .gamma = gamma, .friction = friction, .coupling = Coupling::norm},
                        true);
                    input.loads = {load(Load::Kind::body_force, "", 3 * part * strength * std::cos(angle),
                                        3 * part * strength * tension)};
                    SchemeOptions options = implicit_scheme;
                    options.cohesion = cohesion;
                    StepLcpRun run(input, options);
                    REQUIRE(StepLcp::fits_by_polygon(run.model, options));
                    CHECK_FALSE(StepLcp::fits(run.model, options));
                    REQUIRE(run.step(0.1));
                    CAPTURE(angle);
                    CAPTURE(gamma);
                    if (part < 1) CHECK(run.u(0).norm() < 1e-13);
                    else CHECK(run.u(0).norm() > 1e-7);
                }
            }
}

TEST_CASE("step LCP: with the norm a led point loses cohesion as the polygon says and at most 8.3 % faster") {
    for (const double gamma : {1.0, 2.0})
        for (const double degrees : {0.0, 22.5, 45.0, 70.0, 90.0}) {
            const double t = degrees * M_PI / 180, g = gamma * std::sin(t), c = std::sqrt(2) - 1;
            const double size = std::hypot(std::cos(t), g),
                         polygon = c * (std::cos(t) + g + (std::cos(t) + g + std::abs(std::cos(t) - g)) / std::sqrt(2));
            const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = gamma, .coupling = Coupling::norm};
            ModelInput input = point_masses(law, true);
            const double breaks = law.delta_c() / size;
            input.loads = {load(Load::Kind::displacement, "base", std::sin(t), std::cos(t), {{0, 1}, {0, 2 * breaks}})};
            StepLcpRun run(input);
            for (int k = 0; k < 64; ++k) REQUIRE(run.step(1. / 256));
            CAPTURE(degrees);
            CHECK(1 - run.cohesion_of(0) == relative(0.5 * polygon / size, 1e-10));
            CHECK(polygon <= size / std::cos(M_PI / 8) + 1e-15);
            CHECK(polygon >= size - 1e-15);
        }
}

TEST_CASE("step LCP: two triangles drawn apart or along each other follow the exact discrete solution") {
    // two point masses m on a bond of area S: relative motion y'' = kappa^2 y about the place where the bond ends; the
    // step turns (y, y') by the hyperbolic angle a
    struct Mode {
        CohesiveLaw law;
        bool shear;
    };
    for (const Mode& mode :
         {Mode{{.sigma_c = 1, .G_c = 0.5, .gamma = 0}, false}, Mode{{.sigma_c = 1, .G_c = 0.5, .gamma = 2}, false},
          Mode{{.sigma_c = 1, .G_c = 0.5, .gamma = 2}, true},
          Mode{{.sigma_c = 1, .G_c = 0.5, .gamma = 0.5, .friction = 0.3}, true}}) {
        ModelInput input = body_with(bar_mesh(1, 1, 2, 1), {.density = 3, .E = 0, .nu = 0}, mode.law);
        StepLcpRun run(input);
        const double S = 0.5 * std::sqrt(5.0), m = 1, gamma = mode.law.gamma, reach = mode.shear ? 1 / gamma : 1;
        const double strength = mode.shear ? gamma + mode.law.friction : 1;
        const double kappa = std::sqrt(strength * S / reach / (m / 2)), h = 0.02, a = 2 * std::atanh(h * kappa / 2);
        const double V0 = 1.1 * kappa * reach;
        const FanPoint& at = run.model.fan_points[run.model.fan_point_of[0]];
        const Vec2 apart = mode.shear ? turned_left(at.normal) : at.normal;
        for (Index c = 0; c < 6; ++c)
            run.now.velocity[run.now.node_of_corner[c]] = (c / 3 == at.after / 3 ? 0.5 : -0.5) * V0 * apart;
        int n = 0;
        for (;; ++n) {
            const double expected = reach * (1 - std::cosh(n * a)) + V0 / kappa * std::sinh(n * a);
            if (expected >= reach) break;
            if (n > 0) CHECK((mode.shear ? run.opening_of(0).y() : run.opening_of(0).x()) == relative(expected, 1e-11));
            REQUIRE(run.step(h));
            CHECK(run.verdict.worst() < 1e-11);
            CHECK(std::abs(run.identity) < 1e-13 * V0 * V0);
        }
        CHECK(n > 20);
        REQUIRE(run.step(h));
        CHECK(run.cohesion_of(0) == 0);
        CHECK(run.surface() == relative(2 * S * mode.law.G_c, 1e-12));
    }
}

TEST_CASE("step LCP: a bond that is not broken by the motion closes again with what is left of it") {
    ModelInput input = point_masses({.sigma_c = 1, .G_c = 0.5, .gamma = 0}, true);
    StepLcpRun run(input);
    for (const Index c : {0, 1}) run.now.velocity[run.now.node_of_corner[c]] = Vec2(0, 0.5);
    double smallest = 1;
    for (int n = 0; n < 400; ++n) {
        REQUIRE(run.step(0.01));
        CHECK(run.verdict.worst() < 1e-12);
        CHECK(run.cohesion_of(0) <= smallest);
        smallest = run.cohesion_of(0);
    }
    CHECK(smallest == relative(std::sqrt(0.75), 1e-4));  // u = 1 - cosh t + V_0 sinh t
    CHECK(std::abs(run.opening_of(0).x()) < 0.005);      // it has come back, and landed within half a step of motion
    CHECK(std::abs(run.v(0).y()) < 1e-12);
}

TEST_CASE("step LCP: impact with restitution and sliding to rest") {
    for (const double e : {0.0, 0.3, 1.0}) {
        StepLcpRun run(point_masses({.friction = 0, .restitution = e}, false));
        run.now.velocity[run.now.node_of_corner[0]] = Vec2(0.2, -1);
        REQUIRE(run.step(0.1));
        CHECK(run.v(0).y() == relative(e, 1e-14));
        CHECK(run.v(0).x() == 0.2);
        CHECK(run.verdict.worst() < 1e-14);
    }
    ModelInput input = point_masses({.friction = 0.5}, false);
    input.loads = {load(Load::Kind::body_force, "", 0.0, -3.0)};  // a weight of 1 on each corner: it slows down by 1/2
    SchemeOptions options = implicit_scheme;
    options.theta = 1;
    StepLcpRun run(input, options);
    for (const Index c : {0, 1}) run.now.velocity[run.now.node_of_corner[c]] = Vec2(1, 0);
    for (int n = 1; n <= 30; ++n) {
        REQUIRE(run.step(0.1));
        CHECK(run.verdict.worst() < 1e-14);
        CHECK(run.v(0).x() == relative(std::max(0.0, 1 - 0.05 * n), 1e-13));
    }
    CHECK(run.v(0).x() == 0);
}

TEST_CASE("step LCP: at rest and unloaded nothing moves") {
    for (const ModelInput& input : {square(glue), hexagon(glue), square(glue, 2)}) {
        StepLcpRun run(input);
        for (int n = 0; n < 3; ++n) {
            REQUIRE(run.step(0.2));
            CHECK(run.energy() < 1e-28);
            CHECK(run.surface() < 1e-14);
            CHECK(run.cohesion_of(0) == relative(1, 1e-14));
        }
    }
}

TEST_CASE("step LCP: a strong body moves like one whose bonds cannot break") {
    // round every interior vertex the reactions are not unique; the motion is
    CohesiveLaw strong = glue;
    strong.sigma_c = 1e3;
    strong.G_c = 1e7;  // its softening must not outweigh the inertia of the step, or it could break as well
    for (const MassMatrix mass :
         {MassMatrix::lumped, MassMatrix::consistent}) {  // one point: a triangle by itself has none for its turning
        SchemeOptions options = implicit_scheme;
        options.mass = mass;
        StepLcpRun separate(square(strong, 2), options), whole(square(CohesiveLaw::unbreakable(), 2), options);
        for (Index c = 0; c < 24; ++c) {
            const Vec2& x = separate.model.mesh.corner(c / 3, c % 3);
            for (StepLcpRun* run : {&separate, &whole})
                run->now.velocity[run->now.node_of_corner[c]] = Vec2(x.x() * x.y(), 1 - 2 * x.x());
        }
        for (int n = 0; n < 3; ++n) {
            REQUIRE(separate.step(0.2));
            REQUIRE(whole.step(0.2));
            CHECK(separate.verdict.worst() < 1e-10);
            CHECK(whole.n_rows == 0);
            for (Index c = 0; c < 24; ++c) CHECK((separate.v(c) - whole.v(c)).norm() < 1e-11);
        }
    }
}

TEST_CASE("step LCP: a glued boundary that is driven") {
    // velocity and displacement histories that mean the same motion; both points break in one step, the third corner
    // follows by inertia alone
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
    ModelInput by_place = point_masses(law, true), by_speed = by_place;
    by_place.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 4}, {0, 2}})};
    by_speed.loads = {load(Load::Kind::velocity, "base", 0.0, 0.5)};
    StepLcpRun place(by_place), speed(by_speed);
    for (const Index c : {0, 1}) speed.now.velocity[speed.now.node_of_corner[c]] = Vec2(0, 0.5);
    for (int n = 1; n <= 25; ++n) {
        for (StepLcpRun* run : {&place, &speed}) {
            REQUIRE(run->step(0.1));
            CHECK(run->verdict.worst() < 1e-12);
            CHECK(run->opening_of(0).x() == relative(0.05 * n, 1e-12));
            CHECK(run->v(0).y() == relative(0.5, 1e-12));
            CHECK(run->cohesion_of(0) == relative(std::max(0.0, 1 - 0.05 * n), 1e-12));
        }
    }
}

TEST_CASE("step LCP: only the rows that a scene needs") {
    const auto layout = [](const CohesiveLaw& law, CohesionScheme cohesion) {
        const Model model = make_model(hexagon(law));
        SchemeOptions options = implicit_scheme;
        options.cohesion = cohesion;
        return StepLcp(model, initial_state(model), 0.1, options).problem();
    };
    const int n = 12;  // points: six interfaces
    const LcpProblem full = layout(glue, CohesionScheme::implicit_beta);
    CHECK(full.size() == 9 * n);
    const auto known = cohesive_layout(full);
    REQUIRE(known.has_value());
    CHECK(known->n_cohesive == n);
    CHECK(known->n_contacts == n);
    CHECK(layout({.sigma_c = 1, .G_c = 1, .gamma = 0}, CohesionScheme::implicit_beta).size() == 3 * n);
    CHECK(layout({.sigma_c = 1, .G_c = 1, .gamma = 1}, CohesionScheme::implicit_beta).size() == 6 * n);
    CHECK(layout({.sigma_c = 1, .G_c = 1, .gamma = 0, .friction = 1}, CohesionScheme::explicit_beta).size() == 4 * n);
    CHECK(layout({.friction = 0}, CohesionScheme::explicit_beta).size() == n);
    CHECK(layout(CohesiveLaw::unbreakable(), CohesionScheme::implicit_beta).size() == 0);
    // without friction and gamma the matrix is semidefinite where softening does not outweigh inertia
    const Eigen::MatrixXd M = layout({.sigma_c = 1, .G_c = 1, .gamma = 0}, CohesionScheme::implicit_beta).M;
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M + M.transpose()).eigenvalues().minCoeff() > -1e-13);
}

TEST_CASE("step LCP: random motions of a closed fan obey the equations and the energy identity") {
    int n_steps = 0, n_unsolved = 0, n_broken = 0;
    for (int seed = 0; seed < 20; ++seed) {
        Random random(seed, "step lcp");
        CohesiveLaw law{.sigma_c = 1,
                        .G_c = 0.05,
                        .gamma = random.uniform(0, 2),
                        .friction = random.uniform(),
                        .restitution = random.uniform()};
        if (seed % 3 == 0) law.restitution = 0;
        SchemeOptions options = implicit_scheme;
        if (seed % 2 == 1) options.cohesion = CohesionScheme::explicit_beta;
        StepLcpRun run(hexagon(law), options);
        for (Vec2& v : run.now.velocity) v = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        const double start = run.energy();
        for (int n = 0; n < 12; ++n, ++n_steps) {
            CAPTURE(seed);
            if (!run.step(0.03)) {
                ++n_unsolved;
                break;
            }
            CHECK(run.verdict.worst() < 1e-9);
            CHECK(std::abs(run.identity) < 1e-12 * start);
            CHECK(run.energy() < start * (1 + 1e-12));
        }
        for (Index p = 0; p < run.model.n_points(); ++p) n_broken += run.cohesion_of(p) == 0;
    }
    CHECK(n_steps > 200);
    CHECK(n_unsolved <= 2);
    CHECK(n_broken > 20);
}

}  // namespace step_lcp_test
