// Excavation: what remains after triangles vanish, against closed forms and the body that lacked them from the start.
#include "stepper/adapt/excavation.hpp"
#include "model/make_model.hpp"

#include "mesh/triangulate.hpp"
#include "model/successor.hpp"
#include "support/plates.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace excavation_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double for_ever = 1e300;

/// A run whose body loses triangles.
class ExcavatedRun {
public:
    explicit ExcavatedRun(ModelInput input, const SchemeOptions& options = {}, bool in_equilibrium = false)
        : ExcavatedRun(make_model(std::move(input)), options, in_equilibrium) {}
    ExcavatedRun(Model made, const SchemeOptions& options, bool in_equilibrium)
        : model(std::move(made)), scheme(options), now(start(in_equilibrium)), ledger(model, now, options.mass) {
        stepper.emplace(model, scheme);
        h = 0.8 * stepper->stable_step();
    }

    void step() {
        last = stepper->step(now, h, next);
        REQUIRE(last.rejection == Rejection::none);
        std::swap(now, next);
        ledger.add(now, last);
    }

    /// The state at the end of the trial step remains in `next`, the model before in `before`.
    std::vector<CornerLoad> excavate(std::span<const Index> triangles, double ramp) {
        const StepReport report = stepper->step(now, h, next);
        REQUIRE(report.rejection == Rejection::none);
        std::vector<std::uint8_t> vanishes(model.mesh.n_triangles(), 0);
        for (const Index t : triangles) vanishes[t] = 1;
        std::vector<CornerLoad> forces = released_forces(model, now, next, scheme, vanishes);
        Excavated rest = knap::excavate(model, now, triangles, scheme.mass);
        std::ranges::copy(released_pressures(model, now, rest.model, rest.state), std::back_inserter(forces));
        trial = std::move(next), before = std::move(model);
        stepper.reset();
        model = std::move(rest.model), now = std::move(rest.state);
        if (ramp > 0) release(forces, now.time, ramp, model);
        stepper.emplace(model, scheme);
        next = now;
        ledger.excavate(rest.energies);
        return forces;
    }

    /// [m/s] Largest difference between the velocities of what remains and those of the trial step, in bonded fans.
    double off_trial() const {
        double largest = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            if (!model.has_vanished(model.mesh.triangle_of(c)) && trial.split_rank[before.fan_of_corner[c]] < 0)
                largest = std::max(
                    largest, (now.velocity[now.node_of_corner[c]] - trial.velocity[trial.node_of_corner[c]]).norm());
        return largest;
    }

    double residual() const { return ledger.largest_residual() / ledger.largest_energy(); }

    Model model, before;
    SchemeOptions scheme;
    State now, next, trial;
    EnergyLedger ledger;
    std::optional<MoreauJean> stepper;
    StepReport last;
    double h = 0;

private:
    State start(bool in_equilibrium) const {
        State state = initial_state(model);
        if (in_equilibrium) MoreauJean(model, scheme).start_in_equilibrium(state);
        return state;
    }
};

std::vector<Index> triangles_in_box(const Mesh& mesh, const Box& box) { return triangles_in(mesh, box.corners()); }

Vec2 momentum(const Model& model, const State& state) {
    Vec2 sum = Vec2::Zero();
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        sum += model.corner_mass[c] * state.velocity[state.node_of_corner[c]];
    return sum;
}

/// E = rho = 1, so that c = 1; n cells on a length of 1, held at its left end, pulled by sigma at the right one.
constexpr int n_cells = 200;
constexpr double sigma = 1e-3, height = 1. / n_cells, half = 0.5;
ModelInput pulled_bar() {
    ModelInput input =
        body_with(symmetric_bar_mesh(n_cells, 1, height), {.density = 1, .E = 1, .nu = 0}, CohesiveLaw::unbreakable());
    input.plane = PlaneModel::stress;
    input.loads = {load(Load::Kind::displacement, "left", 0.0, std::nullopt),
                   load(Load::Kind::traction, "right", sigma, 0.0)};
    return input;
}

/// Of the bar between a and b.
double mean_velocity(const ExcavatedRun& run, double a, double b) {
    double sum = 0, mass = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        if (const double x = run.model.mesh.corner(c).x(); x < a || x > b) continue;
        if (run.model.has_vanished(run.model.mesh.triangle_of(c))) continue;
        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]].x();
        mass += run.model.corner_mass[c];
    }
    return sum / mass;
}

