// Files that are written as a whole.
#include "base/whole_file.hpp"

#include "base/appended_file.hpp"
#include "base/checksum.hpp"
#include "base/error.hpp"
#include "support/limited.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

#include <set>

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
    const fs::path missing = scratch.path / "missing" / "file";
    CHECK(tests::output_error_of([&] { read_whole_file(missing); }).find(missing.string()) != std::string::npos);
    CHECK(tests::output_error_of([&] { write_whole_file(missing, "x"); }).find(missing.string()) != std::string::npos);
}

TEST_CASE("a temporary name leads nowhere else") {
    const Scratch scratch;
    const fs::path file = scratch.path / "run.json", other = scratch.path / "of someone else";
    write_whole_file(other, "precious");
    fs::create_symlink(other, scratch.path / "run.json.part");
    write_whole_file(file, "record");
    CHECK(read_whole_file(other) == "precious");
    CHECK(read_whole_file(file) == "record");
    fs::create_symlink(other, scratch.path / "run.json.part");
    write_whole_file(file, [](const fs::path& part) { write_whole_file(part, "by its name"); });
    CHECK(read_whole_file(other) == "precious");
    CHECK(read_whole_file(file) == "by its name");
    fs::create_directory(scratch.path / "run.json.part");
    CHECK_THROWS_AS(write_whole_file(file, "third"), OutputError);
    CHECK(read_whole_file(file) == "by its name");
    fs::remove(scratch.path / "run.json.part");
    CHECK(scratch.n_files() == 2);
    fs::create_symlink(other, scratch.path / "log.txt");
    CHECK_THROWS_WITH_AS(AppendedFile(scratch.path / "log.txt"), doctest::Contains("it is a symbolic link"),
                         OutputError);
}

TEST_CASE("a file that grows is with the system after every line or the reason is told") {
    const Scratch scratch;
    const fs::path path = scratch.path / "energy.csv";
    {
        AppendedFile file(path);
        file.add("first\n");
        CHECK(read_whole_file(path) == "first\n");
        AppendedFile moved = std::move(file);
        moved.add("second\n");
        CHECK(moved.size() == 13);
        moved.truncate(6);
        moved.close();
        CHECK(moved.descriptor() == -1);
    }
    CHECK(read_whole_file(path) == "first\n");
    CHECK(AppendedFile(path).size() == 6);
    if (fs::exists("/dev/full")) {
        AppendedFile full("/dev/full");
        CHECK(tests::output_error_of([&] { full.add("x"); }).find("/dev/full: No space left") != std::string::npos);
    }
    const tests::Limited no_more_files(RLIMIT_NOFILE, 0);
    CHECK(tests::output_error_of([&] { AppendedFile{path}; }).find("energy.csv: Too many open files") !=
          std::string::npos);
    CHECK(tests::output_error_of([&] { write_whole_file(path, "x"); }).find("energy.csv: Too many open files") !=
          std::string::npos);
    CHECK(tests::output_error_of([&] { read_whole_file(path); }).find("energy.csv: Too many open files") !=
          std::string::npos);
}

TEST_CASE("a file that cannot be read to its end is an error") {
    CHECK_THROWS_WITH_AS(read_whole_file("/proc/self/mem"), doctest::Contains("Input/output error"), OutputError);
    CHECK_THROWS_WITH_AS(read_whole_file(fs::temp_directory_path()), doctest::Contains("Is a directory"), OutputError);
    const Scratch scratch;
    write_whole_file(scratch.path / "none", "");
    CHECK(read_whole_file(scratch.path / "none").empty());
    const std::string large(300'000, 'x');
    write_whole_file(scratch.path / "large", large, true);
    CHECK(read_whole_file(scratch.path / "large") == large);
}

TEST_CASE("every flipped bit and every missing byte changes the checksum") {
    std::string bytes = "a checksum of 29 bytes: 4 words";
    std::set<std::uint64_t> sums{checksum(bytes)};
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        std::string other = bytes;
        other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << bit % 8));
        sums.insert(checksum(other));
    }
    for (std::size_t n = 0; n < bytes.size(); ++n) sums.insert(checksum(bytes.substr(0, n)));
    for (const char* end : {"", "x"}) sums.insert(checksum(bytes + std::string("\0", 1) + end));
    CHECK(sums.size() == 1 + 9 * bytes.size() + 2);
    // the highest bits of two words, which multiplication alone would not spread
    std::string twice(64, ' ');
    const std::uint64_t before = checksum(twice);
    twice[7] ^= '\x80', twice[15] ^= '\x80';
    CHECK(checksum(twice) != before);
}

TEST_CASE("a file is read in parts and a fault names its reason") {
    const Scratch scratch;
    const fs::path file = scratch.path / "bytes";
    std::string bytes;
    for (int i = 0; i < 200'000; ++i) bytes += static_cast<char>(i * i % 251);
    write_whole_file(file, bytes);
    CHECK(read_whole_file(file) == bytes);
    CHECK(read_begin(file, 70'000) == bytes.substr(0, 70'000));
    for (const std::size_t n : {bytes.size(), 2 * bytes.size()}) CHECK(read_begin(file, n) == bytes);
    for (const std::size_t n : {std::size_t{5}, bytes.size()})
        CHECK(fault_of_end(file, bytes.substr(bytes.size() - n)).empty());
    CHECK(fault_of_end(file, "</end>") == "is cut off after 200000 bytes");
    CHECK(fault_of_end(scratch.path, "</end>").find("is damaged: ") == 0);
    CHECK(fault_of_bytes(file, checksum(bytes)).empty());
    CHECK(fault_of_bytes(file, checksum(bytes) + 1) == "is damaged: its checksum is wrong");
    CHECK(fault_of_bytes(scratch.path / "none", 0).find("No such file") != std::string::npos);
    CHECK(tests::output_error_of([&] { read_whole_file(scratch.path); }).find("Is a directory") != std::string::npos);
    CHECK_THROWS_AS(read_given_file(scratch.path / "none", "missing-file"), UserError);
}

}  // namespace whole_file_test
