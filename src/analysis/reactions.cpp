#include "analysis/reactions.hpp"

#include <algorithm>

namespace knap {

Reactions::Reactions(const Model& model) : model_(model) {
    // every load has a history of its own, whose number is that of the load
    for (const PrescribedMotion& motion : model.prescribed)
        for (int k = 0; k < 2; ++k)
            if (motion.component[k]) loads_.push_back(motion.history[k]);
    std::ranges::sort(loads_);
    loads_.erase(std::unique(loads_.begin(), loads_.end()), loads_.end());
    renew();
    std::vector<int> n_held(loads_.size(), 0);
    for (const Held& held : held_) ++n_held[held.place];
    places_.assign(loads_.size(), Vec2::Zero());
    for (const Held& held : held_) places_[held.place] += model.mesh.corner(held.corner) / n_held[held.place];
    for (const Obstacle& obstacle : model.obstacles) places_.push_back(obstacle.start.position);
    largest_forces_.assign(places_.size(), 0.0);
}

void Reactions::sum_forces(const State& state, std::vector<Vec2>& forces) const {
    forces.assign(loads_.size(), Vec2::Zero());
    for (auto held = held_.begin(); held != held_.end();) {
        const Index place = held->place;
        double x = 0, y = 0;  // in registers: a load may hold every corner of the body
        for (; held != held_.end() && held->place == place; ++held) {
            const Index motion = model_.prescribed_of_corner[held->corner];
            if (motion < 0) continue;  // it was excavated
            if (held->component == 0) x += state.reaction[motion].x();
            else y += state.reaction[motion].y();
        }
        forces[place] = {x, y};
    }
    for (const ObstacleState& obstacle : state.obstacles) forces.push_back(-obstacle.reaction.head<2>());
}

void Reactions::after_step(const State& state) {
    sum_forces(state, forces_);
    for (std::size_t i = 0; i < forces_.size(); ++i)
        largest_forces_[i] = std::max(largest_forces_[i], forces_[i].norm());
}

void Reactions::renew() {
    held_.clear();
    for (Index corner = 0; corner < model_.mesh.n_corners(); ++corner) {
        const PrescribedMotion* motion = model_.motion_of(corner);
        for (int k = 0; motion && k < 2; ++k) {
            if (!motion->component[k]) continue;
            const auto at = std::ranges::lower_bound(loads_, motion->history[k]);
            held_.push_back({static_cast<Index>(at - loads_.begin()), corner, k});
        }
    }
    std::ranges::stable_sort(held_, {}, &Held::place);
}

std::vector<Reaction> Reactions::at(const State& state) const {
    std::vector<Vec2> forces;
    sum_forces(state, forces);
    std::vector<Reaction> found(loads_.size(), {Vec2::Zero(), Vec2::Zero()});
    std::vector<Eigen::Vector2i> n_held(loads_.size(), Eigen::Vector2i::Zero());
    for (const auto& [place, corner, k] : held_) {
        if (model_.prescribed_of_corner[corner] < 0) continue;  // it was excavated
        ++n_held[place][k];
        found[place].displacement[k] += state.displacement[state.node_of_corner[corner]][k];
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i].force = forces[i];
        for (int k = 0; k < 2; ++k)
            if (n_held[i][k] > 0) found[i].displacement[k] /= n_held[i][k];
    }
    for (const ObstacleState& obstacle : state.obstacles)
        found.push_back({forces[found.size()], obstacle.moved.head<2>(), -obstacle.reaction.z(), obstacle.moved.z(),
                         obstacle.velocity.head<2>(), obstacle.velocity.z()});
    return found;
}

std::span<const Measure<Reaction>> driver_columns() {
    using R = Reaction;
    static constexpr Measure<R> columns[] = {
        {"_force_x", "N",
         "force on the body of a load that prescribes a motion, or of an obstacle, x; mean over the last step",
         [](const R& r) { return r.force.x(); }},
        {"_force_y", "N", "the same force, y", [](const R& r) { return r.force.y(); }},
        {"_u_x", "m", "displacement x: mean over the corners with the prescribed motion, or of the obstacle",
         [](const R& r) { return r.displacement.x(); }},
        {"_u_y", "m", "the same displacement, y", [](const R& r) { return r.displacement.y(); }}};
    return columns;
}

std::span<const Measure<Reaction>> obstacle_columns() {
    using R = Reaction;
    static constexpr Measure<R> columns[] = {
        {"_moment", "N m", "moment on the body about the reference point of the obstacle, mean over the last step",
         [](const R& r) { return r.moment; }},
        {"_angle", "rad", "angle by which the obstacle has turned", [](const R& r) { return r.angle; }},
        {"_v_x", "m/s", "velocity of the obstacle, x", [](const R& r) { return r.velocity.x(); }},
        {"_v_y", "m/s", "velocity of the obstacle, y", [](const R& r) { return r.velocity.y(); }},
        {"_spin", "rad/s", "angular velocity of the obstacle", [](const R& r) { return r.spin; }}};
    return columns;
}

std::vector<std::string> reaction_columns(const std::vector<std::string>& loads,
                                          const std::vector<std::string>& obstacles) {
    std::vector<std::string> names{"time"};
    const auto add = [&](const std::vector<std::string>& drivers, std::span<const Measure<Reaction>> columns) {
        for (const std::string& driver : drivers)
            for (const std::string& name : names_of(columns, driver)) names.push_back(name);
    };
    add(loads, driver_columns());
    add(obstacles, driver_columns());
    add(obstacles, obstacle_columns());
    return names;
}

std::vector<std::string> Reactions::names() const {
    std::vector<std::string> names;
    for (const Index load : loads_) names.push_back(model_.load_names[load]);
    for (const Obstacle& obstacle : model_.obstacles) names.push_back(obstacle.name);
    return names;
}

std::vector<std::string> Reactions::columns() const {
    const std::vector<std::string> all = names();
    const auto obstacles = all.begin() + static_cast<std::ptrdiff_t>(loads_.size());
    return reaction_columns({all.begin(), obstacles}, {obstacles, all.end()});
}

std::vector<double> Reactions::line(const State& state) const {
    std::vector<double> row{state.time};
    const std::vector<Reaction> all = at(state);
    for (const Reaction& reaction : all) add_values(driver_columns(), reaction, row);
    for (std::size_t i = loads_.size(); i < all.size(); ++i) add_values(obstacle_columns(), all[i], row);
    return row;
}

}  // namespace knap
