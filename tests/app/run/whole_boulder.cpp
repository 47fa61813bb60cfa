// A boulder that nothing can break against references that share no code with knap: flights and impacts by R_N and R_T
// from event to event, and the steady roll of a polygon.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

namespace whole_boulder_test {

using namespace program;
using knap::tests::relative;

namespace {

constexpr double g = 9.81;  // [m/s2]

struct Vector {
    double x, y;
};
Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y}; }
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y}; }
Vector operator*(double s, const Vector& a) { return {s * a.x, s * a.y}; }
double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }
double cross(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }

/// A polygon of mass 1: its corners about its centre of mass.
struct Boulder {
    std::vector<Vector> corners;
    Vector centre{0, 0};  // [m] of the corners that were given
    double inertia = 0;   // [m2] J/m

    explicit Boulder(const std::vector<Vector>& given) : corners(given) {
        double area = 0;
        for (std::size_t i = 0; i < given.size(); ++i) {
            const Vector a = given[i], b = given[(i + 1) % given.size()];
            area += 0.5 * cross(a, b);
            centre = centre + cross(a, b) / 6 * (a + b);
        }
        centre = 1 / area * centre;
        for (Vector& corner : corners) corner = corner - centre;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vector a = corners[i], b = corners[(i + 1) % corners.size()];
            inertia += cross(a, b) * (dot(a, a) + dot(a, b) + dot(b, b)) / 12 / area;
        }
    }
};

struct Plane {
    Vector at, normal;  // towards the boulder
};

struct Rebound {
    double friction, R_N, R_T;
};

struct Motion {
    Vector centre, velocity;
    double angle, spin;
};

Motion after(const Motion& start, double t) {
    return {start.centre + t * start.velocity + Vector{0, -g / 2 * t * t}, start.velocity + Vector{0, -g * t},
            start.angle + t * start.spin, start.spin};
}

Vector arm_of(const Boulder& boulder, std::size_t corner, double angle) {
    const Vector r = boulder.corners[corner];
    return {std::cos(angle) * r.x - std::sin(angle) * r.y, std::sin(angle) * r.x + std::cos(angle) * r.y};
}

/// [m] Of the lowest corner above the planes, and which it is.
struct Gap {
    double value = INFINITY;
    std::size_t corner = 0, plane = 0;
};
Gap gap_of(const Boulder& boulder, const std::vector<Plane>& planes, const Motion& at) {
    Gap least;
    for (std::size_t i = 0; i < boulder.corners.size(); ++i)
        for (std::size_t j = 0; j < planes.size(); ++j) {
            const double gap = dot(planes[j].normal, at.centre + arm_of(boulder, i, at.angle) - planes[j].at);
            if (gap < least.value) least = {gap, i, j};
        }
    return least;
}

/// One point of contact: V+ = V- + W P with V_N+ = -R_N V_N-. Friction leaves R_T V_T- of the slip where mu P_N is
/// enough, stops at P_T = 0 where the normal impulse alone takes more, and is mu P_N where it needs more.
void rebound(const Boulder& boulder, const Plane& plane, std::size_t corner, const Rebound& law, Motion& at) {
    const Vector n = plane.normal, t{-n.y, n.x}, r = arm_of(boulder, corner, at.angle);
    const double rn = cross(r, n), rt = cross(r, t), J = boulder.inertia, W_NN = 1 + rn * rn / J, W_NT = rn * rt / J,
                 W_TT = 1 + rt * rt / J;
    const double V_N = dot(n, at.velocity) + at.spin * rn, V_T = dot(t, at.velocity) + at.spin * rt;
    const double change = -(1 + law.R_N) * V_N, sign = V_T > 0 ? 1 : -1;
    const auto slip_after = [&](double P_N, double P_T) { return V_T + W_NT * P_N + W_TT * P_T; };
    double P_N = change / W_NN, P_T = 0;
    if (slip_after(P_N, 0) * sign > law.R_T * std::abs(V_T)) {  // friction brakes
        const double determinant = W_NN * W_TT - W_NT * W_NT, to_kink = (law.R_T - 1) * V_T;
        P_N = (W_TT * change - W_NT * to_kink) / determinant, P_T = (W_NN * to_kink - W_NT * change) / determinant;
        if (std::abs(P_T) > law.friction * P_N) {
            P_N = change / (W_NN - law.friction * sign * W_NT);
            P_T = -law.friction * sign * P_N;
        }
    } else if (slip_after(P_N, 0) * sign < -std::abs(V_T)) {  // the normal impulse reverses the slip beyond -V_T-
        const double determinant = W_NN * W_TT - W_NT * W_NT, to_kink = -2 * V_T;
        P_N = (W_TT * change - W_NT * to_kink) / determinant, P_T = (W_NN * to_kink - W_NT * change) / determinant;
        if (std::abs(P_T) > law.friction * P_N) {
            P_N = change / (W_NN + law.friction * sign * W_NT);
            P_T = law.friction * sign * P_N;
        }
    }
    at.velocity = at.velocity + P_N * n + P_T * t;
    at.spin += (rn * P_N + rt * P_T) / J;
}

/// From event to event until `end` [s]; counts the impacts.
Motion fall(const Boulder& boulder, const std::vector<Plane>& planes, const Rebound& law, Motion start, double end,
            int& n_impacts) {
    constexpr double watched = 2e-5;  // [s] between two looks
    double now = 0;
    while (true) {
        double t = watched;
        while (now + t < end && gap_of(boulder, planes, after(start, t)).value > 0) t += watched;
        if (now + t >= end) return after(start, end - now);
        double low = t - watched;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + t);
            (gap_of(boulder, planes, after(start, middle)).value > 0 ? low : t) = middle;
        }
        start = after(start, low), now += low;
        const Gap touched = gap_of(boulder, planes, start);
        rebound(boulder, planes[touched.plane], touched.corner, law, start);
        ++n_impacts;
    }
}

