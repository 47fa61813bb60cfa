#include "stepper/adapt/adaptation.hpp"
#include "model/make_model.hpp"

#include "base/parallel.hpp"
#include "element/elastic_forces.hpp"
#include "element/triangle_matrices.hpp"
#include "mesh/edge_graph.hpp"
#include "mesh/relax.hpp"
#include "model/successor.hpp"
#include "stepper/adapt/refined_patches.hpp"
#include "stepper/common/elastic_energy.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace knap {
namespace {

double length(const Mesh& mesh, const std::array<Index, 2>& ends) {
    return (mesh.vertices[ends[1]] - mesh.vertices[ends[0]]).norm();
}

/// The factor on the domain of a point (law/norm_law.hpp) at which the traction lies on its border.
double by_norm(double t_N, double t_T, const CohesiveLaw& law) {
    if (t_N > 0) return std::hypot(t_N, t_T / law.gamma) / law.sigma_c;
    double largest = 0;
    law.visit_friction_lines([&](const FrictionLine& line) {
        largest = std::max(largest, (t_T + line.slope * t_N) / (law.gamma + line.offset / law.sigma_c));
    });
    return largest / law.sigma_c;
}

/// Its largest value at t_N = m + r cos, t_T = r sin: at an end, where the domain changes, or at a derivative of zero.
double largest_on_circle(double m, double r, const CohesiveLaw& law) {
    double largest = 0;
    const double g2 = law.gamma * law.gamma;
    const auto look = [&](double cosine) {
        if (std::abs(cosine) <= 1)
            largest = std::max(largest, by_norm(m + r * cosine, r * std::sqrt(1 - cosine * cosine), law));
    };
    for (const double cosine : {1.0, -m / r, m / r * g2 / (1 - g2)}) look(cosine);
    law.visit_friction_lines([&](const FrictionLine& line) { look(line.slope / std::hypot(1, line.slope)); });
    return largest;
}

bool can_break(const CohesiveLaw& law) { return law.breakable() && law.sigma_c > 0; }

/// [0/1] Per triangle: one of its vertices came apart, or it vanished.
std::vector<std::uint8_t> frozen_triangles(const Model& model, const State& state) {
    std::vector<std::uint8_t> frozen(model.mesh.n_triangles());
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        frozen[model.mesh.triangle_of(c)] |= state.split_rank[model.fan_of_corner[c]] >= 0;
    return frozen;
}

Renumbering renumbering(const Model& before, const Model& after, const RefinedMesh& refined) {
    Renumbering numbers{.vertex = std::vector<Index>(before.mesh.n_vertices(), -1),
                        .interface = std::vector<Index>(before.interfaces.size(), -1),
                        .triangle_before = refined.triangle_before};
    for (Index v = 0; v < after.mesh.n_vertices(); ++v)
        if (refined.origin[v].vertex >= 0) numbers.vertex[refined.origin[v].vertex] = v;
    const Grouped<Index> at_lower_end(after.mesh.vertices.size(), [&](const auto& visit) {
        for (std::size_t i = 0; i < after.interfaces.size(); ++i)
            visit(std::ranges::min(after.interfaces[i].vertex), static_cast<Index>(i));
    });
    for (std::size_t i = 0; i < before.interfaces.size(); ++i) {
        const auto& [a, b] = before.interfaces[i].vertex;
        const auto [low, high] = std::minmax({numbers.vertex[a], numbers.vertex[b]});
        if (low < 0) continue;
        for (const Index now : at_lower_end[low])
            if (std::ranges::max(after.interfaces[now].vertex) == high) numbers.interface[i] = now;
    }
    return numbers;
}

/// [kg m2/s] About the origin.
double angular_momentum(const Model& model, const State& state) {
    double sum = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        sum += model.corner_mass[c] * cross(model.mesh.corner(c), state.velocity[state.node_of_corner[c]]);
    return sum;
}

struct EnergyParts {
    double kinetic = 0, strain = 0;  // [J]
    EnergyParts& operator+=(const EnergyParts& other) {
        kinetic += other.kinetic, strain += other.strain;
        return *this;
    }
};

/// Energies as of leapfrog_energies, added up in blocks: the rounding of many refinements must not add up in the
/// balance.
LeapfrogEnergies energies_of(const Model& model, const State& state) {
    if (model.heat) return leapfrog_energies(model, state);
    constexpr std::size_t block = 1024;  // corners
    const ElasticForces elastic(model.mesh, model.materials, model.plane, model.thickness);
    std::vector<Vec2> before = state.displacement, force(model.mesh.n_corners());
    for (std::size_t n = 0; n < before.size(); ++n) before[n] -= state.last_step * state.velocity[n];
    std::vector<std::uint8_t> unused;
    elastic.evaluate(0, model.mesh.n_triangles(), before, state.node_of_corner, force.data(), unused);
    std::vector<EnergyParts> partial;
    const EnergyParts sum =
        sum_over_blocks(force.size(), block, partial, [&](std::size_t first, std::size_t last, EnergyParts& own) {
            for (std::size_t c = first; c < last; ++c) {
                const Index node = state.node_of_corner[c];
                own.kinetic += 0.5 * model.corner_mass[c] * state.velocity[node].squaredNorm();
                own.strain -= 0.5 * force[c].dot(state.displacement[node]);
            }
        });
    return {.kinetic = sum.kinetic, .strain = sum.strain};
}

}  // namespace

