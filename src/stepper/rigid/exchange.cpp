// Contacts between pieces that step by themselves (stepper/islands) and others.
#include "stepper/rigid/rigid_contacts.hpp"

#include <algorithm>

namespace knap {

void RigidContacts::impulses_on_deformable(const std::vector<MovingBody>& bodies,
                                           std::vector<CornerImpulse>& impulses) const {
    impulses.clear();
    const auto add = [&](Index corner, const Vec2& impulse) {
        if (corner == rigid_support || model_.ground_at(corner) != nullptr) return;
        const Index piece = piece_of(corner);
        if (bodies[piece].deformable) impulses.push_back({piece, corner, impulse});
    };
    for (const Row& row : rows_) {
        if (row.impulse.isZero(0) || sides_of(row, bodies) != Sides::mixed) continue;
        if (row.source == Source::face) {
            const FaceContact& c = faces_.all()[row.number];
            const Vec2 n = c.normal, P = row.impulse.x() * n + row.impulse.y() * turned_left(n),
                       turn = c.gap / c.length * row.impulse.y() * n;
            for (const Index corner : c.vertex) add(corner, 0.5 * P);
            add(c.edge[0], -(1 - c.share) * P - turn);
            add(c.edge[1], -c.share * P + turn);
        } else {
            const FanPoint& point = model_.points(model_.fans[points_[row.number].fan])[points_[row.number].place];
            for (int k = 0; k < row.n_terms; ++k) {
                const Vec3 P = row.impulse.x() * row.terms[k].along_N + row.impulse.y() * row.terms[k].along_T;
                for (const Index corner : {point.before, point.after})
                    if (corner != rigid_support && piece_of(corner) == row.terms[k].body) add(corner, P.head<2>());
            }
        }
    }
}

void RigidContacts::release_retired(State& end) const {
    for (const Point& at : points_)
        if (end.has_retired(model_.points(model_.fans[at.fan])[at.place].point))
            end.points[end.first_point[end.split_rank[at.fan]] + at.place].traction.setZero();
}

bool RigidContacts::mark_overlapping(const State& end, double allowed, const std::vector<MovingBody>& bodies,
                                     std::vector<std::uint8_t>& marked) const {
    bool any = false;
    for (const Row& row : rows_) {
        if (row.source != Source::face || sides_of(row, bodies) != Sides::mixed) continue;
        const FaceContact& c = faces_.all()[row.number];
        const double gap = c.normal.dot(c.jump([&](Index corner) -> Vec2 {
            if (const GroundVertex* ground = model_.ground_at(corner)) return ground->place;
            return model_.mesh.corner(corner) + end.displacement[end.node_of_corner[corner]];
        }));
        if (gap >= std::min(row.gap, 0.0) - allowed * row.length) continue;
        for (int k = 0; k < row.n_terms; ++k)
            if (const Index body = row.terms[k].body; body < n_pieces_ && !bodies[body].deformable)
                marked[body] = 1, any = true;
    }
    return any;
}

}  // namespace knap
