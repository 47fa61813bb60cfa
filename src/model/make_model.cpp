#include "model/make_model.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "element/shape_functions.hpp"
#include "element/triangle_matrices.hpp"
#include "model/body_in_obstacles.hpp"
#include "model/fans.hpp"
#include "model/joined_polygons.hpp"
#include "model/make_ground.hpp"
#include "model/mass_scaling.hpp"
#include "model/selections.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace knap {
namespace {

/// Returns `selected`; throws where it is empty. `what` acts on the selection; it has the given number in its list.
template <class Selected>
Selected not_empty(Selected selected, const std::string& what, const Selection& on, EmptySelection::List list,
                   std::size_t number) {
    if (!selected.empty()) return selected;
    std::string place = on.box ? "a box" : "everything";
    if (!on.boundary.empty()) place = "boundary `" + on.boundary + "`" + (on.box ? " inside a box" : "");
    if (!on.body.empty()) place += " of body `" + on.body + "`";
    throw EmptySelection(list, number, what + " on " + place + " selects nothing of the mesh");
}

class LoadMaker {
public:
    explicit LoadMaker(Model& model) : model_(model), mesh_(model.mesh) {
        model_.prescribed_of_corner.assign(mesh_.n_corners(), -1);
    }

    void add(const Load& load) {
        model_.load_names.push_back(load.name.empty() ? "load" + std::to_string(number()) : load.name);
        model_.histories.push_back(load.history);
        switch (load.kind) {
            case Load::Kind::traction:
            case Load::Kind::stress: return add_traction(load);
            case Load::Kind::force: return add_force(load);
            case Load::Kind::body_force:
            case Load::Kind::acceleration: return add_body_force(load);
            case Load::Kind::velocity:
            case Load::Kind::displacement: return add_motion(load);
        }
    }

    /// Later ones overwrite earlier ones. The forces of a stress s on the corners of a triangle:
    ///
    ///     -V s w_c,    with grad u = sum_c u_c (x) w_c;    large rotations: -V F s w_c, which turn (S = D E + s)
    void add_initial_stress(const std::vector<InitialStress>& given) {
        model_.history_of_initial_stress = number();
        model_.load_names.emplace_back("initial_stress");
        model_.histories.emplace_back();
        const Index n = mesh_.order == 1 ? 1 : 3;  // places
        model_.initial_stress.assign(n * mesh_.n_triangles(), {});
        std::vector<char> is_stressed(mesh_.n_triangles(), 0);
        for (std::size_t i = 0; i < given.size(); ++i)
            for (const Index t : knap::not_empty(selected_triangles(mesh_, given[i].on), "an initial stress",
                                                 given[i].on, EmptySelection::initial_stresses, i)) {
                is_stressed[t] = 1;
                const auto value_at = [&, &box = given[i].on.box](const Vec2& x) {
                    // points over the box suffice: triangles on its border reach beyond it
                    const bool beyond = given[i].field.table && box;
                    return given[i].field.at_start(beyond ? x.cwiseMax(box->low).cwiseMin(box->high).eval() : x);
                };
                for (Index k = 0; k < 3 && given[i].field.table; ++k)
                    value_at(mesh_.corner(t, k));  // so will a finer mesh
                for (Index m = 0; m < n; ++m) {
                    const Vec2 place = n == 1
                                           ? mesh_.centroid(t)
                                           : Vec2(0.5 * (mesh_.corner(t, (m + 1) % 3) + mesh_.corner(t, (m + 2) % 3)));
                    model_.initial_stress[n * t + m] = value_at(place);
                }
            }
        for (Index t = 0; t < mesh_.n_triangles(); ++t)
            if (is_stressed[t]) add_forces_of_initial_stress(t);
    }

private:
    Index number() const { return static_cast<Index>(model_.histories.size()); }

