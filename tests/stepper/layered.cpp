// Bodies of layered rock: the hole of Lekhnitskii, a pulse across the layers, and the balance of energy in every scheme.
#include "heat/heat_bodies.hpp"
#include "support/paths.hpp"
#include "support/plates.hpp"
#include "support/relative.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace layered_test {

using namespace knap;
using namespace knap::tests;

namespace {

using Complex = std::complex<double>;

/// A wide plate in plane stress with a hole of radius 1 under a stress of 1 along its layers, in their frame (S. G.
/// Lekhnitskii, Anisotropic Plates, 1968, section 36). With the roots mu_k of mu^4/E + (1/G' - 2 nu'/E') mu^2 + 1/E' = 0,
///
///     s_xx = 1 + 2 Re sum mu_k^2 phi_k',   s_yy = 2 Re sum phi_k',   s_xy = -2 Re sum mu_k phi_k'
///     phi_k = A_k/zeta_k,   A_1 = -A_2 = -i/(2 (mu_1 - mu_2)),   zeta_k = (z_k + w_k)/(1 - i mu_k)
///     z_k = x + mu_k y,   w_k^2 = z_k^2 - 1 - mu_k^2
class Hole {
public:
    explicit Hole(const Elastic& rock) {
        const Bedding& across = *rock.bedding;
        const double b = rock.E * (0.5 / across.G - across.nu / across.E), c = rock.E / across.E,
                     root = std::sqrt(b * b - c);  // real: both roots are imaginary
        mu_ = {Complex(0, std::sqrt(b + root)), Complex(0, std::sqrt(b - root))};
    }
    Eigen::Vector3d stress(const Vec2& x) const {
        Eigen::Vector3d sum(1, 0, 0);
        for (const int k : {0, 1}) {
            const Complex mu = mu_[k], A = Complex(0, k == 0 ? -1 : 1) / (2. * (mu_[0] - mu_[1])),
                          z = x.x() + mu * x.y(), square = z * z - 1. - mu * mu;
            Complex w = std::sqrt(square), zeta = (z + w) / (1. - Complex(0, 1) * mu);
            if (std::abs(zeta) < 1) w = -w, zeta = (z + w) / (1. - Complex(0, 1) * mu);
            const Complex slope = -A / (zeta * w);  // phi'
            sum += 2 * Eigen::Vector3d((mu * mu * slope).real(), slope.real(), -(mu * slope).real());
        }
        return sum;
    }

private:
    std::array<Complex, 2> mu_;
};

const Elastic slate{
    .density = 2700, .E = 90e9, .nu = 0.2, .bedding = Bedding{.E = 30e9, .nu = 0.1, .G = 15e9, .angle = 0.5}};

}  // namespace

