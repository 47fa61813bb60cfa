#pragma once
// Disjoint sets of the numbers 0 to n - 1. The lowest member of a set is its representative, in any order of the joins.
#include "base/vec.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace knap {

class UnionFind {
public:
    explicit UnionFind(std::size_t n = 0) { start(n); }
    /// Every number alone.
    void start(std::size_t n) {
        parent_.resize(n);
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    /// The lowest member of the set of i. Halves the path on the way.
    Index find(Index i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }

    /// False where both were in one set already.
    bool join(Index i, Index j) {
        const auto [low, high] = std::minmax({find(i), find(j)});
        parent_[high] = low;
        return low != high;
    }

    void serialize(auto& archive) { archive(parent_); }

private:
    std::vector<Index> parent_;
};

}  // namespace knap