/// A plate of 16 x 16 cells under its weight and a stress around it, at rest on its lower edge.
ModelInput plate(const CohesiveLaw& law, Index order = 1) {
    ModelInput input = body_with(bar_mesh(16, 16, 1, 1), {.density = 1, .E = 1, .nu = 0.2}, law);
    input.mesh.order = order;
    Load around = load(Load::Kind::stress, "left", std::nullopt, std::nullopt);
    around.stress = {-2e-3, -1e-3, 3e-4};
    for (const char* side : {"left", "right", "top"}) around.on.boundary = side, input.loads.push_back(around);
    input.loads.push_back({.kind = Load::Kind::acceleration, .value = {0.0, -2e-3}});
    input.loads.push_back(load(Load::Kind::displacement, "bottom", 0.0, 0.0));
    return input;
}

/// [m] Where the body has the point that can give back most.
Vec2 damaged_place(const ExcavatedRun& run) {
    Vec2 place = Vec2::Zero();
    double most = 0;
    for (std::size_t s = 0; s < run.now.split_fans.size(); ++s) {
        const auto points = run.model.points(run.model.fans[run.now.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const double recoverable = run.now.points[run.now.first_point[s] + j].cohesion *
                                       opening(run.model, run.now, points[j].point).norm();
            if (recoverable > most) most = recoverable, place = run.model.mesh.corner(points[j].corner());
        }
    }
    REQUIRE(most > 0);
    return place;
}

std::vector<Index> triangles_near(const Vec2& place, double distance, const Mesh& mesh) {
    return triangles_in(mesh, circle(place, distance, 12));
}

const CohesiveLaw strong{.sigma_c = 1, .G_c = 1, .gamma = 1, .friction = 0.5};
const Box gallery{{0.30, 0.30}, {0.70, 0.55}};

}  // namespace

TEST_CASE("excavation: a bar loses its pulled half at once and unloads with the velocity sigma/(rho c)") {
    ExcavatedRun run(pulled_bar(), {}, true);
    const double stored = run.ledger.row().strain;
    run.excavate(triangles_in_box(run.model.mesh, {{half, 0}, {1, height}}), 0);
    CHECK(run.ledger.row().excavated_energy == relative(0.5 * stored, 1e-9));
    const double start = run.now.time;
    while (run.now.time < start + 0.4) {
        run.step();
        // the wall pulls with sigma until the wave arrives
        const double time = run.now.time - 0.5 * run.h - start;
        CHECK(momentum(run.model, run.now).x() == relative(-sigma * height * time, 1e-9));
    }
    const double front = half - (run.now.time - start);
    CHECK(mean_velocity(run, front + 0.1, half) == relative(-sigma, 5e-3));
    CHECK(std::abs(mean_velocity(run, 0, front - 0.04)) < 1e-6 * sigma);
    CHECK(run.residual() < 1e-13);
    CHECK(run.ledger.row().excavation_work == 0);
}

TEST_CASE("excavation: over a ramp T the released force does the work -sigma^2 T/(6 rho c) on a bar") {
    ExcavatedRun run(pulled_bar(), {}, true);
    const double T = 0.2;
    const auto forces = run.excavate(triangles_in_box(run.model.mesh, {{half, 0}, {1, height}}), T);
    Vec2 total = Vec2::Zero();
    for (const CornerLoad& at : forces) total += at.force;
    CHECK(total.x() == relative(sigma * height, 1e-9));
    CHECK(std::abs(total.y()) < 1e-12 * sigma * height);
    const double start = run.now.time;
    while (run.now.time < start + 0.4) run.step();
    CHECK(run.ledger.row().excavation_work == relative(-sigma * sigma * T / 6 * height, 2e-3));
    CHECK(mean_velocity(run, half - 0.15, half) == relative(-sigma, 1e-3));
    CHECK(run.residual() < 1e-13);
}

