#pragma once
// Small bodies for physics tests: structured bars (tests want exact waves; scenarios use random meshes) and runs of the stepper.
#include "model/state.hpp"
#include "observe/energy_ledger.hpp"
#include "stepper/moreau_jean.hpp"

#include <omp.h>

#include <functional>

namespace knap::tests {

/// The bodies are small and the tests run side by side: one thread, unless a test asks for more.
inline const bool one_thread = (omp_set_num_threads(1), true);

/// Finds the edges of a rectangle's mesh and names its boundaries.
inline void name_sides(Mesh& mesh, double length, double height) {
    mesh.boundary_names = {"left", "right", "bottom", "top"};
    find_edges(mesh);
    for (BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 middle = 0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        const double near = 1e-9 * (length + height);
        edge.boundary = middle.x() < near ? 0 : middle.x() > length - near ? 1 : middle.y() < near ? 2 : 3;
    }
}

/// n_x by n_y cells of two triangles each, from the origin, boundaries left, right, bottom, top; the region is the column's: region_of(i).
inline Mesh bar_mesh(int n_x, int n_y, double length, double height, const std::function<Index(int)>& region_of = {}) {
    Mesh mesh;
    for (int j = 0; j <= n_y; ++j)
        for (int i = 0; i <= n_x; ++i) mesh.vertices.push_back({length * i / n_x, height * j / n_y});
    const auto at = [&](int i, int j) { return static_cast<Index>(j * (n_x + 1) + i); };
    for (int j = 0; j < n_y; ++j)
        for (int i = 0; i < n_x; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            const Index region = region_of ? region_of(i) : 0;
            mesh.region.push_back(region);
            mesh.region.push_back(region);
        }
    name_sides(mesh, length, height);
    return mesh;
}

/// A bar of n cells of four triangles each (both diagonals), mirror-symmetric about its axis, so that waves along it stay one-dimensional:
/// the nodes of a column move alike. Triangles 4 i .. 4 i + 3 of cell i lie below, right, above, left; boundaries as in bar_mesh.
inline Mesh symmetric_bar_mesh(int n, double length, double height, const std::function<Index(int)>& region_of = {}) {
    Mesh mesh;
    for (int i = 0; i <= n; ++i) {
        mesh.vertices.push_back({length * i / n, 0});
        mesh.vertices.push_back({length * i / n, height});
        if (i < n) mesh.vertices.push_back({length * (i + 0.5) / n, 0.5 * height});
    }
    for (int i = 0; i < n; ++i) {
        const Index a = 3 * i, d = a + 1, middle = a + 2, b = a + 3, c = a + 4;
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, d}, std::pair{d, a}}) {
            mesh.triangles.push_back({from, to, middle});
            mesh.region.push_back(region_of ? region_of(i) : 0);
        }
    }
    name_sides(mesh, length, height);
    return mesh;
}

inline Load load(Load::Kind kind, const std::string& boundary, std::optional<double> x, std::optional<double> y, TimeFunction history = {}) {
    return {.kind = kind, .on = {.boundary = boundary, .box = {}}, .value = {x, y}, .history = std::move(history)};
}

/// A model with its stepper, its state and its books.
class Run {
public:
    explicit Run(ModelInput input) : Run(make_model(std::move(input))) {}
    explicit Run(Model made) : model(std::move(made)), stepper(model), now(initial_state(model)), ledger(model, now) {}
    Run(const Run&) = delete;  // the stepper refers to the model

    const StepReport& step(double h) {
        last = stepper.step(now, h, next_);
        std::swap(now, next_);
        ledger.add(now, last);
        return last;
    }

    /// Displacement and velocity of the corner of `triangle` at its vertex k.
    Vec2 u(Index triangle, Index k) const { return now.displacement[now.node_of_corner[3 * triangle + k]]; }
    Vec2 v(Index triangle, Index k) const { return now.velocity[now.node_of_corner[3 * triangle + k]]; }

    /// Mass-weighted mean velocity of all triangles that `chosen` accepts.
    Vec2 mean_velocity(const std::function<bool(Index)>& chosen) const {
        Vec2 momentum = Vec2::Zero();
        double mass = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c) {
            if (!chosen(c / 3)) continue;
            momentum += model.corner_mass[c] * now.velocity[now.node_of_corner[c]];
            mass += model.corner_mass[c];
        }
        return momentum / mass;
    }

    Model model;
    MoreauJean stepper;
    State now;
    EnergyLedger ledger;
    StepReport last;

private:
    State next_;
};

}  // namespace knap::tests
