#pragma once
// Bodies and contacts in one step of rigid pieces (rigid_contacts.hpp).
#include "model/state.hpp"
#include "stepper/contact/contact_row.hpp"

#include <array>
#include <vector>

namespace knap {

/// A body in a step: a piece, or behind all pieces an obstacle. What stands still or is driven has no inverse mass.
struct MovingBody {
    Vec3 before = Vec3::Zero();        // [m/s, m/s, rad/s] v-
    Vec3 free = Vec3::Zero();          // [m/s, m/s, rad/s] v+ without contacts
    Vec3 inverse_mass = Vec3::Zero();  // [1/kg, 1/kg, 1/(kg m2)]
    Vec3 acceleration = Vec3::Zero();  // [m/s2, m/s2, rad/s2] by loads in free flight; of obstacles 0
    double kick = 0;                   // [s] of a piece, from v- to v+
    Vec3 kicked = Vec3::Zero();        // [m/s, m/s, rad/s] kick times acceleration
    Vec3 flight = Vec3::Zero();        // [m/s, m/s, rad/s] until something strikes it: v+ without contacts, or v-
                                       // of a piece that something bears
    Vec3 end = Vec3::Zero();           // [m/s, m/s, rad/s] v+
    Vec3 strike = Vec3::Zero();        // [m, m, rad] beyond h v+, since it moved freely until it was struck
    Vec3 shift = Vec3::Zero();         // [m, m, rad] by which its place is corrected
    Vec2 centre = Vec2::Zero();        // [m]
    double struck_at = 0;              // [s] tau; 0: nothing strikes it
    double works_at = 0;               // [s] s, likewise
    Vec3 gained = Vec3::Zero();        // [m/s, m/s, rad/s] s a
    double couple = 0;                 // [N m s] that keeps the angular momentum where its place is corrected
    bool asleep = false;
    bool is_piece = true;     // false: an obstacle
    bool deformable = false;  // a piece that steps by itself, whose v+ is a guess

    bool moves() const { return inverse_mass.x() > 0 || inverse_mass.y() > 0 || inverse_mass.z() > 0; }
};

constexpr double stands_below = 1e-3;  // [-] of the speed of sleep: slower motions are rounding and sweeps

struct RigidStep {
    const State& begin;
    double drift_time, kick_time;  // [s] of the positions, of the velocities
    bool closing = false;          // of nearly no length: only what was in contact before stays so
};

/// Of two bodies or more.
struct RigidRow : ContactRow {
    enum class Source : std::uint8_t { face, obstacle, pair, point };
    Source source;
    Index number;                                    // in the list of its source
    Vec2 lasting = Vec2::Zero();                     // [N s] the impulse under the force of the step before
    Vec2 free = Vec2::Zero(), after = Vec2::Zero();  // [m/s] V without and with the impulses
    double apart = 0;                                // [m] the gap; of faces less where corners overlap less
    double own_N = 0, own_T = 0;                     // [1/kg]
    bool is_struck = false;                          // within the step
    Index cluster = -1;                              // none: nothing that it joins moves
    int n_terms = 0;
    std::array<ClusterTerm, 4> terms;

    /// Terms of the same body are one.
    void add(const ClusterTerm& term) {
        for (int k = 0; k < n_terms; ++k)
            if (terms[k].body == term.body) {
                terms[k].along_N += term.along_N, terms[k].along_T += term.along_T;
                return;
            }
        terms[n_terms++] = term;
    }
};

/// [m/s], or of the unit of the member times that of the rate.
inline Vec2 rate(const RigidRow& row, const std::vector<MovingBody>& bodies, Vec3 MovingBody::*velocity) {
    Vec2 V = Vec2::Zero();
    for (int k = 0; k < row.n_terms; ++k) V += row.terms[k].rate(bodies[row.terms[k].body].*velocity);
    return V;
}

/// Adds to their v+ what the impulse makes of it.
inline void push_bodies(const RigidRow& row, std::vector<MovingBody>& bodies) {
    for (int k = 0; k < row.n_terms; ++k) {
        MovingBody& body = bodies[row.terms[k].body];
        body.end += body.inverse_mass.cwiseProduct(row.terms[k].wrench(row.impulse));
    }
}

/// What a contact joins: pieces and obstacles; deformable pieces and others; or deformable pieces and obstacles.
enum class Sides : std::uint8_t { rigid, mixed, deformable };
inline Sides sides_of(const RigidRow& row, const std::vector<MovingBody>& bodies) {
    bool deformable = false, other = false;
    for (int k = 0; k < row.n_terms; ++k) {
        const MovingBody& body = bodies[row.terms[k].body];
        if (body.deformable) deformable = true;
        else if (body.is_piece) other = true;
    }
    return !deformable ? Sides::rigid : other ? Sides::mixed : Sides::deformable;
}

/// When it is known which bodies are awake, and where they are struck.
inline void complete(RigidRow& row, const std::vector<MovingBody>& bodies) {
    row.own_N = row.own_T = 0;
    for (int k = 0; k < row.n_terms; ++k) {
        const ClusterTerm& term = row.terms[k];
        const Vec3& inverse_mass = bodies[term.body].inverse_mass;
        row.own_N += term.along_N.dot(inverse_mass.cwiseProduct(term.along_N));
        row.own_T += term.along_T.dot(inverse_mass.cwiseProduct(term.along_T));
    }
    row.free = rate(row, bodies, &MovingBody::free);
}

}  // namespace knap
