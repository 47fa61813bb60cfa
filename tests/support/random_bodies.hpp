#pragma once
// Random small bodies in random motion: a few triangles, interior vertices included, every edge an interface or some of them unbreakable,
// perhaps on a support, perhaps driven; random laws, loads and velocities. Strength, density and size are of order 1.
#include "base/random.hpp"
#include "support/bodies.hpp"

#include <algorithm>
#include <cmath>

namespace knap::tests {

struct RandomBodyOptions {
    bool friction = true, tangential = true, restitution = true;
    bool driven = true, support = true, unbreakable = true;
    bool units = true;  // any units of length, mass and time
    int max_cells = 3;  // each way, of two triangles
    Index order = 1;    // of the triangles
    std::shared_ptr<const SofteningShape> softening = nullptr;
    double delay = 0;            // relaxation time of the laws over the step
    bool over_pressure = false;  // friction has a polygon over the pressure
    bool secant = false;         // unloading, with explicit beta
    double longest = 1.2;        // step, as a part of what Assumption 1 asks of the smallest triangle alone
};

struct RandomBody {
    ModelInput input;
    std::vector<Vec2> velocity;  // [m/s] per vertex
    SchemeOptions scheme;
    double step;                        // [s] a part of what Assumption 1 asks of a single triangle
    std::vector<Vec2> friction_points;  // [Pa] of friction over pressure
};

/// The same obstacle with numbers that are larger by these factors of length, mass and time.
inline void in_units(Obstacle& obstacle, double length, double mass, double time) {
    for (Vec2& p : obstacle.outline.points) p *= length;
    obstacle.outline.radius *= length;
    obstacle.start.position *= length;
    obstacle.mass *= mass;
    obstacle.inertia *= mass * length * length;
    for (int k = 0; k < 3; ++k) {
        const double way = k < 2 ? length : 1;
        obstacle.initial_velocity[k] *= way / time;
        obstacle.drive[k].value *= obstacle.drive[k].kind == Drive::Kind::velocity ? way / time : way;
        for (double& t : obstacle.drive[k].history.time) t *= time;
        for (ObstacleForce& force : obstacle.forces) force.value[k] *= mass * length * way / (time * time);
    }
    for (ObstacleForce& force : obstacle.forces)
        for (double& t : force.history.time) t *= time;
}

/// The same body with numbers that are larger by these factors of length, mass and time.
inline void in_units(RandomBody& made, double length, double mass, double time) {
    const double pressure = mass / (length * time * time), speed = length / time;
    ModelInput& input = made.input;
    for (Vec2& x : input.mesh.vertices) x *= length;
    input.thickness *= length;
    for (Elastic& material : input.materials) material.density *= mass / std::pow(length, 3), material.E *= pressure;
    for (Elastic& material : input.materials)
        if (material.bedding) material.bedding->E *= pressure, material.bedding->G *= pressure;
    input.laws[0].sigma_c *= pressure;
    input.laws[0].G_c *= pressure * length;
    input.laws[0].G_II *= pressure * length;
    input.laws[0].slip_distance *= length;
    for (Vec2& point : made.friction_points) point *= pressure;
    if (!made.friction_points.empty())
        input.laws[0].over_pressure = std::make_shared<FrictionOverPressure>(made.friction_points);
    for (CohesiveLaw& law : input.laws) law.relaxation_time *= time;
    for (Support& support : input.supports) support.gap *= length;
    for (Load& each : input.loads) {
        double unit = 1;
        if (each.kind == Load::Kind::traction) unit = pressure;
        if (each.kind == Load::Kind::body_force) unit = pressure / length;
        if (each.kind == Load::Kind::velocity) unit = speed;
        if (each.kind == Load::Kind::displacement) unit = length;
        for (auto& value : each.value)
            if (value) *value *= unit;
        for (double& t : each.history.time) t *= time;
    }
    for (Obstacle& obstacle : input.obstacles) in_units(obstacle, length, mass, time);
    for (Vec2& v : made.velocity) v *= speed;
    made.step *= time;
    made.scheme.damping /= time;
}

class RandomBodies {
public:
    RandomBodies(std::uint64_t seed, const RandomBodyOptions& options = {})
        : random_(seed, "body"), options_(options) {}

    RandomBody body() {
        RandomBody made;
        make_mesh(made.input);
        make_laws(made);
        make_loads(made);
        make_step(made);
        if (options_.units) change_units(made);
        return made;
    }

private:
    bool chance(double part) { return random_.uniform() < part; }
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return *(values.begin() + static_cast<int>(random_.uniform(0, static_cast<double>(values.size()))));
    }

    void make_mesh(ModelInput& input) {
        const int n_x = 1 + static_cast<int>(random_.uniform(0, options_.max_cells)),
                  n_y = 1 + static_cast<int>(random_.uniform(0, options_.max_cells));
        input.mesh = bar_mesh(n_x, n_y, n_x, n_y);
        input.mesh.order = options_.order;
        for (Vec2& x : input.mesh.vertices)
            if (x.y() > 0) {  // the bottom stays straight, for the support
                const double dx = random_.uniform(-0.25, 0.25), dy = random_.uniform(-0.25, 0.25);
                x += Vec2(dx, dy);
            }
        const int n_regions = options_.unbreakable && chance(0.3) ? 2 : 1;
        for (Index& region : input.mesh.region) region = n_regions == 2 && chance(0.6) ? 1 : 0;
        input.thickness = one_of({1.0, 0.5});
    }

