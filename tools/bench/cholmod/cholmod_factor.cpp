#include "cholmod_factor.hpp"

#include <stdexcept>

namespace knap {

CholmodFactor::CholmodFactor(int ordering, Kind kind) {
    cholmod_start(&common_);
    common_.supernodal = kind == Kind::supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
    common_.postorder = ordering != CHOLMOD_NATURAL;
    common_.print = 0;
}

CholmodFactor::~CholmodFactor() {
    cholmod_free_factor(&L_, &common_);
    for (cholmod_dense** of_solve : {&x_, &y_, &e_}) cholmod_free_dense(of_solve, &common_);
    cholmod_finish(&common_);
}

cholmod_sparse CholmodFactor::view(const SparseMatrix& A, int stored) const {
    cholmod_sparse seen{};
    seen.nrow = A.rows(), seen.ncol = A.cols(), seen.nzmax = A.nonZeros();
    seen.p = const_cast<int*>(A.outerIndexPtr()), seen.i = const_cast<int*>(A.innerIndexPtr()),
    seen.x = const_cast<double*>(A.valuePtr());
    seen.stype = stored, seen.itype = CHOLMOD_INT, seen.xtype = CHOLMOD_REAL, seen.dtype = CHOLMOD_DOUBLE;
    seen.sorted = seen.packed = 1;
    return seen;
}

void CholmodFactor::check(bool good, const char* what) const {
    if (!good || common_.status != CHOLMOD_OK)
        throw std::runtime_error(std::string("CHOLMOD: ") + what + " failed, status " + std::to_string(common_.status));
}

void CholmodFactor::analyse(const SparseMatrix& A) {
    cholmod_free_factor(&L_, &common_);
    cholmod_sparse seen = view(A, -1);
    L_ = cholmod_analyze(&seen, &common_);
    check(L_, "analysis");
}

void CholmodFactor::analyse(const SparseMatrix& A, std::vector<int> permutation) {
    cholmod_free_factor(&L_, &common_);
    cholmod_sparse seen = view(A, -1);
    const int ordering = common_.method[0].ordering;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    L_ = cholmod_analyze_p(&seen, permutation.data(), nullptr, 0, &common_);
    common_.method[0].ordering = ordering;
    check(L_, "analysis of a given permutation");
}

void CholmodFactor::factorise(const SparseMatrix& A) {
    cholmod_sparse seen = view(A, -1);
    check(cholmod_factorize(&seen, L_, &common_), "factor");
}

const Eigen::VectorXd& CholmodFactor::solve(const Eigen::VectorXd& b) {
    cholmod_dense right{};
    right.nrow = right.nzmax = right.d = b.size(), right.ncol = 1, right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL, right.dtype = CHOLMOD_DOUBLE;
    check(cholmod_solve2(CHOLMOD_A, L_, &right, nullptr, &x_, nullptr, &y_, &e_, &common_), "solve");
    return solution_ = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(x_->x), b.size());
}

std::vector<int> CholmodFactor::permutation() const {
    const int* first = static_cast<const int*>(L_->Perm);
    return {first, first + L_->n};
}

double CholmodFactor::n_entries() const { return L_->is_super ? static_cast<double>(L_->xsize) : common_.lnz; }

void CholmodFactor::delete_row(int k) { check(cholmod_rowdel(k, nullptr, L_, &common_), "deletion of a row"); }

void CholmodFactor::add_row(int k, const SparseMatrix& column) {
    cholmod_sparse seen = view(column, 0);
    check(cholmod_rowadd(k, &seen, L_, &common_), "addition of a row");
}

void CholmodFactor::update(bool adds, const SparseMatrix& columns) {
    cholmod_sparse seen = view(columns, 0);
    check(cholmod_updown(adds, &seen, L_, &common_), "update");
}

}  // namespace knap
