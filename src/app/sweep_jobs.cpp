// Job lists of a sweep for who has a scheduler: GNU parallel, Slurm, Snakemake. All read jobs.txt, a command a line, in the directory of the sweep.
#include "app/sweep.hpp"
#include "base/whole_file.hpp"

#include <algorithm>

namespace knap {
namespace {

std::string line_of(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + quoted_for_shell(word);
    return line;
}

std::string slurm_script(const std::string& name, std::size_t n_jobs) {
    return "#!/bin/bash\n"
           "#SBATCH --job-name=" + name + "\n"
           "#SBATCH --array=1-" + std::to_string(n_jobs) + "\n"
           "#SBATCH --cpus-per-task=1\n"
           "#SBATCH --output=runs/slurm_%a.log\n"
           "# submit in this directory: sbatch sweep.slurm\n"
           "cd \"${SLURM_SUBMIT_DIR:-.}\" || exit 1\n"
           "eval \"$(sed -n \"${SLURM_ARRAY_TASK_ID}p\" jobs.txt)\"\n";
}

/// A run whose simulation failed (exit code 3) is a result, too. What all made is collected by the sweep itself.
std::string snakefile(const std::string& collect) {
    std::string python = "'";
    for (const char c : collect) python += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    python += "'";
    return "# snakemake --cores 4\n"
           "JOBS = open(\"jobs.txt\").read().splitlines()\n"
           "COLLECT = " + python + "\n"
           "\n"
           "rule all:\n"
           "    input: expand(\"runs/job_{job}.done\", job=range(1, len(JOBS) + 1))\n"
           "    params: command=lambda wildcards: COLLECT\n"
           "    shell: \"{params.command}\"\n"
           "\n"
           "rule run:\n"
           "    output: touch(\"runs/job_{job}.done\")\n"
           "    params: command=lambda wildcards: JOBS[int(wildcards.job) - 1]\n"
           "    shell: \"{params.command} || test $? -eq 3\"\n";
}

}  // namespace

std::string quoted_for_shell(const std::string& word) {
    const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::string("_-+=.,/:%@").find(c) != std::string::npos; };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string emit_jobs(const std::string& kind, const std::vector<std::vector<std::string>>& jobs, const std::vector<std::string>& collect, const std::string& name,
                      const std::filesystem::path& directory) {
    std::string list;
    for (const auto& job : jobs) list += line_of(job) + "\n";
    write_whole_file(directory / "jobs.txt", list);
    if (kind == "parallel") return "parallel --joblog jobs.log < jobs.txt";
    if (kind == "slurm") {
        write_whole_file(directory / "sweep.slurm", slurm_script(name, jobs.size()));
        return "sbatch sweep.slurm";
    }
    write_whole_file(directory / "Snakefile", snakefile(line_of(collect)));
    return "snakemake --cores 4";
}

}  // namespace knap
