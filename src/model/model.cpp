#include "model/model.hpp"

#include "base/error.hpp"
#include "model/fans.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

std::string described(const Selection& on) {
    if (on.boundary.empty()) return on.box ? "a box" : "everything";
    return "boundary `" + on.boundary + "`" + (on.box ? " inside a box" : "");
}

[[noreturn]] void selects_nothing(const std::string& what, const Selection& on) {
    throw UserError("empty-selection", what + " on " + described(on) + " selects nothing of the mesh");
}

/// Indices of the boundary edges whose middle is selected.
std::vector<std::size_t> selected_edges(const Mesh& mesh, const Selection& on) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < mesh.boundary_edges.size(); ++i) {
        const BoundaryEdge& edge = mesh.boundary_edges[i];
        const Vec2 middle = 0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        const bool named = on.boundary.empty() || mesh.boundary_names[edge.boundary] == on.boundary;
        if (named && (!on.box || on.box->contains(middle))) found.push_back(i);
    }
    return found;
}

Vec2 centroid(const Mesh& mesh, Index t) { return (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3; }

class LoadMaker {
public:
    explicit LoadMaker(Model& model) : model_(model) { model_.prescribed_of_corner.assign(model.mesh.n_corners(), -1); }

    void add(const Load& load) {
        const Index history = static_cast<Index>(model_.histories.size());
        model_.histories.push_back(load.history);
        switch (load.kind) {
            case Load::Kind::traction: return add_traction(load, history);
            case Load::Kind::body_force:
            case Load::Kind::acceleration: return add_body_force(load, history);
            case Load::Kind::velocity:
            case Load::Kind::displacement: return add_motion(load, history);
        }
    }

private:
    static Vec2 vector_of(const Load& load) { return {load.value[0].value_or(0), load.value[1].value_or(0)}; }

    void add_traction(const Load& load, Index history) {
        const Mesh& mesh = model_.mesh;
        const auto edges = selected_edges(mesh, load.on);
        if (edges.empty()) selects_nothing("a traction", load.on);
        for (const std::size_t i : edges) {
            const auto& [triangle, side, boundary] = mesh.boundary_edges[i];
            const Index next = (side + 1) % 3;
            const double length = (mesh.corner(triangle, next) - mesh.corner(triangle, side)).norm();
            const Vec2 force = vector_of(load) * (0.5 * length * model_.thickness);
            model_.corner_loads.push_back({3 * triangle + side, history, force});
            model_.corner_loads.push_back({3 * triangle + next, history, force});
        }
    }

    void add_body_force(const Load& load, Index history) {
        const Mesh& mesh = model_.mesh;
        bool any = false;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            if (load.on.box && !load.on.box->contains(centroid(mesh, t))) continue;
            any = true;
            const double amount = load.kind == Load::Kind::acceleration ? model_.corner_mass[3 * t]
                                                                        : mesh.area(t) * model_.thickness / 3;
            for (Index k = 0; k < 3; ++k) model_.corner_loads.push_back({3 * t + k, history, vector_of(load) * amount});
        }
        if (!any) selects_nothing("a body force", load.on);
    }

    void add_motion(const Load& load, Index history) {
        const Mesh& mesh = model_.mesh;
        std::vector<char> held(mesh.n_corners(), 0);
        if (load.on.boundary.empty()) {
            for (Index c = 0; c < mesh.n_corners(); ++c) held[c] = !load.on.box || load.on.box->contains(mesh.corner(c / 3, c % 3));
        } else {
            for (const std::size_t i : selected_edges(mesh, load.on)) {
                const auto& [triangle, side, boundary] = mesh.boundary_edges[i];
                held[3 * triangle + side] = held[3 * triangle + (side + 1) % 3] = 1;
            }
        }
        if (std::find(held.begin(), held.end(), 1) == held.end()) selects_nothing("a prescribed motion", load.on);
        for (std::size_t f = 0; f < model_.fans.size(); ++f) {
            spread_over_bonds(model_.fans[f], held);
            for (Index i = 0; i < model_.fans[f].n_corners; ++i) {
                const Index corner = model_.fan_corners[model_.fans[f].first_corner + i];
                if (held[corner]) prescribe(corner, static_cast<Index>(f), load, history);
            }
        }
    }

    /// What holds one corner holds all that are bonded to it round the vertex; a crack ends it.
    void spread_over_bonds(const Fan& fan, std::vector<char>& held) const {
        for (int pass = 0; pass < 2; ++pass)  // forth and back; a second time round for closed fans
            for (Index step = 0; step < 2 * fan.n_points; ++step) {
                const Index j = pass == 0 ? step % fan.n_points : fan.n_points - 1 - step % fan.n_points;
                const FanPoint& point = model_.fan_points[fan.first_point + j];
                if (point.cracked || point.before == ground || point.after == ground) continue;
                if (held[point.before] || held[point.after]) held[point.before] = held[point.after] = 1;
            }
    }

    /// Later loads win component by component.
    void prescribe(Index corner, Index fan, const Load& load, Index history) {
        if (model_.prescribed_of_corner[corner] < 0) {
            model_.prescribed_of_corner[corner] = static_cast<Index>(model_.prescribed.size());
            model_.prescribed.push_back({fan, {false, false}, {0, 0}, Vec2::Zero(), {false, false}});
        }
        PrescribedMotion& motion = model_.prescribed[model_.prescribed_of_corner[corner]];
        for (int i = 0; i < 2; ++i) {
            if (!load.value[i]) continue;
            motion.component[i] = true;
            motion.history[i] = history;
            motion.value[i] = *load.value[i];
            motion.is_displacement[i] = load.kind == Load::Kind::displacement;
        }
    }

    Model& model_;
};

