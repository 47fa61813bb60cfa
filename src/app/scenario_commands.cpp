// knap check, knap mesh, knap new: a scenario before it is run.
#include "app/check/cost.hpp"
#include "app/check/findings.hpp"
#include "app/check/heat_scales.hpp"
#include "app/check/law_table.hpp"
#include "app/check/mesh_surplus.hpp"
#include "app/check/stress_balance.hpp"
#include "app/commands.hpp"
#include "app/ensemble/ensemble.hpp"
#include "app/run/run_text.hpp"
#include "app/run/start_state.hpp"
#include "app/setup/adaptation.hpp"
#include "app/setup/excavations.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "base/terminal.hpp"
#include "base/whole_file.hpp"
#include "mesh/mesh_file.hpp"
#include "microstructure/grain_mesh.hpp"
#include "model/mass_scaling.hpp"
#include "model/part_of_body.hpp"
#include "model/selections.hpp"
#include "scenario/schema.hpp"
#include "scenario/specimen_strength.hpp"
#include "scenario/write_scenario.hpp"
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/explicit/rebounds.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

namespace knap {
namespace {

void print_mesh(const MeshReport& mesh) {
    std::printf("mesh\n  triangles %d, vertices %d, interfaces %d, pre-cracked edges %d\n", mesh.n_triangles,
                mesh.n_vertices, mesh.n_interior_edges, mesh.n_cracked_edges);
    std::printf("  edge lengths %s / %s / %s (smallest, mean, largest)\n", readable(mesh.smallest_edge, "m").c_str(),
                readable(mesh.mean_edge, "m").c_str(), readable(mesh.largest_edge, "m").c_str());
    std::printf("  angles: smallest %.1f, 1 %% of the triangles below %.1f, largest %.1f degree\n", mesh.smallest_angle,
                mesh.smallest_angle_percentiles[0], mesh.largest_angle);
    if (mesh.n_paths > 0)
        std::printf(
            "  paths along edges are %.1f %% longer than straight lines (%.1f %% far from their ends), spread over "
            "directions %.1f %%\n",
            100 * mesh.mean_path_excess, 100 * mesh.far_path_excess, 100 * mesh.path_excess_spread);
}

void print_materials(const Scenario& scenario) {
    std::printf("wave speeds\n");
    for (const NamedMaterial& m : scenario.materials)
        std::printf("  %-12s c_d %.1f, c_s %.1f, c_R %.1f m/s%s\n", m.name.c_str(),
                    m.elastic.dilatational_speed(scenario.plane), m.elastic.shear_speed(scenario.plane),
                    m.elastic.rayleigh_speed(scenario.plane),
                    m.elastic.bedding ? " (layers: the fastest, the slowest, along them)" : "");
}

/// [s] Step of an implicit cohesion up to which Assumption 1 certainly holds on a mesh of breakable edges of length
/// `edge` [m]: h <= (0.43/theta) sqrt(l_coh/l) l/c, with l_coh over the steepness of the softening. It may hold for
/// larger steps.
double assumption_1_step(const Resolution& resolution, double edge, double theta) {
    return 0.43 / theta * std::sqrt(resolution.cohesive_length / resolution.steepness / edge) * edge /
           resolution.wave_speed;
}

/// Whether cracks may run along all edges of the random mesh of a material.
bool cracks_anywhere(const Scenario& scenario) {
    for (std::size_t m = 0; m < scenario.materials.size() && !scenario.given; ++m)
        if (scenario.laws[scenario.law_of_pair[m][m]].law.breakable()) return true;
    return false;
}

void print_resolution(const ReadResult& read, const Mesh& mesh, const StepPlan& plan) {
    const Scenario& scenario = read.scenario;
    const double step = plan.limits.cracking;  // [s] that in which cohesion may decrease
    const std::vector<Resolution> found = judge_resolution(scenario, mesh);
    std::printf("interfaces\n");
    const double fine = scenario.finest_edge(mean_edge(mesh)), coarse = scenario.mesh.size / scenario.order;
    const bool refined = (!scenario.mesh.refine.empty() || scenario.adapt.active()) && coarse > fine;
    for (const Resolution& r : found) {
        std::printf("  %-12s law %s: process zone %s (at rest), %.1f edges%s", r.material.c_str(), r.law.c_str(),
                    readable(r.steep_zone(), "m").c_str(), r.n_edges, refined ? " where refined" : "");
        if (refined) std::printf(", %.1f elsewhere", r.n_edges * fine / coarse);
        std::printf("; cohesive length %s\n", readable(r.cohesive_length, "m").c_str());
    }
    bool as_measured = false;
    for (const NamedLaw& law : scenario.laws) {
        if (law.measured_G_c == 0) continue;
        as_measured = true;
        std::printf(
            "  law %s: a crack under the least load that drives it costs %s as measured; interfaces have G_c %s, the "
            "surplus of this mesh is %.3f +- %.3f\n",
            law.name.c_str(), readable(law.measured_G_c, "J/m2", 4).c_str(), readable(law.law.G_c, "J/m2", 4).c_str(),
            law.surplus.mean, law.surplus.deviation);
    }
    if (cracks_anywhere(scenario) && !as_measured)
        std::printf(
            "  a crack along the edges of a random mesh costs 1.1 to 1.3 G_c per length, however small they are: its "
            "path is 5 %% longer, the rest is damage\n  beside it. To meet a measured toughness write toughness = \"as "
            "measured\" (above all tables)\n");
    std::fputs(mesh_surplus_text(read, mesh, plan).c_str(), stdout);
    for (const NamedLaw& law : scenario.laws)
        if (law.measured_sigma_c > 0)
            std::printf(
                "  law %s: a specimen (%s, %s) with sigma_c %s breaks at the strength that the law gives "
                "for %s as measured; the surplus of this mesh is %.3f +- %.3f\n",
                law.name.c_str(), test_word(scenario.strength.test), readable(scenario.strength.size, "m", 4).c_str(),
                readable(law.law.sigma_c, "Pa", 4).c_str(), readable(law.measured_sigma_c, "Pa", 4).c_str(),
                law.strength_surplus.mean, law.strength_surplus.deviation);
    if (const LawStrength strength = law_strength(scenario); strength.measured > 0)
        std::printf("  specimen: %s as measured, %s by the law of its interfaces\n",
                    readable(strength.measured, "Pa", 4).c_str(), readable(strength.of_interfaces, "Pa", 4).c_str());
    else if (strength.of_interfaces > 0)
        std::printf(
            "  specimen: %s by the law; strength_ratio of the summary is that of the run over it. To meet a measured "
            "strength write strength = \"as measured\" (above all tables)\n",
            readable(strength.of_interfaces, "Pa", 4).c_str());
    const SchemeOptions& scheme = scenario.time.scheme;
    if (scheme.cohesion == CohesionScheme::explicit_beta) return;  // Assumption 1 is one of the implicit cohesion
    for (const Resolution& r : found) {
        const double limit = assumption_1_step(r, fine, scheme.theta);
        const char* what = limit >= step ? "holds for every step"
                           : scheme.respect_assumption_1
                               ? "may not hold where cohesion decreases: such steps are repeated with a smaller size"
                               : "may not hold where cohesion decreases: one of several solutions is used";
        std::printf("  %-12s Assumption 1 certainly holds for h <= %s, margin %.2f; %s\n", r.material.c_str(),
                    readable(limit, "s").c_str(), limit / step, what);
    }
}

void print_absorbing(const Model& model, const SchemeOptions& scheme) {
    for (const Selection& on : scheme.absorbing) {
        double length = 0;  // [m]
        for (const std::size_t e : selected_edges(model.mesh, on)) {
            const BoundaryEdge& edge = model.mesh.boundary_edges[e];
            length += model.mesh.side_vector(edge.triangle, edge.side).norm();
        }
        std::printf("  boundary `%s` absorbs waves of normal incidence, on %s; others return in part\n",
                    on.boundary.c_str(), readable(length, "m", 6).c_str());
    }
}

/// What rebounds: pieces that stay rigid, by [rigid], and deformable ones; none that is held.
struct Rebounding {
    std::size_t n_rigid = 0;
    std::size_t fewest = 0, most = 0;  // triangles of a deformable piece; 0: there is none
    double inertia = 1;                // [-] the largest of a piece, over that of its outline
    double speed = infinity;           // [m/s] c L/D of a deformable piece: edge L, root D of the area
};

/// [-] Masses lie at the corners of triangles: a triangle with the sides a, b, c has m (a^2 + b^2 + c^2)/9 and not /36.
double inertia_of(const Model& model, const std::vector<Index>& triangles) {
    double mass = 0, second = 0, more = 0;
    Vec2 first = Vec2::Zero();
    for (const Index t : triangles) {
        const double m = model.materials[model.mesh.region[t]].density * model.mesh.area(t);
        double sides = 0;
        Vec2 centre = Vec2::Zero();
        for (Index k = 0; k < 3; ++k) {
            sides += model.mesh.side_vector(t, k).squaredNorm();
            centre += model.mesh.corner(t, k) / 3;
        }
        mass += m, first += m * centre, second += m * (centre.squaredNorm() + sides / 36), more += m * sides / 12;
    }
    return 1 + more / (second - first.squaredNorm() / mass);
}

Rebounding rebounding_of(const Model& model, const RigidOptions& options) {
    State start = initial_state(model);
    FrozenPieces rigid;
    if (options.active()) rigid = freeze(model, start);
    const PiecesOfBody pieces = pieces_of_body(model, start, {});
    std::map<Index, std::vector<Index>> triangles;  // by the lowest one of a piece
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        if (!pieces.held[t]) triangles[pieces.first[t]].push_back(t);
    Rebounding found;
    for (const auto& [first, of_piece] : triangles) {
        found.inertia = std::max(found.inertia, inertia_of(model, of_piece));
        if (rigid.body && !can_break(rigid.body->pieces[rigid.body->piece_of_triangle[first]], options)) {
            ++found.n_rigid;
            continue;
        }
        const std::size_t n = of_piece.size();
        found.fewest = found.most == 0 ? n : std::min(found.fewest, n);
        found.most = std::max(found.most, n);
        double area = 0, smallest = infinity;
        for (const Index t : of_piece) area += model.mesh.area(t), smallest = std::min(smallest, model.mesh.area(t));
        const Elastic& material = model.materials[model.mesh.region[of_piece.front()]];
        found.speed = std::min(found.speed, material.dilatational_speed(model.plane) * std::sqrt(2 * smallest / area));
    }
    return found;
}

/// `depth` [-]: of an edge, by which the surface gives way at most; it does by 3 V D/c (stepper/README.md).
std::string rebound_text(const ContactLaw& law, const Rebounding& bodies, const RigidOptions& rigid, double depth) {
    std::string text = law.changing < 0 ? formatted("friction %.3g, ", law.friction)
                                        : "friction of its law over pressure, or over the slip of faces that were "
                                          "joined (others: that without slip), ";
    const double own = natural_rebound(bodies.fewest);
    const std::string of_its_own =
        formatted("by its elasticity (%zu triangles: with at least %.2g, up to 0.98 of its speed)", bodies.fewest, own);
    if (law.rebound == ContactLaw::Rebound::of_bodies) {
        text += formatted("bodies rebound with R_N %.3g", law.restitution);
        if (bodies.most > 0 && law.restitution < own)
            text +=
                formatted(", deformable ones up to impacts of about %.2g m/s on this mesh", depth / 3 * bodies.speed);
        if (bodies.most > 0 && law.restitution > own)
            text += ", a deformable one with less where its own rebound is less: " + of_its_own;
    } else {
        text += formatted("restitution %.3g of faces", law.restitution);
        if (bodies.n_rigid > 0)
            text += law.gives_restitution
                        ? ", and of rigid pieces that cannot break"
                        : formatted(", %.3g of rigid pieces that cannot break (rigid.restitution)", rigid.restitution);
        if (bodies.most > 0 && rigid.active()) text += ", 0 of what can break, below a blow that may break it";
        if (bodies.most > 0) text += "; a deformable body rebounds " + of_its_own;
    }
    return law.tangential > 0 ? text + formatted(", R_T %.3g", law.tangential) : text;
}

/// A line for each obstacle that bodies may rebound from, and each range of a terrain.
void print_obstacles(const Scenario& scenario, const Rebounding& bodies) {
    const auto text_of = [&](const ContactLaw& law) {
        return rebound_text(law, bodies, scenario.time.scheme.rigid, Rebounds::depth_of_obstacles());
    };
    for (const Obstacle& obstacle : scenario.obstacles) {
        const auto rebounds = [](const ContactLaw& law) { return law.is_of_bodies() || law.restitution > 0; };
        if (scenario.contact_of_pair.empty() && obstacle.ranges.empty() && !obstacle.any_law(rebounds)) continue;
        std::printf("  obstacle %s: %s\n", obstacle.name.c_str(), text_of(obstacle.contact).c_str());
        for (const SurfaceRange& range : obstacle.ranges)
            std::printf("  obstacle %s, x from %.6g to %.6g m: %s\n", obstacle.name.c_str(), range.from, range.to,
                        text_of(range.law).c_str());
    }
}

/// A line for each pair of materials whose free faces meet.
void print_contact(const Scenario& scenario, const Rebounding& bodies) {
    const std::vector<std::string> materials = scenario.material_names();
    for (std::size_t a = 0; a < scenario.contact_of_pair.size(); ++a)
        for (std::size_t b = a; b < materials.size(); ++b) {
            const ContactLaw& law = scenario.contact_of_pair[a][b];
            std::printf("  contact of free faces, %s on %s: %s\n", materials[a].c_str(), materials[b].c_str(),
                        rebound_text(law, bodies, scenario.time.scheme.rigid, Rebounds::depth_of_faces()).c_str());
        }
}

void print_methods(const Scenario& scenario, const Model& model) {
    bool friction = false, restitution = false, breakable = false, shear = false;
    for (const Interface& i : model.interfaces) {
        const CohesiveLaw& law = model.laws[i.law];
        breakable = breakable || (law.breakable() && !i.cracked);
        if (!law.breakable() && !i.cracked) continue;
        friction = friction || law.friction_range()[1] > 0;
        restitution = restitution || law.restitution > 0;
        shear = shear || law.gamma > 0;
    }
    std::printf(
        "physics\n  interfaces: cohesion %s, tangential cohesion %s, friction %s, impact %s; supports %s, driven "
        "boundaries %s\n",
        breakable ? "yes" : "no (elastic)", breakable && shear ? "yes" : "no", friction ? "yes" : "no",
        restitution ? "with restitution" : "plastic", scenario.supports.empty() ? "no" : "yes",
        model.prescribed.empty() ? "no" : "yes");
    if (!scenario.contact_of_pair.empty() || !scenario.obstacles.empty()) {
        const Rebounding bodies = rebounding_of(model, scenario.time.scheme.rigid);
        print_contact(scenario, bodies);
        print_obstacles(scenario, bodies);
        if (bodies.inertia > 1.05)
            std::printf(
                "  pieces turn with up to %.3g times the inertia of their outlines, since masses are at the corners of "
                "triangles; less with a smaller mesh.size\n",
                bodies.inertia);
    }
    std::printf("  scheme: %s\n", scheme_text(scenario.time, scenario.works().viscosity).c_str());
    if (breakable && scenario.time.scheme.rigid.active() && !may_be_parted(model))
        std::printf(
            "  with supports, held boundaries or free obstacles all pieces become deformable together where a blow may "
            "break one, and steps cost until it is over what they cost without [rigid]\n");
    if (!scenario.time.start_run.empty())
        std::printf("  starts from the state `%s` of another run; the time counts from 0 again\n",
                    scenario.time.start_run.c_str());
    if (scenario.time.rest.ends_run) std::printf("  ends at rest, at the latest at time.end\n");
    print_absorbing(model, scenario.time.scheme);
}

/// What moves, or what could.
void print_mass_scaling(const Scenario& scenario, const Model& model, const StepPlan& plan) {
    constexpr double most = 0.01, pays = 1.2;
    if (scenario.time.mass_scaling > 0) {
        const auto moved = moved_mass(model);
        if (!moved) {
            std::printf(
                "  mass scaling: nothing moves, since what limits the step has no neighbours to take it from\n");
            return;
        }
        std::printf(
            "  mass scaling: steps are %.3g times as long; %.2g %% of the mass moves from %d triangles to %d others, "
            "of "
            "which that at %s has %.3g times its mass\n",
            moved->gain, 100 * moved->moved, moved->n_lighter, moved->n_heavier,
            place_text(moved->heaviest.front().centroid).c_str(), moved->heaviest.front().factor);
        return;
    }
    if (!may_scale_masses(scenario)) return;
    if (const MassScaling could = scale_masses(model, plan.stable_of_triangle, model_input(scenario).cuts, most, pays);
        could.gain >= pays)
        std::printf(
            "  explicit steps would be %.3g times as long with time.mass_scaling = \"1 %%\", which moves %.2g %% "
            "of the mass\n",
            could.gain, 100 * could.moved);
}

void print_run(const Scenario& scenario, const Model& model, const StepPlan& plan, const Cost& cost,
               bool long_measured) {
    const double rigid = plan.limits.rigid.step;
    const std::string how_many =
        rigid > 0 ? formatted(" of what is deformable; rigid pieces take steps of %s, %lld of them, or shorter ones",
                              readable(rigid, "s", 4).c_str(),
                              static_cast<long long>(std::ceil(scenario.time.end / rigid * (1 - 1e-12))))
                  : formatted(", %lld steps, %.3g triangle-steps", static_cast<long long>(plan.n_steps),
                              static_cast<double>(plan.n_steps) * model.mesh.n_triangles());
    std::printf("run\n  stable step %s, h = %s (%.3g CFL)%s\n", readable(plan.stable_step, "s", 4).c_str(),
                readable(plan.limits.largest, "s", 4).c_str(), plan.limits.largest / plan.stable_step,
                how_many.c_str());
    print_mass_scaling(scenario, model, plan);
    if (plan.n_at_corners > 0)
        std::printf("  %lld of them end at corners of tables over time\n", static_cast<long long>(plan.n_at_corners));
    if (const SchemeChangeOptions& change = plan.limits.change; plan.limits.changes())
        std::printf(
            "  these are implicit, down to %s (%.3g CFL) where they fail; then explicit ones of %s go on, at least "
            "%.0f each time, until the body is quiet for %s\n",
            readable(plan.limits.cracking, "s", 4).c_str(), plan.limits.cracking / plan.stable_step,
            readable(change.explicit_step, "s", 4).c_str(),
            std::ceil((plan.limits.cracking + change.quiet_for) / change.explicit_step),
            readable(change.quiet_for, "s").c_str());
    else if (plan.limits.cracking < plan.limits.largest)
        std::printf("  after the first loss of cohesion h = %s (%.3g CFL): up to %.0f steps\n",
                    readable(plan.limits.cracking, "s", 4).c_str(), plan.limits.cracking / plan.stable_step,
                    std::ceil(scenario.time.end / plan.limits.cracking));
    const bool may_pile_up =
        model.faces_meet() &&
        (scenario.time.scheme.rigid.active() ||
         std::ranges::any_of(model.interfaces, [&](const Interface& i) { return model.laws[i.law].breakable(); }));
    if (cost.given_up_after > 0) {
        std::printf("  %s; a smaller time.step, or %s\n", unknown_text(cost, plan.limits.largest).c_str(),
                    long_measured ? "bulk = \"auto\"" : "--time, which waits ten times as long");
    } else {
        const auto time = [](double seconds) { return readable(seconds, "s", 2); };
        const bool is_range = cost.least_steps < cost.steps;
        const auto range = [&](double least, double most, int digits) {
            return (is_range ? readable(least, "s", 2) + " to " : "") + readable(most, "s", is_range ? 2 : digits);
        };
        std::printf("  about %s of one core: mesh and model %s, steps %s, frames %s, figures %s, tables %s\n",
                    range(cost.least(), cost.total(), 3).c_str(), time(cost.model).c_str(),
                    range(cost.least_steps, cost.steps, 2).c_str(), time(cost.frames).c_str(),
                    time(cost.figures).c_str(), time(cost.lines).c_str());
        if (cost.search > 0)
            std::printf("  of it the search for the equilibrium at the start %s%s\n", time(cost.least_search).c_str(),
                        cost.search > cost.least_search ? (" to " + time(cost.search)).c_str() : "");
        if (is_range)
            std::printf(
                "  a step takes %s now (measured%s) while nothing breaks and no contact changes, the first number; "
                "%s\n",
                readable(cost.first_step, "s", 2).c_str(), long_measured ? "" : ", briefly; --time measures longer",
                cost.stage > 0
                    ? formatted("a stage of explicit steps at least %s, and much that breaks makes tens of them",
                                readable(cost.stage, "s", 2).c_str())
                          .c_str()
                    : "the second one is as in the gallery where much breaks");
        else
            std::printf("  a step takes %s now (measured%s), %.1f times that on average, as in the gallery; %s\n",
                        readable(cost.first_step, "s", 2).c_str(),
                        long_measured ? "" : ", briefly; --time measures longer", cost.mean_over_first,
                        may_pile_up
                            ? "pieces that break or lie on each other may take 30 times as long: see the progress line"
                            : "within a factor of 2 there, more for a body that fragments");
    }
    if (scenario.adapt.active()) {
        const AdaptationForecast expected = forecast(scenario, model.mesh);
        std::printf(
            "  adapt: about %.2g triangles after straight cracks of %s, %.2g if they branch half-way, a uniform mesh "
            "has %.2g: gain %.2g, within a factor of 2 in five scenarios; less where much of the body is near its "
            "strength\n",
            expected.at_end, readable(expected.crack, "m").c_str(), expected.at_most, expected.uniform, expected.gain);
    }
    const std::string from = scenario.adapt.active() ? formatted("%.0f to ", cost.least_memory) : "";
    std::printf("  %s%.0f MB of memory, %.0f MB of disk space for %.0f frames\n", from.c_str(), cost.memory, cost.disk,
                cost.n_frames);
}

/// What `knap sweep` would run.
void print_members(const Scenario& scenario, const Cost& cost) {
    const RandomMembers& random = scenario.sweep.random;
    if (random.n == 0) return;
    double n = random.n;
    for (const std::string& set : scenario.sweep.set) n *= static_cast<double>(sweep_key(set).values.size());
    std::printf("sweep\n  %.0f runs, %zu keys drawn at random: ", n, random.keys.size());
    if (cost.given_up_after > 0) std::printf("their time is not known\n");
    else std::printf("about %s of one core\n", readable(n * (cost.total() - cost.frames - cost.figures), "s").c_str());
}

void print_warnings(const std::vector<Diagnostic>& warnings) {
    for (const Diagnostic& warning : warnings) print_messages(format(warning));
}

/// Which pieces are rigid at the start, and between which times of steps the run lies.
std::string rigid_text(const Model& model, const RigidOptions& options, const Cost& cost) {
    State start = initial_state(model);
    const FrozenPieces frozen = freeze(model, start);
    std::size_t n = 0;
    for (const FrozenBody::Piece& piece : frozen.body->pieces) n += can_break(piece, options);
    const char* const above = may_be_parted(model) ? "; the time above has a blow a second, which makes all deformable"
                                                   : ", as above: a blow makes all pieces deformable";
    return formatted(
        "  rigid   %zu pieces at the start, %zu of them can break; steps take %s of processor time if all are rigid at "
        "all times%s\n",
        frozen.body->pieces.size(), n, readable(cost.rigid_steps, "s", 2).c_str(),
        n == 0 ? ", as here" : (", " + readable(cost.deformable_steps, "s", 2) + " if none is" + above).c_str());
}

void print_grains(const Scenario& scenario, const Mesh& mesh) {
    const GrainReport grains = judge_grains(mesh);
    std::printf("%-28s %d, of them %d whole\n", "grains", grains.n_grains, grains.n_whole);
    std::printf("%-28s %.4g, spread %.3f\n", "mean grain diameter [m]", grains.mean_diameter, grains.spread);
    std::printf("%-28s %.2f at %.0f degree\n", "mean grain elongation", grains.elongation,
                grains.direction * 180 / std::numbers::pi);
    std::printf("%-28s %d\n", "fewest triangles in a grain", grains.min_triangles);
    std::vector<double> area(scenario.materials.size(), 0);
    double total = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) area[mesh.region[t]] += mesh.area(t), total += mesh.area(t);
    for (std::size_t i = 0; i < area.size(); ++i)
        std::printf("%-28s %.2f %%\n", ("area of " + scenario.materials[i].name).c_str(), 100 * area[i] / total);
}

/// Warnings of the start from another run, if this is one; throws what such a run would throw.
std::string text_of_start(const ReadResult& read, const RunOrigin& origin, Model model,
                          const std::vector<PlannedExcavation>& planned, const StepPlan& plan) {
    const NamedFile* const file = read.scenario.start_file();
    if (file == nullptr) return "";
    Excavations excavations(planned);
    Adaptation adaptation(read.scenario.adapt, model_input(read.scenario));
    const StartState other(file->bytes, origin, read.scenario, model, excavations, adaptation);
    return jumps_text(read, model, other, plan.limits.largest);
}

}  // namespace

