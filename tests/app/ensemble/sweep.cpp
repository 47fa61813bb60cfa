// knap sweep: which runs, what is kept, its tables, and its command lines for other schedulers.
#include "app/program.hpp"

#include "app/ensemble/ensemble.hpp"
#include "app/run/report.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

namespace sweep_test {

using namespace program;
using namespace knap;

namespace {

using Texts = std::vector<std::string>;

/// A bar that breaks in the middle: it takes G_c x 4 mm x 1 m, on every mesh.
const std::string bar =
    "bar_pulled_apart -s 'mesh.size=1.5 mm' -s time.end=\"200 us\" -s output.fields=false " + undrawn;
const std::string both = bar + "-s 'interface.left-right.G_c=1.5,3' --seeds 1..2 ";

std::vector<Texts> rows_of(const fs::path& csv) {
    std::ifstream file(csv);
    std::vector<Texts> rows;
    for (std::string line; std::getline(file, line);) {
        std::istringstream cells(line);
        rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

bool has_program(const std::string& name) {
    return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

/// In a shell, in a directory.
int shell_in(const fs::path& directory, const std::string& line) {
    return std::system(("cd '" + directory.string() + "' && " + line + " >shell.txt 2>&1").c_str());
}

void check_whole(const Answer& answer, const fs::path& sweep) {
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    const std::vector<Texts> rows = rows_of(sweep / "sweep.csv");
    REQUIRE(rows.size() == 5);
    CHECK(rows[0] == Texts{"run", "interface.left-right.G_c", "seed", "status", "triangles", "steps", "cpu [s]",
                           "broken_length [m]", "dissipated [J]", "fragments"});
    const Texts values{"1.5", "1.5", "3", "3"}, seeds{"1", "2", "1", "2"};
    for (std::size_t i = 0; i < 4; ++i) {
        const Texts& row = rows[i + 1];
        REQUIRE(row.size() == 10);
        CHECK(row[0] == "G_c_" + values[i] + "_s" + seeds[i]);
        CHECK(row[1] == values[i]);
        CHECK(row[2] == seeds[i]);
        CHECK(row[3] == "done");
        CHECK(std::stod(row[8]) == tests::relative(std::stod(values[i]) * 4e-3, 1e-9));  // G_c x length x thickness
        CHECK(row[9] == "2");
    }
    CHECK(fs::file_size(sweep / "sweep.png") > 10000);
}

}  // namespace

TEST_CASE("sweep: values of a key are split at commas outside of quotes and brackets") {
    CHECK(sweep_key("mesh.size=1 mm, 2 mm").key == "mesh.size");
    CHECK(sweep_key("mesh.size=1 mm, 2 mm").values == Texts{"1 mm", "2 mm"});
    CHECK(sweep_key("domain.size=[1, 2],[3,4]").values == Texts{"[1, 2]", "[3,4]"});
    CHECK(sweep_key("title=\"a, b\",\"it's\"").values == Texts{"\"a, b\"", "\"it's\""});
    CHECK(sweep_key("title=\"say \\\"a, b\\\"\",'\\'").values == Texts{"\"say \\\"a, b\\\"\"", "'\\'"});
    CHECK(sweep_key("mesh.size= 1 mm ,\t2 mm ").values == Texts{"1 mm", "2 mm"});
    CHECK(sweep_key("title=a\\").values == Texts{"a\\"});
    CHECK(sweep_key("title=\"a\\").values == Texts{"\"a\\"});
    CHECK(sweep_key("figure=").values == Texts{""});
    CHECK_THROWS_AS(sweep_key("mesh.size"), UserError);
    CHECK_THROWS_AS(sweep_key("=1"), UserError);
    CHECK(seed_overrides("20") == Texts{"sweep.seeds=20"});
    CHECK(seed_overrides("3..20") == Texts{"seed=3", "sweep.seeds=18"});
    for (const char* wrong : {"1..", "..3", "4..3", "-1", "a", "1...3"})
        CHECK_THROWS_AS(seed_overrides(wrong), UserError);
    CHECK(quoted_for_shell("mesh.size=1e-3") == "mesh.size=1e-3");
    CHECK(quoted_for_shell("it's $1") == "'it'\\''s $1'");
    CHECK(quoted_for_shell("") == "''");
}

TEST_CASE("sweep: the full product with the last key fastest and the seeds faster") {
    const Ensemble plan = plan_sweep("bar_pulled_apart", {"mesh.size=1 mm,2 mm", "time.end=100 us",
                                                          "interface.left-right.G_c=1,2,3", "sweep.seeds=2", "seed=7"});
    REQUIRE(plan.runs.size() == 12);
    REQUIRE(plan.keys.size() == 2);
    CHECK(plan.runs[0].name == "size_1_mm_G_c_1_s7");
    CHECK(plan.runs[1].name == "size_1_mm_G_c_1_s8");
    CHECK(plan.runs[2].name == "size_1_mm_G_c_2_s7");
    CHECK(plan.runs[11].name == "size_2_mm_G_c_3_s8");
    CHECK(plan.caption(plan.runs[11]) == "size 2 mm, G_c 3, seed 8");
    const Scenario base = open_scenario("bar_pulled_apart", {"time.end=100 us"}).scenario;
    for (const EnsembleRun& run : plan.runs) {
        const ReadResult read = open_scenario("bar_pulled_apart", run.overrides);
        CHECK(read.scenario.time.end == tests::relative(100e-6, 1e-12));
        CHECK(read.scenario.mesh.size ==
              tests::relative(plan.variants[run.variant].values[0] == "1 mm" ? 1e-3 : 2e-3, 1e-12));
        CHECK(read.scenario.seed == run.seed);
        CHECK(read.scenario.figures.empty());  // the sweep draws the panels, from the last frame of each run
        CHECK(read.scenario.output.fields);
        CHECK(read.scenario.output.between_frames() > read.scenario.time.end);
        CHECK(read.scenario.output.every == base.output.every);  // of tables and trajectories
        CHECK_FALSE(read.scenario.output.report);
    }
    const Ensemble asked = plan_sweep("bar_pulled_apart", {"mesh.size=2 mm", "output.report=true", "sweep.seeds=2"});
    CHECK(open_scenario("bar_pulled_apart", asked.runs.at(0).overrides).scenario.output.report);
    // what a run would refuse is refused before any is started, and so are two runs of one name
    CHECK_THROWS_AS(plan_sweep("bar_pulled_apart", {"mesh.size=1 mm,2 Pa"}), UserError);
    CHECK_THROWS_AS(plan_sweep("bar_pulled_apart", {"mesh.size=1 mm,1 mm"}), UserError);
    std::string values = "0";  // 100^4 combinations have no room
    for (int i = 1; i < 100; ++i) values += "," + std::to_string(i);
    CHECK_THROWS_WITH_AS(plan_sweep("bar_pulled_apart",
                                    {"mesh.size=" + values, "time.end=" + values, "seed=" + values, "title=" + values}),
                         doctest::Contains("too-many-runs"), UserError);
}

TEST_CASE("sweep: the table of the scenario and --set instead of it") {
    const std::string table =
        "sweep={ set = [\"mesh.size=1 mm,2 mm\", \"time.end=100 us\"], seeds = 3, quantities = [\"dissipated\"] }";
    const Ensemble plan = plan_sweep("bar_pulled_apart", {table});
    CHECK(plan.runs.size() == 6);
    REQUIRE(plan.quantities.size() == 1);
    CHECK(plan.quantities[0].unit == "J");
    CHECK(plan_sweep("bar_pulled_apart", {table, "mesh.size=1 mm,2 mm,3 mm"}).runs.size() == 9);
    CHECK(plan_sweep("bar_pulled_apart", {table, "mesh.size=1 mm"}).runs.size() == 3);
}

TEST_CASE("sweep: every run and table is there and finished runs are kept") {
    const Folder folder("sweep");
    const fs::path sweep = folder.path / "s";
    check_whole(command("sweep " + both + "-q -j 2 -o " + folder.in_shell("s")), sweep);
    const std::vector<Texts> statistics = rows_of(sweep / "statistics.csv");
    REQUIRE(statistics.size() == 1 + 2 * 3);
    CHECK(statistics[2][2] == "dissipated");
    CHECK(statistics[2][3] == "J");
    CHECK(std::stod(statistics[2][5]) == tests::relative(6e-3, 1e-9));
    CHECK(std::stod(statistics[2][6]) < 1e-11);
    const Answer listed = command("info " + folder.in_shell("s"));
    CHECK(listed.has(text_of(sweep / "sweep.md")));
    CHECK(listed.has("s/runs/G_c_3_s2: bar_pulled_apart, done"));
    CHECK_FALSE(listed.has("dissipated  "));  // its numbers
    const std::string table = command("info --csv " + folder.in_shell("s")).text;
    CHECK(std::ranges::count(table, '\n') == 5);
    CHECK(table == command("info --csv " + folder.in_shell("s/runs")).text);
    CHECK(command("info --json " + folder.in_shell("s")).text.ends_with("]\n"));
    CHECK(command("render " + folder.in_shell("s")).has("it has 4 runs; name one, as `"));
    // one is lost: it alone is made again; more seeds are added
    const fs::path kept = sweep / "runs/G_c_3_s1/run.json";
    const auto written = fs::last_write_time(kept);
    fs::remove_all(sweep / "runs/G_c_3_s2");
    const Answer again = command("sweep " + both + "-o " + folder.in_shell("s"));
    CHECK(again.has("run 1 of 1: G_c_3_s2"));
    check_whole(again, sweep);
    CHECK(fs::last_write_time(kept) == written);
    CHECK(command("sweep " + bar + "-s 'interface.left-right.G_c=1.5,3' --seeds 1..3 -o " + folder.in_shell("s"))
              .has("run 2 of 2"));
    // the message of a refused run is in the table
    const Answer failed = command("sweep " + both + "-q -s 'time.step=0.1 us,20 us' -o " + folder.in_shell("f"));
    CHECK(failed.code == 3);
    CHECK(failed.has("G_c_3_step_20_us_s2: refused: time.step"));
    // another sweep in the same place, and a directory with other files
    CHECK(command("sweep " + both + "-s domain.thickness=2 -o " + folder.in_shell("s")).has("runs-exist"));
    fs::create_directories(folder.path / "mine");
    std::ofstream(folder.path / "mine" / "letter.txt") << "dear";
    CHECK(command("sweep " + both + "--force -o " + folder.in_shell("mine")).has("not-a-sweep"));
    CHECK(command("sweep " + bar + "--seeds 3..1 -o " + folder.in_shell("n")).has("the last one is before the first"));
    CHECK_FALSE(fs::exists(folder.path / "n"));
}

namespace {

/// knap with these words, once it has made the file.
pid_t started(const std::string& words, const fs::path& file) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", ("exec '" KNAP_PROGRAM "' " + words + " >/dev/null 2>&1").c_str(),
              static_cast<char*>(nullptr));
        _exit(127);
    }
    for (int i = 0; i < 60000 && !fs::exists(file); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return child;
}

}  // namespace

TEST_CASE("sweep: SIGTERM and SIGHUP stop the run under way and the same command goes on with it") {
    const Folder folder("sweep terminated");
    int signal = SIGTERM;
    SUBCASE("SIGTERM") {}
    SUBCASE("SIGHUP") { signal = SIGHUP; }
    const fs::path run = folder.path / "s/runs/s1";
    const std::string sweep = "sweep " + small_block("-s 'figure=[]' ").erase(small_block().find("-q "), 3) +
                              "-s 'mesh.size=1 mm' -s 'output.checkpoint_every=20 ms' --seeds 1..1 -o " +
                              folder.in_shell("s");
    const pid_t child = started(sweep, run / "checkpoint");
    for (int i = 0; i < 3; ++i) kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 130);
    const std::string report = text_of(folder.path / "s/report.html");
    CHECK(report.find("This sweep was interrupted: 0 of 1 runs are done, 0 failed, 1 to go. The same command "
                      "continues it.") != std::string::npos);
    CHECK(report.find("--seeds 1..1") != std::string::npos);
    CHECK(report.find("location.reload") == std::string::npos);
    REQUIRE(text_of(run / "run.json").find("\"status\": \"interrupted\"") != std::string::npos);
    CHECK(command(sweep).code == 0);
    CHECK(text_of(folder.path / "s/report.html").find("runs are done") == std::string::npos);
    CHECK(text_of(run / "log.txt").find("resumed: continues") != std::string::npos);
}

TEST_CASE("sweep: a table before the end has means of the runs that are done and a deviation of two or more") {
    Ensemble sweep{.kind = "sweep",
                   .keys = {"mesh.size"},
                   .variants = {{.values = {"1 mm"}}, {.values = {"2 mm"}}, {.values = {"3 mm"}}},
                   .n_seeds = 3,
                   .quantities = {{.name = "fragments", .of = "fragments"}}};
    const auto add = [&](const std::string& status, double triangles, double value) {
        const std::size_t v = sweep.runs.size() / 3;
        sweep.runs.push_back({.variant = v, .mesh_size = 1e-3 * static_cast<double>(v + 1)});
        sweep.runs.back().result = {
            .status = status, .triangles = triangles, .steps = 2 * triangles, .values = {value}};
    };
    add("done", 9000, 2), add("done", 9400, 3), add("", 0, NAN);
    add("done", 2400, 5), add("failed", 2000, NAN), add("interrupted", 1000, NAN);
    for (int i = 0; i < 3; ++i) add("", 0, NAN);
    std::istringstream lines(overview(sweep));
    std::vector<Texts> rows;
    for (std::string line; std::getline(lines, line) && line.starts_with('|');) {
        std::istringstream cells(line.substr(1));
        rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, '|');) rows.back().emplace_back(trimmed(cell));
    }
    REQUIRE(rows.size() == 5);
    CHECK(rows[0] == Texts{"mesh.size", "done", "size", "triangles", "steps", "fragments", "smallest", "largest"});
    CHECK(rows[2] == Texts{"1 mm", "2 of 3", "1 mm", "9200", "1.84e+04", "2.5 ± 0.71 (2)", "2", "3"});
    CHECK(rows[3] == Texts{"2 mm", "1 of 3", "2 mm", "2400", "4800", "5 (1)", "5", "5"});
    CHECK(rows[4] == Texts{"3 mm", "0 of 3", "3 mm", "-", "-", "-", "-", "-"});
}

