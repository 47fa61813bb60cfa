// knap study: runs, errors, orders, statistics.
#include "app/program.hpp"

#include "app/ensemble/ensemble.hpp"
#include "output/history_csv.hpp"
#include "record/outputs.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <regex>
#include <sstream>

namespace study_test {

using namespace program;
using namespace knap;

namespace {

/// A bar during the ramp of its pull, not yet broken: smooth in the step.
const std::string ringing = "bar_pulled_apart -q -s time.end=\"10 us\" -s mesh.size=\"2 mm\" -s expect= " + undrawn;

/// A column of study.csv; NaN where it is empty.
std::vector<double> column(const fs::path& study, const std::string& name) {
    std::istringstream text(text_of(study / "study.csv"));
    const auto cells = [](const std::string& line) {
        std::vector<std::string> found{""};
        for (const char c : line) c == ',' ? found.emplace_back() : found.back() += c, void();
        return found;
    };
    std::string line;
    std::getline(text, line);
    // the name of a line may hold a comma, so columns are counted from the end
    auto header = cells(line);
    for (std::string& cell : header) cell = name_in_header(cell);
    const auto from_end = header.end() - std::find(header.begin(), header.end(), name);
    REQUIRE(from_end > 0);
    std::vector<double> values;
    while (std::getline(text, line)) {
        const auto row = cells(line);
        const std::string& cell = *(row.end() - from_end);
        values.push_back(cell.empty() ? NAN : std::stod(cell));
    }
    return values;
}

}  // namespace

TEST_CASE("convergence: orders and extrapolation and spread of known numbers") {
    CHECK(observed_order(0.2, 4e-2, 0.1, 1e-2) == tests::relative(2, 1e-14));
    CHECK(std::isnan(observed_order(0.2, 4e-2, 0.1, 0)));
    CHECK(fitted_order({1, 0.5, 0.25}, {1, 0.125, 1.0 / 64}) == tests::relative(3, 1e-13));
    CHECK(fitted_order({1, 0.5, 0.25}, {1, NAN, 1.0 / 64}) == tests::relative(3, 1e-13));
    CHECK(std::isnan(fitted_order({1, 0.5}, {1, NAN})));
    const auto q = [](double h) { return 7 + 3 * std::pow(h, 1.5); };
    const auto found = extrapolate({0.4, 0.2, 0.1, 0.05}, {q(0.4), q(0.2), q(0.1), q(0.05)});
    REQUIRE(found);
    CHECK(found->order == tests::relative(1.5, 1e-10));
    CHECK(found->value == tests::relative(7, 1e-10));
    CHECK_FALSE(extrapolate({0.4, 0.2, 0.1}, {1, 2, 1.5}));  // to and fro
    CHECK_FALSE(extrapolate({0.8, 0.4, 0.2, 0.1}, {1, 1.05, 2, 1.5}));
    CHECK_FALSE(extrapolate({0.4, 0.2, 0.1}, {1, 0.2, 0.19}));  // of order 6
    CHECK(trend_of({4, 2, 1, NAN}) == Trend::falls);
    CHECK(trend_of({4, NAN, 1, 0}) == Trend::falls);
    CHECK(trend_of({4, 1, 2}) == Trend::does_not_fall);
    CHECK(trend_of({0, 1}) == Trend::does_not_fall);
    CHECK(trend_of({0, 0, NAN}) == Trend::same);
    CHECK(trend_of({4, NAN}) == Trend::unknown);
    CHECK_FALSE(extrapolate({0.4, 0.2, 0.1, 0.05}, {9, 8.9, 8.0, 7.9}));  // no clean order
    const Spread spread = spread_of({1, NAN, 3});
    CHECK(spread.n == 2);
    CHECK(spread.mean == 2);
    CHECK(spread.deviation == tests::relative(std::sqrt(2.0), 1e-15));
    CHECK(spread_of({NAN}).n == 0);
}

TEST_CASE("study: where differences do not fall no order is stated") {
    Ensemble study{.kind = "study",
                   .keys = {"line", "level"},
                   .quantities = {{.name = "broken_length", .of = "broken_length", .unit = "m"}}};
    study.study.lines = {{.name = "to and fro", .set = {}, .levels = {1, 2, 4, 8}},
                         {.name = "second order", .set = {}, .levels = {1, 2, 4, 8}}};
    for (std::size_t line = 0; line < 2; ++line)
        for (const double level : {1, 2, 4, 8}) {
            study.variants.push_back({.values = {study.study.lines[line].name, "1"}, .line = line, .level = level});
            const double value = line == 0 ? (level == 1   ? 12e-3
                                              : level == 2 ? 30e-3
                                              : level == 4 ? 13e-3
                                                           : 29e-3)
                                           : 20e-3 * (1 + 1 / (level * level));
            study.runs.push_back({.variant = study.runs.size(), .name = "r" + std::to_string(level)});
            study.runs.back().result = {.status = "done", .step = 1e-6 / level, .cpu = 1, .values = {value}};
        }
    judge_errors(study);
    const std::string text = overview(study);
    CAPTURE(text);
    CHECK(text.find("- to and fro: no convergence seen, differences of 18 mm, 17 mm, 16 mm do not fall with h\n") !=
          std::string::npos);  // to speak of
    study.runs[3].result.values[0] = 40e-3;
    judge_errors(study);
    const std::string again = overview(study);
    CAPTURE(again);
    CHECK(again.find("- to and fro: no convergence seen, differences of 18 mm, 17 mm, 27 mm do not fall with h\n") !=
          std::string::npos);
    CHECK(again.find("to and fro: order") == std::string::npos);
    CHECK(again.find("- second order: order 2.00 (fitted); extrapolated to 20 mm with order 2.00") !=
          std::string::npos);
    CHECK(again.find("nan") == std::string::npos);
    for (std::size_t i = 0; i < 4; ++i) CHECK(std::isnan(study.errors[0].order[i]));
    CHECK(study.errors[0].order[6] == tests::relative(2, 1e-9));
    CHECK_FALSE(study.errors[0].lines[0].limit);
    CHECK(runs_csv(study).find("nan") == std::string::npos);
}

TEST_CASE("study: theta 1/2 and central differences are of second order in the step and theta 1 of first") {
    const Folder folder("study orders");
    const std::string no_report = "-s output.report=false ";
    const Answer study =
        command("study " + std::string(ringing).erase(ringing.find(no_report), no_report.size()) + "-o " +
                folder.in_shell("s") +
                " -s 'probe=[{ at = [\"12 mm\", \"2 mm\"], name = \"inside\" }]'"
                " -s 'study={ levels = [2, 4, 8, 16], quantity = [{ of = \"inside_u_x\", at = \"10 us\" }], line = ["
                "{ name = \"central differences\" },"
                "{ name = \"trapezoidal rule\", set = [\"time.bulk=implicit\", \"time.step=2 CFL\"] },"
                "{ name = \"theta 1\", set = [\"time.bulk=implicit\", \"time.step=2 CFL\", \"time.theta=1\"], levels = "
                "[16, 32, 64, 128] }] }'");
    CAPTURE(study.text);
    CHECK(study.code == 0);
    const std::vector<double> order = column(folder.path / "s", "order of inside_u_x at 1e-05 s");
    REQUIRE(order.size() == 12);
    for (const std::size_t i : {2, 6}) CHECK(std::abs(order[i] - 2) <= 0.1);
    CHECK(std::abs(order[10] - 1) <= 0.1);
    // all three converge to the same value: the errors of the finest steps are a small fraction of those of the
    // coarsest
    const std::vector<double> error = column(folder.path / "s", "error of inside_u_x at 1e-05 s");
    CHECK(error[7] < 0.05 * error[4]);
    CHECK(error[11] < 0.2 * error[8]);
    CHECK(std::isnan(error[3]));  // the reference
    for (const char* words : {"central differences", "reference: ", "(fitted)", "extrapolated to"})
        CHECK_MESSAGE(study.has(words), words);
    for (const char* file : {"study.md", "study.toml", "figures/work_precision_inside_u_x_at_1e-05_s.png",
                             "figures/convergence_inside_u_x_at_1e-05_s.svg", "runs/theta_1_r128/run.json"})
        CHECK_MESSAGE(fs::exists(folder.path / "s" / file), file);
    const std::string report = text_of(folder.path / "s/report.html");
    const auto n_with = [&](const std::regex& words) {
        return std::distance(std::sregex_iterator(report.begin(), report.end(), words), {});
    };
    CHECK(n_with(std::regex("<figure>")) == 2);  // each once, not as .png and as .svg
    CHECK(n_with(std::regex("alt=\"Error over [^\"]*: inside_u_x at 1e-05 s\"")) == 2);
}

TEST_CASE("study: B7 a ramp wave opens and breaks an interface as exactly computed with order 2") {
    const Folder folder("study ramp");
    REQUIRE(command("study bar_ramp_wave -q --levels 1,2,4 -s output.fields=false " + undrawn + "-o " +
                    folder.in_shell("s"))
                .code == 0);
    for (const char* name : {"surface energy at 18.5 us", "time of 1.5 mJ"}) {
        CAPTURE(name);
        const std::vector<double> error = column(folder.path / "s", std::string("error of ") + name);
        CHECK(error[2] < 3e-4);
        CHECK(std::abs(fitted_order({1, 0.5, 0.25}, error) - 2) <= 0.1);
    }
}

TEST_CASE("study: B7 is of second order from level to level" * doctest::test_suite("slow")) {
    const Folder folder("study ramp order");
    REQUIRE(command("study bar_ramp_wave -q --levels 2,4,8 -o " + folder.in_shell("s")).code == 0);
    for (const char* name : {"surface energy at 18.5 us", "time of 1.5 mJ"})
        for (const std::size_t i : {1, 2})
            CHECK(std::abs(column(folder.path / "s", std::string("order of ") + name)[i] - 2) <= 0.1);
}

TEST_CASE("study: C1 the speed of a debonding crack is of second order" * doctest::test_suite("slow")) {
    const Folder folder("study strip order");
    REQUIRE(command("study debonding_strip -q -s study.line= --levels 0.5,1,2 -o " + folder.in_shell("s")).code == 0);
    const std::vector<double> order = column(folder.path / "s", "order of crack speed times G_c"),
                              error = column(folder.path / "s", "error of crack speed times G_c");
    for (const std::size_t i : {1, 2}) CHECK(std::abs(order[i] - 2) <= 0.1);
    CHECK(error[2] < 2e-4);
}

TEST_CASE("study: the slope of a column between two times") {
    const Folder folder("study slope");
    const auto study = [&](const std::string& times) {
        return command("study " + ringing + "-o " + folder.in_shell("s") +
                       " -s 'study={ levels = [1], quantity = [{ of = \"time\", slope = " + times + " }] }'");
    };
    REQUIRE(study("[\"2 us\", \"8 us\"]").code == 0);
    CHECK(column(folder.path / "s", "slope of time from 2e-06 s to 8e-06 s")[0] == tests::relative(1, 1e-9));
    const Answer wrong = study("[\"8 us\", \"2 us\"]");
    CHECK(wrong.code == 2);
    CHECK(wrong.has("bad-interval"));
}

TEST_CASE("study: finished runs are kept and nothing else is overwritten") {
    const Folder folder("study again");
    const std::string study = "study " + ringing + "-o " + folder.in_shell("s") + " --quantity strain_energy ";
    REQUIRE(command(study + "--levels 1,2").code == 0);
    const fs::path run = folder.path / "s" / "runs" / "explicit_explicit_r1" / "run.json";
    const auto written = fs::last_write_time(run);
    std::string loud = study;
    loud.erase(loud.find("-q "), 3);
    const Answer more = command(loud + "--levels 1,2,4");
    CHECK(more.code == 0);
    CHECK(more.has("run 1 of 1: explicit_explicit_r4"));
    CHECK(fs::last_write_time(run) == written);
    // another scenario in the same place
    const Answer other = command(study + "--levels 1,2 -s domain.thickness=\"2 m\"");
    CHECK(other.code == 2);
    CHECK(other.has("runs-exist"));
    CHECK(other.has("--force"));
    CHECK(fs::last_write_time(run) == written);
    CHECK(command(study + "--levels 1,2 -s domain.thickness=\"2 m\" --force").code == 0);
    CHECK(fs::last_write_time(run) != written);
    // a directory with other files
    fs::create_directories(folder.path / "mine");
    std::ofstream(folder.path / "mine" / "letter.txt") << "dear";
    const Answer mine = command("study " + ringing + "-o " + folder.in_shell("mine") + " --levels 1 --force");
    CHECK(mine.code == 2);
    CHECK(mine.has("not-a-study"));
    CHECK(fs::exists(folder.path / "mine" / "letter.txt"));
}

TEST_CASE("study: two at a time give the same as one after the other") {
    const Folder folder("study jobs");
    const std::string study =
        "study " + ringing + "--levels 1,2,4 --schemes explicit/explicit,explicit/implicit --quantity strain_energy ";
    REQUIRE(command(study + "-j 1 -o " + folder.in_shell("one")).code == 0);
    REQUIRE(command(study + "-j 3 -o " + folder.in_shell("three")).code == 0);
    CHECK(column(folder.path / "one", "strain_energy") == column(folder.path / "three", "strain_energy"));
}

TEST_CASE("study: statistics over seeds") {
    const Folder folder("study seeds");
    const Answer study =
        command("study " + small_block() +
                "--seeds 3 --refine mesh --levels 0.5,1 --quantity dissipated --quantity first_branch_time -o " +
                folder.in_shell("s"));
    CAPTURE(study.text);
    CHECK(study.code == 0);
    CHECK(study.has("dissipated, 3 seeds"));
    const std::vector<double> values = column(folder.path / "s", "dissipated");
    REQUIRE(values.size() == 6);
    CHECK(values[3] != values[4]);
    const std::string statistics = text_of(folder.path / "s" / "statistics.csv");
    CAPTURE(statistics);
    std::ostringstream mean;
    mean << (values[3] + values[4] + values[5]) / 3;
    CHECK(statistics.find("1,3,dissipated,J,3," + mean.str().substr(0, 5)) != std::string::npos);
    CHECK(statistics.find("first_branch_time,s,0,,,,") != std::string::npos);  // nothing branches in 40 us at 2 mm
    CHECK(fs::exists(folder.path / "s" / "figures" / "statistics_dissipated.png"));
}

TEST_CASE("study: a run that is refused is a line of the table") {
    const Folder folder("study refused");
    const Answer study =
        command("study " + ringing + "--levels 0.5,1 -s time.step=\"0.9 CFL\" --quantity strain_energy -o " +
                folder.in_shell("s"));
    CHECK(study.code == 3);
    CHECK(study.has("refused: time.step"));
    CHECK(study.has("exceeds the stable step"));
}

TEST_CASE("study: mistakes are reported before anything runs") {
    const Folder folder("study mistakes");
    const auto fails = [&](const std::string& options, const char* message) {
        const Answer answer = command("study " + ringing + options + " -o " + folder.in_shell("s"));
        INFO(options, "\n", answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has(message));
        CHECK_FALSE(fs::exists(folder.path / "s"));
    };
    fails("--quantity disipated", "did you mean `dissipated`?");
    fails("-s 'study.quantity=[{ of = \"strian\", at = \"1 us\" }]'", "did you mean `strain`?");
    fails("-s 'study.quantity=[{ of = \"strain\", at = \"1 mm\" }]'", "a time");
    fails("-s 'study.quantity=[{ of = \"strain\", at = 1e-6, largest = true }]'", "more than one of");
    fails("-s 'study.quantity=[{ of = \"strain\", reaches = \"1 J\", exact = \"1 J\" }]'", "a time");
    fails("-s 'study.quantity=[{ of = \"strain\", since = \"kinetic\" }]'", "needs reaches");
    fails("-s 'study.quantity=[{ of = \"strain\", reaches = 1, since = \"kinetik\" }]'", "did you mean `kinetic`?");
    fails("--levels 1,0", "greater than 0");
    fails("--levels 1,1", "duplicate-name");
    fails("--schemes explicit", "explicit/implicit");
    fails("--refine stepp", "did you mean `step`?");
    fails("--quantity dissipated --quantity dissipated", "two quantities would be called `dissipated`");
    fails("-s 'study.quantity=[{ of = \"time\", name = \"" + std::string(200, 'a') + "\" }]'", "at most 150");
    fails("-s 'study.set=[\"mesh.sise=1\"]'", "did you mean `size`?");
    fails("-s 'study.line=[{ set = [\"time.theta=2\"] }]'", "time.theta");
    fails("--schemes all -s 'study.line=[{ name = \"a\" }]'", "only one is allowed");
    CHECK(command("study " KNAP_SOURCE_DIR "/scenarios/hopkinson_time_piece.toml --refine mesh")
              .has("cannot be refined"));
}

}  // namespace study_test
