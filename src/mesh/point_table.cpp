#include "mesh/point_table.hpp"

#include "base/error.hpp"
#include "mesh/constrained_delaunay.hpp"

#include <algorithm>

namespace knap {

struct PointTable::Triangulation {
    delaunay::Triangulation of_points;
};

PointTable::PointTable(const std::vector<Row>& rows) : rows_(rows) {
    auto made = std::make_shared<Triangulation>();
    for (std::size_t i = 0; i < rows.size(); ++i)
        made->of_points.insert(delaunay::point(rows[i].place))->info().value = static_cast<Index>(i);
    if (made->of_points.dimension() < 2)
        throw UserError("bad-csv", "the points of the file lie on one line, so that nothing is known beside it",
                        "at least three points, round the body");
    triangulation_ = std::move(made);
}

std::optional<std::array<double, 3>> PointTable::at(const Vec2& place) const {
    constexpr double rounding = 1e-9;  // of the length of an edge of the hull
    const delaunay::Triangulation& triangles = triangulation_->of_points;
    const delaunay::Face face = triangles.locate(delaunay::point(place));
    std::array<double, 3> part{}, value{};  // of the three vertices
    if (triangles.is_infinite(face)) {
        const int beyond = face->index(triangles.infinite_vertex()), first = (beyond + 1) % 3, last = (beyond + 2) % 3;
        const Vec2 a = delaunay::position(face->vertex(first)), edge = delaunay::position(face->vertex(last)) - a;
        part[last] = std::clamp((place - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
        part[first] = 1 - part[last];
        if ((place - a - part[last] * edge).norm() > rounding * edge.norm()) return std::nullopt;
    } else {
        const Vec2 a = delaunay::position(face->vertex(0)), b = delaunay::position(face->vertex(1)) - a,
                   c = delaunay::position(face->vertex(2)) - a;
        part[1] = cross(place - a, c) / cross(b, c), part[2] = cross(b, place - a) / cross(b, c);
        part[0] = 1 - part[1] - part[2];
    }
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3 && part[i] != 0; ++k) value[k] += part[i] * rows_[face->vertex(i)->info().value].value[k];
    return value;
}

}  // namespace knap
