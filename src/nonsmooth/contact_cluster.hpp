#pragma once
// The nonsmooth problem of a cluster of contacts that share nodes of the body, in one step of the explicit bulk:
//
//     V = V_free + W P,     V = (V_N, V_T), P = (p, P_T) of every contact,     W: Delassus operator
//     0 <= p  perp  V_N - b >= 0,     -P_T in mu p 1/2 [ sgn(V_T) + sgn(V_T + V_T-) ]
//
// Interface points may be among the contacts, with their cohesion: P = (p - C, P_T), and the staircase of
// nonsmooth/fan_problem.hpp. A component without a mobility of its own keeps its impulse.
//
// Or a row has any convex law (law/row_law.hpp).
//
// W has a block for every two contacts that share a node. A rigid body may share contacts with everything, so its three
// velocities are unknowns of their own:
//
//     V = V_free + W P + L c,     c = M^-1 L' P: the change of the velocities of rigid bodies,     L: terms
//
// b <= |V_N-| makes the work p (V_N + V_N-)/2 of every contact non-positive, and V = -V- satisfies every bound: without
// friction each step has a solution, whatever the geometry.
//
// Gauss-Seidel sweeps (sequential impulses) solve one contact after the other in closed form; where they are slow, an
// active set over the states of the contacts (nonsmooth/link_state.hpp) starts from their result; where that cycles,
// and for many contacts from the beginning, proximal points. These solve all of 365 problems that the active set, 200
// sweeps and Lemke's pivots left unsolved (jams of up to 290 contacts). The impulses of redundant contacts are not
// unique; the velocities are.
#include "base/vec.hpp"
#include "nonsmooth/block_factor.hpp"
#include "nonsmooth/body_sweeps.hpp"
#include "nonsmooth/link_state.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace knap {

/// How much is spent on a problem that sweeps and the active set leave unsolved: nothing, fast proximal points, careful
/// ones where these fail. Sweeps: of contacts of rigid bodies alone, more of them where they leave much.
enum class ClusterEffort { sweeps, active_set, proximal_points, careful };

/// The block of W by which an impulse of a contact changes the rates of another one, or its own.
struct ContactCoupling {
    Index of, on;
    Eigen::Matrix2d W;  // [1/kg]
};

/// The law of a contact with the gap g [m] and the rate `before` V- [m/s] at the start of a step of h [s]. `deep` [m]:
/// a deeper penetration is reduced by a rebound with up to half of the approach (README.md). `tolerance` [m/s]: nearer
/// kinks of the friction are merged. `kept` [-]: of the slip in an impact (R_T); `given` [m/s]: the speed with which
/// the surface gives way.
InterfaceLaw contact_law(double gap, const Vec2& before, double friction, double restitution, double h, double deep,
                         double tolerance, double kept = 0, double given = 0);

class ContactCluster {
public:
    std::vector<ClusterContact> contacts;
    std::vector<ContactCoupling> couplings;  // of one contact after the other, of each on itself too
    std::vector<ClusterBody> bodies;
    std::vector<ClusterTerm> terms;  // of one contact after the other

    /// Adds to the block of contact `of` on another one; one contact after the other.
    void couple(Index of, Index on, const Eigen::Matrix2d& W);
    /// Likewise.
    void add_term(Index contact, const ClusterTerm& term);
    /// No impulse changes this component of the contact with this own block.
    void hold(ContactCoupling& own, int component);

    /// Holds the components of contacts of rigid bodies alone that these hardly move: what they do is rounding.
    void hold_unmoved();

