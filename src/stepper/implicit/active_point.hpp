#pragma once
#include "interface/point_law.hpp"

#include <vector>

namespace knap {

/// A point of a active fan in the equations of a step.
struct ActivePoint {
    Index fan;            // into Model::fans; points of a fan stand together. -1: a contact with an obstacle, which stands for the support and moves
    Index fan_point;      // into Model::fan_points, or -1 likewise
    Index before, after;  // nodes, or -1: support
    Vec2 normal;
    Index leaf_corner = -1;           // of a contact: a corner of the triangle that it belongs to
    Vec2 support_rate = Vec2::Zero();  // [m/s] (N, T) of the obstacle
    Index beside = -1;                // of a contact between two corners: the node of the second one, and its share
    double share = 0;
    PointLaw law;
    PointResponse response;
    Vec2 rate = Vec2::Zero();  // [m/s] (w_N, w_T)
    double mass;               // [kg] what an impulse between the two sides moves: the scale between impulses and rates

    Vec2 in_frame(const Vec2& a) const { return {normal.dot(a), turned_left(normal).dot(a)}; }
    /// (N, T) of what a field of the nodes does between the two sides.
    Vec2 across(const std::vector<Vec2>& of_node) const {
        const auto at = [&](Index node) -> Vec2 { return node < 0 ? Vec2::Zero() : of_node[node]; };
        if (beside >= 0) return in_frame((1 - share) * at(after) + share * at(beside) - at(before));
        return in_frame(at(after) - at(before));
    }
    /// [m/s] (w_N, w_T)
    Vec2 rate_at(const std::vector<Vec2>& rate) const { return across(rate) - support_rate; }
    /// Its sides move as one.
    bool holds_still() const { return response.closed && response.sticks && law.contact.rate == 0 && response.kink == 0; }
    Vec2 impulse() const { return response.normal(law) * normal + response.tangential * turned_left(normal); }  // [N s] q
};

}  // namespace knap
