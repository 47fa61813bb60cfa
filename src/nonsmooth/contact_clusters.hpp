#pragma once
// Rows that join the same things form a cluster. Clusters come in the order of their first row; rows and members of
// each in their own order.
#include "base/union_find.hpp"

#include <array>
#include <span>

namespace knap {

/// Keeps its memory from step to step.
class ContactClusters {
public:
    /// Members are of two kinds, each numbered from 0; for_members(row, visit) calls visit(kind, number) for those that
    /// a row joins. A row that joins none is in no cluster.
    template <class ForMembers>
    void find(Index n_rows, const std::array<Index, 2>& n_members, const ForMembers& for_members) {
        joined_.start(n_members[0] + n_members[1]);
        first_member_.assign(n_rows, -1);
        for (Index row = 0; row < n_rows; ++row)
            for_members(row, [&](int kind, Index number) {
                const Index member = number + (kind == 0 ? 0 : n_members[0]);
                if (first_member_[row] < 0) first_member_[row] = member;
                joined_.join(first_member_[row], member);
            });
        list(n_members);
    }
    std::size_t size() const { return size_; }
    std::span<const Index> rows(std::size_t cluster) const { return rows_[cluster]; }
    std::span<const Index> members(int kind, std::size_t cluster) const { return members_[kind][cluster]; }
    /// -1: none.
    Index of_row(Index row) const { return of_row_[row]; }

private:
    /// Numbers by cluster.
    struct Lists {
        std::vector<Index> all;
        std::vector<std::size_t> end;
        void read(std::span<const Index> cluster_of, std::size_t n_clusters);
        std::span<const Index> operator[](std::size_t cluster) const {
            const std::size_t first = cluster == 0 ? 0 : end[cluster - 1];
            return std::span(all).subspan(first, end[cluster] - first);
        }
    };
    void list(const std::array<Index, 2>& n_members);

    UnionFind joined_;
    std::vector<Index> first_member_, of_row_;  // per row
    std::vector<Index> of_member_;              // its cluster, or -1
    std::size_t size_ = 0;
    Lists rows_;
    std::array<Lists, 2> members_;
};

}  // namespace knap
