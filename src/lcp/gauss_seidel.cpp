// Projected block Gauss-Seidel: the blocks are solved one after the other by Lemke, the rest of z frozen (Cottle, Pang,
// Stone, The Linear Complementarity Problem, 5.2; Jean 1999, nonsmooth contact dynamics). A block of one unknown is the
// classical projected method, which needs a positive diagonal. An unknown without one is put in a block with the
// unknowns that its row couples to: multipliers with their bounds.
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr int max_sweeps = 20000;
constexpr int max_block = 200;  // unknowns
constexpr int sweeps_between_checks = 5;
constexpr double rounding = 1e-14;      // of w in an equilibrated problem
constexpr double min_condition = 1e-8;  // reciprocal, of an active set that is kept

struct Block {
    std::vector<int> rows;
    Eigen::MatrixXd M;        // [rows, rows]
    std::vector<int> active;  // at the last solution: mostly also at the next one, and then the block costs one product
    Eigen::MatrixXd inverse;  // of M on the active set; empty: not to be used

    void remember(const Eigen::VectorXd& z) {
        active.clear();
        for (int i = 0; i < z.size(); ++i)
            if (z[i] > 0) active.push_back(i);
        inverse.resize(0, 0);
        if (active.empty()) return;
        const Eigen::FullPivLU<Eigen::MatrixXd> lu(M(active, active));
        if (lu.rcond() > min_condition) inverse = lu.inverse();
    }

    /// z by the last active set; false where that is not the solution.
    bool solved_as_before(const Eigen::VectorXd& q, Eigen::VectorXd& z) const {
        if (inverse.size() == 0) return false;
        const int size = static_cast<int>(active.size());
        z.setZero();
        for (int i = 0; i < size; ++i) {
            double sum = 0;
            for (int k = 0; k < size; ++k) sum -= inverse(i, k) * q[active[k]];
            if (sum < 0) return false;
            z[active[i]] = sum;
        }
        for (int i = 0; i < q.size(); ++i)
            if (z[i] == 0 && q[i] + M.row(i).dot(z) < -rounding) return false;
        return true;
    }
};

/// Unknowns joined through the rows with a zero on the diagonal.
std::vector<std::vector<int>> blocks_of_zero_diagonal(const LcpMatrix& M) {
    const int n = static_cast<int>(M.rows());
    std::vector<int> parent(n);
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (int i = 0; i < n; ++i)
        if (M.coeff(i, i) == 0)
            for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry)
                if (entry.value() != 0) parent[root(i)] = root(static_cast<int>(entry.col()));
    std::vector<std::vector<int>> by_root(n);
    for (int i = 0; i < n; ++i) by_root[root(i)].push_back(i);
    std::erase_if(by_root, [](const std::vector<int>& block) { return block.empty(); });
    return by_root;
}

std::vector<Block> prepared(const LcpMatrix& M, const std::vector<std::vector<int>>& partition) {
    std::vector<Block> blocks;
    std::vector<int> place(M.rows(), -1);
    for (const std::vector<int>& rows : partition) {
        const int size = static_cast<int>(rows.size());
        Block block{.rows = rows, .M = Eigen::MatrixXd::Zero(size, size)};
        for (int i = 0; i < size; ++i) place[rows[i]] = i;
        for (int i = 0; i < size; ++i)
            for (LcpMatrix::InnerIterator entry(M, rows[i]); entry; ++entry)
                if (place[entry.col()] >= 0) block.M(i, place[entry.col()]) = entry.value();
        for (const int row : rows) place[row] = -1;
        blocks.push_back(std::move(block));
    }
    return blocks;
}

/// z of the block with all the others frozen; false where the block has no solution.
bool relax(const ScaledLcp& scaled, Block& block, Eigen::VectorXd& z) {
    const int size = static_cast<int>(block.rows.size());
    Eigen::VectorXd q(size), old(size);
    for (int i = 0; i < size; ++i) {
        const int row = block.rows[i];
        old[i] = z[row];
        q[i] = scaled.problem.q[row];
        for (LcpMatrix::InnerIterator entry(scaled.problem.M, row); entry; ++entry)
            q[i] += entry.value() * z[entry.col()];
    }
    q -= block.M * old;
    if (size == 1) {
        if (q[0] < 0 && block.M(0, 0) <= 0) return false;
        z[block.rows[0]] = q[0] < 0 ? -q[0] / block.M(0, 0) : 0.0;
        return true;
    }
    Eigen::VectorXd found(size);
    if (!block.solved_as_before(q, found)) {
        if (!solve_lcp_by_lemke(block.M, q, found)) return false;
        block.remember(found);
    }
    for (int i = 0; i < size; ++i) z[block.rows[i]] = found[i];
    return true;
}

}  // namespace

LcpSolution solve_by_gauss_seidel(const LcpProblem& problem, const LcpOptions& options) {
    const int n = problem.size(), limit = options.max_iterations > 0 ? options.max_iterations : max_sweeps;
    const ScaledLcp scaled = equilibrated(problem);
    Eigen::VectorXd z = options.start.size() == n ? scaled.scaled_z(options.start) : Eigen::VectorXd::Zero(n);
    const auto result = [&](LcpStatus status, int sweeps) {
        return lcp_solution(problem, status, scaled.original_z(z), sweeps);
    };
    std::vector<Block> blocks = prepared(scaled.problem.M, blocks_of_zero_diagonal(scaled.problem.M));
    for (const Block& block : blocks)
        if (block.rows.size() > max_block) return result(LcpStatus::not_applicable, 0);
    for (int sweep = 0; sweep < limit; ++sweep) {
        if (sweep % sweeps_between_checks == 0) {
            const double residual = natural_residual(scaled.problem, z);
            if (residual <= options.tolerance) return result(LcpStatus::solved, sweep);
            if (!std::isfinite(residual)) return result(LcpStatus::stalled, sweep);
        }
        for (Block& block : blocks)
            if (!relax(scaled, block, z)) return result(LcpStatus::not_applicable, sweep);
    }
    return result(LcpStatus::iteration_limit, limit);
}

}  // namespace knap
