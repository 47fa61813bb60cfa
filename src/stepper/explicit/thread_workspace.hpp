#pragma once
// What a thread needs for fans and contacts, and the exact test of a bonded fan, which uses it.
#include "nonsmooth/contact_problem.hpp"
#include "stepper/common/bond_check.hpp"
#include "stepper/explicit/vertex_solver.hpp"

namespace knap {

struct alignas(128) ThreadWorkspace {  // no cache line of two threads
    explicit ThreadWorkspace(const Model& model) : bond_check(model) {}

    std::vector<Vec2> force;     // [N] on the corners of a block of triangles
    std::vector<Vec2> required;  // [N] per corner of a fan, from its points
    std::vector<Vec2> rate;      // [m/s] per contact of a cluster
    BondCheck bond_check;
    VertexSolver::Workspace split;
    ContactProblem contacts;

    /// Finds `required` of fan f that moves as one under force_on(i) [N] on its corner i, `total` on all. `mass` [kg]
    /// per corner, in the order of Model::fan_corners.
    template <class Force>
    void find_required(const Model& model, Index f, const State& begin, const std::vector<double>& mass,
                       const Force& force_on, const Vec2& total) {
        const Fan& fan = model.fans[f];
        const PrescribedMotion* motion = model.motion_of(model.corners(fan)[0]);
        const Vec2 acceleration = total / fan.mass;
        required.resize(fan.n_corners);
        for (Index i = 0; i < fan.n_corners; ++i) {
            required[i] = mass[fan.first_corner + i] * acceleration - force_on(i);
            for (int k = 0; k < 2 && motion; ++k)
                if (motion->component[k]) required[i][k] = 0;  // the drive of each corner supplies it
        }
        if (model.large_rotation) {  // the strengths are those of the normals at the start
            const Rotation frame = fan_frame(model, begin, fan);
            for (Vec2& at_corner : required) at_corner = frame.turned_back(at_corner);
        }
    }
    /// Whether such a fan stays bonded.
    template <class Force>
    bool is_bonded(const Model& model, Index f, const State& begin, const std::vector<double>& mass,
                   const Force& force_on, const Vec2& total) {
        find_required(model, f, begin, mass, force_on, total);
        return bond_check.is_bonded(f, begin, required, 1);
    }
};

}  // namespace knap