double load_factor(const Eigen::Vector3d& stress, const CohesiveLaw& law) {
    if (!can_break(law)) return 0;
    // t_N = m + r cos 2a and |t_T| = r |sin 2a|, largest at once
    const double m = 0.5 * (stress[0] + stress[1]), r = std::hypot(0.5 * (stress[0] - stress[1]), stress[2]);
    if (law.coupling == Coupling::norm) return largest_on_circle(m, r, law);
    double largest = m + r;
    law.visit_friction_lines([&](const FrictionLine& line) {
        const double sheared = r * std::hypot(1, line.slope) + line.slope * m;
        largest = std::max(largest, sheared / (law.gamma + line.slope + line.offset / law.sigma_c));
    });
    return largest / law.sigma_c;
}

double load_factor(const Eigen::Vector3d& stress, const Vec2& normal, const CohesiveLaw& law) {
    if (!can_break(law)) return 0;
    const auto& [x, y] = std::pair(normal.x(), normal.y());
    const Vec2 traction(stress[0] * x + stress[2] * y, stress[2] * x + stress[1] * y);
    const double t_N = traction.dot(normal), t_T = std::abs(cross(normal, traction));
    if (law.coupling == Coupling::norm) return by_norm(t_N, t_T, law);
    double largest = t_N;
    law.visit_friction_lines([&](const FrictionLine& line) {
        largest = std::max(largest, (t_T + line.slope * t_N) / (law.gamma + line.slope + line.offset / law.sigma_c));
    });
    return largest / law.sigma_c;
}

double guaranteed_step(double size, const std::vector<Elastic>& materials, PlaneModel plane) {
    Mesh equilateral{.vertices = {{0, 0}, {size, 0}, {0.5 * size, std::sqrt(0.75) * size}}};
    for (std::size_t m = 0; m < materials.size(); ++m) {
        equilateral.triangles.push_back({0, 1, 2});
        equilateral.region.push_back(static_cast<Index>(m));
    }
    constexpr double reserve = 0.95;  // the target takes the fastest mode as that of a scalar wave
    return reserve * QualityTarget::step_ratio * std::ranges::min(stable_steps(equilateral, materials, plane));
}

