#pragma once
// All that changes during a run, and all that a restart needs.
#include "model/model.hpp"
#include "model/rigid_body.hpp"
#include "model/temperatures.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace knap {

/// The state of one point of a split fan.
struct PointState {
    double cohesion;             // [-] beta
    Vec2 traction;               // [Pa] (N, T) on the side `after`, mean over the last step
    double largest_opening = 0;  // [m] kappa: the largest s, of secant unloading where works ended
    double slid = 0;             // [m] way of the slip so far, where friction follows it

    template <class Archive>
    void serialize(Archive& archive) {
        archive(cohesion, traction, largest_opening, slid);
    }
};

/// Overload of a fan whose laws have an incubation time (stepper/explicit/incubation.hpp).
struct Incubation {
    double memory = 0;       // [-] q
    double utilisation = 0;  // [-] U, when it was found last
    double time = 0;         // [s] of that
    double factor = 1;       // [-] phi on sigma_c and G_c of its points, frozen when it splits

    template <class Archive>
    void serialize(Archive& archive) {
        archive(memory, utilisation, time, factor);
    }
};

/// What became of a point between faces that may meet others ([contact]); it never goes back.
enum class Retirement : std::uint8_t {
    none,     // it joins its sides, which touch nothing else
    retired,  // its sides meet as free faces
    parted,   // it still joins its sides, which touch others apart
    meeting   // likewise, and corners of its fan that are no neighbours meet as free faces
};

/// A contact between a boundary vertex and a boundary edge in the last step.
struct FaceContactState {
    Index vertex, edge;          // corners: the start of the boundary edge that leaves the vertex, that of the edge
    Index entering;              // the end of the boundary edge that enters the vertex
    double contact, tangential;  // [N s] its force along the normal and along the edge, on the vertex, times the step

    template <class Archive>
    void serialize(Archive& archive) {
        archive(vertex, edge, entering, contact, tangential);
    }
};

/// A contact of the body with an obstacle that carried an impulse in the last explicit step, one that
/// stepper/explicit/vertex_contacts.hpp solves: where its next solution starts.
struct ObstacleContactState {
    Index corner, second_corner, obstacle;  // second_corner: of an edge, or -1
    double contact, tangential;             // [N s]

    template <class Archive>
    void serialize(Archive& archive) {
        archive(corner, second_corner, obstacle, contact, tangential);
    }
};

/// A piece that nothing holds, at the start of the last step (stepper/explicit/free_pieces.hpp).
struct PieceMotion {
    Index first_triangle;     // its lowest one
    double mass;              // [kg]
    Vec2 momentum;            // [kg m/s]
    double angular_momentum;  // [kg m2/s] about its centre of mass

    template <class Archive>
    void serialize(Archive& archive) {
        archive(first_triangle, mass, momentum, angular_momentum);
    }
};

/// A piece and what it hits, while an impact lasts (stepper/explicit/rebounds.hpp).
struct Impact {
    Index piece, other;     // the lowest triangles of the pieces; other < 0: obstacle -1 - other
    double start, touched;  // [s] when it began, and when they touched last
    double approach, slip;  // [m/s] of the rigid motions at the contact: the fastest approach, the slip at the start

    template <class Archive>
    void serialize(Archive& archive) {
        archive(piece, other, start, touched, approach, slip);
    }
};

