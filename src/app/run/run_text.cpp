#include "app/run/run_text.hpp"

#include "record/outputs.hpp"

#include <cmath>
#include <cstdio>

namespace knap {
namespace {

template <class... Values>
void add_line(std::string& text, const char* format, Values... values) {
    char line[512];
    std::snprintf(line, sizeof line, format, values...);
    text += line;
}

/// What another try could change, with values; `smallest` [s] is the smallest step allowed now.
std::string advice(CutbackReason reason, double smallest) {
    std::string text;
    if (reason == CutbackReason::assumption_1)
        add_line(text, "time.assumption_1 = \"ignore\" to go on with one of the solutions; or time.cohesion = \"explicit\"; or time.step_min = \"%.3g s\"", 1e-3 * smallest);
    else if (reason == CutbackReason::not_converged)
        add_line(text,
                 "time.bulk = \"explicit\" with time.cohesion = \"explicit\", whose steps are solved vertex by vertex; or time.theta = 0.7 where it is smaller; or half the "
                 "friction of the interface there, where it wedges the body; or time.step_min = \"%.3g s\"",
                 1e-3 * smallest);
    else
        add_line(text, "time.step_min = \"%.3g s\"", 1e-3 * smallest);
    return text;
}

/// " at (x, y) = (0.01, 0.02) m", or nothing.
std::string place_text(const std::optional<Vec2>& place) {
    std::string text;
    if (place) add_line(text, " at (x, y) = (%.6g, %.6g) m", place->x(), place->y());
    return text;
}

/// "steps of 1e-06 s", or from the smallest to the largest.
std::string steps_text(const RunRecord& record) {
    std::string text;
    if (record.largest_step > record.smallest_step * (1 + 1e-6))
        add_line(text, "%lld steps of %.4g to %.4g s", static_cast<long long>(record.steps), record.smallest_step, record.largest_step);
    else
        add_line(text, "%lld steps of %.4g s", static_cast<long long>(record.steps), record.steps > 0 ? record.largest_step : record.step);
    return text;
}

/// What the implicit path did; nothing for the explicit one.
std::string solver_text(const RunRecord& record) {
    std::string text;
    if (record.counts.linear_solves > 0 && record.steps > 0) {
        const auto n = static_cast<double>(record.steps);
        add_line(text, "  solver  %.2f linear solves and %.2f factorisations a step, which takes %.3g s of processor time, %.3g s a solve\n",
                 static_cast<double>(record.counts.linear_solves) / n, static_cast<double>(record.counts.factorisations) / n, record.cpu_steps / n,
                 record.cpu_steps / static_cast<double>(record.counts.linear_solves));
        if (record.counts.fan_fallbacks > 0)
            add_line(text, "  pivots  found %lld steps that this solver did not\n", static_cast<long long>(record.counts.fan_fallbacks));
        if (record.factor.unknowns > 0)
            add_line(text, "  factor  of %lld unknowns with %lld entries, %.1f an unknown\n", static_cast<long long>(record.factor.unknowns),
                     static_cast<long long>(record.factor.entries), static_cast<double>(record.factor.entries) / static_cast<double>(record.factor.unknowns));
    }
    for (const CutbackReason reason : cutback_reasons)
        if (const std::int64_t n = record.n_cutbacks[static_cast<std::size_t>(reason)]; n > 0)
            add_line(text, "  cuts    %lld: %s\n", static_cast<long long>(n), std::string(describe(reason)).c_str());
    return text;
}

}  // namespace

std::string cutback_text(const Cutback& cut, const Vec2& where) {
    std::string text;
    add_line(text, "cut: t = %.9g s, step %.4g s -> %.4g s at (%.6g, %.6g) m: %s\n", cut.time, cut.from, cut.to, where.x(), where.y(),
             std::string(describe(cut.reason)).c_str());
    return text;
}

std::string stuck_text(const Cutback& cut, const Vec2& where, double smallest) {
    std::string text;
    add_line(text, "the run cannot go on from t = %.9g s at (x, y) = (%.6g, %.6g) m: %s, even in a step of %.4g s; the smallest step allowed is %.4g s. Try ",
             cut.time, where.x(), where.y(), std::string(describe(cut.reason)).c_str(), cut.from, smallest);
    return text + advice(cut.reason, smallest);
}

std::string resumed_text(const State& now) {
    std::string text;
    add_line(text, "resumed: goes on from the checkpoint at t = %.9g s, step %lld\n", now.time, static_cast<long long>(now.n_steps));
    return text;
}

std::string missing_text(const std::vector<std::string>& files) {
    if (files.empty()) return "";
    const std::string others = files.size() > 1 ? " and " + std::to_string(files.size() - 1) + " more files" : "";
    return "warning[missing-file]: " + files.front() + others + " which this run wrote cannot be found; the rest is as it would be, --force makes all of it again\n";
}

std::string not_dumped_text(const StepSelection& asked, std::int64_t before, std::int64_t now) {
    const std::string steps = asked.outside(before + 1, now);
    if (steps.empty()) return "";
    const std::string taken = now > before ? "took steps " + std::to_string(before + 1) + " to " + std::to_string(now) : "took no step";
    return "warning[dump-lcp]: --dump-lcp did not store " + steps + "; this command " + taken + "\n";
}

std::string warning_text(const Gate& gate, const State& now) {
    std::string text;
    add_line(text, "warning[%s]: t = %.9g s%s: %s: %s, more than %s", gate.name.data(), now.time, place_text(gate.place).c_str(), gate.meaning.data(),
             value_text(gate.value, gate.unit, 4).c_str(), value_text(gate.warning, gate.unit, 4).c_str());
    if (std::isfinite(gate.limit)) text += "; the run ends beyond " + value_text(gate.limit, gate.unit, 4);
    return text + ". " + std::string(gate.cure) + "\n";
}

std::string violated_text(const Gates& gates, const State& now, const Vec2& fastest) {
    std::string text;
    const Gate* cause = nullptr;  // the gate that the others may come from
    for (const Gate& gate : gates) {
        if (gate.pass()) continue;
        add_line(text, "gate %s violated at t = %.9g s (step %lld): %s%s, limit %s: %s. ", gate.name.data(), now.time, static_cast<long long>(now.n_steps),
                 value_text(gate.value, gate.unit, 4).c_str(), place_text(gate.place).c_str(), value_text(gate.limit, gate.unit, 4).c_str(), gate.meaning.data());
        if (cause == nullptr || gate.name == "interface_residual") cause = &gate;
    }
    if (cause == nullptr) return text;
    if (!cause->place) add_line(text, "The body moves fastest at (x, y) = (%.6g, %.6g) m. ", fastest.x(), fastest.y());
    return text + std::string(cause->cure);
}

std::string end_of_run(const RunRecord& record, const std::filesystem::path& directory) {
    std::string text;
    add_line(text, "%s: %s at t = %.6g s after %s; %d triangles, %d interfaces; %.1f s (%.1f s of processor time)\n",
             record.name.c_str(), record.status.c_str(), record.time, steps_text(record).c_str(), record.triangles, record.interfaces, record.wall, record.cpu);
    add_line(text, "  processor time: mesh and model %.2f s, ", record.cpu_model);
    if (record.cpu_preload > 0) add_line(text, "preload %.2f s, ", record.cpu_preload);
    add_line(text, "steps %.2f s, frames %.2f s, figures %.2f s, other output %.2f s, all else %.2f s\n", record.cpu_steps, record.cpu_frames, record.cpu_figures,
             record.cpu_output - record.cpu_frames - record.cpu_figures, record.cpu_other());
    if (record.cpu_frames > 0) add_line(text, "  frames were written beside the steps, which waited %.3g s for them\n", record.frame_wait);
    if (!record.reason.empty()) text += "  reason: " + record.reason + "\n";
    text += solver_text(record);
    if (!record.summary.values.empty()) add_line(text, "  energies and forces are those of the thickness of %s\n", value_text(record.thickness, "m").c_str());
    for (const auto& [name, value] : record.summary.values) {
        const bool of_driver = name == "reaction_x" || name == "reaction_y" || name == "largest_reaction";
        const std::string whose = of_driver && !record.summary.reaction_of.empty() ? " (of " + record.summary.reaction_of + ")" : "";
        add_line(text, "  %-24s %s%s\n", name.c_str(), value_text(value, unit_of("summary", name)).c_str(), whose.c_str());
    }
    for (const Gate& gate : record.gates)
        add_line(text, "  gate   %-20s %-16s limit %-16s %s%s\n", gate.name.data(), value_text(gate.value, gate.unit, 4).c_str(),
                 std::isinf(gate.limit) ? "none" : value_text(gate.limit, gate.unit, 4).c_str(), gate.pass() ? name_of(gate.level).data() : "VIOLATED",
                 gate.level == GateLevel::ok ? "" : place_text(gate.place).c_str());
    for (const ExpectResult& result : record.expect)
        add_line(text, "  expect %-20s %-16s %-24s %s\n", result.name.c_str(), value_text(result.value, unit_of("summary", result.name)).c_str(), result.limit.c_str(),
                 result.pass ? "ok" : "FAILED");
    text += "run:     " + directory.string() + "\n";
    for (const auto& figure : record.figures) text += "figure:  " + figure.string() + "\n";
    return text;
}

}  // namespace knap
