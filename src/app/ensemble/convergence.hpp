#pragma once
// Statistics of a sample, orders of convergence and extrapolation. Values that are not finite (a failed run, an event
// that did not happen) are left out.
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace knap {

struct Spread {
    int n = 0;                                                          // finite values
    double mean = NAN, deviation = NAN, smallest = NAN, largest = NAN;  // sample standard deviation, 0 for n = 1
};
Spread spread_of(const std::vector<double>& values);

/// Least-squares slope sum (x - mean x)(y - mean y) / sum (x - mean x)^2; NaN with fewer than two different x.
double least_squares_slope(const std::vector<double>& x, const std::vector<double>& y);

/// p of e = C h^p through two errors; NaN where one is 0 or not finite.
double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine);

/// Least-squares slope of log e over log h; NaN with fewer than two positive finite errors.
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);

/// Behaviour of errors, or of differences between neighbouring levels, from coarse to fine. 0 is a difference of
/// rounding. An order has a meaning only where they fall at every step: a fit gives one for an oscillation, too.
enum class Trend { unknown, same, falls, does_not_fall };
Trend trend_of(const std::vector<double>& gaps);

struct Extrapolation {
    double order, value;
};
/// L. F. Richardson (1911): q(h) = q(0) + C h^p through the last three values, whose h have a constant ratio. Nothing
/// unless the differences fall along the whole line, p is between 1/2 (singular fields) and 3, and the three values
/// before the last, if there are, give the same p within 0.3.
std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value);

/// Convergence of one quantity along one line of a study.
struct LineOrder {
    std::vector<double> gaps;  // errors from an exact value, or differences between neighbouring levels
    Trend trend = Trend::unknown;
    bool errors_grow = false;  // although the differences fall: these change sign
    double fitted = NAN;       // order; NaN where the gaps do not fall
    std::optional<Extrapolation> limit;
};

struct QuantityErrors {
    double reference = NAN;
    std::optional<std::size_t> reference_run;  // none: an exact value
    bool relative = true;                      // to the scale or the reference; false: the reference is 0
    std::vector<double> error, order;          // per run; the order from the previous run
    std::vector<LineOrder> lines;
};

}  // namespace knap
