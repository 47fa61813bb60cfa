#pragma once
// Matrix Market text files (Boisvert, Pozo, Remington, NISTIR 5935): real or integer, coordinate or array, general,
// symmetric or skew-symmetric. A stored problem is a pair of them, NAME.L.mtx and NAME.q.mtx.
#include "lcp/problem.hpp"

#include <filesystem>
#include <istream>

namespace knap {

/// `source` names the text in messages. Throws UserError with the line where the text is not such a file.
LcpMatrix read_matrix_market(std::istream& text, const std::string& source);

/// `stem` is the path without .L.mtx and .q.mtx; either of the two files may be given as well.
LcpProblem read_lcp(const std::filesystem::path& stem);

/// Writes stem.L.mtx and stem.q.mtx with the shortest numbers that read back to the same bits. Throws UserError where
/// one of the files exists already, nothing is overwritten, and OutputError where one cannot be written.
void write_lcp(const std::filesystem::path& stem, const LcpProblem& problem);

}  // namespace knap
