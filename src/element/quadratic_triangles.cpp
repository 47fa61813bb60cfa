#include "element/quadratic_triangles.hpp"

#include "element/shape_gradients.hpp"

#include <atomic>
#include <cmath>
#include <limits>

namespace knap {

std::array<Vec2, 7> middle_gradients(const std::array<Vec2, 3>& g, Index k) {
    // d_k = sum_c w_c u_c with w = 2 (1, -2 opposite, -1 at vertex k) + 2.7 (bubble weights 1/9, -4/9, 1)
    std::array<Vec2, 7> weight;
    for (Index i = 0; i < 3; ++i) {
        weight[i] = g[i] + (i == k ? -1.7 : 0.3) * g[k];
        weight[3 + i] = (3 + i == opposite_middle(k) ? -3.2 : 0.8) * g[k];
    }
    weight[6] = 2.7 * g[k];
    return weight;
}

Eigen::Matrix2d bubble_stiffness(const std::array<Vec2, 3>& g, double volume, double lame, double shear) {
    Eigen::Matrix2d R = Eigen::Matrix2d::Zero();
    for (const Vec2& g_k : g) R += (lame + shear) * g_k * g_k.transpose() + shear * g_k.squaredNorm() * Eigen::Matrix2d::Identity();
    return 1.62 * volume * R;
}

QuadraticTriangles::QuadraticTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness) {
    triangles_.resize(mesh.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto g = shape_gradients(mesh, t);
        const Elastic& material = materials[mesh.region[t]];
        const double volume = mesh.area(t) * thickness;
        const Eigen::Matrix2d R = bubble_stiffness(g, volume, material.first_lame(plane), material.shear_modulus());
        triangles_[t] = {.gradient1 = g[1], .gradient2 = g[2], .volume = volume, .R_xx = R(0, 0), .R_yy = R(1, 1), .R_xy = R(0, 1),
                         .material = mesh.region[t]};
    }
    for (const Elastic& material : materials) stiffness_.push_back({material.first_lame(plane), 2 * material.shear_modulus()});
}

void QuadraticTriangles::set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner) {
    fan_of_corner_ = fan_of_corner;
    hold_.resize(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Vec2 &g1 = triangles_[t].gradient1, &g2 = triangles_[t].gradient2;
        for (Index k = 0; k < 6; ++k) {
            const double force = force_of_unit_stress({-(g1 + g2), g1, g2}, triangles_[t].volume, 2, k);
            constexpr float infinite = std::numeric_limits<float>::infinity();
            const double squared = threshold_of_fan[fan_of_corner[7 * t + k]] * force * force;
            hold_[t][k] = std::isinf(squared) ? infinite : std::nextafter(static_cast<float>(squared), -infinite);
        }
    }
}

void QuadraticTriangles::evaluate(Index first, Index last, const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, Vec2* force,
                                  std::vector<std::uint8_t>& fan_is_candidate) const {
    for (std::ptrdiff_t t = first; t < last; ++t, force += 7) {
        const Triangle& here = triangles_[t];
        const Index* node = &node_of_corner[7 * t];
        Vec2 u[7];
        for (int c = 0; c < 7; ++c) u[c] = displacement[node[c]];
        const Vec2 g[3] = {-(here.gradient1 + here.gradient2), here.gradient1, here.gradient2};
        const Vec2 middles = u[3] + u[4] + u[5];
        const Vec2 a = u[6] + (u[0] + u[1] + u[2]) / 9 - 4. / 9 * middles;
        const Vec2 along1 = u[1] - u[0], along2 = u[2] - u[0];  // the linear part: sum_i u_i (x) g_i
        const double L_xx = along1.x() * g[1].x() + along2.x() * g[2].x(), L_xy = along1.x() * g[1].y() + along2.x() * g[2].y();
        const double L_yx = along1.y() * g[1].x() + along2.y() * g[2].x(), L_yy = along1.y() * g[1].y() + along2.y() * g[2].y();
        const Stiffness& elastic = stiffness_[here.material];

        double s_xx = 0, s_yy = 0, s_xy = 0;  // sum of the three stresses
        Vec2 pull[3], sum = Vec2::Zero();     // V/3 sigma_k g_k, what works on d_k
        for (int k = 0; k < 3; ++k) {
            const Vec2 d = 2 * (middles - 2 * u[3 + (k + 1) % 3] - u[k]) + 2.7 * a;
            const double xx = L_xx + d.x() * g[k].x(), yy = L_yy + d.y() * g[k].y();
            const double xy = 0.5 * (L_xy + L_yx + d.x() * g[k].y() + d.y() * g[k].x());
            const double trace = elastic.lame * (xx + yy);
            const double k_xx = trace + elastic.twice_shear * xx, k_yy = trace + elastic.twice_shear * yy, k_xy = elastic.twice_shear * xy;
            s_xx += k_xx, s_yy += k_yy, s_xy += k_xy;
            pull[k] = here.volume / 3 * Vec2(k_xx * g[k].x() + k_xy * g[k].y(), k_xy * g[k].x() + k_yy * g[k].y());
            sum += pull[k];
        }
        const Vec2 q = 2.7 * sum + Vec2(here.R_xx * a.x() + here.R_xy * a.y(), here.R_xy * a.x() + here.R_yy * a.y());  // works on a
        Vec2 all = Vec2::Zero();
        for (int k = 0; k < 3; ++k) {
            const Vec2 linear = here.volume / 3 * Vec2(s_xx * g[k].x() + s_xy * g[k].y(), s_xy * g[k].x() + s_yy * g[k].y());
            force[k] = -linear + 2 * pull[k] - q / 9;
            force[3 + (k + 1) % 3] = -2 * (sum - 2 * pull[k]) + 4. / 9 * q;
            all += force[k] + force[3 + (k + 1) % 3];
        }
        force[6] = -all;
        if (hold_.empty()) continue;
        for (int k = 0; k < 6; ++k)
            if (force[k].squaredNorm() > static_cast<double>(hold_[t][k]))
                std::atomic_ref(fan_is_candidate[fan_of_corner_[7 * t + k]]).store(1, std::memory_order_relaxed);
    }
}

}  // namespace knap
