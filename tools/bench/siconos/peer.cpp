#include "peer.hpp"

#include "base/stopwatch.hpp"
#include "base/union_find.hpp"

#include <LCP_Solvers.h>
#include <LinearComplementarityProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>
#include <lcp_cst.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <vector>

namespace peer {
namespace {

constexpr double tolerance = 1e-11;

using Options = std::unique_ptr<SolverOptions, void (*)(SolverOptions*)>;

Options options_of(int solver, int max_iterations) {
    Options options(solver_options_create(solver), &solver_options_delete);
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = max_iterations;
    options->filterOn = false;
    return options;
}

Outcome run(NumericsMatrix& M, Eigen::VectorXd q, Eigen::VectorXd z, SolverOptions& options) {
    Eigen::VectorXd w = Eigen::VectorXd::Zero(q.size());
    LinearComplementarityProblem problem{.size = static_cast<int>(q.size()), .M = &M, .q = q.data()};
    const knap::Stopwatch watch;
    const int info = linearComplementarity_driver(&problem, z.data(), w.data(), &options);
    return {z, watch.cpu(), info == 0};
}

Outcome run_dense(const knap::LcpProblem& problem, int solver, int max_iterations) {
    Eigen::MatrixXd dense(problem.M);
    NumericsMatrix* M = NM_create_from_data(NM_DENSE, problem.size(), problem.size(), dense.data());
    const Options options = options_of(solver, max_iterations);
    const Outcome outcome = run(*M, problem.q, Eigen::VectorXd::Zero(problem.size()), *options);
    M->matrix0 = nullptr;  // owned here
    NM_clear(M);
    std::free(M);
    return outcome;
}

/// The block-sparse matrix of Siconos in the order of the blocks; owns the numbers that it points to.
struct BlockMatrix {
    BlockMatrix(const knap::LcpProblem& problem, const std::vector<std::vector<int>>& blocks) {
        std::vector<int> block_of(problem.size()), place(problem.size());
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            ends.push_back((b == 0 ? 0 : ends.back()) + static_cast<unsigned>(blocks[b].size()));
            for (std::size_t k = 0; k < blocks[b].size(); ++k)
                block_of[blocks[b][k]] = static_cast<int>(b), place[blocks[b][k]] = static_cast<int>(k);
        }
        first.push_back(0);
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            std::map<int, std::vector<double>> row;  // by block column; columns of a block one after the other
            row[static_cast<int>(b)];
            for (const int i : blocks[b])
                for (knap::LcpMatrix::InnerIterator entry(problem.M, i); entry; ++entry) {
                    std::vector<double>& block = row[block_of[entry.col()]];
                    block.resize(blocks[b].size() * blocks[block_of[entry.col()]].size());
                    block[place[entry.col()] * blocks[b].size() + place[i]] = entry.value();
                }
            for (auto& [column, block] : row) {
                block.resize(blocks[b].size() * blocks[column].size());
                if (column == static_cast<int>(b)) diagonal.push_back(static_cast<unsigned>(numbers.size()));
                numbers.push_back(std::move(block));
                columns.push_back(column);
            }
            first.push_back(columns.size());
        }
        for (std::vector<double>& block : numbers) pointers.push_back(block.data());
        matrix = SBM_new();
        matrix->nbblocks = static_cast<unsigned>(numbers.size());
        matrix->block = pointers.data();
        matrix->blocknumber0 = matrix->blocknumber1 = static_cast<unsigned>(blocks.size());
        matrix->blocksize0 = matrix->blocksize1 = ends.data();
        matrix->filled1 = first.size();
        matrix->filled2 = columns.size();
        matrix->index1_data = first.data();
        matrix->index2_data = columns.data();
        matrix->diagonal_blocks = diagonal.data();
    }
    BlockMatrix(const BlockMatrix&) = delete;
    BlockMatrix& operator=(const BlockMatrix&) = delete;
    ~BlockMatrix() { std::free(matrix); }

    SparseBlockStructuredMatrix* matrix;

private:
    std::vector<std::vector<double>> numbers;
    std::vector<double*> pointers;
    std::vector<unsigned> ends, diagonal;
    std::vector<std::size_t> first, columns;
};

/// Unknowns joined through the rows with a zero on the diagonal: multipliers with their bounds.
std::vector<std::vector<int>> blocks_of_zero_diagonal(const knap::LcpMatrix& M) {
    const int n = static_cast<int>(M.rows());
    knap::UnionFind sets(n);
    for (int i = 0; i < n; ++i)
        if (M.coeff(i, i) == 0)
            for (knap::LcpMatrix::InnerIterator entry(M, i); entry; ++entry)
                if (entry.value() != 0) sets.join(i, static_cast<int>(entry.col()));
    std::vector<std::vector<int>> blocks(n);
    for (int i = 0; i < n; ++i) blocks[sets.find(i)].push_back(i);
    std::erase_if(blocks, [](const std::vector<int>& block) { return block.empty(); });
    return blocks;
}

}  // namespace

Outcome lemke(const knap::LcpProblem& problem) {
    return run_dense(problem, SICONOS_LCP_LEMKE, 20 * problem.size() + 1000);
}

Outcome newton_min(const knap::LcpProblem& problem) { return run_dense(problem, SICONOS_LCP_NEWTON_MIN_FBLSA, 200); }

Outcome block_gauss_seidel(const knap::LcpProblem& problem, const Eigen::VectorXd& start) {
    const std::vector<std::vector<int>> blocks = blocks_of_zero_diagonal(problem.M);
    std::vector<int> order;
    for (const std::vector<int>& block : blocks) order.insert(order.end(), block.begin(), block.end());
    const BlockMatrix blocked(problem, blocks);
    NumericsMatrix* M = NM_create_from_data(NM_SPARSE_BLOCK, problem.size(), problem.size(), blocked.matrix);
    const Options options =
        options_of(SICONOS_LCP_NSGS_SBM, problem.size() < 1000 ? 20000 : 2000);  // a sweep of the largest takes 4 ms
    solver_options_update_internal(options.get(), 0, SICONOS_LCP_LEMKE);
    const Eigen::VectorXd q = problem.q(order);
    const Eigen::VectorXd begin =
        start.size() == problem.size() ? Eigen::VectorXd(start(order)) : Eigen::VectorXd::Zero(problem.size());
    Outcome outcome = run(*M, q, begin, *options);
    const Eigen::VectorXd found = outcome.z;
    outcome.z(order) = found;
    M->matrix1 = nullptr;  // owned here
    NM_clear(M);
    std::free(M);
    return outcome;
}

}  // namespace peer
