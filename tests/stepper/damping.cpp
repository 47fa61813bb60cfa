// Mass-proportional damping of the explicit bulk: its decay, its order, its work in the energy balance, and what it
// leaves of the motion of pieces that nothing holds.
#include "analysis/fragments.hpp"
#include "model/make_model.hpp"
#include "properties/wild_body.hpp"
#include "stepper/adapt/excavation.hpp"
#include "support/obstacles.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace damping_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double alpha = 0.2;  // [1/s]

/// A triangle on two fixed vertices. Its third one, of mass 1, moves in x against a stiffness of 1: omega = 1.
ModelInput oscillator() {
    ModelInput input = point_masses({}, false);
    input.supports.clear();
    input.materials = {{.density = 3, .E = 2, .nu = 0}};  // mu = 1; the shear angle is u
    input.loads = {load(Load::Kind::displacement, "base", 0.0, 0.0)};
    Load guide{.kind = Load::Kind::displacement, .on = {.boundary = "", .box = Box{{0.5, 0.5}, {1.5, 1.5}}}};
    guide.value[1] = 0.0;
    input.loads.push_back(guide);
    return input;
}

/// With absorbing boundaries, too: the largest error of the energy balance so far, over the largest energy or work.
class Balance {
public:
    void add(const StepReport& r) {
        const double energy = r.kinetic + r.strain;
        damping_ += r.damping_work, radiated_ += r.radiated_work;
        work_ += r.external_work - r.cohesive_work + r.impact_work + r.friction_work + r.step_change_work +
                 r.rotation_work + r.damping_work + r.radiated_work;
        largest_ = std::max({largest_, energy, std::abs(r.external_work), -damping_, std::abs(r.cohesive_work)});
        error_ = std::max(error_, std::abs(energy - start_ - work_));
        if (damping_of_ == DampingOf::motion) CHECK(r.damping_work <= 0);
        CHECK(r.radiated_work <= 0);
    }
    explicit Balance(double start, DampingOf damping_of = DampingOf::motion)
        : start_(start), largest_(start), damping_of_(damping_of) {}
    double error() const { return largest_ > 0 ? error_ / largest_ : 0; }
    double damping() const { return damping_; }

private:
    double start_, largest_, work_ = 0, damping_ = 0, radiated_ = 0, error_ = 0;
    DampingOf damping_of_;
};

/// Of the whole body about the origin, at the places of the middle of the last step, to which velocities belong.
struct Momenta {
    explicit Momenta(const Run& run) {
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            const Index node = run.now.node_of_corner[c];
            const Vec2 p = run.model.corner_mass[c] * run.now.velocity[node];
            linear += p, angular += cross(run.model.mesh.corner(c) + run.now.displacement[node], p);
        }
    }
    Vec2 linear = Vec2::Zero();
    double angular = 0;
};

/// Two blocks of 1 x 1 m side by side; `apart` [m]: the gap between them.
ModelInput two_blocks(double apart) {
    ModelInput input = free_block(1, CohesiveLaw::unbreakable());
    const Mesh left = input.mesh;
    Mesh& mesh = input.mesh;
    const auto n = static_cast<Index>(left.vertices.size()), n_triangles = left.n_triangles();
    for (const Vec2& x : left.vertices) mesh.vertices.push_back(x + Vec2(1 + apart, 0));
    for (const auto& t : left.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    for (auto edge : left.interior_edges) {
        for (Index& t : edge.triangle) t += n_triangles;
        mesh.interior_edges.push_back(edge);
    }
    for (auto edge : left.boundary_edges) edge.triangle += n_triangles, mesh.boundary_edges.push_back(edge);
    mesh.region.resize(mesh.triangles.size(), 0);
    input.large_rotation = true;
    input.contact_of_pair = {{{.friction = 0.3}}};
    return input;
}

}  // namespace

