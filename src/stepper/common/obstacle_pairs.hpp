#pragma once
// Contact points of rigid obstacles with each other, of which at least one is free, and of free ones with supports, as
// they lie at the start of a step.
//
// An arc meets what is nearest to its centre. Two polygons meet at the side from which the other one is furthest
// (separating axis theorem), where the facing side of the other is clipped to the ends of this one; a polygon meets a
// half plane at its corners. Normals and arms are those of the middle of the step, so that what turns or slides does
// not sink in; the gap is that of its start.
#include "model/state.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace knap {

struct ObstaclePairContact {
    std::array<Index, 2> obstacle;  // -1: `support`
    std::array<Vec2, 2> arm;        // [m] from the origin of each to the one point of contact
    Vec2 normal;                    // out of the first
    double gap;                     // [m]
    double size;                    // [m] by which a corner of an obstacle counts as rounded in contacts with others
    const Obstacle* support = nullptr;

    /// [m/s, m/s, rad/s] Of one of them at the start of the step.
    Vec3 velocity(int k, const State& begin) const {
        return obstacle[k] < 0 ? Vec3(Vec3::Zero()) : begin.obstacles[obstacle[k]].velocity;
    }
    /// [m] Of the point of contact.
    Vec2 place(const State& begin) const {
        return obstacle[0] < 0 ? arm[0] : Vec2(begin.obstacles[obstacle[0]].pose.position + arm[0]);
    }
};

/// Of what both obstacles have there.
ContactLaw law_between(const Model& model, const ObstaclePairContact& contact, const State& begin);

class ObstaclePairs {
public:
    enum class Supports { pass, meet };
    ObstaclePairs(const Model& model, Supports supports = Supports::pass);

    /// All contacts that may close in a step of h [s]; `rate` [m/s, m/s, rad/s]: of the obstacles without contacts.
    void find(const State& begin, double h, const std::vector<Vec3>& rate);
    const std::vector<ObstaclePairContact>& all() const { return contacts_; }

private:
    const Model& model_;
    std::vector<Obstacle> supports_;
    std::vector<std::array<Index, 2>> pairs_;  // obstacles, and behind them supports
    std::vector<double> half_width_;           // [m] likewise
    std::vector<ObstaclePairContact> contacts_;
};

}  // namespace knap
