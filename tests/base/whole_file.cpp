// Files that are written as a whole.
#include "base/whole_file.hpp"

#include "base/error.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

namespace whole_file_test {

using namespace knap;
namespace fs = std::filesystem;

namespace {

/// A directory of its own that vanishes with the test.
struct Scratch {
    fs::path path = fs::temp_directory_path() / ("knap_whole_file_" + std::to_string(getpid()));
    Scratch() { fs::create_directories(path); }
    ~Scratch() { fs::remove_all(path); }
    std::ptrdiff_t n_files() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

}  // namespace

TEST_CASE("a whole file replaces the one before and keeps it where writing fails") {
    const Scratch scratch;
    const fs::path file = scratch.path / "a name with \xCF\x83.txt";
    const std::string bytes("line\n\0\xFF", 7);
    write_whole_file(file, "first");
    write_whole_file(file, bytes);
    CHECK(read_whole_file(file) == bytes);
    CHECK_THROWS_AS(write_whole_file(file,
                                     [](const fs::path& part) {
                                         write_whole_file(part, "half");
                                         throw SimulationError("stopped");
                                     }),
                    SimulationError);
    CHECK(read_whole_file(file) == bytes);
    CHECK(scratch.n_files() == 1);  // nothing half-written stays
}

TEST_CASE("the previous file is kept under another name until the new one is whole") {
    const Scratch scratch;
    const fs::path file = scratch.path / "now", older = scratch.path / "before";
    for (const char* text : {"1", "2", "3"}) replace_whole_file(file, older, text);
    CHECK(read_whole_file(file) == "3");
    CHECK(read_whole_file(older) == "2");
    CHECK(scratch.n_files() == 2);
}

TEST_CASE("errors of files name the path") {
    const Scratch scratch;
    const auto message = [](const auto& action) -> std::string {
        try {
            action();
        } catch (const OutputError& error) {
            return error.what();
        }
        return "";
    };
    const fs::path missing = scratch.path / "missing" / "file";
    CHECK(message([&] { read_whole_file(missing); }).find(missing.string()) != std::string::npos);
    CHECK(message([&] { write_whole_file(missing, "x"); }).find(missing.string()) != std::string::npos);
}

}  // namespace whole_file_test
