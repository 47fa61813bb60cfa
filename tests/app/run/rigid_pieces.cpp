// [rigid]: pieces that nothing can break move as rigid bodies, and become deformable for a blow.
#include "app/rigid_scene.hpp"
#include "support/relative.hpp"

#include <cmath>
#include <sstream>
#include <tuple>

namespace rigid_pieces_test {

using namespace program;
using knap::tests::relative;

TEST_CASE("rigid pieces: a block slides down an incline as Coulomb says or stays") {
    const Folder folder("rigid incline");
    const auto moved = [&](const std::string& friction) {
        const std::string text = scene(block("b", "0, 0", "0.4, 0.3") + ground("friction = " + friction + "\n") +
                                           "[[load]]\nacceleration = [4.905, -8.495709]\n",
                                       "step = 1e-3\nsleep = 0\nrestitution = 0\n", "1");
        REQUIRE(run_to_end(folder, text).code == 0);
        CHECK(balance(table(folder, "energy.csv")) < 1e-12);
        return last(table(folder, "fragment_history.csv"), "to_x") - 0.2;
    };
    CHECK(moved("0.4") == relative(0.5 * (4.905 - 0.4 * 8.495709), 1e-12));
    const std::string text = scene(
        block("b", "0, 0", "0.4, 0.3") + ground("friction = 0.7\n") + "[[load]]\nacceleration = [4.905, -8.495709]\n",
        "step = 1e-3\nsleep = 0\nrestitution = 0\n", "1");
    REQUIRE(run_to_end(folder, text).code == 0);
    CHECK(std::abs(last(table(folder, "fragment_history.csv"), "to_x") - 0.2) < 1e-14);
}

TEST_CASE("rigid pieces: what begins to slide goes on however slowly and what is braked falls asleep") {
    const Folder folder("rigid slow slide");
    const auto slide = [&](const std::string& friction, const std::string& motion) {
        const std::string text =
            scene(block("b", "0, 0", "0.4, 0.3", motion) + ground("friction = " + friction + "\n") +
                      "[[load]]\nacceleration = [5.0525, -8.4088]\n",  // 31 degrees: tan = 0.6009
                  "step = 1e-3\nrestitution = 0\n", "1");
        REQUIRE(run_to_end(folder, text).code == 0);
    };
    for (const double friction : {0.59, 0.6}) {  // 0.09 and 0.007 m/s2: slower than 2 cm/s for 0.2 s and 2.8 s
        slide(std::to_string(friction), "");
        CHECK(last(table(folder, "fragment_history.csv"), "to_x") - 0.2 ==
              relative(0.5 * (5.0525 - friction * 8.4088), 1e-9));
        CHECK(record(folder)["pieces"]["asleep"] == 0);
    }
    slide("0.61", "velocity = [0.01, 0]\n");
    CHECK(record(folder)["pieces"]["asleep"] == 1);
    CHECK(last(table(folder, "fragment_history.csv"), "to_x") - 0.2 ==
          relative(0.01 * 0.01 / (2 * (0.61 * 8.4088 - 5.0525)), 0.1));
}

TEST_CASE("rigid pieces: what nothing brakes goes on however slowly") {
    const Folder folder("rigid glide");
    for (const bool brakes : {false, true}) {
        const std::string text = scene(block("b", "0, 0", "0.4, 0.3", "velocity = [0.01, 0]\n") +
                                           ground(brakes ? "friction = 0.5\n" : "friction = 0\n") + weight,
                                       "restitution = 0\n", "2");
        REQUIRE(run_to_end(folder, text).code == 0);
        CHECK(record(folder)["pieces"]["asleep"] == (brakes ? 1 : 0));
        const double moved = last(table(folder, "fragment_history.csv"), "to_x") - 0.2;
        const double way = brakes ? 0.01 * 0.01 / (2 * 0.5 * 9.81) : 0.01 * 2;
        CHECK(moved == relative(way, brakes ? 0.5 : 1e-9));  // it stops within four steps
    }
}

TEST_CASE("rigid pieces: steps as long as a fall see what loads bring together") {
    const Folder folder("rigid long step");
    const auto height = [&](const std::string& step, const std::string& below) {
        const std::string text = scene(block("b", "0, 1", "0.4, 0.3") + below + weight,
                                       "step = " + step + "\nsleep = 0\nrestitution = 0\n", "3");
        REQUIRE(run_to_end(folder, text).code == 0);
        return table(folder, "fragments.csv").column("centre_y").back();
    };
    const std::string held = block("held", "-1, -0.2", "2, 0.2") + "[[support]]\non = \"held.bottom\"\n",
                      terrain =
                          "[[obstacle]]\nname = \"terrain\"\nshape = \"polyline\"\n"
                          "points = [[2, 0], [0.5, 0], [0, 0], [-2, 0]]\nfriction = 0.5\n";
    for (const std::string& below : {ground(), terrain, held})
        for (const char* step : {"0.5e-3", "0.1", "1"}) {
            CAPTURE(below);
            CAPTURE(step);
            CHECK(height(step, below) == relative(0.15, 1e-4));
        }
}

TEST_CASE("rigid pieces: a driven obstacle wakes what it touches however slowly it moves") {
    const Folder folder("rigid woken");
    const auto with_plate = [&](const std::string& velocity) {
        return scene(
            block("b", "0, 0", "0.4, 0.3") +
                ground("friction = 0.5\nvelocity = [0, " + velocity + "]\ntable = [[0, 0], [0.5, 0], [0.501, 1]]\n") +
                weight,
            "", "1.5");
    };
    for (const double velocity : {0.005, -0.005}) {
        REQUIRE(run_to_end(folder, with_plate(std::to_string(velocity))).code == 0);
        CHECK(last(table(folder, "fragment_history.csv"), "to_y") - 0.15 == relative(velocity * 0.9995, 1e-3));
    }
    const std::string platen =
        "[[obstacle]]\nname = \"platen\"\nshape = \"half plane\"\nat = [0, 0.303]\nnormal = "
        "[0, -1]\nfriction = 0.5\nvelocity = [0, -0.01]\n";
    REQUIRE(
        run_to_end(folder, scene(block("b", "0, 0", "0.4, 0.3") + ground() + platen + weight, "", "0.5", weak)).code ==
        0);
    CHECK(record(folder)["summary"]["broken_length"] > 0.3);
}

TEST_CASE("rigid pieces: a probe of stress is refused since they have none") {
    check_refused(Folder("rigid probe"),
                  scene(block("b", "0, 0", "0.4, 0.3") + ground() +
                            "[[probe]]\nname = \"p\"\nwatch = \"stress\"\nbox = [0, 0, 0.4, 0.3]\n",
                        "", "0.1"),
                  "exclusive-keys", "a rigid piece has no stresses");
}

TEST_CASE("rigid pieces: what slides slowly against a sleeping piece pushes it on by its weight") {
    const Folder folder("rigid pushed");
    const auto pushed = [&](const std::string& rigid) {
        const std::string line =
            "[[obstacle]]\nname = \"ground\"\nshape = \"polyline\"\npoints = [[5, 0], [-5, 0]]\n"
            "friction = 0.0072\nR_N = 0\n[[obstacle.range]]\nfrom = 0.501\nto = 5\nfriction = 0\n";
        const std::string text = scene(block("a", "-0.5, 0", "1, 1") + block("b", "0.5022, 0", "1, 1") + line +
                                           "[[load]]\nacceleration = [-0.068486, -9.80976]\n",  // 0.4 degrees
                                       "restitution = 0\n" + rigid, "4", whole, "0.3");
        REQUIRE(run_to_end(folder, text).code == 0);
        return last(table(folder, "fragment_history.csv"), "to_x");
    };
    const double without = pushed("sleep = 0\n");
    CHECK(pushed("") == relative(without, 1e-3));
}

TEST_CASE("rigid pieces: what can break rebounds with R_N below a blow and pieces take the law of their rank") {
    const Folder folder("rigid rank");
    // falls without weight at 0.15 m/s, where 0.28 m/s may break it; back from the ground with
    const auto rebound = [&](const std::string& law, const std::string& contact, const std::string& obstacle) {
        std::string text =
            scene(block("b", "0, 0.001", "0.4, 0.3", "velocity = [0, -0.15]\n") + ground("friction = 0\n" + obstacle),
                  "step = 1e-3\nrestitution = 0.7\n", "0.05", law);
        text.insert(text.find("[rigid]"), contact);
        REQUIRE(run_to_end(folder, text).code == 0);
        CHECK(record(folder)["pieces"]["deformable_time_s"] == 0);
        const std::string said = program::command("check " + folder.in_shell("scene.toml")).text;
        return std::pair(last(table(folder, "fragments.csv"), "velocity_y") / 0.15, said);
    };
    const auto is = [](double value) { return relative(value, 1e-9); };
    CHECK(rebound(weak, "", "R_N = 0.5\n").first == is(0.5));
    CHECK(rebound(weak, "R_N = 0.4\n", "").first == is(0.4));
    const auto [broken, on_breakable] = rebound(weak, "", "");
    CHECK(std::abs(broken) < 1e-12);
    CHECK(on_breakable.find("0 of what can break, below a blow that may break it") != std::string::npos);
    CHECK(rebound(whole, "", "restitution = 0.5\n").first == is(0.5));
    CHECK(rebound(whole, "restitution = 0.4\n", "restitution = 0.5\n").first == is(0.5));
    CHECK(rebound(whole, "restitution = 0.4\n", "").first == is(0.4));
    CHECK(rebound(whole, "R_N = 0.4\n", "").first == is(0.4));
    CHECK(std::abs(rebound(whole, "restitution = 0\n", "").first) < 1e-12);
    const auto [own, on_whole] = rebound(whole, "", "");
    CHECK(own == is(0.7));
    CHECK(on_whole.find("0.7 of rigid pieces that cannot break (rigid.restitution)") != std::string::npos);
}

TEST_CASE("rigid pieces: a free flight is a parabola and its turn is exact") {
    const Folder folder("rigid flight");
    const std::string text = scene(block("b", "0, 5", "0.4, 0.3", "velocity = [3, 1]\nspin = \"300 deg/s\"\n") + weight,
                                   "step = 1e-3\n", "0.5");
    REQUIRE(run_to_end(folder, text).code == 0);
    const knap::History path = table(folder, "fragments.csv"), energy = table(folder, "energy.csv");
    CHECK(last(path, "centre_x") == relative(0.2 + 3 * 0.5, 1e-13));
    CHECK(last(path, "centre_y") == relative(5.15 + 0.5 - 0.5 * 9.81 * 0.25, 1e-13));
    CHECK(last(path, "rotation") == relative(150, 1e-10));
    CHECK(last(path, "spin") == relative(300 * std::acos(-1.) / 180, 1e-12));
    CHECK(balance(energy) < 1e-12);
    CHECK(record(folder)["steps"] == 500);
}

TEST_CASE("rigid pieces: momenta of a free flight stay to the last digits") {
    const Folder folder("rigid momenta");
    const std::string bodies = block("a", "0, 5", "0.4, 0.3", "velocity = [3, 1]\nspin = \"300 deg/s\"\n") +
                               block("b", "0, 8", "0.5, 0.3", "velocity = [-1, 2.5]\nspin = \"-200 deg/s\"\n");
    const auto at = [&](const char* end) {
        REQUIRE(run_to_end(folder, scene(bodies, "step = 1e-3\n", end)).code == 0);
        return momenta(folder);
    };
    const Momenta start = at("1e-6"), later = at("0.5");  // 500 steps
    const double size = 300 * std::hypot(3, 1) + 375 * std::hypot(1, 2.5);
    CHECK(std::hypot(later.x - start.x, later.y - start.y) < 1e-15 * size);
    CHECK(std::abs(later.angular - start.angular) < 1e-13 * later.scale);  // its spin is read from corners 9 m away
}

TEST_CASE("rigid pieces: full turns are counted in long steps") {
    const Folder folder("rigid turns");
    const std::string text =
        scene(block("b", "0, 5", "0.4, 0.3", "spin = \"1440 deg/s\"\n") + weight, "step = 1e-2\n", "0.5");
    REQUIRE(run_to_end(folder, text).code == 0);
    CHECK(last(table(folder, "fragments.csv"), "rotation") == relative(720, 1e-10));
}

TEST_CASE("rigid pieces: equal blocks swap their speeds and a drop returns by e squared") {
    const Folder folder("rigid rebound");
    const std::string two = block("a", "0, 0", "0.2, 0.2", "velocity = [2, 0]\n") +
                            block("b", "0.3, 0", "0.2, 0.2", "velocity = [-1, 0]\n");
    const auto speeds = [&](const std::string& rigid, const std::string& contact) {
        std::string text = scene(two, rigid, "0.2");
        text.replace(text.find("[contact]\n"), 10, "[contact]\n" + contact);
        REQUIRE(run_to_end(folder, text).code == 0);
        const knap::History pieces = table(folder, "fragments.csv");
        const double left = pieces.column("centre_x")[0] < pieces.column("centre_x")[1] ? 0 : 1;
        return std::array{pieces.column("velocity_x")[std::size_t(left)],
                          pieces.column("velocity_x")[std::size_t(1 - left)]};
    };
    const auto swapped = speeds("restitution = 1\n", "");
    CHECK(swapped[0] == relative(-1, 1e-12));
    CHECK(swapped[1] == relative(2, 1e-12));
    CHECK(speeds("", "")[1] == relative(0.5 + 0.5 * 0.9 * 3, 1e-12));  // rigid.restitution
    const auto given = speeds("", "restitution = 0.4\n");              // [contact] comes before it
    CHECK(given[0] == relative(0.5 - 0.5 * 0.4 * 3, 1e-12));
    // the impact of a fall of 1 m at its time within a step, e = 0.6: the places of both flights, whatever the step
    for (const char* step : {"1e-3", "7e-4"}) {
        const std::string text = scene(block("b", "0, 1", "0.3, 0.3") + ground("restitution = 0.6\n") + weight,
                                       std::string("step = ") + step + "\n", "0.46");
        REQUIRE(run_to_end(folder, text).code == 0);
        const double left = 0.46 - std::sqrt(2 / 9.81), height = (0.6 * std::sqrt(2 * 9.81) - 0.5 * 9.81 * left) * left;
        CHECK(last(table(folder, "fragments.csv"), "centre_y") == relative(0.15 + height, 1e-12));
        const double lost = 0.5 * 2500 * 0.09 * (1 - 0.36) * 2 * 9.81;
        CHECK(last(table(folder, "energy.csv"), "impact_work") == relative(-lost, 1e-11));
    }
}

TEST_CASE("rigid pieces: a corner that a turn lifts before it is struck does no positive work") {
    const Folder folder("rigid graze");
    const std::string text = scene(
        "[[body]]\nshape = \"polygon\"\npoints = [[0, 1e-6], [0.5, 0.500001], [0, 1.000001], "
        "[-0.5, 0.500001]]\nvelocity = [1, -0.003]\nspin = -1700\n" +
            ground("friction = 0.5\nR_N = 0.5\n") + weight,
        "step = 5e-4\n", "0.002", whole, "0.7");
    const Answer answer = run_to_end(folder, text);
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    CHECK(last(table(folder, "energy.csv"), "impact_work") <= 0);
}

TEST_CASE("rigid pieces: what strikes while it spins moves alike in any step") {
    const Folder folder("rigid spin");
    const auto path = [&](const char* step) {
        const std::string text = scene(block("b", "0, 0.4", "0.4, 0.2", "spin = \"250 deg/s\"\n") +
                                           ground("R_N = 0.7\nR_T = 0.8\nfriction = 2\n") + weight,
                                       std::string("step = ") + step + "\n", "0.42");
        REQUIRE(run_to_end(folder, text).code == 0);
        CHECK(balance(table(folder, "energy.csv")) < 1e-12);
        const knap::History end = table(folder, "fragments.csv");
        CHECK(last(table(folder, "energy.csv"), "impact_work") < -1);
        return std::array{last(end, "centre_x"), last(end, "centre_y"), last(end, "rotation")};
    };
    const auto coarse = path("1e-3"), fine = path("1e-4");
    CHECK(std::abs(coarse[0] - fine[0]) < 1e-10);
    CHECK(std::abs(coarse[1] - fine[1]) < 1e-10);
    CHECK(std::abs(coarse[2] - fine[2]) < 1e-7);
}

TEST_CASE("rigid pieces: one that may break and its terrain with R_T do not overlap") {
    const Folder folder("rigid kept slip");
    const std::string text = scene(block("b", "0, 0.001", "0.3, 0.2", "velocity = [0.5, 0]\n") +
                                       ground("friction = 0.5\nR_N = 0.4\nR_T = 0.8\n") + weight,
                                   "step = 1e-3\n", "0.05", weak);
    REQUIRE(run_to_end(folder, text).code == 0);
    CHECK(record(folder)["pieces"]["deformable_time_s"] == 0);
    double lowest = 1;
    for (const double y : table(folder, "fragment_history.csv").column("from_y")) lowest = std::min(lowest, y);
    CHECK(lowest > -1e-12);
    // friction brakes from the first contact on, and the velocity is that of the middle of the last step
    CHECK(std::abs(last(table(folder, "fragments.csv"), "velocity_x") - (0.5 - 0.5 * 9.81 * 0.05)) < 3e-3);
}

TEST_CASE("rigid pieces: check estimates the steps of what cannot break as rigid ones") {
    const Folder folder("rigid check");
    for (const bool breaks : {false, true}) {
        CAPTURE(breaks);
        const std::string text = accepted(folder, scene(block("b", "0, 0.4", "0.4, 0.2") + ground() + weight,
                                                        "step = 1e-3\n", "0.5", breaks ? weak : whole))
                                     .text;
        CAPTURE(text);
        const auto between = [&](const std::string& start, const std::string& end) {
            const std::size_t at = text.find(start);
            REQUIRE(at != std::string::npos);
            return text.substr(at + start.size(), text.find(end, at) - at - start.size());
        };
        CHECK((between(", steps ", ", frames") == between("steps take ", " of processor")) == !breaks);
        CHECK((text.find("if none is; the time above has a blow a second") != std::string::npos) == breaks);
    }
}

TEST_CASE("rigid pieces: a tip does not pass through a wide crack that one whole point holds in a heap that breaks") {
    const Folder folder("rigid heap");
    // at 0.578 s a broken triangle is thrown against such a point
    const std::string heap =
        "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.3\n[[bodies]]\nname = \"m\"\npattern = \"heap\"\n"
        "box = [0.5, 0.5, 6.5, 6]\nnumber = 40\nsize = 0.6\n[material.rock]\ndensity = 2600\nE = 20e9\nnu = 0.25\n"
        "[interface.default]\nsigma_c = 12e6\nG_c = 200\n[contact]\nfriction = 0.65\nrestitution = 0\n"
        "[rigid]\nstep = 0.5e-3\nsleep = 0\n[[obstacle]]\nname = \"bin\"\nshape = \"polyline\"\n"
        "points = [[10, 8], [7, 0], [0, 0], [-3, 8]]\nfriction = 0.6\nrestitution = 0\n" +
        weight + "[time]\nend = 0.66\n[output]\nfields = false\n";
    const Answer answer = run_to_end(folder, heap);
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    for (const auto& gate : record(folder)["gates"])
        if (gate["name"] == "contact_depth") CHECK(gate["value"] < 0.02);
}

TEST_CASE("rigid pieces: what turns back or comes to a stand on a corner does not fall asleep there") {
    const Folder folder("rigid turn");
    const std::string pull = "[[load]]\nacceleration = [-0.1712, -9.8085]\n";  // 1 degree
    const std::string up = block("b", "-0.5, 0", "1, 1", "velocity = [0.1, 0]\n") + ground("friction = 0\n") + pull;
    REQUIRE(run_to_end(folder, scene(up, "restitution = 0\n", "1.6")).code == 0);  // slower than 2 cm/s for 0.23 s
    CHECK(record(folder)["pieces"]["asleep"] == 0);
    CHECK(last(table(folder, "fragment_history.csv"), "to_x") == relative(0.1 * 1.6 - 0.5 * 0.1712 * 1.6 * 1.6, 1e-9));

    // its energy is that of the block on its corner
    const std::string tipped = block("b", "0, 0", "0.2, 1",
                                     "velocity = [0.37230798986302027, 0.07446159797260406]\n"
                                     "spin = \"-42.66335329630099 deg/s\"\n") +
                               ground("friction = 5\n") + weight;
    double x[2];
    for (const int sleeps : {0, 1}) {
        REQUIRE(run_to_end(folder, scene(tipped, sleeps ? "restitution = 0\n" : "restitution = 0\nsleep = 0\n", "3"))
                    .code == 0);
        x[sleeps] = last(table(folder, "fragment_history.csv"), "to_x");
    }
    CHECK(record(folder)["pieces"]["asleep"] == 0);
    CHECK(std::abs(x[1] - x[0]) < 1e-12);
}

TEST_CASE("rigid pieces: steps are divided as far as a small fast piece needs") {
    const Folder folder("rigid small");
    const std::string text = scene(
        block("b", "0, 0.2", "0.05, 0.05", "velocity = [0, -40]\n") + ground("friction = 0\nR_N = 0.5\n") + weight, "",
        "0.0055", whole, "0.005");
    REQUIRE(run_to_end(folder, text).code == 0);
    const double struck = std::sqrt(40 * 40 + 2 * 9.81 * 0.2), at = (struck - 40) / 9.81;
    CHECK(last(table(folder, "fragments.csv"), "centre_y") == relative(0.025 + 0.5 * struck * (0.0055 - at), 1e-4));
}

TEST_CASE("rigid pieces: an opening that counts as none in a step is none in the books of an island") {
    const Folder folder("rigid closed");
    const std::string wedge =
        "[[obstacle]]\nname = \"w\"\nshape = \"polyline\"\nfriction = 0.4\nR_N = 0.3\npoints = [[3, -0.8], [0.6, "
        "-0.8], "
        "[0, 0], [-0.6, -0.8], [-3, -0.8]]\n";
    const std::string beam =
        block("a", "-1, 0.02", "2, 0.4", "velocity = [0, -4]\ncrack = [{ points = [[0.01, 0.42], [0, 0.12]] }]\n");
    REQUIRE(run_to_end(folder, scene(beam + wedge + weight, "", "0.04", "sigma_c = 3e6\nG_c = 2e5\n", "0.13")).code ==
            0);
    const knap::History energy = table(folder, "energy.csv");
    CHECK(record(folder)["pieces"]["micro_steps"].get<int>() > 1000);
    CHECK(last(energy, "dissipated") + last(energy, "recoverable") > 1000);
    // 1e-5 of delta_c times sigma_c at twenty points is 18 J, which each of 70 closings booked again
    CHECK(std::abs(last(energy, "step_change_work")) <
          0.01 * (last(energy, "dissipated") + last(energy, "recoverable")));
    CHECK(balance(energy) < 1e-12);
}

// Of a foot, a third of the slab makes 0.07 m/s in a step: twice the least blow. What slides has 100 J, and no blow.
TEST_CASE("rigid pieces: weight alone thaws nothing that it cannot break") {
    const Folder folder("rigid weight");
    std::string bodies = block("slab", "0, 0.1405", "1, 0.6") + ground("friction = 0.5\nR_N = 0.3\n") + weight +
                         block("slides", "0.05, 0.7405", "0.2, 0.1", "velocity = [2, 0]\n");
    for (const char* foot : {"0.02, 0.14", "0.3, 0.139", "0.6, 0.1395", "0.85, 0.14"}) {
        const std::string at = foot, x = at.substr(0, at.find(','));
        bodies += block("foot" + x.substr(2), x + ", 0", "0.1" + at.substr(at.find(',')));
    }
    REQUIRE(run_to_end(folder, scene(bodies, "", "0.8", "sigma_c = 1e6\nG_c = 50\n")).code == 0);
    CHECK(record(folder)["pieces"]["asleep"] == 6);
    CHECK(record(folder)["pieces"]["deformable_time_s"] < 0.1);
}

TEST_CASE("rigid pieces: momenta of a free cluster are exact and its balance closes") {
    const Folder folder("rigid cluster");
    std::string bodies;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            std::ostringstream at, motion;
            at << 0.31 * i << ", " << 0.31 * j;
            motion << "velocity = [" << 2 * (1 - i) + 0.3 * j << ", " << 1.5 * (1 - j) << "]\nspin = \""
                   << 100 * (i - j) << " deg/s\"\n";
            bodies += block("b" + std::to_string(3 * i + j), at.str(), "0.3, 0.25", motion.str());
        }
    for (const char* restitution : {"0", "0.3"}) {  // places of what overlaps are corrected
        const auto at = [&](const char* end) {
            const std::string rigid = std::string("step = 2e-3\nrestitution = ") + restitution + "\n";
            REQUIRE(run_to_end(folder, scene(bodies, rigid, end)).code == 0);
            return momenta(folder);
        };
        const Momenta start = at("1e-6"), later = at("0.3");
        CHECK(std::abs(later.x - start.x) < 1e-13 * start.scale);
        CHECK(std::abs(later.y - start.y) < 1e-13 * start.scale);
        CHECK(std::abs(later.angular - start.angular) < 1e-12 * start.scale);
        const knap::History energy = table(folder, "energy.csv");
        CHECK(balance(energy) < 1e-12);
        CHECK(last(energy, "impact_work") < -100);
        CHECK(last(energy, "rigid_injection") < 1e-3 * -last(energy, "impact_work"));
    }
}

