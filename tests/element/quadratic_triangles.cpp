// Triangles of second order against their shape functions, integrated numerically (six points, exact to degree four).
#include "base/random.hpp"
#include "element/elastic_forces.hpp"
#include "element/shape_functions.hpp"
#include "element/triangle_matrices.hpp"
#include "support/meshes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace quadratic_triangles_test {

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic rock{.density = 2000, .E = 5, .nu = 0.3};
const Elastic layered{
    .density = 2000, .E = 5, .nu = 0.3, .bedding = Bedding{.E = 2, .nu = 0.15, .G = 0.8, .angle = 0.4}};
constexpr double thickness = 0.7;

Mesh skew_mesh() {
    Mesh mesh = bar_mesh(3, 2, 2, 1);
    Random random(1, "mesh");
    for (Vec2& x : mesh.vertices) x += 0.1 * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    mesh.order = 2;
    return mesh;
}

template <class Field>
std::vector<Vec2> displacement(const Mesh& mesh, const Field& field) {
    std::vector<Vec2> u;
    for (Index c = 0; c < mesh.n_corners(); ++c) u.push_back(field(mesh.corner(c)));
    return u;
}

std::vector<Vec2> random_displacement(const Mesh& mesh) {
    Random random(2, "u");
    return displacement(mesh, [&](const Vec2&) -> Vec2 {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        return {x, y};
    });
}

/// On free triangles: corner c is node c.
std::vector<Vec2> forces(const Mesh& mesh, PlaneModel plane, const std::vector<Vec2>& u,
                         const Elastic& material = rock) {
    std::vector<Vec2> f(mesh.n_corners());
    std::vector<Index> node(mesh.n_corners());
    for (Index c = 0; c < mesh.n_corners(); ++c) node[c] = c;
    std::vector<std::uint8_t> candidate;
    ElasticForces(mesh, {material}, plane, thickness).evaluate(u, node, f, candidate);
    return f;
}

struct Place {
    Eigen::Vector3d l;  // barycentric
    double weight;
};

/// D. A. Dunavant, Int. J. Numer. Meth. Engng. 21 (1985) 1129, degree 4.
std::vector<Place> places() {
    std::vector<Place> made;
    for (const auto& [a, weight] :
         {std::pair{0.445948490915965, 0.223381589678011}, {0.091576213509771, 0.109951743655322}})
        for (int k = 0; k < 3; ++k) {
            Eigen::Vector3d l = Eigen::Vector3d::Constant(a);
            l[k] = 1 - 2 * a;
            made.push_back({l, weight});
        }
    return made;
}

/// Gradients of the seven shape functions: quadratic ones less what the bubble takes over in their values at the
/// centre.
std::array<Vec2, 7> gradients(const std::array<Vec2, 3>& g, const Eigen::Vector3d& l) {
    const Vec2 bubble = 27 * (l[1] * l[2] * g[0] + l[0] * l[2] * g[1] + l[0] * l[1] * g[2]);
    std::array<Vec2, 7> made;
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        made[k] = (4 * l[k] - 1) * g[k] + bubble / 9;
        made[3 + k] = 4 * (l[k] * g[next] + l[next] * g[k]) - 4. / 9 * bubble;
    }
    made[6] = bubble;
    return made;
}

ElementMatrix integrated_stiffness(const Mesh& mesh, Index t, PlaneModel plane, const Elastic& material) {
    ElementMatrix K = ElementMatrix::Zero(14, 14);
    for (const Place& place : places()) {
        Eigen::Matrix<double, 3, 14> B = Eigen::Matrix<double, 3, 14>::Zero();
        const auto gradient = gradients(shape_gradients(mesh, t), place.l);
        for (int c = 0; c < 7; ++c) {
            B(0, 2 * c) = B(2, 2 * c + 1) = gradient[c].x();
            B(1, 2 * c + 1) = B(2, 2 * c) = gradient[c].y();
        }
        K += place.weight * mesh.area(t) * thickness * B.transpose() * material.stiffness(plane) * B;
    }
    return K;
}

}  // namespace

