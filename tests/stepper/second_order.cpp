// Triangles of second order: nothing of the method changes, the bulk bends.
#include "analysis/interface_graph.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace second_order_test {

using namespace knap;
using namespace knap::tests;

namespace {

const Elastic glass{.density = 2450, .E = 32e9, .nu = 0.2};

ModelInput plate(Mesh mesh, const CohesiveLaw& law, Index order = 2) {
    ModelInput input = body_with(std::move(mesh), glass, law);
    input.plane = PlaneModel::stress;
    input.mesh.order = order;
    return input;
}

Model all_split(ModelInput input) {
    Model model = make_model(std::move(input));
    for (Fan& fan : model.fans) fan.split_at_start = fan.n_points > 0;
    return model;
}

CohesiveLaw strong() { return {.sigma_c = 1e12, .G_c = 1e9, .gamma = 1, .friction = 0.5}; }

template <class Field>
void set_displacement(Run& run, const Field& field) {
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        run.now.displacement[run.now.node_of_corner[c]] = field(run.model.mesh.corner(c));
}

/// [m] largest distance from a displacement field.
template <class Field>
double distance(const Run& run, const Field& field) {
    double worst = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        worst =
            std::max(worst, (run.now.displacement[run.now.node_of_corner[c]] - field(run.model.mesh.corner(c))).norm());
    return worst;
}

/// Pure bending of a strip of height 1 in plane stress: sigma_xx = E curvature (y - 1/2), nothing else.
struct Bending {
    double curvature;
    Vec2 operator()(const Vec2& x) const {
        const double y = x.y() - 0.5;
        return curvature * Vec2(x.x() * y, -0.5 * x.x() * x.x() - 0.5 * glass.nu * y * y);
    }
};

/// A strip with both ends held in the shape of pure bending; with `skew` its mesh is irregular.
ModelInput bent_strip(const CohesiveLaw& law, Index order, bool skew) {
    Mesh mesh = bar_mesh(6, 2, 3, 1);
    for (std::size_t i = 0; i < mesh.vertices.size() && skew; ++i) {
        Vec2& x = mesh.vertices[i];
        if (x.x() > 0 && x.x() < 3) x.x() += 0.1 * std::sin(3.0 * static_cast<double>(i));
        if (x.y() == 0.5) x.y() += 0.1 * std::cos(2.0 * static_cast<double>(i));
    }
    ModelInput input = plate(mesh, law, order);
    for (const char* side : {"left", "right"}) input.loads.push_back(load(Load::Kind::velocity, side, 0.0, 0.0));
    return input;
}

}  // namespace

TEST_CASE("second order: E1 with all edges cohesive a wave runs as in the body without edges") {
    ModelInput whole = plate(bar_mesh(6, 6, 1, 1), CohesiveLaw::unbreakable()),
               cohesive = plate(bar_mesh(6, 6, 1, 1), strong());
    whole.loads = cohesive.loads = {load(Load::Kind::traction, "left", 1e6, 3e5)};
    Run reference(whole), bound(cohesive), split(all_split(cohesive));
    CHECK(static_cast<Index>(split.now.displacement.size()) == split.model.mesh.n_corners());
    const double h = 0.5 * reference.stepper.stable_step();
    for (int i = 0; i < 200; ++i) reference.step(h), bound.step(h), split.step(h);
    CHECK(reference.ledger.row().external_work > 0);
    CHECK(bound.now.split_fans.empty());
    double largest = 0, bound_apart = 0, split_apart = 0;
    for (Index c = 0; c < reference.model.mesh.n_corners(); ++c) {
        const Vec2 u = reference.now.displacement[reference.now.node_of_corner[c]];
        largest = std::max(largest, u.norm());
        bound_apart = std::max(bound_apart, (u - bound.now.displacement[bound.now.node_of_corner[c]]).norm());
        split_apart = std::max(split_apart, (u - split.now.displacement[split.now.node_of_corner[c]]).norm());
    }
    CHECK(bound_apart == 0);
    CHECK(split_apart <= 1e-11 * largest);
    CHECK(split.ledger.worst().fan_fallbacks == 0);
    CHECK(split.ledger.largest_residual() <= 1e-11 * split.ledger.largest_energy());
}

