// Absorbing boundaries: a pulse leaves the body. The part that returns is measured by the energy that is left once the
// pulse has gone.
#include "element/triangle_matrices.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <complex>

namespace absorbing_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr int n_cells = 200;
constexpr double length = 2, height = length / n_cells;

/// (1 - cos(2 pi t/T))/2 until T, then 0.
TimeFunction pulse(double T) {
    TimeFunction history;
    for (int i = 0; i <= 64; ++i) {
        history.time.push_back(T * i / 64);
        history.value.push_back(0.5 * (1 - std::cos(2 * M_PI * i / 64)));
    }
    return history;
}

ModelInput bar(Mesh mesh, const Elastic& material, PlaneModel plane) {
    ModelInput input =
        body_with(std::move(mesh), material, {.sigma_c = 20e6, .G_c = 1e3, .gamma = 1});  // more than any wave here
    input.plane = plane;
    return input;
}

SchemeOptions let_out(const std::string& boundary) {
    return {.absorbing = {{.boundary = boundary, .box = {}, .body = {}}}};
}

struct Reflected {
    double amplitude;  // [-] of the reflected pulse over that of the incident one
    double radiated;   // [-] radiated work over the largest energy
    double error;      // [-] of the balance of energy over the largest energy
};

Reflected run_out(Run& run, double end) {
    const double h = 0.8 * run.stepper.stable_step();
    double largest = 0, radiated = 0;
    while (run.now.time < end) {
        const StepReport& r = run.step(h);
        CHECK(r.radiated_work <= 0);
        radiated += r.radiated_work;
        largest = std::max(largest, r.kinetic + r.strain);
    }
    return {.amplitude = std::sqrt((run.last.kinetic + run.last.strain) / largest),
            .radiated = -radiated / largest,
            .error = run.ledger.largest_residual() / largest};
}

/// The speed of the pulse is c.
Reflected reflection(ModelInput input, const Vec2& traction, double c, int pulse_cells = 40) {
    const double T = pulse_cells * length / n_cells / c;
    input.loads.push_back(load(Load::Kind::traction, "right", traction.x(), traction.y(), pulse(T)));
    Run run(std::move(input), let_out("left"));
    return run_out(run, length / c + 1.5 * T);
}

constexpr Elastic rock{.density = 2500, .E = 50e9, .nu = 0.25};

/// A packet of pressure or shear waves in plane strain on its way down at `angle` to the normal of y = 0, in cells of
/// 1 m.
struct Packet {
    bool is_shear;
    double angle;          // [rad]
    double l = 8, w = 24;  // [m] along the way and across
    double k = 0.4;        // [1/m] wave number

    static double c_p() { return rock.dilatational_speed(PlaneModel::strain); }
    static double c_s() { return rock.shear_speed(PlaneModel::strain); }
    double c() const { return is_shear ? c_s() : c_p(); }
    Vec2 way() const { return {std::sin(angle), -std::cos(angle)}; }

    /// Gradient of the potential, or that turned, and its slope along the way.
    std::pair<Vec2, Vec2> displacement_and_slope(const Vec2& from_centre) const {
        using Complex = std::complex<double>;
        const Vec2 d = way(), e = turned_left(d);
        const double s = d.dot(from_centre), q = e.dot(from_centre);
        const Complex potential = std::exp(Complex(-0.5 * (s * s / (l * l) + q * q / (w * w)), k * s)),
                      along(-s / (l * l), k);
        const double across = -q / (w * w);
        const Vec2 u = (along * potential).real() * d + across * potential.real() * e,
                   slope =
                       ((along * along - 1 / (l * l)) * potential).real() * d + across * (along * potential).real() * e;
        return is_shear ? std::pair(turned_left(u), turned_left(slope)) : std::pair(u, slope);
    }

