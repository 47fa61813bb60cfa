#pragma once
// A fan with corners that contacts touch (vertex_contacts.hpp), as it answers to their impulses: with the masses of its
// parts, or where these cannot stay as they are, by its solution.
#include "stepper/explicit/thread_workspace.hpp"

namespace knap {

struct TouchedFan {
    Index fan;
    bool solved_jointly = false;  // its points are solved with the contacts
    std::vector<Index> corners;   // touched
    std::vector<Index> part;      // per corner of a fan that is not solved jointly
    std::vector<Index> body;      // per touched corner: its number in the problem
    std::vector<Vec2> velocity;   // [m/s] per touched corner, under the present impulses
    VertexSolver::Known known;    // solved jointly: under these impulses
};

/// Its parts at the start of the step, and whether it is solved jointly.
void find_parts(const Model& model, const VertexSolver& solver, TouchedFan& touched, const ExplicitStep& step,
                ThreadWorkspace& work);
/// Its points are solved with the contacts; sets `splits` [0/1] of a bonded fan.
void solve_jointly(TouchedFan& touched, const State& begin, std::vector<std::uint8_t>& splits);
bool keeps_its_parts(const Model& model, const TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work,
                     StepReport& report);
void solve_fan(const Model& model, const VertexSolver& solver, TouchedFan& touched, const ExplicitStep& step,
               VertexSolver::Workspace& work);
void add_parts(const Model& model, TouchedFan& touched, const ExplicitStep& step, ContactProblem& problem);

}  // namespace knap
