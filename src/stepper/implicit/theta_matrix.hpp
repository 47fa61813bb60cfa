#pragma once
// The matrix of an implicit step on the free components of the nodes,
//
//     A = (1 + d) M + theta h C + theta^2 h^2 K + G D G',   G': relative velocities of points, D = -d(impulse)/d(rate),
//
// factorised and solved; with large rotations K in the frames of piece_frames.hpp. From one factor to the next only
// what changed is computed anew (frontal_factor.hpp).
#include "base/grouped.hpp"
#include "element/mass_matrix.hpp"
#include "element/triangle_matrices.hpp"
#include "stepper/common/dashpots.hpp"
#include "stepper/implicit/corner_partition.hpp"
#include "stepper/implicit/frontal_factor.hpp"
#include "stepper/implicit/gmres.hpp"
#include "stepper/implicit/piece_frames.hpp"
#include "stepper/implicit/reduced_matrix.hpp"

#include <memory>
#include <span>

namespace knap {

class ThetaMatrix {
public:
    /// `dashpots`: C, in the order of the corners; they must outlive this, as must `frames` [null: none].
    ThetaMatrix(const Model& model, MassMatrix mass, std::span<const Dashpot> dashpots = {},
                PieceFrames* frames = nullptr);

    /// Nodes, which must outlive their use here, theta^2 h^2 [s2], and M_hat with so many times M. True: M or K or the
    /// nodes, or who meets whom, have changed; with frames, these. `meetings`: sides of contacts between faces, any two
    /// nodes of the body.
    bool set(const CornerPartition& nodes, double stiffness_factor, double mass_factor = 1,
             std::span<const PointSides> meetings = {});
    /// False: A without the friction that follows the contact impulses is not positive definite.
    bool factorise(const std::vector<PointTangent>& points);
    /// That of the last factorise(): none while the near nodes are others.
    bool has_factor() const { return factor_of_ == (is_reduced_ ? FactorOf::near_nodes : FactorOf::body); }

    /// Near nodes from now on: those of these points, which must be all that factorise() is given, the nodes of all
    /// triangles round them, and all nodes that are eliminated with these or later. Before: all nodes. Far nodes know
    /// nothing of the points: they are eliminated once (static condensation), and the equations of the near nodes are
    /// solved by themselves.
    void set_near(const std::vector<PointSides>& points);
    void set_all_near();
    /// Near nodes from now on: those of these points alone, whose equations are dense (ReducedMatrix), and those of
    /// points before them while neither M nor K nor the nodes change. Components along which no point acts follow with
    /// the far nodes. False: they are too many; all nodes are near.
    bool set_reduced(const std::vector<ActingPoint>& points);
    bool is_reduced() const { return is_reduced_; }
    bool has_far_nodes() const { return !far_parts_.empty(); }
    const std::vector<Index>& near_nodes() const { return near_nodes_; }
    /// The balance of the near nodes where that of the far nodes is satisfied, from the balance of all.
    void condense(std::vector<Vec2>& impulse);
    /// The change of the far nodes that satisfies their balance, added to `rate`: of the last condense(), after which
    /// the near nodes changed by `change`.
    void add_change_of_far_nodes(const std::vector<Vec2>& change, std::vector<Vec2>& rate);

    /// Per near node; the right-hand side is not read in prescribed components, and the solution is zero there. With
    /// friction that follows the contact impulses by GMRES, preconditioned by the factor; false: it did not converge.
    bool solve(const std::vector<Vec2>& right_side, std::vector<Vec2>& solution);
    /// M_hat x per near node, of the last solution and its right-hand side, to rounding.
    void bulk_part(const std::vector<Vec2>& right_side, const std::vector<Vec2>& solution,
                   std::vector<Vec2>& impulse) const;

    /// Relative rates (x, y) of `points` for unit impulses on each of them, by the symmetric blocks. False: too many
    /// unknowns are eliminated behind these points.
    bool find_compliance(std::span<const PointSides> points, Eigen::Ref<Eigen::MatrixXd> compliance);

