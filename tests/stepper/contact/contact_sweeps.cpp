// Bodies pushed through each other without any response: what overlaps is in contact, what does not overlap is not, and
// gaps change no faster than the bodies move.
#include "base/random.hpp"
#include "mesh/polygon.hpp"
#include "support/pieces.hpp"

#include <doctest/doctest.h>

#include <numbers>

namespace contact_sweeps_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double h = 1e-3, tolerance = 1e-3;  // [s]; [-] penetrations of an edge that count as touching

using Ring = std::vector<Vec2>;

/// Points on an ellipse; its sides have 1 to n_parts edges.
Ring convex_outline(Random& random, int n, int n_parts) {
    const double turn = random.uniform(0, 7), flatness = random.uniform(0.3, 1);
    Ring corners, all;
    for (int i = 0; i < n; ++i) {
        const double angle = turn + 2 * std::numbers::pi * (i + 0.7 * random.uniform()) / n;
        corners.push_back({0.5 * std::cos(angle), 0.5 * flatness * std::sin(angle)});
    }
    for (int i = 0; i < n; ++i) {
        const int parts = 1 + static_cast<int>(random.uniform(0, n_parts));
        for (int k = 0; k < parts; ++k)
            all.push_back(corners[i] +
                          (k + (k > 0 ? 0.3 * random.uniform() : 0)) / parts * (corners[(i + 1) % n] - corners[i]));
    }
    return all;
}

Ring star_outline(Random& random, int n) {
    Ring all;
    for (int i = 0; i < n; ++i)
        all.push_back(0.5 * random.uniform(0.45, 1) *
                      turned({1, 0}, 2 * std::numbers::pi * (i + 0.6 * random.uniform()) / n));
    return all;
}

/// A star with spikes.
Ring spiky_outline(Random& random, int n) {
    Ring all;
    const double thin = random.uniform(0.02, 0.6);
    for (int i = 0; i < n; ++i)
        all.push_back(0.5 * (i % 2 == 1 ? thin : 1) * random.uniform(0.5, 1) *
                      turned({1, 0}, 2 * std::numbers::pi * (i + 0.6 * random.uniform()) / n));
    return all;
}

/// Calls visit(a, b) for every edge of a polygon.
template <class Visit>
void for_edges(const Ring& polygon, const Visit& visit) {
    for (std::size_t i = 0; i < polygon.size(); ++i) visit(polygon[i], polygon[(i + 1) % polygon.size()]);
}

