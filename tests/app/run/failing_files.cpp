// Files that the system does not give, and files of a run that are damaged when it goes on.
#include "app/program.hpp"

#include <algorithm>

namespace failing_files_test {

using namespace program;

namespace {

const std::string small_bar =
    "run bar_ramp_wave -q -j 1 -s 'time.end=\"4 us\"' -s expect={} -s figure=[] -s output.report=false ";

/// The program under a limit of the shell, without files that the caller of the test has open.
Answer limited(const std::string& limit, const std::string& arguments) {
    return command("--version >/dev/null; (exec 3>&- 4>&- 5>&- 6>&- 7>&- 8>&- 9>&-; " + limit +
                   "; exec '" KNAP_PROGRAM "' " + arguments + ")");
}

/// A run under a limit ends with whole tables, or with an error that names the reason and is no success.
void check_limited(const Folder& folder, const std::string& limit, const char* reason) {
    CAPTURE(limit);
    fs::remove_all(folder.path / "run");
    const Answer answer = limited(limit, small_bar + "-o " + folder.in_shell("run"));
    CAPTURE(answer.text);
    if (answer.code == 0) return check_same(folder.path / "whole", folder.path / "run", 3);
    CHECK((answer.code == 2 || answer.code == 3));
    CHECK(answer.has(reason));
    CHECK(answer.text.find("internal") == std::string::npos);
}

}  // namespace

TEST_CASE("a run that may open few files or write small ones never ends well with lines lost") {
    const Folder folder("failing_files");
    REQUIRE(command(small_bar + "-o " + folder.in_shell("whole")).code == 0);
    for (const int n : {4, 5, 6, 7, 8, 9, 12})
        check_limited(folder, "ulimit -n " + std::to_string(n), "Too many open files");
    for (const int blocks : {4, 12, 40}) check_limited(folder, "ulimit -f " + std::to_string(blocks), "File too large");
}

TEST_CASE("a run goes on past damaged frames and states and names them with the cure") {
    const Folder folder("damaged_on_the_way");
    const std::string run =
        "run bar_ramp_wave -q -j 1 -s 'time.end=\"4 us\"' -s expect={} -s output.report=false "
        "-s 'output.every=\"0.5 us\"' -s 'output.states=[\"0.5 us\", \"1 us\"]' "
        "-s 'figure=[{ file = \"speed.webp\", show = \"speed\", width = 300 }]' -o ";
    REQUIRE(command(run + folder.in_shell("whole")).code == 0);
    const std::string in_shell = folder.in_shell("run");
    const fs::path there = folder.path / "run";
    command(run + in_shell + " --until '2.2 us'");
    REQUIRE(fs::exists(there / "checkpoint"));
    REQUIRE(fs::exists(there / "states/1e-06.state"));
    std::ofstream(there / "fields/bulk_0001.vtu", std::ios::trunc).flush();
    fs::resize_file(there / "fields/interfaces_0002.vtu", 300);
    fs::remove(there / "states/5e-07.state");
    fs::resize_file(there / "states/1e-06.state", 200);
    flip_a_byte(there / "fields/bulk_0000.vtu");  // inside: it has its size and its end
    fs::create_symlink(folder.path / "elsewhere", there / "run.json.part");

    const Answer resumed = command(run + in_shell);
    CAPTURE(resumed.text);
    CHECK(resumed.code == 0);
    CHECK(resumed.has("resumed: continues from the checkpoint"));
    CHECK(resumed.has("warning[missing-file]: fields/bulk_0000.vtu is damaged: its checksum is wrong; "));
    CHECK(resumed.has("fields/bulk_0001.vtu is empty; "));
    for (const char* lost : {"fields/interfaces_0002.vtu", "states/5e-07.state", "states/1e-06.state"})
        CHECK(resumed.has(lost));
    CHECK(resumed.has("; all other outputs are unaffected, --force computes the run again"));
    for (const char* of_record : {"fields/bulk_0000.vtu is damaged", "fields/bulk_0001.vtu is empty"})
        CHECK(text_of(there / "run.json").find(of_record) != std::string::npos);
    CHECK(text_of(there / "energy.csv") == text_of(folder.path / "whole/energy.csv"));
    CHECK(fs::file_size(there / "figures/speed.webp") > 1000);  // without the frames that are damaged
    CHECK_FALSE(fs::exists(folder.path / "elsewhere"));

    const Answer drawn = command("render " + in_shell + " --show speed --at '0.5 us'");
    CHECK(drawn.code == 2);
    CHECK(drawn.has("interfaces_0002.vtu` is cut off after 300 bytes"));
    CHECK(drawn.has("--force"));
    CHECK(command("render " + in_shell + " --show speed --at '2 us'").code == 0);
    const auto start = [&](const std::string& time) {
        return command("check bar_ramp_wave -s 'time.end=\"4 us\"' -s expect={} -s 'time.start=run:" + there.string() +
                       "@" + time + "'");
    };
    CHECK(start("1us").has("1e-06.state` has 200 bytes instead of "));
    CHECK(start("1us").has("--force"));
    CHECK(start("1us").code == 2);
    CHECK(start("0.5us").code == 2);

    REQUIRE(command(run + in_shell + " --force").code == 0);  // the cure
    check_same(folder.path / "whole", there, 10);
    CHECK(fs::exists(there / "states/5e-07.state"));
}

TEST_CASE("a flipped byte in any file that a checkpoint counts is named when the run goes on") {
    const Folder folder("flipped");
    const std::string run =
        "run bar_ramp_wave -q -j 1 -s 'time.end=\"2 us\"' -s expect={} -s output.report=false "
        "-s 'output.every=\"0.5 us\"' -s 'output.states=[\"0.5 us\"]' "
        "-s 'figure=[{ file = \"speed.png\", show = \"speed\", at = \"0.6 us\", width = 300 }]' -o ";
    command(run + folder.in_shell("stopped") + " --until '1.2 us'");
    for (const char* flipped : {"", "fields/bulk_0002.vtu", "fields/interfaces_0001.vtu", "figures/speed.png",
                                "states/5e-07.state", "log.txt"}) {
        CAPTURE(flipped);
        const fs::path there = folder.path / "run";
        fs::remove_all(there);
        fs::copy(folder.path / "stopped", there, fs::copy_options::recursive);
        if (flipped == std::string("log.txt")) fs::resize_file(there / flipped, 10);
        else if (*flipped != '\0') flip_a_byte(there / flipped);
        const Answer resumed = command(run + folder.in_shell("run"));
        CAPTURE(resumed.text);
        CHECK(resumed.code == 0);
        CHECK(resumed.has("warning[missing-file]: ") == (*flipped != '\0'));
        CHECK(resumed.has(std::string(flipped) + (*flipped == 's' ? " cannot be used: its checksum is wrong; all other"
                                                  : *flipped == 'l' ? " has lost its end"
                                                  : *flipped == 'f' ? " is damaged: its checksum is wrong; all other"
                                                                    : "")));
        CHECK(text_of(there / "run.json").find(*flipped != '\0' ? flipped : "status") != std::string::npos);
    }
    fs::permissions(folder.path / "run/energy.csv", fs::perms::none);
    const Answer unread = command("render " + folder.in_shell("run") + " --show energy");
    CHECK((unread.code == 0 || unread.has("Permission denied")));  // the superuser may read it
    fs::permissions(folder.path / "run/energy.csv", fs::perms::owner_all);
    fs::remove(folder.path / "run/energy.csv");
    fs::create_directory(folder.path / "run/energy.csv");
    CHECK(command("render " + folder.in_shell("run") + " --show energy").has("run/energy.csv: Is a directory"));
}

TEST_CASE("the messages of a run in a sweep do not follow a symbolic link") {
    const Folder folder("linked_log");
    const std::string sweep =
        "sweep bar_ramp_wave -s 'time.end=\"1 us\"' -s expect={} -s figure=[] -j 1 -o " + folder.in_shell("sweep");
    REQUIRE(command(sweep).code == 0);
    fs::path log;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path / "sweep/runs"))
        if (entry.path().extension() == ".log") log = entry.path();
    REQUIRE(fs::exists(log));
    std::ofstream(folder.path / "mine") << "mine";
    fs::remove(log);
    fs::create_symlink(folder.path / "mine", log);
    const Answer again = command(sweep + " --force");
    CAPTURE(again.text);
    CHECK(again.code != 0);
    CHECK(again.has(log.filename().string() + ": it is a symbolic link"));
    CHECK(text_of(folder.path / "mine") == "mine");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which take more than there is
TEST_CASE("a picture that has no room is refused with its key before the run") {
    const Folder folder("large_picture");
    const Answer refused = limited("ulimit -v 1500000",
                                   "run bar_ramp_wave -j 1 -s 'time.end=\"1 us\"' -s expect={} "
                                   "-s 'figure=[{ file = \"a.png\", width = 20000, box = [0, 0, 0.01, 0.01] }]' -o " +
                                       folder.in_shell("run"));
    CAPTURE(refused.text);
    CHECK(refused.code == 2);
    CHECK(refused.has("`width` = 20000: the picture would have about 20000 x 2"));
    CHECK(refused.has("GB are free"));
    CHECK(refused.has("figure"));
    CHECK_FALSE(fs::exists(folder.path / "run"));
    const Answer animated = command("check bar_ramp_wave -s 'figure=[{ file = \"a.webp\", width = 17000 }]'");
    CHECK(animated.code == 2);
    CHECK(animated.has("`a.webp` can have 16383 on a side at most"));
}
#endif

}  // namespace failing_files_test
