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

/// `lanes` triangles from t on; in(i) is the i-th of them: where fewer are left, the last one fills the lanes.
template <class In>
struct Triangles {
    std::int64_t t;
    int n;  // those that count
    In in;
    const ConstantStrainBody& body;
    const std::int32_t* node_of_corner;

    const ConstantStrainTriangle& operator()(int i) const { return body.triangles[t + in(i)]; }
};

/// mean = s, difference = q_xx = -q_yy, shear = q_xy; of rates: mean = d, difference = e_xx - e_yy, shear = 2 e_xy, so
/// that the power of the stresses is s d + q_xx (e_xx - e_yy) + q_xy 2 e_xy.
template <int lanes>
struct ViscousParts {
    Numbers<lanes> mean, difference, shear;

    Numbers<lanes> dot(const ViscousParts& rate) const {
        return mean * rate.mean + difference * rate.difference + shear * rate.shear;
    }
};
template <int lanes>
struct ViscousStresses {
    ViscousParts<lanes> now, before;
};

/// The stresses at a rate of strain, kept for the next step.
template <int lanes, class In>
[[gnu::always_inline]] inline ViscousStresses<lanes> viscous_stress(const Triangles<In>& of,
                                                                    const ViscousParts<lanes>& rate,
                                                                    const ViscousTriangles& viscous) {
    const auto at = [&](const double* field) __attribute__((always_inline)) {
        return numbers<lanes>([&](int i) { return field[of.t + of.in(i)]; });
    };
    const auto before = [&](int k) __attribute__((always_inline)) {
        return numbers<lanes>([&](int i) { return viscous.before[3 * (of.t + of.in(i)) + k]; });
    };
    const Numbers<lanes> none{}, d = rate.mean, fast = at(viscous.largest_rate), any = d < none ? -d : none,
                                 squeeze = any < fast ? any : fast, shear = at(viscous.shear);
    const ViscousParts<lanes> now{(at(viscous.linear) + at(viscous.quadratic) * squeeze) * d, shear * rate.difference,
                                  shear * rate.shear};
    for (int i = 0; i < of.n; ++i) {
        double* kept = viscous.now + 3 * (of.t + i);
        kept[0] = now.mean[lane_of<lanes>(i)], kept[1] = now.difference[lane_of<lanes>(i)];
        kept[2] = now.shear[lane_of<lanes>(i)];
    }
    return {now, {before(0), before(1), before(2)}};
}

/// A field at corners 1 and 2 less that at corner 0.
template <int lanes>
struct Differences {
    Vectors<lanes> a, b;
};

template <int lanes, class In>
[[gnu::always_inline]] inline Differences<lanes> differences(const Triangles<In>& of, const double* field) {
    const std::int32_t* node = of.node_of_corner + 3 * of.t;
    const auto at = [&](int k) __attribute__((always_inline)) {
        return vectors<lanes>([&](int i) { return field + 2 * static_cast<std::int64_t>(node[3 * of.in(i) + k]); });
    };
    const Vectors<lanes> u0 = at(0), u1 = at(1), u2 = at(2);
    return {{u1.x - u0.x, u1.y - u0.y}, {u2.x - u0.x, u2.y - u0.y}};
}

/// Data of the triangles in the lanes.
template <int lanes>
struct Stage {
    Vectors<lanes> g1, g2;            // gradients of l_1 and l_2
    Numbers<lanes> xx, yx, xy, yy;    // u_x,x, u_y,x and so on, then P; small: strains, then stresses, xy for both
    Numbers<lanes> volume, energies;  // energies: V/2 S:E
};

