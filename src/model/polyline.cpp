#include "model/polyline.hpp"

#include "mesh/polygon.hpp"

#include <cassert>
#include <utility>

namespace knap {
namespace {

constexpr double beyond_reflex = 0.25;  // [-] of a side: how far beyond such an end its plane counts

/// [m] One draw of each kind, so that the offsets of other points do not depend on it.
double offset_of(const Roughness& roughness, Random& random) {
    const double uniform = 2 * random.uniform() - 1;
    double normal = random.normal();
    while (std::abs(normal) > 3) normal = random.normal();
    return roughness.size * (roughness.kind == Roughness::Kind::uniform ? uniform : normal);
}

}  // namespace

AtCorner at_corner(const PlacedEdge& one, const PlacedEdge& two, const Vec2& p, const Vec2& motion, double tolerance) {
    const Vec2 away = p - two.start;
    if (two.along.dot(away) > tolerance || -one.along.dot(away) > tolerance) return AtCorner::none;
    const double gap_1 = one.outward.dot(away), gap_2 = two.outward.dot(away), rate_1 = one.outward.dot(motion),
                 rate_2 = two.outward.dot(motion);
    if (std::min(gap_1, gap_2) < -tolerance) return AtCorner::none;
    const bool both_touch = std::max(gap_1, gap_2) < tolerance && std::max(gap_1 + rate_1, gap_2 + rate_2) < 0;
    return (both_touch ? rate_1 > rate_2 : gap_1 + rate_1 > gap_2 + rate_2) ? AtCorner::first : AtCorner::second;
}

std::vector<Vec2> roughened(const std::vector<Vec2>& points, const std::vector<RoughRange>& ranges,
                            const Roughness& elsewhere, Random random) {
    std::vector<Vec2> smooth{points.front()};
    std::vector<const Roughness*> of_side;
    const auto at = [&](double x) -> const Roughness& {
        const auto found = std::ranges::find_if(ranges, [&](const RoughRange& r) { return r.from <= x && x <= r.to; });
        return found == ranges.end() ? elsewhere : found->roughness;
    };
    const auto add_until = [&](const Vec2& end) {
        const Vec2 start = smooth.back(), way = end - start;
        of_side.push_back(&at(start.x() + 0.5 * way.x()));
        const double parts = std::ceil(way.norm() / of_side.back()->spacing - 1e-9);
        const int n = std::max(static_cast<int>(parts), 1);
        for (int k = 1; k < n; ++k) {
            smooth.push_back(start + static_cast<double>(k) / n * way);
            of_side.push_back(of_side.back());
        }
        smooth.push_back(end);
    };
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vec2 start = points[i], way = points[i + 1] - start;
        std::vector<double> cuts;  // [-] of the side
        for (const RoughRange& range : ranges)
            for (const double x : {range.from, range.to})
                if (const double s = (x - start.x()) / way.x(); s > 0 && s < 1) cuts.push_back(s);
        std::ranges::sort(cuts);
        const auto [last, end] = std::ranges::unique(cuts);
        cuts.erase(last, end);
        for (const double s : cuts) add_until(start + s * way);
        add_until(points[i + 1]);
    }
    std::vector<Vec2> rough = smooth;
    for (std::size_t i = 0; i < smooth.size(); ++i) {
        const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i, of_side.size() - 1);
        const auto along = [&](std::size_t side) { return (smooth[side + 1] - smooth[side]).normalized(); };
        const Roughness& here =
            of_side[before]->largest() < of_side[after]->largest() ? *of_side[before] : *of_side[after];
        rough[i] -= offset_of(here, random) * turned_left((along(before) + along(after)).normalized());
    }
    return rough;
}

Polyline::Polyline(const std::vector<Vec2>& points)
    : Polyline([&] {
          assert(points.size() >= 2);
          std::vector<Part> parts;
          const auto last = static_cast<Index>(points.size()) - 2;
          for (Index i = 0; i <= last; ++i)
              parts.push_back({points[i], points[i + 1], i - 1, i == last ? -1 : i + 1, nobody});
          return parts;
      }()) {}

