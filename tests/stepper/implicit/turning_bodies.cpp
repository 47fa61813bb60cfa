// The implicit scheme with large rotations: a body that turns far in large steps keeps its books, its momentum and its
// angular momentum, and what rests, rests however it is turned.
#include "stepper/implicit/implicit_bulk.hpp"
#include "stepper/implicit/theta_matrix.hpp"
#include "stepper/scheme_change.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace turning_bodies_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double pi = std::numbers::pi;
const Elastic rock{.density = 2500, .E = 10e9, .nu = 0.2};
const Load weight{.kind = Load::Kind::acceleration, .on = {}, .value = {0, -9.81}};

ModelInput body(Mesh mesh, const CohesiveLaw& law = CohesiveLaw::unbreakable()) {
    return turning_body(std::move(mesh), rock, law);
}

SchemeOptions implicit(double theta = 0.5) { return {.bulk = BulkScheme::implicit_theta, .theta = theta}; }

/// Displacements and velocities by place.
template <class Displacement, class Velocity>
void set_motion(Run& run, const Displacement& displacement, const Velocity& velocity) {
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        const Vec2 x = run.model.mesh.corner(c);
        run.now.displacement[node] = displacement(x);
        run.now.velocity[node] = velocity(x);
    }
    run.ledger = EnergyLedger(run.model, run.now);
}
void turn(Run& run, double angle) {
    set_motion(
        run, [&](const Vec2& x) -> Vec2 { return turned(x, angle) - x; }, [](const Vec2&) { return Vec2(0, 0); });
}

struct Counts {
    std::int64_t steps = 0, solves = 0;
    double solves_a_step() const { return static_cast<double>(solves) / static_cast<double>(steps); }
};
Counts run_until(Run& run, double time, double h) {
    Counts counts;
    while (run.now.time < time - 0.5 * h) {
        const bool taken = run.step_if_taken(h);
        REQUIRE_MESSAGE(taken, "rejected at the step after ", run.now.n_steps, ": ",
                        static_cast<int>(run.last.rejection), ", residual ", run.last.residual);
        ++counts.steps, counts.solves += run.last.linear_solves;
    }
    return counts;
}

void check_books(const Run& run, double tolerance = 1e-12) {
    const double scale = run.ledger.largest_energy();
    CHECK(run.ledger.largest_residual() <= tolerance * scale);
    CHECK(run.ledger.worst().worst_friction_work <= 1e-13 * scale);
    CHECK(run.ledger.worst().worst_impact_work <= 1e-13 * scale);
    CHECK(run.ledger.worst().largest_beta_growth == 0);
}

/// Of the body at the end of a step, the angular one about the origin.
struct Momenta {
    Vec2 linear = Vec2::Zero();
    double angular = 0;
};
Momenta momenta(const Run& run) {
    Momenta sum;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        const Vec2 p = run.model.corner_mass[c] * run.now.velocity[node];
        sum.linear += p;
        sum.angular += cross(run.model.mesh.corner(c) + run.now.displacement[node], p);
    }
    return sum;
}

/// A square of 1 m that is stretched by 1e-3, moves with 3 m/s and turns with 50/s.
void set_spinning(Run& run) {
    const auto stretch = [](const Vec2& x) { return Vec2(1e-3 * (x.x() - 0.5), 0); };
    set_motion(run, stretch,
               [&](const Vec2& x) -> Vec2 { return 50 * turned_left(x + stretch(x) - Vec2(0.5, 0.5)) + Vec2(3, 0); });
}

}  // namespace

