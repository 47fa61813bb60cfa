// Which vertex touches which edge: bodies set by hand.
#include "support/pieces.hpp"

#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>
#include <omp.h>

#include <map>
#include <numbers>
#include <set>

namespace face_contacts_test {

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
            CHECK(contact.gap == relative(gap, 1e-12));
            CHECK((contact.normal - Vec2(0, 1)).norm() < 1e-14);
            CHECK(contact.length == relative(3));
        }
        CHECK(contacts[0].share + contacts[1].share == relative(2 - 3.2 / 3, 1e-12));
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

namespace {

/// Contacts between the bodies, without the body's own.
int n_between(const Pieces& scene, const std::vector<FaceContact>& contacts) {
    return int(std::ranges::count_if(
        contacts, [&](const FaceContact& c) { return scene.body_of(c.vertex[0]) != scene.body_of(c.edge[0]); }));
}

/// One triangle with its tip down at `tip`.
Mesh tip(const Vec2& at, double half_width, double height) {
    Mesh mesh;
    mesh.vertices = {at, at + Vec2(half_width, height), at + Vec2(-half_width, height)};
    mesh.triangles = {{0, 1, 2}};
    mesh.region = {0};
    return mesh;
}

/// A block whose upper side has these points, from right to left, over a base at y = -1.
Mesh terrain(const std::vector<Vec2>& upper) {
    Mesh mesh;
    for (const Vec2& x : upper) mesh.vertices.push_back(x);
    const Index n = static_cast<Index>(upper.size());
    for (const Vec2& x : upper) mesh.vertices.push_back({x.x(), -1});
    for (Index i = 0; i + 1 < n; ++i) {
        mesh.triangles.push_back({i, i + 1, n + i + 1});
        mesh.triangles.push_back({i, n + i + 1, n + i});
    }
    mesh.region.assign(mesh.triangles.size(), 0);
    return mesh;
}

}  // namespace

TEST_CASE("squares corner to corner touch along the plane with the larger gap") {
    // the upper square lies across the upper right or left corner of the lower one, d_x beside and d_y above it
    for (const double side : {1., -1.})
        for (const Vec2& d : {Vec2(-0.002, 0.001), Vec2(0.001, -0.002), Vec2(-0.002, -0.0005), Vec2(-0.0005, -0.002),
                              Vec2(0.0005, 0.001)}) {
            CAPTURE(d.x());
            CAPTURE(d.y());
            Pieces scene({block(1, 1, 1, 1), block(1, 1, 1, 1, {side > 0 ? 1 + d.x() : -1 - d.x(), 1 + d.y()})});
            scene.put(1, {0, 0}, 0, {0, 0}, {-side, -1});
            const auto contacts = scene.contacts(h);
            REQUIRE(contacts.size() == 1);
            const FaceContact& contact = contacts[0];
            const double sign = scene.body_of(contact.vertex[0]) == 1 ? 1 : -1;
            const bool upright = d.y() > d.x();
            CHECK((sign * contact.normal - (upright ? Vec2(0, 1) : Vec2(side, 0))).norm() < 1e-12);
            CHECK(contact.gap == relative(std::max(d.x(), d.y()), 1e-9));
        }
}

TEST_CASE("a tip that slides over flat and convex and reflex corners keeps one gap without jumps") {
    struct Case {
        std::vector<Vec2> upper;
        int most;  // contacts at a time
    };
    const Case cases[] = {{{{2, 0}, {1, 0}, {0, 0}}, 1},
                          {{{2, -0.3}, {1, 0}, {0, -0.3}}, 1},
                          {{{2, 0.3}, {1, 0}, {0, 0.3}}, 2},
                          {{{2, 0.01}, {1, 0}, {0, 0}}, 1},
                          {{{2, -0.01}, {1, 0}, {0, 0}}, 1}};
    for (const auto& [upper, most] : cases)
        for (const double depth : {2e-4, 0.02})
            for (const double tilt : {0., 0.2}) {
                CAPTURE(upper[0].y());
                CAPTURE(depth);
                Pieces scene({terrain(upper), tip({0, 0}, 0.3, 0.5)});
                double last = 0;
                for (int i = 0; i <= 1000; ++i) {
                    const double x = 0.5 + 1e-3 * i,
                                 slope = x < 1 ? upper[1].y() - upper[2].y() : upper[0].y() - upper[1].y();
                    const double y = upper[1].y() + slope * (x - 1), below = depth * std::sqrt(1 + slope * slope);
                    const double turn = tilt * (i / 500. - 1);
                    scene.put(1, {x, y - below}, turn, {0, 0}, {1, slope});
                    if (i == 0) {  // has come from above
                        scene.put(1, {x, y}, turn, {0, 0}, {1, slope});
                        scene.remember(scene.contacts(h));
                        scene.put(1, {x, y - below}, turn, {0, 0}, {1, slope});
                    }
                    const auto contacts = scene.contacts(h);
                    REQUIRE(contacts.size() >= 1);
                    CHECK(int(contacts.size()) <= most);
                    double gap = 1e300;
                    for (const FaceContact& contact : contacts) gap = std::min(gap, contact.gap);
                    if (i > 0) CHECK(std::abs(gap - last) < 1.1e-3 * (1 + std::abs(slope)));
                    CHECK(gap < -0.5 * depth);
                    CHECK(gap > -1.5 * depth - 1e-12);
                    last = gap;
                    scene.remember(contacts);
                }
            }
}

