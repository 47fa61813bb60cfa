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

void print_table(const LcpProblem& problem, const std::vector<Verdict>& verdicts) {
    std::printf("%d unknowns, %d entries\n", problem.size(), static_cast<int>(problem.M.nonZeros()));
    std::printf("%-16s %-16s %15s %16s %10s %12s %12s\n", "solver", "status", "scaled residual", "natural residual", "iterations",
                "CPU time [s]", "freely broken");
    for (const Verdict& v : verdicts) {
        const std::string broken = v.bonds_freely_broken ? std::to_string(*v.bonds_freely_broken) : "-";
        std::printf("%-16s %-16s %15.2e %16.2e %10d %12.3g %12s\n", v.solver.c_str(), v.status.c_str(), v.scaled_residual,
                    v.natural_residual, v.iterations, v.seconds, broken.c_str());
    }
}

void print_json(const std::string& file, const LcpProblem& problem, const std::vector<Verdict>& verdicts) {
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
    const Json whole{{"problem", file}, {"unknowns", problem.size()}, {"entries", problem.M.nonZeros()}, {"solvers", std::move(all)}};
    std::printf("%s\n", whole.dump(2).c_str());
}

}  // namespace

ExitCode solve_stored_lcp(const std::filesystem::path& file, const std::string& solver, bool json) {
    const LcpProblem problem = read_lcp(file);
    const std::optional<CohesiveLayout> layout = cohesive_layout(problem);
    std::vector<Verdict> verdicts;
    for (const LcpSolver& candidate : lcp_solvers()) {
        if (solver == "all" && problem.size() > candidate.most_unknowns)
            std::fprintf(stderr, "%s is not tried: it may take very long beyond %d unknowns (--solver %s runs it)\n",
                         std::string(candidate.name).c_str(), candidate.most_unknowns, std::string(candidate.name).c_str());
        else if (solver == "all" || solver == candidate.name) verdicts.push_back(judged(problem, candidate, layout));
    }
    if (json) print_json(file.string(), problem, verdicts);
    else print_table(problem, verdicts);
    const bool solved = std::any_of(verdicts.begin(), verdicts.end(), [](const Verdict& v) { return v.solved; });
    return solved ? exit_done : exit_failed;
}

}  // namespace knap
