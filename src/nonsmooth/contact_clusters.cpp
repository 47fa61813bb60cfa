#include "nonsmooth/contact_clusters.hpp"

#include <numeric>

namespace knap {

void ContactClusters::Lists::read(std::span<const Index> cluster_of, std::size_t n_clusters) {
    end.assign(n_clusters + 1, 0);
    for (const Index k : cluster_of)
        if (k >= 0) ++end[k + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    all.resize(end.back());
    for (Index i = 0; i < std::ssize(cluster_of); ++i)
        if (cluster_of[i] >= 0) all[end[cluster_of[i]]++] = i;
}

void ContactClusters::list(const std::array<Index, 2>& n_members) {
    size_ = 0;
    of_member_.assign(n_members[0] + n_members[1], -1);  // of representatives, then of all
    of_row_.assign(first_member_.size(), -1);
    for (std::size_t row = 0; row < of_row_.size(); ++row) {
        if (first_member_[row] < 0) continue;
        Index& found = of_member_[joined_.find(first_member_[row])];
        if (found < 0) found = static_cast<Index>(size_++);
        of_row_[row] = found;
    }
    for (Index member = 0; member < std::ssize(of_member_); ++member)
        of_member_[member] = of_member_[joined_.find(member)];
    rows_.read(of_row_, size_);
    const std::span<const Index> all(of_member_);
    members_[0].read(all.first(n_members[0]), size_);
    members_[1].read(all.subspan(n_members[0]), size_);
}

}  // namespace knap
