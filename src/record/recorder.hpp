#pragma once
// Observes a run: energy ledger, gates, deformation, cracks; Tables, FrameOutput and FigureOutput write what they find
// at its times.
#include "analysis/breaks.hpp"
#include "analysis/collectors.hpp"
#include "analysis/crack_history.hpp"
#include "analysis/deformation_watch.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/fluids.hpp"
#include "analysis/gates.hpp"
#include "analysis/interface_graph.hpp"
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "analysis/rest_watch.hpp"
#include "analysis/specimen.hpp"
#include "analysis/strength.hpp"
#include "record/figure_output.hpp"
#include "record/tables.hpp"

#include <filesystem>
#include <optional>

namespace knap {

/// [Pa] strength_by_law of the first law within a material, with the sigma_c of its interfaces, and with that as given
/// if strength = "as measured"; 0: there is none.
struct LawStrength {
    double of_interfaces = 0, measured = 0;
};

struct RecorderOptions {
    std::filesystem::path directory;              // of the run; empty: nothing is written
    double end = 0;                               // [s]
    Compression compression = Compression::none;  // of frames
    double frame_every = 0;                       // [s] 0 = no frames except those of figures that are drawn at the end
    double history_every = 0;                     // [s]
    double fragments_every = 0;                   // [s] between lines of fragment_history.csv; 0 = only start and end
    MassMatrix mass = MassMatrix::lumped;
    double theta = 0.5;  // of implicit steps
    RareWorks works;
    CrackOptions cracks;
    double critical_opening = 0;  // [m] the largest delta_c of the breakable laws
    std::vector<AllowedLimit> allowed_limits;
    std::vector<FigureOptions> figures;
    FigureContext context;
    std::vector<ProbeOptions> probes;
    std::vector<CollectorOptions> collectors;
    bool trajectories = false;  // in place of the paths of fragments
    bool breaks = false;        // record every interface that breaks; a specimen implies it
    std::optional<SpecimenOptions> specimen;
    LawStrength law_strength;
    struct Calibrated {
        double measured = 0, of_interfaces = 0;  // of the first law with the property "as measured"; 0: none
    };
    Calibrated toughness, strength;  // [J/m2], [Pa] sigma_c
    RestOptions rest;
    bool resumes = false;  // files of an earlier part of the run exist: nothing is written before open_files()
    bool continues_other_run = false;  // energies and cracks of another run: nothing is written before begin()
};

class Recorder {
public:
    Recorder(const Model& model, const State& start, RecorderOptions options);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// The first lines and the first frame. The constructor does this, unless energies and cracks of another run come
    /// first.
    void begin(const State& start);
    /// The clock of these is set back by `time` [s].
    /// A run goes on from another one: with the step that ended its leapfrog, with other assumptions.
    void close_leapfrog(const State& now, const StepReport& closing) { ledger_.add(now, closing); }
    void assume(const State& now, std::size_t n_obstacles) { ledger_.assume(model_, now, n_obstacles); }
    void set_back(double time) { cracks_.set_back(time), ledger_.set_back(time); }

    /// Writes the tables with all lines so far and opens them for the next lines. The constructor does this for a new
    /// run; a resumed run calls it after its checkpoint was read.
    void open_files();

    void after_step(const State& now, const StepReport& report);

    /// The model has become its successor, between two steps: all frames before it must be finished.
    void model_changed();
    /// A region vanished.
    void after_excavation(const ExcavationEnergies& energies) { ledger_.excavate(energies), model_changed(); }
    /// The mesh was refined; `now` belongs to the new one. Returns what probes watch now in the place of other things.
    std::vector<ProbeSubject> after_adaptation(const State& now, const Renumbering& numbers,
                                               const LeapfrogEnergies& energies);

    /// Returns when all frames so far are written.
    void finish_frames() { frames_.wait(); }
    /// The same when they and the figures are on the disk: before a checkpoint that counts them.
    void flush_files();

    /// Last lines, last frame, and the figures of the end; also after an interruption. Where the run ended early,
    /// figures at times that it did not reach show its last state.
    void finish(const State& now, bool ended_early = false);

    const EnergyLedger& ledger() const { return ledger_; }
    const DeformationWatch& deformation() const { return deformation_; }
    const CrackHistory& cracks() const { return cracks_; }
    const Reactions& reactions() const { return reactions_; }
    const Fluids& fluids() const { return fluids_; }
    const Probes& probes() const { return probes_; }
    Index n_breaks() const { return breaks_ ? breaks_->n_tensile() + breaks_->n_shear() : 0; }  // if recorded
    /// Numbers of the stress-strain curve of the specimen, which there is.
    Strength strength() const;
    const RestWatch* rest() const { return rest_ ? &*rest_ : nullptr; }  // null: the run does not end at rest
    bool at_rest() const { return rest_ && rest_->at_rest(); }
    const GateKeeper& gates() const { return gates_; }  // after the last step
    GateKeeper& gates() { return gates_; }
    const Histories& histories() const { return tables_.all(); }
    const RecorderOptions& options() const { return options_; }
    const std::vector<std::filesystem::path>& figures() const { return figures_.drawn(); }
    OutputTime time() const;
    /// Frames and figures that this run wrote and that are lost or damaged: "fields/bulk_0003.vtu is empty".
    std::vector<std::string> missing_files() const;

    /// What goes on in a run that starts from this one: its energy balance and its cracks.
    void serialize_energies_and_cracks(auto& archive) { archive(ledger_, cracks_); }
    /// All else.
    template <class Archive>
    void serialize(Archive& archive) {
        archive(deformation_, look_, search_, obstacle_look_, step_of_motion_, turned_, gates_, tables_, lines_,
                fragments_, last_line_, figures_, frames_, time_, reactions_, fluids_, probes_, collectors_);
        if (breaks_) archive(*breaks_);
        if (specimen_) archive(*specimen_);
        if (rest_) archive(*rest_);
    }

private:
    /// Motion since the last look at the deformation.
    struct Watch {
        double path = 0;        // [m] of the fastest vertices
        std::int64_t step = 0;  // number of the step of that look
        template <class Archive>
        void serialize(Archive& archive) {
            archive(path, step);
        }
    };
    void renew_observers();
    bool follow_cracks(const State& now);
    void watch_deformation(const State& now, double speed);
    void watch_motion(const State& now, bool at_end = false);
    void write_lines(const State& now);
    void write_arms();
    void write_fragments(const State& now);
    Fragments find_turned_fragments(const State& now);

    const Model& model_;
    RecorderOptions options_;
    EnergyLedger ledger_;
    DeformationWatch deformation_;
    GateKeeper gates_;
    CrackHistory cracks_;
    StatusWatch statuses_;
    Reactions reactions_;
    Fluids fluids_;
    Probes probes_;
    Collectors collectors_;
    std::optional<Breaks> breaks_;
    std::optional<Specimen> specimen_;
    std::optional<RestWatch> rest_;
    OutputTime time_;
    Tables tables_;
    Every lines_, fragments_;
    Watch look_, search_, obstacle_look_;  // of the deformation, for overlaps, and for edges in obstacles
    std::int64_t step_of_motion_ = 0;      // of the last look at the motion of pieces
    double turned_ = 0;                    // [rad] at most, since turns were counted, by rigid pieces
    double last_line_ = -1;                // [s] time of the last line
    FigureOutput figures_;
    FrameOutput frames_;
};

}  // namespace knap