TEST_CASE("second order: pure bending is at rest with all edges cohesive") {
    // its displacement is quadratic, so the patch test of these triangles; those of first order do not pass it
    const Bending bending{1e-4};
    for (const Index order : {2, 1}) {
        Run run(all_split(bent_strip(strong(), order, true)));
        set_displacement(run, bending);
        const double h = 0.5 * run.stepper.stable_step();
        for (int i = 0; i < 500; ++i) run.step(h);
        const double moved = distance(run, bending) / bending.curvature;
        if (order == 2) CHECK(moved <= 1e-11);
        else CHECK(moved > 1e-2);
        CHECK(run.ledger.row().surface() == 0);
    }
}

TEST_CASE("second order: a bent strip breaks when its outer fibre reaches the strength") {
    // forces of a linear traction on a quadratic edge are those of Simpson's points, so the outermost point has the
    // stress of the fibre
    const CohesiveLaw law{.sigma_c = 1e6, .G_c = 3, .gamma = 1, .friction = 0.5};
    for (const double level : {0.999, 1.001}) {
        const Bending bending{level * law.sigma_c / (0.5 * glass.E)};
        Run run(bent_strip(law, 2, false));
        set_displacement(run, bending);
        const double h = 0.5 * run.stepper.stable_step();
        for (int i = 0; i < 200 && run.now.split_fans.empty(); ++i) run.step(h);
        CHECK(run.now.split_fans.empty() == (level < 1));
        if (level < 1) CHECK(distance(run, bending) <= 1e-10 * bending.curvature);
        for (const Index f : run.now.split_fans)  // the fibre that is pulled
            CHECK(run.model.mesh.corner(run.model.fan_corners[run.model.fans[f].first_corner]).y() == 1);
    }
}

TEST_CASE("second order: both paths break a plate with the energy identity to rounding") {
    const CohesiveLaw law{.sigma_c = 1e6, .G_c = 3, .gamma = 1, .friction = 0.3};
    for (const bool implicit : {false, true}) {
        ModelInput input = plate(bar_mesh(4, 3, 0.15, 0.1), law);
        input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0, .glued = true}};
        input.loads = {load(Load::Kind::velocity, "top", 0.02, 0.1, {{0, 1e-4, 2e-4}, {0, 1, -1}})};
        SchemeOptions scheme;
        if (implicit)
            scheme = {.bulk = BulkScheme::implicit_theta,
                      .cohesion = CohesionScheme::implicit_beta,
                      .mass = MassMatrix::consistent};
        Run run(input, scheme);
        const double h = implicit ? 1e-6 : 0.8 * run.stepper.stable_step();
        while (run.now.time < 3.5e-4) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
        }
        const EnergyLedger& ledger = run.ledger;
        CHECK(ledger.largest_residual() <= 1e-10 * ledger.largest_energy());
        CHECK(ledger.worst().worst_impact_work <= 1e-12 * ledger.largest_energy());
        CHECK(ledger.worst().worst_friction_work <= 1e-12 * ledger.largest_energy());
        CHECK(ledger.worst().largest_beta_growth <= 0);
        CHECK(ledger.worst().residual <= 1e-10);
        const std::vector<InterfaceStatus> status = interface_status(run.model, run.now);
        CHECK(status.size() == 2 * run.model.interfaces.size());
        CHECK(std::count(status.begin(), status.end(), InterfaceStatus::broken) > 4);
        // G_c for every area that broke, and what is damaged
        double surface = 0;
        for (const FanPoint& at : run.model.fan_points) {
            const Vec2 u = opening(run.model, run.now, at.point);
            surface += at.area * law.surface_energy(cohesion(run.model, run.now, at.point), u.x(), u.y());
        }
        CHECK(ledger.row().surface() == relative(surface, 1e-9));
    }
}

TEST_CASE("second order: a body force and a traction move the body as a whole") {
    const Mesh mesh = bar_mesh(3, 2, 3, 2);
    ModelInput input = plate(mesh, strong());
    input.loads = {load(Load::Kind::acceleration, "", 2.0, -1.0), load(Load::Kind::traction, "right", 5e3, 1e3),
                   load(Load::Kind::body_force, "", 100, 300)};
    Run run(input);
    double mass = 0;
    for (const double m : run.model.corner_mass) mass += m;
    CHECK(mass == relative(6 * glass.density, 1e-13));
    Vec2 force = Vec2::Zero();
    for (const CornerLoad& each : run.model.corner_loads) force += each.force;
    const Vec2 expected = 6 * glass.density * Vec2(2, -1) + 2 * Vec2(5e3, 1e3) + 6 * Vec2(100, 300);
    CHECK((force - expected).norm() <= 1e-12 * expected.norm());
}

}  // namespace second_order_test