TEST_CASE("second order: forces and stiffness are those of the seven shape functions integrated") {
    const Mesh mesh = skew_mesh();
    const std::vector<Vec2> u = random_displacement(mesh);
    for (const auto& [plane, material] :
         {std::pair{PlaneModel::strain, rock}, {PlaneModel::stress, rock}, {PlaneModel::strain, layered}}) {
        const std::vector<Vec2> f = forces(mesh, plane, u, material);
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const ElementMatrix K = integrated_stiffness(mesh, t, plane, material),
                                made = stiffness_matrix(mesh, t, material, plane, thickness);
            CHECK((made - K).norm() <= 1e-13 * K.norm());
            Eigen::VectorXd all(14);
            for (Index k = 0; k < 7; ++k) all.segment<2>(2 * k) = u[7 * t + k];
            const Eigen::VectorXd expected = -K * all;
            for (Index k = 0; k < 7; ++k) CHECK((f[7 * t + k] - expected.segment<2>(2 * k)).norm() <= 1e-13 * K.norm());
        }
    }
}

TEST_CASE("second order: rigid motions cost no force and every triangle is in equilibrium") {
    const Mesh mesh = skew_mesh();
    for (const Vec2& f : forces(mesh, PlaneModel::strain, displacement(mesh, [](const Vec2& x) -> Vec2 {
                                    return Vec2(0.3, -2) + 1e-2 * turned_left(x);
                                })))
        CHECK(f.norm() <= 1e-13);
    const std::vector<Vec2> f = forces(mesh, PlaneModel::strain, random_displacement(mesh));
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        Vec2 sum = Vec2::Zero();
        double moment = 0;
        for (Index k = 0; k < 7; ++k) sum += f[7 * t + k], moment += cross(mesh.corner(t, k), f[7 * t + k]);
        CHECK(sum.norm() <= 1e-12);
        CHECK(std::abs(moment) <= 1e-12);
    }
}

TEST_CASE("second order: a uniform strain gives a sixth and four sixths of its tractions") {
    const Mesh mesh = skew_mesh();
    const Eigen::Matrix2d gradient = (Eigen::Matrix2d() << 1e-3, 4e-4, -7e-4, 2e-3).finished();
    const Eigen::Vector3d s = rock.stiffness(PlaneModel::stress) *
                              Eigen::Vector3d(gradient(0, 0), gradient(1, 1), gradient(0, 1) + gradient(1, 0));
    const Eigen::Matrix2d stress = (Eigen::Matrix2d() << s[0], s[2], s[2], s[1]).finished();
    const std::vector<Vec2> f =
        forces(mesh, PlaneModel::stress, displacement(mesh, [&](const Vec2& x) -> Vec2 { return gradient * x; }));
    double largest = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto edge = [&](Index k) -> Vec2 { return mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k % 3); };
        const auto outward = [](const Vec2& along) -> Vec2 { return -turned_left(along); };
        for (Index k = 0; k < 3; ++k) {  // the corner pulls its triangle back
            CHECK((f[7 * t + k] + stress * outward(edge(k) + edge(k + 2)) / 6 * thickness).norm() <= 1e-15);
            CHECK((f[7 * t + 3 + k] + stress * outward(edge(k)) * 4 / 6 * thickness).norm() <= 1e-15);
            const auto g = shape_gradients(mesh, t);
            const double V = mesh.area(t) * thickness;
            CHECK(f[7 * t + k].norm() <= stress.norm() * force_of_unit_stress(g, V, 2, k) * (1 + 1e-12));
            CHECK(f[7 * t + 3 + k].norm() <= stress.norm() * force_of_unit_stress(g, V, 2, 3 + k) * (1 + 1e-12));
            CHECK(force_of_unit_stress(g, V, 2, 3 + k) == relative(4. / 6 * edge(k).norm() * thickness, 1e-12));
        }
        CHECK(f[7 * t + 6].norm() <= 1e-15);
        largest = std::max(largest, f[7 * t].norm());
    }
    CHECK(largest > 1e-4);
}

