#include "mesh/overlap.hpp"

#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr double shallow = 0.1;  // of the height of the smaller triangle

struct Triangle {
    std::array<Vec2, 3> corner;  // [m] counterclockwise

    const Vec2& operator[](Index k) const { return corner[k]; }
    Vec2 side(Index k) const { return corner[(k + 1) % 3] - corner[k]; }
    Vec2 low() const { return corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]); }
    Vec2 high() const { return corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]); }
    double area() const { return 0.5 * cross(side(0), corner[2] - corner[0]); }  // [m2] signed
    double smallest_height() const { return 2 * area() / std::max({side(0).norm(), side(1).norm(), side(2).norm()}); }
};

/// [m] The smallest distance, over the sides of a, that b reaches behind the side. Zero for a side of either triangle
/// where they are separate (separating axis theorem).
double depth_behind_sides(const Triangle& a, const Triangle& b) {
    double smallest = infinity;
    for (Index k = 0; k < 3; ++k) {
        const Vec2 along = a.side(k).normalized();
        double reach = 0;
        for (const Vec2& p : b.corner) reach = std::max(reach, cross(along, p - a[k]));
        smallest = std::min(smallest, reach);
    }
    return smallest;
}

bool overlap_deeply(const Triangle& a, const Triangle& b) {
    const double depth = std::min(depth_behind_sides(a, b), depth_behind_sides(b, a));
    return depth > shallow * std::min(a.smallest_height(), b.smallest_height());
}

/// Pairs of triangles with overlapping boxes, found by bisecting the set until few are left: at the median along an
/// axis; where that cuts too many triangles, as with slivers that lie askew side by side, along the longest edge of one
/// of them. Triangles that do not overlap cross no such line except where it leaves its triangle, so few are in both
/// parts (M. S. Paterson and F. F. Yao 1990).
class PairSearch {
public:
    PairSearch(std::vector<Triangle> triangles, std::vector<bool> is_candidate)
        : triangles_(std::move(triangles)), is_candidate_(std::move(is_candidate)) {}

    /// Calls visit(a, b) for the pairs of a candidate a with another triangle, some of them several times, until it
    /// returns true.
    template <class Visit>
    bool visit_pairs(const std::vector<Index>& some, const Visit& visit) const {
        constexpr std::size_t few = 16, n_edges_tried = 16;
        if (std::ranges::none_of(some, [&](Index t) { return is_candidate_[t]; })) return false;
        if (some.size() <= few) return visit_all_pairs(some, visit);
        Vec2 low = triangles_[some[0]][0], high = low;
        for (const Index t : some) low = low.cwiseMin(triangles_[t][0]), high = high.cwiseMax(triangles_[t][0]);
        const int axis = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
        const auto visit_halves = [&](const Halves& half) {
            return visit_pairs(half[0], visit) || visit_pairs(half[1], visit);
        };
        for (const int a : {axis, 1 - axis})
            if (const Halves half = at_median(some, a); is_worthwhile(half, some.size())) return visit_halves(half);
        for (std::size_t i = 0; i < n_edges_tried; ++i) {
            const Index t = some[(2 * i + 1) * some.size() / (2 * n_edges_tried)];
            if (const Halves half = along_edge(some, t); is_worthwhile(half, some.size())) return visit_halves(half);
        }
        return visit_all_pairs(some, visit);
    }

private:
    using Halves = std::array<std::vector<Index>, 2>;  // triangles that the line cuts are in both

    Halves at_median(const std::vector<Index>& some, int axis) const {
        std::vector<double> position;
        for (const Index t : some) position.push_back(triangles_[t][0][axis]);
        const auto median = position.begin() + static_cast<std::ptrdiff_t>(position.size() / 2);
        std::ranges::nth_element(position, median);
        Halves half;
        for (const Index t : some) {
            if (triangles_[t].low()[axis] <= *median) half[0].push_back(t);
            if (triangles_[t].high()[axis] > *median) half[1].push_back(t);
        }
        return half;
    }

    /// A triangle that only touches the line is on one side of it.
    Halves along_edge(const std::vector<Index>& some, Index of) const {
        const Triangle& triangle = triangles_[of];
        const Index longest = std::ranges::max({0, 1, 2}, {}, [&](Index k) { return triangle.side(k).squaredNorm(); });
        Halves half;
        for (const Index t : some) {
            const auto aside = [&](Index k) {
                return cross(triangle.side(longest), triangles_[t][k] - triangle[longest]);
            };
            const auto [right, left] = std::minmax({aside(0), aside(1), aside(2)});
            if (left > 0) half[0].push_back(t);
            if (right < 0) half[1].push_back(t);
        }
        return half;
    }

