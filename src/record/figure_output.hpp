#pragma once
// The figures of a run, drawn at their times or, where pictures of several times share a scale, from frames at its end.
#include "figures/figures.hpp"
#include "record/frame_output.hpp"

#include <algorithm>

namespace knap {

class FigureOutput {
public:
    /// An empty directory: nothing is drawn. `histories` and `time` must outlive it.
    FigureOutput(const Model& model, std::filesystem::path directory, std::vector<FigureOptions> figures,
                 FigureContext context, const Histories& histories, OutputTime& time);

    bool need_frames() const { return std::ranges::any_of(figures_, waits_for_the_end); }
    /// A figure that is drawn at the end needs the frame of this moment.
    bool needs_frame(const State& now) const;
    void after_step(const State& now) { draw_due(now, false); }
    /// `ended_early`: figures at times that the run did not reach show its last state.
    void finish(const State& now, bool ended_early);
    /// When all frames are on disk.
    void draw_sequences(const FrameOutput& frames);

    const std::vector<std::filesystem::path>& drawn() const { return drawn_; }
    /// Compares the figures that an earlier part of the run drew with their checksums.
    void compare();
    /// Returns when all figures so far are on the disk.
    void flush();
    /// Figures that are lost, damaged, or could not be drawn: "figures/cracks.png does not exist".
    std::vector<std::string> missing_files() const;

    void serialize(auto& archive) { archive(next_at_, drawn_, sums_); }

private:
    std::filesystem::path name_of(std::size_t drawn) const { return "figures" / drawn_[drawn].filename(); }
    bool is_due(std::size_t figure, const State& now) const;
    void draw_due(const State& now, bool at_end);
    void show_last_state(double end);

    const Model& model_;
    std::filesystem::path directory_;
    std::vector<FigureOptions> figures_;
    FigureContext context_;
    const Histories& histories_;
    OutputTime& time_;
    std::vector<std::size_t> next_at_;  // per figure: number of its next time
    std::vector<std::filesystem::path> drawn_;
    std::vector<std::uint64_t> sums_;   // checksums of those that are on the disk
    std::vector<std::string> damaged_;  // of an earlier part of the run, with the fault
    std::vector<std::string> undrawn_;  // with the reason
};

}  // namespace knap