TEST_CASE("E39 layers: the stress round a hole is that of Lekhnitskii") {
    describe(
        "A plate of slate (90 GPa along its layers, 30 across) with a hole under a tension along the layers: mean "
        "difference of the stress from Lekhnitskii's, over what the hole adds, for edges of 0.4, 0.2 and 0.1 radii.");
    const Bedding& across = *slate.bedding;
    const Hole exact(slate);
    const double largest = exact.stress({0, 1})[0];  // at the crown
    CHECK(largest == relative(1 + std::sqrt(2 * (std::sqrt(slate.E / across.E) - across.nu * slate.E / across.E) +
                                            slate.E / across.G),
                              1e-12));
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(across.angle).toRotationMatrix();
    const auto stress_at = [&](const Vec2& x) -> Eigen::Vector3d {
        const Eigen::Vector3d s = 1e6 * exact.stress(R.transpose() * x);
        const Eigen::Matrix2d global = R * (Eigen::Matrix2d() << s[0], s[2], s[2], s[1]).finished() * R.transpose();
        return {global(0, 0), global(1, 1), global(0, 1)};
    };
    const Eigen::Vector3d far = stress_at({1e6, 0});  // the hole adds the rest
    constexpr double L = 4;
    std::vector<PointTable::Row> rim;
    for (int i = -400; i <= 400; ++i)
        for (const double side : {-L, L})
            for (const Vec2& x : {Vec2(side, 0.01 * i), Vec2(0.01 * i, side)})
                rim.push_back({x, {stress_at(x)[0], stress_at(x)[1], stress_at(x)[2]}});
    std::ranges::sort(rim, {}, [](const PointTable::Row& row) { return std::pair(row.place.x(), row.place.y()); });
    const auto twice = std::ranges::unique(
        rim, {}, [](const PointTable::Row& row) { return std::pair(row.place.x(), row.place.y()); });
    rim.erase(twice.begin(), twice.end());
    const auto table = std::make_shared<const PointTable>(std::move(rim));
    std::vector<double> error;
    for (const auto& [order, size] : {std::pair<Index, double>{1, 0.4}, {1, 0.2}, {1, 0.1}, {2, 0.1}}) {
        ModelInput input = body_with(plate_with_hole(L, size), slate, CohesiveLaw::unbreakable());
        input.plane = PlaneModel::stress;
        input.mesh.order = order;
        PlaceField field{.path = "load[0].stress"};
        field.table = table;
        input.loads = {{.kind = Load::Kind::stress,
                        .on = {.boundary = "rim", .box = {}},
                        .field = std::make_shared<PlaceField>(field)},
                       pin({0, L}, true, false),
                       pin({0, -L}, true, false),
                       pin({L, 0}, false, true)};
        const Still plate(std::move(input));
        double difference = 0, whole = 0;
        for (Index t = 0; t < plate.model.mesh.n_triangles(); ++t) {
            const Eigen::Vector3d known = stress_at(plate.model.mesh.centroid(t));
            difference += plate.model.mesh.area(t) * (plate.stress(t) - known).squaredNorm();
            whole += plate.model.mesh.area(t) * (known - far).squaredNorm();
        }
        error.push_back(std::sqrt(difference / whole));
    }
    CHECK(error[1] < 0.65 * error[0]);
    CHECK(error[2] < 0.55 * error[1]);  // of first order in the size
    verify_small("error of the stress, triangles of first order", error[2], {0.1});
    verify_small("error of the stress, triangles of second order", error[3], {0.03});
}

// A prescribed stress T leaves the velocity T/(density c) behind the front of a wave across or along the layers.
TEST_CASE("E39 layers: a wave across them and one along them run with their own speeds") {
    describe(
        "Waves in a bar of slate along and across its layers: speed against Christoffel's equation, and the velocity "
        "behind the front against T/(density c).");
    for (const double angle : {0.0, std::numbers::pi / 2}) {
        Elastic rock = slate;
        rock.bedding->angle = angle;
        const double c = rock.wave_matrix(PlaneModel::strain, Vec2::UnitX())(0, 0), T = 1e6;
        ModelInput input = body_with(symmetric_bar_mesh(200, 2, 0.01), rock, CohesiveLaw::unbreakable());
        input.loads = {load(Load::Kind::traction, "right", T, 0, {.time = {0, 4e-5}, .value = {0, 1}})};
        for (const char* side : {"bottom", "top"})
            input.loads.push_back(load(Load::Kind::displacement, side, std::nullopt, 0.0));
        Run run(std::move(input), {.absorbing = {{.boundary = "left", .box = {}, .body = {}}}});
        const double h = 0.8 * run.stepper.stable_step();
        const auto first = [](Index t) { return t < 4; };
        double arrival = 0;
        while (run.now.time < 2.4 / c + 4e-5) {
            const double before = run.mean_velocity(first).x(), then = run.now.time;
            run.step(h);
            const double now = run.mean_velocity(first).x(), half = 0.5 * T / (rock.density * c);
            if (arrival == 0 && now >= half) arrival = then + h * (half - before) / (now - before);
        }
        const std::string way = angle == 0 ? ", along the layers" : ", across the layers";
        verify("velocity behind the front [m/s]" + way, run.mean_velocity(first).x(), T / (rock.density * c), {2e-3});
        verify("speed of the front [m/s]" + way, (2 - 0.005) / (arrival - 2e-5), c, {3e-3});
        CHECK(run.ledger.row().residual < 1e-12);
    }
}

