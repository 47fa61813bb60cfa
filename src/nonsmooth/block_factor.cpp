#include "nonsmooth/block_factor.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <limits>
#include <numeric>

namespace knap {

void BlockFactor::start(Index n) {
    n_blocks_ = n;
    rows_.assign(n, {});
    entries_.clear();
    after_.assign(n, -1);
}

Index BlockFactor::add(Index row, Index column) {
    auto& [first, n, room] = rows_[row];
    if (n == room) {
        room = std::max<std::size_t>(4, 2 * room);
        entries_.resize(entries_.size() + room);
        std::copy_n(entries_.begin() + static_cast<std::ptrdiff_t>(first), n,
                    entries_.end() - static_cast<std::ptrdiff_t>(room));
        first = entries_.size() - room;
    }
    entries_[first + n++] = {column, n_blocks_};
    return n_blocks_++;
}

Index BlockFactor::place_in(Index row, Index column) {
    if (row == column) return row;
    const auto found = std::ranges::find(entries(row), column, &Entry::at);
    return found != entries(row).end() ? found->place : add(row, column);
}

void BlockFactor::analyse() {
    pivots_.clear(), neighbours_.clear(), changed_.clear();
    left_.resize(rows_.size());
    std::iota(left_.begin(), left_.end(), 0);
    while (!left_.empty()) {
        const auto smallest = std::ranges::min_element(
            left_, {}, [&](Index i) { return after_[i] < 0 ? rows_[i].n : std::numeric_limits<std::size_t>::max(); });
        const Index pivot = *smallest;
        *smallest = left_.back();
        left_.pop_back();
        const std::size_t first = neighbours_.size();
        for (const Entry& entry : entries(pivot)) {
            const auto below = std::ranges::find(entries(entry.at), pivot, &Entry::at);
            neighbours_.push_back({entry.at, below->place, entry.place});
            *below = entries(entry.at).back();
            --rows_[entry.at].n;
            if (after_[entry.at] == pivot) after_[entry.at] = -1;
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
