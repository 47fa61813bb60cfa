#include "material/elastic.hpp"

#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace elastic_test {

using namespace knap;
using namespace knap::tests;

namespace {
const Elastic glass{.density = 2450, .E = 32e9, .nu = 0.2};
}

TEST_CASE("C10 wave speeds of glass in plane strain") {
    describe("E = 32 GPa, nu = .2, rho = 2450 kg/m3, plane strain; references to a tenth of a metre a second.");
    verify_near("c_d [m/s]", glass.dilatational_speed(PlaneModel::strain), 3809.5, {0.1, 0.05});
    verify_near("c_s [m/s]", glass.shear_speed(), 2332.8, {0.1, 0.05});
    verify_near("c_R [m/s]", glass.rayleigh_speed(PlaneModel::strain), 2125.2, {0.1, 0.05});
}

TEST_CASE("the Rayleigh speed is the root of its polynomial for every Poisson ratio") {
    // x^3 - 8 x^2 + (24 - 16 k) x - 16 (1 - k) = 0, x = (c_R/c_s)^2, k = (c_s/c_d)^2
    for (double nu = 0; nu < 0.5; nu += 0.049)
        for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress}) {
            const Elastic material{.density = 1, .E = 1, .nu = nu};
            const double k = std::pow(material.shear_speed() / material.dilatational_speed(plane), 2);
            const double x = std::pow(material.rayleigh_speed(plane) / material.shear_speed(), 2);
            CHECK(x * x * x - 8 * x * x + (24 - 16 * k) * x - 16 * (1 - k) ==
                  doctest::Approx(0).scale(16).epsilon(1e-12));
            CHECK((x > 0.7 && x < 1));
        }
}

TEST_CASE("plane stress and plane strain are Hooke's law with the third direction free or held") {
    const double E = glass.E, nu = glass.nu, strain = 1e-3;
    const auto stress_under = [](PlaneModel plane, double xx, double yy, double twice_xy) -> Eigen::Vector3d {
        return glass.stiffness(plane) * Eigen::Vector3d(xx, yy, twice_xy);
    };
    // plane stress: pulled along x and free along y
    const Eigen::Vector3d bar = stress_under(PlaneModel::stress, strain, -nu * strain, 0);
    CHECK(bar[0] == doctest::Approx(E * strain).epsilon(1e-14));
    CHECK(bar[1] == doctest::Approx(0).scale(E * strain).epsilon(1e-14));
    CHECK(glass.plane_modulus(PlaneModel::stress) == E);
    // plane strain: sigma_z = nu sigma_x holds the thickness, so that strain_y = -nu/(1 - nu) strain_x and E' = E/(1 -
    // nu^2)
    const Eigen::Vector3d held = stress_under(PlaneModel::strain, strain, -nu / (1 - nu) * strain, 0);
    CHECK(held[0] == doctest::Approx(glass.plane_modulus(PlaneModel::strain) * strain).epsilon(1e-14));
    CHECK(held[1] == doctest::Approx(0).scale(E * strain).epsilon(1e-14));
    for (const PlaneModel plane : {PlaneModel::stress, PlaneModel::strain}) {
        CHECK(stress_under(plane, 0, 0, strain)[2] == doctest::Approx(E / (2 * (1 + nu)) * strain).epsilon(1e-14));
        // isotropy: turning strain and stress by 45 degrees
        const Eigen::Vector3d turned = stress_under(plane, 0.5 * strain, 0.5 * strain, strain),
                              straight = stress_under(plane, strain, 0, 0);
        CHECK(turned[0] + turned[1] == doctest::Approx(straight[0] + straight[1]).epsilon(1e-14));
        CHECK(2 * turned[2] == doctest::Approx(straight[0] - straight[1]).epsilon(1e-14));
        CHECK(glass.dilatational_speed(plane) ==
              doctest::Approx(std::sqrt(glass.stiffness(plane)(0, 0) / glass.density)).epsilon(1e-14));
    }
}

}  // namespace elastic_test
