#pragma once
// What heat is given to a body, and at which temperatures it is held, in one step of the heat.
#include "model/state.hpp"

namespace knap {

class HeatExchanges {
public:
    struct AtCorner {
        Index corner;
        double conductance;  // [W/K] to the outside
        double heat;         // [W] given
        const HeatExchange* of;
    };
    explicit HeatExchanges(const Model& model);

    /// Values of the step from `begin` to `end` [s]; theta 0: forward Euler, 1: backward. Given heat has the integral
    /// of its history, so that no pulse is lost; temperatures stay within those of the history.
    void begin_step(double begin, double end, double theta);

    const std::vector<AtCorner>& all() const { return all_; }
    /// Adds the heat [W] at temperatures T to the corners; the sum.
    double add_heat(const std::vector<double>& T, std::vector<double>& into) const;
    bool hold_any() const { return !prescription_.empty(); }
    bool hold(Index corner) const { return hold_any() && prescription_[corner] != nullptr; }
    double held(Index corner) const { return follow(*prescription_[corner]); }  // [K] at the end of the step
    bool give_heat() const { return give_heat_; }                               // flux or source: no maximum principle
    /// Widens [low, high] [K] by the temperatures outside and on held boundaries in an interval of time.
    void widen(double begin, double end, double& low, double& high) const;

private:
    void add_edges(const HeatExchange& exchange);
    double factor_of(const HeatExchange& exchange) const { return factor_[&exchange - model_.heat->exchanges.data()]; }
    double follow(const HeatExchange& of) const { return model_.heat->follow(of.value, factor_of(of)); }

    const Model& model_;
    std::vector<AtCorner> all_;
    std::vector<double> factor_;                     // [-] per HeatExchange, of its history in the step
    std::vector<const HeatExchange*> prescription_;  // per corner; null: free; empty: nothing is held
    bool give_heat_ = false;
};

}  // namespace knap
