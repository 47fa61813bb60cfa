#include "output/frame_writer.hpp"

#include "base/stopwatch.hpp"

#include <pthread.h>

namespace knap {

FrameWriter::FrameWriter(std::function<void(const State&)> write) : write_(std::move(write)), thread_([this](const std::stop_token& stop) { work(stop); }) {
    pthread_getcpuclockid(thread_.native_handle(), &clock_);
}

void FrameWriter::add(const State& now) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !is_waiting_ || error_; });
    throw_error();
    waiting_ = now;
    is_waiting_ = true;
    changed_.notify_all();
}

void FrameWriter::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return (!is_waiting_ && !is_writing_) || error_; });
    throw_error();
}

void FrameWriter::check() {
    const std::lock_guard lock(mutex_);
    throw_error();
}

void FrameWriter::throw_error() const {
    if (error_) std::rethrow_exception(error_);
}

double FrameWriter::cpu() const { return Stopwatch::seconds(clock_); }

void FrameWriter::work(const std::stop_token& stop) {
    State now;
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [&] { return is_waiting_; }) && !error_) {
        std::swap(now, waiting_);
        is_waiting_ = false, is_writing_ = true;
        changed_.notify_all();
        lock.unlock();
        std::exception_ptr error;
        try {
            write_(now);
        } catch (...) {
            error = std::current_exception();
        }
        lock.lock();
        is_writing_ = false, error_ = error;
        changed_.notify_all();
    }
}

}  // namespace knap
