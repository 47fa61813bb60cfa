// Our solvers and those of Siconos on the same problems in the same run, in processor time of one core. Every answer is
// judged by our scaled residual and by the check against spurious bond breaking. Arguments: stems of stored problems;
// without any, generated ones.
#include "peer.hpp"

#include "base/stopwatch.hpp"
#include "lcp/matrix_market.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"
#include "lcp/spurious_breaking.hpp"
#include "support/cohesive_lcp.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

using namespace knap;

namespace {

constexpr double nearly = 1e-8;     // residual that counts as solved: their tolerance is in the units of the problem
constexpr double min_time = 0.02;   // [s] of the repetitions of one measurement; the shortest repetition counts
constexpr int min_repetitions = 3;  // of long ones too: both programs get the best of several
constexpr int largest_for_lemke = 3500;

using Solve = std::function<peer::Outcome()>;

peer::Outcome ours(std::string_view name, const LcpProblem& problem, const Eigen::VectorXd& start = {}) {
    const Stopwatch watch;
    const LcpSolution solution = find_lcp_solver(name)->solve(problem, {.start = start});
    return {solution.z, watch.cpu(), solution.status == LcpStatus::solved};
}

struct Measured {
    double seconds = 0;
    char verdict = ' ';  // ' ' solved, '~' nearly, 'x' not, 'f' bonds break spuriously, '-' not tried
    bool counts() const { return verdict == ' ' || verdict == '~'; }
};

Measured measured(const LcpProblem& problem, const std::optional<CohesiveLayout>& layout, const Solve& solve) {
    peer::Outcome outcome = solve();
    Measured result{.seconds = outcome.seconds};
    const double residual = scaled_residual(problem, outcome.z);
    if (!(residual <= max_residual)) result.verdict = residual <= nearly ? '~' : 'x';
    if (result.counts() && layout && spurious_breaking(problem, outcome.z, *layout).n_spurious > 0)
        result.verdict = 'f';
    double total = outcome.seconds;
    for (int count = 1; total < min_time || count < min_repetitions; ++count, total += outcome.seconds) {
        outcome = solve();
        result.seconds = std::min(result.seconds, outcome.seconds);
    }
    return result;
}

std::string text(const Measured& m) {
    if (m.verdict == '-') return "-";
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.3f%c", 1e3 * m.seconds, m.verdict);
    return buffer;
}

std::string ratio(const Measured& theirs, const Measured& mine) {
    if (!theirs.counts() || !mine.counts()) return "-";
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.1f", theirs.seconds / mine.seconds);
    return buffer;
}

void print_head() {
    std::printf("processor time [ms]; ~ solved to 1e-8, x not, f bonds break spuriously, - not tried\n");
    std::printf("%-22s %6s | %11s %11s %11s | %11s %11s | %8s %8s\n", "problem", "n", "S. Lemke", "S. Newton",
                "S. block GS", "Lemke", "default", "Lemke x", "GS x");
}

void compare(const std::string& name, const LcpProblem& problem) {
    const auto layout = cohesive_layout(problem);
    const auto measure = [&](const Solve& solve) { return measured(problem, layout, solve); };
    const bool dense = problem.size() <= largest_for_lemke;
    const Measured skipped{.verdict = '-'};
    const Measured their_lemke =
        dense && problem.size() < 1000 ? measure([&] { return peer::lemke(problem); }) : skipped;
    const Measured their_newton = problem.size() < 1000 ? measure([&] { return peer::newton_min(problem); }) : skipped;
    const Measured their_sweeps = measure([&] { return peer::block_gauss_seidel(problem, {}); });
    const Measured our_lemke = dense ? measure([&] { return ours("lemke", problem); }) : skipped;
    const Measured our_default = measure([&] { return ours("default", problem); });
    std::printf("%-22s %6d | %11s %11s %11s | %11s %11s | %8s %8s\n", name.c_str(), problem.size(),
                text(their_lemke).c_str(), text(their_newton).c_str(), text(their_sweeps).c_str(),
                text(our_lemke).c_str(), text(our_default).c_str(), ratio(their_lemke, our_lemke).c_str(),
                ratio(their_sweeps, our_default).c_str());
    std::fflush(stdout);
}

/// Consecutive steps: the time of each solver from the solution of the previous step.
void compare_along(const std::string& name, const tests::CohesiveScene& scene, int n_steps) {
    tests::CohesiveBody body(scene);
    Measured cold_theirs, warm_theirs, cold_ours, warm_ours;
    const auto add = [](Measured& sum, const Measured& one) {
        sum.seconds += one.seconds;
        if (!one.counts() || sum.verdict == ' ') sum.verdict = one.verdict;
    };
    int n = 0;
    for (int step = 0; step < n_steps; ++step) {
        const LcpProblem problem = body.problem();
        const auto layout = cohesive_layout(problem);
        const Eigen::VectorXd start = body.start();
        n = std::max(n, problem.size());
        if (step > 0) {
            add(cold_theirs, measured(problem, layout, [&] { return peer::block_gauss_seidel(problem, {}); }));
            add(warm_theirs, measured(problem, layout, [&] { return peer::block_gauss_seidel(problem, start); }));
            add(cold_ours, measured(problem, layout, [&] { return ours("default", problem); }));
            add(warm_ours, measured(problem, layout, [&] { return ours("default", problem, start); }));
        }
        body.advance(find_lcp_solver("default")->solve(problem, {.start = start}).z);
    }
    std::printf("%-22s %6d | %11s %11s | %11s %11s | %8s %8s\n", name.c_str(), n, text(cold_theirs).c_str(),
                text(warm_theirs).c_str(), text(cold_ours).c_str(), text(warm_ours).c_str(),
                ratio(cold_theirs, warm_ours).c_str(), ratio(warm_theirs, warm_ours).c_str());
    std::fflush(stdout);
}

tests::CohesiveScene redundant(int n_x, int n_y) { return {.n_x = n_x, .n_y = n_y, .notch = 0}; }
tests::CohesiveScene line(int n_x) { return {.n_x = n_x, .n_y = 4, .every_edge = false, .notch = 0}; }

/// The problem of the third step: waves have come in, bonds are breaking.
LcpProblem third_step(const tests::CohesiveScene& scene) {
    tests::CohesiveBody body(scene);
    for (int step = 0; step < 2; ++step)
        body.advance(find_lcp_solver("default")->solve(body.problem(), {.start = body.start()}).z);
    return body.problem();
}

struct Size {
    const char* name;
    tests::CohesiveScene scene;
};

}  // namespace