    void add_forces_of_initial_stress(Index t) {
        const auto g = shape_gradients(mesh_, t);
        const double volume = mesh_.area(t) * model_.thickness;
        if (mesh_.order == 2) {
            std::array<Vec2, 7> force;
            force.fill(Vec2::Zero());
            for (Index m = 0; m < 3; ++m) {
                const auto weight = middle_gradients(g, m);
                for (Index c = 0; c < 7; ++c)
                    force[c] -= volume / 3 * stress_times(model_.initial_stress[3 * t + m], weight[c]);
            }
            for (Index c = 0; c < 7; ++c) add_corner_load(7 * t + c, force[c]);
            return;
        }
        for (Index c = 0; c < 3; ++c) {
            const Vec2 force = -volume * stress_times(model_.initial_stress[t], g[c]);
            add_corner_load(3 * t + c, force);
            if (!model_.large_rotation) continue;
            add_state_force([=](const State& state, double) {
                Vec2 turned = force;
                for (Index k = 0; k < 3; ++k) turned += state.displacement_of(3 * t + k) * g[k].dot(force);
                return turned;
            });
        }
    }

    template <class Selected>
    Selected not_empty(Selected selected, const std::string& what, const Load& load) const {
        return knap::not_empty(std::move(selected), what, load.on, EmptySelection::loads, number() - 1);
    }

    void add_corner_load(Index corner, const Vec2& force) {
        model_.corner_loads.push_back({corner, number() - 1, force});
    }

    void add_traction(const Load& load) {
        const bool is_traction = load.kind == Load::Kind::traction;
        for (const std::size_t i :
             not_empty(selected_edges(mesh_, load.on), is_traction ? "a traction" : "a pressure or stress", load)) {
            const auto& [triangle, side, boundary] = mesh_.boundary_edges[i];
            if (load.field) {
                add_traction_of_field(load, triangle, side);
                continue;
            }
            const Vec2 along = mesh_.side_vector(triangle, side);  // the body lies to its left
            const Vec2 force = is_traction ? Vec2(load.vector() * (along.norm() * model_.thickness))
                                           : Vec2(model_.thickness * stress_times(load.stress, -turned_left(along)));
            const Index first = mesh_.corners_per_triangle() * triangle;
            const double end = mesh_.order == 1 ? 1. / 2 : 1. / 6;
            add_corner_load(first + side, end * force);
            add_corner_load(first + (side + 1) % 3, end * force);
            if (mesh_.order == 2) add_corner_load(first + 3 + side, 4. / 6 * force);
            if (is_traction || !model_.large_rotation) continue;
            // the traction sigma n of the present edge e + u_b - u_a: -t/2 sigma turned(e + u_b - u_a) on both ends
            const auto on_present_edge = [force = Vec2(end * force), a = first + side, b = first + (side + 1) % 3,
                                          stress = load.stress,
                                          thickness = model_.thickness](const State& state, double) {
                const Vec2 moved = state.displacement_of(b) - state.displacement_of(a);
                return Vec2(force - 0.5 * thickness * stress_times(stress, turned_left(moved)));
            };
            for (std::size_t i = model_.corner_loads.size() - 2; i < model_.corner_loads.size(); ++i)
                model_.corner_loads[i].state_force = static_cast<Index>(model_.state_forces.size());
            model_.state_forces.emplace_back(on_present_edge);
        }
    }