TEST_CASE("damping: a free oscillation decays by half of it and to second order") {
    const auto error_at = [](double h) {
        Run run(oscillator(), {.damping = alpha});
        const Index apex = run.now.node_of_corner[2];
        run.now.velocity[apex].x() = 1;
        Balance balance(0.5);
        const double until = 10, omega = std::sqrt(1 - 0.25 * alpha * alpha);
        for (int i = 0; i < std::lround(until / h); ++i) balance.add(run.step(h));
        CHECK(balance.error() < 1e-13);
        CHECK(balance.damping() < -0.4);
        return run.now.displacement[apex].x() - std::exp(-0.5 * alpha * until) * std::sin(omega * until) / omega;
    };
    const double coarse = error_at(0.1), fine = error_at(0.05), finest = error_at(0.025);
    CHECK(coarse / fine == relative(4, 0.02));
    CHECK(fine / finest == relative(4, 0.005));
    CHECK(std::abs(finest) < 2e-4);
}

TEST_CASE("damping: implicit steps decay as their equation says and to second order and lose what they book") {
    const auto error_at = [](double h, double theta) {
        Run run(oscillator(), {.bulk = BulkScheme::implicit_theta, .theta = theta, .damping = alpha});
        const Index apex = run.now.node_of_corner[2];
        run.now.velocity[apex].x() = 1;
        Balance balance(0.5);
        double u = 0, v = 1, lost = 0;
        const double until = 10, omega = std::sqrt(1 - 0.25 * alpha * alpha), d = theta * h * alpha;
        for (int i = 0; i < std::lround(until / h); ++i) {
            const double w = (v - theta * h * u) / (1 + d + theta * theta * h * h);  // of mass and stiffness 1
            u += h * w, v = (w - (1 - theta) * v) / theta, lost += h * alpha * w * w;
            StepReport report = run.step(h);
            report.external_work -= report.scheme_dissipation;
            balance.add(report);
        }
        CHECK(run.now.displacement[apex].x() == relative(u, 1e-12));
        CHECK(run.now.velocity[apex].x() == relative(v, 1e-12));
        CHECK(-balance.damping() == relative(lost, 1e-12));
        CHECK(balance.error() < 1e-13);
        return u - std::exp(-0.5 * alpha * until) * std::sin(omega * until) / omega;
    };
    const double coarse = error_at(0.1, 0.5), fine = error_at(0.05, 0.5);
    CHECK(coarse / fine == relative(4, 0.02));
    error_at(3, 1), error_at(50, 0.5);
}

TEST_CASE("damping: implicit steps leave a free piece its flight and its spin and take its vibration") {
    for (const double h : {0.01, 0.5}) {
        ModelInput input = free_block(1, CohesiveLaw::unbreakable());
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
        input.initial_velocities = {{.on = {}, .value = {3, 1}, .spin = 2.0}};
        input.obstacles = {boulder({5, 5}, 1, {3, 1})};
        SchemeOptions scheme{.bulk = BulkScheme::implicit_theta, .damping = 5};
        if (h > 0.1) scheme.mass = MassMatrix::consistent;
        Run run(input, scheme);
        double energy = 0, mass = 0, spin_of_wave = 0, inertia = 0;  // of a wave along x
        Vec2 centre = Vec2::Zero(), momentum = Vec2::Zero();
        for (const Fan& fan : run.model.fans)
            mass += fan.mass, centre += fan.mass * run.model.mesh.vertices[fan.vertex];
        for (std::size_t f = 0; f < run.model.fans.size(); ++f) {
            const Fan& fan = run.model.fans[f];
            const Vec2 x = run.model.mesh.vertices[fan.vertex], wave(0.1 * std::cos(std::numbers::pi * x.x()), 0),
                       y = x - centre / mass;
            run.now.velocity[f] += wave;
            energy += 0.5 * fan.mass * wave.squaredNorm(), momentum += fan.mass * wave;
            spin_of_wave += fan.mass * cross(y, wave), inertia += fan.mass * y.squaredNorm();
        }
        const double vibration =
            energy - 0.5 * momentum.squaredNorm() / mass - 0.5 * spin_of_wave * spin_of_wave / inertia;
        const auto angular = [&] {  // about the centre, of the undeformed body
            double sum = 0;
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                sum += run.model.corner_mass[c] *
                       cross(run.model.mesh.corner(c) - Vec2(0.5, 0.5), run.now.velocity[run.now.node_of_corner[c]]);
            return sum;
        };
        const double spin = angular();
        const Momenta start(run);
        run.ledger = EnergyLedger(run.model, run.now, scheme.mass);
        double damping = 0, worst = -1;
        const int n = static_cast<int>(1 / h);
        for (int i = 0; i < n; ++i) {
            run.step(h), damping += run.last.damping_work, worst = std::max(worst, run.last.damping_work);
            if (i > 2) CHECK(run.last.linear_solves < 40);
        }
        const Momenta end(run);
        CAPTURE(h);
        CHECK((end.linear - start.linear - Vec2(0, -10 * n * h)).norm() < 1e-10);
        if (scheme.mass == MassMatrix::lumped) CHECK(std::abs(angular() - spin) < 1e-10);
        CHECK(worst <= 1e-14);
        if (scheme.mass == MassMatrix::lumped) CHECK(damping > -1.0001 * vibration);
        if (h < 0.1) CHECK(damping < -0.98 * vibration);  // exp(-alpha t) is left
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
        REQUIRE(run.now.free_pieces.size() == 1);
        CHECK(run.now.free_pieces[0].mass == relative(1));
        CHECK(run.now.obstacles[0].velocity.y() == relative(1 - 10 * n * h, 1e-12));
    }
}

