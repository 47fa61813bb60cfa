#include "app/setup/setup.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "mesh/shape_graph.hpp"
#include "microstructure/grain_mesh.hpp"
#include "model/make_model.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace knap {

namespace {

/// The vertices between the triangles of excavated regions and others.
std::vector<Index> outline_vertices(const Scenario& scenario, const Mesh& mesh) {
    std::vector<Index> found;
    for (const Excavation& excavation : scenario.excavations)
        for (const InteriorEdge& edge : edges_around(mesh, triangles_in(mesh, excavation.outline)))
            for (const Index v : mesh.side_vertices(edge.triangle[0], edge.side[0])) found.push_back(v);
    return found;
}

/// Grains in the materials that have them; every rock has its own random numbers.
void put_rocks(const Scenario& scenario, Mesh& mesh) {
    const std::vector<Index> fixed = outline_vertices(scenario, mesh);
    const Box box = bounding_box(mesh.vertices);
    for (const GrainedRock& rock : scenario.rocks) {
        const std::uint64_t seed = scenario.seed + static_cast<std::uint64_t>(rock.material) * 0x9E3779B97F4A7C15ull;
        const Index first = put_grains(mesh, Grains(rock.grains, box, seed), rock.material, fixed);
        assign_minerals(mesh, rock.minerals, first, seed);
    }
}

/// The bodies one after the other. Throws ShapeError with the faults of all bodies; a part of the shape of a body is
/// named as ReadResult::at_shapes finds it: "holes[0]", "body[2].holes[0]".
Mesh mesh_of(const Scenario& scenario) {
    if (scenario.given) return scenario.given->mesh;
    if (const Body& body = scenario.bodies.front(); body.name.empty()) return triangulate(body.shape, body.mesh);
    Mesh mesh;
    std::vector<ShapeFault> faults;
    for (const Body& body : scenario.bodies) try {
            const Index first = mesh.n_triangles();
            append(mesh, triangulate(body.shape, body.mesh));
            mesh.parts.push_back({body.name, first, mesh.n_triangles() - first});
        } catch (const ShapeError& error) {
            for (const ShapeFault& fault : error.faults)
                faults.push_back({body.path + "." + fault.part, "(body `" + body.name + "`) " + fault.text});
        }
    if (!faults.empty()) throw ShapeError(faults);
    for (const BodyGroup& group : scenario.groups) {
        const MeshPart &first = mesh.parts[group.first], &last = mesh.parts[group.first + group.n - 1];
        mesh.parts.push_back(
            {group.name, first.first_triangle, last.first_triangle + last.n_triangles - first.first_triangle});
    }
    return mesh;
}

}  // namespace

Model build_model(const Scenario& scenario) {
    ModelInput input = model_input(scenario);
    input.mesh = mesh_of(scenario);
    input.mesh.order = scenario.order;
    if (!scenario.maps.empty()) {
        const std::vector<Index> fixed = outline_vertices(scenario, input.mesh);
        for (const MaterialMap& map : scenario.maps) paint(map, input.mesh, fixed);
    }
    if (!scenario.rocks.empty()) put_rocks(scenario, input.mesh);
    return make_model(std::move(input));
}

ModelInput model_input(const Scenario& scenario) {
    ModelInput input;
    input.plane = scenario.plane;
    input.large_rotation = scenario.large_rotation;
    input.thickness = scenario.thickness;
    for (const NamedMaterial& material : scenario.materials) {
        input.materials.push_back(material.elastic);
        input.layer_angle.push_back(material.layer_angle);
    }
    for (const NamedLaw& law : scenario.laws) {
        input.laws.push_back(law.law);
        input.scatter.push_back(law.scatter);
        input.over_bedding.push_back(law.over_bedding);
    }
    input.law_of_pair = scenario.law_of_pair;
    input.law_within = scenario.law_within;
    input.law_of_joint = scenario.law_of_joint;
    input.seed = scenario.seed;
    input.loads = scenario.loads;
    input.crack_pressures = scenario.crack_pressures;
    input.supports = scenario.supports;
    input.initial_velocities = scenario.initial_velocities;
    input.initial_stresses = scenario.initial_stresses;
    input.obstacles = scenario.obstacles;
    input.contact_of_pair = scenario.contact_of_pair;
    input.mass_scaling = scenario.time.mass_scaling;
    for (const Excavation& excavation : scenario.excavations) input.cuts.push_back(excavation.outline);
    if (scenario.heat) input.heat = std::make_shared<Heat>(*scenario.heat);
    return input;
}