    bool is_symmetric() const { return friction_.empty(); }
    double mass_factor() const { return mass_factor_; }
    const CornerPartition& nodes() const { return *nodes_; }
    ElementMatrix element(Index triangle) const;  // [kg] of M_hat, in x and y
    bool has_frames() const { return frames_ != nullptr; }
    bool is_free(Index node, int component) const { return !nodes_->prescribed[node][component]; }
    /// The free components of a node: the largest one; infinite where one is not a number, which meets no tolerance.
    double largest_free(const std::vector<Vec2>& of_node, Index node) const;
    FactorSize size() const { return factor_.size(); }

private:
    /// Unknowns are numbered by the first corner of their node: they keep their numbers while other fans split.
    Index unknown(Index node, int k) const { return is_free(node, k) ? 2 * nodes_->corner_of_node[node] + k : -1; }
    /// A vector at a node along the axes of its unknowns, and back.
    Vec2 in_frame(Index node, const Vec2& a) const {
        return frames_ ? frames_->of_corner(nodes_->corner_of_node[node]).turned_back(a) : a;
    }
    Vec2 out_of_frame(Index node, const Vec2& a) const {
        return frames_ ? frames_->of_corner(nodes_->corner_of_node[node]).turned(a) : a;
    }
    /// Both components of x_ at a node; zero where it is not free.
    Vec2 at_node(const std::vector<double>& x, Index node) const {
        Vec2 a = Vec2::Zero();
        for (int k = 0; k < 2; ++k)
            if (const Index u = unknown(node, k); u >= 0) a[k] = x[u];
        return out_of_frame(node, a);
    }
    void turn_out(const std::vector<Index>& nodes, std::vector<Vec2>& of_node) const;
    bool touch_frames();
    ElementMatrix element_in_frames(Index triangle) const;
    Index leaf_of_corner(Index corner) const { return dissection_.leaf_of_triangle[model_.mesh.triangle_of(corner)]; }
    Index leaf_of_point(Index fan_point) const;
    void place_fan(const Fan& fan);
    void place_meetings(std::span<const PointSides> meetings);
    void set_block(Index fan_point, const Eigen::Matrix2d& block);
    void set_contacts(std::span<const PointTangent> points);
    void add_elements(Index leaf, std::vector<Element>& elements) const;
    void add_point(const PointSides& sides, const Eigen::Matrix2d& block, std::vector<Element>& elements) const;
    template <class Visit>
    void each_unknown(const std::vector<Index>& nodes, const Visit& visit) const;
    template <class Visit>
    void each_unknown(const PointTangent& point, const Visit& visit) const;
    template <class Visit>
    void for_each_part(Index node, int k, const Visit& visit) const;
    template <class Visit>
    void for_each_part_of_jump(Index node, int k, double weight, const Visit& visit) const;
    template <class Visit>
    void for_each_part_of_jump(Index node, int k, const Eigen::Matrix2d& weight, const Visit& visit) const;
    /// (marked parts, and all above), ascending
    void find_marked_parts(std::vector<Index>& parts);
    /// (parts that eliminate nodes of `points`, and all above), ascending
    template <class Points, class SidesOf>
    void find_parts(const Points& points, const SidesOf& sides_of, std::vector<Index>& parts);
    bool factorise_body(const std::vector<PointTangent>& points);
    bool find_reduced_matrix();
    template <class PointOf, class ComponentOf>
    bool find_compliance(std::span<const PointSides> points, const PointOf& point_of, const ComponentOf& component_of,
                         Eigen::Ref<Eigen::MatrixXd> compliance);
    void find_entries_of_friction();
    bool solve_with_friction();

    const Model& model_;
    MassMatrix mass_;
    std::span<const Dashpot> dashpots_;
    PieceFrames* frames_;
    const CornerPartition* nodes_ = nullptr;
    const Dissection dissection_;
    FrontalFactor factor_;
    Grouped<Index> points_of_leaf_;  // fan points

    // in the factor
    std::vector<std::uint8_t> active_;  // per fan
    double stiffness_factor_ = 0;       // [s2]
    double mass_factor_ = 1;            // [-]
    std::vector<PointSides> meetings_;
    std::vector<Index> eliminated_in_;      // per unknown: part of the dissection
    std::vector<Eigen::Matrix2d> block_;    // [kg] per fan point
    std::vector<Index> with_block_;         // fan points whose block is not zero
    std::vector<std::uint8_t> kept_;        // [0/1] per fan point of with_block_: its block stays
    std::vector<PointTangent> contacts_;    // with obstacles
    std::vector<PointTangent> friction_;    // points whose blocks are not symmetric
    std::vector<PointTangent> points_;      // all
    std::vector<Index> parts_of_friction_;  // with unknowns of friction_, and all parts above

    // of find_compliance()
    std::vector<Index> local_parts_, path_, local_unknowns_;
    std::vector<double> half_;

    enum class FactorOf { none, body, near_nodes } factor_of_ = FactorOf::none;
    bool is_reduced_ = false;
    std::unique_ptr<ReducedMatrix> reduced_;
    std::vector<PointSides> reduced_points_;               // per unknown: its node with an obstacle that rests
    std::vector<Vec2> condensed_, reduced_impulse_;        // [N s] per near node
    std::vector<Index> reduced_parts_, reduced_unknowns_;  // with their unknowns, and all parts above; of these parts

    std::vector<Index> near_parts_, far_parts_, near_nodes_, far_nodes_;
    std::vector<std::uint8_t> is_marked_;  // [0/1] per part

    struct EntryOfFriction {
        Index unknown, component;  // 2 * (place in friction_) + (0: x, 1: y)
        double weight;             // [-] of the unknown in that component of the relative motion
    };
    std::vector<EntryOfFriction> entries_of_friction_;
    std::vector<PointTangent> new_contacts_;
    std::vector<double> x_, y_;     // per unknown
    std::vector<double> far_part_;  // likewise, of condense()
    Gmres gmres_;
    Eigen::VectorXd friction_part_;  // two entries for each point of friction_
};

}  // namespace knap