TEST_CASE("excavation: while the forces do not decrease nothing moves in equilibrium") {
    for (const Index order : {1, 2})
        for (const CohesiveLaw& law : {CohesiveLaw::unbreakable(), strong, CohesiveLaw{.sigma_c = 0, .friction = 2}}) {
            ExcavatedRun run(plate(law, order), {}, true);  // the last one: blocks held by pressure and friction
            run.step();
            const double at_rest = run.last.largest_speed;
            run.excavate(triangles_in_box(run.model.mesh, gallery), for_ever);
            run.excavate(triangles_in_box(run.model.mesh, {{0.7, 0.3}, {0.8, 1}}), for_ever);  // beside it, to the top
            double fastest = 0;
            for (int i = 0; i < 300; ++i) run.step(), fastest = std::max(fastest, run.last.largest_speed);
            CAPTURE(order);
            CAPTURE(at_rest);
            CHECK(fastest <
                  1e-8 * 1e-3);  // of stress/(rho c); the equilibrium itself is known to some 1e-12 of its loads
            CHECK(run.ledger.worst().released == 0);
            CHECK(run.residual() < 1e-12);
        }
}

TEST_CASE(
    "excavation: in implicit steps nothing moves until the forces decrease and then the hole is that of the start") {
    enum class Plate { small_rotation, order_2, large_rotation, contact };
    for (const Plate kind : {Plate::small_rotation, Plate::order_2, Plate::large_rotation, Plate::contact})
        for (const CohesiveLaw& law : {CohesiveLaw::unbreakable(), CohesiveLaw{.sigma_c = 0, .friction = 2}}) {
            SchemeOptions scheme{.bulk = BulkScheme::implicit_theta, .theta = 1, .damping = 0.3};
            ModelInput input = plate(law, kind == Plate::order_2 ? 2 : 1);
            if (kind == Plate::order_2) scheme.mass = MassMatrix::consistent;
            input.large_rotation = kind == Plate::large_rotation || kind == Plate::contact;
            if (kind == Plate::contact) input.contact_of_pair = {{{.friction = 2}}};
            ExcavatedRun run(std::move(input), scheme, true);
            run.h = 0.3;
            run.step();
            run.excavate(triangles_in_box(run.model.mesh, gallery), for_ever);
            run.excavate(triangles_in_box(run.model.mesh, {{0.7, 0.3}, {0.8, 1}}), for_ever);  // beside it, to the top
            double fastest = 0;
            for (int i = 0; i < 10; ++i) run.step(), fastest = std::max(fastest, run.last.largest_speed);
            CAPTURE(static_cast<int>(kind));
            CHECK(fastest < 1e-8 * 1e-3);
            CHECK(run.residual() < 1e-12);
        }
    ExcavatedRun slow(plate(CohesiveLaw::unbreakable()), {.bulk = BulkScheme::implicit_theta, .theta = 1}, true);
    slow.h = 100;
    slow.step();
    slow.excavate(triangles_in_box(slow.model.mesh, gallery), 1000);
    for (int i = 0; i < 40; ++i) slow.step();
    const Model whole = make_model(plate(CohesiveLaw::unbreakable()));
    ExcavatedRun other(without(whole, triangles_in_box(whole.mesh, gallery)), {}, true);
    double off = 0, largest = 0;
    for (Index c = 0; c < whole.mesh.n_corners(); ++c) {
        if (other.model.has_vanished(whole.mesh.triangle_of(c))) continue;
        largest = std::max(largest, other.now.displacement_of(c).norm());
        off = std::max(off, (other.now.displacement_of(c) - slow.now.displacement_of(c)).norm());
    }
    CHECK(off < 1e-9 * largest);
    CHECK(slow.residual() < 1e-12);
}

TEST_CASE("excavation: heat and a fluid in cracks leave the rest in equilibrium and its books closed") {
    for (const bool implicit : {false, true})
        for (const bool conducts : {false, true}) {
            ModelInput input = plate(CohesiveLaw{.sigma_c = 0, .friction = 2});
            Heat heat;
            heat.conduction = conducts;
            heat.materials = {{.expansion = {.coefficient = 1e-5}, .conductivity = 1e-3, .heat_capacity = 1}};
            heat.field.value = Expression("20*x");
            input.heat = std::make_shared<Heat>(heat);
            input.crack_pressures = {CrackPressure{.pressure = 1e-4, .from = Selection{.boundary = "top"}}};
            SchemeOptions scheme;
            if (implicit) scheme = {.bulk = BulkScheme::implicit_theta, .theta = 1};
            ExcavatedRun run(std::move(input), scheme, true);
            if (implicit) run.h = 0.3;
            run.step();
            run.excavate(triangles_in_box(run.model.mesh, gallery), for_ever);
            double fastest = 0, largest = 0;
            for (int i = 0; i < (implicit ? 10 : 200); ++i)
                run.step(), fastest = std::max(fastest, run.last.largest_speed);
            CAPTURE(implicit);
            CAPTURE(conducts);
            if (!conducts) CHECK(fastest < 1e-8 * 1e-3);
            CHECK(run.residual() < 1e-12);
            for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                if (run.model.has_vanished(run.model.mesh.triangle_of(c)))
                    largest = std::max(largest, run.now.displacement_of(c).norm());
            CHECK(largest == 0);
            CHECK(run.ledger.largest_heat_residual() < 1e-12);
        }
}

