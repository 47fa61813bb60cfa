// Standard streams that are closed, or whose reader goes away.
#include "app/program.hpp"

#include <cstdlib>
#include <regex>

namespace streams_test {

using namespace program;

namespace {

/// What a shell says of a line; `knap` stands for the program.
Answer shell(const std::string& line) {
    return command("--version >/dev/null; knap() { '" KNAP_PROGRAM "' \"$@\"; }; " + line);
}

const std::string small_bar = "run bar_ramp_wave -j 1 -s 'time.end=\"4 us\"' -s expect={} -o ";

}  // namespace

TEST_CASE("with closed streams the results are those of any run") {
    const Folder folder("closed_streams");
    REQUIRE(command(small_bar + folder.in_shell("open")).code == 0);
    for (const char* closed : {">&- 2>&-", "<&- >&- 2>&-", "2>&-"}) {
        CAPTURE(closed);
        fs::remove_all(folder.path / "closed");
        const Answer run = shell("(knap " + small_bar + folder.in_shell("closed") + " " + closed + "); echo code $?");
        CHECK(run.has("code 0"));
        for (const char* file : {"energy.csv", "cracks.csv", "run.pvd", "fields/bulk_0001.vtu"})
            CHECK_MESSAGE(text_of(folder.path / "closed" / file) == text_of(folder.path / "open" / file), file);
    }
}

TEST_CASE("a reader of the messages who goes away ends nothing") {
    const Folder folder("broken_pipe");
    // where the reader is gone before the first word
    const auto codes = [](const std::string& arguments) {
        return shell("{ { sleep 0.2; knap " + arguments + " 2>&1; echo code $? >&3; } | true; } 3>&1").text;
    };
    CHECK(codes(small_bar + folder.in_shell("run") + " " + undrawn) == "code 0\n");
    CHECK(text_of(folder.path / "run/run.json").find("\"status\": \"done\"") != std::string::npos);
    CHECK(codes("sweep bar_ramp_wave -s 'time.end=\"2 us\",\"4 us\"' -s expect={} -j 1 " + undrawn + "-o " +
                folder.in_shell("sweep")) == "code 0\n");
    CHECK(fs::file_size(folder.path / "sweep/sweep.csv") > 0);
    CHECK(codes("list") == "code 0\n");
}

TEST_CASE("messages have colours on a terminal and nowhere else") {
    if (std::system("script --version >/dev/null 2>&1") != 0) {
        MESSAGE("skipped: there is no script (Debian: bsdutils)");
        return;
    }
    const auto on_terminal = [](const std::string& variables) {  // script opens a pseudoterminal
        return shell("env " + variables +
                     " script -qec \"'" KNAP_PROGRAM "' check bar_ramp_wave -s mesh.siz=1\" /dev/null")
            .text;
    };
    const std::string plain = command("check bar_ramp_wave -s mesh.siz=1").text,
                      coloured = on_terminal("-u NO_COLOR TERM=xterm");
    CHECK(plain.starts_with("error[unknown-key]: "));
    CHECK(plain.find('\033') == std::string::npos);
    CHECK(coloured.starts_with("\033[1;31merror[unknown-key]\033[0m: "));
    CHECK(std::regex_replace(coloured, std::regex("\033\\[[0-9;]*m|\r"), "") == plain);
    const Folder folder("coloured");
    const std::string run = "'" KNAP_PROGRAM
                            "' run bar_ramp_wave -q -s figure=[] -s 'expect={ dissipated = { below = -1 } }' -o " +
                            folder.in_shell("run");
    const std::string end = shell("env -u NO_COLOR TERM=xterm script -qec \"" + run + "\" /dev/null").text;
    CHECK(std::regex_search(end, std::regex("\033\\[1;31m  expect dissipated .*FAILED\033\\[0m")));
    for (const char* variables : {"NO_COLOR=1 TERM=xterm", "-u NO_COLOR TERM=dumb"})
        CHECK(on_terminal(variables).find('\033') == std::string::npos);
}

}  // namespace streams_test
