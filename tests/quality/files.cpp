// Habits of the files themselves.
#include "source_tree.hpp"

#include <doctest/doctest.h>

#include <sys/wait.h>

#include <cstdlib>
#include <map>
#include <regex>
#include <set>

namespace files_test {

using source_tree::File;

TEST_CASE("files in src are short") {
    std::size_t n_files = 0, total = 0;
    for (const File& file : source_tree::files_below("src")) {
        if (!file.is_cpp()) continue;
        CHECK_MESSAGE(file.lines.size() <= 600, file.path, " has ", file.lines.size(), " lines");
        ++n_files;
        total += file.lines.size();
    }
    REQUIRE(n_files > 10);
    CHECK(total / n_files < 250);  // mean
}

TEST_CASE("tests of a folder of src are in the folder of its name") {
    const std::set<std::string> of_no_folder{"fuzz",  "properties", "python",      "quality",
                                             "slurm", "support",    "verification"};
    std::set<std::string> folders;
    for (const File& file : source_tree::files_below("tests")) {
        const std::string below = file.path.substr(std::string("tests/").size());
        if (!file.is_cpp() || below.find('/') == std::string::npos) continue;
        if (!of_no_folder.contains(below.substr(0, below.find('/')))) folders.insert(below.substr(0, below.rfind('/')));
    }
    REQUIRE(folders.size() > 15);
    for (const std::string& folder : folders)
        CHECK_MESSAGE(std::filesystem::is_directory(source_tree::root() / "src" / folder), "tests/", folder);
}

TEST_CASE("no tabs and no spaces at the end of a line") {
    for (const File& file : source_tree::all_files()) {
        if (!file.is_cpp()) continue;
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            const std::string& line = file.lines[i];
            const bool is_clean = line.find('\t') == std::string::npos && (line.empty() || line.back() != ' ');
            CHECK_MESSAGE(is_clean, file.path, ":", i + 1);
        }
    }
}

TEST_CASE("lines of src fit the screen") {
    for (const File& file : source_tree::files_below("src")) {
        if (!file.is_cpp()) continue;
        // in columns, not bytes
        const auto columns = [](const std::string& l) {
            return std::count_if(l.begin(), l.end(), [](char c) { return (c & 0xC0) != 0x80; });
        };
        const auto n_wide =
            std::count_if(file.lines.begin(), file.lines.end(), [&](const std::string& l) { return columns(l) > 120; });
        CHECK_MESSAGE(n_wide == 0, file.path, " has ", n_wide, " lines of more than 120 columns");
    }
}

TEST_CASE("clang-format leaves the files as they are") {
    if (std::system("command -v clang-format >/dev/null") != 0) return;  // a tool of developers, not of users
    const std::string files = "find src tests tools -name '*.[ch]pp' -print0 | xargs -0 clang-format --dry-run -Werror";
    CHECK(std::system(("cd '" KNAP_SOURCE_DIR "' && " + files).c_str()) == 0);
}

TEST_CASE("no class is defined in two .cpp") {
    static const std::regex member(R"(^(?:[\w:<>,&*\[\] ]*[ &*>])?([A-Z]\w*)::~?\w+\(.*[^;]$)");
    std::map<std::string, std::string> file_of;
    for (const File& file : source_tree::files_below("src"))
        for (const std::string& line : file.lines)
            if (std::smatch m; file.has_extension(".cpp") && std::regex_match(line, m, member)) {
                const auto [known, is_new] = file_of.emplace(m[1], file.path);
                CHECK_MESSAGE(known->second == file.path, m[1].str(), " is defined in ", known->second, " and ",
                              file.path);
            }
    CHECK(file_of.size() > 50);
}

TEST_CASE("tests compare by tolerances that are relative or have a unit") {
    static const std::regex scaled_by_one(R"(\bAppro[x]\b)"), relative(R"(== (\w+::)*relative\()");
    std::size_t n_relative = 0;
    for (const File& file : source_tree::files_below("tests")) {
        if (!file.is_cpp()) continue;
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            const std::string code = file.lines[i].substr(0, file.lines[i].find("//"));
            CHECK_MESSAGE(!std::regex_search(code, scaled_by_one), file.path, ":", i + 1, ": support/relative.hpp");
            n_relative += std::regex_search(code, relative);
        }
    }
    CHECK(n_relative > 500);
}

TEST_CASE("every header has pragma once in its first line") {
    std::size_t n_headers = 0;
    for (const char* folder : {"src", "tests"}) {
        for (const File& file : source_tree::files_below(folder)) {
            if (!file.has_extension(".hpp")) continue;
            ++n_headers;
            CHECK_MESSAGE((!file.lines.empty() && file.lines.front() == "#pragma once"), file.path);
        }
    }
    CHECK(n_headers > 10);
}

