// What comes with the package: completion of the command line in bash, and the manual page.
#include "app/program.hpp"

#include <regex>
#include <sstream>

namespace completion_test {

using namespace program;

namespace {

/// What bash offers for the last of these words.
std::string offered(const std::string& words) {
    const std::string script =
        ". '" KNAP_SOURCE_DIR "/tools/package/knap.bash'; compopt() { :; }; COMP_WORDS=(\"$0\" " + words +
        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _knap; printf \"%s|\" \"${COMPREPLY[@]}\"";
    std::string quoted;
    for (const char c : script) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return command("--version >/dev/null; cd /; bash -c '" + quoted + "' '" KNAP_PROGRAM "'").text;
}

}  // namespace

TEST_CASE("completion offers what fits the place") {
    CHECK(offered("sw") == "sweep|");
    CHECK(offered("run edge_cracked_block_f") == "edge_cracked_block_fine|");
    CHECK(offered("run -q edge_cracked_block_f") == "edge_cracked_block_fine|");
    CHECK(offered("run --unt") == "--until|");
    CHECK(offered("render --show stress_y") == "stress_yy|");
    CHECK(offered("render --colour ''") == "opening|slip|beta|mode|break_time|");
    CHECK(offered("sweep bar_ramp_wave --pr") == "--print-commands|");
    CHECK(offered("lcp x --solver lem") == "lemke|");
    CHECK(offered("study x --refine m") == "mesh|");
    CHECK(offered("study x --reference ''") == "auto|finest|");
    CHECK(offered("study x --schemes implicit/") == "implicit/explicit|implicit/implicit|");
    CHECK(offered("study x --schemes all,explicit/i") == "all,explicit/implicit|");
    CHECK(offered("run --until edge") == "|");
    CHECK(offered("run --until bi") == "|");  // where the script stands are files whose names begin so
    CHECK(offered("study -q x --levels bi") == "|");
    CHECK(offered("run -o bi") == "bin|");
    CHECK(offered("run -s mesh.siz") == "mesh.size=|");
    CHECK(offered("run --set 'load[0].ram'") == "load[0].ramp=|");
    CHECK(offered("run -s interface.default.G_c") == "interface.default.G_c=|");
}

TEST_CASE("help and manual name every command and what the exit codes mean") {
    const std::string page = text_of(KNAP_SOURCE_DIR "/tools/package/knap.1"),
                      readme = std::regex_replace(text_of(KNAP_SOURCE_DIR "/README.md"), std::regex("\\s+"), " ");
    std::istringstream help(command("--help").text);
    int n_commands = 0;
    bool listed = false;
    for (std::string line; std::getline(help, line);) {
        listed = listed || line.starts_with("Subcommands:");
        if (!listed || !line.starts_with("  ") || line[2] == ' ') continue;
        ++n_commands;
        const std::string name = line.substr(2, line.find(' ', 2) - 2);
        CHECK_MESSAGE((page.find("\n.BI " + name + " ") != std::string::npos ||
                       page.find("\n.B " + name + "\n") != std::string::npos),
                      name);
    }
    CHECK(n_commands == 13);
    for (const char* code :
         {"0 success", "1 internal error", "2 bad scenario or option",
          "3 the simulation failed, ran out of memory or violated a gate, or no solver solved the problem",
          "130 interrupted"}) {
        CHECK_MESSAGE(help.str().find(code) != std::string::npos, code);
        CHECK_MESSAGE(page.find(code) != std::string::npos, code);
        CHECK_MESSAGE(readme.find(code) != std::string::npos, code);
    }
    for (const char* file : {"breaks.csv", "stress_strain.csv", "mesh.msh"})
        CHECK_MESSAGE(page.find(file) != std::string::npos, file);
}

TEST_CASE("the compressed manual is that page and holds no time") {
    const std::string packed = text_of(KNAP_BINARY_DIR "/knap.1.gz");
    REQUIRE(packed.size() > 10);
    CHECK(packed.substr(0, 2) == "\x1f\x8b");
    CHECK(packed.substr(3, 5) ==
          std::string(
              5, '\0'));  // no name, and the second in which it was packed: 0, so that the package is the same tomorrow
    CHECK(command("--version >/dev/null; zcat '" KNAP_BINARY_DIR "/knap.1.gz'").text ==
          text_of(KNAP_SOURCE_DIR "/tools/package/knap.1"));
}

}  // namespace completion_test
