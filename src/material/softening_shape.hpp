#pragma once
// The shape of a softening law: traction over strength B on first loading, as a polygon of at most twelve pieces over
// the opening x in units of G_c/sigma_c.
//
//     sigma(s) = sigma_c B(x),   x = s sigma_c/G_c,      B(0) = 1,   B(x_f) = 0,   int B dx = 1
//
// Every B that does not grow belongs to a potential of the form of the linear law, and x(b) is its inverse:
//
//     Psi = beta sigma_c s + G_c f(beta),     f(beta) = 1 - int_0^beta x(b) db,     f convex,  f(1) = 0,  f(0) = 1
//
// so a point that breaks has consumed G_c, whatever the shape and the mix of opening and slip. On a polygon f is
// piecewise quadratic, and all solvers of the linear law stay finite.
#include "base/vec.hpp"

#include <memory>
#include <string>
#include <vector>

namespace knap {

struct SofteningOptions {
    enum class Shape { linear, petersson, mc2010, exponential, trapezoid, power, table };
    Shape shape = Shape::linear;
    double plateau = 0.5;          // [-] trapezoid: part of the final opening at full strength; 1: Dugdale
    double exponent = 2;           // [-] power: B = (1 - x/x_f)^exponent
    std::vector<Vec2> table = {};  // (opening, traction), both in any unit
};

class SofteningShape {
public:
    static constexpr std::size_t max_pieces = 12;

    /// Knots (opening, traction) without a fault_of_softening; scaled to B(0) = 1 and area 1.
    explicit SofteningShape(std::vector<Vec2> knots);

    double traction(double x) const;                            // [-] B, exactly 0 from the final opening on
    double continued_traction(double x) const;                  // [-] B, beyond the final opening on the last piece
    double opening(double beta) const;                          // [-] the largest x with B >= beta
    double dissipated(double beta) const;                       // [-] f
    double final_opening() const { return knots_.back().x(); }  // [-] x_f
    int piece_at(double x) const;                               // number of the piece, the last one beyond x_f
    int n_pieces() const { return static_cast<int>(slopes_.size()); }
    double slope(int piece) const { return slopes_[piece]; }   // [-] -dB/dx; infinite where B drops
    double steepest(double beta = 1) const;                    // [-] largest slope below this cohesion
    const std::vector<Vec2>& knots() const { return knots_; }  // (x, B)

private:
    std::vector<Vec2> knots_;
    std::vector<double> slopes_, consumed_;  // [-] per piece; f per knot
};

/// What is wrong with a table: it must begin at opening 0, end with traction 0, and its traction must not grow. Empty
/// where nothing is.
std::string fault_of_softening(const std::vector<Vec2>& knots);

/// Null for the linear law, which needs no polygon.
std::shared_ptr<const SofteningShape> make_softening(const SofteningOptions& options);

}  // namespace knap
