#include "stepper/step_control.hpp"

#include <algorithm>
#include <limits>

namespace knap {
namespace {

constexpr int steps_until_growth = 10;
constexpr double growth = 1.5;

constexpr std::array<std::pair<std::string_view, std::string_view>, cutback_reasons.size()> reason_texts{{
    {"softening", "cohesion begins to fall"},
    {"release", "a fan splits"},
    {"assumption_1", "Assumption 1 does not hold, so the step has several solutions"},
    {"contact_speed", "faces that meet move by more than a twentieth of an edge"},
    {"not_converged", "the interface problem was not solved to its tolerance"},
}};

/// [s] Rounding of a time that is a sum of steps.
double time_rounding(const State& state, double time) {
    return static_cast<double>(state.n_steps + 1) * std::numeric_limits<double>::epsilon() * time;
}

}  // namespace

std::string_view name_of(CutbackReason reason) { return reason_texts[static_cast<std::size_t>(reason)].first; }
std::string_view describe(CutbackReason reason) { return reason_texts[static_cast<std::size_t>(reason)].second; }

void StepControl::start_from(const StepControl& earlier) {
    intact_ = earlier.intact_;
    if (!intact_) largest_ = std::min(largest_, limits_.cracking);
    step_ = earlier.step_ < earlier.largest_ ? std::min(earlier.step_, largest_) : largest_;
    n_good_ = earlier.n_good_;
}

bool StepControl::has_reached(const State& state, double time) {
    return state.time >= time - time_rounding(state, time);
}

double StepControl::tolerance(const State& begin) const {
    return std::min(time_rounding(begin, limits_.end), 0.25 * step_);
}

bool StepControl::depends_on_end(const State& begin) const {
    return limits_.end - begin.time < 2 * step_ - tolerance(begin);
}

double StepControl::next(const State& begin) const {
    const double left = limits_.end - begin.time;
    if (!depends_on_end(begin) || std::abs(left - step_) <= tolerance(begin)) return step_;
    return left < step_ ? left : 0.5 * left;
}

std::optional<CutbackReason> StepControl::reason_against(double h, const StepReport& report) const {
    if (report.rejection == Rejection::assumption_1) return CutbackReason::assumption_1;
    if (report.rejection == Rejection::contact_speed) return CutbackReason::contact_speed;
    if (report.rejection == Rejection::not_converged) return CutbackReason::not_converged;
    if (h <= limits_.cracking * (1 + 1e-12)) return std::nullopt;
    if (report.softened > 0) return CutbackReason::softening;
    return report.released > 0 ? std::optional(CutbackReason::release) : std::nullopt;
}

std::optional<Cutback> StepControl::judge(const State& begin, double h, const StepReport& report) {
    const std::optional<CutbackReason> reason = reason_against(h, report);
    const bool rejected = report.rejection != Rejection::none,
               breaks = !rejected && (report.softened > 0 || report.released > 0);
    if (breaks || reason == CutbackReason::assumption_1) {
        largest_ = std::min(largest_, limits_.cracking);
        intact_ = false;
    }
    if (!reason) {
        smallest_taken_ = largest_taken_ == 0 ? h : std::min(smallest_taken_, h);
        largest_taken_ = std::max(largest_taken_, h);
        step_ = std::min(step_, largest_);
        if (++n_good_ >= steps_until_growth) step_ = std::min(growth * step_, largest_), n_good_ = 0;
        return std::nullopt;
    }
    ++n_cutbacks_[static_cast<std::size_t>(*reason)];
    rejected_steps_ += report;
    const bool to_cracking = !rejected || (reason == CutbackReason::assumption_1 && h > limits_.cracking * (1 + 1e-12));
    step_ = to_cracking ? limits_.cracking : 0.5 * h;
    n_good_ = 0;
    stuck_ = step_ < limits_.smallest;
    return Cutback{.reason = *reason, .time = begin.time, .from = h, .to = step_};
}

Vec2 place_of_damage(const Model& model, const State& begin, const State& end) {
    Index worst = -1;
    double largest_loss = 0;
    for (std::size_t rank = 0; rank < end.split_fans.size(); ++rank) {
        const Index fan = end.split_fans[rank], before = begin.split_rank[fan];
        double loss = 0;
        for (Index i = 0; i < model.fans[fan].n_points; ++i) {
            const FanPoint& point = model.fan_points[model.fans[fan].first_point + i];
            if (point.cracked || model.laws[point.law].sigma_c <= 0) continue;
            const double had = before >= 0 ? begin.points[begin.first_point[before] + i].cohesion : 1;
            loss = std::max(loss, had - end.points[end.first_point[rank] + i].cohesion);
        }
        if (loss > largest_loss || (worst < 0 && before < 0)) worst = fan, largest_loss = loss;
    }
    return worst < 0 ? Vec2::Zero() : model.mesh.corner(model.fan_corners[model.fans[worst].first_corner]);
}

}  // namespace knap