TEST_CASE("damping: in implicit steps a piece at rest bears its weight and one that slides is braked by friction") {
    for (const DampingOf of : {DampingOf::vibration, DampingOf::motion})
        for (const double slope : {0.0, 0.2}) {  // [rad]
            ModelInput input = free_block(1, CohesiveLaw::unbreakable());
            input.materials[0].E = 1e4;
            input.obstacles = {platen({0, 0}, {0, 1}, {.friction = 0.1})};
            const double g = 10, weight = g * std::cos(slope),
                         push = g * std::sin(slope) - (slope > 0 ? 0.1 * weight : 0);
            input.loads = {load(Load::Kind::acceleration, "", g * std::sin(slope), -weight)};
            Run run(input, {.bulk = BulkScheme::implicit_theta, .theta = 1, .damping = 10, .damping_of = of});
            const double h = 0.02;
            for (int i = 0; i < 20; ++i) run.step(h);
            const double before = Momenta(run).linear.x();
            for (int i = 0; i < 20; ++i) {
                run.step(h);
                CHECK(run.last.damping_work <= 1e-12);
                CHECK(run.now.obstacles[0].reaction.y() == relative(-weight, 1e-3));
            }
            CAPTURE(slope);
            const double gained = Momenta(run).linear.x() - before;
            if (of == DampingOf::vibration)
                CHECK(gained == (slope > 0 ? relative(push * 20 * h, 1e-3) : within(0, 1e-8)));
            else if (slope > 0) CHECK(Momenta(run).linear.x() == relative(push / 10, 0.02));
            CHECK(run.ledger.largest_residual() < 1e-11 * run.ledger.largest_energy());
        }
}

TEST_CASE("damping: a free disc falls as its discrete equation says and its energy is accounted for") {
    ModelInput input = free_block(1, {});
    input.obstacles = {boulder({5, 5}, 1, {0.5, 0})};
    input.obstacles[0].initial_velocity.z() = 2;
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
    {
        Run run(input, {.bulk = BulkScheme::implicit_theta, .damping = alpha, .damping_of = DampingOf::motion});
        for (int i = 0; i < 10; ++i) run.step(0.1);
        const double kept = std::pow((1 - 0.05 * alpha) / (1 + 0.05 * alpha), 10);  // (1 - d)/(1 + d) in a step
        const Vec3& v = run.now.obstacles[0].velocity;
        CHECK(v.z() == relative(2 * kept, 1e-12));
        CHECK(v.y() == relative(-10 / alpha * (1 - kept), 1e-12));
        CHECK(run.mean_velocity([](Index) { return true; }).y() == relative(v.y(), 1e-12));
        CHECK(run.ledger.largest_residual() < 1e-13 * run.ledger.largest_energy());
    }
    Run run(input, {.damping = alpha, .damping_of = DampingOf::motion});
    const double h = 1e-3, start = 0.5 * 0.25 + 0.5 * 0.5 * 4;  // inertia m r^2/2
    Balance balance(start);
    for (int i = 0; i < 1000; ++i) balance.add(run.step(h));
    const double t = 999.5 * h, fall = std::exp(-alpha * t);  // velocities live at the middle of the steps
    const Vec3& v = run.now.obstacles[0].velocity;
    CHECK(v.x() == relative(0.5 * fall, 1e-6));
    CHECK(v.y() == relative(-10 / alpha * (1 - fall), 1e-6));
    CHECK(v.z() == relative(2 * fall, 1e-6));
    CHECK(run.mean_velocity([](Index) { return true; }).y() == relative(v.y(), 1e-12));
    CHECK(balance.error() < 1e-13);
}

