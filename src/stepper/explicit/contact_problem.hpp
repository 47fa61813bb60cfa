#pragma once
// A cluster of contacts between free faces and the interface points of the fans that they touch, as one problem:
//
//     v_b = free_b + m_b^-1 sum P      bodies: corners, parts of fans that move as one, obstacles
//     V   = sum along . v              rows: contacts and points; their laws in contact/contact_cluster.hpp
//
// Where friction wedges pieces against each other, contacts and fans that take turns need not agree; jointly they do.
#include "interface/fan_problem.hpp"
#include "stepper/contact/contact_cluster.hpp"

namespace knap {

class ContactProblem {
public:
    void clear();
    /// Something that moves as one. Returns the number of its corner.
    Index add_body(const Vec2& free, const Vec2& inverse_mass);
    /// The corners of a fan and its links; returns its first corner. With `stuck_stays` the links that stick in its
    /// result go on, which leaves few unknowns. Secant unloading: with the cohesion that the links bear there.
    Index add_fan(const SolvedFan& fan, Index n_corners, bool stuck_stays);
    /// A contact that starts with this impulse; its terms follow.
    void add_contact(const Vec2& impulse);
    /// On the last contact: V += (along_N . v, along_T . v) of a corner.
    void add_term(Index corner, const Vec2& along_N, const Vec2& along_T);
    /// When all is added: finds W and V_free.
    void assemble();

    /// Contacts in the order in which they were added, without the points.
    std::size_t n_contacts() const { return rows_.size(); }
    ClusterContact& contact(std::size_t i) { return cluster_.contacts[rows_[i]]; }
    /// The residual of the laws of all rows [m/s]; `speed` and `rounding` [m/s] as there.
    double solve(double speed, double rounding);
    /// [m/s] Of the solution.
    Vec2 velocity(Index corner) const { return bodies_[corners_[corner].body].end + corners_[corner].offset; }
    /// [m/s] The largest error of the rates of the contacts, if V was the rate of each of them.
    double residual(std::span<const Vec2> V);
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
    struct Term {
        Index row, corner;
        Vec2 along_N, along_T;
    };
    void add_parts(const SolvedFan& fan, Index n_corners, bool stuck_stays);

    std::vector<Body> bodies_;
    std::vector<Corner> corners_;
    std::vector<Term> terms_;  // of one row after the other
    std::vector<Index> part_;  // per corner of a fan: the first corner of its part
    std::vector<std::size_t> end_of_body_;
    std::vector<Index> of_body_;  // places in terms_, of one body after the other
    std::vector<Index> rows_;     // of the contacts
    ContactCluster cluster_;
};

}  // namespace knap
