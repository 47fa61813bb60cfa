#pragma once
// The problem of one fan (fan_problem.hpp) as a linear complementarity problem, for the fans whose active set cycles.
//
// Unbreakable links make clusters; V = W P + V_free between clusters. Every term  r in w sgn(V_T - k)  of a tangential law, w = w0 + w1 p,
// is a friction law of its own with P_T = sum (a - c)  (D. E. Stewart, J. C. Trinkle 1996):
//     0 <= p  perp  V_N - b >= 0,    0 <= a  perp  V_T - k + y >= 0,    0 <= c  perp  -(V_T - k) + y >= 0,    0 <= y  perp  w - a - c >= 0
#include "interfaces/fan_problem.hpp"
#include "interfaces/link_law.hpp"

#include <vector>

namespace knap {

struct FanLcpSolution {
    bool solved = false;
    double residual = 0;         // of the complementarity problem, scaled
    std::vector<Vec2> velocity;  // [m/s] end velocity per body
    std::vector<Vec2> impulse;   // [N s] per link; zero for unbreakable ones
};

/// `laws`: one per link (not read for unbreakable ones). `speed` [m/s]: the scale of the problem.
FanLcpSolution solve_fan_lcp(const FanProblem& problem, const std::vector<LinkLaw>& laws, double speed);

}  // namespace knap
