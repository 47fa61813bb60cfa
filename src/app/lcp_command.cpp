// knap lcp: solves stored complementarity problems and measures every answer independently of its solver.
#include "app/commands.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "lcp/infeasibility.hpp"
#include "lcp/matrix_market.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"
#include "lcp/spurious_breaking.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <optional>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;

struct Verdict {
    const LcpSolver* solver;
    std::string name = std::string(solver->name), status = {};
    double scaled_residual = 0, natural_residual = 0;
    int iterations = 0;
    Eigen::VectorXd ray = {};                     // proves that there is no solution
    double seconds = 0;                           // of processor time
    std::optional<int> n_spuriously_broken = {};  // of a cohesive problem

    bool is_solved() const { return status == knap::name(LcpStatus::solved); }
};

Verdict judged(const LcpProblem& problem, const LcpSolver& solver, const std::optional<CohesiveLayout>& layout) {
    const Stopwatch watch;
    const LcpSolution solution = solver.solve(problem, {});
    Verdict verdict{.solver = &solver, .status = std::string(name(solution.status)), .seconds = watch.cpu()};
    verdict.scaled_residual = scaled_residual(problem, solution.z);
    verdict.natural_residual = natural_residual(problem, solution.z);
    verdict.iterations = solution.iterations;
    if (proves_infeasibility(problem, solution.ray)) verdict.ray = solution.ray;
    if (layout && solution.z.allFinite())
        verdict.n_spuriously_broken = spurious_breaking(problem, solution.z, *layout).n_spurious;
    if (verdict.is_solved() && verdict.scaled_residual > max_residual) verdict.status = "inaccurate";
    if (verdict.is_solved() && verdict.n_spuriously_broken.value_or(0) > 0) verdict.status = "breaks_spuriously";
    return verdict;
}

void print_head(const std::string& file, const LcpProblem& problem) {
    std::printf("%s: %d unknowns, %d entries\n", file.c_str(), problem.size(), static_cast<int>(problem.M.nonZeros()));
    std::printf("%-16s %-17s %15s %16s %10s %12s %18s\n", "solver", "status", "scaled residual", "natural residual",
                "iterations", "CPU time [s]", "spuriously broken");
    std::fflush(stdout);
}

/// At once: the next solver may take minutes.
void print_line(const Verdict& v) {
    const std::string broken = v.n_spuriously_broken ? std::to_string(*v.n_spuriously_broken) : "-";
    std::printf("%-16s %-17s %15.2e %16.2e %10d %12.3g %18s\n", v.name.c_str(), v.status.c_str(), v.scaled_residual,
                v.natural_residual, v.iterations, v.seconds, broken.c_str());
    std::fflush(stdout);
}

Json as_json(const std::string& file, const LcpProblem& problem, const std::vector<Verdict>& verdicts) {
    Json all = Json::array();
    for (const Verdict& v : verdicts) {
        all.push_back({{"solver", v.name},
                       {"status", v.status},
                       {"scaled_residual", v.scaled_residual},  // null where it is not finite
                       {"natural_residual", v.natural_residual},
                       {"iterations", v.iterations},
                       {"cpu_s", v.seconds}});
        if (v.ray.size() > 0) all.back()["ray"] = std::vector<double>(v.ray.begin(), v.ray.end());
        if (v.n_spuriously_broken) all.back()["bonds_spuriously_broken"] = *v.n_spuriously_broken;
    }
    return {{"problem", file}, {"unknowns", problem.size()}, {"entries", problem.M.nonZeros()}, {"solvers", all}};
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
        std::vector<std::string> left_out;
        int max_unknowns = 0;
        for (const LcpSolver& candidate : lcp_solvers()) {
            if (solver != "all" && solver != candidate.name) continue;
            if (solver == "all" && problem.size() > candidate.max_unknowns) {
                if (left_out.empty()) max_unknowns = candidate.max_unknowns;
                left_out.emplace_back(candidate.name);
                continue;
            }
            verdicts.push_back(judged(problem, candidate, layout));
            if (!json) print_line(verdicts.back());
        }
        if (!left_out.empty())
            std::fprintf(
                stderr,
                "left out: %s, since each may take hours beyond %d unknowns (this problem has %d); --solver %s "
                "runs it all the same\n",
                joined(left_out).c_str(), max_unknowns, problem.size(), left_out.front().c_str());
        if (std::ranges::any_of(verdicts, [](const Verdict& v) { return v.ray.size() > 0; }))
            std::fprintf(stderr,
                         "no solution: a ray y >= 0 with M'y <= 0 and q'y < 0 was found and checked (--json)\n");
        all_solved = all_solved && std::ranges::any_of(verdicts, &Verdict::is_solved);
        if (json) documents.push_back(as_json(file.string(), problem, verdicts));
    }
    if (json) std::printf("%s\n", (documents.size() == 1 ? documents[0] : documents).dump(2).c_str());
    return all_solved ? exit_done : exit_failed;
}

}  // namespace knap