TEST_CASE("rigid pieces: a heap falls asleep and lies still and the run ends there") {
    const Folder folder("rigid heap");
    std::string bodies = ground() +
                         "[[obstacle]]\nname = \"left\"\nshape = \"half plane\"\nat = [-0.1, 0]\nnormal = "
                         "[1, 0]\n[[obstacle]]\nname = \"right\"\nshape = \"half plane\"\nat = [1, 0]\n"
                         "normal = [-1, 0]\n";
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            std::ostringstream at;
            at << 0.33 * i + 0.02 * j << ", " << 0.05 + 0.3 * j;
            bodies += block("b" + std::to_string(3 * i + j), at.str(), "0.28, 0.2", "spin = \"40 deg/s\"\n");
        }
    const std::string text = scene(bodies + weight, "restitution = 0\n", "8\nuntil = \"rest\"");
    REQUIRE(run_to_end(folder, text).code == 0);
    const Json json = record(folder);
    CHECK(json["ended"] == "rest");
    CHECK(json["pieces"]["asleep"] == 9);
    CHECK(json["time_s"].get<double>() < 5);
    CHECK(std::abs(last(table(folder, "energy.csv"), "kinetic")) < 1e-30);  // rounding of the sum over the pieces
    CHECK(balance(table(folder, "energy.csv")) < 1e-12);

    const std::string awake = scene(bodies + weight, "restitution = 0\nsleep = 0\n", "6");
    REQUIRE(run_to_end(folder, awake, " --force --until 4s").code == 0);
    const knap::History before = table(folder, "fragments.csv");
    REQUIRE(run_to_end(folder, awake, "").code == 0);
    const knap::History after = table(folder, "fragments.csv");
    for (const char* column : {"centre_x", "centre_y"})
        for (std::size_t i = 0; i < before.rows.size(); ++i)
            CHECK(std::abs(after.column(column)[i] - before.column(column)[i]) < 1e-9);
}

