#pragma once
// Random bodies without mercy: laws, shapes, units, steps and loads far outside of what anybody would simulate on purpose, but legal.
#include "support/obstacle_shapes.hpp"
#include "support/random_bodies.hpp"

#include <numbers>
#include <string>

namespace knap::tests {

inline constexpr double max_strain = 0.2;  // [-] of a run with Green's strain: a larger one changes the stable step

struct WildBody {
    RandomBody body;        // its step is that of the implicit bulk, its velocities are per vertex
    double safety;          // [-] step over the stable one, of the explicit bulk
    double scatter;         // [m/s] of the corners of fans that are in pieces at the start
    double cracking;        // [-] step once cohesion falls, over the largest
    bool from_equilibrium;  // starts at rest under its loads
    int n_steps;            // of the largest step
};

class WildBodies {
public:
    explicit WildBodies(std::uint64_t seed)
        : seed_(seed),
          random_(seed, "wild"),
          pressing_(seed, "press"),
          resisting_(seed, "resist"),
          turning_(seed, "turn"),
          measured_(seed, "measured") {}

    WildBody body() {
        WildBody made{.body = RandomBodies(seed_, {.units = false, .max_cells = 4}).body()};
        stretch(made.body);
        change_laws(made.body);
        close_gaps(made.body.input);
        add_cracks(made.body.input.mesh);
        choose_scheme(made);
        reverse_loads(made);
        press(made);
        resist(made);
        turn(made);
        measure(made);
        in_units(made.body, std::pow(10, random_.uniform(-9, 6)), std::pow(10, random_.uniform(-12, 9)),
                 std::pow(10, random_.uniform(-9, 6)));
        return made;
    }

private:
    bool chance(double part) { return random_.uniform() < part; }
    double one_of(std::initializer_list<double> values) {
        return *(values.begin() + static_cast<int>(random_.uniform(0, static_cast<double>(values.size()))));
    }

    void stretch(RandomBody& body) {
        const double flat = chance(0.3) ? std::pow(10, random_.uniform(-1.5, 0)) : 1;
        for (Vec2& x : body.input.mesh.vertices) x.y() *= flat;
        body.step *= flat;
        body.input.thickness *= std::pow(10, random_.uniform(-3, 3));
    }

    void change_laws(RandomBody& body) {
        CohesiveLaw& law = body.input.laws[0];
        if (chance(0.1)) law.sigma_c = law.G_c = 0;  // rubble
        law.gamma = one_of({0, 1, random_.uniform(0, 3)});
        law.friction = one_of({0, 0.3, random_.uniform(0, 1), std::pow(10, random_.uniform(0, 3))});
        law.restitution = one_of({0, 0, 1, random_.uniform()});
    }

    /// What is glued touches.
    void close_gaps(ModelInput& input) {
        for (Support& support : input.supports)
            if (support.glued) support.gap = 0;
    }

    void add_cracks(Mesh& mesh) {
        const double part = one_of({0, 0, 0.2, 0.6, 1});
        for (InteriorEdge& edge : mesh.interior_edges) edge.cracked = chance(part);
    }

    void choose_scheme(WildBody& made) {
        SchemeOptions& scheme = made.body.scheme;
        const double most = 1 / (1 + made.body.input.laws[0].restitution);
        scheme.bulk = chance(0.5) ? BulkScheme::implicit_theta : BulkScheme::explicit_lumped;
        scheme.cohesion = chance(0.5) ? CohesionScheme::implicit_beta : CohesionScheme::explicit_beta;
        scheme.theta = one_of({0.5, 0.5, most, random_.uniform(0.5, most)});
        if (scheme.bulk == BulkScheme::explicit_lumped) scheme.mass = MassMatrix::lumped;
        made.safety = one_of({1, 0.8, random_.uniform(0.02, 1)});
        made.body.step *= std::pow(10, random_.uniform(-1, 1));
        made.cracking = one_of({1, random_.uniform(0.05, 1)});
        made.from_equilibrium = scheme.bulk == BulkScheme::implicit_theta && chance(0.1);
        made.scatter = one_of({0, 0, 1, 10}) * random_.uniform();
        made.n_steps = 20 + static_cast<int>(random_.uniform(0, 60));
    }

    /// Every load turns some times within the run; displacements are so large that a good part of the bonds fails.
    void reverse_loads(WildBody& made) {
        const ModelInput& input = made.body.input;
        for (Load& load : made.body.input.loads) {
            if (!chance(0.7)) continue;
            const bool by_place = load.kind == Load::Kind::displacement;
            double size = random_.uniform(0, 4), t = 0;
            if (by_place) size *= std::max(input.laws[0].delta_c(), 0.1);
            load.history = {};
            for (int i = 0; i < 8; ++i) {
                load.history.time.push_back(t);
                load.history.value.push_back(by_place && i == 0 ? 0 : size * random_.uniform(-1, 1));
                t += made.body.step * made.n_steps * random_.uniform(0.02, 0.3);
            }
        }
    }

