// time.start = "run:DIR@40us", "run:DIR" (its last state) or "run:FILE": the state from which a run starts.
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/whole_file.hpp"
#include "record/checkpoint_file.hpp"
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>

namespace knap {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view of_run = "run:";
constexpr std::size_t max_times = 12;  // in a message

std::string times_text(const std::vector<StoredState>& states) {
    std::vector<std::string> times;
    for (const StoredState& state : states)
        if (state.fault.empty()) times.push_back(readable(state.moment.time, "s", 6));
    times.erase(std::unique(times.begin(), times.end()), times.end());
    const std::size_t n = times.size();
    times.resize(std::min(n, max_times));
    return joined(times) + (n > max_times ? ", ... (" + std::to_string(n) + ")" : "");
}

/// The file of the state of a run at a time, or of its last one; none, and an error, where there is none.
std::optional<fs::path> find_state(const Table& time, const std::string& run, const std::optional<std::string>& at) {
    const fs::path directory = time.reading().files.directory / run;
    const Quantity requested = parse_quantity(at.value_or("0"));
    if (!requested.problem.empty() || (!requested.unit.empty() && requested.dimension != dimension_of("s"))) {
        time.error("bad-value", "start", "has no time after @: `" + *at + "`", "as in \"run:" + run + "@40us\"");
        return std::nullopt;
    }
    std::error_code none;
    if (!fs::is_regular_file(directory / "run.json", none)) {
        time.error("missing-file", "start", ": `" + directory.string() + "` holds no run",
                   "the directory of a run, relative to the scenario file");
        return std::nullopt;
    }
    const std::vector<StoredState> states = stored_states(directory);
    if (const StoredState* state = at ? state_at(states, requested.value) : last_state(states)) return state->file;
    const std::string none_there = ": the run in `" + directory.string() + "` has no state" +
                                   (at ? " at " + readable(requested.value, "s", 6) : "");
    for (const StoredState& state : states)
        if (!state.fault.empty()) {
            time.error("bad-state", "start",
                       none_there + " that can be used, and `" + state.file.string() + "` " + state.fault,
                       "run the other scenario again with --force and this program");
            return std::nullopt;
        }
    time.error("no-such-state", "start", none_there + (states.empty() ? "" : "; it has those at " + times_text(states)),
               "`output.states = \"" + at.value_or("40us") +
                   "\"` in its scenario keeps that state; frames hold only what is drawn");
    return std::nullopt;
}

}  // namespace

bool starts_from_run(Reading& reading) { return reading.table("time").text("start").starts_with(of_run); }

void read_start(const Table& time) {
    if (!starts_from_run(time.reading())) return;
    const std::string name = time.text("start").substr(of_run.size());
    const std::size_t at = name.rfind('@');
    fs::path file = time.reading().files.directory / name;
    std::error_code none;
    if (!fs::is_regular_file(file, none)) {
        const bool at_end = at == std::string::npos;
        if (at_end && !fs::exists(file, none))
            return time.error("missing-file", "start", ": there is no run or state `" + file.string() + "`",
                              "\"run:DIR@40us\", \"run:DIR\" for its last state, or the file of a state");
        const std::optional<fs::path> found =
            find_state(time, name.substr(0, at), at_end ? std::nullopt : std::optional(name.substr(at + 1)));
        if (!found) return;
        file = *found;
    }
    try {
        std::string bytes = read_whole_file(file);
        unpacked_checkpoint(bytes);
        time.scenario().files.push_back({time.path("start"), "start.state", std::move(bytes), std::string(of_run)});
        time.scenario().time.start_run = name;
    } catch (const std::runtime_error& error) {
        time.error("bad-state", "start", ": `" + file.string() + "` cannot be used: " + error.what(),
                   "run the other scenario again with --force and this program");
    }
}

void check_states(const Table& output, double end) {
    std::vector<double>& states = output.scenario().output.states;
    std::ranges::sort(states);
    if (end > 0 && !states.empty() && states.back() > end)
        output.warning("never-reached", "states",
                       ": the run ends at " + readable(end, "s", 6) + ", before " + readable(states.back(), "s", 6));
}

}  // namespace knap