// J. C. Jaeger, Geol. Mag. 97 (1960) 65: a facet at the angle t to the platens slides under the compressive stress
//     S sin t cos t = (gamma + mu) sigma_c f + mu S cos^2 t
// with the factor f of strength over the angle to the layers.
TEST_CASE("E39 layers: a specimen slides on a facet at the strength of Jaeger") {
    describe(
        "A specimen with a facet at the angle t to the platens, in layers whose strength is a fifth along them: S sin "
        "t "
        "cos t = (gamma + mu) sigma_c f + mu S cos^2 t with the factor f of the angle between facet and layers.");
    constexpr double sigma_c = 1e6, gamma = 2, mu = 0.5;
    for (const double t : {35., 45., 60., 75.})
        for (const double off : {0., 10., 50.}) {  // between facet and layers
            CAPTURE(t);
            CAPTURE(off);
            Elastic rock = slate;
            const Vec2 along(1, std::tan(t * degree));
            Shape shape;
            shape.outer = {.points = {{0, 0}, {1, 0}, {1, 1 + along.y()}, {0, 1 + along.y()}},
                           .boundary = {0, 1, 2, 1}};
            shape.outer.points.insert(shape.outer.points.begin() + 2, Vec2(1, 0.5 + along.y()));
            shape.outer.boundary.insert(shape.outer.boundary.begin() + 2, 1);
            shape.outer.points.emplace_back(0, 0.5), shape.outer.boundary.emplace_back(1);
            shape.boundary_names = {"bottom", "side", "top"};
            shape.cracks = {{.points = {{0, 0.5}, {1, 0.5 + along.y()}}}};
            Mesh mesh = triangulate(shape, {.size = 0.5});
            for (InteriorEdge& edge : mesh.interior_edges) edge.joint = edge.cracked ? 0 : -1, edge.cracked = false;
            rock.bedding->angle = (t + off) * degree;
            ModelInput input = body_with(mesh, rock, CohesiveLaw::unbreakable());
            input.laws.push_back({.sigma_c = sigma_c, .G_c = 10, .gamma = gamma, .friction = mu});
            input.law_of_joint = {1};
            input.over_bedding = {{}, {.strength = {.angle = {0, 20 * degree}, .factor = {0.2, 1}}, .energy = {}}};
            input.loads = {load(Load::Kind::displacement, "bottom", std::nullopt, 0.0), pin({0, 0}, true, false),
                           load(Load::Kind::velocity, "top", std::nullopt, -1e-3)};
            Run run(std::move(input), {.bulk = BulkScheme::implicit_theta, .theta = 1});
            const double expected = (gamma + mu) * sigma_c * std::min(1., 0.2 + 0.8 * off / 20) /
                                    (std::cos(t * degree) * (std::sin(t * degree) - mu * std::cos(t * degree)));
            double peak = 0;
            const double h = expected / 30e9 * (1 + along.y());  // a thousandth of the way there
            for (int i = 0; i < 3000 && run.step(h).rejection == Rejection::none; ++i)
                peak = std::max(peak, -stress(run.model, run.now, 0)[1]);
            verify("strength [Pa], facet at " + digits(t) + " deg, " + digits(off) + " deg from the layers", peak,
                   expected, {2e-3});
        }
}

/// Calls visit(turning, order, bulk) for what large rotations, order and bulk may be together.
void for_each_scheme(const auto& visit) {
    for (const bool turning : {false, true})
        for (const Index order : {1, 2})
            for (const BulkScheme bulk : {BulkScheme::explicit_lumped, BulkScheme::implicit_theta}) {
                if (turning && order == 2) continue;
                CAPTURE(turning);
                CAPTURE(order);
                CAPTURE(static_cast<int>(bulk));
                visit(turning, order, bulk);
            }
}

