#include "mesh/overlap.hpp"

#include <cmath>
#include <limits>
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
    double signed_area() const { return 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]); }
    double smallest_height() const {
        return 2 * signed_area() / std::max({side(0).norm(), side(1).norm(), side(2).norm()});
    }
};

/// [m] The smallest distance, over the sides of a, that b reaches behind the side. Zero for a side of either triangle
/// where they are separate (separating axis theorem).
double depth_behind_sides(const Triangle& a, const Triangle& b) {
    double smallest = std::numeric_limits<double>::infinity();
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

/// Where two sheets of a mesh overlap, the region that they cover twice ends at edges of the boundary, and the triangle
/// of such an edge is in that region: so it is enough to compare the triangles with an edge on the boundary with all
/// others. Candidates are found by bisecting the body until few are left: at the median along an axis; where that cuts
/// too many triangles, as with slivers that lie askew side by side, along the longest edge of one of them. Triangles
/// that do not overlap cross no such line except where it leaves its triangle, so few are in both parts (M. S. Paterson
/// and F. F. Yao 1990).
class OverlapSearch {
public:
    using Pair = std::optional<std::array<Index, 2>>;

    explicit OverlapSearch(const Mesh& mesh) : at_boundary_(mesh.triangles.size(), false) {
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            triangles_.push_back({{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}});
        for (const BoundaryEdge& edge : mesh.boundary_edges) at_boundary_[edge.triangle] = true;
    }

    Pair among(const std::vector<Index>& some) const {
        constexpr std::size_t few = 16, n_edges_tried = 16;
        if (std::none_of(some.begin(), some.end(), [&](Index t) { return at_boundary_[t]; })) return std::nullopt;
        if (some.size() <= few) return in_pairs(some);
        const int axis = wider_axis(some);
        for (const int a : {axis, 1 - axis})
            if (const Halves half = at_median(some, a); is_worthwhile(half, some.size())) return in_halves(half);
        for (std::size_t i = 0; i < n_edges_tried; ++i) {
            const Index t = some[(2 * i + 1) * some.size() / (2 * n_edges_tried)];
            if (const Halves half = along_edge(some, t); is_worthwhile(half, some.size())) return in_halves(half);
        }
        return in_pairs(some);
    }

private:
    using Halves = std::array<std::vector<Index>, 2>;  // triangles that the line cuts are in both

    int wider_axis(const std::vector<Index>& some) const {
        Vec2 low = triangles_[some[0]][0], high = low;
        for (const Index t : some) low = low.cwiseMin(triangles_[t][0]), high = high.cwiseMax(triangles_[t][0]);
        return high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
    }

    Halves at_median(const std::vector<Index>& some, int axis) const {
        std::vector<double> position;
        for (const Index t : some) position.push_back(triangles_[t][0][axis]);
        const auto median = position.begin() + static_cast<std::ptrdiff_t>(position.size() / 2);
        std::nth_element(position.begin(), median, position.end());
        Halves half;
        for (const Index t : some) {
            if (triangles_[t].low()[axis] <= *median) half[0].push_back(t);
            if (triangles_[t].high()[axis] > *median) half[1].push_back(t);
        }
        return half;
    }

    /// A triangle that only touches the line is on one side of it.
    Halves along_edge(const std::vector<Index>& some, Index of) const {
        const auto shorter = [&](Index a, Index b) {
            return triangles_[of].side(a).squaredNorm() < triangles_[of].side(b).squaredNorm();
        };
        const Index longest = std::max({0, 1, 2}, shorter);
        const Vec2 from = triangles_[of][longest], along = triangles_[of].side(longest);
        Halves half;
        for (const Index t : some) {
            const auto aside = [&](Index k) { return cross(along, triangles_[t][k] - from); };
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

    Pair in_halves(const Halves& half) const {
        const Pair found = among(half[0]);
        return found ? found : among(half[1]);
    }

    Pair in_pairs(const std::vector<Index>& some) const {
        for (const Index a : some)
            for (const Index b : some)
                if (at_boundary_[a] && a != b && boxes_overlap(triangles_[a], triangles_[b]) &&
                    overlap_deeply(triangles_[a], triangles_[b]))
                    return std::array{a, b};
        return std::nullopt;
    }

    static bool boxes_overlap(const Triangle& a, const Triangle& b) {
        return (a.low().array() < b.high().array()).all() && (b.low().array() < a.high().array()).all();
    }

    std::vector<Triangle> triangles_;
    std::vector<bool> at_boundary_;
};

/// The intersection of two triangles, a cut by the sides of b: its area [m2], and its moment (area times centroid).
double common_area(const Triangle& a, const Triangle& b, Vec2& moment) {
    std::array<Vec2, 9> polygon, cut;
    std::size_t n = 3;
    std::copy(a.corner.begin(), a.corner.end(), polygon.begin());
    for (Index k = 0; k < 3; ++k) {
        const Vec2 from = b[k], along = b.side(k);
        std::size_t m = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec2 &p = polygon[i], &q = polygon[(i + 1) % n];
            const double left_p = cross(along, p - from), left_q = cross(along, q - from);
            if (left_p >= 0) cut[m++] = p;
            if ((left_p > 0 && left_q < 0) || (left_p < 0 && left_q > 0))
                cut[m++] = p + left_p / (left_p - left_q) * (q - p);
        }
        polygon = cut, n = m;
        if (n < 3) return 0;
    }
    double area = 0;
    moment = Vec2::Zero();
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const double part = 0.5 * cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        area += part;
        moment += part / 3 * (polygon[0] + polygon[i] + polygon[i + 1]);
    }
    return area;
}

/// Pairs are found in the cells of a grid about as wide as the triangles; only cells that triangles touch are stored,
/// by a hash of their position, since pieces may have flown far apart. A pair that shares several cells is compared in
/// the one with the lower left corner of the intersection of their boxes.
class PairSearch {
public:
    PairSearch(std::span<const Vec2> corner, std::span<const Index> vertex) : vertex_(vertex) {
        for (Index t = 0; t < static_cast<Index>(corner.size() / 3); ++t) {
            Triangle triangle{{corner[3 * t], corner[3 * t + 1], corner[3 * t + 2]}};
            const double area = triangle.signed_area();
            if (!std::isfinite(area) || area == 0) continue;
            if (area < 0) std::swap(triangle.corner[1], triangle.corner[2]);
            pieces_.push_back({triangle, triangle.low(), triangle.high(), t});
        }
    }

    CoveredTwice find() {
        CoveredTwice found;
        if (pieces_.size() < 2) return found;
        set_width();
        std::size_t n_buckets = 1;
        while (n_buckets < 2 * pieces_.size()) n_buckets *= 2;
        const Grouped<Entry> buckets(n_buckets, [&](const auto& visit) {
            for (const Piece& piece : pieces_)
                for_cells(piece, [&](const Cell& cell) { visit(cell.hash() & (n_buckets - 1), Entry{cell, &piece}); });
        });
        for (std::size_t bucket = 0; bucket < n_buckets; ++bucket) {
            const std::span<const Entry> entries = buckets[bucket];
            for (std::size_t i = 0; i < entries.size(); ++i)
                for (std::size_t j = i + 1; j < entries.size(); ++j)
                    if (entries[i].cell == entries[j].cell)
                        compare(entries[i].cell, *entries[i].piece, *entries[j].piece, found);
        }
        return found;
    }

private:
    struct Piece {
        Triangle triangle;
        Vec2 low, high;  // [m] its box
        Index number;
    };

    struct Cell {
        std::int64_t column, row;
        bool operator==(const Cell&) const = default;
        std::size_t hash() const {
            const std::uint64_t mixed = (static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15u) ^
                                        (static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4Fu);
            return mixed ^ (mixed >> 29);
        }
    };

    struct Entry {
        Cell cell;
        const Piece* piece;
    };

    Cell cell_at(const Vec2& x) const {
        return {static_cast<std::int64_t>(std::floor(x.x() / width_)),
                static_cast<std::int64_t>(std::floor(x.y() / width_))};
    }

    template <class Visit>
    void for_cells(const Piece& piece, const Visit& visit) const {
        constexpr std::int64_t max_cells =
            1 << 14;  // a triangle so much larger than the mean one is reported by other gates
        const Cell low = cell_at(piece.low), high = cell_at(piece.high);
        if ((high.column - low.column + 1) * (high.row - low.row + 1) > max_cells) return;
        for (std::int64_t row = low.row; row <= high.row; ++row)
            for (std::int64_t column = low.column; column <= high.column; ++column) visit({column, row});
    }

    /// The mean width of the triangles' boxes.
    void set_width() {
        double sum = 0, farthest = 0;
        for (const Piece& piece : pieces_) {
            sum += (piece.high - piece.low).maxCoeff();
            farthest = std::max({farthest, piece.high.cwiseAbs().maxCoeff(), piece.low.cwiseAbs().maxCoeff()});
        }
        width_ = std::max(sum / static_cast<double>(pieces_.size()), farthest * 1e-12);
    }

    bool share_a_vertex(Index a, Index b) const {
        const auto of_b = vertex_.subspan(3 * b, 3);
        return std::any_of(of_b.begin(), of_b.end(), [&](Index v) {
            return v == vertex_[3 * a] || v == vertex_[3 * a + 1] || v == vertex_[3 * a + 2];
        });
    }

    void compare(const Cell& cell, const Piece& a, const Piece& b, CoveredTwice& found) const {
        const Vec2 low = a.low.cwiseMax(b.low), high = a.high.cwiseMin(b.high);
        if (!(low.x() < high.x() && low.y() < high.y()) || cell_at(low) != cell) return;
        if (share_a_vertex(a.number, b.number) && !overlap_deeply(a.triangle, b.triangle)) return;
        Vec2 moment;
        const double area = common_area(a.triangle, b.triangle, moment);
        if (!(area > 0)) return;
        found.area += area;
        found.triangles += area / std::min(a.triangle.signed_area(), b.triangle.signed_area());
        if (area > found.largest) found.largest = area, found.place = moment / area;
    }

    std::span<const Index> vertex_;
    std::vector<Piece> pieces_;
    double width_ = 1;  // [m] of a cell
};

}  // namespace

std::optional<std::array<Index, 2>> find_overlap(const Mesh& mesh) {
    std::vector<Index> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    return OverlapSearch(mesh).among(all);
}

CoveredTwice find_covered_twice(std::span<const Vec2> corner, std::span<const Index> vertex) {
    return PairSearch(corner, vertex).find();
}

}  // namespace knap
