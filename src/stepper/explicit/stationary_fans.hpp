#pragma once
// Fans that came apart and now rest in parts that move as one: where cohesion fell a little beside the crack and the points closed again (two thirds of all in
// the edge-cracked block), or where the crack went through and its faces fly freely (half of the others). Every point of such a fan is either held, that is
// closed and at the kink of its friction and of its cohesion at once, or open without cohesion. So the one linear system of the fan solver
// (interface/fan_solver.hpp) is: one velocity for each part, the impulses by walking the chain from an open point on; where none is open, with the
// self-stress of least norm.
//
//     V = sum m_i v_i_free / sum m_i,     P_after = P_before - m_i (V - v_i_free),     P = 0 where it is open
//
// With the operations in the solver's order the bits of the motion are the solver's. What these impulses do not hold, or what closes, is the solver's business.
#include "model/state.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/scheme_options.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/explicit/free_motion.hpp"

#include <cstdint>
#include <vector>

namespace knap {

class StationaryFans {
public:
    /// One fan at a time; one a thread.
    struct Workspace {
        std::vector<Index> node, part;        // per corner
        std::vector<std::uint8_t> is_open;    // per point
        std::vector<double> bound;            // [m/s] per point, of an open one: below it the sides would touch
        Index first_open, n_parts;            // point, or -1; the last part may be empty
        std::vector<Vec2> velocity;           // [m/s] per part
        std::vector<double> mass;             // [kg] per part
        std::vector<Vec2> required, impulse;  // [N s] per corner, per point
    };

    /// `mass` [kg]: of the corners, in the order of Model::fan_corners. It and `contacts`, those of the step, must outlive this.
    StationaryFans(const Model& model, CohesionScheme cohesion, const std::vector<double>& mass, const ObstacleContacts& contacts)
        : model_(model), cohesion_(cohesion), mass_(mass), contacts_(contacts) {}

    /// False: the fan is not stationary, or does not stay so in its parts; then nothing is written.
    bool advance(Index rank, const State& begin, const FreeMotion& free, State& end, Workspace& work, StepReport& report) const;

private:
    /// Which corners move as one. False: the fan has points that are neither held nor freely open, or something acts on it from beside.
    bool find_parts(Index rank, const State& begin, double h, Workspace& work) const;

    const Model& model_;
    CohesionScheme cohesion_;
    const std::vector<double>& mass_;
    const ObstacleContacts& contacts_;
};

}  // namespace knap
