#pragma once
// The linear complementarity problem  w = M z + q,  0 <= w  perp  z >= 0  (Cottle, Pang, Stone, The Linear
// Complementarity Problem), and the arguments and results of every solver. The empty problem has the empty solution.
#include "base/tolerance.hpp"

#include <Eigen/SparseCore>

#include <span>
#include <string_view>

namespace knap {

using LcpMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// The entries of a row, with increasing columns. Loops over them take a quarter of the time of Eigen's iterators.
struct LcpRow {
    std::span<const int> columns;
    std::span<const double> values;
    std::size_t size() const { return columns.size(); }
};

inline LcpRow row_of(const LcpMatrix& M, int row) {
    const int start = M.outerIndexPtr()[row];
    const auto size = static_cast<std::size_t>(M.outerIndexPtr()[row + 1] - start);
    return {{M.innerIndexPtr() + start, size}, {M.valuePtr() + start, size}};
}

struct LcpProblem {
    LcpMatrix M;        // [n, n]
    Eigen::VectorXd q;  // [n]

    int size() const { return static_cast<int>(q.size()); }
};

/// A dense matrix is stored without its zeros.
inline LcpProblem lcp_problem(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) { return {M.sparseView(0, 0), q}; }

/// M x. Every row is summed in the order of its entries.
Eigen::VectorXd product(const LcpMatrix& M, const Eigen::VectorXd& x);

enum class LcpStatus {
    solved,  // the criterion of the solver holds; scaled_residual (scaling.hpp) is the independent measure
    ray,     // the pivots ended on a ray, which leads to no solution; of the default solver: a proof that there is none
    iteration_limit,
    singular,  // a linear system could not be solved
    stalled,   // steps too small to continue
};

constexpr std::string_view name(LcpStatus status) {
    constexpr std::string_view names[]{"solved", "ray", "iteration_limit", "singular", "stalled"};
    return names[static_cast<int>(status)];
}

struct LcpOptions {
    double tolerance = 1e-11;  // natural residual of the equilibrated problem, whose diagonal and q are of order one
    int max_iterations = 0;    // sweeps or linear solves of one start, not pivots; 0: the limit of the solver
    bool exhaustive = true;    // false: the default solver tries no other solver but Lemke's, and that few paths
    Eigen::VectorXd start;     // warm start, z of a similar problem; empty: none

    int limit(int limit_of_solver) const { return max_iterations > 0 ? max_iterations : limit_of_solver; }
};

/// For every status z is the last iterate if there is one and zero otherwise; w = M z + q.
struct LcpSolution {
    LcpStatus status = LcpStatus::solved;
    Eigen::VectorXd z, w;      // [n]
    int iterations = 0;        // pivots, sweeps or linear solves
    Eigen::VectorXd ray = {};  // [n] of the default solver: proves that there is no solution (infeasibility.hpp)
};

inline LcpSolution lcp_solution(const LcpProblem& problem, LcpStatus status, const Eigen::VectorXd& z, int iterations) {
    return {.status = status, .z = z, .w = product(problem.M, z) + problem.q, .iterations = iterations};
}

}  // namespace knap
