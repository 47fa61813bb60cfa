#pragma once
// The discrete model: immutable once made. What changes during a run is State; only an excavation or a refined mesh
// replaces the model by its successor (successor.hpp).
//
// Every triangle owns its corners (mesh.hpp). Every interior edge, and every boundary edge on a support, is an
// interface with points (nodal quadrature): of order 1 two, one at each end, of area S = 1/2 length x thickness; of
// order 2 also one in the middle, of areas 1/6, 1/6 and 4/6 (Simpson). Point p = points_per_interface() interface +
// place; places 0 and 1 are the ends, 2 is the middle.
//
// A fan consists of the corners round a mesh vertex, counterclockwise, and the points between them; or of the one or
// two corners in the middle of an edge and their point; or of the centre of a triangle.
#include "element/elastic_of.hpp"
#include "material/cohesive_law.hpp"
#include "material/strength_over_bedding.hpp"
#include "microstructure/scatter.hpp"
#include "model/ground.hpp"
#include "model/heat.hpp"
#include "model/loads.hpp"
#include "model/obstacle.hpp"

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

namespace knap {

struct State;

inline constexpr Index rigid_support = -1;  // stands for the rigid support where a corner or a triangle is expected

struct Interface {
    std::array<Index, 2> triangle;  // sides A and B; side A may be the support
    std::array<Index, 2> vertex;    // the two ends
    Vec2 normal;                    // N, from side A to side B; T = turned_left(N)
    double length;                  // [m]
    Index law;                      // into Model::laws
    Index joint_law : 31;           // that of the joint here, one number where its strength is random; -1: no joint
    bool cracked : 1;               // no cohesion from the start
    double gap;                     // [m] initial opening (supports only)
    double beyond = 0;              // [m] how far the ground goes on straight where the support ends (supports only)
};
static_assert(sizeof(Interface) == 64);  // a million triangles have 1.5 million

/// An interface point between the corners `before` and `after` (counterclockwise); either may be the support.
struct FanPoint {
    Index before, after;
    Index point;       // points_per_interface() interface + place
    Index law : 31;    // into Model::laws
    bool cracked : 1;  // no cohesion from the start
    Vec2 normal;       // N, from before to after; T = turned_left(N)
    double area;       // [m2] S
    double gap;        // [m] initial opening

    bool on_support() const { return before == rigid_support || after == rigid_support; }
    /// A corner of the point that is no support.
    Index corner() const { return after == rigid_support ? before : after; }
};
static_assert(sizeof(FanPoint) == 48);  // three quarters of a cache line: tests of candidate fans read all of them

/// In a closed fan point i lies before corner i; an open fan has n_corners - 1 points, and one more per support.
struct Fan {
    Index vertex;                   // or -1: the middle of an edge, the centre of a triangle
    Index first_corner, n_corners;  // into Model::fan_corners
    Index first_point, n_points;    // into Model::fan_points
    bool closed;                    // the last point leads back to the first corner
    bool split_at_start;            // has a cracked point or a support
    double mass;                    // [kg] sum of its corner masses
};

/// Force on a corner times a history: constant, or a function of the state.
struct CornerLoad {
    Index corner;
    Index history;            // into Model::histories
    Vec2 force;               // [N]; one that depends on the state: that of the body at rest where it starts
    Index state_force = -1;   // into Model::state_forces, if it depends on the state
    bool is_release = false;  // a force of what was excavated, which fades; its history follows those of the scenario

