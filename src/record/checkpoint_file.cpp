#include "record/checkpoint_file.hpp"

#include "base/checksum.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"
#include "record/version.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

namespace knap {
namespace {

namespace fs = std::filesystem;

constexpr const char* magic = "knap-checkpoint";
constexpr int format_number = 38;
constexpr std::size_t longest_line = 300;

std::string program() { return version() + "-" + git_hash() + (git_dirty() ? "-changed" : ""); }

struct Head {
    std::string program;
    Moment moment;
    std::size_t size = 0;
    std::uint64_t sum = 0;
};

/// Reads the first line of a file.
Head head_of(const std::string& text) {
    std::istringstream line(text);
    std::string found_magic;
    int found_format = 0;
    Head head;
    if (!(line >> found_magic >> found_format) || found_magic != magic) throw SimulationError("it is not a checkpoint");
    const bool has_program = static_cast<bool>(line >> head.program);
    if (found_format != format_number)
        throw SimulationError(formatted("its format is %d, that of this program is %d", found_format, format_number) +
                              (has_program ? "; knap " + head.program + " reads it" : ""));
    if (!(line >> head.moment.time >> head.moment.last_step >> head.size >> head.sum))
        throw SimulationError("its first line is damaged");
    return head;
}

std::string moment_text(const Moment& moment) { return formatted("%.17g %.17g", moment.time, moment.last_step); }

/// Checksum of all that follows the name of the program.
std::uint64_t sum_of(const Moment& moment, std::string_view memory) {
    return checksum(moment_text(moment)) ^ checksum(memory);
}

}  // namespace

std::string packed_checkpoint(std::string room_and_memory, const Moment& moment) {
    const std::string_view behind = std::string_view(room_and_memory).substr(room_for_head);
    const std::string head = formatted("%s %d %s %s %zu ", magic, format_number, program().c_str(),
                                       moment_text(moment).c_str(), behind.size());
    // zeros before the checksum fill the line, so that each of its bytes counts
    const std::string sum =
        formatted("%0*ju\n", static_cast<int>(room_for_head - 1 - head.size()), std::uintmax_t{sum_of(moment, behind)});
    assert(head.size() + sum.size() == room_for_head);
    std::ranges::copy(head + sum, room_and_memory.begin());
    return room_and_memory;
}

std::string unpacked_checkpoint(const std::string& file) {
    const std::size_t end = file.substr(0, longest_line).find('\n');
    if (end == std::string::npos) throw SimulationError("it is not a checkpoint");
    const Head head = head_of(file.substr(0, end));
    const std::string_view memory = std::string_view(file).substr(end + 1);
    if (head.program != program())
        throw SimulationError("it was written by knap " + head.program + ", this is " + program() +
                              ", whose results may differ in the last bits");
    if (memory.size() != head.size)
        throw SimulationError(
            formatted("it should have %zu bytes after its first line, it has %zu", head.size, memory.size()));
    if (sum_of(head.moment, memory) != head.sum) throw SimulationError("its checksum is wrong");
    return std::string(memory);
}

fs::path state_file(double time) { return fs::path("states") / (shortest(time) + ".state"); }

std::string fault_of_state(const fs::path& file, Moment* moment) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (error) return "cannot be read: " + error.message();
    if (size == 0) return "is empty";
    try {
        std::string line = read_begin(file, longest_line);
        line.resize(std::min(line.find('\n'), line.size()));
        const Head head = head_of(line);
        if (moment) *moment = head.moment;
        const std::size_t expected = line.size() + 1 + head.size;
        if (size != expected) return formatted("has %ju bytes instead of %zu", size, expected);
    } catch (const SimulationError& problem) {
        return std::string("cannot be used: ") + problem.what();
    }
    return "";
}

std::string fault_of_whole_state(const fs::path& file) {
    std::string fault = fault_of_state(file);
    if (!fault.empty()) return fault;
    try {
        unpacked_checkpoint(read_whole_file(file));
    } catch (const SimulationError& problem) {
        fault = std::string("cannot be used: ") + problem.what();
    }
    return fault;
}

std::vector<StoredState> stored_states(const fs::path& run) {
    std::vector<fs::path> files;
    for (const char* name : {newest_checkpoint, previous_checkpoint, checkpoint_of_end}) files.push_back(run / name);
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(run / "states", none))
        if (entry.path().extension() == ".state") files.push_back(entry.path());
    std::vector<StoredState> states;
    for (const fs::path& file : files) {
        if (!fs::is_regular_file(file, none)) continue;
        StoredState& state = states.emplace_back(StoredState{.file = file});
        state.fault = fault_of_state(file, &state.moment);
    }
    std::ranges::sort(states, {}, [](const StoredState& state) { return std::pair(state.moment.time, state.file); });
    return states;
}

const StoredState* state_at(const std::vector<StoredState>& states, double time) {
    const auto distance = [&](const StoredState& state) {
        return state.fault.empty() ? std::abs(state.moment.time - time) : INFINITY;
    };
    const auto nearest = std::ranges::min_element(states, {}, distance);
    if (nearest == states.end() || !(distance(*nearest) <= 2 * nearest->moment.last_step * (1 + 1e-9))) return nullptr;
    return &*nearest;
}

const StoredState* last_state(const std::vector<StoredState>& states) {
    const StoredState* last = nullptr;
    for (const StoredState& state : states)
        if (state.fault.empty()) last = &state;
    return last;
}

}  // namespace knap
