#pragma once
// A figure at several frames of a run directory.
#include "figures/figures.hpp"

#include <filesystem>
#include <map>
#include <vector>

namespace knap {

/// The frames of a run directory. The first small ones stay in memory, since a figure needs each twice, and several
/// figures show the same.
class FrameReader {
public:
    explicit FrameReader(std::filesystem::path run) : run_(std::move(run)) {}
    const std::filesystem::path& run() const { return run_; }
    /// Valid until the next call. Throws UserError where its file is missing or damaged.
    const Frame& frame(std::size_t number);

private:
    static constexpr std::size_t most = 400'000;  // corners, 25 MB
    std::filesystem::path run_;
    std::map<std::size_t, Frame> kept_;
    std::size_t n_kept_ = 0;  // corners
    Frame other_;
};

/// Draws a figure at several frames with their common scale into `directory` and returns the files: of an animation
/// one, with the frames as its pictures; none without frames.
std::vector<std::filesystem::path> draw_sequence(const FigureOptions& options, FrameReader& reader,
                                                 const std::vector<std::size_t>& frames, const Histories& histories,
                                                 const FigureContext& context, const std::filesystem::path& directory);

}  // namespace knap
