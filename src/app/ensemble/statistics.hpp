#pragma once
// Spread of a sample, least squares, orders of convergence. Values that are not finite (a run failed, an event never
// happened) are left out.
#include <optional>
#include <vector>

namespace knap {

struct Spread {
    int n = 0;                                  // finite values
    double mean, deviation, smallest, largest;  // NaN for n = 0; the standard deviation of a sample, 0 for n = 1
};
Spread spread_of(const std::vector<double>& values);

/// Slope of the line of least squares: sum (x - mean x)(y - mean y)/sum (x - mean x)^2; NaN with less than two
/// different x.
double least_squares_slope(const std::vector<double>& x, const std::vector<double>& y);

/// p of e = C h^p through two errors; NaN where one is 0 or not finite.
double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine);

/// p of the line of least squares through (log h, log e); NaN with less than two errors that are positive and finite.
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);

/// Behaviour of errors, or of differences between neighbours, from coarse to fine; 0 is a difference of rounding. An
/// order is meaningful only where they fall at every step: a fit gives one to a quantity that oscillates, too.
enum class Trend { unknown, same, falls, does_not_fall };
Trend trend_of(const std::vector<double>& gaps);

/// L. F. Richardson (1911): q(h) = q(0) + C h^p through the last three values, coarse to fine, whose h are in constant
/// ratio. Nothing unless the order is clean: differences fall along the whole line, the order is between 1/2 (singular
/// fields) and 3, and the three values before the last one (if there are) give the same within 0.3.
struct Extrapolation {
    double order, value;
};
std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value);

}  // namespace knap
