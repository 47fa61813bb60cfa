#pragma once
// Random scenes of small bodies that fly, spin and fall into each other, break and slide: large rotations and contact
// between all free faces. Sizes, densities and wave speeds are of order 1.
#include "base/random.hpp"
#include "stepper/common/step_scheme.hpp"
#include "support/bodies.hpp"
#include "support/obstacle_shapes.hpp"
#include "support/overlap.hpp"
#include "support/pieces.hpp"

#include <numbers>

namespace knap::tests {

struct FlyingBody {
    bool star;             // a polygon round its centre; else a bar of cells
    int n_x, n_y;          // cells of a bar; n_x: corners of a star
    double width, height;  // [m]
    double roughness;      // [-] of a cell: how far vertices are moved
    std::uint64_t seed;    // of these moves
    Vec2 place;            // [m] of its middle
    double angle;          // [rad]
    Vec2 velocity;         // [m/s]
    double spin;           // [rad/s]
    double density, E;     // [kg/m3], [Pa]
};

enum class Floor { none, half_plane, tilted, polygon, free_disc };

struct FlyingScene {
    std::vector<FlyingBody> bodies;
    CohesiveLaw law;
    ContactLaw contact;
    bool implicit_cohesion = false;
    double cracked = 0;               // [-] part of the interfaces without cohesion from the start
    double scatter = 0;               // [m/s] of the corners of fans that are split from the start
    double gravity = 0, damping = 0;  // [m/s2], [1/s]
    Floor floor = Floor::none;
    double safety = 0.8, fastest = 0;  // [-] of the stable step; [m/s] at the start
    int n_steps = 0;
    double rigid_step = 0;  // [-] over that of the deformable body; 0: its pieces are never rigid
    RigidOptions rigid;

