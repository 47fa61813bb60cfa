#pragma once
// A made-up run with everything a figure has to cope with: a plate of random triangles, a pre-crack, a crack that branches, damaged
// interfaces ahead of the tips, stresses with peaks at the tips, and histories to go with it. It stands in for physics nowhere else.
#include "base/random.hpp"
#include "output/frame.hpp"
#include "output/history_csv.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace synthetic {

using namespace knap;

inline constexpr double width = 0.1, height = 0.04;  // [m]
inline constexpr double start = 0.05, fork = 0.072, tip = 0.09,
                        front = 0.093;  // [m] x of pre-crack end, branching, tips, damage front

/// Half the distance [m] of the two branches at x.
inline double spread(double x) { return x < fork ? 0 : 0.5 * (x - fork) + 8 * (x - fork) * (x - fork); }

/// 1 above the crack, -1 below, 0 between its branches.
inline int side(const Vec2& x) {
    const double y = x.y() - 0.5 * height - 0.0006 * std::sin(400 * x.x());
    return y > spread(x.x()) ? 1 : y < -spread(x.x()) ? -1 : 0;
}

inline Vec2 displacement(const Vec2& x, int side) {
    const double open = x.x() < tip ? 8e-6 * std::sqrt((tip - x.x()) / tip) : 0;
    return {2e-6 * x.x() / width, side * open + 4e-6 * (x.y() / height - 0.5)};
}

/// Uniform tension, and the singular field of a mode I crack at each tip (with a blunted core).
inline Eigen::Vector3d stress(const Vec2& x) {
    Eigen::Vector3d s(0.1e6, x.x() > tip ? 1e6 : 0.35e6, 0);
    for (const double sign : {-1.0, 1.0}) {
        const Vec2 d = x - Vec2(tip, 0.5 * height + sign * spread(tip));
        const double r = d.norm() + 2e-4, a = std::atan2(d.y(), d.x()), k = 1.2e5 / std::sqrt(2 * std::numbers::pi * r),
                     c = std::cos(a / 2);
        s += k * c *
             Eigen::Vector3d(1 - std::sin(a / 2) * std::sin(1.5 * a), 1 + std::sin(a / 2) * std::sin(1.5 * a),
                             std::sin(a / 2) * std::cos(1.5 * a));
    }
    return s;
}

/// About 2 n_x (0.4 n_x) triangles.
inline Frame frame(int n_x = 160) {
    const int n_y = std::max(2, static_cast<int>(0.4 * n_x));
    Random random(7, "synthetic");
    std::vector<Vec2> vertices;
    for (int j = 0; j <= n_y; ++j) {
        for (int i = 0; i <= n_x; ++i) {
            const double dx = i == 0 || i == n_x ? 0 : random.uniform(-0.33, 0.33),
                         dy = j == 0 || j == n_y ? 0 : random.uniform(-0.33, 0.33);
            vertices.push_back({width * (i + dx) / n_x, height * (j + dy) / n_y});
        }
    }
    Frame f;
    f.time = 40e-6;
    std::vector<int> sides;
    std::map<std::pair<int, int>, Index> first_corner;  // of an edge seen once
    const auto add = [&](int a, int b, int c) {
        const int v[] = {a, b, c};
        const Vec2 centre = (vertices[a] + vertices[b] + vertices[c]) / 3;
        sides.push_back(side(centre));
        for (const int k : v) {
            f.position.push_back(vertices[k]);
            f.displacement.push_back(displacement(vertices[k], sides.back()));
            f.velocity.push_back(Vec2(0.1 * vertices[k].x() / width, 0.4 * sides.back()));
            f.temperature.push_back(300 + 50 * vertices[k].x() / width);
        }
        f.stress.push_back(stress(centre));
        f.stress_zz.push_back(0.2 * (f.stress.back()[0] + f.stress.back()[1]));
        f.region.push_back(centre.x() > 0.5 * width ? 1 : 0);
        for (int k = 0; k < 3; ++k) {
            const Index here = static_cast<Index>(f.position.size()) - 3 + k, next = here + (k == 2 ? -2 : 1);
            const auto other = first_corner.find({v[(k + 1) % 3], v[k]});
            if (other == first_corner.end()) {
                first_corner[{v[k], v[(k + 1) % 3]}] = here;
                continue;
            }
            const Index there = other->second, there_next = there % 3 == 2 ? there - 2 : there + 1;
            const bool on_crack = sides[here / 3] != sides[there / 3];
            f.side_a.push_back({there_next, there});
            f.side_b.push_back({here, next});
            for (const Index corner : {here, next}) {
                const Vec2 x = f.position[corner];
                const double opening =
                    on_crack ? std::abs(f.displacement[corner].y() - displacement(x, sides[there / 3]).y()) : 0;
                const double cohesion = !on_crack || x.x() > front ? 1
                                        : x.x() > tip              ? (x.x() - tip) / (front - tip)
                                                                   : 0;
                const bool precrack = on_crack && f.position[here].x() < start && f.position[next].x() < start;
                f.end_position.push_back(x);
                f.cohesion.push_back(precrack ? 0 : cohesion);
                f.opening.push_back(opening);
                f.slip.push_back(0.1 * opening);
                f.traction.push_back({1e6 * cohesion, 1e5});
                f.status.push_back(precrack        ? InterfaceStatus::precrack
                                   : cohesion == 1 ? InterfaceStatus::intact
                                   : cohesion > 0  ? InterfaceStatus::damaged
                                                   : InterfaceStatus::broken);
            }
        }
    };
    for (int j = 0; j < n_y; ++j) {
        for (int i = 0; i < n_x; ++i) {
            const int a = j * (n_x + 1) + i, b = a + 1, c = b + n_x + 1, d = c - 1;
            if (random.uniform() < 0.5) add(a, b, c), add(a, c, d);
            else add(a, b, d), add(b, c, d);
        }
    }
    f.length_scale = diagonal(f.position);
    return f;
}

