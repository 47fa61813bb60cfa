// Standard streams that are closed, or whose reader goes away.
#include "app/program.hpp"

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

}  // namespace streams_test
