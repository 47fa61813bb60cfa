#include "analysis/fragments.hpp"

#include "analysis/interface_status.hpp"
#include "base/union_find.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {

Fragments find_fragments(std::span<const TriangleContent> triangles, std::span<const std::array<Index, 2>> joined) {
    UnionFind sets(triangles.size());
    for (const auto& [a, b] : joined) sets.join(a, b);

    Fragments found;
    found.piece_of_triangle.assign(triangles.size(), -1);
    for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t) {
        const Index first = sets.find(t);
        if (first == t) {
            found.piece_of_triangle[t] = static_cast<Index>(found.pieces.size());
            found.pieces.push_back({.first_triangle = t, .n_triangles = 0, .area = 0, .mass = 0, .velocity = Vec2::Zero(), .centre = Vec2::Zero()});
        }
        found.piece_of_triangle[t] = found.piece_of_triangle[first];
        Fragment& piece = found.pieces[found.piece_of_triangle[t]];
        const TriangleContent& content = triangles[t];
        ++piece.n_triangles;
        piece.area += content.area;
        piece.mass += content.mass;
        piece.velocity += content.momentum;  // divided by the mass below
        piece.centre += content.mass * content.centroid;
        piece.kinetic_energy += content.kinetic_energy;
    }
    for (Fragment& piece : found.pieces) piece.velocity /= piece.mass, piece.centre /= piece.mass;
    // what turns: about the centre of mass, which is known now (Steiner)
    for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t) {
        const TriangleContent& content = triangles[t];
        Fragment& piece = found.pieces[found.piece_of_triangle[t]];
        const Vec2 arm = content.centroid - piece.centre;
        piece.spread += content.spread + content.mass * arm * arm.transpose();
        piece.angular_momentum += content.spin + cross(arm, content.momentum);
    }

    const auto heavier = [](const Fragment& a, const Fragment& b) { return a.mass > b.mass; };
    std::stable_sort(found.pieces.begin(), found.pieces.end(), heavier);
    for (Index p = 0; p < static_cast<Index>(found.pieces.size()); ++p) found.piece_of_triangle[found.pieces[p].first_triangle] = p;
    for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t) found.piece_of_triangle[t] = found.piece_of_triangle[sets.find(t)];
    return found;
}

Fragments find_fragments(const Model& model, const State& state) {
    std::vector<TriangleContent> triangles;
    triangles.reserve(model.mesh.triangles.size());
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const double mass = model.triangle_mass(t);
        TriangleContent content{.area = model.mesh.area(t), .mass = mass, .momentum = Vec2::Zero(), .centroid = Vec2::Zero()};
        const auto place = [&](Index k) -> Vec2 { return model.mesh.corner(t, k) + state.displacement[state.node_of_corner[n * t + k]]; };
        for (Index k = 0; k < n; ++k) {
            const double corner_mass = model.corner_mass[n * t + k];
            const Vec2& velocity = state.velocity[state.node_of_corner[n * t + k]];
            content.momentum += corner_mass * velocity;
            content.centroid += corner_mass / mass * place(k);
            content.kinetic_energy += 0.5 * corner_mass * velocity.squaredNorm();
        }
        for (Index k = 0; k < n; ++k) {
            const Vec2 arm = place(k) - content.centroid;
            content.spread += model.corner_mass[n * t + k] * arm * arm.transpose();
            content.spin += model.corner_mass[n * t + k] * cross(arm, state.velocity[state.node_of_corner[n * t + k]]);
        }
        triangles.push_back(content);
    }
    const std::vector<InterfaceStatus> status = interface_status(model, state);
    std::vector<std::array<Index, 2>> joined;
    for (std::size_t i = 0; i < status.size(); ++i) {
        const auto [a, b] = model.interfaces[i / model.mesh.order].triangle;
        const bool holds = status[i] == InterfaceStatus::intact || status[i] == InterfaceStatus::damaged;
        if (holds && a != rigid_support && b != rigid_support) joined.push_back({a, b});
    }
    return find_fragments(triangles, joined);
}

