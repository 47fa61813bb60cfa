#pragma once
// Central differences with the lumped mass (explicit_step.hpp). The mass couples nothing beyond a fan, so the interface
// problem of the step falls apart into one small problem per vertex.
#include "element/elastic_forces.hpp"
#include "element/thermal_stress.hpp"
#include "stepper/common/bond_check.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/explicit/absorbing_boundary.hpp"
#include "stepper/explicit/free_pieces.hpp"
#include "stepper/explicit/incubation.hpp"
#include "stepper/explicit/mesh_blocks.hpp"
#include "stepper/explicit/vertex_contacts.hpp"
#include "stepper/explicit/vertex_obstacles.hpp"

#include <optional>

namespace knap {

class ExplicitScheme : public StepScheme {
public:
    ExplicitScheme(const Model& model, const SchemeOptions& options);

    StepReport step(const State& begin, double h, State& end) override;

private:
    StepReport sweep_blocks(const ExplicitStep& step);
    template <class Corner>
    struct Sweep;
    std::span<const Rotation> find_frames(const State& begin);
    template <class Corner>
    void move_fans(const Sweep<Corner>& sweep);
    template <class Corner>
    bool decide_and_move(const Sweep<Corner>& sweep, const typename BlockFans<Corner>::BlockFan& fan,
                         const Corner* corner, const Vec2& force);
    double add_thermal_forces(const MeshBlock& block, const ExplicitStep& step, Vec2* force, StepReport& report);
    void find_obstacle_contacts(const ExplicitStep& step);
    void add_crack_forces(double sign);
    void settle_fluids(const ExplicitStep& step, StepReport& report);
    StepReport sweep_bordering(const ExplicitStep& step);
    template <class Force>
    bool is_bonded(Index fan, std::span<const InscribedCircle> circles, const Force& force_on, const Vec2& force,
                   const ExplicitStep& step, ThreadWorkspace& work, StepReport& report);
    Vec2 velocity_as_one(Index fan, const Vec2& force, const Vec2& contact, const ExplicitStep& step) const;
    void move_bonded(Index fan, const Vec2& force, const Vec2& contact, const ExplicitStep& step, NodeMotion& nodes,
                     StepReport& report) const;
    void advance_bonded_contacts(const ExplicitStep& step, StepReport& report);
    void release(const ExplicitStep& step, StepReport& report);
    StepReport advance_remaining_split_fans(const ExplicitStep& step);
    StepReport account_loads(const ExplicitStep& step);
    void account_loads(std::span<const CornerLoad> loads, const ExplicitStep& step, StepReport& report) const;
    ViscousStep viscous_step(const ExplicitStep& step) const {
        const std::vector<double>& before = step.begin.viscous_stress;
        const bool is_known = before.size() == no_viscous_stress_.size();
        return {.velocity = step.begin.velocity,
                .last_step = step.begin.last_step,
                .before = (is_known ? before : no_viscous_stress_).data(),
                .now = step.end.viscous_stress.data()};
    }
    void account_viscosity(const ViscousStep& viscous, StepReport& report) const;
    void account_rotation(const ExplicitStep& step, StepReport& report) const;
    /// Of a bonded fan, or null.
    const PrescribedMotion* drive_of(Index fan) const {
        const Index drive = drives_.empty() ? -1 : drive_of_fan_[fan];
        return drive < 0 ? nullptr : &drives_[drive];
    }
    /// No contact acts on several fans.
    bool fans_are_independent() const { return model_.obstacles.empty() && !contacts_; }

    const Model& model_;
    SchemeOptions options_;
    ElasticForces forces_;
    std::optional<ThermalStress> thermal_;  // with heat
    CrackForces crack_forces_;
    IncubationClock incubation_;
    AbsorbingBoundary absorbing_;
    FreePieces free_pieces_;
    std::vector<MeshBlock> blocks_;
    ObstacleStep obstacle_step_;
    VertexSolver solver_;
    VertexObstacles obstacles_;
    std::optional<VertexContacts> contacts_;      // between free faces, and with obstacles beyond a fan
    std::vector<double> mass_;                    // [kg] per corner, in the order of Model::fan_corners
    std::vector<PrescribedMotion> drives_;        // of the first corners of fans, side by side for bonded ones
    std::vector<Index> drive_of_fan_;             // per fan: into drives_, or -1
    std::vector<double> amplitude_;               // of every history, at the start of the step
    std::vector<double> velocity_factor_;         // of every history, see ExplicitStep
    std::vector<Vec2> corner_force_;              // [N] per corner, see ExplicitStep
    std::vector<Vec2> corner_impulse_;            // [N s] likewise
    std::vector<Vec2> corner_rate_;               // [m/s] per corner: v+ where a fluid presses, else 0
    std::vector<double> elastic_energy_;          // [J] per block, with large rotations
    std::vector<double> no_viscous_stress_;       // zeros, of a state without; empty: no viscosity
    std::vector<std::uint8_t> fan_is_candidate_;  // per fan: it exceeds the stress criterion
    BondProofs bond_proofs_;
    std::vector<std::uint8_t> splits_;         // per fan, in this step
    std::vector<Rotation> frames_;             // per point of split fans, see ExplicitStep
    std::vector<ThreadWorkspace> workspaces_;  // one per thread
    std::vector<StepReport> partial_;
    State unordered_;
};

}  // namespace knap
