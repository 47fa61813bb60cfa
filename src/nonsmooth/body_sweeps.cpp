#include "nonsmooth/body_sweeps.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr int sweeps_until_all = 8;  // sweeps: over all contacts

}  // namespace

void BodySweeps::read(const std::vector<ClusterContact>& contacts, const std::vector<ClusterBody>& bodies,
                      const std::vector<ClusterTerm>& terms, const std::vector<Eigen::Matrix2d>& own) {
    rows_.clear(), parts_.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const ClusterContact& c = contacts[i];
        assert(c.cohesive == 0 && !c.unbreakable && !c.other);
        const auto kinks = c.law.closed.kinks();
        assert(kinks.size() < 3);
        double friction = 0;
        for (const Staircase::Kink& kink : kinks) friction += kink.friction;
        const auto first = static_cast<Index>(parts_.size());
        for (Index k = c.first_term; k < c.last_term; ++k) {
            const ClusterTerm& term = terms[k];
            const Vec3& inverse_mass = bodies[term.body].inverse_mass;
            parts_.push_back({term.body, term.along_N, term.along_T, inverse_mass.cwiseProduct(term.along_N),
                              inverse_mass.cwiseProduct(term.along_T)});
        }
        rows_.push_back({.free = c.free,
                         .W_NN = own[i](0, 0),
                         .W_TN = own[i](1, 0),
                         .W_TT = own[i](1, 1),
                         .may_touch = c.law.contact.may_touch,
                         .bound = c.law.contact.rate,
                         .kinks = {kinks.empty() ? 0 : kinks.front().rate, kinks.empty() ? 0 : kinks.back().rate},
                         .friction = friction,
                         .impulse = c.impulse,
                         .step = Vec2::Zero(),
                         .direction = Vec2::Zero(),
                         .first_part = first,
                         .last_part = static_cast<Index>(parts_.size())});
    }
    change_.assign(bodies.size(), Vec3::Zero());
    for (const Row& row : rows_)
        for (Index k = row.first_part; k < row.last_part; ++k)
            change_[parts_[k].body] += row.impulse.x() * parts_[k].by_N + row.impulse.y() * parts_[k].by_T;
}

/// [N s] -P_T in mu p 1/2 [sgn(V_T - kink_0) + sgn(V_T - kink_1)] with V_T = free + W_TT P_T.
double BodySweeps::tangential(const Row& row, double p, double free) {
    const double most = row.friction * p;
    if (free < row.kinks[0]) return row.W_TT > 0 ? std::min(most, (row.kinks[0] - free) / row.W_TT) : most;
    if (free > row.kinks[1]) return row.W_TT > 0 ? std::max(-most, (row.kinks[1] - free) / row.W_TT) : -most;
    return 0;
}

void BodySweeps::solve(Row& row, Change& change) {
    Vec2 V = row.free;
    for (Index k = row.first_part; k < row.last_part; ++k) {
        const Vec3& c = change_[parts_[k].body];
        V.x() += parts_[k].along_N.dot(c), V.y() += parts_[k].along_T.dot(c);
    }
    double p = row.impulse.x();
    if (row.W_NN > 0) p = row.may_touch ? std::max(0.0, p - (V.x() - row.bound) / row.W_NN) : 0;
    const double more = p - row.impulse.x();
    const double T = p > 0 ? tangential(row, p, V.y() + row.W_TN * more - row.W_TT * row.impulse.y()) : 0;
    row.step = {more, T - row.impulse.y()};
    if (row.step.isZero(0)) return;
    const double by_N = std::abs(row.step.x()) * row.W_NN, by_T = std::abs(row.step.y()) * row.W_TT;
    change.largest = std::max({change.largest, by_N, by_T});
    change.norm2 += by_N * std::abs(row.step.x()) + by_T * std::abs(row.step.y());
    row.impulse = {p, T};
    for (Index k = row.first_part; k < row.last_part; ++k)
        change_[parts_[k].body] += row.step.x() * parts_[k].by_N + row.step.y() * parts_[k].by_T;
}

BodySweeps::Change BodySweeps::sweep(const std::vector<Index>& rows) {
    Change change;
    for (const Index i : rows) solve(rows_[i], change);
    return change;
}

int BodySweeps::run(double change, int max_sweeps, std::vector<ClusterContact>& contacts) {
    all_.resize(rows_.size());
    std::iota(all_.begin(), all_.end(), 0);
    direction_.assign(change_.size(), Vec3::Zero());
    double before2 = infinity;
    int n = 0;
    for (bool whole = true; n < max_sweeps;) {
        start_ = change_;
        ++n;
        const Change now = sweep(whole ? all_ : closed_);
        if (n == max_sweeps || (whole && now.largest <= change)) break;
        if (whole) {
            closed_.clear();
            for (const Index i : all_) {
                Row& row = rows_[i];
                if (!row.impulse.isZero(0) || !row.step.isZero(0)) {
                    closed_.push_back(i);
                    continue;
                }
                for (Index k = row.first_part; k < row.last_part; ++k)
                    direction_[parts_[k].body] -=
                        row.direction.x() * parts_[k].by_N + row.direction.y() * parts_[k].by_T;
                row.direction.setZero();
            }
        }
        const bool restarts = now.norm2 > before2;
        const double beta = restarts || before2 == 0 ? 0 : now.norm2 / before2;
        before2 = now.norm2;
        for (const Index i : closed_) {
            Row& row = rows_[i];
            const Vec2 extra = beta * row.direction;
            row.impulse += extra;
            row.direction = restarts ? Vec2(Vec2::Zero()) : Vec2(row.step + extra);
        }
        for (std::size_t b = 0; b < change_.size(); ++b) {
            const Vec3 extra = beta * direction_[b], step = change_[b] - start_[b];
            change_[b] += extra;
            direction_[b] = restarts ? Vec3(Vec3::Zero()) : Vec3(step + extra);
        }
        whole = n % sweeps_until_all == 0 || n + 1 == max_sweeps || now.largest <= change;
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) contacts[i].impulse = rows_[i].impulse;
    return n;
}

}  // namespace knap