TEST_CASE("rigid pieces: a breakable body freezes in flight and thaws for the blow") {
    const Folder folder("rigid thaw");
    const std::string bodies = block("b", "0, 0.5", "0.4, 0.3", "velocity = [1, 0]\nspin = \"200 deg/s\"\n") +
                               ground() + weight + "[[initial]]\nstrain_rate = [3.2, 0, 0]\n";
    const std::string text = scene(bodies, "hold = 10\n", "0.32", weak);
    REQUIRE(run_to_end(folder, text).code == 0);
    const Json json = record(folder);
    const knap::History energy = table(folder, "energy.csv");
    CHECK(json["pieces"]["thaws"].get<int>() >= 1);
    CHECK(json["pieces"]["deformable_time_s"].get<double>() < 0.1);
    CHECK(last(energy, "vibration_booked") < 0);
    CHECK(balance(energy) < 1e-12);
    CHECK(last(energy, "dissipated") > 0);
    // while it flies as a rigid piece its strain energy stays to all digits
    const auto strain = energy.column("strain"), step = energy.column("step"),
               booked = energy.column("vibration_booked"), dissipated = energy.column("dissipated");
    int n = 0;
    for (std::size_t i = 1; i < step.size(); ++i) {
        if (!(step[i] > 1e-4 && step[i - 1] > 1e-4) || booked[i] != booked[i - 1]) continue;
        if (dissipated[i] != dissipated[i - 1]) continue;  // hit, and deformable
        ++n;
        CHECK(strain[i] == strain[i - 1]);
    }
    CHECK(n > 10);
    // it became rigid when its vibration was slower than the slowest blow that may break it
    const double mass = 2500 * 0.4 * 0.3, blow = 0.3 * 8e6 / std::sqrt(2500 * 30e9), start = 3.2 * 0.4 / std::sqrt(12.);
    CHECK(start > 1.3 * blow);
    const auto first = std::ranges::find_if(booked, [](double value) { return value < 0; });
    CHECK(*first >= -0.5 * mass * blow * blow);
}

