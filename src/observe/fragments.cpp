#include "observe/fragments.hpp"

#include "model/model.hpp"
#include "model/state.hpp"
#include "observe/interface_status.hpp"

#include <algorithm>
#include <numeric>
#include <ostream>

namespace knap {

namespace {

/// Union-find in which the lowest triangle of a set names it.
class Sets {
public:
    explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
    Index name(Index i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(Index a, Index b) {
        a = name(a), b = name(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<Index> parent_;
};

}  // namespace

Fragments find_fragments(std::span<const TriangleContent> triangles, std::span<const std::array<Index, 2>> joined) {
    Sets sets(triangles.size());
    for (const auto& [a, b] : joined) sets.join(a, b);

    Fragments found;
    found.piece_of_triangle.assign(triangles.size(), -1);
    for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t) {
        const Index first = sets.name(t);
        if (first == t) {
            found.piece_of_triangle[t] = static_cast<Index>(found.pieces.size());
            found.pieces.push_back({t, 0, 0.0, 0.0, Vec2::Zero(), Vec2::Zero()});
        }
        found.piece_of_triangle[t] = found.piece_of_triangle[first];
        Fragment& piece = found.pieces[found.piece_of_triangle[t]];
        const TriangleContent& content = triangles[t];
        ++piece.n_triangles;
        piece.area += content.area;
        piece.mass += content.mass;
        piece.velocity += content.momentum;  // divided by the mass below
        piece.centre += content.mass * content.centroid;
    }
    for (Fragment& piece : found.pieces) piece.velocity /= piece.mass, piece.centre /= piece.mass;

    const auto heavier = [](const Fragment& a, const Fragment& b) { return a.mass > b.mass; };
    std::stable_sort(found.pieces.begin(), found.pieces.end(), heavier);
    for (Index p = 0; p < static_cast<Index>(found.pieces.size()); ++p) found.piece_of_triangle[found.pieces[p].first_triangle] = p;
    for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t) found.piece_of_triangle[t] = found.piece_of_triangle[sets.name(t)];
    return found;
}

Fragments find_fragments(const Model& model, const State& state) {
    std::vector<TriangleContent> triangles;
    triangles.reserve(model.mesh.triangles.size());
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const double mass = model.triangle_mass(t);
        Vec2 momentum = Vec2::Zero(), moment = Vec2::Zero();  // sums over the corners
        for (Index k = 0; k < n; ++k) {
            const Index node = state.node_of_corner[n * t + k];
            momentum += model.corner_mass[n * t + k] * state.velocity[node];
            moment += model.corner_mass[n * t + k] * (model.mesh.corner(t, k) + state.displacement[node]);
        }
        triangles.push_back({model.mesh.area(t), mass, momentum, moment / mass});
    }
    const std::vector<InterfaceStatus> status = interface_status(model, state);
    std::vector<std::array<Index, 2>> joined;
    for (std::size_t i = 0; i < status.size(); ++i) {
        const auto [a, b] = model.interfaces[i / model.mesh.order].triangle;
        const bool holds = status[i] == InterfaceStatus::intact || status[i] == InterfaceStatus::damaged;
        if (holds && a != ground && b != ground) joined.push_back({a, b});
    }
    return find_fragments(triangles, joined);
}

void write_fragments(std::ostream& out, const Fragments& fragments) {
    out << "fragment,triangles,area_m2,mass_kg,centre_x_m,centre_y_m,velocity_x_m_s,velocity_y_m_s\n";
    const auto precision = out.precision(9);
    for (std::size_t p = 0; p < fragments.pieces.size(); ++p) {
        const Fragment& f = fragments.pieces[p];
        out << p << ',' << f.n_triangles << ',' << f.area << ',' << f.mass << ',' << f.centre.x() << ',' << f.centre.y() << ','
            << f.velocity.x() << ',' << f.velocity.y() << '\n';
    }
    out.precision(precision);
}

}  // namespace knap
