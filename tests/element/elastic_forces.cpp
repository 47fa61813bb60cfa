#include "element/elastic_forces.hpp"
#include "base/random.hpp"
#include "element/shape_functions.hpp"
#include "element/triangle_matrices.hpp"
#include "support/meshes.hpp"
#include "support/relative.hpp"
#include "support/verification.hpp"

#include <Eigen/LU>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace elastic_forces_test {

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic rock{.density = 2000, .E = 5, .nu = 0.3};
const Elastic layered{
    .density = 2000, .E = 5, .nu = 0.3, .bedding = Bedding{.E = 2, .nu = 0.15, .G = 0.8, .angle = 0.4}};
constexpr double thickness = 0.7;

/// Free triangles: corner c is node c, and no fan is ever candidate.
class FreeTriangles {
public:
    explicit FreeTriangles(const Mesh& mesh, PlaneModel plane, bool large_rotation = false,
                           const Elastic& material = rock)
        : mesh_(mesh),
          forces_(mesh, {material}, plane, thickness, large_rotation),
          node_(mesh.n_corners()),
          candidate_(1, 0) {
        for (Index c = 0; c < mesh.n_corners(); ++c) node_[c] = c;
    }

    std::vector<Vec2> force(const std::vector<Vec2>& u) {
        std::vector<Vec2> f(mesh_.n_corners());
        forces_.evaluate(u, node_, f, candidate_);
        return f;
    }
    /// [J] With large rotations.
    double energy(const std::vector<Vec2>& u) {
        std::vector<Vec2> f(mesh_.n_corners());
        return forces_.evaluate(0, mesh_.n_triangles(), u, node_, f.data(), candidate_);
    }

private:
    const Mesh& mesh_;
    ElasticForces forces_;
    std::vector<Index> node_;
    std::vector<std::uint8_t> candidate_;
};

Mesh skew_mesh() {
    Mesh mesh = bar_mesh(3, 2, 2, 1);
    Random random(1, "mesh");
    for (Vec2& x : mesh.vertices) x += 0.1 * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    return mesh;
}

template <class Field>
std::vector<Vec2> displacement(const Mesh& mesh, const Field& field) {
    std::vector<Vec2> u;
    for (Index c = 0; c < mesh.n_corners(); ++c) u.push_back(field(mesh.corner(c / 3, c % 3)));
    return u;
}

}  // namespace

TEST_CASE("rigid motions cost no force and every triangle is in equilibrium") {
    const Mesh mesh = skew_mesh();
    FreeTriangles body(mesh, PlaneModel::strain);
    for (const Vec2& f :
         body.force(displacement(mesh, [](const Vec2& x) -> Vec2 { return Vec2(0.3, -2) + 1e-2 * turned_left(x); })))
        CHECK(f.norm() <= 1e-14);
    Random random(2, "u");
    std::vector<Vec2> u(mesh.n_corners());
    for (Vec2& v : u) v = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    const std::vector<Vec2> f = body.force(u);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        Vec2 sum = Vec2::Zero();
        double moment = 0;
        for (Index k = 0; k < 3; ++k) sum += f[3 * t + k], moment += cross(mesh.corner(t, k), f[3 * t + k]);
        CHECK(sum.norm() <= 1e-13);
        CHECK(std::abs(moment) <= 1e-13);
    }
}