TEST_CASE("T1 a free square turns twice in implicit steps") {
    for (const double turn : {0.017, 0.067, 0.27}) {
        CAPTURE(turn);
        Run run(body(bar_mesh(4, 4, 1, 1)), implicit());
        set_spinning(run);
        const Momenta start = momenta(run);
        double p = 0, L = 0;
        Counts all;
        while (run.now.time < 4 * pi / 50) {
            all.solves += run_until(run, run.now.time + turn / 50, turn / 50).solves, ++all.steps;
            const Momenta now = momenta(run);
            p = std::max(p, (now.linear - start.linear).norm() / start.linear.norm());
            L = std::max(L, std::abs(now.angular / start.angular - 1));
        }
        MESSAGE("omega h ", turn, ": identity ", run.ledger.largest_residual() / run.ledger.largest_energy(), ", p ", p,
                ", L ", L, ", solves a step ", all.solves_a_step());
        check_books(run);
        CHECK(p < 1e-12);
        CHECK(L < 1e-12);
        CHECK(all.solves_a_step() <= 12);
        CHECK(run.ledger.row().rotation_work == 0);
    }
}

TEST_CASE("T2 theta above one half brakes a spin as booked") {
    for (const double turn : {0.005, 0.02}) {
        CAPTURE(turn);
        Run run(body(bar_mesh(4, 4, 1, 1)), implicit(1));
        set_motion(
            run, [](const Vec2&) { return Vec2(0, 0); },
            [](const Vec2& x) -> Vec2 { return 50 * turned_left(x - Vec2(0.5, 0.5)); });
        const double h = turn / 50;
        run_until(run, 40 * h, h);  // the body has stretched
        const double before = run.ledger.row().kinetic, booked = run.ledger.row().scheme_dissipation;
        run_until(run, 120 * h, h);
        const double lost = before - run.ledger.row().kinetic;
        const double rate = std::log(before / run.ledger.row().kinetic) / (80 * h), law = 2 * 0.5 * h * 50 * 50;
        MESSAGE("omega h ", turn, ": loss ", rate, " for ", law, " per second");
        CHECK(rate == relative(law, 0.05));
        CHECK(run.ledger.row().scheme_dissipation - booked == relative(lost, 1e-2));
        check_books(run);
    }
}

TEST_CASE("T3 a column at rest does not see how it is turned") {
    const auto rest = [](double angle) {
        ModelInput input = body(bar_mesh(2, 10, 0.4, 2));
        const Vec2 g = turned({2, -9.81}, angle);
        input.loads = {load(Load::Kind::velocity, "bottom", 0, 0), weight};
        input.loads[1].value = {g.x(), g.y()};
        Run run(std::move(input), implicit(1));
        turn(run, angle);
        const double h = 0.05;  // 1000 passages of a wave through a triangle
        run_until(run, 10 * h, h);
        const State before = run.now;
        const Counts counts = run_until(run, 30 * h, h);
        double creep = 0;
        for (std::size_t i = 0; i < before.displacement.size(); ++i)
            creep = std::max(creep, (run.now.displacement[i] - before.displacement[i]).norm());
        CHECK(creep < 1e-12);
        CHECK(counts.solves_a_step() <= 4);
        return run.ledger.row().strain;
    };
    const double upright = rest(0);
    for (const double angle : {120 * degree, -75 * degree}) CHECK(rest(angle) == relative(upright, 1e-7));
}

TEST_CASE("T4 a block slides down an inclined obstacle in implicit steps") {
    const double incline = 30 * degree, mu = 0.3, g = 9.81, a = g * (std::sin(incline) - mu * std::cos(incline));
    for (const double theta : {1.0, 0.55}) {
        for (const double h : {1e-3, 1e-2}) {
            CAPTURE(theta);
            CAPTURE(h);
            // the corner sinks, and the block strains, by 2.1e-9 of the way, as 1/E: by 2.1e-7 with the E of `rock`
            ModelInput input = turning_body(bar_mesh(4, 2, 0.4, 0.2), {.density = 2500, .E = 1e12, .nu = 0.2},
                                            CohesiveLaw::unbreakable());
            Obstacle slope{.name = "slope", .outline = {.kind = Outline::Kind::half_plane}};
            slope.contact.friction = mu;
            input.obstacles = {slope};
            input.loads = {weight};
            input.loads[0].value = {-g * std::sin(incline), -g * std::cos(incline)};
            Run run(std::move(input), implicit(theta));
            run_until(run, 0.2, h);
            const double t = run.now.time;
            CHECK(-run.u(0, 0).x() == relative(0.5 * a * t * (t + (2 * theta - 1) * h), 1e-8));
            check_books(run);
        }
    }
}

