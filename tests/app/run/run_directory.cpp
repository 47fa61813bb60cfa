// How a run takes its directory: the one that was named, from nobody who is in it, and whole whatever happens.
#include "app/program.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace run_directory_test {

using namespace program;

namespace {

const std::string bar = "bar_ramp_wave -q -j 1 -s 'expect={}' -s 'mesh.size=1 mm' " + undrawn;

/// In a shell, in a directory.
int run_in(const fs::path& directory, const std::string& output) {
    return WEXITSTATUS(std::system(
        ("cd '" + directory.string() + "' && '" KNAP_PROGRAM "' run " + bar + "-o " + output + " >/dev/null 2>&1")
            .c_str()));
}

bool is_done(const fs::path& run) {
    return text_of(run / "run.json").find("\"status\": \"done\"") != std::string::npos &&
           fs::exists(run / "fields/bulk_0000.vtu") && fs::exists(run / "resolved.toml");
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

}  // namespace

TEST_CASE("run directory: a run under way is not cleared by force") {
    const Folder folder("busy");
    const std::string run = "run " + bar + "-o " + folder.in_shell("run");
    REQUIRE(command(run).code == 0);
    const int lock = open((folder.path / "run/log.txt").c_str(), O_WRONLY | O_CLOEXEC);  // as one who runs there
    REQUIRE(flock(lock, LOCK_EX | LOCK_NB) == 0);
    const std::string before = text_of(folder.path / "run/run.json");
    const Answer other = command(run + " -s seed=2 --force");
    close(lock);
    CHECK(other.code == 2);
    CHECK(other.has("run-busy"));
    CHECK(text_of(folder.path / "run/run.json") == before);
    CHECK(command(run + " -s seed=2 --force").code == 0);
    CHECK(text_of(folder.path / "run/run.json") != before);
    CHECK(is_done(folder.path / "run"));
}

TEST_CASE("run directory: it is the one that was named") {
    const Folder folder("named");
    SUBCASE("where one stands") {
        CHECK(run_in(folder.path, ".") == 0);
        CHECK(run_in(folder.path, ".") == 2);
        CHECK(is_done(folder.path));
        CHECK(run_in(folder.path, ". --force") == 0);
        CHECK(is_done(folder.path));
    }
    SUBCASE("prepared by someone, behind a link") {
        fs::create_directory(folder.path / "large disk");
        REQUIRE(chmod((folder.path / "large disk").c_str(), 02750) == 0);
        struct stat before {
        }, after{};
        REQUIRE(stat((folder.path / "large disk").c_str(), &before) == 0);
        fs::create_directory_symlink("large disk", folder.path / "link");
        CHECK(run_in(folder.path, "link") == 0);
        CHECK(run_in(folder.path, "link --force") == 0);
        CHECK(fs::is_symlink(folder.path / "link"));
        CHECK(is_done(folder.path / "large disk"));
        REQUIRE(stat((folder.path / "large disk").c_str(), &after) == 0);
        CHECK(before.st_ino == after.st_ino);
        CHECK(before.st_mode == after.st_mode);
    }
    SUBCASE("not where a link leads to nothing") {
        fs::create_directory_symlink("not mounted", folder.path / "link");
        CHECK(command("run " + bar + "-o " + folder.in_shell("link")).has("dangling-link"));
        CHECK(fs::is_symlink(folder.path / "link"));
    }
    SUBCASE("and none beside it") {
        for (const char* other : {"run.part", "run"}) {
            fs::create_directory(folder.path / "run.part");
            write(folder.path / "run.part" / "letter.txt", "dear");
            CHECK(run_in(folder.path, other) == (std::string(other) == "run" ? 0 : 2));
            CHECK(text_of(folder.path / "run.part/letter.txt") == "dear");
        }
    }
}

TEST_CASE("run directory: a start that was killed is started again and nobody else is taken for one") {
    const Folder folder("half");
    fs::create_directory(folder.path / "run");
    const std::string run = "run " + bar + "-o " + folder.in_shell("run");
    SUBCASE("before its run.json") {
        write(folder.path / "run/log.txt", ""), write(folder.path / "run/run.json.part", "{\"sta");
    }
    SUBCASE("while it cleared an older run") {
        write(folder.path / "run/run.json", "{\"status\": \"starting\", \"version\": \"0\"}");
        write(folder.path / "run/log.txt", "an older run");
        write(folder.path / "run/checkpoint", "of an older run");
    }
    SUBCASE("before its first checkpoint") {
        REQUIRE(command(run).code == 0);
        std::string record = text_of(folder.path / "run/run.json");
        record.replace(record.find("\"done\""), 6, "\"running\"");
        write(folder.path / "run/run.json", record);
        CHECK(command(run + " -s seed=2").has("run-exists"));
    }
    SUBCASE("a log of someone else") {
        write(folder.path / "run/log.txt", "years of measurements");
        CHECK(command(run).has("run-exists"));
        CHECK(command(run + " --force").has("not-a-run"));
        CHECK(text_of(folder.path / "run/log.txt") == "years of measurements");
        return;
    }
    SUBCASE("a record of someone else") {
        write(folder.path / "run/run.json", "{\"status\": \"running\"}");
        CHECK(command(run).has("exists already"));
        CHECK(text_of(folder.path / "run/run.json") == "{\"status\": \"running\"}");
        return;
    }
    const Answer again = command(run);
    CAPTURE(again.text);
    CHECK(again.code == 0);
    CHECK(is_done(folder.path / "run"));
    CHECK(text_of(folder.path / "run/log.txt").find("older") == std::string::npos);
    CHECK_FALSE(fs::exists(folder.path / "run/checkpoint"));
}

TEST_CASE("run directory: a page for who waits for a mesh goes with a run that does not begin") {
    const Folder folder("announced");
    const std::string listening = "bar_ramp_wave -j 1 -s 'expect={}' " + undrawn + "-s 'mesh.size=1 mm' ";
    const std::string outside = "-s 'initial=[{box=[8,8,9,9],velocity=[0,1]}]' ";
    CHECK(command("run " + listening + outside + "-o " + folder.in_shell("new/deep/run")).has("empty-selection"));
    CHECK_FALSE(fs::exists(folder.path / "new"));
    fs::create_directory(folder.path / "run");
    CHECK(command("run " + listening + outside + "-o " + folder.in_shell("run/")).has("empty-selection"));
    CHECK(fs::is_empty(folder.path / "run"));
    write(folder.path / "run/report.html", "mine");
    CHECK(command("run " + listening + "-o " + folder.in_shell("run")).has("run-exists"));
    CHECK(text_of(folder.path / "run/report.html") == "mine");
    // one that was killed meanwhile has left its page
    fs::create_directory(folder.path / "killed");
    write(folder.path / "killed/log.txt", ""), write(folder.path / "killed/report.html", "makes its mesh");
    write(folder.path / "killed/run.json", "{\"status\": \"starting\", \"version\": \"0\"}");
    CHECK(command("run " + listening + "-o " + folder.in_shell("killed")).code == 0);
    CHECK(is_done(folder.path / "killed"));
}

TEST_CASE("run directory: what runs did not make stays") {
    const Folder folder("notes");
    const fs::path run = folder.path / "run";
    const std::string line = "run " + bar + "-o " + folder.in_shell("run");
    const auto lies_there = [&] {
        return text_of(run / "paper/text.tex") == "years" && text_of(run / "notes.txt") == "mine";
    };
    fs::create_directories(run / "paper");
    write(run / "paper/text.tex", "years"), write(run / "notes.txt", "mine");
    SUBCASE("where a run that was killed begins again, and with force") {
        write(run / "run.json", "{\"status\": \"starting\", \"version\": \"0\"}");
        write(run / "energy.csv", "of an older run");
        for (const char* force : {"", " -s seed=2 --force"}) {
            CHECK(command(line + force).code == 0);
            CHECK(is_done(run));
            CHECK(lies_there());
        }
    }
    SUBCASE("beside a run.json of another program") {
        write(run / "run.json", "{\"a\": 1}");
        for (const char* force : {"", " --force"}) {
            const Answer answer = command(line + force);
            CHECK(answer.code == 2);
            CHECK_FALSE(answer.has("replace the old run"));
            CHECK(lies_there());
        }
    }
}

TEST_CASE("run directory: an unfinished run names the file that has changed since it began") {
    const Folder folder("changed file");
    const auto write_layers = [&](const char* angle) {
        write(folder.path / "layers.csv",
              std::string("x [m], y [m], angle [deg]\n-1, -1, 0\n2, -1, 0\n0, 2, ") + angle + "\n");
    };
    write_layers("10");
    write_scene(folder, R"(knap = 1
[domain]
shape = "rectangle"
size = ["20 mm", "10 mm"]
[mesh]
size = "5 mm"
[material.glass]
density = 2500
E = "70 GPa"
nu = 0.2
[material.glass.bedding]
E = "50 GPa"
nu = 0.2
angle = "layers.csv"
[interface.default]
breakable = false
[time]
end = "2 us"
[output]
fields = false
)");
    const std::string into_run = "-o " + folder.in_shell("run");
    REQUIRE(run_scene(folder, into_run).code == 0);
    std::string record = text_of(folder.path / "run/run.json");
    record.replace(record.find("\"done\""), 6, "\"running\"");
    write(folder.path / "run/run.json", record);
    write_layers("20");
    const Answer answer = run_scene(folder, into_run);
    CAPTURE(answer.text);
    CHECK(answer.code == 2);
    CHECK(answer.has("another scenario, nothing was run; `material_glass_bedding_angle.csv` has changed since"));
}

TEST_CASE("run directory: on a full disk an earlier run stays and the message names a cure") {
    const Folder folder("full");
    const std::string line = "run " + bar + "-s seed=2 -o " + folder.in_shell("run");
    REQUIRE(command("run " + bar + "-o " + folder.in_shell("run")).code == 0);
    const Answer full = command("--version >/dev/null; ulimit -f 0; '" KNAP_PROGRAM "' " + line + " --force");
    CAPTURE(full.text);
    CHECK(full.code == 3);
    CHECK(full.has("cannot write"));
    CHECK(full.has("files of the earlier run are still there"));
    CHECK(is_done(folder.path / "run"));
    fs::remove_all(folder.path / "run");  // as it says
    CHECK(command(line).code == 0);
}

TEST_CASE("run directory: a run whose record is lost may be replaced") {
    const Folder folder("lost record");
    const std::string line = "run " + bar + "-o " + folder.in_shell("run");
    REQUIRE(command(line).code == 0);
    fs::remove(folder.path / "run/run.json");
    CHECK(command(line).has("replace the old run with --force"));
    CHECK(command(line + " -s seed=2 --force").has("delete this one by hand"));
    CHECK(command(line + " --force").code == 0);
    CHECK(is_done(folder.path / "run"));
}

TEST_CASE("run directory: a pipe instead of one of its files is refused and not waited for") {
    const Folder folder("pipes");
    const std::string line = "timeout 20 '" KNAP_PROGRAM "' run " + bar + "-o " + folder.in_shell("run");
    const auto refused = [&](const char* name, const std::string& force) {
        const fs::path pipe = folder.path / "run" / name;
        fs::create_directories(pipe.parent_path());
        fs::remove(pipe);
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        const Answer answer = command("--version >/dev/null; " + line + force);
        CAPTURE(answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has("run/" + std::string(name) + "` is a pipe"));
        fs::remove(pipe);
    };
    for (const char* name : {"log.txt", "run.json", "run.json.part", "fields/bulk_0000.vtu"}) refused(name, "");
    fs::remove_all(folder.path / "run");
    REQUIRE(command("run " + bar + "-o " + folder.in_shell("run")).code == 0);
    for (const char* name : {"log.txt", "run.json", "scenario.toml", "energy.csv", "checkpoint"})
        refused(name, " --force");
    CHECK(mkfifo((folder.path / "run/mine").c_str(), 0600) == 0);  // no matter of the run
    CHECK(command("run " + bar + "--force -o " + folder.in_shell("run")).code == 0);
}

TEST_CASE("run directory: a volume of its own has more than nothing in it") {
    const Folder folder("volume");
    fs::create_directories(folder.path / "run/lost+found");
    CHECK(command("run " + bar + "-o " + folder.in_shell("run")).code == 0);
    CHECK(fs::exists(folder.path / "run/lost+found"));
}

}  // namespace run_directory_test
