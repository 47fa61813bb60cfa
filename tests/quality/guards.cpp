// A test run that runs nothing must fail: these guards are tried here.
#include <doctest/doctest.h>

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

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
    const std::string here = quoted(KNAP_BINARY_DIR);
    CHECK(exit_code(quoted(KNAP_CTEST) + " -N --test-dir " + here + " --no-tests=error -R 'quality/guard target'") == 0);
    CHECK(exit_code(quoted(KNAP_CTEST) + " --test-dir " + here + " --no-tests=error -R 'no such test'") != 0);
}