TEST_CASE("layers: the balance of energy closes in every scheme with heat and with rotation") {
    for_each_scheme([&](bool turning, Index order, BulkScheme bulk) {
        Mesh mesh = bar_mesh(6, 3, 2, 1);
        mesh.order = order;
        ModelInput input = heated(std::move(mesh), field("300 + 200*x", {a}, {.time = {0, 1, 9}, .value = {0, 1, 0.3}}),
                                  layered, weak, PlaneModel::strain);
        input.large_rotation = turning;
        input.initial_velocities = {{.on = {}, .value = {0.1, 0}, .spin = 0.2}};
        Run run(std::move(input), {.bulk = bulk, .theta = 0.5});
        const double h = bulk == BulkScheme::implicit_theta ? 0.05 : 0.5 * run.stepper.stable_step();
        while (run.now.time < 4 && run.step(h).rejection == Rejection::none) continue;
        CHECK(run.now.time >= 4);
        CHECK(run.ledger.largest_residual() < 1e-12);
    });
}

// All corners are held in y and the long faces bear no shear, so that a thin bar is a line with the stiffness
// D_xx - D_xs^2/D_ss of its place, s: shear.
TEST_CASE("E39 layers by place: a bar whose layers turn has the strain and the waves of each place") {
    describe(
        "A thin bar of slate, held in y, whose layers turn from its one end to the other: end displacement under a "
        "static "
        "tension against the sum of T dx/D(x), and arrival of a wave against the sum of dx/c(x), with the stiffness "
        "D = density c^2 = D_xx - D_xs^2/D_ss of the layers of each place.");
    constexpr int n = 200;
    constexpr double length = 2, T = 1e6, ramp = 2e-5;
    const auto angle_at = [](double x) { return 0.5 * std::numbers::pi * x / length; };
    const auto stiffness_at = [&](double x) {
        Elastic rock = slate;
        rock.bedding->angle = angle_at(x);
        const Eigen::Matrix3d D = rock.stiffness(PlaneModel::strain);
        return D(0, 0) - D(0, 2) * D(0, 2) / D(2, 2);
    };
    const auto bar = [&](Index order) {
        ModelInput input = body_with(symmetric_bar_mesh(n, length, 0.01), slate, CohesiveLaw::unbreakable());
        input.mesh.order = order;
        for (Index t = 0; t < input.mesh.n_triangles(); ++t)  // four triangles at one place of the bar
            input.mesh.layer_angle.push_back(angle_at(length * (t / 4 + 0.5) / n));
        input.loads = {{.kind = Load::Kind::displacement, .on = {.box = Box{Vec2(-1, -1), Vec2(3, 1)}}}};
        input.loads[0].value[1] = 0;
        return input;
    };
    for (const Index order : {1, 2}) {
        ModelInput input = bar(order);
        input.loads.push_back(load(Load::Kind::traction, "right", T, 0));
        input.loads.push_back(load(Load::Kind::displacement, "left", 0.0, std::nullopt));
        const Still still(std::move(input));
        const auto end_of = [&](int place) {  // mean of both corners of its right side
            const Index corner = still.model.mesh.corners_per_triangle() * (4 * place + 1);
            const auto u = [&](Index c) { return still.now.displacement[still.now.node_of_corner[c]].x(); };
            return 0.5 * (u(corner) + u(corner + 1));
        };
        double u = 0;
        for (int i = 0; i < n; ++i) {
            u += length / n * T / stiffness_at(length * (i + 0.5) / n);
            CHECK(end_of(i) == relative(u, 1e-3));
        }
        verify("end displacement [m], order " + std::to_string(order), end_of(n - 1), u,
               {5e-5});  // layers turn within a height
    }
    Run run([&] {
        ModelInput input = bar(1);
        input.loads.push_back(
            load(Load::Kind::traction, "right", T, std::nullopt, {.time = {0, ramp}, .value = {0, 1}}));
        return input;
    }());
    const double h = 0.8 * run.stepper.stable_step();
    const auto c = [&](double x) { return std::sqrt(stiffness_at(x) / slate.density); };
    // Behind the front T sqrt(Z/Z_0)/Z is the velocity for the impedance Z = density c; it has the way of 1/c.
    double passage = ramp / 2, front = length;
    for (const double place : {1.5, 1., 0.5}) {
        for (constexpr double dx = 1e-4; front > place + dx / 2; front -= dx) passage += dx / c(front - dx / 2);
        const auto here = [&](Index t) { return t / 4 == static_cast<Index>(place * n / length); };
        const double half = 0.5 * T / slate.density / std::sqrt(c(place) * c(length));
        double arrival = 0;
        while (arrival == 0 && run.now.time < 1e-3) {
            const double before = run.mean_velocity(here).x(), then = run.now.time;
            run.step(h);
            if (const double now = run.mean_velocity(here).x(); now >= half)
                arrival = then + h * (half - before) / (now - before);
        }
        verify("arrival of the wave [s] at x = " + digits(place) + " m", arrival, passage, {1e-2});  // 5 % of the ramp
    }
    CHECK(run.ledger.largest_residual() < 1e-12);
}

