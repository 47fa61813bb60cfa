#pragma once
// The files that hold the memory of a run at one time: the checkpoints from which it continues itself, and the states
// from which other runs start.
//
//     <run>/checkpoint            the newest
//     <run>/checkpoint.previous   the one before; used where the newest is damaged
//     <run>/checkpoint.end        of a finished run: before the first step that depends on time.end; from it the run
//                                 continues to a later end
//     <run>/states/<time>.state   of output.states
//
// A file is one line (format, program, time and last step, bytes, checksum) and the memory of the run.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

inline constexpr const char* newest_checkpoint = "checkpoint";
inline constexpr const char* previous_checkpoint = "checkpoint.previous";
inline constexpr const char* checkpoint_of_end = "checkpoint.end";

/// The moment to which a memory belongs.
struct Moment {
    double time = 0;       // [s]
    double last_step = 0;  // [s]
};

/// A file from the bytes of a memory behind `room_for_head` others, without a copy of them, and back to those bytes.
/// Unpacking throws SimulationError with the fault of the file.
inline constexpr std::size_t room_for_head = 256;
std::string packed_checkpoint(std::string room_and_memory, const Moment& moment);
std::string unpacked_checkpoint(const std::string& file);

/// Name of a state file [s]: "states/4e-05.state".
std::filesystem::path state_file(double time);

/// Why a file is no whole state of this format, by its first line and its size: "is empty"; empty where it is one.
std::string fault_of_state(const std::filesystem::path& file, Moment* moment = nullptr);
/// The same by all of its bytes.
std::string fault_of_whole_state(const std::filesystem::path& file);

struct StoredState {
    std::filesystem::path file;
    Moment moment = {};
    std::string fault = {};  // fault_of_state
};
/// The checkpoints and states in the directory of a run, in the order of time.
std::vector<StoredState> stored_states(const std::filesystem::path& run);

/// The one without a fault that belongs to a time [s]: it was the first after it, or (a checkpoint) at most two steps
/// away; null where there is none.
const StoredState* state_at(const std::vector<StoredState>& states, double time);
/// The last one without a fault; null where there is none.
const StoredState* last_state(const std::vector<StoredState>& states);

}  // namespace knap
