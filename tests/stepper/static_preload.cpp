// Starts in static equilibrium: exact columns and bars, contact, supports that do not hold, a preload just below the
// strength (E14).
#include "base/error.hpp"
#include "model/make_model.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>

namespace static_preload_test {

using namespace knap;
using namespace knap::tests;

namespace {

const CohesiveLaw glue{.sigma_c = 2, .G_c = 1e-3, .gamma = 1, .friction = 0.3};

/// Plane stress, thickness 1, E = 1000, density 1, nu = 0: what is pulled along y stays as wide as it is.
ModelInput block(const Mesh& mesh, const CohesiveLaw& law = glue) {
    ModelInput input = body_with(mesh, {.density = 1, .E = 1000, .nu = 0}, law);
    input.plane = PlaneModel::stress;
    return input;
}

Load gravity(double g) { return load(Load::Kind::acceleration, "", 0.0, -g); }

/// A body, its stepper and its state at the start.
struct Start {
    explicit Start(ModelInput input, const SchemeOptions& options = implicit())
        : model(make_model(std::move(input))), stepper(model, options), now(initial_state(model)) {
        loaded = now;
    }
    Start(const Start&) = delete;  // the stepper refers to the model

    void load() { stepper.start_in_equilibrium(loaded); }
    /// What it says is wrong.
    std::string complaint() {
        try {
            load();
        } catch (const SimulationError& error) {
            return error.what();
        }
        return "nothing";
    }
    Vec2 u(Index corner) const { return loaded.displacement[loaded.node_of_corner[corner]]; }
    Vec2 x(Index corner) const { return model.mesh.corner(corner / 3, corner % 3); }

    /// [N] All that the support does to the body.
    Vec2 support() const {
        Vec2 sum = Vec2::Zero();
        for (std::size_t e = 0; e < model.interfaces.size(); ++e) {
            const Interface& edge = model.interfaces[e];
            if (edge.triangle[0] != rigid_support) continue;
            for (Index end = 0; end < 2; ++end) {
                const Vec2 r = traction(model, loaded, 2 * static_cast<Index>(e) + end);
                sum += 0.5 * edge.length * model.thickness * (r.x() * edge.normal + r.y() * turned_left(edge.normal));
            }
        }
        return sum;
    }

    Model model;
    MoreauJean stepper;
    State now, loaded;
};

void check_fresh(const Start& start) {
    CHECK(start.loaded.time == start.now.time);
    CHECK(start.loaded.last_step == 0);
    CHECK(start.loaded.n_steps == 0);
    CHECK(start.loaded.rate.empty());
    CHECK(start.loaded.split_fans == start.now.split_fans);
    CHECK(same_bits(start.loaded.velocity, start.now.velocity));  // at rest, but for what is driven
    for (const PointState& point : start.loaded.points) CHECK((point.cohesion == 0 || point.cohesion == 1));
}

/// Mean over the width of u_y of the vertices at a height; the body has n columns from x = 0 to 1.
double mean_rise(const Start& start, double y, int n) {
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
        const double x = static_cast<double>(i) / n;
        for (Index c = 0; c < start.model.mesh.n_corners(); ++c) {
            if ((start.x(c) - Vec2(x, y)).norm() > 1e-9) continue;
            sum += (i == 0 || i == n ? 0.5 : 1) * start.u(c).y() / n;
            break;
        }
    }
    return sum;
}

}  // namespace

TEST_CASE("a column hangs or stands on its support with exact displacements and reaction") {
    // linear elements, a lumped mass and nu = 0: by a virtual displacement min(y, Y) the mean over every row of
    // vertices is exact
    for (const double g : {1.0, -0.4}) {
        for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
            ModelInput input = block(bar_mesh(4, 12, 1, 3));
            input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0, .glued = true}};
            input.loads = {gravity(g)};
            SchemeOptions options = implicit(0.6);
            options.mass = mass;
            Start start(input, options);
            start.load();
            check_fresh(start);
            for (int j = 0; j <= 12; ++j) {
                const double y = 0.25 * j, exact = -g / 1000 * (3 * y - y * y / 2);
                CHECK(std::abs(mean_rise(start, y, 4) - exact) <= 1e-12 * 4.5 * std::abs(g) / 1000);
            }
            CHECK((start.support() - Vec2(0, 3 * g)).norm() <= 1e-11 * 3 * std::abs(g));
        }
    }
}

