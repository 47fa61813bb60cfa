#include "analysis/fragments.hpp"

#include "analysis/interface_graph.hpp"
#include "base/union_find.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <ranges>

namespace knap {

namespace {

/// `content_of(t, moments)` of a triangle, with its moments or without, is asked twice: to keep them all would take 128
/// bytes a triangle. `whole`: with the moments, too.
template <class Content>
Fragments fragments_of_sets(UnionFind& sets, Index n_triangles, bool whole, const Content& content_of) {
    Fragments found;
    found.piece_of_triangle.reserve(n_triangles);
    for (Index t = 0; t < n_triangles; ++t) {
        const Index first = sets.find(t);  // the lowest triangle of its fragment
        if (first == t) found.pieces.push_back({.first_triangle = t});
        found.piece_of_triangle.push_back(first == t ? static_cast<Index>(found.pieces.size()) - 1
                                                     : found.piece_of_triangle[first]);
        Fragment& piece = found.pieces[found.piece_of_triangle[t]];
        const TriangleContent& content = content_of(t, false);
        ++piece.n_triangles;
        piece.area += content.area;
        piece.mass += content.mass;
        piece.velocity += content.momentum;  // divided by the mass below
        piece.centre += content.mass * content.centroid;
        piece.kinetic_energy += content.kinetic_energy;
        piece.start += content.mass * content.start;
    }
    for (Fragment& piece : found.pieces)
        piece.velocity /= piece.mass, piece.centre /= piece.mass, piece.start /= piece.mass;
    for (Index t = 0; whole && t < n_triangles; ++t) {  // moments about the centre of mass (Steiner)
        const TriangleContent& content = content_of(t, true);
        Fragment& piece = found.pieces[found.piece_of_triangle[t]];
        const Vec2 arm = content.centroid - piece.centre;
        piece.spread += content.spread + content.mass * arm * arm.transpose();
        piece.angular_momentum += content.spin + cross(arm, content.momentum);
        const Vec2 from = content.start - piece.start;
        piece.turn += content.turn + content.mass * Vec2(from.dot(arm), cross(from, arm));
    }

    std::ranges::stable_sort(found.pieces, std::greater<>(), &Fragment::mass);
    for (std::size_t p = 0; p < found.pieces.size(); ++p)
        found.piece_of_triangle[found.pieces[p].first_triangle] = static_cast<Index>(p);
    for (Index t = 0; t < n_triangles; ++t) found.piece_of_triangle[t] = found.piece_of_triangle[sets.find(t)];
    return found;
}

/// `n` corners a triangle.
template <Index n>
TriangleContent content_of(const Model& model, const State& state, Index t, bool moments) {
    TriangleContent content{.area = model.mesh.area(t), .mass = model.triangle_mass(t)};
    const double* mass = &model.corner_mass[n * t];
    std::array<Vec2, n> at_start, now, velocity;
    for (Index k = 0; k < n; ++k) {
        const Index node = state.node_of_corner[n * t + k];
        velocity[k] = state.velocity[node];
        at_start[k] = model.mesh.corner(t, k);
        now[k] = at_start[k] + state.displacement[node];
        const double part = mass[k] / content.mass;
        content.momentum += mass[k] * velocity[k];
        content.centroid += part * now[k];
        content.start += part * at_start[k];
        content.kinetic_energy += 0.5 * mass[k] * velocity[k].squaredNorm();
    }
    for (Index k = 0; moments && k < n; ++k) {
        const Vec2 arm = now[k] - content.centroid;
        content.spread += mass[k] * arm * arm.transpose();
        content.spin += mass[k] * cross(arm, velocity[k]);
        const Vec2 from = at_start[k] - content.start;
        content.turn += mass[k] * Vec2(from.dot(arm), cross(from, arm));
    }
    return content;
}

/// `whole`: with what the pieces are and how they move, beyond their masses.
Fragments fragments_of(const Model& model, const State& state, bool whole) {
    std::vector<Index> number,
        place(model.mesh.n_triangles(), -1);  // of the triangles that have not vanished, and back
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        if (!model.has_vanished(t)) place[t] = static_cast<Index>(number.size()), number.push_back(t);
    const auto content_at = [&](Index i, bool moments) {
        const Index t = number[i];
        if (!whole) return TriangleContent{.mass = model.triangle_mass(t)};
        return model.mesh.order == 1 ? content_of<3>(model, state, t, moments)
                                     : content_of<7>(model, state, t, moments);
    };
    const std::vector<InterfaceStatus> status = interface_status(model, state);
    UnionFind sets(number.size());
    for (std::size_t i = 0; i < status.size(); ++i) {
        const auto [a, b] = model.interfaces[i / model.mesh.order].triangle;
        const bool unbroken = status[i] == InterfaceStatus::intact || status[i] == InterfaceStatus::damaged;
        if (!unbroken || a == rigid_support || b == rigid_support) continue;
        if (!model.is_gone(model.interfaces[i / model.mesh.order])) sets.join(place[a], place[b]);
    }
    Fragments found = fragments_of_sets(sets, static_cast<Index>(number.size()), whole, content_at);
    for (Fragment& piece : found.pieces) piece.first_triangle = number[piece.first_triangle];
    std::vector<Index> piece_of(model.mesh.n_triangles(), -1);
    for (std::size_t i = 0; i < number.size(); ++i) piece_of[number[i]] = found.piece_of_triangle[i];
    found.piece_of_triangle = std::move(piece_of);
    found.turn = model.large_rotation;
    return found;
}

}  // namespace

Fragments find_fragments(std::span<const TriangleContent> triangles, std::span<const std::array<Index, 2>> joined) {
    UnionFind sets(triangles.size());
    for (const auto& [a, b] : joined) sets.join(a, b);
    return fragments_of_sets(sets, static_cast<Index>(triangles.size()), true,
                             [&](Index t, bool) { return triangles[t]; });
}

Fragments find_fragments(const Model& model, const State& state) { return fragments_of(model, state, true); }

std::vector<Index> fragment_of_triangles(const Model& model, const State& state) {
    return fragments_of(model, state, false).piece_of_triangle;
}

double Fragment::rotation() const {
    const double principal = std::atan2(turn.y(), turn.x()) / degree;
    return principal + 360 * std::round((near - principal) / 360);
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

std::span<const Measure<FragmentLine>> fragment_columns(bool turn) {
    using L = FragmentLine;
    static constexpr Measure<L> columns[] = {
        {"fragment", "", "number of the fragment; the heaviest is 0", [](const L& l) { return double(l.number); }},
        {"triangles", "", "number of its triangles", [](const L& l) { return double(l.fragment.n_triangles); }},
        {"area", "m2", "area", [](const L& l) { return l.fragment.area; }},
        {"mass", "kg", "mass", [](const L& l) { return l.fragment.mass; }},
        {"centre_x", "m", "x of the centre of mass in the deformed body",
         [](const L& l) { return l.fragment.centre.x(); }},
        {"centre_y", "m", "y of the centre of mass in the deformed body",
         [](const L& l) { return l.fragment.centre.y(); }},
        {"velocity_x", "m/s", "velocity of the centre of mass, x", [](const L& l) { return l.fragment.velocity.x(); }},
        {"velocity_y", "m/s", "velocity of the centre of mass, y", [](const L& l) { return l.fragment.velocity.y(); }},
        {"diameter", "m", "diameter of the circle of the same area", [](const L& l) { return l.fragment.diameter(); }},
        {"mass_part", "", "mass over the mass of the whole body", [](const L& l) { return l.mass_part; }},
        {"passing", "", "part of the mass of the body that is in fragments of this diameter or less",
         [](const L& l) { return l.passing; }},
        {"elongation", "", "longest over shortest axis of the ellipse with the same moments",
         [](const L& l) { return l.fragment.elongation(); }},
        {"angle", "deg", "angle of the longest axis to the x axis, 0 to 180",
         [](const L& l) { return l.fragment.angle(); }},
        {"spin", "rad/s", "angular momentum about the centre of mass over the moment of inertia",
         [](const L& l) { return l.fragment.spin(); }},
        {"kinetic_energy", "J", "kinetic energy", [](const L& l) { return l.fragment.kinetic_energy; }},
        {"rotation", "deg", "angle by which the fragment has turned, full turns counted; with large rotations only",
         [](const L& l) { return l.fragment.rotation(); }}};
    return std::span(columns).first(std::size(columns) - (turn ? 0 : 1));  // `rotation` is the last
}

History fragment_table(const Fragments& fragments) {
    const std::span<const Measure<FragmentLine>> columns = fragment_columns(fragments.turn);
    History table{.columns = names_of(columns), .rows = {}};
    std::vector<std::pair<double, double>> sizes;  // diameter, mass
    double mass = 0;
    for (const Fragment& f : fragments.pieces) sizes.emplace_back(f.diameter(), f.mass), mass += f.mass;
    std::ranges::sort(sizes);
    std::vector<double> up_to(1, 0.0);  // mass of the i smallest
    for (const auto& size : sizes) up_to.push_back(up_to.back() + size.second);
    for (std::size_t p = 0; p < fragments.pieces.size(); ++p) {
        const Fragment& f = fragments.pieces[p];
        const auto larger = std::ranges::upper_bound(sizes, f.diameter(), {}, &std::pair<double, double>::first);
        const double passing = up_to[static_cast<std::size_t>(larger - sizes.begin())] / up_to.back();
        table.rows.push_back(values_of(columns, FragmentLine{p, f, f.mass / mass, passing}));
    }
    return table;
}

std::span<const Measure<FragmentMoment>> fragment_moment_columns() {
    using M = FragmentMoment;
    static constexpr auto least = [](const M& m, auto of) {
        return std::ranges::min(m.fragments.pieces | std::views::transform(of));
    };
    static constexpr auto sum = [](const M& m, auto of) {
        double total = 0;
        for (const Fragment& piece : m.fragments.pieces) total += std::invoke(of, piece);
        return total;
    };
    using F = Fragment;
    static constexpr Measure<M> columns[] = {
        {"time", "s", "time", [](const M& m) { return m.time; }},
        {"fragments", "", "number of fragments; bodies that are whole count as one each",
         [](const M& m) { return double(m.fragments.pieces.size()); }},
        {"largest_fragment", "", "mass of the heaviest fragment over that of all",
         [](const M& m) { return m.fragments.pieces.front().mass / sum(m, [](const F& f) { return f.mass; }); }},
        {"median_fragment", "m", "diameter up to which fragments have half of the mass",
         [](const M& m) { return diameter_passing(m.table, 0.5); }},
        {"from_x", "m", "smallest x of the centres of mass of fragments",
         [](const M& m) { return least(m, [](const F& f) { return f.centre.x(); }); }},
        {"to_x", "m", "largest x of the centres of mass of fragments: the run-out",
         [](const M& m) { return -least(m, [](const F& f) { return -f.centre.x(); }); }},
        {"from_y", "m", "smallest y of the centres of mass of fragments",
         [](const M& m) { return least(m, [](const F& f) { return f.centre.y(); }); }},
        {"to_y", "m", "largest y of the centres of mass of fragments",
         [](const M& m) { return -least(m, [](const F& f) { return -f.centre.y(); }); }},
        {"largest_speed", "m/s", "largest speed of a centre of mass",
         [](const M& m) { return -least(m, [](const F& f) { return -f.velocity.norm(); }); }},
        {"translation", "J", "kinetic energy of the centres of mass",
         [](const M& m) { return sum(m, &F::energy_of_translation); }},
        {"rotation", "J", "kinetic energy of the spins", [](const M& m) { return sum(m, &F::energy_of_rotation); }}};
    return columns;
}

std::vector<Output> fragment_path_columns(bool turn) {
    std::vector<Output> columns{
        {"time", "s", "time"},
        {"label", "", "lowest triangle of the fragment: where it breaks, the part with this triangle keeps the label"}};
    columns.insert(columns.end(), fragment_columns(turn).begin(), fragment_columns(turn).end());
    return columns;
}

std::vector<std::vector<double>> fragment_path_lines(double time, const Fragments& fragments, const History& table) {
    constexpr std::size_t max_lines = 1000;  // of one time
    std::vector<std::vector<double>> lines;
    for (std::size_t p = 0; p < std::min(fragments.pieces.size(), max_lines); ++p) {
        std::vector<double>& line = lines.emplace_back();
        line = {time, static_cast<double>(fragments.pieces[p].first_triangle)};
        line.insert(line.end(), table.rows[p].begin(), table.rows[p].end());
    }
    return lines;
}

double diameter_passing(const History& table, double part) {
    double smallest = std::nan("");
    const std::vector<double> diameter = table.column("diameter"), passing = table.column("passing");
    for (std::size_t i = 0; i < diameter.size(); ++i)
        if (passing[i] >= part * (1 - 1e-12)) smallest = std::fmin(smallest, diameter[i]);
    return smallest;
}

}  // namespace knap
