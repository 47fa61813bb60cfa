#include "record/recorder.hpp"

#include "analysis/fragments.hpp"
#include "analysis/interface_graph.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "figures/canvas.hpp"
#include "output/history_csv.hpp"
#include "record/outputs.hpp"
#include "record/sequence.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

namespace knap {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// of the explicit bulk, at least: a look takes a part of a step, a search for overlap some steps
constexpr std::int64_t steps_between_looks = 32, steps_between_searches = 256;

void write_sheet(const History& history, const std::filesystem::path& path) {
    write_csv(history, header_of(path.filename().string(), history.columns), path);
}

/// The file with all lines so far, open for the next ones.
std::ofstream opened(const std::filesystem::path& path, const History& history) {
    write_sheet(history, path);
    return std::ofstream(path, std::ios::app);
}

void add_line(const std::vector<double>& row, History& history, std::ofstream& file, const std::filesystem::path& path) {
    history.rows.push_back(row);
    if (!file.is_open()) return;
    file << csv_line(row) << "\n" << std::flush;
    if (!file) throw OutputError("cannot write " + path.string() + ": " + std::strerror(errno));
}

}  // namespace

Recorder::Recorder(const Model& model, const State& start, RecorderOptions options)
    : model_(model),
      options_(std::move(options)),
      ledger_(model, start, options_.mass, options_.weakest_point),
      deformation_(model),
      gates_(options_.critical_opening, diagonal(model.mesh.vertices), options_.allowed_limits),
      cracks_(interface_graph(model), options_.cracks),
      reactions_(model),
      probes_(model, options_.probes) {
    histories_.energy.columns = names_of(energy_columns());
    histories_.cracks.columns = names_of(crack_columns());
    if (!reactions_.empty()) histories_.reactions.columns = reactions_.columns();
    if (!probes_.empty()) histories_.probes.columns = probes_.columns();
    if (options_.breaks || options_.specimen) {
        breaks_.emplace(model, start);
        histories_.breaks.columns = names_of(break_columns());
    }
    if (options_.specimen) {
        specimen_.emplace(model, reactions_, *options_.specimen);
        specimen_->begin(start);
        histories_.stress_strain.columns = names_of<SpecimenMoment>(stress_strain_columns(*options_.specimen));
    }
    next_at_.assign(options_.figures.size(), 0);
    gates_.judge(ledger_, deformation_);
    if (options_.goes_on) return;
    open_files();
    write_lines(start);
    next_history_ = start.time + options_.history_every;
    const bool fields = writer_ && options_.frame_every > 0;
    if (fields) write_frame(start);
    next_frame_ = fields ? start.time + options_.frame_every : never;
}

/// Adds the processor time of its block to that of output, and of one part of it. All of that is done by the thread that steps, and its time is asked for: that
/// of the program has what is written beside in it, and what other threads of the steps did a moment ago.
class Recorder::Timed {
public:
    explicit Timed(Recorder& recorder, double* part = nullptr) : recorder_(recorder), part_(part) {}
    ~Timed() {
        const double seconds = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID) - begin_;
        recorder_.output_seconds_ += seconds;
        if (part_ != nullptr) *part_ += seconds;
    }
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;

private:
    Recorder& recorder_;
    double* part_;
    double begin_ = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID);
};

void Recorder::open_files() {
    if (options_.directory.empty()) return;
    const Timed timed(*this);
    energy_file_ = opened(options_.directory / "energy.csv", histories_.energy);
    crack_file_ = opened(options_.directory / "cracks.csv", histories_.cracks);
    if (!reactions_.empty()) reaction_file_ = opened(options_.directory / "reactions.csv", histories_.reactions);
    if (!probes_.empty()) probe_file_ = opened(options_.directory / "probes.csv", histories_.probes);
    if (breaks_) break_file_ = opened(options_.directory / "breaks.csv", histories_.breaks);
    if (specimen_) stress_strain_file_ = opened(options_.directory / "stress_strain.csv", histories_.stress_strain);
    if (options_.frame_every <= 0 && std::none_of(options_.figures.begin(), options_.figures.end(), waits_for_the_end)) return;
    series_.emplace(options_.directory, frame_times_);
    writer_.emplace([this](const State& then) { series_->write(make_frame(model_, then, false)); });
}

void Recorder::write_frame(const State& now) {
    const Timed timed(*this, &frame_seconds_);
    const Stopwatch watch;
    writer_->add(now);
    frame_times_.push_back(now.time);
    frame_wait_ += watch.wall();
}

void Recorder::finish_frames() {
    const Stopwatch watch;
    end_frames();
    frame_wait_ += watch.wall();
}