TEST_CASE("sweep: no run outlives a sweep that is killed") {
    const Folder folder("sweep killed");
    const fs::path run = folder.path / "s/runs/s1";
    const std::string sweep = "sweep " + small_block() +
                              "-s 'mesh.size=1 mm' -s 'output.checkpoint_every=20 ms' --seeds 1..1 -o " +
                              folder.in_shell("s");
    const pid_t child = started(sweep, run / "checkpoint");
    const int log = open((run / "log.txt").c_str(), O_RDONLY | O_CLOEXEC);
    REQUIRE(flock(log, LOCK_EX | LOCK_NB) != 0);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    REQUIRE(flock(log, LOCK_EX) == 0);  // when the run is gone
    close(log);
    CHECK(text_of(run / "run.json").find("\"status\": \"interrupted\"") != std::string::npos);
    CHECK(command(sweep).code == 0);
    CHECK(text_of(run / "log.txt").find("resumed: continues") != std::string::npos);
}

TEST_CASE("sweep: a run whose record is lost is done again and a directory without a run is not touched") {
    const Folder folder("sweep lost record");
    const std::string sweep = "sweep " + bar + "-q --seeds 1..2 -o " + folder.in_shell("s");
    const fs::path runs = folder.path / "s/runs";
    REQUIRE(command(sweep).code == 0);
    fs::remove(runs / "s1/run.json");
    CHECK(command(sweep).code == 0);
    CHECK(fs::exists(runs / "s1/run.json"));
    fs::remove(runs / "s1/run.json");
    std::ofstream(runs / "s1/resolved.toml") << "# mine";
    for (const char* force : {"", " --force"}) {
        const Answer answer = command(sweep + force);
        CAPTURE(answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has("delete this one by hand"));
        CHECK_FALSE(answer.has("replace"));
    }
    fs::remove_all(runs / "s1");  // as the message says
    CHECK(command(sweep).code == 0);
}