    bool unbreakable() const { return !law.breakable() && cracked == 0; }
};

inline Mesh mesh_of(const FlyingBody& body) {
    Random random(body.seed, "rough");
    const auto moved = [&] {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        return Vec2(x, y);
    };
    Mesh mesh;
    if (body.star) {
        std::vector<Vec2> outline;
        for (int i = 0; i < body.n_x; ++i)
            outline.push_back(turned({0.5 * (1 + body.roughness * random.uniform(-1.5, 1)), 0},
                                     2 * std::numbers::pi * (i + body.roughness * random.uniform(-1, 1)) / body.n_x));
        mesh = star_mesh(outline);
        for (Vec2& x : mesh.vertices) x = {body.width * x.x(), body.height * x.y()};
    } else {
        mesh = bar_mesh(body.n_x, body.n_y, body.width, body.height);
        const Vec2 middle(0.5 * body.width, 0.5 * body.height), cell(body.width / body.n_x, body.height / body.n_y);
        for (Vec2& x : mesh.vertices) x += body.roughness * cell.cwiseProduct(moved()) - middle;
    }
    for (Vec2& x : mesh.vertices) x = body.place + turned(x, body.angle);
    return mesh;
}

/// Whether triangles of two bodies overlap.
inline bool overlap(const Mesh& a, const Mesh& b) {
    const auto corners = [](const Mesh& mesh, Index t) {
        return std::array{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    };
    for (Index i = 0; i < a.n_triangles(); ++i)
        for (Index j = 0; j < b.n_triangles(); ++j)
            if (overlap(corners(a, i), corners(b, j)) > 0) return true;
    return false;
}

class FlyingScenes {
public:
    explicit FlyingScenes(std::uint64_t seed) : seed_(seed), random_(seed, "flying") {}

    /// The same bodies and laws, as rigid pieces while nothing can break.
    FlyingScene rigid_scene() {
        FlyingScene made = scene();
        if (made.law.over_pressure) made.law.over_pressure = nullptr, made.contact.changing = -1;
        random_ = Random(seed_, "rigid");
        made.rigid_step = std::pow(10, random_.uniform(0, 2));
        made.rigid.thaw = one_of({0.3, 0.3, std::pow(10, random_.uniform(-2, 1))});
        made.rigid.hold = std::pow(10, random_.uniform(0, 1.3));
        made.rigid.smallest = chance(0.3) ? random_.uniform(0, 1) : 0;
        made.rigid.sleep = chance(0.5) ? 0.1 * made.fastest * random_.uniform() : 0;
        made.rigid.restitution = one_of({0.0, 0.9, random_.uniform()});
        made.contact.gives_restitution = chance(0.5);
        return made;
    }

    FlyingScene scene() {
        FlyingScene made;
        const int layout = whole(0, 5);  // 0: a wall of flush blocks; else bodies apart
        made.fastest = chance(0.1) ? 0 : std::pow(10, random_.uniform(-3, -0.8));
        if (layout == 0) add_wall(made);
        else add_flight(made);
        draw_laws(made);
        change_friction(made);
        if (chance(0.4))
            made.floor =
                one_of({Floor::half_plane, Floor::half_plane, Floor::tilted, Floor::polygon, Floor::free_disc});
        if (chance(0.4)) made.gravity = std::pow(10, random_.uniform(-5, -1.5));
        if (chance(0.15)) made.damping = std::pow(10, random_.uniform(-2, 1));
        made.safety = one_of({0.8, 0.5, random_.uniform(0.05, 1)});
        made.n_steps = whole(100, 600);
        return made;
    }

private:
    bool chance(double part) { return random_.uniform() < part; }
    int whole(int low, int end) { return static_cast<int>(random_.uniform(low, end)); }
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return *(values.begin() + whole(0, static_cast<int>(values.size())));
    }
    Vec2 vector(double size) {
        const double x = random_.uniform(-size, size), y = random_.uniform(-size, size);
        return {x, y};
    }

    FlyingBody body() {
        FlyingBody made{};
        made.star = chance(0.3);
        made.n_x = made.star ? whole(3, 9) : whole(1, 4), made.n_y = whole(1, 4);
        const double size = std::pow(2, random_.uniform(-2, 1));
        made.width = size, made.height = size * one_of({1.0, random_.uniform(0.15, 1)});
        made.roughness = chance(0.3) ? 0 : random_.uniform(0, 0.3);
        made.seed = random_.bits();
        made.density = chance(0.2) ? std::pow(10, random_.uniform(-2, 2)) : 1;
        made.E = chance(0.2) ? std::pow(10, random_.uniform(-1, 1)) : 1;
        return made;
    }

    /// Towards a common middle, each as near as there is a place for it in a random direction.
    void add_flight(FlyingScene& made) {
        const int n = whole(1, 7);
        std::vector<Mesh> placed;
        for (int i = 0; i < n; ++i) {
            FlyingBody one = body();
            one.angle = chance(0.2) ? 0 : random_.uniform(0, 2 * std::numbers::pi);
            const Vec2 direction = turned({1, 0}, random_.uniform(0, 2 * std::numbers::pi));
            const double size = std::max(one.width, one.height), step = size * std::pow(10, random_.uniform(-4, -1));
            const auto fits = [&](double away) {
                one.place = away * direction;
                const Mesh mesh = mesh_of(one);
                return std::ranges::none_of(placed, [&](const Mesh& other) { return overlap(mesh, other); });
            };
            double away = 0;
            while (!fits(away)) away += 0.1 * size;
            while (away > step && fits(away - step)) away -= step;
            fits(away);
            one.velocity = made.fastest * (0.3 * vector(1) - direction);
            one.spin = chance(0.3) ? 0 : made.fastest / size * random_.uniform(-1, 1);
            placed.push_back(mesh_of(one));
            made.bodies.push_back(one);
        }
    }

    /// Rows of blocks whose faces coincide, and one that flies into them.
    void add_wall(FlyingScene& made) {
        const int rows = whole(1, 4), columns = whole(1, 3);
        FlyingBody block = body();
        block.star = false, block.roughness = 0;
        const double gap = chance(0.7) ? 0 : 1e-3 * block.width, shift = chance(0.5) ? 0 : 0.5;
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
                block.place = {(i + (j % 2) * shift) * (block.width + gap), j * (block.height + gap)};
                block.n_x = whole(1, 4), block.n_y = whole(1, 3);
                made.bodies.push_back(block);
            }
        if (made.fastest == 0) return;
        FlyingBody one = body();
        const double radius = 0.75 * std::hypot(one.width, one.height);
        one.place = {-0.5 * block.width - radius, random_.uniform(0, rows * block.height)};
        one.angle = random_.uniform(0, 2 * std::numbers::pi);
        one.velocity = made.fastest * Vec2(1, random_.uniform(-0.3, 0.3));
        one.spin = made.fastest / radius * random_.uniform(-1, 1);
        made.bodies.push_back(one);
    }

