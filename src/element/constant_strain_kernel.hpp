#pragma once
// See constant_strain.hpp. Included by one file per instruction set, of which nobody else can name the kernels.
#include "element/constant_strain.hpp"

namespace knap {
namespace {

template <int lanes>
struct Register;
template <>
struct Register<2> {
    using type = double __attribute__((vector_size(16)));
};
template <>
struct Register<4> {
    using type = double __attribute__((vector_size(32)));
};
/// A number of each triangle, in the order of lane_of: that costs the fewest moves between the registers.
template <int lanes>
using Numbers = typename Register<lanes>::type;

/// A vector of each triangle.
template <int lanes>
struct Vectors {
    Numbers<lanes> x, y;
};

template <int lanes>
constexpr int lane_of(int triangle) {
    return lanes == 4 && (triangle == 1 || triangle == 2) ? 3 - triangle : triangle;
}

using OneVector = Numbers<2>;

inline OneVector load(const double* vector) {
    OneVector xy;
    __builtin_memcpy(&xy, vector, sizeof xy);
    return xy;
}
inline void store(const OneVector& xy, double* vector) { __builtin_memcpy(vector, &xy, sizeof xy); }

template <int lanes, class At>
[[gnu::always_inline]] inline Vectors<lanes> vectors(const At& at) {
    if constexpr (lanes == 2) {
        const OneVector a = load(at(0)), b = load(at(1));
        return {__builtin_shufflevector(a, b, 0, 2), __builtin_shufflevector(a, b, 1, 3)};
    } else {
        const Numbers<4> a = __builtin_shufflevector(load(at(0)), load(at(1)), 0, 1, 2, 3),
                         b = __builtin_shufflevector(load(at(2)), load(at(3)), 0, 1, 2, 3);
        return {__builtin_shufflevector(a, b, 0, 4, 2, 6), __builtin_shufflevector(a, b, 1, 5, 3, 7)};
    }
}

template <int lanes, class Of>
[[gnu::always_inline]] inline Numbers<lanes> numbers(const Of& of) {
    if constexpr (lanes == 2) return Numbers<2>{of(0), of(1)};
    else return Numbers<4>{of(0), of(2), of(1), of(3)};
}

template <int lanes, class To>
[[gnu::always_inline]] inline void store(const Vectors<lanes>& v, const To& to) {
    if constexpr (lanes == 2) {
        store(__builtin_shufflevector(v.x, v.y, 0, 2), to(0));
        store(__builtin_shufflevector(v.x, v.y, 1, 3), to(1));
    } else {
        const Numbers<4> a = __builtin_shufflevector(v.x, v.y, 0, 4, 2, 6),
                         b = __builtin_shufflevector(v.x, v.y, 1, 5, 3, 7);
        store(__builtin_shufflevector(a, a, 0, 1), to(0)), store(__builtin_shufflevector(a, a, 2, 3), to(1));
        store(__builtin_shufflevector(b, b, 0, 1), to(2)), store(__builtin_shufflevector(b, b, 2, 3), to(3));
    }
}

/// Several threads may do so at once.
inline void mark_candidates(const ConstantStrainBody& body, std::int64_t triangle, double norm2,
                            std::uint8_t* fan_is_candidate) {
    for (int k = 0; k < 3; ++k) {
        const std::int32_t fan = body.fan_of_corner[3 * triangle + k];
        if (norm2 > body.threshold_of_fan[fan]) __atomic_store_n(&fan_is_candidate[fan], 1, __ATOMIC_RELAXED);
    }
}

template <int lanes>
struct ViscousStresses {
    Numbers<lanes> now, before;
};

/// s at the rate of area d, kept for the next step.
template <int lanes, class In>
[[gnu::always_inline]] inline ViscousStresses<lanes> viscous_stress(std::int64_t t, int n, const In& in,
                                                                    const Numbers<lanes>& d,
                                                                    const ViscousTriangles& viscous) {
    const auto of = [&](const double* field) __attribute__((always_inline)) {
        return numbers<lanes>([&](int i) { return field[t + in(i)]; });
    };
    const Numbers<lanes> none{}, fast = of(viscous.largest_rate), any = d < none ? -d : none,
                                 squeeze = any < fast ? any : fast;
    const Numbers<lanes> s = (of(viscous.linear) + of(viscous.quadratic) * squeeze) * d, before = of(viscous.before);
    for (int i = 0; i < n; ++i) viscous.now[t + i] = s[lane_of<lanes>(i)];
    return {s, before};
}

/// As ConstantStrainForces, of `lanes` triangles from t on; in(i) is the i-th of them: where fewer are left, the last
/// one fills the lanes. Adds the energy of the first n.
template <int lanes, StrainMeasure measure, bool is_viscous, class In>
[[gnu::always_inline]] inline void add_forces(std::int64_t t, int n, const In& in, const ConstantStrainBody& body,
                                              const double* displacement, const std::int32_t* node_of_corner,
                                              double* force, double& energy, std::uint8_t* fan_is_candidate,
                                              ViscousTriangles* viscous) {
    const ConstantStrainTriangle* triangle = body.triangles + t;
    const std::int32_t* node = node_of_corner + 3 * t;
    const auto of_node = [&](const double* field, int k) __attribute__((always_inline)) {
        return vectors<lanes>([&](int i) { return field + 2 * static_cast<std::int64_t>(node[3 * in(i) + k]); });
    };
    const Vectors<lanes> u0 = of_node(displacement, 0), u1 = of_node(displacement, 1), u2 = of_node(displacement, 2),
                         a{u1.x - u0.x, u1.y - u0.y}, b{u2.x - u0.x, u2.y - u0.y};
    const auto g1 = vectors<lanes>([&](int i) { return triangle[in(i)].gradient1; }),
               g2 = vectors<lanes>([&](int i) { return triangle[in(i)].gradient2; });
    const auto volume = numbers<lanes>([&](int i) { return triangle[in(i)].volume; });
    const auto elastic = [&](int i) -> const LameConstants& { return body.stiffness[triangle[in(i)].material]; };
    const auto lambda = numbers<lanes>([&](int i) { return elastic(i).lambda; }),
               twice_shear = numbers<lanes>([&](int i) { return elastic(i).twice_shear; });
    Vectors<lanes> f1, f2;
    Numbers<lanes> norm2;
    Vectors<lanes> c{}, d{};  // rates of a and b
    if constexpr (is_viscous) {
        const Vectors<lanes> v0 = of_node(viscous->velocity, 0), v1 = of_node(viscous->velocity, 1),
                             v2 = of_node(viscous->velocity, 2);
        c = {v1.x - v0.x, v1.y - v0.y}, d = {v2.x - v0.x, v2.y - v0.y};
    }
    if constexpr (measure == StrainMeasure::small) {
        const auto xx = g1.x * a.x + g2.x * b.x, yy = g1.y * a.y + g2.y * b.y,
                   xy = 0.5 * (g1.y * a.x + g1.x * a.y + g2.y * b.x + g2.x * b.y);
        auto trace = lambda * (xx + yy);
        if constexpr (is_viscous) {
            const auto rate = g1.x * c.x + g2.x * d.x + g1.y * c.y + g2.y * d.y;
            const auto [s, before] = viscous_stress<lanes>(t, n, in, rate, *viscous);
            trace += s;
            const auto work = -0.5 * viscous->last_step * volume * (before + s) * rate,
                       unmoved = -volume * s * (xx + yy);
            for (int i = 0; i < n; ++i)
                viscous->work += work[lane_of<lanes>(i)], viscous->unmoved += unmoved[lane_of<lanes>(i)];
        }
        const auto s_xx = trace + twice_shear * xx, s_yy = trace + twice_shear * yy, s_xy = twice_shear * xy;
        f1 = {-volume * (s_xx * g1.x + s_xy * g1.y), -volume * (s_yy * g1.y + s_xy * g1.x)};
        f2 = {-volume * (s_xx * g2.x + s_xy * g2.y), -volume * (s_yy * g2.y + s_xy * g2.x)};
        norm2 = s_xx * s_xx + s_yy * s_yy + 2 * s_xy * s_xy;
    } else {
        const auto H_xx = g1.x * a.x + g2.x * b.x, H_yx = g1.x * a.y + g2.x * b.y,  // u_x,x and u_y,x
            H_xy = g1.y * a.x + g2.y * b.x, H_yy = g1.y * a.y + g2.y * b.y;
        const auto xx = H_xx + 0.5 * (H_xx * H_xx + H_yx * H_yx), yy = H_yy + 0.5 * (H_xy * H_xy + H_yy * H_yy),
                   twice_xy = H_xy + H_yx + (H_xx * H_xy + H_yx * H_yy);  // of E
        const auto trace = lambda * (xx + yy), s_xx = trace + twice_shear * xx, s_yy = trace + twice_shear * yy,
                   s_xy = 0.5 * twice_shear * twice_xy;
        const auto energies = 0.5 * volume * (s_xx * xx + s_yy * yy + s_xy * twice_xy);  // V/2 S:E
        for (int i = 0; i < n; ++i) energy += energies[lane_of<lanes>(i)];
        const auto F_xx = H_xx + 1.0, F_yy = H_yy + 1.0;
        auto P_xx = s_xx * F_xx + s_xy * H_xy, P_yx = s_xx * H_yx + s_xy * F_yy, P_xy = s_xy * F_xx + s_yy * H_xy,
             P_yy = s_xy * H_yx + s_yy * F_yy;
        if constexpr (is_viscous) {
            const auto R_xx = g1.x * c.x + g2.x * d.x, R_yx = g1.x * c.y + g2.x * d.y,  // rate of F
                R_xy = g1.y * c.x + g2.y * d.x, R_yy = g1.y * c.y + g2.y * d.y;
            // cof F : R, with F at the end of the last step, in its middle and at its start
            const auto at_end = F_yy * R_xx - H_yx * R_xy - H_xy * R_yx + F_xx * R_yy,
                       half = viscous->last_step * (R_xx * R_yy - R_xy * R_yx);
            const auto [s, before] = viscous_stress<lanes>(t, n, in, at_end - half, *viscous);
            P_xx += s * F_yy, P_yx -= s * H_xy, P_xy -= s * H_yx, P_yy += s * F_xx;
            const auto work = -0.5 * viscous->last_step * volume * (before * (at_end - 2.0 * half) + s * at_end);
            for (int i = 0; i < n; ++i) viscous->work += work[lane_of<lanes>(i)];
        }
        f1 = {-volume * (g1.x * P_xx + g1.y * P_xy), -volume * (g1.x * P_yx + g1.y * P_yy)};
        f2 = {-volume * (g2.x * P_xx + g2.y * P_xy), -volume * (g2.x * P_yx + g2.y * P_yy)};
        norm2 = (P_xx * P_xx + P_xy * P_xy) + (P_yx * P_yx + P_yy * P_yy);
    }
    store(Vectors<lanes>{-(f1.x + f2.x), -(f1.y + f2.y)}, [force](int i) { return force + 6 * i; });
    store(f1, [force](int i) { return force + 6 * i + 2; });
    store(f2, [force](int i) { return force + 6 * i + 4; });

    const auto exceeds = norm2 > numbers<lanes>([&](int i) { return static_cast<double>(triangle[in(i)].threshold); });
    long long any = 0;
    for (int i = 0; i < lanes; ++i) any |= exceeds[i];
    if (any == 0) return;
    for (int i = 0; i < n; ++i) mark_candidates(body, t + i, norm2[lane_of<lanes>(i)], fan_is_candidate);
}

template <int lanes, StrainMeasure measure, bool is_viscous>
double constant_strain_forces(std::int32_t first, std::int32_t last, const ConstantStrainBody& body,
                              const double* displacement, const std::int32_t* node_of_corner, double* force,
                              std::uint8_t* fan_is_candidate, ViscousTriangles* viscous) {
    double energy = 0;
    std::int64_t t = first;
    for (; t + lanes <= last; t += lanes, force += 6 * lanes)
        add_forces<lanes, measure, is_viscous>(
            t, lanes, [](int i) { return i; }, body, displacement, node_of_corner, force, energy, fan_is_candidate,
            viscous);
    if (t == last) return energy;
    double spare[6 * lanes];
    const int n = static_cast<int>(last - t);
    add_forces<lanes, measure, is_viscous>(
        t, n, [n](int i) { return i < n ? i : n - 1; }, body, displacement, node_of_corner, spare, energy,
        fan_is_candidate, viscous);
    __builtin_memcpy(force, spare, 6 * n * sizeof(double));
    return energy;
}

template <int lanes, StrainMeasure measure>
ConstantStrainForces kernel_of(bool is_viscous) {
    return is_viscous ? &constant_strain_forces<lanes, measure, true> : &constant_strain_forces<lanes, measure, false>;
}

template <int lanes>
ConstantStrainForces kernel_of(StrainMeasure measure, bool is_viscous) {
    return measure == StrainMeasure::small ? kernel_of<lanes, StrainMeasure::small>(is_viscous)
                                           : kernel_of<lanes, StrainMeasure::green>(is_viscous);
}

}  // namespace
}  // namespace knap