TEST_CASE("sweep and study: one process at a time in a directory") {
    const Folder folder("batch busy");
    for (const std::string& what : {"sweep " + bar + "--seeds 1..2 ", "study " + bar + "--levels 1 "}) {
        const fs::path directory = folder.path / what.substr(0, 5);
        const std::string line = what + "-q -o '" + directory.string() + "'";
        fs::create_directory(directory);
        const int lock = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);  // as another process does
        REQUIRE(flock(lock, LOCK_EX | LOCK_NB) == 0);
        for (const char* force : {"", " --force"}) {
            const Answer other = command(line + force);
            CHECK(other.code == 2);
            CHECK(other.has("run-busy"));
        }
        CHECK(fs::is_empty(directory));
        close(lock);
        CHECK(command(line).code == 0);
    }
}

TEST_CASE("sweep: the message of a run is shown where its results cannot be written") {
    const Folder folder("sweep no room");
    const std::string line = "sweep " + bar + "--seeds 1..1 -o " + folder.in_shell("s");
    const Answer full = command("--version >/dev/null; ulimit -f 8; '" KNAP_PROGRAM "' " + line);
    CAPTURE(full.text);
    CHECK(full.has("run 1 of 1: s1: failed: cannot write"));
    CHECK(command(line).code == 0);
}