std::vector<double> requested_sizes(const Model& model, const State& state, const AdaptOptions& options,
                                    const std::optional<Vec2>& also) {
    const Mesh& mesh = model.mesh;
    std::vector<double> distance(mesh.vertices.size(), infinity);
    const auto mark = [&](Index triangle) {
        for (const Index v : mesh.triangles[triangle]) distance[v] = 0;
    };
    std::vector<Eigen::Vector3d> stresses;  // [Pa] per triangle
    stresses.reserve(mesh.triangles.size());
    for (Index t = 0; t < mesh.n_triangles(); ++t) stresses.push_back(stress(model, state, t));
    const auto law_of_interface = [&](std::size_t i) -> const CohesiveLaw& {
        return model.laws_follow_temperature ? state.temperature->laws[2 * i] : model.laws[model.interfaces[i].law];
    };
    std::vector<const CohesiveLaw*> law(mesh.n_triangles());  // of the weakest interface that may get any direction
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
        const Interface& interface = model.interfaces[i];
        const CohesiveLaw& own = law_of_interface(i);
        if (interface.cracked || !can_break(own)) continue;
        const auto [a, b] = interface.triangle;
        const bool on_line =
            a != rigid_support && (mesh.region[a] != mesh.region[b] || mesh.interior_edges[i].joint >= 0);
        for (const Index t : interface.triangle) {
            if (t == rigid_support) continue;
            if (on_line) {
                if (load_factor(stresses[t], interface.normal, own) > options.load) mark(t);
            } else if (law[t] == nullptr || own.sigma_c < law[t]->sigma_c) {
                law[t] = &own;
            }
        }
    }
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (law[t] != nullptr && load_factor(stresses[t], *law[t]) > options.load) mark(t);
    for (Index v = 0; also && v < mesh.n_vertices(); ++v)
        if (mesh.vertices[v] == *also) distance[v] = 0;  // of all bodies that touch there
    // distances along edges (Dijkstra), as far as they matter
    const double fine_until = options.margin * options.size,
                 reach = fine_until + (options.coarse - options.size) / options.grading;
    const EdgeEnds ends = edge_ends(mesh);
    const Grouped<Index> edges = edges_at_vertices(mesh.vertices.size(), ends);
    using Entry = std::pair<double, Index>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (Index v = 0; v < mesh.n_vertices(); ++v)
        if (distance[v] == 0) queue.emplace(0, v);
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > distance[v]) continue;
        for (const Index e : edges[v]) {
            const Index other = ends[e][ends[e][0] == v];
            const double there = d + length(mesh, ends[e]);
            if (there >= reach || there >= distance[other]) continue;
            distance[other] = there;
            queue.emplace(there, other);
        }
    }
    std::vector<double> size;
    for (const double d : distance)
        size.push_back(std::min(options.coarse, options.size + options.grading * std::max(0.0, d - fine_until)));
    return size;
}

std::vector<std::uint8_t> coarse_fans(const Model& model, double size) {
    const Mesh& mesh = model.mesh;
    std::vector<double> sum(mesh.vertices.size(), 0);
    std::vector<Index> n(mesh.vertices.size(), 0);
    for (const auto& ends : edge_ends(mesh))
        for (const Index v : ends) sum[v] += length(mesh, ends), ++n[v];
    std::vector<std::uint8_t> coarse;
    for (const Fan& fan : model.fans) coarse.push_back(sum[fan.vertex] > 1.5 * size * n[fan.vertex]);
    return coarse;
}

std::optional<RefinedMesh> refined_mesh(const Model& model, const State& state, const AdaptOptions& options,
                                        const std::vector<double>& requested, std::uint64_t seed) {
    const std::vector<std::uint8_t> frozen = frozen_triangles(model, state);
    const StableStep stable_step(model.materials, model.plane);
    const auto is_stable = [&](const Mesh& mesh, Index t) { return stable_step(mesh, t) >= options.smallest_step; };
    return refined(model.mesh, {.size = requested, .frozen = frozen, .allowed = is_stable, .seed = seed});
}

AdaptedModel adapt(const Model& model, const State& state, const AdaptOptions& options, RefinedMesh refined,
                   ModelInput input) {
    input.mesh = std::move(refined.mesh);
    AdaptedModel next{.model = make_model(std::move(input))};
    next.model.too_coarse = coarse_fans(next.model, options.size);
    next.numbers = renumbering(model, next.model, refined);
    next.state = carried_over(model, state, next.model, refined);
    restore_momentum_and_energy(model, state, next.model, refined, next.state);
    next.energies = energies_of(next.model, next.state);
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        next.energies.kinetic += kinetic_energy(model.obstacles[o], state.obstacles[o].velocity);
    next.angular_momentum_change = angular_momentum(next.model, next.state) - angular_momentum(model, state);
    return next;
}

}  // namespace knap
