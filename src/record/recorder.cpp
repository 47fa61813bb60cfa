#include "record/recorder.hpp"

#include "analysis/fragments.hpp"
#include "analysis/interface_graph.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "figures/canvas.hpp"
#include "output/history_csv.hpp"
#include "record/outputs.hpp"
#include "record/run_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

namespace knap {
namespace {

constexpr double never = infinity, none = std::numeric_limits<double>::quiet_NaN();

// Explicit bulk, minimum numbers of steps: a look costs a fraction of a step, a search for overlap several steps.
constexpr std::int64_t steps_between_looks = 32, steps_between_searches = 256;

/// [J] Smallest fracture energy of an interface point; 0 where none can break.
double weakest_point(const Model& model) {
    double smallest = never;
    for (const FanPoint& point : model.fan_points)
        if (const CohesiveLaw& law = model.laws[point.law]; law.breakable() && !point.cracked && law.G_c > 0)
            smallest = std::min(smallest, law.G_c * point.area);
    return std::isinf(smallest) ? 0 : smallest;
}

}  // namespace

/// Adds the processor time of its block to that of the output and to one part of it. Only the time of the calling
/// thread counts: that of the process includes the frame writer and the other threads of the steps.
class Recorder::Timed {
public:
    explicit Timed(Recorder& recorder, double OutputTime::*part = nullptr) : time_(recorder.time_), part_(part) {}
    ~Timed() {
        const double seconds = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID) - start_;
        time_.cpu += seconds;
        if (part_ != nullptr) time_.*part_ += seconds;
    }
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;

private:
    OutputTime& time_;
    double OutputTime::*part_;
    double start_ = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID);
};

Recorder::Recorder(const Model& model, const State& start, RecorderOptions options)
    : model_(model),
      options_(std::move(options)),
      ledger_(model, start, options_.mass, weakest_point(model)),
      deformation_(model),
      gates_(options_.critical_opening, diagonal(model.mesh.vertices), options_.allowed_limits),
      cracks_(interface_graph(model), options_.cracks),
      reactions_(model),
      probes_(model, options_.probes),
      next_at_(options_.figures.size(), 0) {
    const auto add = [&](const char* file, History& history, std::vector<std::string> columns, auto line) {
        history.columns = std::move(columns);
        sheets_.push_back({file, &history, line, {}});
    };
    const std::vector<Measure<EnergyRow>> energies = energy_columns(options_.works);
    add("energy.csv", histories_.energy, names_of<EnergyRow>(energies),
        [this, energies](const State&) { return values_of<EnergyRow>(energies, ledger_.row()); });
    add("cracks.csv", histories_.cracks, names_of(crack_columns()), [this](const State& now) {
        return values_of(crack_columns(), CrackMoment{now.time, cracks_, options_.context.rayleigh_speed});
    });
    if (!reactions_.empty())
        add("reactions.csv", histories_.reactions, reactions_.columns(),
            [this](const State& now) { return reactions_.line(now); });
    if (!probes_.empty())
        add("probes.csv", histories_.probes, probes_.columns(), [this](const State& now) { return probes_.line(now); });
    if (options_.specimen) {
        specimen_.emplace(model, reactions_, *options_.specimen);
        specimen_->begin(start);
        add("stress_strain.csv", histories_.stress_strain,
            names_of<SpecimenMoment>(stress_strain_columns(*options_.specimen)),
            [this](const State&) { return specimen_->line(breaks_->n_tensile(), breaks_->n_shear()); });
    }
    add("fragment_history.csv", histories_.fragment_history, names_of(fragment_moment_columns()), nullptr);
    fragment_sheets_ = sheets_.size() - 1;
    std::vector<std::string> path_columns;
    for (const Output& column : fragment_path_columns(model.large_rotation)) path_columns.emplace_back(column.name);
    add("fragment_paths.csv", histories_.fragment_paths, std::move(path_columns), nullptr);
    if (options_.breaks || options_.specimen) {
        breaks_.emplace(model, start);
        add("breaks.csv", histories_.breaks, names_of(break_columns()), nullptr);
    }
    if (options_.rest.ends_run) rest_.emplace(model, options_.rest);
    gates_.judge(ledger_, deformation_);
    probes_.after_step(start);
    if (options_.resumes) return;
    open_files();
    write_lines(start);
    write_fragments(start);
    next_history_ = start.time + options_.history_every;
    next_fragments_ = options_.fragments_every > 0 ? start.time + options_.fragments_every : never;
    const bool fields = writer_ && options_.frame_every > 0;
    if (fields) write_frame(start);
    next_frame_ = fields ? start.time + options_.frame_every : never;
}

