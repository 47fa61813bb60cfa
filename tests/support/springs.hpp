#pragma once
// Exact bodies of two masses and a spring on a cohesive point, for references that are ordinary differential equations.
#include "support/bodies.hpp"

namespace knap::tests {

inline SchemeOptions implicit(double theta = 0.5, CohesionScheme cohesion = CohesionScheme::implicit_beta) {
    return {.bulk = BulkScheme::implicit_theta, .cohesion = cohesion, .theta = theta};
}

enum class SpringMotion { opening, slip };

/// What happens at one cohesive point of area 1; the body has two of them, equal, so that everything is there twice.
struct SpringBody {
    CohesiveLaw law;
    double mass = 1;       // at each point, and the same beyond its spring
    double stiffness = 1;  // of each spring
    SpringMotion motion = SpringMotion::opening;
    bool glued = true;
};

/// The two points stand below a triangle without stiffness. At each of them hangs the tip of a triangle with nu = 0 that is symmetric
/// about the x-axis: it is a spring between the tip and its two far corners, which move alike, with k_x = E and k_y = G and no force across.
/// Six more triangles without stiffness join them and give all masses the same size; their other corners are held.
///
///       b---+---b        triangles, of area 1: 0 = 0 1 +;  1, 2 = springs 0 b b, 1 b b;  3, 4 above them, 5, 6 below
///       |\ / \ /|
///       | 0===1 |        === support; each point has area 1
///       |/ \ / \|
///       b---+---b
inline ModelInput spring_body(const SpringBody& body) {
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh.vertices = {{0, 0}, {2, 0}, {1, 1}, {-1, 1}, {-1, -1}, {3, 1}, {3, -1}, {1, -1}};
    input.mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {1, 6, 5}, {0, 2, 3}, {1, 5, 2}, {0, 4, 7}, {1, 7, 6}};
    input.mesh.region = {1, 0, 0, 1, 1, 1, 1};
    input.mesh.boundary_names = {"free", "base", "left", "right"};
    find_edges(input.mesh);
    for (BoundaryEdge& edge : input.mesh.boundary_edges)
        edge.boundary = edge.triangle == 0 ? 1 : edge.triangle == 1 ? 2 : edge.triangle == 2 ? 3 : 0;
    const double density = 0.75 * body.mass;  // four corners make a mass
    const double modulus = (body.motion == SpringMotion::opening ? 2 : 1) * body.stiffness;
    input.materials = {{.density = density, .E = modulus, .nu = 0}, {.density = density, .E = 0, .nu = 0}};
    input.laws = {body.law, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1, 1}, {1, 1}};
    input.supports = {{.on = {.boundary = "base", .box = {}}, .law = 0, .glued = body.glued}};
    for (const double y : {1.0, -1.0})
        input.loads.push_back({.kind = Load::Kind::displacement,
                               .on = {.boundary = "", .box = Box{Vec2(0.9, y - 0.1), Vec2(1.1, y + 0.1)}},
                               .value = {0.0, 0.0},
                               .history = {}});
    for (const char* end : {"left", "right"}) {  // no springs turn
        const bool opens = body.motion == SpringMotion::opening;
        input.loads.push_back(load(Load::Kind::displacement, end, opens ? std::optional(0.0) : std::nullopt,
                                   opens ? std::nullopt : std::optional(0.0)));
    }
    return input;
}

/// Along the requested motion: {x, y}.
inline std::array<std::optional<double>, 2> along(SpringMotion motion, double value) {
    if (motion == SpringMotion::slip) return {value, std::nullopt};
    return {std::nullopt, value};
}

/// The masses beyond the springs move by `history`.
inline void drive(ModelInput& input, SpringMotion motion, const TimeFunction& history) {
    for (const char* end : {"left", "right"}) {
        const auto value = along(motion, 1);
        input.loads.push_back(load(Load::Kind::displacement, end, value[0], value[1], history));
    }
}

/// A force on each of them.
inline void push(ModelInput& input, SpringMotion motion, const TimeFunction& history) {
    for (const char* end : {"left", "right"}) {
        const auto value = along(motion, 0.5);  // on a length of 2
        input.loads.push_back(load(Load::Kind::traction, end, value[0], value[1], history));
    }
}

/// A constant pressure on each point.
inline void press(ModelInput& input, double pressure) {
    input.loads.push_back(
        {.kind = Load::Kind::body_force,
         .on = {.boundary = "", .box = Box{Vec2(0.9, 0.2), Vec2(1.1, 0.4)}},  // on the triangle above the points
         .value = {0.0, -3 * pressure},
         .history = {}});
}

/// Values of a function at the ends of n steps of h, linear in between.
template <class Function>
TimeFunction sampled(const Function& function, double h, int n) {
    TimeFunction made;
    for (int i = 0; i <= n; ++i) {
        made.time.push_back(i * h);
        made.value.push_back(function(i * h));
    }
    return made;
}

/// What one of the two equal points of the support does (the other must do the same).
class PointView {
public:
    explicit PointView(const Run& run) : run_(run) {
        while (run.model.interfaces[point_ / 2].triangle[0] != rigid_support) point_ += 2;
    }
    double u(SpringMotion motion = SpringMotion::opening) const {
        return motion == SpringMotion::opening ? run_.u(0, 0).y() : run_.u(0, 0).x();
    }
    double v(SpringMotion motion = SpringMotion::opening) const {
        return motion == SpringMotion::opening ? run_.v(0, 0).y() : run_.v(0, 0).x();
    }
    double beta() const { return cohesion(run_.model, run_.now, point_); }
    Vec2 traction() const { return knap::traction(run_.model, run_.now, point_); }
    double asymmetry() const {
        return (run_.u(0, 0) - run_.u(0, 1)).norm() +
               std::abs(cohesion(run_.model, run_.now, point_) - cohesion(run_.model, run_.now, point_ + 1));
    }

private:
    const Run& run_;
    Index point_ = 0;
};

}  // namespace knap::tests
