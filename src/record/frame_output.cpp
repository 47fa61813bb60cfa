#include "record/frame_output.hpp"

#include "analysis/fragments.hpp"

#include <algorithm>

namespace knap {

void FrameOutput::open() {
    series_.emplace(directory_, times_, sums_, compression_);
    series_->list(!model_.obstacles.empty());
    writer_.emplace([this](const State& then) {
        Frame frame = make_frame(model_, then, false);
        const std::vector<Index> of_triangle = fragment_of_triangles(model_, then);
        const auto n_left = std::ranges::count_if(of_triangle, [](Index fragment) { return fragment >= 0; });
        const std::size_t n_drawn = frame.region.size() / n_left;  // pieces of a triangle of second order
        for (const Index fragment : of_triangle)
            if (fragment >= 0) frame.fragment.insert(frame.fragment.end(), n_drawn, fragment);
        series_->write(frame);
    });
}

void FrameOutput::start(const State& start) {
    if (!is_open() || !has_times()) return;
    write(start);
    clock_.start(start.time);
}

void FrameOutput::after_step(const State& now, bool of_figure) {
    const bool is_due = clock_.advance_if_due(now.time);
    if (!is_open()) return;
    writer_->check();
    if (is_due || of_figure) write(now);
}

void FrameOutput::finish(const State& now, bool ended_early) {
    // without times of its own a run that ends before the time of its figures has no frame yet
    if (is_open() && (has_times() || ended_early) && (times_.empty() || times_.back() < now.time)) write(now);
}

void FrameOutput::complete() {
    if (!is_open()) return;
    writer_->finish();
    sums_ = series_->sums();
    const double seconds = uncounted();
    time_.cpu += seconds, time_.frames += seconds;
    counted_ += seconds;
}

void FrameOutput::wait() {
    const Stopwatch watch;
    complete();
    if (is_open()) time_.waited_for_frames += watch.wall();
}

void FrameOutput::flush() {
    if (is_open()) series_->flush();
}

void FrameOutput::write(const State& now) {
    const Timed timed(time_, &OutputTime::frames);
    const Stopwatch watch;
    writer_->add(now);
    times_.push_back(now.time);
    time_.waited_for_frames += watch.wall();
}

std::vector<std::string> FrameOutput::missing_files() const {
    return series_ ? series_->missing(!model_.obstacles.empty()) : std::vector<std::string>();
}

}  // namespace knap