/// A bonded fan is one node, as in an ordinary finite element mesh. A split fan has one node per corner from then on;
/// where its points stick, the fan solver joins them. For f < number of fans, node f belongs to fan f, or to its first
/// corner once it is split; further nodes follow in the order of split_fans.
struct State {
    double time = 0;       // [s]
    double last_step = 0;  // [s] size of the last step; 0 at the start
    std::int64_t n_steps = 0;
    std::vector<Vec2> displacement;     // [m] per node
    std::vector<Vec2> velocity;         // [m/s] per node: at `time` with has_end_velocities(), else of the leapfrog, at
                                        // the middle of the last step
    std::vector<Vec2> rate;             // [m/s] per node: mean over the last step with has_end_velocities(), else empty
    std::vector<Index> node_of_corner;  // per corner
    std::vector<Index> split_fans;      // in any order
    std::vector<Index> first_point;     // per split fan, in that order: into `points`
    std::vector<PointState> points;     // of the split fans, in that order
    std::vector<Index> split_rank;      // per fan: its place in split_fans, or -1
    std::vector<Vec2> reaction;         // [N] per prescribed motion, mean over the last step; 0 in free components
    std::vector<ObstacleState> obstacles;
    double elastic_energy = 0;  // [J] with large rotations: at the start of the last step
    double elastic_work = 0;    // [J] with large rotations: elastic forces times the displacements of the last step
    std::vector<double>
        viscous_stress;  // [Pa] s, q_xx, q_xy of the last step (element/bulk_viscosity.hpp), per triangle (order 2:
                         // three times); empty: there was none
    std::vector<Retirement> retired;              // per point; empty where Model::contact_of_pair is
    std::vector<FaceContactState> face_contacts;  // of the last step, in the order of (vertex, edge)
    std::vector<ObstacleContactState> obstacle_contacts;
    std::vector<Impact> impacts;         // in any order
    std::vector<double> fluid_pressure;  // [Pa] of injected fluids in the last step, 0 of others; empty: none injected

    std::vector<Incubation> incubation;    // per fan; empty where no law has an incubation time
    std::vector<PieceMotion> free_pieces;  // in the order of their triangles; empty: damping acts on no vibration alone

    Motion motion = Motion::deformable;    // of the next step
    SharedFrozenBody frozen;               // null: the last step was none of rigid pieces
    std::vector<RigidPiece> rigid_pieces;  // in the order of FrozenBody::pieces

    SharedTemperatures temperature;         // null: no heat
    SharedTemperatures temperature_before;  // one step before, or the same object where it has not changed

    /// [m] Zero for the support.
    Vec2 displacement_of(Index corner) const {
        return corner == rigid_support ? Vec2::Zero() : displacement[node_of_corner[corner]];
    }
    /// [m] (u_N, u_T) of a point in its own frame (point_frame). Both sides start in the same place, so the
    /// jump of displacements is that of positions.
    Vec2 opening_of(const FanPoint& point, const Rotation& frame) const {
        const Vec2 jump = displacement_of(point.after) - displacement_of(point.before);
        const Vec2 normal = frame.turned(point.normal);
        return {point.gap + normal.dot(jump), turned_left(normal).dot(jump)};
    }

    /// The last step was one of the implicit scheme; with bulk = "auto", so is the next one.
    bool has_end_velocities() const { return !rate.empty(); }
    /// All pieces are asleep or held.
    bool lies_still() const {
        return frozen && std::ranges::all_of(rigid_pieces, [&](const RigidPiece& piece) {
                   return piece.state == PieceState::asleep || frozen->pieces[&piece - rigid_pieces.data()].held;
               });
    }
    PieceState piece_state(Index triangle) const {
        return frozen ? rigid_pieces[frozen->piece_of_triangle[triangle]].state : PieceState::deformable;
    }
    /// [-] phi of the points of a fan.
    double strength_factor(Index fan) const { return incubation.empty() ? 1 : incubation[fan].factor; }
    bool has_retired(Index point) const { return !retired.empty() && retired[point] == Retirement::retired; }

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time, last_step, n_steps, displacement, velocity, rate, node_of_corner, split_fans, first_point, points,
                split_rank, reaction, obstacles, elastic_energy, elastic_work, viscous_stress, retired, face_contacts,
                obstacle_contacts, impacts, incubation, free_pieces, motion, rigid_pieces, fluid_pressure);
        FrozenBody body = frozen ? *frozen : FrozenBody{};
        archive(body);
        if constexpr (Archive::is_loading::value)
            frozen = body.pieces.empty() ? nullptr : std::make_shared<FrozenBody>(std::move(body));
        const bool same = temperature == temperature_before;
        for (SharedTemperatures* shared : {&temperature, &temperature_before}) {
            Temperatures values = *shared && (!same || shared == &temperature) ? **shared : Temperatures{};
            archive(values);
            if constexpr (Archive::is_loading::value)
                *shared = values.of_corner.empty() ? nullptr : std::make_shared<Temperatures>(std::move(values));
        }
        if (!temperature_before) temperature_before = temperature;
    }
};

State initial_state(const Model& model);

/// A law of the model has an incubation time.
bool has_incubation(const Model& model);
/// A law of the model has coupling = "norm".
bool has_norm(const Model& model);