void Recorder::open_files() {
    if (options_.directory.empty()) return;
    const Timed timed(*this);
    for (Sheet& sheet : sheets_) open(sheet);
    if (options_.frame_every <= 0 && std::ranges::none_of(options_.figures, waits_for_the_end)) return;
    series_.emplace(options_.directory, frame_times_);
    writer_.emplace([this](const State& then) {
        Frame frame = make_frame(model_, then, false);
        const std::vector<Index> of_triangle = find_fragments(model_, then).piece_of_triangle;
        const auto n_left = std::ranges::count_if(of_triangle, [](Index fragment) { return fragment >= 0; });
        const std::size_t n_drawn = frame.region.size() / n_left;  // pieces of a triangle of second order
        for (const Index fragment : of_triangle)
            if (fragment >= 0) frame.fragment.insert(frame.fragment.end(), n_drawn, fragment);
        series_->write(frame);
    });
}

void Recorder::after_step(const State& now, const StepReport& report) {
    ledger_.add(now, report);
    if (rest_) rest_->after_step(ledger_.row());
    probes_.after_step(now);
    watch_deformation(now, report.largest_speed);
    gates_.judge(ledger_, deformation_);
    if (writer_) writer_->check();
    const double reached = now.time * (1 + 1e-12);
    if (breaks_) {  // every step: between two lines none must be missed
        const Timed timed(*this);
        if (specimen_) specimen_->after_step(now);
        for (std::vector<double>& line : breaks_->found(now)) add_line(sheets_.back(), std::move(line));
    }
    if (reached >= next_history_) {
        write_lines(now);
        next_history_ = options_.history_every * (std::floor(reached / options_.history_every) + 1);
    }
    if (reached >= next_fragments_) {
        write_fragments(now);
        next_fragments_ = options_.fragments_every * (std::floor(reached / options_.fragments_every) + 1);
    }
    bool frame = reached >= next_frame_;
    for (std::size_t i = 0; i < options_.figures.size() && writer_; ++i)
        frame = frame || (is_due(i, now) && waits_for_the_end(options_.figures[i]));
    if (frame) write_frame(now);
    if (reached >= next_frame_) next_frame_ = options_.frame_every * (std::floor(reached / options_.frame_every) + 1);
    draw_due(now, false);
}

void Recorder::model_changed() {
    cracks_.set_graph(interface_graph(model_));
    renew_observers();
}

void Recorder::renew_observers() {
    probes_.renew();
    reactions_.renew();
    deformation_.renew();
    ledger_.renew(model_, weakest_point(model_));
}

void Recorder::after_adaptation(const State& now, const Renumbering& numbers, const LeapfrogEnergies& energies) {
    ledger_.adapt(numbers, energies);
    cracks_.renumber(interface_graph(model_), numbers);
    if (breaks_) breaks_->renumber(now, numbers);
    renew_observers();
}

