#pragma once
// Grains of a rock: a power diagram whose cells have given areas. Diameters are drawn from a lognormal distribution;
// sites move to the centroids of their cells and weights follow the missing areas, as in D. P. Bourne, P. J. J. Kok, S.
// M. Roper, W. D. T. Spanjer, "Laguerre tessellations and polycrystalline microstructures", Phil. Mag. 100 (2020) 2677
// (from memory; there by optimal transport, here by a damped fixed point, which leaves errors of some percent).
// Elongated grains grow round in a plane that is stretched afterwards.
#include "base/grouped.hpp"
#include "mesh/polygon.hpp"

#include <cstdint>
#include <string_view>

namespace knap {

/// Power diagram (Laguerre's Voronoi diagram): the plane divided among sites with weights,
///     cell i = { x : |x - p_i|^2 - w_i <= |x - p_j|^2 - w_j for all j }.
/// Cells are convex polygons; equal weights give Voronoi cells. Source: F. Aurenhammer, "Power diagrams: properties,
/// algorithms and applications", SIAM J. Comput. 16 (1987) 78 (from memory). Cells are cut out of a box by half planes,
/// nearest sites first.
class PowerDiagram {
public:
    /// All sites lie in the box [m]; one weight [m2] per site.
    PowerDiagram(std::vector<Vec2> sites, std::vector<double> weights, const Box& box);

    Index n_sites() const { return static_cast<Index>(sites_.size()); }
    const Vec2& site(Index i) const { return sites_[i]; }
    double weight(Index i) const { return weights_[i]; }

    /// The site whose cell contains x.
    Index cell_at(const Vec2& x) const;
    /// Counterclockwise, within the box; empty where others cover all of it.
    std::vector<Vec2> cell(Index i) const;

private:
    /// Calls visit(site) for the sites of the bins that lie `ring` bins away; false when there are none that far.
    template <class Visit>
    bool visit_ring(const Vec2& x, int ring, Visit visit) const;
    int bin_along(int axis, double x) const;

    std::vector<Vec2> sites_;
    std::vector<double> weights_;
    double largest_weight_ = 0;
    Box box_;
    double bin_ = 1;                // [m] width of the square bins
    std::array<int, 2> n_bins_;     // per direction
    Grouped<Index> sites_of_bins_;  // row by row
};

struct GrainOptions {
    double size = 0;        // [m] mean diameter, of the circle of equal area
    double spread = 0.25;   // [-] standard deviation of the diameters over their mean
    double elongation = 1;  // [-] length over width
    double direction = 0;   // [rad] of the length, from x
};

/// Cells that fill a box, with the diameters of the options, not elongated.
PowerDiagram round_cells(const GrainOptions& options, const Box& box, std::uint64_t seed, std::string_view stream);

class Grains {
public:
    /// Grains that fill the box and a little more, so that its border cuts through grains as a saw does.
    Grains(const GrainOptions& options, const Box& box, std::uint64_t seed);

    Index n_grains() const { return diagram_.n_sites(); }
    Index at(const Vec2& x) const { return diagram_.cell_at(to_round_ * x); }
    double area(Index grain) const { return signed_area(diagram_.cell(grain)); }  // [m2]

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
