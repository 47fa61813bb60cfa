#pragma once
// One step of the implicit theta scheme (implicit_scheme.hpp) as a linear complementarity problem, full and unreduced:
// all fans are active, so every triangle moves by itself unless unbreakable points join it to others. Equations
// (22)-(24) of the method, with the cohesion law at the end of the step. The reference of the implicit scheme on small
// meshes, its fallback there, and what `--dump-lcp` stores.
//
//     M_hat w = M v - theta h K u + theta h F_theta + theta H' P,       so   H w = H w_free + theta W P
//     P_N = p_N - h S sigma_c beta_theta,   P_T = p_T+ - p_T- + h (r_T+ - r_T-),      W = H M_hat^-1 H' (Delassus)
//
// Rows and unknowns of a point, those of the cohesion times its area S:
//
//     unknown >= 0          row >= 0
//     S A                   theta (beta - beta+)                                  loss of cohesion
//     S beta+               theta (A - sigma_c (delta_c (1 - beta+) - s_N - gamma chi))      s_N = u_N+, or o
//     p_N                   w_N - c                                               may touch, w_N not prescribed
//     p_T+, p_T-            zeta + w_T, zeta - w_T
//     zeta                  mu p_N - p_T+ - p_T-
//     S r_T+, S r_T-        chi + u_T+, chi - u_T+
//     chi                   S gamma sigma_c beta_theta - r_T+ - r_T-
//     o                     S sigma_c/delta_c (o - u_N+)                          so o = max(u_N+, 0)
//
// Secant unloading with explicit beta (a damaged point, kappa > 0), with openings at u + theta h w in the place of u+:
//
//     S D                   sigma_c beta/theta (s_N + gamma chi - kappa (1 - D))  the part of beta that is not borne
//     chi                   S gamma sigma_c beta (1 - D)/theta - r_T+ - r_T-      P_T = theta h (r_T+ - r_T-)
//
//     o                     S sigma_c beta (1 - D)/theta - y     only where the sides may overlap there
//     y                     o - u_N                              P_N = p_N - theta h y
//
// so that P_N = p_N - h S sigma_c beta (1 - D) with 1 - D = min(s/kappa, 1), and no cohesion pulls an overlap. With
// implicit beta the force of the ramp is the product of two unknowns, beta+ and 1 - D: such a step is no linear
// complementarity problem.
//
// Friction over pressure: zeta's row has mu_1 p_N - sum d_i z_i in place of mu p_N, with the bends p_i of its polygon,
// where its slope falls by d_i, and the mobility m of the point:
//
//     z_i                   m (z_i - p_N + p_i)
//
// The norm: a sum of absolute values in the place of the root, s = c (u_N + |gamma u_T| + |u_N + gamma u_T|/sqrt(2)
// + |u_N - gamma u_T|/sqrt(2)), c = sqrt(2) - 1, so that each has r+, r- and chi as u_T has them above. Its tractions
// are those of the polygon of 8 sides round the half ellipse: exact where (t_N, t_T/gamma) is at 0, 45 and 90 degrees
// to N, up to 1/cos(22.5 deg) = 1.082 times the traction between. Friction acts on r = max(P_N, 0) in place of p_N:
//
//     r                     m (r - P_N)
//
// Every row times its unknown is an energy [J]: only then does the scaling of lcp/scaling.hpp give the same bits in all
// units of length, mass and time.
//
// A softening polygon is the sum of its pieces (layers): each has its own S A and S beta+, starts with the part of beta
// that lies in it and falls over its own interval of s; beta+ is their sum. Since x(b) falls, the potential is convex
// in each of them, and they empty in their order.
//
// Only the rows that a body needs are there: p_T, zeta with friction; r_T, chi with gamma > 0; A, beta+, o with
// implicit beta. Points without cohesion have p_N, p_T, zeta alone. o is needed where a cohesive point can end the step
// with u_N+ < 0, because it lands faster than the scheme can stop it; without such points, and with friction and gamma,
// the layout is that of lcp/spurious_breaking.hpp. With theta < 1 no bond breaks spuriously: beta_theta > 0 wherever
// beta > 0, so r_T stays and with it chi = |u_T|.
#include "lcp/problem.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/active_point.hpp"