double Fragment::diameter() const { return std::sqrt(4 * area / std::numbers::pi); }

double Fragment::elongation() const {
    const double mean = 0.5 * spread.trace(), radius = std::hypot(0.5 * (spread(0, 0) - spread(1, 1)), spread(0, 1));
    return std::sqrt((mean + radius) / (mean - radius));
}

double Fragment::angle() const {
    const double degrees = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1)) * 180 / std::numbers::pi;
    return degrees < 0 ? degrees + 180 : degrees;
}

std::span<const Measure<FragmentLine>> fragment_columns() {
    using L = FragmentLine;
    static constexpr std::array columns{
        Measure<L>{"fragment", "", "number, the heaviest is 0", [](const L& l) { return static_cast<double>(l.number); }},
        Measure<L>{"triangles", "", "number of its triangles", [](const L& l) { return static_cast<double>(l.fragment.n_triangles); }},
        Measure<L>{"area", "m2", "area", [](const L& l) { return l.fragment.area; }},
        Measure<L>{"mass", "kg", "mass", [](const L& l) { return l.fragment.mass; }},
        Measure<L>{"centre_x", "m", "centre of mass, where it is at the end", [](const L& l) { return l.fragment.centre.x(); }},
        Measure<L>{"centre_y", "m", "likewise", [](const L& l) { return l.fragment.centre.y(); }},
        Measure<L>{"velocity_x", "m/s", "of the centre of mass", [](const L& l) { return l.fragment.velocity.x(); }},
        Measure<L>{"velocity_y", "m/s", "likewise", [](const L& l) { return l.fragment.velocity.y(); }},
        Measure<L>{"diameter", "m", "of the circle of the same area", [](const L& l) { return l.fragment.diameter(); }},
        Measure<L>{"mass_part", "", "its mass over the mass of all", [](const L& l) { return l.mass_part; }},
        Measure<L>{"passing", "", "part of the mass of all in fragments of this diameter or less", [](const L& l) { return l.passing; }},
        Measure<L>{"elongation", "", "longest over shortest axis of the ellipse with the same moments", [](const L& l) { return l.fragment.elongation(); }},
        Measure<L>{"angle", "deg", "of the longest axis from the x axis, 0 to 180", [](const L& l) { return l.fragment.angle(); }},
        Measure<L>{"spin", "rad/s", "angular momentum about the centre of mass over the moment of inertia", [](const L& l) { return l.fragment.spin(); }},
        Measure<L>{"kinetic_energy", "J", "kinetic energy", [](const L& l) { return l.fragment.kinetic_energy; }},
    };
    return columns;
}

History fragment_table(const Fragments& fragments) {
    History table{.columns = names_of(fragment_columns()), .rows = {}};
    std::vector<std::pair<double, double>> sizes;  // diameter, mass
    double mass = 0;
    for (const Fragment& f : fragments.pieces) sizes.emplace_back(f.diameter(), f.mass), mass += f.mass;
    std::sort(sizes.begin(), sizes.end());
    std::vector<double> up_to(1, 0.0);  // mass of the i smallest
    for (const auto& size : sizes) up_to.push_back(up_to.back() + size.second);
    for (std::size_t p = 0; p < fragments.pieces.size(); ++p) {
        const Fragment& f = fragments.pieces[p];
        const auto larger = std::upper_bound(sizes.begin(), sizes.end(), f.diameter(), [](double d, const auto& size) { return d < size.first; });
        const double passing = up_to[static_cast<std::size_t>(larger - sizes.begin())] / up_to.back();
        table.rows.push_back(values_of(fragment_columns(), FragmentLine{p, f, f.mass / mass, passing}));
    }
    return table;
}

double diameter_passing(const History& table, double part) {
    double smallest = std::nan("");
    const std::vector<double> diameter = table.column("diameter"), passing = table.column("passing");
    for (std::size_t i = 0; i < diameter.size(); ++i)
        if (passing[i] >= part * (1 - 1e-12)) smallest = std::fmin(smallest, diameter[i]);
    return smallest;
}

}  // namespace knap
