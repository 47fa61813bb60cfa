#include "app/run/continuation.hpp"

#include "app/run/checkpoint.hpp"
#include "app/setup/step_plan.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "scenario/write_scenario.hpp"

namespace knap {
namespace {

namespace fs = std::filesystem;

bool is_from_default(const ReadResult& read, const std::string& key) {
    const Node* node = read.values.find(key);
    return node && !node->is_given();
}

bool step_follows_from_end(const StepLength& step) { return step.value == 0 || step.of_stable_step; }

/// Sets a key to a number, in the values and in the scenario.
template <class Number>
void set(ReadResult& read, const std::string& key, Number& member, double value) {
    read.values.set(key, Node::of_number(value));
    member = Number{value};
}

/// Keeps the defaults of the first part, and the step of a run that was extended before.
void keep_defaults(ReadResult& read, const ReadResult& first) {
    OutputOptions& output = read.scenario.output;
    const OutputOptions& kept = first.scenario.output;
    for (const auto& [key, member] : {std::pair{"output.every", &OutputOptions::every},
                                      std::pair{"output.history_every", &OutputOptions::history_every}})
        if (is_from_default(read, key) && first.values.has(key)) set(read, key, output.*member, kept.*member);
    if (read.scenario.specimen && first.scenario.specimen && is_from_default(read, "specimen.window"))
        set(read, "specimen.window", read.scenario.specimen->window, first.scenario.specimen->window);
    StepLength& step = read.scenario.time.step;
    if (const StepLength& first_step = first.scenario.time.step;
        step_follows_from_end(step) && !step_follows_from_end(first_step))
        set(read, "time.step", step, first_step.value);
}

std::string kept_text(const StepLength& step, const OutputOptions& output) {
    return (step.value > 0 ? "time.step = " + shortest(step.value) + (step.of_stable_step ? " CFL, " : " s, ") : "") +
           "output.every = " + shortest(output.every) + " s, output.history_every = " + shortest(output.history_every) +
           " s";
}

/// The text with another end, and with the times of figures that follow from it.
std::string resolved_with_end(ReadResult read, double end) {
    set(read, "time.end", read.scenario.time.end, end);
    for (std::size_t i = 0; i < read.values.count("figure"); ++i) {
        const std::string key = item("figure", i) + ".at";
        if (is_from_default(read, key)) read.values.set(key, Node::of_list({Node::of_number(end)}));
    }
    return resolved_for_run(read);
}

}  // namespace

std::string resolved_for_run(const ReadResult& read) {
    ReadResult stored = read;
    for (const NamedFile& file : read.scenario.files)
        stored.values.set(file.key, Node::of_text(file.prefix + file.name));
    return resolved_toml(stored);
}

Continuation continuation_of(const ReadResult& read, const Model& model, const fs::path& directory) {
    const fs::path file = directory / "resolved.toml";
    std::string text;
    std::optional<ReadResult> first;
    try {
        if (std::error_code none; fs::is_regular_file(file, none)) {
            text = read_whole_file(file);
            first = read_scenario_text(text, file.string(), {}, directory);
        }
    } catch (const std::runtime_error&) {
        // not a scenario of this program
    }
    const double end = read.scenario.time.end, first_end = first ? first->scenario.time.end : 0;
    if (!first || end < first_end) return {.read = read};
    Continuation continuation{.read = read};
    first->scenario.adapt = read.scenario.adapt;  // whether it pays does not depend on the end
    keep_defaults(continuation.read, *first);
    StepLength& step = continuation.read.scenario.time.step;
    const OutputOptions& output = continuation.read.scenario.output;
    if (resolved_with_end(continuation.read, first_end) != text) return {.read = read};
    if (end == first_end) {  // the same run
        if (resolved_for_run(continuation.read) != resolved_for_run(read))
            continuation.text = "kept from the run in the directory: " + kept_text(step, output) + "\n";
        return continuation;
    }
    if (!Checkpoints::exist_in(directory) && !Checkpoints::end_exists_in(directory)) return {.read = read};
    if (const std::string problem = Checkpoints::problem_in(directory, true); !problem.empty())
        throw UserError(
            "not-extended",
            "the run in `" + directory.string() + "` cannot continue to t = " + shortest(end) + " s: " + problem,
            "start it again with --force, or choose another directory with --output");
    if (step_follows_from_end(step))
        set(continuation.read, "time.step", step,
            plan_steps(first->scenario.time, first->scenario.adapt, model, infinity).limits.largest);
    continuation.first_files_of_shorter = FirstFiles{{"resolved.toml", text}};
    for (const NamedFile& named : read.scenario.files)
        continuation.first_files_of_shorter->emplace_back(named.name, named.bytes);
    continuation.text = "extended: time.end was " + shortest(first_end) + " s, is " + shortest(end) + " s; kept are " +
                        kept_text(step, output) +
                        "; resolved.toml contains them, and running it at once gives the same bits\n";
    return continuation;
}

}  // namespace knap
