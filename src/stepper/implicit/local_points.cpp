#include "stepper/implicit/local_points.hpp"

#include "base/reserve_capacity.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double far_from_law = 1e-3;  // of the scale
constexpr double local_goal = 1e-8;    // of the scale: change of an impulse in a sweep
constexpr int max_inner_sweeps = 20;

double distance_from_law(const ActivePoint& point) {
    return std::max(std::abs(point.response.contact - point.multipliers.contact),
                    std::abs(point.response.tangential - point.multipliers.tangential));
}

/// (N, T) [N s] that its piece gives at its rate, and that its multipliers give.
std::pair<Vec2, Vec2> impulses_of(const ActivePoint& point) {
    const Vec2 cohesive(point.law.strength * point.response.cohesion_theta, 0);
    return {point.impulse_of_piece(point.rate) - cohesive,
            Vec2(point.multipliers.contact, point.multipliers.tangential) - cohesive};
}

}  // namespace

LocalPoints::LocalPoints(const Model& model, ThetaMatrix& matrix) : matrix_(matrix) {
    reserve_capacity(model.fan_points.size(), fans_, place_);
    reserve_capacity(max_points, chosen_, sides_, at_);
}

/// Whole fans, those farthest from their laws first. Contacts with obstacles are left out.
void LocalPoints::choose(const std::vector<ActivePoint>& points, double unit) {
    fans_.clear(), chosen_.clear();
    for (std::size_t first = 0, end; first < points.size(); first = end) {
        end = end_of_fan(points, first);
        double distance = 0;
        for (std::size_t j = first; j < end; ++j) distance = std::max(distance, distance_from_law(points[j]));
        if (points[first].fan >= 0 && distance > far_from_law * unit) fans_.emplace_back(-distance, first);
    }
    std::ranges::sort(fans_);
    for (const auto& [distance, first] : fans_) {
        const std::size_t end = end_of_fan(points, first);
        if (chosen_.size() + end - first > max_points) continue;
        for (std::size_t j = first; j < end; ++j) chosen_.push_back(j);
    }
}

bool LocalPoints::solve(const std::vector<ActivePoint>& points, const std::vector<Vec2>& direction, Softening softening,
                        double unit, std::vector<Vec2>& residual) {
    forget();
    choose(points, unit);
    if (chosen_.empty()) return false;
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(chosen_.size());
    sides_.clear(), at_.clear();
    for (const std::size_t j : chosen_) sides_.push_back(points[j].sides), at_.push_back(points[j].multipliers);
    compliance_.resize(n, n), rate_.resize(n), impulse_.resize(n), step_.resize(n);
    if (!matrix_.find_compliance(sides_, compliance_)) return false;
    const auto chosen = [&](Eigen::Index k) -> const ActivePoint& { return points[chosen_[k / 2]]; };
    const auto block = [&](Eigen::Index k) {
        return tangent(chosen(k).law, chosen(k).multipliers, chosen(k).response, softening);
    };
    for (Eigen::Index k = 0; k < n; k += 2) {
        const Eigen::Matrix2d axes = chosen(k).axes();
        for (Eigen::Index i = 0; i < n; ++i)
            compliance_.block<1, 2>(i, k) = (compliance_.block<1, 2>(i, k) * axes).eval();
        for (Eigen::Index i = 0; i < n; ++i)
            compliance_.block<2, 1>(k, i) = (axes.transpose() * compliance_.block<2, 1>(k, i)).eval();
    }
    // without their blocks: (1 - W D)^-1 W
    Matrix without = Matrix::Identity(n, n);
    for (Eigen::Index k = 0; k < n; k += 2)
        without.middleCols<2>(k) -= compliance_.middleCols<2>(k).lazyProduct(symmetric_part(block(k)));
    compliance_ = without.partialPivLu().solve(compliance_);
    // from the multipliers on, whose impulses differ from those at the end of the step
    for (Eigen::Index k = 0; k < n; k += 2) {
        const auto [of_piece, now] = impulses_of(chosen(k));
        step_.segment<2>(k) = chosen(k).across(direction);
        rate_.segment<2>(k) = chosen(k).rate + step_.segment<2>(k);
        impulse_.segment<2>(k) = now - of_piece + block(k) * step_.segment<2>(k);
    }
    rate_ += compliance_.lazyProduct(impulse_);
    for (Eigen::Index k = 0; k < n; k += 2) impulse_.segment<2>(k) = impulses_of(chosen(k)).second;
    if (!find_impulses(points, unit)) return false;
    for (Eigen::Index k = 0; k < n; k += 2) {
        const Vec2 beyond =
            impulse_.segment<2>(k) - impulses_of(chosen(k)).first + block(k) * (rate_.segment<2>(k) - chosen(k).rate);
        sides_[k / 2].add_force(-chosen(k).out_of_frame(beyond), residual);
    }
    place_.assign(points.size(), -1);
    for (std::size_t k = 0; k < chosen_.size(); ++k) place_[chosen_[k]] = static_cast<int>(k);
    return true;
}

