#include "material/elastic.hpp"

#include "support/relative.hpp"
#include "support/verification.hpp"

#include <Eigen/LU>

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
    verify_near("c_s [m/s]", glass.shear_speed(PlaneModel::strain), 2332.8, {0.1, 0.05});
    verify_near("c_R [m/s]", glass.rayleigh_speed(PlaneModel::strain), 2125.2, {0.1, 0.05});
}

TEST_CASE("the Rayleigh speed is the root of its polynomial for every Poisson ratio") {
    // x^3 - 8 x^2 + (24 - 16 k) x - 16 (1 - k) = 0, x = (c_R/c_s)^2, k = (c_s/c_d)^2
    for (double nu = 0; nu < 0.5; nu += 0.049)
        for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress}) {
            const Elastic material{.density = 1, .E = 1, .nu = nu};
            const double k = std::pow(material.shear_speed(plane) / material.dilatational_speed(plane), 2);
            const double x = std::pow(material.rayleigh_speed(plane) / material.shear_speed(plane), 2);
            CHECK(x * x * x - 8 * x * x + (24 - 16 * k) * x - 16 * (1 - k) == within(0, 1.6e-11));
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
    CHECK(bar[0] == relative(E * strain, 1e-14));
    CHECK(bar[1] == within(0, 1e-14 * E * strain));
    CHECK(glass.plane_modulus(PlaneModel::stress) == E);
    // plane strain: sigma_z = nu sigma_x holds the thickness, so that strain_y = -nu/(1 - nu) strain_x and E' = E/(1 -
    // nu^2)
    const Eigen::Vector3d held = stress_under(PlaneModel::strain, strain, -nu / (1 - nu) * strain, 0);
    CHECK(held[0] == relative(glass.plane_modulus(PlaneModel::strain) * strain, 1e-14));
    CHECK(held[1] == within(0, 1e-14 * E * strain));
    for (const PlaneModel plane : {PlaneModel::stress, PlaneModel::strain}) {
        CHECK(stress_under(plane, 0, 0, strain)[2] == relative(E / (2 * (1 + nu)) * strain, 1e-14));
        // isotropy: turning strain and stress by 45 degrees
        const Eigen::Vector3d turned = stress_under(plane, 0.5 * strain, 0.5 * strain, strain),
                              straight = stress_under(plane, strain, 0, 0);
        CHECK(turned[0] + turned[1] == relative(straight[0] + straight[1], 1e-14));
        CHECK(2 * turned[2] == relative(straight[0] - straight[1], 1e-14));
        CHECK(glass.dilatational_speed(plane) ==
              relative(std::sqrt(glass.stiffness(plane)(0, 0) / glass.density), 1e-14));
    }
}

TEST_CASE("layers of equal constants are the isotropic material at any angle") {
    for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress})
        for (const double angle : {0.0, 0.7, 2.0}) {
            Elastic layered = glass;
            layered.bedding = Bedding{.E = glass.E, .nu = glass.nu, .G = glass.shear_modulus(), .angle = angle};
            CHECK((layered.stiffness(plane) - glass.stiffness(plane)).norm() <= 1e-14 * glass.stiffness(plane).norm());
            CHECK((layered.stress_of_expansion(plane) - glass.stress_of_expansion(plane)).norm() <=
                  1e-14 * glass.stress_of_expansion(plane).norm());
            const Vec2 n(std::cos(0.3), std::sin(0.3));
            CHECK((layered.wave_matrix(plane, n) - glass.wave_matrix(plane, n)).norm() <= 1e-10);
            CHECK(layered.dilatational_speed(plane) == relative(glass.dilatational_speed(plane), 1e-12));
            CHECK(layered.shear_speed(plane) == relative(glass.shear_speed(plane), 1e-12));
            CHECK(layered.rayleigh_speed(plane) == relative(glass.rayleigh_speed(plane), 1e-12));
            CHECK(layered.plane_modulus(plane) == relative(glass.plane_modulus(plane), 1e-13));
        }
}

TEST_CASE("layers: the compliance in space with its third direction free or held gives the plane laws") {
    const Elastic slate{
        .density = 2700, .E = 90e9, .nu = 0.2, .bedding = Bedding{.E = 60e9, .nu = 0.15, .G = 20e9, .angle = 0.6}};
    const Bedding& across = *slate.bedding;
    Eigen::Matrix4d S = Eigen::Matrix4d::Zero();  // xx, yy, zz, xy in the frame of the layers
    S.topLeftCorner<3, 3>() << 1 / slate.E, -across.nu / across.E, -slate.nu / slate.E, -across.nu / across.E,
        1 / across.E, -across.nu / across.E, -slate.nu / slate.E, -across.nu / across.E, 1 / slate.E;
    S(3, 3) = 1 / across.G;
    const double c = std::cos(across.angle), s = std::sin(across.angle);
    const Eigen::Matrix2d R = (Eigen::Matrix2d() << c, -s, s, c).finished();
    const Eigen::Matrix2d strain = (Eigen::Matrix2d() << 1e-3, 4e-4, 4e-4, -2e-3).finished(),
                          local = R.transpose() * strain * R;
    const auto turned_back = [&](const Eigen::Vector4d& stress) -> Eigen::Vector3d {
        const Eigen::Matrix2d global =
            R * (Eigen::Matrix2d() << stress[0], stress[3], stress[3], stress[1]).finished() * R.transpose();
        return {global(0, 0), global(1, 1), global(0, 1)};
    };
    const Eigen::Vector3d given(strain(0, 0), strain(1, 1), 2 * strain(0, 1));
    // held: zero strain along z
    const Eigen::Vector4d held = S.inverse() * Eigen::Vector4d(local(0, 0), local(1, 1), 0, 2 * local(0, 1));
    const Eigen::Vector3d in_plane = slate.stiffness(PlaneModel::strain) * given;
    CHECK((in_plane - turned_back(held)).norm() <= 1e-13 * held.norm());
    CHECK(slate.stress_along_strike(in_plane) == relative(held[2], 1e-13));
    // the stress that undoes it in the plane: all three strains are those of the expansion
    const Eigen::Vector4d kept = S.inverse() * Eigen::Vector4d(1, 1, 1, 0);
    const Eigen::Matrix2d D_A = slate.stress_of_expansion(PlaneModel::strain) * (1 + slate.nu);
    CHECK((Eigen::Vector3d(D_A(0, 0), D_A(1, 1), D_A(0, 1)) - turned_back(kept)).norm() <= 1e-13 * kept.norm());
    // free: no stress along z
    Eigen::Matrix3d plane;
    plane << S(0, 0), S(0, 1), 0, S(1, 0), S(1, 1), 0, 0, 0, S(3, 3);
    const Eigen::Vector3d free = plane.inverse() * Eigen::Vector3d(local(0, 0), local(1, 1), 2 * local(0, 1));
    CHECK((slate.stiffness(PlaneModel::stress) * given - turned_back({free[0], free[1], 0, free[2]})).norm() <=
          1e-13 * free.norm());
    // waves along and across the layers
    const Eigen::Matrix3d inverse = plane.inverse();
    const Vec2 along(c, s);
    const Eigen::Matrix2d W = slate.wave_matrix(PlaneModel::stress, along);
    CHECK(along.dot(W * along) == relative(std::sqrt(inverse(0, 0) / slate.density), 1e-12));
    CHECK(turned_left(along).dot(W * turned_left(along)) == relative(std::sqrt(across.G / slate.density), 1e-12));
}

}  // namespace elastic_test
