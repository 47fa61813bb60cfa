// Contacts between the faces of cracks, beside the points that are still live.
#include "base/random.hpp"
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/contact/retirement.hpp"
#include "stepper/rigid/freeze.hpp"
#include "support/pieces.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <optional>

namespace cracked_bodies_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double h = 1e-3;

/// Splits every fan, but for one at `bonded`; points between triangles of different parts lose their cohesion.
void crack(Pieces& scene, const std::vector<int>& part, std::optional<Vec2> bonded = std::nullopt) {
    scene.body.assign(part.begin(), part.end());
    for (Index f = 0; f < Index(scene.model.fans.size()); ++f) {
        if (bonded && scene.model.mesh.corner(scene.model.corners(scene.model.fans[f])[0]) == *bonded) continue;
        split(scene.model, f, scene.state);
        PointState* state = scene.state.points.data() + scene.state.first_point.back();
        for (const FanPoint& point : scene.model.points(scene.model.fans[f]))
            (state++)->cohesion = part[point.before / 3] == part[point.after / 3];
    }
}

/// n teeth of width 1 and height 2 x slope between two bars; part 1 is the upper one.
Pieces zigzag(int n_cells, double slope) {
    Mesh mesh = bar_mesh(n_cells, 2, n_cells / 2., 1);
    for (int i = 0; i <= n_cells; ++i) mesh.vertices[n_cells + 1 + i].y() += (i % 2 == 0 ? -0.25 : 0.25) * slope;
    Pieces scene({mesh});
    std::vector<int> part(mesh.triangles.size(), 0);
    std::fill(part.begin() + 2 * n_cells, part.end(), 1);
    crack(scene, part);
    return scene;
}

}  // namespace

TEST_CASE(
    "a zigzag crack slides over to free faces at the slip at which its points retire: those on the surface first") {
    const double slope = 0.3, edge = 0.5 * std::sqrt(1 + slope * slope);
    for (const double slip : {0.8 * retirement_slip, 1.2 * retirement_slip, 0.8 * inner_retirement_slip,
                              1.2 * inner_retirement_slip, 0.2}) {
        CAPTURE(slip);
        Pieces scene = zigzag(8, slope);
        scene.put(1, slip * edge * Vec2(1, slope) / std::sqrt(1 + slope * slope));
        scene.retire();
        const auto contacts = scene.contacts(h);
        if (slip < retirement_slip) {
            CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 0);
            CHECK(contacts.empty());
            continue;
        }
        if (slip < inner_retirement_slip) {
            CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 2);
            continue;
        }
        CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 2 * 8);
        // the peaks of the lower part on the rising flanks of the upper one, and the upper part's on the lower flanks;
        // the end of the upper bar overhangs
        int n_rising = 0;
        for (const FaceContact& contact : contacts) {
            CHECK(scene.body_of(contact.vertex[0]) != scene.body_of(contact.edge[0]));
            if (std::abs(contact.gap) < 1e-12) {
                ++n_rising;
                CHECK(std::abs(contact.normal.x() / contact.normal.y()) == relative(slope));
                CHECK(contact.normal.x() * contact.normal.y() < 0);
            } else {
                CHECK(contact.gap > 0);
            }
        }
        CHECK(n_rising == 8);
    }
}

namespace {

/// Six triangles of edge 1 round a vertex; triangle i lies between the directions of 60 i and 60 (i + 1) degrees.
Pieces hexagon(const std::vector<int>& part) {
    std::vector<Vec2> outline;
    for (int i = 0; i < 6; ++i) outline.push_back(turned({1, 0}, i * std::numbers::pi / 3));
    Pieces scene({star_mesh(outline)});
    crack(scene, part);
    return scene;
}

/// Of the points at the centre.
std::ptrdiff_t n_retired_at_centre(const Pieces& scene) {
    std::ptrdiff_t n = 0;
    for (const FanPoint& point : scene.model.fan_points)
        n += scene.state.retired[point.point] == Retirement::retired &&
             scene.model.mesh.corner(point.corner()).norm() < 1e-9;
    return n;
}

}  // namespace