ExitCode check_scenario(ReadResult read, bool full, bool strict, bool time) {
    const Scenario& scenario = read.scenario;
    const Stopwatch watch;
    const Model model = model_of(read);
    const double model_seconds = watch.cpu();
    std::vector<Diagnostic> found = check_model(read, model);
    const RunOrigin origin = origin_of(read);
    const std::vector<PlannedExcavation> excavations = plan_excavations(read, model);
    const StepPlan plan = plan_of(read, model, scenario.time.end);
    const std::string jumps = text_of_start(read, origin, model, excavations, plan);
    if (full) std::fputs(full_listing(read).c_str(), stdout);
    std::printf("%s: %s\n", scenario.name.c_str(), scenario.title.c_str());
    if (scenario.bodies.size() > 1) std::printf("bodies %zu\n", scenario.bodies.size());
    print_mesh(judge(model.mesh));
    std::fputs(placed_sets_text(scenario, model.mesh).c_str(), stdout);
    print_materials(scenario);
    std::fputs(laws_text(read, model).c_str(), stdout);
    print_resolution(read, model.mesh, plan);
    print_methods(scenario, model);
    std::fputs(initial_stress_text(scenario, model).c_str(), stdout);
    std::fputs(heat_text(scenario, model.mesh, plan.limits.largest).c_str(), stdout);
    std::fputs(probes_text(model, scenario.probes).c_str(), stdout);
    for (const PlannedExcavation& one : excavations)
        std::printf("  excavation[%zu]: %zu triangles vanish at %s, their forces within %s\n", one.number,
                    one.triangles.size(), readable(one.at, "s", 6).c_str(), readable(one.ramp, "s", 6).c_str());
    const Cost cost = estimate_cost(scenario, model, plan, model_seconds, time ? 0.5 : 0.05);
    print_run(scenario, model, plan, cost, time);
    print_members(scenario, cost);
    if (scenario.time.scheme.rigid.active())
        std::fputs(rigid_text(model, scenario.time.scheme.rigid, cost).c_str(), stdout);
    std::ranges::move(findings_of_model(read, model, plan, &cost), std::back_inserter(found));
    print_warnings(read.warnings), print_warnings(found);
    std::fputs(jumps.c_str(), stderr);
    return strict && !(read.warnings.empty() && found.empty() && jumps.empty()) ? exit_bad_input : exit_done;
}

