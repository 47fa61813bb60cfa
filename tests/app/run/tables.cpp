// Tables over time and temperature against the steps and the range of a run, from `check` to the end of the run.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

namespace tables_test {

using namespace program;
using knap::tests::relative;

namespace {

const std::string pulse = "table = [[0, 0], [12, 0], [13, 1], [17, 1], [18, 0]]\n";

/// A bar in 20 steps of 50 s.
std::string bar(const std::string& more) {
    return "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.02]\nmodel = \"plane stress\"\n[mesh]\nsize = "
           "0.01\n[material.a]\ndensity = 2000\nE = 20e9\nnu = 0.2\nconductivity = 3\nheat_capacity = 800\n"
           "[time]\nend = 1000\nbulk = \"implicit\"\nstep = 50\ntheta = 1\n[output]\nfields = false\nreport = false\n"
           "[[load]]\non = \"left\"\ndisplacement = [0, 0]\n" +
           more;
}

const std::string strong = "[interface.default]\nbreakable = false\n",
                  weak = "[interface.default]\nsigma_c = 1e6\nG_c = 50\n",
                  pulled = "[[load]]\non = \"right\"\ntraction = [1e5, 0]\n",
                  heated =
                      "[heat]\ntemperature = \"0\"\nconduction = true\n[[heat.exchange]]\non = \"left\"\nflux = 1e6\n";

Answer of(const Folder& folder, const std::string& words, const std::string& scene) {
    std::ofstream(folder.path / "bar.toml") << scene;
    return command(words + folder.in_shell("bar.toml"));
}

knap::History energy_of(const Folder& folder, const std::string& scene) {
    const Answer run = of(folder, "run -q --force -o " + folder.in_shell("run") + " ", scene);
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    return knap::read_csv(folder.path / "run" / "energy.csv");
}

}  // namespace

TEST_CASE("tables: implicit steps end at the corners of a pulse and meet its peak") {
    const Folder folder("pulse_of_load");
    const Answer check = of(folder, "check ", bar(strong + pulled + pulse));
    CAPTURE(check.text);
    CHECK(check.has("4 of them end at corners of tables over time"));
    const knap::History energy = energy_of(folder, bar(strong + pulled + pulse));
    const std::vector<double> time = energy.column("time"), strain = energy.column("strain");
    for (std::size_t i = 0; i < time.size(); ++i)
        if (time[i] == 17) CHECK(strain[i] == relative(0.5 * 1e10 * 0.1 * 0.02 / 20e9, 0.1));
    CHECK(std::ranges::count(time, 17) == 1);
    CHECK(strain.back() < 1e-9 * std::ranges::max(strain));
    // ten times the strength, for 5 s
    const auto dissipates = [&](const char* traction) {
        const Answer run = of(folder,
                              "run -q --force -o " + folder.in_shell("run") +
                                  " -s mesh.size=0.02 -s 'load[1].traction=[" + traction + ", 0]' ",
                              bar(weak + pulled + pulse));
        CAPTURE(run.text);
        CHECK(run.has("  dissipated  "));
        return !run.has("  dissipated               0 J");
    };
    CHECK(dissipates("1e7"));
    CHECK_FALSE(dissipates("1e5"));
}

TEST_CASE("tables: a step takes all of the heat of a pulse and check names it") {
    const Folder folder("pulse_of_flux");
    const std::string scene = bar(strong + heated + pulse);
    CHECK(energy_of(folder, scene).column("heat_in").back() == relative(1e6 * 0.02 * 5, 1e-12));
    const Answer check = of(folder, "check ", scene);
    CAPTURE(check.text);
    CHECK(check.has("warning[unresolved-table]: `heat.exchange[0]` has a peak of its factor, 1 at t = 13 s"));
    CHECK_FALSE(of(folder, "check ", bar(strong + heated + "ramp = 500\n")).has("unresolved-table"));
}

TEST_CASE("tables: explicit steps that miss a peak are named") {
    const Folder folder("pulse_explicit");
    const auto check = [&](const std::string& table, const std::string& load) {
        return of(folder, "check -s time.bulk=explicit -s time.end=1e-3 -s time.step=auto -s time.theta=0.5 ",
                  bar(strong + "[[load]]\non = \"right\"\n" + load + table));
    };
    const std::string short_one = "table = [[0, 0], [1.2e-6, 0], [1.3e-6, 1], [1.4e-6, 0]]\n",
                      long_one = "table = [[0, 0], [1e-4, 1], [2e-4, 0]]\n";
    const Answer named = check(short_one, "traction = [1, 0]\n");
    CAPTURE(named.text);
    CHECK(named.has("warning[unresolved-table]: `load[1]` has a peak"));
    CHECK(check(short_one, "displacement = [1e-9, 0]\n").has("this motion is not made"));
    const std::string ball =
        "traction = [0, 0]\n[[obstacle]]\nshape = \"disc\"\ncentre = [0.05, 0.2]\nradius = 0.05\nturns = false\n";
    for (const char* motion : {"mass = 3\nforce = [0, 1]\n", "velocity = [0, 0.1]\n"}) {
        const Answer of_obstacle = check(short_one, ball + motion);
        CAPTURE(of_obstacle.text);
        CHECK(of_obstacle.has("warning[unresolved-table]: `obstacle[0]` has a peak"));
        CHECK_FALSE(check(long_one, ball + motion).has("unresolved-table"));
    }
    CHECK_FALSE(check(long_one, "traction = [1, 0]\n").has("unresolved-table"));
}

TEST_CASE("tables: a run that does not meet the range of a table is a warning") {
    const Folder folder("range_of_table");
    const auto check = [&](const std::string& more) {
        const Answer answer = of(folder, "check ", bar(more));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        return answer;
    };
    CHECK(check(strong + pulled + "ramp = 2e6\n").has("has a factor of at most 0.0005 until the run ends at 1000 s"));
    CHECK(check(strong + pulled + "table = [[-20, 0], [-10, 2]]\n").has("warning[before-the-start]"));
    CHECK_FALSE(check(strong + pulled + "ramp = 1e5\n").has("-the-"));
    CHECK_FALSE(check(strong + pulled + "table = [[-20, 0], [10, 2]]\n").has("-the-"));
    const auto cooled = [&](const std::string& table) {
        return check(weak + "strength_table = " + table +
                     "\n[heat]\ntemperature = \"-4\"\nramp = 500\nreference = 0\n");
    };
    CHECK(cooled("[[263, 1], [273, 0.2]]")
              .has("warning[table-not-reached]: `interface.default.strength_table` covers 263 to 273"));
    CHECK(cooled("[[-1, 0.9], [0, 0.2]]").has("go far beyond it"));
    CHECK_FALSE(cooled("[[-10, 1], [0, 0.2]]").has("table-not-reached"));
    CHECK_FALSE(cooled("[[-1, 1], [-0.5, 1], [0, 0.2]]").has("table-not-reached"));
}

TEST_CASE("tables: a grid of temperatures beside the body or after the run is a warning") {
    const Folder folder("grid_of_table");
    const auto check = [&](const std::string& rows) {
        std::ofstream(folder.path / "T.csv") << rows;
        const Answer answer = of(folder, "check ", bar(strong + "[heat]\ntemperature = \"T.csv\"\n"));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        return answer;
    };
    CHECK_FALSE(check("0, 0, 1\n0.1, 0, 2\n").has("table-not-reached"));
    CHECK(check("0, 0, 1\n100, 0, 2\n").code == 0);
    CHECK(check("0, 0, 1\n0.05, 0, 2\n").has("covers x = 0 to 0.05 m, and the body extends from 0 to 0.1 m"));
    CHECK(check("200, 0, 1\n300, 0, 2\n").has("covers x = 200 to 300 m"));
    CHECK(check("0, 0, 2000, 1\n0, 0, 3000, 2\n").has("covers t = 2000 to 3000 s, and the run goes from 0 to 1000 s"));
    CHECK_FALSE(check("0, 0, 0, 1\n0, 0, 300, 2\n").has("table-not-reached"));
}

TEST_CASE("tables: a temperature that bends within an edge is a warning with the size that resolves it") {
    const Folder folder("bend_of_temperature");
    const auto check = [&](const std::string& formula, const std::string& more = "") {
        const Answer answer = of(folder, "check ", bar(strong + "[heat]\ntemperature = \"" + formula + "\"\n" + more));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        return answer;
    };
    CHECK_FALSE(check("100*x + 20*y").has("bends within"));
    CHECK_FALSE(check("3").has("bends within"));
    // over h = 10 mm the parabola departs by h^2/4, 1/400 of its range
    CHECK_FALSE(check("x*x").has("bends within"));
    CHECK(check("exp(-x/0.003)").has("bends within an edge of"));
    CHECK(check("exp(-x/0.003)*t").has("% of its range from what is interpolated, at 500 s"));
}

}  // namespace tables_test
