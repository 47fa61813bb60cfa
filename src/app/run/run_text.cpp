#include "app/run/run_text.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "figures/ticks.hpp"
#include "record/outputs.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using Count = long long;

std::string at_place(const std::optional<Vec2>& place) { return place ? " at " + place_text(*place) : ""; }

std::string reason_text(const Cutback& cut) {
    const std::string text(describe(cut.reason));
    if (cut.value == 0) return text;
    if (cut.reason == CutbackReason::impact || cut.reason == CutbackReason::blow)
        return text + formatted(" (%.4g times)", cut.value);
    const bool is_length = cut.reason != CutbackReason::contact_residual;
    return text + formatted(is_length ? " (%.4g of an edge)" : " (%.4g of them)", cut.value);
}

/// Each sentence on a line of its own.
std::string sentences(std::string text, const std::string& line_break) {
    for (std::size_t at = text.find(". "); at != text.npos && at + 2 < text.size(); at = text.find(". ", at + 1))
        text.replace(at + 1, 1, line_break);
    return text;
}

/// A gate that has no limit or was not judged says nothing.
bool is_judged(const Gate& gate) {
    return gate.level != GateLevel::ok || (!std::isnan(gate.value) && std::isfinite(gate.warning));
}

/// Whether cracks beside the main one took part in work_per_advance, which then is not what an advance costs.
std::string shared_work_text(const Summary& summary) {
    constexpr double zigzag =
        1.3;  // a single crack along edges over its chords, with side cracks below those that count
    const double branches = summary["branches"], all = summary["crack_length"] / summary["main_length"];
    if (!(branches > 0 || all > zigzag)) return "";
    return formatted(" (not the cost of one crack: all cracks are %.3g times as long as the main one)", all);
}

/// The work of the implicit solver and the cutbacks.
std::string solver_text(const RunRecord& record) {
    std::string text;
    const StepReport& counts = record.counts;
    if (counts.linear_solves > 0 && record.steps > 0) {
        const auto n = static_cast<double>(record.steps), solves = static_cast<double>(counts.linear_solves);
        text += formatted(
            "  solver  %.2f linear solves and %.2f factorisations per step, %s of processor time per step, %s per "
            "solve\n",
            solves / n, static_cast<double>(counts.factorisations) / n, readable(record.spent.steps / n, "s").c_str(),
            readable(record.spent.steps / solves, "s").c_str());
        if (counts.fan_fallbacks > 0)
            text += formatted("  Lemke   solved %lld steps on which this solver failed (Lemke fallback)\n",
                              Count(counts.fan_fallbacks));
        if (record.factor.unknowns > 0)
            text += formatted("  factor  of %lld unknowns with %lld entries, %.1f per unknown\n",
                              Count(record.factor.unknowns), Count(record.factor.entries),
                              static_cast<double>(record.factor.entries) / static_cast<double>(record.factor.unknowns));
    }
    for (const CutbackReason reason : cutback_reasons)
        if (const std::int64_t n = record.n_cutbacks[static_cast<std::size_t>(reason)]; n > 0)
            text += formatted("  cutbacks %lld: %s\n", Count(n), describe(reason).data());
    return text;
}

}  // namespace

std::string cutback_text(const Cutback& cut, const Vec2& where, double end) {
    const std::string text = formatted("cutback: t = %s, step %s -> %s at %s: %s\n", readable(cut.time, "s", 9).c_str(),
                                       readable(cut.from, "s", 4).c_str(), readable(cut.to, "s", 4).c_str(),
                                       place_text(where).c_str(), reason_text(cut).c_str());
    if (!cut.changes_to_explicit) return text;
    const auto steps = [&](double until) { return std::ceil((std::min(until, end) - cut.time) / cut.to); };
    return text + formatted(
                      "scheme: explicit from t = %s, since %s; at least %.0f steps of %s, %.4g if the body is not "
                      "quiet before time.end\n",
                      readable(cut.time, "s", 9).c_str(), describe(cut.reason).data(), steps(cut.explicit_until),
                      readable(cut.to, "s", 4).c_str(), steps(end));
}

