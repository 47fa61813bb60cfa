// Test cases that ctest would lose.
#include "source_tree.hpp"

#include <doctest/doctest.h>

#include <map>
#include <regex>

namespace names_test {

using source_tree::File;

namespace {

/// Names of the test cases in a file.
std::vector<std::string> case_names(const File& file) {
    static const std::regex pattern(R"(\bTEST_CASE(_TEMPLATE|_FIXTURE)?\([^"]*"((\\.|[^"\\])*)\")");
    std::vector<std::string> names;
    std::smatch match;
    for (const std::string& line : file.lines) {
        if (std::regex_search(line, match, pattern)) names.push_back(match[2]);
    }
    return names;
}

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace

TEST_CASE("test names survive the way through ctest") {
    // ; separates a CMake list, brackets glue one, a comma separates doctest filters, a backslash and a quote are escapes
    const std::string forbidden = ";,[]\\\"$";
    for (const File& file : source_tree::files_below("tests")) {
        for (const std::string& name : case_names(file)) {
            CHECK_MESSAGE(name.find_first_of(forbidden) == std::string::npos, file.path, ": ", name);
            CHECK_MESSAGE((!name.empty() && name.front() != ' ' && name.back() != ' '), file.path, ": ", name);
        }
    }
}

TEST_CASE("no two test cases of a program have the same name") {
    std::map<std::string, std::string> seen;  // folder and name -> file; the filter does not tell capitals apart
    for (const File& file : source_tree::files_below("tests")) {
        for (const std::string& name : case_names(file)) {
            const std::string key = lower(file.path.substr(0, file.path.rfind('/')) + "/" + name);
            CHECK_MESSAGE(!seen.contains(key), file.path, " repeats a name of ", seen[key], ": ", name);
            seen[key] = file.path;
        }
    }
    CHECK(seen.size() > 20);
}

TEST_CASE("every folder of tests is registered") {
    const File cmake = source_tree::read(source_tree::root() / "tests" / "CMakeLists.txt");
    for (const File& file : source_tree::files_below("tests")) {
        const std::string below = file.path.substr(std::string("tests/").size());
        if (!file.has_extension(".cpp") || below == "main.cpp" || below.starts_with("fuzz/")) continue;
        const bool is_program = std::any_of(cmake.lines.begin(), cmake.lines.end(), [&](const std::string& l) {
            return l.starts_with("add_executable(") && l.find(" " + below) != std::string::npos;
        });
        if (is_program) continue;
        const std::string call = "knap_tests(" + below.substr(0, below.find('/')) + " ";
        CHECK_MESSAGE(std::any_of(cmake.lines.begin(), cmake.lines.end(),
                                  [&](const std::string& l) { return l.starts_with(call); }),
                      file.path);
        CHECK_MESSAGE(!case_names(file).empty(), "no test case in ", file.path);
    }
}

}  // namespace names_test
