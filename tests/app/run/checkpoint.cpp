// Endurance: a run that is killed, interrupted or damaged goes on with the same bits, and nothing is lost.
#include "app/run/checkpoint.hpp"
#include "app/program.hpp"
#include "base/error.hpp"
#include "base/random.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

namespace checkpoint_test {

using namespace program;

namespace {

const std::string explicit_block = small_block() + "-s output.breaks=true ";
const std::string implicit_block =
    "edge_cracked_block_implicit -q -j 1 -s 'mesh.size=5 mm' -s 'time.end=40 us' -s 'time.step=1 us' -s 'expect={}' -s "
    "output.breaks=true " +
    undrawn;

/// Half of the time is spent in refinements.
const std::string refined_block =
    "edge_cracked_block -q -j 1 -s 'mesh.size=4 mm' -s 'adapt={ size = \"0.5 mm\", every = 10 }' -s "
    "'interface.default.sigma_c=8 MPa' -s 'time.end=25 us' -s 'output.every=2 us' -s 'expect={}' -s "
    "output.breaks=true " +
    undrawn;

/// Conduction, cracks and a time factor.
const std::string explicit_quench =
    "alumina_quench -q -j 1 -s 'mesh.size=1 mm' -s 'time.end=100 us' -s time.damping=0 -s 'expect={}' -s "
    "output.breaks=true " +
    undrawn;
const std::string implicit_quench = explicit_quench +
                                    "-s time.bulk=implicit -s time.cohesion=implicit -s time.theta=1 -s "
                                    "time.assumption_1=ignore -s limits.law_lag=10 -s "
                                    "'time.step=2 us' ";

/// Implicit steps, explicit ones where cracks run, and implicit ones in between.
const std::string changing_specimen =
    "uniaxial_compression -q -j 1 -s 'mesh.size=6 mm' -s time.bulk=auto -s 'time.damping=50 kHz' -s "
    "time.quiet_below=1e-3 -s 'obstacle[0].velocity=[\"0 m/s\", \"-10 mm/s\"]' -s 'obstacle[0].ramp=2 ms' -s "
    "'time.step=0.1 ms' -s 'time.end=12 ms' -s limits.law_lag=none -s 'expect={}' -s output.breaks=true " +
    undrawn;

/// Rigid in flight; from 30 ms on its pieces step by themselves, and become rigid again.
const std::string boulder_with_islands =
    "boulder_breaks -q -j 1 -s 'rigid={ hold = 5 }' -s 'time.end=90 ms' -s 'output.every=5 ms' -s 'expect={}' -s "
    "output.breaks=true " +
    undrawn;

ino_t inode(const fs::path& path) {
    struct stat found {};
    return stat(path.c_str(), &found) == 0 ? found.st_ino : 0;
}

/// Starts `knap run`, waits until it has written a checkpoint of its own and `pause` longer, and sends it `signal`. Its
/// exit status as of wait().
int run_and_stop(const std::string& arguments, const fs::path& run, int signal, std::chrono::microseconds pause) {
    const ino_t before = inode(run / "checkpoint");
    const pid_t child = fork();
    if (child == 0) {
        const std::string line =
            "exec '" KNAP_PROGRAM "' run " + arguments + "-o '" + run.string() + "' >/dev/null 2>&1";
        execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    int status = 0;
    bool ended = false;
    while (!ended && (inode(run / "checkpoint") == before || inode(run / "checkpoint") == 0)) {
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        ended = waitpid(child, &status, WNOHANG) == child;
    }
    if (ended) return status;
    std::this_thread::sleep_for(pause);
    kill(child, signal);
    waitpid(child, &status, 0);
    return status;
}

/// All that a run found: its histories, fragments and every field frame.
void check_same_bits(const fs::path& a, const fs::path& b) {
    std::vector<fs::path> files{"energy.csv", "cracks.csv", "arms.csv", "breaks.csv", "fragments.csv", "run.pvd"};
    for (const auto& entry : fs::directory_iterator(a / "fields"))
        files.push_back(fs::path("fields") / entry.path().filename());
    CHECK(files.size() > 10);
    for (const fs::path& file : files) CHECK_MESSAGE(text_of(a / file) == text_of(b / file), file);
    CHECK_FALSE(knap::Checkpoints::exist_in(a));  // of a run that is done
    CHECK_FALSE(knap::Checkpoints::exist_in(b));
}

/// Each file of a frame is whole, whatever became of its run.
void check_frames(const fs::path& whole, const fs::path& killed) {
    for (const auto& entry : fs::directory_iterator(killed / "fields"))
        if (entry.path().extension() == ".vtu")
            CHECK_MESSAGE(text_of(whole / "fields" / entry.path().filename()) == text_of(entry.path()), entry.path());
}

void kill_often(const std::string& block, const Folder& folder, int times = 20) {
    REQUIRE(command("run " + block + "-o " + folder.in_shell("whole")).code == 0);
    const std::string often = block + "-s output.checkpoint_every=0 ";
    knap::Random random(7, "kills");
    int n_kills = 0;
    for (int i = 0; i < times; ++i) {
        const int status = run_and_stop(often, folder.path / "killed", SIGKILL,
                                        std::chrono::microseconds(static_cast<int>(random.uniform(0, 10000))));
        if (!WIFSIGNALED(status)) break;
        check_frames(folder.path / "whole", folder.path / "killed");
        ++n_kills;
        if (i == 0 && text_of(folder.path / "killed/run.json").find("\"status\": \"running\"") != std::string::npos)
            CHECK(command("info " + folder.in_shell("killed")).has(", killed, "));
    }
    CHECK(n_kills > times / 4);
    const Answer last = command("run " + often + "-o " + folder.in_shell("killed"));
    CAPTURE(last.text);
    CHECK((last.code == 0 || last.has("run-exists")));  // or the last one had come to its end before it was killed
    check_same_bits(folder.path / "whole", folder.path / "killed");
}

}  // namespace

TEST_CASE("a run killed at twenty random moments ends with the same bits") {
    kill_often(explicit_block, Folder("killed explicit"));
}

TEST_CASE("a run with rigid pieces and islands that is killed ends with the same bits") {
    kill_often(boulder_with_islands, Folder("killed islands"), 8);
}

TEST_CASE("runs of other kinds killed at twenty random moments end with the same bits" * doctest::test_suite("slow")) {
    SUBCASE("with refinements") { kill_often(refined_block, Folder("killed refined")); }
    SUBCASE("implicit") { kill_often(implicit_block, Folder("killed implicit")); }
    SUBCASE("both schemes") { kill_often(changing_specimen, Folder("killed both schemes")); }
    SUBCASE("with heat") { kill_often(explicit_quench, Folder("killed quench")); }
    SUBCASE("with heat, implicit") { kill_often(implicit_quench, Folder("killed implicit quench")); }
}

TEST_CASE("an interrupted run goes on when it is started again") {
    const Folder folder("resumed");
    const std::string block = explicit_block + "-s output.checkpoint_every=0 ";
    REQUIRE(command("run " + explicit_block + "-o " + folder.in_shell("whole")).code == 0);
    const int status = run_and_stop(block, folder.path / "stopped", SIGINT, std::chrono::microseconds(0));
    REQUIRE(WIFEXITED(status));
    REQUIRE(WEXITSTATUS(status) == 130);
    CHECK(text_of(folder.path / "stopped/run.json").find("\"status\": \"interrupted\"") != std::string::npos);
    const auto stop = [&] {  // each goes on from a copy of the one run
        fs::remove_all(folder.path / "run");
        fs::copy(folder.path / "stopped", folder.path / "run", fs::copy_options::recursive);
    };

    {  // with the same bits
        stop();
        CHECK(command("run " + block + "-o " + folder.in_shell("run")).code == 0);
        CHECK(text_of(folder.path / "run/log.txt").find("resumed: continues from the checkpoint at t = ") !=
              std::string::npos);
        check_same_bits(folder.path / "whole", folder.path / "run");
    }
    {  // from the older checkpoint where the newest is damaged
        stop();
        flip_a_byte(folder.path / "run/checkpoint");
        REQUIRE(fs::exists(folder.path / "run/checkpoint.previous"));
        const Answer again = command("run " + block + "-o " + folder.in_shell("run"));
        CHECK(again.code == 0);
        for (const std::string& text : {again.text, text_of(folder.path / "run/log.txt")}) {  // with -q, too
            CHECK(text.find("is not used: its checksum is wrong") != std::string::npos);
            CHECK(text.find("resumed: continues from the checkpoint at t = ") != std::string::npos);
        }
        check_same_bits(folder.path / "whole", folder.path / "run");
    }
    {  // without the frames that were taken away and says so
        stop();
        REQUIRE(fs::exists(folder.path / "run/fields/bulk_0000.vtu"));
        fs::remove(folder.path / "run/fields/bulk_0000.vtu");
        fs::remove(folder.path / "run/run.pvd");
        const Answer again = command("run " + block + "-o " + folder.in_shell("run"));
        CHECK(again.code == 0);
        CHECK(again.has("warning[missing-file]: fields/bulk_0000.vtu"));
        CHECK(text_of(folder.path / "run/run.json").find("fields/bulk_0000.vtu") != std::string::npos);
        fs::copy_file(folder.path / "whole/fields/bulk_0000.vtu", folder.path / "run/fields/bulk_0000.vtu");
        check_same_bits(folder.path / "whole", folder.path / "run");
    }
    {  // not where both are damaged and nothing is lost then
        stop();
        flip_a_byte(folder.path / "run/checkpoint");
        fs::resize_file(folder.path / "run/checkpoint.previous", 100);
        const std::string energy = text_of(folder.path / "run/energy.csv");
        const Answer again = command("run " + block + "-o " + folder.in_shell("run"));
        CHECK(again.code == 2);
        CHECK(again.has("no-checkpoint"));
        CHECK(again.has("--force"));
        CHECK(text_of(folder.path / "run/energy.csv") == energy);
    }
    {  // not as another scenario
        stop();
        const Answer other = command("run " + block + "-s seed=3 -o " + folder.in_shell("run"));
        CHECK(other.has("run-exists"));
        CHECK(other.has("holds an unfinished run of another scenario"));
        CHECK(other.has("they differ first: `seed = 4` there, `seed = 3` here"));
        CHECK(other.has("--force deletes it"));
        CHECK(command("run " + block + "-s mesh.grading=0.2 -o " + folder.in_shell("run"))
                  .has("first in [mesh]: `grading = 0.3` there, `grading = 0.2` here"));
        CHECK(knap::Checkpoints::exist_in(folder.path / "run"));
        // as the message says
        CHECK(command("run " + folder.in_shell("run/resolved.toml") + " -q -j 1 -o " + folder.in_shell("run")).code ==
              0);
        check_same_bits(folder.path / "whole", folder.path / "run");
    }
    {  // where its file has another comment
        stop();
        std::ofstream(folder.path / "other.toml") << "# a remark\n" << text_of(folder.path / "run/scenario.toml");
        std::string of_file = block;
        CHECK(command("run " + of_file.replace(0, of_file.find(' '), folder.in_shell("other.toml")) + "-o " +
                      folder.in_shell("run"))
                  .code == 0);
        CHECK(text_of(folder.path / "run/log.txt").find("resumed: continues from the checkpoint at t = ") !=
              std::string::npos);
    }
}

TEST_CASE("a slope that thaws goes on with the same bits") {  // the laws of its points are made again
    for (const std::string coupling : {"sum", "norm"}) {
        CAPTURE(coupling);
        const Folder folder("thaw");
        const std::string run =
            "run permafrost_slope -q -j 1 -s 'mesh.size=3 m' -s 'time.end=0.9 s' -s 'expect={}' -s "
            "output.breaks=true -s interface.joint.coupling=" +
            coupling + " " + undrawn + "-o ";
        REQUIRE(command(run + folder.in_shell("whole")).code == 0);
        CHECK(command(run + folder.in_shell("parts") + " --until 500ms").code == 0);
        CHECK(command(run + folder.in_shell("parts")).code == 0);
        check_same_bits(folder.path / "whole", folder.path / "parts");
    }
}

TEST_CASE("a run that goes on from its older checkpoint keeps that until it has a newer one that is whole") {
    const Folder folder("older");
    const std::string run = "run " + explicit_block + "-s 'output.checkpoint_every=1 h' -o " + folder.in_shell("run");
    for (const char* until : {"10us", "20us", "15us"}) {
        CHECK(command(run + " --until " + until).code == 0);
        if (std::string(until) != "10us") flip_a_byte(folder.path / "run/checkpoint");
    }
    CHECK(command(run + " --until 12us").code == 0);  // from 10 us
}

TEST_CASE("both checkpoints stay where a newer one cannot be written") {
    const Folder folder("no third");
    const fs::path run = folder.path / "run", in_the_way = run / "checkpoint.part/something";
    const std::string block = "run " + explicit_block + "-s 'output.checkpoint_every=1 h' -o " + folder.in_shell("run");
    for (const char* until : {"10us", "20us"}) REQUIRE(command(block + " --until " + until).code == 0);
    const std::string newest = text_of(run / "checkpoint"), previous = text_of(run / "checkpoint.previous");
    fs::create_directories(in_the_way);
    const Answer answer = command(block + " --until 30us");
    CHECK(answer.code == 3);
    CHECK(answer.has("cannot write"));
    CHECK(text_of(run / "checkpoint") == newest);
    CHECK(text_of(run / "checkpoint.previous") == previous);
    fs::remove_all(in_the_way.parent_path());
    CHECK(command(block + " --until 30us").code == 0);
    CHECK(text_of(run / "checkpoint.previous") == newest);
}

TEST_CASE("tables that are deleted while a run goes on are whole at its end") {
    const Folder folder("deleted table");
    std::thread vandal([&] {
        for (int i = 0; i < 60000 && !fs::exists(folder.path / "run/fields/bulk_0001.vtu"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        fs::remove(folder.path / "run/energy.csv");
    });
    CHECK(command("run " + explicit_block + "-o " + folder.in_shell("run")).code == 0);
    vandal.join();
    CHECK(command("run " + explicit_block + "-o " + folder.in_shell("whole")).code == 0);
    CHECK(text_of(folder.path / "run/energy.csv") == text_of(folder.path / "whole/energy.csv"));
}

TEST_CASE("a run that cannot write goes on when it can") {
    const Folder folder("cannot write");
    const std::string block = explicit_block + "-s output.checkpoint_every=0 ";
    REQUIRE(command("run " + explicit_block + "-o " + folder.in_shell("whole")).code == 0);
    // its fields vanish while it runs
    std::thread vandal([&] {
        for (int i = 0; i < 60000 && !fs::exists(folder.path / "run/fields/bulk_0002.vtu"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        fs::rename(folder.path / "run/fields", folder.path / "fields");
    });
    const Answer stopped = command("run " + block + "-o " + folder.in_shell("run"));
    vandal.join();
    CAPTURE(stopped.text);
    CHECK(stopped.code == 3);
    CHECK(stopped.has("the same command continues"));
    CHECK(text_of(folder.path / "run/run.json").find("\"status\": \"failed\"") != std::string::npos);
    fs::rename(folder.path / "fields", folder.path / "run/fields");
    CHECK(command("run " + block + "-o " + folder.in_shell("run")).code == 0);
    check_same_bits(folder.path / "whole", folder.path / "run");
}

TEST_CASE("a checkpoint of another format names the version that reads it") {
    CHECK_THROWS_WITH_AS(knap::unpacked_checkpoint("knap-checkpoint 7 0.1.0-abcdef 0 0 0 0\n"),
                         doctest::Contains("its format is 7, that of this program is "), knap::SimulationError);
    CHECK_THROWS_WITH_AS(knap::unpacked_checkpoint("knap-checkpoint 7 0.1.0-abcdef 0 0 0 0\n"),
                         doctest::Contains("; knap 0.1.0-abcdef reads it"), knap::SimulationError);
}

TEST_CASE("damaged checkpoints are told from whole ones") {
    const std::string memory = "all that a run remembers\n", room(knap::room_for_head, ' ');
    const std::string whole = knap::packed_checkpoint(room + memory, {.time = 1e-5, .last_step = 1e-8});
    CHECK(knap::unpacked_checkpoint(whole) == memory);
    CHECK(knap::unpacked_checkpoint(knap::packed_checkpoint(room, {})) == "");
    for (std::size_t i = 0; i < whole.size(); ++i) {
        CHECK_THROWS_AS(knap::unpacked_checkpoint(whole.substr(0, i)), knap::SimulationError);
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ 4);
        CHECK_THROWS_AS(knap::unpacked_checkpoint(damaged), knap::SimulationError);
    }
}

}  // namespace checkpoint_test
