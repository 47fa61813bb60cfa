// knap run with time.start = "equilibrium": a body that rests under its loads, and those that cannot begin.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

namespace run_preload_test {

using namespace program;

namespace {

/// A column of stone, glued to the support and pulled upwards; `load` on its top [MPa].
std::string column(const Folder& folder, const std::string& load, const std::string& more = "") {
    std::ofstream(folder.path / "column.toml")
        << "knap = 1\nname = \"column\"\n[domain]\nshape = \"rectangle\"\nsize = [\"100 mm\", \"300 mm\"]\n"
           "model = \"plane stress\"\n[mesh]\nsize = \"20 mm\"\n[material.stone]\ndensity = \"2000 kg/m3\"\n"
           "E = \"10 GPa\"\nnu = 0\n[interface.default]\nsigma_c = \"1 MPa\"\nG_c = \"10 J/m2\"\n"
           "[[support]]\non = \"bottom\"\ninterface = \"default\"\nglued = true\n[[load]]\non = \"top\"\n"
           "traction = [\"0 MPa\", \"0.9 MPa\"]\n[time]\nend = \"1 ms\"\nbulk = \"implicit\"\ncohesion = \"implicit\"\n"
           "start = \"equilibrium\"\n[output]\nfields = false\n"
        << more;
    return "run " + folder.in_shell("column.toml") + " -q -j 1 -s 'load[0].traction=[\"0 MPa\", \"" + load +
           " MPa\"]' -o " + folder.in_shell("run");
}

/// Dry masonry on a rough half plane: `bodies` under gravity.
std::string masonry(const Folder& folder, const std::string& bodies, const std::string& more = "") {
    std::ofstream(folder.path / "masonry.toml")
        << "knap = 1\n[domain]\nrotation = \"large\"\nthickness = \"1 m\"\n[mesh]\nsize = \"200 mm\"\n"
           "[material.rock]\ndensity = \"2000 kg/m3\"\nE = \"20 GPa\"\nnu = 0.2\n[interface.default]\n"
           "sigma_c = \"5 MPa\"\nG_c = \"50 J/m2\"\nfriction = 0.6\n[contact]\nfriction = 0.6\n[[obstacle]]\n"
           "name = \"ground\"\nshape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]\nfriction = 0.6\n[[load]]\n"
           "acceleration = [\"0 m/s2\", \"-10 m/s2\"]\n[time]\nend = \"1 ms\"\nstart = \"equilibrium\"\n[output]\n"
           "fields = false\n"
        << bodies << more;
    return folder.in_shell("masonry.toml");
}

/// It does not move, and the ground bears its weight [N].
void check_stands(const Folder& folder, const std::string& scene, double weight) {
    std::ostringstream expected;
    expected << " --force -q -j 1 -s 'expect={kinetic_energy={at_most=1e-15}, reaction_y={value=" << weight
             << ", within=1e-4}}' -o ";
    const Answer rests = command("run " + scene + expected.str() + folder.in_shell("run"));
    CAPTURE(rests.text);
    CHECK(rests.code == 0);
}

}  // namespace

TEST_CASE("a run from equilibrium begins with the strain of its preload and rests") {
    const Folder folder("preload");
    for (const char* bulk : {"implicit", "explicit"}) {
        const Answer rests = command(column(folder, "0.9") + " --force -s time.bulk=" + bulk +
                                     " -s 'expect={energy_residual={at_most=1e-12}, largest_speed={at_most=1e-9}, "
                                     "broken_length={at_most=0}, strain_energy={value=1.215, within=1e-9}}'");
        CAPTURE(rests.text);
        const auto record = nlohmann::json::parse(text_of(folder.path / "run/run.json"));
        double sum = 0;
        for (const auto& part : record["cpu_parts_s"]) sum += part.get<double>();
        CHECK(record["cpu_parts_s"]["preload"] > 0);
        CHECK(std::abs(sum - record["cpu_s"].get<double>()) <= 1e-9 * sum);
        CHECK(rests.code == 0);  // 1/2 sigma^2/E times the volume of .03 m3 is 1.215 J
    }
    std::string loud = column(folder, "0.9") + " --force";
    loud.erase(loud.find(" -q"), 3);
    CHECK(command(loud).text.find("search for the equilibrium at the start\n") != std::string::npos);
}

TEST_CASE("glue at an end whose motion is prescribed across it holds to its strength") {
    const Folder folder("preload_held");
    const Answer rests = command(
        column(folder, "0.9", "[[load]]\non = \"right\"\nvelocity = [\"0 m/s\", \"free\"]\n") +
        " -s 'expect={energy_residual={at_most=1e-12}, largest_speed={at_most=1e-9}, broken_length={at_most=0}}'");
    CAPTURE(rests.text);
    CHECK(rests.code == 0);
    CHECK_FALSE(rests.has("cohesion begins to fall"));
}

TEST_CASE("a run from equilibrium that its interfaces or supports do not hold fails and says where") {
    const Folder folder("overload");
    const Answer breaks = command(column(folder, "1.02"));
    CAPTURE(breaks.text);
    CHECK(breaks.code == 3);
    CHECK(
        breaks.has("no equilibrium under the loads at t = 0 s: the preload is more than the interfaces hold, what "
                   "breaks loose would move away with "));
    const Answer flies = command(column(folder, "0.5") + " --force -s 'support=[]'");
    CAPTURE(flies.text);
    CHECK(flies.code == 2);  // known before it runs
    CHECK(flies.has("nothing holds the body around (0.05, 0.15) m: a force of (0, 5e+04) N"));
    const Answer check = command("check " + folder.in_shell("column.toml") + " -s 'support=[]'");
    CHECK(check.code == 2);
    CHECK(check.has("error[not-held]"));
    CHECK(check.has("column.toml:"));
}

TEST_CASE("a wall of a pattern and a dry-stone wall of polygons start at rest with the weight on the ground") {
    const Folder folder("masonry");
    const std::string wall = masonry(folder,
                                     "[[bodies]]\nname = \"wall\"\npattern = \"wall\"\ncolumns = 2\nrows = 2\n"
                                     "block = [\"0.6 m\", \"0.3 m\"]\n");
    check_stands(folder, wall, 2000 * 10 * 1.2 * 0.6);
    const std::string stones = masonry(folder,
                                       "[[bodies]]\nname = \"wall\"\npattern = \"voronoi\"\nmesh_size = \"150 mm\"\n"
                                       "box = [\"0 m\", \"0 m\", \"2 m\", \"1 m\"]\nsize = \"0.4 m\"\n");
    check_stands(folder, stones, 2000 * 10 * 2 * 1);
}

TEST_CASE("a wall whose joints are open in part carries blocks at rest") {
    const Folder folder("joints");
    std::string bodies = "[[body]]\nname = \"wall\"\nshape = \"rectangle\"\nsize = [\"2 m\", \"0.9 m\"]\n";
    for (const char* joint : {"[[0, 0.3], [1.2, 0.3]]", "[[0.6, 0.6], [2, 0.6]]", "[[0.5, 0], [0.5, 0.3]]",
                              "[[1, 0], [1, 0.3]]", "[[1.5, 0], [1.5, 0.3]]", "[[0.75, 0.3], [0.75, 0.6]]"})
        bodies += std::string("[[body.crack]]\npoints = ") + joint + "\n";
    for (int i = 0; i < 3; ++i)
        bodies += "[[body]]\nname = \"block" + std::to_string(i) +
                  "\"\nshape = \"rectangle\"\nsize = [\"0.6 m\", \"0.3 m\"]\norigin = [" +
                  std::to_string(0.1 + 0.6 * i) + ", 0.9]\n";
    check_stands(folder, masonry(folder, bodies), 2000 * 10 * (1.8 + 3 * 0.18));
}

TEST_CASE("what hovers over other bodies or an obstacle is an error of check that says how far") {
    const Folder folder("hovers");
    const std::string wall = masonry(folder,
                                     "[[bodies]]\nname = \"wall\"\npattern = \"wall\"\ncolumns = 2\nrows = 3\n"
                                     "block = [\"0.6 m\", \"0.3 m\"]\ngap = \"1 mm\"\n");
    const Answer rows = command("check " + wall);
    CAPTURE(rows.text);
    CHECK(rows.code == 2);
    CHECK(rows.has("error[not-held]"));
    CHECK(rows.has("which hovers 1 mm from what is nearest: a force of (0, "));
    CHECK(rows.has("so it is with 4 more"));  // three blocks of the second row and two of the third
    const Answer whole = command("check " + wall + " -s 'bodies[0].gap=\"0 m\"' -s 'bodies[0].origin=[0, 0.002]'");
    CHECK(whole.code == 2);
    CHECK(whole.has("around (0.6, 0.452) m, which hovers 2 mm from what is nearest"));
    CHECK(command("check " + wall + " -s 'bodies[0].gap=\"20 um\"'").has("which hovers 20 \u00b5m from"));
    CHECK(command("check " + wall + " -s 'bodies[0].gap=\"0 m\"'").code == 0);
    std::ofstream(folder.path / "masonry.toml", std::ios::app)
        << "[[obstacle]]\nname = \"stone\"\nshape = \"disc\"\ncentre = [0.6, 1.3]\nradius = \"0.1 m\"\ndensity = "
           "\"2000 "
           "kg/m3\"\nvelocity = [\"free\", \"free\"]\n";
    const Answer stone =
        command("run " + wall +
                " -q --force -s 'bodies[0].gap=\"0 m\"' -s 'mesh.size=\"0.6 m\"' -s 'bodies[0].columns=1' -s "
                "'bodies[0].rows=1' -o " +
                folder.in_shell("run"));
    CAPTURE(stone.text);
    CHECK(stone.has("nothing holds the free obstacle `stone`, it would move away with 10 m/s2, at (0.6, 1.3) m"));
}

TEST_CASE("an interrupt ends the search for the equilibrium at the start") {
    const Folder folder("slow_preload");
    // a crack beyond its toughness on a fine mesh: the search takes minutes
    const Answer answer =
        command("--version >/dev/null; timeout --preserve-status --kill-after=20 5 '" KNAP_PROGRAM
                "' run edge_cracked_block -q -s 'time.start=\"equilibrium\"' -s 'mesh.size=\"0.5 mm\"' "
                "-o " +
                folder.in_shell("run"));
    CAPTURE(answer.text);
    CHECK(answer.code == 130);
    CHECK(answer.has("interrupted"));
}

}  // namespace run_preload_test
