// Bonded fans, in blocks of triangles and across their borders; and split fans that are stationary.
#include "base/parallel.hpp"
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "stepper/explicit/mesh_blocks.hpp"
#include "stepper/explicit/partition.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace bonded_fans_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// A plate of 2 x 1, pulled apart by tractions above and below that grow for one unit of time.
ModelInput pulled_plate(double size, double pull) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    ModelInput input = body_with(triangulate(shape, {.size = size}), {.density = 1, .E = 1, .nu = 0.2},
                                 {.sigma_c = 1e-3, .G_c = 1e-6, .gamma = 1, .friction = 0.3});
    const TimeFunction ramp({{0, 0}, {1, 1}});
    input.loads = {load(Load::Kind::traction, "top", 0.0, pull, ramp),
                   load(Load::Kind::traction, "bottom", 0.0, -pull, ramp)};
    return input;
}

/// Splits every fan inside the body at rest, with this cohesion at its points.
void part_all_inside(Run& run, double cohesion) {
    for (Index f = 0; f < static_cast<Index>(run.model.fans.size()); ++f)
        if (run.model.fans[f].closed) split(run.model, f, run.now);
    for (PointState& point : run.now.points) point.cohesion = cohesion;
}

}  // namespace

TEST_CASE("every fan is inside one block of triangles or borders on several") {
    for (const Index order : {1, 2}) {
        ModelInput input = pulled_plate(0.025, 0);
        input.mesh.order = order;
        const Model model = make_model(std::move(input));
        const std::vector<MeshBlock> blocks = make_blocks(model);
        const Index per_triangle = model.mesh.corners_per_triangle();
        REQUIRE(blocks.size() > 2);
        std::vector<int> n_found(model.fans.size(), 0), n_kept(model.mesh.n_corners(), 0);
        Index next = 0, next_load = 0;
        for (const MeshBlock& block : blocks) {
            CHECK(block.first == next);
            CHECK(block.last - block.first <= blocks.front().last);
            next = block.last;
            const MeshBlock::Corner* corner = block.inner.corners.data();
            bool same = block.inner.no_force == per_triangle * blocks.front().last;
            for (const auto& inner : block.inner.fans) {
                const Fan& fan = model.fans[inner.fan];
                ++n_found[inner.fan];
                const Index n_places = block.inner.n_places(inner);
                const auto corners = model.corners(fan);
                for (Index i = 0; i < fan.n_corners; ++i)
                    same = same && corner[i] + per_triangle * block.first == corners[i];
                for (Index i = fan.n_corners; i < n_places; ++i) same = same && corner[i] == block.inner.no_force;
                corner += n_places;
                same = same && inner.is_free && inner.n_corners == fan.n_corners && inner.mass == fan.mass;
            }
            CHECK(same);
            for (const MeshBlock::Corner c : block.kept) ++n_kept[per_triangle * block.first + c];
            CHECK(block.first_load == next_load);
            next_load = block.last_load;
            for (Index i = block.first_load; i < block.last_load; ++i) {
                const Index triangle = model.mesh.triangle_of(model.corner_loads[i].corner);
                same = same && block.first <= triangle && triangle < block.last;
            }
            CHECK(same);
        }
        CHECK(next == model.mesh.n_triangles());
        CHECK(next_load == static_cast<Index>(model.corner_loads.size()));
        bool kept = true;
        for (const MeshBlock& block : blocks)
            for (const auto& bordering : block.bordering.fans) {
                ++n_found[bordering.fan];
                for (const Index c : model.corners(model.fans[bordering.fan])) kept = kept && n_kept[c]-- == 1;
            }
        CHECK(kept);
        CHECK(std::ranges::count(n_found, 1) == static_cast<std::ptrdiff_t>(n_found.size()));
        CHECK(std::ranges::count(n_kept, 0) == static_cast<std::ptrdiff_t>(n_kept.size()));
    }
}