LawStrength law_strength(const Scenario& scenario) {
    for (std::size_t m = 0; scenario.specimen && m < scenario.materials.size(); ++m) {
        const NamedLaw& named = scenario.laws[scenario.law_of_pair[m][m]];
        CohesiveLaw law = named.law;
        if (!law.breakable() || law.sigma_c <= 0 || named.over_bedding.any()) continue;
        LawStrength found{.of_interfaces = strength_by_law(scenario.specimen->test, law)};
        law.sigma_c = named.measured_sigma_c;
        if (law.sigma_c > 0) found.measured = strength_by_law(scenario.specimen->test, law);
        return found;
    }
    return {};
}

namespace {

std::vector<FigureContext::Line> lines_of(const std::vector<CollectorOptions>& collectors) {
    std::vector<FigureContext::Line> lines;
    for (const CollectorOptions& one : collectors)
        lines.push_back(
            {one.name, one.x ? Vec2(*one.x, -infinity) : one.from, one.x ? Vec2(*one.x, infinity) : one.to});
    return lines;
}

}  // namespace

RecorderOptions recorder_options(const Scenario& scenario, const Model& model, const RareWorks& works,
                                 const std::filesystem::path& directory, bool resumes, bool continues_other_run) {
    double process_zone = 0, fastest = 0, critical_opening = 0;
    for (const Resolution& r : judge_resolution(scenario, model.mesh))
        process_zone = std::max(process_zone, r.process_zone);
    for (const NamedMaterial& material : scenario.materials)
        fastest = std::max(fastest, material.elastic.dilatational_speed(scenario.plane));
    RecorderOptions::Calibrated toughness, strength;
    for (const NamedLaw& law : scenario.laws) {
        if (law.law.breakable()) critical_opening = std::max(critical_opening, law.law.delta_c());
        if (law.measured_G_c > 0 && toughness.measured == 0) toughness = {law.measured_G_c, law.law.G_c};
        if (law.measured_sigma_c > 0 && strength.measured == 0) strength = {law.measured_sigma_c, law.law.sigma_c};
    }
    return {.directory = directory,
            .end = scenario.time.end,
            .compression = scenario.output.compression,
            .frame_every = scenario.output.between_frames(),
            .history_every = scenario.output.history_every,
            .fragments_every = scenario.output.every,
            .mass = scenario.time.scheme.mass,
            .theta = scenario.time.scheme.theta,
            .works = works,
            .cracks = crack_options(diagonal(model.mesh.vertices), process_zone, fastest, model.mesh.order),
            .critical_opening = critical_opening,
            .allowed_limits = scenario.allowed_limits,
            .figures = scenario.figures,
            .context = {.title = scenario.title.empty() ? scenario.name : scenario.title,
                        .rayleigh_speed = rayleigh_speed(scenario),
                        .materials = scenario.material_names(),
                        .celsius = scenario.heat && scenario.heat->celsius,
                        .collectors = lines_of(scenario.collectors)},
            .probes = scenario.probes,
            .collectors = scenario.collectors,
            .trajectories = scenario.output.trajectories,
            .breaks = scenario.output.breaks,
            .specimen = scenario.specimen,
            .law_strength = law_strength(scenario),
            .toughness = toughness,
            .strength = strength,
            .rest = scenario.time.rest,
            .resumes = resumes,
            .continues_other_run = continues_other_run};
}

