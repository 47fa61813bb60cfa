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
//
// Large rotations: K (u + theta h w) becomes the force f(w) of element/green_step.hpp, which is not linear. The step is
// solved with a linear r(w) in the frames A of piece_frames.hpp round a rate w_0, until its solution is w_0:
//
//     r(w) = theta M (v+ - v) + theta h (f(w_0) + theta h A K A' (w - w_0) + ...)
#include "element/elastic_forces.hpp"
#include "element/green_step.hpp"
#include "element/thermal_stress.hpp"
#include "element/triangle_matrices.hpp"
#include "law/point_law.hpp"
#include "model/state.hpp"
#include "stepper/common/dashpots.hpp"
#include "stepper/common/fluid_pressures.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/implicit/corner_partition.hpp"
#include "stepper/implicit/piece_frames.hpp"

#include <memory>
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
/// Blocks (i, j) become turns_i block turns_j'; of order 1.
void turn_blocks(const std::array<Rotation, 3>& turns, ElementMatrix& M_hat);
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

    /// Large rotations: rates [m/s] per corner of the last step become a guess of those of this one, turned with each
    /// piece.
    void turn_rates(std::vector<Vec2>& corner_rate) const;
    /// Large rotations: r(w) from now on is linear round these rates [m/s], per corner, where it is exact.
    void linearise(const std::vector<Vec2>& corner_rate);
    /// [N s] Large rotations: of momenta, loads and forces; and the rounding of the motion in the step.
    double balance_scale() const { return balance_scale_; }
    double rounding() const { return rounding_; }
    /// [m] Of a corner: in the undeformed body; with large rotations in the middle of the step, as far as it is known.
    Vec2 place(Index corner) const {
        Vec2 x = model_.mesh.corner(corner);
        if (turning_) x += turning_->begin[corner] + 0.5 * turning_->change[corner];
        return x;
    }
    PieceFrames* frames() const { return turning_ ? &turning_->frames : nullptr; }  // null: small rotations

    /// W [m/s] per corner, from now on; null: zero. It must outlive its use.
    void set_carried(const std::vector<Vec2>* carried) { carried_ = carried; }
    std::span<const Dashpot> dashpots() const { return dashpots_; }  // in the order of the corners
    double mass_factor() const { return damping_ > 0 ? 1 + step_->kick() * damping_ : 1; }  // [-]

    // Injected fluids, by their numbers in Model::crack_fluids (stepper/common/fluid_pressures.hpp)
    bool has_injected_fluids() const { return model_.has_injected_fluids(); }
    const std::vector<double>& fluid_pressure() const { return fluid_pressure_; }  // [Pa]
    const CrackForces& crack_forces() const { return crack_forces_; }
    /// `rate` [m/s]: of the nodes, the solution under the present pressures; solve() renews it under others, and is
    /// false where there is none.
    FluidStep fluid_step(const std::vector<Vec2>& rate, const std::function<bool()>& solve);
    Vec2 place_of_fluid(std::size_t fluid) const { return crack_forces_.place(fluid, *of_fluids_); }  // [m]

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
    /// Of large rotations.
    struct Turning {
        GreenStep green;
        PieceFrames frames;
        std::vector<Index> own_node;                   // per corner: itself
        std::vector<Vec2> begin, change;               // [m] per corner: u, u+ - u
        std::vector<double> thermal_change;            // [-] per triangle: e+ - e
        std::vector<Vec2> rate;                        // [m/s] per corner: w_0
        std::vector<Vec2> corner_rate, turned, force;  // [m/s], [N] per corner
    };
    void find_loads(const State& of_forces);
    const std::vector<CornerLoad>& find_crack_forces();
    void begin_fluids();
    void set_fluid_pressure(std::size_t fluid, double pressure);
    double fluid_compliance(std::size_t fluid) const;  // [m3/Pa] about dg/dp
    GreenStep::Motion motion() const;
    void begin_turning();
    void green_force(std::vector<Vec2>& of_corner) const;
    void account_green_strains(const std::vector<Vec2>& rate, StepReport& report) const;
    void add_turned_stiffness(const std::vector<Vec2>& of_corner, std::vector<Vec2>& force) const;

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
    const State* of_fluids_ = nullptr;    // in which crack_forces_ are found
    std::vector<double> fluid_pressure_;  // [Pa] in the step, where fluids are injected; else empty
    std::vector<double> fluid_volume_;    // [m3] V at its start
    ElasticForces forces_;
    std::optional<ThermalStress> thermal_;  // with heat
    std::unique_ptr<Turning> turning_;      // null: small rotations
    std::vector<double> corner_stiffness_;  // [N/m] mean of the diagonal of K
    const StepContext* step_ = nullptr;
    const CornerPartition* nodes_ = nullptr;
    std::vector<double> amplitude_;         // [-] theta mean of each history
    State predicted_;                       // u + theta h v, for forces that depend on it; turning: (u + u+)/2
    std::vector<Vec2> load_, begin_force_;  // [N] F_theta; with it -K u and thermal forces, per corner
    std::vector<CornerLoad> released_;      // [N] of load_, of what was excavated
    std::vector<Vec2> velocity_;            // [m/s] v, per node
    std::vector<Vec2> prescribed_end_;      // [m/s] v+ of prescribed components, per node
    double begin_impulse_ = 0, largest_impulse_ = 0, balance_scale_ = 0, rounding_ = 0;
    double largest_stiffness_ = 0;
};

}  // namespace knap
