#include "app/bench_machine.hpp"

#include "base/stopwatch.hpp"

#include <Eigen/Core>

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

namespace knap {
namespace {

double memory_rate() {
    constexpr std::size_t n = 1 << 22;  // 32 MB an array
    std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
    double best = 0;
    for (int trial = 0; trial < 6; ++trial) {
        const Stopwatch watch;
        const double s = 1 + trial;
        for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + s * c[i];
        best = std::max(best, 24.0 * n / watch.cpu());
        b[trial] = a[n - 1 - trial];  // nothing can be left out
    }
    return best;
}

double flop_rate() {
    using Pair = Eigen::Array2d;
    constexpr int n_chains = 12;  // as many as the registers hold; fewer would wait for each other
    double best = 0, sum = 0;
    for (int trial = 0; trial < 6; ++trial) {
        Pair x[n_chains];
        for (int i = 0; i < n_chains; ++i) x[i] = Pair(i, trial);
        const Pair factor = Pair::Constant(0.5 + 1e-3 * trial), added = Pair::Constant(0.25);
        constexpr int n = 2000000;
        const Stopwatch watch;
        for (int k = 0; k < n; ++k) {
#pragma GCC unroll 12  // else they are not in registers
            for (int i = 0; i < n_chains; ++i) x[i] = factor * x[i] + added;
        }
        best = std::max(best, 2.0 * 2 * n_chains * n / watch.cpu());
        for (const Pair& chain : x) sum += chain.sum();
    }
    return sum > 0 ? best : 0;
}

/// [s] The best mean of some turns that two threads take; both are there already.
double time_of_turns(std::atomic<int>& turn) {
    constexpr int n_turns = 1000;
    turn.store(-2);
    double best = std::numeric_limits<double>::infinity();
#pragma omp parallel num_threads(2)
    if (omp_get_num_threads() == 2) {
        const int mine = omp_get_thread_num();
        turn.fetch_add(1);
        while (turn.load() < 0) {}  // the other one has come
        const double begin = omp_get_wtime();
        for (int i = mine; i < n_turns; i += 2) {
            while (turn.load() != i) {}
            turn.store(i + 1);
        }
        if (mine == 0) best = (omp_get_wtime() - begin) / n_turns;
    }
    return best;
}

}  // namespace

double handover_time() {
    if (omp_get_num_procs() < 2) return std::numeric_limits<double>::quiet_NaN();
    alignas(64) static std::atomic<int> turn;
    double best = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < 50; ++trial) best = std::min(best, time_of_turns(turn));
    return std::isfinite(best) ? best : std::numeric_limits<double>::quiet_NaN();  // no second thread came
}

Machine measure_machine() { return {.bytes = memory_rate(), .flops = flop_rate()}; }

}  // namespace knap