FoundationOfEdge foundations_of(const Mesh& mesh, const std::vector<Foundation>& foundations) {
    FoundationOfEdge of_edge(mesh.boundary_edges.size(), -1);
    for (std::size_t f = 0; f < foundations.size(); ++f) {
        const auto edges = selected_edges(mesh, foundations[f].on);
        if (edges.empty()) selects_nothing("a foundation", foundations[f].on);
        for (const std::size_t i : edges) of_edge[i] = static_cast<Index>(f);
    }
    return of_edge;
}

void set_initial_velocities(const std::vector<InitialVelocity>& given, Model& model) {
    // a node's velocity is the mass-weighted mean of its corners', so that momentum is what the scenario says
    std::vector<Vec2> of_triangle(model.mesh.n_triangles(), Vec2::Zero());
    for (const InitialVelocity& initial : given) {
        bool any = false;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            if (initial.on.box && !initial.on.box->contains(centroid(model.mesh, t))) continue;
            of_triangle[t] = initial.value;
            any = true;
        }
        if (!any) selects_nothing("an initial velocity", initial.on);
    }
    model.initial_velocity.assign(model.mesh.n_corners(), Vec2::Zero());
    for (const Fan& fan : model.fans) {
        Vec2 momentum = Vec2::Zero();
        for (Index i = 0; i < fan.n_corners; ++i) {
            const Index corner = model.fan_corners[fan.first_corner + i];
            momentum += model.corner_mass[corner] * of_triangle[corner / 3];
        }
        for (Index i = 0; i < fan.n_corners; ++i) {
            const Index corner = model.fan_corners[fan.first_corner + i];
            model.initial_velocity[corner] = fan.split_at_start ? of_triangle[corner / 3] : Vec2(momentum / fan.mass);
        }
    }
}

}  // namespace

Model make_model(ModelInput input) {
    Model model;
    model.mesh = std::move(input.mesh);
    model.plane = input.plane;
    model.thickness = input.thickness;
    model.materials = input.materials;
    model.laws = input.laws;

    model.corner_mass.resize(model.mesh.n_corners());
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        model.corner_mass[c] = model.materials[model.mesh.region[c / 3]].density * model.mesh.area(c / 3) * model.thickness / 3;

    make_interfaces_and_fans(input, foundations_of(model.mesh, input.foundations), model);
    LoadMaker loads(model);
    for (const Load& load : input.loads) loads.add(load);
    set_initial_velocities(input.initial_velocities, model);
    return model;
}

}  // namespace knap
