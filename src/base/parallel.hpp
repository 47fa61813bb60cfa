#pragma once
// Loops over fixed blocks: the blocks, and the order in which their results are added, do not depend on the number of
// threads.
//
// A block should meet the same thread in every loop, since its data is in the cache of that thread, and moving it
// between processors without a common cache is expensive. So each pair of threads shares a range of blocks and works on
// it from both ends: only blocks near the meeting point change threads. A pair that has finished helps the next one.
#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace knap {

/// The blocks of a pair of threads that are not started yet.
struct alignas(64) BlockRange {
    std::atomic<std::ptrdiff_t> n_left, next_up, next_down;
};

/// Calls work(i) for i in [0, n_blocks), by several threads where there is more than one block.
template <class Work>
void for_blocks(std::ptrdiff_t n_blocks, const Work& work) {
    constexpr int max_threads = 64;
    const int n = static_cast<int>(std::min<std::ptrdiff_t>({omp_get_max_threads(), max_threads, n_blocks}));
    if (n <= 1) {
        for (std::ptrdiff_t i = 0; i < n_blocks; ++i) work(i);
        return;
    }
    const int n_pairs = (n + 1) / 2;
    std::array<BlockRange, max_threads / 2> ranges;
    for (int p = 0; p < n_pairs; ++p) {
        const std::ptrdiff_t first = n_blocks * 2 * p / n, end = n_blocks * std::min(2 * p + 2, n) / n;
        ranges[p].n_left = end - first, ranges[p].next_up = first, ranges[p].next_down = end - 1;
    }
#pragma omp parallel num_threads(n)
    for (int k = 0; k < n_pairs; ++k) {
        const int thread = omp_get_thread_num();
        BlockRange& range = ranges[(thread / 2 + k) % n_pairs];
        while (range.n_left.fetch_sub(1, std::memory_order_relaxed) > 0)
            work(thread % 2 == 0 ? range.next_up.fetch_add(1, std::memory_order_relaxed)
                                 : range.next_down.fetch_sub(1, std::memory_order_relaxed));
    }
}

/// Loops take one thread while it lives, if `small`: those of little work wait for the others longer than they work.
class OneThread {
public:
    explicit OneThread(bool small) : n_(omp_get_max_threads()) {
        if (small) omp_set_num_threads(1);
    }
    OneThread(const OneThread&) = delete;
    OneThread& operator=(const OneThread&) = delete;
    ~OneThread() { omp_set_num_threads(n_); }

private:
    int n_;
};

/// Calls work(first, last, result) for blocks of [0, n) in parallel and returns the sum of the results in the order of
/// the blocks. Result needs a default value of zero and operator+=. `partial` is workspace; it never shrinks.
template <class Result, class Work>
Result sum_over_blocks(std::size_t n, std::size_t block, std::vector<Result>& partial, const Work& work) {
    const auto n_blocks = static_cast<std::ptrdiff_t>((n + block - 1) / block);
    if (std::ssize(partial) < n_blocks) partial.resize(n_blocks);
    for_blocks(n_blocks, [&](std::ptrdiff_t i) {
        Result own{};  // written to the list once, since its neighbours there belong to other threads
        work(i * block, std::min(n, (i + 1) * block), own);
        partial[i] = own;
    });
    Result total{};
    for (std::ptrdiff_t i = 0; i < n_blocks; ++i) total += partial[i];
    return total;
}

}  // namespace knap
