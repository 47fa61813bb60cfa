#include "record/recorder.hpp"

#include "analysis/fragments.hpp"
#include "analysis/free_motion.hpp"
#include "analysis/interface_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Explicit bulk, minimum numbers of steps: a look costs a fraction of a step, a search for overlap several steps.
constexpr double counted_turn = 0.7;  // [rad] a quarter of a turn hides none, and a step has at most half of it
constexpr std::int64_t steps_between_looks = 32, steps_between_searches = 256;

}  // namespace

Recorder::Recorder(const Model& model, const State& start, RecorderOptions options)
    : model_(model),
      options_(std::move(options)),
      ledger_(model, start, options_.mass, weakest_point(model)),
      deformation_(model),
      gates_(options_.critical_opening, diagonal(model.mesh.vertices), options_.allowed_limits),
      cracks_(interface_graph(model), options_.cracks),
      statuses_(model),
      reactions_(model),
      fluids_(model),
      probes_(model, options_.probes),
      collectors_(model, start, options_.collectors),
      tables_(options_.directory, options_.context.celsius),
      lines_(options_.history_every),
      fragments_(options_.fragments_every),
      figures_(model, options_.directory, options_.figures, options_.context, tables_.all(), time_),
      frames_(model, options_.directory, options_.frame_every, options_.compression, time_) {
    const std::vector<Measure<EnergyRow>> energies = energy_columns(options_.works);
    tables_.add(&Histories::energy, names_of<EnergyRow>(energies),
                [this, energies](const State&) { return values_of<EnergyRow>(energies, ledger_.row()); });
    tables_.add(&Histories::cracks, names_of(crack_columns()), [this](const State& now) {
        return values_of(crack_columns(), CrackMoment{now.time, cracks_, options_.context.rayleigh_speed});
    });
    if (!reactions_.empty())
        tables_.add(&Histories::reactions, reactions_.columns(),
                    [this](const State& now) { return reactions_.line(now); });
    if (!fluids_.empty())
        tables_.add(&Histories::fluids, fluids_.columns(), [this](const State& now) { return fluids_.line(now); });
    if (!probes_.empty())
        tables_.add(&Histories::probes, probes_.columns(), [this](const State& now) { return probes_.line(now); });
    if (options_.specimen) {
        specimen_.emplace(model, reactions_, *options_.specimen);
        specimen_->begin(start);
        tables_.add(&Histories::stress_strain, names_of<SpecimenMoment>(stress_strain_columns(*options_.specimen)),
                    [this](const State&) { return specimen_->line(breaks_->n_tensile(), breaks_->n_shear()); });
    }
    tables_.add(&Histories::fragment_history, names_of(fragment_moment_columns()));
    std::vector<std::string> path_columns;
    for (const Output& column : fragment_path_columns(model.large_rotation)) path_columns.emplace_back(column.name);
    if (options_.trajectories) tables_.add(&Histories::trajectories, names_of(trajectory_columns()));
    else tables_.add(&Histories::fragment_paths, std::move(path_columns));
    if (!options_.collectors.empty()) tables_.add(&Histories::passages, names_of(passage_columns()));
    if (options_.breaks || options_.specimen) {
        breaks_.emplace(model, start);
        tables_.add(&Histories::breaks, names_of(break_columns()));
    }
    if (options_.rest.ends_run) rest_.emplace(model, options_.rest);
    gates_.judge(ledger_, deformation_);
    probes_.after_step(start);
    if (!options_.resumes && !options_.continues_other_run) begin(start);
}

void Recorder::begin(const State& start) {
    if (options_.continues_other_run) deformation_.look_at(start), gates_.judge(ledger_, deformation_);
    open_files();
    follow_cracks(start);
    reactions_.after_step(start);
    write_lines(start);
    write_fragments(start);
    lines_.start(start.time);
    fragments_.start(start.time);
    frames_.start(start);
}

void Recorder::open_files() {
    if (options_.directory.empty()) return;
    const Timed timed(time_);
    tables_.open();
    figures_.compare();
    if (frames_.has_times() || figures_.need_frames()) frames_.open();
}