TEST_CASE("second order: the lumped mass integrates cubic functions and the consistent one quadratic products") {
    const auto lumped = [](const auto& f) {
        double sum = 0;
        for (Index k = 0; k < 7; ++k) {
            const Mesh unit{.order = 2, .vertices = {{0, 0}, {1, 0}, {0, 1}}, .triangles = {{0, 1, 2}}, .region = {0}};
            const Vec2 x = unit.corner(0, k);
            sum += corner_share(2, k, 0.5) * f(x.x(), x.y());
        }
        return sum;
    };
    for (int i = 0; i <= 3; ++i)  // the integral of x^i y^j over the unit triangle is i! j!/(i + j + 2)!
        for (int j = 0; i + j <= 3; ++j)
            CHECK(lumped([&](double x, double y) { return std::pow(x, i) * std::pow(y, j); }) ==
                  relative(std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3), 1e-14));

    for (const Index order : {1, 2}) {
        const ElementMatrix &M = mass_matrix(order, MassMatrix::consistent),
                            &diagonal = mass_matrix(order, MassMatrix::lumped);
        CHECK((M - M.transpose()).norm() <= 1e-16);
        for (Index i = 0; i < M.rows(); ++i) CHECK(M.row(i).sum() == relative(diagonal(i, i), 1e-14));
        CHECK(diagonal.sum() == relative(1.0, 1e-15));
    }
    // x^2 and x y on the unit triangle: the integral of x^3 y is 3! 1!/6!, over the area 1/2
    const Mesh unit{.order = 2, .vertices = {{0, 0}, {1, 0}, {0, 1}}, .triangles = {{0, 1, 2}}, .region = {0}};
    Eigen::VectorXd a(7), b(7);
    for (Index k = 0; k < 7; ++k)
        a[k] = std::pow(unit.corner(0, k).x(), 2), b[k] = unit.corner(0, k).x() * unit.corner(0, k).y();
    CHECK(a.dot(mass_matrix(2, MassMatrix::consistent) * b) == relative(2 * 6.0 / 720, 1e-14));
}

TEST_CASE("second order: the stable step is that of the free triangle") {
    // equilateral, nodes 1/2 apart; against the largest eigenvalue by power iteration
    const Mesh mesh = skew_mesh();
    for (const Elastic& material : {rock, layered}) {
        const std::vector<double> steps = stable_steps(mesh, {material}, PlaneModel::strain);
        std::vector<Vec2> u = random_displacement(mesh);
        std::vector<double> rate(mesh.n_triangles());
        for (int i = 0; i < 3000; ++i) {
            const std::vector<Vec2> f = forces(mesh, PlaneModel::strain, u, material);
            for (Index t = 0; t < mesh.n_triangles(); ++t) {
                double before = 0, after = 0;
                const auto mass = [&](Index k) {
                    return corner_share(2, k, material.density * mesh.area(t) * thickness);
                };
                for (Index k = 0; k < 7; ++k)
                    before += mass(k) * u[7 * t + k].squaredNorm(), after += f[7 * t + k].squaredNorm() / mass(k);
                rate[t] = std::sqrt(after / before);
                for (Index k = 0; k < 7; ++k) u[7 * t + k] = f[7 * t + k] / (mass(k) * std::sqrt(after));
            }
        }
        for (Index t = 0; t < mesh.n_triangles(); ++t) CHECK(steps[t] == relative(2 / std::sqrt(rate[t]), 1e-6));
    }
}

TEST_CASE("second order: the stress criterion marks fans by the forces on their corners") {
    const Mesh mesh = skew_mesh();
    std::vector<Index> own(mesh.n_corners());  // a fan and a node per corner
    for (Index c = 0; c < mesh.n_corners(); ++c) own[c] = c;
    ElasticForces triangles(mesh, {rock}, PlaneModel::strain, thickness);
    triangles.set_stress_criterion(std::vector<double>(mesh.n_corners(), 1), own);
    std::vector<Vec2> f(mesh.n_corners());
    std::vector<std::uint8_t> candidate(mesh.n_corners(), 0);
    triangles.evaluate(displacement(mesh, [](const Vec2& x) -> Vec2 { return 0.1 * x.squaredNorm() * x; }), own, f,
                       candidate);
    int n_candidates = 0, n_held = 0;
    for (Index c = 0; c < mesh.n_corners(); ++c) {
        const Index t = mesh.triangle_of(c), k = mesh.place_in_triangle(c);
        const double most = force_of_unit_stress(shape_gradients(mesh, t), mesh.area(t) * thickness, 2, k);
        CHECK(static_cast<bool>(candidate[c]) == (k < 6 && f[c].norm() > most));
        (candidate[c] ? n_candidates : n_held) += k < 6;
    }
    CHECK(n_candidates > 10);
    CHECK(n_held > 10);
}

}  // namespace quadratic_triangles_test
