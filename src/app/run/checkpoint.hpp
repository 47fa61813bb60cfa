#pragma once
// Checkpoints: all that a run needs to go on with the same bits as if it had never stopped.
//
//     <run>/checkpoint            the newest
//     <run>/checkpoint.previous   the one before; used where the newest is damaged
//
// One line (format, program, bytes, CRC-32), then the memory of the run. Written by a temporary name and rename, so that a killed run leaves two whole
// ones. A finished run has another one instead:
//
//     <run>/checkpoint.end        before the first step that depends on time.end; from it the run goes on to a later one
#include "base/stopwatch.hpp"
#include "record/recorder.hpp"
#include "stepper/step_control.hpp"

#include <filesystem>
#include <string>

namespace knap {

/// What is kept. The model, the figures' options and the like follow from the scenario.
struct RunMemory {
    State& now;
    StepControl& control;
    Recorder& recorder;
    std::int64_t log_size = 0;         // [byte] of log.txt by then
    double cpu = 0, wall = 0;          // [s] spent so far by all parts of the run
    double cpu_model = 0, cpu_preload = 0, cpu_steps = 0;  // [s] of it in mesh and model, in the start in equilibrium, in steps
};

class Checkpoints {
public:
    /// `every`: [s] of wall time between two.
    Checkpoints(std::filesystem::path directory, double every) : directory_(std::move(directory)), every_(every) {}

    bool due() const { return watch_.wall() >= every_; }
    /// Throws OutputError where it cannot be written; those before are kept then.
    void write(RunMemory& memory);
    /// The newest that is whole, into `memory`; returns what is to be said of it. Throws UserError where none can be used.
    std::string read(RunMemory& memory);
    void remove() const;
    /// Of a finished run: the newest stays, as checkpoint.end.
    void keep_for_later_end() const;

    static bool end_exists_in(const std::filesystem::path& directory);
    /// checkpoint.end becomes the newest again.
    static void reopen_end(const std::filesystem::path& directory);
    /// Why a run can go on from none of all three with this program; empty where it can.
    static std::string problem_in(const std::filesystem::path& directory);

    static bool exist_in(const std::filesystem::path& directory);
    /// Whether a run can go on from one of them with this program.
    static bool usable_in(const std::filesystem::path& directory);

private:
    std::filesystem::path directory_;
    double every_;
    bool newest_is_whole_ = true;  // else the one before is not replaced by it
    Stopwatch watch_;
};

/// All that is in it as bytes, and back into one of the same scenario. Restoring throws SimulationError where the bytes are no memory of a run;
/// `memory` is half new then. What lies behind a right checksum was written by this program: its numbers are not judged.
std::string bytes_of(RunMemory& memory);
void restore(const std::string& bytes, RunMemory& memory);

/// The bytes of a checkpoint file round its memory, and back. Unpacking throws SimulationError saying what is wrong with the file.
std::string packed_checkpoint(const std::string& memory);
std::string unpacked_checkpoint(const std::string& file);

}  // namespace knap
