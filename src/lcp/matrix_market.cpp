#include "lcp/matrix_market.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

namespace knap {
namespace {

struct Header {
    bool coordinate = false;
    bool mirrored = false;  // only the lower triangle is stored
    double mirror_sign = 1;
};

class Reader {
public:
    Reader(std::istream& text, std::string source) : text_(text), source_(std::move(source)) {}

    LcpMatrix matrix() {
        const Header header = read_header();
        std::istringstream sizes = next_line("the line of sizes");
        const long n_rows = whole(sizes, "number of rows"), n_columns = whole(sizes, "number of columns");
        const long n_given = header.coordinate ? whole(sizes, "number of entries") : 0;
        end_of(sizes);
        if (n_rows < 0 || n_columns < 0 || n_given < 0 || std::max(n_rows, n_columns) > largest_size) fail("impossible sizes");
        if (header.mirrored && n_rows != n_columns) fail("a symmetric matrix must be square");
        const long n_entries = header.coordinate ? n_given : n_rows * n_columns;
        if (std::max(n_rows, n_columns) > std::max(believed_size, n_entries)) fail("a matrix of this size has more entries");
        if (header.coordinate) {
            for (long k = 0; k < n_entries; ++k) read_entry(header, n_rows, n_columns);
        } else {
            read_array(header, n_rows, n_columns);
        }
        expect_end();
        LcpMatrix M(n_rows, n_columns);
        M.setFromTriplets(entries_.begin(), entries_.end());
        if (static_cast<std::size_t>(M.nonZeros()) != entries_.size()) fail("an entry stands there twice");
        return M;
    }

private:
    static constexpr long largest_size = 100'000'000;
    static constexpr long believed_size = 1'000'000;  // without as many entries: a wrong number must not take all memory

    [[noreturn]] void fail(const std::string& message) const {
        throw UserError(std::vector{Diagnostic{.code = "matrix-market", .message = message, .file = source_, .line = line_}});
    }

    Header read_header() {
        std::string line;
        if (!std::getline(text_, line)) fail("the file is empty or cannot be read");
        ++line_;
        std::transform(line.begin(), line.end(), line.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        std::istringstream words(line);
        std::string banner, object, format, field, symmetry;
        words >> banner >> object >> format >> field >> symmetry;
        if (banner != "%%matrixmarket" || object != "matrix") fail("the first line must begin with `%%MatrixMarket matrix`");
        if (format != "coordinate" && format != "array") fail("format `" + format + "`: only coordinate and array are read");
        if (field != "real" && field != "integer") fail("field `" + field + "`: only real and integer are read");
        if (symmetry != "general" && symmetry != "symmetric" && symmetry != "skew-symmetric")
            fail("symmetry `" + symmetry + "`: only general, symmetric and skew-symmetric are read");
        return {format == "coordinate", symmetry != "general", symmetry == "skew-symmetric" ? -1.0 : 1.0};
    }

    /// Skips comments and blank lines.
    bool skip_to_line(std::string& line) {
        while (std::getline(text_, line)) {
            ++line_;
            const size_t start = line.find_first_not_of(" \t\r");
            if (start != std::string::npos && line[start] != '%') return true;
        }
        return false;
    }

    std::istringstream next_line(const std::string& wanted) {
        std::string line;
        if (!skip_to_line(line)) fail("the file ends where " + wanted + " should be");
        return std::istringstream(line);
    }

    void expect_end() {
        std::string line;
        if (skip_to_line(line)) fail("more entries than the line of sizes says");
    }

    long whole(std::istringstream& words, const char* wanted) const {
        long value = 0;
        if (!(words >> value)) fail(std::string("expected the ") + wanted);
        return value;
    }

    double number(std::istringstream& words) const {
        double value = 0;
        if (!(words >> value) || !std::isfinite(value)) fail("expected a finite number");
        return value;
    }

    void end_of(std::istringstream& words) const {
        std::string more;
        if (words >> more) fail("`" + more + "` after the end of the entry");
    }

    void read_entry(const Header& header, long n_rows, long n_columns) {
        std::istringstream words = next_line("an entry");
        const long row = whole(words, "row"), column = whole(words, "column");
        const double value = number(words);
        end_of(words);
        if (row < 1 || row > n_rows || column < 1 || column > n_columns) fail("the entry lies outside the matrix");
        if (header.mirrored && column > row) fail("a symmetric matrix is stored by its lower triangle");
        add(header, row - 1, column - 1, value);
    }

    void read_array(const Header& header, long n_rows, long n_columns) {
        for (long column = 0; column < n_columns; ++column)
            for (long row = header.mirrored ? column + (header.mirror_sign < 0) : 0; row < n_rows; ++row) {
                std::istringstream words = next_line("an entry");
                const double value = number(words);
                end_of(words);
                add(header, row, column, value);
            }
    }

    void add(const Header& header, long row, long column, double value) {
        if (value == 0) return;
        entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
        if (header.mirrored && row != column)
            entries_.emplace_back(static_cast<int>(column), static_cast<int>(row), header.mirror_sign * value);
    }

    std::istream& text_;
    std::string source_;
    int line_ = 0;
    std::vector<Eigen::Triplet<double>> entries_;
};

std::string without_suffix(std::string path) {
    for (const std::string suffix : {".L.mtx", ".q.mtx"})
        if (path.ends_with(suffix)) return path.substr(0, path.size() - suffix.size());
    return path;
}

}  // namespace

LcpMatrix read_matrix_market(std::istream& text, const std::string& source) { return Reader(text, source).matrix(); }

LcpMatrix read_matrix_market(const std::filesystem::path& file) {
    std::ifstream text(file);
    if (!text) throw UserError("cannot-read", "cannot open `" + file.string() + "`");
    return read_matrix_market(text, file.string());
}

LcpProblem read_lcp(const std::filesystem::path& stem) {
    const std::string base = without_suffix(stem.string());
    const LcpMatrix M = read_matrix_market(std::filesystem::path(base + ".L.mtx"));
    const LcpMatrix q = read_matrix_market(std::filesystem::path(base + ".q.mtx"));
    if (M.rows() != M.cols()) throw UserError("matrix-market", "the matrix of `" + base + ".L.mtx` is not square");
    if (q.cols() != 1 || q.rows() != M.rows())
        throw UserError("matrix-market", "`" + base + ".q.mtx` must have one column and as many rows as the matrix");
    return {M, Eigen::MatrixXd(q).col(0)};
}

}  // namespace knap
