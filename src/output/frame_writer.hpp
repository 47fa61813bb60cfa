#pragma once
// Writes frames beside the steps, by a thread of its own. A step waits for a copy of the state only: of the block with 37 768 triangles 0.1 ms, where gathering a
// Frame from it takes 4 and writing that 10. One state is written while at most one waits; whoever comes with a third is held until there is room, so a
// slow disk costs time and no memory.
#include "model/state.hpp"

#include <condition_variable>
#include <ctime>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace knap {

class FrameWriter {
public:
    /// `write` is called by the thread for one state after the other. After the first that it throws no other is written, and every call here throws it.
    explicit FrameWriter(std::function<void(const State&)> write);
    /// Ends when all is written.
    ~FrameWriter() = default;
    FrameWriter(const FrameWriter&) = delete;
    FrameWriter& operator=(const FrameWriter&) = delete;

    void add(const State& now);
    /// Comes back when all is written.
    void finish();
    /// Throws if something could not be written; does not wait.
    void check();

    double cpu() const;  // [s] processor time of the thread so far

private:
    void work(const std::stop_token& stop);
    void throw_error() const;

    const std::function<void(const State&)> write_;
    std::mutex mutex_;                     // of what follows
    std::condition_variable_any changed_;  // and when it does
    State waiting_;
    bool is_waiting_ = false, is_writing_ = false;
    std::exception_ptr error_;
    clockid_t clock_{};    // of the processor time of the thread
    std::jthread thread_;  // the first to go: it works with the others
};

}  // namespace knap
