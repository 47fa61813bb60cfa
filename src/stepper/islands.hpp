#pragma once
// Pieces that a blow may break step by themselves, in microseconds, while the other rigid pieces take one large step:
//
//     trial     contacts of all pieces over H (rigid/rigid_scheme.hpp), with the mean motion of deformable ones; what
//               is hit harder than it bears is deformable, too, and the trial is repeated until nothing else is
//     the rest  ends the trial
//     island    all deformable pieces, as a body of their own (model/part_of_body.hpp), take explicit steps until
//               t + H. Its contacts with the rest are those of the trial: the constant force p/K on each corner, K the
//               kick of its piece. So what one side gets the other one gives
//     ring      a piece of the rest in which the island now lies deep is deformable, too, and the step is repeated; so
//               are all that it touches where these contacts gave energy, or its steps had no solution
//     end       the leapfrog of the island is closed (scheme_change.hpp): its velocities are those of t + H. Pieces
//               that have been quiet for `hold` passages of a wave, and vibrate no faster than a blow that they bear,
//               become rigid
//
// A piece that becomes deformable has its rigid motion and the second half of the kick of its last step first, without
// elastic forces; its strain works from then on. Between two steps the state has all of it, so islands need no memory.
//
// Ledger: works of contacts between the island and the rest are exchange_work, those on both sides added up.
#include "model/part_of_body.hpp"
#include "stepper/explicit/explicit_scheme.hpp"
#include "stepper/rigid/rigid_scheme.hpp"
#include "stepper/step_control.hpp"

#include <memory>

namespace knap {

class Islands {
public:
    /// All must outlive this.
    Islands(const Model& model, const SchemeOptions& options, const StepLimits& limits, RigidScheme& rigid)
        : model_(model), options_(options), rigid_options_(options.rigid), limits_(limits), rigid_(rigid) {
        options_.rigid = {};
    }

    /// As StepScheme::step, from a state that moves as rigid pieces. Rejected as a blow where pieces that vibrated
    /// until now are hit, and as their own steps are where the deformable pieces have none.
    StepReport step(const State& begin, double h, State& end);

private:
    struct Force {
        Index corner;  // of the part
        Vec2 value;    // [N]
    };
    StepReport try_step(const State& begin, double h);
    bool grow(int ring, const State& end, const StepReport& report);
    void find_part();
    void advance(double h, State& end, StepReport& report);
    void begin_island(StepReport& report);
    void add_contacts_of_trial();
    StepReport take_micro_steps(double h);
    void push(double factor);
    void account_exchange(double kick, StepReport& report);
    Vec2& force_on(Index corner) { return part_.model.corner_loads[load_of_corner_[corner]].force; }
    bool begins(Index piece) const;  // it was rigid until this step
    void take_contacts(double h, double closing, State& end) const;
    void update_pieces(double h, State& end, StepReport& report);
    void rebuild_pieces(double end_time, State& end, StepReport& report) const;
    std::vector<double> find_means(State& end) const;
    double hold(double area, Index triangle) const;  // [s]
    bool is_quiet(const FrozenBody::Piece& piece, const RigidPiece& motion, double vibration, double now) const;

    const Model& model_;
    SchemeOptions options_;
    RigidOptions rigid_options_;
    StepLimits limits_;
    RigidScheme& rigid_;
    std::vector<std::uint8_t> deformable_;  // [0/1] per piece of the start
    PartOfBody part_;
    std::unique_ptr<ExplicitScheme> explicit_;  // of part_.model
    State start_, now_, next_;                  // of the part
    std::vector<RigidContacts::CornerImpulse> impulses_;
    std::vector<Force> forces_;          // of the rest, by corners
    std::vector<Index> load_of_corner_;  // per corner of the part: where the model has them
    std::vector<Index> pushed_;          // corners on which they act now
    std::vector<Vec3> mean_reaction_;    // per obstacle, of the island
    std::vector<double> struck_;         // [s] per triangle of the part: the last blow, or loss of cohesion
};

}  // namespace knap
