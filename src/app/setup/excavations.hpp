#pragma once
// The excavations of a run: which triangles vanish when, and what a continued run needs to know of those that happened.
#include "model/model.hpp"
#include "scenario/read_scenario.hpp"
#include "stepper/adapt/excavation.hpp"

namespace knap {

/// In the order of time. A triangle vanishes once.
struct PlannedExcavation {
    std::size_t number;  // of Scenario::excavations
    double at, ramp;     // [s]
    std::vector<Index> triangles;
};

/// Throws UserError: a region without triangles, or with all that are left; probes in a region.
std::vector<PlannedExcavation> plan_excavations(const ReadResult& read, const Model& model);

/// Warnings: loads and supports that a region takes with it, a mesh that does not follow its outline.
std::vector<Diagnostic> findings_of_excavations(const ReadResult& read, const Model& model);

class Excavations {
public:
    explicit Excavations(std::vector<PlannedExcavation> planned) : planned_(std::move(planned)) {}

    /// One vanishes at this state.
    bool is_due(const State& now) const;
    /// [s] At most `h`: a large step ends at the next one, or nearly there.
    double step_size(const State& now, double h) const;
    /// Before the next one, at the trial step of h [s] from `now` to `trial`: the forces of faces that touch its
    /// region, by further trial steps. Returns a warning where its triangles have left their place by more than an
    /// edge.
    std::string prepare(const Model& model, MoreauJean& stepper, const State& now, const State& trial, double h);
    /// Replaces model and state by those without the region, after the trial step of `scheme`. Returns the
    /// line of the log.
    std::string perform(const State& trial, const SchemeOptions& scheme, Model& model, State& now,
                        ExcavationEnergies& energies);
    /// The model after all that happened so far, from that at the start of the run.
    void repeat(Model& model) const;
    /// The clock is set back by `time` [s].
    void set_back(double time) {
        for (Done& done : done_) done.time -= time;
    }

    template <class Archive>
    void serialize(Archive& archive) {
        archive(done_);
    }

private:
    struct Done {
        double time = 0;            // [s]
        std::vector<Index> corner;  // of the released forces
        std::vector<Vec2> force;    // [N]

        void serialize(auto& archive) { archive(time, corner, force); }
    };
    std::vector<std::uint8_t> next_region(const Model& model) const;
    std::string moved_warning(const Model& model, const State& now) const;
    void release_forces(std::size_t number, Model& model) const;

    std::vector<PlannedExcavation> planned_;
    std::vector<Done> done_;
    std::vector<Vec2> contacts_;  // [N] of the next one: lasting_contacts
};

}  // namespace knap