void Recorder::after_step(const State& now, const StepReport& report) {
    ledger_.add(now, report);
    if (rest_) rest_->after_step(ledger_.row(), now.frozen ? std::optional(now.lies_still()) : std::nullopt);
    probes_.after_step(now);
    watch_deformation(now, report.largest_speed);
    watch_motion(now);
    gates_.judge(ledger_, deformation_);
    const bool changed = follow_cracks(now);
    reactions_.after_step(now);
    fluids_.after_step(now);
    if (!options_.collectors.empty())
        for (std::vector<double>& line : collectors_.after_step(now, report.largest_speed, changed))
            tables_.add_line(&Histories::passages, std::move(line));
    if (breaks_) {  // every step: between two lines none must be missed
        const Timed timed(time_);
        if (specimen_) specimen_->after_step(now);
        for (std::vector<double>& line : breaks_->found(now)) tables_.add_line(&Histories::breaks, std::move(line));
        if (specimen_) specimen_->end_window(now, breaks_->n_tensile(), breaks_->n_shear());
    }
    if (lines_.advance_if_due(now.time)) write_lines(now);
    if (fragments_.advance_if_due(now.time)) write_fragments(now);
    frames_.after_step(now, figures_.needs_frame(now));
    figures_.after_step(now);
}

void Recorder::model_changed() {
    cracks_.set_graph(interface_graph(model_));
    probes_.renew();
    renew_observers();
}

void Recorder::renew_observers() {
    statuses_.renew();
    reactions_.renew();
    if (!fluids_.empty()) fluids_.renew();
    if (specimen_) specimen_->renew(model_);
    deformation_.renew();
    ledger_.renew(model_, weakest_point(model_));
}

std::vector<ProbeSubject> Recorder::after_adaptation(const State& now, const Renumbering& numbers,
                                                     const LeapfrogEnergies& energies) {
    ledger_.adapt(numbers, energies);
    cracks_.renumber(interface_graph(model_), numbers);
    if (breaks_) breaks_->renumber(now, numbers);
    renew_observers();
    return probes_.renumber(now, numbers);
}

Strength Recorder::strength() const {
    Strength found =
        strength_of(specimen_->curve(breaks_->n_tensile(), breaks_->n_shear()), options_.specimen->modulus_between);
    if (!model_.vanished.empty()) found.tangent_modulus = found.strain_ratio = Strength::unknown;  // of two bodies
    return found;
}

/// In every step, so that what is found does not depend on the lines that are written. Returns whether the status of an
/// interface changed.
bool Recorder::follow_cracks(const State& now) {
    const std::vector<EdgeStatus>& changed = statuses_.changed(now);
    cracks_.grow(now.time, changed, ledger_.row().cohesive_work);
    return !changed.empty();
}

/// With the full turns of each.
Fragments Recorder::find_turned_fragments(const State& now) {
    Fragments found = find_fragments(model_, now);
    deformation_.count_turns(now);
    for (Fragment& piece : found.pieces) piece.near = deformation_.turned(now, piece.first_triangle);
    return found;
}

void Recorder::finish(const State& now, bool ended_early) {
    if (now.n_steps > look_.step) {
        const Timed timed(time_);
        deformation_.look_at(now), look_ = {0, now.n_steps};
    }
    watch_motion(now, true);
    gates_.judge_end(ledger_, deformation_);
    if (last_line_ < now.time) write_lines(now);
    const History& fragments = histories().fragment_history;
    if (fragments.rows.empty() || fragments.rows.back()[0] < now.time) write_fragments(now);
    frames_.finish(now, ended_early);
    {
        const Timed timed(time_);
        tables_.close();
        tables_.all().fragments = fragment_table(find_turned_fragments(now));
        tables_.write("fragments.csv", histories().fragments);
        write_arms();
        tables_.write_missing();
    }
    figures_.finish(now, ended_early);
    frames_.complete();
    figures_.draw_sequences(frames_);
}

