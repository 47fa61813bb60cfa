#include "analysis/reactions.hpp"

#include <algorithm>
#include <array>

namespace knap {

Reactions::Reactions(const Model& model) : model_(model) {
    // every load has a history of its own, so the history tells the load
    for (const PrescribedMotion& motion : model.prescribed)
        for (int k = 0; k < 2; ++k)
            if (motion.component[k]) loads_.push_back(motion.history[k]);
    std::sort(loads_.begin(), loads_.end());
    loads_.erase(std::unique(loads_.begin(), loads_.end()), loads_.end());
    n_held_.assign(loads_.size(), Eigen::Vector2i::Zero());
    for (Index corner = 0; corner < model.mesh.n_corners(); ++corner) {
        const Index i = model.prescribed_of_corner[corner];
        if (i < 0) continue;
        for (int k = 0; k < 2; ++k) {
            if (!model.prescribed[i].component[k]) continue;
            const auto at = std::lower_bound(loads_.begin(), loads_.end(), model.prescribed[i].history[k]);
            const Index place = static_cast<Index>(at - loads_.begin());
            held_.push_back({place, corner, k});
            ++n_held_[place][k];
        }
    }
    places_.assign(loads_.size(), Vec2::Zero());
    for (const Held& held : held_) places_[held.place] += model.mesh.corner(held.corner) / n_held_[held.place].sum();
    for (const Obstacle& obstacle : model.obstacles) places_.push_back(obstacle.start.position);
}

std::vector<Reaction> Reactions::at(const State& state) const {
    std::vector<Reaction> found(loads_.size(), {Vec2::Zero(), Vec2::Zero()});
    for (const Held& held : held_) {
        found[held.place].force[held.component] += state.reaction[model_.prescribed_of_corner[held.corner]][held.component];
        found[held.place].displacement[held.component] += state.displacement[state.node_of_corner[held.corner]][held.component];
    }
    for (std::size_t i = 0; i < found.size(); ++i)
        for (int k = 0; k < 2; ++k)
            if (n_held_[i][k] > 0) found[i].displacement[k] /= n_held_[i][k];
    for (const ObstacleState& obstacle : state.obstacles) found.push_back({-obstacle.reaction.head<2>(), obstacle.moved.head<2>()});
    return found;
}

std::span<const Output> driver_columns() {
    static constexpr std::array columns{Output{"_force_x", "N", "force on the body of a load that prescribes a motion, or of an obstacle; mean over the last step"},
                                        Output{"_force_y", "N", "likewise"},
                                        Output{"_u_x", "m", "displacement: mean over the corners that the load holds, or of the obstacle"},
                                        Output{"_u_y", "m", "likewise"}};
    return columns;
}

std::span<const Output> obstacle_columns() {
    static constexpr std::array columns{Output{"_moment", "N m", "moment on the body about the reference point of the obstacle, mean over the last step"},
                                        Output{"_angle", "rad", "by which the obstacle has turned"},
                                        Output{"_v_x", "m/s", "velocity of the obstacle"},
                                        Output{"_v_y", "m/s", "likewise"},
                                        Output{"_spin", "rad/s", "angular velocity of the obstacle"}};
    return columns;
}

std::vector<std::string> reaction_columns(const std::vector<std::string>& loads, const std::vector<std::string>& obstacles) {
    std::vector<std::string> names{"time"};
    const auto add = [&](const std::vector<std::string>& of, std::span<const Output> columns) {
        for (const std::string& name : of)
            for (const Output& column : columns) names.push_back(name + std::string(column.name));
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
    const auto first_obstacle = all.begin() + static_cast<std::ptrdiff_t>(loads_.size());
    return reaction_columns({all.begin(), first_obstacle}, {first_obstacle, all.end()});
}

std::vector<double> Reactions::line(const State& state) const {
    std::vector<double> row{state.time};
    for (const Reaction& reaction : at(state)) {
        row.insert(row.end(), {reaction.force.x(), reaction.force.y()});
        row.insert(row.end(), {reaction.displacement.x(), reaction.displacement.y()});
    }
    for (const ObstacleState& obstacle : state.obstacles)
        row.insert(row.end(), {-obstacle.reaction.z(), obstacle.moved.z(), obstacle.velocity.x(), obstacle.velocity.y(), obstacle.velocity.z()});
    return row;
}

}  // namespace knap