std::string quiet_text(double time) {
    return formatted("scheme: implicit from t = %s, the body is quiet\n", readable(time, "s", 9).c_str());
}

std::string rigid_text(double time, std::size_t n_pieces) {
    return formatted("rigid: %zu pieces from t = %s on, nothing breaks\n", n_pieces, readable(time, "s", 9).c_str());
}

std::string stuck_text(const Cutback& cut, const Vec2& where, double smallest) {
    std::string text = formatted(
        "the run cannot continue from t = %s at %s: %s, even in a step of %s; the smallest step allowed is %s. ",
        readable(cut.time, "s", 9).c_str(), place_text(where).c_str(), reason_text(cut).c_str(),
        readable(cut.from, "s", 4).c_str(), readable(smallest, "s", 4).c_str());
    if (cut.reason == CutbackReason::contact_speed)
        return text + "Look at the units of velocities and loads, or use larger triangles where the faces meet.";
    if (cut.reason == CutbackReason::jammed)
        return text +
               "Look at the prescribed motions: they press a part against what cannot give way, or wedge it in. Or use "
               "less friction there.";
    if (const auto gate = std::ranges::find(gate_rules(), name_of(cut.reason), &GateRule::name);
        gate != gate_rules().end())  // contact_depth, contact_residual
        return text + std::string(gate->cure);
    const char* const alternatives =
        cut.reason == CutbackReason::assumption_1
            ? "time.bulk = \"auto\", which takes explicit steps where a body snaps "
              "back; or time.assumption_1 = \"ignore\" to continue with one of "
              "the solutions; or time.cohesion = \"explicit\"; or "
        : cut.reason == CutbackReason::not_converged
            ? "time.bulk = \"explicit\" with time.cohesion = \"explicit\", whose steps are solved vertex by vertex; or "
              "time.theta = 0.7 where it is smaller; or half the friction of the interface there, where it wedges the "
              "body; or "
            : "";
    return text + formatted("Try %stime.step_min = \"%s\"", alternatives, readable(1e-3 * smallest, "s").c_str());
}

std::string missing_text(const std::vector<std::string>& files) {
    if (files.empty()) return "";
    constexpr std::size_t n_named = 10;
    std::string named = files.front();
    for (std::size_t i = 1; i < std::min(files.size(), n_named); ++i) named += "; " + files[i];
    if (files.size() > n_named) named += "; and " + std::to_string(files.size() - n_named) + " more";
    return "warning[missing-file]: " + named +
           "; all other outputs are unaffected, --force computes the run again and writes all of them\n";
}

std::string not_dumped_text(const StepSelection& selected, std::int64_t before, std::int64_t now) {
    const std::string steps = selected.outside(before + 1, now);
    if (steps.empty()) return "";
    return "warning[dump-lcp]: --dump-lcp did not store " + steps + "; this command took " +
           (now > before ? formatted("steps %lld to %lld\n", Count(before + 1), Count(now)) : "no step\n");
}

std::string warning_text(const Gate& gate, const State& now) {
    std::string text =
        formatted("warning[%s]: t = %.9g s%s: %s: %s, more than %s", gate.name.data(), now.time,
                  at_place(gate.place).c_str(), gate.meaning.data(), value_text(gate.value, gate.unit, 4).c_str(),
                  value_text(gate.warning, gate.unit, 4).c_str());
    if (std::isfinite(gate.limit)) text += "; the run ends above " + value_text(gate.limit, gate.unit, 4);
    return text + ". " + std::string(gate.cure) + "\n";
}

