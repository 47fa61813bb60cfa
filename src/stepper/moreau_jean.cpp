#include "stepper/moreau_jean.hpp"

#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "model/mass_scaling.hpp"
#include "model/time_tables.hpp"
#include "stepper/common/changing_friction.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "stepper/common/law_change.hpp"
#include "stepper/common/surface_energy.hpp"
#include "stepper/explicit/explicit_scheme.hpp"
#include "stepper/implicit/implicit_scheme.hpp"
#include "stepper/islands.hpp"
#include "stepper/scheme_change.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {

MoreauJean::MoreauJean(const Model& model, const SchemeOptions& options) : model_(model), options_(options) {
    if (!changes()) make_scheme(options.takes_implicit_steps());
    if (options.rigid.active()) rigid_ = std::make_unique<RigidScheme>(model, options);
    if (model.heat) heat_.emplace(model);
    friction_follows_slip_ = follows_slip(model);
}

MoreauJean::~MoreauJean() = default;

/// Blows are waves: islands take explicit steps also where the other steps are implicit.
void MoreauJean::resolve_islands(const StepLimits& limits) {
    if (!rigid_ || !may_be_parted(model_)) return;
    constexpr double safety = 0.8;
    SchemeOptions options = options_;
    StepLimits of_island = limits;
    if (options.takes_implicit_steps()) {
        options.cohesion = CohesionScheme::explicit_beta;
        of_island.cracking = safety * std::ranges::min(stable_steps(model_));
    }
    islands_ = std::make_unique<Islands>(model_, options, of_island, *rigid_);
}

bool MoreauJean::is_implicit(const State& begin) const {
    return changes() ? begin.has_end_velocities() : implicit_ != nullptr;
}

void MoreauJean::make_scheme(bool implicit) {
    SchemeOptions options = options_;
    if (changes()) options.cohesion = implicit ? CohesionScheme::implicit_beta : CohesionScheme::explicit_beta;
    if (implicit) implicit_ = std::make_unique<ImplicitScheme>(model_, options);
    else explicit_ = std::make_unique<ExplicitScheme>(model_, options);
    if (give_up_ != nullptr) give_up_when(give_up_);
}

/// theta of a first implicit step after explicit ones reverses no rate of a contact (scheme_change.hpp).
SchemeOptions MoreauJean::options_of(const State& begin, double h) const {
    SchemeOptions options = options_;
    if (!begins_implicit_stage(begin, h)) return options;
    if (begin.split_fans.empty() && begin.face_contacts.empty()) return options;
    double restitution = 0;
    for (const std::vector<ContactLaw>& of_material : model_.contact_of_pair)
        for (const ContactLaw& law : of_material) restitution = std::max(restitution, law.restitution);
    for (const CohesiveLaw& law : model_.laws) restitution = std::max(restitution, law.restitution);
    for (const Obstacle& obstacle : model_.obstacles)
        restitution = std::max(restitution, obstacle.largest_restitution());
    options.theta = 1 / (1 + restitution);
    return options;
}

StepScheme& MoreauJean::scheme_of(const State& begin, double h) {
    if (begin.motion == Motion::rigid) return *rigid_;
    const bool implicit = is_implicit(begin);
    const std::unique_ptr<StepScheme>& scheme = implicit ? implicit_ : explicit_;
    if (!scheme) make_scheme(implicit);
    if (implicit && changes()) scheme->set_theta(options_of(begin, h).theta);
    return *scheme;
}

void MoreauJean::begin(State& start) const {
    if (changes()) begin_theta_scheme(start);
    if (rigid_) start.motion = !changes() && rigid_->may_begin(start) ? Motion::rigid : Motion::thawed;
}

std::optional<StepReport> MoreauJean::thaw(State& now, State& end) {
    if (!now.frozen) {
        now.motion = Motion::thawed;
        return {};
    }
    const double h = now.last_step * closing_part;
    StepReport report = complete(now, h, rigid_->thaw(now, h, end), end);
    end.last_step = 0;
    return report;
}

void MoreauJean::give_up_when(GiveUp condition) {
    give_up_ = condition;
    for (const auto& scheme : {&explicit_, &implicit_})
        if (*scheme) (*scheme)->give_up_when(condition);
}

double MoreauJean::stable_step() const {
    if (!options_.takes_explicit_steps()) return infinity;
    return std::ranges::min(stable_steps(model_));
}

FactorSize MoreauJean::factor_size() const { return implicit_ ? implicit_->factor_size() : FactorSize{}; }

double MoreauJean::step_size(const State& begin, double h) const {
    return is_implicit(begin) ? step_to_corner(model_, begin.time, h) : h;
}

StepReport MoreauJean::step(const State& begin, double h, State& end) {
    assert(h > 0 && &begin != &end);
    if (heat_) end.temperature = heat_->after(begin, h, is_implicit(begin));
    return advance(begin, h, end);
}

StepReport MoreauJean::close_leapfrog(const State& begin, State& end) {
    end.temperature = begin.temperature;
    StepReport report = advance(begin, closing_part * begin.last_step, end);
    if (report.residual > max_residual) report.rejection = Rejection::not_converged;
    if (report.rejection != Rejection::none) return report;
    std::vector<Vec2> force;
    const double strain = elastic_energy(model_, end, force);
    report.step_change_work += strain - report.strain;
    report.strain = strain;
    begin_theta_scheme(end);
    return report;
}

/// With the temperatures of the end already there.
StepReport MoreauJean::advance(const State& begin, double h, State& end) {
    if (begin.motion == Motion::rigid && islands_) return complete(begin, h, islands_->step(begin, h, end), end);
    StepReport report = scheme_of(begin, h).step(begin, h, end);
    const bool just_thawed = begin.motion == Motion::thawed && begin.last_step == 0 && begin.n_steps > 0;
    if (just_thawed && report.rejection == Rejection::none)
        report.thaw_dissipation = dissipated_since(model_, begin, end, [](Index) { return true; });
    return complete(begin, h, report, end);
}

StepReport MoreauJean::complete(const State& begin, double h, StepReport report, State& end) const {
    if (heat_) end.temperature_before = begin.temperature;
    if (model_.laws_follow_temperature) account_law_change(model_, begin, report);
    if (report.rejection != Rejection::none) return report;
    if (friction_follows_slip_) follow_slip(model_, begin, end);
    end.time = begin.time + h;
    end.last_step = h;
    end.n_steps = begin.n_steps + 1;
    if (begin.motion == Motion::thawed) end.motion = Motion::thawed, end.frozen = nullptr, end.rigid_pieces.clear();
    if (std::isfinite(report.kinetic + report.strain)) return report;
    throw SimulationError(formatted("the motion is no longer finite at t = %s (step %lld) at ",
                                    readable(end.time, "s", 9).c_str(), static_cast<long long>(end.n_steps)) +
                          place_text(place_of_largest_speed(model_, end)) +
                          ": the step is probably too large, or a load or velocity has a wrong unit; try a smaller "
                          "time.step");
}

}  // namespace knap