TEST_CASE("a bar between two given ends starts with the displacements of its moment") {
    // the histories go on, the equilibrium is that of t = 2; a prescribed velocity has not moved anything yet
    ModelInput input = block(bar_mesh(8, 2, 4, 1), CohesiveLaw::unbreakable());
    input.loads = {load(Load::Kind::velocity, "left", 1.0, std::nullopt),
                   load(Load::Kind::displacement, "right", 1e-2, std::nullopt, {{0, 1, 3}, {0, 0, 4}}),
                   load(Load::Kind::velocity, "bottom", std::nullopt, 0.0)};
    Start start(input);
    start.loaded.time = start.now.time = 2;
    start.load();
    check_fresh(start);
    for (Index c = 0; c < start.model.mesh.n_corners(); ++c)
        CHECK(start.loaded.velocity[start.loaded.node_of_corner[c]] ==
              Vec2(start.x(c).x() == 0 ? 1 : 0, 0));  // what is driven begins with its speed
    for (Index c = 0; c < start.model.mesh.n_corners(); ++c)
        CHECK((start.u(c) - Vec2(2e-2 * start.x(c).x() / 4, 0)).norm() <= 1e-14);
}

TEST_CASE("a block falls through its gap onto the support and stands there") {
    for (const double restitution : {0.0, 0.5}) {
        ModelInput input = block(bar_mesh(4, 4, 1, 1),
                                 {.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = 0.3, .restitution = restitution});
        input.law_of_pair = {{1}};
        input.laws.push_back(CohesiveLaw::unbreakable());
        input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0, .glued = false, .gap = 1e-6}};
        input.loads = {gravity(1)};
        Start start(input);
        start.load();
        check_fresh(start);
        CHECK((start.support() - Vec2(0, 1)).norm() <= 1e-10);
        CHECK(std::abs(mean_rise(start, 0, 4) + 1e-6) <= 1e-13);
        CHECK(std::abs(mean_rise(start, 1, 4) + 1e-6 + 0.5e-3) <= 1e-13);
    }
}

TEST_CASE("a slender beam is held by its clamped end alone") {
    // its first bending mode is some two hundred times slower than a wave along it
    ModelInput input = block(bar_mesh(200, 1, 200, 1));
    input.laws.push_back(CohesiveLaw::unbreakable());
    input.law_of_pair = {{1}};
    input.supports = {{.on = {.boundary = "left", .box = {}}, .law = 0, .glued = true}};
    input.loads = {gravity(1e-6)};
    Start start(input);
    start.load();
    check_fresh(start);
    CHECK((start.support() - Vec2(0, 200e-6)).norm() <=
          1e-6 * 200e-6);  // the forces of its bending are a million times the load
    double sag = 0;
    for (const Vec2& u : start.loaded.displacement) sag = std::min(sag, u.y());
    const double slender = -1e-6 * std::pow(200, 4) / (8 * 1000.0 / 12);  // Euler and Bernoulli
    CHECK(sag / slender == relative(0.222, 0.01));  // one row of linear triangles locks: 2/9 of it
}

TEST_CASE("a nearly incompressible beam bends in its equilibrium as Timoshenko says") {
    // the terms of K u are 1e7 times the load: rounding of their sum is no lack of balance
    ModelInput input = block(bar_mesh(50, 10, 5, 1));
    input.plane = PlaneModel::strain;
    input.mesh.order = 2;
    input.materials[0].nu = 0.4999;
    input.laws.push_back(CohesiveLaw::unbreakable());
    input.law_of_pair = {{1}};
    input.supports = {{.on = {.boundary = "left", .box = {}}, .law = 1, .glued = true}};
    input.loads = {load(Load::Kind::traction, "right", 0.0, -1e-6)};
    Start start(input);
    start.load();
    std::vector<Vec2> force;
    const double G = 1000 / (2 * 1.4999), E = 1000 / (1 - 0.4999 * 0.4999), F = 1e-6, L = 5;
    const double beam = F * F * L * L * L / (6 * E / 12) + 0.6 * F * F * L / G;
    CHECK(elastic_energy(start.model, start.loaded, force) / beam == relative(0.97, 0.01));
}

