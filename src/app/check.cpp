// knap check: what people ask before they run.
#include "app/commands.hpp"
#include "app/run/cost.hpp"
#include "app/run/model_findings.hpp"
#include "app/run/setup.hpp"
#include "app/run/step_plan.hpp"
#include "base/stopwatch.hpp"
#include "scenario/write_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

void print_mesh(const MeshReport& mesh) {
    std::printf("mesh\n  triangles %d, vertices %d, interfaces %d, pre-cracked edges %d\n", mesh.n_triangles, mesh.n_vertices,
                mesh.n_interior_edges, mesh.n_cracked_edges);
    std::printf("  edge lengths %.3g / %.3g / %.3g mm (smallest, mean, largest)\n", 1e3 * mesh.smallest_edge, 1e3 * mesh.mean_edge,
                1e3 * mesh.largest_edge);
    std::printf("  angles: smallest %.1f, 1 %% of the triangles below %.1f, largest %.1f degree\n", mesh.smallest_angle,
                mesh.smallest_angle_percentiles[0], mesh.largest_angle);
    if (mesh.n_paths > 0)
        std::printf("  paths along edges are %.1f %% longer than straight lines (%.1f %% far from their ends), spread over directions %.1f %%\n",
                    100 * mesh.mean_path_excess, 100 * mesh.far_path_excess, 100 * mesh.path_excess_spread);
}

void print_materials(const Scenario& scenario) {
    std::printf("wave speeds\n");
    for (const NamedMaterial& m : scenario.materials)
        std::printf("  %-12s c_d %.1f, c_s %.1f, c_R %.1f m/s\n", m.name.c_str(), m.elastic.dilatational_speed(scenario.plane),
                    m.elastic.shear_speed(), m.elastic.rayleigh_speed(scenario.plane));
}

/// `step`: [s] the one in which cohesion may fall.
void print_resolution(const Scenario& scenario, double mean_edge, double step) {
    const std::vector<Resolution> found = judge_resolution(scenario, mean_edge);
    std::printf("interfaces\n");
    for (const Resolution& r : found)
        std::printf("  %-12s law %s: process zone %.3g mm (at rest), %.1f edges; cohesive length %.3g mm\n", r.material.c_str(), r.law.c_str(),
                    1e3 * r.process_zone, r.n_edges, 1e3 * r.cohesive_length);
    const SchemeOptions& scheme = scenario.time.scheme;
    for (const Resolution& r : found) {
        const double limit = assumption_1_step(r, finest_edge(scenario, mean_edge), scheme.theta);
        const char* what = scheme.cohesion == CohesionScheme::explicit_beta ? "of an implicit cohesion; explicit beta has no such limit"
                           : limit >= step                                  ? "holds for every step"
                           : scheme.respect_assumption_1                    ? "may not hold where cohesion falls: such steps are cut"
                                                                            : "may not hold where cohesion falls: one of several solutions is taken";
        std::printf("  %-12s Assumption 1 margin %.2f: surely holds up to h = %.3g s; %s\n", r.material.c_str(), limit / step, limit, what);
    }
}

void print_parts(const Scenario& scenario, const Model& model) {
    bool friction = false, restitution = false, breakable = false, shear = false;
    for (const Interface& i : model.interfaces) {
        const CohesiveLaw& law = model.laws[i.law];
        breakable = breakable || (law.breakable() && !i.cracked);
        if (!law.breakable() && !i.cracked) continue;
        friction = friction || law.friction > 0;
        restitution = restitution || law.restitution > 0;
        shear = shear || law.gamma > 0;
    }
    std::printf("what this scene needs\n  cohesion %s, tangential cohesion %s, friction %s, impact %s, supports %s, driven boundaries %s\n",
                breakable ? "yes" : "no (elastic)", breakable && shear ? "yes" : "no", friction ? "yes" : "no",
                restitution ? "with restitution" : "plastic", scenario.supports.empty() ? "no" : "yes", model.prescribed.empty() ? "no" : "yes");
    const SchemeOptions& scheme = scenario.time.scheme;
    const bool implicit_bulk = scheme.bulk == BulkScheme::implicit_theta, implicit_beta = scheme.cohesion == CohesionScheme::implicit_beta;
    std::printf("  path: ");
    if (implicit_bulk)
        std::printf("implicit bulk (theta %g, %s mass%s), ", scheme.theta, name_of(scheme.mass),
                    scenario.time.start_in_equilibrium ? ", from equilibrium" : "");
    else
        std::printf("explicit lumped bulk, ");
    std::printf("%s; ", implicit_beta ? "implicit beta" : "explicit beta");
    std::printf("%s\n", implicit_bulk ? "all interfaces together: method of multipliers, sparse factorisations" : "one exact problem per vertex that may open");
}

void print_cost(const Cost& cost, bool long_measured) {
    std::printf("  about %.3g s of one core: mesh and model %.2g, steps %.2g, frames %.2g, figures %.2g, tables %.2g\n", cost.total(), cost.model, cost.steps, cost.frames,
                cost.figures, cost.lines);
    std::printf("  a step takes %.2g s now (measured%s), %.1f times that on the mean, as in the gallery; within a factor of 2 there, more where all goes to pieces\n",
                cost.first_step, long_measured ? "" : ", shortly; --time takes longer", cost.mean_over_first);
    std::printf("  %.0f MB of memory, %.0f MB of disk for %.0f frames\n", cost.memory, cost.disk, cost.n_frames);
}

}  // namespace

ExitCode check_scenario(const ReadResult& read, bool full, bool strict, bool time) {
    const Scenario& scenario = read.scenario;
    const Stopwatch watch;
    const Model model = model_of(read);
    const double model_seconds = watch.cpu();
    refuse_unheld_body(read, model);
    const StepPlan plan = plan_of(read, model, scenario.time.end);
    const double edge = mean_edge(model.mesh);

    if (full) std::fputs(full_listing(read).c_str(), stdout);
    std::printf("%s: %s\n", scenario.name.c_str(), scenario.title.c_str());
    print_mesh(judge(model.mesh));
    std::fputs(random_sets_text(scenario).c_str(), stdout);
    print_materials(scenario);
    print_resolution(scenario, edge, plan.limits.cracking);
    print_parts(scenario, model);

    std::printf("run\n  stable step %.4g s, h = %.4g s (%.3g CFL), %lld steps, %.3g triangle-steps\n", plan.stable_step, plan.limits.largest,
                plan.limits.largest / plan.stable_step, static_cast<long long>(plan.n_steps),
                static_cast<double>(plan.n_steps) * model.mesh.n_triangles());
    if (plan.limits.cracking < plan.limits.largest)
        std::printf("  from the first loss of cohesion on h = %.4g s (%.3g CFL): up to %.0f steps\n", plan.limits.cracking,
                    plan.limits.cracking / plan.stable_step, std::ceil(scenario.time.end / plan.limits.cracking));
    const Cost cost = estimate_cost(scenario, model, plan, model_seconds, time ? 0.5 : 0.05);
    print_cost(cost, time);

    std::vector<Diagnostic> warnings = read.warnings;
    for (const Diagnostic& warning : findings_of_model(read, model, plan, &cost)) warnings.push_back(warning);
    for (const Diagnostic& warning : warnings) std::fputs(format(warning).c_str(), stderr);
    return strict && !warnings.empty() ? exit_bad_input : exit_done;
}

}  // namespace knap