RunRecord record_of(const Scenario& scenario, const Model& model, const StepPlan& plan) {
    return {.status = "running",
            .name = scenario.name,
            .title = scenario.title,
            .seed = scenario.seed,
            .triangles = model.mesh.n_triangles(),
            .interfaces = static_cast<Index>(model.interfaces.size()),
            .thickness = model.thickness,
            .step = plan.limits.largest,
            .scheme = scenario.time.scheme,
            .mass_scaling = moved_mass(model),
            .mean_edge = mean_edge(model.mesh),
            .rayleigh_speed = rayleigh_speed(scenario),
            .materials = scenario.material_names(),
            .temperature_unit = !scenario.heat           ? ""
                                : scenario.heat->celsius ? "C"
                                                         : "K",
            .collectors = lines_of(scenario.collectors)};
}

std::vector<Resolution> judge_resolution(const Scenario& scenario, const Mesh& mesh) {
    std::vector<Resolution> found;
    const double edge = scenario.finest_edge(mean_edge(mesh));
    std::set<std::pair<Index, Index>> meeting;  // materials of separate bodies have no interface
    for (const InteriorEdge& interface : mesh.interior_edges)
        meeting.insert(std::minmax(mesh.region[interface.triangle[0]], mesh.region[interface.triangle[1]]));
    const auto judge_law = [&](const std::string& where, const NamedLaw& law, double modulus, double wave_speed,
                               bool anywhere) {
        if (!law.law.breakable() || law.law.sigma_c <= 0) return;
        const double shortest = law.over_bedding.shortest_zone();
        found.push_back({where, law.name, shortest * law.law.cohesive_length(modulus),
                         shortest * law.law.process_zone(modulus), shortest * law.law.steep_zone(modulus) / edge,
                         wave_speed, law.law.steepness(), anywhere});
    };
    const auto modulus = [&](const NamedMaterial& material) { return material.elastic.plane_modulus(scenario.plane); };
    const auto speed = [&](const NamedMaterial& material) {
        return material.elastic.dilatational_speed(scenario.plane);
    };
    for (std::size_t a = 0; a < scenario.materials.size(); ++a)
        for (std::size_t b = a; b < scenario.materials.size(); ++b) {
            if (!meeting.contains({static_cast<Index>(a), static_cast<Index>(b)})) continue;
            const NamedMaterial &one = scenario.materials[a], &other = scenario.materials[b];
            judge_law(a == b ? one.name : one.name + "-" + other.name, scenario.laws[scenario.law_of_pair[a][b]],
                      std::min(modulus(one), modulus(other)), std::max(speed(one), speed(other)), a == b);
        }
    for (std::size_t f = 0; f < scenario.supports.size(); ++f) {
        if (!scenario.supports[f].glued) continue;
        double softest = infinity,
               fastest = 0;  // only the mesh knows which one is there
        for (const NamedMaterial& material : scenario.materials)
            softest = std::min(softest, modulus(material)), fastest = std::max(fastest, speed(material));
        judge_law("support " + std::to_string(f + 1), scenario.laws[scenario.supports[f].law], 2 * softest, fastest,
                  false);
    }
    return found;
}

