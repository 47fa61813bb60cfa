// The matrix of an implicit step against the sum of its elements, while fans come apart and points change.
#include "stepper/implicit/theta_matrix.hpp"
#include "model/make_model.hpp"
#include "stepper/implicit/dissection.hpp"
#include "stepper/implicit/gmres.hpp"
#include "stepper/implicit/implicit_bulk.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <omp.h>
#include <Eigen/Dense>

#include <algorithm>

namespace theta_matrix_test {

using namespace knap;
using namespace knap::tests;

namespace {

Model plate(Index order = 1) {
    ModelInput input =
        body_with(order == 1 ? bar_mesh(12, 7, 1, 0.6) : bar_mesh(7, 4, 1, 0.6), {.density = 1, .E = 1, .nu = 0.3},
                  {.sigma_c = 1e-3, .G_c = 2e-5, .gamma = 1, .friction = 0.3});
    input.mesh.order = order;
    input.loads = {load(Load::Kind::velocity, "left", 0, 0), load(Load::Kind::velocity, "right", 0, std::nullopt)};
    return make_model(std::move(input));
}

/// Which fans are active, the blocks of their points, and the matrix that they make.
struct Setting {
    const Model& model;
    double stiffness_factor = 0.5;
    double friction = 0;  // size of the unsymmetric part of the blocks
    std::vector<std::uint8_t> active = std::vector<std::uint8_t>(model.fans.size(), 0);
    CornerPartition partition;
    std::vector<PointTangent> points;

    void give(ThetaMatrix& matrix) {
        partition_corners(model, active, partition);
        points.clear();
        for (std::size_t f = 0; f < model.fans.size(); ++f)
            for (Index i = model.fans[f].first_point;
                 active[f] && i < model.fans[f].first_point + model.fans[f].n_points; ++i) {
                const FanPoint& point = model.fan_points[i];
                const Vec2 n = point.normal, t = turned_left(n);
                const Eigen::Matrix2d closed = (5 + i % 3) * n * n.transpose(),
                                      tangential = friction * t * n.transpose();
                points.push_back({{i, partition.node_of_corner[point.before], partition.node_of_corner[point.after]},
                                  closed + tangential,
                                  closed});
            }
        matrix.set(partition, stiffness_factor);
    }

    Eigen::MatrixXd dense() const {
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * partition.n_nodes(), 2 * partition.n_nodes());
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            const ElementMatrix K = stiffness_matrix(model.mesh, t, model.materials[0], model.plane, model.thickness);
            const ElementMatrix& M = mass_matrix(model.mesh.order, MassMatrix::consistent);
            const Index* node = &partition.node_of_corner[M.rows() * t];
            for (int i = 0; i < M.rows(); ++i)
                for (int j = 0; j < M.rows(); ++j)
                    A.block<2, 2>(2 * node[i], 2 * node[j]) +=
                        stiffness_factor * K.block<2, 2>(2 * i, 2 * j) +
                        model.triangle_mass(t) * M(i, j) * Eigen::Matrix2d::Identity();
        }
        for (const PointTangent& point : points)
            for (const auto& [a, b] :
                 {std::pair(point.sides.after, point.sides.before), std::pair(point.sides.before, point.sides.after)}) {
                A.block<2, 2>(2 * a, 2 * a) += point.block;
                A.block<2, 2>(2 * a, 2 * b) -= point.block;
            }
        for (Index i = 0; i < 2 * partition.n_nodes(); ++i)
            if (partition.prescribed[i / 2][i % 2]) A.row(i).setZero(), A.col(i).setZero(), A(i, i) = 1;
        return A;
    }

    std::vector<Vec2> right_hand_side() const {
        std::vector<Vec2> b(partition.n_nodes());
        for (Index i = 0; i < partition.n_nodes(); ++i)
            for (int k = 0; k < 2; ++k) b[i][k] = partition.prescribed[i][k] ? 0 : 1 + (7 * i + 3 * k) % 11;
        return b;
    }