    /// The force of int N_a f ds on end a of an edge, by Simpson's rule: exact for f that is quadratic along an edge of
    /// order 1, linear along one of order 2.
    void add_traction_of_field(const Load& load, Index triangle, Index side) {
        const Vec2 along = mesh_.side_vector(triangle, side), normal = -model_.thickness * turned_left(along),
                   begin = mesh_.corner(triangle, side);
        const Index first = mesh_.corners_per_triangle() * triangle;
        const std::array<Index, 2> ends{first + side, first + (side + 1) % 3};
        const auto kept = std::make_shared<const Load>(load);
        const auto add = [&](Index corner, double at, double own, double of_middle) {  // weights of f there and at 1/2
            const auto force_at = [kept, own, of_middle, place = Vec2(begin + at * along),
                                   middle = Vec2(begin + 0.5 * along)](const Vec2& on, double t) {
                Vec2 force = own * kept->traction_on(on, place, t);
                if (of_middle != 0) force += of_middle * kept->traction_on(on, middle, t);
                return force;
            };
            load.field->at_start(begin + at * along);
            add_corner_load(corner, force_at(normal, 0));
            const bool follows = load.kind == Load::Kind::stress && model_.large_rotation;
            if (!follows && !load.field->depends_on_time()) return;
            add_state_force(
                [force_at, follows, normal, ends, thickness = model_.thickness](const State& state, double t) {
                    if (!follows) return force_at(normal, t);
                    const Vec2 moved = state.displacement_of(ends[1]) - state.displacement_of(ends[0]);
                    return force_at(normal - thickness * turned_left(moved), t);
                });
        };
        const bool linear = mesh_.order == 1;
        for (int end = 0; end < 2; ++end) add(ends[end], end, 1. / 6, linear ? 2. / 6 : 0);
        if (!linear) add(first + 3 + side, 0.5, 4. / 6, 0);
    }

    /// Of the last corner load.
    void add_state_force(StateForce force) {
        model_.corner_loads.back().state_force = static_cast<Index>(model_.state_forces.size());
        model_.state_forces.push_back(std::move(force));
    }

    void add_body_force(const Load& load) {
        for (const Index t : not_empty(selected_triangles(mesh_, load.on), "a body force", load)) {
            const double amount =
                load.kind == Load::Kind::acceleration ? model_.triangle_mass(t) : mesh_.area(t) * model_.thickness;
            const Index n = mesh_.corners_per_triangle();
            for (Index k = 0; k < n; ++k)
                add_corner_load(n * t + k, load.vector() * corner_share(mesh_.order, k, amount));
        }
    }

    /// Shared by the vertices, also of second order.
    void add_force(const Load& load) {
        const std::vector<char> selected = selected_corners(mesh_, load.on);
        const auto vertex_of = [&](Index c) {
            return mesh_.triangles[mesh_.triangle_of(c)][mesh_.place_in_triangle(c)];
        };
        std::vector<Index> corners, n_corners(mesh_.vertices.size(), 0);  // n_corners: selected ones, per vertex
        for (Index c = 0; c < mesh_.n_corners(); ++c)
            if (selected[c] && mesh_.place_in_triangle(c) < 3) corners.push_back(c), ++n_corners[vertex_of(c)];
        const auto n_vertices = n_corners.size() - std::ranges::count(n_corners, 0);
        for (const Index c : not_empty(corners, "a force", load))
            add_corner_load(c, load.vector() / (static_cast<double>(n_vertices) * n_corners[vertex_of(c)]));
    }

    /// Later loads replace earlier ones component by component; a scenario with such loads is an error
    /// (find_contradictions).
    void add_motion(const Load& load) {
        const std::vector<char> held = held_corners(model_, load.on);
        std::vector<Index> corners;
        for (const Index corner : model_.fan_corners)
            if (held[corner]) corners.push_back(corner);
        for (const Index corner : not_empty(corners, "a prescribed motion", load)) {
            Index& number = model_.prescribed_of_corner[corner];
            if (number < 0) {
                number = static_cast<Index>(model_.prescribed.size());
                model_.prescribed.push_back(
                    {model_.fan_of_corner[corner], {false, false}, {0, 0}, Vec2::Zero(), {false, false}});
            }
            PrescribedMotion& motion = model_.prescribed[number];
            for (int k = 0; k < 2; ++k) {
                if (!load.value[k]) continue;
                motion.component[k] = true;
                motion.history[k] = this->number() - 1;
                motion.value[k] = *load.value[k];
                motion.is_displacement[k] = load.kind == Load::Kind::displacement;
            }
        }
    }

