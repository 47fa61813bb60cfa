#pragma once
// A fan whose cohesion falls within the step (implicit beta with the explicit bulk):
//
//     forces with  beta_theta = theta beta+ + (1 - theta) beta,      beta+ = law at the end openings under these forces
//
// With a given beta+ the fan is the problem of fan_problem.hpp, so beta+ is a fixed point. One iteration contracts by
// theta h k S sigma_c/(delta_c m), small inside the stable step of a mesh that resolves the process zone. The iteration
// starts from beta+ = beta: where there are several solutions, nothing breaks below its strength.
#include "material/cohesive_law.hpp"
#include "nonsmooth/fan_solver.hpp"

namespace knap {

/// A link that has cohesion at the start of the step.
struct LinkCohesion {
    Index link;
    const CohesiveLaw* law;
    double start;      // [-] beta
    double strength;   // [N s] C with this beta
    double guess = 0;  // [-] beta+ that the forces are found with
};

/// The links come with the cohesive impulse of the start and leave with that of beta_theta. A fan that does
/// not settle is reported in the solution: a smaller step, in which the contraction is stronger, does. `rest`: as of
/// FanSolver::solve.
FanSolution solve_softening(SolvedFan& fan, FanSolver& solver, std::vector<LinkCohesion>& cohesion, double theta,
                            double rest = 0);

}  // namespace knap