    double error(const std::vector<Vec2>& x) const {
        const std::vector<Vec2> b = right_hand_side();
        const Eigen::Map<const Eigen::VectorXd> flat_x(x[0].data(), 2 * partition.n_nodes()),
            flat_b(b[0].data(), 2 * partition.n_nodes());
        return (dense() * flat_x - flat_b).norm() / flat_b.norm();
    }
};

std::vector<ActingPoint> acting(const std::vector<PointSides>& sides) {
    std::vector<ActingPoint> points;
    for (const PointSides& of_point : sides) points.push_back({of_point, {true, true}});
    return points;
}

std::vector<Vec2> solution(ThetaMatrix& matrix, Setting& setting) {
    setting.give(matrix);
    REQUIRE(matrix.factorise(setting.points));
    std::vector<Vec2> x;
    REQUIRE(matrix.solve(setting.right_hand_side(), x));
    return x;
}

}  // namespace

TEST_CASE("the factor that follows the changes is that of a new matrix to the last bit") {
    const Model model = plate();
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    std::size_t entries = 0;
    const auto compare = [&] {
        const std::vector<Vec2> x = solution(matrix, setting);
        CHECK(setting.error(x) < 1e-12);
        ThetaMatrix fresh(model, MassMatrix::consistent);
        CHECK(same_bits(x, solution(fresh, setting)));
        CHECK(matrix.size().entries == fresh.size().entries);
        entries = matrix.size().entries;
    };
    compare();
    const std::size_t intact = entries;
    for (std::size_t f = 0; f < model.fans.size(); f += 5) {  // come apart, near and far
        setting.active[f] = true;
        compare();
    }
    CHECK(entries > intact);
    for (std::size_t f = 0; f < model.fans.size(); f += 10) setting.active[f] = false;
    compare();
    setting.stiffness_factor = 2;
    compare();
    std::fill(setting.active.begin(), setting.active.end(), false);
    compare();
    setting.stiffness_factor = 0.5;
    compare();
    CHECK(entries == intact);
}

TEST_CASE("the same bits for one and two and four threads") {
    ModelInput input;  // large enough for several threads, with fronts that they share
    input.mesh = bar_mesh(48, 32, 1.5, 1);
    input.materials = {{.density = 1, .E = 1, .nu = 0.3}};
    input.laws = {{.sigma_c = 1e-3, .G_c = 2e-5, .gamma = 1, .friction = 0.3}};
    input.law_of_pair = {{0}};
    const Model model = make_model(std::move(input));
    const auto solve = [&](int n_threads) {
        omp_set_num_threads(n_threads);
        ThetaMatrix matrix(model, MassMatrix::consistent);
        Setting setting{.model = model, .friction = 0.3};
        std::vector<Vec2> all;
        const auto add = [&] {
            const std::vector<Vec2> x = solution(matrix, setting);
            all.insert(all.end(), x.begin(), x.end());
        };
        for (std::size_t f = 0; f < model.fans.size(); f += 2) setting.active[f] = model.fans[f].n_points > 0;
        add();
        std::vector<PointTangent> softening = setting.points;
        PointTangent& point = softening[softening.size() / 2];
        point.block = point.symmetric_block = -100 * Eigen::Matrix2d::Identity();
        CHECK(!matrix.factorise(softening));
        for (std::size_t f = 400; f < 420; ++f) setting.active[f] = model.fans[f].n_points > 0;
        add();
        omp_set_num_threads(1);
        return all;
    };
    const std::vector<Vec2> one = solve(1);
    for (const int n_threads : {2, 4}) CHECK(same_bits(one, solve(n_threads)));
}