TEST_CASE("excavation: the first step of bonded fans is that of the whole body") {
    CohesiveLaw brittle{.sigma_c = 1e-3, .G_c = 4e-6, .gamma = 1, .friction = 0.3};
    for (const bool large : {false, true})
        for (const double damping : {0., 0.5}) {
            ModelInput input = plate(brittle);
            input.large_rotation = large;
            if (damping > 0) input.materials[0].bulk_viscosity = {0.06, 1.2}, input.materials[0].shear_viscosity = 0.1;
            for (std::size_t i = 0; i < input.mesh.interior_edges.size(); i += 17)
                input.mesh.interior_edges[i].cracked = true;
            input.loads.push_back(load(Load::Kind::traction, "top", 0.0, 2e-3, {.time = {0, 0.3}, .value = {0, 1}}));
            // what is left of a piece that nothing holds has a rigid motion of its own
            ExcavatedRun run(std::move(input), {.damping = damping, .damping_of = DampingOf::motion});
            while (run.ledger.worst().softened < 300) run.step();
            const double speed = run.last.largest_speed, usual_step = run.h;
            run.h *= 1e-3;  // next to nothing breaks in the steps before and after
            run.step();
            const EnergyRow row = run.ledger.row();
            run.excavate(triangles_near(damaged_place(run), 0.2, run.model.mesh), 10 * usual_step);
            CHECK(run.ledger.row().excavated_recoverable > 0);
            CHECK(run.ledger.row().recoverable < row.recoverable);
            run.step();
            CAPTURE(large);
            CAPTURE(damping);
            CHECK(run.off_trial() < 1e-12 * speed);
            CHECK(run.ledger.row().dissipated >= row.dissipated);
            CHECK(std::abs(run.ledger.row().law_lag - row.law_lag) < 1e-3 * run.ledger.row().excavated_recoverable);
            run.h = usual_step;
            for (int i = 0; i < 300; ++i) {
                run.step();
                if (i < 10) CHECK(run.last.largest_speed < 3 * speed);  // no impact became a lasting force
            }
            CHECK(run.residual() < 1e-12);
        }
}

TEST_CASE(
    "excavation: a body that turns freely keeps momentum and angular momentum of what remains while nothing is "
    "released") {
    ModelInput input = body_with(bar_mesh(12, 12, 1, 1), {.density = 1, .E = 1, .nu = 0.2}, CohesiveLaw::unbreakable());
    input.large_rotation = true;
    input.initial_velocities = {{.on = {}, .value = {0.01, 0.02}, .spin = 0.05}};
    ExcavatedRun run(std::move(input), {.damping = 0.1});
    while (run.now.time < 5) run.step();
    const auto moment = [&] {
        double sum = 0;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            const Index node = run.now.node_of_corner[c];
            const Vec2 x = run.model.mesh.corner(c) + run.now.displacement[node] - 0.5 * run.h * run.now.velocity[node];
            sum += run.model.corner_mass[c] * cross(x, run.now.velocity[node]);
        }
        return sum;
    };
    run.excavate(triangles_in_box(run.model.mesh, {{0, 0}, {0.5, 0.5}}), 0);
    const Vec2 p = momentum(run.model, run.now);
    const double L = moment();
    for (int i = 0; i < 500; ++i) run.step();
    CHECK((momentum(run.model, run.now) - p).norm() < 1e-13 * p.norm());
    CHECK(moment() == relative(L, 1e-5));  // of the leapfrog, of second order in the step
    CHECK(run.residual() < 1e-12);
}