TEST_CASE("damping: random bodies with cracks and friction and obstacles close their energy balance") {
    int n = 0, n_broken = 0, n_absorbing = 0, n_free = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        WildBody wild = WildBodies(seed).body();
        if (wild.body.scheme.bulk != BulkScheme::explicit_lumped || !wild.body.input.obstacles.empty() != (seed % 2))
            continue;
        const double h = wild.safety * Run(wild.body.input, wild.body.scheme).stepper.stable_step();
        wild.body.scheme.damping_of = seed % 4 < 2 ? DampingOf::motion : DampingOf::vibration;
        wild.body.scheme.damping = 0.1 * static_cast<double>(1 + seed % 7) / h;  // up to a half of the motion in a step
        if (const auto& loads = wild.body.input.loads;
            wild.body.input.supports.empty() && seed % 3 != 0 && std::ranges::none_of(loads, &Load::drives))
            wild.body.scheme.absorbing = {{.boundary = "right"}}, ++n_absorbing;
        Run run(wild.body.input, wild.body.scheme);
        Balance balance(run.ledger.row().kinetic + run.ledger.row().strain, wild.body.scheme.damping_of);
        bool taken = true;
        for (int i = 0; i < wild.n_steps && taken; ++i) {
            taken = run.step_if_taken(i % 3 ? h : 0.6 * h);
            if (taken) balance.add(run.last), n_free += !run.now.free_pieces.empty();
            // a sliver that flies off and turns too far in a step, which the gate of a run sees, ends it here
            taken = taken && run.ledger.row().strain >= -0.1 * run.ledger.row().kinetic;
        }
        INFO("seed " << seed);
        CHECK(balance.error() < 1e-12);
        for (const PointState& point : run.now.points) n_broken += point.cohesion == 0;
        ++n;
    }
    CHECK(n > 50);
    CHECK(n_absorbing > 5);
    CHECK(n_broken > 100);
    CHECK(n_free > 1000);
}

TEST_CASE("damping: a piece that nothing holds falls and turns as without it and only its vibration decays") {
    for (const bool large : {false, true}) {
        ModelInput input = free_block(1, CohesiveLaw::unbreakable());
        input.large_rotation = large;
        input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
        input.initial_velocities = {{.on = {}, .value = {3, 1}, .spin = large ? 2.0 : 0.0}};
        input.obstacles = {boulder({5, 5}, 1, {3, 1})};
        input.obstacles[0].initial_velocity.z() = 2;
        Run run(input, {.damping = 5});
        const double h = 0.5 * run.stepper.stable_step();
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {  // a wave along x, of no momentum
            const double x = run.model.mesh.corner(c).x();
            run.now.velocity[run.now.node_of_corner[c]].x() += 0.1 * std::cos(std::numbers::pi * x);
        }
        const auto vibration = [&] {  // of a body of mass 1, without the obstacle
            return run.ledger.row().kinetic + run.ledger.row().strain - 0.5 * Momenta(run).linear.squaredNorm() -
                   kinetic_energy(run.model.obstacles[0], run.now.obstacles[0].velocity);
        };
        const double spin = Momenta(run).angular - cross(Vec2(0.5, 0.5), Momenta(run).linear);
        run.ledger = EnergyLedger(run.model, run.now);
        double first = 0, last = 0, momentum = 1, gained = 0;
        for (int i = 0; i < 400; ++i) {
            run.step(h);
            if (i == 9) first = vibration();
            if (i == 109) last = vibration();
            const double k = i == 0 ? 0.5 * h : h, d = 0.5 * 5 * k;
            gained = (-10 * k + d * gained) / (1 + d), momentum += gained;
        }
        const Momenta end(run);
        const double fallen = 10 * 399.5 * h;
        CAPTURE(large);
        CHECK(std::abs(end.linear.x() - 3) < 1e-12);
        CHECK(std::abs(end.linear.y() - momentum) < 1e-11);
        CHECK(std::abs(end.linear.y() - (1 - fallen)) < 10 * h * (0.5 * 5 * h));  // g h d: the part of the last step
        const Vec3& v = run.now.obstacles[0].velocity;
        CHECK((v - Vec3(3, 1 - fallen, 2)).norm() < 1e-12);
        REQUIRE(run.now.free_pieces.size() == 1);
        if (large) CHECK(run.now.free_pieces[0].angular_momentum == relative(spin, 1e-11));
        if (!large) CHECK(std::log(first / last) == relative(5 * 100 * h, 0.02));
        CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
        CHECK(run.ledger.row().damping_work < 0);
    }
}

