#include "bulk/linear_triangles.hpp"

#include "bulk/shape_gradients.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace knap {
LinearTriangles::LinearTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness) {
    triangles_.resize(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto gradients = shape_gradients(mesh, t);
        triangles_[t] = {.gradient1 = gradients[1],
                         .gradient2 = gradients[2],
                         .volume = mesh.area(t) * thickness,
                         .threshold = std::numeric_limits<float>::infinity(),
                         .material = mesh.region[t]};
    }
    for (const Elastic& material : materials) stiffness_.push_back({material.first_lame(plane), 2 * material.shear_modulus()});
}

void LinearTriangles::set_screen(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner) {
    threshold_of_fan_ = threshold_of_fan;
    fan_of_corner_ = fan_of_corner;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Index* fan = &fan_of_corner_[3 * t];
        const double smallest = std::min({threshold_of_fan_[fan[0]], threshold_of_fan_[fan[1]], threshold_of_fan_[fan[2]]});
        constexpr float infinite = std::numeric_limits<float>::infinity();
        triangles_[t].threshold = std::isinf(smallest) ? infinite : std::nextafter(static_cast<float>(smallest), -infinite);
    }
}

void LinearTriangles::evaluate(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                             std::vector<Vec2>& corner_force, std::vector<std::uint8_t>& fan_is_hot) const {
    const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(triangles_.size());
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t t = 0; t < n; ++t) {
        const Triangle& here = triangles_[t];
        const Index* node = &node_of_corner[3 * t];
        const Vec2 u0 = displacement[node[0]];
        const Vec2 a = displacement[node[1]] - u0, b = displacement[node[2]] - u0;
        const Vec2 &g1 = here.gradient1, &g2 = here.gradient2;
        const double xx = g1.x() * a.x() + g2.x() * b.x();
        const double yy = g1.y() * a.y() + g2.y() * b.y();
        const double xy = 0.5 * (g1.y() * a.x() + g1.x() * a.y() + g2.y() * b.x() + g2.x() * b.y());
        const Stiffness& elastic = stiffness_[here.material];
        const double trace = elastic.lame * (xx + yy);
        const double s_xx = trace + elastic.twice_shear * xx, s_yy = trace + elastic.twice_shear * yy, s_xy = elastic.twice_shear * xy;
        const double V = here.volume;
        const Vec2 f1(-V * (s_xx * g1.x() + s_xy * g1.y()), -V * (s_xy * g1.x() + s_yy * g1.y()));
        const Vec2 f2(-V * (s_xx * g2.x() + s_xy * g2.y()), -V * (s_xy * g2.x() + s_yy * g2.y()));
        corner_force[3 * t] = -(f1 + f2);
        corner_force[3 * t + 1] = f1;
        corner_force[3 * t + 2] = f2;
        const double norm2 = s_xx * s_xx + s_yy * s_yy + 2 * s_xy * s_xy;
        if (norm2 > static_cast<double>(here.threshold)) {
            for (int k = 0; k < 3; ++k) {
                const Index fan = fan_of_corner_[3 * t + k];
                if (norm2 > threshold_of_fan_[fan]) std::atomic_ref(fan_is_hot[fan]).store(1, std::memory_order_relaxed);
            }
        }
    }
}

}  // namespace knap