template <int lanes, StrainMeasure measure, class In>
[[gnu::always_inline]] inline void find_strain(const Triangles<In>& of, const double* displacement,
                                               Stage<lanes>& stage) {
    const auto [a, b] = differences<lanes>(of, displacement);
    const auto g1 = vectors<lanes>([&](int i) { return of(i).gradient1; }),
               g2 = vectors<lanes>([&](int i) { return of(i).gradient2; });
    // one by one: GCC 12 would copy a whole structure in other pieces than it was written, and wait
    stage.g1.x = g1.x, stage.g1.y = g1.y, stage.g2.x = g2.x, stage.g2.y = g2.y;
    stage.volume = numbers<lanes>([&](int i) { return of(i).volume; });
    stage.xx = g1.x * a.x + g2.x * b.x, stage.yy = g1.y * a.y + g2.y * b.y;
    if constexpr (measure == StrainMeasure::small) stage.xy = 0.5 * (g1.y * a.x + g1.x * a.y + g2.y * b.x + g2.x * b.y);
    else stage.yx = g1.x * a.y + g2.x * b.y, stage.xy = g1.y * a.x + g2.y * b.x;
}

/// Stresses (xx, yy, xy) of the strain (xx, yy, 2 xy).
template <int lanes, class In>
[[gnu::always_inline]] inline void add_stress_of_layers(const Triangles<In>& of, const Numbers<lanes>& xx,
                                                        const Numbers<lanes>& yy, const Numbers<lanes>& twice_xy,
                                                        Numbers<lanes>& s_xx, Numbers<lanes>& s_yy,
                                                        Numbers<lanes>& s_xy) {
    const auto of_layers = [&](double LayerStiffness::*part) __attribute__((always_inline)) {
        return numbers<lanes>([&](int i) { return of.body.layers[of(i).kind].*part; });
    };
    using L = LayerStiffness;
    const auto xx_yy = of_layers(&L::xx_yy), xx_xy = of_layers(&L::xx_xy), yy_xy = of_layers(&L::yy_xy);
    s_xx += of_layers(&L::xx_xx) * xx + xx_yy * yy + xx_xy * twice_xy;
    s_yy += xx_yy * xx + of_layers(&L::yy_yy) * yy + yy_xy * twice_xy;
    s_xy += xx_xy * xx + yy_xy * yy + of_layers(&L::xy_xy) * twice_xy;
}

