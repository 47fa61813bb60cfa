#include "record/progress.hpp"

#include "base/formatted.hpp"
#include "base/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

/// A length or time with the unit prefix that leaves one to three digits before the point.
std::string scaled(double value, const char* unit) {
    static constexpr std::array<std::pair<double, const char*>, 5> prefixes{
        {{1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}, {1e-12, "p"}}};
    for (const auto& [scale, prefix] : prefixes)
        if (std::abs(value) >= scale) return formatted("%.3g %s%s", value / scale, prefix, unit);
    return formatted("%.3g %s", value, unit);
}

/// Cut to the width of the terminal: a line that wraps cannot be rewritten.
std::string fitted(std::string line, std::FILE* terminal) {
    winsize size{};
    if (ioctl(fileno(terminal), TIOCGWINSZ, &size) == 0 && size.ws_col > 1 && line.size() >= size.ws_col)
        line.resize(size.ws_col - 1);
    return line;
}

}  // namespace

std::string left_text(double seconds) {
    return seconds < 100    ? formatted("%.0f s left", seconds)
           : seconds < 6000 ? formatted("%.0f min left", seconds / 60)
                            : formatted("%.1f h left", seconds / 3600);
}

SearchProgress::SearchProgress(std::FILE* file) : file_(file), terminal_(file != nullptr && isatty(fileno(file))) {}

void SearchProgress::operator()(int step, double part) {
    const double wall = watch_.wall();
    if (file_ == nullptr || (!terminal_ && wall < next_wall_)) return;
    next_wall_ = std::max(2 * wall, 5.0);
    std::string text = "search for the equilibrium at the start";
    if (step > 1) text += formatted(": step %d", step);
    if (part < 1) text += formatted(", out of balance by %.0e of the loads", part);
    if (terminal_) std::fprintf(file_, "\r\033[K%s", fitted(text, file_).c_str());
    else std::fprintf(file_, "%s\n", text.c_str());
    std::fflush(file_);
}

Progress::Progress(std::FILE* file, const State& start, double end)
    : file_(file),
      terminal_(file != nullptr && isatty(fileno(file))),
      start_(start.time),
      end_(end),
      last_step_(start.n_steps) {}

std::string Progress::line(const State& now, const Recorder& recorder) const {
    const CrackPattern& cracks = recorder.cracks().pattern();
    const EnergyLedger& ledger = recorder.ledger();
    const double part = now.time / end_, wall = watch_.wall();
    std::string text = formatted("%3.0f %%  t ", 100 * part) + scaled(now.time, "s");
    if (part < 1 && now.time > start_) text += "  " + left_text(wall * (end_ - now.time) / (now.time - start_));
    text += "  main crack " + scaled(cracks.main_length, "m");
    const double speed = recorder.cracks().tip_speed() / recorder.options().context.rayleigh_speed;
    if (std::isfinite(speed)) text += formatted("  v/cR %.2f", speed);
    text += formatted("  tips %zu  branches %d  dE %.0e  %.2e triangle-steps/s", cracks.tips.size(), cracks.n_branches,
                      ledger.largest_residual() / std::max(ledger.largest_energy(), 1e-300),
                      static_cast<double>(triangle_steps_) / std::max(wall, 1e-9));
    return text;
}

void Progress::after_step(const State& now, const Recorder& recorder, Index n_triangles) {
    triangle_steps_ += (now.n_steps - std::exchange(last_step_, now.n_steps)) * n_triangles;
    if (file_ == nullptr) return;
    if (terminal_) {
        const double wall = watch_.wall();
        if (wall < next_wall_) return;
        next_wall_ = wall + 0.2;
        std::fprintf(file_, "\r\033[K%s", fitted(line(now, recorder), file_).c_str());
    } else {
        if (now.time < end_ * next_part_ / 20 * (1 - 1e-12)) return;
        while (next_part_ <= 20 && now.time >= end_ * next_part_ / 20 * (1 - 1e-12)) ++next_part_;
        std::fprintf(file_, "%s\n", line(now, recorder).c_str());
    }
    std::fflush(file_);
}

void Progress::finish(const State& now, const Recorder& recorder) {
    if (file_ == nullptr || !terminal_) return;
    std::fprintf(file_, "\r\033[K%s\n", fitted(line(now, recorder), file_).c_str());
}

void Progress::print(const std::string& text) const {
    if (terminal_) std::fputs("\r\033[K", file_);
    print_messages(text);
}

}  // namespace knap
