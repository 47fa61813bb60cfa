#pragma once
// Polylines with the ground on their left: the open outline of a terrain, or the closed ones of polygons that have one
// surface (model/joined_polygons). Their sides lie in bins along the longer side of their box, so that a place asks
// only those near it, however many there are.
#include "base/placed_edge.hpp"
#include "base/random.hpp"

#include <algorithm>
#include <vector>

namespace knap {

/// Offsets of points of a polyline along its normal.
struct Roughness {
    enum class Kind { uniform, normal };
    Kind kind = Kind::uniform;
    double size = 0;            // [m] uniform: the largest offset; normal: the standard deviation of one below 3 of it
    double spacing = infinity;  // [m] longer sides are divided evenly

    /// [m]
    double largest() const { return kind == Kind::uniform ? size : 3 * size; }
};
struct RoughRange {
    double from, to;  // [m] x
    Roughness roughness;
};
/// The points of a polyline after they are divided and offset, with one more at the end of every range that it passes.
/// `ranges` are ascending and apart, and `elsewhere` is between them; where two meet, the smaller offset counts.
std::vector<Vec2> roughened(const std::vector<Vec2>& points, const std::vector<RoughRange>& ranges,
                            const Roughness& elsewhere, Random random);

/// Which of two sides of an outline has a point at the convex corner between them, or none where it is not in the cone
/// of both outward normals, widened by `tolerance` [m]: the one from which it is further away after the `motion` [m] of
/// the step; where it touches both, the one that it approaches less. So what slides along flush faces passes the seam.
enum class AtCorner { none, first, second };
AtCorner at_corner(const PlacedEdge& one, const PlacedEdge& two, const Vec2& p, const Vec2& motion, double tolerance);

class Polyline {
public:
    /// A straight part; those before and after it, or -1 at an end; and whose it is.
    struct Part {
        Vec2 start, end;  // [m], not in one place
        Index before, after, owner;
    };
    struct Side : PlacedEdge {
        double turn;  // sine of the turn at its start, positive to the left: there the ground is convex; 0 at an end
        Index before, after, owner;  // as of its part
    };
    static constexpr double flat = 1e-3;  // sine of a turn that is none: it would reach 1e-4 of an edge into a face
    static constexpr Index nobody = -1;   // the owner of a terrain
    /// At least two points, none in the place of the one before it.
    explicit Polyline(const std::vector<Vec2>& points);
    explicit Polyline(const std::vector<Part>& parts);

    const std::vector<Side>& sides() const { return sides_; }
    /// [m] Of all points about the origin.
    double radius() const { return radius_; }
    /// The starts of all sides, and behind them the ends.
    Index n_points() const { return size() + static_cast<Index>(ends_.size()); }
    Vec2 point(Index i) const { return i < size() ? sides_[i].start : sides_[ends_[i - size()]].end; }
    /// Calls visit(way [m]) for the sides at a point, from it to their other end.
    template <class Visit>
    void visit_sides_at(Index i, const Visit& visit) const {
        if (i < size()) visit(Vec2(sides_[i].end - sides_[i].start));
        if (const Index before = i < size() ? sides_[i].before : ends_[i - size()]; before >= 0)
            visit(Vec2(sides_[before].start - sides_[before].end));
    }
    Index owner_of_point(Index i) const { return sides_[i < size() ? i : ends_[i - size()]].owner; }
    /// The point may touch an edge between its ends: it is an end, or the ground is convex there.
    bool is_corner(Index i) const { return i >= size() || sides_[i].before < 0 || sides_[i].turn > flat; }
    /// Calls visit(i) for the points at sides within `reach` [m] of p, and others.
    template <class Visit>
    void visit_points_near(const Vec2& p, double reach, const Visit& visit) const {
        visit_near(p, reach, [&](Index i) {
            visit(i);
            if (sides_[i].after < 0)
                visit(size() + static_cast<Index>(std::ranges::lower_bound(ends_, i) - ends_.begin()));
        });
    }

    /// [m] The distance of p, and the direction in which it grows; negative in the ground. What is nearest to an end of
    /// the polyline is not in the ground.
    double distance_to(const Vec2& p, Vec2& normal) const;
    /// False only where no side is within `reach` [m] of p.
    bool may_reach(const Vec2& p, double reach) const;
    /// Calls visit(i) for all sides within `reach` [m] of p, and others.
    template <class Visit>
    void visit_near(const Vec2& p, double reach, const Visit& visit) const {
        const std::size_t first = bin(p[axis_] - reach), last = bin(p[axis_] + reach);
        for (std::size_t b = first; b <= last; ++b)
            for (std::size_t k = b == 0 ? 0 : bins_[b - 1].end; k < bins_[b].end; ++k)
                if (std::max(first, first_bin_[in_bins_[k]]) == b) visit(in_bins_[k]);
    }
    /// Calls visit(gap, normal) for the sides of `owner` beside which p lies, in front and not further away than
    /// `reach` [m].
    template <class Visit>
    void visit_beside(const Vec2& p, double reach, Index owner, const Visit& visit) const {
        visit_near(p, reach, [&](Index i) {
            const Side& side = sides_[i];
            if (side.owner != owner) return;
            const double gap = side.gap(p), s = side.place(p);
            if (gap >= 0 && gap <= reach && s >= 0 && s < side.length) visit(gap, side.outward);
        });
    }
    /// Calls visit(gap, normal) for the planes of the sides of `owner` that a point p may touch, as near as `reach` and
    /// as deep as `depth` [m]: both where the ground is not convex; where it is, the one from which p is further away
    /// after the `motion` [m] of the step, as far as p is within `tolerance` [m] of both, so that it passes from one to
    /// the next.
    template <class Visit>
    void visit_planes(const Vec2& p, const Vec2& motion, double tolerance, double reach, double depth, Index owner,
                      const Visit& visit) const {
        visit_near(p, std::max(reach, depth), [&](Index i) {
            if (sides_[i].owner != owner) return;
            const double gap = sides_[i].gap(p);
            if (gap <= reach && gap >= -depth && has(i, p, gap, motion, tolerance, reach) &&
                (gap >= -tolerance || is_as_deep(p, gap)))
                visit(gap, sides_[i].outward);
        });
    }

private:
    struct Bin {
        std::size_t end = 0;                      // into in_bins_
        double low = infinity, high = -infinity;  // [m] of its sides, across the axis
    };
    Index size() const { return static_cast<Index>(sides_.size()); }
    std::size_t bin(double x) const {
        return static_cast<std::size_t>(std::clamp((x - low_) / cell_, 0.0, static_cast<double>(bins_.size() - 1)));
    }
    /// p is in the ground, and not much less than by -gap [m]: behind the plane of a side it may be in front of
    /// another.
    bool is_as_deep(const Vec2& p, double gap) const;
    bool has(Index i, const Vec2& p, double gap, const Vec2& motion, double tolerance, double reach) const;

    std::vector<Side> sides_;
    std::vector<Index> ends_;  // sides after which there is none, ascending
    std::vector<Bin> bins_;
    std::vector<Index> in_bins_;          // sides, of one bin after the other
    std::vector<std::size_t> first_bin_;  // per side
    double radius_ = 0, low_ = 0, cell_ = 1;
    Bin all_;  // of all sides
    int axis_ = 0;
};

}  // namespace knap