TEST_CASE("a uniform strain gives the tractions of its stress") {
    const Mesh mesh = skew_mesh();
    for (const auto& [plane, material] :
         {std::pair{PlaneModel::strain, rock}, {PlaneModel::stress, rock}, {PlaneModel::strain, layered}}) {
        const Eigen::Matrix2d gradient = (Eigen::Matrix2d() << 1e-3, 4e-4, -7e-4, 2e-3).finished();
        const Eigen::Vector3d s = material.stiffness(plane) *
                                  Eigen::Vector3d(gradient(0, 0), gradient(1, 1), gradient(0, 1) + gradient(1, 0));
        const Eigen::Matrix2d stress = (Eigen::Matrix2d() << s[0], s[2], s[2], s[1]).finished();
        const std::vector<Vec2> f =
            FreeTriangles(mesh, plane, false, material).force(displacement(mesh, [&](const Vec2& x) -> Vec2 {
                return gradient * x;
            }));
        for (Index c = 0; c < mesh.n_corners(); ++c) {
            // the corner pulls its triangle back: minus the tractions on the halves of its two edges = those on half
            // the opposite edge
            const Index t = c / 3, k = c % 3;
            const Vec2 opposite = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3);
            const Vec2 traction = stress * (-turned_left(opposite)) * 0.5 * thickness;
            CHECK((f[c] - traction).norm() <= 1e-15);
        }
    }
}

TEST_CASE("the forces are minus the derivative of the strain energy") {
    const Mesh mesh = skew_mesh();
    FreeTriangles body(mesh, PlaneModel::strain);
    Random random(3, "u");
    std::vector<Vec2> u(mesh.n_corners());
    for (Vec2& v : u) v = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    const auto energy = [&](const std::vector<Vec2>& at) {  // by strains from edge vectors, not by shape functions
        double sum = 0;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            Eigen::Matrix2d X, U;
            X << mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0);
            U << at[3 * t + 1] - at[3 * t], at[3 * t + 2] - at[3 * t];
            const Eigen::Matrix2d gradient = U * X.inverse();
            const Eigen::Vector3d strain(gradient(0, 0), gradient(1, 1), gradient(0, 1) + gradient(1, 0));
            sum += 0.5 * mesh.area(t) * thickness * strain.dot(rock.stiffness(PlaneModel::strain) * strain);
        }
        return sum;
    };
    const std::vector<Vec2> f = body.force(u);
    for (Index c = 0; c < mesh.n_corners(); ++c)
        for (int k = 0; k < 2; ++k) {
            std::vector<Vec2> up = u, down = u;
            up[c][k] += 1e-4, down[c][k] -= 1e-4;
            CHECK(f[c][k] == within(-(energy(up) - energy(down)) / 2e-4, 1e-8));
        }
}

TEST_CASE("the stable step is that of the free triangle") {
    const Mesh mesh = skew_mesh();
    for (const Elastic& material : {rock, layered}) {
        FreeTriangles body(mesh, PlaneModel::strain, false, material);
        const std::vector<double> steps = stable_steps(mesh, {material}, PlaneModel::strain);
        std::vector<Vec2> u(mesh.n_corners());
        Random random(4, "u");
        for (Vec2& v : u) v = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        std::vector<double> rate(mesh.n_triangles());
        for (int i = 0; i < 3000; ++i) {  // power iteration on M^-1 K, triangle by triangle
            const std::vector<Vec2> f = body.force(u);
            for (Index t = 0; t < mesh.n_triangles(); ++t) {
                double before = 0, after = 0;
                const double mass = material.density * mesh.area(t) * thickness / 3;
                for (Index k = 0; k < 3; ++k)
                    before += u[3 * t + k].squaredNorm(), after += f[3 * t + k].squaredNorm() / (mass * mass);
                rate[t] = std::sqrt(after / before);
                for (Index k = 0; k < 3; ++k) u[3 * t + k] = f[3 * t + k] / (mass * std::sqrt(after));
            }
        }
        for (Index t = 0; t < mesh.n_triangles(); ++t) CHECK(steps[t] == relative(2 / std::sqrt(rate[t]), 1e-6));
    }
}

