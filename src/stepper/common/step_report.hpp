#pragma once
// What one step says of itself; the ledger adds it up.
#include "base/vec.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace knap {

constexpr double max_residual = 1e-10;  // of the interface laws, scaled: the gate of every run, and what a step is rejected for

/// Why a step was not taken; its end state is void and must not be used.
enum class Rejection {
    none,
    assumption_1,   // softening outweighs inertia and stiffness: the step has several solutions; a smaller one has one
    not_converged,  // the solver of the interfaces did not reach its tolerance
};

/// How the values of two parts of the body, or of two steps, make one.
enum class Combine { sum, maximum };

/// Works are those of this step [J]; of impulses with the mean of the velocities before and after (formulation: energy ledger).
struct StepReport {
    double kinetic = 0;          // 1/2 v' M v after the step
    double strain = 0;           // 1/2 u_n' K u_{n+1}
    double dissipated = 0;       // sum of S G_c f(beta) over all points, after the step: what closing them does not give back
    double recoverable = 0;      // sum of S beta sigma_c s, after the step: what closing them gives back
    double external_work = 0;    // of loads and prescribed motions
    double cohesive_work = 0;    // spent against the interface forces that Psi belongs to (positive: taken from the body)
    double crossing_loss = 0;    // part of the cohesive work that no energy stores: lost where a slip crosses zero within a step
    double impact_work = 0;      // <= 0
    double friction_work = 0;    // <= 0
    double step_change_work = 0; // what a change of the step size does to the leapfrog energy; 0 at constant step
    double scheme_dissipation = 0;  // >= 0: what theta > 1/2 takes away, (theta - 1/2) (|dv|_M^2 + |du|_K^2); 0 for the explicit bulk
    double worst_impact_work = 0;    // the largest single term beyond what the residual and rounding explain, must be <= 0
    double worst_friction_work = 0;
    double residual = 0;             // worst residual of the interface laws, scaled
    double penetration = 0;          // [m] largest
    double largest_speed = 0;        // [m/s]
    double largest_beta_growth = 0;  // must be 0
    double largest_drop = 0;         // [J] S G_c (fall of beta in this step)^2 of one point: by about this a step misses the law there
    Index drop_corner = -1;   // at that point
    std::int64_t fan_solves = 0;     // local problems solved, and how many needed more than one system
    std::int64_t fan_iterations = 0;
    std::int64_t fan_fallbacks = 0;
    std::int64_t bond_checks = 0;    // exact tests of fans in one piece
    std::int64_t released = 0;       // fans that came apart in this step
    std::int64_t softened = 0;       // points that lost cohesion in this step, with either bulk (account_cohesion)
    std::int64_t linear_solves = 0;  // of the implicit bulk
    std::int64_t factorisations = 0;
    Rejection rejection = Rejection::none;
    Vec2 where = Vec2::Zero();       // [m] of the rejection

    /// Every number above, as visit(member, how to combine it): sums and serialization follow from this list.
    template <class Visit>
    static constexpr void for_each_number(const Visit& visit) {
        using R = StepReport;
        constexpr auto sums = std::tuple{&R::kinetic, &R::strain, &R::dissipated, &R::recoverable, &R::external_work, &R::cohesive_work,
                                         &R::crossing_loss, &R::impact_work, &R::friction_work, &R::step_change_work, &R::scheme_dissipation,
                                         &R::fan_solves, &R::fan_iterations, &R::fan_fallbacks, &R::bond_checks, &R::released, &R::softened,
                                         &R::linear_solves, &R::factorisations};
        constexpr auto maxima = std::tuple{&R::worst_impact_work, &R::worst_friction_work, &R::residual, &R::penetration, &R::largest_speed,
                                           &R::largest_beta_growth};
        std::apply([&](auto... member) { (visit(member, Combine::sum), ...); }, sums);
        std::apply([&](auto... member) { (visit(member, Combine::maximum), ...); }, maxima);
    }

    template <class Archive>
    void serialize(Archive& archive) {
        for_each_number([&](auto member, Combine) { archive(this->*member); });
        archive(largest_drop, drop_corner, rejection, where);
    }

    /// Adds the share of another part of the body (or of another step).
    StepReport& operator+=(const StepReport& other) {
        for_each_number([&](auto member, Combine how) {
            if (how == Combine::sum) this->*member += other.*member;
            else this->*member = std::max(this->*member, other.*member);
        });
        if (other.largest_drop > largest_drop) largest_drop = other.largest_drop, drop_corner = other.drop_corner;
        if (rejection == Rejection::none) rejection = other.rejection, where = other.where;
        return *this;
    }
};

}  // namespace knap