TEST_CASE("rigid pieces: islands keep momenta and the balance of a free cluster") {
    const Folder folder("rigid islands");
    std::string bodies;
    for (int i = 0; i < 3; ++i) {
        std::ostringstream at, motion;
        at << 0.41 * i << ", " << 0.05 * i;
        motion << "velocity = [" << 4 * (1 - i) << ", 0]\nspin = \"" << 50 * i << " deg/s\"\n";
        bodies += block("b" + std::to_string(i), at.str(), "0.4, 0.3", motion.str());
    }
    bodies += block("far", "5, 5", "0.4, 0.3", "velocity = [1, 2]\nspin = \"90 deg/s\"\n");
    // with a viscosity that calms what vibrates, so that all are rigid at the end: momenta() is theirs
    const auto at = [&](const char* end) {
        REQUIRE(run_to_end(folder, scene(bodies, "hold = 3\n", end, weak, "0.15"),
                           " --force -s material.rock.bulk_viscosity=[0.1,0] -s material.rock.shear_viscosity=0.1")
                    .code == 0);
        return momenta(folder);
    };
    const Momenta start = at("1e-6"), later = at("0.02");
    CHECK(std::abs(later.x - start.x) < 1e-13 * start.scale);
    CHECK(std::abs(later.y - start.y) < 1e-13 * start.scale);
    CHECK(std::abs(later.angular - start.angular) < 1e-5 * start.scale);
    const knap::History energy = table(folder, "energy.csv");
    CHECK(balance(energy) < 1e-12);
    CHECK(last(energy, "dissipated") > 0);
    CHECK(last(energy, "thaw_dissipation") < 1e-2 * last(energy, "dissipated"));
    const Json pieces = record(folder)["pieces"];
    CHECK(pieces["thaws"].get<int>() >= 2);
    CHECK(pieces["micro_steps"].get<int>() > 100);
}

