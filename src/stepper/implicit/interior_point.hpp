#pragma once
// Contacts of an implicit step by an interior point method. Where hundreds of them change their pieces at once, as at
// the onset of a slide, the active set cycles and stiff springs lead on slowly.
//
// In the plane Coulomb's cone has two edges, q = lambda_+ (1, mu) + lambda_- (1, -mu), and the law is
//
//     0 <= lambda_+-  perp  z_+- = w_N - b + mu s +- mu w_T >= 0        with s = |w_T|
//
// For given s this is the optimum of a convex function (G. De Saxce, Z.-Q. Feng, Math. Comput. Modelling 28, 1998), to
// which Newton's steps on lambda z = tau, tau -> 0, lead from any start; s is that of the rates before the step. Each
// is one system with M_hat and a definite block at every contact. It need not be exact: the active set goes on from
// there.
// (S. J. Wright, Primal-Dual Interior-Point Methods, 1997; V. Acary, F. Cadoux 2013 on s, both from memory)
#include "stepper/implicit/newton_iteration.hpp"

namespace knap {

class InteriorPoint {
public:
    /// Both must outlive this.
    InteriorPoint(ThetaMatrix& matrix, NewtonIteration& newton) : matrix_(matrix), newton_(newton) {}

    /// All points are contacts, or broken: none has cohesion.
    static bool fits(const std::vector<ActivePoint>& points);

    /// From the present iterate.
    void begin();
    /// Goes on from where it was, until impulses or rates are below `goal` [-] of their scales. The iterate becomes the
    /// solution so far. False: it was not reached.
    bool approach(double goal);

private:
    /// One value for each edge of the cone.
    struct Contact {
        std::array<double, 2> lambda, z;            // [N s], [m/s]
        std::array<double, 2> lambda_step, z_step;  // of Newton's direction
        std::array<double, 2> lack;                 // [m/s] z of the rates minus z
        double friction, dilation;                  // [-] mu, [m/s] s
    };
    /// What is left.
    struct Distance {
        double product = 0;  // [N2 s2] mean of lambda z, times the mass of the point
        double lack = 0;     // [N s] largest, likewise
    };
    Distance find_distance();
    void spread();
    bool find_direction(double tau);
    double longest_step() const;
    void move(double a);
    void finish();

    ThetaMatrix& matrix_;
    NewtonIteration& newton_;
    std::vector<Contact> contacts_;  // per point
    std::vector<Vec2> rate_;         // [m/s] per node, where the next approach() goes on
    double unit_ = 1;                // [N s] scale of the impulses
    std::vector<PointTangent> tangents_;
};

}  // namespace knap
