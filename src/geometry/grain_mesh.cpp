#include "geometry/grain_mesh.hpp"

#include "geometry/relax.hpp"
#include "geometry/vertex_stars.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace knap {
namespace {

constexpr Index none = -1;
constexpr int n_sweeps = 8;

/// The neighbours of a triangle across its edges, or none.
std::vector<std::array<Index, 3>> neighbours_of(const Mesh& mesh) {
    std::vector<std::array<Index, 3>> neighbours(mesh.triangles.size(), {none, none, none});
    for (const InteriorEdge& edge : mesh.interior_edges)
        for (int k = 0; k < 2; ++k) neighbours[edge.triangle[k]][edge.side[k]] = edge.triangle[1 - k];
    return neighbours;
}

/// A triangle with two neighbours in one other grain goes over to it. Every change takes a border edge away, so this ends.
void smooth_teeth(Mesh& mesh) {
    const auto neighbours = neighbours_of(mesh);
    std::vector<Index> front(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) front[t] = mesh.n_triangles() - 1 - t;
    while (!front.empty()) {
        const Index t = front.back();
        front.pop_back();
        if (mesh.grain[t] == none) continue;
        std::array<Index, 3> grain;
        for (int k = 0; k < 3; ++k) grain[k] = neighbours[t][k] == none ? none : mesh.grain[neighbours[t][k]];
        const Index twice = grain[0] == grain[1] || grain[0] == grain[2] ? grain[0] : grain[1] == grain[2] ? grain[1] : none;
        if (twice == none || twice == mesh.grain[t]) continue;
        mesh.grain[t] = twice;
        for (const Index n : neighbours[t])
            if (n != none) front.push_back(n);
    }
}

class BorderSmoothing {
public:
    BorderSmoothing(Mesh& mesh, const Grains& grains) : mesh_(mesh), grains_(grains), stars_(mesh), fixed_(mesh.n_vertices(), 0), size_(mesh.n_vertices()) {
        const auto fix = [&](Index triangle, Index side) {
            fixed_[mesh.triangles[triangle][side]] = fixed_[mesh.triangles[triangle][(side + 1) % 3]] = 1;
        };
        for (const BoundaryEdge& edge : mesh.boundary_edges) fix(edge.triangle, edge.side);
        for (const InteriorEdge& edge : mesh.interior_edges) {
            const auto [a, b] = edge.triangle;
            if (edge.cracked || edge.joint >= 0 || mesh.region[a] != mesh.region[b] || (mesh.grain[a] == none) != (mesh.grain[b] == none)) fix(a, edge.side[0]);
        }
        for (Index v = 0; v < mesh.n_vertices(); ++v) {
            // the wanted edge length is the one found: mean over the edges round the vertex
            double sum = 0;
            for (const Index t : stars_[v])
                for (Index k = 0; k < 3; ++k)
                    if (mesh.triangles[t][k] == v)
                        sum += 0.5 * ((mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k)).norm() + (mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k)).norm());
            size_[v] = stars_[v].empty() ? 1 : sum / static_cast<double>(stars_[v].size());
        }
    }

    void run() {
        std::vector<Index> on_border, beside;
        std::vector<char> near(mesh_.n_vertices(), 0);
        for (Index v = 0; v < mesh_.n_vertices(); ++v) {
            if (fixed_[v] || grains_round(v).size() < 2) continue;
            on_border.push_back(v);
            near[v] = 1;
        }
        for (const Index v : on_border)
            for (const Index t : stars_[v])
                for (const Index w : mesh_.triangles[t])
                    if (!near[w] && !fixed_[w]) near[w] = 1, beside.push_back(w);
        for (int sweep = 0; sweep < n_sweeps; ++sweep) {
            for (const Index v : on_border) pull(v);
            for (const Index v : beside) make_way(v);
        }
    }

