// Errors of a study and the orders in which they fall.
#include "app/convergence.hpp"
#include "app/study.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The finest finished run of the first line that has one.
std::size_t finest_run(const Study& study, std::size_t q) {
    for (std::size_t line = 0; line < study.plan.options.lines.size(); ++line) {
        const std::vector<std::size_t> runs = study.runs_of(line);
        for (auto run = runs.rbegin(); run != runs.rend(); ++run)
            if (std::isfinite(study.results[*run].values[q])) return *run;
    }
    return 0;
}

constexpr double rounding = 1e-9;
constexpr double least_order = 0.25;  // what goes to and fro and settles slowly is below; singular fields have 1/2

/// 0 between values that are the same but for rounding, as times of events in coarse steps can be.
double difference(double a, double b) { return std::abs(a - b) <= rounding * std::abs(b) ? 0 : std::abs(a - b); }

/// Orders of one line. Beside the finest run errors are too small where the steps are nearly as fine, and the order would come out too
/// large; the differences between neighbours fall with the same order and are free of that.
void judge_line(const Study& study, std::size_t q, std::size_t line, StudyErrors& errors) {
    const std::vector<std::size_t> runs = study.runs_of(line);
    const std::vector<double> h = study.h(line);
    std::vector<double> value, gap;
    for (const std::size_t run : runs) value.push_back(study.results[run].values[q]);
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const double error = errors.error[runs[i]];
        gap.push_back(errors.exact ? (error <= rounding ? 0 : error) : i + 1 < runs.size() ? difference(value[i], value[i + 1]) : NAN);
    }
    const double fitted = fitted_order(h, gap);
    const Trend trend = trend_of(gap) == Trend::falls && fitted < least_order ? Trend::does_not_fall : trend_of(gap);
    const bool falls = trend == Trend::falls;
    for (std::size_t i = 1; i < runs.size() && falls; ++i) errors.order[runs[i]] = observed_order(h[i - 1], gap[i - 1], h[i], gap[i]);
    errors.fitted.push_back(falls ? fitted : NAN);
    errors.gaps.push_back(gap);
    errors.trend.push_back(trend);
    const auto beyond = falls ? extrapolate(h, value) : std::nullopt;
    errors.extrapolated.push_back(beyond ? std::optional(beyond->value) : std::nullopt);
    errors.extrapolated_order.push_back(beyond ? std::optional(beyond->order) : std::nullopt);
}

StudyErrors judge_quantity(const Study& study, std::size_t q) {
    const StudyQuantity& quantity = study.plan.options.quantities[q];
    const std::size_t n = study.results.size();
    StudyErrors errors{.exact = quantity.exact.has_value() && !study.plan.options.against_finest};
    errors.error.assign(n, NAN);
    errors.order.assign(n, NAN);
    errors.reference_run = errors.exact ? n : finest_run(study, q);
    errors.reference = errors.exact ? *quantity.exact : study.results[errors.reference_run].values[q];
    errors.relative = quantity.scale || errors.reference != 0;
    const double scale = quantity.scale ? *quantity.scale : errors.reference != 0 ? std::abs(errors.reference) : 1;
    for (std::size_t i = 0; i < n; ++i)
        if (i != errors.reference_run) errors.error[i] = std::abs(study.results[i].values[q] - errors.reference) / scale;
    for (std::size_t line = 0; line < study.plan.options.lines.size(); ++line) judge_line(study, q, line, errors);
    return errors;
}

}  // namespace

std::vector<std::size_t> Study::runs_of(std::size_t line) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < plan.runs.size(); ++i)
        if (plan.runs[i].line == line) found.push_back(i);
    return found;
}

std::vector<double> Study::h(std::size_t line) const {
    std::vector<double> h;
    // steps are rounded to divide the end, so their own length counts; a mesh is as fine as it was asked to be
    for (const std::size_t run : runs_of(line))
        h.push_back(plan.options.refine == Refine::step && std::isfinite(results[run].step) ? results[run].step : 1 / plan.runs[run].level);
    return h;
}

void judge_study(Study& study) {
    for (std::size_t q = 0; q < study.plan.options.quantities.size(); ++q) study.errors.push_back(judge_quantity(study, q));
}

}  // namespace knap
