// knap sweep --emit slurm, with an sbatch that runs what it is given at once.
#include "program.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace slurm_test {

using namespace program;

TEST_CASE("slurm: an emitted script packs all runs of a sweep into jobs and collects them") {
    const Folder folder("slurm");
    fs::create_directories(folder.path / "bin");
    std::ofstream(folder.path / "bin/sbatch")
        << "#!/bin/bash\n"
           "script=$(cat)\n"
           "echo \"$@\" >>\"$CALLS\"\n"
           "n=$(sed -n 's/^#SBATCH --array=1-\\([0-9]*\\).*/\\1/p' <<<\"$script\")\n"
           "for ((i = 1; i <= ${n:-1}; ++i)); do SLURM_ARRAY_TASK_ID=$i bash -c \"$script\" >&2; done\n"
           "echo '17;cluster'\n";
    fs::permissions(folder.path / "bin/sbatch", fs::perms::owner_all);
    const std::string sweep = "sweep bar_pulled_apart -s 'mesh.size=1 mm,2 mm' --seeds 1..2 -j 3 -s 'figure=[]' -o " +
                              folder.in_shell("a sweep");
    const Answer emitted = command(sweep + " --emit slurm 2>/dev/null >" + folder.in_shell("submit.sh"));
    REQUIRE(emitted.code == 0);
    const std::string script = text_of(folder.path / "submit.sh");
    CAPTURE(script);
    for (const char* part : {"/a sweep/runs/slurm_%a.log\"\n", "#SBATCH --output=\"", "#SBATCH --array=1-1%3\n",
                             "#SBATCH --cpus-per-task=1\n", "#SBATCH --time=6\n", "#SBATCH --mem="})
        CHECK_MESSAGE(script.find(part) != script.npos, part);
    CHECK_FALSE(fs::exists(folder.path / "a sweep" / "sweep.csv"));
    const Answer submitted = command("--version >/dev/null; CALLS=" + folder.in_shell("calls") +
                                     " PATH=" + folder.in_shell("bin") + ":$PATH sh " + folder.in_shell("submit.sh"));
    CAPTURE(submitted.text);
    CHECK(submitted.code == 0);
    CHECK(text_of(folder.path / "calls") == "--parsable\n--dependency=afterany:17\n");
    const std::string table = text_of(folder.path / "a sweep" / "sweep.csv");
    CHECK(std::count(table.begin(), table.end(), '\n') == 5);
    CHECK(fs::exists(folder.path / "a sweep" / "report.html"));
    CHECK(command(sweep + " --emit pbs").code == 2);
}

}  // namespace slurm_test
