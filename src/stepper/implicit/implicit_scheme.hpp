#pragma once
// The implicit theta scheme (Acary, Collins-Craft, Bourrier; J. J. Moreau, M. Jean): all interfaces of the body and its stiffness together.
//
// Unknown is the rate of displacement over the step, w = v_theta = theta v+ + (1 - theta) v, of every corner:
//
//     u+ = u + h w,     v+ = (w - (1 - theta) v)/theta
//     M (v+ - v) + h K (u + theta h w) = h F_theta + H' P           F_theta = theta F(t + h) + (1 - theta) F(t)
//     P_N = -h S sigma_c beta_theta + p,     0 <= p  perp  w_N - c >= 0
//    -P_T in h S gamma sigma_c beta_theta sgn(u_T + h w_T) + mu p sgn(w_T)
//     beta+ = min(beta, max(0, 1 - (max(u_N + h w_N, 0) + gamma |u_T + h w_T|)/delta_c))
//     beta_theta = theta beta+ + (1 - theta) beta      (implicit beta; explicit beta: beta_theta = beta)
//
// The contact bound, V = rate at the begin of the step; e = 0 where cohesion is left:
//     touching, up to rounding:  c = -(1 - theta (1 + e)) max(-V_N, 0)   Newton's law v_N+ = -e v_N- against an approach, else w_N >= 0
//     apart, e = 0:              c = min(-u_N/h, -(1 - theta) max(-V_N, 0))  lands on the wall, or stops at it
//     apart, e > 0:              no contact in this step: it must touch first
// The work of an impulse is P . w; since c <= 0 and the friction opposes w_T, every single contact and friction work is <= 0.
// A corner near a rigid obstacle has a point more, whose support moves; the rates of a free obstacle are found by ObstacleMotion.
// Prescribed components: a velocity is reached at t + h (w is the mean), a displacement at t + h (v+ is the slope of its history there).
#include "stepper/common/bond_check.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/obstacle_motion.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/augmented_lagrangian.hpp"
#include "stepper/implicit/sticking_nodes.hpp"

#include <limits>

namespace knap {

class ImplicitScheme : public StepScheme {
public:
    ImplicitScheme(const Model& model, const SchemeOptions& options);

    StepReport step(const State& begin, double h, State& end) override;
    double stable_step() const override { return std::numeric_limits<double>::infinity(); }
    void give_up_when(GiveUp asked) override { solver_.give_up_when(asked); }
    FactorSize factor_size() const override { return {.unknowns = matrix_.n_unknowns(), .entries = matrix_.n_entries()}; }

private:
    void solve_points(const State& begin, double h, StepReport& report);  // all active points, until nothing more opens
    bool start_from_lemke(const State& begin, double h);  // all that can be active, rates and multipliers of another solver
    void choose_partition(const State& begin, double h);
    void make_points(const State& begin, double h);
    ActivePoint make_point(const State& begin, double h, Index fan, Index fan_point) const;
    bool is_given(Index node, int component) const;             // prescribed, or the support
    double mass_between(Index before, Index after) const;       // [kg] ActivePoint::mass
    void impose(ActivePoint& point) const;  // components (N, T) of its rate that both sides prescribe are not decided
    void guess_multipliers(const State& begin, double h);
    void find_scales();
    void find_obstacle_rates(const State& begin, double h, StepReport& report);
    ActivePoint make_contact_point(const ObstacleContact& contact, const State& begin, double h) const;
    std::span<const ActivePoint> contact_points() const { return std::span(points_).last(contacts_.all().size()); }
    const std::vector<Vec3>& contact_wrenches();  // [N s, N s, N m s] of the body on each obstacle
    void guess_contacts();
    void keep_contacts();
    bool activate_opening_fans(double h, StepReport& report);  // fans in one piece that cannot stay so
    bool holds(Index fan) const;
    double momentum_scale() const;  // [N s] of loads, momenta and strengths
    void check_residual(StepReport& report) const;
    bool energy_balance_error_exceeds(const StepReport& report) const;  // by the work of the residual
    void account_points(double h, StepReport& report) const;
    void store(const State& begin, double h, State& end, StepReport& report) const;
    StepReport rejected(StepReport report, Rejection rejection) const;
    Vec2 place_of_trouble(Rejection rejection) const;

    const Model& model_;
    SchemeOptions options_;
    ImplicitBulk bulk_;
    ThetaMatrix matrix_;
    AugmentedLagrangian solver_;
    StickingNodes sticking_;
    BondCheck bond_check_;
    ObstacleContacts contacts_;
    ObstacleMotion obstacles_;

    std::vector<std::uint8_t> active_;         // per fan
    std::vector<std::uint8_t> matrix_active_;  // for which the matrix stands, and the step
    double matrix_step_ = 0;
    CornerPartition partition_;
    std::vector<double> node_inertia_;        // [kg] diagonal of M_hat
    std::vector<ActivePoint> points_;          // of active fans; then the contacts with obstacles, in the order of contacts_
    std::vector<Index> active_point_of_;       // per fan point: into points_, or -1
    std::vector<Vec2> guess_;                 // per fan point: contact and tangential impulse [N s]
    std::vector<std::uint8_t> has_guess_;
    std::vector<Vec2> contact_guess_;         // likewise per contact with an obstacle
    std::vector<Vec2> pushed_;                // [N s] per corner: theta times the impulses of the obstacles on it
    std::vector<Vec2> rate_;                  // per node
    std::vector<Vec2> corner_rate_;
    std::vector<Vec2> required_;                 // [N s] per corner of the fan that is tested
    std::vector<Vec3> wrench_;
    std::vector<std::uint8_t> touched_;       // per obstacle
    double scale_ = 0, largest_scale_ = 0;    // [N s] AugmentedLagrangian::solve
};

}  // namespace knap
