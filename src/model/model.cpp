#include "model/model.hpp"

#include "base/error.hpp"
#include "element/triangle_matrices.hpp"
#include "model/fans.hpp"
#include "model/selections.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace knap {
namespace {

std::string described(const Selection& on) {
    if (on.boundary.empty()) return on.box ? "a box" : "everything";
    return "boundary `" + on.boundary + "`" + (on.box ? " inside a box" : "");
}

[[noreturn]] void selects_nothing(const std::string& what, const Selection& on, EmptySelection::List list, std::size_t number) {
    throw EmptySelection(list, number, what + " on " + described(on) + " selects nothing of the mesh");
}

class LoadMaker {
public:
    explicit LoadMaker(Model& model) : model_(model) { model_.prescribed_of_corner.assign(model.mesh.n_corners(), -1); }

    void add(const Load& load, std::size_t number) {
        number_ = number;
        const Index history = static_cast<Index>(model_.histories.size());
        model_.histories.push_back(load.history);
        switch (load.kind) {
            case Load::Kind::traction:
            case Load::Kind::stress: return add_traction(load, history);
            case Load::Kind::force: return add_force(load, history);
            case Load::Kind::body_force:
            case Load::Kind::acceleration: return add_body_force(load, history);
            case Load::Kind::velocity:
            case Load::Kind::displacement: return add_motion(load, history);
        }
    }

private:
    static Vec2 times(const std::array<double, 3>& stress, const Vec2& normal) {
        return {stress[0] * normal.x() + stress[2] * normal.y(), stress[2] * normal.x() + stress[1] * normal.y()};
    }
    static Vec2 vector_of(const Load& load) { return {load.value[0].value_or(0), load.value[1].value_or(0)}; }

    void add_traction(const Load& load, Index history) {
        const Mesh& mesh = model_.mesh;
        const auto edges = selected_edges(mesh, load.on);
        if (edges.empty()) selects_nothing(load.kind == Load::Kind::traction ? "a traction" : "a pressure or stress", load.on, EmptySelection::loads, number_);
        for (const std::size_t i : edges) {
            const auto& [triangle, side, boundary] = mesh.boundary_edges[i];
            const Index next = (side + 1) % 3;
            const Vec2 along = mesh.corner(triangle, next) - mesh.corner(triangle, side);  // the body lies to its left
            const Vec2 force = load.kind == Load::Kind::traction ? Vec2(vector_of(load) * (along.norm() * model_.thickness))
                                                                 : Vec2(model_.thickness * times(load.stress, -turned_left(along)));
            const Index first = mesh.corners_per_triangle() * triangle;
            const double end = mesh.order == 1 ? 1. / 2 : 1. / 6;
            model_.corner_loads.push_back({first + side, history, end * force});
            model_.corner_loads.push_back({first + next, history, end * force});
            if (mesh.order == 2) model_.corner_loads.push_back({first + 3 + side, history, 4. / 6 * force});
        }
    }

    void add_body_force(const Load& load, Index history) {
        const Mesh& mesh = model_.mesh;
        bool any = false;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            if (load.on.box && !load.on.box->contains(mesh.centroid(t))) continue;
            any = true;
            const double amount = load.kind == Load::Kind::acceleration ? model_.triangle_mass(t) : mesh.area(t) * model_.thickness;
            const Index n = mesh.corners_per_triangle();
            for (Index k = 0; k < n; ++k)
                model_.corner_loads.push_back({n * t + k, history, vector_of(load) * corner_share(mesh.order, k, amount)});
        }
        if (!any) selects_nothing("a body force", load.on, EmptySelection::loads, number_);
    }

    void check_not_empty(const std::string& what, const Load& load, const std::vector<char>& corners) const {
        if (std::find(corners.begin(), corners.end(), 1) == corners.end()) selects_nothing(what, load.on, EmptySelection::loads, number_);
    }

