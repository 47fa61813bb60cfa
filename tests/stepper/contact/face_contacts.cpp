// Which vertex touches which edge: bodies set by hand.
#include "support/pieces.hpp"

#include "base/random.hpp"

#include <doctest/doctest.h>

#include <numbers>

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double h = 1e-3;

Mesh block(int n_x, int n_y, double length, double height, const Vec2& at = Vec2::Zero()) {
    Mesh mesh = bar_mesh(n_x, n_y, length, height);
    for (Vec2& x : mesh.vertices) x += at;
    return mesh;
}

}  // namespace

TEST_CASE("a square on a longer block has two contacts at its lower corners") {
    for (const double gap : {0., 1e-4, -1e-4}) {
        const Pieces scene({block(1, 1, 3, 1), block(1, 1, 1, 1, {1.1, 1 + gap})});
        const auto contacts = scene.contacts(h);
        REQUIRE(contacts.size() == 2);
        for (const FaceContact& contact : contacts) {
            CHECK(scene.body_of(contact.vertex[0]) == 1);
            CHECK(scene.body_of(contact.edge[0]) == 0);
            CHECK(contact.gap == doctest::Approx(gap).epsilon(1e-12));
            CHECK((contact.normal - Vec2(0, 1)).norm() < 1e-14);
            CHECK(contact.length == doctest::Approx(3));
        }
        CHECK(contacts[0].share + contacts[1].share == doctest::Approx(2 - 3.2 / 3).epsilon(1e-12));
    }
}

TEST_CASE("squares stacked flush touch at two corners and not at four") {
    for (const double offset : {0., 1e-9, -1e-9, 0.01, -0.01, 0.3}) {
        CAPTURE(offset);
        const Pieces scene({block(1, 1, 1, 1), block(1, 1, 1, 1, {offset, 1})});
        CHECK(scene.contacts(h).size() == 2);
    }
    // with three edges a side, the nodes of both bodies in a row: one contact a node
    const Pieces fine({block(3, 3, 1, 1), block(3, 3, 1, 1, {0, 1})});
    CHECK(fine.contacts(h).size() == 4);
    // displaced by half an edge: of six vertices that face an edge as many stay as are independent
    const Pieces shifted({block(3, 3, 1, 1), block(3, 3, 1, 1, {1. / 6, 1})});
    CHECK(shifted.contacts(h).size() == 5 - 1);
}

namespace {

/// A random star-shaped polygon of n corners; radius 0.5 to 1 times `size`.
std::vector<Vec2> random_outline(Random& random, int n, double size, const Vec2& at) {
    std::vector<Vec2> outline;
    for (int i = 0; i < n; ++i)
        outline.push_back(at + size * random.uniform(0.5, 1) *
                                   turned({1, 0}, 2 * std::numbers::pi * (i + 0.8 * random.uniform(0, 1)) / n));
    return outline;
}

/// Bodies on a jittered lattice, so near that some overlap a little, with random velocities and rotations.
Pieces random_rubble(std::uint64_t seed, int n_x, int n_y) {
    Random random(seed, "rubble");
    std::vector<Mesh> bodies;
    for (int i = 0; i < n_x; ++i)
        for (int j = 0; j < n_y; ++j)
            bodies.push_back(star_mesh(random_outline(random, 5 + static_cast<int>(random.uniform(0, 5)), 0.7,
                                                      {i + random.uniform(0, 0.1), j + random.uniform(0, 0.1)})));
    Pieces scene(bodies);
    for (Index b = 0; b < Index(bodies.size()); ++b)
        scene.put(b, {random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05)}, random.uniform(-3, 3),
                  bodies[b].vertices.back(), {random.uniform(-5, 5), random.uniform(-5, 5)}, random.uniform(-5, 5));
    return scene;
}

bool equal(const FaceContact& a, const FaceContact& b) {
    const auto values = [](const FaceContact& c) {
        return std::array{c.normal.x(), c.normal.y(), c.length, c.share, c.gap, c.contact, c.tangential};
    };
    return a.vertex == b.vertex && a.edge == b.edge && values(a) == values(b);
}
bool equal(const std::vector<FaceContact>& a, const std::vector<FaceContact>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) { return equal(x, y); });
}

}  // namespace

TEST_CASE("unit impulses of a contact have no resultant and no moment") {
    int n = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Pieces scene = random_rubble(seed, 9, 9);
        for (const FaceContact& contact : scene.contacts(h)) {
            const auto [n_, t] = std::pair{contact.normal, turned_left(contact.normal)};
            const Vec2 a = scene.place(contact.edge[0]), b = scene.place(contact.edge[1]);
            CHECK((b - a - contact.length * t).norm() < 1e-14);
            for (const Vec2& p : {Vec2(1, 0), Vec2(0, 1)}) {
                const Vec2 force = p.x() * n_ + p.y() * t, couple = contact.gap / contact.length * p.y() * n_;
                const Vec2 on_a = -(1 - contact.share) * force - couple, on_b = -contact.share * force + couple;
                Vec2 sum = on_a + on_b;
                double moment = cross(a, on_a) + cross(b, on_b);
                for (const Index corner : contact.vertex)
                    sum += force / 2, moment += cross(scene.place(corner), force / 2);
                CHECK(sum.norm() < 1e-14);
                CHECK(std::abs(moment) < 2e-14);
            }
            ++n;
        }
    }
    CHECK(n > 100);
}

TEST_CASE("the list of contacts does not depend on the list of candidates") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Pieces scene = random_rubble(seed, 5, 5);
        FaceContacts lasting(scene.model);
        Random random(seed, "rubble");
        for (int step = 0; step < 40; ++step) {
            lasting.find(scene.state, h);
            const auto anew = scene.contacts(h);
            REQUIRE(equal({lasting.all().begin(), lasting.all().end()}, anew));
            for (std::size_t i = 0; i < scene.state.displacement.size(); ++i)
                scene.state.displacement[i] += h * scene.state.velocity[i];
        }
    }
}
