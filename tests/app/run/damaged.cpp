// Run directories that are no longer what a run left, and paths that cannot be.
#include "app/program.hpp"

#include <vector>

namespace damaged_test {

using namespace program;

namespace {

const std::string small_bar = "run bar_ramp_wave -q -j 1 -s 'time.end=\"2 us\"' -s expect={} -s figure=[] ";

std::string without(std::string text, const std::string& part) { return text.erase(text.find(part), part.size()); }
std::string with(std::string text, const std::string& part, const std::string& other) {
    return text.replace(text.find(part), part.size(), other);
}

}  // namespace

TEST_CASE("a damaged run is refused with its file") {
    const Folder folder("damaged");
    const std::string in_shell = folder.in_shell("run");
    const fs::path run = folder.path / "run";
    REQUIRE(command(small_bar + "-o " + in_shell).code == 0);
    const auto write = [&](const char* file, const std::string& text) {
        std::ofstream(run / file, std::ios::binary) << text;
    };
    const auto refused = [&](const std::string& arguments, const std::string& file) {
        const Answer answer = command(arguments);
        CAPTURE(answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has("run/" + file));
    };
    const std::string json = text_of(run / "run.json"), energy = text_of(run / "energy.csv");
    for (const std::string& text : std::vector<std::string>{
             "", "{}", "[]", "3", "{", "\"\xff\"", with(json, "\"seed\": 1", "\"seed\": -1"),
             with(json, "\"seed\": 1", "\"seed\": \"\xff\""), with(json, "\"materials\": [", "\"materials\": [3, "),
             with(json, "\"gates\": [", "\"gates\": [[], "), with(json, "\"summary\": {", "\"summary\": { \"x\": [],"),
             without(json, "\"pass\": true,"), with(json, "\"scheme\": {", "\"scheme\": 7, \"scheme_was\": {")}) {
        CAPTURE(text.substr(0, 40));
        write("run.json", text);
        for (const char* format : {"", "--json ", "--csv "})
            refused("info " + std::string(format) + in_shell, "run.json");
        refused("render --show energy " + in_shell, "run.json");
    }
    write("run.json", json);
    for (const std::string& text : {std::string(), with(energy, "time", "tim"), with(energy, "\n0,", "\nnull,"),
                                    energy.substr(0, energy.find('\n') + 1), energy.substr(0, energy.size() - 60)}) {
        write("energy.csv", text);
        refused("render --show energy " + in_shell, "energy.csv");
    }
    write("energy.csv", energy);
    write("fields/bulk_0000.vtu", text_of(run / "fields/bulk_0000.vtu").substr(0, 1500));
    refused("render --show speed --at 0us " + in_shell, "fields/bulk_0000.vtu");
    write("run.pvd", with(text_of(run / "run.pvd"), "timestep=\"0\"", "timestep=\"now\""));
    refused("render --show speed " + in_shell, "run.pvd");
}

TEST_CASE("a sweep does a run again whose record is damaged") {
    const Folder folder("damaged_sweep");
    const std::string sweep = "sweep bar_ramp_wave -s 'time.end=\"1 us\",\"2 us\"' -s expect={} -s figure=[] -j 1 -o " +
                              folder.in_shell("sweep");
    REQUIRE(command(sweep).code == 0);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path / "sweep/runs"))
        if (entry.is_directory()) std::ofstream(entry.path() / "run.json");
    const Answer again = command(sweep);
    CAPTURE(again.text);
    CHECK(again.code == 0);
    CHECK(again.has("run 2 of 2"));
}

TEST_CASE("paths that cannot be are the user's mistake") {
    const std::string long_name(300, 'a');
    const Folder folder("paths");
    for (const std::string& arguments :
         {small_bar + "-o " + folder.in_shell(long_name), "new " + folder.in_shell(long_name),
          "mesh bar_ramp_wave -o " + folder.in_shell(long_name + ".msh"), "info " + folder.in_shell(long_name),
          "check " + folder.in_shell(long_name), "study bar_ramp_wave -o " + folder.in_shell(long_name)}) {
        const Answer answer = command(arguments);
        CAPTURE(answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has(long_name));
        CHECK(answer.text.find("internal") == std::string::npos);
    }
    CHECK(fs::is_empty(folder.path));
    REQUIRE(command(small_bar + "-o " + folder.in_shell("L\xf6we")).code == 0);
    const Answer info = command("info --json " + folder.in_shell("L\xf6we"));
    CHECK(info.code == 0);
    CHECK(info.has("L\xef\xbf\xbdwe\""));  // the replacement character
}

TEST_CASE("an impossible figure is reported before anything is drawn") {
    const Folder folder("no_figure");
    REQUIRE(command(small_bar + "-o " + folder.in_shell("run")).code == 0);
    for (const char* option :
         {"--deform nan", "--deform inf", "--range 5 1", "--range 1 1", "--range inf 1", "--box 1 1 0 0", "--at nan"}) {
        CAPTURE(option);
        const Answer answer = command("render " + folder.in_shell("run") + " --show displacement " + option);
        CHECK(answer.code == 2);
        CHECK(answer.has("error["));
    }
    // nor is there a picture of what the run does not have
    for (const char* option : {"--show reactions", "--show stress_strain", "--show breaks",
                               "--show cracks --colour mode", "--show probe_velocities", "--show speed --at 1s"}) {
        CAPTURE(option);
        const Answer answer = command("render " + folder.in_shell("run") + " " + option);
        CHECK(answer.code == 2);
        CHECK(answer.has("it has "));
    }
    CHECK_FALSE(fs::exists(folder.path / "run" / "rendered" / "reactions.png"));
    CHECK(command("render " + folder.in_shell("run") + " --show speed --at 1us --aspect 10").code == 0);
    // an option without an effect is no option
    for (const char* option :
         {"--show speed --file a.png --width 84mm", "--show speed --file a.pdf --width 800", "--show speed --speed 1",
          "--show speed --every 1us", "--show speed --colour slip", "--show speed --curves energy",
          "--show energy --at 1us", "--show energy --deform 2", "--show energy --range 0 1",
          "--show energy --over time", "--animate --at 1us", "--animate --file a.png", "--at 1us", "--width 84mm"}) {
        CAPTURE(option);
        const Answer answer = command("render " + folder.in_shell("run") + " " + option);
        CHECK(answer.code == 2);
        CHECK(answer.has("error[no-effect]"));
    }
    CHECK_FALSE(fs::exists(folder.path / "run" / "rendered" / "a.png"));
}

}  // namespace damaged_test
