#include "element/linear_triangles.hpp"

#include "element/shape_gradients.hpp"

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

void LinearTriangles::set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner) {
    threshold_of_fan_ = threshold_of_fan;
    fan_of_corner_ = fan_of_corner;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Index* fan = &fan_of_corner_[3 * t];
        const double smallest = std::min({threshold_of_fan_[fan[0]], threshold_of_fan_[fan[1]], threshold_of_fan_[fan[2]]});
        constexpr float infinite = std::numeric_limits<float>::infinity();
        triangles_[t].threshold = std::isinf(smallest) ? infinite : std::nextafter(static_cast<float>(smallest), -infinite);
    }
}

void LinearTriangles::evaluate(Index first, Index last, const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, Vec2* force,
                               std::vector<std::uint8_t>& fan_is_candidate) const {
    using Pair = Eigen::Array2d;  // x and y at once
    for (std::ptrdiff_t t = first; t < last; ++t, force += 3) {
        const Triangle& here = triangles_[t];
        const Index* node = &node_of_corner[3 * t];
        const Pair u0 = displacement[node[0]], a = displacement[node[1]].array() - u0, b = displacement[node[2]].array() - u0;
        const Pair g1 = here.gradient1, g2 = here.gradient2, turned1 = g1.reverse(), turned2 = g2.reverse();
        const Pair strain = g1 * a + g2 * b;                      // xx, yy
        const Pair shear1 = turned1 * a, shear2 = turned2 * b;
        const double xy = 0.5 * (shear1[0] + shear1[1] + shear2[0] + shear2[1]);
        const Stiffness& elastic = stiffness_[here.material];
        const Pair s = elastic.lame * (strain[0] + strain[1]) + elastic.twice_shear * strain;
        const double s_xy = elastic.twice_shear * xy;
        const Pair f1 = -here.volume * (s * g1 + s_xy * turned1), f2 = -here.volume * (s * g2 + s_xy * turned2);
        force[0] = -(f1 + f2);
        force[1] = f1;
        force[2] = f2;
        const Pair squares = s * s;
        const double norm2 = squares[0] + squares[1] + 2 * s_xy * s_xy;
        if (norm2 > static_cast<double>(here.threshold)) {
            for (int k = 0; k < 3; ++k) {
                const Index fan = fan_of_corner_[3 * t + k];
                if (norm2 > threshold_of_fan_[fan]) std::atomic_ref(fan_is_candidate[fan]).store(1, std::memory_order_relaxed);
            }
        }
    }
}

}  // namespace knap
