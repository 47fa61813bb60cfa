#include "stepper/contact/contact_row.hpp"

#include "stepper/common/contact_search.hpp"

namespace knap {

ContactRow row_of(const Model& model, const State& begin, const FaceContact& contact, double scale) {
    return {.gap = contact.gap,
            .length = contact.length,
            .rounding = position_rounding * (place_of(model, begin, contact.edge[0]).norm() + contact.length),
            .law = law_between_faces(model, begin, contact),
            .place = place_of(model, begin, contact.vertex[1]),
            .impulse = scale * Vec2(contact.contact, contact.tangential)};
}

ContactRow row_of(const Model& model, const State& begin, const ObstaclePairContact& contact) {
    const Vec2 x = contact.place(begin);
    return {.gap = contact.gap,
            .length = contact.size,
            .rounding = position_rounding * (x.norm() + contact.arm[0].norm() + contact.arm[1].norm()),
            .law = law_between(model, contact, begin),
            .place = x};
}

}  // namespace knap
