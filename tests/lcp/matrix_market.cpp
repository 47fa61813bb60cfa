#include "lcp/matrix_market.hpp"

#include "base/error.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace matrix_market_test {

using namespace knap;

namespace {

Eigen::MatrixXd read(const std::string& text) {
    std::istringstream stream(text);
    return read_matrix_market(stream, "text");
}

/// Line of the error message; 0 where the text is read without error.
int line_of_error(const std::string& text) {
    try {
        read(text);
    } catch (const UserError& error) {
        CHECK(!error.diagnostics.at(0).message.empty());
        CHECK(error.diagnostics.at(0).file == "text");
        return error.diagnostics.at(0).line;
    }
    return 0;
}

}  // namespace

TEST_CASE("Matrix Market texts of every supported kind") {
    Eigen::MatrixXd expected(2, 2);
    expected << 1, 3, 2, 4;
    CHECK(read("%%MatrixMarket matrix array real general\n% comment\n2 2\n1\n2\n3\n4\n") == expected);
    CHECK(read("%%MatrixMarket MATRIX Coordinate integer General\n\n2 2 4\n1 1 1\n2 1 2\n1 2 3\n2 2 4\n") == expected);
    expected << 1, 2, 2, 0;
    CHECK(read("%%MatrixMarket matrix coordinate real symmetric\r\n2 2 2\r\n1 1 1\r\n2 1 2\r\n") == expected);
    CHECK(read("%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n0\n") == expected);
    expected << 0, -2e-3, 2e-3, 0;
    CHECK(read("%%MatrixMarket matrix array real skew-symmetric\n2 2\n2e-3\n") == expected);
    CHECK(read("%%MatrixMarket matrix coordinate real general\n0 0 0\n").size() == 0);
}

TEST_CASE("Matrix Market errors name their line") {
    const std::string general = "%%MatrixMarket matrix coordinate real general\n";
    CHECK(line_of_error("1 2 3\n") == 1);
    CHECK(line_of_error("%%MatrixMarket matrix coordinate complex general\n") == 1);
    CHECK(line_of_error(general + "2 2\n") == 2);
    CHECK(line_of_error(general + "-2 2 0\n") == 2);
    CHECK(line_of_error(general + "2 2 1\n3 1 1\n") == 3);
    CHECK(line_of_error(general + "2 2 1\n0 1 1\n") == 3);
    CHECK(line_of_error(general + "2 2 1\n1 1 abc\n") == 3);
    CHECK(line_of_error(general + "2 2 1\n1 1 nan\n") == 3);
    CHECK(line_of_error(general + "2 2 1\n1 1 1 1\n") == 3);
    CHECK(line_of_error(general + "2 2 2\n1 1 1\n") == 3);
    CHECK(line_of_error(general + "2 2 1\n1 1 1\n2 2 1\n") == 4);
    CHECK(line_of_error("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 1\n") == 3);
    CHECK_THROWS_AS(read_lcp("there_is_no_such_file"), UserError);
    CHECK_THROWS_WITH_AS(read_lcp("nosuch.mtx"),
                         doctest::Contains("`nosuch.mtx` is not one of the two files of a stored problem"), UserError);
    CHECK_THROWS_WITH_AS(read_lcp(__FILE__), doctest::Contains("is not one of the two files"), UserError);
}

TEST_CASE("a written problem reads back to the same bits and is never overwritten") {
    const std::filesystem::path folder = std::filesystem::path(KNAP_BINARY_DIR) / "lcp tests";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    Eigen::MatrixXd M(2, 2);
    M << 1.0 / 3, 0, -1e-300, 0.1;
    const Eigen::Vector2d q(-1e17 / 7, 5e-324);
    const std::filesystem::path stem = folder / "some.step";
    write_lcp(stem, lcp_problem(M, q));
    const LcpProblem back = read_lcp(folder / "some.step.q.mtx");
    CHECK(Eigen::MatrixXd(back.M) == M);
    CHECK(back.q == q);
    CHECK_THROWS_AS(write_lcp(stem, lcp_problem(M, q)), UserError);
    std::filesystem::remove(folder / "some.step.L.mtx");
    CHECK_THROWS_AS(write_lcp(stem, lcp_problem(M, q)), UserError);  // the other file exists
    CHECK(!std::filesystem::exists(folder / "some.step.L.mtx"));
    CHECK_THROWS_AS(write_lcp(folder / "no such folder" / "x", lcp_problem(M, q)), OutputError);
    write_lcp(folder / "empty", lcp_problem(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)));
    CHECK(read_lcp(folder / "empty").size() == 0);
}

}  // namespace matrix_market_test