/// Gives every corner of `fan` a node of its own and every point a PointState.
void split(const Model& model, Index fan, State& state);

/// Large rotations: R of the polar decomposition of the sum of m F over the corners of the fan (F = R U of their
/// triangles, m their masses). The identity if rotations are small, and on a support, which does not turn.
Rotation fan_frame(const Model& model, const State& state, const Fan& fan);
/// The point beyond the vertex of a point, on the same face, which turns by less than 0.2 rad there, with the same law;
/// null: there is none.
const FanPoint* same_face_beyond(const Model& model, const FanPoint& point);
/// Mean rotation of the two triangles beside a point of a split fan, whose parts turn by themselves. Under friction
/// over pressure, and with the norm, two points of a face have one frame, the mean of theirs, unless they turn apart by
/// more than 0.01 rad: strains turn them by less, and with normals of their own one of them alone would bear what
/// presses on both, and a slip that both follow would contradict the contact of one.
Rotation point_frame(const Model& model, const State& state, const FanPoint& point);

/// [N] Of a load of factor 1.
inline Vec2 force_of(const Model& model, const CornerLoad& load, const State& state) {
    return load.depends_on_state() ? model.state_forces[load.state_force](state, state.time) : load.force;
}

/// [m] Of a corner of the mesh, or of a vertex of the ground.
inline Vec2 place_of(const Model& model, const State& state, Index corner) {
    if (const GroundVertex* ground = model.ground_at(corner)) return ground->place;
    return model.mesh.corner(corner) + state.displacement_of(corner);
}

/// The law of a point at the temperature of this moment.
inline const CohesiveLaw& law_of(const Model& model, const State& state, const FanPoint& point) {
    if (model.laws_follow_temperature) return state.temperature->laws[point.point];
    return model.laws[point.law];
}
/// The laws of the points at the temperatures of the state, which a checkpoint does not hold.
void fit_laws(const Model& model, State& state);
/// State of a point; null in a bonded fan.
const PointState* state_of(const Model& model, const State& state, Index point);

/// [m] (u_N, u_T) of a point in the frame of its interface (A to B), where it has the same components.
Vec2 opening(const Model& model, const State& state, Index point);
/// [m] Likewise in a frame, as explicit steps read it with the cohesion `beta`: where fans turn, what is left of an
/// opening that cohesion has closed turns from one component into the other, and the rates that would close it again
/// contradict each other round the vertex, by next to nothing: too little to tell which of them hold. A component below
/// a fraction of the softening length is zero, also in the energy of the interface.
Vec2 cohesive_opening(const Model& model, const State& state, const FanPoint& point, const Rotation& frame,
                      double beta);
/// [m] The rounding error of a closed gap; a smaller opening counts as none. Without this tolerance a point with
/// restitution that is held closed would lose its contact in every step that leaves u_N = +1e-17.
double touching_gap(const Model& model, const State& state, const FanPoint& point);
/// [-] beta of a point; 1 in a bonded fan.
double cohesion(const Model& model, const State& state, Index point);
/// [Pa] Traction on side B in the frame of the interface; in a bonded fan from the mean stress of the two neighbours.
Vec2 traction(const Model& model, const State& state, Index point);
/// [Pa] (N, T) of the stress (xx, yy, xy) on side B.
Vec2 traction(const Eigen::Vector3d& stress, const Vec2& normal);
/// [m] Where the body has its largest speed, or a speed that is not finite.
Vec2 place_of_largest_speed(const Model& model, const State& state);
/// [-] Barycentric coordinates of a corner in its triangle.
Eigen::Vector3d coordinates(const Mesh& mesh, Index corner);
/// [Pa] Mean stress (xx, yy, xy) of a triangle; with large rotations Cauchy's, in the present configuration.
Eigen::Vector3d stress(const Model& model, const State& state, Index triangle);
/// [Pa] At barycentric coordinates; of order 2 the linear part of the field, without the rest of the bubble.
Eigen::Vector3d stress(const Model& model, const State& state, Index triangle, const Eigen::Vector3d& at);
/// [Pa] xx, yy, xy, zz likewise. In plane strain eps_zz = 0, so zz = nu (xx + yy) - E a dT; in plane stress 0.
Eigen::Vector4d stress_with_zz(const Model& model, const State& state, Index triangle, const Eigen::Vector3d& at);

}  // namespace knap
