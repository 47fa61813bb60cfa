#include "microstructure/grain_mesh.hpp"

#include "mesh/relax.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

/// A triangle with two neighbours with one other label takes it. Every change removes a border edge, so this
/// ends.
void smooth_teeth(const Mesh& mesh, std::vector<Index>& label) {
    std::vector<std::array<Index, 3>> neighbours(mesh.triangles.size(),
                                                 {no_index, no_index, no_index});  // across the edges
    for (const InteriorEdge& edge : mesh.interior_edges)
        for (int k = 0; k < 2; ++k) neighbours[edge.triangle[k]][edge.side[k]] = edge.triangle[1 - k];
    std::vector<Index> front(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) front[t] = mesh.n_triangles() - 1 - t;
    while (!front.empty()) {
        const Index t = front.back();
        front.pop_back();
        if (label[t] == no_index) continue;
        std::array<Index, 3> grain;
        for (int k = 0; k < 3; ++k) grain[k] = neighbours[t][k] == no_index ? no_index : label[neighbours[t][k]];
        const Index twice = grain[0] == grain[1] || grain[0] == grain[2] ? grain[0]
                            : grain[1] == grain[2]                       ? grain[1]
                                                                         : no_index;
        if (twice == no_index || twice == label[t]) continue;
        label[t] = twice;
        for (const Index n : neighbours[t])
            if (n != no_index) front.push_back(n);
    }
}

/// Moves vertices between grains onto the true borders, and their neighbours out of the way.
class BorderSmoothing {
public:
    BorderSmoothing(Mesh& mesh, const std::vector<Index>& label, const BorderBetween& border,
                    std::span<const Index> fixed)
        : mesh_(mesh),
          label_(label),
          border_(border),
          stars_(vertex_stars(mesh)),
          fixed_(mesh.n_vertices(), 0),
          size_(mesh.n_vertices(), 1) {
        for (const Index v : fixed) fixed_[v] = 1;
        const auto fix = [&](Index triangle, Index side) {
            for (const Index v : mesh.side_vertices(triangle, side)) fixed_[v] = 1;
        };
        for (const BoundaryEdge& edge : mesh.boundary_edges) fix(edge.triangle, edge.side);
        for (const InteriorEdge& edge : mesh.interior_edges) {
            const auto [a, b] = edge.triangle;
            const bool of_materials =
                mesh.region[a] != mesh.region[b] || (label[a] == no_index) != (label[b] == no_index);
            if (edge.cracked || edge.joint >= 0 || of_materials) fix(a, edge.side[0]);
        }
        for (Index v = 0; v < mesh.n_vertices(); ++v) {
            double sum = 0;
            for (const Index t : stars_[v])
                for (Index k = 0; k < 3; ++k)
                    if (mesh.triangles[t][k] == v)
                        sum += 0.5 * (mesh.side_vector(t, k).norm() + mesh.side_vector(t, (k + 2) % 3).norm());
            if (!stars_[v].empty()) size_[v] = sum / static_cast<double>(stars_[v].size());
        }
    }

    void run() {
        constexpr int n_sweeps = 8;
        std::vector<Index> on_border, neighbours;
        std::vector<char> near(mesh_.n_vertices(), 0);
        for (Index v = 0; v < mesh_.n_vertices(); ++v)
            if (!fixed_[v] && grains_around(v).size() >= 2) near[v] = 1, on_border.push_back(v);
        for (const Index v : on_border)
            for (const Index t : stars_[v])
                for (const Index w : mesh_.triangles[t])
                    if (!near[w] && !fixed_[w]) near[w] = 1, neighbours.push_back(w);
        for (int sweep = 0; sweep < n_sweeps; ++sweep) {
            for (const Index v : on_border) pull(v);
            for (const Index v : neighbours) make_way(v);
        }
    }

private:
    std::vector<Index> grains_around(Index v) const {
        std::vector<Index> found;
        for (const Index t : stars_[v])
            if (label_[t] != no_index && std::ranges::count(found, label_[t]) == 0) found.push_back(label_[t]);
        return found;
    }

    /// The nearest point of the border line, or the point where three grains meet (of more: in the least-squares
    /// sense).
    Vec2 target(Index v) const {
        const std::vector<Index> around = grains_around(v);
        Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
        Vec2 right = Vec2::Zero();
        const Vec2 x = mesh_.vertices[v];
        for (std::size_t i = 0; i < around.size(); ++i)
            for (std::size_t j = i + 1; j < around.size(); ++j) {
                const Grains::Border border = border_(around[i], around[j], x);
                normal += border.normal * border.normal.transpose();
                right += border.normal * (border.offset - border.normal.dot(x));
            }
        if (around.size() == 2 || normal.isZero(0)) return x + right;
        const double trace = normal.trace(), determinant = cross(normal.col(0), normal.col(1));
        if (determinant < 1e-3 * trace * trace) return x + right / trace;  // nearly parallel borders: towards them
        return x + Vec2(cross(right, normal.col(1)), cross(normal.col(0), right)) / determinant;
    }

    /// Moves v as far along `way` as the star of v stays acceptable: tries `part` of it, and half of that as long as
    /// more than a tenth is left.
    template <class IsAcceptable>
    void move(Index v, const Vec2& way, double part, const IsAcceptable& is_acceptable) {
        const Vec2 start = mesh_.vertices[v];
        for (; part > 0.1; part /= 2) {
            mesh_.vertices[v] = start + part * way;
            if (is_acceptable(worst_of_star(v))) return;
        }
        mesh_.vertices[v] = start;
    }