TEST_CASE("T5 a warm block that turned has no stress and one that spins while it warms closes its books") {
    // the strain is 1e-3 at 100 K
    const auto field = [](const std::string& formula, TimeFunction history) {
        auto heat = std::make_shared<Heat>();
        heat->field = {Expression(formula), std::move(history)};
        heat->materials.push_back({.expansion = {.coefficient = 1e-5}});
        return heat;
    };
    ModelInput input = body(bar_mesh(4, 4, 1, 1));
    input.heat = field("100", {});
    const double e = (1 + rock.nu) * 1e-3;
    Run run(input, implicit(1));
    set_motion(
        run, [&](const Vec2& x) -> Vec2 { return (1 + e) * turned(x, 77 * degree) - x; },
        [](const Vec2&) { return Vec2(0, 0); });
    run_until(run, 0.1, 1e-2);
    double largest = 0;
    for (Index t = 0; t < run.model.mesh.n_triangles(); ++t)
        largest = std::max(largest, stress(run.model, run.now, t).head<2>().cwiseAbs().maxCoeff());
    CHECK(largest < 1e-11 * rock.E * 1e-3);

    input.heat = field("100 + 30*x", {.time = {0, 0.01, 0.02}, .value = {0, 1, 0.5}});
    Run warming(std::move(input), implicit());
    set_spinning(warming);
    run_until(warming, 0.03, 1e-3);
    CHECK(warming.ledger.row().thermal_work != 0);
    check_books(warming);
}

TEST_CASE("a piece that turns costs no factorisation and one that bends that of its triangles") {
    const Model model = make_model(body(bar_mesh(12, 2, 1.2, 0.2)));
    ImplicitBulk bulk(model, MassMatrix::lumped);
    ThetaMatrix matrix(model, MassMatrix::lumped, {}, bulk.frames());
    CornerPartition nodes;
    partition_corners(model, std::vector<std::uint8_t>(model.fans.size(), 0), nodes);
    State state = initial_state(model);
    StepContext step;
    step.begin = &state, step.h = 1e-3;
    std::vector<Vec2> rate(model.mesh.n_corners(), Vec2::Zero()), ignored;
    /// Whether the factor changes, and the error of a solution.
    const auto changes = [&] {
        bulk.begin_step(step);
        bulk.linearise(rate);
        bulk.set_nodes(nodes, rate, ignored);
        const bool other = matrix.set(nodes, step.stiffness_factor());
        REQUIRE(matrix.factorise({}));
        std::vector<Vec2> right_side(nodes.n_nodes()), solution, error;
        for (Index i = 0; i < nodes.n_nodes(); ++i) right_side[i] = Vec2(std::sin(3 * i), std::cos(7 * i));
        REQUIRE(matrix.solve(right_side, solution));
        error = right_side;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            const ElementMatrix M_hat = matrix.element(t);
            for (Index i = 0; i < 3; ++i)
                for (Index j = 0; j < 3; ++j)
                    error[nodes.node_of_corner[3 * t + i]] -=
                        M_hat.block<2, 2>(2 * i, 2 * j) * solution[nodes.node_of_corner[3 * t + j]];
        }
        for (const Vec2& r : error) CHECK(r.norm() < 1e-9);
        return other;
    };
    const auto move = [&](const std::function<Vec2(const Vec2&)>& place) {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            state.displacement[state.node_of_corner[c]] = place(model.mesh.corner(c)) - model.mesh.corner(c);
    };
    CHECK(changes());
    for (const double angle : {0.3, 2.0, 4.0}) {
        move([&](const Vec2& x) { return turned(x, angle); });
        CHECK_FALSE(changes());
    }
    move([](const Vec2& x) {  // along an arc of 0.6 rad
        const double angle = 0.5 * x.x();
        return Vec2((2 - x.y()) * std::sin(angle), (x.y() - 2) * std::cos(angle));
    });
    CHECK(changes());
    CHECK_FALSE(changes());
}