TEST_CASE("broken points inside the body retire early where corners that are no neighbours overlap") {
    // all six cracked; triangles 0 and 3 go towards each other by d, so their corners overlap by 2 d sin 30 = d; each
    // slips by d along its neighbours
    const Vec2 axis = turned({1, 0}, std::numbers::pi / 6);
    const auto closed_by = [&](double d, bool towards_each_other) {
        Pieces scene = hexagon({0, 1, 2, 3, 4, 5});
        scene.put(0, -d * axis);
        scene.put(3, towards_each_other ? Vec2(d * axis) : Vec2(-d * axis));
        scene.retire();
        return n_retired_at_centre(scene);
    };
    static_assert(1.5 * retirement_slip < 0.004 && 0.006 < 0.5 * inner_retirement_slip);
    CHECK(closed_by(0.004, true) == 0);   // less than the overlap of 0.005
    CHECK(closed_by(0.006, true) == 4);   // those of 0 and 3; 1 and 2, 4 and 5 have not moved apart
    CHECK(closed_by(0.006, false) == 0);  // the same slips, without an overlap of strangers: 3 goes away from 0
    CHECK(closed_by(1.1 * inner_retirement_slip, false) == 4);
}

TEST_CASE("corners that are no neighbours meet while all points of their fan hold") {
    // triangles 0 and 3 go towards each other by d, so their corners overlap by d; or both go the same way
    const Vec2 axis = turned({1, 0}, std::numbers::pi / 6);
    for (const auto& scene_of : {std::pair(0.004, true), {0.006, true}, {0.006, false}}) {
        const double d = scene_of.first;
        const bool towards_each_other = scene_of.second;
        CAPTURE(d);
        CAPTURE(towards_each_other);
        Pieces scene = hexagon({0, 1, 2, 3, 4, 5});
        for (PointState& point : scene.state.points) point.cohesion = 0.5;
        scene.put(0, -d * axis);
        scene.put(3, towards_each_other ? Vec2(d * axis) : Vec2(-d * axis));
        scene.retire();
        CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 0);
        const bool meet = towards_each_other && d > 0.005;
        CHECK(std::ranges::count(scene.state.retired, Retirement::meeting) == (meet ? 6 : 0));
        const auto contacts = scene.contacts(h);
        CHECK(contacts.empty() == !meet);
        bool has_met = false;  // 0 and 3; both overlap less with what lies beside the other one
        for (const FaceContact& contact : contacts) {
            const Index one = scene.body_of(contact.vertex[0]), other = scene.body_of(contact.edge[0]);
            CHECK(std::abs(one - other) % 5 > 1);
            CHECK(contact.depth < 1.001 * d);
            has_met = has_met || (one + other == 3 && contact.depth > 0.999 * d);
        }
        CHECK(has_met == meet);
        // once the points beside triangle 0 have retired, it meets all others, and the other five still have theirs
        if (!meet) continue;
        for (const FanPoint& point : scene.model.fan_points)
            if (scene.body_of(point.before) == 0 || scene.body_of(point.after) == 0)
                scene.state.retired[point.point] = Retirement::retired;
        for (const FaceContact& contact : scene.contacts(h)) {
            const Index one = scene.body_of(contact.vertex[0]), other = scene.body_of(contact.edge[0]);
            if (one != 0 && other != 0) CHECK(std::abs(one - other) > 1);
        }
    }
}

TEST_CASE("what slips inside a body whose vertex has come apart retires as on the surface") {
    // triangles 0 and 1 lie against the other four; 1 goes outwards and retires with both of its points, or with none
    const auto retired_with = [&](double slip_of_1) {
        Pieces scene = hexagon({0, 1, 2, 3, 3, 3});
        scene.put(1, slip_of_1 * Vec2(0, 1));
        scene.put(3, 1.2 * retirement_slip * turned({1, 0}, -std::numbers::pi / 2));
        scene.retire();
        return n_retired_at_centre(scene);
    };
    CHECK(retired_with(0.8 * inner_retirement_slip) == 0);
    CHECK(retired_with(1.2 * inner_retirement_slip) == 4);
}

TEST_CASE("a broken point that is alone in its slip retires on the surface and not inside the body") {
    const double slip = 1.2 * inner_retirement_slip;  // less than that of a hinge
    // inside: the crack between triangles 5 and 0 alone has slipped at the centre, then that between 0 and 1, too
    for (const bool two : {false, true}) {
        CAPTURE(two);
        Pieces scene = hexagon({0, 1, 1, 1, 1, 1});
        // what slips alone goes away from the corners on the other side of the vertex: else these meet
        const Vec2 along = slip * turned({1, 0}, two ? std::numbers::pi / 6 : std::numbers::pi);
        for (Index c = 0; c < scene.model.mesh.n_corners(); ++c)
            if (scene.model.mesh.corner(c).norm() < 1e-9 && c / 3 == 0) scene.displacement(c) = along;
        if (!two)  // the other side of triangle 0 moves with it, and keeps its cohesion
            for (Index c = 0; c < scene.model.mesh.n_corners(); ++c)
                if (scene.model.mesh.corner(c).norm() < 1e-9 && c / 3 != 5) scene.displacement(c) = along;
        scene.retire();
        CHECK(n_retired_at_centre(scene) == (two ? 2 : 0));
        CHECK(std::ranges::count(scene.state.retired, Retirement::parted) == 0);
    }
    // on the surface of a bar of two cells that is cracked along x = 1
    Pieces bar({bar_mesh(2, 1, 2, 1)});
    crack(bar, {0, 0, 1, 1});
    for (Index c = 0; c < bar.model.mesh.n_corners(); ++c)
        if (bar.body_of(c) == 1 && bar.model.mesh.corner(c).y() == 0) bar.displacement(c) = {0, -slip};
    bar.retire();
    CHECK(std::ranges::count(bar.state.retired, Retirement::retired) == 1);
}