/// Looks when the fastest vertex could have moved far enough since the last look, whatever the end of the run and
/// whatever is written, and at the end. A path that is not a number is far enough.
void Recorder::watch_deformation(const State& now, double speed) {
    deformation_.look_at_obstacles(now);
    const double reached = now.time * (1 + 1e-12), path = now.last_step * speed;
    const bool always = options_.end > 0 && reached >= options_.end, explicit_bulk = !now.has_end_velocities();
    const auto is_due = [&](Watch& watch, double far, std::int64_t n_steps) {
        watch.path += path;
        return always || (!(watch.path < far) && now.n_steps >= watch.step + (explicit_bulk ? n_steps : 1));
    };
    const bool look = is_due(look_, deformation_.look_path(), steps_between_looks),
               search = is_due(search_, deformation_.search_path(), steps_between_searches);
    double spin = 0;  // looks may be long steps apart
    for (const RigidPiece& piece : now.rigid_pieces) spin = std::max(spin, std::abs(piece.spin));
    turned_ += now.last_step * spin;
    const bool count = look || turned_ >= counted_turn;
    if (count) turned_ = 0;
    if (count && !look) deformation_.count_turns(now);
    bool into_obstacles = false;
    if (deformation_.has_obstacles()) {
        obstacle_look_.path += now.last_step * deformation_.obstacle_speed(now);
        // contacts of rigid pieces tell their depths in every step
        into_obstacles = is_due(obstacle_look_, deformation_.obstacle_path(), now.frozen ? steps_between_looks : 1);
    }
    if (!look && !search && !into_obstacles) return;
    const Timed timed(time_);
    if (into_obstacles) deformation_.look_into_obstacles(now), obstacle_look_ = {0, now.n_steps};
    if (look) deformation_.look_at(now), look_ = {0, now.n_steps};
    if (search) deformation_.look_for_overlap(now), search_ = {0, now.n_steps};
}

/// Spins in every implicit step that brakes them, vibrations in some steps, where temperatures may cause them.
void Recorder::watch_motion(const State& now, bool at_end) {
    const bool implicit = now.has_end_velocities(),
               brakes = implicit && model_.large_rotation && options_.theta > 0.5 && !at_end;
    const std::int64_t n = implicit || at_end ? 1 : steps_between_looks;
    if (!brakes && (!now.temperature || now.n_steps < step_of_motion_ + n)) return;
    const Timed timed(time_);
    step_of_motion_ = now.n_steps;
    ledger_.look_at(free_motion(model_, now),
                    brakes ? braked_per_time(options_.theta, now.last_step, 1) * now.last_step : 0);
}

// ---- tables

void Recorder::write_lines(const State& now) {
    const Timed timed(time_);
    last_line_ = now.time;
    cracks_.snapshot(now.time);
    tables_.write_lines(now);
}

void Recorder::write_fragments(const State& now) {
    const Timed timed(time_);
    const Fragments fragments = find_turned_fragments(now);
    const History table = fragment_table(fragments);
    tables_.add_line(&Histories::fragment_history,
                     values_of(fragment_moment_columns(), FragmentMoment{now.time, fragments, table}));
    if (options_.trajectories)
        for (std::vector<double>& line : trajectory_lines(model_, now))
            tables_.add_line(&Histories::trajectories, std::move(line));
    else
        for (std::vector<double>& line : fragment_path_lines(now.time, fragments, table))
            tables_.add_line(&Histories::fragment_paths, std::move(line));
}

/// The arms as they are known at the end: an arm counts once it is long, but it grew from its first edge on, and so did
/// the lengths and the main tip in cracks.csv.
void Recorder::write_arms() {
    if (cracks_.arms().arms().empty()) return;
    const CrackHistory::Past past = cracks_.conclude();
    History& table = tables_.all().cracks;
    std::vector<std::vector<double>>& rows = table.rows;
    const std::size_t n_earlier = past.all.size() - rows.size();  // of the run from which this one started
    for (std::size_t i = n_earlier; i < past.all.size(); ++i) {
        const auto value = [&](const char* column) -> double& { return rows[i - n_earlier][table.place_of(column)]; };
        const Vec2 place = past.tip[i] ? past.tip[i]->position : Vec2(none, none);
        const double speed = past.tip[i] ? past.tip[i]->speed : none, c_R = options_.context.rayleigh_speed;
        value("main_length") = past.main[i];
        value("crack_length") = std::max(value("crack_length"), past.all[i]);
        value("tip_x") = place.x(), value("tip_y") = place.y();
        value("tip_speed") = speed, value("tip_speed_over_cR") = c_R > 0 ? speed / c_R : none;
    }
    tables_.write("cracks.csv", histories().cracks);
    tables_.write("arms.csv", cracks_.arm_table());
}

OutputTime Recorder::time() const {
    OutputTime time = time_;
    time.cpu += frames_.uncounted(), time.frames += frames_.uncounted();
    return time;
}

void Recorder::flush_files() {
    frames_.wait();
    frames_.flush();
    figures_.flush();
}

std::vector<std::string> Recorder::missing_files() const {
    std::vector<std::string> files = frames_.missing_files();
    for (std::string& file : figures_.missing_files()) files.push_back(std::move(file));
    return files;
}

}  // namespace knap