namespace {

/// What is at this place is held, or led along one axis.
Load led(const Vec2& place, std::optional<double> x, std::optional<double> y) {
    const Vec2 around(1e-6, 1e-6);
    return {.kind = Load::Kind::displacement,
            .on = {.boundary = "", .box = Box{place - around, place + around}},
            .value = {x, y}};
}

}  // namespace

TEST_CASE("a pendulum swings as a rigid one in implicit steps") {
    ModelInput input = body(bar_mesh(8, 1, 1, 0.125));
    input.loads = {led({0, 0}, 0, 0), weight};
    Run run(std::move(input), implicit());
    double md = 0, I = 0;  // about the pivot
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Vec2 x = run.model.mesh.corner(c);
        md += run.model.corner_mass[c] * x.x(), I += run.model.corner_mass[c] * x.squaredNorm();
    }
    // from the height of its pivot to that height on the other side: half of a period
    const double offset = std::atan(0.125);
    turn(run, -offset);
    constexpr double K = 1.8540746773013719;  // elliptic integral of the first kind, k^2 = 1/2
    const double half_period = 2 * K * std::sqrt(I / (9.81 * md / std::cos(offset)));
    run_until(run, half_period, half_period / 100);
    const Vec2 tip = run.u(14, 1) + run.model.mesh.corner(14, 1);
    CHECK((tip - turned({-1, 0}, -offset)).norm() < 1e-5);
    CHECK(run.ledger.row().kinetic < 1e-6 * run.ledger.largest_energy());
    check_books(run);
}

TEST_CASE("a ladder slides along two axes as in explicit steps") {
    const auto slide = [](const SchemeOptions& scheme, double h) {
        ModelInput input = body(bar_mesh(6, 1, 0.6, 0.1));
        input.materials[0].E = 1e8;
        input.loads = {led({0, 0}, 0, {}), led({0.6, 0}, {}, 0), weight};
        input.loads[2].value = {-9.81, 2};
        Run run(std::move(input), scheme);
        run_until(run, 0.4, h);
        check_books(run);
        return std::array{run.u(0, 0), run.u(10, 1)};
    };
    const auto large = slide(implicit(), 4e-3), small = slide({}, 2e-4);
    CHECK(large[0].x() == 0);
    CHECK(large[1].y() == 0);
    CHECK(large[0].y() == relative(small[0].y(), 5e-3));
    CHECK(large[1].x() == relative(small[1].x(), 5e-3));
}

TEST_CASE("T11 a slender cantilever bends far under a growing load") {
    ModelInput input = body(bar_mesh(20, 2, 2, 0.1));
    input.materials[0].E = 3e8;
    input.loads = {load(Load::Kind::displacement, "left", 0, 0), weight};
    input.loads[1].value = {0, -9.81 * 20};
    input.loads[1].history = {.time = {0, 4}, .value = {0, 1}};
    const auto tip = [&](double h) {
        Run run(input, implicit(1));
        const Counts counts = run_until(run, 4, h);
        MESSAGE(h, " s: solves a step ", counts.solves_a_step(), ", tip ", run.u(38, 1).y());
        CHECK(counts.solves_a_step() < 20);
        check_books(run);
        return run.u(38, 1);
    };
    const Vec2 large = tip(0.04), small = tip(0.02);
    CHECK(small.y() < -1);  // of a length of 2
    CHECK((large - small).norm() < 1e-2 * small.norm());
}

