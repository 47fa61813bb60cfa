#pragma once
// Checkpoints: the data from which a run continues with the same bits as if it had never stopped.
//
// Their files (record/checkpoint_file.hpp) are written under a temporary name and renamed, so a killed run leaves two
// whole ones.
#include "app/setup/adaptation.hpp"
#include "app/setup/excavations.hpp"
#include "base/stopwatch.hpp"
#include "record/checkpoint_file.hpp"
#include "record/recorder.hpp"
#include "record/run_record.hpp"
#include "stepper/step_control.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace knap {

/// What a run that starts from another one must share with it.
struct RunOrigin {
    std::string scenario;  // resolved, and the checksums of the files that it names
    RareWorks works;       // of this run and of those from which it started

    void serialize(auto& archive) { archive(scenario, works); }
};

/// The contents of a checkpoint. Model, options of figures and the like follow from the scenario.
struct RunMemory {
    RunOrigin& origin;
    State& now;
    StepControl& control;
    Recorder& recorder;
    Excavations& excavations;
    Adaptation& adaptation;
    std::int64_t& triangle_steps;
    std::int64_t log_size = 0;  // [byte] of log.txt at that time
    TimeSpent spent = {};       // by all parts of the run so far
};

class Checkpoints {
public:
    /// `every`: [s] of wall time between two.
    Checkpoints(std::filesystem::path directory, double every) : directory_(std::move(directory)), every_(every) {}

    bool due() const { return watch_.wall() >= every_; }
    /// Throws OutputError where it cannot be written; the earlier ones are kept then.
    void write(RunMemory memory);
    /// Reads the newest undamaged one into `memory`; returns a warning about damaged ones. Throws UserError where none
    /// can be used.
    std::string read(RunMemory& memory);
    void remove() const;
    /// After a finished run the newest is kept as checkpoint.end.
    void keep_for_later_end() const;

    static bool exist_in(const std::filesystem::path& directory);
    static bool end_exists_in(const std::filesystem::path& directory);
    /// checkpoint.end becomes the newest again.
    static void reopen_end(const std::filesystem::path& directory);
    /// The reason why this program can continue from none of them, `also_end` or without checkpoint.end; empty where it
    /// can.
    static std::string problem_in(const std::filesystem::path& directory, bool also_end);

private:
    std::filesystem::path directory_;
    double every_;
    bool newest_is_whole_ = true;  // else it does not replace the previous one
    Stopwatch watch_;
};

/// The states of output.states.
class KeptStates {
public:
    /// `times` [s], in their order.
    KeptStates(std::filesystem::path directory, std::vector<double> times)
        : directory_(std::move(directory)), times_(std::move(times)) {}

    /// Those that are reached were written by an earlier part of the run: they are read.
    void skip_to(const State& now);
    bool is_due(const State& now) const;
    /// Those that are reached. Throws OutputError.
    void write(RunMemory memory);
    /// Those that were reached and are lost or damaged: "states/4e-05.state is empty".
    std::vector<std::string> missing() const;

private:
    std::filesystem::path directory_;
    std::vector<double> times_;
    std::size_t n_ = 0;                // that are reached
    std::vector<std::string> faults_;  // of those of an earlier part of the run
};

/// A memory as bytes, and back into a memory of the same scenario. Restoring throws SimulationError where the bytes are
/// not the memory of a run; `memory` is then partly overwritten. The numbers themselves are not checked: a right
/// checksum shows that this program wrote them.
std::string bytes_of(RunMemory& memory);
void restore(const std::string& bytes, RunMemory& memory);

/// The file of a memory.
std::string packed(RunMemory& memory);

/// The parts of a memory with which another run starts, in this order. Throws cereal's exceptions where the bytes are
/// not those of a memory.
class MemoryReader {
public:
    explicit MemoryReader(const std::string& bytes);
    ~MemoryReader();
    const RunOrigin& origin() const { return origin_; }
    void read_motion(State& now, StepControl& control, Excavations& excavations, Adaptation& adaptation);
    void read_energies_and_cracks(Recorder& recorder);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    RunOrigin origin_;
};

}  // namespace knap