    /// Solves the problem and returns its residual [m/s], the largest error of a rate. `speed` [m/s] is the scale of
    /// the rates, `rounding` [m/s] their absolute error.
    double solve(double speed, double rounding, ClusterEffort effort = ClusterEffort::careful);
    /// More sweeps over contacts of rigid bodies alone, from what was found; returns the residual [m/s].
    double sweep_bodies(double speed, int max_sweeps);
    double largest_impulse() const {  // [N s]
        double largest = 0;
        for (const ClusterContact& c : contacts) largest = std::max(largest, c.impulse.norm());
        return largest;
    }
    /// [m/s] of the impulse of a contact, if its rate was its `velocity`.
    double residual(Index i) const { return error(i, lawful_impulse(i) - contacts[i].impulse); }
    /// [1/kg] The block of W of a contact on itself, of the problem that was solved last.
    const Eigen::Matrix2d& own(Index i) const { return own_[i]; }
    /// Reads the own blocks from couplings and terms.
    void find_own();
    /// [1/kg] Of own(i), what rigid bodies make of it.
    Eigen::Matrix2d own_of_bodies(Index i) const;
    static constexpr double unmoved = 1e-12;  // [-] of the mobility of a contact, by rigid bodies

private:
    /// Of alpha, over proximal points.
    struct Weights {
        double first, lighter;  // lighter: after a problem that was solved
        int points;             // at most
    };

    /// A term as the active set sees it: rates of unknowns by velocities, and wrenches of impulses.
    struct TermPart {
        Eigen::Matrix<double, 2, 3> rates;
        Eigen::Matrix<double, 3, 2> wrenches;
    };

    /// A row of the dense system on a rigid body: its rate, and the change of velocities by its impulse.
    struct BodyRow {
        Eigen::Index row;
        Vec3 rate, change;
    };

    Vec2 lawful_impulse(Index i) const;
    double error(Index i, const Vec2& change) const;
    double largest_error() const;
    void apply(Index i, const Vec2& impulse);
    void count_bodies(Index i);
    std::span<ClusterTerm> terms_of(Index i) { return {terms.data() + contacts[i].first_term, n_terms(i)}; }
    std::span<const ClusterTerm> terms_of(Index i) const { return {terms.data() + contacts[i].first_term, n_terms(i)}; }
    std::size_t n_terms(Index i) const { return contacts[i].last_term - contacts[i].first_term; }
    double sweep();
    void find_velocities();
    double sweep_to(double change, int max_sweeps);
    double solve_bodies(double speed, double rounding);
    bool settle_states(double speed, double tolerance);
    double approach(double best, double speed, double rounding, const Weights& weights);
    void bring_near(double alpha);
    std::size_t attempts_since_same();
    bool solve_states();
    void fit_states(const FanScales& scales);
    bool solve_dense();
    bool solve_blocks();
    void analyse();
    void find_lack();

    /// [kg] The factor of its rate in its projection.
    double weight(Index i) const { return 1 / own_[i].trace(); }
    Index size() const { return static_cast<Index>(contacts.size()); }

    std::vector<Eigen::Matrix2d> own_, exact_own_;  // [1/kg] per contact: its own block, with and without alpha D
    std::vector<Eigen::Matrix2d> own_coupling_;     // [1/kg] of exact_own_ without rigid bodies
    std::vector<Vec2> free_;                        // [m/s] V_free without alpha D
    std::vector<Vec2> counted_;                     // [m/s] per term: what the velocity of its contact has of it
    std::vector<LinkState> states_;
    std::vector<RowLaw::Tangent> tangents_;  // per contact with a law of its own, at its place; empty: there is none
    std::vector<std::uint8_t> tried_;        // states of one attempt after the other
    std::vector<BodyRow> body_rows_;
    std::vector<Eigen::Index> unknown_, place_;  // rows of W; per row: its place in unknown_, or -1
    std::vector<Eigen::Matrix2d> part_;          // per coupling: its entries between unknowns
    std::vector<TermPart> part_of_term_;         // per term: its entries at unknowns
    std::vector<Index> place_of_part_;           // per coupling, then four per term: in factor_
    bool is_analysed_ = false;                   // factor_ has the pattern of the couplings
    BlockFactor factor_;                         // of contacts, then two rows per rigid body
    std::vector<double> rhs_, p_;                // of the unknowns
    std::vector<double> by_rows_, lack_;         // of the rows of factor_
    std::vector<ClusterContact> best_, start_;
    BodySweeps body_sweeps_;
};

}  // namespace knap