TEST_CASE("a thin piece is not touched from behind and a deep contact keeps its edge") {
    // a plate of thickness 0.05 between two tips; the upper one rests on it, the lower one is 0.05 from its upper face
    Pieces scene({block(2, 1, 2, 0.05), tip({0.7, 0.05}, 0.3, 0.5)});
    auto contacts = scene.contacts(h);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].normal.y() == relative(1));
    // pushed in step by step it stays in contact with the same face, also where the other one is nearer
    const FaceContact first = contacts[0];
    for (int i = 1; i <= 15; ++i) {
        scene.remember(contacts);
        scene.put(1, {0, -1e-3 * i}, 0, {0, 0}, {0, -1});
        contacts = scene.contacts(h);
        REQUIRE(contacts.size() == 1);
        CHECK(contacts[0].edge == first.edge);
        CHECK(contacts[0].gap == relative(-1e-3 * i));
    }
    // a tip that suddenly lies as deep was never on that side
    scene.state.face_contacts.clear();
    CHECK(n_between(scene, scene.contacts(h)) == 0);
}

TEST_CASE("the inner vertex of a hollow face is no contact between its two ends") {
    // it cannot close before these, and would be one contact too many of two rigid sides
    for (const double depth : {0., 1e-4, 5e-4}) {
        Mesh hollow = block(2, 1, 0.1, 0.1, {1.5, 1 - depth});
        for (Vec2& x : hollow.vertices)
            if (std::abs(x.x() - 1.55) < 1e-12) x.y() += 8e-4;  // turns right by 0.032
        const Pieces scene({block(1, 1, 3, 1), hollow});
        const auto contacts = scene.contacts(h);
        CHECK(contacts.size() == 2);
        for (const FaceContact& contact : contacts) CHECK(contact.gap == relative(-depth));
    }
}

TEST_CASE("a tip in a sharp notch touches a face that it lies behind beyond the end of this face") {
    // notch of a = 10 degrees, its faces from (0, 0.5) upwards; a tip of 4 degrees behind the right one by g
    const double half = 5 * std::numbers::pi / 180, g = 4e-4;
    const Vec2 bottom(0, 0.5), up(std::sin(half), std::cos(half)), n(-std::cos(half), std::sin(half));
    const double width = 0.5 * std::tan(half), thin = 0.4 * std::tan(half * 0.4);
    Pieces scene({star_mesh({{-1, -1}, {1, -1}, {1, 1}, {width, 1}, bottom, {-width, 1}, {-1, 1}}),
                  star_mesh({{0, 0}, {thin, 0.4}, {-thin, 0.4}})});
    for (const double beyond : {0., 1., 2., 3., 4., 5.}) {  // in g; in front of the left face up to cot a = 5.7
        CAPTURE(beyond);
        scene.put(1, bottom - g * (beyond * up + n));
        const auto contacts = scene.contacts(h);
        const auto of_tip = std::ranges::find_if(contacts, [&](const FaceContact& contact) {
            return scene.body_of(contact.vertex[0]) == 1 && contact.normal.dot(n) > 0.999;
        });
        REQUIRE(of_tip != contacts.end());
        CHECK(of_tip->gap == relative(-g));
    }
}

TEST_CASE("steps that move a contact too far or find it too deep are refused with the place") {
    Pieces scene({block(2, 1, 2, 1), tip({0.7, 1.0}, 0.3, 0.5)});
    FaceContacts contacts(scene.model);
    scene.put(1, {0, 0}, 0, {0, 0}, {0, -40});
    contacts.find(scene.state, h);
    CHECK_FALSE(contacts.refusal());
    scene.put(1, {0, 0}, 0, {0, 0}, {0, -60});  // 0.06 of the edge in a step
    contacts.find(scene.state, h);
    REQUIRE(contacts.refusal());
    CHECK(contacts.refusal()->reason == ContactRefusal::Reason::speed);
    CHECK(contacts.refusal()->value == relative(0.06));
    CHECK((contacts.refusal()->place - Vec2(0.7, 1)).norm() < 1e-12);
    scene.put(1, {0, 0}, 0, {0, 0}, {0, 60});  // it leaves
    contacts.find(scene.state, h);
    CHECK_FALSE(contacts.refusal());
    scene.put(1, {0, 0}, 0, {0, 0}, {0, 1e6});
    contacts.find(scene.state, h);
    CHECK(contacts.refusal());
    scene.put(1, {0, 0});
    scene.remember(scene.contacts(h));
    scene.put(1, {0, -0.12});
    contacts.find(scene.state, h);
    REQUIRE(contacts.refusal());
    CHECK(contacts.refusal()->reason == ContactRefusal::Reason::depth);
    CHECK(contacts.refusal()->value == relative(0.12));
}

