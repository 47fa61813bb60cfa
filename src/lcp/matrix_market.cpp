#include "lcp/matrix_market.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
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
        read_header();
        next_line("the line of sizes");
        n_rows_ = number<long>("the number of rows");
        n_columns_ = number<long>("the number of columns");
        const long n_given = is_coordinate_ ? number<long>("the number of entries") : 0;
        end_line();
        const long largest = std::max(n_rows_, n_columns_);
        if (std::min({n_rows_, n_columns_, n_given}) < 0 || largest > max_size) fail("impossible sizes");
        const long n_entries = is_coordinate_ ? n_given : n_rows_ * n_columns_;
        if (sign_of_mirror_ != 0 && n_rows_ != n_columns_) fail("a symmetric matrix must be square");
        if (largest > std::max(max_empty_size, n_entries)) fail("a matrix of this size has more entries");
        if (is_coordinate_) {
            for (long k = 0; k < n_entries; ++k) read_entry();
        } else {
            for (long column = 0; column < n_columns_; ++column)
                for (long row = sign_of_mirror_ == 0 ? 0 : column + (sign_of_mirror_ < 0); row < n_rows_; ++row) {
                    next_line("an entry");
                    add(row, column);
                }
        }
        if (skip_to_line()) fail("more entries than the line of sizes says");
        LcpMatrix M(n_rows_, n_columns_);
        M.setFromTriplets(entries_.begin(), entries_.end());
        if (static_cast<std::size_t>(M.nonZeros()) != entries_.size()) fail("an entry occurs twice");
        return M;
    }

private:
    [[noreturn]] void fail(const std::string& message) const {
        throw UserError(
            std::vector{Diagnostic{.code = "matrix-market", .message = message, .file = source_, .line = n_lines_}});
    }

    void read_header() {
        std::string line;
        if (!std::getline(text_, line)) fail("the file is empty or cannot be read");
        ++n_lines_;
        std::ranges::transform(line, line.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        std::istringstream words(line);
        std::string banner, object, format, field, symmetry;
        words >> banner >> object >> format >> field >> symmetry;
        if (banner != "%%matrixmarket" || object != "matrix")
            fail("the first line must begin with `%%MatrixMarket matrix`");
        if (format != "coordinate" && format != "array")
            fail("format `" + format + "`: only coordinate and array are read");
        if (field != "real" && field != "integer") fail("field `" + field + "`: only real and integer are read");
        if (symmetry != "general" && symmetry != "symmetric" && symmetry != "skew-symmetric")
            fail("symmetry `" + symmetry + "`: only general, symmetric and skew-symmetric are read");
        is_coordinate_ = format == "coordinate";
        sign_of_mirror_ = symmetry == "general" ? 0 : symmetry == "symmetric" ? 1 : -1;
    }

    /// To the next line that is neither blank nor a comment.
    bool skip_to_line() {
        for (std::string line; std::getline(text_, line);) {
            ++n_lines_;
            const std::size_t start = line.find_first_not_of(" \t\r");
            if (start == std::string::npos || line[start] == '%') continue;
            line_ = std::istringstream(line);
            return true;
        }
        return false;
    }

    void next_line(const std::string& expected) {
        if (!skip_to_line()) fail("the file ends where " + expected + " should be");
    }

    template <class Number>
    Number number(const std::string& name) {
        Number value = 0;
        if (!(line_ >> value) || !std::isfinite(value)) fail("expected " + name);
        return value;
    }

    void end_line() {
        std::string more;
        if (line_ >> more) fail("`" + more + "` after the end of the entry");
    }

    void read_entry() {
        next_line("an entry");
        const long row = number<long>("the row"), column = number<long>("the column");
        if (row < 1 || row > n_rows_ || column < 1 || column > n_columns_) fail("the entry lies outside the matrix");
        if (sign_of_mirror_ != 0 && column > row) fail("a symmetric matrix is stored by its lower triangle");
        add(row - 1, column - 1);
    }

    /// The value at the end of the line.
    void add(long row, long column) {
        const double value = number<double>("a finite number");
        end_line();
        if (value == 0) return;
        entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
        if (sign_of_mirror_ != 0 && row != column)
            entries_.emplace_back(static_cast<int>(column), static_cast<int>(row), sign_of_mirror_ * value);
    }

    std::istream& text_;
    std::string source_;
    std::istringstream line_;
    int n_lines_ = 0;
    bool is_coordinate_ = false;
    int sign_of_mirror_ = 0;  // of the upper triangle, which is not stored; 0: a general matrix
    long n_rows_ = 0, n_columns_ = 0;
    std::vector<Eigen::Triplet<double>> entries_;
};

std::string without_suffix(const std::string& path) {
    for (const std::string suffix : {".L.mtx", ".q.mtx"})
        if (path.ends_with(suffix)) return path.substr(0, path.size() - suffix.size());
    return path;
}

std::string matrix_text(const LcpMatrix& M) {
    std::string text = "%%MatrixMarket matrix coordinate real general\n";
    text += std::to_string(M.rows()) + " " + std::to_string(M.cols()) + " " + std::to_string(M.nonZeros()) + "\n";
    for (int i = 0; i < M.outerSize(); ++i)
        for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry)
            text +=
                std::to_string(i + 1) + " " + std::to_string(entry.col() + 1) + " " + shortest(entry.value()) + "\n";
    return text;
}

std::string vector_text(const Eigen::VectorXd& q) {
    std::string text = "%%MatrixMarket matrix array real general\n" + std::to_string(q.size()) + " 1\n";
    for (const double x : q) text += shortest(x) + "\n";
    return text;
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

void write_lcp(const std::filesystem::path& stem, const LcpProblem& problem) {
    const std::filesystem::path matrix = stem.string() + ".L.mtx", vector = stem.string() + ".q.mtx";
    for (const std::filesystem::path& file : {matrix, vector})
        if (std::filesystem::exists(file)) throw UserError("file-exists", "`" + file.string() + "` exists already");
    write_whole_file(matrix, matrix_text(problem.M));
    write_whole_file(vector, vector_text(problem.q));
}

}  // namespace knap