TEST_CASE("E39 layers: a plane wave on a regular mesh has the speed and the direction of Christoffel's equation") {
    describe("The force of a plane wave of 100 edges on a node of a layered body against Christoffel's matrix.");
    // -f/m = density c^2 k^2 u/density at a node far from the boundary, for u = a exp(i k n . x)
    constexpr Index n = 6;
    const Mesh mesh = bar_mesh(n, n, n, n);  // edges of 1
    const Vec2 middle(n / 2, n / 2);
    constexpr double k = 2 * std::numbers::pi / 100;
    for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress}) {
        FreeTriangles body(mesh, plane, false, layered);
        for (const double angle : {0.0, 0.4, 1.0, 0.4 + std::numbers::pi / 2, 2.5}) {
            const Vec2 along(std::cos(angle), std::sin(angle));
            Eigen::Matrix2d found;  // of the cosine at the middle
            for (int component = 0; component < 2; ++component) {
                const std::vector<Vec2> f = body.force(displacement(mesh, [&](const Vec2& x) -> Vec2 {
                    return std::cos(k * along.dot(x - middle)) * Vec2::Unit(component);
                }));
                Vec2 sum = Vec2::Zero();
                for (Index c = 0; c < mesh.n_corners(); ++c)
                    if ((mesh.corner(c) - middle).norm() < 1e-9) sum += f[c];
                found.col(component) = -sum / (layered.density * thickness * k * k);  // a node has the area 1
            }
            const Eigen::Matrix2d speeds = layered.wave_matrix(plane, along);
            verify_small("error of the matrix, wave at " + digits(angle) + " rad" +
                             (plane == PlaneModel::strain ? ", plane strain" : ", plane stress"),
                         (found - speeds * speeds).norm() / found.norm(), {2e-3});
        }
    }
}

TEST_CASE("the stress criterion marks the fans of triangles with much stress and no others") {
    const Mesh mesh = bar_mesh(4, 1, 4, 1);
    ElasticForces forces(mesh, {rock}, PlaneModel::strain, thickness);
    std::vector<Index> fan_of_corner, node;
    for (Index c = 0; c < mesh.n_corners(); ++c)
        fan_of_corner.push_back(mesh.triangles[c / 3][c % 3]), node.push_back(c);
    forces.set_stress_criterion(std::vector<double>(mesh.n_vertices(), 1.0), fan_of_corner);
    // |sigma|_F = 1.01 and .99 in two triangles, none in the others
    std::vector<Vec2> u(mesh.n_corners(), Vec2::Zero());
    const double strain = 1 / (std::sqrt(2.0) * rock.E / (1 + rock.nu) * 0.5);  // of pure shear with |sigma|_F = 1
    for (const auto& [t, level] : {std::pair<Index, double>{2, 1.01}, {7, 0.99}})
        for (Index k = 0; k < 3; ++k) u[3 * t + k].x() = level * strain * mesh.corner(t, k).y();
    std::vector<std::uint8_t> candidate(mesh.n_vertices(), 0);
    std::vector<Vec2> f(mesh.n_corners());
    forces.evaluate(u, node, f, candidate);
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
        const auto& corners = mesh.triangles[2];
        CHECK(static_cast<bool>(candidate[v]) == (std::find(corners.begin(), corners.end(), v) != corners.end()));
    }
}

// ---- large rotations

namespace {

std::vector<Vec2> random_displacements(const Mesh& mesh, double size) {
    Random random(5, "u");
    std::vector<Vec2> u(mesh.n_corners());
    for (Vec2& v : u) v = size * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    return u;
}

}  // namespace

TEST_CASE("large rotations: a body that only turns has no stress") {
    const Mesh mesh = skew_mesh();
    FreeTriangles body(mesh, PlaneModel::strain, true);
    for (const double angle : {1e-8, 0.3, 1.6, 3.1, -2.0}) {
        const std::vector<Vec2> u =
            displacement(mesh, [&](const Vec2& x) -> Vec2 { return turned(x, angle) - x + Vec2(3, -1); });
        for (const Vec2& f : body.force(u)) CHECK(f.norm() <= 1e-14 * rock.E * thickness);  // edges of about 1 m
        CHECK(body.energy(u) <= 1e-28 * rock.E);
    }
}

