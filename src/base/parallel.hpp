#pragma once
// Loops over fixed blocks: the blocks, and the order in which their results are added, do not depend on the number of threads.
//
// Every thread has a range of blocks of its own, the same ones in every loop over as many, so that what it wrote is in its cache when it reads it again: where
// two processors share no cache, blocks that go to whoever comes first make two threads slower than one. Who is through helps the others.
#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace knap {

/// The blocks of one thread that nobody has taken yet.
struct alignas(64) BlockRange {
    std::atomic<std::ptrdiff_t> next;
    std::ptrdiff_t end;
};

/// Calls work(i) for i in [0, n_blocks), by several threads where there is more than one block.
template <class Work>
void for_blocks(std::ptrdiff_t n_blocks, const Work& work) {
    constexpr int most_threads = 64;
    const int n = static_cast<int>(std::min<std::ptrdiff_t>({omp_get_max_threads(), most_threads, n_blocks}));
    if (n <= 1) {
        for (std::ptrdiff_t i = 0; i < n_blocks; ++i) work(i);
        return;
    }
    std::array<BlockRange, most_threads> ranges;
    for (int t = 0; t < n; ++t) ranges[t].next = n_blocks * t / n, ranges[t].end = n_blocks * (t + 1) / n;
#pragma omp parallel
    for (int k = 0; k < n; ++k) {
        BlockRange& range = ranges[(omp_get_thread_num() + k) % n];
        for (std::ptrdiff_t i; (i = range.next.fetch_add(1, std::memory_order_relaxed)) < range.end;) work(i);
    }
}

/// Calls work(first, last, result) for blocks of [0, n) in parallel and returns the sum of the results in the order of the blocks.
/// Result needs a default value of zero and operator+=.
template <class Result, class Work>
Result sum_over_blocks(std::size_t n, std::size_t block, std::vector<Result>& partial, const Work& work) {
    const std::ptrdiff_t n_blocks = static_cast<std::ptrdiff_t>((n + block - 1) / block);
    partial.assign(n_blocks, Result{});
    for_blocks(n_blocks, [&](std::ptrdiff_t i) { work(i * block, std::min(n, (i + 1) * block), partial[i]); });
    Result total{};
    for (const Result& part : partial) total += part;
    return total;
}

}  // namespace knap
