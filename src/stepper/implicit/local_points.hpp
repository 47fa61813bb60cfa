#pragma once
// The points of a few fans by themselves, all others on the pieces of their laws (nonlinear elimination).
//
// With friction the active set cycles in single fans: two or three points round a vertex that close, slide and soften,
// whose pieces Newton's method on the whole body does not find, however near all the others are. The rates of these
// points depend on their impulses q alone,
//
//     w = w_free + W q,      W = G' (A - G D G')^-1 G,      D: what the matrix A has of their pieces,
//
// so the laws at these w are a small dense problem. Block Gauss-Seidel over the fans, with the resolvents of the points
// inside, solves it; impulses z beyond those of their pieces then enter the right-hand side of Newton's step.
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/theta_matrix.hpp"

#include <Eigen/Core>

namespace knap {

class LocalPoints {
public:
    LocalPoints(const Model& model, ThetaMatrix& matrix);

    /// Fans whose impulses are far from their laws, up to a number of points. `direction`: Newton's step of the body on
    /// the pieces of all points, with the softening that the factor has; `unit` [N s]: scale of the impulses. Their
    /// impulses z are subtracted from `residual` [N s]. False: there are none, or no solution was found.
    bool solve(const std::vector<ActivePoint>& points, const std::vector<Vec2>& direction, Softening softening,
               double unit, std::vector<Vec2>& residual);
    void forget() { place_.clear(); }
    /// The point is one of the last solution; its (contact, tangential) impulses there [N s].
    bool has(std::size_t point) const { return point < place_.size() && place_[point] >= 0; }
    Vec2 impulse(std::size_t point) const { return {at_[place_[point]].contact, at_[place_[point]].tangential}; }

private:
    static constexpr int max_points = 60, max_size = 2 * max_points;  // (N, T) of each point
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_size, max_size>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_size, 1>;

    void choose(const std::vector<ActivePoint>& points, double unit);
    bool find_impulses(const std::vector<ActivePoint>& points, double unit);
    double sweep_fan(const std::vector<ActivePoint>& points, Eigen::Index first, Eigen::Index end, double goal);

    ThetaMatrix& matrix_;
    std::vector<std::pair<double, std::size_t>> fans_;  // [N s] distance from the laws, negative; first point
    std::vector<std::size_t> chosen_;                   // points, those of a fan in succession
    std::vector<int> place_;                            // per point: in chosen_, or -1; empty: no solution
    std::vector<PointSides> sides_;                     // of the chosen points, as the following
    std::vector<Multipliers> at_;
    Matrix compliance_;             // W, in (N, T) of each point
    Vector rate_, impulse_, step_;  // w, q; along `direction`
};

}  // namespace knap