std::string violated_text(const Gates& gates, const State& now, const Vec2& fastest) {
    std::string text;
    const Gate* cause = nullptr;  // the gate that may explain the others
    for (const Gate& gate : gates) {
        if (gate.pass()) continue;
        text += formatted("gate %s violated at t = %s (step %lld): %s%s, limit %s: %s. ", gate.name.data(),
                          readable(now.time, "s", 9).c_str(), Count(now.n_steps),
                          value_text(gate.value, gate.unit, 4).c_str(), at_place(gate.place).c_str(),
                          value_text(gate.limit, gate.unit, 4).c_str(), gate.meaning.data());
        if (cause == nullptr || gate.name == "interface_residual") cause = &gate;
    }
    if (cause == nullptr) return text;
    if (!cause->place) text += "The body moves fastest" + at_place(fastest) + ". ";
    return text + std::string(cause->cure);
}

std::string not_at_rest_text(double end) {
    return formatted(
        "warning[not-at-rest]: the body is not at rest at time.end = %s: a later time.end, a larger time.rest_below, "
        "or time.damping\n",
        readable(end, "s", 6).c_str());
}

std::string not_failed_text(const Scenario& scenario, const Summary& summary, Index n_breaks) {
    const bool can_break = std::ranges::any_of(scenario.laws, [](const NamedLaw& law) { return law.law.breakable(); });
    const double peak = summary["peak_stress"];
    if (!scenario.specimen || !can_break || !(peak > 0) || !std::isnan(summary["strength"])) return "";
    return formatted("warning[no-strength]: the specimen did not fail: %s, so peak_stress = %s is no strength\n",
                     n_breaks == 0 ? "nothing broke" : "its stress has not fallen by 5 % while interfaces broke",
                     shown_text(peak, "Pa", 6).c_str());
}

std::string damping_text(const SchemeOptions& scheme, const Model& model, const State& now, double time) {
    const bool is_free =
        !now.free_pieces.empty() || std::ranges::any_of(model.obstacles, [](const Obstacle& o) { return o.is_free(); });
    if (!is_free || scheme.damping == 0 || scheme.damping_of == DampingOf::motion) return "";
    return formatted(
        "damping: from t = %s on nothing holds %zu pieces of the body; there, and of free obstacles, time.damping acts "
        "on vibrations, not on flight, roll and slide (damping_of = \"motion\", as until 0.1: on both)\n",
        readable(time, "s", 9).c_str(), now.free_pieces.size());
}

std::string scheme_text(const TimeOptions& time, bool is_viscous) {
    const SchemeOptions& scheme = time.scheme;
    const char* const beta = scheme.cohesion == CohesionScheme::implicit_beta ? "implicit beta" : "explicit beta";
    if (scheme.bulk == BulkScheme::automatic)
        return formatted(
            "changes: implicit bulk (theta %g) and beta in large steps while the body is quiet%s, explicit bulk and "
            "beta where it is not%s%s",
            scheme.theta, time.start_in_equilibrium ? ", from equilibrium" : "",
            scheme.damping > 0 ? "; mass-proportional damping" : "", is_viscous ? "; viscosity of explicit steps" : "");
    if (scheme.bulk == BulkScheme::implicit_theta)
        return formatted(
            "implicit bulk (theta %g, %s mass%s), %s; all interfaces together: method of multipliers, sparse "
            "factorisations%s",
            scheme.theta, name_of(scheme.mass), time.start_in_equilibrium ? ", from equilibrium" : "", beta,
            scheme.damping > 0 ? "; mass-proportional damping" : "");
    return formatted("explicit lumped bulk, %s; one exact problem per vertex that may open%s%s", beta,
                     scheme.damping > 0 ? "; mass-proportional damping" : "", is_viscous ? "; viscosity" : "");
}

std::string probes_text(const std::vector<ProbeSubject>& subjects) {
    std::string text;
    for (const ProbeSubject& subject : subjects)
        text += "  probe `" + subject.probe + "` watches " + text_of(subject) + "\n";
    return text;
}

std::string probes_text(const Model& model, const std::vector<ProbeOptions>& probes) {
    return probes_text(Probes(model, probes).subjects());
}

