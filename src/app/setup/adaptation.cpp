#include "app/setup/adaptation.hpp"

#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/make_model.hpp"
#include "stepper/moreau_jean.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double pays_from = 2;          // gain of the forecast
constexpr double all_above = 0.5;        // of the area that is to be fine
constexpr std::size_t max_looks = 8;     // at the mesh in one step
constexpr int steps_of_rebuild = 400;    // of a body take as long as to refine all of it (measured)
constexpr double rehearsal_size = 8000;  // triangles of the rehearsal at most

/// A mesh that will have the sizes [m] given at its vertices.
struct FutureMesh {
    double area = 0, fine = 0;  // [m2] of all, and of what has the smallest size
    double n = 0;               // triangles

    bool is_mostly_fine() const { return fine > all_above * area; }
};

FutureMesh future_mesh(const Mesh& mesh, const std::vector<double>& sizes, double smallest) {
    FutureMesh future;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const double size = (sizes[a] + sizes[b] + sizes[c]) / 3, area = mesh.area(t);
        future.area += area;
        if (size <= smallest) future.fine += area;
        future.n += std::max(1.0, n_triangles_of(area, size));
    }
    return future;
}

/// Loads alone will ask for small triangles in more than half of the body before its large ones have saved as much as
/// it costs to refine all of it: a coarse body that does not break carries the loads for that time.
bool loads_need_all_of_it(const Scenario& scenario, double area) {
    Scenario coarse = scenario;
    std::vector<MeshOptions*> meshes{&coarse.mesh};
    for (Body& body : coarse.bodies) meshes.push_back(&body.mesh);
    for (MeshOptions* mesh : meshes) {
        mesh->refine.clear();  // small triangles would need small steps
        mesh->size = std::max(mesh->size, std::sqrt(n_triangles_of(area, 1) / rehearsal_size));
    }
    try {
        Model model = build_model(coarse);
        const Model breakable = model;
        for (CohesiveLaw& law : model.laws)
            if (law.breakable()) law.sigma_c *= 1e9, law.G_c *= 1e9;  // never reached
        MoreauJean stepper(model, scenario.time.scheme);
        State now = initial_state(model), next = now;
        if (scenario.time.start_in_equilibrium) stepper.start_in_equilibrium(now);
        const double step_of_run = plan_steps(scenario.time, scenario.adapt, model, infinity).limits.largest,
                     end = steps_of_rebuild * step_of_run;
        const double n_steps = std::ceil(end / (0.8 * stepper.stable_step()));
        for (int step = 0; step < n_steps; ++step) {
            const std::vector<double> sizes = requested_sizes(breakable, now, scenario.adapt);
            if (future_mesh(model.mesh, sizes, scenario.adapt.size).is_mostly_fine()) return true;
            if (stepper.step(now, end / n_steps, next).rejection != Rejection::none) return false;
            std::swap(now, next);
        }
    } catch (const std::runtime_error&) {
        // a load that selects nothing in large triangles, or a motion that ends: the run reports it
    }
    return false;
}

}  // namespace

double n_triangles_of(double area, double size) { return 2.36 * area / (size * size); }

/// The stress exceeds 0.3 of the strength within some 5 lengths l = E' G_c/sigma_c^2 of a moving tip that dissipates
/// G_c (measured), in general within r ~ K^2 ~ G, and cracks along random edges dissipate up to 1.4 G_c: the width of
/// the strip that they leave is 14 l (0.3/load)^2, the margins, and the graded borders. Along a line that alone may
/// break only its own triangles are marked.
AdaptationForecast forecast(const Scenario& scenario, const Mesh& mesh) {
    const AdaptOptions& adapt = scenario.adapt;
    double cohesive_length = 0;
    for (const Resolution& r : judge_resolution(scenario, mesh))
        if (r.anywhere) cohesive_length = std::max(cohesive_length, r.cohesive_length);
    const double width = 14 * cohesive_length * 0.09 / (adapt.load * adapt.load) + 2 * adapt.margin * adapt.size +
                         2 * adapt.size / adapt.grading;
    const FutureMesh uniform = future_mesh(mesh, std::vector<double>(mesh.vertices.size(), adapt.size), adapt.size);
    const auto length = [](const std::vector<Vec2>& points) { return bounding_box(points).extent().maxCoeff(); };
    AdaptationForecast expected{.area = uniform.area, .uniform = uniform.n};
    double longest = scenario.given ? length(mesh.vertices) : 0;
    for (const Body& body : scenario.bodies) {
        const double across = length(body.shape.outer.points);
        longest = std::max(longest, across);
        for (const Crack& crack : body.shape.cracks)
            if (crack.joint < 0) expected.crack += across - length(crack.points);
    }
    if (expected.crack <= 0) expected.crack = longest;
    const auto after = [&](double advance) {
        return mesh.n_triangles() + n_triangles_of(std::min(uniform.area, width * advance), adapt.size);
    };
    expected.at_end = after(expected.crack), expected.at_most = after(1.5 * expected.crack);
    expected.gain = 2 * expected.uniform / (mesh.n_triangles() + expected.at_end);
    return expected;
}