TEST_CASE("rigid pieces: a blow breaks what it breaks without them while others fly on") {
    const Folder folder("rigid blow");
    struct Broken {
        double length, law_lag;
    };
    const auto broken = [&](const std::string& body, double speed, bool rigid) -> Broken {
        std::ostringstream motion, end;
        motion << "velocity = [0, " << -speed << "]\n";
        end << 0.01 / speed + 0.003;
        std::string text = scene(body + motion.str() + block("far", "5, 5", "0.4, 0.3") + ground(), "step = 5e-4\n",
                                 end.str(), weak, "0.1");
        if (!rigid) text.replace(text.find("[rigid]\n"), 20, "");
        REQUIRE(run_to_end(folder, text).code == 0);
        const Json summary = record(folder)["summary"];
        return {summary["broken_length"].get<double>(), summary["law_lag_at_end"].get<double>()};
    };
    const std::string on_side = block("b", "0, 0.01", "0.4, 0.3"),
                      on_corner =
                          "[[body]]\nname = \"b\"\nshape = \"polygon\"\npoints = [[0, 0.01], [0.3, 0.25], "
                          "[0.05, 0.5], [-0.2, 0.3]]\n";
    for (const auto& [body, speed, breaks] :
         {std::tuple(on_side, 0.5, false), std::tuple(on_side, 1., false), std::tuple(on_corner, 2., false),
          std::tuple(on_corner, 4., true), std::tuple(on_side, 8., true), std::tuple(on_corner, 8., true)}) {
        const Broken without = broken(body, speed, false), with = broken(body, speed, true);
        CHECK((without.length > 0) == breaks);
        CHECK(with.length == relative(without.length, 1e-9));
        CHECK(std::abs(with.law_lag - without.law_lag) < 0.01);
    }
}

