// The numbers of the summary are those of the run, whatever it writes.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace summary_test {

using namespace program;

namespace {

nlohmann::json record_of(const fs::path& run) { return nlohmann::json::parse(text_of(run / "run.json")); }

/// Runs the scene with many and with few lines and frames; all numbers of both summaries agree.
nlohmann::json check_same_summary(const Folder& folder, const std::string& text, const char* many, const char* few,
                                  const std::string& more = "") {
    write_scene(folder, text);
    const auto summary = [&](const char* every, const char* fields) {
        const Answer answer =
            run_scene(folder, std::string("-j 1 -s output.history_every='") + every + "' -s output.every='" + every +
                                  "' -s output.fields=" + fields + more + " --force -o " + folder.in_shell("run"));
        CAPTURE(answer.text);
        REQUIRE(answer.code == 0);
        return record_of(folder.path / "run")["summary"];
    };
    const nlohmann::json a = summary(many, "true"), b = summary(few, "false");
    CHECK(a.size() > 40);
    CHECK(a.size() == b.size());
    for (const auto& [name, value] : a.items())
        CHECK_MESSAGE(value == b[name], name, ": ", value.dump(), b[name].dump());
    return a;
}

/// A strip of stone of 40 x 20 mm that is pulled apart, with `more`.
std::string pulled_strip(const std::string& more) {
    return rectangle("0.04, 0.02", "\"2 mm\"") + R"([material.stone]
density = 2600
E = "30 GPa"
nu = 0.2
[interface.default]
sigma_c = "5 MPa"
G_c = "20 J/m2"
friction = 0.5
[[load]]
name = "grip"
on = "right"
velocity = ["0.5 m/s", "free"]
ramp = "10 us"
[[load]]
on = "left"
displacement = [0, "free"]
)" + more;
}

const std::string specimen =
    "[specimen]\ntest = \"tension\"\nforce = \"grip\"\naxis = \"x\"\n[time]\nend = \"60 us\"\n";

}  // namespace

TEST_CASE("no number of the summary depends on what is written") {
    const Folder folder("summary");
    SUBCASE("a crack that branches") {
        const nlohmann::json summary = check_same_summary(
            folder, text_of(fs::path(KNAP_SOURCE_DIR) / "scenarios/edge_cracked_block.toml"), "0.1 us", "7 us",
            " -s 'mesh.size=2 mm' -s 'time.end=60 us' -s 'expect={}' -s 'figure=[]'");
        CHECK(summary["max_tip_speed"].get<double>() > 300);
        CHECK(summary["steady_work_per_advance"].get<double>() > 0);
    }
    SUBCASE("a specimen that fails") {
        const nlohmann::json summary = check_same_summary(folder, pulled_strip(specimen), "0.2 us", "7 us");
        CHECK(summary["strength"] == summary["peak_stress"]);
        CHECK(summary["strength"].get<double>() > 4e6);
        CHECK(summary["grip_largest_force"].get<double>() > 4e6 * 0.02);
        CHECK(summary["cohesive_friction_work"].get<double>() <= 0);
    }
    SUBCASE("a plate under a changing temperature") {
        std::string text = pulled_strip(
            "[heat]\ntemperature = \"20 + 100*sin(3e5*t)*exp(-x/0.01)\"\nreference = 20\n[time]\nend = \"20 us\"\n");
        text.insert(text.find("nu = 0.2\n"), "expansion = 1e-5\n");
        CHECK(check_same_summary(folder, text, "0.2 us", "3 us")["kinetic_part"].get<double>() > 0);
    }
}

TEST_CASE("a specimen that has not failed has no strength and the run says so") {
    const Folder folder("no strength");
    write_scene(folder, pulled_strip(specimen));
    const auto run_until = [&](const char* end) {
        const Answer answer = run_scene(folder, std::string("-j 1 -s output.fields=false -s time.end='") + end +
                                                    "' --force -o " + folder.in_shell("run"));
        CAPTURE(answer.text);
        REQUIRE(answer.code == 0);
        return record_of(folder.path / "run")["warnings"].dump();
    };
    CHECK(run_until("15 us").find("the specimen did not fail: nothing broke") != std::string::npos);
    const nlohmann::json summary = record_of(folder.path / "run")["summary"];
    CHECK(summary["peak_stress"].get<double>() > 0);
    CHECK(summary["strength"].is_null());
    CHECK(summary["strength_ratio"].is_null());
    CHECK(run_until("60 us").find("no-strength") == std::string::npos);
    CHECK(record_of(folder.path / "run")["summary"]["strength_ratio"].get<double>() > 0.8);
}

}  // namespace summary_test
