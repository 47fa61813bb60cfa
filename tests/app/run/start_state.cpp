// A run that starts from the state of another one: its bits, its energy balance, and what is refused.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cstring>

namespace start_state_test {

using namespace program;
using knap::tests::relative;

namespace {

const std::string block =
    "edge_cracked_block -q -j 1 -s 'mesh.size=2 mm' -s 'time.step=0.1 us' -s 'expect={}' " + undrawn;
const std::string quench =
    "alumina_quench -q -j 1 -s 'mesh.size=1 mm' -s time.damping=0 -s 'expect={}' -s 'time.step=0.02 us' " + undrawn;
const std::string refined =
    "edge_cracked_block -q -j 1 -s 'mesh.size=4 mm' -s 'adapt={ size = \"0.5 mm\", every = 10 }' -s "
    "'interface.default.sigma_c=8 MPa' -s 'time.step=0.05 us' -s 'expect={}' " +
    undrawn;
const std::string implicit_block =
    "edge_cracked_block_implicit -q -j 1 -s 'mesh.size=5 mm' -s 'time.step=1 us' -s 'expect={}' " + undrawn;

/// The last line of a table without its time.
std::vector<double> last_line(const fs::path& table) {
    std::vector<double> line = knap::read_csv(table).rows.back();
    line.erase(line.begin());
    return line;
}

double column_end(const fs::path& table, const std::string& name) { return knap::read_csv(table).column(name).back(); }

/// The last frame but for its time: the line that describes it, and the first block of the data (head of 16 bytes, of
/// which the last four are the length of what follows).
std::string last_frame(const fs::path& run) {
    fs::path last;
    for (const auto& entry : fs::directory_iterator(run / "fields"))
        if (entry.path().extension() == ".vtu" && entry.path() > last) last = entry.path();
    std::string text = text_of(last);
    const std::size_t line = text.rfind('\n', text.find("\"TimeValue\""));
    text.erase(line, text.find('\n', line + 1) - line);
    const std::size_t data = text.find('_', text.find("<AppendedData")) + 1;
    std::uint32_t length = 0;
    std::memcpy(&length, text.data() + data + 12, sizeof length);
    return text.erase(data, 16 + length);
}

/// `whole` goes on to twice the time at which `rest` starts from it. Heat flows over differences of times, which round
/// differently where the clock starts again: `same_bits` = false.
void check_goes_on(const std::string& scene, const std::string& half, const std::string& end, const Folder& folder,
                   bool same_bits = true) {
    const fs::path whole = folder.path / "whole", rest = folder.path / "rest";
    const Answer first = command("run " + scene + "-s 'time.end=" + end + "' -s 'output.states=" + half + "' -o " +
                                 folder.in_shell("whole"));
    CAPTURE(first.text);
    REQUIRE(first.code == 0);
    const Answer second = command("run " + scene + "-s 'time.end=" + half + "' -s 'time.start=run:" + whole.string() +
                                  "@" + half + "' -o " + folder.in_shell("rest"));
    CAPTURE(second.text);
    REQUIRE(second.code == 0);
    CHECK(second.has("the time counts from 0 again"));
    const std::vector<double> energies = last_line(whole / "energy.csv"), found = last_line(rest / "energy.csv");
    if (same_bits) {
        CHECK(energies == found);
        CHECK(text_of(whole / "fragments.csv") == text_of(rest / "fragments.csv"));
        CHECK(last_frame(whole) == last_frame(rest));
    } else {
        const double largest = std::abs(*std::ranges::max_element(energies, {}, [](double e) { return std::abs(e); }));
        REQUIRE(energies.size() == found.size());
        for (std::size_t i = 0; i < energies.size(); ++i) CHECK(std::abs(energies[i] - found[i]) <= 1e-9 * largest);
    }
    CHECK(column_end(rest / "energy.csv", "dissipated") > 0);
}

}  // namespace

TEST_CASE("a run that starts from another one goes on with its bits and its energy balance") {
    SUBCASE("explicit") { check_goes_on(block, "20 us", "40 us", Folder("start explicit")); }
    SUBCASE("implicit") { check_goes_on(implicit_block, "20 us", "40 us", Folder("start implicit")); }
    SUBCASE("with refinements") { check_goes_on(refined, "12 us", "24 us", Folder("start refined")); }
    SUBCASE("with heat") { check_goes_on(quench, "50 us", "100 us", Folder("start quench"), false); }
}

TEST_CASE("a start is repeated from its own directory and continued like any run") {
    const Folder folder("start again");
    REQUIRE(
        command("run " + block + "-s 'time.end=30 us' -s 'output.states=20 us' -o " + folder.in_shell("first")).code ==
        0);
    const std::string start = "-s 'time.start=run:" + (folder.path / "first").string() + "@20us' ";
    const std::string rest = "run " + block + "-s 'time.end=20 us' " + start;
    REQUIRE(command(rest + "-o " + folder.in_shell("rest")).code == 0);
    REQUIRE(command(rest + "-o " + folder.in_shell("parts") + " --until 8us").code == 0);
    REQUIRE(command(rest + "-o " + folder.in_shell("parts")).code == 0);
    check_same(folder.path / "rest", folder.path / "parts", 20);
    fs::remove_all(folder.path / "first");
    const Answer again =
        command("run " + folder.in_shell("rest/resolved.toml") + " -q -j 1 -o " + folder.in_shell("again"));
    CAPTURE(again.text);
    REQUIRE(again.code == 0);
    check_same(folder.path / "rest", folder.path / "again", 20);
    CHECK(text_of(folder.path / "rest/resolved.toml").find("start = \"run:start.state\"") != std::string::npos);
}

TEST_CASE("other loads act on the state of another run and its energy balance stays closed") {
    const Folder folder("start other loads");
    const std::string first = folder.in_shell("first");
    REQUIRE(command("run " + block + "-s 'time.end=30 us' -s 'output.states=20 us' -o " + first).code == 0);
    const std::string start = "-s 'time.start=run:" + (folder.path / "first").string() + "@20us' ";
    const auto go_on = [&](const std::string& settings) {
        const Answer run =
            command("run " + block + start + settings + "-s 'time.end=20 us' -o " + folder.in_shell("rest"));
        CAPTURE(run.text);
        REQUIRE(run.code == 0);
    };
    SUBCASE("pressed together") {
        go_on("-s 'load[0].traction=[\"0 MPa\", \"-2 MPa\"]' -s 'load[1].traction=[\"0 MPa\", \"2 MPa\"]' ");
        const std::vector<double> work = knap::read_csv(folder.path / "rest/energy.csv").column("external_work");
        CHECK(work[1] < work[0]);  // the faces still move apart
    }
    SUBCASE("damped and held at its ends") {
        go_on(
            "-s 'load=[{ on = \"top\", velocity = [0, 0] }, { on = \"bottom\", velocity = [0, 0] }]' "
            "-s 'time.damping=1e5 Hz' ");
        CHECK(column_end(folder.path / "rest/energy.csv", "damping_work") < 0);
    }
    SUBCASE("a displacement that begins elsewhere is a jump") {
        const Answer run = command("run " + block + start +
                                   "-s 'load=[{ on = \"top\", displacement = [0, \"1 mm\"], ramp = \"20 us\" }]' -s "
                                   "'time.end=1 us' -s limits.rotation=none -s limits.area_change=none -s "
                                   "limits.law_lag=none -o " +
                                   folder.in_shell("rest"));
        CHECK(run.has("begins with 0 m, where the other run is at "));
    }
    if (!fs::exists(folder.path / "rest/energy.csv")) return;
    const knap::History energy = knap::read_csv(folder.path / "rest/energy.csv");
    double largest = 0, worst = 0;
    for (const auto& name : {"kinetic", "strain", "external_work", "surface"})
        for (const double value : energy.column(name)) largest = std::max(largest, std::abs(value));
    for (const double residual : energy.column("residual")) worst = std::max(worst, std::abs(residual));
    CHECK(worst < 1e-10 * largest);
}

TEST_CASE("an explicit run starts from an implicit one") {
    const Folder folder("start slow");
    REQUIRE(
        command("run " + implicit_block + "-s 'time.end=30 us' -s 'output.states=20 us' -o " + folder.in_shell("slow"))
            .code == 0);
    const std::string start = "-s 'time.start=run:" + (folder.path / "slow").string() + "@20us' ";
    const Answer fast = command("run " + implicit_block + start +
                                "-s time.bulk=explicit -s time.cohesion=explicit -s time.step=auto -s "
                                "time.step_cracking= -s 'time.end=10 us' -o " +
                                folder.in_shell("fast"));
    CAPTURE(fast.text);
    REQUIRE(fast.code == 0);
    const knap::History slow = knap::read_csv(folder.path / "slow/energy.csv"),
                        energy = knap::read_csv(folder.path / "fast/energy.csv");
    CHECK(energy.column("time").front() == 0);
    CHECK(std::abs(energy.column("residual").back()) < 1e-10 * energy.column("external_work").back());
    CHECK(energy.column("external_work").front() > 0);
    // and back: a last step of nearly no length brings the velocities to its end
    const Answer back = command("run " + implicit_block + "-s 'time.start=run:" + (folder.path / "fast").string() +
                                "@10us' -s 'time.end=10 us' -o " + folder.in_shell("back"));
    CAPTURE(back.text);
    REQUIRE(back.code == 0);
    const knap::History again = knap::read_csv(folder.path / "back/energy.csv");
    CHECK(std::abs(again.column("residual").back()) < 1e-10 * again.column("external_work").back());
    // rows of explicit steps have the work up to the middle of the next step
    const std::vector<double> work = energy.column("external_work");
    CHECK(again.column("external_work").front() == relative(0.5 * (work.end()[-2] + work.back()), 1e-4));
}

// A bar between two ends that cools from above, slowly, until it tears; then one end is let go.
const std::string bar_body =
    "knap = 1\nname = \"bar\"\n[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.02]\n[mesh]\nsize = 0.005\n"
    "[material.a]\ndensity = 2000\nE = 20e9\nnu = 0.2\nexpansion = 1e-5\nconductivity = 2\nheat_capacity = 800\n"
    "[interface.default]\nsigma_c = 3e6\nG_c = 20\nfriction = 0.5\n";
const std::string slow_bar =
    bar_body + "[heat]\ntemperature = \"0\"\nconduction = true\n[[heat.exchange]]\non = \"top\"\ntemperature = -40\n" +
    "ramp = 100\n[[load]]\non = \"left\"\ndisplacement = [0, 0]\n[[load]]\non = \"right\"\n" +
    "displacement = [0, \"free\"]\n[time]\nend = 50\nbulk = \"implicit\"\nstep = 5\ntheta = 1\n" +
    "[output]\nreport = false\nfields = false\nstates = 50\n";

TEST_CASE("a fall starts from a slow run with heat: large rotations and contact and frozen temperatures or none") {
    const Folder folder("start chain");
    const auto file = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder.path / (name + ".toml")) << text;
        return folder.in_shell(name + ".toml");
    };
    const auto run = [&](const std::string& name, const std::string& text) {
        const Answer answer = command("run " + file(name, text) + " -q -j 1 -o " + folder.in_shell(name));
        CAPTURE(answer.text);
        return answer;
    };
    const auto energies = [&](const std::string& name) { return knap::read_csv(folder.path / name / "energy.csv"); };
    REQUIRE(run("slow", slow_bar).code == 0);
    const auto from = [](const std::string& state, const std::string& more = "") {
        return "[[load]]\non = \"left\"\ndisplacement = [0, 0]\n[time]\nend = \"60 us\"\nstart = \"run:" + state +
               "\"\n[output]\nreport = false\nfields = false\nstates = \"60 us\"\n" + more;
    };
    std::string large = bar_body;
    large.insert(large.find("[mesh]"), "rotation = \"large\"\n");
    std::string without_viscosity = large;  // as small rotations without contact have it
    without_viscosity.insert(large.find("[interface.default]"), "bulk_viscosity = [0, 0]\nshear_viscosity = 0\n");
    const std::string frozen = "[heat]\ntemperature = \"frozen\"\n";
    REQUIRE(run("small", bar_body + frozen + from("slow@50s")).code == 0);
    CHECK(command("render " + folder.in_shell("small") + " --show energy").code == 0);  // reads its resolved text
    REQUIRE(run("large", without_viscosity + frozen + "[contact]\n" + from("slow@50s")).code == 0);
    REQUIRE(run("middle", large + frozen + "[contact]\n" + from("small@60us")).code == 0);
    for (const char* name : {"small", "large", "middle"}) {
        CAPTURE(name);
        const knap::History energy = energies(name);
        const double largest = energies("slow").column("strain").back();
        for (const double residual : energy.column("residual")) CHECK(std::abs(residual) < 1e-13 * largest);
        CHECK(energy.column("thermal_work").front() == energies("slow").column("thermal_work").back());
        CHECK(energy.column("thermal_work").back() == energy.column("thermal_work").front());
        if (std::string_view(name) == "small") continue;
        // the rotations of the bar, up to 1e-3, are all that its energy can change by
        CHECK(energy.column("assumptions").front() != 0);
        CHECK(std::abs(energy.column("assumptions").front()) < 1e-3 * largest);
    }
    // the path of the bar is the same up to those rotations
    CHECK(energies("large").column("strain").back() == relative(energies("small").column("strain").back(), 1e-3));
    const Answer cold = run("cold", large + "[contact]\n" + from("slow@50s"));
    REQUIRE(cold.code == 0);
    CHECK(cold.has("warning[jump]: without heat the thermal strains of the other run vanish, and with them up to 5.8"));
    CHECK(energies("cold").column("assumptions").front() > 0.1 * energies("slow").column("strain").back());
    CHECK(std::abs(energies("cold").column("residual").back()) < 1e-13 * energies("cold").column("strain").front());
    // what cannot be
    const Answer back = run("back", bar_body + frozen + from("large@60us"));
    CHECK(back.code == 2);
    CHECK(back.has("`contact` is given there, nothing here; `domain.rotation` is \"large\" there, \"small\" here"));
    CHECK(back.has("what has turned would be strained"));
    const Answer alone = run("alone", large + frozen + "[time]\nend = 1\n");
    CHECK(alone.code == 2);
    CHECK(alone.has("needs temperatures of another run"));
    const Answer heated = run("heated", large + frozen + "ramp = 1\n" + from("slow@50s"));
    CHECK(heated.code == 2);
    CHECK(heated.has("has no meaning where temperatures are frozen"));
    std::string thaws = slow_bar, thawed = large;
    for (std::string* text : {&thaws, &thawed})
        text->insert(text->find("G_c"), "strength_table = [[-50, 1], [0, 0.9]]\n");
    REQUIRE(run("thaws", thaws).code == 0);
    const Answer lawless = run("lawless", large + from("thaws@50s"));
    CHECK(lawless.code == 2);
    CHECK(lawless.has("`interface.default.strength_table` is [[-50, 1], [0, 0.9]] there, nothing here"));
    CHECK(lawless.has("or frozen (temperature = \"frozen\", which keeps the strengths, too)"));
    REQUIRE(run("lawful", thawed + frozen + from("thaws@50s")).code == 0);
    CHECK(std::abs(energies("lawful").column("residual").back()) < 1e-13 * energies("thaws").column("strain").back());
}

