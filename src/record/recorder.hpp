#pragma once
// Watches a run: energy ledger, crack history, CSV lines, field frames, figures at their times. Knows nothing of the stepper's insides.
#include "analysis/breaks.hpp"
#include "analysis/crack_history.hpp"
#include "analysis/deformation_watch.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/gates.hpp"
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "analysis/specimen.hpp"
#include "figures/figures.hpp"
#include "output/frame.hpp"
#include "output/frame_writer.hpp"
#include "output/vtk_series.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>

namespace knap {

struct RecorderOptions {
    std::filesystem::path directory;  // of the run; empty: nothing is written
    double end = 0;                   // [s]
    double frame_every = 0;           // [s] 0 = no fields but those of figures that are drawn at the end
    double history_every = 0;         // [s]
    double rayleigh_speed = 0;        // [m/s]
    std::vector<std::string> materials;  // names, by region
    MassMatrix mass = MassMatrix::lumped;
    CrackOptions cracks;
    double critical_opening = 0;             // [m] the largest of the laws that can break
    double weakest_point = 0;                // [J] what the weakest point takes to break
    std::vector<AllowedLimit> allowed_limits;
    std::vector<FigureOptions> figures;
    std::vector<ProbeOptions> probes;
    bool breaks = false;  // note every interface that breaks; a specimen needs it
    std::optional<SpecimenOptions> specimen;
    std::string title;
    bool goes_on = false;             // an earlier part of the run wrote files: nothing is written until open_files()
};

class Recorder {
public:
    Recorder(const Model& model, const State& start, RecorderOptions options);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// The files with all lines so far, to go on behind them: by the constructor, and after the memory was read back from a checkpoint.
    void open_files();

    void after_step(const State& now, const StepReport& report);

    /// Comes back when all frames so far are on the disk: before a checkpoint that counts them.
    void finish_frames();

    /// Last lines, last frame, and the figures of the end; also after an interruption.
    /// Of a run that failed, figures whose time it did not reach show the state in which it ended.
    void finish(const State& now, bool failed = false);

    const EnergyLedger& ledger() const { return ledger_; }
    const DeformationWatch& deformation() const { return deformation_; }
    const CrackHistory& cracks() const { return cracks_; }
    const Reactions& reactions() const { return reactions_; }
    const GateKeeper& gates() const { return gates_; }  // as they stand after the last step
    GateKeeper& gates() { return gates_; }
    const Histories& histories() const { return histories_; }
    const RecorderOptions& options() const { return options_; }
    const std::vector<std::filesystem::path>& figures() const { return drawn_; }
    std::vector<std::string> missing_files() const;  // frames and figures that this run has written and someone has taken away
    double output_seconds() const { return output_seconds_ + uncounted(); }  // [s] processor time spent here and beside the steps, and on two parts of it:
    double frame_seconds() const { return frame_seconds_ + uncounted(); }
    double figure_seconds() const { return figure_seconds_; }
    double frame_wait() const { return frame_wait_; }  // [s] of wall time that the steps waited for frames

    template <class Archive>
    void serialize(Archive& archive) {
        archive(ledger_, deformation_, look_, search_, gates_, cracks_, histories_, next_frame_, next_history_, last_line_, frame_times_, next_at_, drawn_);
        archive(output_seconds_, frame_seconds_, figure_seconds_, frame_wait_);
        if (breaks_) archive(*breaks_);
        if (specimen_) archive(*specimen_);
    }

private:
    class Timed;
    /// Since the last look at the deformation.
    struct Watch {
        double path = 0;        // [m] of the fastest vertices
        std::int64_t step = 0;  // number of that step
        template <class Archive>
        void serialize(Archive& archive) { archive(path, step); }
    };
    void write_frame(const State& now);
    void watch_step(const State& now);
    void watch_deformation(const State& now, double speed);
    void write_lines(const State& now);
    void end_frames();
    void write_fragments(const State& now);
    void write_arms();
    bool is_due(std::size_t figure, const State& now) const;
    void show_last_state(double end);
    void draw_due(const State& now, bool at_end);
    void draw_sequences();
    FigureContext figure_context() const;
    void write_lost_sheets() const;
    double uncounted() const { return writer_ ? writer_->cpu() - counted_ : 0; }  // [s] processor time beside the steps that is in neither of the sums yet

    const Model& model_;
    RecorderOptions options_;
    EnergyLedger ledger_;
    DeformationWatch deformation_;
    GateKeeper gates_;
    CrackHistory cracks_;
    Reactions reactions_;
    Probes probes_;
    std::optional<Breaks> breaks_;
    std::optional<Specimen> specimen_;
    Histories histories_;
    std::ofstream energy_file_, crack_file_, reaction_file_, probe_file_, break_file_, stress_strain_file_;
    std::optional<VtkSeries> series_;
    double next_frame_ = 0, next_history_ = 0;
    Watch look_, search_;  // of the deformation, and for overlaps
    double last_line_ = -1;             // [s] time of the last line
    std::vector<double> frame_times_;   // [s]
    std::vector<std::size_t> next_at_;  // per figure: which of its times comes next
    std::vector<std::filesystem::path> drawn_;
    double output_seconds_ = 0, frame_seconds_ = 0, figure_seconds_ = 0, frame_wait_ = 0;
    double counted_ = 0;
    std::optional<FrameWriter> writer_;  // the first to go: it works with the others
};

}  // namespace knap
