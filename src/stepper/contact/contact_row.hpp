#pragma once
// A contact in a step as a row of the nonsmooth problem, whatever touches: faces of the body, the body and an obstacle,
// two obstacles. On what it acts, corners and rigid bodies, each scheme keeps as terms (law/row_term.hpp).
#include "law/row_term.hpp"
#include "stepper/common/obstacle_pairs.hpp"
#include "stepper/contact/face_contacts.hpp"

namespace knap {

struct ContactRow {
    double gap = 0;       // [m]
    double length = 0;    // [m] of the edge in contact
    double rounding = 0;  // [m] of its places
    ContactLaw law;
    Vec2 place = Vec2::Zero();    // [m]
    Vec2 before = Vec2::Zero();   // [m/s] (V_N, V_T) at the start of the step
    Vec2 impulse = Vec2::Zero();  // [N s] (p, P_T)
};

/// With the impulse of the step before times `scale`.
ContactRow row_of(const Model& model, const State& begin, const FaceContact& contact, double scale);
ContactRow row_of(const Model& model, const State& begin, const ObstaclePairContact& contact);

/// Of a contact at `arm` [m] on a rigid body, into which its normal points.
inline ClusterTerm term_on(Index body, const Vec2& normal, const Vec2& arm) {
    return {body, wrench_of(normal, arm), wrench_of(turned_left(normal), arm)};
}
/// Calls visit(term) for the obstacles of the pair; a support does not move.
void visit_terms(const ObstaclePairContact& contact, const auto& visit) {
    for (const int k : {0, 1})
        if (contact.obstacle[k] >= 0)
            visit(term_on(contact.obstacle[k], k == 0 ? Vec2(-contact.normal) : contact.normal, contact.arm[k]));
}

}  // namespace knap