TEST_CASE("stationary split fans move like bonded fans") {
    Run whole(pulled_plate(0.2, 3e-4)), parted(pulled_plate(0.2, 3e-4));
    part_all_inside(parted, 0.8);
    const double h = 0.5 * whole.stepper.stable_step();
    for (int i = 0; i < 40; ++i) whole.step(h), parted.step(h);
    CHECK(parted.last.fan_solves == static_cast<std::int64_t>(parted.now.split_fans.size()));
    CHECK(whole.now.split_fans.empty());
    for (const PointState& point : parted.now.points) CHECK(point.cohesion == 0.8);
    double largest = 0, difference = 0;
    for (Index t = 0; t < whole.model.mesh.n_triangles(); ++t)
        for (Index k = 0; k < 3; ++k) {
            largest = std::max(largest, whole.u(t, k).norm());
            difference = std::max(difference, (whole.u(t, k) - parted.u(t, k)).norm());
        }
    CHECK(largest > 1e-5);
    CHECK(difference <= 1e-13 * largest);
    const double energy = parted.ledger.row().kinetic + parted.ledger.row().strain;
    CHECK(std::abs(parted.ledger.row().residual) <= 1e-13 * energy);
}

TEST_CASE("fans at rest hold as much as their cohesion and no more") {
    for (const double left : {0.9, 0.2}) {
        Run run(pulled_plate(0.2, 3e-4));
        part_all_inside(run, left);
        const double h = 0.5 * run.stepper.stable_step();
        double largest_stress = 0, largest_opening = 0;  // over all triangles and times, until the first opening
        while (run.now.time < 1 && largest_opening == 0) {
            run.step(h);
            for (Index p = 0; p < run.model.n_points(); ++p)
                largest_opening = std::max(largest_opening, opening(run.model, run.now, p).norm());
            for (Index t = 0; t < run.model.mesh.n_triangles(); ++t) {
                bool inside = true;
                for (Index k = 0; k < 3; ++k)
                    inside = inside && run.model.fans[run.model.fan_of_corner[3 * t + k]].closed;
                if (!inside) continue;
                const Eigen::Vector3d s = stress(run.model, run.now, t);
                largest_stress = std::max(largest_stress, 0.5 * (s[0] + s[1]) + std::hypot(0.5 * (s[0] - s[1]), s[2]));
            }
        }
        const double strength = left * run.model.laws[0].sigma_c;
        CAPTURE(largest_stress / strength);
        CHECK((largest_opening > 0) == (left == 0.2));
        if (left == 0.9) CHECK(largest_stress < strength);
        // of single triangles inside; the stress at a point is that of both sides, and one may be on the boundary
        else CHECK((largest_stress > 0.7 * strength && largest_stress < 1.5 * strength));
    }
}

namespace {

/// A plate 1 high that a crack at x = 1 cuts through, or only its part left of it; the other part flies off, and `back`
/// pushes it.
ModelInput cut_plate(int n_columns, double back) {
    ModelInput input;
    input.mesh = bar_mesh(n_columns, 4, 0.25 * n_columns, 1);
    for (InteriorEdge& edge : input.mesh.interior_edges) {
        const Vec2 a = input.mesh.corner(edge.triangle[0], edge.side[0]),
                   b = input.mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
        edge.cracked = a.x() == 1 && b.x() == 1;
    }
    input.materials = {{.density = 1, .E = 1, .nu = 0.2}};
    input.laws = {{.sigma_c = 1e-3, .G_c = 1e-6, .gamma = 1, .friction = 0.3}};
    input.law_of_pair = {{0}};
    input.loads = {load(Load::Kind::traction, "left", -1e-4, 3e-5)};
    if (n_columns > 4) input.loads.push_back(load(Load::Kind::traction, "right", -back, 0.0));
    if (n_columns > 4)
        input.initial_velocities = {{.on = {.boundary = "", .box = Box{{1, 0}, {2, 1}}}, .value = {1e-4, 2e-5}}};
    return input;
}

}  // namespace

