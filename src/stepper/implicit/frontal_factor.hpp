#pragma once
// Cholesky factor of a sparse matrix that is a sum of element matrices, by fronts (I. Duff, J. Reid, ACM Trans. Math. Softw. 9, 1983):
// every part of a dissection has a small dense matrix, the sum of its elements or of what its two halves left over,
//
//     | A  B' |       A = L L',   L_B = B L^-T      unknowns that nothing outside of the part touches, eliminated here
//     | B  C  |       C - L_B L_B'                  left over for the part above
//
// Every front is kept. Where elements changed, in values or in unknowns, only their leaves and the parts above these are computed anew:
// a crack that runs changes a few of thousands. The factor depends on the present elements alone, not on how they came about.
//
// Why not CHOLMOD (tools/bench/cholmod, one thread; its time over ours; block of 1 mm with 100 nodes split, of 0.5 mm in brackets): a new factor after each
// change, with the ordering kept, takes 2.3 to 7 (3.4 to 11.5) times as long; row additions and deletions for 100 split nodes 5.1 to 5.5 (2.8 to 5.5), for one
// node 0.3 to 0.4 (0.2 to 0.4); an update for 10 changed points 0.16 to 0.6 (0.06 to 0.09). A factor from scratch takes 0.6 (1.0), a substitution 0.2 (0.4) of
// our time: our L has 2.1 to 2.7 times the entries. CHOLMOD's modified factor depends on its history, must know all unknowns beforehand, and allocates memory in
// the step. Half of an implicit run can be our substitution: smaller cuts (dissection.hpp) and a substitution without gathering are the next gain.
#include "base/arena.hpp"
#include "element/triangle_matrices.hpp"
#include "stepper/implicit/dissection.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace knap {

struct Element {
    int n_unknowns;
    std::array<Index, 14> unknown;  // any numbers below the size of `eliminated_in`; -1: not there
    ElementMatrix matrix;
};

class FrontalFactor {
public:
    using ElementsOf = std::function<void(Index leaf, std::vector<Element>&)>;  // adds the elements of a leaf to the list

    explicit FrontalFactor(const Dissection& dissection);

    /// The elements of this leaf have changed, or where an unknown of theirs is eliminated.
    void touch(Index leaf) { stale_[leaf] = true; }
    void touch_all() { stale_.assign(stale_.size(), true); }

    /// Brings up to date what was touched. `eliminated_in`: per unknown the smallest part that holds all elements it is in.
    /// False: the matrix is not positive definite.
    bool update(const std::vector<Index>& eliminated_in, const ElementsOf& elements_of);
    /// x in, A^-1 x out; per unknown, entries of numbers that are no unknowns are left alone.
    void solve(std::vector<double>& x) const;

    std::vector<Index> unknowns() const;  // in the order of their elimination
    std::int64_t n_unknowns() const;
    std::int64_t n_entries() const;       // of L

private:
    class DenseMatrix {
    public:
        void set_zero(Arena& arena, Index n_rows, Index n_columns);
        Eigen::Map<Eigen::MatrixXd> map() { return {entries_.first(), n_rows_, n_columns_}; }
        double& operator()(Index row, Index column) { return entries_.first()[row + n_rows_ * column]; }
        const double* column(Index j) const { return entries_.first() + n_rows_ * j; }

    private:
        ArenaList<double> entries_;
        Eigen::Index n_rows_ = 0, n_columns_ = 0;
    };
    struct Front {
        ArenaList<Index> unknown;    // those that are eliminated come first
        Index n_eliminated = 0;
        DenseMatrix L;               // lower half: L, and L_B below it
        DenseMatrix left_over;       // lower half
        Index size() const { return static_cast<Index>(unknown.size()); }
        Index n_left() const { return size() - n_eliminated; }
        std::span<const Index> eliminated() const { return unknown.entries().first(n_eliminated); }
        std::span<const Index> left() const { return unknown.entries().subspan(n_eliminated); }
    };

    /// Room for as many unknowns as there can be, in what one front after the other is made of.
    void make_room_for(std::size_t n_unknowns);

    void find_unknowns(Index part, const std::vector<Index>& eliminated_in);
    void assemble(Index part);
    void add_left_over(const Front& half, Front& front);
    static double& entry(Front& front, Index row, Index column);
    static bool eliminate(Front& front);
    void gather(const Front& front, const std::vector<double>& x) const;  // into local_

    const Dissection& dissection_;
    Arena arena_;                      // of the fronts: a crack makes them grow, node by node
    std::vector<Front> fronts_;        // per part
    std::vector<std::uint8_t> stale_;  // per part
    std::vector<Index> place_;         // per unknown: in the front that is being made, or -1
    std::vector<Index> place_above_;   // per unknown left over by a half: in the front that is being made
    std::vector<Index> own_, left_;    // unknowns of the front that is being made
    std::vector<Element> elements_;
    mutable Eigen::VectorXd local_;
};

}  // namespace knap
