#include "law/self_stress.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace knap {
namespace {

class ActiveSet {
public:
    explicit ActiveSet(const std::vector<HalfPlane>& planes) : planes_(planes) {}

    void add(Index i) { members_[n_++] = i; }
    bool has(Index i) const { return std::find(members_.begin(), members_.begin() + n_, i) != members_.begin() + n_; }
    int size() const { return n_; }
    Index operator[](int i) const { return members_[i]; }

    /// The direction of steepest ascent: the point nearest to zero in the convex hull of the active gradients. Reduces
    /// the active set to the gradients that carry it.
    Vec2 steepest_ascent() {
        if (n_ == 3 && holds_zero()) return Vec2::Zero();
        Vec2 best = gradient(0);
        std::array<Index, 3> carrying{members_[0]};
        int n_carrying = 1;
        for (int i = 0; i < n_; ++i)
            for (int j = i; j < n_; ++j) {
                const Vec2 side = gradient(j) - gradient(i);
                const double length2 = side.squaredNorm();
                const double part = length2 > 0 ? std::clamp(-gradient(i).dot(side) / length2, 0.0, 1.0) : 0;
                const Vec2 nearest = gradient(i) + part * side;
                if (nearest.squaredNorm() >= best.squaredNorm()) continue;
                best = nearest;
                n_carrying = 0;
                if (part < 1) carrying[n_carrying++] = members_[i];
                if (part > 0) carrying[n_carrying++] = members_[j];
            }
        members_ = carrying;
        n_ = n_carrying;
        return best;
    }

private:
    const Vec2& gradient(int i) const { return planes_[members_[i]].gradient; }
    bool holds_zero() const {
        const double a = cross(gradient(0), gradient(1)), b = cross(gradient(1), gradient(2)),
                     c = cross(gradient(2), gradient(0));
        return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
    }

    const std::vector<HalfPlane>& planes_;
    std::array<Index, 3> members_{};
    int n_ = 0;
};

}  // namespace

SelfStress find_self_stress(const std::vector<HalfPlane>& planes, const Vec2& start) {
    SelfStress found{.c = start};
    const auto value = [&](Index i) { return planes[i].value + planes[i].gradient.dot(found.c); };
    const Index n = static_cast<Index>(planes.size());
    Index lowest = 0;
    double scale = 0;  // of the squared gradients
    for (Index i = 0; i < n; ++i) {
        if (value(i) < value(lowest)) lowest = i;
        scale = std::max(scale, planes[i].gradient.squaredNorm());
    }
    found.slack = n > 0 ? value(lowest) : 0;
    if (found.slack >= 0) return found;

    ActiveSet active(planes);
    active.add(lowest);
    for (int iteration = 0; iteration < 100; ++iteration) {
        const Vec2 direction = active.steepest_ascent();
        const double rate = direction.squaredNorm();
        if (rate <= 1e-24 * scale) break;         // the maximum
        double length = -2 * found.slack / rate;  // as far inside as it was outside
        Index blocking = -1;
        for (Index i = 0; i < n; ++i) {
            const double slower = rate - planes[i].gradient.dot(direction);
            if (active.has(i) || slower <= 1e-14 * scale) continue;
            const double until = std::max(0.0, value(i) - found.slack) / slower;
            if (until < length) length = until, blocking = i;
        }
        found.c += length * direction;
        found.slack += length * rate;
        if (found.slack >= 0) return found;
        if (blocking < 0) break;
        active.add(blocking);
    }
    for (int i = 0; i < active.size(); ++i) found.binding[found.n_binding++] = active[i];
    return found;
}

double StrengthPolygon::smallest_slack_of_curve(const Vec2& P) const {
    const double N = P.dot(normal);
    if (coupling != Coupling::norm) return slack_over(N + cohesive, rubbing(N + cohesive), P);
    const double T = std::abs(P.dot(turned_left(normal)));
    return N >= 0 || cohesive == 0 ? std::min(N + cohesive, jump + rubbing(N) - T)
                                   : cohesive * (1 - Vec2(N / cohesive, T / jump).norm());
}

void StrengthPolygon::add_chords(Index link, const Vec2& P, const Vec2& undetermined,
                                 std::vector<HalfPlane>& planes) const {
    constexpr int n_chords = 16;  // of the whole domain up to 1 - cos(pi/32) = 0.005
    constexpr double d = std::numbers::pi / (2 * n_chords);
    static const auto directions = [] {  // (cos a, sin a)
        std::array<Vec2, n_chords> made;
        for (int k = 0; k < n_chords; ++k)
            made[k] = {std::cos((2 * k + 1 - n_chords) * d), std::sin((2 * k + 1 - n_chords) * d)};
        return made;
    }();
    static const double reach = std::cos(d);
    const Vec2 tangent = turned_left(normal);
    const double N = P.dot(normal), T = P.dot(tangent);
    for (const Vec2& a : directions)
        // through the points of the ellipse at the angles a -+ d:  cos a (-N/C) + sin a T/jump <= cos d
        planes.push_back({cohesive * (reach + a.x() * N / cohesive - a.y() * T / jump),
                          undetermined.cwiseProduct(a.x() * normal - a.y() * cohesive / jump * tangent), link, 0});
    visit_lines([&](const FrictionLine& line) {
        for (const int sign : {1, -1})
            planes.push_back({jump + line.offset + line.slope * N - sign * T,
                              undetermined.cwiseProduct(line.slope * normal - sign * tangent), link, sign});
    });
}

}  // namespace knap
