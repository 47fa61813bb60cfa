#pragma once
// Nonlinear block Gauss-Seidel between Newton's steps on the points: one fan after the other moves its nodes to the
// solution of their own equations, while the nodes of all other fans rest,
//
//     r(w) = H' q(w; multipliers),        multipliers <- q(w).
//
// A step of the whole body ends where the first stiff springs of closing or sticking points are met, so with hundreds
// of points that change their piece it stays short. A sweep lets every fan pass its kinks by itself. Points join nodes
// of one fan only, so the equations of a fan are small; for given multipliers and without friction a sweep never raises
// the potential of the step.
// (C. Graeser, R. Kornhuber, J. Comput. Math. 27, 2009; C. Graeser, O. Sander, IMA J. Numer. Anal. 39, 2019: truncated
// nonsmooth Newton multigrid, from memory.)
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/theta_matrix.hpp"

#include <Eigen/Core>

#include <span>

namespace knap {

class FanSweep {
public:
    /// Both must outlive it.
    FanSweep(const Model& model, const ThetaMatrix& matrix);

    /// Of these points, whose nodes the matrix knows.
    void begin(const std::vector<ActivePoint>& points);
    /// Fans whose balance is missed by more than `tolerance` [N s] move: their `points`, `rate` [m/s], and, per near
    /// node, `impulse` r(w) and `residual` r(w) - H' q [N s], which follow.
    void sweep(double tolerance, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, std::vector<Vec2>& impulse,
               std::vector<Vec2>& residual);

private:
    static constexpr Index max_nodes = 16;  // of a fan, and points: larger ones are left to the steps of the body
    static constexpr int max_unknowns = 2 * max_nodes;
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_unknowns, max_unknowns>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_unknowns, 1>;
    using Columns = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 2>>;

    void find_columns(const std::vector<ActivePoint>& points);
    bool load(std::span<const ActivePoint> points, const std::vector<Vec2>& impulse);
    int place(Index node) const;
    Vec2 turn(const ActivePoint& point, const Vector& x) const;
    void add_impulse(const ActivePoint& point, const Vec2& impulse, Vector& x) const;
    bool is_free(int unknown) const;
    double largest_residual() const;
    void find_residual(std::span<const ActivePoint> points);
    bool find_direction(std::span<const ActivePoint> points, Softening softening);
    double step_length(std::span<const ActivePoint> points) const;
    bool is_balanced(double tolerance, const std::vector<Vec2>& residual) const;
    bool solve(double tolerance, std::span<ActivePoint> points);
    double update_multipliers(std::span<ActivePoint> points) const;
    void move(std::span<ActivePoint> points, std::vector<Vec2>& rate, std::vector<Vec2>& impulse,
              std::vector<Vec2>& residual) const;
    Columns columns(Index fan_corner) const;

    const Model& model_;
    const ThetaMatrix& matrix_;
    bool has_columns_ = false;
    std::vector<double> columns_;        // [kg] M_hat of the triangle of a corner: the two columns of the corner
    std::vector<Index> first_column_;    // per entry of Model::fan_corners: its place among these
    std::vector<std::uint8_t> touches_;  // [0/1] per node: it touches an obstacle

    // of the present fan
    const Fan* fan_ = nullptr;
    Index n_nodes_ = 0;
    std::array<Index, max_nodes> node_{};
    Matrix inertia_, matrix_of_step_;  // [kg] M_hat of its nodes; with the points
    Vector start_;                     // [N s] r(w) before the fan moves
    Vector move_, step_;               // [m/s]
    Vector residual_;                  // [N s]
    std::array<PointResponse, max_nodes> response_{};
};

}  // namespace knap
