#pragma once
// A run that starts from the state of another one (time.start = "run:DIR@40us").
//
//     taken over    displacements, velocities, cohesion and tractions of points, temperatures, incubation, retired
//                   points, contacts, obstacles, excavations, the mesh of [adapt], the size of the step
//     goes on       the energy balance from its first term, the arms of the cracks (with negative times)
//     begins anew   the time, at 0; tables, frames, probes, gauges, limits, counts of steps
//     must agree    the body: every key that is no load, time, output or motion of an obstacle
//
//     may be new    rotations large, contact between free faces, rigid pieces, further obstacles, times of excavations
//                   after its end, no heat, temperatures frozen: the energies of the same state change by what the
//                   balance calls assumptions
//
// After implicit steps an explicit run may start: both have the energies 1/2 v'Mv + 1/2 u'Ku of one moment. Velocities
// of the explicit bulk belong to the middle of a step: before implicit steps a last explicit one of nearly no length
// brings them to its end (stepper/scheme_change.hpp).
#include "app/run/checkpoint.hpp"
#include "scenario/read_scenario.hpp"
#include "stepper/moreau_jean.hpp"

#include <functional>

namespace knap {

/// The resolved scenario with the checksums of its files, and the works of it and of the run from which it starts.
/// Throws UserError where that run has another body, or a state from which this one cannot start.
RunOrigin origin_of(const ReadResult& read);

/// The state of the other run in the clock of this one.
struct StartState {
    /// `file`: of the state; `origin`: of this run. Model, excavations and refinements become those of its moment.
    StartState(const std::string& file, const RunOrigin& origin, const Scenario& scenario, Model& model,
               Excavations& excavations, Adaptation& adaptation);

    /// What the balance of the other run needs in addition, after reader.read_energies_and_cracks.
    void complete(Recorder& recorder) const;

    MemoryReader reader;  // its energies and cracks are next
    State now;
    StepControl control;        // of the other run
    double time = 0;            // [s] of the other run
    std::int64_t n_steps = 0;   // of the other run
    std::int64_t set_back = 0;  // steps
    struct StressAt {
        double largest = 0;  // [Pa]
        Vec2 place = Vec2::Zero();
    };
    std::optional<StressAt> lost_stress;    // of prevented thermal strains, where this run has no heat
    std::optional<StressAt> gained_stress;  // of turns that are strains with large rotations, where it matters

private:
    void add_obstacles(const Model& model);
    void find_gained_stress(const Model& model);
    void drop_heat(const Model& model);
    void begin_bulk(const Scenario& scenario, const Model& model);
    std::optional<StepReport> closing_;  // of the leapfrog, before implicit steps
    bool assumes_anew_ = false;          // what changes the energy of the same displacements
    std::size_t n_obstacles_ = 0;        // of the other run
};

/// The state at t = 0 of a run that starts from no other one. A body that its interfaces cannot hold in equilibrium has
/// failed before its first step. With [adapt] the equilibrium is found on meshes that are refined where it loads them,
/// until it asks for no finer one; `renew` makes the stepper of the present model. `tell`: of the search.
State start_of(Model& model, std::optional<MoreauJean>& stepper, bool in_equilibrium, Adaptation& adaptation,
               const std::function<void()>& renew, const TellSearch& tell, RunRecord& record);

/// A warning where the equilibrium took cohesion from interfaces, or nothing.
std::string start_damage_text(const Model& model, const State& start);

/// A warning for each prescribed displacement, and for the prescribed temperature, that does not begin where the other
/// run was, and for thermal stresses that vanish; `step` [s] is the first one.
std::string jumps_text(const ReadResult& read, const Model& model, const StartState& other, double step);

}  // namespace knap