    Model& model_;
    const Mesh& mesh_;
};

/// Wherever a fluid may come, its pressure has a value.
void check_pressures(const CrackPressure& given, const Model& model) {
    for (const Interface& interface : model.interfaces)
        if (given.field && interface.triangle[0] != rigid_support &&
            (interface.cracked || model.laws[interface.law].breakable()))
            for (const Index v : interface.vertex) given.field->at_start(model.mesh.vertices[v]);
}

/// Vertices where a fluid enters cracks, and the points of the joints that it fills.
CrackFluid fluid_of(const CrackPressure& given, const ModelInput& input, std::size_t number, const Model& model) {
    const Mesh& mesh = model.mesh;
    CrackFluid fluid{.given = given, .history = static_cast<Index>(model.histories.size())};
    fluid.is_source.assign(mesh.vertices.size(), !given.from && given.joint_law < 0);
    if (given.from) {
        const std::vector<char> selected = selected_corners(mesh, *given.from);
        std::vector<Index> corners;
        for (Index c = 0; c < mesh.n_corners(); ++c)
            if (selected[c] && mesh.place_in_triangle(c) < 3) corners.push_back(c);
        for (const Index c :
             not_empty(corners, "a pressure in cracks from", *given.from, EmptySelection::crack_pressures, number))
            fluid.is_source[mesh.triangles[mesh.triangle_of(c)][mesh.place_in_triangle(c)]] = 1;
    }
    if (given.joint_law < 0) return fluid;
    for (std::size_t i = 0; i < mesh.interior_edges.size(); ++i) {
        const Index joint = mesh.interior_edges[i].joint, n = model.points_per_interface();
        if (joint < 0 || input.law_of_joint[joint] != given.joint_law) continue;
        for (const Index v : model.interfaces[i].vertex) fluid.is_source[v] = 1;
        for (Index k = 0; k < n; ++k) fluid.joint_points.push_back(static_cast<Index>(i) * n + k);
    }
    if (fluid.joint_points.empty())
        throw EmptySelection(EmptySelection::crack_pressures, number, "no joint of the mesh has the law of a pressure");
    return fluid;
}

SupportOfEdge supports_of(const Mesh& mesh, const std::vector<Support>& supports) {
    SupportOfEdge of_edge(mesh.boundary_edges.size(), -1);
    for (std::size_t s = 0; s < supports.size(); ++s) {
        const Selection& on = supports[s].on;
        for (const std::size_t i : not_empty(selected_edges(mesh, on), "a support", on, EmptySelection::supports, s))
            of_edge[i] = static_cast<Index>(s);
    }
    return of_edge;
}

/// Per corner of a fan: the place of the first corner with which it moves at the start, or the support. All corners of
/// a bonded fan move as one, and in a split fan those with an unbreakable point between them.
std::vector<Index> parts_that_move_as_one(const Model& model, const Fan& fan) {
    std::vector<Index> part(fan.n_corners, 0);
    if (!fan.split_at_start) return part;
    const auto corners = model.corners(fan);
    std::iota(part.begin(), part.end(), 0);
    const auto part_of = [&](Index c) {
        return c == rigid_support ? rigid_support : part[std::ranges::find(corners, c) - corners.begin()];
    };
    for (const FanPoint& point : model.points(fan)) {
        if (!unbreakable(model, point)) continue;
        const Index a = part_of(point.before), b = part_of(point.after);
        std::ranges::replace(part, std::max(a, b), std::min(a, b));
    }
    return part;
}

/// Common centre of mass of some triangles, at least one.
Vec2 centre_of_mass(const Model& model, const std::vector<Index>& triangles) {
    const Vec2 origin = model.mesh.centroid(triangles.front());  // a distant one would cost digits
    Vec2 moment = Vec2::Zero();
    double mass = 0;
    for (const Index t : triangles) {
        moment += model.triangle_mass(t) * (model.mesh.centroid(t) - origin);
        mass += model.triangle_mass(t);
    }
    return origin + moment / mass;
}

/// The velocity v + omega x (x - x_c) + D (x - x_c) that the scenario gives to each corner.
std::vector<Vec2> given_velocities(const std::vector<InitialVelocity>& given, const Model& model) {
    std::vector<Vec2> of_corner(model.mesh.n_corners(), Vec2::Zero());
    for (std::size_t i = 0; i < given.size(); ++i) {
        const auto& [on, value, spin, rate] = given[i];
        const std::vector<Index> triangles = not_empty(selected_triangles(model.mesh, on), "an initial velocity", on,
                                                       EmptySelection::initial_velocities, i);
        const bool is_uniform = spin == 0 && rate == std::array<double, 3>{};
        const Vec2 centre = is_uniform ? Vec2(Vec2::Zero()) : centre_of_mass(model, triangles);
        const Index n = model.mesh.corners_per_triangle();
        for (const Index t : triangles)
            for (Index c = n * t; c < n * (t + 1); ++c) {
                const Vec2 arm = model.mesh.corner(c) - centre;
                of_corner[c] = value;
                if (!is_uniform) of_corner[c] += spin * turned_left(arm) + stress_times(rate, arm);
            }
    }
    return of_corner;
}

/// Corners that move as one start with the mass-weighted mean of their velocities, which keeps the momentum; the first
/// step would otherwise join them with a loss of energy that no term of the balance covers. On the support they are at
/// rest.
void set_initial_velocities(const std::vector<InitialVelocity>& given, Model& model) {
    const auto is_rate = [](const PrescribedMotion& motion) {
        return (motion.component[0] && !motion.is_displacement[0]) ||
               (motion.component[1] && !motion.is_displacement[1]);
    };
    if (!given.empty() || std::ranges::any_of(model.prescribed, is_rate))
        model.initial_velocity.assign(model.mesh.n_corners(), Vec2::Zero());
    if (given.empty()) return;
    const std::vector<Vec2> of_corner = given_velocities(given, model);
    struct Sum {  // over the corners of a part
        Vec2 momentum = Vec2::Zero();
        double mass = 0;
        bool differ = false;
    };
    std::vector<Sum> sums;  // by the first corner of the part
    for (const Fan& fan : model.fans) {
        const auto corners = model.corners(fan);
        const auto given_at = [&](Index i) -> const Vec2& { return of_corner[corners[i]]; };
        const std::vector<Index> part = parts_that_move_as_one(model, fan);
        std::ranges::fill(sums, Sum{});
        sums.resize(fan.n_corners);
        for (Index i = 0; i < fan.n_corners; ++i) {
            if (part[i] < 0) continue;
            Sum& sum = sums[part[i]];
            sum.momentum += model.corner_mass[corners[i]] * given_at(i);
            sum.mass += model.corner_mass[corners[i]];
            sum.differ = sum.differ || given_at(i) != given_at(part[i]);
        }
        for (Index i = 0; i < fan.n_corners; ++i)
            if (part[i] >= 0) {
                const Sum& sum = sums[part[i]];
                model.initial_velocity[corners[i]] = sum.differ ? Vec2(sum.momentum / sum.mass) : given_at(part[i]);
            }
    }
}

/// A corner with prescribed velocity starts with it, so that there is no impact at the start.
void start_as_driven(Model& model) {
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const PrescribedMotion* motion = model.motion_of(c);
        for (int k = 0; k < 2 && motion; ++k)
            if (motion->component[k] && !motion->is_displacement[k])
                model.initial_velocity[c][k] = motion->value[k] * model.histories[motion->history[k]](0);
    }
}

