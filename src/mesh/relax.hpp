#pragma once
// Moves single vertices of the worst triangles to lengthen the explicit time step, and leaves the others at their
// random places.
#include "mesh/mesh.hpp"

#include <algorithm>
#include <functional>

namespace knap {

/// How good a triangle is, each over the requested value: 1 and more is good enough; negative or zero for an
/// inverted one.
struct TriangleQuality {
    double step;   // stable step of the free triangle with lumped mass over that of an equilateral one of the requested
                   // edge length
    double angle;  // sine of the smallest angle

    double worse() const { return std::min(step, angle); }
};

/// The worst step and the worst angle among some triangles; quality(t) is a TriangleQuality.
template <class Quality>
TriangleQuality worst_of(std::span<const Index> triangles, const Quality& quality) {
    TriangleQuality worst{infinity, infinity};
    for (const Index t : triangles) {
        const TriangleQuality q = quality(t);
        worst = {std::min(worst.step, q.step), std::min(worst.angle, q.angle)};
    }
    return worst;
}

/// The values requested of every triangle.
class QualityTarget {
public:
    explicit QualityTarget(double min_angle = 22);  // [degree]

    /// The fastest mode is taken as that of a scalar wave: omega^2 = 3 c^2 lambda, lambda the largest eigenvalue of
    /// sum grad N grad N'. `size` [m] is the requested edge length.
    TriangleQuality operator()(const Mesh& mesh, Index triangle, double size) const;

    /// Stable step of a triangle over that of an equilateral one of the requested edge length.
    static constexpr double step_ratio = 0.66;

private:
    double min_sine_;
};

/// Tries to lift step ratio and smallest angle of every triangle above the target. `fixed` has one flag per vertex;
/// `size` [m] is the requested edge length at a place. Reads vertices and triangles only.
void relax_worst(Mesh& mesh, const std::vector<char>& fixed, const std::function<double(const Vec2&)>& size,
                 const QualityTarget& target);
void relax_worst(Mesh& mesh, const std::vector<char>& fixed, double size, const QualityTarget& target);

}  // namespace knap
