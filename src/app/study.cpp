#include "app/study.hpp"

#include "base/whole_file.hpp"

#include <cstdio>

namespace knap {

ExitCode study_scenario(const std::string& scenario, const std::vector<std::string>& overrides, const BatchOptions& command) {
    Study study{.plan = plan_study(scenario, overrides)};
    const std::filesystem::path directory = command.output.empty() ? std::filesystem::path("studies") / study.plan.name : command.output;
    const DirectoryLock lock = take_batch_directory(directory, "study");
    const auto to_do = runs_to_do(batch_of(study.plan.runs), directory / "runs", command.force);
    begin_batch(directory, "study", resolved_for_run(open_scenario(scenario, overrides)));
    if (!do_runs(scenario, to_do, directory / "runs", command)) return exit_interrupted;
    for (const StudyRun& run : study.plan.runs) study.results.push_back(read_result(directory / "runs" / run.name, study.plan.options.quantities));
    if (!study.is_statistics()) judge_study(study);
    const std::string text = study_text(study);
    write_whole_file(directory / "study.txt", text);
    write_whole_file(directory / "study.csv", study_csv(study));
    write_whole_file(directory / "study.md", study_markdown(study));
    if (study.is_statistics()) write_whole_file(directory / "statistics.csv", statistics_csv(study));
    std::fputs(text.c_str(), stdout);
    std::printf("\nstudy:   %s\n", directory.string().c_str());
    for (const auto& figure : draw_study(study, directory / "figures")) std::printf("figure:  %s\n", figure.string().c_str());
    return exit_code_of(study.results);
}

}  // namespace knap
