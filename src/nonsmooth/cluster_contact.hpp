#pragma once
// Contacts of a cluster (contact_cluster.hpp) and the rigid bodies that they join.
#include "base/vec.hpp"
#include "law/interface_law.hpp"
#include "law/row_law.hpp"
#include "law/row_term.hpp"

namespace knap {

struct ClusterContact {
    InterfaceLaw law;
    double cohesive = 0;            // [N s] C; of an interface point
    bool unbreakable = false;       // an interface point that sticks for ever
    PressedFriction pressed = {};   // in place of p in the friction of `law`, whose mu is 1
    const RowLaw* other = nullptr;  // a law of its own instead of `law` and `cohesive`
    Vec2 free = Vec2::Zero();       // [m/s] V_free
    Vec2 impulse = Vec2::Zero();    // [N s] P: the start of the iteration, and the result
    Vec2 velocity = Vec2::Zero();   // [m/s] result: V
    Index first_coupling = 0, last_coupling = 0;
    Index first_term = 0, last_term = 0;
};

struct ClusterBody {
    Vec3 inverse_mass;           // [1/kg, 1/kg, 1/(kg m2)]
    Vec3 change = Vec3::Zero();  // [m/s, m/s, rad/s] by the impulses
};

}  // namespace knap
