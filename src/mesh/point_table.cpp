#include "mesh/point_table.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/constrained_delaunay.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double rounding = 1e-9;     // of the length of an edge of the hull
constexpr double on_the_line = 1e-6;  // of the length of a line of points: vertices of a curve, and decimals of a file

std::array<double, 3> between(const std::array<double, 3>& a, const std::array<double, 3>& b, double part) {
    std::array<double, 3> value;
    for (std::size_t k = 0; k < value.size(); ++k) value[k] = part == 0 ? a[k] : (1 - part) * a[k] + part * b[k];
    return value;
}

/// The part of the way from a to b that leads to the foot of a place.
double part_of_way(const Vec2& a, const Vec2& b, const Vec2& place) {
    return (place - a).dot(b - a) / (b - a).squaredNorm();
}

double distance_from_line(const Vec2& a, const Vec2& b, const Vec2& place) {
    return std::abs(cross(b - a, place - a)) / (b - a).norm();
}

}  // namespace

struct PointTable::Triangulation {
    delaunay::Triangulation of_points;
};

PointTable::PointTable(std::vector<Row> rows) {
    std::ranges::stable_sort(rows, {}, &Row::time);
    for (auto first = rows.begin(); first != rows.end();) {
        const auto end = std::find_if(first, rows.end(), [&](const Row& row) { return row.time != first->time; });
        moments_.push_back(moment({first, end}));
        first = end;
    }
}

PointTable::Moment PointTable::moment(std::vector<Row> rows) {
    if (rows.size() < 2)
        throw UserError("bad-csv", "there is one point alone at t = " + shortest(rows.front().time) + " s",
                        "two points on a line, or more round the places that need a value");
    const auto from = [&](const Vec2& a) { return [a](const Row& row) { return (row.place - a).squaredNorm(); }; };
    const Vec2 a = std::ranges::max_element(rows, {}, from(rows.front().place))->place,
               b = std::ranges::max_element(rows, {}, from(a))
                       ->place;  // an end of the line, if it is one, and the other
    Moment made{.time = rows.front().time, .rows = std::move(rows), .triangulation = nullptr};
    if (std::ranges::all_of(made.rows, [&, most = on_the_line * (b - a).norm()](const Row& row) {
            return distance_from_line(a, b, row.place) <= most;
        })) {
        std::ranges::sort(made.rows, {}, [&](const Row& row) { return part_of_way(a, b, row.place); });
        return made;
    }
    auto triangles = std::make_shared<Triangulation>();
    for (std::size_t i = 0; i < made.rows.size(); ++i)
        triangles->of_points.insert(delaunay::point(made.rows[i].place))->info().value = static_cast<Index>(i);
    made.triangulation = std::move(triangles);
    return made;
}

std::optional<std::array<double, 3>> PointTable::at(const Moment& moment, const Vec2& place) {
    const std::vector<Row>& rows = moment.rows;
    if (!moment.triangulation) {
        const Vec2 &a = rows.front().place, &b = rows.back().place;
        const double way = part_of_way(a, b, place);
        if (distance_from_line(a, b, place) > on_the_line * (b - a).norm() || way < -on_the_line ||
            way > 1 + on_the_line)
            return std::nullopt;
        auto after =
            std::ranges::upper_bound(rows, way, {}, [&](const Row& row) { return part_of_way(a, b, row.place); });
        after = std::clamp(after, rows.begin() + 1, rows.end() - 1);
        const Row& before = *(after - 1);
        return between(before.value, after->value,
                       std::clamp(part_of_way(before.place, after->place, place), 0.0, 1.0));
    }
    const delaunay::Triangulation& triangles = moment.triangulation->of_points;
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
        for (int k = 0; k < 3 && part[i] != 0; ++k) value[k] += part[i] * rows[face->vertex(i)->info().value].value[k];
    return value;
}

std::optional<std::array<double, 3>> PointTable::at(const Vec2& place, double t) const {
    const auto after = std::ranges::upper_bound(moments_, t, {}, &Moment::time);
    if (after == moments_.begin()) return at(moments_.front(), place);
    const auto first = at(*(after - 1), place);
    const double start = (after - 1)->time;
    if (after == moments_.end() || !first || t == start) return first;
    const auto second = at(*after, place);
    return second ? std::optional(between(*first, *second, (t - start) / (after->time - start))) : std::nullopt;
}

bool PointTable::reaches(const Vec2& place) const {
    return std::ranges::all_of(moments_, [&](const Moment& moment) { return at(moment, place).has_value(); });
}

}  // namespace knap