    /// [-] Reflected over incident flux of energy of a plane wave. A wave p exp(i omega (d.x/c - t)) has, over i omega,
    /// the velocity -p and the stress sigma = C:(d p + p d)/2c; on y = 0 dashpots demand
    ///     sigma_xy = rho c_s v_x,     sigma_yy = rho c_p v_y.
    /// A wave that is faster along y = 0 than the incident one decays with y: d_y is imaginary and carries nothing.
    double reflected(double incidence) const {
        using Complex = std::complex<double>;
        using Way = std::array<Complex, 2>;
        const double mu = rock.density * c_s() * c_s(), lambda = rock.density * c_p() * c_p() - 2 * mu,
                     slowness = std::sin(incidence) / c();
        const auto missing = [&](const Way& d, bool shear) {
            const Way p = shear ? Way{-d[1], d[0]} : d;
            const double speed = shear ? c_s() : c_p();
            return Eigen::Vector2cd(
                mu * (d[0] * p[1] + d[1] * p[0]) / speed + rock.density * c_s() * p[0],
                (lambda * (d[0] * p[0] + d[1] * p[1]) + 2 * mu * d[1] * p[1]) / speed + rock.density * c_p() * p[1]);
        };
        const auto upwards = [&](double speed) {
            const double sine = slowness * speed;
            return Way{sine, std::sqrt(Complex(1 - sine * sine))};
        };
        const Way p = upwards(c_p()), s = upwards(c_s());
        Eigen::Matrix2cd A;
        A << missing(p, false), missing(s, true);
        const Eigen::Vector2cd a = A.inverse() * -missing({std::sin(incidence), -std::cos(incidence)}, is_shear);
        return (std::norm(a[0]) * c_p() * p[1].real() + std::norm(a[1]) * c_s() * s[1].real()) /
               (c() * std::cos(incidence));
    }

    /// Mean of the above over the packet: the energy at the wave numbers (k_s, k_q) is proportional to
    /// (k_s^2 + k_q^2)^2 exp(-l^2 (k_s - k)^2 - w^2 k_q^2).
    double theory() const {
        double sum = 0, weights = 0;
        for (int i = -30; i <= 30; ++i)
            for (int j = -30; j <= 30; ++j) {
                const double x = 0.1 * i, y = 0.1 * j, k_s = k + x / l, k_q = y / w, square = k_s * k_s + k_q * k_q,
                             weight = square * square * std::exp(-x * x - y * y);
                sum += weight * reflected(angle + std::atan2(k_q, k_s)), weights += weight;
            }
        return sum / weights;
    }
};

/// In a rectangle in which the packet and what it sends back have room.
Reflected reflection_of(const Packet& packet) {
    const double wide = 3.5 * packet.w, deep = 4 * packet.l,
                 up = wide * std::sin(packet.angle) + deep * std::cos(packet.angle) + 2,
                 aside = wide * std::cos(packet.angle) + deep * std::sin(packet.angle) + 2,
                 travel = 2 * up / std::cos(packet.angle);
    const int width = static_cast<int>(2 * aside + travel * std::sin(packet.angle)),
              depth = 2 * static_cast<int>(up + 0.5 * wide * std::sin(packet.angle));
    Run run(bar(bar_mesh(width, depth, width, depth), rock, PlaneModel::strain), let_out("bottom"));
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const auto [u, slope] = packet.displacement_and_slope(run.model.mesh.corner(c) - Vec2(aside, up));
        const Index node = run.now.node_of_corner[c];
        run.now.displacement[node] = 1e-3 * u, run.now.velocity[node] = -1e-3 * packet.c() * slope;
    }
    run.ledger = EnergyLedger(run.model, run.now);
    return run_out(run, travel / packet.c());
}

void verify_packet(bool is_shear, double degrees) {
    const Packet packet{is_shear, degrees * M_PI / 180};
    const Reflected found = reflection_of(packet);
    const std::string at = std::string(is_shear ? ", shear" : ", pressure") + " wave at " + digits(degrees) + " deg";
    verify_near("part of the energy that returns" + at, found.amplitude * found.amplitude, packet.theory(),
                {2e-3, 1e-3});
    verify_near("radiated work over the energy" + at, found.radiated, 1 - packet.theory(), {2e-3, 1e-3});
    verify_small("error of the balance of energy" + at, found.error, {1e-12});
}

}  // namespace

