#pragma once
// Orders of convergence, extrapolation, and the spread of a sample.
#include <optional>
#include <vector>

namespace knap {

/// p of e = C h^p through two errors; NaN where one is 0 or not finite.
double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine);

/// p of the least-squares line through (log h, log e); NaN with less than two errors that are positive and finite.
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);

/// What errors, or differences between neighbours, do from coarse to fine; what is not finite (a run that failed) is passed over, 0 is a difference of rounding.
/// An order has a meaning only where they fall at every step: of a quantity that goes to and fro a line of least squares has one too.
enum class Trend { unknown, same, falls, does_not_fall };
Trend trend_of(const std::vector<double>& gaps);

/// L. F. Richardson (1911): q(h) = q(0) + C h^p through the values of three steps in constant ratio, coarse to fine.
struct Extrapolation {
    double order, value;
};
/// Nothing where the values do not come closer monotonically.
std::optional<Extrapolation> extrapolate(double ratio, double coarse, double middle, double fine);

/// The same for a whole line, steps `h` from coarse to fine: from the last three, and only where the order is clean: differences
/// fall along the whole line, the order is between a half and three (singular fields, and what a scheme can do), and the three before them (if there are) give
/// the same within 0.3.
std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value);

/// A sample without its not-a-numbers (what never happened).
struct Spread {
    int n = 0;
    double mean, deviation, smallest, largest;  // NaN of an empty sample; the deviation is that of a sample, 0 of a single value
};
Spread spread_of(const std::vector<double>& values);

}  // namespace knap