void Recorder::end_frames() {
    if (!writer_) return;
    writer_->finish();
    const double beside = uncounted();
    output_seconds_ += beside, frame_seconds_ += beside, counted_ += beside;
}

void Recorder::after_step(const State& now, const StepReport& report) {
    ledger_.add(now, report);
    watch_deformation(now, report.largest_speed);
    gates_.judge(ledger_, deformation_);
    if (writer_) writer_->check();
    const double reached = now.time * (1 + 1e-12);
    if (specimen_ || breaks_) watch_step(now);
    if (reached >= next_history_) {
        write_lines(now);
        next_history_ = options_.history_every * (std::floor(reached / options_.history_every) + 1);
    }
    bool kept = reached >= next_frame_;
    for (std::size_t i = 0; i < options_.figures.size() && writer_; ++i) kept = kept || (is_due(i, now) && waits_for_the_end(options_.figures[i]));
    if (kept) write_frame(now);
    if (reached >= next_frame_) {
        next_frame_ = options_.frame_every * (std::floor(reached / options_.frame_every) + 1);
    }
    draw_due(now, false);
}

/// When the fastest could have gone far enough since the last time, whatever the end of the run; at frames; and at the end. A path that is no number is far enough.
void Recorder::watch_deformation(const State& now, double speed) {
    const double reached = now.time * (1 + 1e-12), path = now.last_step * speed;
    const bool always = reached >= next_frame_ || (options_.end > 0 && reached >= options_.end), explicit_bulk = now.rate.empty();
    const auto is_due = [&](Watch& watch, double far, std::int64_t n_steps) {
        watch.path += path;
        return always || (!(watch.path < far) && now.n_steps >= watch.step + (explicit_bulk ? n_steps : 1));
    };
    const bool look = is_due(look_, deformation_.look_path(), steps_between_looks), search = is_due(search_, deformation_.search_path(), steps_between_searches);
    if (!look && !search) return;
    const Timed timed(*this);
    if (look) deformation_.look_at(now), look_ = {0, now.n_steps};
    if (search) deformation_.look_for_overlap(now), search_ = {0, now.n_steps};
}

/// What must not miss a step between two lines.
void Recorder::watch_step(const State& now) {
    const Timed timed(*this);
    if (specimen_) specimen_->after_step(now);
    if (!breaks_) return;
    for (const std::vector<double>& row : breaks_->found(now)) add_line(row, histories_.breaks, break_file_, options_.directory / "breaks.csv");
}

void Recorder::finish(const State& now, bool failed) {
    if (now.n_steps > look_.step) {
        const Timed timed(*this);
        deformation_.look_at(now), look_ = {0, now.n_steps};
    }
    gates_.judge(ledger_, deformation_, true);
    if (last_line_ < now.time) write_lines(now);
    if (writer_ && (options_.frame_every > 0 || failed) && frame_times_.back() < now.time) write_frame(now);
    write_fragments(now);
    write_arms();
    write_lost_sheets();
    if (failed) show_last_state(now.time);
    draw_due(now, true);
    end_frames();
    draw_sequences();
}

/// The end stands for all times of figures that were not reached.
void Recorder::show_last_state(double end) {
    for (FigureOptions& figure : options_.figures) {
        std::vector<double>& at = figure.at;
        if (at.empty() || at.back() <= end) continue;
        const std::size_t least = std::min<std::size_t>(at.size(), 2);  // pictures of several times are named by them
        std::erase_if(at, [&](double time) { return time > end; });
        if (at.empty() || at.back() < end) at.push_back(end);
        while (at.size() < least) at.push_back(end);
    }
}

void Recorder::write_fragments(const State& now) {
    const Timed timed(*this);
    histories_.fragments = fragment_table(find_fragments(model_, now));
    if (!options_.directory.empty()) write_sheet(histories_.fragments, options_.directory / "fragments.csv");
}

/// The arms as they are known in the end: an arm counts when it is long, but grew from its first edge on, and so do the lengths and the main tip in cracks.csv.
void Recorder::write_arms() {
    if (cracks_.arms().arms().empty()) return;
    const Timed timed(*this);
    const CrackHistory::Past past = cracks_.conclude();
    for (std::size_t i = 0; i < past.all.size(); ++i) {
        std::vector<double>& row = histories_.cracks.rows[i];
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        const Vec2 place = past.tip[i] ? past.tip[i]->position : Vec2(none, none);
        const double speed = past.tip[i] ? past.tip[i]->speed : none;
        row[1] = past.main[i], row[2] = std::max(row[2], past.all[i]);
        row[7] = place.x(), row[8] = place.y(), row[9] = speed, row[10] = options_.rayleigh_speed > 0 ? speed / options_.rayleigh_speed : none;
    }
    if (options_.directory.empty()) return;
    crack_file_ = opened(options_.directory / "cracks.csv", histories_.cracks);
    write_sheet(cracks_.arm_table(), options_.directory / "arms.csv");
}

