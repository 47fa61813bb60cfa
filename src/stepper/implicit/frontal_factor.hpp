#pragma once
// Cholesky factor of a sparse matrix that is a sum of element matrices, by the multifrontal method (I. Duff, J. Reid,
// ACM Trans. Math. Softw. 9, 1983). Every part of a dissection has a dense front, the sum of its elements or of the
// Schur complements of its two halves,
//
//     | A  B' |       A = L L',   L_B = B L^-T      unknowns that belong to this part alone, eliminated here
//     | B  C  |       C - L_B L_B'                  Schur complement for the part above
//
// Every front is kept. Where elements changed, in values or in unknowns, only their leaves and the parts above these
// are computed anew: a running crack changes a few of thousands. The factor depends on the present elements alone, not
// on its history.
//
// Why not CHOLMOD (tools/bench/cholmod, one thread; its time over ours; block of 1 mm with 100 nodes split, of 0.5 mm
// in brackets):
//     new factor after a change, ordering kept              2.3 to 7     (3.4 to 11.5)
//     row additions and deletions for 100 split nodes       5.1 to 5.5   (2.8 to 5.5)
//     the same for one node                                 0.3 to 0.4   (0.2 to 0.4)
//     update for 10 changed points                          0.16 to 0.6  (0.06 to 0.09)
//     factor from scratch                                   0.6          (1.0)
//     substitution; our L has 2.1 to 2.7 times the entries  0.2          (0.4)
// CHOLMOD's modified factor depends on its history, needs all unknowns beforehand, and allocates memory in the step.
// (Measured before the smallest vertex cuts of dissection.hpp, which took a third of the entries and more than half of
// the operations.)
#include "base/arena.hpp"
#include "element/triangle_matrices.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/dissection.hpp"
#include "stepper/implicit/front_kernel.hpp"

#include <functional>
#include <span>

namespace knap {

struct Element {
    int n_unknowns;
    std::array<Index, 14> unknown;  // -1: none
    ElementMatrix matrix;
};

class FrontalFactor {
public:
    using ElementsOf = std::function<void(Index leaf, std::vector<Element>&)>;  // appends the elements of a leaf

    /// Unknowns are numbers from 0 to n_numbers - 1; not all of them need to occur.
    FrontalFactor(const Dissection& dissection, std::size_t n_numbers);

    /// The elements of this leaf have changed, or the part where one of their unknowns is eliminated.
    void touch(Index leaf) { stale_[leaf] = true; }
    void touch_all() { stale_.assign(stale_.size(), true); }

    /// Computes the touched fronts. `eliminated_in`: per unknown, the smallest part that holds all its elements. False:
    /// the matrix is not positive definite.
    bool update(const std::vector<Index>& eliminated_in, const ElementsOf& elements_of);
    /// The two halves of a solution, x <- L^-1 x and x <- L^-T x, in `parts` alone, which ascend; with all parts
    /// x <- A^-1 x. Parts that come with their parents: L^-1 x of an x that is zero in the unknowns of all others, and
    /// L^-T x in those of `parts`. Parts that come with their children: x <- L^-1 x eliminates their unknowns from the
    /// entries of all others (static condensation).
    void substitute(std::span<const Index> parts, std::vector<double>& x);
    void substitute_back(std::span<const Index> parts, std::vector<double>& x);
    /// The entries that belong to `parts`.
    void set_zero(std::span<const Index> parts, std::vector<double>& x) const;
    FactorSize size() const;

private:
    struct Front {
        ArenaList<Index> unknown;  // eliminated ones first
        Index n_eliminated = 0;
        ArenaList<double> L;      // lower half, column by column: L, and L_B below it
        ArenaList<double> schur;  // likewise
        Index size() const { return static_cast<Index>(unknown.size()); }
        Index n_left() const { return size() - n_eliminated; }
        std::span<const Index> left() const { return unknown.entries().subspan(n_eliminated); }
        double& at(Index row, Index column) {
            if (column < n_eliminated) return L.first()[row + size() * std::size_t(column)];
            return schur.first()[row - n_eliminated + n_left() * std::size_t(column - n_eliminated)];
        }
        const double* column_of_L(Index k) const { return L.first() + size() * std::size_t(k); }
    };
    void find_unknowns(Index part, const std::vector<Index>& eliminated_in);
    void assemble(Index part);
    bool eliminate(Front& front) const;
    void substitute_in_front(const Front& front, std::vector<double>& x);
    void substitute_back_in_front(const Front& front, std::vector<double>& x);
    void load(const Front& front, const std::vector<double>& x);

    const FrontKernel kernel_;
    const Dissection& dissection_;
    Arena arena_;                      // of the fronts, which grow node by node with a crack
    std::vector<Front> fronts_;        // per part
    std::vector<std::uint8_t> stale_;  // per part
    std::vector<Index> place_;         // per unknown: in the front in work, or -1
    std::vector<Index> own_, left_;    // unknowns of the front in work
    std::vector<Index> row_;           // in it, of the unknowns that a half leaves
    std::vector<Element> elements_;    // of the leaf in work
    std::vector<double> local_;        // right-hand side of the front in work
};

}  // namespace knap