TEST_CASE("the corner of a crack that a live point holds as a hinge touches what lies in its opening") {
    // two cells side by side, cracked along x = 1 but for the point at (1, 1), the left one turned clockwise; a block to
    // the left of the hinge, its right side inclined as `angle` says
    for (const bool bonded : {false, true})
        for (const double opening : {0.15, 0.5, 2.0, 3.0}) {
            CAPTURE(opening);
            CAPTURE(bonded);
            Mesh block = bar_mesh(1, 1, 0.3, 0.4);
            Pieces scene({bar_mesh(2, 1, 2, 1), block});
            const Vec2 hinge(1, 1);
            crack(scene, {0, 0, 1, 1, 2, 2}, bonded ? std::optional(hinge) : std::nullopt);
            const double angle = -0.2, gap = 1e-4;
            scene.put(0, Vec2::Zero(), -opening, {1, 1});
            const Vec2 normal = turned({1, 0}, angle);
            scene.put(2, Vec2(1, 1) - gap * normal - Vec2(0.3, 0.2), angle, {0.3, 0.2});
            // the point at (1, 1) holds, that at (1, 0) does not
            for (std::size_t rank = 0; rank < scene.state.split_fans.size(); ++rank) {
                const Fan& fan = scene.model.fans[scene.state.split_fans[rank]];
                for (Index j = 0; j < fan.n_points; ++j)
                    if (scene.model.mesh.corner(scene.model.points(fan)[j].after) == Vec2(1, 1))
                        scene.state.points[scene.state.first_point[rank] + j].cohesion = 1;
            }
            scene.retire();
            CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 1);
            CHECK(std::ranges::count(scene.state.retired, Retirement::parted) == (opening > 0.2));
            const auto piece_of_right = [&](Hinges hinges) {
                return pieces_of_body(scene.model, scene.state, {}, hinges).first[2];
            };
            CHECK(piece_of_right(Hinges::join) == 0);
            CHECK(piece_of_right(Hinges::part) == (opening > 0.2 ? 2 : 0));
            const auto contacts = scene.contacts(h);
            // in a crack that is hardly open there is no room for the block: nothing is looked for there
            REQUIRE(contacts.size() == (opening > 0.2 ? 1 : 0));
            if (contacts.empty()) continue;
            CHECK(scene.body_of(contacts[0].vertex[0]) == 1);
            CHECK(scene.body_of(contacts[0].edge[0]) == 2);
            CHECK(contacts[0].gap == relative(gap, 1e-9));
            CHECK((contacts[0].normal - normal).norm() < 1e-12);
        }
}

TEST_CASE("a hinge that closes while its piece stays where it is meets what lies in its opening") {
    // the cells of the test before, opened wide, and a block in the opening; then the left one turns back onto its corner
    Pieces scene({bar_mesh(2, 1, 2, 1), bar_mesh(1, 1, 0.1, 0.1)});
    const Vec2 hinge(1, 1), from_hinge(-0.55, -0.35);  // to the corner
    crack(scene, {0, 0, 1, 1, 2, 2}, hinge);
    scene.put(2, hinge + from_hinge - Vec2(0, 0.1));
    scene.put(0, Vec2::Zero(), -2.5, hinge);
    scene.retire();
    FrozenPieces pieces = freeze(scene.model, scene.state);
    REQUIRE(pieces.pieces.size() == 2);
    scene.state.frozen = pieces.body, scene.state.rigid_pieces = std::move(pieces.pieces);
    scene.state.rigid_pieces[0].state = PieceState::deformable;
    FaceContacts found(scene.model);
    found.set_pieces(scene.state.frozen);
    found.find(scene.state, h);
    CHECK(found.all().empty());
    const double gap = 1e-4, touch = std::atan2(-from_hinge.x(), -from_hinge.y());
    scene.put(0, Vec2::Zero(), -(touch + gap / from_hinge.norm()), hinge);
    found.find(scene.state, h);
    REQUIRE(found.all().size() == 1);
    CHECK(scene.body_of(found.all()[0].vertex[0]) == 2);
    CHECK(found.all()[0].gap == relative(gap, 1e-3));
}