TEST_CASE("a run that starts from another one may have every kind of output anew") {
    const Folder folder("start outputs");
    const auto run = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder.path / (name + ".toml")) << text;
        const Answer answer =
            command("run " + folder.in_shell(name + ".toml") + " -q -j 1 -o " + folder.in_shell(name));
        CAPTURE(answer.text);
        return answer;
    };
    const std::string scene = bar_body + "[[load]]\nname = \"pull\"\non = \"right\"\nvelocity = [\"1 m/s\", 0]\n",
                      times = "[time]\nend = \"5 us\"\n";
    REQUIRE(run("first", scene + times + "[output]\nreport = false\nfields = false\nstates = \"5 us\"\n").code == 0);
    const Answer next = run(
        "next", scene + times + "start = \"run:first\"\n[output]\nreport = false\nfields = false\n" +
                    "every = \"1 us\"\n[[probe]]\nname = \"end\"\nat = [0.1, 0.01]\n[[collector]]\nname = \"line\"\n" +
                    "x = 0.2\n[specimen]\ntest = \"tension\"\nforce = \"pull\"\naxis = \"x\"\n[limits]\nslip = 0.5\n" +
                    "[sweep]\nseeds = 2\n[expect]\nfragments = { at_least = 1 }\n[[figure]]\nfile = \"energy.svg\"\n" +
                    "show = \"energy\"\n");
    CHECK(next.code == 0);
    // from its last state, which it was asked to keep
    const knap::History before = knap::read_csv(folder.path / "first/energy.csv"),
                        after = knap::read_csv(folder.path / "next/energy.csv");
    CHECK(after.column("external_work").front() == before.column("external_work").back());
}

