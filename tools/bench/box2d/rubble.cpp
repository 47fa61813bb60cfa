// Rigid stones fall on a ground in Box2D: rubble STONES GROUND STEP END FRICTION DAMPING DENSITY [UNITS]
// STONES: lines "vx vy spin n x1 y1 x2 y2 ..." of outlines that are simple, counterclockwise; those that are not convex, or
// have more than 8 corners, become triangles. GROUND: lines "x1 y1 x2 y2 ..." of open polylines. SI units. UNITS (1): of
// Box2D in a metre; its skin is 0.01 of them, and overlaps of 0.005 of them stay. It moves nothing by more than 2 in a step.
// Prints as CSV: processor time [s], time at rest [s] (kinetic energy below 1e-6 of its largest value), deepest penetration
// until then and at the end [m], mean x and height at the end [m], energy lost per mass [J/kg].
#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <vector>

namespace {

constexpr float gravity = 9.81f;

using Outline = std::vector<b2Vec2>;

float turn(const b2Vec2& a, const b2Vec2& b, const b2Vec2& c) { return b2Cross(b - a, c - b); }

std::vector<Outline> convex_parts(Outline points) {
    constexpr float no_area = 1e-5f;  // [m2] of two edges that are one
    const auto at = [&](std::size_t i) { return points[i % points.size()]; };
    for (std::size_t i = 0; i < points.size();)
        if (std::abs(turn(at(i), at(i + 1), at(i + 2))) > no_area) ++i;
        else points.erase(points.begin() + static_cast<std::ptrdiff_t>((i + 1) % points.size())), i = 0;
    bool convex = points.size() <= b2_maxPolygonVertices;
    for (std::size_t i = 0; i < points.size(); ++i) convex = convex && turn(at(i), at(i + 1), at(i + 2)) > 0;
    if (convex) return {points};
    std::vector<Outline> parts;
    while (points.size() > 2) {  // cut ears, the widest first
        std::size_t best = points.size();
        float widest = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const b2Vec2 a = at(i), b = at(i + 1), c = at(i + 2);
            const auto is_inside = [&](const b2Vec2& p) {
                return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
            };
            if (turn(a, b, c) > widest && std::none_of(points.begin(), points.end(), is_inside))
                widest = turn(a, b, c), best = i;
        }
        if (best == points.size()) break;
        if (widest > no_area) parts.push_back({at(best), at(best + 1), at(best + 2)});
        points.erase(points.begin() + static_cast<std::ptrdiff_t>((best + 1) % points.size()));
    }
    return parts;
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

/// [J] kinetic, with the work of gravity that is left
struct Energy {
    double kinetic = 0, total = 0;
};
Energy energy(const std::vector<b2Body*>& stones, float units) {
    Energy sum;
    for (const b2Body* s : stones) {
        const float about_centre = s->GetInertia() - s->GetMass() * s->GetLocalCenter().LengthSquared();
        sum.kinetic += 0.5 * (s->GetMass() * s->GetLinearVelocity().LengthSquared() +
                              about_centre * s->GetAngularVelocity() * s->GetAngularVelocity());
        sum.total += s->GetMass() * gravity * units * s->GetWorldCenter().y;
    }
    sum.kinetic /= units * units, sum.total /= units * units;
    sum.total += sum.kinetic;
    return sum;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 8 && argc != 9) return 2;
    const auto number = [&](int i) { return std::strtof(argv[i], nullptr); };
    const float step = number(3), end = number(4), friction = number(5), damping = number(6), density = number(7),
                units = argc > 8 ? number(8) : 1;
    b2World world({0, -gravity * units});
    world.SetAllowSleeping(false);
    const auto add_shape = [&](b2Body* body, const b2Shape& shape) {
        b2FixtureDef fixture;
        fixture.shape = &shape, fixture.density = density / (units * units), fixture.friction = friction;
        body->CreateFixture(&fixture);
    };
    b2BodyDef definition;
    b2Body* ground = world.CreateBody(&definition);
    std::string line;
    for (std::ifstream file(argv[2]); std::getline(file, line);) {
        std::istringstream values(line);
        b2Vec2 a, b;
        for (values >> a.x >> a.y; values >> b.x >> b.y; a = b) {
            b2EdgeShape edge;
            edge.SetTwoSided(units * a, units * b);
            add_shape(ground, edge);
        }
    }
    std::vector<b2Body*> stones;
    for (std::ifstream file(argv[1]); std::getline(file, line);) {
        std::istringstream values(line);
        definition.type = b2_dynamicBody;
        definition.linearDamping = definition.angularDamping = damping;
        b2Vec2 velocity;
        float spin;
        std::size_t n;
        values >> velocity.x >> velocity.y >> spin >> n;
        Outline points(n);
        b2Vec2 middle(0, 0);  // single precision: places relative to it
        for (b2Vec2& p : points) values >> p.x >> p.y, middle += (1.f / static_cast<float>(n)) * p;
        for (b2Vec2& p : points) p -= middle;
        definition.position = units * middle;
        b2Body* body = world.CreateBody(&definition);
        for (Outline part : convex_parts(points)) {
            for (b2Vec2& p : part) p *= units;
            b2PolygonShape shape;
            shape.Set(part.data(), static_cast<int>(part.size()));
            add_shape(body, shape);
        }
        body->SetLinearVelocity(units * velocity), body->SetAngularVelocity(spin);
        stones.push_back(body);
    }
    const double start = energy(stones, units).total;
    double largest = 0, rest = 0;
    float depth = 0;
    double seconds = 0;
    for (float t = 0; t < end; t += step) {
        const std::clock_t before = std::clock();
        world.Step(step, 8, 3);
        seconds += static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
        const double now = energy(stones, units).kinetic;
        largest = std::max(largest, now);
        if (now > 1e-6 * largest) rest = t + step;
        depth = std::max(depth, deepest(world));
    }
    double mass = 0, x = 0, height = 0;
    for (const b2Body* s : stones)
        mass += s->GetMass(), x += s->GetMass() * s->GetWorldCenter().x, height += s->GetMass() * s->GetWorldCenter().y;
    std::printf("%.3g,%.3g,%.3g,%.3g,%.4g,%.4g,%.4g\n", seconds, rest, depth / units, deepest(world) / units,
                x / mass / units, height / mass / units, (start - energy(stones, units).total) / mass);
}