TEST_CASE("sweep: the message of a run is shown where even its record cannot be written") {
    const Folder folder("sweep no record");
    const fs::path run = folder.path / "s/runs/s1";
    std::thread vandal([&] {  // takes the names that whole files are written under
        for (int i = 0; i < 60000 && !fs::exists(run / "checkpoint"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        for (const char* name : {"run.json.part", "checkpoint.part"})
            for (std::error_code error; fs::exists(run) && !fs::create_directory(run / name, error);)
                std::this_thread::yield();
    });
    const std::string block = small_block().erase(small_block().find("-q "), 3);
    const Answer full =
        command("sweep " + block + "-s 'mesh.size=1 mm' -s 'output.checkpoint_every=20 ms' --seeds 1..1 -o " +
                folder.in_shell("s"));
    vandal.join();
    CAPTURE(full.text);
    CHECK(text_of(run / "run.json").find("\"status\": \"running\"") != std::string::npos);
    CHECK(full.code == 3);
    CHECK(full.has("run 1 of 1: s1: failed: cannot write"));
    CHECK(full.has("s1: running: cannot write"));
}

TEST_CASE("sweep and study: a disk that was full at the start is no obstacle later") {
    const Folder folder("batch full disk");
    for (const std::string& what : {"sweep " + bar + "--seeds 1..1 ", "study " + bar + "--levels 1 "}) {
        for (const char* blocks :
             {"0", "1", "2", "4", "8"}) {  // the table of runs, or the first files of the first run, have no room
            const std::string line = what + "-q -o " + folder.in_shell(what.substr(0, 5) + blocks);
            CHECK(WEXITSTATUS(std::system(
                      (std::string("ulimit -f ") + blocks + "; '" KNAP_PROGRAM "' " + line + " 2>/dev/null >&2")
                          .c_str())) == 3);
            CHECK(command(line).code == 0);
        }
    }
}

TEST_CASE("sweep: printed command lines are done by a Slurm array and by GNU parallel and by Snakemake") {
    const Folder folder("sweep commands");
    const fs::path sweep = folder.path / "s";
    const std::string line = "'" KNAP_PROGRAM "' sweep " + both + "-q -o s";
    REQUIRE(shell_in(folder.path, line + " --print-commands | tee jobs.txt") == 0);
    // as in scenarios/README.md
    SUBCASE("Slurm") {  // played by a loop
        CHECK(shell_in(folder.path,
                       "for i in 1 2 3 4; do SLURM_ARRAY_TASK_ID=$i bash -c 'eval \"$(sed -n "
                       "\"${SLURM_ARRAY_TASK_ID}p\" jobs.txt)\"' || exit 1; done") == 0);
    }
    SUBCASE("parallel") {
        if (!has_program("parallel")) return;
        CHECK(shell_in(folder.path, "parallel -j 2 --joblog jobs.log < jobs.txt") == 0);
    }
    SUBCASE("Snakemake") {
        if (!has_program("snakemake")) return;
        std::ofstream(folder.path / "Snakefile") << "JOBS = open(\"jobs.txt\").read().splitlines()\n"
                                                    "rule all:\n"
                                                    "    input: expand(\"done/{job}\", job=range(len(JOBS)))\n"
                                                    "rule run:\n"
                                                    "    output: touch(\"done/{job}\")\n"
                                                    "    params: command=lambda wildcards: JOBS[int(wildcards.job)]\n"
                                                    "    shell: \"{params.command} || test $? -eq 3\"\n";
        CHECK_MESSAGE(shell_in(folder.path, "snakemake --cores 2") == 0, text_of(folder.path / "shell.txt"));
    }
    const Answer collected = command("sweep " + both + "-o " + folder.in_shell("s"));
    CHECK_FALSE(collected.has("run 1 of"));
    check_whole(collected, sweep);
    // nothing is left for a second list
    const std::string out = "sweep " + both + "-q -o " + folder.in_shell("s") + " --print-commands";
    const Answer nothing = command(out);
    CHECK(nothing.text.starts_with("0 of 4 runs are to be done"));
    // existing runs are replaced by --force only
    const Answer all = command(out + " --force");
    CHECK(all.has("4 of 4 runs are to be done"));
    CHECK(all.has(" --force -s "));
}

}  // namespace sweep_test