    void add_force(const Load& load, Index history) {
        const Mesh& mesh = model_.mesh;
        std::vector<char> selected = selected_corners(mesh, load.on);
        check_not_empty("a force", load, selected);
        std::vector<Index> n_corners(mesh.vertices.size(), 0);  // selected ones, per vertex
        const auto vertex_of = [&](Index c) { return mesh.triangles[mesh.triangle_of(c)][mesh.place_in_triangle(c)]; };
        for (Index c = 0; c < mesh.n_corners(); ++c) {
            if (mesh.place_in_triangle(c) > 2) selected[c] = 0;  // shared by vertices, also of second order
            if (selected[c]) ++n_corners[vertex_of(c)];
        }
        const auto n_vertices = n_corners.size() - std::count(n_corners.begin(), n_corners.end(), 0);
        if (n_vertices == 0) selects_nothing("a force", load.on, EmptySelection::loads, number_);
        for (Index c = 0; c < mesh.n_corners(); ++c)
            if (selected[c]) model_.corner_loads.push_back({c, history, vector_of(load) / (static_cast<double>(n_vertices) * n_corners[vertex_of(c)])});
    }

    void add_motion(const Load& load, Index history) {
        const std::vector<char> held = held_corners(model_, load.on);
        check_not_empty("a prescribed motion", load, held);
        for (std::size_t f = 0; f < model_.fans.size(); ++f)
            for (Index i = 0; i < model_.fans[f].n_corners; ++i) {
                const Index corner = model_.fan_corners[model_.fans[f].first_corner + i];
                if (held[corner]) prescribe(corner, static_cast<Index>(f), load, history);
            }
    }

    /// Later loads replace earlier ones component by component; a scenario may not ask for that (find_contradictions).
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
    std::size_t number_ = 0;  // of the load
};

SupportOfEdge supports_of(const Mesh& mesh, const std::vector<Support>& supports) {
    SupportOfEdge of_edge(mesh.boundary_edges.size(), -1);
    for (std::size_t f = 0; f < supports.size(); ++f) {
        const auto edges = selected_edges(mesh, supports[f].on);
        if (edges.empty()) selects_nothing("a support", supports[f].on, EmptySelection::supports, f);
        for (const std::size_t i : edges) of_edge[i] = static_cast<Index>(f);
    }
    return of_edge;
}

/// Per corner of a fan: the first corner that it moves with at the start, or the support. All corners of a fan in one piece, and in the others
/// those that points without end of strength join.
std::vector<Index> parts_that_move_as_one(const Model& model, const Fan& fan) {
    std::vector<Index> part(fan.n_corners, 0);
    if (!fan.split_at_start) return part;
    const Index* corner = &model.fan_corners[fan.first_corner];
    std::iota(part.begin(), part.end(), 0);
    const auto part_of = [&](Index c) { return c == rigid_support ? rigid_support : part[std::find(corner, corner + fan.n_corners, c) - corner]; };
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model.fan_points[fan.first_point + j];
        if (point.cracked || model.laws[point.law].breakable()) continue;
        const Index a = part_of(point.before), b = part_of(point.after);
        std::replace(part.begin(), part.end(), std::max(a, b), std::min(a, b));
    }
    return part;
}

