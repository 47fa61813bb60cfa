#pragma once
// Conduction of heat, with the temperatures at the vertices. Corners round a vertex have one temperature (are a node)
// while
// intact points join them; where points are damaged each side keeps its own. Lumped capacity C = rho c V share (that
// of the mass), over the time factor:
//
//     C_i dT_i/dt = sum_j w_ij (T_j - T_i)                                       w_ij = -k A t grad l_i . grad l_j
//                 + sum_points S h(u_N) (T_other - T_i)                          h = 1/(max(u_N, 0)/k_f + 1/h_0)
//                 + sum of free faces that press on each other, S h_0 (T_other - T_i)
//                 + sum_edges L t/2 (q + a (T_outside - T_i)) + V Q/3            Q: source
//
// What one corner gives another one gets, so that the sum of C T changes by what comes through the boundary and from
// sources only, to rounding. c(T) is the slope of the stored heat H(T), latent heat a steep part of it (apparent
// capacity; Thermal::heat_level): a step finds the T that stores what came in, so that no front of melting is missed.
// k(T) is that of the begin of a step, the mean between the temperatures of two corners. Order 2
// conducts on its six linear triangles. On Delaunay meshes all w summed round an edge are >= 0; then an explicit step
// up to C_i/sum_j w_ij, and every implicit one, keeps T between its bounds (maximum principle). Where single corners
// split off a mesh with obtuse triangles it may be exceeded; `overshoot` tells.
#include "heat/heat_exchanges.hpp"

#include <Eigen/SparseCholesky>

#include <memory>
#include <vector>

namespace knap {

class Conduction {
public:
    explicit Conduction(const Model& model);
    static constexpr double safety = 0.8;  // of the stable explicit step

    /// From the temperatures of `begin`, which may be older than its motion, to the time `end` [s]: forward steps of at
    /// most 0.8 of the stable one.
    SharedTemperatures explicit_step(const State& begin, double end);
    /// One step of backward Euler.
    SharedTemperatures implicit_step(const State& begin, double end);

    double capacity(Index corner) const { return capacity_[corner]; }  // [J/K]
    /// [s] C_i/sum_j |w_ij| of the worst node, with the openings of `begin`.
    double stable_step(const State& begin);

private:
    struct Gap {
        Index a, b;          // corners
        double conductance;  // [W/K]
    };

    void find_gaps(const State& begin);
    void follow_conductivity(const std::vector<double>& T);
    const std::vector<double>& present() const { return conductivity_varies_ ? present_ : conductance_; }
    double closed_conductance(Index a, Index b, double length) const;
    double conductance_of(const FanPoint& point, double u_N) const;
    void find_pressed_faces(const State& begin);
    bool is_intact(const State& begin, Index rank, std::size_t point) const;
    /// Heat [W] into every corner at these temperatures, and its sum over boundaries and sources.
    double add_heat(const std::vector<double>& T, std::vector<double>& into) const;
    template <class Visit>
    void for_each_node_of(Index fan, const State& begin, std::vector<Index>& memory, const Visit& visit) const;
    template <class Visit>
    void for_each_node(const State& begin, const Visit& visit) const;
    /// [K] H of a corner over its capacity: T itself where nothing freezes and no c depends on T.
    double level(Index corner, double T) const;
    const Thermal& thermal_of(Index corner) const;
    double apparent_capacity(Index corner, double T) const;  // [J/K]
    /// [K] Of a node at T, after it has got `heat` [J].
    double warmed(std::span<const Index> corners, double T, double heat) const;
    SharedTemperatures finished(const State& begin, double end, std::vector<double> T, double heat_in) const;

    const Model& model_;
    HeatExchanges exchanges_;
    std::vector<double> capacity_;      // [J/K] per corner
    std::vector<double> conductance_;   // [W/K] w of the pairs of corners of each triangle, the largest of all T
    std::vector<double> present_;       // [W/K] at the temperatures of the step, where conductivities depend on them
    std::vector<double> diagonal_;      // [W/K] per corner: sum of |w| and of exchanges
    bool bends_ = false;                // some material has latent heat or a c(T)
    bool conductivity_varies_ = false;  // some material has a k(T)
    std::vector<Gap> gaps_;
    std::vector<double> into_, of_gaps_;  // [W], [W/K] per corner
    std::vector<double> node_capacity_;   // [J/K] of the nodes of stable_step, at the first corner of each
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
    std::vector<Index> analysed_;  // for which factor_ was: the unknown of each corner, then the corners of the gaps
};

}  // namespace knap
