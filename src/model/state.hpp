#pragma once
// All that changes in a run, and all that a restart needs.
#include "model/model.hpp"

#include <vector>

namespace knap {

/// What a split fan remembers of each of its points.
struct PointState {
    double cohesion;  // [-] beta
    Vec2 traction;    // [Pa] (N, T) mean over the last step, on the side `after`; of the pressure it tells what rests under it

    template <class Archive>
    void serialize(Archive& archive) { archive(cohesion, traction); }
};

/// A fan that has not come apart is one node, like in an ordinary finite element mesh; one that has is a node per corner, for ever
/// (its corners still move together where its points stick: the fan solver clusters them).
/// Node f (for f < number of fans) belongs to fan f, or to its first corner once split; further nodes follow in the order of split_fans.
struct State {
    double time = 0;           // [s]
    double last_step = 0;      // [s] the step that led here; 0 at the start
    std::int64_t n_steps = 0;
    std::vector<Vec2> displacement;     // [m] per node
    std::vector<Vec2> velocity;         // [m/s] per node; of the explicit bulk: at the middle of the last step
    std::vector<Vec2> rate;             // [m/s] per node, of the implicit bulk: mean velocity over the last step; empty at the start
    std::vector<Index> node_of_corner;  // per corner
    std::vector<Index> split_fans;      // in order of release, but where stepper/explicit/split_order has put them in that of the fans
    std::vector<Index> first_point;     // per split fan, in that order: into `points`
    std::vector<PointState> points;     // of the split fans, in that order
    std::vector<Index> split_rank;      // per fan: its place in split_fans, or -1
    std::vector<Vec2> reaction;         // [N] per prescribed motion: what drives it, mean over the last step; 0 in free components
    std::vector<ObstacleState> obstacles;

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time, last_step, n_steps, displacement, velocity, rate, node_of_corner, split_fans, first_point, points, split_rank, reaction, obstacles);
    }
};

State initial_state(const Model& model);

/// Gives every corner of `fan` a node of its own and every point a PointState.
void split(const Model& model, Index fan, State& state);

/// Opening of a point in the frame of its interface (A to B): (u_N, u_T) [m].
Vec2 opening(const Model& model, const State& state, Index point);
/// [m] What rounding leaves of a closed gap: openings are differences of displacements, and what is this small beside them is none. Without it
/// a point with restitution that is held closed loses its contact in every step that leaves u_N = +1e-17, and its cohesion pulls the sides
/// into each other.
double touching_gap(const Model& model, const State& state, const FanPoint& point);
/// Cohesion of a point; 1 in a fan that never came apart.
double cohesion(const Model& model, const State& state, Index point);
/// Traction on side B in the frame of its interface [Pa]; in an intact fan the mean stress there of the two neighbours gives it.
Vec2 traction(const Model& model, const State& state, Index point);
/// (N, T) of the stress (xx, yy, xy) round an interface [Pa], in its frame.
Vec2 traction(const Eigen::Vector3d& stress, const Vec2& normal);
/// Where a body moves fastest, or no longer by a finite speed [m].
Vec2 place_of_largest_speed(const Model& model, const State& state);
/// Barycentric coordinates of a corner in its triangle.
Eigen::Vector3d coordinates(const Mesh& mesh, Index corner);
/// Stress (xx, yy, xy) of a triangle, mean over it [Pa].
Eigen::Vector3d stress(const Model& model, const State& state, Index triangle);
/// At barycentric coordinates of it; of order 2 the linear field next to it, without what the bubble has beyond.
Eigen::Vector3d stress(const Model& model, const State& state, Index triangle, const Eigen::Vector3d& at);

}  // namespace knap