TEST_CASE("the scale of elastic impulses grows with the rates and rates that overflow have none") {
    const Model model = plate();
    const State state = initial_state(model);
    CornerPartition nodes;
    partition_corners(model, std::vector<std::uint8_t>(model.fans.size(), 0), nodes);
    StepContext step;
    step.h = 2, step.theta = 1, step.begin = &state;
    ImplicitBulk bulk(model, MassMatrix::lumped);
    bulk.begin_step(step);
    std::vector<Vec2> rate;
    bulk.set_nodes(nodes, std::vector<Vec2>(model.mesh.n_corners(), Vec2::Zero()), rate);
    std::ranges::fill(rate, Vec2(1, 0));
    const double scale = bulk.largest_elastic_impulse(rate);
    CHECK(scale > 0);
    rate.back() = {1e3, 0};
    CHECK(bulk.largest_elastic_impulse(rate) > 10 * scale);
    rate.back() = {1e300, 1e300};  // their norm is infinite, and so would be a tolerance
    CHECK(bulk.largest_elastic_impulse(rate) == 0);
}

TEST_CASE("the factor of triangles of second order follows the changes too") {
    const Model model = plate(2);
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    for (std::size_t f = 0; f < model.fans.size(); f += 20) {
        setting.active[f] = model.fans[f].n_points > 0;
        const std::vector<Vec2> x = solution(matrix, setting);
        CHECK(setting.error(x) < 1e-12);
        ThetaMatrix fresh(model, MassMatrix::consistent);
        CHECK(same_bits(x, solution(fresh, setting)));
    }
}

TEST_CASE("an indefinite matrix is refused and the factor recovers") {
    const Model model = plate();
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    for (std::size_t f = 0; f < model.fans.size(); f += 3) setting.active[f] = true;
    const std::vector<Vec2> before = solution(matrix, setting);
    std::vector<PointTangent> softening = setting.points;
    PointTangent& point = softening[softening.size() / 2];
    point.block = point.symmetric_block = -100 * Eigen::Matrix2d::Identity();
    CHECK(!matrix.factorise(softening));
    CHECK(!matrix.factorise(softening));  // not forgotten
    CHECK(same_bits(before, solution(matrix, setting)));
}

TEST_CASE("friction that follows the contacts is solved with the factor of the rest") {
    const Model model = plate();
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    for (std::size_t f = 0; f < model.fans.size(); f += 4) setting.active[f] = true;
    for (const double friction : {0.3, 3e3, 0.3}) {
        setting.friction = friction;
        setting.give(matrix);
        REQUIRE(matrix.factorise(setting.points));
        CHECK(!matrix.is_symmetric());
        std::vector<Vec2> x;
        CHECK(matrix.solve(setting.right_hand_side(), x) == (friction < 1));  // beyond reach of GMRES: false
        if (friction < 1) CHECK(setting.error(x) < 1e-7);
    }
}

TEST_CASE("far nodes that are eliminated once leave the solution as it is") {
    const Model model = plate();
    for (const auto& [friction, reduced] :
         {std::pair(0.0, false), std::pair(0.3, false), std::pair(0.0, true), std::pair(0.3, true)}) {
        ThetaMatrix matrix(model, MassMatrix::consistent);
        Setting setting{.model = model};
        for (std::size_t f = 0; f < model.fans.size() / 10; ++f) setting.active[f] = !reduced || f % 5 == 0;
        setting.friction = friction;
        const std::vector<Vec2> all = solution(matrix, setting), b = setting.right_hand_side();
        CHECK(matrix.near_nodes().size() == all.size());
        std::vector<PointSides> sides;
        for (const PointTangent& point : setting.points) sides.push_back(point.sides);
        REQUIRE(!sides.empty());
        if (reduced) {
            REQUIRE(matrix.set_reduced(acting(sides)));
            CHECK(!matrix.has_factor());
            REQUIRE(matrix.factorise(setting.points));
            CHECK(matrix.has_factor());
        } else {
            matrix.set_near(sides);
        }
        CHECK(matrix.near_nodes().size() < all.size());
        CHECK(matrix.near_nodes().size() > 0);
        std::vector<Vec2> impulse(b.size()), right_side(b.size(), Vec2::Zero()), near, of_bulk;
        std::ranges::transform(b, impulse.begin(), [](const Vec2& x) -> Vec2 { return -x; });
        matrix.condense(impulse);
        for (const Index node : matrix.near_nodes()) right_side[node] = -impulse[node];
        REQUIRE(matrix.solve(right_side, near));
        std::vector<Vec2> x(b.size(), Vec2::Zero());
        for (const Index node : matrix.near_nodes()) x[node] = near[node];
        matrix.add_change_of_far_nodes(near, x);
        double error = 0, size = 0;
        for (std::size_t i = 0; i < x.size(); ++i)
            error = std::max(error, (x[i] - all[i]).norm()), size = std::max(size, all[i].norm());
        CHECK(error < (friction > 0 ? 1e-7 : 1e-12) * size);  // of GMRES
        // the bulk takes what the points leave of the right-hand side
        matrix.bulk_part(right_side, near, of_bulk);
        for (const PointTangent& point : setting.points)
            point.sides.add_force(point.block * point.sides.jump(near), of_bulk);
        for (const Index node : matrix.near_nodes())
            for (int k = 0; k < 2; ++k)
                if (matrix.is_free(node, k)) CHECK(std::abs(of_bulk[node][k] - right_side[node][k]) < 1e-6);
    }
}

