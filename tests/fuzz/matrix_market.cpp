// Any text as a Matrix Market file.
#include "target.hpp"

#include "base/error.hpp"
#include "lcp/matrix_market.hpp"

#include <cmath>
#include <sstream>

using namespace knap;
using tests::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::istringstream text(tests::text_of(data, size));
    try {
        const LcpMatrix M = read_matrix_market(text, "input.mtx");
        for (int k = 0; k < M.outerSize(); ++k)
            for (LcpMatrix::InnerIterator entry(M, k); entry; ++entry) {
                require(entry.row() >= 0 && entry.row() < M.rows() && entry.col() >= 0 && entry.col() < M.cols(),
                        "entries lie in the matrix");
                require(std::isfinite(entry.value()), "entries are finite");
            }
    } catch (const UserError& error) {
        require(!error.diagnostics.empty(), "an error says something");
    }
    return 0;
}