TEST_CASE("E32 a pulse of normal incidence leaves by an absorbing boundary") {
    describe(
        "A pulse of 40 and of 20 cells runs down a bar of 200 cells with nothing but the absorbing boundary at its end "
        "(E = 50 GPa, nu = 0.25, 2500 kg/m3). Reference: nothing returns. What does is the dispersion of linear "
        "triangles and of central differences, of order 2.");
    on_path("explicit, explicit");
    const auto of_pressure = [](PlaneModel plane, int cells) {
        ModelInput input = bar(symmetric_bar_mesh(n_cells, length, height), rock, plane);
        for (const char* side : {"bottom", "top"})
            input.loads.push_back(load(Load::Kind::displacement, side, std::nullopt, 0.0));
        return reflection(std::move(input), {1e6, 0}, rock.dilatational_speed(plane), cells);
    };
    const auto of_shear = [](int cells) {
        ModelInput input = bar(symmetric_bar_mesh(n_cells, length, height), rock, PlaneModel::strain);
        for (const char* side : {"bottom", "top"})
            input.loads.push_back(load(Load::Kind::displacement, side, 0.0, std::nullopt));
        return reflection(std::move(input), {0, 1e6}, rock.shear_speed(PlaneModel::strain), cells);
    };
    const auto verify_part = [](const std::string& wave, const Reflected& long_pulse, const Reflected& short_pulse) {
        verify_small("reflected amplitude, 40 cells, " + wave, long_pulse.amplitude, {1e-3});
        verify_small("reflected amplitude, 20 cells, " + wave, short_pulse.amplitude, {1e-2, 5e-3});
        verify_small("1 - radiated work over the energy, 40 cells, " + wave, 1 - long_pulse.radiated, {1e-6});
        verify_small("error of the balance of energy, 40 cells, " + wave, long_pulse.error, {1e-12});
    };
    const PlaneModel strain = PlaneModel::strain, stress = PlaneModel::stress;
    verify_part("pressure, plane strain", of_pressure(strain, 40), of_pressure(strain, 20));
    verify_part("pressure, plane stress", of_pressure(stress, 40), of_pressure(stress, 20));
    verify_part("shear", of_shear(40), of_shear(20));
}

TEST_CASE("E32 a packet of oblique incidence loses what dashpots take") {
    describe(
        "A packet of plane waves (wave length of 15.7 cells, Gaussian of 8 cells along its way and 24 across) meets "
        "the "
        "absorbing side of a rectangle at an angle. Reference: part of the energy that dashpots rho c_p and rho c_s "
        "send "
        "back as pressure and shear wave (Lysmer and Kuhlemeyer 1969), mean over the directions in the packet.");
    on_path("explicit, explicit");
    verify_packet(false, 30);
    verify_packet(true, 0);
}

TEST_CASE("E32 packets of other incidences lose what dashpots take" * doctest::test_suite("slow")) {
    describe("As before, at other angles.");
    on_path("explicit, explicit");
    for (const double degrees : {0, 45}) verify_packet(false, degrees);
    verify_packet(true, 25);
}

TEST_CASE("absorbing boundary: in any direction and with a crack that reaches it") {
    const Elastic slender{.density = 2500, .E = 50e9, .nu = 0};
    const double turn = 0.5;
    Mesh mesh = bar_mesh(n_cells, 2, length, 2 * height);
    for (InteriorEdge& edge : mesh.interior_edges) {
        const Vec2 middle =
            0.5 * (mesh.corner(edge.triangle[0], edge.side[0]) + mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3));
        edge.cracked = std::abs(middle.y() - height) < 1e-9 && middle.x() < 0.2 * length;
    }
    for (Vec2& x : mesh.vertices) x = Eigen::Rotation2Dd(turn) * x;
    ModelInput input = bar(std::move(mesh), slender, PlaneModel::stress);
    const auto [part, radiated, error] = reflection(std::move(input), Eigen::Rotation2Dd(turn) * Vec2(1e6, 0),
                                                    slender.dilatational_speed(PlaneModel::stress));
    MESSAGE("reflected amplitude " << part);
    CHECK(part < 1e-2);
    CHECK(radiated > 0.9999);
    CHECK(error < 1e-12);
}

