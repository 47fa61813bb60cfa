#pragma once
// The law of a point over a step whose opening is a norm, s = sqrt(<u_N>^2 + gamma^2 u_T^2), as a row
// (law/row_law.hpp):
//
//     P = -C rho(|W|) d|W| + p N - f T,     |W| = sqrt(<W_N>^2 + gamma^2 W_T^2),     W = V + shift
//     0 <= p  perp  V_N - b >= 0,           f in mu <P_N> 1/2 [ sgn(V_T) + sgn(V_T + V_T-) ]
//
// At W = 0 the cohesion is anything inside the half ellipse of the half axes C rho(0), gamma C rho(0). Friction acts on
// the compression <P_N> alone, not on cohesion: a closed point bears the shear gamma C + mu P_N, at rest and sliding.
// (Friction on p at rest, where p may balance cohesion, would give the convex sum of ellipse and Coulomb's cone, with
// sqrt(gamma^2 + mu^2) C, of which the first slip would lose all but gamma C.)
//
// rho = 1 with constant unloading. On a ramp of secant unloading W belongs to the middles of the steps, and rho is the
// quotient of the changes of the energy w and of the opening since the middle of the last step, s-:
//
//     s+ <= kappa:  (s+ + s-)/(2 kappa)       beyond:  1 - a^2/(2 kappa (s+ - s-)),  a = kappa - s-
//
// which grows with s+, so the law stays that of a convex function. As |W| is convex, the work of the cohesion is at
// least the change of w with W in the middles; with W at the end of the step (constant unloading), what returns to zero
// comes to rest.
#include "law/interface_law.hpp"
#include "law/row_law.hpp"

namespace knap {

class NormLaw : public RowLaw {
public:
    double cohesive = 0;                 // [N s] C
    double gamma = 1;                    // [-] > 0
    ContactBound contact;                // of V_N
    Staircase sliding;                   // friction over V_T, of a compression of 1
    Vec2 shift = Vec2::Zero();           // [m/s]
    double ramp = 0, start = 0;          // [m/s] kappa and s- in units of W; no ramp: 0
    PressedFriction over_pressure = {};  // in place of mu p, with sliding over V_T of mu = 1
    double pressed = -1;                 // [N s] the compression that friction sees; negative: that of the impulse

    Projection project(const Vec2& Q, double r) const override { return respond(Q, r).at; }

    /// The parts of an impulse. Friction and p are zero where there is no contact.
    struct Response {
        Projection at;
        bool closed = false, sticks = false;  // V_N = b; no component moves
        Vec2 cohesion = Vec2::Zero();         // [N s] of P
        double friction = 0;                  // [N s] of P_T
        Vec2 rate = Vec2::Zero();             // [m/s] V
        double size = 0;                      // [m/s] |W|
        double friction_sign = 0;             // of its slip
    };
    Response respond(const Vec2& Q, double r) const;
    /// d|W|/dW, zero at W = 0.
    Vec2 along(const Vec2& W) const;
    /// [-] dP/dQ = I - (I + H)^-1, H = curvature (d2|W|/dW2 |W|) + growth along along'; of a closed point along T
    /// alone.
    Eigen::Matrix2d slope(const Vec2& W, double curvature, double growth, bool closed) const;
    virtual double rho(double size) const;
    virtual double slope_of_rho(double size) const;

    double size(const Vec2& W) const { return length(std::max(W.x(), 0.0), gamma * W.y()); }
    /// std::hypot, where the squares are normal numbers by their root.
    static double length(double x, double y) {
        const double square = x * x + y * y;
        return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(x, y);
    }

private:
    double size_after(const Vec2& A, double k) const;
    double slip_after(double W_N, double A_T, double k, double F, double r) const;
};

}  // namespace knap
