#include "stepper/contact/block_factor.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace knap {

void BlockFactor::start(Index n) {
    n_blocks_ = n;
    rows_.resize(n);
    for (auto& row : rows_) row.clear();
}

Index BlockFactor::add(Index row, Index column) {
    rows_[row].push_back({column, n_blocks_});
    return n_blocks_++;
}

Index BlockFactor::place_in(Index row, Index column) {
    if (row == column) return row;
    const auto found = std::ranges::find(rows_[row], column, &Entry::at);
    return found != rows_[row].end() ? found->place : add(row, column);
}

void BlockFactor::analyse() {
    pivots_.clear(), neighbours_.clear(), changed_.clear();
    std::vector<Index> left(rows_.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<Index>(i);
    while (!left.empty()) {
        const auto smallest = std::ranges::min_element(left, {}, [&](Index i) { return rows_[i].size(); });
        const Index pivot = *smallest;
        *smallest = left.back();
        left.pop_back();
        const std::size_t first = neighbours_.size();
        for (const Entry& entry : rows_[pivot]) {
            auto& row = rows_[entry.at];
            const auto below = std::ranges::find(row, pivot, &Entry::at);
            neighbours_.push_back({entry.at, below->place, entry.place});
            *below = row.back();
            row.pop_back();
        }
        for (std::size_t i = first; i < neighbours_.size(); ++i)
            for (std::size_t j = first; j < neighbours_.size(); ++j)
                changed_.push_back(place_in(neighbours_[i].row, neighbours_[j].row));
        pivots_.push_back({pivot, neighbours_.size()});
    }
}

bool BlockFactor::factorise() {
    std::size_t first = 0, change = 0;
    for (const Pivot& pivot : pivots_) {
        Eigen::Matrix2d& own = blocks_[pivot.row];
        if (own.determinant() == 0) return false;
        own = own.inverse().eval();
        for (std::size_t i = first; i < pivot.last; ++i) {
            Eigen::Matrix2d& below = blocks_[neighbours_[i].below];
            below *= own;
            for (std::size_t j = first; j < pivot.last; ++j)
                blocks_[changed_[change++]].noalias() -= below.lazyProduct(blocks_[neighbours_[j].right]);
        }
        first = pivot.last;
    }
    return true;
}

void BlockFactor::solve(Eigen::Ref<Eigen::VectorXd> b) const {
    std::size_t first = 0;
    for (const Pivot& pivot : pivots_) {
        const Vec2 known = b.segment<2>(2 * pivot.row);
        for (std::size_t i = first; i < pivot.last; ++i)
            b.segment<2>(2 * neighbours_[i].row) -= blocks_[neighbours_[i].below] * known;
        first = pivot.last;
    }
    for (std::size_t k = pivots_.size(); k-- > 0;) {
        Vec2 rest = b.segment<2>(2 * pivots_[k].row);
        for (std::size_t i = k > 0 ? pivots_[k - 1].last : 0; i < pivots_[k].last; ++i)
            rest -= blocks_[neighbours_[i].right] * b.segment<2>(2 * neighbours_[i].row);
        b.segment<2>(2 * pivots_[k].row) = blocks_[pivots_[k].row] * rest;
    }
}

}  // namespace knap
