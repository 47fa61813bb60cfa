#pragma once
// The refinements of a run ([adapt]): when the mesh is looked at, and what a continued run needs to know of them.
#include "scenario/scenario.hpp"
#include "stepper/adapt/adaptation.hpp"

#include <string>
#include <utility>

namespace knap {

class Adaptation {
public:
    /// `input`: of the model, without its mesh.
    Adaptation(const AdaptOptions& options, ModelInput input) : options_(options), input_(std::move(input)) {}

    /// Marks the vertices of a model that may not split; called at the start of a run.
    void guard(Model& model) const;
    /// A look at the mesh is due before the next step.
    bool is_due(const State& now) const { return follows() && now.n_steps >= next_look_; }
    /// The mesh may be refined.
    bool follows() const { return options_.active() && mesh_state_ == MeshState::follows; }
    /// Looks at the mesh, and refines it where it is too coarse; `also` [m]: a vertex that a step would have split.
    /// Without a refined mesh, the model allows it to split.
    std::optional<RefinedMesh> look(Model& model, const State& now, const std::optional<Vec2>& also = {}) {
        return look(model, now, now, also);
    }
    /// The same before the run, with the equilibrium in which it is to start on this mesh: what this broke or softened
    /// in large triangles is bonded again on the finer one, on which it is to be found anew.
    std::optional<RefinedMesh> look_at_equilibrium(Model& model, const State& found) {
        return look(model, found, initial_state(model), {});
    }
    /// The model on that mesh, which also allows `also` to split if it is still coarse.
    AdaptedModel refine(const Model& model, const State& now, RefinedMesh mesh, const std::optional<Vec2>& also = {});
    void after_step(Model& model);
    /// The model after all refinements so far, from that at the start of the run.
    void repeat(Model& model) const;

    /// [s] Processor time of a look and what followed from it.
    void took(double cpu) { counts_.cpu += cpu; }
    /// The count of steps is set back by `steps`.
    void set_back(std::int64_t steps) { next_look_ -= steps; }

    AdaptationCounts counts(const Model& model, const State& now) const;
    /// The mesh reached adapt.limit.
    bool stays_coarse() const { return mesh_state_ == MeshState::stays; }
    /// A line that says why the mesh changes no more, or that a vertex came apart in large triangles; once each.
    std::string take_warning() { return std::exchange(warning_, {}); }

    void serialize(auto& archive) {
        archive(next_look_, mesh_state_, counts_);
        if (!options_.active()) return;
        archive(mesh_, mesh_.grain);
    }

private:
    /// What becomes of the mesh: it is refined where that is due; it is fine everywhere; it is at adapt.limit.
    enum class MeshState : std::uint8_t { follows, is_fine, stays };

    void allow(const Vec2& place, const State& now, Model& model);
    /// Sizes are those that `loaded` asks for, and triangles stay at vertices that came apart in `now`.
    std::optional<RefinedMesh> look(Model& model, const State& loaded, const State& now,
                                    const std::optional<Vec2>& also);

    AdaptOptions options_;
    ModelInput input_;
    std::int64_t next_look_ = 0;  // step
    MeshState mesh_state_ = MeshState::follows;
    bool told_ = false;  // that a vertex came apart in large triangles
    AdaptationCounts counts_;
    Mesh mesh_;  // the present one; empty before the first refinement
    std::string warning_;
    std::vector<Vec2> allowed_;  // [m] vertices that may split in this step although they are coarse
};

/// The numbers of triangles to expect of [adapt] where every initial crack, or else one, crosses its body along the
/// longer side. `gain` was within a factor of 2 of that of the run in five scenarios (scenarios/BENCHMARKS.md); it
/// knows no loads.
struct AdaptationForecast {
    double area = 0;     // [m2]
    double crack = 0;    // [m] advance of all cracks
    double at_end = 0;   // triangles, where no crack branches
    double at_most = 0;  // triangles, where every crack branches in the middle of its way
    double uniform = 0;  // triangles of a uniform mesh of adapt.size
    double gain = 1;     // [-] triangle-steps of the uniform mesh over those of the run, with `at_end`
};
AdaptationForecast forecast(const Scenario& scenario, const Mesh& mesh);

/// Replaces [adapt] by a uniform mesh of its size where the forecast on the coarse mesh finds no gain, or where loads
/// need all of it soon; the reason, or nothing. Does not depend on the end of a run that is extended.
std::string replace_where_it_does_not_pay(Scenario& scenario, const Mesh& coarse);

/// [-] Triangles of a random mesh of mean edge length `size` [m] over an area [m2], measured.
double n_triangles_of(double area, double size);

}  // namespace knap