std::string pairs(const std::vector<Vector>& points) {
    std::ostringstream text;
    text.precision(17);
    for (const Vector& p : points) text << (text.tellp() > 0 ? ", [" : "[") << p.x << ", " << p.y << "]";
    return "[" + text.str() + "]";
}

/// A boulder alone, above what `ground` says; the step of rigid pieces in seconds.
std::string scene(const std::vector<Vector>& corners, const std::string& motion, const std::string& ground,
                  const std::string& step, const std::string& end) {
    return "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.9\n[[body]]\nshape = \"polygon\"\npoints = " +
           pairs(corners) + "\n" + motion +
           "[material.rock]\ndensity = 2600\nE = 20e9\nnu = 0.25\n[interface.default]\nbreakable = false\n[contact]\n"
           "[rigid]\nsleep = 0\nstep = " +
           step + "\n" + ground + "[time]\nend = " + end + "\n[output]\nfields = false\nevery = 0.002\n";
}

knap::History run(const Folder& folder, const std::string& text, const char* table) {
    write_scene(folder, text);
    const Answer answer = run_scene(folder, "-j 1 --force -s 'figure=[]' -o " + folder.in_shell("run"));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    return knap::read_csv(folder.path / "run" / table);
}

/// [m2] J/m at the start: masses lie at the corners of triangles, so it is more than that of the polygon.
double inertia_of(const knap::History& path) {
    const auto value = [&](const char* column) { return path.column(column).front(); };
    const double v2 = std::pow(value("velocity_x"), 2) + std::pow(value("velocity_y"), 2);
    return (2 * value("kinetic_energy") / value("mass") - v2) / std::pow(value("spin"), 2);
}

}  // namespace

TEST_CASE("whole boulder: flights and rebounds from event to event") {
    const Folder folder("whole boulder");
    const std::vector<Vector> corners{{-0.5, 12}, {0.1, 11.7}, {0.6, 12.1}, {0.5, 12.6}, {0, 12.9}, {-0.45, 12.6}};
    const double slope = std::atan(0.75);
    const std::vector<Plane> valley{{{0, 9}, {std::sin(slope), std::cos(slope)}}, {{12, 0}, {0, 1}}};
    const std::string ground =
        "[[obstacle]]\nshape = \"polyline\"\npoints = [[60, 0], [12, 0], [-4, 12]]\nfriction = 0.6\nR_N = 0.5\nR_T = "
        "0.8\n[[load]]\nacceleration = [0, -9.81]\n";
    for (const double spin : {-120., 45., 200.}) {
        CAPTURE(spin);
        Boulder boulder(corners);
        std::vector<double> errors;
        for (const char* step : {"4e-4", "1e-4"}) {
            const knap::History path = run(
                folder, scene(corners, "velocity = [2, 0]\nspin = " + std::to_string(spin) + "\n", ground, step, "2"),
                "fragment_paths.csv");
            boulder.inertia = inertia_of(path);
            int n_impacts = 0;
            const Motion exact = fall(boulder, valley, {.friction = 0.6, .R_N = 0.5, .R_T = 0.8},
                                      {boulder.centre, {2, 0}, 0, spin * M_PI / 180}, 2, n_impacts);
            const auto value = [&](const char* column) { return path.column(column).back(); };
            errors.push_back(std::hypot(value("centre_x") - exact.centre.x, value("centre_y") - exact.centre.y));
            CHECK(n_impacts == 4);
        }
        for (const double error : errors) CHECK(error < 1e-10);  // of 8 to 10 m: exact at any step
    }
}

TEST_CASE("whole boulder: a polygon rolls down with the speed of a rimless wheel") {
    // T. McGeer, Int. J. Robotics Research 9 (1990) 62: with corners at the radius l, 2 a between two of them,
    // k2 = J/m and a slope of the angle s, a corner without rebound leaves eta of the spin, and the fall from one corner
    // to the next gives 4 g l sin a sin s/(l^2 + k2) to its square.
    const Folder folder("rimless wheel");
    constexpr int n = 8;
    constexpr double l = 0.5, s = 10 * M_PI / 180;
    std::vector<Vector> corners;
    for (int i = 0; i < n; ++i)
        corners.push_back(
            {l * std::cos((2 * i + 1) * M_PI / n), l * std::cos(M_PI / n) + l * std::sin((2 * i + 1) * M_PI / n)});
    Boulder wheel(corners);
    std::ostringstream ground;
    ground.precision(17);
    ground << "[[obstacle]]\nshape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]\nfriction = 2\nrestitution = 0\n"
           << "[[load]]\nacceleration = [" << g * std::sin(s) << ", " << -g * std::cos(s) << "]\n";
    const knap::History path = run(
        folder, scene(corners, "velocity = [1.5, 0]\nspin = -200\n", ground.str(), "2e-4", "8"), "fragment_paths.csv");
    wheel.inertia = inertia_of(path);
    const double a = M_PI / n, eta = (wheel.inertia + l * l * std::cos(2 * a)) / (wheel.inertia + l * l),
                 gain = 4 * g * l * std::sin(a) * std::sin(s) / (l * l + wheel.inertia),
                 before = std::sqrt(gain / (1 - eta * eta));
    double fastest = 0;
    const auto time = path.column("time"), spin = path.column("spin");
    for (std::size_t i = 0; i < time.size(); ++i)
        if (time[i] > 6.5) fastest = std::max(fastest, -spin[i]);
    CHECK(fastest == relative(before, 4e-3));  // seen every 2 ms
}

}  // namespace whole_boulder_test