TEST_CASE("damping: a held piece beside one that flies has the same bits whatever damping is of") {
    ModelInput input = two_blocks(1);
    input.contact_of_pair.clear();
    input.supports = {{.on = {.boundary = "", .box = Box{{-0.1, -0.1}, {0.1, 1.1}}}, .law = 0, .glued = true}};
    input.loads = {load(Load::Kind::acceleration, "", 1.0, -1.0)};
    std::vector<State> ends;
    for (const DampingOf of : {DampingOf::motion, DampingOf::vibration}) {
        Run run(input, {.damping = 2, .damping_of = of});
        for (int i = 0; i < 300; ++i) run.step(0.8 * run.stepper.stable_step());
        ends.push_back(run.now);
        if (of == DampingOf::motion) CHECK(run.now.free_pieces.empty());
        else CHECK(run.now.free_pieces.size() == 1);
    }
    const Run run(input);
    int n_same = 0, n_other = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const Vec2 a = ends[0].velocity[ends[0].node_of_corner[c]], b = ends[1].velocity[ends[1].node_of_corner[c]];
        const bool held = run.model.mesh.corner(c).x() <= 1;
        if (held) CHECK(a == b), ++n_same;
        else n_other += a != b;
    }
    CHECK(n_same > 0);
    CHECK(n_other == n_same);
}

TEST_CASE("damping: pieces that collide exchange momentum alone and fly on with all of it") {
    ModelInput input = two_blocks(0.01);
    input.initial_velocities = {{.on = {.boundary = "", .box = Box{{-0.1, -0.1}, {1.005, 1.1}}}, .value = {0.1, 0.02}}};
    Run run(input, {.damping = 1});
    const Momenta start(run);
    const double h = 0.4 * run.stepper.stable_step();
    std::optional<double> met;
    for (int i = 0; i < 1000; ++i) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
        if (run.last.approach > 0 && !met) met = run.last.approach_place.x();
    }
    const Momenta end(run);
    REQUIRE(met);
    CHECK(*met == relative(1.01, 1e-4));  // of the moved body, as the place of a cutback
    CHECK(run.now.free_pieces.size() == 2);
    CHECK(run.mean_velocity([&](Index t) { return t >= run.model.mesh.n_triangles() / 2; }).x() > 0.04);
    CHECK((end.linear - start.linear).norm() < 1e-13);
    CHECK(end.angular == relative(start.angular, 1e-5));
    CHECK(run.ledger.largest_residual() < 1e-12 * run.ledger.largest_energy());
}