/// The layers of a triangle have the angle of the field at its centroid.
void turn_layers(const std::vector<std::shared_ptr<const PlaceField>>& fields, Model& model) {
    if (std::ranges::all_of(fields, [](const auto& field) { return field == nullptr; })) return;
    Mesh& mesh = model.mesh;
    mesh.layer_angle.clear();
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const PlaceField* const field = fields[mesh.region[t]].get();
        const std::optional<Bedding>& bedding = model.materials[mesh.region[t]].bedding;
        mesh.layer_angle.push_back(field     ? field->at_start(mesh.centroid(t))[0] * std::numbers::pi / 180
                                   : bedding ? bedding->angle
                                             : 0);
    }
}

/// An acceleration of everything, such as gravity, acts on free obstacles, too.
void weigh_obstacles(const std::vector<Load>& loads, Model& model) {
    for (Obstacle& obstacle : model.obstacles)
        for (const Load& load : loads)
            if (load.kind == Load::Kind::acceleration && !load.on.box && load.on.body.empty())
                obstacle.forces.push_back(
                    {.value = obstacle.mass * Vec3(load.vector().x(), load.vector().y(), 0), .history = load.history});
}

void check_obstacles(const Model& model) {
    const std::optional<StartOverlap> found = overlap_at_start(model);
    if (!found) return;
    const std::string& name = model.obstacles[found->obstacle].name;
    if (model.obstacles[found->obstacle].outline.kind == Outline::Kind::polyline)
        throw ObstacleInBody(found->obstacle,
                             "the body starts in the ground of obstacle `" + name + "`, by " +
                                 readable(found->depth, "m") + " at " + place_text(found->place),
                             "move it out by as much; the ground lies on the left of the polyline, whose points may be "
                             "given the other way round");
    throw ObstacleInBody(
        found->obstacle,
        "obstacle `" + name +
            formatted("` lies in the body at the start, by %s at ", readable(found->depth, "m").c_str()) +
            place_text(found->place),
        "move it out by as much");
}

}  // namespace