private:
    std::vector<Index> grains_round(Index v) const {
        std::vector<Index> found;
        for (const Index t : stars_[v])
            if (mesh_.grain[t] != none && std::find(found.begin(), found.end(), mesh_.grain[t]) == found.end()) found.push_back(mesh_.grain[t]);
        return found;
    }

    /// The nearest point of the border line, or the point where three grains meet (of more: in the least-squares sense).
    Vec2 target(Index v) const {
        const std::vector<Index> round = grains_round(v);
        Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
        Vec2 right = Vec2::Zero();
        const Vec2 x = mesh_.vertices[v];
        for (std::size_t i = 0; i < round.size(); ++i)
            for (std::size_t j = i + 1; j < round.size(); ++j) {
                const Grains::Border border = grains_.border(round[i], round[j]);
                normal += border.normal * border.normal.transpose();
                right += border.normal * (border.offset - border.normal.dot(x));
            }
        if (round.size() == 2) return x + right;
        const double trace = normal.trace(), determinant = cross(normal.col(0), normal.col(1));
        if (determinant < 1e-3 * trace * trace) return x + right / trace;  // nearly parallel borders: towards them
        return x + Vec2(cross(right, normal.col(1)), cross(normal.col(0), right)) / determinant;
    }

    /// As far towards its border as the triangles round it stay good.
    void pull(Index v) {
        const Vec2 start = mesh_.vertices[v];
        const Quality least = worst_round(v);
        Vec2 way = target(v) - start;
        if (const double length = way.norm(); length > size_[v]) way *= size_[v] / length;  // a junction may lie far off
        for (double part = 1; part > 0.1; part /= 2) {
            mesh_.vertices[v] = start + part * way;
            const Quality now = worst_round(v);
            if (now.step >= std::min(1.0, least.step) && now.angle >= std::min(1.0, least.angle)) return;
        }
        mesh_.vertices[v] = start;
    }

    /// To the middle of its neighbours, where that makes its worst triangle better.
    void make_way(Index v) {
        Vec2 sum = Vec2::Zero();
        for (const Index t : stars_[v])
            for (const Index w : mesh_.triangles[t])
                if (w != v) sum += mesh_.vertices[w];
        const Vec2 start = mesh_.vertices[v], middle = sum / (2 * static_cast<double>(stars_[v].size()));
        const double before = worst_round(v).worse();
        for (double part = 0.5; part > 0.1; part /= 2) {
            mesh_.vertices[v] = start + part * (middle - start);
            if (worst_round(v).worse() > before) return;
        }
        mesh_.vertices[v] = start;
    }

    /// Stable step and smallest angle over what is wanted of a mesh (relax.hpp).
    struct Quality {
        double step = std::numeric_limits<double>::infinity(), angle = step;
        double worse() const { return std::min(step, angle); }
    };

    Quality worst_round(Index v) const {
        static const Wanted wanted;
        static const double wanted_sine = std::sin(wanted.min_angle * std::numbers::pi / 180);
        Quality worst;
        for (const Index t : stars_[v]) {
            const Vec2 a = mesh_.corner(t, 0), b = mesh_.corner(t, 1), c = mesh_.corner(t, 2);
            worst = {std::min(worst.step, step_ratio(a, b, c, size_[v]) / wanted.step_ratio), std::min(worst.angle, smallest_sine(a, b, c) / wanted_sine)};
        }
        return worst;
    }

    Mesh& mesh_;
    const Grains& grains_;
    VertexStars stars_;
    std::vector<char> fixed_;
    std::vector<double> size_;  // [m] mean edge length round a vertex
};

/// Numbers from `first` on, in the order of the triangles.
void number_from(Index first, const std::vector<char>& is_new, std::vector<Index>& grain, Index n_grains) {
    std::vector<Index> number(n_grains, none);
    for (std::size_t t = 0; t < grain.size(); ++t) {
        if (!is_new[t]) continue;
        Index& now = number[grain[t]];
        if (now == none) now = first++;
        grain[t] = now;
    }
}

}  // namespace

Index put_grains(Mesh& mesh, const Grains& grains, Index region) {
    const std::vector<Index> old = mesh.grain.empty() ? std::vector<Index>(mesh.triangles.size(), none) : mesh.grain;
    const Index first = 1 + (old.empty() ? none : *std::max_element(old.begin(), old.end()));
    std::vector<char> is_new(mesh.triangles.size(), 0);
    mesh.grain.assign(mesh.triangles.size(), none);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        if (mesh.region[t] != region || old[t] != none) continue;
        is_new[t] = 1;
        mesh.grain[t] = grains.at((mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3);
    }
    smooth_teeth(mesh);
    BorderSmoothing(mesh, grains).run();
    number_from(first, is_new, mesh.grain, grains.n_grains());
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (!is_new[t]) mesh.grain[t] = old[t];
    return first;
}

}  // namespace knap