TEST_CASE("absorbing boundary: implicit steps let a pulse out as explicit ones do and large ones end at rest") {
    constexpr int n = 100;
    const auto run_with = [](SchemeOptions scheme, double cfl) {
        const Elastic slender{.density = 2500, .E = 50e9, .nu = 0};
        const double c = slender.dilatational_speed(PlaneModel::stress), T = 0.4 * length / c;
        ModelInput input = bar(symmetric_bar_mesh(n, length, height), slender, PlaneModel::stress);
        input.loads.push_back(load(Load::Kind::traction, "right", 1e6, 0.0, pulse(T)));
        scheme.absorbing = let_out("left").absorbing;
        Run run(std::move(input), scheme);
        const double h = cfl * std::ranges::min(stable_steps(run.model.mesh, run.model.materials, run.model.plane));
        double largest = 0, radiated = 0, injected = 0;
        while (run.now.time < length / c + 1.5 * T) {
            const StepReport& r = run.step(h);
            CHECK(r.radiated_work <= 0);
            radiated -= r.radiated_work, injected += r.external_work;
            largest = std::max(largest, r.kinetic + r.strain);
        }
        CHECK(run.ledger.largest_residual() < 1e-12 * largest);
        CHECK(radiated == relative(injected, 1e-2));
        return std::sqrt(std::max(0., run.last.kinetic + run.last.strain) / largest);
    };
    const SchemeOptions implicit{.bulk = BulkScheme::implicit_theta};
    const double of_explicit = run_with({}, 0.8), fine = run_with(implicit, 0.4), coarse = run_with(implicit, 3);
    MESSAGE("left: explicit " << of_explicit << ", implicit " << fine << " and " << coarse);
    CHECK(fine < 5e-3);
    CHECK(coarse < 2e-2);
    run_with({.bulk = BulkScheme::implicit_theta, .mass = MassMatrix::consistent}, 1);
    // a step that all waves leave: the dashpots bear the traction, C v = F
    ModelInput input = bar(bar_mesh(8, 4, 2, 1), rock, PlaneModel::strain);
    input.loads = {load(Load::Kind::traction, "right", 1e6, 0.0)};
    for (const char* side : {"bottom", "top"})
        input.loads.push_back(load(Load::Kind::displacement, side, std::nullopt, 0.0));
    SchemeOptions large = let_out("left");
    large.bulk = BulkScheme::implicit_theta, large.theta = 1;
    Run run(std::move(input), large);
    for (int i = 0; i < 10; ++i) run.step(1);
    const double speed = 1e6 / (rock.density * rock.dilatational_speed(PlaneModel::strain));
    CHECK(run.mean_velocity([](Index) { return true; }).x() == relative(speed, 1e-9));
}

TEST_CASE("absorbing boundary: stress in situ on the same boundary stays in equilibrium") {
    ModelInput input = bar(bar_mesh(8, 4, 2, 1), rock, PlaneModel::strain);
    for (const char* side : {"left", "right", "bottom", "top"}) {
        Load stress = load(Load::Kind::stress, side, std::nullopt, std::nullopt);
        stress.stress = {-5e6, -8e6, 1e6};
        input.loads.push_back(stress);
    }
    SchemeOptions scheme = let_out("left");
    scheme.absorbing.push_back({.boundary = "bottom", .box = {}, .body = {}});
    Run run(std::move(input), scheme);
    run.stepper.start_in_equilibrium(run.now);
    for (int i = 0; i < 2000; ++i) run.step(0.8 * run.stepper.stable_step());
    CHECK(run.last.kinetic < 1e-20 * run.last.strain);
    const Eigen::Vector3d s = stress(run.model, run.now, 0);
    CHECK(s[0] == relative(-5e6, 1e-9));
    CHECK(s[1] == relative(-8e6, 1e-9));
    CHECK(s[2] == relative(1e6, 1e-9));
}

TEST_CASE("absorbing boundary: refused where the boundary is held or led") {
    ModelInput held = bar(bar_mesh(4, 2, 2, 1), rock, PlaneModel::strain);
    held.supports = {{.on = {.boundary = "left", .box = {}, .body = {}}}};
    CHECK_THROWS_AS(Run(held, let_out("left")), UserError);
    ModelInput slip_follows_normal = bar(bar_mesh(4, 2, 2, 1), rock, PlaneModel::strain);
    slip_follows_normal.loads = {load(Load::Kind::velocity, "left", 0.0, 1.0)};
    CHECK_THROWS_AS(Run(slip_follows_normal, let_out("left")), UserError);
}

}  // namespace absorbing_test
