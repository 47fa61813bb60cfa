#pragma once
// Vector Aitken extrapolation of multipliers, fan by fan (contacts between faces: all together), in the active set and
// in the method of multipliers. A move d that is q times the previous one will be followed by q d, q^2 d, ...:
//     q < 1   nearly redundant points: the rest of the series is q/(1 - q) moves;
//             (also where the nodal forces nearly cancel: from a bound they would come all the way back)
//     q = 1   contradictory bounds round a vertex: the nodal forces H' d cancel, no rate responds, and the same move
//             would repeat for ever. Since w = 0 satisfies all bounds, a point must open or slip: the first to reach
//             its bound along d.
//             An opening point of a curved law turns its force until its opening is along the misfit of the bounds: to
//             the end of the series, or as far as a turn is straight.
// Contacts with obstacles are left out: they couple the whole body and may jam it.
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/theta_matrix.hpp"

namespace knap {

class MultiplierSeries {
public:
    MultiplierSeries(const Model& model, const ThetaMatrix& matrix);

    /// The next move is the first of a series.
    void forget() { last_move_.clear(); }
    /// After the multipliers have moved by `move` [N s, (N, T) per point]: of fans with a move above `min_move`.
    void extrapolate(const std::vector<Vec2>& move, double min_move, std::vector<ActivePoint>& points);

private:
    const ThetaMatrix& matrix_;
    std::vector<Vec2> force_;      // [N s] per node
    std::vector<Vec2> last_move_;  // [N s] per point
};

}  // namespace knap
