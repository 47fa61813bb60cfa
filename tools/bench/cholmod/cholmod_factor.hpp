#pragma once
// A Cholesky factor by CHOLMOD, of one ordering and one kind.
#include "matrices.hpp"

#include <cholmod.h>

namespace knap {

enum class Kind {
    supernodal,
    simplicial
};  // L L' of dense blocks, L D L' column by column: only the second can be modified

class CholmodFactor {
public:
    CholmodFactor(int ordering, Kind kind);
    ~CholmodFactor();
    CholmodFactor(const CholmodFactor&) = delete;

    /// A: its lower triangle is read.
    void analyse(const SparseMatrix& A);
    /// With this permutation instead of one that is looked for.
    void analyse(const SparseMatrix& A, std::vector<int> permutation);
    void factorise(const SparseMatrix& A);
    const Eigen::VectorXd& solve(const Eigen::VectorXd& b);
    std::vector<int> permutation() const;
    double n_entries() const;  // of L, with those zeros that it stores

    // modification of a simplicial factor in the natural order
    void delete_row(int k);                               // becomes that of the unit matrix
    void add_row(int k, const SparseMatrix& column);      // n x 1, was that of the unit matrix
    void update(bool adds, const SparseMatrix& columns);  // A + C C' or A - C C'

private:
    cholmod_sparse view(const SparseMatrix& A, int stored) const;
    void check(bool good, const char* what) const;

    cholmod_common common_;
    cholmod_factor* L_ = nullptr;
    cholmod_dense *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
    Eigen::VectorXd solution_;
};

}  // namespace knap
