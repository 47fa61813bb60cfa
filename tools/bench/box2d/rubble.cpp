// The stones of a file (lines "n x1 y1 x2 y2 ...") fall into a box of a given width, in Box2D: rubble STONES WIDTH STEP END
// Prints as CSV: processor time [s], time at rest [s], deepest penetration until then and at the end [m], mean height at
// the end [m].
#include <box2d/box2d.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

namespace {

constexpr float friction = 0.5f, damping = 2;  // [-], [1/s] as in the scenario

b2Body* add(b2World& world, b2BodyType type, const b2Shape& shape, float density) {
    b2BodyDef definition;
    definition.type = type;
    definition.linearDamping = definition.angularDamping = damping;
    b2Body* body = world.CreateBody(&definition);
    b2FixtureDef fixture;
    fixture.shape = &shape;
    fixture.density = density;
    fixture.friction = friction;
    body->CreateFixture(&fixture);
    return body;
}

void add_wall(b2World& world, const b2Vec2& a, const b2Vec2& b) {
    b2EdgeShape edge;
    edge.SetTwoSided(a, b);
    add(world, b2_staticBody, edge, 0);
}

/// [m] Largest overlap of two shapes without their skins.
float deepest(b2World& world) {
    float depth = 0;
    for (b2Contact* c = world.GetContactList(); c; c = c->GetNext()) {
        b2WorldManifold manifold;
        c->GetWorldManifold(&manifold);
        for (int i = 0; i < c->GetManifold()->pointCount && c->IsTouching(); ++i)
            depth = std::max(depth, -manifold.separations[i] - c->GetFixtureA()->GetShape()->m_radius -
                                        c->GetFixtureB()->GetShape()->m_radius);
    }
    return depth;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) return 2;
    const float width = std::strtof(argv[2], nullptr), step = std::strtof(argv[3], nullptr),
                end = std::strtof(argv[4], nullptr);
    b2World world({0, -9.81f});
    world.SetAllowSleeping(false);
    add_wall(world, {-1, 0}, {width + 1, 0});
    add_wall(world, {0, -1}, {0, 20});
    add_wall(world, {width, -1}, {width, 20});
    std::vector<b2Body*> stones;
    std::ifstream file(argv[1]);
    for (int n; file >> n;) {
        std::vector<b2Vec2> points(n);
        for (b2Vec2& p : points) file >> p.x >> p.y;
        b2PolygonShape shape;
        shape.Set(points.data(), n);
        stones.push_back(add(world, b2_dynamicBody, shape, 2400));
    }
    const auto kinetic = [&] {
        double sum = 0;
        for (const b2Body* s : stones) {
            const float about_centre = s->GetInertia() - s->GetMass() * s->GetLocalCenter().LengthSquared();
            sum += 0.5 * (s->GetMass() * s->GetLinearVelocity().LengthSquared() +
                          about_centre * s->GetAngularVelocity() * s->GetAngularVelocity());
        }
        return sum;
    };
    double largest = 0, rest = 0;
    float depth = 0;
    const std::clock_t start = std::clock();
    for (float t = 0; t < end; t += step) {
        world.Step(step, 8, 3);
        const double now = kinetic();
        largest = std::max(largest, now);
        if (now > 1e-6 * largest) rest = t + step;
        depth = std::max(depth, deepest(world));
    }
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    double mass = 0, height = 0;
    for (const b2Body* s : stones) mass += s->GetMass(), height += s->GetMass() * s->GetWorldCenter().y;
    std::printf("%.3g,%.3g,%.3g,%.3g,%.4g\n", seconds, rest, depth, deepest(world), height / mass);
}
