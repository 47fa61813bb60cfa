#pragma once
// Grains of a rock: a power diagram whose cells have given areas. Diameters are drawn from a lognormal distribution;
// sites move to the centroids of their cells and weights follow the missing areas, as in D. P. Bourne, P. J. J. Kok, S.
// M. Roper, W. D. T. Spanjer, "Laguerre tessellations and polycrystalline microstructures", Phil. Mag. 100 (2020) 2677
// (from memory; there by optimal transport, here by a damped fixed point, which leaves errors of some percent).
// Elongated grains grow round in a plane that is stretched afterwards.
#include "microstructure/power_diagram.hpp"

namespace knap {

struct GrainOptions {
    double size = 0;        // [m] mean diameter, of the circle of equal area
    double spread = 0.25;   // [-] standard deviation of the diameters over their mean
    double elongation = 1;  // [-] length over width
    double direction = 0;   // [rad] of the length, from x
};

class Grains {
public:
    /// Grains that fill the box and a little more, so that its border cuts through grains as a saw does.
    Grains(const GrainOptions& options, const Box& box, std::uint64_t seed);

    Index n_grains() const { return diagram_.n_sites(); }
    Index at(const Vec2& x) const { return diagram_.cell_at(to_round_ * x); }
    double area(Index grain) const;  // [m2]

    /// The line normal.x = offset between two grains; the normal points from a to b.
    struct Border {
        Vec2 normal;
        double offset;  // [m]
    };
    Border border(Index a, Index b) const;

private:
    Eigen::Matrix2d to_round_;  // from the body to the plane where grains are round; keeps areas
    PowerDiagram diagram_;
};

}  // namespace knap
