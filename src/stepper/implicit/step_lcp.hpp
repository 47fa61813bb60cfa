#pragma once
// One step of the implicit theta scheme (stepper/implicit/implicit_scheme.hpp) as a linear complementarity problem, full and unreduced: every
// triangle moves by itself, every point that is not unbreakable has its rows. Equations (22)-(24) of the method, with the cohesion law at
// k+1. The reference of the implicit path on small meshes, and what a run stores of a step. Rows and unknowns, times the areas S:
//
//     S A       theta (beta - beta+)                                       what the cohesion has lost
//     S beta+   theta [ A - sigma_c (delta_c (1 - beta+) - s_N - gamma chi) ]   s_N = u_N+, or o below
//     p_N       w_N - c                                                    of points that may touch and are not driven on both sides
//     p_T+-     zeta +- w_T                  zeta      mu p_N - p_T+ - p_T-
//     r_T+-     chi +- u_T+                  chi       S gamma sigma_c beta_theta - r_T+ - r_T-
//     o         o - u_N+                                                   so o = max(u_N+, 0)
//
// with  w = w_free + theta W P,  W = H M_hat^-1 H',  P_N = p_N - h S sigma_c beta_theta,  P_T = p_T+ - p_T- + h (r_T+ - r_T-).
// Only the rows that a scene needs are there: no law with friction, no p_T and zeta; no gamma, no r_T and chi; explicit beta, no A, beta+
// and o. Points without cohesion have p_N, p_T and zeta alone. o is needed where a cohesive point can end the step with u_N+ < 0: where
// it lands faster than the scheme can stop it; without such points, and with friction and gamma, the layout is that of
// lcp/spurious_breaking.hpp. With theta < 1 no bond breaks spuriously: beta_theta > 0 wherever beta > 0, so r_T stays and with it chi = |u_T|.
#include "lcp/problem.hpp"
#include "model/state.hpp"
#include "stepper/common/scheme_options.hpp"

#include <memory>

namespace knap {

class PartedBody;

/// First unknown of every group; a group that a scene does not need is empty. Points by their number: 2 interface + end.
struct StepLcpLayout {
    std::vector<Index> cohesive, contacts, landing;  // points with cohesion; that may touch; that need o
    bool implicit_beta = false, friction = false, tangential = false;

    int m() const { return static_cast<int>(cohesive.size()); }
    int c() const { return static_cast<int>(contacts.size()); }
    int bond(int i) const { return i; }  // A
    int beta(int i) const { return m() + i; }
    int normal(int k) const { return (implicit_beta ? 2 * m() : 0) + k; }
    int slip(int k) const { return normal(c()) + 2 * k; }                       // p_T+, then p_T-
    int slip_rate(int k) const { return slip(friction ? c() : 0) + k; }         // zeta
    int tangent(int i) const { return slip_rate(friction ? c() : 0) + 2 * i; }  // r_T+, then r_T-
    int offset(int i) const { return tangent(tangential ? m() : 0) + i; }       // chi
    int opening(int j) const { return offset(tangential ? m() : 0) + j; }       // o
    int size() const { return opening(static_cast<int>(landing.size())); }
};

struct StepLcp {
    LcpProblem problem;
    StepLcpLayout layout;
    // what a solution z means: impulses P = impulse_of_z z + known_impulse of every point, N then T, 2 per point [N s]
    LcpMatrix impulse_of_z;
    Eigen::VectorXd known_impulse;
    Eigen::SparseMatrix<double> jump;  // H [2 n_points, 2 n_corners]; rows of unbreakable points are empty
    std::shared_ptr<const PartedBody> body;
};

/// `options.bulk` is taken to be implicit_theta.
StepLcp step_lcp(const Model& model, const State& begin, double h, const SchemeOptions& options);

/// The end of the step that a solution stands for.
struct StepLcpEnd {
    std::vector<Vec2> rate, velocity;  // [m/s] w and v+, per corner
    std::vector<Vec2> opening;         // [m] (u_N+, u_T+), per point
    std::vector<Vec2> impulse;         // [N s] P, per point, in its frame; of unbreakable points it is not known: 0
    std::vector<double> contact;       // [N s] p, per point
    std::vector<double> cohesion;      // [-] beta+, per point
};

StepLcpEnd recover(const StepLcp& step, const Model& model, const State& begin, double h, const Eigen::VectorXd& z);

}  // namespace knap
