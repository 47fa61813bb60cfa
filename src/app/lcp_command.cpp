// knap lcp: solve a stored complementarity problem and let the judge say how well.
#include "app/commands.hpp"
#include "base/stopwatch.hpp"
#include "lcp/free_breaking.hpp"
#include "lcp/matrix_market.hpp"
#include "lcp/residual.hpp"
#include "lcp/solvers.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <optional>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;

constexpr double largest_residual = 1e-10;  // scaled, of what counts as solved

struct Verdict {
    std::string solver, status;
    double scaled_residual, natural_residual;
    int iterations;
    double seconds;                        // of processor time
    std::optional<int> bonds_freely_broken;  // where the layout is that of a cohesive problem
    bool solved;
};

/// What the judge says, whatever the solver claims.
std::string judged_status(LcpStatus claimed, double residual, int n_free) {
    if (claimed == LcpStatus::solved && residual > largest_residual) return "inaccurate";
    if (claimed == LcpStatus::solved && n_free > 0) return "breaks_freely";
    return std::string(name(claimed));
}

Verdict judged(const LcpProblem& problem, const LcpSolver& solver, const std::optional<CohesiveLayout>& layout) {
    const Stopwatch watch;
    const LcpSolution solution = solver.solve(problem);
    Verdict verdict{.solver = std::string(solver.name), .seconds = watch.cpu()};
    verdict.iterations = solution.iterations;
    verdict.scaled_residual = scaled_residual(problem, solution.z);
    verdict.natural_residual = natural_residual(problem, solution.z);
    if (layout && solution.z.allFinite()) verdict.bonds_freely_broken = free_breaking(problem, solution.z, *layout).n_free;
    verdict.status = judged_status(solution.status, verdict.scaled_residual, verdict.bonds_freely_broken.value_or(0));
    verdict.solved = verdict.status == name(LcpStatus::solved);
    return verdict;
}

void print_head(const std::string& file, const LcpProblem& problem) {
    std::printf("%s: %d unknowns, %d entries\n", file.c_str(), problem.size(), static_cast<int>(problem.M.nonZeros()));
    std::printf("%-16s %-16s %15s %16s %10s %12s %12s\n", "solver", "status", "scaled residual", "natural residual", "iterations",
                "CPU time [s]", "freely broken");
    std::fflush(stdout);
}

/// As soon as it is there: the next solver may take minutes.
void print_line(const Verdict& v) {
    const std::string broken = v.bonds_freely_broken ? std::to_string(*v.bonds_freely_broken) : "-";
    std::printf("%-16s %-16s %15.2e %16.2e %10d %12.3g %12s\n", v.solver.c_str(), v.status.c_str(), v.scaled_residual, v.natural_residual,
                v.iterations, v.seconds, broken.c_str());
    std::fflush(stdout);
}

Json as_json(const std::string& file, const LcpProblem& problem, const std::vector<Verdict>& verdicts) {
    Json all = Json::array();
    for (const Verdict& v : verdicts) {
        Json one{{"solver", v.solver},
                 {"status", v.status},
                 {"scaled_residual", v.scaled_residual},  // null where it is not finite
                 {"natural_residual", v.natural_residual},
                 {"iterations", v.iterations},
                 {"cpu_s", v.seconds}};
        if (v.bonds_freely_broken) one["bonds_freely_broken"] = *v.bonds_freely_broken;
        all.push_back(std::move(one));
    }
    return Json{{"problem", file}, {"unknowns", problem.size()}, {"entries", problem.M.nonZeros()}, {"solvers", std::move(all)}};
}

void say_what_was_left_out(const std::vector<const LcpSolver*>& left_out, int n) {
    if (left_out.empty()) return;
    std::string names;
    for (const LcpSolver* solver : left_out) names += (names.empty() ? "" : ", ") + std::string(solver->name);
    std::fprintf(stderr, "left out: %s, since beyond %d unknowns (this problem has %d) each may take hours; --solver %s runs it all the same\n", names.c_str(),
                 left_out.front()->most_unknowns, n, std::string(left_out.front()->name).c_str());
}

void say_what_was_not_applicable(const std::vector<Verdict>& verdicts) {
    for (const Verdict& v : verdicts)
        if (v.status == name(LcpStatus::not_applicable))
            std::fprintf(stderr, "not applicable: %s, which needs %s\n", v.solver.c_str(), std::string(find_lcp_solver(v.solver)->needs).c_str());
}

}  // namespace

ExitCode solve_stored_lcp(const std::vector<std::filesystem::path>& files, const std::string& solver, bool json) {
    Json documents = Json::array();
    bool all_solved = true;
    for (const std::filesystem::path& file : files) {
        const LcpProblem problem = read_lcp(file);
        const std::optional<CohesiveLayout> layout = cohesive_layout(problem);
        if (!json) print_head(file.string(), problem);
        std::vector<Verdict> verdicts;
        std::vector<const LcpSolver*> left_out;
        for (const LcpSolver& candidate : lcp_solvers()) {
            if (solver != "all" && solver != candidate.name) continue;
            if (solver == "all" && problem.size() > candidate.most_unknowns) {
                left_out.push_back(&candidate);
                continue;
            }
            verdicts.push_back(judged(problem, candidate, layout));
            if (!json) print_line(verdicts.back());
        }
        say_what_was_left_out(left_out, problem.size());
        say_what_was_not_applicable(verdicts);
        all_solved = all_solved && std::any_of(verdicts.begin(), verdicts.end(), [](const Verdict& v) { return v.solved; });
        if (json) documents.push_back(as_json(file.string(), problem, verdicts));
    }
    if (json) std::printf("%s\n", (documents.size() == 1 ? documents[0] : documents).dump(2).c_str());
    return all_solved ? exit_done : exit_failed;
}

}  // namespace knap
