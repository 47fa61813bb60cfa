#pragma once
// Links that obey interface laws as one linear complementarity problem. Every term  r in w sgn(V_T - k)  of a
// tangential law, w = w0 + w1 p, is a friction law of its own with P_T = sum (a - c)  (D. E. Stewart, J. C. Trinkle
// 1996):
//     0 <= p  perp  V_N - b >= 0,               0 <= a  perp  V_T - k + y >= 0,
//     0 <= c  perp  -(V_T - k) + y >= 0,        0 <= y  perp  w - a - c >= 0
//
// Friction over pressure, w1 f(p): with the bends p_i of its polygon, where its slope falls by d_i,
//     w = w0 + w1 (mu_1 p - sum d_i z_i),      0 <= z_i  perp  z_i - p + p_i >= 0
//
// Secant unloading: l is what of the cohesion C is not borne, w = w0 (1 - l/C) of its sign, whose y is |V_T - k|:
//     0 <= l  perp  V_N + start + gamma y + ramp (l/C - 1) + m >= 0,           0 <= m  perp  C - l >= 0
#include "lcp/solvers.hpp"
#include "nonsmooth/link_state.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace knap {

/// Keeps its memory from one problem to the next.
class StaircaseLcp {
public:
    void clear() { rows_.clear(), largest_unit_ = 0; }
    /// Adds a link with a law; `mobility` [1/kg]: trace of its own response.
    void add(std::size_t link, const InterfaceLaw& law, double mobility);
    /// Adds a link with secant unloading, if the law has that.
    void add(std::size_t number, const FanLink& link, const InterfaceLaw& law, double mobility);

    /// response(i, along, j, on) [1/kg]: what an impulse on link j in direction `on` (0: N, 1: T) adds to the rate of
    /// link i; free(i, along) [m/s]: its rate without impulses; `speed` [m/s]: the scale of the problem. False where
    /// Lemke's paths end without a solution.
    template <class Response, class Free>
    bool solve(double speed, const Response& response, const Free& free);
    /// Calls add(link, along, impulse [N s]) for every part of an impulse.
    template <class Add>
    void for_impulses(const Add& add) const {
        for (std::size_t r = 0; r < rows_.size(); ++r)
            if (const Row& row = rows_[r]; row.sign != 0)
                add(row.link, row.along, scale_ * row.unit * z_[r] * row.sign);
    }
    /// Calls add(link, C - C r [N s]) for every link on a ramp.
    template <class Add>
    void for_lacks(const Add& add) const {
        for (std::size_t r = 0; r < rows_.size(); ++r)
            if (const Row& row = rows_[r]; row.cohesion > 0 && row.sign != 0) add(row.link, scale_ * row.unit * z_[r]);
    }
    /// Residual of the scaled problem.
    double residual() const { return residual_; }

private:
    /// One unknown impulse of the problem, and its row.
    struct Row {
        std::size_t link;
        int along;                  // 0: contact, 1: friction
        double sign;                // of the impulse; 0: the slack y
        double rate;                // [m/s] b of a contact, k of a sign
        double cohesive, friction;  // [N s], [-] w0, w1 of a sign; p_i of a bend
        std::size_t first;          // of the three rows of a sign
        double cohesion;            // [N s] C of the rows l, m of a ramp; else 0
        double ramp;                // [m/s] of the row l
        double unit;                // [sqrt kg] scales impulses up and velocities down: W has a unit diagonal
        double bend = 0;            // [-] d_i/mu_1 of the row z_i; else 0
    };
    double coefficient_of_bend(const Row& row, const Row& column) const;
    template <class Response>
    double coefficient(const Row& row, const Row& column, const Response& response) const;

    std::vector<Row> rows_;
    double largest_unit_ = 0, scale_ = 1;  // scale_ [m/s sqrt kg]
    std::vector<double> M_, q_, z_, w_;    // Eigen's own would allocate with every size
    double residual_ = 0;
};

inline void StaircaseLcp::add(std::size_t link, const InterfaceLaw& law, double mobility) {
    const double unit = mobility > 0 ? std::sqrt(2 / mobility) : 1;
    largest_unit_ = std::max(largest_unit_, unit);
    if (law.contact.may_touch) rows_.push_back({link, 0, 1, law.contact.rate, 0, 0, rows_.size(), 0, 0, unit});
    for (const Staircase::Kink& kink : law.staircase(law.contact.may_touch).kinks()) {
        const std::size_t first = rows_.size();
        for (const double sign : {1., -1., 0.})
            rows_.push_back({link, 1, sign, kink.rate, kink.cohesive,
                             kink.friction * law.staircase(law.contact.may_touch).line.slope, first, 0, 0, unit});
    }
}

