#include "nonsmooth/contact_problem.hpp"

#include "nonsmooth/link_state.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

// [-] of the mobility that a row has whose parts could all move: a smaller one is the rounding of a share, as where a
// vertex that is held lies at the held end of an edge, whose other end is free
constexpr double held = 1e-8;

}  // namespace

void ContactProblem::clear() {
    bodies_.clear(), corners_.clear(), terms_.clear(), rows_.clear();
    cluster_.contacts.clear(), cluster_.bodies.clear(), cluster_.terms.clear();
    curved_.clear();
    free_of_rigid_.clear();
}

Index ContactProblem::add_body(const Vec2& free, const Vec2& inverse_mass) {
    corners_.push_back({static_cast<Index>(bodies_.size()), Vec2::Zero()});
    bodies_.push_back({free, inverse_mass});
    return static_cast<Index>(corners_.size()) - 1;
}

/// Corners whose links stick move as one, with the relative velocities of the last solution:
///
///     v_i = v + offset_i,     sum m_i v_free = sum m_i (v_i_free - offset_i)
void ContactProblem::add_parts(const SolvedFan& solved, Index n_corners, bool stuck_stays) {
    const FanProblem& fan = solved.problem;
    const FanResult& result = solved.result;
    part_.resize(n_corners);
    std::iota(part_.begin(), part_.end(), 0);
    const auto is_free = [&](Index body) {
        return body >= 0 && body < n_corners && fan.bodies[body].inverse_mass.minCoeff() > 0;
    };
    for (std::size_t i = 0; i < fan.links.size(); ++i) {
        const FanLink& link = fan.links[i];
        if (!stuck_stays || !result.links[i].stuck || !is_free(link.before) || !is_free(link.after)) continue;
        const auto [first, other] = std::minmax({part_[link.before], part_[link.after]});
        std::ranges::replace(part_, other, first);
    }
    const std::size_t first_body = bodies_.size();
    for (Index i = 0; i < n_corners; ++i) {
        const FanBody& own = fan.bodies[i];
        const Vec2 offset = result.velocity[i] - result.velocity[part_[i]];
        corners_.push_back({static_cast<Index>(first_body) + part_[i], offset});
        bodies_.push_back({own.free_velocity, own.inverse_mass});
        if (part_[i] == i) continue;
        Body& body = bodies_[first_body + part_[i]];
        const Vec2 mass = body.inverse_mass.cwiseInverse(), sum = mass + own.mass();
        body.free =
            (mass.cwiseProduct(body.free) + own.mass().cwiseProduct(own.free_velocity - offset)).cwiseQuotient(sum);
        body.inverse_mass = sum.cwiseInverse();
    }
}

Index ContactProblem::add_fan(const SolvedFan& solved, Index n_corners, bool stuck_stays) {
    const FanProblem& fan = solved.problem;
    const FanResult& result = solved.result;
    const double rest = scales_of(fan, 0).rest;
    const auto first = static_cast<Index>(corners_.size());
    add_parts(solved, n_corners, stuck_stays);
    for (std::size_t b = n_corners; b < fan.bodies.size(); ++b) add_body(fan.bodies[b].free_velocity, Vec2::Zero());
    for (std::size_t i = 0; i < fan.links.size(); ++i) {
        FanLink link = fan.links[i];
        const auto body_of = [&](Index body) { return body < 0 ? -1 : corners_[first + body].body; };
        if (body_of(link.before) == body_of(link.after)) continue;
        ClusterContact point{.unbreakable = link.unbreakable};
        if (!link.unbreakable) {
            if (link.ramp > 0) link.cohesive = result.links[i].cohesive_impulse;
            const Vec2 before = fan.velocity_before(link.after) - fan.velocity_before(link.before);
            if (link.coupling == Coupling::sum) point.law = link_law(link, before, fan.drift_time, rest);
            else curved_.push_back({cluster_.contacts.size(), norm_law(link, before, fan.drift_time, rest)});
            point.cohesive = link.cohesive, point.pressed = link.pressed;
        }
        point.impulse = {link.normal.dot(result.links[i].impulse), link.tangent().dot(result.links[i].impulse)};
        const auto row = static_cast<Index>(cluster_.contacts.size());
        cluster_.contacts.push_back(point);
        if (link.after >= 0) terms_.push_back({{first + link.after, link.normal, link.tangent()}, row});
        if (link.before >= 0) terms_.push_back({{first + link.before, -link.normal, -link.tangent()}, row});
    }
    return first;
}

Index ContactProblem::add_rigid_body(const Vec3& free, const Vec3& inverse_mass) {
    free_of_rigid_.push_back(free);
    cluster_.bodies.push_back({inverse_mass});
    return static_cast<Index>(free_of_rigid_.size()) - 1;
}

