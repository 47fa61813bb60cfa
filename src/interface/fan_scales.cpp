#include "interface/fan_scales.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double relative_tolerance = 1e-12;  // of the largest impulse, or speed

}  // namespace

FanScales scales_of(const FanProblem& problem) {
    double impulse = 0, speed = 0, mass = 0;
    for (const FanBody& body : problem.bodies) {
        const Vec2 m = body.mass();
        impulse = std::max(impulse, m.cwiseProduct(body.free_velocity - body.velocity).cwiseAbs().maxCoeff());
        speed = std::max({speed, body.free_velocity.cwiseAbs().maxCoeff(), body.velocity.cwiseAbs().maxCoeff()});
        mass = std::max(mass, m.maxCoeff());
    }
    for (const FanLink& link : problem.links) {  // what an impact can give, and how fast the cohesion can make its bodies
        const Vec2 w = problem.inverse_mass(link.after) + problem.inverse_mass(link.before);
        const Vec2 approach = (problem.free_velocity(link.after) - problem.free_velocity(link.before)).cwiseAbs();
        for (int k = 0; k < 2; ++k)
            if (w[k] > 0) impulse = std::max(impulse, approach[k] / w[k]);
        if (link.unbreakable) continue;
        impulse = std::max(impulse, link.cohesive);
        speed = std::max(speed, link.cohesive * w.maxCoeff());
    }
    // an impulse is a difference of momenta: near their rounding nothing can be decided. All at rest and unloaded: any unit will do
    impulse += 0.01 * mass * speed;
    if (impulse == 0) impulse = 1;
    if (speed == 0) speed = 1;
    return {.impulse = impulse,
            .speed = speed,
            .impulse_tolerance = relative_tolerance * impulse,
            .speed_tolerance = relative_tolerance * speed,
            .rest = relative_tolerance * speed};
}

}  // namespace knap
