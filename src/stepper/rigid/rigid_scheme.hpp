#pragma once
// The third scheme: pieces of the body that nothing can break now move as rigid bodies, in steps of milliseconds.
//
//     M (v+ - v-) = k F + sum along' P,     x+ = c+ + R(angle+) arm,     c+ = c + h v+,     angle+ = angle + h w+
//
// with the kick k and the drift h of the leapfrog (as in the explicit scheme), loads F of the start of the step, and
// the laws of contact at its end (rigid_contacts.hpp). A free flight is exact at the ends of the steps. Impulses of
// contacts have no resultant and no moment.
//
// A step in which a contact hits a piece that can break so hard that it may break is rejected as a blow: it counts for
// nothing, and the body is deformable from its start on (freeze.hpp). The hit is the approach V_N-, or W_NN p, if that
// is more (what others hand on), times sqrt(1 + (P_T/p)^2), of the impulses p and P_T (friction) beyond the forces of
// the step before; more than k sigma_c/(rho c) min(1, sqrt(10 L/D)) (c = sqrt(E/rho), edge L, D = sqrt(area)),
// or a lasting force above sigma_c/2 over an edge. What is handed on has at most the p of the same motion without loads
// (RigidContacts::solve_anew): contacts share a weight in many ways, and each solution in another one.
//
// Pieces that have been slower than `sleep` for 0.2 s without setting out (what accelerates slowly does) or going on
// with no loss (as what slides without friction), that press on what stands still, and whose contacts would bear them
// at rest, fall asleep. They stand still until something hits them faster than that or begins to touch them, or a
// driven obstacle touches them.
//
// A step has two parts, so that deformable pieces can take their own one between them (stepper/islands): a trial, which
// finds the impulses of all contacts, and its end, which moves what is rigid. The impulses on a deformable piece are
// those that its mean motion needs until it is at the end of the step, with v+ at that moment.
//
// Ledger: vibration_booked when pieces become rigid; sleep_work; the elastic energy stays in the shape of the pieces.
#include "stepper/rigid/rigid_contacts.hpp"

#include <optional>
#include <span>

namespace knap {

class RigidScheme : public StepScheme {
public:
    RigidScheme(const Model& model, const SchemeOptions& options);

    /// `begin` may be a deformable state, whose pieces become rigid with this step; as after a blow it stays
    /// deformable while one of them vibrates as fast as that.
    StepReport step(const State& begin, double h, State& end) override;
    /// The contacts of a step; nothing moves. `deformable` [0/1] per piece, or empty: none is.
    StepReport try_step(const State& begin, double h, std::span<const std::uint8_t> deformable);
    /// What follows from the last trial. `report`: that of the trial; its end state lacks what deformable pieces do.
    StepReport end_step(StepReport report, State& end);
    /// Marks [0/1] the pieces that the trial hits so hard that they may break; [-] of the hardest blow. Whether there
    /// are new ones.
    bool mark_struck(std::vector<std::uint8_t>& marked);
    const RigidContacts::Blow& blow() const { return blow_; }
    /// [-] Of each piece: its hardest blow in the last trial.
    const std::vector<double>& blows() const { return blows_; }
    const State& start() const { return trial_->begin; }  // with rigid pieces
    const RigidContacts& contacts() const { return contacts_; }
    const std::vector<MovingBody>& bodies() const { return bodies_; }
    const Vec3& load_on(Index piece) const { return load_[piece]; }  // [N, N, N m]
    /// Faces that came apart between pieces, after all of them have moved; `before`: the marks until then.
    void retire(const std::vector<Retirement>& before, State& end) const;

    /// From rigid pieces to a deformable state with velocities of its time: a step of nearly no length, with the kick
    /// of half of the step before; `h` [s], as MoreauJean::close_leapfrog.
    StepReport thaw(const State& begin, double h, State& end);
    /// Whether a deformable state at its start moves as rigid pieces, none of which is held and may break.
    bool may_begin(const State& start) const;

private:
    /// Of the loads with one history on a piece: sum of f, of arm x f and of arm . f, at angle 0.
    struct PieceLoad {
        Index piece, history;
        Vec2 force;
        double cross, dot;
    };
    void renew(const State& begin);
    void account_freeze(const State& begin, const FrozenBody& body, double strain, StepReport& report) const;
    void account_energies(const FrozenBody& body, StepReport& report) const;
    void find_contacts(StepReport& report);
    bool lies_still(const RigidStep& step);
    StepReport stay(const RigidStep& step, StepReport report, State& end);
    void find_free_motion(const RigidStep& step);
    void add_rates(Vec3 MovingBody::*end);
    std::vector<MovingBody> at_rest() const;
    void fall_asleep(const RigidStep& step, State& end, StepReport& report);
    void move_pieces(const RigidStep& step, State& end, StepReport& report);

    const Model& model_;
    SchemeOptions options_;
    RigidContacts contacts_;
    ObstacleMotion obstacles_;
    std::optional<RigidStep> trial_;
    bool stays_ = false;                    // in the trial all lies still
    std::vector<std::uint8_t> deformable_;  // [0/1] per piece
    RigidContacts::Blow blow_;
    std::vector<double> blows_;
    State start_;                   // of rigid pieces that were deformable
    SharedFrozenBody known_;        // for which loads and contacts were read
    std::vector<PieceLoad> loads_;  // piece by piece
    std::vector<double> amplitude_;
    std::vector<Vec3> load_;  // [N, N, N m] per piece
    std::vector<MovingBody> bodies_;
    std::vector<std::vector<Vec3>> added_;  // to the velocities of pieces: by loads, then by contacts
    std::vector<Vec3> wrench_;              // [N s, N s, N m s] per body
    std::vector<Vec3> of_obstacles_;
    UnionFind pressed_;
};

}  // namespace knap
