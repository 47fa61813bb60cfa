#pragma once
// Orders of convergence, extrapolation, and the spread of a sample.
#include <optional>
#include <vector>

namespace knap {

/// p of e = C h^p through two errors; NaN where one is 0 or not finite.
double observed_order(double h_coarse, double error_coarse, double h_fine, double error_fine);

/// p of the least-squares line through (log h, log e); NaN with less than two errors that are positive and finite.
double fitted_order(const std::vector<double>& h, const std::vector<double>& error);

/// L. F. Richardson (1911): q(h) = q(0) + C h^p through the values of three steps in constant ratio, coarse to fine.
struct Extrapolation {
    double order, value;
};
/// Nothing where the values do not come closer monotonically.
std::optional<Extrapolation> extrapolate(double ratio, double coarse, double middle, double fine);

/// The same for a whole line, steps `h` from coarse to fine: from the last three, and only where the order is clean, that is where the
/// three before them (if there are) give the same within 0.3.
std::optional<Extrapolation> extrapolate(const std::vector<double>& h, const std::vector<double>& value);

/// A sample without its not-a-numbers (what never happened).
struct Spread {
    int n = 0;
    double mean, deviation, smallest, largest;  // NaN of an empty sample; the deviation is that of a sample, 0 of a single value
};
Spread spread_of(const std::vector<double>& values);

}  // namespace knap