Polyline::Polyline(const std::vector<Part>& parts) {
    std::vector<Vec2> points;
    for (const auto& [start, end, before, after, owner] : parts) {
        if (after < 0) ends_.push_back(size());
        sides_.push_back({placed_edge(start, end), 0, before, after, owner});
        assert(sides_.back().length > 0);
        points.push_back(start), points.push_back(end);
    }
    for (Side& side : sides_) {
        if (side.before < 0) continue;
        const Vec2& before = sides_[side.before].along;
        side.turn = cross(before, side.along);
        // a turn back by more than a right angle is as sharp as any
        if (before.dot(side.along) < 0) side.turn = side.turn > 0 ? 1 : -1;
    }
    for (const Vec2& p : points) radius_ = std::max(radius_, p.norm());
    const Box box = bounding_box(points);
    axis_ = box.extent().y() > box.extent().x() ? 1 : 0;
    all_.low = box.low[1 - axis_], all_.high = box.high[1 - axis_];
    low_ = box.low[axis_], cell_ = box.extent()[axis_] / static_cast<double>(size());
    bins_.resize(sides_.size());
    const auto for_bins = [&](const auto& visit) {  // visit(side, bin)
        for (Index i = 0; i < size(); ++i)
            for (std::size_t b = first_bin_[i], last = bin(std::max(sides_[i].start[axis_], sides_[i].end[axis_]));
                 b <= last; ++b)
                visit(i, b);
    };
    for (Index i = 0; i < size(); ++i)
        first_bin_.push_back(bin(std::min(sides_[i].start[axis_], sides_[i].end[axis_])));
    for_bins([&](Index i, std::size_t b) {
        Bin& at = bins_[b];
        for (const Vec2& end : {sides_[i].start, sides_[i].end})
            at.low = std::min(at.low, end[1 - axis_]), at.high = std::max(at.high, end[1 - axis_]);
        ++at.end;
    });
    std::size_t total = 0;
    for (Bin& at : bins_) total += std::exchange(at.end, total);  // starts, which filling moves to the ends
    in_bins_.resize(total);
    for_bins([&](Index i, std::size_t b) { in_bins_[bins_[b].end++] = i; });
}

bool Polyline::may_reach(const Vec2& p, double reach) const {
    const double x = p[axis_], y = p[1 - axis_], high = low_ + cell_ * static_cast<double>(size());
    if (x + reach < low_ || x - reach > high || y - reach > all_.high || y + reach < all_.low) return false;
    for (std::size_t b = bin(x - reach), last = bin(x + reach); b <= last; ++b)
        if (y - reach <= bins_[b].high && y + reach >= bins_[b].low) return true;
    return false;
}

double Polyline::distance_to(const Vec2& p, Vec2& normal) const {
    double nearest = infinity, distance = infinity;
    const auto look = [&](Index i) {
        const Side& side = sides_[i];
        const double s = std::clamp(side.place(p), 0.0, side.length);
        const Vec2 away = p - side.start - s * side.along;
        const double length = away.norm();
        if (length >= nearest) return;
        nearest = distance = length, normal = side.outward;
        const bool at_end = s == 0 || s == side.length;
        const Index other = s == 0 ? side.before : side.after;
        const bool is_end = at_end && other < 0;
        Vec2 out = side.outward;  // at a corner the mean one tells the side
        if (at_end && !is_end) out += sides_[other].outward;
        const bool is_in_ground = !is_end && out.dot(away) < 0;
        if (at_end && length > 0) normal = (is_in_ground ? -1 : 1) * away / length;
        if (is_in_ground) distance = -length;
    };
    for (double reach = cell_; nearest > reach && reach < 1e6 * cell_ + p.norm(); reach *= 4) {
        nearest = infinity;
        visit_near(p, reach, look);
    }
    return distance;
}

bool Polyline::is_as_deep(const Vec2& p, double gap) const {
    constexpr double most = 4;  // [-] of its distance to the nearest side: in a valley it touches two
    Vec2 normal;
    return -gap <= -most * distance_to(p, normal);
}

/// Whether the plane of side i is one that p may touch, by what is next to it at both ends.
bool Polyline::has(Index i, const Vec2& p, double gap, const Vec2& motion, double tolerance, double reach) const {
    const Side& side = sides_[i];
    const double s = side.place(p);
    const auto at_end = [&](Index neighbour, double beyond, AtCorner own) {
        if (neighbour < 0) return beyond <= 0;
        const Side &other = sides_[neighbour], &one = own == AtCorner::first ? side : other,
                   &two = own == AtCorner::first ? other : side;
        if (two.turn < -flat) return beyond <= std::min(reach + std::abs(gap), beyond_reflex * side.length);
        const Vec2 away = p - two.start;  // for both sides, so that one of them has the point
        if (two.turn <= 0) {  // of a straight corner one side has the point, or both where it is below between them
            const double between = std::max(-gap, 0.0) * -two.turn, after = two.along.dot(away);
            return own == AtCorner::first ? after < between : -after <= between;
        }
        const AtCorner found = at_corner(one, two, p, motion, tolerance);
        if (found != AtCorner::none) return found == own;
        if (beyond > 0 || gap >= 0) return beyond <= 0;
        const double of_own = side.outward.dot(away), of_other = other.outward.dot(away);
        return own == AtCorner::first ? of_own >= of_other : of_own > of_other;
    };
    return at_end(side.before, -s, AtCorner::second) && at_end(side.after, s - side.length, AtCorner::first);
}

}  // namespace knap