TEST_CASE("a step in which a piece turns too far is rejected") {
    Run run(body(bar_mesh(4, 4, 1, 1)), implicit());
    set_spinning(run);
    CHECK_FALSE(run.step_if_taken(0.5 / 50));
    CHECK(run.last.rejection == Rejection::turn);
    CHECK(run.last.rejected_value == relative(0.5, 0.05));
}

TEST_CASE("damping of vibrations leaves a turned piece its spin in implicit steps") {
    SchemeOptions scheme = implicit();
    scheme.damping = 300;
    Run run(body(bar_mesh(4, 4, 1, 1)), scheme);
    const auto stretch = [](const Vec2& x) { return Vec2(1e-4 * (x.x() - 0.5), 0); };
    set_motion(
        run, [&](const Vec2& x) -> Vec2 { return turned(x + stretch(x), 2) - x; },
        [&](const Vec2& x) -> Vec2 {
            return turned(5 * turned_left(x + stretch(x) - Vec2(0.5, 0.5)) + Vec2(1, 0), 2);
        });
    const Momenta start = momenta(run);
    run_until(run, 0.1, 1e-3);
    const Momenta end = momenta(run);
    CHECK((end.linear - start.linear).norm() < 1e-10 * start.linear.norm());
    CHECK(end.angular == relative(start.angular, 1e-10));
    CHECK(run.ledger.row().damping_work < 0);
    check_books(run, 1e-11);  // displacements of 2 m round off
}

TEST_CASE("a body that turns changes between the schemes with closed books") {
    SchemeOptions scheme;
    scheme.bulk = BulkScheme::automatic, scheme.cohesion = CohesionScheme::implicit_beta;
    Run run(body(bar_mesh(4, 4, 1, 1)), scheme);
    begin_theta_scheme(run.now);
    set_spinning(run);
    run.now.rate.clear(), begin_theta_scheme(run.now);
    const Momenta start = momenta(run);
    run_until(run, 0.02, 1e-3);
    begin_leapfrog(run.now);
    const double h = 0.5 * run.stepper.stable_step();
    for (int i = 0; i < 200; ++i) run.step(h);
    State end;
    const StepReport closing = run.stepper.close_leapfrog(run.now, end);
    REQUIRE(closing.rejection == Rejection::none);
    run.now = end;
    run.ledger.add(run.now, closing);
    run_until(run, run.now.time + 0.02, 1e-3);
    CHECK(momenta(run).angular == relative(start.angular, 1e-6));  // the stage of explicit steps starts half a step off
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
}

namespace {

/// A beam that is clamped on its left, breakable near there, and a free disc that falls on it.
ModelInput beam_with_disc() {
    ModelInput input = body(bar_mesh(8, 2, 1, 0.1), {.sigma_c = 1e6, .G_c = 1e3, .gamma = 1, .friction = 0.5});
    input.materials[0].E = 2e7;
    input.loads = {load(Load::Kind::displacement, "left", 0, 0), weight};
    Obstacle disc{.name = "disc", .outline = {.kind = Outline::Kind::disc, .radius = 0.08}};
    disc.start.position = {0.8, 0.182};
    for (Drive& drive : disc.drive) drive.kind = Drive::Kind::free;
    disc.mass = 20, disc.inertia = 0.5 * disc.mass * 0.08 * 0.08;
    disc.forces = {{.value = {0, -9.81 * disc.mass, 0}, .history = {}}};
    disc.contact.friction = 0.4;
    input.obstacles = {disc};
    return input;
}

}  // namespace

TEST_CASE("steps with large rotations follow from their state alone") {
    // so a run goes on from a checkpoint with the same bits; the beam bends by 0.3 rad
    const SchemeOptions scheme = implicit(0.6);
    Run run(beam_with_disc(), scheme);
    run_until(run, 0.1, 2e-3);
    CHECK(run.ledger.row().kinetic > 0);
    check_books(run, 1e-11);
    MoreauJean other(run.model, scheme);
    State now = run.now, next;
    for (int i = 0; i < 5; ++i) {
        run.step(2e-3);
        REQUIRE(other.step(now, 2e-3, next).rejection == Rejection::none);
        std::swap(now, next);
        CHECK(same_bits(now, run.now));
    }
}

