#include "app/ensemble/convergence.hpp"

#include "app/ensemble/ensemble.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

constexpr double rounding = 1e-9;   // relative, of times of events in coarse steps
constexpr double min_order = 0.25;  // singular fields have 1/2, slowly decaying oscillations less

std::vector<double> finite(std::vector<double> values) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    return values;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Through the value `last` and the two before it.
std::optional<Extrapolation> extrapolate_three(const std::vector<double>& h, const std::vector<double>& value,
                                               std::size_t last) {
    const double ratio = h[last - 1] / h[last], coarse = value[last - 2], middle = value[last - 1], fine = value[last];
    if (std::abs(h[last - 2] / h[last - 1] - ratio) > 0.05 * ratio) return std::nullopt;
    // q(rh) - q(h) = C h^p (r^p - 1): two successive differences have the ratio r^p
    const double p = std::log((coarse - middle) / (middle - fine)) / std::log(ratio);
    if (!std::isfinite(p) || p <= 0) return std::nullopt;
    return Extrapolation{p, fine + (fine - middle) / (std::pow(ratio, p) - 1)};
}

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

Spread spread_of(const std::vector<double>& values) {
    const std::vector<double> sample = finite(values);
    if (sample.empty()) return {};
    const double m = mean(sample), n = static_cast<double>(sample.size());
    double squares = 0;
    for (const double v : sample) squares += (v - m) * (v - m);
    const auto [low, high] = std::ranges::minmax(sample);
    return {static_cast<int>(sample.size()), m, n > 1 ? std::sqrt(squares / (n - 1)) : 0, low, high};
}

double least_squares_slope(const std::vector<double>& x, const std::vector<double>& y) {
    const double mean_x = mean(x), mean_y = mean(y);
    double xx = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        xx += (x[i] - mean_x) * (x[i] - mean_x), xy += (x[i] - mean_x) * (y[i] - mean_y);
    const bool differ = xx > 1e-24 * static_cast<double>(x.size()) * mean_x * mean_x;  // by more than rounding
    return x.size() > 1 && differ ? xy / xx : NAN;
}

double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine) {
    const double order = std::log(error_coarse / error_fine) / std::log(h_coarse / h_fine);
    return std::isfinite(order) ? order : NAN;
}

double fitted_order(const std::vector<double>& h, const std::vector<double>& error) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < h.size(); ++i)
        if (std::isfinite(error[i]) && error[i] > 0) x.push_back(std::log(h[i])), y.push_back(std::log(error[i]));
    return least_squares_slope(x, y);
}

Trend trend_of(const std::vector<double>& gaps) {
    const std::vector<double> known = finite(gaps);
    if (!known.empty() && std::ranges::all_of(known, [](double gap) { return gap == 0; })) return Trend::same;
    if (known.size() < 2) return Trend::unknown;
    for (std::size_t i = 1; i < known.size(); ++i)
        if (known[i] > 0 && known[i] >= known[i - 1]) return Trend::does_not_fall;
    return Trend::falls;
}

std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value) {
    const std::size_t n = h.size();
    if (n < 3) return std::nullopt;
    std::vector<double> gaps;
    for (std::size_t i = 1; i < n; ++i) gaps.push_back(std::abs(value[i] - value[i - 1]));
    const auto found = extrapolate_three(h, value, n - 1);
    if (!found || found->order < 0.5 || found->order > 3 || trend_of(gaps) != Trend::falls) return std::nullopt;
    if (n == 3) return found;
    const auto before = extrapolate_three(h, value, n - 2);
    return before && std::abs(before->order - found->order) <= 0.3 ? found : std::nullopt;
}

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
