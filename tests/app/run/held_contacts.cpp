// Contacts of free faces where motions are prescribed: on both sides of a contact, along it, or from rest.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cmath>

namespace held_contacts_test {

using namespace program;
using namespace knap;
using knap::tests::relative;

namespace {

/// Two blocks of 1 GPa with [contact].
std::string two_blocks(const std::string& one, const std::string& two, const std::string& mesh_size,
                       const std::string& loads, const std::string& end) {
    return "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = " + mesh_size +
           "\n[[body]]\nname = \"a\"\nshape = \"rectangle\"\n" + one +
           "\n[[body]]\nname = \"b\"\nshape = \"rectangle\"\n" + two +
           "\n[material.rock]\ndensity = 2600\nE = \"1 GPa\"\nnu = 0.25\n[interface.default]\nbreakable = "
           "false\nfriction = 0.3\nrestitution = 0\n[contact]\n" +
           loads + "[time]\nend = " + end + "\n[output]\nreport = false\nfields = false\nhistory_every = 0.005\n";
}
const std::string weight = "[[load]]\nacceleration = [0, -9.81]\n";

struct Outcome {
    int code;
    History reactions;

    double last(const std::string& column) const { return reactions.column(column).back(); }
    double mean(const std::string& column) const {
        const std::vector<double> values = reactions.column(column);
        double sum = 0;
        for (std::size_t i = values.size() / 2; i < values.size(); ++i) sum += values[i];
        return sum / static_cast<double>(values.size() - values.size() / 2);
    }
    double largest(const std::string& column) const {
        double largest = 0;
        for (const double value : reactions.column(column)) largest = std::max(largest, std::abs(value));
        return largest;
    }
};

Outcome run(const Folder& folder, const std::string& text) {
    std::ofstream(folder.path / "scene.toml") << text;
    const int code =
        command("run " + folder.in_shell("scene.toml") + " -q -j 1 --force --output " + folder.in_shell("run")).code;
    return {code, read_csv(folder.path / "run" / "reactions.csv")};
}

}  // namespace

TEST_CASE("held contacts: two blocks side by side that are held below bear their weights") {
    const Folder folder("held side by side");
    const Outcome found =
        run(folder, two_blocks("origin = [-2, -0.4]\nsize = [2, 0.4]", "origin = [0, -0.4]\nsize = [2, 0.4]", "0.2",
                               "[[load]]\nname = \"a\"\non = \"a.bottom\"\ndisplacement = [0, 0]\n"
                               "[[load]]\nname = \"b\"\non = \"b.bottom\"\ndisplacement = [0, 0]\n" +
                                   weight,
                               "0.1"));
    REQUIRE(found.code == 0);
    const double W = 2600 * 0.8 * 9.81;  // [N] of each
    CHECK(found.mean("a_force_y") + found.mean("b_force_y") == relative(2 * W, 0.05));
    CHECK(found.largest("a_force_x") < W);  // 1e16 N where shares of 1e-16 were levers
}

TEST_CASE("held contacts: two blocks on each other are guided along a plane of symmetry") {
    const Folder folder("held on symmetry");
    const Outcome found =
        run(folder, two_blocks("origin = [0, 0]\nsize = [1, 0.5]", "origin = [0, 0.5]\nsize = [1, 0.5]", "0.2",
                               "[[load]]\nname = \"a\"\non = \"a.left\"\ndisplacement = [0, \"free\"]\n"
                               "[[load]]\nname = \"b\"\non = \"b.left\"\ndisplacement = [0, \"free\"]\n"
                               "[[load]]\nname = \"floor\"\non = \"a.bottom\"\ndisplacement = [\"free\", 0]\n" +
                                   weight,
                               "0.1\nstart = \"equilibrium\""));
    REQUIRE(found.code == 0);  // gate impact_injection: friction along a plane that is held changed the normal rate
    CHECK(found.mean("floor_force_y") == relative(2600 * 9.81, 1e-6));
}

TEST_CASE("held contacts: a block that is driven from rest slides along one that is held without any weight") {
    const Folder folder("held and driven");
    const Outcome found =
        run(folder, two_blocks("origin = [0, 0]\nsize = [0.2, 0.1]", "origin = [0, 0.1]\nsize = [0.2, 0.1]", "0.05",
                               "[[load]]\nname = \"a\"\non = \"a.bottom\"\ndisplacement = [0, 0]\n"
                               "[[load]]\nname = \"b\"\non = \"b.left\"\nvelocity = [0.05, \"free\"]\nramp = 0.005\n",
                               "0.02"));
    REQUIRE(found.code == 0);  // all speeds at the start are zero but for those that are prescribed
    CHECK(found.last("b_u_x") == relative(0.05 * (0.02 - 0.0025), 1e-3));
}

TEST_CASE("held contacts: a step in seconds that leaves out the default viscosity is warned of") {
    const Folder folder("held no viscosity");
    const std::string scene = two_blocks("origin = [0, 0]\nsize = [1, 0.5]", "origin = [0, 0.5]\nsize = [1, 0.5]",
                                         "0.2", "[[load]]\non = \"a.bottom\"\ndisplacement = [0, 0]\n", "0.1");
    std::ofstream(folder.path / "scene.toml") << scene;
    const std::string check = "check " + folder.in_shell("scene.toml");
    CHECK(command(check).text.find("no-viscosity") == std::string::npos);
    CHECK(command(check + " -s time.step='\"20 us\"'").text.find("warning[no-viscosity]") != std::string::npos);
    CHECK(command(check + " -s time.step='\"20 us\"' -s material.rock.bulk_viscosity='[0, 0]'")
              .text.find("no-viscosity") == std::string::npos);
}

}  // namespace held_contacts_test
