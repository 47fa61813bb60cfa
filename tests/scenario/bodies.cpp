// Several bodies in a scenario: places, names, motions, and what contradicts them.
#include "samples.hpp"

#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

namespace bodies_test {

using namespace knap;
using knap::tests::relative;
using samples::changed;
using samples::mistakes;

namespace {

/// The least with `blocks` in place of [domain].
std::string scene(const std::string& blocks) {
    return changed("[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n", blocks);
}

std::string block(const std::string& name, double x, double y, const std::string& more = "") {
    return "[[body]]\nname = \"" + name + "\"\nshape = \"rectangle\"\nsize = [0.1, 0.04]\norigin = [" + shortest(x) +
           ", " + shortest(y) + "]\n" + more;
}

bool reports(const std::string& text, const std::string& code, const std::string& words, int line = 0) {
    const std::vector<Diagnostic> found = mistakes(text);
    std::string all;
    for (const Diagnostic& d : found) all += format(d);
    CAPTURE(all);
    const bool is_there = std::ranges::any_of(found, [&](const Diagnostic& d) {
        return d.code == code && (d.message + d.hint + d.note).find(words) != std::string::npos && d.line > 0 &&
               (line == 0 || d.line == line);
    });
    CHECK(is_there);
    CHECK(found.size() == 1);
    return is_there;
}

}  // namespace

TEST_CASE("bodies: shapes and names and motions") {
    const std::string text =
        scene(block("a", 0, 0) + block("b", 0, 0.04, "velocity = [1, 2]\nspin = 180\nmesh_size = 0.002\n") +
              "[[body]]\nshape = \"disc\"\ncentre = [0.3, 0]\nradius = 0.02\n");
    const Scenario s = samples::read(text + "[[initial]]\nbody = \"a\"\nspin = 90\n").scenario;
    REQUIRE(s.bodies.size() == 3);
    CHECK(s.body_names() == std::vector<std::string>{"a", "b", "body3"});
    CHECK(s.boundary_names() == std::vector<std::string>{"a.bottom", "a.right", "a.top", "a.left", "b.bottom",
                                                         "b.right", "b.top", "b.left", "body3.rim"});
    CHECK(s.bodies[1].shape.outer.points[0] == Vec2(0, 0.04));
    CHECK(s.bodies[0].mesh.size == 0.001);
    CHECK(s.bodies[1].mesh.size == 0.002);
    REQUIRE(s.initial_velocities.size() == 2);
    CHECK(s.initial_velocities[0].on.body == "b");
    CHECK(s.initial_velocities[0].value == Vec2(1, 2));
    CHECK(s.initial_velocities[0].spin == relative(std::numbers::pi, 1e-15));
    CHECK(s.initial_velocities[1].on.body == "a");
    CHECK(s.initial_velocities[1].spin == relative(std::numbers::pi / 2, 1e-15));
}

TEST_CASE("bodies: the mesh of a body depends on its name and the seed alone") {
    const auto seeds = [](const std::string& text) {
        std::vector<std::uint64_t> found;
        for (const Body& body : samples::read(text).scenario.bodies) found.push_back(body.mesh.seed);
        return found;
    };
    const auto two = seeds(scene(block("a", 0, 0) + block("b", 0, 0.04)));
    const auto three = seeds(scene(block("new", 0, 0.1) + block("a", 0, 0) + block("b", 0, 0.04)));
    CHECK(two[0] != two[1]);
    CHECK(three[1] == two[0]);
    CHECK(three[2] == two[1]);
    CHECK(seeds("seed = 2\n" + scene(block("a", 0, 0)))[0] != two[0]);
}

TEST_CASE("bodies: the point about which a body turns") {
    const Scenario s =
        samples::read(scene(block("a", 0.01, 0.02, "angle = 90\n") +
                            "[[body]]\nshape = \"polygon\"\npoints = [[1, 0], [1.1, 0], [1, 0.1]]\nangle = -90\n" +
                            "[[body]]\nshape = \"disc\"\ncentre = [2, 0]\nradius = 0.1\nangle = 90\n"
                            "[[body.hole]]\ncentre = [2.05, 0]\nradius = 0.01\n"))
            .scenario;
    CHECK((s.bodies[0].shape.outer.points[2] - Vec2(0.01 - 0.04, 0.02 + 0.1)).norm() < 1e-15);
    CHECK((s.bodies[1].shape.outer.points[1] - Vec2(1, -0.1)).norm() < 1e-15);
    CHECK((bounding_box(s.bodies[2].shape.holes[0].points).middle() - Vec2(2, 0.05)).norm() < 1e-3);
}

TEST_CASE("bodies: what cannot be") {
    const std::string two = block("a", 0, 0) + block("b", 0, 0.04);
    CHECK(mistakes(scene(two)).empty());
    reports(scene(block("a", 0, 0) + block("b", 0, 0.03)), "overlap", "in body `a` by 10 mm at (0.05, 0.04) m", 7);
    reports(scene(two + block("a", 0, 0.2)), "duplicate-name", "name of another body", 13);
    reports(scene("[domain]\ncentre = [0, 0]\n" + two), "exclusive-keys", "`domain.centre` has no meaning", 3);
    reports(scene("[domain]\n[[domain.hole]]\ncentre = [0, 0]\nradius = 1\n" + two), "exclusive-keys", "`domain.hole`");
    reports(scene(two) + "[[load]]\non = \"left\"\ntraction = [1, 0]\n", "unknown-name", "did you mean `a.left`?");
    reports(scene(two) + "[[load]]\non = \"a\"\ntraction = [1, 0]\n", "unknown-name", "on = { body = \"a\" }");
    reports(scene(two) + "[[load]]\non = { body = \"c\" }\nacceleration = [1, 0]\n", "unknown-name", "known: a, b");
    reports(scene(two) + "[[initial]]\nbody = \"c\"\nspin = 1\n", "unknown-name", "there is no body `c`");
    reports(scene(two) + "[[initial]]\nbody = \"a\"\n", "missing-key", "has no velocity, spin, strain_rate or stress");
    reports(scene(two) + "[[joints]]\ndirection = 0\nspacing = 0.01\n", "missing-key", "the name of a body: a, b");
    reports(scene(two + "material = \"glas\"\n"), "unknown-name", "did you mean `glass`?");
    reports(scene("[[body]]\nsize = [1, 1]\n"), "missing-key", "`body[0].shape` is missing");
    reports(scene(two) +
                "[[load]]\non = \"a.top\"\nvelocity = [0, 1]\n[specimen]\ntest = \"tension\"\nforce = "
                "\"load0\"\nheight = 0.04\n",
            "missing-key", "there are several bodies");
}

TEST_CASE("bodies: a wall is a group of numbered blocks") {
    const std::string text = scene(block("ground", -1, -0.04) +
                                   "[[bodies]]\npattern = \"wall\"\ncolumns = 2\nrows = 2\nblock = [0.02, 0.01]\n"
                                   "velocity = [1, 0]\nspin = 3\nangle = 90\n" +
                                   "[[bodies]]\nname = \"rubble\"\npattern = \"heap\"\nbox = [1, 0, 1.1, 0.1]\n"
                                   "size = 0.02\nnumber = 5\ncorners = 0\nmesh_size = 0.004\n");
    const Scenario s = samples::read(text).scenario;
    REQUIRE(s.bodies.size() == 1 + 5 + 5);
    CHECK(s.bodies[1].name == "wall1");
    CHECK(s.bodies[5].name == "wall5");
    CHECK(s.bodies[6].name == "rubble1");
    CHECK(s.bodies[6].mesh.size == 0.004);
    REQUIRE(s.groups.size() == 2);
    CHECK((s.groups[0].name == "wall" && s.groups[0].first == 1 && s.groups[0].n == 5));
    CHECK(s.bodies[3].shape.boundary_names ==
          std::vector<std::string>{"wall3.bottom", "wall3.right", "wall3.top", "wall3.left"});
    CHECK(s.bodies[7].shape.boundary_names == std::vector<std::string>{"rubble2.rim"});
    CHECK((s.bodies[1].shape.outer.points[2] - Vec2(-0.01, 0.02)).norm() < 1e-15);  // turned about its origin
    CHECK(s.initial_velocities.size() == 5);
    CHECK(mistakes(text + "[[load]]\non = { body = \"wall\" }\nacceleration = [0, -9.81]\n").empty());
    // seeds: stones by the name of the group, meshes by the names of the bodies
    const Scenario t = samples::read("seed = 5\n" + text).scenario;
    CHECK(t.bodies[1].shape.outer.points == s.bodies[1].shape.outer.points);
    CHECK(t.bodies[6].shape.outer.points != s.bodies[6].shape.outer.points);
    CHECK(t.bodies[1].mesh.seed != s.bodies[1].mesh.seed);
}

TEST_CASE("bodies: patterns that cannot be") {
    const auto wall = [](const std::string& more) {
        return scene("[[bodies]]\npattern = \"wall\"\ncolumns = 2\nrows = 2\nblock = [0.02, 0.01]\n" + more);
    };
    const auto heap = [](const std::string& more) {
        return scene("[[bodies]]\npattern = \"heap\"\nbox = [0, 0, 0.1, 0.1]\nsize = 0.02\n" + more);
    };
    CHECK(mistakes(wall("")).empty());
    reports(wall("bond = 0.02\n"), "out-of-range", "leaves blocks of 400 µm", 7);
    CHECK(mistakes(scene("[[bodies]]\npattern = \"wall\"\ncolumns = 3\nrows = 1\nblock = [0.02, 0.01]\ngap = 0.03\n"))
              .empty());  // a single row has no bond
    reports(wall("fraction = 0.2\n"), "exclusive-keys", "belongs to pattern = \"heap\"");
    reports(wall("[[body]]\nname = \"wall3\"\nshape = \"disc\"\nradius = 0.01\ncentre = [1, 1]\n"), "duplicate-name",
            "`wall3` is the name of another body");
    reports(wall("[[body]]\nshape = \"disc\"\nradius = 0.01\n"), "overlap", "(body `wall1`) lies in body `body1`");
    reports(heap(""), "missing-key", "has none of number, fraction");
    reports(heap("number = 100\n"), "geometry", "finds no room", 6);
    reports(heap("number = 2\ncorners = 2\n"), "out-of-range", "at least 3");
    reports(changed("size = 0.02", "size = 0.001", heap("number = 2\n")), "out-of-range", "1.5 times the mesh size");
    reports(scene("[[bodies]]\npattern = \"voronoi\"\nbox = [0, 0, 100, 100]\nsize = 0.02\n"), "out-of-range",
            "more than 5000 bodies");
}

TEST_CASE("contact: laws of pairs of materials") {
    const std::string two = scene("[domain]\nrotation = \"large\"\n" + block("a", 0, 0) + block("b", 0, 0.04)) +
                            "[material.steel]\ndensity = 8000\nE = 190e9\nnu = 0.3\n"
                            "[interface.glass-steel]\nsigma_c = 0\nfriction = 0.7\nrestitution = 0.2\n";
    CHECK(samples::read(two).scenario.contact_of_pair.empty());
    REQUIRE(samples::read(two).warnings.size() == 1);
    CHECK(samples::read(two).warnings[0].code == "no-contact");
    reports(changed("large", "big", two) + "[contact]\n", "unknown-word", "rotation");
    const auto laws = [&](const std::string& contact) {
        std::vector<std::pair<double, double>> found;
        const auto pairs = samples::read(two + contact).scenario.contact_of_pair;
        REQUIRE(pairs.size() == 2);
        CHECK(pairs[0][1].friction == pairs[1][0].friction);
        CHECK(pairs[0][1].restitution == pairs[1][0].restitution);
        for (const auto& [a, b] : {std::pair{0, 0}, {0, 1}, {1, 1}})
            found.emplace_back(pairs[a][b].friction, pairs[a][b].restitution);
        return found;
    };
    using Laws = std::vector<std::pair<double, double>>;
    CHECK(laws("[contact]\n") == Laws{{0, 0}, {0.7, 0.2}, {0, 0}});  // those of the interfaces
    CHECK(laws("[contact]\nfriction = 0.5\n") == Laws{{0.5, 0}, {0.5, 0.2}, {0.5, 0}});
    CHECK(laws("[contact]\nfriction = 0.5\n[[contact.pair]]\nmaterials = [\"steel\", \"glass\"]\nrestitution = 1\n"
               "[[contact.pair]]\nmaterials = [\"steel\", \"steel\"]\nfriction = 0.1\n") ==
          Laws{{0.5, 0}, {0.5, 1}, {0.1, 0}});
}

TEST_CASE("a support with contact ends with the faces that stand on it or goes on") {
    const std::string body = samples::changed("size = [0.1, 0.04]\n", "size = [0.1, 0.04]\nrotation = \"large\"\n",
                                              samples::least + "[contact]\n"),
                      held = "[interface.rock]\nbreakable = false\n[[support]]\non = \"bottom\"\nglued = true\n";
    const auto n_warnings = [](const std::string& text) {
        return std::ranges::count(samples::read(text).warnings, "support-ends", &Diagnostic::code);
    };
    CHECK(n_warnings(body + "[[support]]\non = \"bottom\"\n") == 1);
    CHECK(n_warnings(body + "[[support]]\non = \"bottom\"\nbeyond = 0\n") == 0);
    const std::string wide = "[[support]]\non = \"bottom\"\nbeyond = \"0.2 m\"\n";
    CHECK(n_warnings(body + wide) == 0);
    CHECK(samples::read(body + wide).scenario.supports[0].beyond == 0.2);
    reports(samples::least + wide, "exclusive-keys", "`support[0].beyond` is a ground for contact");
    CHECK(n_warnings(body + held + "interface = \"rock\"\n") == 0);
    CHECK(n_warnings(samples::least + "[[support]]\non = \"bottom\"\n") == 0);
}

TEST_CASE("a side of a body or of a group of bodies by its own name") {
    const std::string two = scene(block("a", 0, 0) + block("b", 0.1, 0.04)),
                      wall = scene(
                          "[[bodies]]\nname = \"wall\"\npattern = \"wall\"\ncolumns = 3\nrows = 2\nblock = [0.02, "
                          "0.01]\nbond = 0\norigin = [0, 0]\n");
    const auto on = [](const std::string& place) { return "[[support]]\non = " + place + "\n"; };
    CHECK(mistakes(two + on("{ body = \"b\", boundary = \"bottom\" }")).empty());
    CHECK(mistakes(two + on("{ body = \"b\", boundary = \"b.bottom\" }")).empty());
    CHECK(mistakes(wall + on("{ body = \"wall\", boundary = \"bottom\" }")).empty());
    reports(two + on("{ body = \"b\", boundary = \"botom\" }"), "unknown-name", "did you mean `bottom`?");
    reports(two + on("{ body = \"b\", boundary = \"a.bottom\" }"), "unknown-name", "a.bottom");
    reports(wall + on("{ body = \"wall\", boundary = \"front\" }"), "unknown-name", "front");
}

TEST_CASE("contact: what cannot be") {
    const std::string one = changed("[mesh]", "rotation = \"large\"\n[mesh]");
    CHECK(mistakes(one + "[contact]\n").empty());
    reports(samples::least + "[contact]\n", "exclusive-keys", "`contact` needs large rotations", 16);
    reports(changed("end = 80e-6", "end = 80e-6\ncohesion = \"implicit\"", one) + "[contact]\n", "exclusive-keys",
            "does not go together with cohesion = \"implicit\": contacts");
    reports(one + "[contact]\nfriction = -1\n", "out-of-range", "at least 0");
    const std::string pair = "[contact]\n[[contact.pair]]\nfriction = 0.1\n";
    reports(one + pair, "missing-key", "`contact.pair[0].materials` is missing");
    reports(one + pair + "materials = [\"glass\", \"glas\"]\n", "unknown-name", "did you mean `glass`?");
    reports(one + pair +
                "materials = [\"glass\", \"glass\"]\n[[contact.pair]]\nfriction = 0.1\nmaterials = [\"glass\", "
                "\"glass\"]\n",
            "duplicate-name", "second entry of this pair");
    reports(one + "[contact]\n[[contact.pair]]\nmaterials = [\"glass\", \"glass\"]\n", "missing-key",
            "neither friction nor restitution");
}

}  // namespace bodies_test
