#pragma once
// Loops over fixed blocks: the blocks, and the order in which their results are added, do not depend on the number of threads.
#include <algorithm>
#include <cstddef>
#include <vector>

namespace knap {

/// Calls work(first, last, result) for blocks of [0, n) in parallel and returns the sum of the results in the order of the blocks.
/// Result needs a default value of zero and operator+=.
template <class Result, class Work>
Result sum_over_blocks(std::size_t n, std::size_t block, std::vector<Result>& partial, const Work& work) {
    const std::ptrdiff_t n_blocks = static_cast<std::ptrdiff_t>((n + block - 1) / block);
    partial.assign(n_blocks, Result{});
#pragma omp parallel for schedule(dynamic, 1) if (n_blocks > 1)
    for (std::ptrdiff_t i = 0; i < n_blocks; ++i) work(i * block, std::min(n, (i + 1) * block), partial[i]);
    Result total{};
    for (const Result& part : partial) total += part;
    return total;
}

}  // namespace knap
