#pragma once
// A table over a grid of x, y and t, linear between its places and constant outside.
#include <array>
#include <string>
#include <vector>

namespace knap {

class GridTable {
public:
    /// Rows (x, y, t, value) in any order, one for every place of the grid. Throws UserError ("bad-csv") if one is
    /// missing or comes twice.
    explicit GridTable(const std::vector<std::array<double, 4>>& rows);

    double operator()(double x, double y, double t) const;
    bool depends_on_time() const { return axes_[2].size() > 1; }
    const std::vector<double>& axis(std::size_t k) const { return axes_[k]; }  // x, y, t: ascending
    /// [s] As TimeFunction::corner, of the values at all places.
    double corner(double begin, double end, double shortest) const;

private:
    std::array<std::vector<double>, 3> axes_;  // ascending
    std::vector<double> values_;               // x fastest, then y
};

}  // namespace knap