TEST_CASE("a run does not start from what it cannot use") {
    const Folder folder("start refused");
    const fs::path first = folder.path / "first";
    REQUIRE(command("run " + block + "-s 'time.end=20 us' -s 'output.states=[\"5 us\", \"10 us\"]' -o " +
                    folder.in_shell("first"))
                .code == 0);
    const auto start = [&](const std::string& from, const std::string& more = "") {
        const Answer answer =
            command("check " + block.substr(0, block.find(" -q")) +
                    " -s 'mesh.size=2 mm' -s 'time.step=0.1 us' -s 'time.start=" + from + "' " + more);
        CAPTURE(answer.text);
        return answer;
    };
    const std::string at = "run:" + first.string() + "@";
    CHECK(start(at + "10us").code == 0);
    CHECK(start(at + "10us").has("starts from the state"));
    CHECK(start(at + "10us", "-s 'mesh.size=1 mm'").has("`mesh.size` is 0.002 there, 0.001 here"));
    CHECK(start(at + "10us", "-s interface.default.G_c=4").has("`interface.default.G_c` is 3 there, 4 here"));
    CHECK(start(at + "7us").has("has no state at 7 µs; it has those at 5 µs, 10 µs, 1"));
    CHECK(start(at + "soon").has("has no time after @"));
    CHECK(start("run:" + first.string() + "/none").has("there is no run or state"));
    CHECK(start("run:" + folder.path.string() + "@10us").has("holds no run"));
    CHECK(start("walking").has("allowed: rest, equilibrium, run:*"));
    std::ofstream(first / "states/1e-05.state", std::ios::app) << "more";
    CHECK(start(at + "10us").has("states/1e-05.state` has "));
    CHECK(start(at + "10us").has(" bytes instead of "));
    CHECK(start(at + "10us").code == 2);
}

}  // namespace start_state_test
