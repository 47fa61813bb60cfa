// Friction over pressure and over slip along joints of many vertices: straight, bent, turning, and as free faces.
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/sheared_joint.hpp"

#include <doctest/doctest.h>

#include <map>

namespace changing_friction_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Steep below half the pressure of the joint, flat from it on: what presses on half of the area rubs by 0.71 of what
/// presses on all of it.
CohesiveLaw bent_friction() {
    CohesiveLaw law{.sigma_c = infinity};
    law.over_pressure = std::make_shared<FrictionOverPressure>(std::vector<Vec2>{
        {0, 0}, {0.5 * joint_pressure, 0.3 * joint_pressure}, {2 * joint_pressure, 0.36 * joint_pressure}});
    law.friction = law.over_pressure->chord(joint_pressure);
    return law;
}

const FanPoint& fan_point(const Run& run, Index point) { return run.model.fan_points[run.model.fan_point_of[point]]; }
double area_of(const Run& run, Index point) { return fan_point(run, point).area; }
std::vector<Index> cracked_points(const Run& run) {
    std::vector<Index> points;
    for (const FanPoint& at : run.model.fan_points)
        if (at.cracked) points.push_back(at.point);
    return points;
}

/// [N] Friction along the joint, of points and of free faces, in the last step.
double friction_of(const Run& run) {
    double sum = 0;
    for (const Index point : cracked_points(run))
        if (!run.now.has_retired(point))
            sum += area_of(run, point) * std::abs(state_of(run.model, run.now, point)->traction.y());
    for (const FaceContactState& at : run.now.face_contacts) sum += std::abs(at.tangential) / run.now.last_step;
    return sum;
}

/// [N] f of the pressure of every vertex of the joint, over its area.
double threshold_of(const Run& run) {
    std::map<Index, double> force, area;  // per fan
    for (const Index point : cracked_points(run)) {
        const Index fan = run.model.fan_of_corner[fan_point(run, point).corner()];
        force[fan] += area_of(run, point) * state_of(run.model, run.now, point)->traction.x();
        area[fan] += area_of(run, point);
    }
    double sum = 0;
    for (const auto& [fan, S] : area) sum += S * (*run.model.laws[0].over_pressure)(force[fan] / S);
    return sum;
}

struct Means {
    double friction = 0, threshold = 0;  // [N]
};

/// Over the steps from the time 1.2 to 1.6, in which the joint slides.
Means means_of(const ShearedJoint& joint, const SchemeOptions& scheme) {
    Run run(sheared_joint(joint), scheme);
    const double h = scheme.bulk == BulkScheme::implicit_theta ? 0.02 : 0.8 * run.stepper.stable_step();
    Means sum;
    int n = 0;
    while (run.now.time < 1.6) {
        REQUIRE(run.step(h).rejection == Rejection::none);
        if (run.now.time < 1.2) continue;
        sum.friction += friction_of(run), ++n;
        if (!joint.contact) sum.threshold += threshold_of(run);
    }
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
    return {sum.friction / n, sum.threshold / n};
}

}  // namespace

TEST_CASE("friction over pressure of a joint is that of the pressure of its vertices whether it is bent or turns") {
    for (const SchemeOptions& path : both_paths())
        for (const bool large : {false, true})
            for (const double sagitta : {0.0, 0.2}) {
                on_path(path);
                CAPTURE(large);
                CAPTURE(sagitta);
                ShearedJoint joint{.sagitta = sagitta,
                                   .shear = 0.42 * joint_pressure,
                                   .contact = false,
                                   .large_rotation = large,
                                   .law = bent_friction()};
                const Means without = means_of(joint, path);
                CHECK(without.friction == relative(without.threshold, 1e-5));
                if (!large) continue;
                // its points retire: vertices press on faces
                joint.contact = true;
                const Means with = means_of(joint, path);
                CHECK(with.friction == relative(without.friction, 0.03));
            }
}

TEST_CASE("a sliding joint has the friction of the mean pressure where viscosity damps it and says what may flutter") {
    struct Case {
        double viscosity, theta;  // theta of implicit steps; 0: explicit ones
        std::array<double, 2> lack;
    };
    for (const auto& [viscosity, theta, expected] :
         {Case{0, 0, {0.03, 0.5}}, {0.3, 0, {0, 0.01}}, {0, 1, {0, 0.001}}}) {
        CAPTURE(viscosity);
        CAPTURE(theta);
        ModelInput input = sheared_joint(
            {.shear = 0.5 * joint_pressure, .contact = false, .large_rotation = false, .law = bent_friction()});
        input.materials[0].shear_viscosity = viscosity;
        SchemeOptions scheme = theta > 0 ? both_implicit : both_explicit;
        if (theta > 0) scheme.theta = theta;
        Run run(std::move(input), scheme);
        const double h = theta > 0 ? 0.02 : 0.8 * run.stepper.stable_step();
        std::map<Index, double> pressure;
        double friction = 0, work = 0, slip = 0;
        int n = 0;
        while (run.now.time < 4) {
            const StepReport report = run.step(h);
            REQUIRE(report.rejection == Rejection::none);
            work += report.fluttering_work, slip += report.fluttering_slip;
            if (run.now.time < 2) continue;
            friction += friction_of(run), ++n;
            for (const Index point : cracked_points(run))
                pressure[point] += state_of(run.model, run.now, point)->traction.x();
        }
        double of_mean = 0;
        for (const auto& [point, sum] : pressure)
            of_mean += area_of(run, point) * (*run.model.laws[0].over_pressure)(sum / n);
        const double lack = 1 - friction / n / of_mean;
        CHECK(lack > expected[0] - 1e-9);
        CHECK(lack < expected[1]);
        CHECK(-work == relative(theta > 0 ? 0 : run.ledger.row().friction_work, 1e-9));
        CHECK(work <= 0.34 * slip);
        CHECK(work >= 0.25 * slip);
    }
}

TEST_CASE("a joint that weakens by slip keeps the friction of its slip when its sides meet as free faces") {
    const CohesiveLaw weakens{.sigma_c = infinity, .friction = 0.4, .kinetic_friction = 0.1, .slip_distance = 0.06};
    Run run(sheared_joint({.shear = 0.5 * joint_pressure, .law = weakens}));
    const double h = 0.8 * run.stepper.stable_step();
    double found = 0;
    int n = 0;
    while (run.now.time < 3) {
        REQUIRE(run.step(h).rejection == Rejection::none);
        if (run.now.time >= 2.5) found += friction_of(run), ++n;
    }
    CHECK(std::ranges::count(run.now.retired, Retirement::retired) == 24);
    CHECK(found / n == relative(0.1 * joint_pressure * 12, 0.02));  // of the length 12
    CHECK(run.ledger.largest_residual() <= 1e-12 * run.ledger.largest_energy());
}

}  // namespace changing_friction_test
