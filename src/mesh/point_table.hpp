#pragma once
// Values at scattered points. In between they are linear on the triangles of the Delaunay triangulation of the points,
// so that a field which is linear over them is reproduced everywhere; points on one line, as along a boundary, have
// values between them alone. Points may have several moments, between which the values are linear, too.
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
        double time = 0;                // [s]
    };
    /// Rows at different places or times. Throws UserError ("bad-csv") where a moment has one point alone.
    explicit PointTable(std::vector<Row> rows);

    bool depends_on_time() const { return moments_.size() > 1; }
    /// Constant before the first moment and after the last one. None outside the convex hull of the points, or beside
    /// their line (by more than rounding).
    std::optional<std::array<double, 3>> at(const Vec2& place, double t) const;
    /// Whether at() has a value there at all times.
    bool reaches(const Vec2& place) const;

private:
    struct Triangulation;
    struct Moment {
        double time;
        std::vector<Row> rows;                               // of points on one line from its one end to the other
        std::shared_ptr<const Triangulation> triangulation;  // null: they lie on one line
    };
    static Moment moment(std::vector<Row> rows);
    static std::optional<std::array<double, 3>> at(const Moment& moment, const Vec2& place);

    std::vector<Moment> moments_;  // in their order
};

}  // namespace knap
