// Interfaces that hold are rigid: the body with all its edges cohesive moves as the body without (E1, E12), and a
// preload below the strength does nothing at all (E14).
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace rigidity_test {

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic glass{.density = 2450, .E = 32e9, .nu = 0.2};

ModelInput plate(Mesh mesh, const CohesiveLaw& law, PlaneModel plane = PlaneModel::strain) {
    ModelInput input = body_with(std::move(mesh), glass, law);
    input.plane = plane;
    return input;
}

/// Every vertex with a point of its own between all its corners, so that each is solved by the solver of fans.
Model all_split(ModelInput input) {
    Model model = make_model(std::move(input));
    for (Fan& fan : model.fans) fan.split_at_start = true;
    return model;
}

/// Far above what loads it; not further, since the tolerance of the implicit scheme is a part of the strength.
CohesiveLaw strong() { return {.sigma_c = 1e8, .G_c = 1e5, .gamma = 1, .friction = 0.5}; }

/// A bar_mesh of n x n cells, with one vertex moved so near to an edge that a triangle of half a degree remains.
Mesh mesh_with_sliver(int n) {
    Mesh mesh = bar_mesh(n, n, 1, 1);
    const Index vertex = (n / 2) * (n + 1) + n / 2;
    // triangle (i, j), (i+1, j), (i+1, j+1) to the lower left of the vertex: onto the middle of its edge from (i, j) to
    // (i+1, j)
    mesh.vertices[vertex].y() -= (1 - 4e-3) / n;
    mesh.vertices[vertex].x() -= 0.4 / n;
    find_edges(mesh);
    for (BoundaryEdge& edge : mesh.boundary_edges) edge.boundary = 0;
    mesh.boundary_names = {"left"};
    for (BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 middle =
            0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        if (middle.x() > 1e-9) edge.boundary = 1;
    }
    mesh.boundary_names = {"left", "other"};
    return mesh;
}

/// Largest difference of the displacements of two runs over the largest displacement, at the same corners.
double difference(const Run& a, const Run& b) {
    double worst = 0, largest = 0;
    for (Index c = 0; c < a.model.mesh.n_corners(); ++c) {
        worst = std::max(worst, (a.u(c / 3, c % 3) - b.u(c / 3, c % 3)).norm());
        largest = std::max(largest, a.u(c / 3, c % 3).norm());
    }
    return worst / largest;
}

double smallest_area(const Mesh& mesh) {
    double area = INFINITY;
    for (Index t = 0; t < mesh.n_triangles(); ++t) area = std::min(area, mesh.area(t));
    return area;
}

void set_displacement(Run& run, const Eigen::Matrix2d& gradient) {
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        run.now.displacement[run.now.node_of_corner[c]] = gradient * run.model.mesh.corner(c / 3, c % 3);
}

/// A plate pushed at its left in steps of h: without interfaces, with all edges cohesive (vertices bound), and with
/// every vertex split into its corners.
void run_a_wave(const SchemeOptions& path, const Mesh& mesh, int n_steps, double h, double tolerance) {
    on_path(path);
    ModelInput whole = plate(mesh, CohesiveLaw::unbreakable()), cohesive = plate(mesh, strong());
    whole.loads = cohesive.loads = {load(Load::Kind::traction, "left", 1e6, 3e5)};
    Run reference(whole, path), bound(cohesive, path), split(all_split(cohesive), path);
    CHECK(static_cast<Index>(split.now.displacement.size()) == mesh.n_corners());
    for (int i = 0; i < n_steps; ++i) {
        for (Run* run : {&reference, &bound, &split}) {
            run->step(h);
            REQUIRE(run->last.rejection == Rejection::none);
        }
    }
    CHECK(reference.ledger.row().external_work > 0);
    CHECK(bound.now.split_fans.empty());
    const std::string at = ", " + std::to_string(n_steps) + " steps";
    verify_at_most("difference of the displacements, bound" + at, difference(reference, bound), 0);
    verify_small("difference of the displacements, split" + at, difference(reference, split), {tolerance});
    CHECK(split.ledger.worst().fan_fallbacks == 0);
    CHECK(split.ledger.worst().penetration == 0);
    CHECK(split.ledger.largest_residual() <= 1e-11 * split.ledger.largest_energy());
}

double stable_step(const Mesh& mesh) { return Run(plate(mesh, CohesiveLaw::unbreakable())).stepper.stable_step(); }

}  // namespace

TEST_CASE("E1 with all edges cohesive a wave runs as in the body without edges") {
    describe(
        "A plate of 16 x 16 cells (8 x 8 in implicit steps) pushed at its left: without interfaces, with all edges "
        "cohesive (vertices bound), and with every vertex split into its corners. No "
        "artificial compliance.");
    const Mesh mesh = bar_mesh(16, 16, 1, 1), coarse = bar_mesh(8, 8, 1, 1);
    run_a_wave(both_explicit, mesh, 300, 0.5 * stable_step(mesh), 1e-10);
    run_a_wave(both_implicit, coarse, 40, 2 * stable_step(coarse), 1e-10);
}

TEST_CASE("E12 slivers of half a degree do not disturb a wave") {
    describe("A plate of 6 x 6 cells with a triangle of half a degree, pushed at its left by central differences.");
    const Mesh mesh = mesh_with_sliver(6);
    CHECK(smallest_area(mesh) < 1e-2 * 0.5 / 36);
    run_a_wave(both_explicit, mesh, 3000, 0.5 * stable_step(mesh), 1e-8);
}

