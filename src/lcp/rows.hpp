#pragma once
// Ways through a row of a matrix that is dense in blocks, as those of cohesive steps are: most of its entries are
// passed in one stride or in runs without gaps, which take a part of the time of a loop over single entries.
#include "lcp/problem.hpp"

#include <algorithm>
#include <vector>

namespace knap {

using RowValues = Eigen::Map<const Eigen::ArrayXd>;

/// Calls action(first, length) for the runs of entries whose columns have no gap between them, in their order.
template <class Action>
void for_each_run(const LcpRow& row, const Action& action) {
    const auto size = static_cast<int>(row.size());
    const int* columns = row.columns.data();
    for (int first = 0, end = 1; first < size; first = end++) {
        const auto reaches = [&](int last) { return last < size && columns[last] - columns[first] == last - first; };
        int step = 1;
        for (; reaches(end + step - 1); step *= 2) end += step;
        for (; step > 0; step /= 2)
            if (reaches(end + step - 1)) end += step;
        action(first, end - first);
    }
}

/// A set of columns, whose entries in a row are found without a look at all others.
class ColumnSet {
public:
    /// The columns c of n for which contains(c) holds.
    template <class Contains>
    ColumnSet(int n, const Contains& contains) : next_(n + 1, n) {
        for (int c = n - 1; c >= 0; --c) next_[c] = contains(c) ? c : next_[c + 1];
    }

    /// The first entry of the row, from `entry` on, in a column of the set; the size of the row where there is none.
    int first(const LcpRow& row, int entry) const {
        const auto size = static_cast<int>(row.size());
        const int* columns = row.columns.data();
        while (entry < size) {
            const int column = columns[entry], wanted = next_[column];
            if (wanted == column) return entry;
            const int end = std::min(size, entry + wanted - column);  // columns increase: it is here or before
            entry = columns[end - 1] < wanted
                        ? end
                        : static_cast<int>(std::lower_bound(columns + entry + 1, columns + end, wanted) - columns);
        }
        return size;
    }

    /// Calls action(entry) for the entries of the row in these columns.
    template <class Action>
    void for_each(const LcpRow& row, const Action& action) const {
        for (int e = first(row, 0); e < static_cast<int>(row.size()); e = first(row, e + 1)) action(e);
    }

private:
    std::vector<int> next_;  // [n + 1] the first column of the set that is not before; n: none
};

}  // namespace knap