    bool depends_on_state() const { return state_force >= 0; }
};

/// [N] A force on a corner that depends on u or v (a stress that follows its face, a bedding, drag), or on the time not
/// by a factor alone, for a history of 1. The explicit scheme takes it at the start of the step, the implicit one at
/// u + theta h v (so that a spring keeps its energy with theta = 1/2); its work is one of loads. The stable step does
/// not know it: beside the mass m of a corner its stiffness k and viscosity c must keep k h^2 and c h below m.
using StateForce = std::function<Vec2(const State& state, double time)>;

/// A fluid in cracks on the mesh (CrackPressure).
struct CrackFluid {
    CrackPressure given;
    Index history;                         // into Model::histories; 1 everywhere where the fluid is injected
    std::vector<std::uint8_t> is_source;   // [0/1] per mesh vertex
    std::vector<Index> joint_points;       // it presses on them, broken or not
    std::optional<double> only_time = {};  // [s] for ever: in equilibrium
};

/// Prescribed motion of a corner in x, y or both. All corners of a bonded fan have the same.
struct PrescribedMotion {
    Index fan;
    std::array<bool, 2> component;
    std::array<Index, 2> history;  // into Model::histories, per component
    Vec2 value;                    // [m/s] or [m]
    std::array<bool, 2> is_displacement;

    /// Prescribed rate of component k; `displacement` [m] at the start of the step.
    PrescribedRate rate(int k, const std::vector<TimeFunction>& histories, double displacement,
                        const StepTimes& step) const {
        return prescribed_rate(is_displacement[k], value[k], histories[history[k]], displacement, step);
    }
};

struct ModelInput {
    Mesh mesh;
    PlaneModel plane = PlaneModel::strain;
    double thickness = 1;            // [m]
    std::vector<Elastic> materials;  // by Mesh::region
    std::vector<CohesiveLaw> laws;
    std::vector<std::vector<Index>> law_of_pair;    // law_of_pair[material a][material b], symmetric
    std::vector<Index> law_of_joint;                // by number of the joint set
    std::vector<Index> law_within;                  // within a grain, by material; needed where the mesh has grains
    std::vector<Scatter> scatter;                   // by law; empty = no law scatters
    std::uint64_t seed = 1;                         // of the scatter
    std::vector<StrengthOverBedding> over_bedding;  // by law; empty = no law follows the layers
    // [deg] by material, null where the layers have the angle of the material; makes Mesh::layer_angle
    std::vector<std::shared_ptr<const PlaceField>> layer_angle;
    std::vector<Load> loads;
    std::vector<CrackPressure> crack_pressures;
    std::vector<Support> supports;
    std::vector<InitialVelocity> initial_velocities;
    std::vector<InitialStress> initial_stresses;
    std::vector<Obstacle> obstacles;
    bool large_rotation = false;                           // as in Model
    std::vector<std::vector<ContactLaw>> contact_of_pair;  // as in Model
    std::shared_ptr<const Heat> heat;                      // as in Model
    double mass_scaling = 0;              // [-] part of the mass that may move to triangles which limit the step
    std::vector<std::vector<Vec2>> cuts;  // [m] polygons which will be excavated: no mass moves into or out of them
};

struct Model {
    Mesh mesh;
    PlaneModel plane;
    double thickness;  // [m]
    std::vector<Elastic> materials;
    std::vector<CohesiveLaw> laws;         // those of the input, then one for each interface whose strength is its own
    bool laws_follow_temperature = false;  // some of them, with heat: law_of(state) has the law of the moment

    // [-] per triangle: its mass over that of its material (mass_scaling.hpp); empty: 1
    std::vector<double> mass_factor;
    std::vector<double> corner_mass;  // [kg] per corner: that of its triangle times its share (corner_share)
    std::vector<Interface> interfaces;
    std::vector<Fan> fans;
    std::vector<Index> fan_corners;
    std::vector<FanPoint> fan_points;
    std::vector<Index> fan_of_corner;
    std::vector<Index> fan_point_of;  // per point: its index in fan_points; -1 on an interface that is gone