    /// Lasting pressure, with restitution in between: what it closes bounces and comes to rest again and again. The numbers are of a stream of
    /// their own, so that the other bodies stay what they are.
    void press(WildBody& made) {
        if (made.body.scheme.bulk != BulkScheme::explicit_lumped || pressing_.uniform() > 0.15) return;
        ModelInput& input = made.body.input;
        const auto draw_contact = [&](auto& law) {
            law.restitution = pressing_.uniform(0.02, 0.98);
            law.friction = std::max(0.0, pressing_.uniform(-0.3, 1));
        };
        draw_contact(input.laws[0]);
        input.loads.clear();
        input.supports.clear();
        const double pressure =
            std::min(0.1 * input.materials[0].E, std::pow(10, pressing_.uniform(-1, 0.5)));  // the strength is 1
        Obstacle floor = platen({0, 0}, {0, 1});
        draw_contact(floor.contact);
        input.obstacles.push_back(floor);
        input.loads.push_back(load(Load::Kind::traction, "top", std::nullopt, -pressure));
        for (InteriorEdge& edge : input.mesh.interior_edges) edge.cracked = edge.cracked || pressing_.uniform() < 0.7;
        made.scatter = pressing_.uniform(0, 1);
        for (Vec2& v : made.body.velocity) v *= 0.1;
        made.safety = pressing_.uniform(0.5, 1);
        made.n_steps = 200 + static_cast<int>(pressing_.uniform(0, 400));
    }

    /// Large rotations, and often a spin: its speed at a corner is up to twice the others. A stream of its own, too.
    void turn(WildBody& made) {
        if (made.body.scheme.bulk != BulkScheme::explicit_lumped || turning_.uniform() > 0.25) return;
        made.body.input.large_rotation = true;
        const std::vector<Vec2>& vertices = made.body.input.mesh.vertices;
        double fastest = 0, size = 0;
        for (const Vec2& v : made.body.velocity) fastest = std::max(fastest, v.norm());
        for (const Vec2& x : vertices) size = std::max(size, x.norm());
        const double spin = 2 * turning_.uniform(-1, 1) * fastest / size;
        for (std::size_t i = 0; i < vertices.size(); ++i) made.body.velocity[i] += spin * turned_left(vertices[i]);
        made.n_steps *= turning_.uniform() < 0.2 ? 10 : 1;
    }

    /// Damping and absorbing boundaries, also of a stream of their own.
    void resist(WildBody& made) {
        if (made.body.scheme.bulk != BulkScheme::explicit_lumped) return;
        if (resisting_.uniform() < 0.1)
            made.body.scheme.damping = std::pow(10, resisting_.uniform(-3, 1)) / made.body.step;
        ModelInput& input = made.body.input;
        if (resisting_.uniform() < 0.1 && input.supports.empty() && std::ranges::none_of(input.loads, &Load::drives))
            made.body.scheme.absorbing = {{.boundary = "right", .box = {}, .body = {}}};
    }

    /// Laws as they are measured, one of them; also of a stream of their own.
    void measure(WildBody& made) {
        if (measured_.uniform() > 0.2) return;
        ModelInput& input = made.body.input;
        CohesiveLaw& law = input.laws[0];
        const double part = measured_.uniform(), size = measured_.uniform();
        switch (static_cast<int>(measured_.uniform(0, 5))) {
            case 0: {
                const double mu = law.friction + 0.1, bend = std::pow(10, 2 * part - 1);
                made.body.friction_points = {{0, 0},
                                             {bend, mu * bend},
                                             {3 * bend, (1 + 2 * size) * mu * bend},
                                             {9 * bend, (1 + 5 * size) * mu * bend}};
                law.over_pressure = std::make_shared<FrictionOverPressure>(made.body.friction_points);
                law.friction = law.over_pressure->chord(law.sigma_c);
                break;
            }
            case 1:
                law.kinetic_friction = part * law.friction;
                law.slip_distance = std::pow(10, 2 * size - 2);
                break;
            case 2:
                if (law.sigma_c == 0 || law.gamma == 0) return;
                law.friction = 0;
                law.G_II = std::pow(10, 2 * part - 0.5) * law.G_c;
                law.mode_mix = size < 0.5 ? ModeMix::power : ModeMix::benzeggagh_kenane;
                law.mix_exponent = 1 + 2 * measured_.uniform();
                break;
            case 3:
                if (made.body.scheme.bulk == BulkScheme::explicit_lumped) law.unloading = Unloading::vertical;
                break;
            default:
                for (Elastic& material : input.materials)
                    material.bedding = Bedding{.E = std::pow(10, part - 0.5) * material.E,
                                               .nu = 0.3 * part * material.nu,
                                               .G = std::pow(10, part - 0.7) * material.E,
                                               .angle = std::numbers::pi * size};
        }
    }

    std::uint64_t seed_;
    Random random_, pressing_, resisting_, turning_, measured_;
};

}  // namespace knap::tests