TEST_CASE("a free body in balanced tension is in equilibrium and one that is pushed is not") {
    ModelInput input = block(bar_mesh(6, 3, 2, 1));
    input.loads = {load(Load::Kind::traction, "left", -1.0, 0.0), load(Load::Kind::traction, "right", 1.0, 0.0)};
    Start pulled(input);
    pulled.load();
    check_fresh(pulled);
    for (Index t = 0; t < pulled.model.mesh.n_triangles(); ++t)
        CHECK((stress(pulled.model, pulled.loaded, t) - Eigen::Vector3d(1, 0, 0)).norm() <=
              1e-6);  // its position is free, and large compared with its strain

    input.loads = {load(Load::Kind::traction, "left", 1.0, 0.0)};
    const std::string message = Start(input).complaint();
    CHECK_MESSAGE(message.find("nothing holds the body") != std::string::npos, message);
    input.loads = {load(Load::Kind::traction, "left", 0.0, 1.0),
                   load(Load::Kind::traction, "right", 0.0, -1.0)};  // it would turn
    const std::string turned = Start(input).complaint();
    CHECK_MESSAGE(turned.find("nothing holds the body") != std::string::npos, turned);
    input.loads = {gravity(1)};
    Start unloaded(input), weightless(block(bar_mesh(2, 2, 1, 1)));
    CHECK(unloaded.complaint().find("nothing holds the body") != std::string::npos);
    CHECK(weightless.complaint() == "nothing");
}

namespace {

Load stress_on(const std::string& boundary, const std::array<double, 3>& stress) {
    return {.kind = Load::Kind::stress, .on = {.boundary = boundary, .box = {}}, .stress = stress};
}

/// Nothing moves in n steps of the explicit bulk, from the equilibrium of `input`, and the energies stay.
void check_rests(const ModelInput& input, int n = 2000) {
    Start start(input, {});
    start.load();
    check_fresh(start);
    EnergyLedger ledger(start.model, start.loaded);
    const double energy = ledger.row().strain;
    REQUIRE(energy > 0);
    State now = start.loaded, next;
    const double h = 0.8 * start.stepper.stable_step();
    double kinetic = 0;
    for (int i = 0; i < n; ++i) {
        const StepReport report = start.stepper.step(now, h, next);
        REQUIRE(report.softened + report.released == 0);
        std::swap(now, next);
        ledger.add(now, report);
        kinetic = std::max(kinetic, ledger.row().kinetic);
    }
    CHECK(kinetic <= 1e-20 * energy);
    CHECK(ledger.row().strain == relative(energy, 1e-10));
    CHECK(ledger.largest_residual() <= 1e-11 * energy);
    CHECK(std::abs(ledger.row().external_work) <= 1e-9 * energy);
    CHECK(ledger.worst().residual <= 1e-10);
}

}  // namespace

TEST_CASE(
    "the explicit bulk rests from its start in equilibrium under gravity and pressure on glue and on rough or bouncing "
    "support") {
    const CohesiveLaw rough{.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = 0.6},
        bouncing{.sigma_c = 0, .G_c = 0, .friction = 0.6, .restitution = 0.5};
    for (const int order : {1, 2})
        for (const CohesiveLaw& support_law : {glue, rough, bouncing}) {
            CAPTURE(order);
            CAPTURE(support_law.restitution);
            ModelInput input = block(bar_mesh(4, 6, 1, 1.5));
            input.mesh.order = order;
            input.materials[0].nu = 0.3;  // it spreads on its support, which friction resists
            input.laws.push_back(support_law);
            input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = support_law.sigma_c > 0}};
            input.loads = {gravity(0.3), stress_on("left", {-0.4, -0.4, 0}), stress_on("right", {-0.4, -0.4, 0})};
            check_rests(input);
        }
}

TEST_CASE("a stress in situ fills a body uniformly and the explicit bulk keeps it") {
    // traction sigma n on the whole border of a free body: sigma is the exact solution, also where cracks lie closed
    ModelInput input = block(bar_mesh(6, 4, 3, 2), {.sigma_c = 9, .G_c = 1e-3, .gamma = 1, .friction = 0.3});
    input.materials[0].nu = 0.25;
    for (const char* side : {"left", "right", "bottom", "top"}) input.loads.push_back(stress_on(side, {-2, -1, 0.5}));
    check_rests(input, 500);
    Start start(input, {});
    start.load();
    for (Index t = 0; t < start.model.mesh.n_triangles(); ++t)
        CHECK((stress(start.model, start.loaded, t) - Eigen::Vector3d(-2, -1, 0.5)).norm() <=
              1e-6);  // its place is free
}