TEST_CASE("pieces of a triple junction touch their neighbours and the live point keeps its own") {
    // six triangles round a vertex, three parts of 120 degrees; edge i is before triangle i
    std::vector<Vec2> outline;
    for (int i = 0; i < 6; ++i) outline.push_back(turned({1, 0}, i * std::numbers::pi / 3));
    const auto junction = [&](const std::array<Vec2, 3>& shift) {
        Pieces scene({star_mesh(outline)});
        crack(scene, {0, 0, 1, 1, 2, 2});
        for (Index part = 0; part < 3; ++part) scene.put(part, shift[part]);
        scene.retire();
        return scene;
    };
    const Vec2 out = turned({1, 0}, std::numbers::pi / 3);  // of part 0, along its axis
    {                                                       // all three apart
        const Pieces scene = junction(
            {0.1 * out, 0.1 * turned(out, 2 * std::numbers::pi / 3), 0.1 * turned(out, -2 * std::numbers::pi / 3)});
        CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 6);
        CHECK(scene.contacts(h).empty());
    }
    {  // part 0 slides along its face towards part 2: it opens from part 1, and the tip at the centre lies on the face
        const Vec2 along(-0.06, 0);
        const Pieces scene = junction({-along, Vec2::Zero(), Vec2::Zero()});
        CHECK(std::ranges::count(scene.state.retired, Retirement::retired) ==
              4);  // between 1 and 2 the points are live
        const auto contacts = scene.contacts(h);
        REQUIRE(contacts.size() == 2);
        for (const FaceContact& contact : contacts) {
            CHECK(std::abs(contact.gap) < 1e-12);
            CHECK(std::abs(contact.normal.x()) < 1e-12);
            CHECK(scene.body_of(contact.vertex[0]) + scene.body_of(contact.edge[0]) == 2);  // parts 0 and 2
        }
    }
    {  // part 0 pressed into the notch between the others: its tip touches both
        Pieces scene = junction({0.1 * out, Vec2::Zero(), Vec2::Zero()});
        CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 4);
        scene.put(0, -1e-4 * out);
        std::array<int, 3> n_of_tip{};
        for (const FaceContact& contact : scene.contacts(h)) {
            CHECK(contact.gap == relative(-1e-4 * std::sqrt(0.75)));
            if (scene.model.mesh.corner(contact.vertex[0]).norm() < 1e-12) ++n_of_tip[scene.body_of(contact.edge[0])];
        }
        CHECK(n_of_tip == std::array{0, 1, 1});
    }
}

TEST_CASE("a tip behind both faces of a notch touches the one in which it is deeper") {
    // six triangles round a vertex; part 0 is a wedge in the notch of 60 degrees between the parts 1 and 2, whose crack
    // has opened by less than points retire at: the faces of the notch meet deeper inside than at the ends of both
    std::vector<Vec2> outline;
    for (int i = 0; i < 6; ++i) outline.push_back(turned({1, 0}, i * std::numbers::pi / 3));
    Pieces scene({star_mesh(outline)});
    crack(scene, {0, 1, 1, 1, 2, 2});
    const double opening = 0.0015;
    scene.put(2, {0, -opening});
    scene.put(0, {0.1, 0.05});
    scene.retire();
    CHECK(std::ranges::count(scene.state.retired, Retirement::retired) == 4);  // between 1 and 2 the points are live
    const Vec2 tip(-0.0016, -opening - 0.0003);
    scene.put(0, tip);
    Index n_of_tip = 0;
    for (const FaceContact& contact : scene.contacts(h)) {
        if (scene.body_of(contact.vertex[0]) != 0 || scene.model.mesh.corner(contact.vertex[0]).norm() > 1e-12)
            continue;
        ++n_of_tip;
        CHECK(scene.body_of(contact.edge[0]) == 1);
        CHECK(contact.gap == relative(tip.dot(turned({1, 0}, -std::numbers::pi / 6))));
    }
    CHECK(n_of_tip == 1);
}

