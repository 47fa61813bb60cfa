// knap run: its directory, what it refuses, how it ends.
#include "app/program.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <regex>
#include <thread>

namespace run_test {

using namespace program;

namespace {

std::ptrdiff_t count_of(const std::string& text, const std::string& word) {
    std::ptrdiff_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
}

}  // namespace

TEST_CASE("a run directory is complete") {
    const Folder folder("complete");
    const std::string block = small_block("-s 'figure[0].at=[\"20 us\", \"40 us\"]' ");
    const Answer run = command("run " + block + "-o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    for (const char* file : {"scenario.toml", "resolved.toml", "run.json", "log.txt", "energy.csv", "cracks.csv",
                             "fragments.csv", "run.pvd", "fields/bulk_0000.vtu", "fields/interfaces_0000.vtu",
                             "figures/cracks_20us.png", "figures/energy.png"})
        CHECK_MESSAGE(fs::file_size(folder.path / "run" / file) > 0, file);
    CHECK(text_of(folder.path / "run/scenario.toml").find("Does a crack in a glass plate run") !=
          std::string::npos);  // verbatim
    const std::string json = text_of(folder.path / "run/run.json");
    for (const char* key : {"\"status\": \"done\"",
                            "version",
                            "git",
                            "command",
                            "seed",
                            "threads",
                            "wall_s",
                            "cpu_s",
                            "peak_memory_bytes",
                            "triangles",
                            "interfaces",
                            "steps",
                            "triangle_steps_per_core_second",
                            "energy_residual",
                            "external_work",
                            "dissipated",
                            "friction_work",
                            "impact_work",
                            "broken_length",
                            "first_growth_time",
                            "max_tip_speed",
                            "max_tip_speed_over_cR",
                            "branches",
                            "first_branch_time",
                            "fragments",
                            "largest_penetration",
                            "largest_speed",
                            "gates",
                            "expect"})
        CHECK_MESSAGE(json.find(key) != std::string::npos, key);
    CHECK(run.has("gate   energy_residual"));
    CHECK(run.has("figures/energy.png"));

