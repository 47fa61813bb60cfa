// Crack patterns that must not depend on what is no physics: the step (E13), what counts as broken (E17).
#include "geometry/triangulate.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic glass{.density = 2450, .E = 32e9, .nu = 0.2};

/// A random mesh of a block with a crack from the middle of its left side.
Mesh cracked_block(const Vec2& size, double crack, double edge) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {size.x(), 0}, size, {0, size.y()}}, .boundary = {0, 1, 2, 3}};
    shape.cracks = {{.points = {{0, 0.5 * size.y()}, {crack, 0.5 * size.y()}}}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    return triangulate(shape, {.size = edge});
}

/// Pulled apart across the crack by a step of traction.
ModelInput pulled(Mesh mesh, double sigma_c, double pull) {
    ModelInput input;
    input.mesh = std::move(mesh);
    input.thickness = 1e-3;
    input.materials = {glass};
    input.laws = {{.sigma_c = sigma_c, .G_c = 3, .gamma = 1}};
    input.law_of_pair = {{0}};
    input.loads = {load(Load::Kind::traction, "top", 0.0, pull), load(Load::Kind::traction, "bottom", 0.0, -pull)};
    return input;
}

std::set<Index> broken(const Run& run, double threshold = 0) {
    std::set<Index> found;
    for (Index p = 0; p < run.model.n_points(); ++p)
        if (cohesion(run.model, run.now, p) <= threshold) found.insert(p);
    return found;
}

double part_that_differs(const std::set<Index>& a, const std::set<Index>& b) {
    std::vector<Index> only_one;
    std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only_one));
    return static_cast<double>(only_one.size()) / static_cast<double>(b.size());
}

/// To a time in whole steps of about h; implicit steps that are refused are taken in halves.
void go(Run& run, double until, double h, const std::function<void()>& after_step = [] {}) {
    double now = h;
    State end;
    while (run.now.time < until * (1 - 1e-9)) {
        const StepReport report = run.stepper.step(run.now, std::min(now, until - run.now.time), end);
        if (report.refusal != Refusal::none) {
            now /= 2;
            REQUIRE(now > 1e-6 * h);
            continue;
        }
        std::swap(run.now, end);
        run.ledger.add(run.now, report);
        now = std::min(h, 1.5 * now);
        after_step();
    }
}

}  // namespace

TEST_CASE("E13 the broken set converges with the step") {
    describe("The edge-cracked block, 100 x 40 mm, at 1.5 mm, 1 MPa: points that are broken at 20 us, when the crack has just begun to run, with steps of .8, .4, .2 of the stable one, against .05 of it. "
             "Later the pattern is chaotic and another step is another sample.");
    const Mesh mesh = cracked_block({0.1, 0.04}, 0.05, 1.5e-3);
    const auto at_20_us = [&](double safety) {
        Run run(pulled(mesh, 3.08e6, 1e6));
        go(run, 20e-6, safety * run.stepper.stable_step());
        return std::pair{broken(run), run.ledger.row().surface};
    };
    on_path(both_explicit);
    const auto [reference, energy] = at_20_us(0.05);
    CHECK(reference.size() > mesh.interior_edges.size() / 100);
    for (const double safety : {0.8, 0.4, 0.2}) {
        const auto [set, surface] = at_20_us(safety);
        const std::string at = ", " + digits(safety) + " of the stable step";
        verify_small("part of the broken points that differs" + at, part_that_differs(set, reference), {0.05 * safety / 0.2});
        verify("surface energy over that of the reference" + at, surface / energy, 1, {0.01 * safety / 0.2});
    }
}

TEST_CASE("E17 it does not matter from where on a point counts as broken") {
    describe("A block of 40 x 20 mm with a crack of 15 mm is pulled apart to 16 us; after every step cohesion below a threshold is set to zero. The same points are broken with 1e-12 and 1e-6 as without.");
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        const bool is_explicit = path.bulk == BulkScheme::explicit_lumped;
        const Mesh mesh = cracked_block({0.04, 0.02}, 0.015, is_explicit ? 1e-3 : 2e-3);
        std::set<Index> reference;
        for (const double threshold : {0.0, 1e-12, 1e-6}) {
            Run run(pulled(mesh, 8e6, 4e6), path), stable(pulled(mesh, 8e6, 4e6));
            const double h = (is_explicit ? 0.8 : 2) * stable.stepper.stable_step();
            go(run, 16e-6, h, [&] {
                for (PointState& point : run.now.points)
                    if (point.cohesion < threshold) point.cohesion = 0;
            });
            if (threshold == 0) {
                reference = broken(run);
                CHECK(reference.size() > 30);
            } else {
                verify_at_most("part of the broken points that differs, threshold " + digits(threshold), part_that_differs(broken(run), reference), 0);
            }
        }
    }
}