int main(int argc, char** argv) {
    if (!std::getenv("OPENBLAS_NUM_THREADS")) {  // read at load time; threads that spin would add processor time
        setenv("OPENBLAS_NUM_THREADS", "1", 1);
        execv("/proc/self/exe", argv);
    }
    if (!std::freopen("/dev/null", "w", stderr)) return 1;  // Siconos reports every singular matrix there
    print_head();
    for (int i = 1; i < argc; ++i) compare(std::filesystem::path(argv[i]).stem().stem().string(), read_lcp(argv[i]));
    if (argc > 1) return 0;
    const std::vector<Size> sizes{{"line 270", line(29)},
                                  {"line 1400", line(155)},
                                  {"line 2400", line(266)},
                                  {"redundant 270", redundant(2, 4)},
                                  {"redundant 1400", redundant(5, 6)},
                                  {"redundant 2400", redundant(7, 7)},
                                  {"redundant 3000", redundant(8, 8)},
                                  {"redundant 10000", redundant(14, 14)}};
    for (const Size& size : sizes) compare(size.name, third_step(size.scene));
    std::printf("\nten consecutive steps, sums over the last nine\n%-22s %6s | %11s %11s | %11s %11s | %8s %8s\n", "",
                "n", "S. GS cold", "S. GS warm", "ours cold", "ours warm", "cold x", "warm x");
    for (const Size& size : sizes) compare_along(size.name, size.scene, 10);
}
