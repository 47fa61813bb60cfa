#pragma once
// The bulk in an implicit step (implicit_scheme.hpp): what its corners take of impulse at a given rate w = v_theta of the nodes,
//
//     bulk_impulse(w) = theta M (v+ - v) + theta h K (u + theta h w) - theta h F_theta,      theta (v+ - v) = w - v where nothing is prescribed,
//
// and the energies of the step. In equilibrium the points supply what the corners of a node take together.
#include "element/elastic_forces.hpp"
#include "model/state.hpp"
#include "stepper/common/scheme_options.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/implicit/corner_partition.hpp"

#include <array>

namespace knap {

class ImplicitBulk {
public:
    ImplicitBulk(const Model& model, const SchemeOptions& options);

    /// Loads and prescribed motions of a step of size h from `begin`, which must outlive it.
    void begin_step(const State& begin, double h);
    /// Nodes of the step. Their rate is a guess for w: velocities at the begin; what is prescribed is exact.
    void set_partition(const CornerPartition& partition, std::vector<Vec2>& rate);

    void bulk_impulse(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const;           // [N s]
    void sum_to_nodes(const std::vector<Vec2>& of_corner, std::vector<Vec2>& of_node) const;
    void apply_matrix(const std::vector<Vec2>& direction, std::vector<Vec2>& of_node) const;  // M_hat times a direction of free components

    const std::vector<std::array<bool, 2>>& prescribed() const { return prescribed_; }  // per node
    Vec2 end_velocity(Index node, const Vec2& rate) const;
    double corner_stiffness(Index corner) const { return corner_stiffness_[corner]; }    // [N/m] mean of the diagonal
    double corner_mass(Index corner) const;                                              // [kg] on the diagonal
    double largest_impulse() const { return largest_impulse_; }                          // [N s] of loads and momenta: the scale of rounding

    /// Energies and the work of loads and prescribed motions. `residual_impulse` [N s, per node]: bulk_impulse minus supplied, the reactions.
    void account(const std::vector<Vec2>& rate, const std::vector<Vec2>& residual_impulse, StepReport& report) const;

private:
    void add_mass_times(const std::vector<Vec2>& of_node, double factor, std::vector<Vec2>& of_corner) const;
    void elastic(const std::vector<Vec2>& displacement, std::vector<Vec2>& force) const;

    const Model& model_;
    SchemeOptions options_;
    ElasticForces forces_;
    std::vector<double> corner_stiffness_;
    const State* begin_ = nullptr;
    double h_ = 0;
    std::vector<Vec2> load_, begin_force_;  // [N] F_theta and -K u per corner
    CornerPartition partition_;
    std::vector<Vec2> displacement_, velocity_;       // per node, at the begin
    std::vector<std::array<bool, 2>> prescribed_;     // per node
    std::vector<Vec2> prescribed_rate_, prescribed_end_;  // [m/s] w and v+
    double largest_impulse_ = 0;
    std::vector<double> amplitude_;                       // [-] of each history
    mutable std::vector<Vec2> moved_, force_;
    mutable std::vector<Vec2> end_, change_, momentum_;   // of account()
    mutable std::vector<std::uint8_t> unused_;
};

}  // namespace knap
