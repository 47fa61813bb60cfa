#pragma once
// The program as a person runs it: arguments in, text and exit code out.
#include <doctest/doctest.h>

#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>

namespace program {

namespace fs = std::filesystem;

struct Answer {
    int code;
    std::string text;  // standard output and standard error
    bool has(const std::string& words) const { return text.find(words) != std::string::npos; }
};

/// `arguments` as typed in a shell.
inline Answer command(const std::string& arguments) {
    FILE* pipe = popen(("'" KNAP_PROGRAM "' " + arguments + " 2>&1").c_str(), "r");
    REQUIRE(pipe != nullptr);
    Answer answer{0, {}};
    char buffer[4096];
    for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) answer.text.append(buffer, n);
    const int status = pclose(pipe);
    answer.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return answer;
}

inline std::string text_of(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// In its middle.
inline void flip_a_byte(const fs::path& path) {
    std::string bytes = text_of(path);
    bytes[bytes.size() / 2] ^= 1;
    std::ofstream(path, std::ios::binary) << bytes;
}

/// A folder of its own for one test, empty at the start.
class Folder {
public:
    explicit Folder(const std::string& name)
        : path(fs::path(KNAP_BINARY_DIR) / "app tests" / name) {  // the space is on purpose
        fs::remove_all(path);
        fs::create_directories(path);
    }
    std::string in_shell(const std::string& file) const { return "'" + (path / file).string() + "'"; }
    fs::path path;
};

/// The tables and frames of two runs are the same; `least`: of them there are more.
inline void check_same(const fs::path& a, const fs::path& b, int least) {
    int n = 0;
    for (const auto& file : fs::recursive_directory_iterator(a)) {
        const std::string ending = file.path().extension();
        if (ending != ".csv" && ending != ".vtu" && ending != ".webp") continue;
        ++n;
        CHECK_MESSAGE(text_of(file.path()) == text_of(b / fs::relative(file.path(), a)), file.path().string());
    }
    CHECK(n > least);
}

/// The scenario of a test in its folder.
inline void write_scene(const Folder& folder, const std::string& text) {
    std::ofstream(folder.path / "scene.toml") << text;
}
inline Answer run_scene(const Folder& folder, const std::string& options) {
    return command("run " + folder.in_shell("scene.toml") + " -q -s output.report=false " + options);
}

/// `knap check` finds an error with this code and these words in it.
inline void check_refused(const Folder& folder, const std::string& text, const char* code, const char* words) {
    write_scene(folder, text);
    const Answer answer = command("check " + folder.in_shell("scene.toml"));
    CAPTURE(answer.text);
    CHECK(answer.code == 2);
    CHECK(answer.has(code));
    CHECK(answer.has(words));
}

/// What check says of a scenario that it accepts.
inline Answer accepted(const Folder& folder, const std::string& text) {
    write_scene(folder, text);
    const Answer answer = command("check " + folder.in_shell("scene.toml"));
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    return answer;
}

/// Runs the scenario whole, with these numbers of threads, and in parts that end at these times: all have the tables
/// and frames of the run `whole`; `least`: of them there are more.
inline void check_threads_and_parts(const Folder& folder, std::initializer_list<const char*> threads,
                                    std::initializer_list<const char*> ends, int least) {
    const Answer whole = run_scene(folder, "-j 1 -o " + folder.in_shell("whole"));
    CAPTURE(whole.text);
    REQUIRE(whole.code == 0);
    for (const std::string n : threads) {
        const std::string name = "threads" + n;
        REQUIRE(run_scene(folder, "-j " + n + " -o " + folder.in_shell(name)).code == 0);
        check_same(folder.path / "whole", folder.path / name, least);
    }
    const std::string parts = "-j 1 -o " + folder.in_shell("parts");
    for (const char* end : ends) REQUIRE(run_scene(folder, parts + " --until " + end).code == 0);
    REQUIRE(run_scene(folder, parts).code == 0);
    check_same(folder.path / "whole", folder.path / "parts", least);
}

/// For runs of which no test looks at the figures and the report: they take nine tenths of the time of a short one.
inline const std::string undrawn = "-s 'figure=[]' -s output.report=false ";

/// A small block that breaks within a tenth of a second; `output`: options of what it draws.
inline std::string small_block(const std::string& output = undrawn) {
    return "edge_cracked_block -q -j 1 -s 'mesh.size=2 mm' -s 'time.end=40 us' -s 'expect={}' " + output;
}

/// The head of a scenario: a rectangle of the sides "a, b" [m], `more` of its [domain], triangles of `size` [m].
inline std::string rectangle(const std::string& sides, const std::string& size, const std::string& more = "") {
    return "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [" + sides + "]\n" + more + "[mesh]\nsize = " + size +
           "\n";
}

}  // namespace program