TEST_CASE("layers by place: a folded layer is bit for bit the materials of its places") {
    const std::string fold = "30 + 40*min(1, max(0, 1e9*(x - 0.7))) - 90*min(1, max(0, 1e9*(x - 1.4))) deg";
    constexpr std::array angles{30., 70., -20.};
    constexpr int n = 6;
    const auto region = [](int i) { return static_cast<Index>(3 * i / n); };
    for_each_scheme([&](bool turning, Index order, BulkScheme bulk) {
        const auto run_of = [&](bool by_place) {
            Mesh mesh = by_place ? bar_mesh(n, 3, 2, 1) : bar_mesh(n, 3, 2, 1, region);
            mesh.order = order;
            const TimeFunction heating{.time = {0, 1, 9}, .value = {0, 1, 0.3}};
            ModelInput input =
                heated(std::move(mesh), field("300 + 200*x", std::vector<double>(by_place ? 1 : 3, a), heating),
                       layered, weak, PlaneModel::strain);
            const auto in_radians = [](double angle) { return angle * std::numbers::pi / 180; };
            if (by_place) {
                PlaceField angle{.path = "material.rock.bedding.angle", .n_values = 1};
                angle.formulas[0].of_place = Expression(fold.substr(0, fold.rfind(' ')));
                input.layer_angle = {std::make_shared<const PlaceField>(angle)};
            }
            for (std::size_t m = 0; m < input.materials.size() && !by_place; ++m)
                input.materials[m].bedding->angle = in_radians(angles[m]);
            input.over_bedding = {{.strength = {.angle = {0, in_radians(60)}, .factor = {0.3, 1}}, .energy = {}}};
            input.large_rotation = turning;
            input.initial_velocities = {{.on = {}, .value = {0.1, 0}, .spin = 0.2}};
            auto run = std::make_unique<Run>(
                std::move(input),
                SchemeOptions{.bulk = bulk, .theta = 0.5, .absorbing = {{.boundary = "left", .box = {}, .body = {}}}});
            const double h = bulk == BulkScheme::implicit_theta ? 0.05 : 0.5 * run->stepper.stable_step();
            while (run->now.time < 3 && run->step(h).rejection == Rejection::none) continue;
            return run;
        };
        const auto one = run_of(true), other = run_of(false);
        REQUIRE(one->now.time >= 3);
        CHECK(one->now.displacement == other->now.displacement);
        CHECK(one->now.velocity == other->now.velocity);
        for (Index t = 0; t < one->model.mesh.n_triangles(); ++t)
            CHECK(stress(one->model, one->now, t) == stress(other->model, other->now, t));
        CHECK(std::ranges::any_of(one->now.points, [](const PointState& p) { return p.cohesion < 1; }));
        CHECK(one->ledger.largest_residual() < 1e-12);
    });
}

}  // namespace layered_test
