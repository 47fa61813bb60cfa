#include "app/ensemble/ensemble.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <algorithm>
#include <cstdio>

namespace knap {
namespace {

namespace fs = std::filesystem;

void print_commands(const std::string& scenario, const std::vector<const EnsembleRun*>& to_do, const Ensemble& ensemble,
                    const fs::path& directory, const BatchOptions& options) {
    for (const EnsembleRun* run : to_do) {
        std::string line;
        for (const std::string& word : command_of(options.program, scenario, *run, directory / "runs", options.force))
            line += (line.empty() ? "" : " ") + quoted_for_shell(word);
        std::printf("%s\n", line.c_str());
    }
    std::fprintf(stderr,
                 "%zu of %zu runs are to be done; afterwards the same command without --print-commands makes tables "
                 "and figures\n",
                 to_do.size(), ensemble.runs.size());
}

}  // namespace

std::string quoted_for_shell(const std::string& word) {
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || std::string("_-+=.,/:%@").find(c) != std::string::npos;
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

ExitCode run_ensemble(Ensemble ensemble, const std::string& scenario, const BatchOptions& options) {
    const std::string& kind = ensemble.kind;
    const fs::path directory =
        options.output.empty() ? fs::path(ensemble.is_study() ? "studies" : "sweeps") / ensemble.name : options.output;
    const fs::path runs = directory / "runs";
    const DirectoryLock lock = take_directory(directory, kind);
    const auto to_do = runs_to_do(ensemble.runs, runs, options.force);
    write_whole_file(directory / (kind + ".toml"),
                     ensemble.record);  // first, so that it can be told from a directory of someone else
    std::error_code error;
    if (fs::create_directories(runs, error); error)
        throw UserError("cannot-write", "cannot make `" + runs.string() + "`: " + error.message());
    if (options.print_commands) {
        print_commands(scenario, to_do, ensemble, directory, options);
        return exit_done;
    }
    if (!do_runs(scenario, to_do, runs, options)) return exit_interrupted;
    for (EnsembleRun& run : ensemble.runs) run.result = read_result(runs / run.name, ensemble.quantities);
    if (ensemble.is_study() && ensemble.n_seeds == 0) judge_errors(ensemble);
    const std::string text = overview(ensemble);
    write_whole_file(directory / (kind + ".md"), text);
    write_whole_file(directory / (kind + ".csv"), runs_csv(ensemble));
    if (ensemble.n_seeds > 0) write_whole_file(directory / "statistics.csv", statistics_csv(ensemble));
    std::printf("%s%-9s%s\n", text.c_str(), (kind + ":").c_str(), directory.string().c_str());
    for (const fs::path& figure : draw_ensemble(ensemble, directory))
        std::printf("figure:  %s\n", figure.string().c_str());
    const bool good =
        std::ranges::all_of(ensemble.runs, [](const EnsembleRun& run) { return run.result.trouble().empty(); });
    return good ? exit_done : exit_failed;
}

}  // namespace knap
