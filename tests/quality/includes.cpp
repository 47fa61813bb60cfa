// Includes point down, and third-party headers stay behind their walls.
#include "source_tree.hpp"

#include <doctest/doctest.h>

#include <map>
#include <regex>

namespace includes_test {

using source_tree::File;

namespace {

const std::map<std::string, int> layer_of{{"base", 0},
                                          {"mesh", 1},
                                          {"material", 1},
                                          {"lcp", 1},
                                          {"microstructure", 2},
                                          {"element", 2},
                                          {"law", 2},
                                          {"nonsmooth", 3},
                                          {"model", 3},
                                          {"heat", 4},
                                          {"stepper/common", 4},
                                          {"stepper/contact", 5},
                                          {"stepper/explicit", 6},
                                          {"stepper/implicit", 6},
                                          {"stepper/rigid", 6},
                                          {"stepper", 7},
                                          {"stepper/adapt", 8},
                                          {"output", 9},
                                          {"analysis", 10},
                                          {"figures", 11},
                                          {"record", 12},
                                          {"scenario", 13},
                                          {"app/setup", 14},
                                          {"app/check", 15},
                                          {"app/run", 16},
                                          {"app/ensemble", 17},
                                          {"app", 18}};

/// What a file includes in quotes or brackets, as written.
std::vector<std::string> includes(const File& file, char open) {
    static const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    std::vector<std::string> found;
    std::smatch match;
    for (const std::string& line : file.lines) {
        if (std::regex_search(line, match, pattern) && match[1].str()[0] == open) found.push_back(match[2]);
    }
    return found;
}

std::string folder_of(const std::string& path) { return path.substr(0, std::min(path.rfind('/'), path.size())); }

/// The folder of a file below src: "app/run" and "stepper/explicit" as well; "" for src/main.cpp.
std::string folder_below_src(const File& file) {
    const std::string below = file.path.substr(std::string("src/").size());
    return below.find('/') == std::string::npos ? "" : folder_of(below);
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& starts) {
    return std::any_of(starts.begin(), starts.end(), [&](const std::string& s) { return text.starts_with(s); });
}

/// Files of src that include a header whose name starts with one of these.
std::set<std::string> users_of(const std::vector<std::string>& starts) {
    std::set<std::string> users;
    for (const File& file : source_tree::files_below("src")) {
        for (const std::string& header : includes(file, '<')) {
            if (starts_with_any(header, starts)) users.insert(file.path);
        }
    }
    return users;
}

}  // namespace

TEST_CASE("a file includes its own folder and lower layers only") {
    int n_includes = 0;
    for (const File& file : source_tree::files_below("src")) {
        if (!file.is_cpp() || folder_below_src(file).empty()) continue;
        const std::string own = folder_below_src(file);
        CAPTURE(file.path);
        REQUIRE_MESSAGE(layer_of.contains(own), "folder without a layer: ", own);
        for (const std::string& header : includes(file, '"')) {
            CAPTURE(header);
            const std::string other = folder_of(header);
            REQUIRE_MESSAGE(layer_of.contains(other), "write it as \"folder/file.hpp\"");
            CHECK((other == own || layer_of.at(other) < layer_of.at(own)));
            CHECK(std::filesystem::exists(source_tree::root() / "src" / header));
            ++n_includes;
        }
    }
    CHECK(n_includes > 20);
}

TEST_CASE("the search for contacts knows no solver") {
    int n_files = 0;
    for (const File& file : source_tree::files_below("src")) {
        if (!file.is_cpp() || folder_below_src(file) != "stepper/contact") continue;
        ++n_files;
        for (const std::string& header : includes(file, '"'))
            CHECK_MESSAGE(!header.starts_with("nonsmooth/"), file.path, " includes ", header);
    }
    CHECK(n_files > 5);
}

TEST_CASE("headers and sources of a name include others in one direction") {
    const auto unit_of = [](const std::string& path) { return path.substr(0, path.rfind('.')); };
    std::map<std::string, std::set<std::string>> below;
    for (const File& file : source_tree::files_below("src")) {
        if (!file.is_cpp()) continue;
        const std::string unit = unit_of(file.path.substr(4));
        for (const std::string& header : includes(file, '"'))
            if (unit_of(header) != unit) below[unit].insert(unit_of(header));
    }
    std::map<std::string, std::set<std::string>> reached;  // by folder: units that come back to themselves
    for (const auto& [unit, direct] : below) {
        std::set<std::string> seen;
        std::vector<std::string> next(direct.begin(), direct.end());
        while (!next.empty()) {
            const std::string other = next.back();
            next.pop_back();
            if (!seen.insert(other).second) continue;
            if (const auto found = below.find(other); found != below.end())
                next.insert(next.end(), found->second.begin(), found->second.end());
        }
        if (seen.contains(unit)) reached[folder_of(unit)].insert(unit);
    }
    for (const auto& [folder, units] : reached) {
        std::string names;
        for (const std::string& unit : units) names += " " + unit;
        FAIL_CHECK("these in " << folder << " include each other:" << names);
    }
}

TEST_CASE("main includes only the app and errors") {
    const std::filesystem::path main = source_tree::root() / "src" / "main.cpp";
    if (!std::filesystem::exists(main)) return;
    for (const std::string& header : includes(source_tree::read(main), '"')) {
        CAPTURE(header);
        CHECK((header.starts_with("app/") || header.starts_with("base/")));
    }
}

TEST_CASE("CGAL and toml++ are each behind one file") {
    const std::map<std::string, std::set<std::string>> users{{"src/mesh/", users_of({"CGAL/"})},
                                                             {"src/scenario/", users_of({"toml++/", "toml.hpp"})}};
    for (const auto& [folder, files] : users) {
        CHECK(files.size() <= 1);
        for (const std::string& file : files) CHECK_MESSAGE(file.starts_with(folder), file);
    }
    for (const File& file : source_tree::files_below("src"))
        for (const std::string& header : includes(file, '"'))
            if (header == "mesh/constrained_delaunay.hpp" || header == "mesh/triangle_locator.hpp")
                CHECK_MESSAGE(file.path.starts_with("src/mesh/"), file.path);
}

TEST_CASE("CLI11 is in app only and JSON in app and record and the JSON schema and GeoJSON") {
    for (const std::string& user : users_of({"CLI/", "CLI11"})) CHECK(user.starts_with("src/app/"));
    for (const std::string& user : users_of({"nlohmann/"}))
        CHECK((user.starts_with("src/app/") || user.starts_with("src/record/") || user == "src/scenario/schema.cpp" ||
               user == "src/scenario/read_traces.cpp"));
}

TEST_CASE("cereal is behind one file") {
    CHECK(users_of({"cereal/"}) == std::set<std::string>{"src/app/run/checkpoint.cpp"});
    CHECK(users_of({"boost/"}).empty());
}

TEST_CASE("VTK is in output only and cairo in figures only") {
    for (const std::string& user : users_of({"vtk"})) CHECK(user.starts_with("src/output/"));
    for (const std::string& user : users_of({"cairo"})) CHECK(user.starts_with("src/figures/"));
    CHECK(users_of({"png.h"}) == std::set<std::string>{"src/figures/write_png.cpp"});
    CHECK(users_of({"webp/"}) == std::set<std::string>{"src/figures/animation.cpp"});
}

}  // namespace includes_test
