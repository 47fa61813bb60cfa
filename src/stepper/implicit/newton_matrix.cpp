#include "stepper/implicit/newton_matrix.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>

namespace knap {

NewtonMatrix::NewtonMatrix(const Model& model, ThetaMatrix& matrix) : matrix_(matrix) {
    reserve_capacity(model.fan_points.size() + 1, states_, tangents_);
}

bool NewtonMatrix::factorise(const std::vector<ActivePoint>& points, int& n_factorisations) {
    // one entry more than points: "no points" differs from "no factor"
    bool same = matrix_.has_factor() && states_.size() == points.size() + 1;
    for (std::size_t i = 0; same && i < points.size(); ++i) same = states_[i] == points[i].response.state;
    if (same) return true;
    states_.resize(points.size() + 1);
    for (std::size_t i = 0; i < points.size(); ++i) states_[i] = points[i].response.state;
    const bool softens = std::ranges::any_of(points, [](const ActivePoint& p) { return p.response.softens; });
    for (const Softening softening : {Softening::now, Softening::none}) {
        if (softening == Softening::now && !softens) continue;
        make_tangents(points, softening);
        ++n_factorisations;
        indefinite_ = softens && softening == Softening::none;
        if (matrix_.factorise(tangents_)) return true;
    }
    forget();
    return false;
}

void NewtonMatrix::make_tangents(const std::vector<ActivePoint>& points, Softening softening) {
    tangents_.clear();
    for (const ActivePoint& point : points) {
        const Eigen::Matrix2d D = tangent(point.law, point.multipliers, point.response, softening);
        if (D.isZero(0)) continue;
        const Eigen::Matrix2d axes = point.axes();
        tangents_.push_back({.sides = point.sides,
                             .block = axes * D * axes.transpose(),
                             .symmetric_block = axes * symmetric_part(D) * axes.transpose()});
    }
}

bool NewtonMatrix::violates_assumption_1(const std::vector<ActivePoint>& points) {
    if (indefinite_) return true;
    // the factor has the slope at the end of the step; the step may pass steeper ones
    const auto may_be_steeper = [](const ActivePoint& p) {
        return (p.response.breaks && p.law.cohesion > 0) || (p.response.softens && p.law.material->softening);
    };
    if (std::ranges::none_of(points, may_be_steeper)) return false;
    make_tangents(points, Softening::at_all);
    forget();
    return !matrix_.factorise(tangents_);
}

}  // namespace knap