ExitCode mesh_scenario(ReadResult read, const std::filesystem::path& output, bool force) {
    const std::string ending = output.extension().string();
    if (!output.empty() && ending != ".msh" && ending != ".vtu" && ending != ".svg")
        throw UserError("mesh-format", "`" + output.string() + "` is not the name of a mesh",
                        "known endings: .msh, .vtu, .svg");
    if (!output.empty() && !force) refuse_existing(output);
    const Model model = model_of(read);
    const MeshReport report = judge(model.mesh);
    print_warnings(read.warnings), print_warnings(findings_of_places(read, model));
    if (read.scenario.bodies.size() > 1) std::printf("%-28s %zu\n", "bodies", read.scenario.bodies.size());
    std::printf("%-28s %d\n%-28s %d\n%-28s %d\n%-28s %d\n", "triangles", report.n_triangles, "vertices",
                report.n_vertices, "interfaces", report.n_interior_edges, "pre-cracked edges", report.n_cracked_edges);
    std::printf("%-28s %.6g\n", "area [m2]", report.area);
    std::printf("%-28s %.4g %.4g %.4g\n", "edge length [m]", report.smallest_edge, report.mean_edge,
                report.largest_edge);
    std::printf("%-28s %.2f (1 %% below %.2f, 10 %% %.2f, 50 %% %.2f)\n", "smallest angle [degree]",
                report.smallest_angle, report.smallest_angle_percentiles[0], report.smallest_angle_percentiles[1],
                report.smallest_angle_percentiles[2]);
    std::printf("%-28s %.2f\n", "largest angle [degree]", report.largest_angle);
    std::printf("%-28s %.4g\n", "stable step [s]", std::ranges::min(stable_steps(model)));
    for (const Resolution& r : judge_resolution(read.scenario, model.mesh))
        std::printf("%-28s %.1f (%s, %s)\n", "edges per process zone", r.n_edges, r.material.c_str(),
                    readable(r.steep_zone(), "m").c_str());
    if (report.n_paths > 0) {
        std::printf("%-28s %.4f, spread over directions %.4f; without the ends of the paths %.4f\n", "path excess",
                    report.mean_path_excess, report.path_excess_spread, report.far_path_excess);
        for (int i = 0; i < MeshReport::n_directions; ++i)
            std::printf("  %5.1f degree  %.4f\n", 180.0 * i / MeshReport::n_directions, report.path_excess[i]);
    }
    std::fputs(placed_sets_text(read.scenario, model.mesh).c_str(), stdout);
    if (!model.mesh.grain.empty()) print_grains(read.scenario, model.mesh);
    if (output.empty()) return exit_done;
    std::vector<std::string> joints;  // by their laws
    for (const Index law : read.scenario.law_of_joint)
        joints.push_back(law < 0 ? "without a law" : read.scenario.laws[law].name);
    write_new_file(output, mesh_as_text(model.mesh, ending, read.scenario.material_names(), joints));
    std::printf("mesh:    %s\n", output.string().c_str());
    return exit_done;
}

