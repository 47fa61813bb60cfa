#include "stepper/explicit/vertex_obstacles.hpp"

namespace knap {

void VertexObstacles::begin(const ExplicitStep& step) {
    now_.motion.begin_explicit(step.begin, step.kick_time, step.drift_time, step.obstacle_damping);
    now_.contacts.find(step.begin, step.drift_time, now_.motion.rate(), step.corner_force);
    now_.pairs.find(step.begin, step.drift_time, now_.motion.rate());
    now_.gives.clear();
    for (const ObstacleContact& contact : now_.contacts.all())
        if (!now_.rebounds.is_idle())
            now_.gives.push_back(now_.rebounds.find(contact, now_.contacts.law_of(contact, step.begin), step.begin));
    now_.impulse.assign(now_.contacts.all().size(), Vec2::Zero());
}

void VertexObstacles::finish(const ExplicitStep& step, const VertexContacts* contacts, StepReport& report) {
    const State& begin = step.begin;
    for (const ObstacleContact& contact : now_.contacts.all()) {
        const Vec2 rate = contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }) -
                          velocity_at(begin.obstacles[contact.obstacle].velocity, contact);
        report.add_approach(contact.gap, step.drift_time, contact.normal.dot(rate),
                            begin.obstacles[contact.obstacle].pose.position + contact.arm);
    }
    for (const ObstaclePairContact& at : now_.pairs.all()) {
        const Vec2 rate = velocity_at(at.velocity(1, begin), at.arm[1]) - velocity_at(at.velocity(0, begin), at.arm[0]);
        report.add_approach(at.gap, step.drift_time, at.normal.dot(rate), at.place(begin));
    }
    now_.rebounds.report_lack(report);
    now_.contacts.sum_wrenches([&](std::size_t i) -> const Vec2& { return now_.impulse[i]; }, wrench_);
    if (contacts) contacts->add_wrenches(wrench_);
    now_.motion.finish(begin, wrench_, step.end, report);
}

}  // namespace knap
