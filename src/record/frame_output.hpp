#pragma once
// The frames of a run, which a thread of their own writes.
#include "output/frame_writer.hpp"
#include "output/vtk_series.hpp"
#include "record/output_time.hpp"

#include <optional>

namespace knap {

class FrameOutput {
public:
    /// `every` [s]; 0: only frames of figures. `time` must outlive it.
    FrameOutput(const Model& model, std::filesystem::path directory, double every, Compression compression,
                OutputTime& time)
        : model_(model),
          directory_(std::move(directory)),
          every_(every),
          compression_(compression),
          clock_(every),
          time_(time) {}

    bool has_times() const { return every_ > 0; }
    bool is_open() const { return writer_.has_value(); }
    void open();
    void start(const State& start);
    /// `of_figure`: a figure needs this moment.
    void after_step(const State& now, bool of_figure);
    /// The last frame.
    void finish(const State& now, bool ended_early);
    /// Returns when all frames so far are written; wait(): while the steps do.
    void complete();
    void wait();
    /// Returns when a loss of power takes none of the frames written so far.
    void flush();

    const std::vector<double>& times() const { return times_; }  // [s]
    bool has(std::size_t k) const { return series_->has(k); }    // it is whole
    std::vector<std::string> missing_files() const;
    double uncounted() const { return writer_ ? writer_->cpu() - counted_ : 0; }  // [s] of the writer, not yet in time

    void serialize(auto& archive) { archive(clock_, times_, sums_); }

private:
    void write(const State& now);

    const Model& model_;
    std::filesystem::path directory_;
    double every_;
    Compression compression_;
    Every clock_;
    OutputTime& time_;
    std::vector<double> times_;
    std::vector<VtkSeries::Sums> sums_;  // of the frames that are complete
    double counted_ = 0;                 // [s] processor time of the writer that time_ contains
    std::optional<VtkSeries> series_;
    std::optional<FrameWriter> writer_;  // destroyed first: its thread uses the other members
};

}  // namespace knap