namespace {

/// What the snap of a body moved and left out.
std::string snap_text(const Scenario& scenario, std::size_t number) {
    const Body& body = scenario.bodies[number];
    SnapCounts counts;
    planar_graph(body.shape, 0, &counts);
    std::string text =
        formatted("  %-14s within %s: %d ends joined, %d corners and crossings merged", (body.path + ".snap").c_str(),
                  readable(body.shape.snap, "m").c_str(), counts.n_joined, counts.n_merged);
    if (counts.n_left_out > 0)
        text += formatted(", %d pieces left out, %s in all", counts.n_left_out,
                          readable(counts.length_left_out, "m").c_str());
    std::vector<std::string> lost;
    for (const Index crack : counts.lost)
        lost.push_back(scenario.table_of_part(number, PlacedSet::Part::cracks, static_cast<std::size_t>(crack),
                                              body.path + ".crack"));
    if (!lost.empty()) text += "; wholly left out or on other lines: " + first_of(lost);
    return text + "\n";
}

/// ", 515 m, 476 m after snap"
std::string lengths_text(const CrackLengths& lengths, const PlacedSet& set, bool snaps) {
    const auto sum = [&](const std::vector<double>& of_cracks) {
        const auto first = of_cracks.begin() + static_cast<std::ptrdiff_t>(set.first);
        return readable(std::accumulate(first, first + set.n, 0.0), "m");
    };
    return ", " + sum(lengths.drawn) + (snaps ? ", " + sum(lengths.after) + " after snap" : "");
}

/// "70 of quartz (55 % of the area), 31 of mica (45 %)"
std::string grains_text(const Scenario& scenario, const Mesh& mesh) {
    std::vector<std::set<Index>> grains(scenario.materials.size());
    std::vector<double> area(grains.size(), 0.0);
    double total = 0, of_none = 0;  // [m2]
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        total += mesh.area(t);
        if (mesh.grain[t] < 0) of_none += mesh.area(t);
        else grains[mesh.region[t]].insert(mesh.grain[t]), area[mesh.region[t]] += mesh.area(t);
    }
    std::vector<std::string> texts;
    for (std::size_t m = 0; m < grains.size(); ++m)
        if (!grains[m].empty())
            texts.push_back(formatted("%zu of %s (%.3g %%)", grains[m].size(), scenario.materials[m].name.c_str(),
                                      100 * area[m] / total));
    return joined(texts) + (of_none > 0 ? formatted("; %.3g %% of the area in no grain", 100 * of_none / total) : "");
}

}  // namespace

CrackLengths::CrackLengths(Shape shape) {
    const auto inside = [&] {
        std::vector<double> lengths(shape.cracks.size(), 0.0);
        const PlanarGraph graph = planar_graph(shape, 0);
        for (const GraphSegment& segment : graph.segments) {
            if (segment.crack < 0) continue;
            const auto [a, b] = graph.line(segment);
            lengths[segment.crack] += (b - a).norm();
        }
        return lengths;
    };
    after = inside();
    if (std::exchange(shape.snap, 0) > 0) drawn = inside();
    else drawn = after;
}

std::string placed_sets_text(const Scenario& scenario, const Mesh& mesh) {
    std::string text;
    if (scenario.given && !scenario.given->others.empty())
        text += formatted("  mesh.material  %s: of %zu surfaces that are no material (%s)\n",
                          scenario.materials[scenario.given->of_others].name.c_str(), scenario.given->others.size(),
                          first_of(scenario.given->others).c_str());
    if (!mesh.grain.empty()) text += "  grains         " + grains_text(scenario, mesh) + '\n';
    for (std::size_t i = 0; i < scenario.bodies.size(); ++i)
        if (scenario.bodies[i].shape.snap > 0) text += snap_text(scenario, i);
    std::map<std::size_t, CrackLengths> of_body;
    const auto lengths_of = [&](std::size_t body) -> const CrackLengths& {
        return of_body.try_emplace(body, scenario.bodies[body].shape).first->second;
    };
    for (const PlacedSet& set : scenario.placed_sets)
        text +=
            formatted("  %-14s %d placed", set.path.c_str(), set.n) +
            (set.is_random() ? "" : lengths_text(lengths_of(set.body), set, scenario.bodies[set.body].shape.snap > 0)) +
            (set.n_cropped > 0 ? formatted(", %d outside the body left out", set.n_cropped) : "") +
            (set.fraction > 0 ? formatted(", %.4g %% of the area of the body\n", 100 * set.fraction) : "\n");
    return text;
}

double rayleigh_speed(const Scenario& scenario) {
    return scenario.materials.front().elastic.rayleigh_speed(scenario.plane);
}

}  // namespace knap