TEST_CASE("excavation: a hole made slowly ends as the plate that had it from the start") {
    for (const Index order : {1, 2}) {
        ExcavatedRun run(plate(CohesiveLaw::unbreakable(), order), {.damping = 1}, true);
        run.excavate(triangles_in_box(run.model.mesh, gallery), 5);
        State with_hole = initial_state(run.model);
        Model loaded = run.model;
        std::erase_if(loaded.corner_loads, [&](const CornerLoad& at) { return at.is_release; });
        MoreauJean(loaded, {}).start_in_equilibrium(with_hole);
        while (run.now.time < 60) run.step();
        double off = 0, moved = 0;
        for (std::size_t n = 0; n < with_hole.displacement.size(); ++n) {
            off = std::max(off, (run.now.displacement[n] - with_hole.displacement[n]).norm());
            moved = std::max(moved, with_hole.displacement[n].norm());
        }
        CAPTURE(order);
        CHECK(off < 1e-7 * moved);
        CHECK(run.residual() < 1e-12);
    }
}

// Kirsch 1898, plane stress, uniaxial sigma along x, hole of radius 1:
//     u_r = sigma/(2 E) (r (1 - nu) + (1 + nu)/r + (4/r + (1 + nu)(r - 1/r^3)) cos 2 theta)
// The exact tractions act on the outer square, so that only the mesh errs.
TEST_CASE("excavation: a round hole converges to the displacements of Kirsch with the square of the mesh size") {
    constexpr double L = 4, E = 1, nu = 0.25, pull = 1e-3;
    const auto exact_stress = [&](const Vec2& x) -> std::array<double, 3> {
        const double r2 = x.squaredNorm(), t = std::atan2(x.y(), x.x()), a2 = 1 / r2, a4 = a2 * a2;
        return {pull * (1 - a2 * (1.5 * std::cos(2 * t) + std::cos(4 * t)) + 1.5 * a4 * std::cos(4 * t)),
                pull * (-a2 * (0.5 * std::cos(2 * t) - std::cos(4 * t)) - 1.5 * a4 * std::cos(4 * t)),
                pull * (-a2 * (0.5 * std::sin(2 * t) + std::sin(4 * t)) + 1.5 * a4 * std::sin(4 * t))};
    };
    std::vector<double> error;
    for (const double size : {0.4, 0.2, 0.1}) {
        Shape shape;
        shape.outer.points = {{-L, -L}, {0, -L}, {L, -L}, {L, 0}, {L, L}, {0, L}, {-L, L}, {-L, 0}};
        shape.outer.boundary.assign(8, 0), shape.boundary_names = {"rim"};
        const std::vector<Vec2> outline = circle(Vec2::Zero(), 1, 4 * static_cast<int>(std::lround(0.5 * M_PI / size)));
        shape.regions = {{.points = outline, .only_line = true}};
        ModelInput input =
            body_with(triangulate(shape, {.size = size}), {.density = 1, .E = E, .nu = nu}, CohesiveLaw::unbreakable());
        input.plane = PlaneModel::stress;
        hold_middles_of_sides(input, L);
        Model model = make_model(std::move(input));
        const Index history = static_cast<Index>(model.histories.size());
        model.histories.emplace_back();
        for (const BoundaryEdge& edge : model.mesh.boundary_edges) {
            const Index first = 3 * edge.triangle, a = first + edge.side, b = first + (edge.side + 1) % 3;
            const Vec2 along = model.mesh.side_vector(edge.triangle, edge.side), start = model.mesh.corner(a);
            for (const double s : {0.5 - std::sqrt(1. / 12), 0.5 + std::sqrt(1. / 12)}) {  // Gauss
                const Vec2 force = 0.5 * stress_times(exact_stress(start + s * along), -turned_left(along));
                model.corner_loads.push_back({a, history, (1 - s) * force});
                model.corner_loads.push_back({b, history, s * force});
            }
        }
        const Model rest = without(model, triangles_in(model.mesh, outline));
        State state = initial_state(rest);
        MoreauJean(rest, {}).start_in_equilibrium(state);
        double largest = 0;
        for (Index c = 0; c < rest.mesh.n_corners(); ++c) {
            const Vec2 x = rest.mesh.corner(c);
            const double r = x.norm();
            if (rest.has_vanished(rest.mesh.triangle_of(c)) || r > 1 + 1e-9) continue;
            const double cos2 = (x.x() * x.x() - x.y() * x.y()) / (r * r),
                         u_r = pull / (2 * E) *
                               (r * (1 - nu) + (1 + nu) / r + (4 / r + (1 + nu) * (r - 1 / (r * r * r))) * cos2);
            largest = std::max(largest, std::abs(state.displacement_of(c).dot(x) / r - u_r) / (3 * pull / E));
        }
        error.push_back(largest);
    }
    MESSAGE("errors of u_r on the wall, of its largest: " << error[0] << " " << error[1] << " " << error[2]);
    CHECK(error[2] < 8e-3);
    CHECK(std::log2(error[0] / error[2]) / 2 > 1.5);
}