    void draw_laws(FlyingScene& made) {
        CohesiveLaw& law = made.law;
        law = CohesiveLaw::unbreakable();
        if (chance(0.75)) {
            law.sigma_c = std::pow(10, random_.uniform(-4, -1));
            law.G_c = 0.5 * law.sigma_c * std::pow(10, random_.uniform(-4, -1));
            if (chance(0.1)) law.sigma_c = law.G_c = 0;
            made.cracked = one_of({0.0, 0.0, 0.3, 1.0});
            made.scatter = made.cracked > 0 && chance(0.5) ? made.fastest * random_.uniform() : 0;
        }
        law.gamma = one_of({0.0, 1.0, random_.uniform(0, 3)});
        law.friction = one_of({0.0, 0.3, random_.uniform(0, 1)});
        law.restitution = one_of({0.0, 0.0, 1.0, random_.uniform()});
        made.contact.friction = one_of({0.0, law.friction, random_.uniform(0, 1), std::pow(10, random_.uniform(0, 1))});
        made.contact.restitution = one_of({0.0, 0.0, 1.0, random_.uniform()});
        made.implicit_cohesion = chance(0.15);
    }

    /// Friction over pressure or over slip, of a stream of their own.
    void change_friction(FlyingScene& made) const {
        Random random(seed_, "friction");
        if (random.uniform() > 0.3) return;
        CohesiveLaw& law = made.law;
        const double size = std::pow(10, random.uniform(-4, -1)), part = random.uniform();
        if (random.uniform() < 0.5) {
            const double mu = law.friction + 0.1;
            law.over_pressure = std::make_shared<FrictionOverPressure>(
                std::vector<Vec2>{{0, 0}, {size, mu * size}, {3 * size, (1 + 2 * part) * mu * size}});
            law.friction = law.over_pressure->chord(law.sigma_c);
        } else {
            law.kinetic_friction = part * law.friction;
            law.slip_distance = size;
        }
        made.contact.changing = 0;
    }

    std::uint64_t seed_;
    Random random_;
};

inline ModelInput input_of(const FlyingScene& scene) {
    ModelInput input;
    Mesh& mesh = input.mesh;
    Vec2 low = Vec2::Constant(1e9), high = -low;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const FlyingBody& body = scene.bodies[b];
        const Mesh part = mesh_of(body);
        const Index first = mesh.n_vertices();
        for (const Vec2& x : part.vertices) {
            mesh.vertices.push_back(x);
            low = low.cwiseMin(x), high = high.cwiseMax(x);
        }
        for (const auto& [i, j, k] : part.triangles) mesh.triangles.push_back({first + i, first + j, first + k});
        mesh.region.insert(mesh.region.end(), part.triangles.size(), static_cast<Index>(b));
        input.materials.push_back({.density = body.density, .E = body.E, .nu = 0.2});
    }
    mesh.boundary_names = {"free"};
    find_edges(mesh);
    Random random(1, "cracks");
    for (InteriorEdge& edge : mesh.interior_edges) edge.cracked = random.uniform() < scene.cracked;
    input.laws = {scene.law};
    const std::size_t n = scene.bodies.size();
    input.law_of_pair.assign(n, std::vector<Index>(n, 0));
    input.contact_of_pair.assign(n, std::vector<ContactLaw>(n, scene.contact));
    input.large_rotation = true;
    if (scene.gravity > 0) input.loads = {{.kind = Load::Kind::acceleration, .on = {}, .value = {0, -scene.gravity}}};
    const ContactLaw touch{.friction = scene.contact.friction, .restitution = scene.contact.restitution};
    const Vec2 below(0.5 * (low.x() + high.x()), low.y());
    const double width = high.x() - low.x();
    switch (scene.floor) {
        case Floor::none: break;
        case Floor::half_plane: input.obstacles = {platen(below, {0, 1}, touch)}; break;
        case Floor::tilted: input.obstacles = {platen(below - Vec2(0, 0.3 * width), {0.5, 1}, touch)}; break;
        case Floor::polygon:
            input.obstacles = {polygon(
                {below + Vec2(-0.3 * width, -0.5), below + Vec2(0.2 * width, -0.4), below - Vec2(0.1 * width, 0.01)},
                touch)};
            break;
        case Floor::free_disc:
            input.obstacles = {boulder(below - Vec2(0, 0.51), 0.5, {0, scene.fastest}, touch)};
            break;
    }
    return input;
}

}  // namespace knap::tests
