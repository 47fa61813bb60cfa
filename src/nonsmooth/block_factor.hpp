#pragma once
// LU factor of a matrix of 2x2 blocks with a symmetric pattern, without pivoting beyond the blocks: that of a cluster
// of contacts. The order of elimination (minimum degree) and the places of all blocks depend on the pattern alone and
// serve for every set of values, so a factorisation is one pass over a list.
#include "base/vec.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace knap {

class BlockFactor {
public:
    /// A pattern of n rows with diagonal blocks only.
    void start(Index n);
    /// Adds the block of a row and another column, which nobody has added, and returns its place.
    Index add(Index row, Index column);
    /// The pivot of a row comes after that of another one, without which it is singular. Once for each row.
    void eliminate_after(Index row, Index other) { after_[row] = other; }
    /// When all are added: finds the order and the blocks that fill.
    void analyse();

    /// The blocks in their places, diagonal ones at the numbers of their rows: zero after clear().
    void clear() { blocks_.assign(n_blocks_, Eigen::Matrix2d::Zero()); }
    Eigen::Matrix2d& block(Index place) { return blocks_[place]; }
    /// False if a pivot is singular.
    bool factorise();
    /// b becomes the solution; two numbers for each row.
    void solve(Eigen::Ref<Eigen::VectorXd> b) const;

private:
    struct Entry {
        Index at, place;  // column, or row; of its block
    };
    struct Neighbour {
        Index row, below, right;  // another row; places of its block left of the pivot, and of that above it
    };
    struct Pivot {
        Index row;
        std::size_t last;  // into neighbours_
    };
    /// The blocks of a row that are not eliminated, without the diagonal: in entries_.
    struct Row {
        std::size_t first = 0, n = 0, room = 0;
    };
    std::span<Entry> entries(Index row) { return {entries_.data() + rows_[row].first, rows_[row].n}; }
    Index place_in(Index row, Index column);

    Index n_blocks_ = 0;
    std::vector<Row> rows_;
    std::vector<Entry> entries_;
    std::vector<Index> after_;  // per row: the other one, or -1
    std::vector<Index> left_;   // rows without a pivot
    std::vector<Pivot> pivots_;
    std::vector<Neighbour> neighbours_;
    std::vector<Index> changed_;  // places of the blocks that each pivot changes, rows of neighbours_ times columns
    std::vector<Eigen::Matrix2d> blocks_;
};

}  // namespace knap