void Recorder::finish(const State& now, bool ended_early) {
    if (now.n_steps > look_.step) {
        const Timed timed(*this);
        deformation_.look_at(now), look_ = {0, now.n_steps};
    }
    const bool heat = options_.works.heat;
    gates_.judge_end(ledger_, deformation_, heat ? median_kinetic_part(histories_.energy) : std::nan(""));
    if (last_line_ < now.time) write_lines(now);
    if (histories_.fragment_history.rows.empty() || histories_.fragment_history.rows.back()[0] < now.time)
        write_fragments(now);
    if (writer_ && (options_.frame_every > 0 || ended_early) && frame_times_.back() < now.time) write_frame(now);
    {
        const Timed timed(*this);
        histories_.fragments = fragment_table(find_fragments(model_, now));
        write_table("fragments.csv", histories_.fragments);
        write_arms();
        for (std::error_code none; const Sheet& sheet : sheets_)  // a table that was deleted during the run
            if (!std::filesystem::exists(options_.directory / sheet.file, none))
                write_table(sheet.file.c_str(), *sheet.history);
    }
    if (ended_early) show_last_state(now.time);
    draw_due(now, true);
    if (writer_) writer_->finish(), count_frame_time();
    draw_sequences();
}

/// Looks when the fastest vertex could have moved far enough since the last look, whatever the end of the run, at
/// frames, and at the end. A path that is not a number is far enough.
void Recorder::watch_deformation(const State& now, double speed) {
    const double reached = now.time * (1 + 1e-12), path = now.last_step * speed;
    const bool always = reached >= next_frame_ || (options_.end > 0 && reached >= options_.end),
               explicit_bulk = now.rate.empty();
    const auto is_due = [&](Watch& watch, double far, std::int64_t n_steps) {
        watch.path += path;
        return always || (!(watch.path < far) && now.n_steps >= watch.step + (explicit_bulk ? n_steps : 1));
    };
    const bool look = is_due(look_, deformation_.look_path(), steps_between_looks),
               search = is_due(search_, deformation_.search_path(), steps_between_searches);
    if (!look && !search) return;
    const Timed timed(*this);
    if (look) deformation_.look_at(now), look_ = {0, now.n_steps};
    if (search) deformation_.look_for_overlap(now), search_ = {0, now.n_steps};
}

// ---- tables

void Recorder::write_table(const char* file, const History& history) const {
    if (options_.directory.empty()) return;
    write_csv(history, header_of(file, history.columns, options_.context.celsius), options_.directory / file);
}

void Recorder::open(Sheet& sheet) const {
    write_table(sheet.file.c_str(), *sheet.history);
    sheet.stream = std::ofstream(options_.directory / sheet.file, std::ios::app);
}

void Recorder::add_line(Sheet& sheet, std::vector<double> line) {
    sheet.history->rows.push_back(std::move(line));
    if (!sheet.stream.is_open()) return;
    sheet.stream << csv_line(sheet.history->rows.back()) << "\n" << std::flush;
    if (!sheet.stream)
        throw OutputError("cannot write " + (options_.directory / sheet.file).string() + ": " + std::strerror(errno));
}

void Recorder::write_lines(const State& now) {
    const Timed timed(*this);
    last_line_ = now.time;
    cracks_.snapshot(now.time, interface_status(model_, now));
    for (Sheet& sheet : sheets_)
        if (sheet.line) add_line(sheet, sheet.line(now));
}

void Recorder::write_fragments(const State& now) {
    const Timed timed(*this);
    const Fragments fragments = find_fragments(model_, now);
    const History table = fragment_table(fragments);
    add_line(sheets_[fragment_sheets_],
             values_of(fragment_moment_columns(), FragmentMoment{now.time, fragments, table}));
    for (std::vector<double>& line : fragment_path_lines(now.time, fragments, table))
        add_line(sheets_[fragment_sheets_ + 1], std::move(line));
}

