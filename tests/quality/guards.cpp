// A test run that runs nothing must fail: these guards are tried here.
#include "source_tree.hpp"

#include <doctest/doctest.h>

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace guards_test {

namespace {

std::string quoted(const std::string& path) { return "'" + path + "'"; }

/// Exit code of a shell command with its output thrown away; -1 when it did not end by itself.
int exit_code(const std::string& command) {
    const int status = std::system((command + " >/dev/null 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

const std::string this_program = quoted(std::filesystem::read_symlink("/proc/self/exe").string());

}  // namespace

TEST_CASE("guard: a test program without cases fails") {
    CHECK(exit_code(quoted(KNAP_TEST_WITHOUT_CASES)) == 1);
    CHECK(exit_code(quoted(KNAP_TEST_WITHOUT_CASES) + " --list-test-cases") == 1);  // so that it does not build
}

TEST_CASE("guard: a name that no case has fails") {
    CHECK(exit_code(this_program + " --test-case='no such case'") == 1);
    CHECK(exit_code(this_program + " --test-case='guard target'") == 0);
}

TEST_CASE("guard target") { CHECK(this_program.size() > 2); }

TEST_CASE("guard: ctest that finds no test fails") {
    namespace fs = std::filesystem;
    const fs::path empty = fs::path(KNAP_BINARY_DIR) / "no_tests_here";  // its own folder: ctest writes logs
    fs::create_directories(empty);
    std::ofstream(empty / "CTestTestfile.cmake");
    CHECK(exit_code(quoted(KNAP_CTEST) + " --test-dir " + quoted(empty.string()) + " --no-tests=error") != 0);

    const source_tree::File script = source_tree::read(source_tree::root() / "tools" / "test");
    const auto asks_for_it = [](const std::string& l) {
        return l.find("ctest ") != std::string::npos && l.find("--no-tests=error") != std::string::npos;
    };
    CHECK(std::any_of(script.lines.begin(), script.lines.end(), asks_for_it));
}

}  // namespace guards_test
