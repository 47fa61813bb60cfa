#pragma once
// Static test of a chain of corners that move as one. The impulses P between them follow by walking along the chain:
// P_after = P_before - required, where `required` is the sum that a corner must receive from its points. Round a closed
// chain they are known up to one constant 2-vector c, the self-stress, added to every point: the chain stays bonded if
// and only if some c makes every point admissible (static theorem of limit analysis). The c of least norm is tried
// first, which is mostly sufficient, then the best one.
#include "base/vec.hpp"
#include "law/interface_law.hpp"
#include "material/cohesive_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace knap {

/// value + gradient . c >= 0
struct HalfPlane {
    double value;
    Vec2 gradient;
    Index link;
    int shear;  // sign of the tangential impulse that yields, along T; 0: the tension yields
};

/// Admissible impulses of a point: p = P_N + C >= 0 and the tangential range of p, three half planes, or two for each
/// line of a friction over pressure. Of the norm: the half ellipse |P_T| <= jump sqrt(1 - (P_N/C)^2) in tension,
/// |P_T| <= jump + contact_jump P_N in compression.
struct StrengthPolygon : TangentialRange {
    Vec2 normal;      // N; T = turned_left(N)
    double cohesive;  // C, a force or an impulse, as P
    Coupling coupling = Coupling::sum;
    PressedFriction pressed = {};  // in place of contact_jump

    /// Strength of a point at rest: cohesion in both directions, friction on the contact, which of a table is that of
    /// pressures times `unit`.
    static StrengthPolygon at_rest(const CohesiveLaw& law, const Vec2& normal, double cohesive, double unit) {
        return {{.jump = law.gamma * cohesive, .contact_jump = law.friction},
                normal,
                cohesive,
                law.coupling,
                law.pressed_friction(unit)};
    }

    /// Of the norm, or with a friction over pressure: bounded by more than three lines.
    bool is_curved() const { return coupling == Coupling::norm || pressed; }
    /// Negative: P is not admissible. All points of fans that nearly open are asked in every step, mostly with straight
    /// lines: without a call, and the call takes copies, so that polygon and P stay in registers.
    [[gnu::always_inline]] double smallest_slack(const Vec2& P) const {
        if (is_curved()) return StrengthPolygon(*this).smallest_slack_of_curve(Vec2(P));
        const double p = P.dot(normal) + cohesive;
        return slack_over(p, contact_jump * p, P);
    }
    /// Half planes of c at P + undetermined c; `undetermined`: 0, 1 or -1 per component.
    void add_half_planes(Index link, const Vec2& P, const Vec2& undetermined, std::vector<HalfPlane>& planes) const {
        if (coupling == Coupling::norm) return add_chords(link, P, undetermined, planes);
        const double p = P.dot(normal) + cohesive,
                     q = P.dot(turned_left(normal)) + (offset + line_offset + contact_offset * p);
        const Vec2 slope = turned_left(normal) + contact_offset * normal;
        planes.push_back({p, undetermined.cwiseProduct(normal), link, 0});
        visit_lines([&](const FrictionLine& line) {
            const double most = jump + line.offset + line.slope * p;
            planes.push_back({most - q, undetermined.cwiseProduct(line.slope * normal - slope), link, +1});
            planes.push_back({most + q, undetermined.cwiseProduct(line.slope * normal + slope), link, -1});
        });
    }

private:
    double rubbing(double p) const { return pressed ? pressed(p) : contact_jump * p; }
    /// Where p gives the tangential range a friction.
    double slack_over(double p, double friction, const Vec2& P) const {
        const double q = P.dot(turned_left(normal)) + (offset + line_offset + contact_offset * p);
        return std::min(p, jump + line_jump + friction - std::abs(q));
    }
    double smallest_slack_of_curve(const Vec2& P) const;
    template <class Visit>
    void visit_lines(const Visit& visit) const {
        if (!pressed) return visit(FrictionLine{contact_jump, line_jump});
        for (int i = 0; i < pressed.law->n_lines(); ++i) visit(pressed.line(i));
    }
    /// Of a convex part of the domain: chords of the half ellipse, and Coulomb's lines of compression in tension, too.
    void add_chords(Index link, const Vec2& P, const Vec2& undetermined, std::vector<HalfPlane>& planes) const;
};

/// The c that minimises the sum of w |P + undetermined c|^2 over the points, by components.
class LeastNormSelfStress {
public:
    void add(double w, const Vec2& P) {  // undetermined in both components; w * P is a call within large functions
        sum_.x() += w * P.x(), sum_.y() += w * P.y();
        weight_.x() += w, weight_.y() += w;
    }
    void add(double w, const Vec2& P, const Vec2& undetermined) {
        sum_ += w * undetermined.cwiseProduct(P);
        weight_ += w * undetermined.cwiseAbs2();
    }
    bool is_free() const { return !weight_.isZero(0); }
    Vec2 c() const {
        return {weight_.x() > 0 ? -sum_.x() / weight_.x() : 0.0, weight_.y() > 0 ? -sum_.y() / weight_.y() : 0.0};
    }

private:
    Vec2 sum_ = Vec2::Zero(), weight_ = Vec2::Zero();
};

/// visit(j, P) for the points of a bonded chain. `first`: P before the first corner (closed: of the first point). Stops
/// and returns false where `visit` does.
template <class Required, class Visit>
bool walk_chain(Index n_points, bool closed, const Vec2& first, const Required& required, const Visit& visit) {
    Vec2 P = first;
    for (Index j = 0; j < n_points; ++j) {
        if (!closed) P -= required(j);
        if (!visit(j, P)) return false;
        if (closed) P -= required(j);
    }
    return true;
}

/// The first P of a chain: zero where it is open, else the self-stress of least |P|^2/area.
template <class Required, class Area>
Vec2 least_norm_start(Index n_points, bool closed, const Required& required, const Area& area) {
    if (!closed) return Vec2::Zero();
    LeastNormSelfStress least;
    walk_chain(n_points, closed, Vec2::Zero(), required,
               [&](Index j, const Vec2& P) { return least.add(1 / area(j), P), true; });
    return least.c();
}

struct SelfStress {
    Vec2 c = Vec2::Zero();
    double slack = 0;                // smallest of all half planes at c; >= 0: admissible
    std::array<Index, 3> binding{};  // where slack < 0, the half planes of smallest slack: the opening mechanism
    int n_binding = 0;
};

/// Steepest ascent of the smallest slack (concave, piecewise linear) from `start`; stops where it is >= 0, or maximal.
SelfStress find_self_stress(const std::vector<HalfPlane>& planes, const Vec2& start);

}  // namespace knap