    /// Otherwise further bisection would cost more than all pairs.
    static bool is_worthwhile(const Halves& half, std::size_t n_triangles) {
        const auto n = static_cast<double>(n_triangles), a = static_cast<double>(half[0].size()),
                   b = static_cast<double>(half[1].size());
        return std::max(a, b) <= 0.9 * n && a + b <= 1.4 * n;
    }

    template <class Visit>
    bool visit_all_pairs(const std::vector<Index>& some, const Visit& visit) const {
        for (std::size_t i = 0; i < some.size(); ++i)
            for (std::size_t j = i + 1; j < some.size(); ++j) {
                const auto [a, b] = is_candidate_[some[i]] ? std::pair(some[i], some[j]) : std::pair(some[j], some[i]);
                if (is_candidate_[a] && boxes_overlap(triangles_[a], triangles_[b]) && visit(a, b)) return true;
            }
        return false;
    }

    static bool boxes_overlap(const Triangle& a, const Triangle& b) {
        return (a.low().array() < b.high().array()).all() && (b.low().array() < a.high().array()).all();
    }

    const std::vector<Triangle> triangles_;
    const std::vector<bool> is_candidate_;
};

/// The intersection of two triangles: a cut by the sides of b.
std::vector<Vec2> intersection(const Triangle& a, const Triangle& b) {
    std::vector<Vec2> polygon(a.corner.begin(), a.corner.end()), scratch;
    for (Index k = 0; k < 3; ++k)
        clip(
            polygon, [from = b[k], along = b.side(k)](const Vec2& p) { return cross(p - from, along); }, scratch);
    return polygon;
}

}  // namespace

/// The region that two sheets of a mesh cover twice ends at edges of the boundary, and the triangle of such an edge is
/// in that region: so triangles with an edge on the boundary are compared with all others.
std::optional<std::array<Index, 2>> find_overlap(const Mesh& mesh) {
    std::vector<Triangle> triangles;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        triangles.push_back({{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}});
    std::vector<bool> at_boundary(triangles.size(), false);
    for (const BoundaryEdge& edge : mesh.boundary_edges) at_boundary[edge.triangle] = true;
    std::vector<Index> all(triangles.size());
    std::iota(all.begin(), all.end(), 0);
    std::optional<std::array<Index, 2>> found;
    PairSearch(triangles, at_boundary).visit_pairs(all, [&](Index a, Index b) {
        if (overlap_deeply(triangles[a], triangles[b])) found = {a, b};
        return found.has_value();
    });
    return found;
}

CoveredTwice find_covered_twice(std::span<const Vec2> corner, std::span<const Index> vertex) {
    std::vector<Triangle> triangles;
    std::vector<Index> valid;
    for (Index t = 0; t < static_cast<Index>(corner.size() / 3); ++t) {
        Triangle& triangle = triangles.emplace_back(Triangle{{corner[3 * t], corner[3 * t + 1], corner[3 * t + 2]}});
        const double area = triangle.area();
        if (area < 0) std::swap(triangle.corner[1], triangle.corner[2]);
        if (std::isfinite(area) && area != 0) valid.push_back(t);
    }
    const auto share_a_vertex = [&](Index a, Index b) {
        const auto of_a = vertex.subspan(3 * a, 3), of_b = vertex.subspan(3 * b, 3);
        return std::ranges::find_first_of(of_a, of_b) != of_a.end();
    };
    struct Overlap {
        std::array<Index, 2> pair;
        double area;  // [m2]
        Vec2 centroid;
    };
    std::vector<Overlap> overlaps;
    PairSearch(triangles, std::vector<bool>(triangles.size(), true)).visit_pairs(valid, [&](Index a, Index b) {
        if (a > b) std::swap(a, b);
        if (share_a_vertex(a, b) && !overlap_deeply(triangles[a], triangles[b])) return false;
        const std::vector<Vec2> common = intersection(triangles[a], triangles[b]);
        if (const double area = signed_area(common); area > 0) overlaps.push_back({{a, b}, area, centroid(common)});
        return false;
    });
    std::ranges::sort(overlaps, {}, &Overlap::pair);
    const auto repeated = std::ranges::unique(overlaps, {}, &Overlap::pair);
    overlaps.erase(repeated.begin(), repeated.end());
    CoveredTwice found;
    for (const auto& [pair, area, place] : overlaps) {
        found.area += area;
        found.triangles += area / std::min(triangles[pair[0]].area(), triangles[pair[1]].area());
        if (area > found.largest) found.largest = area, found.place = place;
    }
    return found;
}

}  // namespace knap
