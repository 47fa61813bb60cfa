#pragma once
// In place of src/record/figure_output.hpp: nothing is drawn.
#include "figures/figures.hpp"
#include "record/frame_output.hpp"

namespace knap {

struct FigureOutput {
    FigureOutput(const Model&, const std::filesystem::path&, const std::vector<FigureOptions>&, const FigureContext&,
                 const Histories&, OutputTime&) {}
    bool need_frames() const { return false; }
    bool needs_frame(const State&) const { return false; }
    void after_step(const State&) {}
    void finish(const State&, bool) {}
    void draw_sequences(const FrameOutput&) {}
    const std::vector<std::filesystem::path>& drawn() const { return drawn_; }
    void compare() {}
    void flush() {}
    std::vector<std::string> missing_files() const { return {}; }

private:
    std::vector<std::filesystem::path> drawn_;
};

}  // namespace knap