inline History energy(int n = 400) {
    History h{{"time", "kinetic", "strain", "surface", "external_work", "cohesive_work", "friction_work", "impact_work",
               "residual", "law_lag_energy"},
              {}};
    for (int i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n, external = 0.62 * s * s + 0.02 * std::sin(9 * s) * s,
                     surface = s > 0.15 ? 0.27 * std::pow((s - 0.15) / 0.85, 1.2) : 0;
        const double friction = -0.03 * s * s * s, impact = 0, left = external - surface + friction;
        h.rows.push_back(
            {80e-6 * s, 0.45 * left, 0.55 * left, surface, external, surface, friction, impact, 1e-14, 1e-5});
    }
    return h;
}

inline History cracks(int n = 400) {
    History h{{"time", "main_length", "crack_length", "broken_length", "damaged_length", "tips", "branches", "tip_x",
               "tip_y", "tip_speed", "tip_speed_over_cR", "n_broken", "n_damaged"},
              {}};
    Random random(3, "speed");
    double length = 0;
    for (int i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n,
                     speed =
                         s > 0.15 && s < 0.9 ? 1250 * (1 - std::exp(-(s - 0.15) / 0.08)) + random.uniform(-60, 60) : 0;
        length += speed * 80e-6 / n;
        const double all = s > 0.5 ? length * (1 + 1.2 * (s - 0.5)) : length;
        h.rows.push_back({80e-6 * s, length, all, 1.15 * all, s > 0.13 ? 0.004 + 0.01 * s : 0, s > 0.5 ? 2.0 : 1.0,
                          s > 0.5 ? 1.0 : 0.0, start + length, 0.02, speed, speed / 2125, 300 * s, 40});
    }
    return h;
}

inline History reactions(int n = 400) {
    History h{{"time", "load0_force_x", "load0_force_y", "load0_u_x", "load0_u_y", "load2_force_x", "load2_force_y",
               "load2_u_x", "load2_u_y"},
              {}};
    for (int i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n, force = 1e3 * (s < 0.6 ? s : 0.6 * std::exp(-(s - 0.6) / 0.1));
        h.rows.push_back({80e-6 * s, 10 * s, force, 0, 1e-6 * s, -10 * s, -force, 0, 0});
    }
    return h;
}

inline History probes(int n = 400) {
    History h{{"time", "end_u_x", "end_u_y", "end_v_x", "end_v_y", "bar_stress_xx", "bar_stress_yy", "bar_stress_xy",
               "tip_K_I", "tip_K_II"},
              {}};
    for (int i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n;
        h.rows.push_back({80e-6 * s, 1e-6 * s * s, -2e-6 * std::sin(9 * s), 0.025 * s, -0.225 * std::cos(9 * s),
                          14e6 * s * (1.8 - s), 1e5 * s, 0, 1e6 * s, -2e5 * s * s});
    }
    return h;
}

inline History fluids(int n = 400) {
    History h{{"time", "water_pressure", "water_volume", "water_injected", "water_length", "water_aperture"}, {}};
    for (int i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n, length = 0.02 + 0.06 * std::pow(s, 2. / 3);
        h.rows.push_back({80e-6 * s, 2e6 * std::sqrt(0.02 / length), 1e-6 * s, 1.02e-6 * s, length, 1e-5 * s});
    }
    return h;
}

/// A rock in compression: elastic to 100 MPa, cracks from 40 MPa, most of them steep.
inline History stress_strain(int n = 400) {
    History h{
        {"time", "stress", "axial_strain", "lateral_strain", "volumetric_strain", "tensile_breaks", "shear_breaks"},
        {}};
    for (int i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n, stress = 100e6 * (s < 0.7 ? s / 0.7 : std::exp(-(s - 0.7) / 0.05)),
                     cracked = s > 0.3 ? std::pow(s - 0.3, 2) : 0;
        const double axial = 2e-3 * s, lateral = -0.6e-3 * s - 0.02 * cracked;
        h.rows.push_back(
            {80e-6 * s, stress, axial, lateral, axial + lateral, std::floor(700 * cracked), std::floor(300 * cracked)});
    }
    return h;
}

inline History breaks(int n = 200) {
    History h{{"time", "x", "y", "angle", "length", "shear", "energy"}, {}};
    Random random(5, "breaks");
    for (int i = 0; i < n; ++i)
        h.rows.push_back({80e-6 * (0.3 + 0.6 * i / n), 0.05, 0.02,
                          std::fmod(180 + 90 + 40 * (random.uniform() + random.uniform() - 1), 180), 5e-4,
                          random.uniform(0, 0.8), 1e-3});
    return h;
}

inline History fragments(int n = 60) {
    History h{{"fragment", "diameter", "mass_part", "passing"}, {}};
    for (int i = 0; i < n; ++i)
        h.rows.push_back({static_cast<double>(i), 0.02 * std::pow(0.93, i), 1. / n, 1 - static_cast<double>(i) / n});
    return h;
}

/// All of them.
inline Histories histories(int n = 400) {
    return {.energy = energy(n),
            .cracks = cracks(n),
            .reactions = reactions(n),
            .fluids = fluids(n),
            .probes = probes(n),
            .breaks = breaks(),
            .stress_strain = stress_strain(n),
            .fragments = fragments()};
}

}  // namespace synthetic
