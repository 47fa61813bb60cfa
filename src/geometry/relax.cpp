#include "geometry/relax.hpp"

#include "geometry/vertex_stars.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace knap {

double step_ratio(const Vec2& a, const Vec2& b, const Vec2& c, double size) {
    const double twice_area = cross(b - a, c - a);
    if (!(twice_area > 0)) return 0;
    // sum grad N grad N' has the trace sum l^2 / (4 A^2) and the determinant 3 / (4 A^2); both eigenvalues are 2 / l^2 when equilateral
    const double half_trace = 0.5 * ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) / (twice_area * twice_area);
    const double determinant = 3 / (twice_area * twice_area);
    const double largest = half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - determinant));
    return std::sqrt(2 / largest) / size;
}

double smallest_sine(const Vec2& a, const Vec2& b, const Vec2& c) {
    const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
    return cross(b - a, c - a) * std::min({ab, bc, ca}) / (ab * bc * ca);
}

namespace {

class Relaxation {
public:
    Relaxation(Mesh& mesh, const SizeField& size, const Wanted& wanted)
        : mesh_(mesh), size_(size), wanted_(wanted), wanted_sine_(std::sin(wanted.min_angle * std::numbers::pi / 180)), stars_(mesh) {}

    /// 1 and more is good enough.
    double quality(Index t) const {
        const Quality q = both(t);
        return std::min(q.step, q.angle);
    }

    /// Pattern search for the place of one vertex where the worst triangle of its star is best. No angle gets worse than wanted for it:
    /// where the shape itself has small details the step ratio cannot be had, and angles must not pay for trying.
    void move(Index v) {
        Quality best = worst_of_star(v);
        double step = 0.1 * size_(mesh_.vertices[v]);
        for (int n_halvings = 0; n_halvings < 4 && std::min(best.step, best.angle) < 1;) {
            const Vec2 start = mesh_.vertices[v];
            Vec2 place = start;
            for (const Vec2& direction : directions) {
                mesh_.vertices[v] = start + step * direction;
                const Quality found = worst_of_star(v);
                if (found.angle >= std::min(1.0, best.angle) && std::min(found.step, found.angle) > std::min(best.step, best.angle)) {
                    best = found;
                    place = mesh_.vertices[v];
                }
            }
            mesh_.vertices[v] = place;
            if (place == start) {
                step /= 2;
                ++n_halvings;
            }
        }
    }

private:
    struct Quality {
        double step, angle;  // each over what is wanted
    };

    Quality both(Index t) const {
        const Vec2 a = mesh_.corner(t, 0), b = mesh_.corner(t, 1), c = mesh_.corner(t, 2);
        return {step_ratio(a, b, c, size_((a + b + c) / 3)) / wanted_.step_ratio, smallest_sine(a, b, c) / wanted_sine_};
    }

    Quality worst_of_star(Index v) const {
        Quality worst{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        for (const Index t : stars_[v]) {
            const Quality q = both(t);
            worst = {std::min(worst.step, q.step), std::min(worst.angle, q.angle)};
        }
        return worst;
    }

    inline static const std::array<Vec2, 8> directions{Vec2(1, 0),  Vec2(0.7, 0.7),   Vec2(0, 1),  Vec2(-0.7, 0.7),
                                                       Vec2(-1, 0), Vec2(-0.7, -0.7), Vec2(0, -1), Vec2(0.7, -0.7)};
    Mesh& mesh_;
    const SizeField& size_;
    const Wanted& wanted_;
    double wanted_sine_;
    VertexStars stars_;
};

}  // namespace

void relax_worst(Mesh& mesh, const std::vector<char>& fixed, const SizeField& size, const Wanted& wanted) {
    Relaxation relaxation(mesh, size, wanted);
    for (int sweep = 0; sweep < 4; ++sweep) {
        std::vector<std::pair<double, Index>> bad;
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            if (const double quality = relaxation.quality(t); quality < 1) bad.emplace_back(quality, t);
        std::sort(bad.begin(), bad.end());
        for (const auto& [quality, t] : bad)
            for (const Index v : mesh.triangles[t])
                if (!fixed[v]) relaxation.move(v);
    }
}

}  // namespace knap
