// A finished run goes on to a later time.end, with the bits of a run of that length.
#include "app/program.hpp"

namespace extend_test {

using namespace program;

namespace {

const std::string drawn_block =
                      "edge_cracked_block -q -j 1 -s 'mesh.size=2.5 mm' -s 'expect={}' -s output.report=false ",
                  block = drawn_block + "-s 'figure=[]' ";

/// All tables and frames of two runs are the same, and neither has more.
void check_same_output(const fs::path& one, const fs::path& other) {
    int n = 0;
    for (const auto& [from, to] : {std::pair{one, other}, std::pair{other, one}})
        for (const auto& file : fs::recursive_directory_iterator(from)) {
            const std::string ending = file.path().extension();
            if (ending != ".csv" && ending != ".vtu" && ending != ".pvd" && ending != ".png") continue;
            const fs::path twin = to / fs::relative(file.path(), from);
            CHECK_MESSAGE(text_of(file.path()) == text_of(twin), twin.string());
            ++n;
        }
    CHECK(n > 40);
}

}  // namespace

TEST_CASE("a finished run goes on to a later end and is the run that its resolved scenario makes at once") {
    const Folder folder("extend");
    const std::string block_with_energy = drawn_block + "-s 'figure=[{ file = \"energy.png\", show = \"energy\" }]' ";
    const fs::path run = folder.path / "run";
    const std::string output = "-o " + folder.in_shell("run");
    REQUIRE(command("run " + block_with_energy + "-s 'time.end=20 us' " + output).code == 0);
    CHECK_FALSE(fs::exists(run / "checkpoint"));
    const Answer longer = command("run " + block_with_energy + "-s 'time.end=31 us' " + output);
    CAPTURE(longer.text);
    REQUIRE(longer.code == 0);
    CHECK(longer.has("extended: time.end was 2e-05 s, is 3.1e-05 s; kept are time.step = "));
    CHECK(text_of(run / "log.txt").find("resumed: continues from the checkpoint at t = ") != std::string::npos);
    CHECK(text_of(run / "run.json").find("\"status\": \"done\"") != std::string::npos);
    CHECK(text_of(run / "resolved.toml").find("history_every = 5.0000000000000004e-08") !=
          std::string::npos);  // a four hundredth of the first end
    REQUIRE(command("run " + folder.in_shell("run/resolved.toml") + " -q -j 1 -o " + folder.in_shell("once")).code ==
            0);
    check_same_output(run, folder.path / "once");
    CHECK(text_of(run / "resolved.toml") == text_of(folder.path / "once/resolved.toml"));

    // the same again is there already; further goes on; back, and any other change, is another run
    CHECK(command("run " + block_with_energy + "-s 'time.end=31 us' " + output).has("run-exists"));
    CHECK(command("run " + block_with_energy + "-s 'time.end=20 us' " + output).has("run-exists"));
    CHECK(command("run " + block_with_energy + "-s 'time.end=40 us' -s seed=2 " + output).has("run-exists"));
    REQUIRE(command("run " + block_with_energy + "-s 'time.end=40 us' " + output).code == 0);
    REQUIRE(command("run " + folder.in_shell("run/resolved.toml") + " -q -j 1 -o " + folder.in_shell("twice")).code ==
            0);
    check_same_output(run, folder.path / "twice");
}

TEST_CASE("a run with laws of rate and of slip is extended to the bits of the run of that length") {
    const Folder folder("extend_rates");
    const std::string rates = "run " + block +
                              "-s interface.default.unloading=secant -s interface.default.relaxation_time=2e-7 -s "
                              "interface.default.incubation_time=2e-6 -s interface.default.G_II=9 -s "
                              "interface.default.friction=0.6 -s interface.default.kinetic_friction=0.1 -s "
                              "interface.default.slip_distance=1e-7 ";
    REQUIRE(command(rates + "-s 'time.end=35 us' -o " + folder.in_shell("run")).code == 0);
    REQUIRE(command(rates + "-s 'time.end=50 us' -o " + folder.in_shell("run")).code == 0);
    REQUIRE(command("run " + folder.in_shell("run/resolved.toml") + " -q -j 1 -o " + folder.in_shell("once")).code ==
            0);
    check_same_output(folder.path / "run", folder.path / "once");
    // all of them were at work
    const std::string record = text_of(folder.path / "once/run.json");
    for (const char* number :
         {"largest_strength_factor", "incubation_dissipation", "viscous_dissipation", "mixed_dissipation"}) {
        const auto at = record.find(number);
        REQUIRE(at != std::string::npos);
        CHECK(std::stod(record.substr(record.find(':', at) + 1)) > 0);
    }
    CHECK(text_of(folder.path / "once/energy.csv").find("interface_elastic") != std::string::npos);
}

TEST_CASE("a run with a step of its own is extended to the bits of the run of that length") {
    const Folder folder("extend_step");
    // 0.35 us divides neither end: the last steps of the first run are shorter, and are not in the longer one
    const std::string implicit =
        "run edge_cracked_block_implicit -q -j 1 -s 'mesh.size=4 mm' -s 'time.step=0.35 us' -s 'output.every=1 us' -s "
        "'output.history_every=0.5 us' "
        "-s 'expect={}' " +
        undrawn;
    REQUIRE(command(implicit + "-s 'time.end=14.8 us' -o " + folder.in_shell("run")).code == 0);
    const Answer longer = command(implicit + "-s 'time.end=22 us' -o " + folder.in_shell("run"));
    CAPTURE(longer.text);
    REQUIRE(longer.code == 0);
    REQUIRE(command(implicit + "-s 'time.end=22 us' -o " + folder.in_shell("once")).code == 0);
    check_same_output(folder.path / "run", folder.path / "once");
}

TEST_CASE("a run that was stopped may go on to a later end and a damaged one is left as it is") {
    const Folder folder("extend_stopped");
    const fs::path run = folder.path / "run";
    const std::string output = "-o " + folder.in_shell("run");
    REQUIRE(command("run " + block + "-s 'time.end=20 us' --until 12us " + output).code == 0);
    REQUIRE(command("run " + block + "-s 'time.end=25 us' " + output).code == 0);
    REQUIRE(command("run " + folder.in_shell("run/resolved.toml") + " -q -j 1 -o " + folder.in_shell("once")).code ==
            0);
    check_same_output(run, folder.path / "once");

    const std::string resolved = text_of(run / "resolved.toml"), record = text_of(run / "run.json");
    fs::resize_file(run / "checkpoint.end", 100);
    const Answer damaged = command("run " + block + "-s 'time.end=30 us' " + output);
    CAPTURE(damaged.text);
    CHECK(damaged.code == 2);
    CHECK(damaged.has("error[not-extended]: the run in `"));
    CHECK(text_of(run / "resolved.toml") == resolved);
    CHECK(text_of(run / "run.json") == record);
}

}  // namespace extend_test