// b leaves the blow with 4 m/s, four times the gap to c in a step: c lies out of the reach of its speed before
TEST_CASE("rigid pieces: what a blow throws at a neighbour behind a gap meets it") {
    const Folder folder("rigid row");
    const auto moved = [&](const std::string& rigid) {
        const std::string bodies = block("a", "0, 0", "0.2, 0.2", "velocity = [4, 0]\n") +
                                   block("b", "0.21, 0.02", "0.2, 0.2") + block("c", "0.4105, 0.05", "0.2, 0.2");
        REQUIRE(run_to_end(folder, scene(bodies, rigid, "0.05", "sigma_c = 8e7\nG_c = 2000\n")).code == 0);
        for (const Json& gate : record(folder)["gates"]) {
            if (gate["name"] == "overlap") CHECK(gate["value"] == 0.0);
            if (gate["name"] == "contact_depth") CHECK(gate["value"].get<double>() < 0.02);
        }
        double furthest = 0;
        for (const double x : table(folder, "fragments.csv").column("centre_x")) furthest = std::max(furthest, x);
        return furthest - 0.5105;
    };
    CHECK(moved("") == relative(moved("thaw = 0\n"), 0.01));
}

TEST_CASE("rigid pieces: thaw = 0 has the bits of a run without them") {
    const Folder folder("rigid never");
    const std::string text = scene(block("b", "0, 0.01", "0.4, 0.3", "velocity = [1, -2]\n") + ground() + weight,
                                   "thaw = 0\n", "0.01", weak);
    std::string without = text;
    without.replace(without.find("[rigid]\nthaw = 0\n"), 17, "");
    write_scene(folder, text);
    REQUIRE(run_scene(folder, "-j 1 -o " + folder.in_shell("never")).code == 0);
    write_scene(folder, without);
    REQUIRE(run_scene(folder, "-j 1 -o " + folder.in_shell("absent")).code == 0);
    check_same(folder.path / "absent", folder.path / "never", 4);
}