    void make_laws(RandomBody& made) {
        CohesiveLaw law{.sigma_c = 1,
                        .G_c = std::pow(10, random_.uniform(-2, 0)),
                        .gamma = 0,
                        .friction = 0,
                        .restitution = 0,
                        .softening = options_.softening};
        if (options_.tangential) law.gamma = one_of({0.0, 1.0, random_.uniform(0, 2)});
        if (options_.friction) law.friction = one_of({0.0, 0.3, random_.uniform(0, 1)});
        if (options_.restitution) law.restitution = one_of({0.0, 0.5, random_.uniform(0, 1)});
        const double most = 1 / (1 + law.restitution);
        made.scheme.bulk = BulkScheme::implicit_theta;
        made.scheme.theta = one_of({0.5, 0.5, random_.uniform(0.5, most)});
        made.scheme.cohesion = chance(0.75) ? CohesionScheme::implicit_beta : CohesionScheme::explicit_beta;
        made.scheme.mass = chance(0.7) ? MassMatrix::lumped : MassMatrix::consistent;
        if (options_.secant) law.unloading = Unloading::secant, made.scheme.cohesion = CohesionScheme::explicit_beta;
        ModelInput& input = made.input;
        input.materials.assign(2, {.density = 1, .E = one_of({1.0, 10.0, 100.0}), .nu = random_.uniform(0, 0.4)});
        input.plane = chance(0.5) ? PlaneModel::strain : PlaneModel::stress;
        if (options_.over_pressure) {
            const double mu = law.friction + 0.2, bend = one_of({0.1, 0.3, 1.0});
            made.friction_points = {{0, 0}, {bend, mu * bend}, {3 * bend, 2 * mu * bend}, {9 * bend, 3 * mu * bend}};
            law.over_pressure = std::make_shared<FrictionOverPressure>(made.friction_points);
            law.friction = law.over_pressure->chord(law.sigma_c);
        }
        input.laws = {law, CohesiveLaw::unbreakable()};
        input.law_of_pair = {{0, 0}, {0, 1}};  // the second region does not break inside
    }

    void make_loads(RandomBody& made) {
        ModelInput& input = made.input;
        if (options_.support && chance(0.4))
            input.supports = {{.on = {.boundary = "bottom", .box = {}},
                               .law = 0,
                               .glued = chance(0.6),
                               .gap = chance(0.3) ? 0.01 : 0}};
        const auto number = [&](double size) { return random_.uniform(-size, size); };
        if (chance(0.5))
            input.loads.push_back(
                load(Load::Kind::traction, one_of({"left", "right", "top"}), number(1), number(1), {{0, 2}, {0.5, 1}}));
        if (chance(0.3)) input.loads.push_back(load(Load::Kind::body_force, "", number(1), number(1)));
        if (options_.driven && chance(0.3)) {
            std::optional<double> x, y;
            if (chance(0.7)) x = number(0.3);
            if (!x || chance(0.5)) y = number(0.3);
            const bool by_place = chance(0.5);
            const TimeFunction history =
                by_place ? TimeFunction{{0, 0.05, 5}, {0, 0.02, 3}} : TimeFunction{{0, 1}, {0.2, 1}};
            input.loads.push_back(load(by_place ? Load::Kind::displacement : Load::Kind::velocity,
                                       one_of({"left", "right", "top"}), x, y, history));
        }
    }

    void make_step(RandomBody& made) {
        const ModelInput& input = made.input;
        const CohesiveLaw& law = input.laws[0];
        double least = 1e300, mass = 1e300;  // of 1/kappa
        for (Index t = 0; t < input.mesh.n_triangles(); ++t) {
            // mass over area of the points: 1/3 over 1/2 of the edge, or 2/15 over 4/6 in its middle
            const double m = input.mesh.area(t) * input.thickness / 3 * (options_.order == 1 ? 1 : 0.3);
            for (Index k = 0; k < 3; ++k) {
                const double S =
                    0.5 * input.thickness * (input.mesh.corner(t, k) - input.mesh.corner(t, (k + 1) % 3)).norm();
                least = std::min(
                    least, std::sqrt(m * law.softening_length() / (4 * law.sigma_c * S * (1 + law.gamma * law.gamma))));
            }
            mass = std::min(mass, m);
        }
        made.step = least * random_.uniform(0.05, options_.longest) / made.scheme.theta;
        for (CohesiveLaw& each : made.input.laws) each.relaxation_time = options_.delay * made.step;
        // velocities that break some of the bonds in a few steps, others not
        const double speed = one_of({0.0, 0.3, 1.0, 3.0}) * law.sigma_c * made.step;
        for (std::size_t i = 0; i < input.mesh.vertices.size(); ++i) {
            const double x = random_.uniform(-1, 1), y = random_.uniform(-1, 1);
            made.velocity.push_back(speed * Vec2(x, y) / std::sqrt(mass));
        }
    }

    void change_units(RandomBody& made) {
        const double length = std::pow(10, random_.uniform(-3, 3)), mass = std::pow(10, random_.uniform(-3, 3));
        const double time = std::pow(10, random_.uniform(-3, 3));
        in_units(made, length, mass, time);
    }

    Random random_;
    RandomBodyOptions options_;
};

}  // namespace knap::tests
