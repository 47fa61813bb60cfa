#pragma once
// The bulk in an implicit step (implicit_scheme.hpp): the impulse that each element node needs from the interfaces at a
// given rate w of the nodes,
//
//     r(w) = theta M (v+ - v) + theta h (K (u + theta h w) + alpha M (w - W) + C w - F_theta)
//     theta (v+ - v) = w - v   where w is free,
//
// its derivative M_hat = (1 + d) M + theta h C + theta^2 h^2 K with d = theta h alpha, and the energies of the step. C
// are the dashpots of absorbing boundaries, alpha is mass-proportional damping, and W the rigid motion of pieces that
// nothing holds, where it acts on vibrations alone (CarriedMotion); their works -h w' alpha M (w - W) and -h w' C w
// are never positive. Thermal strains e add the theta mean of their
// forces, and sigma = D (eps - e):
//
//     E = 1/2 v' M v + 1/2 int sigma : (eps - e),     W_th = -int sigma_theta : (e+ - e)
//     scheme dissipation = (theta - 1/2) (|v+ - v|_M^2 + |(eps+ - e+) - (eps - e)|_D^2)
#include "element/elastic_forces.hpp"
#include "element/thermal_stress.hpp"
#include "element/triangle_matrices.hpp"
#include "law/point_law.hpp"
#include "model/state.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/common/dashpots.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/implicit/corner_partition.hpp"

#include <optional>

namespace knap {

/// What all parts of an implicit step share; the step owns it.
struct StepContext : ThetaStep {
    const State* begin = nullptr;
    SharedTemperatures end_temperature;  // null: no heat
    StepTimes times() const { return {.begin = begin->time, .h = h, .theta = theta}; }
};

/// M_hat of one triangle [kg], of so many times its mass; `stiffness_factor` [s2]: theta^2 h^2.
ElementMatrix theta_element(const Model& model, Index triangle, double stiffness_factor, MassMatrix mass,
                            double mass_factor = 1);
/// Adds `factor` [s] times those of its corners; `dashpots` in the order of the corners.
void add_dashpots(const Model& model, Index triangle, std::span<const Dashpot> dashpots, double factor,
                  ElementMatrix& M_hat);

class ImplicitBulk {
public:
    /// `damping` [1/s]: alpha.
    ImplicitBulk(const Model& model, MassMatrix mass, double damping = 0, const std::vector<Selection>& absorbing = {});

    /// Loads of the step. `step` must outlive it.
    void begin_step(const StepContext& step);
    /// Prescribed motions. `rate` becomes the prescribed rates, and `corner_rate` [m/s, per corner] where w is free.
    void set_nodes(const CornerPartition& nodes, const std::vector<Vec2>& corner_rate, std::vector<Vec2>& rate);

    /// W [m/s] per corner, from now on; null: zero. It must outlive its use.
    void set_carried(const std::vector<Vec2>* carried) { carried_ = carried; }
    std::span<const Dashpot> dashpots() const { return dashpots_; }  // in the order of the corners
    double mass_factor() const { return damping_ > 0 ? 1 + step_->kick() * damping_ : 1; }  // [-]

    void impulse(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const;  // [N s] r(w)
    void sum_to_nodes(const std::vector<Vec2>& of_corner, std::vector<Vec2>& of_node) const;

    void momentum(const std::vector<Vec2>& velocity, std::vector<Vec2>& of_corner) const;     // [N s] M v, per corner
    void momentum_of_nodes(const std::vector<Vec2>& velocity, std::vector<Vec2>& sum) const;  // adds M v, per node
    /// [N s] Of r(w) what the body as a whole feels: without elastic and thermal forces.
    void external_impulse(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const;

    Vec2 end_velocity(Index node, const Vec2& rate) const;  // [m/s] v+
    double corner_inertia(Index corner) const;              // [kg] mean of the diagonal of M_hat in its triangle
    double largest_stiffness() const { return largest_stiffness_; }  // [1/s2] K_ii/M_ii of a corner
    double largest_impulse() const { return largest_impulse_; }  // [N s] of momenta and loads: the scale of rounding
    /// [N s] A hundredth of the largest term whose sum is (theta h)^2 K w: the same where few loads bend a body far.
    double largest_elastic_impulse(const std::vector<Vec2>& rate) const;

    /// Scratch memory of account().
    struct Workspace {
        std::vector<Vec2> of_corner, of_node, end_velocity;
    };
    /// Energies, and works of loads and prescribed motions. `reaction` [N s, per node]: r(w) minus the impulses of the
    /// interfaces.
    void account(const std::vector<Vec2>& rate, const std::vector<Vec2>& reaction, Workspace& work,
                 StepReport& report) const;

private:
    template <class Work>
    void for_triangles(const Work& work) const;
    template <class Velocity>
    void add_mass_times(const Velocity& of_corner, std::vector<Vec2>& sum) const;
    Vec2 change_of_velocity(Index node, const Vec2& rate) const;
    void add_change_of_momentum(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const;
    void add_damping(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const;
    double elastic_impulse(Index corner, double speed) const;
    void elastic_force(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                       std::vector<Vec2>& of_corner) const;

    const Model& model_;
    MassMatrix mass_;
    double damping_;  // [1/s]
    std::vector<Dashpot> dashpots_;
    const std::vector<Vec2>* carried_ = nullptr;
    CrackForces crack_forces_;
    ElasticForces forces_;
    std::optional<ThermalStress> thermal_;  // with heat
    std::vector<double> corner_stiffness_;  // [N/m] mean of the diagonal of K
    const StepContext* step_ = nullptr;
    const CornerPartition* nodes_ = nullptr;
    std::vector<double> amplitude_;         // [-] theta mean of each history
    State predicted_;                       // u + theta h v, for forces that depend on the state
    std::vector<Vec2> load_, begin_force_;  // [N] F_theta; with it -K u and thermal forces, per corner
    std::vector<CornerLoad> released_;      // [N] of load_, of what was excavated
    std::vector<Vec2> velocity_;            // [m/s] v, per node
    std::vector<Vec2> prescribed_end_;      // [m/s] v+ of prescribed components, per node
    double begin_impulse_ = 0, largest_impulse_ = 0;
    double largest_stiffness_ = 0;
};

}  // namespace knap
