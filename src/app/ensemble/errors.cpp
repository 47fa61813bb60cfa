// Errors of a study and the orders in which they fall.
#include "app/ensemble/ensemble.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double rounding = 1e-9;
constexpr double min_order = 0.25;  // a slowly settling oscillation is below; singular fields have 1/2

/// 0 between values that are the same but for rounding, as times of events in coarse steps can be.
double difference(double a, double b) { return std::abs(a - b) <= rounding * std::abs(b) ? 0 : std::abs(a - b); }

/// What orders refer to: the length of the step, or a multiple of the sizes of the mesh.
double h_of(const Ensemble& study, std::size_t run) {
    // steps are rounded to divide the end, so their own length counts; a mesh is as fine as it was asked to be
    const double step = study.runs[run].result.step;
    return study.study.refine == Refine::step && std::isfinite(step) ? step : 1 / study.variants[run].level;
}

/// The finest finished run of the first line that has one.
std::size_t finest_run(const Ensemble& study, std::size_t q) {
    for (std::size_t line = 0; line < study.study.lines.size(); ++line) {
        const std::vector<std::size_t> runs = study.variants_of(line);
        for (auto run = runs.rbegin(); run != runs.rend(); ++run)
            if (std::isfinite(study.runs[*run].result.values[q])) return *run;
    }
    return 0;
}

/// Beside the finest run errors are too small where the steps are nearly as fine, and the order would come out too
/// large; the differences between neighbours fall with the same order and are free of that. Fills errors.order of these
/// runs.
LineOrder judge_line(const Ensemble& study, std::size_t q, const std::vector<std::size_t>& runs,
                     QuantityErrors& errors) {
    std::vector<double> h, value;
    for (const std::size_t run : runs) h.push_back(h_of(study, run)), value.push_back(study.runs[run].result.values[q]);
    LineOrder line;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const double error = errors.error[runs[i]];
        if (!errors.reference_run)
            line.gaps.push_back(error <= rounding ? 0 : error);
        else
            line.gaps.push_back(i + 1 < runs.size() ? difference(value[i], value[i + 1]) : NAN);
    }
    line.trend = trend_of(line.gaps);
    line.fitted = fitted_order(h, line.gaps);
    if (line.trend == Trend::falls && line.fitted < min_order) line.trend = Trend::does_not_fall;
    // differences of changing sign may shrink while the values are as far from the finest one as before
    std::vector<double> error;
    for (const std::size_t run : runs) error.push_back(errors.error[run]);
    const bool has_reference = errors.reference_run && std::ranges::find(runs, *errors.reference_run) != runs.end();
    line.errors_grow = line.trend == Trend::falls && has_reference && trend_of(error) == Trend::does_not_fall;
    if (line.errors_grow) line.trend = Trend::does_not_fall;
    if (line.trend != Trend::falls) {
        line.fitted = NAN;
        return line;
    }
    for (std::size_t i = 1; i < runs.size(); ++i)
        errors.order[runs[i]] = observed_order(h[i - 1], line.gaps[i - 1], h[i], line.gaps[i]);
    line.limit = extrapolate(h, value);
    return line;
}

QuantityErrors judge_quantity(const Ensemble& study, std::size_t q) {
    const StudyQuantity& quantity = study.quantities[q];
    const std::size_t n = study.runs.size();
    QuantityErrors errors{.error = std::vector<double>(n, NAN), .order = std::vector<double>(n, NAN)};
    if (!quantity.exact || study.study.against_finest) errors.reference_run = finest_run(study, q);
    errors.reference = errors.reference_run ? study.runs[*errors.reference_run].result.values[q] : *quantity.exact;
    errors.relative = quantity.scale || errors.reference != 0;
    const double scale = quantity.scale.value_or(errors.reference != 0 ? std::abs(errors.reference) : 1);
    for (std::size_t i = 0; i < n; ++i)
        if (i != errors.reference_run)
            errors.error[i] = std::abs(study.runs[i].result.values[q] - errors.reference) / scale;
    for (std::size_t line = 0; line < study.study.lines.size(); ++line)
        errors.lines.push_back(judge_line(study, q, study.variants_of(line), errors));
    return errors;
}

}  // namespace

void judge_errors(Ensemble& study) {
    study.errors.clear();
    for (std::size_t q = 0; q < study.quantities.size(); ++q) study.errors.push_back(judge_quantity(study, q));
}

}  // namespace knap