TEST_CASE("no path of a machine") {
    // put together here so that this file does not find itself
    const std::vector<std::string> starts{
        "/"
        "home/",
        "/"
        "root/",
        "/"
        "work/",
        "/"
        "tmp/",
        "/"
        "mnt/",
        "/"
        "Users/"};
    for (const File& file : source_tree::all_files()) {
        if (file.path == ".git") continue;  // in a linked worktree a file that names its repository
        for (std::size_t i = 0; i < file.lines.size(); ++i) {
            for (const std::string& start : starts) {
                CHECK_MESSAGE(file.lines[i].find(start) == std::string::npos, file.path, ":", i + 1, " names ", start);
            }
        }
    }
}

TEST_CASE("tools are executable and stop at the first error") {
    namespace fs = std::filesystem;
    for (const char* name : {"tools/run", "tools/test", "tools/setup", ".ci/run"}) {
        CAPTURE(name);
        const fs::path path = source_tree::root() / name;
        REQUIRE(fs::exists(path));
        CHECK((fs::status(path).permissions() & fs::perms::owner_exec) != fs::perms::none);
        const File script = source_tree::read(path);
        CHECK(std::find(script.lines.begin(), script.lines.end(), "set -euo pipefail") != script.lines.end());
    }
}

TEST_CASE("tools refuse options that they do not know") {
    for (const char* name : {"run", "test", "setup", "lint", "verify", "gallery", "fuzz", "bench/tables",
                             "bench/quench", "bench/lammps", "bench/box2d/run", "package/try", "package/try_archive"}) {
        CAPTURE(name);
        const std::string tool = "'" KNAP_SOURCE_DIR "/tools/" + std::string(name) + "'";
        const int unknown = std::system((tool + " --no-such-option 2>/dev/null").c_str());
        CHECK(WEXITSTATUS(unknown) == 2);
        CHECK(std::system((tool + " --help | grep -q .").c_str()) == 0);
    }
}

TEST_CASE("every third-party package has its page") {
    const File index = source_tree::read(source_tree::root() / "third_party_notes" / "README.md");
    for (const char* name : {"eigen", "cgal", "vtk", "cli11", "tomlplusplus", "nlohmann_json", "doctest", "cairo",
                             "libpng", "libwebp", "openmp", "dejavu", "cereal", "boost"}) {
        const std::string page = std::string(name) + ".md";
        CAPTURE(page);
        CHECK(std::filesystem::exists(source_tree::root() / "third_party_notes" / page));
        CHECK(std::any_of(index.lines.begin(), index.lines.end(),
                          [&](const std::string& l) { return l.find(page) != std::string::npos; }));
    }
}

TEST_CASE("notes name files that exist") {
    static const std::regex pattern("`((src|tests|tools|scenarios)/[A-Za-z0-9_./-]*)`");
    for (const File& file : source_tree::all_files()) {
        if (!file.has_extension(".md")) continue;
        for (const std::string& line : file.lines) {
            for (std::sregex_iterator m(line.begin(), line.end(), pattern), end; m != end; ++m) {
                CHECK_MESSAGE(std::filesystem::exists(source_tree::root() / (*m)[1].str()), file.path, " names ",
                              (*m)[1].str());
            }
        }
    }
}

/// Of a line of a csv file; commas between quotes separate nothing.
std::ptrdiff_t n_fields(const std::string& line) {
    bool quoted = false;
    return 1 + std::count_if(line.begin(), line.end(), [&](char c) {
               if (c == '"') quoted = !quoted;
               return c == ',' && !quoted;
           });
}

TEST_CASE("tables of results say what they are and stand on a page") {
    std::string pages;
    for (const char* page :
         {"scenarios/BENCHMARKS.md", "scenarios/README.md", "tools/bench/README.md", "tests/VERIFICATION.md"})
        for (const std::string& line : source_tree::read(source_tree::root() / page).lines) pages += line;
    for (const char* folder : {"scenarios/results", "tools/bench", "tests/verification"})
        for (const File& file : source_tree::files_below(folder)) {
            if (!file.has_extension(".csv")) continue;
            CAPTURE(file.path);
            const auto header = std::find_if(file.lines.begin(), file.lines.end(),
                                             [](const std::string& l) { return !l.starts_with("#"); });
            REQUIRE(header != file.lines.end());
            CHECK(header != file.lines.begin());
            for (auto line = header; line != file.lines.end(); ++line)
                CHECK_MESSAGE(n_fields(*line) == n_fields(*header), *line);
            const std::string name = std::filesystem::path(file.path).filename().string();
            CHECK_MESSAGE((pages.find("/" + name + ")") != std::string::npos ||
                           pages.find("(" + name + ")") != std::string::npos),
                          "no page links to it");
        }
}

}  // namespace files_test
