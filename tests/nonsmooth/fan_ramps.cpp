// Fans with secant unloading whose links pass kappa within the step, and such on stiff ramps.
#include "nonsmooth/fan_ramps.hpp"

#include "support/fan_judge.hpp"
#include "support/random_fans.hpp"

#include <doctest/doctest.h>

namespace fan_ramps_test {

using namespace knap;
using namespace knap::tests;

namespace {

FanBody body(double v_x, double v_y, double free_x, double free_y, double w) {
    return {.velocity = {v_x, v_y}, .free_velocity = {free_x, free_y}, .inverse_mass = {w, w}};
}

/// Without friction and restitution, gamma = 1; kappa = 0: cohesion of an intact point, without a ramp.
FanLink link(Index before, Index after, const Vec2& normal, const Vec2& u, double cohesive, double kappa,
             const Vec2& ramp_start, const Vec2& middle) {
    return {.before = before,
            .after = after,
            .normal = normal,
            .u_N = u.x(),
            .u_T = u.y(),
            .cohesive = cohesive,
            .gamma = 1,
            .friction = 0,
            .restitution = 0,
            .unbreakable = false,
            .ramp_start = ramp_start,
            .kappa = kappa,
            .middle = middle};
}

/// A vertex of edge_cracked_block (seed 2, 68 us): five slips come to zero together. The openings are rounded, so one of
/// them ends 6e-13 of the speed beyond its zero, on a ramp so stiff (kappa = 1e-12 m) that this is 1e-8 of its cohesion.
FanProblem slip_within_tolerance() {
    FanProblem fan;
    fan.closed = fan.has_ramps = true;
    fan.drift_time = 0x1.c381fab13b9f3p-25;
    fan.bodies = {body(-0x1.edf70c023c404p-6, 0x1.29cf0699abd92p-1, -0x1.04ca0809171bp-5, 0x1.249937247963fp-1,
                       0x1.c02e37a65ea99p+13),
                  body(-0x1.ed06d6adac645p-6, 0x1.29d52172b1e3p-1, -0x1.93e5eb5f0b034p-5, 0x1.27c1a4441ef97p-1,
                       0x1.92a4c801bcb02p+13),
                  body(-0x1.ed0ed5e4ba738p-6, 0x1.29d5bafa59511p-1, -0x1.38dcccf6f8774p-6, 0x1.2d2f4d5dfb5e9p-1,
                       0x1.89dc9e0158ccap+13),
                  body(-0x1.ed0ed5e4ba738p-6, 0x1.29d5bafa59511p-1, 0x1.af1077abad768p-7, 0x1.2fee5bff1d586p-1,
                       0x1.88dc0e7272e7bp+13),
                  body(-0x1.edf70c023c404p-6, 0x1.29cf0699abd92p-1, -0x1.08846e40dd17ap-6, 0x1.3b4929daa5e8cp-1,
                       0x1.cc05348792568p+13)};
    fan.links = {link(4, 0, {0x1.8eb57379e203ap-1, 0x1.413588d392c45p-1}, {0x0p+0, 0x0p+0}, 0x1.1f6eeba716bd9p-15,
                      0x0p+0, {0x0p+0, 0x0p+0}, {0x0p+0, 0x0p+0}),
                 link(0, 1, {-0x1.430ca318b4a5cp-1, 0x1.8d381ecb46b39p-1}, {-0x1.451e8ep-69, -0x1.0de250ad89ac2p-39},
                      0x1.11ea1937e97ffp-15, 0x1.0a849309f56b3p-36, {0x1.c9c8ce71fd70fp-21, -0x1.320aec387a406p-14},
                      {-0x1.45a57a5769f65p-69, 0x1.93b29e2c789p-46}),
                 link(1, 2, {-0x1.d89c3aac441e5p-1, -0x1.89dee64fa8cfep-2}, {0x1.483a2058p-68, -0x1.21f5f39cb8c33p-43},
                      0x1.4dad2cfe704ap-15, 0x1.1e581b52307abp-40, {0x1.ebd7acefd2033p-25, -0x1.48cf28c7c6cbap-18},
                      {0x1.483dde6b772ccp-68, 0x1.b1bab360e3p-50}),
                 link(2, 3, {-0x1.75454952c9a33p-2, -0x1.dcc58e3c74788p-1}, {0x0p+0, 0x0p+0}, 0x1.753ff874df5e8p-15,
                      0x0p+0, {0x0p+0, 0x0p+0}, {0x0p+0, 0x0p+0}),
                 link(3, 4, {0x1.5b73e4f4485d3p-1, -0x1.780f2fa4a5404p-1}, {-0x1.3f532ap-69, -0x1.13944c0a6c367p-39},
                      0x1.0b7985fe85496p-15, 0x1.10245f1a70f91p-36, {0x1.d371e64b2898ep-21, -0x1.38803e1ea092p-14},
                      {-0x1.3fe5b3f173019p-69, 0x1.9c37846c98bp-46})};
    return fan;
}

/// Another (61 us): five ramps with kappa from 5e-15 to 2e-13 m. Ratios of the path of Lemke's method differ by 6e-13.
FanProblem ramps_nearly_rigid() {
    FanProblem fan;
    fan.closed = fan.has_ramps = true;
    fan.drift_time = 0x1.c381fab13b9f3p-25;
    fan.bodies = {body(-0x1.f8c2a2496e4afp-4, 0x1.09137ce7cce57p-1, -0x1.1ab0e3851e02fp-3, 0x1.180d026437b16p-1,
                       0x1.08d24986d2d85p+14),
                  body(-0x1.f8c2a4485d71dp-4, 0x1.0913804e84c93p-1, -0x1.c2a0220a73b5p-4, 0x1.15773ccaa024bp-1,
                       0x1.9f02d1114f022p+13),
                  body(-0x1.f8c445770b204p-4, 0x1.091384245a308p-1, -0x1.e2179ecb63243p-4, 0x1.ecca2c4831f65p-2,
                       0x1.fb2ba88f25d7dp+13),
                  body(-0x1.f8c307430fd19p-4, 0x1.09140ef66b6d1p-1, -0x1.383f4af53de83p-3, 0x1.eddcab2cfab6cp-2,
                       0x1.f9f6b44172f67p+13),
                  body(-0x1.f8bee1c27069bp-4, 0x1.0913c71e67bc8p-1, -0x1.4e555842749p-3, 0x1.11b21b2497504p-1,
                       0x1.46251811fe92cp+14)};
    fan.links = {link(4, 0, {-0x1.0d32544cbdcfdp-1, 0x1.b384faaa25361p-1}, {0x1.376fb0ep-69, 0x1.d3e2444d27b2dp-44},
                      0x1.e08c1cd35e19p-16, 0x1.42cb8e74581bap-43, {0x1.104079f8508f8p-22, 0x1.0948fb4fcccfep-18},
                      {0x1.3765814bedb74p-69, -0x1.e02bbe82b595p-48}),
                 link(0, 1, {-0x1.fea0d29e79b3p-1, -0x1.2ba27ae06693p-4}, {-0x1.31cf2cc7ep-70, -0x1.8494858faa427p-49},
                      0x1.38abfa60e7a6dp-15, 0x1.691fe106f6774p-48, {0x1.07320e1346fd4p-30, -0x1.b8a43940bbc83p-24},
                      {-0x1.31c8cc16b3c17p-70, -0x1.d03c5f2209e8p-56}),
                 link(1, 2, {0x1.a35903579669ep-5, -0x1.ff542809789b7p-1},
                      {0x1.461725595ad25p-48, -0x1.7385e4b1ed9bdp-45}, 0x1.0fff3057ff8b8p-15, 0x1.1369de049362p-42,
                      {0x1.2d5a822025d52p-21, -0x1.a54c8fbfd8e55p-20}, {0x1.5a76355205f3cp-47, -0x1.5fdacf686534p-51}),
                 link(2, 3, {0x1.ec31e46882347p-1, -0x1.1a0d0d02b01aap-2}, {0x1.51f3e71p-69, 0x1.fedf21bd93da9p-44},
                      0x1.0e681437ab767p-15, 0x1.3da9f9e760b75p-45, {0x1.b101a944cf509p-27, 0x1.21a89f00b5bd4p-18},
                      {0x1.5218d56331dc3p-69, 0x1.7dd79182976p-52}),
                 link(3, 4, {0x1.d3db1045a4abdp-2, 0x1.c76f8fcdb6997p-1}, {0x1.05809dep-70, -0x1.f19ddeaf58ec6p-44},
                      0x1.06eac67f16844p-15, 0x1.35bf64a709d75p-43, {0x1.a213b5c3d7642p-22, -0x1.1a24ada470a0bp-18},
                      {0x1.729191e6471bcp-49, 0x1.140a18c3135p-47})};
    return fan;
}

/// The ramp of a link that has been opened to kappa, as the explicit scheme gives it with constant steps.
void put_on_ramp(const FanProblem& fan, double kappa, FanLink& link) {
    const double h = fan.drift_time;
    const Vec2 rate = fan.velocity_before(link.after) - fan.velocity_before(link.before), u(link.u_N, link.u_T),
               half = 0.5 * h * Vec2(link.normal.dot(rate), link.tangent().dot(rate));
    link.kappa = kappa;
    link.restitution = 0;
    link.middle = u - half;
    link.ramp_start = 2 / h * Vec2(2 * u.x() - half.x() + link.gamma * std::abs(link.middle.y()), u.y());
}

/// Where no part that is borne is the quotient of the changes of energy and opening (fan_ramps.hpp) at an opening
/// nearer than `reach` [m] to the one found: the largest distance of such a part [-].
double distance_from_energy(const SolvedFan& fan, double reach) {
    const double h = fan.problem.drift_time;
    double worst = 0;
    for (std::size_t i = 0; i < fan.problem.links.size(); ++i) {
        const FanLink& link = fan.problem.links[i];
        if (link.kappa == 0 || link.cohesive == 0) continue;
        const Vec2 rate = fan.result.across(link);
        const double opened = std::max(link.middle.x(), 0.0) + link.gamma * std::abs(link.middle.y()),
                     slip = link.gamma *
                            (std::abs(link.middle.y()) + std::abs(link.u_T + 0.5 * h * link.tangent().dot(rate))),
                     twice = link.u_N + link.middle.x() + 0.5 * h * link.normal.dot(rate) + slip;  // s- + s+
        const auto energy = [&](double s) {
            return s <= 0 ? 0 : s <= link.kappa ? 0.5 * s * s / link.kappa : s - 0.5 * link.kappa;
        };
        const auto part_at = [&](double s) {
            if (s <= link.kappa || opened >= link.kappa) return std::clamp(0.5 * (s + opened) / link.kappa, 0.0, 1.0);
            return (energy(s) - energy(opened)) / (s - opened);
        };
        const double end = twice - opened, part = fan.result.links[i].cohesive_impulse / link.cohesive;
        worst = std::max({worst, part_at(end - reach) - part, part - part_at(end + reach)});
    }
    return worst;
}

}  // namespace

TEST_CASE("ramps of secant unloading: vertices that were not solved") {
    for (const FanProblem& problem : {slip_within_tolerance(), ramps_nearly_rigid()}) {
        SolvedFan fan{problem, {}};
        for (FanLink& link : fan.problem.links) link.set_ramp(problem.drift_time);
        FanSolver solver;
        const FanSolution solution = solve_on_ramps(fan, solver);
        CHECK(solution.residual <= 1e-12);
        const FanJudge judge(fan.problem, fan.result);
        CHECK(judge.verdict().worst() <= 1e-11);
        CHECK(distance_from_energy(fan, 1e-11 * judge.speed_scale() * problem.drift_time) <= 1e-12);
    }
}

TEST_CASE("ramps of secant unloading: random links that pass kappa bear the quotient of energy and opening") {
    FanSolver solver;
    int n_passing = 0;
    for (int seed = 0; seed < 3000; ++seed) {
        SolvedFan fan{RandomFan(seed, {.friction = false, .prescribed = false}).problem(), {}};
        FanProblem& problem = fan.problem;
        Random random(seed, "kappa");
        const double step = FanJudge(problem, fan.result).speed_scale() * problem.drift_time;
        for (FanLink& link : problem.links) {
            if (link.cohesive == 0 || random.uniform() < 0.2) continue;
            put_on_ramp(problem, 0, link);
            const double opened = std::max(link.middle.x(), 0.0) + link.gamma * std::abs(link.middle.y());
            link.kappa = opened * (1 + random.uniform()) + step * std::pow(10, random.uniform(-6, 0));
            // what softens is at its largest opening but for rounding
            if (const double draw = random.uniform(); opened > 0 && draw < 0.4)
                link.kappa = std::nextafter(opened, draw < 0.2 ? 0.0 : 1.0);
            link.set_ramp(problem.drift_time);
            problem.has_ramps = true;
        }
        const FanSolution solution = solve_on_ramps(fan, solver);
        const double distance = distance_from_energy(fan, 1e-10 * step);
        CHECK_MESSAGE(std::max(solution.residual, distance) <= 1e-10, "seed ", seed);
        for (const FanLink& link : problem.links) n_passing += link.ramp_shift != 0;
    }
    CHECK(n_passing > 1000);
}

}  // namespace fan_ramps_test