/// By the line `#:schema` editors with a TOML extension complete and check keys.
constexpr const char* schema_file = "knap.schema.json";

ExitCode write_new_scenario(const std::string& name, const std::string& from, bool force) {
    const std::filesystem::path file = name.ends_with(".toml") ? name : name + ".toml";
    const std::string stem = file.stem().string(),
                      text = from.empty() ? new_scenario(stem) : renamed(built_in_scenario(from), stem);
    read_scenario_text(new_scenario(stem), file.string());  // refuses a name that a scenario cannot have
    std::vector<BuiltIn> written{{file.string(), std::string("#:schema ") + schema_file + "\n" + text}};
    for (const BuiltIn& mesh : built_in_files())  // that it names
        if (text.find('"' + mesh.name + '"') != text.npos)
            written.push_back({(file.parent_path() / mesh.name).string(), mesh.text});
    for (const BuiltIn& one : written)
        if (!force) refuse_existing(one.name);
    const std::filesystem::path schema = file.parent_path() / schema_file;
    written.push_back({schema.string(), json_schema()});
    if (std::error_code none; std::filesystem::exists(schema, none))
        if (const std::string present = read_given_file(schema, "cannot-read"); present != written.back().text) {
            if (present.find("\"title\": \"knap scenario\"") == std::string::npos && !force)
                refuse_existing(schema,
                                "knap new writes the schema of its keys there, and this is none: another "
                                "directory, or replace it with --force");
            std::printf("renewed %s: it was not that of this version\n", schema.string().c_str());
        }
    for (const BuiltIn& one : written) write_new_file(one.name, one.text);
    std::printf("wrote %s; next: knap check %s, knap run %s\n", file.string().c_str(), file.string().c_str(),
                file.string().c_str());
    return exit_done;
}

void refuse_existing(const std::filesystem::path& file, const std::string& cure) {
    std::error_code none;
    if (std::filesystem::is_character_file(file, none)) return;  // /dev/stdout
    if (std::filesystem::exists(file, none))
        throw UserError("file-exists", "`" + file.string() + "` exists already", cure);
}

void write_new_file(const std::filesystem::path& file, const std::string& text) {
    try {
        write_whole_file(file, text);
    } catch (const OutputError& error) {
        throw UserError("cannot-write", error.what(), "choose another place");
    }
}

}  // namespace knap
