#pragma once
// Where the multipliers of an implicit step (augmented_lagrangian.hpp) will end, known from how they move.
//
// A move of the multipliers of one fan that is followed by one of q times its length will be followed by q, q^2, ... of it:
//
//     q < 1    the points are nearly redundant: the rest of the series is q/(1 - q) moves
//     q = 1    they contradict each other: round the vertex more is closed than its corners can obey (the bounds c do not add up to zero). The pulls of such a
//              move on every corner cancel, H' d = 0, so that no rate answers, and it would go on for ever. Since w = 0 obeys all bounds, something must open:
//              what comes to its bound first along this ray.
//
// Only corners of one vertex meet in a fan. So every fan is extrapolated by itself, thousands at once.
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/theta_matrix.hpp"

namespace knap {

class MultiplierExtrapolation {
public:
    explicit MultiplierExtrapolation(const Model& model);

    /// No move is known yet.
    void begin() { before_.clear(); }
    /// After a move of the multipliers, from `last` (contact, tangential) [N s] to those in the laws: on to where it leads, in fans that moved by more than
    /// `least`.
    void apply(const ThetaMatrix& matrix, std::vector<ActivePoint>& points, const std::vector<Vec2>& last, double least);

private:
    std::vector<Vec2> before_;  // [N s] per point: its last move; zero after an extrapolation
    std::vector<Vec2> move_;    // [N s] d per point
    std::vector<Vec2> pull_;    // [N s] H' d per node
};

}  // namespace knap
