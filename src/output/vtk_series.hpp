#pragma once
// The frames of a run as VTK files: <run>/fields/bulk_NNNN.vtu (triangles; a point for each node),
// interfaces_NNNN.vtu (line cells) and, with obstacles, obstacles_NNNN.vtu (polygons), listed with their times in
// <run>/run.pvd. Intact interfaces inside the body are not written (they would double the size of a run): they are
// closed, and their traction follows from the stress on either side. A frame that is read back lacks them; no figure
// needs them. Positions are float64, other fields float32.
#include "output/frame.hpp"
#include "output/outputs.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace knap {

/// The arrays of the three files, by name of the file.
const std::vector<OutputTable>& frame_outputs();

/// Of the arrays of a frame. A frame of 1 480 triangles with cracks takes 0.8, 1.3 and 6.6 ms and 307, 175 and 127 kB;
/// meshio reads no LZ4.
enum class Compression { none, lz4, zlib };

class VtkSeries {
public:
    /// Checksums of the files of a frame.
    using Sums = std::array<std::uint64_t, 3>;

    /// Makes <run>/fields and removes incomplete files there. `written` [s]: times of the frames that an earlier part
    /// of the run wrote, with their `sums`, with which their files are compared; new frames follow them.
    explicit VtkSeries(std::filesystem::path run, std::vector<double> written = {}, std::vector<Sums> sums = {},
                       Compression compression = Compression::none);

    /// Writes the next frame and lists it. Whatever interrupts the run, run.pvd and all files that it lists are
    /// complete. Throws OutputError naming the path that could not be written.
    void write(const Frame& frame);
    /// Writes run.pvd anew, where there are frames.
    void list(bool obstacles) const;
    /// Returns when all frames so far are on the disk, and a loss of power takes none of them. Throws OutputError.
    void flush();

    const std::vector<double>& times() const { return times_; }  // [s]
    const std::vector<Sums>& sums() const { return sums_; }

    /// Whether the bulk and interfaces of this frame are whole.
    bool has(std::size_t frame) const;

    /// Files of these frames that are lost or damaged: "fields/bulk_0003.vtu is empty".
    std::vector<std::string> missing(bool obstacles) const;

private:
    std::string fault_of_file(const std::string& name) const;

    std::filesystem::path run_;
    std::vector<double> times_;
    std::vector<Sums> sums_;
    Compression compression_;
    std::map<std::string, std::string> faults_;  // of files that an earlier part of the run wrote, by name
    std::size_t n_flushed_ = times_.size();      // a checkpoint that counts frames has flushed them
};

/// Times [s] of the frames of a finished or interrupted run. Throws UserError when there is no run.pvd.
std::vector<double> frame_times(const std::filesystem::path& run);

/// Frame number `index` of frame_times. Throws UserError naming the file that is missing or damaged.
Frame read_frame(const std::filesystem::path& run, std::size_t index);

/// The number of the frame nearest to `time` [s]; `times` is not empty.
std::size_t nearest_frame(const std::vector<double>& times, double time);

}  // namespace knap
