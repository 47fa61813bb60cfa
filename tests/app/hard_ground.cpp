// Where people run programs: full disks, foreign languages, folders with any name, files that are no scenarios.
#include "program.hpp"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

using namespace program;

TEST_CASE("a full disk ends a run with 3 and says which file") {
    const Folder folder("full disk");
    // no file may grow beyond 200 blocks of 512 or 1024 bytes: the first frame does
    const std::string run = "'" KNAP_PROGRAM "' run " + small_block() + "-s 'mesh.size=1 mm' -o " + folder.in_shell("run");
    const std::string shell = "-c \"ulimit -f 200; " + run + "\" 2>&1";
    FILE* pipe = popen(("bash " + shell).c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::string text;
    char buffer[4096];
    for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
    const int status = pclose(pipe);
    CAPTURE(text);
    CHECK(WEXITSTATUS(status) == 3);
    CHECK(text.find("cannot write") != std::string::npos);
    CHECK(text.find("bulk_0000.vtu") != std::string::npos);
    CHECK(text_of(folder.path / "run/run.json").find("\"status\": \"failed\"") != std::string::npos);
    // the same command again, when there is room
    CHECK(command("run " + small_block() + "-s 'mesh.size=1 mm' -o " + folder.in_shell("run")).code == 0);
}

TEST_CASE("a run directory that vanishes ends the run with 3") {
    const Folder folder("vanishing");
    std::thread vandal([&] {
        for (int i = 0; i < 60000 && !fs::exists(folder.path / "run/fields/bulk_0001.vtu"); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::error_code ignored;
        for (int i = 0; i < 100 && fs::exists(folder.path / "run"); ++i) fs::remove_all(folder.path / "run", ignored);
    });
    const Answer answer = command("run " + small_block() + "-s 'mesh.size=1 mm' -s 'output.every=1 us' -o " + folder.in_shell("run"));
    vandal.join();
    CAPTURE(answer.text);
    CHECK(answer.code == 3);
    CHECK(answer.has("cannot write"));
}

TEST_CASE("SIGTERM ends a run as Ctrl-C does") {
    const Folder folder("terminate");
    const fs::path run = folder.path / "run";
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        execl(KNAP_PROGRAM, KNAP_PROGRAM, "run", "edge_cracked_block", "-q", "-j", "1", "-o", run.c_str(), nullptr);
        _exit(127);
    }
    for (int i = 0; i < 600 && !fs::exists(run / "fields/bulk_0001.vtu"); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    kill(child, SIGTERM);
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 130);
    CHECK(text_of(run / "run.json").find("\"status\": \"interrupted\"") != std::string::npos);
}

TEST_CASE("a run goes on when nobody reads what it says") {
    const Folder folder("deaf");
    command("run edge_cracked_block -j 1 -s 'mesh.size=2 mm' -s 'time.end=40 us' -s 'expect={}' -o " + folder.in_shell("run") + " 2>&1 | head -c 1");
    CHECK(text_of(folder.path / "run/run.json").find("\"status\": \"done\"") != std::string::npos);
}

TEST_CASE("names of files and folders may have any letters") {
    const Folder folder("Übung größer ☃ 日本");
    fs::copy_file(KNAP_SOURCE_DIR "/scenarios/bar_pulled_apart.toml", folder.path / "stab ä.toml");
    const Answer answer = command("run " + folder.in_shell("stab ä.toml") + " -q -j 1 -o " + folder.in_shell("läuft ☃"));
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    for (const char* file : {"figures/energy.png", "fields/bulk_0000.vtu", "run.pvd", "energy.csv"})
        CHECK_MESSAGE(fs::file_size(folder.path / "läuft ☃" / file) > 0, file);
}

TEST_CASE("a language whose decimal sign is a comma changes no number") {
    const Folder folder("comma");
    const std::string scenario = " run bar_pulled_apart -q -j 1 -o ";
    const auto in_language = [&](const std::string& language) {
        const std::string run = "LC_ALL=" + language + " '" KNAP_PROGRAM "'" + scenario + folder.in_shell(language) + " > /dev/null 2>&1";
        REQUIRE(std::system(run.c_str()) == 0);
    };
    for (const char* language : {"C", "de_DE.UTF-8", "tr_TR.UTF-8"}) in_language(language);  // of which the machine may have only the first
    for (const char* file : {"energy.csv", "cracks.csv", "resolved.toml", "fields/bulk_0001.vtu"}) {
        CAPTURE(file);
        CHECK(text_of(folder.path / "C" / file) == text_of(folder.path / "de_DE.UTF-8" / file));
        CHECK(text_of(folder.path / "C" / file) == text_of(folder.path / "tr_TR.UTF-8" / file));
    }
}

TEST_CASE("what is no scenario is refused in a few lines") {
    const Folder folder("no scenario");
    const auto written = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder.path / name, std::ios::binary) << text;
        return command("check " + folder.in_shell(name));
    };
    const Answer empty = written("empty.toml", ""), picture = written("picture.toml", std::string("\x89PNG\r\n\x1a\n\0\0\0", 11));
    CHECK(empty.code == 2);
    CHECK(empty.has("says nothing"));
    CHECK(picture.code == 2);
    CHECK(picture.has("is not a text file"));
    const Answer large = written("large.toml", "a = \"" + std::string(21'000'000, 'x') + "\"\n");
    CHECK(large.code == 2);
    CHECK(large.has("more than 20 MB"));
    const Answer deep = written("deep.toml", "a = " + std::string(100'000, '['));
    CHECK(deep.code == 2);
    CHECK(deep.text.size() < 2000);
    std::string keys = "knap = 1\n";
    for (int i = 0; i < 2000; ++i) keys += "key_" + std::to_string(i) + " = 1.5\n";
    const Answer many = written("many.toml", keys);
    CHECK(many.code == 2);
    CHECK(many.has("... and 19"));
    CHECK(many.has("20"));
    CHECK(many.text.size() < 20'000);
}
