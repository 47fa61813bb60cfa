#include "stepper/step_control.hpp"

#include "stepper/common/contact_search.hpp"

#include <algorithm>
#include <limits>

namespace knap {
namespace {

constexpr int steps_until_growth = 10;
constexpr int after_fast_contact = 3;  // in a run of implicit steps: too long ones are refused before they are solved
constexpr double growth = 1.5;
constexpr double growth_implicit = 2, cut_implicit = 0.25;  // [-] in a run that changes scheme
constexpr int first_wait = 8, longest_wait = 128;           // steps
constexpr double most_opened = 0.5, aimed_opened = 0.4;     // [-] StepReport::largest_opened after a hard impact
constexpr double opened_to_grow = 0.25;                     // [-] likewise
constexpr double passages_of_impact = 2;
constexpr double least_against_contact = 1. / 1024;  // [-] of the largest step: ten halvings

bool is_of_contact(CutbackReason reason) {
    return reason == CutbackReason::contact_speed || reason == CutbackReason::contact_depth ||
           reason == CutbackReason::contact_residual;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, cutback_reasons.size()> reason_texts{{
    {"softening", "cohesion begins to fall"},
    {"release", "a fan splits"},
    {"assumption_1", "Assumption 1 does not hold, so the step has several solutions"},
    {"contact_speed", "faces that meet move by more than a twentieth of an edge, of rigid pieces a fifth"},
    {"contact_depth", "free faces lie deeper in each other than limits.contact_depth"},
    {"contact_residual",
     "contacts of free faces and obstacles do not obey their laws to a millionth of their speeds, or bring energy"},
    {"not_converged", "the interface problem was not solved to its tolerance"},
    {"motion", "the body moves faster than a large implicit step resolves"},
    {"cohesive_work", "a large implicit step misses the work of cohesion, or its end lies beyond the strength"},
    {"jammed", "contacts are driven against each other, and no motion was found that obeys their laws"},
    {"impact", "a hard impact moves faces by more than the critical opening"},
    {"blow", "a piece is hit, or vibrates, so hard that it may break; the body is deformable now"},
}};

/// [s] Rounding of a time that is a sum of steps.
double time_rounding(const State& state, double time) {
    return static_cast<double>(state.n_steps + 1) * std::numeric_limits<double>::epsilon() * time;
}

}  // namespace

std::string_view name_of(CutbackReason reason) { return reason_texts[static_cast<std::size_t>(reason)].first; }
std::string_view describe(CutbackReason reason) { return reason_texts[static_cast<std::size_t>(reason)].second; }

void StepControl::start_from(const StepControl& earlier, const State& start) {
    change_.start_from(earlier.change_);
    if (limits_.changes()) {
        if (!start.has_end_velocities()) begin_stage(limits_.change.explicit_step, limits_.change.explicit_step);
        return;
    }
    intact_ = earlier.intact_;
    if (!intact_) largest_ = std::min(largest_, limits_.cracking);
    step_ = earlier.step_ < earlier.largest_ ? std::min(earlier.step_, largest_) : largest_;
    n_good_ = earlier.n_good_;
}

void StepControl::go_on_after_impact(double time) { struck_until_ = time + passages_of_impact * limits_.passage; }

bool StepControl::has_reached(const State& state, double time) {
    return state.time >= time - time_rounding(state, time);
}

double StepControl::tolerance(const State& begin) const {
    return std::min(time_rounding(begin, limits_.end), 0.25 * size(begin));
}

bool StepControl::depends_on_end(const State& begin) const {
    return limits_.end - begin.time < 2 * size(begin) - tolerance(begin);
}

double StepControl::next(const State& begin) const {
    const double left = limits_.end - begin.time, step = size(begin);
    if (!depends_on_end(begin) || std::abs(left - step) <= tolerance(begin)) return step;
    return left < step ? left : 0.5 * left;
}

std::optional<Cutback> StepControl::reason_against(const State& begin, double h, const StepReport& report) const {
    Cutback cut{.reason = CutbackReason::softening, .time = begin.time, .from = h, .to = h};
    const auto because = [&](CutbackReason reason, std::optional<Vec2> place = std::nullopt, double value = 0) {
        cut.reason = reason, cut.place = place, cut.value = value;
        return cut;
    };
    switch (report.rejection) {
        case Rejection::assumption_1: return because(CutbackReason::assumption_1, report.where);
        case Rejection::contact_speed:
            return because(CutbackReason::contact_speed, report.where, report.rejected_value);
        case Rejection::contact_residual:
            return because(CutbackReason::contact_residual, report.where, report.rejected_value);
        case Rejection::not_converged: return because(CutbackReason::not_converged, report.where);
        case Rejection::jammed: return because(CutbackReason::jammed, report.where);
        case Rejection::turn: return because(CutbackReason::motion, report.where, report.rejected_value);
        case Rejection::blow:  // judge_rigid
        case Rejection::none:
        case Rejection::too_coarse: break;
    }
    if (report.contact_depth > limits_.contact_depth)
        return because(CutbackReason::contact_depth, report.depth_place, report.contact_depth);
    if (report.contact_residual > max_contact_residual)
        return because(CutbackReason::contact_residual, report.residual_place, report.contact_residual);
    if (h > least_after_impact() * (1 + 1e-12)) {
        const double covered = report.approach * h / limits_.critical_opening;  // [-]
        if (!is_struck(begin) && covered > hard_impact)
            return because(CutbackReason::impact, report.approach_place, covered);
        if (is_struck(begin) && report.largest_opened > most_opened)
            return because(CutbackReason::impact, std::nullopt, report.largest_opened / aimed_opened);
    }
    if (limits_.changes()) {
        // right after a change of scheme a body at rest has rates near rounding, which another step may resolve
        if (report.residual > max_residual) return because(CutbackReason::not_converged);
        switch (begin.has_end_velocities() ? change_.fault(report) : StepFault::none) {
            case StepFault::motion: return because(CutbackReason::motion);
            case StepFault::cohesive_work: return because(CutbackReason::cohesive_work);
            case StepFault::none: return std::nullopt;
        }
    }
    if (h <= limits_.cracking * (1 + 1e-12)) return std::nullopt;
    if (report.softened > 0) return because(CutbackReason::softening);
    return report.released > 0 ? std::optional(because(CutbackReason::release)) : std::nullopt;
}

/// A step of rigid pieces. What cannot be resolved with smaller ones is left to the deformable body; what islands
/// cannot resolve has the reason of their own steps.
std::optional<Cutback> StepControl::judge_rigid(const State& begin, double h, const StepReport& report) {
    constexpr double aimed_motion = 0.8;
    const double motion = std::max(report.contact_motion, 1e-300), smallest = limits_.rigid.smallest;
    const double fitting = std::min(aimed_motion / motion, growth) * h;
    if (report.rejection == Rejection::none) {
        rigid_step_ = std::clamp(fitting, smallest, limits_.rigid.step);
        smallest_taken_ = largest_taken_ == 0 ? h : std::min(smallest_taken_, h);
        largest_taken_ = std::max(largest_taken_, h);
        if (report.micro_steps > 0) thawed_time_ += h;
        return std::nullopt;
    }
    Cutback cut = reason_against(begin, h, report)
                      .value_or(Cutback{.time = begin.time, .from = h, .to = h, .place = report.where});
    cut.value = report.rejected_value;
    if (report.contact_depth > limits_.contact_depth) cut.reason = CutbackReason::contact_depth;
    if (report.rejection == Rejection::blow) {
        cut.reason = CutbackReason::blow, cut.thaws = true, cut.to = step_;
        deformable_until_ = begin.time + h + limits_.rigid.hold;
    } else {
        // speeds are those of the start of the step, so that a motion is in proportion to it
        cut.to = rigid_step_ = std::max(motion > 1 ? fitting : 0.5 * h, smallest);
        if (stuck_ = h <= smallest; stuck_) cut.to = 0.5 * smallest;
    }
    ++n_cutbacks_[static_cast<std::size_t>(cut.reason)];
    return cut;
}

std::optional<Cutback> StepControl::judge(const State& begin, double h, const StepReport& report) {
    if (begin.motion == Motion::rigid) return judge_rigid(begin, h, report);
    std::optional<Cutback> cut = reason_against(begin, h, report);
    if (report.rejection == Rejection::none && report.approach * largest_ > hard_impact * limits_.critical_opening)
        struck_until_ = begin.time + passages_of_impact * limits_.passage;
    const bool rejected = report.rejection != Rejection::none || (cut && is_of_contact(cut->reason)),
               several_solutions = cut && cut->reason == CutbackReason::assumption_1,
               breaks = !rejected && (report.softened > 0 || report.released > 0),
               is_large = limits_.changes() && begin.has_end_velocities();
    if ((breaks || several_solutions) && !limits_.changes()) {
        largest_ = std::min(largest_, limits_.cracking);
        intact_ = false;
    }
    if (!cut) {
        if (begin.motion == Motion::thawed) {
            thawed_time_ += h;
            if (report.softened > 0 || report.released > 0)
                deformable_until_ = std::max(deformable_until_, begin.time + h + limits_.rigid.hold);
        }
        smallest_taken_ = largest_taken_ == 0 ? h : std::min(smallest_taken_, h);
        largest_taken_ = std::max(largest_taken_, h);
        step_ = std::min(step_, largest_);
        change_.after_step(begin, h, report);  // a run with bulk = "auto" may start from this one
        if (is_large) {
            ++n_good_;
            if (h >= unsolved_) unsolved_ = infinity;
            const double larger = std::min(growth_implicit * step_, largest_);
            if (change_.is_beyond_rejected(begin.time + h) && (larger < unsolved_ || n_good_ >= patience_))
                step_ = larger;
            return std::nullopt;
        }
        opened_ = std::max(opened_, report.largest_opened);
        const bool met_fast =
            begin.has_end_velocities() && n_cutbacks_[static_cast<std::size_t>(CutbackReason::contact_speed)] > 0;
        if (++n_good_ < (met_fast ? after_fast_contact : steps_until_growth)) return std::nullopt;
        if (!is_struck(begin) || growth * opened_ <= opened_to_grow) step_ = std::min(growth * step_, largest_);
        n_good_ = 0, opened_ = 0;
        return std::nullopt;
    }
    ++n_cutbacks_[static_cast<std::size_t>(cut->reason)];
    rejected_steps_ += report;
    if (is_large) {
        shorten_or_change(*cut);
        return cut;
    }
    const bool to_cracking =
        (!rejected && !limits_.changes()) || (several_solutions && h > limits_.cracking * (1 + 1e-12));
    cut->to = step_ = to_cracking ? limits_.cracking : 0.5 * h;
    if (cut->reason == CutbackReason::impact)
        cut->to = step_ = std::max(std::min(h / cut->value, largest_), least_after_impact());
    n_good_ = 0, opened_ = 0;
    stuck_ = step_ < smallest_against(cut->reason);
    return cut;
}

/// After a rejected implicit step: a shorter one, or explicit steps.
void StepControl::shorten_or_change(Cutback& cut) {
    change_.rejected(cut.time, cut.from);
    if (cut.reason == CutbackReason::not_converged || cut.reason == CutbackReason::jammed) {
        patience_ = cut.from >= unsolved_ ? std::min(2 * patience_, longest_wait) : first_wait;
        unsolved_ = cut.from;
    }
    n_good_ = 0;
    if (cut.from > limits_.cracking * (1 + 1e-12)) {
        cut.to = step_ = std::max(cut_implicit * cut.from, limits_.cracking);
        return;
    }
    cut.changes_to_explicit = true;
    change_.to_explicit(cut.time);
    cut.explicit_until = change_.earliest_end();
    changes_.push_back({cut.time, true, cut.reason});
    begin_stage(limits_.change.explicit_step, limits_.change.explicit_step);
    cut.to = step_;
}

bool StepControl::ends_explicit_stage(const State& now) const {
    return limits_.changes() && now.motion != Motion::rigid && !now.has_end_velocities() && now.last_step > 0 &&
           change_.is_quiet(now.time);
}

void StepControl::begin_implicit_stage(const State& now, const StepReport& closing) {
    change_.to_implicit(now.time, closing);
    changes_.push_back({now.time, false, {}});
    begin_stage(limits_.cracking, limits_.largest);
}

void StepControl::begin_stage(double step, double largest) {
    step_ = step, largest_ = largest;
    n_good_ = 0, unsolved_ = infinity;
}

double StepControl::least_after_impact() const {
    return std::min(largest_, smallest_against(CutbackReason::contact_speed));
}

double StepControl::smallest_against(CutbackReason reason) const {
    return is_of_contact(reason) ? std::max(limits_.smallest, least_against_contact * largest_) : limits_.smallest;
}

Vec2 place_of(const Cutback& cut, const Model& model, const State& begin, const State& end) {
    if (cut.place) return *cut.place;
    return cut.reason == CutbackReason::motion ? place_of_largest_speed(model, end)
                                               : place_of_damage(model, begin, end);
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