TEST_CASE("a pressure that grows does the work in the energy balance") {
    // slowly, on a disc-like block on both bulks: work = p^2/2 times the compliance of plane stress, 2 (1 - nu)/E of an
    // area of 2
    for (const SchemeOptions& options : {SchemeOptions{}, implicit()}) {
        ModelInput input = block(bar_mesh(4, 2, 2, 1), CohesiveLaw::unbreakable());
        input.materials[0].nu = 0.25;
        TimeFunction smooth;  // no ringing is left at its end
        for (int i = 0; i <= 100; ++i)
            smooth.time.push_back(i * 0.04), smooth.value.push_back(0.5 - 0.5 * std::cos(i * M_PI / 100));
        for (const char* side : {"left", "right", "bottom", "top"}) {
            input.loads.push_back(stress_on(side, {-3, -3, 0}));
            input.loads.back().history = smooth;
        }
        Run run(input, options);
        const double h = std::min(2e-2, 0.8 * run.stepper.stable_step()), exact = 0.5 * 9 * 2 * 0.75 / 1000 * 2;
        while (run.now.time < 4.5) run.step(h);
        CHECK(run.ledger.row().external_work == relative(exact, 1e-3));
        CHECK(run.ledger.largest_residual() <= 1e-12 * exact);
    }
}

TEST_CASE("E14 a preload of .99 of the strength rests and 2 percent more breaks") {
    describe("A bar on a glued support under .99 of its strength: the run begins in static equilibrium.");
    const auto pulled = [](double load_over_strength, TimeFunction history = {}) {
        ModelInput input = block(bar_mesh(6, 2, 3, 1));
        input.supports = {{.on = {.boundary = "left", .box = {}}, .law = 0, .glued = true}};
        input.loads = {load(Load::Kind::traction, "right", load_over_strength * glue.sigma_c, 0.0, std::move(history))};
        return input;
    };
    for (const double theta : {0.5, 1.0}) {
        Start start(pulled(0.99), implicit(theta));
        start.load();
        check_fresh(start);
        const double most = 3 * 0.99 * glue.sigma_c / 1000, h = 0.2, speed_of_sound = std::sqrt(1000.0);
        for (Index t = 0; t < start.model.mesh.n_triangles(); ++t)
            CHECK((stress(start.model, start.loaded, t) - Eigen::Vector3d(0.99 * glue.sigma_c, 0, 0)).norm() <=
                  1e-11 * glue.sigma_c);
        EnergyLedger ledger(start.model, start.loaded);
        State now = start.loaded, next;
        double moved = 0, speed = 0;
        for (int i = 0; i < 10000; ++i) {
            const StepReport report = start.stepper.step(now, h, next);
            REQUIRE(report.rejection == Rejection::none);
            REQUIRE(report.softened + report.released == 0);
            std::swap(now, next);
            ledger.add(now, report);
            for (std::size_t n = 0; n < now.displacement.size(); ++n) {
                moved = std::max(moved, (now.displacement[n] - start.loaded.displacement[n]).norm());
                speed = std::max(speed, now.velocity[n].norm());
            }
        }
        on_path(both_implicit);
        const std::string at = ", theta = " + digits(theta);
        verify_small("largest movement over the displacement, 10 000 steps" + at, moved / most, {1e-11});
        verify_small("largest speed over that of sound times strain" + at, speed / (speed_of_sound * most / 3),
                     {1e-10});
        CHECK(ledger.largest_residual() <= 1e-11 * ledger.largest_energy());
    }
    // the same load in the run, then more
    Start more(pulled(0.99, {{0, 1, 2}, {1, 1, 1.02}}), implicit());
    more.load();
    State now = more.loaded, next;
    std::int64_t softened = 0;
    double first = 0;
    while (now.time < 3 && softened == 0) {
        const StepReport report = more.stepper.step(now, 1e-3, next);
        REQUIRE(report.rejection == Rejection::none);
        std::swap(now, next);
        softened += report.softened;
        first = now.time;
    }
    verify_at_least("points that soften when the load grows by 2 percent", static_cast<double>(softened), 1);
    verify("time at which they do", first, 1.505,
           {0.1});  // .99 x 1.0101 = 1, after half of the rise; the end of the bar rings
    // and at the start
    const std::string message = Start(pulled(0.99 * 1.02), implicit()).complaint();
    verify_that("2 percent more at the start is rejected",
                message.find("the preload is more than the interfaces hold") != std::string::npos);
    verify_that("1e-6 below the strength is held", Start(pulled(1 - 1e-6), implicit()).complaint() == "nothing");
}

TEST_CASE("a preload that its support does not hold says where") {
    ModelInput input = block(bar_mesh(4, 4, 1, 1), CohesiveLaw::unbreakable());
    input.laws.push_back({.sigma_c = 1, .G_c = 1e-3, .gamma = 1});
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = true}};
    input.loads = {gravity(-1.5)};
    const std::string message = Start(input).complaint();
    CHECK_MESSAGE(message.find("the preload is more than the interfaces hold, what breaks loose would move away with "
                               "1.5 m/s2, at (") != std::string::npos,
                  message);
    CHECK_MESSAGE(message.find(", 0) m") != std::string::npos, message);
    input.loads = {gravity(-0.5)};
    CHECK(Start(input).complaint() == "nothing");
}

