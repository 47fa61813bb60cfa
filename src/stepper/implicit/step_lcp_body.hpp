#pragma once
// The body of one implicit step with everything parted that can part: triangles joined by unbreakable points only. With
// M_hat = M + h^2 theta^2 K the equations of stepper/implicit/implicit_scheme.hpp, times theta, read
//
//     M_hat w = M v - theta h K u + theta h F_theta + theta H' P         w = rate of every corner over the step
//
// Where nothing is unbreakable M_hat is block diagonal, a block a triangle. Prescribed components of w are known and eliminated.
#include "model/state.hpp"
#include "stepper/common/scheme_options.hpp"

#include <Eigen/SparseCholesky>

#include <deque>

namespace knap {

class PartedBody {
public:
    using Matrix = Eigen::SparseMatrix<double>;

    PartedBody(const Model& model, const State& begin, double h, const SchemeOptions& options);

    /// [m/s] w if no point acted; x and y of every corner.
    const Eigen::VectorXd& free_rate() const { return free_rate_; }
    /// Per jump: the part of its row that is not prescribed; 0: nothing that happens in the step changes this rate.
    Eigen::VectorXd freedom(const Matrix& H) const;
    /// [1/kg] H M_hat^-1 H' on the components that are not prescribed; H [n, 2 n_corners] takes corners to jumps.
    Matrix delassus(const Matrix& H) const;
    /// [m/s] w under impulses [N s] on the corners, x and y each.
    Eigen::VectorXd rate(const Eigen::VectorXd& impulse) const { return free_rate_ + theta_ * response(impulse); }
    /// [m/s] v+ of every corner that moves over the step with the rates w.
    Eigen::VectorXd end_velocity(const Eigen::VectorXd& rate) const;

private:
    void join(const Model& model);
    void prescribe(const Model& model, const State& begin, double h, double theta);
    void number_unknowns();
    void factorise(const Matrix& M_hat);
    Eigen::VectorXd response(const Eigen::VectorXd& impulse) const;  // M_hat^-1

    struct Part {               // triangles that nothing can part
        Eigen::Index first, n;  // its unknowns
        Eigen::SimplicialLDLT<Matrix> factor;
    };
    double theta_;
    std::vector<Index> leader_;                    // per corner: the lowest that it moves with for ever, or support
    std::vector<Index> part_of_triangle_;          // its lowest triangle
    std::vector<char> is_known_;                   // per component of a corner
    Eigen::VectorXd known_rate_, known_velocity_;  // [m/s] w and v+ where known, else 0
    Eigen::VectorXd velocity_;                     // [m/s] v
    Matrix expand_;                                // [2 n_corners, unknowns]
    std::deque<Part> parts_;
    Eigen::VectorXd free_rate_;
};

}  // namespace knap
