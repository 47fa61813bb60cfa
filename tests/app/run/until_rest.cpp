// time.until = "rest": the run ends at rest, says so, and resumes with the same bits.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace until_rest_test {

using namespace program;
using Json = nlohmann::json;

namespace {

const std::string scene = R"(knap = 1
[domain]
shape = "rectangle"
size = ["1 m", "1 m"]
[mesh]
size = "0.25 m"
[material.soft]
density = 2000
E = "100 MPa"
nu = 0.2
[interface.default]
breakable = false
[[support]]
on = "bottom"
[[load]]
acceleration = [0, "-10 m/s2"]
[time]
end = "2 s"
until = "rest"
damping = "100 Hz"
[[figure]]
file = "end.png"
show = "speed"
)";

Json record_of(const fs::path& run) { return Json::parse(text_of(run / "run.json")); }

}  // namespace

TEST_CASE("until rest: the run ends at rest and says when and resumes with the same bits") {
    const Folder folder("until rest");
    std::ofstream(folder.path / "block.toml") << scene;
    const std::string run = "run " + folder.in_shell("block.toml") + " -q -j 1 -s output.report=false ";
    const Answer whole = command(run + "-o " + folder.in_shell("whole"));
    REQUIRE(whole.code == 0);
    CHECK(whole.has("ended before time.end: the body is at rest since"));
    const Json record = record_of(folder.path / "whole");
    CHECK(record["status"] == "done");
    CHECK(record["ended"] == "rest");
    const double since = record["summary"]["rest_time"], end = record["time_s"];
    CHECK(since > 0.01);
    CHECK(end < 1);
    CHECK(end - since >= 10 * std::sqrt(2) / std::sqrt(100e6 / 2.4 / 2000));  // ten passages
    CHECK(fs::exists(folder.path / "whole/figures/end.png"));

    CHECK(command(run + "--until 100ms -o " + folder.in_shell("part")).code == 0);
    CHECK_FALSE(record_of(folder.path / "part").contains("ended"));
    CHECK(command(run + "-o " + folder.in_shell("part")).code == 0);
    CHECK(text_of(folder.path / "part/energy.csv") == text_of(folder.path / "whole/energy.csv"));
    CHECK(record_of(folder.path / "part")["summary"] == record["summary"]);

    const Answer late = command(run + "-s time.end=50ms -o " + folder.in_shell("late"));
    CHECK(late.code == 0);
    CHECK(late.has("warning[not-at-rest]"));
    CHECK_FALSE(record_of(folder.path / "late").contains("ended"));
}

TEST_CASE("until rest: refused where something moves for ever") {
    const Folder folder("never rests");
    std::ofstream(folder.path / "block.toml") << scene + "[[load]]\non = \"top\"\nvelocity = [0, -0.01]\n";
    const Answer answer = command("check " + folder.in_shell("block.toml"));
    CHECK(answer.code == 2);
    CHECK(answer.has("never-rests"));
}

}  // namespace until_rest_test