// ---- large rotations: the equilibrium of the turned body, on which the explicit steps stay at rest

namespace {

struct Rest {
    double kinetic, energy_error;  // over the strain energy, over the largest energy
    double rotation_work;          // over the strain energy
};

/// 2000 explicit steps from the equilibrium.
Rest rest_after(Start& start) {
    const double h = 0.5 * start.stepper.stable_step();
    EnergyLedger ledger(start.model, start.loaded);
    State now = start.loaded, next;
    for (int i = 0; i < 2000; ++i) {
        ledger.add(next, start.stepper.step(now, h, next));
        std::swap(now, next);
    }
    const EnergyRow& row = ledger.row();
    return {row.kinetic / row.strain, ledger.largest_residual() / ledger.largest_energy(),
            std::abs(ledger.largest_rotation_work()) / row.strain};
}

}  // namespace

TEST_CASE("a cantilever with large rotations rests in its equilibrium nearer to its support by 4/7 w^2/L") {
    // w' = 4 w/(3 L) (x^3 - 3 x^2 + 3 x) under a uniform load, and the end moves back by 1/2 int w'^2 dx
    ModelInput input = block(bar_mesh(40, 4, 1, 0.1), CohesiveLaw::unbreakable());
    input.loads = {load(Load::Kind::displacement, "left", 0.0, 0.0), gravity(0.06)};
    input.large_rotation = true;
    Start start(input, {});
    start.load();
    Vec2 end = Vec2::Zero();
    for (Index c = 0; c < start.model.mesh.n_corners(); ++c)
        if ((start.x(c) - Vec2(1, 0.05)).norm() < 1e-9) end = start.u(c);
    REQUIRE(end.y() < -0.005);
    CHECK(-end.x() == relative(4. / 7 * end.y() * end.y(), 0.02));
    const Rest rest = rest_after(start);
    CHECK(rest.kinetic < 1e-18);
    CHECK(rest.energy_error < 1e-13);
    CHECK(rest.rotation_work < 1e-12);
    // with small rotations the end moves down alone
    input.large_rotation = false;
    Start small(input, {});
    small.load();
    for (Index c = 0; c < small.model.mesh.n_corners(); ++c)
        if ((small.x(c) - Vec2(1, 0.05)).norm() < 1e-9) CHECK(std::abs(small.u(c).x()) < 0.01 * std::abs(end.x()));
}

TEST_CASE("a jointed column with large rotations rests in its equilibrium under weight and a pressure that follows") {
    CohesiveLaw joint{.sigma_c = 0, .G_c = 1, .gamma = 1, .friction = 1.2};
    ModelInput input = block(bar_mesh(4, 12, 1, 3), joint);
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0}};
    input.loads = {gravity(1),
                   load(Load::Kind::traction, "top", 0.01, 0.0),
                   {.kind = Load::Kind::stress, .on = {.boundary = "left"}, .stress = {-0.05, -0.05, 0}}};
    input.large_rotation = true;
    Start start(input, {});
    start.load();
    const Rest rest = rest_after(start);
    CHECK(rest.kinetic < 1e-18);
    CHECK(rest.energy_error < 1e-12);
}

TEST_CASE("a body whose faces meet by contact starts in equilibrium and knows that no face has retired yet") {
    ModelInput input = block(bar_mesh(2, 2, 1, 1), CohesiveLaw::unbreakable());
    input.loads = {load(Load::Kind::displacement, "left", 0.0, 0.0), gravity(0.06)};
    input.large_rotation = true;
    input.contact_of_pair = {{{.friction = 1.2}}};
    Start start(input, {});
    start.load();
    CHECK(start.now.retired.size() == start.model.n_points());
    CHECK(start.loaded.retired == start.now.retired);
}

TEST_CASE("a body that turns too far for the search is refused") {
    ModelInput input = block(bar_mesh(40, 4, 1, 0.1), CohesiveLaw::unbreakable());
    input.loads = {load(Load::Kind::displacement, "left", 0.0, 0.0), gravity(0.5)};
    input.large_rotation = true;
    const std::string message = Start(input, {}).complaint();
    CHECK_MESSAGE(message.find("turns or strains too far") != std::string::npos, message);
}

}  // namespace static_preload_test