    /// Towards its border, as far as the triangles around it stay good.
    void pull(Index v) {
        const TriangleQuality before = worst_of_star(v);
        Vec2 way = target(v) - mesh_.vertices[v];
        if (const double length = way.norm(); length > size_[v]) way *= size_[v] / length;  // a junction may be distant
        move(v, way, 1, [&](const TriangleQuality& now) {
            return now.step >= std::min(1.0, before.step) && now.angle >= std::min(1.0, before.angle);
        });
    }

    /// Towards the middle of its neighbours, where that improves its worst triangle.
    void make_way(Index v) {
        Vec2 sum = Vec2::Zero();
        for (const Index t : stars_[v])
            for (const Index w : mesh_.triangles[t])
                if (w != v) sum += mesh_.vertices[w];
        const Vec2 middle = sum / (2 * static_cast<double>(stars_[v].size()));
        const double before = worst_of_star(v).worse();
        move(v, middle - mesh_.vertices[v], 0.5, [&](const TriangleQuality& now) { return now.worse() > before; });
    }

    TriangleQuality worst_of_star(Index v) const {
        return worst_of(stars_[v], [&](Index t) { return quality_(mesh_, t, size_[v]); });
    }

    Mesh& mesh_;
    const std::vector<Index>& label_;
    const BorderBetween& border_;
    QualityTarget quality_;
    Grouped<Index> stars_;
    std::vector<char> fixed_;
    std::vector<double> size_;  // [m] mean edge length around a vertex, taken as the requested one
};

/// Moments of the area of one grain.
struct Moments {
    double area = 0;                                   // [m2]
    Vec2 first = Vec2::Zero();                         // [m3]
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();  // [m4]
    Index n_triangles = 0;
    bool is_whole = true;  // all its triangles have neighbours, and these are in grains
};

std::vector<Moments> moments_of_grains(const Mesh& mesh) {
    std::vector<Moments> moments;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Index g = mesh.grain[t];
        if (g < 0) continue;
        if (g >= std::ssize(moments)) moments.resize(g + 1);
        const double area = mesh.area(t);
        const Vec2 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2), sum = a + b + c;
        moments[g].area += area;
        moments[g].first += area / 3 * sum;
        moments[g].second +=
            area / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
        ++moments[g].n_triangles;
    }
    const auto cut = [&](Index grain) {
        if (grain >= 0) moments[grain].is_whole = false;
    };
    for (const BoundaryEdge& edge : mesh.boundary_edges) cut(mesh.grain[edge.triangle]);
    for (const InteriorEdge& edge : mesh.interior_edges) {
        const Index a = mesh.grain[edge.triangle[0]], b = mesh.grain[edge.triangle[1]];
        if (a < 0 || b < 0) cut(std::max(a, b));
    }
    return moments;
}

}  // namespace

void fit_borders(Mesh& mesh, std::vector<Index>& label, const BorderBetween& border, std::span<const Index> fixed) {
    smooth_teeth(mesh, label);
    BorderSmoothing(mesh, label, border, fixed).run();
}

Index put_grains(Mesh& mesh, const Grains& grains, Index region, std::span<const Index> fixed) {
    const std::vector<Index> old =
        mesh.grain.empty() ? std::vector<Index>(mesh.triangles.size(), no_index) : mesh.grain;
    const Index first = 1 + (old.empty() ? no_index : std::ranges::max(old));
    const auto is_new = [&](Index t) { return mesh.region[t] == region && old[t] == no_index; };
    mesh.grain.assign(mesh.triangles.size(), no_index);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (is_new(t)) mesh.grain[t] = grains.at(mesh.centroid(t));
    fit_borders(
        mesh, mesh.grain, [&](Index a, Index b, const Vec2&) { return grains.border(a, b); }, fixed);
    std::vector<Index> number(grains.n_grains(), no_index);  // from `first` on, in the order of the triangles
    for (Index t = 0, next = first; t < mesh.n_triangles(); ++t) {
        Index& grain = mesh.grain[t];
        if (is_new(t) && number[grain] == no_index) number[grain] = next++;
        grain = is_new(t) ? number[grain] : old[t];
    }
    return first;
}

std::vector<double> grain_areas(const Mesh& mesh) {
    std::vector<double> areas;
    for (const Moments& m : moments_of_grains(mesh)) areas.push_back(m.area);
    return areas;
}

GrainReport judge_grains(const Mesh& mesh) {
    const std::vector<Moments> moments = moments_of_grains(mesh);
    GrainReport report{.n_grains = static_cast<Index>(moments.size())};
    double sum = 0, squares = 0;
    Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();
    for (const Moments& m : moments) {
        if (!m.is_whole || m.n_triangles == 0) continue;
        const double diameter = std::sqrt(4 * m.area / std::numbers::pi);
        sum += diameter;
        squares += diameter * diameter;
        const Vec2 centroid = m.first / m.area;
        shape += (m.second - m.area * centroid * centroid.transpose()) / (m.area * m.area);
        report.min_triangles = report.n_whole == 0 ? m.n_triangles : std::min(report.min_triangles, m.n_triangles);
        ++report.n_whole;
    }
    if (const Index n = report.n_whole; n > 0) {
        const double d = report.mean_diameter = sum / n;
        report.spread = std::sqrt(std::max(0.0, squares / n - d * d)) / d;
        const double mean = 0.5 * shape.trace(), half = 0.5 * (shape(0, 0) - shape(1, 1)),
                     radius = std::hypot(half, shape(0, 1));
        report.elongation = std::sqrt((mean + radius) / (mean - radius));
        report.direction = 0.5 * std::atan2(shape(0, 1), half);
    }
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (mesh.grain[edge.triangle[0]] != mesh.grain[edge.triangle[1]])
            report.border_length += mesh.side_vector(edge.triangle[0], edge.side[0]).norm();
    return report;
}

}  // namespace knap
