#pragma once
// Values at scattered points, in between linear on the triangles of their Delaunay triangulation: a field that is
// linear over the points is reproduced everywhere.
#include "base/vec.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace knap {

class PointTable {
public:
    struct Row {
        Vec2 place;                     // [m]
        std::array<double, 3> value{};  // of up to three columns
    };
    /// Rows at different places. Throws UserError ("bad-csv") where all lie on one line.
    explicit PointTable(const std::vector<Row>& rows);

    /// None outside the convex hull of the points (by more than rounding).
    std::optional<std::array<double, 3>> at(const Vec2& place) const;

private:
    struct Triangulation;
    std::shared_ptr<const Triangulation> triangulation_;
    std::vector<Row> rows_;
};

}  // namespace knap
