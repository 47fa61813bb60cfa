#include "heat/heat_exchanges.hpp"

#include "element/shape_functions.hpp"
#include "model/selections.hpp"

#include <algorithm>

namespace knap {

HeatExchanges::HeatExchanges(const Model& model) : model_(model) {
    const Mesh& mesh = model_.mesh;
    const Index n = mesh.corners_per_triangle();
    for (const HeatExchange& exchange : model_.heat->exchanges) {
        using Kind = HeatExchange::Kind;
        if (exchange.kind == Kind::temperature) {
            prescription_.resize(mesh.n_corners(), nullptr);
            const std::vector<char> selected = selected_corners(mesh, exchange.on);
            for (Index c = 0; c < mesh.n_corners(); ++c)
                if (selected[c] && !model.has_vanished(mesh.triangle_of(c))) prescription_[c] = &exchange;
        } else if (exchange.kind == Kind::source) {
            give_heat_ = true;
            for (const Index t : selected_triangles(mesh, exchange.on))
                for (Index k = 0; k < n && !model.has_vanished(t); ++k) {
                    const double volume = corner_share(mesh.order, k, mesh.area(t) * model_.thickness);
                    all_.push_back({n * t + k, 0, exchange.value * volume, &exchange});
                }
        } else {
            give_heat_ = give_heat_ || exchange.kind == Kind::flux;
            add_edges(exchange);
        }
    }
}

/// Trapezoidal shares of an edge; of order 2 of its two halves.
void HeatExchanges::add_edges(const HeatExchange& exchange) {
    const Mesh& mesh = model_.mesh;
    for (const std::size_t i : selected_edges(mesh, exchange.on)) {
        const auto& [triangle, side, boundary] = mesh.boundary_edges[i];
        const Index first = mesh.corners_per_triangle() * triangle;
        const double area = mesh.side_vector(triangle, side).norm() * model_.thickness;
        const auto add = [&](Index k, double share) {
            const bool convects = exchange.kind == HeatExchange::Kind::convection;
            all_.push_back({first + k, convects ? exchange.transfer * share * area : 0,
                            convects ? 0 : exchange.value * share * area, &exchange});
        };
        const double at_ends = mesh.order == 1 ? 0.5 : 0.25;
        add(side, at_ends), add((side + 1) % 3, at_ends);
        if (mesh.order == 2) add(3 + side, 0.5);
    }
}

void HeatExchanges::begin_step(double begin, double end, double theta) {
    factor_.clear();
    for (const HeatExchange& exchange : model_.heat->exchanges) {
        const TimeFunction& history = exchange.history;
        switch (exchange.kind) {
            case HeatExchange::Kind::flux:
            case HeatExchange::Kind::source:
                factor_.push_back(history(theta == 0 ? begin : end) + history.beyond_trapezoid(begin, end));
                break;
            case HeatExchange::Kind::convection: factor_.push_back(history.over_step(begin, end, theta)); break;
            case HeatExchange::Kind::temperature:  // large steps end at its corners
                factor_.push_back(theta == 0 ? history.over_step(begin, end, 1) : history(end));
        }
    }
}

double HeatExchanges::add_heat(const std::vector<double>& T, std::vector<double>& into) const {
    double sum = 0;
    for (const AtCorner& at : all_) {
        const double flow =
            at.conductance > 0 ? at.conductance * (follow(*at.of) - T[at.corner]) : at.heat * factor_of(*at.of);
        into[at.corner] += flow, sum += flow;
    }
    return sum;
}

void HeatExchanges::widen(double begin, double end, double& low, double& high) const {
    for (const HeatExchange& exchange : model_.heat->exchanges) {
        if (exchange.kind != HeatExchange::Kind::temperature && exchange.transfer <= 0) continue;
        for (const double factor : exchange.history.range(begin, end)) {
            const double T = model_.heat->follow(exchange.value, factor);
            low = std::min(low, T), high = std::max(high, T);
        }
    }
}

}  // namespace knap