TEST_CASE("the compliance of points is that of the inverse matrix") {
    const Model model = plate();
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    for (std::size_t f = 0; f < model.fans.size() / 3; ++f) setting.active[f] = true;
    setting.give(matrix);
    REQUIRE(matrix.factorise(setting.points));
    std::vector<PointSides> all, some;
    for (const PointTangent& point : setting.points) all.push_back(point.sides);
    REQUIRE(all.size() > 20);
    all[0].second_node = all[5].after, all[0].share = 0.3;  // as a vertex at a gap from an edge
    all[0].lever = 0.2 * Vec2(0.6, 0.8) * Vec2(-0.8, 0.6).transpose();
    REQUIRE(all[0].second_node >= 0);
    matrix.set_near(all);
    for (std::size_t i = 0; i < all.size(); i += 5) some.push_back(all[i]);
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(some.size());
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(2 * setting.partition.n_nodes(), n), compliance(n, n);
    for (Eigen::Index j = 0; j < n; ++j)
        some[j / 2].for_each_node([&](Index node, const auto& weight) {
            const Vec2 of_motion = transposed(weight) * Vec2(Vec2::Unit(j % 2));
            for (int k = 0; k < 2; ++k)
                if (!setting.partition.prescribed[node][k]) G(2 * node + k, j) += of_motion[k];
        });
    REQUIRE(matrix.find_compliance(some, compliance));
    const Eigen::MatrixXd exact = G.transpose() * setting.dense().ldlt().solve(G);
    CHECK((compliance - exact).norm() < 1e-12 * exact.norm());
}

TEST_CASE("components along which no point acts follow with the far nodes") {
    const Model model = plate();
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    setting.give(matrix);
    std::vector<ActingPoint> points;
    for (Index corner = 0; corner < model.mesh.n_corners(); corner += 40) {  // contacts along y
        const Index node = setting.partition.node_of_corner[corner];
        const PointSides sides{.fan_point = -1, .before = -1, .after = node, .leaf_corner = corner};
        const Eigen::Matrix2d block = Eigen::Vector2d(0, 3).asDiagonal();
        setting.points.push_back({sides, block, block});
        points.push_back({sides, {false, true}});
    }
    REQUIRE(points.size() > 5);
    REQUIRE(matrix.factorise(setting.points));
    const std::vector<Vec2> b = setting.right_hand_side();
    std::vector<Vec2> all, near, impulse(b.size());
    REQUIRE(matrix.solve(b, all));
    REQUIRE(matrix.set_reduced(points));
    REQUIRE(matrix.factorise(setting.points));
    std::ranges::transform(b, impulse.begin(), [](const Vec2& x) -> Vec2 { return -x; });
    matrix.condense(impulse);
    std::vector<Vec2> right_side(b.size(), Vec2::Zero()), x(b.size(), Vec2::Zero());
    for (const Index node : matrix.near_nodes()) {
        CHECK(impulse[node].x() == 0);
        right_side[node] = -impulse[node];
    }
    REQUIRE(matrix.solve(right_side, near));
    for (const Index node : matrix.near_nodes()) x[node] = near[node];
    matrix.add_change_of_far_nodes(near, x);
    double error = 0, size = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        error = std::max(error, (x[i] - all[i]).norm()), size = std::max(size, all[i].norm());
    CHECK(error < 1e-12 * size);
    for (ActingPoint& point : points) point.along[0] = true;
    REQUIRE(matrix.set_reduced(points));  // another one
    CHECK(!matrix.has_factor());
}

