// Pairs are found in the cells of a grid whose cells are as wide as triangles; only cells that triangles touch are stored, by a hash of their place, since pieces
// may have flown far apart. A pair that shares several cells is taken in the one with the lower left corner of what their boxes have in common.
#include "geometry/covered_twice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace knap {
namespace {

using Triangle = std::array<Vec2, 3>;

constexpr double lawful_depth = 0.1;          // of the height of the smaller of two triangles with a common vertex
constexpr std::int64_t most_cells = 1 << 14;  // of one triangle

double signed_area(const Triangle& t) { return 0.5 * cross(t[1] - t[0], t[2] - t[0]); }

struct Piece {
    Triangle corner;  // counterclockwise
    Vec2 low, high;
    Index number;
};

/// The common part of two triangles, that of `a` cut by the sides of `b`: its area, and its moment (area times centroid).
double common_area(const Triangle& a, const Triangle& b, Vec2& moment) {
    std::array<Vec2, 9> polygon, cut;
    std::size_t n = 3;
    std::copy(a.begin(), a.end(), polygon.begin());
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 from = b[k], along = b[(k + 1) % 3] - from;
        std::size_t m = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec2 &p = polygon[i], &q = polygon[(i + 1) % n];
            const double left_p = cross(along, p - from), left_q = cross(along, q - from);
            if (left_p >= 0) cut[m++] = p;
            if ((left_p > 0 && left_q < 0) || (left_p < 0 && left_q > 0)) cut[m++] = p + left_p / (left_p - left_q) * (q - p);
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

/// [m] How far b reaches behind the side of a that it reaches behind the least; triangles are apart where that is nothing for a side of either.
double depth_behind_sides(const Triangle& a, const Triangle& b) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 from = a[k], along = (a[(k + 1) % 3] - from).normalized();
        double reach = 0;
        for (const Vec2& p : b) reach = std::max(reach, cross(along, p - from));
        least = std::min(least, reach);
    }
    return least;
}

/// [m] The smallest.
double height(const Triangle& t) {
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (t[(k + 1) % 3] - t[k]).norm());
    return 2 * signed_area(t) / longest;
}

class PairSearch {
public:
    PairSearch(std::span<const Vec2> corner, std::span<const Index> vertex) : corner_(corner), vertex_(vertex) {}

    CoveredTwice find() {
        for (Index t = 0; t < static_cast<Index>(corner_.size() / 3); ++t) add(t);
        if (pieces_.size() < 2) return {};
        make_grid();
        CoveredTwice found;
        for (std::size_t bucket = 0; bucket + 1 < first_.size(); ++bucket)
            for (Index i = first_[bucket]; i < first_[bucket + 1]; ++i)
                for (Index j = i + 1; j < first_[bucket + 1]; ++j)
                    if (entries_[i].column == entries_[j].column && entries_[i].row == entries_[j].row) compare(entries_[i], pieces_[entries_[j].piece], found);
        return found;
    }

private:
    struct Entry {
        std::int64_t column, row;
        Index piece;
    };

    void add(Index t) {
        Piece piece{.corner = {corner_[3 * t], corner_[3 * t + 1], corner_[3 * t + 2]}, .low = {}, .high = {}, .number = t};
        const double area = signed_area(piece.corner);
        if (!std::isfinite(area) || area == 0) return;
        if (area < 0) std::swap(piece.corner[1], piece.corner[2]);
        piece.low = piece.corner[0].cwiseMin(piece.corner[1]).cwiseMin(piece.corner[2]);
        piece.high = piece.corner[0].cwiseMax(piece.corner[1]).cwiseMax(piece.corner[2]);
        pieces_.push_back(piece);
    }

    std::int64_t cell(double x) const { return static_cast<std::int64_t>(std::floor(x / width_)); }

    std::size_t bucket_of(std::int64_t column, std::int64_t row) const {
        const std::uint64_t mixed = (static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15u) ^ (static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4Fu);
        return static_cast<std::size_t>((mixed ^ (mixed >> 29)) & (first_.size() - 2));
    }

    template <class Work>
    void for_cells(const Piece& piece, const Work& work) const {
        const std::int64_t left = cell(piece.low.x()), right = cell(piece.high.x()), bottom = cell(piece.low.y()), top = cell(piece.high.y());
        if ((right - left + 1) * (top - bottom + 1) > most_cells) return;  // a triangle torn out of all proportion is the business of other gates
        for (std::int64_t row = bottom; row <= top; ++row)
            for (std::int64_t column = left; column <= right; ++column) work(column, row);
    }

    /// Cells as wide as the mean of the triangles' boxes; entries sorted by bucket, the order in a bucket that of the triangles.
    void make_grid() {
        double sum = 0, farthest = 0;
        for (const Piece& piece : pieces_) {
            sum += (piece.high - piece.low).maxCoeff();
            farthest = std::max({farthest, piece.high.cwiseAbs().maxCoeff(), piece.low.cwiseAbs().maxCoeff()});
        }
        width_ = std::max(sum / static_cast<double>(pieces_.size()), farthest * 1e-12);
        std::size_t n_buckets = 1;
        while (n_buckets < 2 * pieces_.size()) n_buckets *= 2;
        first_.assign(n_buckets + 1, 0);
        for (const Piece& piece : pieces_) for_cells(piece, [&](std::int64_t column, std::int64_t row) { ++first_[bucket_of(column, row) + 1]; });
        for (std::size_t b = 0; b < n_buckets; ++b) first_[b + 1] += first_[b];
        entries_.resize(first_.back());
        std::vector<Index> next(first_.begin(), first_.end() - 1);
        for (std::size_t p = 0; p < pieces_.size(); ++p)
            for_cells(pieces_[p], [&](std::int64_t column, std::int64_t row) { entries_[next[bucket_of(column, row)]++] = {column, row, static_cast<Index>(p)}; });
    }

    bool share_a_vertex(Index a, Index b) const {
        for (Index i = 0; i < 3; ++i)
            for (Index j = 0; j < 3; ++j)
                if (vertex_[3 * a + i] == vertex_[3 * b + j]) return true;
        return false;
    }

    void compare(const Entry& at, const Piece& b, CoveredTwice& found) const {
        const Piece& a = pieces_[at.piece];
        const Vec2 low = a.low.cwiseMax(b.low), high = a.high.cwiseMin(b.high);
        if (!(low.x() < high.x() && low.y() < high.y()) || cell(low.x()) != at.column || cell(low.y()) != at.row) return;
        if (share_a_vertex(a.number, b.number)) {
            const double depth = std::min(depth_behind_sides(a.corner, b.corner), depth_behind_sides(b.corner, a.corner));
            if (!(depth > lawful_depth * std::min(height(a.corner), height(b.corner)))) return;
        }
        Vec2 moment;
        const double area = common_area(a.corner, b.corner, moment);
        if (!(area > 0)) return;
        found.area += area;
        found.triangles += area / std::min(signed_area(a.corner), signed_area(b.corner));
        if (area > found.largest) found.largest = area, found.place = moment / area;
    }

    std::span<const Vec2> corner_;   // [m]
    std::span<const Index> vertex_;
    std::vector<Piece> pieces_;
    double width_ = 1;  // [m]
    std::vector<Index> first_;  // per bucket, into entries_
    std::vector<Entry> entries_;
};

}  // namespace

CoveredTwice find_covered_twice(std::span<const Vec2> corner, std::span<const Index> vertex) { return PairSearch(corner, vertex).find(); }

}  // namespace knap
