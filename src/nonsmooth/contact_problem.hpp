#pragma once
// A cluster of contacts and the interface points of the fans that they touch, as one problem:
//
//     v_b = free_b + M_b^-1 sum along' P    bodies: corners, parts of fans that move as one; rigid bodies
//     V   = sum along v                     rows: contacts and points; their laws in contact_cluster.hpp
//
// Where friction wedges pieces against each other, contacts and fans that take turns need not agree; jointly they do.
#include "nonsmooth/contact_cluster.hpp"
#include "nonsmooth/fan_problem.hpp"

namespace knap {

class ContactProblem {
public:
    void clear();
    /// Something that moves as one. Returns the number of its corner.
    Index add_body(const Vec2& free, const Vec2& inverse_mass);
    /// The corners of a fan and its links; returns its first corner. With `stuck_stays` the links that stick in its
    /// result go on, which leaves few unknowns. Secant unloading: with the cohesion that the links bear there.
    Index add_fan(const SolvedFan& fan, Index n_corners, bool stuck_stays);
    /// Returns its number among the rigid bodies. Its free velocities [m/s, m/s, rad/s], and [1/kg, 1/kg, 1/(kg m2)].
    Index add_rigid_body(const Vec3& free, const Vec3& inverse_mass);
    /// A contact that starts with this impulse; its terms follow. `given` [m/s]: its rate by what moves as prescribed.
    void add_contact(const Vec2& impulse, const Vec2& given = Vec2::Zero());
    /// Of the last contact, on a corner or on a rigid body.
    void add_term(const CornerTerm& term) { terms_.push_back({term, rows_.back()}); }
    void add_term(const ClusterTerm& term);
    /// When all is added: finds W and V_free.
    void assemble();

    /// Contacts in the order in which they were added, without the points.
    std::size_t n_contacts() const { return rows_.size(); }
    ClusterContact& contact(std::size_t i) { return cluster_.contacts[rows_[i]]; }
    /// False: what it joins is held along the contact, and friction does nothing.
    bool may_slip(std::size_t i) const { return cluster_.own(rows_[i])(1, 1) > 0; }
    /// The residual of the laws of all rows [m/s]; `speed` and `rounding` [m/s] as there.
    double solve(double speed, double rounding, ClusterEffort effort = ClusterEffort::careful);
    /// [m/s] Of the solution.
    Vec2 velocity(Index corner) const { return bodies_[corners_[corner].body].end + corners_[corner].offset; }
    /// [m/s, m/s, rad/s] Likewise.
    Vec3 velocity_of_rigid_body(Index body) const { return free_of_rigid_[body] + cluster_.bodies[body].change; }
    /// [m/s] The largest error of the rates of the contacts, if V was the rate of each of them.
    double residual(std::span<const Vec2> V);
    /// The contact whose law the last of these rates misses most.
    std::size_t worst() const;
    double largest_impulse() const { return cluster_.largest_impulse(); }  // [N s]

private:
    struct Body {
        Vec2 free, inverse_mass;  // [m/s], [1/kg]
        Vec2 end = Vec2::Zero();  // [m/s]
    };
    struct Corner {
        Index body;
        Vec2 offset;  // [m/s] its velocity less that of the body
    };
    struct Term : CornerTerm {
        Index row;
    };
    struct CurvedRow {
        std::size_t row;
        NormLaw law;
    };
    /// The mobility that a row would have if all of its corners could move as its lightest one.
    struct Mobility {
        double inverse_mass = 0;  // [1/kg] of that corner
        double along2 = 0;        // [-] sum of |along_N|^2
        double largest() const { return inverse_mass * along2; }
    };
    void add_parts(const SolvedFan& fan, Index n_corners, bool stuck_stays);

    std::vector<Body> bodies_;
    std::vector<Corner> corners_;
    std::vector<Term> terms_;          // of one row after the other
    std::vector<Index> part_;          // per corner of a fan: the first corner of its part
    std::vector<Vec3> free_of_rigid_;  // [m/s, m/s, rad/s]
    std::vector<Mobility> mobility_;   // per row
    std::vector<std::size_t> end_of_body_;
    std::vector<Index> of_body_;     // places in terms_, of one body after the other
    std::vector<Index> rows_;        // of the contacts
    std::vector<CurvedRow> curved_;  // points of fans whose laws are no staircases
    ContactCluster cluster_;
};

}  // namespace knap