TEST_CASE("a live crack end inside the body is no contact vertex and its two sides touch behind it") {
    // the crack between triangles 0 and 5 opens at the rim only
    std::vector<Vec2> outline;
    for (int i = 0; i < 6; ++i) outline.push_back(turned({1, 0}, i * std::numbers::pi / 3));
    Pieces scene({star_mesh(outline)});
    crack(scene, {0, 0, 0, 0, 0, 1});
    for (std::size_t i = 0; i < scene.model.interfaces.size(); ++i) {
        const Interface& interface = scene.model.interfaces[i];
        for (Index place = 0; place < 2; ++place)
            if (interface.vertex[place] == 0 && interface.vertex[1 - place] == 6)
                scene.state.retired[2 * i + place] = Retirement::retired;
    }
    const auto contacts = scene.contacts(h);  // the two rim corners lie on each other: twins
    REQUIRE(contacts.size() <= 1);
    FaceContacts found(scene.model);
    found.find(scene.state, h);
    for (const FreeEdge& edge : found.boundary().edges())
        if (scene.model.mesh.corner(edge.start).norm() < 1e-12) CHECK(edge.entering == -1);
    CHECK(found.boundary().edges().size() == 8);
}

TEST_CASE("a tip on a face stays there when a crack opens towards the end of that face") {
    // the crack b-c between the triangles a b c and b d c opens at c; the tip of the other body touches the face b-d
    // near b, behind the line a-b
    Mesh quad, wedge;
    quad.vertices = {{3.98296, 1.63923}, {3.87869, 0.684585}, {5.38871, 0.243958}, {4.87769, 1.75659}};
    quad.triangles = {{0, 1, 3}, {1, 2, 3}};
    wedge.vertices = {{3.78151, 0.02379}, {4.07058, 0.62818}, {2.93272, 0.69796}};
    wedge.triangles = {{0, 1, 2}};
    Pieces scene({quad, wedge});
    crack(scene, {0, 0, 1});
    const auto contacts = scene.contacts(h);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].edge[0] == 3);  // b of the second triangle
    scene.remember(contacts);
    scene.state.face_contacts.insert(scene.state.face_contacts.begin(), {1, 7, 1, 0});  // b met the face behind the tip
    for (std::size_t i = 0; i < scene.model.interfaces.size(); ++i)
        for (Index place = 0; place < 2; ++place)
            if (scene.model.interfaces[i].vertex[place] == 3) scene.state.retired[2 * i + place] = Retirement::retired;
    FaceContacts found(scene.model);
    found.find(scene.state, h);
    CHECK_FALSE(found.refusal());  // the tip is 0.2 below the line a-b
    Index n_of_tip = 0;
    for (const FaceContact& contact : found.all()) {
        if (scene.body_of(contact.vertex[0]) != 1) continue;
        CHECK(contact.edge[0] == 3);
        ++n_of_tip;
    }
    CHECK(n_of_tip == 1);
}

TEST_CASE("contacts do not depend on when the faces of retired points were added") {
    std::size_t n = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        CAPTURE(seed);
        Random random(seed, "retire");
        std::vector<Mesh> bodies{bar_mesh(8, 6, 8, 6), bar_mesh(5, 5, 5, 5)};
        for (Vec2& x : bodies[1].vertices) x += Vec2(1.5, 6);
        Pieces scene(bodies);
        for (Index f = 0; f < Index(scene.model.fans.size()); ++f) split(scene.model, f, scene.state);
        const double speed = seed % 2 == 0 ? 0.01 : 3;
        for (Vec2& v : scene.state.velocity) v = speed * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        FaceContacts lasting(scene.model);
        for (int step = 0; step < 60; ++step) {
            for (int k = 0; k < int(seed % 5); ++k)
                scene.state.retired[std::size_t(random.uniform(0, double(scene.state.retired.size())))] =
                    Retirement::retired;
            if (step == 40 && seed % 7 == 0) std::ranges::fill(scene.state.retired, Retirement::none);
            lasting.find(scene.state, h);
            const auto anew = scene.contacts(h);
            REQUIRE(lasting.all().size() == anew.size());
            for (std::size_t k = 0; k < anew.size(); ++k, ++n) {
                const FaceContact &a = lasting.all()[k], &b = anew[k];
                REQUIRE((a.vertex == b.vertex && a.edge == b.edge && a.normal == b.normal && a.share == b.share &&
                         a.gap == b.gap && a.contact == b.contact));
            }
            scene.remember(anew);
            for (std::size_t i = 0; i < scene.state.displacement.size(); ++i)
                scene.state.displacement[i] += h * scene.state.velocity[i];
        }
    }
    CHECK(n > 1000);
}

}  // namespace cracked_bodies_test