TEST_CASE("E1 patch test: a uniform strain is at rest with all edges cohesive") {
    const Eigen::Matrix2d gradient = (Eigen::Matrix2d() << 1e-4, 3e-5, -2e-5, 7e-5).finished();
    for (const SchemeOptions& path : both_paths())
        for (const bool sliver : {false, true}) {
            on_path(path);
            const bool is_explicit = path.bulk == BulkScheme::explicit_lumped;
            const Mesh mesh = sliver ? mesh_with_sliver(6) : bar_mesh(8, 8, 1, 1);
            ModelInput input = plate(mesh, strong());
            for (const std::string& side : mesh.boundary_names)
                input.loads.push_back(load(Load::Kind::velocity, side, 0.0, 0.0));
            Run run(all_split(input), path);
            set_displacement(run, gradient);
            const double h = (is_explicit ? 0.5 : 5) * stable_step(mesh);
            const int n_steps = is_explicit ? 1000 : 100;
            for (int i = 0; i < n_steps; ++i) run.step(h);
            double worst = 0;
            for (Index c = 0; c < mesh.n_corners(); ++c)
                worst = std::max(worst, (run.u(c / 3, c % 3) - gradient * mesh.corner(c / 3, c % 3)).norm());
            verify_small("largest error of the displacement over the strain, " + std::to_string(n_steps) + " steps" +
                             (sliver ? ", with slivers" : ""),
                         worst / gradient.norm(), {1e-10});
            CHECK(run.ledger.row().surface() == 0);
        }
}

TEST_CASE("E14 a bar at .99 of its strength rests for ten thousand steps and at 1.01 it breaks") {
    describe("A bar between two ends, stretched to .99 of its strength.");
    on_path(both_explicit);
    const double sigma_c = 1e6;
    const CohesiveLaw law{.sigma_c = sigma_c, .G_c = 3, .gamma = 1, .friction = 0.5};
    for (const double level : {0.99, 1.01}) {
        // uniaxial stress along x: the ends are held, the sides free
        ModelInput input = plate(bar_mesh(10, 3, 1, 0.3), law, PlaneModel::stress);
        input.loads = {load(Load::Kind::velocity, "left", 0.0, std::nullopt),
                       load(Load::Kind::velocity, "right", 0.0, std::nullopt)};
        Run run(input);
        const double strain = level * sigma_c / glass.E;
        set_displacement(run, Eigen::Vector2d(strain, -glass.nu * strain).asDiagonal());
        const double h = 0.5 * run.stepper.stable_step();
        const std::vector<Vec2> start = run.now.displacement;
        for (int i = 0; i < 10000 && run.now.split_fans.empty(); ++i) run.step(h);
        if (level < 1) {
            CHECK(run.now.n_steps == 10000);
            CHECK(run.ledger.worst().bond_checks + run.ledger.worst().fan_solves > 0);  // it was put to the test
            double worst = 0;
            for (std::size_t i = 0; i < start.size(); ++i)
                worst = std::max(worst, (run.now.displacement[i] - start[i]).norm());
            verify_small("movement over the strain in 10 000 steps at .99", worst / strain, {1e-10});
            CHECK(run.ledger.worst().largest_speed <= 1e-9 * strain * glass.dilatational_speed(PlaneModel::stress));
        } else {
            for (int i = 0; i < 2000; ++i) run.step(h);
            double weakest = 1;
            for (Index p = 0; p < run.model.n_points(); ++p)
                weakest = std::min(weakest, cohesion(run.model, run.now, p));
            verify_at_most("smallest beta 2000 steps after it began to open at 1.01", weakest, 0);
            CHECK(run.ledger.worst().residual <= 1e-10);
        }
    }
}

TEST_CASE("what cannot part starts with one velocity whatever the scenario gives its triangles") {
    // a crack to the middle of a plate that cannot break, its upper half thrown up and aside: fans along the crack are
    // split from the start
    for (const BulkScheme bulk : {BulkScheme::explicit_lumped, BulkScheme::implicit_theta}) {
        Mesh mesh = bar_mesh(6, 6, 1, 1);
        for (InteriorEdge& edge : mesh.interior_edges) {
            const Vec2 a = mesh.corner(edge.triangle[0], edge.side[0]),
                       b = mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
            edge.cracked = std::abs(a.y() - 0.5) + std::abs(b.y() - 0.5) < 1e-9 && 0.5 * (a.x() + b.x()) < 0.5;
        }
        ModelInput input = plate(std::move(mesh), CohesiveLaw::unbreakable());
        const Vec2 thrown(0.3, 1);
        input.initial_velocities = {{.on = {.boundary = "", .box = Box{{-1, 0.5}, {2, 2}}}, .value = thrown},
                                    {.on = {.boundary = "", .box = Box{{0.2, 0.5}, {0.4, 0.8}}}, .value = -thrown}};
        Run run(input, {.bulk = bulk, .cohesion = CohesionScheme::explicit_beta});
        const Vec2 momentum = run.mean_velocity([](Index) { return true; });
        CHECK(momentum.x() / momentum.y() == relative(0.3, 1e-12));
        REQUIRE(!run.now.split_fans.empty());
        const double h = 0.4 * (1.0 / 6) / glass.dilatational_speed(PlaneModel::strain) / 2;
        for (int step = 0; step < 30; ++step) run.step(h);
        CHECK(run.ledger.largest_residual() <= 1e-13 * run.ledger.largest_energy());
        CHECK((run.mean_velocity([](Index) { return true; }) - momentum).norm() <= 1e-12 * momentum.norm());
    }
}

}  // namespace rigidity_test
