// Errors of the runs of a study and how they converge along each of its lines.
#include "app/ensemble/ensemble.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double rounding = 1e-9;   // relative, of times of events in coarse steps
constexpr double min_order = 0.25;  // singular fields have 1/2, slowly decaying oscillations less

/// The length of the step as it is (it is rounded to divide the end time), or the requested sizes of the mesh relative
/// to those of the scenario.
double h_of(const Ensemble& study, std::size_t run) {
    const double step = study.runs[run].result.step;
    return study.study.refine == Refine::step && std::isfinite(step) ? step : 1 / study.variants[run].level;
}

/// The finest run with a value, of the first line that has one.
std::size_t finest_run(const Ensemble& study, std::size_t q) {
    for (std::size_t line = 0; line < study.study.lines.size(); ++line) {
        std::vector<std::size_t> runs = study.variants_of(line);
        std::ranges::reverse(runs);
        for (const std::size_t run : runs)
            if (std::isfinite(study.runs[run].result.values[q])) return run;
    }
    return 0;
}

/// Errors relative to the finest run are too small, and their order too large, where the steps are nearly as fine; the
/// differences between neighbouring levels fall with the same order without this bias. Sets errors.order of `runs`.
LineOrder judge_line(const Ensemble& study, std::size_t q, const std::vector<std::size_t>& runs,
                     QuantityErrors& errors) {
    std::vector<double> h, value, error;
    for (const std::size_t run : runs) {
        h.push_back(h_of(study, run));
        value.push_back(study.runs[run].result.values[q]);
        error.push_back(errors.error[run]);
    }
    LineOrder line;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        if (errors.reference_run) {
            const double next = i + 1 < runs.size() ? value[i + 1] : NAN, difference = std::abs(value[i] - next);
            line.gaps.push_back(difference <= rounding * std::abs(next) ? 0 : difference);
        } else line.gaps.push_back(error[i] <= rounding ? 0 : error[i]);
    }
    line.trend = trend_of(line.gaps);
    line.fitted = fitted_order(h, line.gaps);
    // differences of changing sign may fall while the values stay as far from the finest one
    const bool has_reference = errors.reference_run && std::ranges::count(runs, *errors.reference_run) > 0;
    const bool too_slow = line.trend == Trend::falls && line.fitted < min_order;
    line.errors_grow =
        line.trend == Trend::falls && !too_slow && has_reference && trend_of(error) == Trend::does_not_fall;
    if (too_slow || line.errors_grow) line.trend = Trend::does_not_fall;
    if (line.trend != Trend::falls) {
        line.fitted = NAN;
        return line;
    }
    for (std::size_t i = 1; i < runs.size(); ++i)
        errors.order[runs[i]] = observed_order(h[i - 1], line.gaps[i - 1], h[i], line.gaps[i]);
    line.limit = extrapolate(h, value);
    return line;
}

}  // namespace

void judge_errors(Ensemble& study) {
    study.errors.clear();
    const std::size_t n = study.runs.size();
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
        const StudyQuantity& quantity = study.quantities[q];
        QuantityErrors errors{.error = std::vector<double>(n, NAN), .order = std::vector<double>(n, NAN), .lines = {}};
        if (!quantity.exact || study.study.against_finest) errors.reference_run = finest_run(study, q);
        errors.reference = errors.reference_run ? study.runs[*errors.reference_run].result.values[q] : *quantity.exact;
        errors.relative = quantity.scale || errors.reference != 0;
        const double scale = quantity.scale.value_or(errors.reference != 0 ? std::abs(errors.reference) : 1);
        for (std::size_t i = 0; i < n; ++i)
            if (i != errors.reference_run)
                errors.error[i] = std::abs(study.runs[i].result.values[q] - errors.reference) / scale;
        for (std::size_t line = 0; line < study.study.lines.size(); ++line)
            errors.lines.push_back(judge_line(study, q, study.variants_of(line), errors));
        study.errors.push_back(std::move(errors));
    }
}

}  // namespace knap
