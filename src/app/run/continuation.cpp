#include "app/run/continuation.hpp"

#include "app/run/checkpoint.hpp"
#include "app/run/run.hpp"
#include "app/run/step_plan.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "scenario/units.hpp"

#include <cmath>
#include <limits>
#include <tuple>

namespace knap {
namespace {

namespace fs = std::filesystem;

/// The scenario that a run in this directory began with; nothing where it cannot be read.
std::optional<ReadResult> scenario_in(const fs::path& directory, std::string& text) {
    const fs::path file = directory / "resolved.toml";
    std::error_code none;
    if (!fs::is_regular_file(file, none)) return std::nullopt;
    try {
        text = read_whole_file(file);
        return read_scenario_text(text, file.string(), {}, directory);
    } catch (const std::runtime_error&) {
        return std::nullopt;
    }
}

bool is_from_default(const ReadResult& read, const std::string& key) {
    const Node* node = read.values.find(key);
    return node && !node->is_given();
}

bool step_follows_from_end(const ReadResult& read) { return read.scenario.time.step.value == 0 || read.scenario.time.step.of_stable_step; }

void set(ReadResult& read, const std::string& key, double value) { read.values.set(key, Node::of_number(value)); }

void keep_step(ReadResult& read, double step) {
    set(read, "time.step", step);
    read.scenario.time.step = {.value = step};
}

/// Output intervals that follow from the end, and the step of a run that was extended before.
void keep_defaults(ReadResult& read, const ReadResult& first) {
    if (is_from_default(read, "output.every") && first.values.has("output.every")) {
        set(read, "output.every", first.scenario.output.every);
        read.scenario.output.every = first.scenario.output.every;
    }
    if (is_from_default(read, "output.history_every") && first.values.has("output.history_every")) {
        set(read, "output.history_every", first.scenario.output.history_every);
        read.scenario.output.history_every = first.scenario.output.history_every;
    }
    if (step_follows_from_end(read) && !step_follows_from_end(first)) keep_step(read, first.scenario.time.step.value);
}

std::string kept_text(const ReadResult& read) {
    const auto& [time, output] = std::tie(read.scenario.time, read.scenario.output);
    const std::string step = time.step.value > 0 ? "time.step = " + shortest(time.step.value) + (time.step.of_stable_step ? " CFL, " : " s, ") : "";
    return step + "output.every = " + shortest(output.every) + " s, output.history_every = " + shortest(output.history_every) + " s";
}

/// What it would have been with another end.
std::string resolved_with_end(ReadResult read, double end) {
    set(read, "time.end", end);
    for (std::size_t i = 0; i < read.values.count("figure"); ++i) {
        const std::string key = item("figure", i) + ".at";
        if (!is_from_default(read, key)) continue;
        Node list{.type = Node::Type::array};
        list.children.push_back(Node::of_number(end));
        read.values.set(key, std::move(list));
    }
    return resolved_for_run(read);
}

}  // namespace

Continuation continuation_of(const ReadResult& read, const Model& model, const fs::path& directory) {
    std::string text;
    const std::optional<ReadResult> first = scenario_in(directory, text);
    if (!first || read.scenario.time.end < first->scenario.time.end) return {.read = read};
    Continuation continuation{.read = read};
    ReadResult& kept = continuation.read;
    keep_defaults(kept, *first);
    const double end = first->scenario.time.end;
    if (resolved_with_end(kept, end) != text) return {.read = read};
    if (read.scenario.time.end == end) {  // the same run
        if (resolved_for_run(kept) != resolved_for_run(read)) continuation.said = "kept of the run that stands there: " + kept_text(kept) + "\n";
        return continuation;
    }
    if (!Checkpoints::exist_in(directory) && !Checkpoints::end_exists_in(directory)) return {.read = read};
    if (const std::string problem = Checkpoints::problem_in(directory); !problem.empty())
        throw UserError("not-extended", "the run in `" + directory.string() + "` cannot go on to t = " + shortest(read.scenario.time.end) + " s: " + problem,
                        "start it again with --force, or choose another directory with --output");
    if (step_follows_from_end(kept)) keep_step(kept, plan_of(*first, model, std::numeric_limits<double>::infinity()).limits.largest);
    continuation.of_run = FirstFiles{{"resolved.toml", text}};
    for (const NamedFile& file : read.scenario.files) continuation.of_run->emplace_back(file.name, file.bytes);
    continuation.said = "extended: time.end was " + shortest(end) + " s, is " + shortest(read.scenario.time.end) + " s; kept are " + kept_text(kept) +
                        ", as resolved.toml says, which run at once gives the same bits\n";
    return continuation;
}

}  // namespace knap
