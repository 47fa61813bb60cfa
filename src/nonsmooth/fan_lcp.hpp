#pragma once
// The problem of one fan (fan_problem.hpp) as a linear complementarity problem, for the fans whose active set cycles.
// Unbreakable links make clusters; V = W P + V_free between clusters (staircase_lcp.hpp).
#include "nonsmooth/fan_clusters.hpp"
#include "nonsmooth/staircase_lcp.hpp"

#include <optional>

namespace knap {

/// Keeps its memory from one problem to the next.
class FanLcp {
public:
    /// The residual of the scaled complementarity problem, and the motion, in which impulses of unbreakable links are
    /// zero. Nothing where Lemke's paths end without a solution. Reads the law of each state (of unbreakable links
    /// not). `speed` [m/s]: the scale of the problem.
    std::optional<double> solve(const FanProblem& problem, const std::vector<LinkState>& states, double speed,
                                FanMotion& motion);

private:
    FanClusters clusters_;  // joined by unbreakable links
    StaircaseLcp lcp_;
};

}  // namespace knap
