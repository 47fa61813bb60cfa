#pragma once
// The nodes of an implicit step: which corners move as one, and which components of their motion are prescribed.
//
// A bonded fan is one node. An active fan has one node on each side of every interface that can break.
// (State keeps its own nodes: one per corner of every fan that has ever split.)
#include "model/model.hpp"

#include <cstdint>
#include <vector>

namespace knap {

/// [-] The weight of the motion of a node in a relative motion: the jump gains weight * motion, the node
/// transposed(weight) * force.
inline double transposed(double weight) { return weight; }
inline Eigen::Matrix2d transposed(const Eigen::Matrix2d& weight) { return weight.transpose(); }
/// What a matrix of the relative motion is between two nodes.
inline Eigen::Matrix2d between(double a, const Eigen::Matrix2d& block, double b) { return a * b * block; }
template <class A, class B>
Eigen::Matrix2d between(const A& a, const Eigen::Matrix2d& block, const B& b) {
    return transposed(a) * block * b;
}
/// [-] Of the motion along an axis, on average.
inline double squared(double weight) { return weight * weight; }
inline double squared(const Eigen::Matrix2d& weight) { return 0.5 * weight.squaredNorm(); }

/// The nodes on the two sides of an interface point; of a contact with an obstacle, which is `before` there; or of a
/// contact between faces: a vertex, `before`, and a point of an edge.
struct PointSides {
    Index fan_point;         // into Model::fan_points; -1: contact with an obstacle
    Index before, after;     // nodes; -1: the rigid support, or the obstacle
    Index second_node = -1;  // contact on an edge: the node of its second corner
    double share = 0;        // [-] of `second_node` in the motion of that contact
    Index leaf_corner = -1;  // contact: a corner of its triangle
    Index before_too = -1;   // another node at the vertex, which moves with the mean of both
    // [-] g/L t n' of a vertex at the gap g from its edge: the slip is that of the edge's motion where the vertex is,
    // so that friction has no moment (contact/face_contacts.hpp)
    Eigen::Matrix2d lever = Eigen::Matrix2d::Zero();

    /// visit(node, weight in the relative motion after - before): a number, or with a lever a matrix
    template <class Visit>
    void for_each_node(const Visit& visit) const {
        const auto visit_edge = [&](Index node, double weight, double sign) {
            if (node < 0) return;
            if (second_node < 0 || lever.isZero(0)) visit(node, weight);
            else visit(node, Eigen::Matrix2d(weight * Eigen::Matrix2d::Identity() + sign * lever));
        };
        visit_edge(after, 1 - share, 1);
        if (before >= 0) visit(before, before_too >= 0 ? -0.5 : -1.0);
        visit_edge(second_node, share, -1);
        if (before_too >= 0) visit(before_too, -0.5);
    }
    /// A force on `after`, and its reaction on `before`.
    void add_force(const Vec2& force, std::vector<Vec2>& of_node) const {
        for_each_node([&](Index node, const auto& weight) { of_node[node] += transposed(weight) * force; });
    }
    /// Adds what `block` makes of the relative motion to a matrix of nodal motions: an impulse per component.
    /// place(node): the rows, and columns, of its x and y, or -1.
    template <class Place, class Matrix>
    void add_block(const Eigen::Matrix2d& block, const Place& place, Matrix& matrix) const {
        for_each_node([&](Index a, const auto& weight_a) {
            const std::array<Index, 2> row = place(a);
            for_each_node([&](Index b, const auto& weight_b) {
                const std::array<Index, 2> column = place(b);
                const Eigen::Matrix2d part = between(weight_a, block, weight_b);
                for (int k = 0; k < 2; ++k)
                    for (int l = 0; l < 2; ++l)
                        if (row[k] >= 0 && column[l] >= 0) matrix(row[k], column[l]) += part(k, l);
            });
        });
    }
    Vec2 jump(const std::vector<Vec2>& of_node) const {
        const auto at = [&](Index node) -> Vec2 { return node < 0 ? Vec2::Zero() : of_node[node]; };
        const Vec2 vertex = before_too >= 0 ? Vec2(0.5 * (at(before) + at(before_too))) : at(before);
        if (second_node >= 0)
            return (1 - share) * at(after) + share * at(second_node) - vertex - lever * (at(second_node) - at(after));
        return at(after) - vertex;
    }
    bool operator==(const PointSides&) const = default;
};

struct CornerPartition {
    std::vector<std::uint8_t> active;   // [0/1] per fan: its interfaces may open in this step
    std::vector<Index> node_of_corner;  // per corner
    std::vector<Index> corner_of_node;  // per node: its first corner
    std::vector<Index> motion;          // per node: into Model::prescribed, or -1
    std::vector<std::array<bool, 2>>
        prescribed;  // per node, x and y: by its motion or by unbreakable glue to the support

    Index n_nodes() const { return static_cast<Index>(corner_of_node.size()); }
    /// `node` -1 is the rigid support.
    bool is_prescribed(Index node, int component) const { return node < 0 || prescribed[node][component]; }
    PointSides sides(const Model& model, Index fan_point) const {
        const auto node = [&](Index corner) { return corner == rigid_support ? -1 : node_of_corner[corner]; };
        const FanPoint& at = model.fan_points[fan_point];
        return {.fan_point = fan_point, .before = node(at.before), .after = node(at.after)};
    }
};

/// Fills `partition` and reuses its memory. Nodes are numbered fan by fan.
void partition_corners(const Model& model, const std::vector<std::uint8_t>& active, CornerPartition& partition);

}  // namespace knap
