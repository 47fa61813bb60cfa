#include "app/run/adaptation.hpp"

#include "app/run/setup.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double pays_below = 0.5;    // of the area that is to be fine
constexpr std::size_t max_looks = 8;  // at the mesh in one step

}  // namespace

double n_triangles_of(double area, double size) { return 2.36 * area / (size * size); }

/// The stress exceeds 0.3 of the strength within some 5 cohesive lengths of a moving tip (measured), elsewhere within
/// r ~ K^2: the width of the strip that a crack leaves is 10 l (0.3/load)^2, the margins, and the graded borders.
AdaptationForecast forecast(const Scenario& scenario, const Mesh& mesh) {
    const AdaptOptions& adapt = scenario.adapt;
    double cohesive_length = 0, area = 0;
    for (const Resolution& r : judge_resolution(scenario, mesh))
        cohesive_length = std::max(cohesive_length, r.cohesive_length);
    for (Index t = 0; t < mesh.n_triangles(); ++t) area += mesh.area(t);
    const double width = 10 * cohesive_length * 0.09 / (adapt.load * adapt.load) + 2 * adapt.margin * adapt.size +
                         2 * adapt.size / adapt.grading;
    AdaptationForecast expected{.crack = bounding_box(mesh.vertices).extent().maxCoeff(),
                                .uniform = n_triangles_of(area, adapt.size)};
    expected.at_end = mesh.n_triangles() + n_triangles_of(std::min(area, width * expected.crack), adapt.size);
    expected.gain = 2 * expected.uniform / (mesh.n_triangles() + expected.at_end);
    return expected;
}

void Adaptation::begin(Model& model) const {
    if (options_.active()) model.too_coarse = coarse_fans(model, options_.size);
}

void Adaptation::repeat(Model& model) const {
    if (mesh_.triangles.empty()) return begin(model);
    ModelInput input = input_;
    input.mesh = mesh_;
    model = make_model(std::move(input));
    begin(model);
    if (ended_) model.too_coarse.clear();
}

/// A vertex that is still coarse may split in this step, and those allowed before in it; after many looks all may.
void Adaptation::allow(const Vec2& place, double time, Model& model) {
    allowed_.push_back(place);
    std::vector<std::uint8_t>& coarse = model.too_coarse;
    const std::int64_t n_before = counts_.coarse_breaks;
    if (allowed_.size() > max_looks) coarse.clear(), ++counts_.coarse_breaks;
    for (std::size_t f = 0; f < coarse.size(); ++f) {
        if (!coarse[f]) continue;
        const auto at = std::ranges::find(allowed_, model.mesh.vertices[model.fans[f].vertex]);
        if (at == allowed_.end()) continue;
        coarse[f] = 0;
        counts_.coarse_breaks += at + 1 == allowed_.end();  // the others were counted
    }
    if (n_before == 0 && counts_.coarse_breaks > 0)
        warning_ = formatted(
            "warning[adapt]: at t = %.6g s the vertex at (%.6g, %.6g) m comes apart although its triangles are too "
            "large: at the faces of cracks, and where parts of them would need a smaller step, they stay as they are. "
            "It is the first one; adaptation.coarse_breaks in run.json is their number. [[mesh.refine]] makes a region "
            "fine from the start\n",
            time, place.x(), place.y());
}

std::optional<AdaptedModel> Adaptation::look(Model& model, const State& now, const std::optional<Vec2>& also) {
    const Stopwatch watch;
    const Mesh& mesh = model.mesh;
    if (!also) next_look_ = now.n_steps + static_cast<std::int64_t>(options_.every);
    std::vector<double> wanted = wanted_sizes(model, now, options_, also);
    double area = 0, fine = 0, n = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const double size = (wanted[a] + wanted[b] + wanted[c]) / 3;
        area += mesh.area(t);
        if (size <= options_.size) fine += mesh.area(t);
        n += std::max(1.0, n_triangles_of(mesh.area(t), size));
    }
    if (fine > pays_below * area && !ended_) {
        std::ranges::fill(wanted, options_.size);
        n = n_triangles_of(area, options_.size);
        ended_ = true;
        warning_ = formatted(
            "warning[adapt]: at t = %.6g s more than half of the body is to be fine: all of it is from now on, %.3g "
            "triangles; a uniform mesh (mesh.size = %.3g m, no [adapt]) is faster\n",
            now.time, n, options_.size);
    }
    std::optional<AdaptedModel> refined;
    if (n > options_.limit) {
        ended_ = true;
        warning_ = formatted(
            "warning[adapt]: at t = %.6g s the mesh would have %.3g triangles, adapt.limit is %.3g: it stays as it is, "
            "and interfaces break in coarse triangles\n",
            now.time, n, options_.limit);
        model.too_coarse.clear();
    } else {
        refined = adapt(model, now, options_, wanted, input_, static_cast<std::uint64_t>(counts_.batches) + 1);
    }
    if (refined) {
        ++counts_.batches;
        counts_.largest_batch = std::max<std::int64_t>(counts_.largest_batch,
                                                       std::ranges::count(refined->numbers.triangle_before, Index(-1)));
        counts_.angular_momentum += refined->angular_momentum_change;
        mesh_ = refined->model.mesh;
    }
    Model& present = refined ? refined->model : model;
    if (also) allow(*also, now.time, present);
    counts_.cpu += watch.cpu();
    return refined;
}

}  // namespace knap