template <int lanes, StrainMeasure measure, bool is_viscous, bool has_layers, class In>
[[gnu::always_inline]] inline void find_stress(const Triangles<In>& of, ViscousTriangles* viscous,
                                               Stage<lanes>& stage) {
    const auto volume = stage.volume;
    const auto elastic = [&](int i) -> const LameConstants& { return of.body.stiffness[of(i).kind]; };
    const auto lambda = numbers<lanes>([&](int i) { return elastic(i).lambda; }),
               twice_shear = numbers<lanes>([&](int i) { return elastic(i).twice_shear; });
    const Vectors<lanes> g1 = stage.g1, g2 = stage.g2;
    Vectors<lanes> c{}, d{};
    if constexpr (is_viscous) {
        const auto rates = differences<lanes>(of, viscous->velocity);
        c = rates.a, d = rates.b;
    }
    if constexpr (measure == StrainMeasure::small) {
        const auto xx = stage.xx, yy = stage.yy, xy = stage.xy;
        auto trace = lambda * (xx + yy);
        Numbers<lanes> q_xx, q_xy;
        if constexpr (is_viscous) {
            const auto e_xx = g1.x * c.x + g2.x * d.x, e_yy = g1.y * c.y + g2.y * d.y;
            const ViscousParts<lanes> rate{e_xx + e_yy, e_xx - e_yy, g1.y * c.x + g2.y * d.x + g1.x * c.y + g2.x * d.y},
                strain{xx + yy, xx - yy, 2.0 * xy};
            const auto [now, before] = viscous_stress<lanes>(of, rate, *viscous);
            const auto work = -0.5 * viscous->last_step * volume * (before.dot(rate) + now.dot(rate)),
                       unmoved = -volume * now.dot(strain);
            for (int i = 0; i < of.n; ++i)
                viscous->work += work[lane_of<lanes>(i)], viscous->unmoved += unmoved[lane_of<lanes>(i)];
            trace += now.mean, q_xx = now.difference, q_xy = now.shear;
        }
        stage.xx = trace + twice_shear * xx, stage.yy = trace + twice_shear * yy, stage.xy = twice_shear * xy;
        if constexpr (has_layers) add_stress_of_layers<lanes>(of, xx, yy, 2.0 * xy, stage.xx, stage.yy, stage.xy);
        if constexpr (is_viscous) stage.xx += q_xx, stage.yy -= q_xx, stage.xy += q_xy;
    } else {
        const auto H_xx = stage.xx, H_yx = stage.yx, H_xy = stage.xy, H_yy = stage.yy;
        const auto xx = H_xx + 0.5 * (H_xx * H_xx + H_yx * H_yx), yy = H_yy + 0.5 * (H_xy * H_xy + H_yy * H_yy),
                   twice_xy = H_xy + H_yx + (H_xx * H_xy + H_yx * H_yy);  // of E
        const auto trace = lambda * (xx + yy);
        auto s_xx = trace + twice_shear * xx, s_yy = trace + twice_shear * yy, s_xy = 0.5 * twice_shear * twice_xy;
        if constexpr (has_layers) add_stress_of_layers<lanes>(of, xx, yy, twice_xy, s_xx, s_yy, s_xy);
        stage.energies = 0.5 * volume * (s_xx * xx + s_yy * yy + s_xy * twice_xy);
        const auto F_xx = H_xx + 1.0, F_yy = H_yy + 1.0;
        auto P_xx = s_xx * F_xx + s_xy * H_xy, P_yx = s_xx * H_yx + s_xy * F_yy, P_xy = s_xy * F_xx + s_yy * H_xy,
             P_yy = s_xy * H_yx + s_yy * F_yy;
        if constexpr (is_viscous) {
            const auto R_xx = g1.x * c.x + g2.x * d.x, R_yx = g1.x * c.y + g2.x * d.y,  // rate of F
                R_xy = g1.y * c.x + g2.y * d.x, R_yy = g1.y * c.y + g2.y * d.y;
            // cof F : R, with F at the end of the last step, in its middle and at its start
            const auto at_end = F_yy * R_xx - H_yx * R_xy - H_xy * R_yx + F_xx * R_yy,
                       half = viscous->last_step * (R_xx * R_yy - R_xy * R_yx);
            // rate of Green's strain, sym(F' R)
            const auto difference = F_xx * R_xx + H_yx * R_yx - H_xy * R_xy - F_yy * R_yy,
                       shear = F_xx * R_xy + H_xy * R_xx + H_yx * R_yy + F_yy * R_yx,
                       half_difference =
                           0.5 * viscous->last_step * (R_xx * R_xx + R_yx * R_yx - R_xy * R_xy - R_yy * R_yy),
                       half_shear = viscous->last_step * (R_xx * R_xy + R_yx * R_yy);
            const ViscousParts<lanes> end{at_end, difference, shear},
                middle{at_end - half, difference - half_difference, shear - half_shear},
                start{at_end - 2.0 * half, difference - 2.0 * half_difference, shear - 2.0 * half_shear};
            const auto [now, before] = viscous_stress<lanes>(of, middle, *viscous);
            const auto s = now.mean, q_xx = now.difference, q_xy = now.shear;
            P_xx += s * F_yy + (q_xx * F_xx + q_xy * H_xy), P_yx += q_xx * H_yx + q_xy * F_yy - s * H_xy;
            P_xy += q_xy * F_xx - q_xx * H_xy - s * H_yx, P_yy += s * F_xx + (q_xy * H_yx - q_xx * F_yy);
            const auto work = -0.5 * viscous->last_step * volume * (before.dot(start) + now.dot(end));
            for (int i = 0; i < of.n; ++i) viscous->work += work[lane_of<lanes>(i)];
        }
        stage.xx = P_xx, stage.yx = P_yx, stage.xy = P_xy, stage.yy = P_yy;
    }
}

