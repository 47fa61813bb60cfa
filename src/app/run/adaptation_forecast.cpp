#include "app/run/adaptation_forecast.hpp"

#include "app/run/setup.hpp"
#include "base/formatted.hpp"
#include "stepper/moreau_jean.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double pays_from = 2;            // gain of the forecast
constexpr double rehearsal_size = 8000;    // triangles of the rehearsal at most
constexpr int n_looks = 64;                // at equal times of a run
constexpr double step_of_rehearsal = 0.8;  // [-] of the stable step

/// The cohesive length [m] of all laws, and of those along whose interfaces a crack may take any path; 0: none.
struct CohesiveLengths {
    double all = 0, anywhere = 0;
};

CohesiveLengths cohesive_lengths(const Scenario& scenario, const Mesh& mesh) {
    CohesiveLengths lengths;
    for (const Resolution& r : judge_resolution(scenario, mesh)) {
        lengths.all = std::max(lengths.all, r.cohesive_length);
        if (r.anywhere) lengths.anywhere = std::max(lengths.anywhere, r.cohesive_length);
    }
    return lengths;
}

/// What the loads do to a body that does not break.
struct Rehearsal {
    double first_crack = infinity;  // [s]
    std::vector<double> n;          // triangles that are needed, after each look
};

/// The scenario with few triangles, and without small ones, which would need small steps.
Scenario coarsened(const Scenario& scenario, double area) {
    Scenario coarse = scenario;
    for (MeshOptions* mesh : {&coarse.mesh, &coarse.bodies.front().mesh}) {
        mesh->refine.clear();
        mesh->size = std::max(scenario.mesh.size, std::sqrt(n_triangles_of(area, 1) / rehearsal_size));
    }
    return coarse;
}

/// A crack starts where the load factor of a coarse triangle reaches 1; at the end of a crack where K reaches the
/// toughness, at 0.4 edges from the tip.
double factor_of_first_crack(const Scenario& scenario, const Mesh& mesh) {
    if (scenario.bodies.front().shape.cracks.empty()) return 1;
    const double at_tip = cohesive_lengths(scenario, mesh).all / (2 * std::numbers::pi * 0.4 * mean_edge(mesh));
    return std::min(1.0, std::sqrt(at_tip));
}

/// Until a crack that starts with the first one has crossed the body in the time `crossing` [s]: later loads meet
/// another body.
Rehearsal rehearse(const Scenario& scenario, double area, double uniform, double crossing) {
    const AdaptOptions& adapt = scenario.adapt;
    Model model = build_model(coarsened(scenario, area));
    const Model breakable = model;
    for (CohesiveLaw& law : model.laws)
        if (law.breakable()) law.sigma_c *= 1e9, law.G_c *= 1e9;  // never reached
    AdaptOptions starts = adapt;
    starts.load = factor_of_first_crack(scenario, model.mesh);
    starts.margin = 0;

    MoreauJean stepper(model, scenario.time.scheme);
    State now = initial_state(model), next = now;
    if (scenario.time.start_in_equilibrium) stepper.start_in_equilibrium(now);
    const double largest = step_of_rehearsal * stepper.stable_step(), end = scenario.time.end;
    const double n_steps = std::max(1.0, std::ceil(end / n_looks / largest)), h = end / n_looks / n_steps;
    Rehearsal found;
    std::vector<double> sizes(model.mesh.vertices.size(), adapt.coarse);
    for (int look = 0; look < n_looks && now.time <= found.first_crack + crossing; ++look) {
        for (int i = 0; i < n_steps; ++i) {
            if (stepper.step(now, h, next).rejection != Rejection::none) return found;
            std::swap(now, next);
        }
        const std::vector<double> requested = requested_sizes(breakable, now, adapt);
        std::ranges::transform(sizes, requested, sizes.begin(), [](double a, double b) { return std::min(a, b); });
        const FutureMesh future = future_mesh(model.mesh, sizes, adapt.size);
        found.n.push_back(future.is_mostly_fine() ? uniform : future.n);
        if (found.first_crack == infinity && std::ranges::min(requested_sizes(breakable, now, starts)) <= adapt.size)
            found.first_crack = now.time;
    }
    return found;
}

}  // namespace

double n_triangles_of(double area, double size) { return 2.36 * area / (size * size); }

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

/// The stress exceeds 0.3 of the strength within some 5 cohesive lengths of a moving tip (measured), elsewhere within
/// r ~ K^2: the width of the strip that a crack leaves is 10 l (0.3/load)^2, the margins, and the graded borders. Along
/// a line that alone may break only its own triangles are marked.
AdaptationForecast forecast(const Scenario& scenario, const Mesh& mesh) {
    const AdaptOptions& adapt = scenario.adapt;
    const double width = 10 * cohesive_lengths(scenario, mesh).anywhere * 0.09 / (adapt.load * adapt.load) +
                         2 * adapt.margin * adapt.size + 2 * adapt.size / adapt.grading;
    const FutureMesh uniform = future_mesh(mesh, std::vector<double>(mesh.vertices.size(), adapt.size), adapt.size);
    const double across = bounding_box(mesh.vertices).extent().maxCoeff(),
                 crossing = across / (0.5 * rayleigh_speed(scenario));
    AdaptationForecast expected{.uniform = uniform.n};
    for (const Crack& crack : scenario.bodies.front().shape.cracks)
        if (crack.joint < 0) expected.crack += across - bounding_box(crack.points).extent().maxCoeff();
    if (expected.crack <= 0) expected.crack = across;

    Rehearsal loads{.first_crack = 0};
    try {
        loads = rehearse(scenario, uniform.area, uniform.n, crossing);
    } catch (const std::runtime_error&) {
        // a load that selects nothing in large triangles, or a motion that ends: the run reports it, cracks remain
    }
    double sum = 0;
    for (int look = 1; look <= n_looks; ++look) {
        const double time = scenario.time.end * look / n_looks,
                     run = std::clamp((time - loads.first_crack) / crossing, 0.0, 1.0) * expected.crack;
        if (look <= std::ssize(loads.n)) expected.by_loads = loads.n[look - 1];
        const double by_cracks = mesh.n_triangles() + n_triangles_of(width * run, adapt.size);
        expected.at_end = std::min(uniform.n, std::max(expected.by_loads, by_cracks));
        sum += expected.at_end;
    }
    expected.mean = sum / n_looks;
    return expected;
}

std::string replace_where_it_does_not_pay(Scenario& scenario, const Mesh& coarse) {
    AdaptOptions& adapt = scenario.adapt;
    if (!adapt.active()) return {};
    const AdaptationForecast expected = forecast(scenario, coarse);
    if (expected.gain() >= pays_from || expected.uniform > adapt.limit) return {};
    scenario.mesh.size = adapt.size;
    for (Body& body : scenario.bodies) body.mesh.size = adapt.size, body.mesh.refine = scenario.mesh.refine;
    adapt.size = 0;
    return formatted(
        "refinement during the run does not pay here: a uniform mesh of adapt.size has %.2g triangles, and most of "
        "them would be needed (gain %.2g, below %.2g), because %s. This run has the uniform mesh from the start",
        expected.uniform, expected.gain(), pays_from,
        expected.by_loads > 0.5 * expected.uniform ? "the loads bring most of the body near its strength"
                                                   : "the process zone is long");
}

}  // namespace knap