TEST_CASE("a driven obstacle turns a block with it") {
    ModelInput input = body(bar_mesh(3, 2, 0.3, 0.2));
    for (Vec2& x : input.mesh.vertices) x += Vec2(0.5, 0.05);
    input.loads = {weight};
    Obstacle paddle{.name = "paddle", .outline = {.kind = Outline::Kind::half_plane}};
    paddle.start.position = {0, 0.05};
    paddle.drive[2] = {.kind = Drive::Kind::velocity, .value = 0.2, .history = {.time = {0, 0.5}, .value = {0, 1}}};
    paddle.contact.friction = 0.6;
    input.obstacles = {paddle};
    Run run(std::move(input), implicit(0.8));
    run_until(run, 1.6, 4e-3);
    const double angle = run.now.obstacles[0].pose.angle;             // its tangent is less than the friction
    CHECK(angle == relative(0.2 * (0.25 + 1.1 + 0.3 * 4e-3), 1e-6));  // a step moves with v + theta (v+ - v)
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Vec2 x = run.model.mesh.corner(c), pivot(0, 0.05);
        CHECK((x + run.now.displacement_of(c) - pivot - turned(x - pivot, angle)).norm() < 2e-3);
    }
    check_books(run, 400 * 1e-10);  // 400 steps, each balanced to 1e-10 of momenta and forces (126 N s)
}

TEST_CASE("a block tips over the edge of its support as in explicit steps") {
    const auto tip = [](const SchemeOptions& scheme, double h) {
        ModelInput input = body(bar_mesh(2, 6, 0.2, 0.6));
        input.materials[0].E = 1e8;
        input.laws.push_back({.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = 0.9});
        input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1}};
        input.loads = {weight};
        input.loads[0].value = {4.5, -9.81};
        Run run(std::move(input), scheme);
        run_until(run, 0.4, h);
        check_books(run, scheme.takes_implicit_steps() ? 1e-12 : 1e-11);
        const Vec2 across = run.mean_velocity([](Index) { return true; });
        return across;
    };
    const Vec2 large = tip(implicit(0.55), 2e-3), small = tip({}, 1e-4);
    CHECK(small.norm() > 0.3);
    CHECK((large - small).norm() < 0.02 * small.norm());
}

namespace {

const CohesiveLaw glue{.sigma_c = 5e6, .G_c = 20, .gamma = 1, .friction = 0.5};

struct Ended {
    std::vector<Vec2> place, velocity;  // per corner, turned back
    std::vector<double> cohesion;       // per point
    std::vector<Vec2> opening;
};

/// A bar under pressure that is turned at the start and then pulled apart, sheared and spun by its motion.
Ended run_turned(const SchemeOptions& scheme, double angle) {
    ModelInput input = body(bar_mesh(6, 2, 0.3, 0.1), glue);
    input.loads = {{.kind = Load::Kind::stress, .on = {.boundary = "top", .box = {}}}};
    input.loads[0].stress = {-1e5, -1e5, 0};
    Run run(std::move(input), scheme);
    set_motion(
        run, [&](const Vec2& x) -> Vec2 { return turned(x, angle) - x; },
        [&](const Vec2& x) {
            return turned({14 * (x.x() - 0.1), 30 * x.x() - 8 * x.y()}, angle);
        });
    run_until(run, 5e-4, 2e-5);
    check_books(run);
    Ended ended;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        ended.place.push_back(turned(run.model.mesh.corner(c) + run.now.displacement[node], -angle));
        ended.velocity.push_back(turned(run.now.velocity[node], -angle));
    }
    for (Index p = 0; p < run.model.n_points(); ++p) {
        ended.cohesion.push_back(cohesion(run.model, run.now, p));
        ended.opening.push_back(opening(run.model, run.now, p));
    }
    return ended;
}