TEST_CASE("large rotations: a strained body that turns has the turned forces and the same energy") {
    const Mesh mesh = skew_mesh();
    for (const auto& [plane, material] :
         {std::pair{PlaneModel::strain, rock}, {PlaneModel::stress, rock}, {PlaneModel::strain, layered}}) {
        FreeTriangles body(mesh, plane, true, material);
        const std::vector<Vec2> u = random_displacements(mesh, 0.03), f = body.force(u);
        double largest = 0;
        for (const Vec2& of_corner : f) largest = std::max(largest, of_corner.norm());
        for (const double angle : {0.5, 2.0, -3.0}) {
            std::vector<Vec2> moved(u.size());
            for (Index c = 0; c < mesh.n_corners(); ++c)
                moved[c] = turned(mesh.corner(c) + u[c], angle) - mesh.corner(c) + Vec2(1, 2);
            const std::vector<Vec2> found = body.force(moved);
            for (Index c = 0; c < mesh.n_corners(); ++c)
                CHECK((found[c] - turned(f[c], angle)).norm() <= 1e-13 * largest);
            CHECK(body.energy(moved) == relative(body.energy(u), 1e-13));
        }
        for (Index t = 0; t < mesh.n_triangles(); ++t) {  // equilibrium about the present places
            Vec2 sum = Vec2::Zero();
            double moment = 0;
            for (Index k = 0; k < 3; ++k)
                sum += f[3 * t + k], moment += cross(mesh.corner(t, k) + u[3 * t + k], f[3 * t + k]);
            CHECK(sum.norm() <= 1e-14 * largest);
            CHECK(std::abs(moment) <= 1e-14 * largest);
        }
    }
}

TEST_CASE("large rotations: the forces are minus the derivative of the energy and small strains are linear") {
    const Mesh mesh = skew_mesh();
    for (const Elastic& material : {rock, layered}) {
        FreeTriangles body(mesh, PlaneModel::strain, true, material), linear(mesh, PlaneModel::strain, false, material);
        const std::vector<Vec2> u = random_displacements(mesh, 0.1), f = body.force(u);
        for (Index c = 0; c < mesh.n_corners(); ++c)
            for (int k = 0; k < 2; ++k) {
                std::vector<Vec2> up = u, down = u;
                up[c][k] += 1e-4, down[c][k] -= 1e-4;
                CHECK(f[c][k] == within(-(body.energy(up) - body.energy(down)) / 2e-4, 1e-6));
            }
        for (const double size : {1e-3, 1e-6, 1e-9}) {
            const std::vector<Vec2> small = random_displacements(mesh, size), found = body.force(small),
                                    expected = linear.force(small);
            for (Index c = 0; c < mesh.n_corners(); ++c)
                CHECK((found[c] - expected[c]).norm() <= 100 * size * size * rock.E * thickness);
        }
    }
}

TEST_CASE("large rotations: the stress criterion bounds the forces at any strain") {
    const Mesh mesh = bar_mesh(3, 3, 3, 3);
    ElasticForces forces(mesh, {rock}, PlaneModel::strain, thickness, true);
    std::vector<Index> fan_of_corner(mesh.n_corners(), 0), node;
    for (Index c = 0; c < mesh.n_corners(); ++c) node.push_back(c);
    for (const double size : {0.01, 0.1, 0.4}) {
        const std::vector<Vec2> u = random_displacements(mesh, size);
        std::vector<Vec2> f(mesh.n_corners());
        std::vector<std::uint8_t> candidate(1, 0);
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const auto evaluate = [&](double threshold) {
                forces.set_stress_criterion({threshold * threshold}, fan_of_corner);
                candidate[0] = 0;
                forces.evaluate(t, t + 1, u, node, f.data(), candidate);
                return candidate[0] != 0;
            };
            evaluate(1);
            double needed = 0;  // [Pa] the stress whose bound on the forces they reach
            const auto g = shape_gradients(mesh, t);
            for (Index k = 0; k < 3; ++k)
                needed = std::max(needed, f[k].norm() / force_of_unit_stress(g, mesh.area(t) * thickness, 1, k));
            CHECK(evaluate(needed * (1 - 1e-6)));
        }
    }
}

}  // namespace elastic_forces_test