#include <Eigen/SparseCholesky>

#include <optional>

namespace knap {

/// The end of the step that a solution stands for.
struct StepLcpEnd {
    std::vector<Vec2> rate, velocity;  // [m/s] w and v+, per corner
    std::vector<Vec2> opening;         // [m] (u_N+, u_T+), per point
    std::vector<Vec2> impulse;         // [N s] P (N, T), per point; 0 for unbreakable points, where it is unknown
    std::vector<double> contact;       // [N s] p_N, per point
    std::vector<double> held;          // [N s] likewise, on a ramp with the cohesion that is not borne
    std::vector<double> cohesion;      // [-] beta+, per point
};

class StepLcp {
public:
    /// `model` and `begin` must outlive it; `options.bulk` is taken as implicit_theta. Without obstacles.
    /// Without `end_temperature` the temperatures of the begin last.
    StepLcp(const Model& model, const State& begin, double h, const SchemeOptions& options,
            SharedTemperatures end_temperature = nullptr);
    StepLcp(const StepLcp&) = delete;

    /// Not for the norm and vertical unloading, nor with implicit beta for secant unloading and a G_II.
    static bool fits(const Model& model, const SchemeOptions& options);
    /// The norm, too, by a polygon; with constant unloading.
    static bool fits_by_polygon(const Model& model, const SchemeOptions& options);

    const LcpProblem& problem() const { return problem_; }
    StepLcpEnd end(const Eigen::VectorXd& z) const;
    /// By the default solver, at last Lemke's method; nothing where it finds no solution.
    std::optional<StepLcpEnd> solve() const;

private:
    using Matrix = Eigen::SparseMatrix<double>;
    using Triplets = std::vector<Eigen::Triplet<double>>;

    void factorise(MassMatrix mass);
    void make_points();
    void lay_out();
    void add_layers(const PointLaw& law);
    double reach(const PointLaw& law) const;
    bool lands(Index point) const;
    void add_opening(int row, Index point, double factor);
    void add_ramps();
    void add_cohesion();
    void add_contacts();
    int pressing(int contact) const;
    void add_compressions();
    void scale_pressures();
    void add_tangential_cohesion();
    void add_sign(int first, int bound, Index point, const Vec2& factor, double constant);
    std::vector<Vec2> rate(const Eigen::VectorXd& impulse) const;

    const Model& model_;
    StepContext step_;
    ImplicitBulk bulk_;
    CornerPartition nodes_;
    std::vector<Index> unknown_;  // per node, x and y: of M_hat, or -1
    Index n_unknowns_ = 0;
    Eigen::SimplicialLDLT<Matrix> M_hat_;
    std::vector<Vec2> free_rate_;      // [m/s] w without any P, per node
    std::vector<ActivePoint> points_;  // by their number
    Matrix H_;                         // [2 n_points, unknowns]; rows of unbreakable points are empty

    // the layout: points, and the first row of every group, which may be empty
    std::vector<Index> cohesive_, contacts_, landing_;  // points with cohesion; that may touch; that need o
    /// A part of the cohesion of a point that falls by itself: from `start`, its value at the start of the step, to 0
    /// at the equivalent opening `end` [m], by 1/length per opening. A polygon has one for each piece that falls.
    struct Layer {
        int cohesive;  // into cohesive_
        double start, end, length;
    };
    std::vector<Layer> layers_;  // with implicit beta
    std::vector<int> ramps_;     // into cohesive_: points with secant unloading
    struct Bend {
        int contact, line;  // into contacts_; that begins at it
    };
    std::vector<Bend> bends_;  // of friction over pressure
    bool friction_ = false, tangential_ = false;
    int n_terms_ = 1;  // of absolute values in the equivalent opening
    int loss_, beta_, normal_, slip_, slip_rate_, tangent_, offset_, opening_, pull_, ramp_, bend_, compression_,
        size_ = 0;

    Triplets rows_of_rate_, impulse_of_unknown_, coupling_;
    Eigen::VectorXd constant_;
    // P = impulse_of_z z + known_impulse [N s], N and T of every point
    LcpMatrix impulse_of_z_;
    Eigen::VectorXd known_impulse_;
    LcpProblem problem_;
};

}  // namespace knap
