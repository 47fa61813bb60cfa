#include "stepper/adapt/refined_patches.hpp"

#include "base/union_find.hpp"
#include "element/shape_functions.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double least_part = -0.5, largest_part = 1;  // [-] of the short waves that are added

using PerCorner = std::array<Vec2, 3>;

PerCorner velocities(const State& state, Index triangle) {
    PerCorner v;
    for (Index k = 0; k < 3; ++k) v[k] = state.velocity[state.node_of_corner[3 * triangle + k]];
    return v;
}

/// Gradient of a linear field with these values at the corners.
Eigen::Matrix2d gradient(const Mesh& mesh, Index triangle, const PerCorner& values) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    const auto g = shape_gradients(mesh, triangle);
    for (int k = 0; k < 3; ++k) sum += values[k] * g[k].transpose();
    return sum;
}

/// [W] per length: stress : gradient of a velocity, times the volume of the triangle.
double power(const Model& model, const State& state, Index triangle, const Eigen::Matrix2d& rate) {
    const Eigen::Vector3d s = stress(model, state, triangle);
    const double density = s[0] * rate(0, 0) + s[1] * rate(1, 1) + s[2] * (rate(0, 1) + rate(1, 0));
    return density * model.mesh.area(triangle) * model.thickness;
}

/// [J] 1/2 v' M v + 1/2 int sigma : (eps(u - h v) - e) of one triangle, e its thermal strain.
double leapfrog_energy(const Model& model, const State& state, Index triangle) {
    const PerCorner v = velocities(state, triangle);
    PerCorner before;
    double kinetic = 0;
    for (Index k = 0; k < 3; ++k) {
        before[k] = state.displacement_of(3 * triangle + k) - state.last_step * v[k];
        kinetic += 0.5 * model.corner_mass[3 * triangle + k] * v[k].squaredNorm();
    }
    Eigen::Matrix2d strain = gradient(model.mesh, triangle, before);
    if (state.temperature) strain -= state.temperature->strain[triangle] * Eigen::Matrix2d::Identity();
    return kinetic + 0.5 * power(model, state, triangle, strain);
}

/// [m/s] Per vertex.
std::vector<Vec2> short_waves(const Model& model, const State& state) {
    struct Mean {
        double area = 0;
        Vec2 place = Vec2::Zero(), value = Vec2::Zero(), own = Vec2::Zero();
        Eigen::Matrix2d gradient = Eigen::Matrix2d::Zero();
    };
    const Mesh& mesh = model.mesh;
    std::vector<Mean> means(mesh.vertices.size());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const double area = mesh.area(t);
        const PerCorner v = velocities(state, t);
        const Eigen::Matrix2d slope = gradient(mesh, t, v);
        for (int k = 0; k < 3; ++k) {
            Mean& mean = means[mesh.triangles[t][k]];
            mean.area += area, mean.place += area * mesh.centroid(t), mean.value += area / 3 * (v[0] + v[1] + v[2]);
            mean.gradient += area * slope, mean.own = v[k];
        }
    }
    std::vector<Vec2> waves(mesh.vertices.size(), Vec2::Zero());
    for (std::size_t i = 0; i < means.size(); ++i) {
        const auto& [area, place, value, own, slope] = means[i];
        if (area > 0) waves[i] = own - value / area - slope / area * (mesh.vertices[i] - place / area);
    }
    return waves;
}

class Patches {
public:
    Patches(const Model& before, const State& old, const Model& after, const RefinedMesh& refined, State& state)
        : before_(before), old_(old), after_(after), refined_(refined), state_(state), patches_(n_vertices()) {
        const Mesh& mesh = after.mesh;
        within_.assign(n_vertices(), 1), is_in_patch_.assign(n_vertices(), 0);
        std::vector<std::uint8_t> stays(before.mesh.n_triangles(), 0);
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const Index t_before = refined.triangle_before[t];
            if (t_before < 0) {
                added_.push_back(t);
                for (int k = 1; k < 3; ++k) patches_.join(mesh.triangles[t][0], mesh.triangles[t][k]);
                for (const Index v : mesh.triangles[t]) is_in_patch_[v] = 1;
            } else {
                stays[t_before] = 1;
                for (const Index v : mesh.triangles[t]) within_[v] = 0;
            }
        }
        for (Index t = 0; t < before.mesh.n_triangles(); ++t)
            if (!stays[t]) replaced_.push_back(t);
        vertex_.assign(before.mesh.vertices.size(), -1);
        for (Index v = 0; v < mesh.n_vertices(); ++v)
            if (refined.origin[v].vertex >= 0) vertex_[refined.origin[v].vertex] = v;
    }

    void restore_momentum();
    void restore_energy();

private:
    std::size_t n_vertices() const { return after_.mesh.vertices.size(); }
    /// Numbers of patches are those of vertices.
    Index patch_of(std::size_t fan) { return patches_.find(after_.fans[fan].vertex); }
    Index patch_of_replaced(Index triangle) { return patches_.find(vertex_[before_.mesh.triangles[triangle][0]]); }
    Index patch_of_added(Index triangle) { return patches_.find(after_.mesh.triangles[triangle][0]); }
    /// [kg] Per component: what is free to move.
    Vec2 free_mass(std::size_t fan) const;
    /// [m/s] Per fan; without momentum in any patch.
    std::vector<Vec2> waves_within();

    const Model& before_;
    const State& old_;
    const Model& after_;
    const RefinedMesh& refined_;
    State& state_;
    UnionFind patches_;                               // of vertices that added triangles connect
    std::vector<Index> replaced_;                     // triangles before
    std::vector<Index> added_;                        // triangles after
    std::vector<Index> vertex_;                       // after it, per vertex before
    std::vector<std::uint8_t> is_in_patch_, within_;  // [0/1] per vertex: one, all of its triangles are added ones
};

