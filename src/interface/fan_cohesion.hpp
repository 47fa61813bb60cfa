#pragma once
// A fan whose cohesion falls within the step (implicit beta with the explicit bulk): the smallest problem of its kind.
//
//     forces with  beta_theta = theta beta+ + (1 - theta) beta,      beta+ = law at the end openings that they lead to
//
// With a given beta+ the fan is the problem of fan_problem.hpp; beta+ is a fixed point of solving that. One sweep contracts by
// theta h k S sigma_c/(delta_c m), small inside the stable step of a mesh that resolves the process zone; a secant over all links of the fan (mixing of
// depth one, D. G. Anderson, J. ACM 12, 1965) makes it exact in three solves where one link softens. It starts from the cohesion of the begin, so
// what can hold does hold: nothing breaks below its strength where there are several solutions.
#include "interface/fan_solver.hpp"
#include "material/cohesive_law.hpp"

#include <vector>

namespace knap {

/// A link that has cohesion at the begin of the step.
struct LinkCohesion {
    Index link;
    const CohesiveLaw* law;
    double begin;        // [-] beta
    double strength;     // [N s] C with the beta of the begin
    double guess = 0;    // [-] of beta+: the forces were found with it
    double answer = 0;   // [-] beta+ by the law
    double last_gap = 0, last_answer = 0;  // answer - guess, and answer, of the solve before

    double gap() const { return answer - guess; }
};

/// Links of `problem` come with the cohesive impulse of the begin and leave with that of beta_theta. A fan that does not settle says so: a smaller
/// step, in which h k is smaller still, does.
FanSolution solve_softening(FanProblem& problem, FanSolver& solver, std::vector<LinkCohesion>& cohesion, double theta);

}  // namespace knap