std::string replace_where_it_does_not_pay(Scenario& scenario, const Mesh& coarse) {
    AdaptOptions& adapt = scenario.adapt;
    if (!adapt.active()) return {};
    const AdaptationForecast expected = forecast(scenario, coarse);
    if (expected.uniform > adapt.limit || scenario.given) return {};
    const bool short_zone = expected.gain >= pays_from;
    if (short_zone && !loads_need_all_of_it(scenario, expected.area)) return {};
    scenario.mesh.size = adapt.size;
    for (Body& body : scenario.bodies)
        body.mesh.size = std::min(body.mesh.size, adapt.size), body.mesh.refine = scenario.mesh.refine;
    adapt.size = 0;
    const std::string why =
        short_zone ? formatted("the loads bring most of the body near its strength within %d steps", steps_of_rebuild)
                   : formatted("the process zone is long (gain %.2g, below %.2g)", expected.gain, pays_from);
    return formatted(
        "refinement during the run does not pay here: a uniform mesh of adapt.size has %.2g triangles, and most of "
        "them would be needed, because %s. This run has the uniform mesh from the start",
        expected.uniform, why.c_str());
}

void Adaptation::guard(Model& model) const {
    if (!options_.active()) return;
    if (stays_coarse()) model.too_coarse.clear();
    else model.too_coarse = coarse_fans(model, options_.size);
}

void Adaptation::repeat(Model& model) const {
    if (!mesh_.triangles.empty()) {
        ModelInput input = input_;
        input.mesh = mesh_;
        input.mesh.parts = refined_parts(model.mesh, mesh_);
        model = make_model(std::move(input));
    }
    guard(model);
}

/// Those that came apart keep their triangles, so that the state knows all of them.
AdaptationCounts Adaptation::counts(const Model& model, const State& now) const {
    AdaptationCounts counts = counts_;
    const std::vector<std::uint8_t> coarse = coarse_fans(model, options_.size);
    for (std::size_t f = 0; f < coarse.size(); ++f)
        counts.coarse_breaks += coarse[f] && now.split_rank[f] >= 0 && !model.fans[f].split_at_start;
    return counts;
}

/// A vertex that is still coarse may split in this step, and those allowed before in it; after many looks all may.
void Adaptation::allow(const Vec2& place, const State& now, Model& model) {
    allowed_.push_back(place);
    const bool all = allowed_.size() > max_looks;
    bool is_coarse = false;
    for (std::size_t f = 0; f < model.too_coarse.size(); ++f) {
        if (!model.too_coarse[f]) continue;
        const Vec2& vertex = model.mesh.vertices[model.fans[f].vertex];
        if (!all && std::ranges::find(allowed_, vertex) == allowed_.end()) continue;
        model.too_coarse[f] = 0;
        is_coarse |= vertex == place;
    }
    if (!is_coarse || told_ || counts(model, now).coarse_breaks > 0) return;
    told_ = true;
    warning_ = formatted(
        "warning[adapt]: at t = %s the vertex at %s splits in triangles that are too large. They could not be refined "
        "because they touch a crack or would need a smaller step. This is the first such vertex; "
        "adaptation.coarse_breaks in run.json is their number. [[mesh.refine]] makes a region fine from the start\n",
        readable(now.time, "s", 6).c_str(), place_text(place).c_str());
}

void Adaptation::after_step(Model& model) {
    if (!allowed_.empty()) guard(model);
    allowed_.clear();
}

std::optional<RefinedMesh> Adaptation::look(Model& model, const State& loaded, const State& now,
                                            const std::optional<Vec2>& also) {
    const Mesh& mesh = model.mesh;
    if (!also) next_look_ = now.n_steps + static_cast<std::int64_t>(options_.every);
    std::vector<double> requested = requested_sizes(model, loaded, options_, also);
    const FutureMesh future = future_mesh(mesh, requested, options_.size);
    double n = future.n;
    if (future.is_mostly_fine() && mesh_state_ == MeshState::follows) {
        std::ranges::fill(requested, options_.size);
        n = n_triangles_of(future.area, options_.size);
        mesh_state_ = MeshState::is_fine;
        warning_ = formatted(
            "warning[adapt]: at t = %s more than half of the body must be refined, so all of it is refined now, %.3g "
            "triangles; a uniform mesh (mesh.size = %s, no [adapt]) is faster\n",
            readable(now.time, "s", 6).c_str(), n, readable(options_.size, "m").c_str());
    }
    std::optional<RefinedMesh> refined;
    if (n > options_.limit) {
        mesh_state_ = MeshState::stays;
        warning_ = formatted(
            "warning[adapt]: at t = %s the mesh would have %.3g triangles, adapt.limit is %.3g: it stays as it is, and "
            "interfaces break in coarse triangles; adaptation.coarse_breaks in run.json is the number of their "
            "vertices\n",
            readable(now.time, "s", 6).c_str(), n, options_.limit);
        guard(model);
    } else {
        refined = refined_mesh(model, now, options_, requested, static_cast<std::uint64_t>(counts_.batches) + 1);
    }
    if (also && !refined) allow(*also, now, model);
    return refined;
}

AdaptedModel Adaptation::refine(const Model& model, const State& now, RefinedMesh mesh,
                                const std::optional<Vec2>& also) {
    ++counts_.batches;
    counts_.largest_batch =
        std::max<std::int64_t>(counts_.largest_batch, std::ranges::count(mesh.triangle_before, Index(-1)));
    AdaptedModel refined = adapt(model, now, options_, std::move(mesh), input_);
    counts_.angular_momentum += refined.angular_momentum_change;
    mesh_ = refined.model.mesh;
    if (also) allow(*also, refined.state, refined.model);
    return refined;
}

}  // namespace knap
