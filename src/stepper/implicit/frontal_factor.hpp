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
// Threads: parts of one level of the tree do not touch each other. But a crack changes the fronts from a few leaves to
// the root, of which the largest are on one path, so several threads also share the rows and columns of a large front.
// Every entry is one sum in a fixed order, and does not depend on their number.
//
// CHOLMOD's modified factor depends on its history, needs all unknowns beforehand, and allocates memory in the step;
// tools/bench/cholmod.csv compares the times.
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
    static constexpr Index panel = 16;  // columns of a Schur complement
    struct Front {
        ArenaList<Index> unknown;  // in the order of their elimination
        Index n_eliminated = 0;
        ArenaList<double> L;      // lower half, column by column: L, and L_B below it
        ArenaList<double> schur;  // likewise, in panels of columns that start with the row of their first one
        Index size() const { return static_cast<Index>(unknown.size()); }
        Index n_left() const { return size() - n_eliminated; }
        std::span<const Index> left() const { return unknown.entries().subspan(n_eliminated); }
        /// Its entry in a row is column(k)[row].
        double* column(Index k) {
            if (k < n_eliminated) return L.first() + size() * std::size_t(k);
            return schur_column(k - n_eliminated) - n_eliminated;
        }
        /// That is stored of it: of a column of L the first one, else that of its panel.
        Index first_row(Index k) const { return k < n_eliminated ? 0 : k - (k - n_eliminated) % panel; }
        /// Rows and columns counted from the first one that is left.
        double* schur_column(Index j) {
            const Index first = j - j % panel;
            return schur.first() + first_of_panel(j) + (n_left() - first) * std::size_t(j - first) - first;
        }
        /// Where the panel of column j begins.
        std::size_t first_of_panel(Index j) const {
            const std::size_t first = j - j % panel;
            return first * n_left() - first * (first - panel) / 2;
        }
    };
    /// A half of the part in work, whose unknowns have the same order in both.
    struct Half {
        Front* front;
        std::vector<Index> row;     // in the front of the part, of the unknowns that it leaves
        std::vector<Index> column;  // per column of this front: of these, or -1
    };
    /// Of a thread, for the front in work.
    struct alignas(128) Workspace {  // no cache line of two threads
        explicit Workspace(std::size_t n_numbers);
        std::vector<Index> place;    // per unknown: in the front, or -1
        std::vector<Index> unknown;  // of the front
        std::array<Half, 2> half;
        std::vector<Element> elements;  // of the leaf
        std::vector<double> local;      // right-hand side
        ArenaList<double> packed;       // columns of L
    };
    enum class Threads { one, all };
    template <class Work>
    static void divide(Threads threads, std::size_t n, std::size_t block, const Work& work);

    Workspace& workspace();
    void sort_by_level(std::span<const Index> parts);
    std::span<const Index> parts_of_level(std::size_t level) const;
    bool is_large(Index part) const;
    void find_unknowns(Index part, const std::vector<Index>& eliminated_in, Workspace& work);
    void assemble(Index part, Threads threads, Workspace& work);
    bool eliminate(Front& front, Threads threads, Workspace& work);
    void substitute_in_front(const Front& front, std::vector<double>& x);
    void substitute_back_in_front(const Front& front, std::vector<double>& x);
    double* load(const Front& front, const std::vector<double>& x);

    const FrontKernel kernel_;
    const Dissection& dissection_;
    Arena arena_;                      // of the fronts, which grow node by node with a crack
    std::vector<Front> fronts_;        // per part
    std::vector<std::uint8_t> stale_;  // per part
    const Threads threads_;            // of small bodies one
    std::vector<Index> level_;         // per part: number of the parts that contain it
    std::vector<Index> stale_parts_;
    std::vector<Index> by_level_;        // parts in work, those of a level in succession
    std::vector<Index> first_of_level_;  // into by_level_
    std::vector<Workspace> workspaces_;
};

}  // namespace knap
