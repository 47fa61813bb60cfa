#pragma once
#include <cmath>

namespace knap {

/// What acts between faces that meet: of the body, of obstacles, of a terrain.
struct ContactLaw {
    /// Whose rebound the restitution is: of the faces at the point of contact, whatever is behind them (Newton's law);
    /// or (R_N) of rigid bodies exactly, and of deformable ones by a surface that gives way (explicit/rebounds.hpp).
    enum class Rebound { of_faces, of_bodies };

    double friction = 0;             // [-] Coulomb's mu
    double restitution = 0;          // [-] Newton's coefficient
    bool gives_restitution = false;  // the scenario does; else rigid pieces that cannot break have their own
    Rebound rebound = Rebound::of_faces;
    double tangential = 0;  // [-] R_T: of the slip before an impact, below which friction does not brake it
    int changing = -1;      // into Model::laws: the friction is that of this law, over slip or pressure; -1: constant

    bool rebounds() const { return restitution > 0 || tangential > 0; }
    bool is_of_bodies() const { return rebound == Rebound::of_bodies || tangential > 0; }
    /// [-] At faces of deformable bodies.
    double restitution_of_faces() const { return rebound == Rebound::of_faces ? restitution : 0; }
};

/// Of two obstacles: of one that has R_N or R_T alone its own; else the geometric means of what each has.
inline ContactLaw law_between(const ContactLaw& a, const ContactLaw& b) {
    if (a.is_of_bodies() != b.is_of_bodies()) return a.is_of_bodies() ? a : b;
    return {.friction = std::sqrt(a.friction * b.friction),
            .restitution = std::sqrt(a.restitution * b.restitution),
            .gives_restitution = true,
            .rebound = a.rebound == b.rebound ? a.rebound : ContactLaw::Rebound::of_faces,
            .tangential = std::sqrt(a.tangential * b.tangential)};
}

}  // namespace knap
