#include "lcp/matrix_market.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <vector>

namespace knap {
namespace {

constexpr long max_size = 100'000'000;
constexpr long max_empty_size = 1'000'000;  // of a matrix with fewer entries: a wrong number must not take all memory

class Reader {
public:
    Reader(std::istream& text, std::string source) : text_(text), source_(std::move(source)) {}

    LcpMatrix matrix() {
        if (!next_line(true)) fail("the file is empty");
        std::string header = line_.str(), banner, object, format, field, symmetry;
        std::ranges::transform(header, header.begin(), [](unsigned char c) { return std::tolower(c); });
        std::istringstream(header) >> banner >> object >> format >> field >> symmetry;
        if (banner != "%%matrixmarket" || object != "matrix")
            fail("the first line must start with `%%MatrixMarket matrix`");
        const auto require = [&](const char* name, const std::string& word, std::initializer_list<const char*> read) {
            if (std::ranges::find(read, word) == read.end())
                fail(std::string(name) + " `" + word + "`: only " + joined({read.begin(), read.end()}) + " are read");
        };
        require("format", format, {"coordinate", "array"});
        require("field", field, {"real", "integer"});
        require("symmetry", symmetry, {"general", "symmetric", "skew-symmetric"});
        const bool is_array = format == "array", is_general = symmetry == "general",
                   is_skew = symmetry.starts_with("skew");

        expect_line("the line of sizes");
        const long n_rows = number<long>("the number of rows"), n_columns = number<long>("the number of columns");
        long n_entries = is_array ? 0 : number<long>("the number of entries");
        expect_line_end();
        const long largest = std::max(n_rows, n_columns);
        if (std::min({n_rows, n_columns, n_entries}) < 0 || largest > max_size) fail("impossible sizes");
        if (!is_general && n_rows != n_columns) fail("a symmetric matrix must be square");
        if (is_array) n_entries = n_rows * n_columns;
        if (largest > std::max(max_empty_size, n_entries)) fail("a matrix of this size has more entries");
        if (is_array && !is_general) n_entries = n_rows * (n_rows + (is_skew ? -1 : 1)) / 2;

        std::vector<Eigen::Triplet<double>> entries;
        for (long k = 0, row = is_skew ? 1 : 0, column = 0; k < n_entries; ++k) {
            expect_line("an entry");
            if (!is_array) {
                row = number<long>("the row") - 1, column = number<long>("the column") - 1;
                if (row < 0 || row >= n_rows || column < 0 || column >= n_columns)
                    fail("the entry lies outside the matrix");
                if (!is_general && column > row) fail("a symmetric matrix is stored by its lower triangle");
            }
            const double value = number<double>("a finite number");
            expect_line_end();
            const int i = static_cast<int>(row), j = static_cast<int>(column);
            if (value != 0) entries.emplace_back(i, j, value);
            if (value != 0 && !is_general && i != j) entries.emplace_back(j, i, is_skew ? -value : value);
            if (is_array && ++row == n_rows) ++column, row = is_general ? 0 : column + (is_skew ? 1 : 0);
        }
        if (next_line()) fail("more entries than the line of sizes says");
        LcpMatrix M(n_rows, n_columns);
        M.setFromTriplets(entries.begin(), entries.end());
        if (static_cast<std::size_t>(M.nonZeros()) != entries.size()) fail("an entry occurs twice");
        return M;
    }

private:
    [[noreturn]] void fail(const std::string& message) const {
        const std::string line = line_.str();
        throw UserError(std::vector{Diagnostic{.code = "matrix-market",
                                               .message = message,
                                               .file = source_,
                                               .line = n_lines_,
                                               .column = 1,
                                               .length = static_cast<int>(line.size()),
                                               .source_line = line}});
    }

    /// To the next line, which may be blank or a comment where `any` is set.
    bool next_line(bool any = false) {
        for (std::string line; std::getline(text_, line);) {
            ++n_lines_;
            const std::size_t start = line.find_first_not_of(" \t\r");
            if (!any && (start == std::string::npos || line[start] == '%')) continue;
            line_ = std::istringstream(line);
            return true;
        }
        return false;
    }

    void expect_line(const std::string& content) {
        if (!next_line()) fail("the file ends where " + content + " should be");
    }

    template <class Number>
    Number number(const std::string& name) {
        Number value = 0;
        if (!(line_ >> value) || !std::isfinite(value)) fail("expected " + name);
        return value;
    }

    void expect_line_end() {
        if (std::string more; line_ >> more) fail("`" + more + "` after the end of the entry");
    }

    std::istream& text_;
    std::string source_;
    std::istringstream line_;
    int n_lines_ = 0;
};

LcpMatrix read_matrix_market_file(const std::string& file) {
    std::istringstream text(read_given_file(file, "cannot-read"));
    return read_matrix_market(text, file);
}

}  // namespace

LcpMatrix read_matrix_market(std::istream& text, const std::string& source) { return Reader(text, source).matrix(); }

LcpProblem read_lcp(const std::filesystem::path& stem) {
    std::string base = stem.string();
    if (base.ends_with(".L.mtx") || base.ends_with(".q.mtx")) base.resize(base.size() - 6);
    else if (std::error_code none; (stem.extension() == ".mtx" || std::filesystem::is_regular_file(stem, none)) &&
                                   !std::filesystem::exists(base + ".L.mtx", none))
        throw UserError("matrix-market", "`" + base + "` is not one of the two files of a stored problem",
                        "give NAME.L.mtx or NAME.q.mtx, which are beside each other, or NAME");
    const LcpMatrix M = read_matrix_market_file(base + ".L.mtx"), q = read_matrix_market_file(base + ".q.mtx");
    if (M.rows() != M.cols())
        throw UserError("matrix-market", concatenated("the matrix of `", base, ".L.mtx` is not square: ", M.rows(),
                                                      " rows, ", M.cols(), " columns"));
    if (q.cols() != 1 || q.rows() != M.rows())
        throw UserError("matrix-market", concatenated("`", base, ".q.mtx` must have one column and ", M.rows(),
                                                      " rows as the matrix; it has ", q.cols(), " and ", q.rows()));
    return {M, Eigen::MatrixXd(q).col(0)};
}

void write_lcp(const std::filesystem::path& stem, const LcpProblem& problem) {
    const std::string matrix_file = stem.string() + ".L.mtx", vector_file = stem.string() + ".q.mtx";
    for (const std::string& file : {matrix_file, vector_file})
        if (std::filesystem::exists(file)) throw UserError("file-exists", "`" + file + "` exists already");
    const LcpMatrix& M = problem.M;
    std::ostringstream matrix, vector;
    matrix << "%%MatrixMarket matrix coordinate real general\n"
           << M.rows() << ' ' << M.cols() << ' ' << M.nonZeros() << '\n';
    for (int i = 0; i < M.outerSize(); ++i)
        for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry)
            matrix << i + 1 << ' ' << entry.col() + 1 << ' ' << shortest(entry.value()) << '\n';
    vector << "%%MatrixMarket matrix array real general\n" << problem.size() << " 1\n";
    for (const double x : problem.q) vector << shortest(x) << '\n';
    write_whole_file(matrix_file, matrix.str());
    write_whole_file(vector_file, vector.str());
}

}  // namespace knap