    std::vector<TimeFunction> histories;   // of the loads, of an initial stress, of the crack fluids, in their order;
                                           // then those of excavations
    std::vector<std::string> load_names;   // likewise
    std::vector<CornerLoad> corner_loads;  // in the order of the corners
    std::vector<StateForce> state_forces;
    std::vector<CrackFluid> crack_fluids;
    std::vector<PrescribedMotion> prescribed;
    std::vector<Index> prescribed_of_corner;  // per corner: into `prescribed`, or -1
    std::vector<Vec2> initial_velocity;       // [m/s] per corner; equal where corners move as one; empty: zero
    // [Pa] xx, yy, xy of the undeformed body, per triangle (order 2: at the middles of its edges); empty: none. Its
    // forces are among corner_loads, so that its work is one of loads and the elastic energy counts from there.
    std::vector<std::array<double, 3>> initial_stress;
    Index history_of_initial_stress = -1;  // of these forces, into `histories`
    std::vector<Obstacle> obstacles;
    bool large_rotation = false;  // Green's strain and turned fans; else all rotations are small
    std::vector<std::vector<ContactLaw>> contact_of_pair;  // [material][material], symmetric; or empty: faces_meet()
    Ground ground;                                         // the supports, with contact; its vertices are numbered
                                                           // behind the corners
    std::shared_ptr<const Heat> heat;                      // null: no temperatures
    // Excavated triangles keep their numbers, and so do their corners and interfaces, so that all numbers hold for the
    // whole run. Their interfaces have no points, and each of their corners is a fan of its own without forces, at rest
    // in its first place: a step does nothing there.
    std::vector<std::uint8_t> vanished;  // [0/1] per triangle; empty: nothing was excavated
    // A step in which such a fan splits is rejected, so that the mesh becomes finer there first.
    std::vector<std::uint8_t> too_coarse;  // [0/1] per fan; empty: the mesh does not change

    Index points_per_interface() const { return mesh.order + 1; }
    Index n_points() const { return points_per_interface() * static_cast<Index>(interfaces.size()); }
    Index interface_of(Index point) const { return point / points_per_interface(); }
    /// Null where the number is that of a corner.
    const GroundVertex* ground_at(Index corner) const {
        return corner < mesh.n_corners() ? nullptr : &ground.vertices[corner - mesh.n_corners()];
    }
    /// Free faces that are no neighbours meet, [contact].
    bool faces_meet() const { return !contact_of_pair.empty(); }
    bool has_injected_fluids() const {
        return std::ranges::any_of(crack_fluids, [](const CrackFluid& fluid) { return fluid.given.is_injected(); });
    }
    bool may_become_finer() const { return !too_coarse.empty(); }
    bool has_vanished(Index triangle) const { return !vanished.empty() && vanished[triangle]; }
    /// One of its triangles was excavated, so it has no points any more.
    bool is_gone(const Interface& interface) const {
        const auto gone = [&](Index triangle) { return triangle != rigid_support && vanished[triangle]; };
        return !vanished.empty() && (gone(interface.triangle[0]) || gone(interface.triangle[1]));
    }
    Elastic elastic(Index triangle) const { return elastic_of(mesh, materials, triangle); }
    /// [kg] Of its material: that which takes up heat.
    double material_mass(Index triangle) const {
        return materials[mesh.region[triangle]].density * mesh.area(triangle) * thickness;
    }
    /// [kg] Which moves and has weight.
    double triangle_mass(Index triangle) const {
        return mass_factor.empty() ? material_mass(triangle) : mass_factor[triangle] * material_mass(triangle);
    }
    std::span<const Index> corners(const Fan& fan) const {
        return {fan_corners.data() + fan.first_corner, std::size_t(fan.n_corners)};
    }
    std::span<const FanPoint> points(const Fan& fan) const {
        return {fan_points.data() + fan.first_point, std::size_t(fan.n_points)};
    }
    Vec2 initial_velocity_of(Index corner) const {
        return initial_velocity.empty() ? Vec2(Vec2::Zero()) : initial_velocity[corner];
    }
    /// Null where nothing is prescribed.
    const PrescribedMotion* motion_of(Index corner) const {
        const Index motion = prescribed.empty() ? -1 : prescribed_of_corner[corner];
        return motion < 0 ? nullptr : &prescribed[motion];
    }
};

/// A point that sticks for ever: it is no crack, and its law has infinite strength.
inline bool unbreakable(const Model& model, const FanPoint& point) {
    return !point.cracked && !model.laws[point.law].breakable();
}

}  // namespace knap