/// Of two convex polygons: the largest gap of all planes along edges; negative where they overlap.
double separation(const Ring& a, const Ring& b) {
    double gap = -1e300;
    for (const auto& [one, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
        for_edges(*one, [&](const Vec2& from, const Vec2& to) {
            const Vec2 normal = -turned_left((to - from).normalized());
            double nearest = 1e300;
            for (const Vec2& x : *other) nearest = std::min(nearest, normal.dot(x - from));
            gap = std::max(gap, nearest);
        });
    return gap;
}

bool crosses(const Ring& a, const Ring& b) {
    bool any = false;
    for_edges(a, [&](const Vec2& p, const Vec2& q) {
        for_edges(b, [&](const Vec2& r, const Vec2& s) {
            any =
                any || (cross(q - p, r - p) * cross(q - p, s - p) < 0 && cross(s - r, p - r) * cross(s - r, q - r) < 0);
        });
    });
    return any;
}

double distance(const Vec2& x, const Ring& polygon) {
    double least = 1e300;
    for_edges(polygon, [&](const Vec2& a, const Vec2& b) {
        const double s = std::clamp((b - a).dot(x - a) / (b - a).squaredNorm(), 0., 1.);
        least = std::min(least, (x - a - s * (b - a)).norm());
    });
    return least;
}

/// The second body comes from a random side with a random spin.
class Approach {
public:
    Approach(Random& random, Ring fixed, Ring moving)
        : a(std::move(fixed)), b_(std::move(moving)), scene({star_mesh(a), star_mesh(b_)}) {
        const Vec2 side = turned({1, 0}, random.uniform(0, 7));
        angle_ = random.uniform(0, 7);
        start_ = 1.2 * side + random.uniform(-0.6, 0.6) * turned_left(side);
        step = std::pow(10, random.uniform(-4, -2.3));
        velocity_ = step / h * (random.uniform(-1, 1) * turned_left(side) - side);
        spin_ = random.uniform(-1, 1) * step / h;
        put(0);
        for (double distance; (distance = apart()) > 0.03 && (b[0] - a[0]).norm() < 5;)
            put(time_ + std::ceil((distance - 0.02) / (3 * step)));
    }
    void advance() { put(time_ + 1); }
    double apart() const {
        double least = 1e300;
        for (const Vec2& x : b) least = std::min(least, distance(x, a));
        for (const Vec2& x : a) least = std::min(least, distance(x, b));
        return least;
    }

    Ring a, b;  // as they are now

private:
    void put(double time) {
        time_ = time;
        const double angle = angle_ + h * time * spin_;
        const Vec2 shift = start_ + h * time * velocity_;
        b.clear();
        for (const Vec2& x : b_) b.push_back(shift + turned(x, angle));
        scene.put(1, shift, angle, Vec2::Zero(), velocity_, spin_);
    }

    Ring b_;
    Vec2 start_, velocity_;
    double angle_, spin_, time_ = 0;

public:
    Pieces scene;
    double step;  // [m] motion in a step
};

/// [m] How deep a vertex of one of them lies in the other one.
double depth_of(const Approach& at) {
    double depth = 0;
    for (const Vec2& x : at.b)
        if (contains(at.a, x)) depth = std::max(depth, distance(x, at.a));
    for (const Vec2& x : at.a)
        if (contains(at.b, x)) depth = std::max(depth, distance(x, at.b));
    return depth;
}

double smallest_gap(const std::vector<FaceContact>& contacts) {
    double gap = 1e300;
    for (const FaceContact& contact : contacts) gap = std::min(gap, contact.gap);
    return gap;
}

}  // namespace

TEST_CASE("contacts of convex bodies have the gap of the separating plane") {
    int n_touching = 0;
    for (const int n_parts : {1, 4})
        for (int seed = 1; seed <= 500; ++seed) {
            CAPTURE(seed);
            Random random(seed, "convex");
            Ring a = convex_outline(random, 3 + int(random.uniform(0, 6)), n_parts),
                 b = convex_outline(random, 3 + int(random.uniform(0, 6)), n_parts);
            Approach at(random, std::move(a), std::move(b));
            for (int i = 0; i < 200; ++i, at.advance()) {
                const double gap = separation(at.a, at.b);
                if (gap > 0.1 || gap < -3 * at.step - 0.3 * tolerance) break;
                const auto contacts = at.scene.contacts(h);
                at.scene.remember(contacts);
                if (gap > 0) {
                    for (const FaceContact& contact : contacts) CHECK(contact.gap > -tolerance * contact.length);
                    continue;
                }
                ++n_touching;
                REQUIRE(contacts.size() > 0);
                CHECK(std::abs(smallest_gap(contacts) - gap) < 0.5 * tolerance + at.step);
            }
        }
    CHECK(n_touching > 2000);
}

TEST_CASE("bodies with notches touch where they overlap and nowhere else") {
    int n_touching = 0;
    for (int seed = 1; seed <= 1000; ++seed) {
        CAPTURE(seed);
        Random random(seed, "notches");
        Ring a = star_outline(random, 4 + int(random.uniform(0, 8))),
             b = star_outline(random, 4 + int(random.uniform(0, 8)));
        Approach at(random, std::move(a), std::move(b));
        for (int i = 0; i < 200; ++i, at.advance()) {
            const double depth = depth_of(at);
            if (depth > 3 * at.step + 0.3 * tolerance || at.apart() > 0.1) break;
            const auto contacts = at.scene.contacts(h);
            at.scene.remember(contacts);
            if (depth > 0) {
                ++n_touching;
                REQUIRE(contacts.size() > 0);
                CHECK(smallest_gap(contacts) < -depth + 0.5 * tolerance + at.step);
            } else if (!crosses(at.a, at.b)) {
                for (const FaceContact& contact : contacts) CHECK(contact.gap > -1.01 * tolerance * contact.length);
            }
        }
    }
    CHECK(n_touching > 1000);
}

TEST_CASE("spikes that pass each other touch along no plane that one of them reaches behind") {
    // of 1 500 scenes those in which one of two planes at their corners would stay that separates neither
    int n_near = 0;
    for (const int seed : {255, 1165}) {
        CAPTURE(seed);
        Random random(seed, "spiky");
        Ring a = spiky_outline(random, 2 * (2 + int(random.uniform(0, 4)))),
             b = spiky_outline(random, 2 * (2 + int(random.uniform(0, 4))));
        Approach at(random, std::move(a), std::move(b));
        for (int i = 0; i < 200 && at.apart() < 0.1 && !crosses(at.a, at.b); ++i, at.advance()) {
            const auto contacts = at.scene.contacts(h);
            at.scene.remember(contacts);
            n_near += contacts.size() > 0;
            for (const FaceContact& contact : contacts) CHECK(contact.gap > -1.01 * tolerance * contact.length);
        }
    }
    CHECK(n_near > 10);
}

TEST_CASE("the line of an edge goes on behind a body and what lies there is not deep in it") {
    // without a look at the corners a vertex would lie deeper than a tenth of the edge
    Random random(24, "star");
    Ring a = star_outline(random, 4 + int(random.uniform(0, 8))),
         b = star_outline(random, 4 + int(random.uniform(0, 8)));
    Approach at(random, std::move(a), std::move(b));
    FaceContacts contacts(at.scene.model);
    int n_touching = 0;
    for (int i = 0; i < 200 && depth_of(at) < 0.02 && at.apart() < 0.1; ++i, at.advance()) {
        contacts.find(at.scene.state, h);
        at.scene.remember({contacts.all().begin(), contacts.all().end()});
        n_touching += depth_of(at) > 0;
        CHECK_FALSE(contacts.refusal());
    }
    CHECK(n_touching > 2);
}

TEST_CASE("a block that slides along flush blocks meets no seam") {
    for (const double depth : {0., 1e-12, 1e-9, 1e-6, 3e-4, -1e-6})
        for (const double step : {1e-4, 1e-2})
            for (const double tilt : {0., 1e-6, -1e-6}) {
                CAPTURE(depth);
                CAPTURE(tilt);
                std::vector<Mesh> bodies{bar_mesh(2, 1, 0.8, 0.5)};
                for (int i = 0; i < 4; ++i) {
                    bodies.push_back(bar_mesh(1 + i % 2, 1, 1, 1));
                    for (Vec2& x : bodies.back().vertices) x += Vec2(i, -1);
                }
                Pieces scene(bodies);
                int n_hindering = 0, n_wrong = 0;
                // small steps over the first two seams only: of a flush joint, and of a joint and an inner vertex
                for (int i = 0; i * step < (step < 1e-3 ? 0.5 : 2.5); ++i) {
                    scene.put(0, {0.13 + i * step, -depth}, tilt, {0.4, 0}, {step / h, 0});
                    const auto contacts = scene.contacts(h);
                    int n = 0;
                    for (const FaceContact& contact : contacts) {
                        const bool is_vertex = scene.body_of(contact.vertex[0]) == 0;
                        if (!is_vertex && scene.body_of(contact.edge[0]) != 0) continue;  // of flush blocks
                        ++n;
                        const double rate = (is_vertex ? 1 : -1) * contact.normal.x() / h * step;
                        n_hindering += rate < -1e-2 * step / h && contact.gap + h * rate < -1e-9 * step;
                    }
                    n_wrong += n < 2 || n > 6;
                    scene.remember(contacts);
                }
                CHECK(n_hindering == 0);
                CHECK(n_wrong == 0);
            }
}

}  // namespace contact_sweeps_test