Vec2 Patches::free_mass(std::size_t fan) const {
    const PrescribedMotion* motion = after_.motion_of(after_.corners(after_.fans[fan])[0]);
    Vec2 mass = Vec2::Constant(state_.split_rank[fan] < 0 ? after_.fans[fan].mass : 0);
    for (int k = 0; k < 2; ++k)
        if (motion && motion->component[k]) mass[k] = 0;
    return mass;
}

void Patches::restore_momentum() {
    const auto momentum = [](const Model& model, const State& state, Index triangle) {
        Vec2 sum = Vec2::Zero();
        const PerCorner v = velocities(state, triangle);
        for (Index k = 0; k < 3; ++k) sum += model.corner_mass[3 * triangle + k] * v[k];
        return sum;
    };
    std::vector<Vec2> missing(n_vertices(), Vec2::Zero()), mass = missing;  // [kg m/s], [kg] per patch
    for (const Index t : replaced_) missing[patch_of_replaced(t)] += momentum(before_, old_, t);
    for (const Index t : added_) missing[patch_of_added(t)] -= momentum(after_, state_, t);
    const auto for_each_free = [&](const auto& visit) {
        for (std::size_t f = 0; f < after_.fans.size(); ++f) {
            if (!is_in_patch_[after_.fans[f].vertex]) continue;
            const Vec2 free = free_mass(f);
            for (int k = 0; k < 2; ++k)
                if (free[k] > 0) visit(f, k, free[k]);
        }
    };
    for_each_free([&](std::size_t f, int k, double m) { mass[patch_of(f)][k] += m; });
    for_each_free(
        [&](std::size_t f, int k, double) { state_.velocity[f][k] += missing[patch_of(f)][k] / mass[patch_of(f)][k]; });
}

std::vector<Vec2> Patches::waves_within() {
    const std::vector<Vec2> before = short_waves(before_, old_);
    std::vector<Vec2> waves(after_.fans.size(), Vec2::Zero());
    std::vector<Vec2> momentum(n_vertices(), Vec2::Zero()), mass = momentum;  // per patch
    for (std::size_t f = 0; f < waves.size(); ++f) {
        const Index v = after_.fans[f].vertex;
        if (!within_[v]) continue;
        const auto& [vertex, triangle, weight] = refined_.origin[v];
        if (triangle < 0) waves[f] = before[vertex];
        for (int k = 0; k < 3 && triangle >= 0; ++k)
            waves[f] += weight[k] * before[before_.mesh.triangles[triangle][k]];
        const Vec2 free = free_mass(f);
        momentum[patch_of(f)] += free.cwiseProduct(waves[f]), mass[patch_of(f)] += free;
    }
    for (std::size_t f = 0; f < waves.size(); ++f) {
        if (!within_[after_.fans[f].vertex]) continue;
        const Vec2 free = free_mass(f);
        for (int k = 0; k < 2; ++k)
            waves[f][k] = free[k] > 0 ? waves[f][k] - momentum[patch_of(f)][k] / mass[patch_of(f)][k] : 0;
    }
    return waves;
}

void Patches::restore_energy() {
    const std::vector<Vec2> waves = waves_within();
    struct Balance {  // [J]; linear a + square a^2 is what the part a of the waves adds
        double lost = 0, linear = 0, square = 0;
        /// Factor of the field that adds the energy lost.
        double part() const {
            const double root = linear * linear + 4 * square * lost;
            if (!(square > 0) || !(linear > 0) || root < 0) return 0;
            return std::clamp(2 * lost / (linear + std::sqrt(root)), least_part, largest_part);
        }
    };
    std::vector<Balance> balances(n_vertices());
    for (const Index t : replaced_) balances[patch_of_replaced(t)].lost += leapfrog_energy(before_, old_, t);
    for (const Index t : added_) {
        Balance& balance = balances[patch_of_added(t)];
        balance.lost -= leapfrog_energy(after_, state_, t);
        const PerCorner v = velocities(state_, t);
        PerCorner w;
        for (Index k = 0; k < 3; ++k) {
            const Index c = 3 * t + k;
            w[k] = waves[after_.fan_of_corner[c]];
            balance.linear += after_.corner_mass[c] * v[k].dot(w[k]);
            balance.square += 0.5 * after_.corner_mass[c] * w[k].squaredNorm();
        }
        balance.linear -= 0.5 * state_.last_step * power(after_, state_, t, gradient(after_.mesh, t, w));
    }
    for (Index t = 0; t < after_.mesh.n_triangles(); ++t) {  // beside a patch, which moves their corners
        const auto& corners = after_.mesh.triangles[t];
        const auto in_patch = std::ranges::find_if(corners, [&](Index v) { return is_in_patch_[v] != 0; });
        const Index t_before = refined_.triangle_before[t];
        if (t_before < 0 || in_patch == corners.end()) continue;
        balances[patches_.find(*in_patch)].lost +=
            leapfrog_energy(before_, old_, t_before) - leapfrog_energy(after_, state_, t);
    }
    for (std::size_t f = 0; f < waves.size(); ++f)
        if (within_[after_.fans[f].vertex]) state_.velocity[f] += balances[patch_of(f)].part() * waves[f];
}

}  // namespace

void restore_momentum_and_energy(const Model& before, const State& old, const Model& after, const RefinedMesh& refined,
                                 State& state) {
    Patches patches(before, old, after, refined, state);
    patches.restore_momentum();
    patches.restore_energy();
}

}  // namespace knap
