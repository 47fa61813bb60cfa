#pragma once
// The frames of a run: <run>/fields/bulk_NNNN.vtu, interfaces_NNNN.vtu and (with obstacles) obstacles_NNNN.vtu, listed with their times in <run>/run.pvd.
#include "output/frame.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

class VtkSeries {
public:
    /// Makes <run>/fields. `written` [s]: times of frames that an earlier part of the run wrote; it goes on behind them. What was half written goes.
    explicit VtkSeries(std::filesystem::path run, std::vector<double> written = {});

    /// Writes the next frame and lists it: run.pvd and all files that it lists are whole at every moment, whatever interrupts the run.
    /// Throws OutputError naming the path that could not be written.
    void write(const Frame& frame);

    const std::vector<double>& times() const { return times_; }  // [s]

    /// Whether the files of this one are there.
    bool has(std::size_t frame) const;

    /// Files of these frames that are gone: "fields/bulk_0003.vtu".
    std::vector<std::string> missing(bool obstacles) const;

private:
    std::filesystem::path run_;
    std::vector<double> times_;
};

/// Times [s] of the frames of a finished or interrupted run. Throws UserError when there is no run.pvd.
std::vector<double> frame_times(const std::filesystem::path& run);

/// Frame number `index` of frame_times.
Frame read_frame(const std::filesystem::path& run, std::size_t index);

/// The number of the frame nearest to `time` [s]; `times` is not empty.
std::size_t nearest_frame(const std::vector<double>& times, double time);

}  // namespace knap