/// From the multipliers in at_, with the rates that belong to them.
bool LocalPoints::find_impulses(const std::vector<ActivePoint>& points, double unit) {
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
        const bool slips_freely = std::isinf(at_[k].rho_T), may_touch = points[chosen_[k]].law.contact.may_touch;
        const Eigen::Index row = 2 * static_cast<Eigen::Index>(k);
        const double W_N = compliance_(row, row), W_T = compliance_(row + 1, row + 1);
        if ((may_touch && !(W_N > 0)) || (!slips_freely && !(W_T > 0))) return false;
        if (may_touch) at_[k].rho_N = 1 / W_N;
        if (!slips_freely) at_[k].rho_T = 1 / W_T;
    }
    const Eigen::Index n = static_cast<Eigen::Index>(chosen_.size());
    const auto fan = [&](Eigen::Index k) { return points[chosen_[k]].fan; };
    for (int sweep = 0; sweep < max_iterations; ++sweep) {
        double largest = 0;
        for (Eigen::Index first = 0, end; first < n; first = end) {
            for (end = first; end < n && fan(end) == fan(first);) ++end;
            largest = std::max(largest, sweep_fan(points, first, end, local_goal * unit));
        }
        if (!rate_.allFinite() || !impulse_.allFinite()) return false;
        if (largest <= local_goal * unit) return true;
    }
    return false;
}

/// Of the chosen points from `first` to `end`: the largest change of an impulse [N s]. The others follow at its end.
double LocalPoints::sweep_fan(const std::vector<ActivePoint>& points, Eigen::Index first, Eigen::Index end,
                              double goal) {
    const Eigen::Index begin = 2 * first, size = 2 * (end - first);
    const Vector rate = rate_.segment(begin, size), impulse = impulse_.segment(begin, size);
    for (int inner = 0; inner < max_inner_sweeps; ++inner) {
        double longest = 0;
        for (Eigen::Index k = first; k < end; ++k) {
            const PointLaw& law = points[chosen_[k]].law;
            const PointResponse r = respond(law, at_[k], rate_[2 * k], rate_[2 * k + 1]);
            const Vec2 q(r.normal(law), r.tangential), change = q - impulse_.segment<2>(2 * k);
            at_[k].contact = r.contact, at_[k].tangential = r.tangential;
            impulse_.segment<2>(2 * k) = q;
            rate_.segment(begin, size) += compliance_.block(begin, 2 * k, size, 2).lazyProduct(change);
            longest = std::max(longest, change.cwiseAbs().maxCoeff());
        }
        if (!(longest > goal)) break;
    }
    const Vector change = impulse_.segment(begin, size) - impulse;
    rate_.segment(begin, size) = rate;
    rate_ += compliance_.middleCols(begin, size).lazyProduct(change);
    return change.cwiseAbs().maxCoeff();
}

}  // namespace knap
