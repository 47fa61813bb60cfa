// A run that starts from another one and has more: rigid pieces, obstacles, excavations.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cmath>

namespace start_with_more_test {

using namespace program;
using knap::tests::relative;

namespace {

std::string block(const std::string& domain = "") {
    return rectangle("0.1, 0.1", "0.025", domain) +
           "[material.rock]\ndensity = 2000\nE = 1e9\nnu = 0.2\n[interface.default]\nbreakable = false\n"
           "[[load]]\nacceleration = [0, -10]\n";
}

/// The state of a run `first` at this time.
std::string from(const Folder& folder, const std::string& time) {
    return "start = \"run:" + (folder.path / "first").string() + "@" + time + "\"\n";
}

Answer run(const Folder& folder, const std::string& name, const std::string& text) {
    write_scene(folder, text + "[output]\nfields = false\nhistory_every = 1e-4\nstates = 0.01\n");
    const Answer answer = run_scene(folder, "-j 1 -o " + folder.in_shell(name));
    CAPTURE(answer.text);
    return answer;
}

/// [J] Of the balance, over all lines.
double largest_residual(const knap::History& energy) {
    double largest = 0;
    for (const double residual : energy.column("residual")) largest = std::max(largest, std::abs(residual));
    return largest;
}

}  // namespace

// It has fallen by 0.5 mm with small rotations, and falls on by 0.5 mm to a floor that was not there; a disc of 2 kg
// that passes by with 3 m/s brings its 9 J.
TEST_CASE("start with more: what falls becomes rigid and meets a floor that the first run has not") {
    const Folder folder("start with obstacles");
    REQUIRE(run(folder, "first", block() + "[time]\nend = 0.01\n").code == 0);
    const std::string large = "rotation = \"large\"\n", more = "[contact]\n[rigid]\n";
    const auto floor_at = [](const char* y) {
        return std::string("[[obstacle]]\nname = \"floor\"\nshape = \"half plane\"\nat = [0, ") + y +
               "]\nnormal = [0, 1]\nfriction = 0.5\n";
    };
    const std::string disc =
        "[[obstacle]]\nname = \"passing\"\nshape = \"disc\"\ncentre = [5, 5]\nradius = 0.1\nmass = 2\n"
        "initial_velocity = [3, 0]\n";
    const std::string time = "[time]\nend = 1\nuntil = \"rest\"\n" + from(folder, "0.01");
    REQUIRE(run(folder, "rest", block(large) + more + floor_at("-1e-3") + disc + time).code == 0);
    const knap::History energy = knap::read_csv(folder.path / "rest/energy.csv");
    CHECK(energy.column("assumptions").front() == relative(9, 1e-9));
    CHECK(energy.column("kinetic").front() == relative(9 + 0.5 * 20 * 0.01, 1e-3));
    CHECK(largest_residual(energy) < 1e-12 * 9);
    const auto height = knap::read_csv(folder.path / "rest/fragment_paths.csv").column("centre_y");
    CHECK(height.front() == relative(0.0495, 1e-5));
    CHECK(height.back() == relative(0.049, 1e-5));
    SUBCASE("not where the body is by then, which check finds, too") {
        write_scene(folder, block(large) + more + floor_at("-1e-4") + "[time]\nend = 1\n" + from(folder, "0.01"));
        for (const std::string& words : {std::string("check "), "run -q -o " + folder.in_shell("no") + " "}) {
            const Answer refused = command(words + folder.in_shell("scene.toml"));
            CAPTURE(refused.text);
            CHECK(refused.code == 2);
            CHECK(refused.has("error[obstacle-in-body]"));
            CHECK(refused.has("`obstacle[0]` (floor) overlaps the body as the other run left it, by 400 µm"));
        }
    }
    SUBCASE("and not back") {
        const fs::path first = folder.path / "first";
        fs::remove_all(first), fs::rename(folder.path / "rest", first);
        const Answer back = run(folder, "back", block(large) + "[contact]\n[time]\nend = 1\n" + from(folder, "0.01"));
        CAPTURE(back.text);
        CHECK(back.code == 2);
        CHECK(back.has("what is rigid has no strains"));
    }
}

// The ice loses nine tenths of its strength of 1 MPa from -20 to -1 C. It meets the floor with 0.17 m/s, and a blow
// 0.3 sigma_c/(rho c) is 0.21 m/s for the cold ice, 0.021 m/s for the warm one.
TEST_CASE("start with more: what thawed falls as rigid pieces with the strength that its frozen temperatures left") {
    const Folder folder("start thawed");
    const auto ice = [](const std::string& domain, const std::string& heat, const std::string& more) {
        return rectangle("0.1, 0.1", "0.05", domain) +
               "[material.ice]\ndensity = 2000\nE = 1e9\nnu = 0.2\nexpansion = 1e-5\n[interface.default]\nsigma_c = "
               "1e6\nG_c = 1000\nstrength_table = [[-20, 1], [-1, 0.1]]\n[heat]\nreference = -20\ntemperature = \"" +
               heat + "\"\n[[load]]\nacceleration = [0, -10]\n" + more;
    };
    const auto falls = [&](const std::string& heat) {
        return run(folder, "falls",
                   ice("rotation = \"large\"\n", heat,
                       "[contact]\n[rigid]\nstep = 1e-4\n[[obstacle]]\nshape = \"half plane\"\nat = [0, -1.5e-3]\n"
                       "normal = [0, 1]\n[time]\nend = 0.012\n" +
                           from(folder, "0.01")));
    };
    for (const bool thaws : {false, true}) {
        CAPTURE(thaws);
        REQUIRE(run(folder, "first", ice("", thaws ? "-20 + 1900*t" : "-20", "[time]\nend = 0.01\n")).code == 0);
        REQUIRE(falls("frozen").code == 0);
        const knap::History energy = knap::read_csv(folder.path / "falls/energy.csv");
        CHECK(energy.column("kinetic").front() == relative(0.5 * 20 * 0.01, 0.05));  // and waves
        CHECK(largest_residual(energy) < 1e-12 * energy.column("kinetic").front());
        const std::string results = text_of(folder.path / "falls/run.json");
        CHECK((results.find("\"thaws\": 0,") == std::string::npos) == thaws);
        fs::remove_all(folder.path / "falls");
        const Answer refused = falls("-20 + 1900*t");
        CAPTURE(refused.text);
        CHECK(refused.code == 2);
        CHECK(refused.has("temperatures that stay (those of another run: time.start and temperature = \"frozen\")"));
        fs::remove_all(folder.path / "first");
    }
}

// Turned by a = 0.03 rad, small rotations have the strain 0, large ones a^2/2 = 4.5e-4: 563 kPa with
// E/(1 - nu) = 1.25 GPa.
TEST_CASE("start with more: what has turned with small rotations would be strained by large ones") {
    const Folder folder("start turned");
    const auto spins = [](const std::string& strength, const std::string& domain, const std::string& time) {
        return rectangle("0.1, 0.1", "0.05", domain + "model = \"plane stress\"\n") +
               "[material.rock]\ndensity = 2000\nE = 1e9\nnu = 0.2\n[interface.default]\n" + strength +
               "[[initial]]\nspin = \"3 rad/s\"\nvelocity = [0, 0]\n[time]\n" + time;
    };
    const std::string strong = "sigma_c = 1e7\nG_c = 1000\n", large = "rotation = \"large\"\n",
                      weak = "sigma_c = 5e5\nG_c = 1\n", on = "end = 1e-3\n" + from(folder, "0.01");
    for (const bool is_weak : {false, true}) {
        const std::string& strength = is_weak ? weak : strong;
        REQUIRE(run(folder, "first", spins(strength, "", "end = 0.01\n")).code == 0);
        const Answer turned = run(folder, "turned", spins(strength, large, on));
        CAPTURE(turned.text);
        CHECK(turned.code == (is_weak ? 2 : 0));
        CHECK(turned.has(is_weak ? "error[turned-body]" : "warning[jump]"));
        CHECK(turned.has("with stresses of up to 563 kPa"));
        fs::remove_all(folder.path / "first"), fs::remove_all(folder.path / "turned");
    }
}

TEST_CASE("start with more: faces that overlap would not meet") {
    const Folder folder("start overlapping");
    const auto two = [](const std::string& more) {
        return std::string(
                   "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.1\n[material.rock]\ndensity = 2000\nE = "
                   "1e9\nnu = 0.2\n"
                   "[interface.default]\nbreakable = false\n[[body]]\nname = \"a\"\nshape = \"rectangle\"\n"
                   "size = [0.1, 0.1]\norigin = [0, 0]\n[[body]]\nname = \"b\"\nshape = \"rectangle\"\n"
                   "size = [0.1, 0.1]\norigin = [0.1005, 0]\nvelocity = [-1, 0]\n") +
               more;
    };
    REQUIRE(run(folder, "first", two("[time]\nend = 0.01\n")).code != 1);
    const Answer refused = run(folder, "second", two("[contact]\n[time]\nend = 0.01\n" + from(folder, "0.01")));
    CAPTURE(refused.text);
    CHECK(refused.code == 2);
    CHECK(refused.has("error[overlapping-faces]"));
}

TEST_CASE("start with more: a region vanishes whose time was after the end of the first run") {
    const Folder folder("start with excavation");
    const auto held = [](const char* at) {
        return block() +
               "[[load]]\non = \"bottom\"\ndisplacement = [0, 0]\n[[excavation]]\nbox = [0.05, 0.05, 0.1, 0.1]\nat = " +
               at + "\nramp = 1e-3\n[time]\nend = 0.01\n";
    };
    REQUIRE(run(folder, "first", held("1")).code == 0);
    REQUIRE(run(folder, "rest", held("1e-3") + from(folder, "0.01")).code == 0);
    const knap::History energy = knap::read_csv(folder.path / "rest/energy.csv");
    CHECK(energy.column("excavated_energy").back() > 0);
    double most = 0;
    for (const double strain : energy.column("strain")) most = std::max(most, strain);
    CHECK(largest_residual(energy) < 1e-12 * most);
    std::string without = held("1");
    without.erase(without.find("[[excavation]]"), without.find("[time]") - without.find("[[excavation]]"));
    REQUIRE(run(folder, "bare", without).code == 0);
    const fs::path first = folder.path / "first";
    fs::remove_all(first), fs::rename(folder.path / "bare", first);
    const Answer other_mesh = run(folder, "other", held("1e-3") + from(folder, "0.01"));
    CAPTURE(other_mesh.text);
    CHECK(other_mesh.code == 2);
    CHECK(other_mesh.has("must be in both, since the mesh follows its outline"));
}

}  // namespace start_with_more_test
