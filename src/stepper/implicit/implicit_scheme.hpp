#pragma once
// The implicit theta scheme (Acary, Collins-Craft, Bourrier; J. J. Moreau, M. Jean): all interfaces of the body and its
// stiffness together.
//
// The unknown is the rate of displacement over the step, w = v_theta = theta v+ + (1 - theta) v, of every element node:
//
//     u+ = u + h w,     v+ = (w - (1 - theta) v)/theta
//     M (v+ - v) + h K (u + theta h w) = h F_theta + H' P           F_theta = theta F(t + h) + (1 - theta) F(t)
//     P_N = -h S sigma_c beta_theta + p,     0 <= p  perp  w_N - b >= 0
//    -P_T in h S gamma sigma_c beta_theta sgn(u_T + h w_T) + mu p sgn(w_T)
//     beta+ = min(beta, max(0, 1 - (max(u_N + h w_N, 0) + gamma |u_T + h w_T|)/delta_c))
//     beta_theta = theta beta+ + (1 - theta) beta      (implicit beta; explicit beta: beta_theta = beta)
//
// The contact bound b, with V = rate at the start of the step, and e = 0 where cohesion is left:
//     touching, up to rounding:   b = -(1 - theta (1 + e)) max(-V_N, 0)          Newton's law v_N+ = -e v_N-
//     apart, e = 0:               b = min(-u_N/h, -(1 - theta) max(-V_N, 0))     closes the gap, or stops at it
//     apart, e > 0:               no contact in this step: it must touch first
// The work of an impulse is P . w; since b <= 0 and friction opposes w_T, every single contact and friction work is
// <= 0. A corner near a rigid obstacle has one point more, on a support that moves; FreeObstacles finds the rates of
// those that are free. Where the model has contact between free faces, they meet as in a search of equilibrium
// (face_points.hpp). Prescribed components: a velocity is reached at t + h (w is the mean), a displacement at t + h (v+
// is the slope of its history there).
//
// With large rotations each solution is one of equations that are linear in the bulk (implicit_bulk.hpp), with points
// in the frames of its motion (turned_points.hpp); the next one starts from it, until both agree.
#include "stepper/common/bond_check.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/augmented_lagrangian.hpp"
#include "stepper/implicit/carried_motion.hpp"
#include "stepper/implicit/face_points.hpp"
#include "stepper/implicit/fixed_point.hpp"
#include "stepper/implicit/free_motions.hpp"
#include "stepper/implicit/free_obstacles.hpp"
#include "stepper/implicit/sticking_rates.hpp"
#include "stepper/implicit/turned_points.hpp"

#include <tuple>

namespace knap {

class ImplicitScheme : public StepScheme {
public:
    ImplicitScheme(const Model& model, const SchemeOptions& options);

    StepReport step(const State& begin, double h, State& end) override;
    void set_theta(double theta) override { step_.theta = theta; }
    void give_up_when(GiveUp condition) override { solver_.give_up_when(condition); }
    FactorSize factor_size() const override { return matrix_.size(); }
    /// What is free moves as rounding leaves it: of no use in a search of equilibrium.
    void leave_free_motions() { leaves_free_motions_ = true; }

private:
    StepReport solve_step(const State& begin, double h, State& end);
    void begin_step(const State& begin, double h, SharedTemperatures end_temperature);
    void solve_points(StepReport& report);
    void solve_body(StepReport& report);
    void solve_under_pressures(StepReport& report);
    void solve_turning_body(StepReport& report);
    void turn();
    double turning_error();
    void store_guesses();
    void guess_rates(const State& begin, std::vector<Vec2>& of_corner) const;
    void solve_free_obstacles(StepReport& report);
    FreeObstacles::Body body_at_contacts() const { return {contact_points(), x_.rate, partition_, momentum_scale_}; }
    const std::vector<Vec2>& reactions();
    bool needs_free_motions();
    bool move_freely();
    void read_corner_rates(std::vector<Vec2>& of_corner) const;  // of the present solution
    bool lemke_is_cheap() const;
    bool start_from_lemke();
    void set_partition();
    void make_points();
    double mass_between(Index before, Index after) const;  // [kg] ActivePoint::mass
    Vec2& guess_of(std::size_t point);
    void guess_multipliers();
    bool activate_opening_fans(StepReport& report);
    void check_residual(StepReport& report) const;
    bool energy_balance_error_exceeds(const StepReport& report) const;
    void account_points(StepReport& report) const;
    void store(State& end, StepReport& report);
    bool opens(Index fan) const;
    std::span<const ActivePoint> contact_points() const { return std::span(x_.points).last(contacts_.all().size()); }
    std::span<const ActivePoint> points_of_fans() const {
        return std::span(x_.points).first(x_.points.size() - contacts_.all().size() - faces_.size());
    }
    std::span<const ActivePoint> face_points() const {
        return std::span(x_.points).subspan(points_of_fans().size(), faces_.size());
    }
    StepReport rejected(StepReport report, Rejection rejection) const;

    const Model& model_;
    const SchemeOptions options_;
    StepContext step_;
    CornerPartition partition_;
    Iterate x_;  // its points: those of active fans, then faces_ and contacts_ in their orders
    ImplicitBulk bulk_;
    CarriedMotion carried_;
    ThetaMatrix matrix_;
    AugmentedLagrangian solver_;
    BondCheck bond_check_;
    ObstacleContacts contacts_;
    ObstacleMotion obstacles_;
    FreeObstacles free_obstacles_;
    FacePoints faces_;
    FreeMotions free_motions_;
    StickingRates sticking_rates_;
    TurnedPoints turned_points_;
    FixedPoint fixed_point_;  // of the rates round which the body is linear

    std::vector<std::uint8_t> active_;  // [0/1] per fan
    std::vector<Vec2> corner_rate_;     // [m/s] per corner: first guess of w
    std::vector<Vec2> turned_rate_;     // [m/s] per corner: round which the body is linear
    std::vector<Vec2> guess_;           // [N s] multipliers (contact, tangential), per fan point, face, contact
    std::vector<Vec2> face_rate_;       // [m/s] per corner: with which faces_ was found
    double coarse_goal_ = 0;            // [N s] of the balance, with large rotations
    bool may_open_ = true;              // bonded fans are tested: with large rotations only near the solution
    bool leaves_free_motions_ = false;
    bool moves_freely_ = false;  // with free_motions_
    int n_free_rounds_ = 0;
    std::tuple<std::vector<Vec2>, std::vector<std::uint8_t>, std::vector<Vec2>> own_guess_;  // the first, of all three
    std::vector<Index> active_point_of_;     // per fan point: into x_.points, or -1
    std::vector<double> node_inertia_;       // [kg] diagonal of M_hat
    double momentum_scale_ = 0, scale_ = 0;  // [N s] of loads, momenta and strengths; of the impulses of the points

    // workspace
    std::vector<Vec2> contact_impulse_;  // [N s] theta times the impulses of obstacles, per corner
    std::vector<Vec2> required_;         // [N s] per corner of the fan in the bond check
    std::vector<Vec2> reaction_;         // [N s] per node, where free obstacles press on what is held
    ImplicitBulk::Workspace work_;
};

}  // namespace knap