TEST_CASE("the dense matrix of a few points refuses softening and stays while nodes and step do") {
    const Model model = plate();
    ThetaMatrix matrix(model, MassMatrix::consistent);
    Setting setting{.model = model};
    for (std::size_t f = 0; f < model.fans.size() / 10; f += 5) setting.active[f] = true;
    const std::vector<Vec2> all = solution(matrix, setting);
    std::vector<PointSides> sides, many;
    for (const PointTangent& point : setting.points) sides.push_back(point.sides);
    REQUIRE(matrix.set_reduced(acting(sides)));
    const auto near_solution = [&] {
        REQUIRE(matrix.factorise(setting.points));
        std::vector<Vec2> near;
        REQUIRE(matrix.solve(std::vector<Vec2>(all.size(), Vec2(1, 2)), near));
        std::vector<Vec2> of_near_nodes;
        for (const Index node : matrix.near_nodes()) of_near_nodes.push_back(near[node]);
        return of_near_nodes;
    };
    const std::vector<Vec2> near = near_solution();
    std::vector<PointTangent> softening = setting.points;
    PointTangent& point = softening[softening.size() / 2];
    point.block = point.symmetric_block = -100 * Eigen::Matrix2d::Identity();
    CHECK(!matrix.factorise(softening));
    // the compliance of some of them is that of the factor of the body
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(sides.size());
    Eigen::MatrixXd reduced(n, n), of_body(n, n);
    REQUIRE(matrix.factorise(setting.points));
    REQUIRE(matrix.find_compliance(sides, reduced));
    CHECK(same_bits(all, solution(matrix, setting)));  // by the factor of the body, which has lost its points before
    REQUIRE(matrix.find_compliance(sides, of_body));
    CHECK((reduced - of_body).norm() < 1e-11 * of_body.norm());
    REQUIRE(matrix.set_reduced(acting(sides)));
    CHECK(same_bits(near, near_solution()));
    sides.pop_back();  // fewer points on the same nodes
    REQUIRE(matrix.set_reduced(acting(sides)));
    CHECK(matrix.near_nodes().size() == near.size());
    for (std::size_t f = 0; f < model.fans.size(); ++f) setting.active[f] = true;
    setting.give(matrix);
    for (const PointTangent& point : setting.points) many.push_back(point.sides);
    CHECK(!matrix.set_reduced(acting(many)));
    CHECK(!matrix.is_reduced());
    CHECK(matrix.near_nodes().size() == static_cast<std::size_t>(setting.partition.n_nodes()));
}

TEST_CASE("gmres solves in as many products as the matrix has eigenvalues") {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(9, 9);
    A(2, 5) = 3, A(5, 2) = -4, A(0, 0) = 2;
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(9, 1, 2);
    int products = 0;
    const auto product = [&](const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> A_x) {
        ++products, A_x = A * x;
    };
    Gmres gmres;
    REQUIRE(gmres.solve(product, b, 9, 1e-13));
    CHECK((A * gmres.solution() - b).norm() < 1e-12);
    CHECK(products <= 4);  // 1, 2, 1 +- sqrt(-12)
    CHECK(!gmres.solve(product, b, 2, 1e-13));
    CHECK(gmres.solve(product, Eigen::VectorXd::Zero(9), 9, 1e-13));
    CHECK(gmres.solution().isZero(0));
}

}  // namespace theta_matrix_test