TEST_CASE("any number of threads finds the same contacts") {
    const int before = omp_get_max_threads();
    const Pieces scene = random_rubble(7, 30, 30);
    omp_set_num_threads(1);
    const auto one = scene.contacts(h);
    CHECK(one.size() > 200);
    for (const int n_threads : {2, 3, 4}) {
        omp_set_num_threads(n_threads);
        CHECK(equal(scene.contacts(h), one));
    }
    omp_set_num_threads(before);
}

TEST_CASE("the contacts turn and move with the whole scene") {
    int n = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Pieces scene = random_rubble(seed, 6, 6), turned_scene = random_rubble(seed, 6, 6);
        const double angle = 0.3 * double(seed);
        for (Index c = 0; c < scene.model.mesh.n_corners(); ++c) {
            turned_scene.displacement(c) = turned(scene.place(c), angle) + Vec2(3, -2) - scene.model.mesh.corner(c);
            const Index node = scene.state.node_of_corner[c];
            turned_scene.state.velocity[node] = turned(scene.state.velocity[node], angle);
        }
        const auto a = scene.contacts(h), b = turned_scene.contacts(h);
        REQUIRE(a.size() == b.size());
        for (std::size_t k = 0; k < a.size(); ++k, ++n) {
            CHECK(a[k].vertex == b[k].vertex);
            CHECK(a[k].edge == b[k].edge);
            CHECK((turned(a[k].normal, angle) - b[k].normal).norm() < 1e-13);
            CHECK(std::abs(a[k].gap - b[k].gap) < 1e-13);
            CHECK(std::abs(a[k].share - b[k].share) < 1e-13);
        }
    }
    CHECK(n > 50);
}

TEST_CASE("the cell grid finds every pair that comes near before the list is made anew") {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        Pieces scene = random_rubble(seed, 4, 5);
        Random random(seed, "moves");
        const FreeBoundary boundary(scene.model);
        const auto edges = boundary.edges();
        std::vector<CornerMotion> corners;
        for (const Index c : boundary.corners()) corners.push_back({scene.place(c), Vec2::Zero()});
        const double margin = random.uniform(0.02, 0.2), reach = 0.3 * margin, move = (margin - 1.5 * reach) / 2.5;
        NearbyEdges nearby;
        nearby.find(edges, corners, margin);
        std::set<std::array<Index, 2>> listed;
        for (std::size_t b = 0; b < nearby.n_blocks(); ++b)
            for (const auto& [i, e] : nearby.of_block(b)) CHECK(listed.insert({i, e}).second);
        std::map<Index, Vec2> shift;  // of nodes
        for (std::size_t c = 0; c < corners.size(); ++c) {
            const Index node = scene.state.node_of_corner[boundary.corners()[c]];
            if (!shift.contains(node)) shift[node] = move * turned({1, 0}, random.uniform(0, 7));
            corners[c].x += shift[node];
        }
        int n_near = 0;
        for (Index i = 0; i < Index(edges.size()); ++i)
            for (Index e = 0; e < Index(edges.size()); ++e) {
                if (edges[e].piece_start == i || edges[e].piece_end == i) continue;
                const Vec2 &a = corners[edges[e].start_place].x, along = corners[edges[e].end_place].x - a,
                           from_a = corners[edges[i].start_place].x - a;
                const double length = along.norm(), gap = cross(from_a, along) / length, s = along.dot(from_a) / length;
                const double beyond =
                    std::min(reach + std::max(0., std::min(-gap, edges[e].depth + gap)), 0.25 * length);
                if (gap > reach || gap < -edges[e].depth || s < -beyond || s > length + beyond) continue;
                const auto direction = [&](Index of) {
                    return (corners[edges[of].end_place].x - corners[edges[of].start_place].x).normalized();
                };
                const Vec2 normal = -turned_left(direction(e));
                if (normal.dot(direction(edges[i].entering)) > VertexCone::widened ||
                    normal.dot(direction(i)) < -VertexCone::widened)
                    continue;  // outside the cone of the vertex
                ++n_near;
                CHECK(listed.contains({i, e}));
            }
        CHECK(n_near > 0);
    }
}

}  // namespace face_contacts_test
