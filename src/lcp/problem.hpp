#pragma once
// The linear complementarity problem  w = M z + q,  0 <= w  perp  z >= 0  (Cottle, Pang, Stone, The Linear
// Complementarity Problem), and what every solver takes and returns. The empty problem is legal: its solution is empty.
#include <Eigen/SparseCore>

#include <string_view>

namespace knap {

using LcpMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct LcpProblem {
    LcpMatrix M;        // [n, n]
    Eigen::VectorXd q;  // [n]

    int size() const { return static_cast<int>(q.size()); }
};

/// A dense matrix is stored without its zeros.
inline LcpProblem lcp_problem(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) { return {M.sparseView(0, 0), q}; }

enum class LcpStatus {
    solved,  // the solver's own criterion holds; scaled_residual (scaling.hpp) is the independent measure
    ray,     // pivots ended on a ray: the path leads to no solution
    iteration_limit,
    singular,        // a linear system could not be solved
    stalled,         // steps too small to continue
    not_applicable,  // the method does not exist for this matrix, e.g. a zero on the diagonal
};

inline std::string_view name(LcpStatus status) {
    switch (status) {
        case LcpStatus::solved:
            return "solved";
        case LcpStatus::ray:
            return "ray";
        case LcpStatus::iteration_limit:
            return "iteration_limit";
        case LcpStatus::singular:
            return "singular";
        case LcpStatus::stalled:
            return "stalled";
        case LcpStatus::not_applicable:
            return "not_applicable";
    }
    return "unknown";
}

struct LcpOptions {
    double tolerance = 1e-11;  // natural residual of the scaled problem, whose diagonal and q are of order one
    int max_iterations = 0;    // sweeps or linear solves of one start, not pivots; 0: the limit of the solver
    bool exhaustive = true;    // false: only the first starts, and the default solver tries no other but Lemke
    Eigen::VectorXd start;     // warm start, z of a similar problem; empty: none
};

/// z is the last iterate if there is one, for every status, and zero otherwise; w = M z + q.
struct LcpSolution {
    LcpStatus status = LcpStatus::solved;
    Eigen::VectorXd z, w;  // [n]
    int iterations = 0;    // pivots, sweeps or linear solves
};

inline LcpSolution lcp_solution(const LcpProblem& problem, LcpStatus status, const Eigen::VectorXd& z, int iterations) {
    return {.status = status, .z = z, .w = problem.M * z + problem.q, .iterations = iterations};
}

}  // namespace knap
