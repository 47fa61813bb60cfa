// Scenarios are documents and tests at once.
#include "source_tree.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <memory>

namespace scenarios_test {

using source_tree::File;

namespace {

const std::string program = KNAP_PROGRAM;  // empty as long as there is none

std::string output_of(const std::string& command) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    REQUIRE(pipe);
    std::string text;
    char buffer[4096];
    for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe.get())) > 0;) text.append(buffer, n);
    return text;
}

std::string text_of(const File& file) {
    std::string text;
    for (const std::string& line : file.lines) text += line + "\n";
    return text;
}

std::vector<File> scenarios() {
    std::vector<File> found;
    for (const File& file : source_tree::files_below("scenarios")) {
        if (file.has_extension(".toml")) found.push_back(file);
    }
    return found;
}

}  // namespace

TEST_CASE("every scenario opens with its question and its source and says what it expects") {
    for (const File& scenario : scenarios()) {
        CAPTURE(scenario.path);
        const auto has = [&](const std::string& start) {
            return std::any_of(scenario.lines.begin(), scenario.lines.end(),
                               [&](const std::string& l) { return l.starts_with(start); });
        };
        REQUIRE(!scenario.lines.empty());
        CHECK(scenario.lines.front().starts_with("# "));
        CHECK(scenario.lines.front().ends_with("?"));
        CHECK((has("# Source:") || has("# Set-up:")));
        CHECK(has("# Expected:"));
        CHECK((has("[expect") || has("expect = ")));  // of a run, of a parameter of a fit
    }
}

TEST_CASE("every scenario is listed in the gallery") {
    if (scenarios().empty()) return;
    const std::string gallery = text_of(source_tree::read(source_tree::root() / "scenarios" / "README.md"));
    for (const File& scenario : scenarios()) {
        CHECK_MESSAGE(gallery.find(std::filesystem::path(scenario.path).filename().string()) != std::string::npos,
                      scenario.path);
    }
}

// scenarios/KEYS.md is `knap schema --markdown`.
TEST_CASE("the list of scenario keys is up to date") {
    if (program.empty()) return;
    const std::string schema = output_of("'" + program + "' schema --markdown");
    REQUIRE(schema.size() > 1000);
    const bool same = text_of(source_tree::read(source_tree::root() / "scenarios" / "KEYS.md")) == schema;
    CHECK_MESSAGE(same, "write it anew: knap schema --markdown > scenarios/KEYS.md");
}

// scenarios/OUTPUTS.md is `knap schema --outputs`.
TEST_CASE("the list of outputs is up to date") {
    if (program.empty()) return;
    const std::string outputs = output_of("'" + program + "' schema --outputs");
    REQUIRE(outputs.size() > 1000);
    const bool same = text_of(source_tree::read(source_tree::root() / "scenarios" / "OUTPUTS.md")) == outputs;
    CHECK_MESSAGE(same, "write it anew: knap schema --outputs > scenarios/OUTPUTS.md");
}

}  // namespace scenarios_test
