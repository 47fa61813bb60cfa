// tools/verify writes tests/verification/*.csv and the table of tests/VERIFICATION.md; this sees that it did, after cases came or went.
#include "source_tree.hpp"

#include <doctest/doctest.h>

#include <regex>

namespace verification_test {

using source_tree::File;

namespace {

/// What follows `before` in lines that match it: names of cases such as B3.
std::set<std::string> case_names(const std::vector<File>& files, const std::string& before) {
    const std::regex pattern(before + "([A-EH][0-9]+)[ ,]");
    std::set<std::string> names;
    std::smatch match;
    for (const File& file : files)
        for (const std::string& line : file.lines)
            if (std::regex_search(line, match, pattern)) names.insert(match[1]);
    return names;
}

}  // namespace

TEST_CASE("the verification report has the cases that the tests have") {
    std::vector<File> tests;
    for (const File& file : source_tree::files_below("tests"))
        if (file.is_cpp()) tests.push_back(file);
    const std::set<std::string> in_tests = case_names(tests, R"(^TEST_CASE\(")");
    CHECK(in_tests.size() > 30);
    const std::pair<const char*, const char*> reports[] = {{"VERIFICATION.md", R"(^\| <a id="\w+"></a>)"},
                                                           {"verification/cases.csv", "^"},
                                                           {"verification/numbers.csv", "^"}};
    for (const auto& [file, before] : reports) {
        const std::set<std::string> in_report =
            case_names({source_tree::read(source_tree::root() / "tests" / file)}, before);
        for (const std::string& name : in_tests)
            CHECK_MESSAGE(in_report.contains(name), name, " is not in ", file, ": tools/verify");
        for (const std::string& name : in_report)
            CHECK_MESSAGE(in_tests.contains(name), name, " has no test any more: tools/verify; ", file);
    }
}

}  // namespace verification_test