TEST_CASE("excavation: a roof whose support vanishes falls freely and meets the floor by the new faces") {
    constexpr double g = 1e-3, opened = 0.1;
    ModelInput input =
        body_with(bar_mesh(8, 20, 0.4, 1), {.density = 1, .E = 1, .nu = 0.2}, CohesiveLaw::unbreakable());
    input.large_rotation = true;
    input.contact_of_pair = {{{.friction = 0.5}}};
    input.loads = {{.kind = Load::Kind::acceleration, .value = {0.0, -g}},
                   load(Load::Kind::displacement, "bottom", 0.0, 0.0)};
    ExcavatedRun run(std::move(input), {.damping = 0});
    run.excavate(triangles_in_box(run.model.mesh, {{0, 0.5}, {0.4, 0.5 + opened}}), 0);  // before the first step
    const auto mean = [&](const std::vector<Vec2>& of_node) {
        double sum = 0, mass = 0;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            if (run.model.mesh.corner(c).y() < 0.6 || run.model.has_vanished(run.model.mesh.triangle_of(c))) continue;
            sum += run.model.corner_mass[c] * of_node[run.now.node_of_corner[c]].y();
            mass += run.model.corner_mass[c];
        }
        return sum / mass;
    };
    const double fall = std::sqrt(2 * opened / g);
    while (run.now.time < 0.9 * fall) run.step();
    CHECK(mean(run.now.velocity) == relative(-g * (run.now.time - 0.5 * run.h), 1e-10));
    CHECK(run.ledger.worst().face_contacts == 0);
    while (run.now.time < 1.05 * fall) run.step();
    CHECK(run.ledger.worst().face_contacts > 0);
    while (run.now.time < 1.5 * fall) run.step();
    CHECK(mean(run.now.displacement) > -1.1 * opened);
    CHECK(run.residual() < 1e-12);
}

TEST_CASE("excavation: the successor keeps numbers and drops what vanished") {
    ModelInput input = plate(strong);
    const Index n_interior = static_cast<Index>(input.mesh.interior_edges.size());
    const Model whole = make_model(std::move(input));
    const std::vector<Index> triangles = triangles_in_box(whole.mesh, gallery);
    const Model rest = without(whole, triangles);
    CHECK(rest.interfaces.size() == whole.interfaces.size());
    CHECK(rest.mesh.n_triangles() == whole.mesh.n_triangles());
    std::size_t n_gone = 0;
    for (Index i = 0; i < n_interior; ++i) {
        const bool gone = rest.is_gone(rest.interfaces[i]);
        n_gone += gone;
        for (Index p = 2 * i; p < 2 * i + 2; ++p) {
            CHECK((rest.fan_point_of[p] < 0) == gone);
            if (!gone) CHECK(rest.fan_points[rest.fan_point_of[p]].point == p);
        }
    }
    CHECK(rest.mesh.interior_edges.size() == whole.mesh.interior_edges.size() - n_gone);
    double length = 0;  // of the new faces: the outline, whose sides lie on no edges of this mesh
    for (const BoundaryEdge& edge : rest.mesh.boundary_edges) {
        CHECK_FALSE(rest.has_vanished(edge.triangle));
        if (rest.mesh.boundary_names[edge.boundary].empty())
            length += rest.mesh.side_vector(edge.triangle, edge.side).norm();
    }
    CHECK(length > 2 * (gallery.extent().x() + gallery.extent().y()) * 0.9);
    for (const Fan& fan : rest.fans)
        for (const Index c : rest.corners(fan))
            if (rest.has_vanished(rest.mesh.triangle_of(c))) CHECK((fan.n_corners == 1 && fan.n_points == 0));
    for (const CornerLoad& at : rest.corner_loads) CHECK_FALSE(rest.has_vanished(rest.mesh.triangle_of(at.corner)));
}

}  // namespace excavation_test