void ContactProblem::add_contact(const Vec2& impulse, const Vec2& given) {
    rows_.push_back(static_cast<Index>(cluster_.contacts.size()));
    cluster_.contacts.push_back({.free = given, .impulse = impulse});
}

void ContactProblem::add_term(const ClusterTerm& term) {
    cluster_.contacts[rows_.back()].free += term.rate(free_of_rigid_[term.body]);
    cluster_.add_term(rows_.back(), term);
}

/// W = sum over the bodies of along' M^-1 along, and V_free likewise. A vertex that moves as one with the end of the
/// edge that it touches is no contact, nor are two that are held: without a mobility it keeps its impulse, zero.
void ContactProblem::assemble() {
    const auto body_of = [&](const Term& term) { return corners_[term.body].body; };
    std::vector<std::size_t>& end = end_of_body_;
    end.assign(bodies_.size() + 1, 0);
    for (const Term& term : terms_) ++end[body_of(term) + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    of_body_.resize(terms_.size());
    for (std::size_t k = 0; k < terms_.size(); ++k) of_body_[end[body_of(terms_[k])]++] = static_cast<Index>(k);
    cluster_.couplings.clear();
    for (const Term& term : terms_) {
        const Index b = body_of(term);
        cluster_.contacts[term.row].free += term.rate(bodies_[b].free + corners_[term.body].offset);
        const Vec2 by_N = bodies_[b].inverse_mass.cwiseProduct(term.along_N),
                   by_T = bodies_[b].inverse_mass.cwiseProduct(term.along_T);
        for (std::size_t k = b == 0 ? 0 : end[b - 1]; k < end[b]; ++k) {
            const Term& other = terms_[of_body_[k]];
            Eigen::Matrix2d W;  // one by one: Eigen's initialisation by commas is slow
            W(0, 0) = other.along_N.dot(by_N), W(0, 1) = other.along_N.dot(by_T);
            W(1, 0) = other.along_T.dot(by_N), W(1, 1) = other.along_T.dot(by_T);
            cluster_.couple(term.row, other.row, W);
        }
    }
    for (const Index row : rows_) {
        const ClusterContact& c = cluster_.contacts[row];
        if (c.first_coupling == c.last_coupling) cluster_.couple(row, row, Eigen::Matrix2d::Zero());
    }
    mobility_.assign(cluster_.contacts.size(), {});
    for (const Term& term : terms_) {
        Mobility& of_row = mobility_[term.row];
        of_row.inverse_mass = std::max(of_row.inverse_mass, bodies_[body_of(term)].inverse_mass.maxCoeff());
        of_row.along2 += term.along_N.squaredNorm();
    }
    for (const CurvedRow& curved : curved_) cluster_.contacts[curved.row].other = &curved.law;
    cluster_.find_own();
    for (ContactCoupling& c : cluster_.couplings) {
        if (c.of != c.on) continue;
        const Eigen::Matrix2d of_bodies = cluster_.own_of_bodies(c.of);
        for (int k = 0; k < 2; ++k)
            if (cluster_.own(c.of)(k, k) - of_bodies(k, k) <= held * mobility_[c.of].largest() &&
                of_bodies(k, k) <= ContactCluster::unmoved * of_bodies.trace())
                cluster_.hold(c, k);
    }
    cluster_.find_own();
    for (const Index row : rows_)
        for (int k = 0; k < 2; ++k)
            if (cluster_.own(row)(k, k) == 0) cluster_.contacts[row].impulse[k] = 0;
}

double ContactProblem::solve(double speed, double rounding, ClusterEffort effort) {
    for (std::size_t i = 0; i < cluster_.contacts.size(); ++i)
        speed = std::max(speed, cluster_.contacts[i].cohesive * cluster_.own(static_cast<Index>(i)).trace());
    const double residual = cluster_.solve(speed, rounding, effort);
    for (Body& body : bodies_) body.end = body.free;
    for (const Term& term : terms_) {
        Body& body = bodies_[corners_[term.body].body];
        body.end += body.inverse_mass.cwiseProduct(term.wrench(cluster_.contacts[term.row].impulse));
    }
    return residual;
}

double ContactProblem::residual(std::span<const Vec2> V) {
    double largest = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        cluster_.contacts[rows_[i]].velocity = V[i];
        largest = std::max(largest, cluster_.residual(rows_[i]));
    }
    return largest;
}

std::size_t ContactProblem::worst() const {
    const auto found = std::ranges::max_element(rows_, {}, [&](Index row) { return cluster_.residual(row); });
    return static_cast<std::size_t>(found - rows_.begin());
}

}  // namespace knap