/// Adds the energy of the triangles that count.
template <int lanes, StrainMeasure measure, class In>
[[gnu::always_inline]] inline void store_forces(const Triangles<In>& of, const Stage<lanes>& stage, double* force,
                                                double& energy, std::uint8_t* fan_is_candidate) {
    constexpr bool small = measure == StrainMeasure::small;
    const auto volume = stage.volume;
    const Vectors<lanes> g1 = stage.g1, g2 = stage.g2;
    const auto xx = stage.xx, xy = stage.xy, yx = small ? xy : stage.yx, yy = stage.yy;
    const Vectors<lanes> f1{-volume * (g1.x * xx + g1.y * xy), -volume * (g1.x * yx + g1.y * yy)},
        f2{-volume * (g2.x * xx + g2.y * xy), -volume * (g2.x * yx + g2.y * yy)};
    store(Vectors<lanes>{-(f1.x + f2.x), -(f1.y + f2.y)}, [force](int i) { return force + 6 * i; });
    store(f1, [force](int i) { return force + 6 * i + 2; });
    store(f2, [force](int i) { return force + 6 * i + 4; });
    if constexpr (!small)
        for (int i = 0; i < of.n; ++i) energy += stage.energies[lane_of<lanes>(i)];

    const auto norm2 = small ? xx * xx + yy * yy + 2 * xy * xy : (xx * xx + xy * xy) + (yx * yx + yy * yy);
    const auto exceeds = norm2 > numbers<lanes>([&](int i) { return static_cast<double>(of(i).threshold); });
    long long any = 0;
    for (int i = 0; i < lanes; ++i) any |= exceeds[i];
    if (any == 0) return;
    for (int i = 0; i < of.n; ++i) mark_candidates(of.body, of.t + i, norm2[lane_of<lanes>(i)], fan_is_candidate);
}

/// Strains, stresses and forces are three loops over a few registers of triangles. In one loop each triangle is a chain
/// of more instructions than a processor looks ahead, and most of its time is waiting.
template <int lanes, StrainMeasure measure, bool is_viscous, bool has_layers>
double constant_strain_forces(std::int32_t first, std::int32_t last, const ConstantStrainBody& body,
                              const double* displacement, const std::int32_t* node_of_corner, double* force,
                              std::uint8_t* fan_is_candidate, ViscousTriangles* viscous) {
    constexpr int few = 8;
    Stage<lanes> stages[few];
    double energy = 0;
    std::int64_t t = first;
    const auto whole = [&](int k) __attribute__((always_inline)) {
        const auto in = [](int i) { return i; };
        return Triangles<decltype(in)>{t + k * lanes, lanes, in, body, node_of_corner};
    };
    while (t + lanes <= last) {
        const std::int64_t n_left = (last - t) / lanes;
        const int n = n_left < few ? static_cast<int>(n_left) : few;
        for (int k = 0; k < n; ++k) find_strain<lanes, measure>(whole(k), displacement, stages[k]);
        for (int k = 0; k < n; ++k) find_stress<lanes, measure, is_viscous, has_layers>(whole(k), viscous, stages[k]);
        for (int k = 0; k < n; ++k, force += 6 * lanes)
            store_forces<lanes, measure>(whole(k), stages[k], force, energy, fan_is_candidate);
        t += n * lanes;
    }
    if (t == last) return energy;
    double spare[6 * lanes];
    const int n = static_cast<int>(last - t);
    const auto in = [n](int i) { return i < n ? i : n - 1; };
    const Triangles<decltype(in)> rest{t, n, in, body, node_of_corner};
    find_strain<lanes, measure>(rest, displacement, stages[0]);
    find_stress<lanes, measure, is_viscous, has_layers>(rest, viscous, stages[0]);
    store_forces<lanes, measure>(rest, stages[0], spare, energy, fan_is_candidate);
    __builtin_memcpy(force, spare, 6 * n * sizeof(double));
    return energy;
}

template <int lanes, StrainMeasure measure>
ConstantStrainForces kernel_of(bool is_viscous, bool has_layers) {
    if (has_layers)
        return is_viscous ? &constant_strain_forces<lanes, measure, true, true>
                          : &constant_strain_forces<lanes, measure, false, true>;
    return is_viscous ? &constant_strain_forces<lanes, measure, true, false>
                      : &constant_strain_forces<lanes, measure, false, false>;
}

template <int lanes>
ConstantStrainForces kernel_of(const KernelKind& kind) {
    return kind.measure == StrainMeasure::small
               ? kernel_of<lanes, StrainMeasure::small>(kind.is_viscous, kind.has_layers)
               : kernel_of<lanes, StrainMeasure::green>(kind.is_viscous, kind.has_layers);
}

}  // namespace
}  // namespace knap
