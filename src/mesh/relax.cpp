#include "mesh/relax.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {

QualityTarget::QualityTarget(double min_angle) : min_sine_(std::sin(min_angle * std::numbers::pi / 180)) {}

TriangleQuality QualityTarget::operator()(const Mesh& mesh, Index triangle, double size) const {
    const Vec2 a = mesh.corner(triangle, 0), b = mesh.corner(triangle, 1), c = mesh.corner(triangle, 2);
    const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm(), twice_area = cross(b - a, c - a);
    TriangleQuality quality{0, twice_area * std::min({ab, bc, ca}) / (ab * bc * ca) / min_sine_};
    if (!(twice_area > 0)) return quality;
    // sum grad N grad N' has the trace sum l^2/(4 A^2) and the determinant 3/(4 A^2); both eigenvalues are 2/l^2 when
    // equilateral
    const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
    const double half_trace = 0.5 * squares / (twice_area * twice_area), determinant = 3 / (twice_area * twice_area);
    const double largest = half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - determinant));
    quality.step = std::sqrt(2 / largest) / size / step_ratio;
    return quality;
}

namespace {

/// size(t) [m]: of the triangle t.
template <class SizeOfTriangle, class SizeAt>
void relax(Mesh& mesh, const std::vector<char>& fixed, const SizeOfTriangle& size_of, const SizeAt& size_at,
           const QualityTarget& target) {
    static const std::array<Vec2, 8> directions{Vec2(1, 0),  Vec2(0.7, 0.7),   Vec2(0, 1),  Vec2(-0.7, 0.7),
                                                Vec2(-1, 0), Vec2(-0.7, -0.7), Vec2(0, -1), Vec2(0.7, -0.7)};
    const Grouped<Index> stars = vertex_stars(mesh);
    const auto quality = [&](Index t) { return target(mesh, t, size_of(t)); };
    // No angle becomes worse than the target for a better one: where the shape itself has small details the step ratio
    // cannot be reached, and angles must not pay for trying. Ends with the first triangle that decides against it.
    // Begins with the triangle that decided last: it mostly does so again.
    std::size_t deciding = 0;
    const auto improves = [&](std::span<const Index> star, TriangleQuality& best) {
        TriangleQuality found{infinity, infinity};
        for (std::size_t i = 0; i < star.size(); ++i) {
            const std::size_t k = (deciding + i) % star.size();
            const TriangleQuality q = quality(star[k]);
            found = {std::min(found.step, q.step), std::min(found.angle, q.angle)};
            if (found.angle < std::min(1.0, best.angle) || found.worse() <= best.worse()) {
                deciding = k;
                return false;
            }
        }
        best = found;
        return true;
    };
    // A search that moved nothing would do so again while no vertex of its star has moved.
    std::vector<int> moved(mesh.vertices.size(), 0), in_vain(mesh.vertices.size(), -1);  // number of the last move
    int n_moves = 0;
    const auto is_in_vain = [&](Index v) {
        return in_vain[v] >= 0 && std::ranges::all_of(stars[v], [&](Index t) {
                   return std::ranges::all_of(mesh.triangles[t], [&](Index w) { return moved[w] <= in_vain[v]; });
               });
    };
    // Pattern search for the position of one vertex where the worst triangle of its star is best.
    const auto move = [&](Index v) {
        if (is_in_vain(v)) return;
        Vec2& x = mesh.vertices[v];
        const Vec2 first = x;
        TriangleQuality best = worst_of(stars[v], quality);
        double step = 0.1 * size_at(x);
        for (int n_halvings = 0; n_halvings < 4 && best.worse() < 1;) {
            const Vec2 start = x;
            Vec2 place = start;
            for (const Vec2& direction : directions) {
                x = start + step * direction;
                if (improves(stars[v], best)) place = x;
            }
            x = place;
            if (place == start) step /= 2, ++n_halvings;
        }
        if (x == first) in_vain[v] = n_moves;
        else moved[v] = ++n_moves;
    };
    for (int sweep = 0; sweep < 4; ++sweep) {
        std::vector<std::pair<double, Index>> bad;
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            if (const double worse = quality(t).worse(); worse < 1) bad.emplace_back(worse, t);
        std::ranges::sort(bad);
        for (const auto& [worse, t] : bad)
            for (const Index v : mesh.triangles[t])
                if (!fixed[v]) move(v);
    }
}

}  // namespace

void relax_worst(Mesh& mesh, const std::vector<char>& fixed, const std::function<double(const Vec2&)>& size,
                 const QualityTarget& target) {
    relax(
        mesh, fixed, [&](Index t) { return size(mesh.centroid(t)); }, size, target);
}

void relax_worst(Mesh& mesh, const std::vector<char>& fixed, double size, const QualityTarget& target) {
    const auto same = [&](const auto&) { return size; };
    relax(mesh, fixed, same, same, target);
}

}  // namespace knap