    // one run for all that is asked of it; what changes it comes last
    {  // the resolved scenario runs again to the same numbers
        const Answer again = command("run " + folder.in_shell("run/resolved.toml") + " -q -j 2 " + undrawn + "-o " +
                                     folder.in_shell("again"));
        CHECK(again.code == 0);
        CHECK(text_of(folder.path / "again/energy.csv") == text_of(folder.path / "run/energy.csv"));
        CHECK(text_of(folder.path / "again/cracks.csv") == text_of(folder.path / "run/cracks.csv"));
    }
    {  // other pictures are drawn from it
        const Answer render =
            command("render " + folder.in_shell("run") +
                    " --show stress_yy --at 20us --file s.svg --range -1MPa 3MPa --box 40mm 10mm 70mm 30mm");
        CHECK(render.code == 0);
        CHECK(fs::file_size(folder.path / "run/rendered/s.svg") > 1000);
        const std::string run = folder.in_shell("run"), to = "render " + run + " -o " + folder.in_shell("paper/c.pdf");
        const Answer drawn = command(to + " --width 84mm --font-size 7");
        CHECK(drawn.code == 0);
        CHECK(drawn.has("`c.pdf` shows cracks"));
        CHECK(command(to + " --width -3mm").has("18 mm to 1.7 m wide, not -3 mm"));
        const std::string pdf = text_of(folder.path / "paper/c.pdf");
        CHECK(pdf.starts_with("%PDF"));
        CHECK(std::regex_search(pdf, std::regex("MediaBox \\[ ?0 0 238\\.1")));  // [pt]
        CHECK(command(to + " --file d.pdf").has("two names of one picture"));
        CHECK(command("render " + run + " --show energy -o " + folder.in_shell("paper/c.eps")).has(".png, .svg, .pdf"));
        CHECK(command("render " + run + " --show energy --width 30mm --font-size 12 -o x.svg").has("at most 4.6 pt"));
        CHECK(command("run bar_ramp_wave -o c.pdf").has("is a picture by its name"));
        CHECK(command("run bar_ramp_wave -o C.PDF").has("is a picture by its name"));
        CHECK(command("render " + folder.in_shell("run")).code == 0);
        CHECK(command("render " + folder.in_shell("run") + " --show nothing").code == 2);
        CHECK(command("render " + folder.in_shell("run") + " --show speed --at 20mm").has("a length"));
        std::ofstream(folder.path / "run/resolved.toml", std::ios::app)
            << "\n[[figure]]\nfile = \"m.png\"\nshow = \"speed\"\nmeasured = [[0.05, 0.02]]\nmeasured_by = \"N\"\n";
        CHECK(command("render " + folder.in_shell("run")).code == 0);
        CHECK(command("render " + folder.in_shell("run") + " --show speed --file one.png").code == 0);
        CHECK(text_of(folder.path / "run/rendered/one.png") == text_of(folder.path / "run/rendered/m.png"));
    }
    {  // it is animated, the same picture by picture each time
        const std::string run = folder.in_shell("run"), file = "run/rendered/cracks.webp";
        CHECK(command("render " + run + " --animate --width 400 --curves crack_length").code == 0);
        const std::string bytes = text_of(folder.path / file);
        CHECK(bytes.substr(0, 4) == "RIFF");
        CHECK(count_of(bytes, "ANMF") == 21);
        CHECK(bytes.size() < 500'000);
        const std::string five = "render " + run + " --animate --width 400 --every 10us";
        CHECK(command(five).code == 0);
        const std::string first = text_of(folder.path / file);
        CHECK(count_of(first, "ANMF") == 5);
        CHECK(command(five).code == 0);
        CHECK(text_of(folder.path / file) == first);
        CHECK(command("render " + run + " --animate --curves rose").code == 2);
        CHECK(command("render " + run + " --animate --every 20us --file a.mp4")
                  .has(std::system("ffmpeg -version >/dev/null 2>&1") == 0 ? "a.mp4" : "no-ffmpeg"));
    }
    {  // its report holds all of it
        const std::string report = text_of(folder.path / "run/report.html");
        CHECK(report.size() > 200'000);
        CHECK(report.size() < 3'000'000);
        CHECK(report.find("Does a crack in a glass plate run, how fast, and does it branch,") != std::string::npos);
        for (const char* words :
             {"E = 32 GPa", "Rayleigh 21", "energy_residual", "triangles of order 1", "J/m2", "figures/cracks_20us.png",
              "@page { size: A4", "type=\"range\"", "run edge_cracked_block"})
            CHECK_MESSAGE(count_of(report, words) > 0, words);
        // nothing is fetched: every address is inside the page
        CHECK(count_of(report, "src=\"") == count_of(report, "src=\"data:image/"));
        CHECK(count_of(report, "href=") == 0);
        const auto before = [&](const char* a, const char* b) { return report.find(a) < report.find(b); };
        CHECK(before("<h2>Frames", "<h2>Figures"));
        CHECK(before("<h2>Figures", "<h2>Results"));
        CHECK(count_of(report, "data:image/webp;base64,") >= 4);
        CHECK_FALSE(fs::exists(folder.path / "again/report.html"));  // output.report = false
    }
    {  // info tells of it
        CHECK(command("info " + folder.in_shell("run")).has("edge_cracked_block"));
        CHECK(command("info --json " + folder.in_shell("run")).has("\"summary\""));
        const Answer table = command("info --csv " + folder.in_shell("run") + " " + folder.in_shell("run"));
        CHECK(std::count(table.text.begin(), table.text.end(), '\n') == 3);
        CHECK(command("info " + folder.in_shell("nowhere")).code == 2);
    }
    {  // it is not overwritten unless told to
        const std::string before = text_of(folder.path / "run/run.json");
        const Answer again = command("run " + block + "-o " + folder.in_shell("run"));
        CHECK(again.code == 2);
        CHECK(again.has("run-exists"));
        CHECK(text_of(folder.path / "run/run.json") == before);
        CHECK(command("run " + small_block() + "--force -o " + folder.in_shell("run")).code == 0);
    }
}

TEST_CASE("a shorter run is the begin of the longer one") {
    const Folder folder("until");
    CHECK(command("run " + small_block() + "-o " + folder.in_shell("long")).code == 0);
    CHECK(command("run " + small_block() + "--until 20us -o " + folder.in_shell("short")).code == 0);
    const std::string whole = text_of(folder.path / "long/energy.csv"),
                      part = text_of(folder.path / "short/energy.csv");
    const std::string head = part.substr(0, part.rfind('\n', part.size() - 2));  // its last line is at its own end
    CHECK(head.size() > 1000);
    CHECK(whole.starts_with(head));

    // it goes on from there, never back
    const std::string shorter = "run " + small_block() + "-o " + folder.in_shell("short");
    const fs::path checkpoint = folder.path / "short/checkpoint";
    const std::string kept = text_of(checkpoint);
    CHECK(kept.size() > 1000);
    const Answer back = command(shorter + " --until 10us");
    CHECK(back.code == 2);
    CHECK(back.has("until-passed"));
    CHECK(text_of(checkpoint) == kept);
    CHECK(command(shorter + " --until 20us").code == 0);  // where it is already
    CHECK(text_of(folder.path / "short/energy.csv") == part);
    CHECK(command(shorter).code == 0);
    CHECK(text_of(folder.path / "short/energy.csv") == whole);
    CHECK(text_of(folder.path / "short/run.pvd") == text_of(folder.path / "long/run.pvd"));
    CHECK_FALSE(fs::exists(checkpoint));
    for (const char* time : {"0", "-5us"}) {
        const Answer none = command("run " + small_block() + "-o " + folder.in_shell("none") + " --until " + time);
        CHECK(none.code == 2);
        CHECK(none.has("--until"));
        CHECK_FALSE(fs::exists(folder.path / "none"));
    }
}

TEST_CASE("force does not clear what knap did not make") {
    const Folder folder("foreign");
    std::ofstream(folder.path / "thesis.tex") << "years of work";
    const Answer run = command("run " + small_block() + "--force -o " + folder.in_shell(""));
    CHECK(run.code == 2);
    CHECK(text_of(folder.path / "thesis.tex") == "years of work");
}

TEST_CASE("a run that misses an expectation ends with 4") {
    const Folder folder("expectation");
    const Answer run = command("run " + small_block() + "-s 'expect={ broken_length = { above = \"1 m\" } }' -o " +
                               folder.in_shell("run"));
    CAPTURE(run.text);
    CHECK(run.code == 4);
    CHECK(run.has("FAILED"));
}

TEST_CASE("bad input ends with 2 and leaves nothing behind") {
    const Folder folder("bad");
    std::ofstream(folder.path / "bad.toml") << "knap = 1\nname = \"bad\"\n[mesh]\nsise = \"1 mm\"\n";
    const Answer run = command("run " + folder.in_shell("bad.toml") + " -o " + folder.in_shell("run"));
    CHECK(run.code == 2);
    CHECK(run.has("bad.toml:4:1"));
    CHECK(run.has("did you mean `size`?"));
    CHECK_FALSE(fs::exists(folder.path / "run"));
    CHECK(command("run nowhere.toml").code == 2);
    const Answer near = command("run " + folder.in_shell("badd.toml"));
    CHECK(near.code == 2);
    CHECK(near.has("did you mean `" + (folder.path / "bad.toml").string() + "`?"));
    const Answer show = command("render run --show stres");
    CHECK(show.code == 2);
    CHECK(show.has("did you mean `stress_xx` or `stress_yy` or `stress_xy` or `stress_strain`?"));
    fs::create_directory(folder.path / "dir.pdf");
    const Answer picture = command("render run --show cracks -o " + folder.in_shell("dir.pdf"));
    CHECK(picture.code == 2);
    CHECK(picture.has("is a directory, and a picture by its name"));
    CHECK(command("run").code == 2);
    CHECK(command("rum edge_cracked_block").has("did you mean `run`?"));
    const Answer step = command("run " + small_block() + "-s 'time.step=1 us' -o " + folder.in_shell("run"));
    CHECK(step.code == 2);
    CHECK(step.has("stable step"));
    const Answer shape = command("check " + small_block().substr(0, small_block().find(" -q")) + " -s 'mesh.size=1 m'");
    CHECK(shape.code == 2);
    CHECK(shape.has("mesh.size"));
}

TEST_CASE("Ctrl-C ends a run with its outputs complete") {
    const Folder folder("interrupt");
    const fs::path run = folder.path / "run";
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        (void)!freopen("/dev/null", "w", stdout);
        execl(KNAP_PROGRAM, KNAP_PROGRAM, "run", "edge_cracked_block", "-q", "-j", "1", "-s", "mesh.size=1 mm", "-s",
              "output.report=false", "-s", "figure=[{ file = \"energy.png\", show = \"energy\" }]", "-o", run.c_str(),
              nullptr);
        _exit(127);
    }
    for (int i = 0; i < 30000 && !fs::exists(run / "fields/bulk_0001.vtu"); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, SIGINT);
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 130);
    const std::string json = text_of(run / "run.json"), pvd = text_of(run / "run.pvd");
    CHECK(json.find("\"status\": \"interrupted\"") != std::string::npos);
    CHECK(json.find("energy_residual") != std::string::npos);
    CHECK(pvd.find("</VTKFile>") != std::string::npos);
    CHECK(fs::file_size(run / "figures/energy.png") > 0);
    CHECK(text_of(run / "energy.csv").back() == '\n');
}

}  // namespace run_test