/// Tables that someone took away while they were written: all lines are here.
void Recorder::write_lost_sheets() const {
    if (options_.directory.empty()) return;
    const History* const sheets[] = {&histories_.energy, &histories_.cracks, &histories_.reactions, &histories_.probes, &histories_.breaks, &histories_.stress_strain};
    const char* const names[] = {"energy.csv", "cracks.csv", "reactions.csv", "probes.csv", "breaks.csv", "stress_strain.csv"};
    std::error_code none;
    for (std::size_t i = 0; i < std::size(names); ++i)
        if (!sheets[i]->columns.empty() && !std::filesystem::exists(options_.directory / names[i], none)) write_sheet(*sheets[i], options_.directory / names[i]);
}

std::vector<std::string> Recorder::missing_files() const {
    std::vector<std::string> files = series_ ? series_->missing(!model_.obstacles.empty()) : std::vector<std::string>();
    std::error_code none;
    for (const std::filesystem::path& figure : drawn_)
        if (const std::filesystem::path file = "figures" / figure.filename(); !std::filesystem::exists(options_.directory / file, none)) files.push_back(file.string());
    return files;
}

void Recorder::write_lines(const State& now) {
    const Timed timed(*this);
    last_line_ = now.time;
    cracks_.snapshot(now.time, interface_status(model_, now));
    add_line(values_of(energy_columns(), ledger_.row()), histories_.energy, energy_file_, options_.directory / "energy.csv");
    add_line(values_of(crack_columns(), CrackMoment{now.time, cracks_, options_.rayleigh_speed}), histories_.cracks, crack_file_, options_.directory / "cracks.csv");
    if (!reactions_.empty()) add_line(reactions_.line(now), histories_.reactions, reaction_file_, options_.directory / "reactions.csv");
    if (!probes_.empty()) add_line(probes_.line(now), histories_.probes, probe_file_, options_.directory / "probes.csv");
    if (specimen_) {
        const std::vector<double> line = specimen_->line(breaks_->n_tensile(), breaks_->n_shear());
        add_line(line, histories_.stress_strain, stress_strain_file_, options_.directory / "stress_strain.csv");
    }
}

/// Whether one of its times has come.
bool Recorder::is_due(std::size_t i, const State& now) const {
    const std::vector<double>& at = options_.figures[i].at;
    return next_at_[i] < at.size() && now.time * (1 + 1e-9) >= at[next_at_[i]];
}

void Recorder::draw_due(const State& now, bool at_end) {
    if (options_.directory.empty()) return;
    std::optional<Frame> frame;
    for (std::size_t i = 0; i < options_.figures.size(); ++i) {
        const FigureOptions& figure = options_.figures[i];
        const bool reached = is_due(i, now);
        if (!reached && !at_end) continue;
        const bool due = figure.at.empty() || !shows_body(figure.show) ? at_end : reached;
        if (due && !waits_for_the_end(figure)) {
            const Timed timed(*this, &figure_seconds_);
            if (!frame) frame = make_frame(model_, now, false);
            drawn_.push_back(draw_figure(figure, *frame, histories_, figure_context(), options_.directory / "figures").file);
        }
        while (is_due(i, now)) ++next_at_[i];
    }
}

/// Figures of several times: only now it is known what their pictures have in common. Frames that someone has taken away are missed elsewhere.
void Recorder::draw_sequences() {
    const Timed timed(*this, &figure_seconds_);
    for (const FigureOptions& figure : options_.figures) {
        if (!writer_ || !waits_for_the_end(figure)) continue;
        FrameList list{.run = options_.directory};
        for (const double time : figure.at) {
            const auto k = static_cast<std::size_t>(std::lower_bound(frame_times_.begin(), frame_times_.end(), time * (1 - 1e-9)) - frame_times_.begin());
            if (k < frame_times_.size() && series_->has(k) && (list.frames.empty() || list.frames.back() != k)) list.frames.push_back(k);
        }
        const FigureScale common = scale_of(figure, list, histories_, figure_context());
        for (const auto& file : draw_frames(figure, list, histories_, figure_context(), options_.directory / "figures", common)) drawn_.push_back(file);
    }
}

FigureContext Recorder::figure_context() const { return {.title = options_.title, .rayleigh_speed = options_.rayleigh_speed, .materials = options_.materials}; }

}  // namespace knap
