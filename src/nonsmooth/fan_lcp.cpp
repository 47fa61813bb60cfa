#include "nonsmooth/fan_lcp.hpp"

namespace knap {

std::optional<double> FanLcp::solve(const FanProblem& problem, const std::vector<LinkState>& states, double speed,
                                    FanMotion& motion) {
    const std::vector<FanLink>& links = problem.links;
    clusters_.start(problem);
    for (const FanLink& link : links)
        if (link.unbreakable) clusters_.join(link, Vec2::Zero(), 0);
    clusters_.find_velocities({}, {}, 0);
    lcp_.clear();
    for (std::size_t i = 0; i < links.size(); ++i)
        if (!links[i].unbreakable) lcp_.add(i, links[i], states[i].law, clusters_.inverse_mass(links[i]).sum());
    const auto direction = [&](std::size_t i, int along) { return along == 0 ? links[i].normal : links[i].tangent(); };
    const auto response = [&](std::size_t i, int along, std::size_t j, int on) {
        return direction(i, along).dot(clusters_.response(links[i], links[j], direction(j, on)));
    };
    const auto free = [&](std::size_t i, int along) {
        double velocity = direction(i, along).dot(clusters_.across(links[i]));
        for (const FanLink& link : links)
            velocity += direction(i, along).dot(clusters_.response(links[i], link, -link.cohesive * link.normal));
        return velocity;
    };
    if (!lcp_.solve(speed, response, free)) return std::nullopt;

    for (std::size_t i = 0; i < links.size(); ++i) motion.impulse[i] = -links[i].cohesive * links[i].normal;
    lcp_.for_impulses([&](std::size_t i, int along, double part) { motion.impulse[i] += part * direction(i, along); });
    motion.cohesive_impulse.resize(links.size());
    for (std::size_t i = 0; i < links.size(); ++i) motion.cohesive_impulse[i] = links[i].cohesive;
    lcp_.for_lacks([&](std::size_t i, double lack) { motion.cohesive_impulse[i] -= lack; });
    for (std::size_t i = 0; i < links.size(); ++i) clusters_.apply(links[i], motion.impulse[i]);
    for (std::size_t b = 0; b < problem.bodies.size(); ++b)
        motion.velocity[b] = clusters_.velocity_of(static_cast<Index>(b));
    return lcp_.residual();
}

}  // namespace knap