TEST_CASE("a part that moves away from a crack does not act on the other side until it comes back") {
    Run half(cut_plate(4, 0)), away(cut_plate(8, 0)), returning(cut_plate(8, 1.5e-4));
    const double h = 0.5 * half.stepper.stable_step();
    const auto difference = [&](const Run& cut) {  // over the left part
        double largest = 0;
        for (Index row = 0; row < 4; ++row)
            for (Index t = 0; t < 8; ++t)
                for (Index k = 0; k < 3; ++k)
                    largest = std::max(largest, (half.u(8 * row + t, k) - cut.u(16 * row + t, k)).norm());
        return largest;
    };
    double largest = 0, apart = 0, after_contact = 0, deepest = 0;
    for (int i = 0; i < 60; ++i) {
        half.step(h), away.step(h), returning.step(h);
        largest = std::max(largest, half.u(0, 0).norm());
        apart = std::max(apart, difference(away));
        after_contact = std::max(after_contact, difference(returning));
        deepest = std::max(deepest, returning.last.penetration);
    }
    CHECK(largest > 1e-5);
    CHECK(apart <= 1e-13 * largest);
    CHECK(after_contact > 0.01 * largest);
    CHECK(deepest <= 1e-12 * largest);
    for (Run* run : {&half, &away, &returning})
        CHECK(std::abs(run->ledger.row().residual) <= 1e-13 * (run->ledger.row().kinetic + run->ledger.row().strain));
}

TEST_CASE("the motion does not depend on the order in which fans split") {
    Run run(pulled_plate(0.1, 2e-3));
    const double h = 0.5 * run.stepper.stable_step();
    for (int i = 0; i < 20; ++i) run.step(h);
    State ordered = run.now;
    for (Index f = 0; f < static_cast<Index>(run.model.fans.size()); ++f)
        if (ordered.split_rank[f] < 0 && f % 3 > 0) split(run.model, f, ordered);
    State before;
    order_split_fans(run.model, ordered, before);
    State any = run.now;
    for (Index k = static_cast<Index>(run.model.fans.size()) - 1; k >= 0; --k) {
        const Index f = k ^ 5;  // some permutation
        if (f < static_cast<Index>(run.model.fans.size()) && any.split_rank[f] < 0 && f % 3 > 0)
            split(run.model, f, any);
    }
    CHECK(std::ranges::is_sorted(ordered.split_fans));
    CHECK(!std::ranges::is_sorted(any.split_fans));
    const auto same_body = [&](const State& a, const State& b) {
        bool same = true;
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
            same = same && a.displacement[a.node_of_corner[c]] == b.displacement[b.node_of_corner[c]];
            same = same && a.velocity[a.node_of_corner[c]] == b.velocity[b.node_of_corner[c]];
        }
        for (Index p = 0; p < run.model.n_points(); ++p)
            same = same && cohesion(run.model, a, p) == cohesion(run.model, b, p);
        return same;
    };
    CHECK(same_body(any, ordered));
    State of_any, of_ordered, twice = any;
    run.stepper.step(any, h, of_any);
    run.stepper.step(ordered, h, of_ordered);
    CHECK(same_body(of_any, of_ordered));
    order_split_fans(run.model, twice, before);
    CHECK(same_body(twice, any));
    CHECK(same_bits(twice, ordered));
    // into a state from before, of another order, and of none
    for (State into : {run.now, any, of_any, of_ordered, initial_state(run.model), State()}) {
        run.stepper.step(ordered, h, into);
        CHECK(same_bits(into, of_ordered));
        CHECK(same_body(into, of_ordered));
    }
}

TEST_CASE("every block of a loop is worked on once by any number of threads") {
    const int before = omp_get_max_threads();
    for (const int n_threads : {1, 2, 3, 70}) {
        omp_set_num_threads(n_threads);
        for (const int n_blocks : {0, 1, 2, 5, 200}) {
            std::vector<int> n_visits(n_blocks, 0);
            for_blocks(n_blocks, [&](std::ptrdiff_t i) { ++n_visits[i]; });
            CHECK(std::count(n_visits.begin(), n_visits.end(), 1) == n_blocks);
        }
    }
    omp_set_num_threads(before);
}

}  // namespace bonded_fans_test
