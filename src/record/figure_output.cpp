#include "record/figure_output.hpp"

#include "base/checksum.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "figures/canvas.hpp"
#include "record/figure_sequence.hpp"

#include <algorithm>

namespace knap {

FigureOutput::FigureOutput(const Model& model, std::filesystem::path directory, std::vector<FigureOptions> figures,
                           FigureContext context, const Histories& histories, OutputTime& time)
    : model_(model),
      directory_(std::move(directory)),
      figures_(std::move(figures)),
      context_(std::move(context)),
      histories_(histories),
      time_(time),
      next_at_(figures_.size(), 0) {}

/// Whether one of its times is reached.
bool FigureOutput::is_due(std::size_t figure, const State& now) const {
    const std::vector<double>& at = figures_[figure].at;
    return next_at_[figure] < at.size() && now.time * (1 + 1e-9) >= at[next_at_[figure]];
}

bool FigureOutput::needs_frame(const State& now) const {
    for (std::size_t i = 0; i < figures_.size(); ++i)
        if (is_due(i, now) && waits_for_the_end(figures_[i])) return true;
    return false;
}

void FigureOutput::draw_due(const State& now, bool at_end) {
    if (directory_.empty()) return;
    std::optional<Frame> frame;
    for (std::size_t i = 0; i < figures_.size(); ++i) {
        const FigureOptions& figure = figures_[i];
        const bool reached = is_due(i, now);
        if (!reached && !at_end) continue;
        const bool due = figure.at.empty() || !shows_body(figure.show) ? at_end : reached;
        if (due && !waits_for_the_end(figure)) {
            const Timed timed(time_, &OutputTime::figures);
            if (!frame) frame = make_frame(model_, now, false);
            drawn_.push_back(draw_figure(figure, *frame, histories_, context_, directory_ / "figures").file);
        }
        while (is_due(i, now)) ++next_at_[i];
    }
}

void FigureOutput::finish(const State& now, bool ended_early) {
    if (ended_early) context_.early_end = now.time, show_last_state(now.time);
    draw_due(now, true);
}

/// Figures of several times share their scale, which is known only at the end. Frames that were deleted are left out
/// here and reported as missing files.
void FigureOutput::draw_sequences(const FrameOutput& frames) {
    const Timed timed(time_, &OutputTime::figures);
    FrameReader reader(directory_);
    for (const FigureOptions& figure : figures_) {
        if (!frames.is_open() || !waits_for_the_end(figure)) continue;
        std::vector<std::size_t> shown;
        for (const double time : figure.at) {
            const auto k = static_cast<std::size_t>(std::ranges::lower_bound(frames.times(), time * (1 - 1e-9)) -
                                                    frames.times().begin());
            if (k < frames.times().size() && frames.has(k) && (shown.empty() || shown.back() != k)) shown.push_back(k);
        }
        try {
            for (const auto& file : draw_sequence(figure, reader, shown, histories_, context_, directory_ / "figures"))
                drawn_.push_back(file);
        } catch (const UserError& error) {  // of a frame that looks whole
            undrawn_.push_back("figures/" + figure.file + " is not drawn: " + error.diagnostics.front().message);
        }
    }
}

/// The end replaces all times of figures that were not reached.
void FigureOutput::show_last_state(double end) {
    for (FigureOptions& figure : figures_) {
        std::vector<double>& at = figure.at;
        if (at.empty() || at.back() <= end) continue;
        const std::size_t n_min = std::min<std::size_t>(at.size(), 2);  // files of several times carry the time
        std::erase_if(at, [&](double time) { return time > end; });
        if (at.empty() || at.back() < end) at.push_back(end);
        while (at.size() < n_min) at.push_back(end);
    }
}

void FigureOutput::compare() {
    for (std::size_t i = 0; i < sums_.size(); ++i)
        if (std::error_code none; std::filesystem::exists(directory_ / name_of(i), none))
            if (const std::string fault = fault_of_bytes(directory_ / name_of(i), sums_[i]); !fault.empty())
                damaged_.push_back(name_of(i).string() + " " + fault);
}

void FigureOutput::flush() {
    for (std::error_code none; sums_.size() < drawn_.size();) {
        const std::filesystem::path file = directory_ / name_of(sums_.size());
        const bool is_there = std::filesystem::exists(file, none);
        if (is_there) flush_to_disk(file);
        sums_.push_back(is_there ? checksum(read_whole_file(file)) : 0);
    }
}

std::vector<std::string> FigureOutput::missing_files() const {
    std::vector<std::string> files = undrawn_;
    files.insert(files.end(), damaged_.begin(), damaged_.end());
    std::error_code none;
    for (std::size_t i = 0; i < drawn_.size(); ++i)
        if (!std::filesystem::exists(directory_ / name_of(i), none))
            files.push_back(name_of(i).string() + " does not exist");
    return files;
}

}  // namespace knap