inline void StaircaseLcp::add(std::size_t number, const FanLink& link, const InterfaceLaw& law, double mobility) {
    const double unit = mobility > 0 ? std::sqrt(2 / mobility) : 1;
    if (link.pressed && law.contact.may_touch) {
        InterfaceLaw of_first = law;
        of_first.closed.line = link.pressed.line(0);
        add(number, of_first, mobility);
        const FrictionOverPressure& polygon = *link.pressed.law;
        for (int i = 1; i < polygon.n_lines(); ++i)
            rows_.push_back({number, 1, 0, 0, link.pressed.unit * polygon.start(i), 0, rows_.size(), 0, 0, unit,
                             (polygon.line(i - 1).slope - polygon.line(i).slope) / polygon.line(0).slope});
    } else {
        add(number, law, mobility);
    }
    if (!(link.ramp > 0 && link.cohesive > 0)) return;
    const std::size_t first = rows_.size();
    for (const double sign : {1., 0.})
        rows_.push_back(
            {number, 0, sign, link.ramp - link.ramp_start.x(), 0, 0, first, link.cohesive, link.ramp, unit});
}

template <class Response, class Free>
bool StaircaseLcp::solve(double speed, const Response& response, const Free& free) {
    const auto n = static_cast<Eigen::Index>(rows_.size());
    scale_ = speed * largest_unit_;
    M_.resize(n * n);
    for (std::vector<double>* list : {&q_, &z_, &w_}) list->resize(n);
    Eigen::Map<Eigen::MatrixXd> M(M_.data(), n, n);
    Eigen::Map<Eigen::VectorXd> q(q_.data(), n), z(z_.data(), n), w(w_.data(), n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Row& row = rows_[i];
        for (Eigen::Index j = 0; j < n; ++j) M(i, j) = coefficient(row, rows_[j], response);
        q[i] = row.sign == 0 ? (row.cohesive + row.cohesion) / (scale_ * row.unit)
                             : row.sign * row.unit * (free(row.link, row.along) - row.rate) / scale_;
    }
    const bool has_ramps = std::ranges::any_of(rows_, [](const Row& row) { return row.cohesion > 0; });
    if (!solve_lcp_by_lemke(M, q, z, has_ramps)) return false;
    w.noalias() = M * z;
    w += q;
    residual_ = n > 0 ? w.cwiseMin(z).cwiseAbs().maxCoeff() : 0;
    return true;
}

inline double StaircaseLcp::coefficient_of_bend(const Row& row, const Row& column) const {
    if (row.link != column.link) return 0;
    if (row.bend > 0 && column.bend > 0) return row.first == column.first ? 1 : 0;
    if (row.bend > 0) return column.along == 0 && column.cohesion == 0 ? -1 : 0;
    return row.sign == 0 && row.cohesion == 0 ? -row.friction * column.bend : 0;
}

template <class Response>
double StaircaseLcp::coefficient(const Row& row, const Row& column, const Response& response) const {
    if (row.bend > 0 || column.bend > 0) return coefficient_of_bend(row, column);
    if (row.link == column.link && (row.cohesion > 0 || column.cohesion > 0)) {
        const auto is_cap = [](const Row& r) { return r.cohesion > 0 && r.sign == 0; };
        const auto is_lack = [](const Row& r) { return r.cohesion > 0 && r.sign != 0; };
        const auto is_slack = [](const Row& r) { return r.cohesion == 0 && r.sign == 0; };
        if (is_cap(row)) return is_lack(column) ? -1 : 0;
        if (is_cap(column)) return is_lack(row) ? 1 : 0;
        if (is_slack(row)) return -row.cohesive / column.cohesion;
        if (is_slack(column)) return column.cohesive / row.cohesion;
        const double by_impulse =
            row.unit * column.unit * row.sign * column.sign * response(row.link, row.along, column.link, column.along);
        return by_impulse + (is_lack(row) && is_lack(column) ? row.unit * row.unit * row.ramp / row.cohesion : 0);
    }
    const bool same_sign = row.along == 1 && column.along == 1 && row.first == column.first;
    if (row.sign == 0) {
        if (row.link == column.link && column.along == 0) return row.friction;
        return same_sign && column.sign != 0 ? -1 : 0;
    }
    if (column.sign == 0) return same_sign ? 1 : 0;
    return row.unit * column.unit * row.sign * column.sign * response(row.link, row.along, column.link, column.along);
}

}  // namespace knap