Model make_model(ModelInput input) {
    Model model{.mesh = std::move(input.mesh),
                .plane = input.plane,
                .thickness = input.thickness,
                .materials = input.materials,
                .laws = input.laws};
    turn_layers(input.layer_angle, model);
    make_interfaces(input, supports_of(model.mesh, input.supports), model);
    if (input.mass_scaling > 0)
        model.mass_factor =
            scale_masses(model, stable_steps(model.mesh, model.materials, model.plane), input.cuts, input.mass_scaling)
                .factor;
    model.corner_mass.reserve(model.mesh.n_corners());
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        model.corner_mass.push_back(corner_share(model.mesh.order, model.mesh.place_in_triangle(c),
                                                 model.triangle_mass(model.mesh.triangle_of(c))));
    make_fans(model);
    model.large_rotation = input.large_rotation;
    if (model.large_rotation && model.mesh.order == 2)
        throw UserError("large-rotation", "large rotations need triangles of first order");
    LoadMaker loads(model);
    for (const Load& load : input.loads) loads.add(load);
    if (!input.initial_stresses.empty()) loads.add_initial_stress(input.initial_stresses);
    std::ranges::stable_sort(model.corner_loads, {}, &CornerLoad::corner);
    for (std::size_t i = 0; i < input.crack_pressures.size(); ++i) {
        check_pressures(input.crack_pressures[i], model);
        model.crack_fluids.push_back(fluid_of(input.crack_pressures[i], input, i, model));
        const CrackPressure& given = input.crack_pressures[i];
        model.histories.push_back(given.is_injected() ? TimeFunction() : given.history);
        model.load_names.push_back(given.name.empty() ? "fluid" + std::to_string(i) : given.name);
    }
    set_initial_velocities(input.initial_velocities, model);
    start_as_driven(model);
    model.obstacles = std::move(input.obstacles);
    join_fixed_polygons(model.obstacles);
    model.contact_of_pair = std::move(input.contact_of_pair);
    model.ground = make_ground(model);
    model.heat = std::move(input.heat);
    for (const CohesiveLaw& law : input.laws) model.laws_follow_temperature |= model.heat && law.of_temperature;
    weigh_obstacles(input.loads, model);
    check_obstacles(model);
    return model;
}

}  // namespace knap
