#pragma once
// Stress intensity factors and J at the tip of a pre-crack that stands, by integrals over a domain round it. With q
// falling from 1 round the tip to 0 at the radius, and x along the crack (B. Moran and C. F. Shih, Eng. Fract. Mech. 27
// (1987); T. Nakamura, C. F. Shih, L. B. Freund, Int. J. Fract. 27 (1985); thermal strains and loaded faces: C. F.
// Shih, B. Moran, T. Nakamura, Int. J. Fract. 30 (1986)):
//
//     J = int [sigma_ij u_i,x q_,j - (W + T) q_,x + rho ((a_i - g_i) u_i,x - v_i v_i,x) q + sigma_ii e_,x q] dA
//         - int t_i [u_i],x q ds
//     K = E'/2 { int [(sigma_ij w_i,x + tau_ij u_i,x) q_,j - sigma_ij w_i,j q_,x + rho (a_i - g_i) w_i,x q
//                     + tau_ii e_,x q] dA - int t_i [w_i],x q ds }
//
// W = 1/2 sigma : (eps - e I), T: elastic and kinetic energy, e: thermal strain in the plane, rho g: a uniform body
// force, (w, tau): Williams' static field of K_I = 1, then of K_II = 1; sums over the two components in the plane. On
// the faces of the crack, with jumps [ ] from side A to side B, t is the traction on side B by a fluid, by contact and
// by friction. All domains give the same.
#include "stepper/common/crack_forces.hpp"

#include <algorithm>
#include <memory>

namespace knap {

struct TipFactors {
    double K_I, K_II;  // [Pa m^1/2]
    double J;          // [J/m2]
};

class TipIntegral {
public:
    /// At the tip nearest to `at`. Throws SimulationError, which names `probe`, where there is none within the radius
    /// [m], or where the domain is not that of one straight crack in one material without other loads than a uniform
    /// body force, temperatures, and those of the faces.
    TipIntegral(const Model& model, const Vec2& at, double radius, const std::string& probe);

    const Vec2& tip() const { return tip_; }  // [m]
    /// At the start and at the end of every step: accelerations are differences of velocities.
    void after_step(const State& state);
    /// NaN where an interface in the domain is damaged, so that the tip does not stand any more, and while
    /// accelerations are not known.
    TipFactors factors(const State& state) const;
    bool has_vanished() const;
    /// Goes on with the velocities of another one, if that has the same domain.
    void continue_from(TipIntegral&& other);

    void serialize(auto& archive) { archive(triangles_, velocity_, acceleration_, last_step_, known_); }

private:
    /// An edge of the crack, from the far end of its points to the one nearer to the tip.
    struct Face {
        std::array<Index, 3> point;      // by distance, the farthest first; of order 1 two
        std::array<double, 3> behind{};  // [m] their distances from the tip
        std::array<double, 3> q{};       // [-]
        Vec2 normal;                     // from A to B, local
        double side;                     // 1: B lies to the left of the crack's direction, -1
    };
    /// A uniform body force.
    struct BodyForce {
        Index history;      // into Model::histories
        Vec2 acceleration;  // [m/s2]
    };
    void place_tip(const Vec2& at, const std::string& probe);
    void check_domain(const std::string& probe) const;
    void find_body_forces(const std::string& probe);
    void find_faces();
    TipFactors of_faces(const State& state, double kappa, double shear) const;
    bool stands(const State& state) const;
    [[noreturn]] void refuse(const std::string& probe, const std::string& what, const Vec2& where) const;
    Vec2 local(const Vec2& global) const { return {along_.dot(global), turned_left(along_).dot(global)}; }
    double distance(Index vertex) const { return (model_.mesh.vertices[vertex] - tip_).norm(); }
    bool is_inside(Index vertex) const { return distance(vertex) < radius_; }
    double q_at(double distance) const { return std::clamp(2 * (1 - distance / radius_), 0.0, 1.0); }

    const Model& model_;
    double radius_;                 // [m]
    Vec2 tip_, along_;              // [m] and the direction in which the crack would go on
    std::vector<Index> triangles_;  // of the domain
    std::vector<Index> points_;     // of the interfaces between them that are no cracks
    std::vector<Face> faces_;
    std::vector<BodyForce> body_forces_;
    std::unique_ptr<CrackForces> fluids_;        // null: there is none
    std::vector<Vec2> velocity_, acceleration_;  // per corner of the domain
    double last_step_ = 0;                       // [s] of those velocities
    bool known_ = false;                         // the accelerations: from the start, or from the second step on
};

}  // namespace knap
