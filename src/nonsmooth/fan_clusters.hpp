#pragma once
// Bodies of a fan that stick to each other form clusters. A cluster has one velocity; the velocity of a body is that of
// its cluster plus a known offset. The support is a body (number -1) of its own cluster.
#include "nonsmooth/fan_problem.hpp"

#include <cstdint>
#include <vector>

namespace knap {

/// Keeps its memory from one problem to the next.
class FanClusters {
public:
    /// Every body is a cluster. The problem must outlive the use of this object.
    void start(const FanProblem& problem);
    /// The body after the link now moves with the one before it, at the relative velocity `jump` [m/s]. False: they
    /// already move together at another one.
    bool join(const FanLink& link, const Vec2& jump, double tolerance);
    /// Velocities under the `known` impulses [N s] of links: V = sum (m (v_free - offset) + P) / sum m. Prescribed
    /// components, and the support, prescribe those of their cluster; false where two of them differ.
    bool find_velocities(const std::vector<Vec2>& impulse, const std::vector<std::uint8_t>& known, double tolerance);
    /// The change of velocity by one more impulse [N s] of a link.
    void apply(const FanLink& link, const Vec2& impulse);

    bool has_one(const FanLink& link) const { return of(link.after) == of(link.before); }
    Vec2 velocity_of(Index body) const { return velocity_[of(body)] + offset_[at(body)]; }
    /// [m/s] relative velocity of the sides of a link
    Vec2 across(const FanLink& link) const {
        return velocity_[of(link.after)] + offset_[at(link.after)] - velocity_[of(link.before)] -
               offset_[at(link.before)];
    }
    /// [1/kg] sum over the two sides
    Vec2 inverse_mass(const FanLink& link) const {
        return inverse_mass_[of(link.after)] + inverse_mass_[of(link.before)];
    }
    /// [m/s] relative velocity of the sides of a link due to an impulse of another one
    Vec2 response(const FanLink& link, const FanLink& other, const Vec2& impulse) const;

private:
    Index at(Index body) const { return body < 0 ? static_cast<Index>(cluster_.size()) - 1 : body; }
    Index of(Index body) const { return cluster_[at(body)]; }

    const FanProblem* problem_ = nullptr;
    std::vector<Index> cluster_;  // per body, then of the support
    std::vector<Index> next_;     // likewise: another body of the cluster, in a circle through all of them
    std::vector<Vec2> offset_;    // [m/s] likewise
    std::vector<Vec2> velocity_, inverse_mass_;  // [m/s], [1/kg] per cluster
};

}  // namespace knap