double difference(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::max(worst, (a[i] - b[i]).norm()), largest = std::max(largest, b[i].norm());
    return worst / largest;
}

}  // namespace

TEST_CASE("cracks in implicit steps do not depend on how a body is turned") {
    for (const CohesionScheme cohesion : {CohesionScheme::explicit_beta, CohesionScheme::implicit_beta}) {
        CAPTURE(std::string(name_of(cohesion)));
        SchemeOptions scheme = implicit();
        scheme.cohesion = cohesion, scheme.respect_assumption_1 = false;
        const Ended straight = run_turned(scheme, 0);
        std::int64_t damaged = 0;
        for (const double beta : straight.cohesion) damaged += beta < 1;
        CHECK(damaged > 0);
        const Ended found = run_turned(scheme, -2.7);
        CHECK(difference(found.place, straight.place) <= 1e-9);
        CHECK(difference(found.velocity, straight.velocity) <= 1e-7);
        CHECK(difference(found.opening, straight.opening) <= 1e-7);
        for (std::size_t p = 0; p < found.cohesion.size(); ++p)
            CHECK(std::abs(found.cohesion[p] - straight.cohesion[p]) <= 1e-7);
    }
}

TEST_CASE("a closed crack keeps its slip while its body turns") {
    // two halves that slipped by 0.1 mm are pressed on each other, and the body turns by a quarter
    ModelInput input = body(bar_mesh(4, 2, 0.4, 0.2));
    for (Index t = 0; t < input.mesh.n_triangles(); ++t) input.mesh.region[t] = input.mesh.centroid(t).y() > 0.1;
    input.materials.push_back(rock);
    input.laws.push_back({.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = 0.5});
    input.law_of_pair = {{0, 1}, {1, 0}};
    for (const char* side : {"top", "bottom"}) {
        input.loads.push_back({.kind = Load::Kind::stress, .on = {.boundary = side, .box = {}}});
        input.loads.back().stress = {-1e5, -1e5, 0};
    }
    Run run(std::move(input), implicit(1));
    const auto is_joint = [&](const FanPoint& point) { return !unbreakable(run.model, point); };
    for (Index f = 0; f < static_cast<Index>(run.model.fans.size()); ++f)
        if (std::ranges::any_of(run.model.points(run.model.fans[f]), is_joint)) split(run.model, f, run.now);
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Index node = run.now.node_of_corner[c];
        run.now.displacement[node] = Vec2(run.model.mesh.region[c / 3] == 1 ? 1e-4 : 0, 0);
        run.now.velocity[node] =
            20 * turned_left(run.model.mesh.corner(c) + run.now.displacement[node] - Vec2(0.2, 0.1));
    }
    run.ledger = EnergyLedger(run.model, run.now);
    const Counts counts = run_until(run, 0.5 * pi / 20, 2e-3);
    MESSAGE("solves a step ", counts.solves_a_step());
    double pressed = 0;  // [N]
    for (Index p = 0; p < run.model.n_points(); ++p) {
        const FanPoint& point = run.model.fan_points[run.model.fan_point_of[p]];
        if (!is_joint(point)) continue;
        const Vec2 u = opening(run.model, run.now, p);
        CHECK(std::abs(u.y()) == relative(1e-4, 1e-6));
        CHECK(std::abs(u.x()) < 1e-9);
        pressed += point.area * traction(run.model, run.now, p).x();
    }
    // the work of the couple of forces that act where their sides are, over a quarter of a turn
    CHECK(run.ledger.row().rotation_work == relative(0.5 * pi * pressed * 1e-4, 0.03));
    check_books(run);
}

}  // namespace turning_bodies_test
