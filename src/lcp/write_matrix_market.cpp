#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "lcp/matrix_market.hpp"

#include <array>
#include <charconv>

namespace knap {
namespace {

std::string digits(double x) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x).ptr};
}

std::string matrix_text(const LcpMatrix& M) {
    std::string text = "%%MatrixMarket matrix coordinate real general\n";
    text += std::to_string(M.rows()) + " " + std::to_string(M.cols()) + " " + std::to_string(M.nonZeros()) + "\n";
    for (int i = 0; i < M.outerSize(); ++i)
        for (LcpMatrix::InnerIterator entry(M, i); entry; ++entry)
            text += std::to_string(i + 1) + " " + std::to_string(entry.col() + 1) + " " + digits(entry.value()) + "\n";
    return text;
}

std::string vector_text(const Eigen::VectorXd& q) {
    std::string text = "%%MatrixMarket matrix array real general\n" + std::to_string(q.size()) + " 1\n";
    for (const double x : q) text += digits(x) + "\n";
    return text;
}

}  // namespace

void write_lcp(const std::filesystem::path& stem, const LcpProblem& problem) {
    const std::filesystem::path matrix = stem.string() + ".L.mtx", vector = stem.string() + ".q.mtx";
    for (const std::filesystem::path& file : {matrix, vector})
        if (std::filesystem::exists(file)) throw UserError("file-exists", "`" + file.string() + "` exists already");
    write_whole_file(matrix, matrix_text(problem.M));
    write_whole_file(vector, vector_text(problem.q));
}

}  // namespace knap
