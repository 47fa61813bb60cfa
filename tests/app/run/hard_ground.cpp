// Where people run programs: full disks, foreign languages, folders with any name, files that are no scenarios.
#include "app/program.hpp"

#include <linux/capability.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <future>
#include <thread>

namespace hard_ground_test {

using namespace program;

TEST_CASE("a full disk ends a run with 3 and says which file") {
    const Folder folder("full disk");
    // no file may grow beyond 200 blocks of 512 or 1024 bytes: the first frame does
    const std::string run =
        "'" KNAP_PROGRAM "' run " + small_block() + "-s 'mesh.size=1 mm' -o " + folder.in_shell("run");
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

TEST_CASE("on a full volume nothing is lost but what had no room") {
    const Folder folder("full volume");
    if (std::system("unshare -rm true 2>/dev/null") != 0) return;  // who may not mount
    // a volume of 300 kB in a name space of its own, later 50 MB
    const std::string run =
        "'" KNAP_PROGRAM "' run " + small_block() + "-s output.checkpoint_every=0 -o volume/run 2>&1; echo code $?; ";
    std::ofstream(folder.path / "script")
        << "mkdir volume && mount -t tmpfs -o size=300k none volume && " << run << "grep status volume/run/run.json; "
        << "mount -o remount,size=50m volume && " << run
        << "grep status volume/run/run.json; cp volume/run/energy.csv .";
    const Answer answer = command("--version >/dev/null; cd " + folder.in_shell("") + "; unshare -rm sh script");
    CAPTURE(answer.text);
    const std::size_t full = answer.text.find("No space left on device"), failed = answer.text.find("code 3\n"),
                      done = answer.text.find("code 0\n");
    CHECK(full < failed);
    CHECK(failed < answer.text.find("\"failed\""));
    CHECK(failed < done);
    CHECK(done < answer.text.find("\"done\""));
    REQUIRE(command("run " + small_block() + "-o " + folder.in_shell("roomy")).code == 0);
    CHECK(text_of(folder.path / "energy.csv") == text_of(folder.path / "roomy/energy.csv"));
}

TEST_CASE("where nothing may be written this is reported and files are read all the same") {
    const Folder folder("read only");
    const fs::path locked = folder.path / "locked";
    const std::string run = "run bar_ramp_wave -q -j 1 -s 'time.end=\"2 us\"' -s expect={} ";
    fs::create_directory(locked);
    REQUIRE(command(run + "-o " + folder.in_shell("locked/run")).code == 0);
    const auto permit = [&](fs::perms perms) {
        for (const fs::path& path : {locked / "run/figures", locked / "run/fields", locked / "run", locked})
            fs::permissions(path, perms);
    };
    permit(fs::perms::owner_read | fs::perms::owner_exec);
    const auto answer_of = [](const std::string& arguments) {
        return std::async(std::launch::async,
                          [&] {
                              prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0,
                                    0);  // root would be let in; of this thread and what it starts
                              return command(arguments);
                          })
            .get();
    };
    for (const std::string& arguments :
         {run + "-o " + folder.in_shell("locked/new"),
          "sweep bar_ramp_wave --seeds 1 -o " + folder.in_shell("locked/new"), "new " + folder.in_shell("locked/new"),
          "mesh bar_ramp_wave -o " + folder.in_shell("locked/new.svg"), "render " + folder.in_shell("locked/run")}) {
        const Answer answer = answer_of(arguments);
        CAPTURE(answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has("Permission denied"));
    }
    const Answer again = answer_of(run + "--force -o " + folder.in_shell("locked/run"));
    CHECK(again.code == 3);
    CHECK(again.has("run.json: Permission denied; files of the earlier run are still there"));
    CHECK(command("info " + folder.in_shell("locked/run")).code == 0);
    CHECK(command("render " + folder.in_shell("locked/run") + " --show speed -o " + folder.in_shell("figures")).code ==
          0);
    permit(fs::perms::owner_all);
}

TEST_CASE("without an environment the results are those of any run") {
    const Folder folder("bare");
    const std::string run = " run bar_ramp_wave -q -j 1 -s 'time.end=\"2 us\"' -s expect={} -o ";
    REQUIRE(command(run + folder.in_shell("usual")).code == 0);
    REQUIRE(command("--version >/dev/null; env -i '" KNAP_PROGRAM "'" + run + folder.in_shell("bare")).code ==
            0);  // no display, home, path, language, terminal
    for (const char* file : {"energy.csv", "fields/bulk_0001.vtu", "figures/opening.png"}) {
        CHECK_MESSAGE(fs::file_size(folder.path / "bare" / file) > 0, file);
        CHECK_MESSAGE(text_of(folder.path / "usual" / file) == text_of(folder.path / "bare" / file), file);
    }
}

TEST_CASE("progress is rewritten on a terminal and comes in lines elsewhere") {
    const Folder folder("terminal");
    std::string run = "run " + small_block() + "--force -o " + folder.in_shell("run");
    run.erase(run.find("-q "), 3);
    const Answer elsewhere = command(run);
    CHECK(elsewhere.code == 0);
    CHECK(elsewhere.has("100 %  t 40 us"));
    CHECK(elsewhere.text.find('\r') == std::string::npos);
    CHECK(elsewhere.text.find('\033') == std::string::npos);
    if (std::system("command -v script >/dev/null") != 0) return;
    std::ofstream(folder.path / "typed") << "stty cols 60; '" KNAP_PROGRAM "' " << run << "\n";
    const Answer terminal =
        command("--version >/dev/null; script -qec \"sh " + folder.in_shell("typed") + "\" /dev/null </dev/null");
    CAPTURE(terminal.text);
    std::size_t n_lines = 0;
    for (std::size_t at = terminal.text.find("\r\033[K"); at != std::string::npos;
         at = terminal.text.find("\r\033[K", at + 1)) {
        ++n_lines;
        CHECK(terminal.text.find_first_of("\r\n", at + 4) - at - 4 < 60);
    }
    CHECK(n_lines > 0);
}

TEST_CASE("a run directory that vanishes ends the run with 3") {
    const Folder folder("vanishing");
    std::thread vandal([&] {
        for (int i = 0; i < 60000 && !fs::exists(folder.path / "run/fields/bulk_0001.vtu"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::error_code ignored;
        for (int i = 0; i < 100 && fs::exists(folder.path / "run"); ++i) fs::remove_all(folder.path / "run", ignored);
    });
    const Answer answer =
        command("run " + small_block() + "-s 'mesh.size=1 mm' -s 'output.every=1 us' -o " + folder.in_shell("run"));
    vandal.join();
    CAPTURE(answer.text);
    CHECK(answer.code == 3);
    CHECK(answer.has("cannot write"));
}

namespace {

/// Starts the program as a shell would, with `before` done to it, and its messages in `log`.
pid_t started(const std::string& arguments, const fs::path& log, const std::string& before = "") {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        execl("/bin/sh", "sh", "-c",
              (before + "exec '" KNAP_PROGRAM "' " + arguments + " >'" + log.string() + "' 2>&1").c_str(), nullptr);
        _exit(127);
    }
    return child;
}

int exit_code_of(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/// Whether a process is the program by now, and has set what is to be done at this signal.
bool catches(pid_t process, int signal) {
    std::error_code none;
    if (!fs::equivalent("/proc/" + std::to_string(process) + "/exe", KNAP_PROGRAM, none)) return false;
    const std::string status = text_of("/proc/" + std::to_string(process) + "/status");
    const std::size_t at = status.find("SigCgt:");
    return at != std::string::npos && (std::stoull(status.substr(at + 7), nullptr, 16) >> (signal - 1) & 1) != 0;
}

void wait_for(const std::function<bool()>& happened) {
    for (int i = 0; i < 30000 && !happened(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

TEST_CASE("SIGTERM and SIGHUP end a run as Ctrl-C does") {
    const Folder folder("terminate");
    const fs::path run = folder.path / "run";
    for (const int signal : {SIGTERM, SIGHUP}) {
        CAPTURE(signal);
        const pid_t child = started(
            "run edge_cracked_block -q -j 1 -s 'mesh.size=1 mm' --force " + undrawn + "-o " + folder.in_shell("run"),
            folder.path / "log");
        wait_for([&] { return fs::exists(run / "fields/bulk_0001.vtu"); });
        kill(child, signal);
        CHECK(exit_code_of(child) == 130);
        CHECK(text_of(run / "run.json").find("\"status\": \"interrupted\"") != std::string::npos);
        fs::remove_all(run);
    }
}

TEST_CASE("a run that is ended while it makes its mesh says so and leaves nothing") {
    const Folder folder("no mesh");
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        CAPTURE(signal);
        const pid_t child =
            started("run edge_cracked_block -j 1 -s mesh.size=0.1mm -o " + folder.in_shell("run"), folder.path / "log");
        for (int i = 0; i < 1000 && !catches(child, signal); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        kill(child, signal);
        CHECK(exit_code_of(child) == 130);
        CHECK(text_of(folder.path / "log") == "interrupted\n");
        CHECK_FALSE(fs::exists(folder.path / "run"));
    }
}

TEST_CASE("a run under nohup outlives its terminal") {
    const Folder folder("nohup");
    const pid_t child =
        started("run " + small_block() + "-o " + folder.in_shell("run"), folder.path / "log", "trap '' HUP; ");
    wait_for([&] { return fs::exists(folder.path / "run/fields/bulk_0001.vtu"); });
    kill(child, SIGHUP);
    CHECK(exit_code_of(child) == 0);
}

TEST_CASE("a run that was started with Ctrl-C ignored is not ended by it") {
    const Folder folder("ignored");
    const pid_t child =
        started("run " + small_block() + "-o " + folder.in_shell("run"), folder.path / "log", "trap '' INT; ");
    wait_for([&] { return fs::exists(folder.path / "run/fields/bulk_0001.vtu"); });
    kill(child, SIGINT);
    CHECK(exit_code_of(child) == 0);
}

TEST_CASE("threads are those of the option or else of OMP_NUM_THREADS or else of Slurm") {
    const Folder folder("threads");
    const auto threads = [&](const std::string& environment, const std::string& option) {
        command("--version >/dev/null; " + environment +
                " '" KNAP_PROGRAM "' run bar_pulled_apart -q --force --until 1us " + option + " -s figure=[] -o " +
                folder.in_shell("run"));
        const std::string json = text_of(folder.path / "run" / "run.json"), key = "\"threads\": ";
        return std::atoi(json.c_str() + json.find(key) + key.size());
    };
    CHECK(threads("OMP_NUM_THREADS=3 SLURM_CPUS_PER_TASK=2", "-j 1") == 1);
    CHECK(threads("OMP_NUM_THREADS=3 SLURM_CPUS_PER_TASK=2", "") == 3);
    CHECK(threads("unset OMP_NUM_THREADS; SLURM_CPUS_PER_TASK=5", "") == 5);
}

TEST_CASE("a run goes on when nobody reads what it says") {
    const Folder folder("deaf");
    command("run edge_cracked_block -j 1 -s 'mesh.size=2 mm' -s 'time.end=40 us' -s 'expect={}' " + undrawn + "-o " +
            folder.in_shell("run") + " 2>&1 | head -c 1");
    CHECK(text_of(folder.path / "run/run.json").find("\"status\": \"done\"") != std::string::npos);
}

TEST_CASE("names of files and folders may have any letters") {
    const Folder folder("Übung größer ☃ 日本");
    fs::copy_file(KNAP_SOURCE_DIR "/scenarios/bar_pulled_apart.toml", folder.path / "stab ä.toml");
    const Answer answer =
        command("run " + folder.in_shell("stab ä.toml") + " -q -j 1 -o " + folder.in_shell("läuft ☃"));
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    for (const char* file : {"figures/energy.png", "fields/bulk_0000.vtu", "run.pvd", "energy.csv"})
        CHECK_MESSAGE(fs::file_size(folder.path / "läuft ☃" / file) > 0, file);
}

TEST_CASE("a language whose decimal sign is a comma changes no number") {
    const Folder folder("comma");
    const std::string scenario = " run bar_pulled_apart -q -j 1 " + undrawn + "-o ";
    const auto in_language = [&](const std::string& language) {
        const std::string run =
            "LC_ALL=" + language + " '" KNAP_PROGRAM "'" + scenario + folder.in_shell(language) + " > /dev/null 2>&1";
        REQUIRE(std::system(run.c_str()) == 0);
    };
    for (const char* language : {"C", "de_DE.UTF-8", "tr_TR.UTF-8"})
        in_language(language);  // of which the machine may have only the first
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
    const Answer empty = written("empty.toml", ""),
                 picture = written("picture.toml", std::string("\x89PNG\r\n\x1a\n\0\0\0", 11));
    CHECK(empty.code == 2);
    CHECK(empty.has("has no keys"));
    CHECK(picture.code == 2);
    CHECK(picture.has("is not a text file"));
    written("large.toml", "knap = 1\n");
    fs::resize_file(folder.path / "large.toml", 100'000'000);
    const Answer large = command("check " + folder.in_shell("large.toml"));
    CHECK(large.code == 2);
    CHECK(large.has("more than 20 MB"));
    const Answer deep = written("deep.toml", "a = " + std::string(100'000, '['));
    CHECK(deep.code == 2);
    CHECK(deep.text.size() < 2000);
    std::string keys = "knap = 1\n";
    for (int i = 0; i < 2000; ++i) keys += "key_" + std::to_string(i) + " = 1.5\n";
    const Answer many = written("many.toml", keys);
    CHECK(many.code == 2);
    CHECK(many.has("the other 19"));
    CHECK(many.has("20"));
    CHECK(many.text.size() <
          50 * 200 + 2000 * 60);  // fifty in full, the first alone names the blocks; then a line each
}

}  // namespace hard_ground_test
