// The kernel of constant-strain triangles gives the same bits with any number of lanes.
#include "element/constant_strain.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include <doctest/doctest.h>

namespace constant_strain_test {

using namespace knap;

namespace {

/// Some triangles of two materials with random gradients, nodes and displacements.
struct Body {
    explicit Body(int n) : force(6 * n, 7.0), is_candidate(n_nodes, 0) {
        Random random(3, "body");
        for (int t = 0; t < n; ++t) {
            triangles.push_back({.gradient1 = {random.uniform(-1, 1), random.uniform(-1, 1)},
                                 .gradient2 = {random.uniform(-1, 1), random.uniform(-1, 1)},
                                 .volume = random.uniform(0.1, 1),
                                 .threshold = 0.05F,
                                 .kind = t % 3 == 1});
            for (int k = 0; k < 3; ++k) node_of_corner.push_back((5 * t + 3 * k) % n_nodes);
        }
        for (int f = 0; f < n_nodes; ++f) thresholds.push_back(f % 2 == 0 ? 0.1 : 100);
        for (int i = 0; i < 2 * n_nodes; ++i) displacement.push_back(random.uniform(-0.3, 0.3));
        for (int i = 0; i < 2 * n_nodes; ++i) velocity.push_back(random.uniform(-2, 2));
        for (int t = 0; t < n; ++t) viscosity.push_back(random.uniform(0, 1));
        for (int i = 0; i < 3 * n; ++i) before.push_back(random.uniform(-1, 1));
        now.resize(3 * n);
    }
    using Result = std::pair<double, std::vector<double>>;
    Result forces(ConstantStrainForces kernel) {
        viscous = {.linear = viscosity.data(),
                   .quadratic = viscosity.data(),
                   .largest_rate = before.data(),
                   .shear = viscosity.data(),
                   .velocity = velocity.data(),
                   .last_step = 0.1,
                   .before = before.data(),
                   .now = now.data(),
                   .work = 0,
                   .unmoved = 0};
        const double energy =
            kernel(0, static_cast<int>(triangles.size()),
                   {.triangles = triangles.data(),
                    .stiffness = stiffness,
                    .layers = layers,
                    .fan_of_corner = node_of_corner.data(),
                    .threshold_of_fan = thresholds.data()},
                   displacement.data(), node_of_corner.data(), force.data(), is_candidate.data(), &viscous);
        return {energy, force};
    }

    static constexpr int n_nodes = 13;
    std::vector<ConstantStrainTriangle> triangles;
    LameConstants stiffness[2] = {{0.7, 1.1}, {2.3, 0.4}};
    LayerStiffness layers[2] = {{-0.3, 0.1, 0.05, 0.2, -0.08, -0.1}, {0.4, 0, 0.1, 0.3, 0.2, 0.15}};
    ViscousTriangles viscous{};
    std::vector<double> thresholds, displacement, force, velocity, viscosity, before, now;
    std::vector<std::int32_t> node_of_corner;
    std::vector<std::uint8_t> is_candidate;
};

#ifdef __x86_64__
template <StrainMeasure measure, bool is_viscous = false, bool has_layers = false>
void check_lanes() {
    for (int n = 1; n <= 13; ++n) {
        Body one(n), four(n);
        const auto [energy, force] = one.forces(baseline_kernel({measure, is_viscous, has_layers}));
        const auto [energy4, force4] = four.forces(avx2_kernel({measure, is_viscous, has_layers}));
        CHECK(std::memcmp(&energy, &energy4, sizeof energy) == 0);
        CHECK((energy > 0) == (measure == StrainMeasure::green));
        CHECK(std::memcmp(force.data(), force4.data(), force.size() * sizeof(double)) == 0);
        CHECK(one.now == four.now);
        CHECK(one.viscous.work == four.viscous.work);
        CHECK(one.viscous.unmoved == four.viscous.unmoved);
        CHECK((one.viscous.work != 0) == is_viscous);
        CHECK(one.is_candidate == four.is_candidate);
        if (n == 13) {
            CHECK(std::ranges::count(one.is_candidate, 0) > 0);
            CHECK(std::ranges::count(one.is_candidate, 1) > 0);
        }
    }
}

#endif

}  // namespace

#ifdef __x86_64__
TEST_CASE("two lanes and four give the same bits") {
    if (!__builtin_cpu_supports("avx2")) return;
    check_lanes<StrainMeasure::small>();
    check_lanes<StrainMeasure::small, true>();
    check_lanes<StrainMeasure::green, true>();
    check_lanes<StrainMeasure::green>();
    check_lanes<StrainMeasure::small, false, true>();
    check_lanes<StrainMeasure::green, true, true>();
}
#endif

}  // namespace constant_strain_test