std::string end_of_run(const RunRecord& record, const std::filesystem::path& directory) {
    const TimeSpent& spent = record.spent;
    const OutputTime& output = record.output;
    const std::string steps =
        record.largest_step > record.smallest_step * (1 + 1e-6)
            ? formatted("%lld steps of %s to %s", Count(record.steps), readable(record.smallest_step, "s", 4).c_str(),
                        readable(record.largest_step, "s", 4).c_str())
            : formatted("%lld steps of %s", Count(record.steps),
                        readable(record.steps > 0 ? record.largest_step : record.step, "s", 4).c_str());
    std::string text =
        formatted("%s: %s at t = %s after %s; %d triangles, %d interfaces; %.1f s (%.1f s of processor time)\n",
                  record.name.c_str(), record.status.c_str(), time_text(record.time).c_str(), steps.c_str(),
                  record.triangles, record.interfaces, spent.wall, spent.cpu);
    text += formatted("  processor time: mesh and model %.2f s, ", spent.model);
    if (spent.preload > 0) text += formatted("preload %.2f s, ", spent.preload);
    // differences of several clocks, which may be below zero by their resolution
    const double steps_alone = std::max(0.0, spent.steps), other = std::max(0.0, record.cpu_other()),
                 tables = std::max(0.0, output.cpu - output.frames - output.figures);
    text += formatted("steps %.2f s, frames %.2f s, figures %.2f s, other output %.2f s, remainder %.2f s\n",
                      steps_alone, output.frames, output.figures, tables, other);
    if (output.frames > 0)
        text += formatted("  frames are written by a thread of their own, for which steps waited %s\n",
                          readable(output.waited_for_frames, "s").c_str());
    if (record.ended == "rest")
        text +=
            "  ended before time.end: the body is at rest since t = " + time_text(record.summary["rest_time"]) + "\n";
    if (!record.reason.empty()) text += "  reason: " + sentences(record.reason, "\n          ") + "\n";
    text += solver_text(record);
    if (!record.summary.values.empty())
        text += "  energies and forces are those of the thickness of " + value_text(record.thickness, "m") + "\n";
    for (const auto& [name, value] : record.summary.values) {
        if (std::isnan(value)) continue;
        const bool of_driver = name == "reaction_x" || name == "reaction_y" || name == "largest_reaction";
        text += formatted("  %-24s %s", name.c_str(), value_text(value, unit_of("summary", name)).c_str());
        text += of_driver && !record.summary.reaction_of.empty() ? " (of " + record.summary.reaction_of + ")" : "";
        text += (name == "work_per_advance" ? shared_work_text(record.summary) : "") + "\n";
    }
    std::size_t width = 0;  // of the longest name
    for (const Gate& gate : record.gates) width = std::max(width, is_judged(gate) ? gate.name.size() : 0);
    for (const ExpectResult& result : record.expect) width = std::max(width, result.name.size());
    const int n = static_cast<int>(width);
    for (const Gate& gate : record.gates)
        if (is_judged(gate))
            text += formatted("  gate   %-*s %-16s limit %-16s %s%s\n", n, gate.name.data(),
                              value_text(gate.value, gate.unit, 4).c_str(),
                              std::isinf(gate.limit) ? "none" : value_text(gate.limit, gate.unit, 4).c_str(),
                              gate.pass() ? name_of(gate.level).data() : "VIOLATED",
                              gate.level == GateLevel::ok ? "" : at_place(gate.place).c_str());
    for (const ExpectResult& result : record.expect)
        text += "  expect " + padded(result.name, n) + " " + padded(result.shown_value, 16) + " " +
                padded(result.shown_limit, 24) + " " + (result.pass ? "ok" : "FAILED") + "\n";
    if (record.n_not_judged > 0)
        text += formatted("  expect: %zu number%s not judged, because the run failed\n", record.n_not_judged,
                          record.n_not_judged == 1 ? "" : "s");
    text += "run:     " + directory.string() + "\n";
    for (const auto& figure : record.figures) text += "figure:  " + figure.string() + "\n";
    return text;
}

}  // namespace knap