TEST_CASE("rigid pieces: threads and a stop within a rigid phase change no bit") {
    const Folder folder("rigid bits");
    std::string bodies = ground() + weight;
    for (int i = 0; i < 3; ++i) {
        std::ostringstream at;
        at << 0.42 * i << ", " << 0.1 + 0.1 * i;
        bodies += block("b" + std::to_string(i), at.str(), "0.4, 0.3", "velocity = [0.5, 0]\nspin = \"30 deg/s\"\n");
    }
    write_scene(folder, scene(bodies, "hold = 5\n", "0.3", weak, "0.15"));
    check_threads_and_parts(folder, {"2", "4"}, {"0.05", "0.21"}, 4);
}

TEST_CASE("rigid pieces: what they do not know is refused with the reason") {
    const Folder folder("rigid refused");
    const std::string bodies = block("b", "0, 1", "0.4, 0.3") + ground() + weight;
    check_refused(folder, scene(bodies + "[[load]]\non = \"b.top\"\ntraction = [0, -1e6]\n", "", "0.1"),
                  "exclusive-keys", "would never break");
    check_refused(folder, scene(bodies + "[[load]]\non = \"b.top\"\nvelocity = [0, -1]\n", "", "0.1"), "exclusive-keys",
                  "a driven boundary deforms its piece");
    check_refused(folder, scene(bodies + "[heat]\ntemperature = \"30*t\"\n", "", "0.1"), "exclusive-keys",
                  "a rigid one has no strains of its own");
    std::string alone = scene(bodies, "", "0.1");
    alone.replace(alone.find("[contact]\n"), 10, "");
    check_refused(folder, alone, "exclusive-keys", "needs contact between pieces");
}

}  // namespace rigid_pieces_test
