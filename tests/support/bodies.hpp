#pragma once
// Small bodies for physics tests: structured bars (tests want exact waves; scenarios use random meshes) and runs of the stepper.
#include "model/state.hpp"
#include "observe/energy_ledger.hpp"
#include "stepper/moreau_jean.hpp"

#include <functional>

namespace knap::tests {

/// n_x by n_y cells of two triangles each, from `low`, boundaries left, right, bottom, top; the region is the column's: region_of(i).
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
    mesh.boundary_names = {"left", "right", "bottom", "top"};
    find_edges(mesh);
    for (BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 middle = 0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        const double near = 1e-9 * (length + height);
        edge.boundary = middle.x() < near ? 0 : middle.x() > length - near ? 1 : middle.y() < near ? 2 : 3;
    }
    return mesh;
}

inline Load load(Load::Kind kind, const std::string& boundary, std::optional<double> x, std::optional<double> y, TimeFunction history = {}) {
    return {.kind = kind, .on = {.boundary = boundary, .box = {}}, .value = {x, y}, .history = std::move(history)};
}

/// A model with its stepper, its state and its books.
class Run {
public:
    explicit Run(ModelInput input) : model(make_model(std::move(input))), stepper(model), now(initial_state(model)), ledger(model, now) {}

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