TEST_CASE("damping: an excavation beside a piece that flies leaves its momentum to the last bits") {
    ModelInput input = two_blocks(1);
    input.contact_of_pair.clear();
    input.large_rotation = false;
    input.supports = {{.on = {.boundary = "", .box = Box{{-0.1, -0.1}, {0.1, 1.1}}}, .law = 0, .glued = true}};
    input.loads = {load(Load::Kind::acceleration, "", 1.0, -1.0)};
    const Model whole = make_model(input);
    const double h = 0.5 * MoreauJean(whole, {}).stable_step();
    const SchemeOptions scheme{.damping = 0.2 / h};  // d = 0.1: a tenth of an impulse comes one step late
    const auto momentum = [&](bool excavated) {
        Model model = whole;
        State now = initial_state(model), next = now;
        std::optional<MoreauJean> stepper(std::in_place, model, scheme);
        for (int i = 0; i < 60; ++i) {
            if (excavated && i == 30) {
                Excavated rest = excavate(model, now, std::array<Index, 1>{0});
                stepper.reset();
                model = std::move(rest.model), now = std::move(rest.state), next = now;
                stepper.emplace(model, scheme);
            }
            REQUIRE(stepper->step(now, h, next).rejection == Rejection::none);
            std::swap(now, next);
        }
        Vec2 sum = Vec2::Zero();
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            if (model.mesh.corner(c).x() > 1.5) sum += model.corner_mass[c] * now.velocity[now.node_of_corner[c]];
        return sum;
    };
    const Vec2 whole_one = momentum(false), other = momentum(true);
    CHECK(whole_one.x() > 50 * h);
    CHECK((other - whole_one).norm() < 1e-13 * whole_one.norm());
}

TEST_CASE("damping: a piece that rests on an obstacle bears its weight and one that slides is braked by friction") {
    for (const double slope : {0.0, 0.2}) {  // [rad]
        ModelInput input = free_block(1, CohesiveLaw::unbreakable());
        input.large_rotation = true;
        input.materials[0].E = 1e4;
        input.obstacles = {platen({0, 0}, {0, 1}, {.friction = 0.1})};
        const double g = 10;
        input.loads = {load(Load::Kind::acceleration, "", g * std::sin(slope), -g * std::cos(slope))};
        Run run(input, {.damping = 10});
        const double h = 0.8 * run.stepper.stable_step();
        while (run.now.time < 1) run.step(h);
        const auto momentum = [&] { return Momenta(run).linear; };
        const Vec2 before = momentum();
        const double since = run.now.time, weight = g * std::cos(slope);
        double impulse = 0;
        while (run.now.time < 2) run.step(h), impulse -= h * run.now.obstacles[0].reaction.y();
        const Vec2 gained = momentum() - before;
        const double t = run.now.time - since, d = 0.5 * 10 * h;
        CAPTURE(slope);
        CHECK(impulse == relative(weight * t, 0.01));
        CHECK(std::abs(gained.y() - (impulse - weight * t)) < 4 * d * weight * h);
        // at rest the block still rings at t = 1, and its friction with it: 2e-5 of the impulse of its weight
        const double pushed = (g * std::sin(slope) - 0.1 * weight) * t;
        CHECK(gained.x() == (slope > 0 ? relative(pushed, 0.01) : within(0, 2e-5 * weight * t)));
    }
}

TEST_CASE("damping: free are the fragments that nothing holds from the step on in which they break off") {
    ModelInput input = free_block(1, CohesiveLaw{.sigma_c = 1, .G_c = 1e-3, .gamma = 1});
    input.mesh = bar_mesh(8, 4, 2, 1);
    input.loads = {load(Load::Kind::displacement, "left", 0.0, 0.0),
                   load(Load::Kind::traction, "right", 4.0, 0.0, {.time = {0, 0.1, 0.4, 0.41}, .value = {0, 1, 1, 0}})};
    Run run(input, {.damping = 0.5});
    const double h = 0.8 * run.stepper.stable_step();
    std::size_t most = 0;
    for (int i = 0; run.now.time < 1; ++i) {
        std::vector<double> expected, found;  // masses of pieces
        if (i % 8 == 0) {
            const Fragments fragments = find_fragments(run.model, run.now);
            std::vector<bool> held(fragments.pieces.size(), false);
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                if (run.model.motion_of(c)) held[fragments.piece_of_triangle[run.model.mesh.triangle_of(c)]] = true;
            for (std::size_t p = 0; p < held.size(); ++p)
                if (!held[p]) expected.push_back(fragments.pieces[p].mass);
        }
        run.step(h);
        for (const PieceMotion& piece : run.now.free_pieces) found.push_back(piece.mass);
        std::ranges::sort(expected), std::ranges::sort(found);
        if (i % 8 > 0) continue;
        REQUIRE(found.size() == expected.size());
        for (std::size_t p = 0; p < found.size(); ++p) CHECK(found[p] == relative(expected[p]));
        most = std::max(most, found.size());
    }
    CHECK(most > 2);
}

}  // namespace damping_test