/// The arms as they are known at the end: an arm counts once it is long, but it grew from its first edge on, and so did
/// the lengths and the main tip in cracks.csv.
void Recorder::write_arms() {
    if (cracks_.arms().arms().empty()) return;
    const CrackHistory::Past past = cracks_.conclude();
    for (std::size_t i = 0; i < past.all.size(); ++i) {
        std::vector<double>& row = histories_.cracks.rows[i];
        const Vec2 place = past.tip[i] ? past.tip[i]->position : Vec2(none, none);
        const double speed = past.tip[i] ? past.tip[i]->speed : none, c_R = options_.context.rayleigh_speed;
        row[1] = past.main[i], row[2] = std::max(row[2], past.all[i]);
        row[7] = place.x(), row[8] = place.y(), row[9] = speed, row[10] = c_R > 0 ? speed / c_R : none;
    }
    write_table("cracks.csv", histories_.cracks);
    write_table("arms.csv", cracks_.arm_table());
}

// ---- frames

void Recorder::write_frame(const State& now) {
    const Timed timed(*this, &OutputTime::frames);
    const Stopwatch watch;
    writer_->add(now);
    frame_times_.push_back(now.time);
    time_.waited_for_frames += watch.wall();
}

void Recorder::finish_frames() {
    if (!writer_) return;
    const Stopwatch watch;
    writer_->finish();
    count_frame_time();
    time_.waited_for_frames += watch.wall();
}

OutputTime Recorder::time() const {
    OutputTime time = time_;
    if (writer_) time.cpu += writer_->cpu() - counted_, time.frames += writer_->cpu() - counted_;
    return time;
}

void Recorder::count_frame_time() { time_ = time(), counted_ = writer_->cpu(); }

std::vector<std::string> Recorder::missing_files() const {
    std::vector<std::string> files = series_ ? series_->missing(!model_.obstacles.empty()) : std::vector<std::string>();
    for (std::error_code none; const std::filesystem::path& figure : drawn_)
        if (const std::filesystem::path file = "figures" / figure.filename();
            !std::filesystem::exists(options_.directory / file, none))
            files.push_back(file.string());
    return files;
}

// ---- figures

/// Whether one of its times is reached.
bool Recorder::is_due(std::size_t figure, const State& now) const {
    const std::vector<double>& at = options_.figures[figure].at;
    return next_at_[figure] < at.size() && now.time * (1 + 1e-9) >= at[next_at_[figure]];
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
            const Timed timed(*this, &OutputTime::figures);
            if (!frame) frame = make_frame(model_, now, false);
            drawn_.push_back(
                draw_figure(figure, *frame, histories_, options_.context, options_.directory / "figures").file);
        }
        while (is_due(i, now)) ++next_at_[i];
    }
}

/// Figures of several times share their scale, which is known only at the end. Frames that were deleted are left out
/// here and reported as missing files.
void Recorder::draw_sequences() {
    const Timed timed(*this, &OutputTime::figures);
    for (const FigureOptions& figure : options_.figures) {
        if (!writer_ || !waits_for_the_end(figure)) continue;
        std::vector<std::size_t> frames;
        for (const double time : figure.at) {
            const auto k = static_cast<std::size_t>(std::ranges::lower_bound(frame_times_, time * (1 - 1e-9)) -
                                                    frame_times_.begin());
            if (k < frame_times_.size() && series_->has(k) && (frames.empty() || frames.back() != k))
                frames.push_back(k);
        }
        for (const auto& file : draw_sequence(figure, options_.directory, frames, histories_, options_.context,
                                              options_.directory / "figures"))
            drawn_.push_back(file);
    }
}

/// The end replaces all times of figures that were not reached.
void Recorder::show_last_state(double end) {
    for (FigureOptions& figure : options_.figures) {
        std::vector<double>& at = figure.at;
        if (at.empty() || at.back() <= end) continue;
        const std::size_t n_min = std::min<std::size_t>(at.size(), 2);  // files of several times carry the time
        std::erase_if(at, [&](double time) { return time > end; });
        if (at.empty() || at.back() < end) at.push_back(end);
        while (at.size() < n_min) at.push_back(end);
    }
}

}  // namespace knap
