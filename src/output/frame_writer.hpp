#pragma once
// Writes frames in another thread while the steps go on. A step waits only for a copy of the state: of the block with
// 37 768 triangles 1 ms, where making a Frame takes 4 ms and writing it 10 ms. One state is written while at most one
// waits; a caller with a third one is held up until it can wait, so a slow disk costs time and no memory. Where the
// system has no memory for a further thread, the caller writes the states itself (std::launch::deferred).
#include "base/stopwatch.hpp"
#include "model/state.hpp"

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <utility>

namespace knap {

class FrameWriter {
public:
    /// `write` is called for one state after the other. After an exception in it no state is written any more, and all
    /// functions below throw that exception. The destructor waits until all is written.
    explicit FrameWriter(std::function<void(const State&)> write) : write_(std::move(write)) {}

    void add(const State& now) {
        check();
        if (writing_.valid()) writing_.get();
        writing_ = waiting_;
        const auto task = [this, state = std::make_shared<const State>(now), before = waiting_]() mutable {
            // waits for the state before, passes its exception on, and releases it
            if (before.valid()) std::exchange(before, {}).get();
            const double start = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID);
            write_(*state);
            cpu_ += Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        };
        waiting_ = std::async(std::launch::async | std::launch::deferred, task);
    }

    /// Returns when all is written.
    void finish() {
        if (waiting_.valid()) waiting_.get();
    }

    /// Throws if a state could not be written; does not wait.
    void check() const {
        for (const auto& state : {writing_, waiting_})
            if (state.valid() && state.wait_for(std::chrono::seconds(0)) == std::future_status::ready) state.get();
    }

    double cpu() const { return cpu_; }  // [s] processor time for the states written so far

private:
    std::function<void(const State&)> write_;
    std::atomic<double> cpu_ = 0;
    std::shared_future<void> writing_, waiting_;  // destroyed first: their tasks use the other members
};

}  // namespace knap