void set_initial_velocities(const std::vector<InitialVelocity>& given, Model& model) {
    // corners that move as one have the mass-weighted mean of theirs, so that momentum is what the scenario says. Welded together by the first
    // step, they would lose energy that is in no book. What stands on the support stays at rest.
    std::vector<Vec2> of_triangle(model.mesh.n_triangles(), Vec2::Zero());
    for (std::size_t i = 0; i < given.size(); ++i) {
        const InitialVelocity& initial = given[i];
        bool any = false;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
            if (initial.on.box && !initial.on.box->contains(model.mesh.centroid(t))) continue;
            of_triangle[t] = initial.value;
            any = true;
        }
        if (!any) selects_nothing("an initial velocity", initial.on, EmptySelection::initial_velocities, i);
    }
    model.initial_velocity.assign(model.mesh.n_corners(), Vec2::Zero());
    for (const Fan& fan : model.fans) {
        const Index* corner = &model.fan_corners[fan.first_corner];
        const std::vector<Index> part = parts_that_move_as_one(model, fan);
        for (Index first = 0; first < fan.n_corners; ++first) {
            Vec2 momentum = Vec2::Zero();
            double mass = 0;
            bool differ = false;
            for (Index i = 0; i < fan.n_corners; ++i) {
                if (part[i] != first) continue;
                const Vec2& velocity = of_triangle[model.mesh.triangle_of(corner[i])];
                momentum += model.corner_mass[corner[i]] * velocity;
                mass += model.corner_mass[corner[i]];
                differ = differ || velocity != of_triangle[model.mesh.triangle_of(corner[first])];
            }
            for (Index i = 0; i < fan.n_corners; ++i)
                if (part[i] == first) model.initial_velocity[corner[i]] = differ ? Vec2(momentum / mass) : of_triangle[model.mesh.triangle_of(corner[first])];
        }
    }
}

/// What is driven at a speed begins with it: there is no blow at the start, and its first reaction is not that of one.
void start_as_driven(Model& model) {
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        if (model.prescribed_of_corner[c] < 0) continue;
        const PrescribedMotion& motion = model.prescribed[model.prescribed_of_corner[c]];
        for (int k = 0; k < 2; ++k)
            if (motion.component[k] && !motion.is_displacement[k])
                model.initial_velocity[c][k] = motion.value[k] * model.histories[motion.history[k]](0);
    }
}

/// An acceleration of everything, gravity, acts on free obstacles, too.
void weigh_obstacles(const std::vector<Load>& loads, Model& model) {
    for (Obstacle& obstacle : model.obstacles)
        for (const Load& load : loads)
            if (load.kind == Load::Kind::acceleration && !load.on.box)
                obstacle.forces.push_back({.value = obstacle.mass * Vec3(load.value[0].value_or(0), load.value[1].value_or(0), 0), .history = load.history});
}

/// Obstacles begin beside the body.
void check_obstacles(const Model& model) {
    const Mesh& mesh = model.mesh;
    Vec2 low = mesh.vertices.front(), high = low;
    for (const Vec2& x : mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
    for (const Obstacle& obstacle : model.obstacles) {
        for (const BoundaryEdge& edge : mesh.boundary_edges) {
            const Vec2 a = mesh.corner(edge.triangle, edge.side), b = mesh.corner(edge.triangle, (edge.side + 1) % 3);
            const double depth = -distance_to(obstacle.outline, obstacle.start, a).gap;
            if (depth <= std::min(1e-6 * (high - low).norm(), 1e-2 * (b - a).norm())) continue;  // of rounded coordinates; contact keeps it from growing
            char text[200];
            std::snprintf(text, sizeof text, " lies in the body at the start, by %.3g m at (%.6g, %.6g) m", depth, a.x(), a.y());
            throw UserError("overlap", "obstacle `" + obstacle.name + "`" + text);
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
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const double of_triangle = model.triangle_mass(model.mesh.triangle_of(c));
        model.corner_mass[c] = corner_share(model.mesh.order, model.mesh.place_in_triangle(c), of_triangle);
    }

    make_interfaces_and_fans(input, supports_of(model.mesh, input.supports), model);
    LoadMaker loads(model);
    for (std::size_t i = 0; i < input.loads.size(); ++i) {
        loads.add(input.loads[i], i);
        model.load_names.push_back(input.loads[i].name.empty() ? "load" + std::to_string(i) : input.loads[i].name);
    }
    std::ranges::stable_sort(model.corner_loads, {}, &CornerLoad::corner);
    set_initial_velocities(input.initial_velocities, model);
    start_as_driven(model);
    model.obstacles = std::move(input.obstacles);
    weigh_obstacles(input.loads, model);
    check_obstacles(model);
    return model;
}

}  // namespace knap
