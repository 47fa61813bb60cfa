// knap mesh: only make, or judge, the mesh.
#include "app/commands.hpp"
#include "app/new_file.hpp"
#include "app/run/model_findings.hpp"
#include "app/run/setup.hpp"
#include "base/error.hpp"
#include "element/triangle_matrices.hpp"
#include "mesh/mesh_file.hpp"
#include "microstructure/grain_mesh.hpp"

#include <algorithm>
#include <numbers>
#include <cstdio>

namespace knap {

namespace {

void print_grains(const Scenario& scenario, const Mesh& mesh) {
    const GrainReport grains = judge_grains(mesh);
    std::printf("%-28s %d, of them %d whole\n", "grains", grains.n_grains, grains.n_whole);
    std::printf("%-28s %.4g, spread %.3f\n", "mean grain diameter [m]", grains.mean_diameter, grains.spread);
    std::printf("%-28s %.2f at %.0f degree\n", "mean grain elongation", grains.elongation, grains.direction * 180 / std::numbers::pi);
    std::printf("%-28s %d\n", "least triangles in a grain", grains.min_triangles);
    std::vector<double> area(scenario.materials.size(), 0);
    double total = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) area[mesh.region[t]] += mesh.area(t), total += mesh.area(t);
    for (std::size_t i = 0; i < area.size(); ++i)
        std::printf("%-28s %.2f %%\n", ("area of " + scenario.materials[i].name).c_str(), 100 * area[i] / total);
}

}  // namespace

ExitCode mesh_scenario(const ReadResult& read, const std::filesystem::path& output, bool force) {
    const Model model = model_of(read);
    const MeshReport report = judge(model.mesh);
    for (const auto& warnings : {read.warnings, findings_of_places(read, model)})
        for (const Diagnostic& warning : warnings) std::fputs(format(warning).c_str(), stderr);
    const std::vector<double> steps = stable_steps(model.mesh, model.materials, model.plane);
    std::printf("%-28s %d\n%-28s %d\n%-28s %d\n%-28s %d\n", "triangles", report.n_triangles, "vertices", report.n_vertices, "interfaces",
                report.n_interior_edges, "pre-cracked edges", report.n_cracked_edges);
    std::printf("%-28s %.6g\n", "area [m2]", report.area);
    std::printf("%-28s %.4g %.4g %.4g\n", "edge length [m]", report.smallest_edge, report.mean_edge, report.largest_edge);
    std::printf("%-28s %.2f (1 %% below %.2f, 10 %% %.2f, 50 %% %.2f)\n", "smallest angle [degree]", report.smallest_angle,
                report.smallest_angle_percentiles[0], report.smallest_angle_percentiles[1], report.smallest_angle_percentiles[2]);
    std::printf("%-28s %.2f\n", "largest angle [degree]", report.largest_angle);
    std::printf("%-28s %.4g\n", "stable step [s]", *std::min_element(steps.begin(), steps.end()));
    for (const Resolution& r : judge_resolution(read.scenario, mean_edge(model.mesh)))
        std::printf("%-28s %.1f (%s, %.3g m)\n", "edges per process zone", r.n_edges, r.material.c_str(), r.process_zone);
    if (report.n_paths > 0) {
        std::printf("%-28s %.4f, spread over directions %.4f; without the ends of the paths %.4f\n", "path excess", report.mean_path_excess,
                    report.path_excess_spread, report.far_path_excess);
        for (int i = 0; i < MeshReport::n_directions; ++i)
            std::printf("  %5.1f degree  %.4f\n", 180.0 * i / MeshReport::n_directions, report.path_excess[i]);
    }
    std::fputs(random_sets_text(read.scenario).c_str(), stdout);
    if (!model.mesh.grain.empty()) print_grains(read.scenario, model.mesh);
    if (output.empty()) return exit_done;
    const std::string ending = output.extension().string();
    if (ending != ".msh" && ending != ".vtu" && ending != ".svg")
        throw UserError("mesh-format", "a mesh is not written as `" + ending + "`", "known: .msh, .vtu, .svg");
    if (!force) refuse_existing(output);
    write_new_file(output, mesh_as_text(model.mesh, ending, material_names(read.scenario)));
    std::printf("mesh:    %s\n", output.string().c_str());
    return exit_done;
}

}  // namespace knap
