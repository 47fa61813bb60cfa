// Tables that grow line by line, where the system refuses.
#include "record/tables.hpp"

#include "base/whole_file.hpp"
#include "support/limited.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

namespace tables_test {

using namespace knap;
namespace fs = std::filesystem;

TEST_CASE("tables: what cannot be opened or written is an error and no line is lost silently") {
    const fs::path directory = fs::temp_directory_path() / ("knap_tables_" + std::to_string(getpid()));
    fs::create_directories(directory);
    Tables tables(directory, false);
    tables.add(&Histories::breaks, {"time"});
    tables.add(&Histories::fragment_paths, {"time"});
    const int first_free = dup(STDERR_FILENO);
    close(first_free);
    {  // one more file: enough for the head, which is written and closed, and for one table that stays open
        const tests::Limited few(RLIMIT_NOFILE, first_free + 1);
        CHECK(tests::output_error_of([&] { tables.open(); }).find("fragment_paths.csv: Too many open files") !=
              std::string::npos);
    }
    tables.open();
    tables.add_line(&Histories::breaks, {1});
    CHECK(read_whole_file(directory / "breaks.csv") == "time [s]\n1\n");
    {
        const tests::Limited small(RLIMIT_FSIZE, 12);
        CHECK(tests::output_error_of([&] {
                  tables.add_line(&Histories::breaks, {2});
              }).find("breaks.csv: File too large") != std::string::npos);
    }
    tables.close();
    tables.open();  // as a run that continues does
    CHECK(read_whole_file(directory / "breaks.csv") == "time [s]\n1\n2\n");
    tables.close();
    fs::remove_all(directory);
}

}  // namespace tables_test
