#pragma once
// Power diagram (Laguerre's Voronoi diagram): the plane divided among sites with weights,
//     cell i = { x : |x - p_i|^2 - w_i <= |x - p_j|^2 - w_j for all j }.
// Cells are convex polygons; equal weights give Voronoi cells. Source: F. Aurenhammer, "Power diagrams: properties,
// algorithms and applications", SIAM J. Comput. 16 (1987) 78 (from memory). Cells are cut out of a box by half planes,
// nearest sites first.
#include "base/grouped.hpp"
#include "mesh/polygon.hpp"

namespace knap {

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
    double bin_ = 1;  // [m] width of the square bins
    int n_x_ = 1, n_y_ = 1;
    Grouped<Index> bins_;  // sites by bin, row by row
};

}  // namespace knap
