#include "interface/fan_lcp.hpp"

#include "lcp/solvers.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

std::optional<double> FanLcp::solve(const FanProblem& problem, const std::vector<LinkState>& states, double speed,
                                    FanMotion& motion) {
    const std::vector<FanLink>& links = problem.links;
    clusters_.start(problem);
    for (const FanLink& link : links)
        if (link.unbreakable) clusters_.join(link, Vec2::Zero(), 0);
    clusters_.find_velocities({}, {}, 0, true);
    rows_.clear();
    double mass = 0;  // [kg] largest of the links
    for (std::size_t i = 0; i < links.size(); ++i)
        if (!links[i].unbreakable) mass = std::max(mass, add_rows(links[i], states[i].law));

    const int n = static_cast<int>(rows_.size());
    const double scale = speed * std::sqrt(mass);  // [m/s sqrt kg]
    M_.resize(n * n);
    for (std::vector<double>* list : {&q_, &z_, &w_}) list->resize(n);
    Eigen::Map<Eigen::MatrixXd> M(M_.data(), n, n);
    Eigen::Map<Eigen::VectorXd> q(q_.data(), n), z(z_.data(), n), w(w_.data(), n);
    for (int i = 0; i < n; ++i) {
        const Row& row = rows_[i];
        for (int j = 0; j < n; ++j) M(i, j) = coefficient(row, rows_[j]);
        if (row.kind == Row::Kind::slack) {
            q[i] = row.cohesive / (scale * row.unit);
            continue;
        }
        double velocity = row.direction.dot(clusters_.across(*row.link));
        for (const FanLink& link : links)
            velocity += row.direction.dot(clusters_.response(*row.link, link, -link.cohesive * link.normal));
        q[i] = row.unit * (velocity - (row.kind == Row::Kind::backward ? -row.rate : row.rate)) / scale;
    }
    if (!solve_lcp_by_lemke(M, q, z)) return std::nullopt;
    w.noalias() = M * z;
    w += q;

    for (std::size_t i = 0; i < links.size(); ++i) motion.impulse[i] = -links[i].cohesive * links[i].normal;
    for (int i = 0; i < n; ++i)
        if (const Row& row = rows_[i]; row.kind != Row::Kind::slack)
            motion.impulse[row.link - links.data()] += scale * row.unit * z[i] * row.direction;
    for (std::size_t i = 0; i < links.size(); ++i) clusters_.apply(links[i], motion.impulse[i]);
    for (std::size_t b = 0; b < problem.bodies.size(); ++b)
        motion.velocity[b] = clusters_.velocity_of(static_cast<Index>(b));
    return n > 0 ? w.cwiseMin(z).cwiseAbs().maxCoeff() : 0.0;
}

double FanLcp::add_rows(const FanLink& link, const InterfaceLaw& law) {
    const double mobility = clusters_.inverse_mass(link).sum(), unit = mobility > 0 ? std::sqrt(2 / mobility) : 1;
    const auto add = [&](Row::Kind kind, const Vec2& direction, const Staircase::Kink& kink) {
        rows_.push_back({kind, &link, direction, kink.rate, kink.cohesive, kink.friction, unit});
    };
    if (law.contact.may_touch) add(Row::Kind::contact, link.normal, {.rate = law.contact.rate});
    for (const Staircase::Kink& kink : law.staircase(law.contact.may_touch).kinks()) {
        add(Row::Kind::forward, link.tangent(), kink);
        add(Row::Kind::backward, -link.tangent(), kink);
        add(Row::Kind::slack, Vec2::Zero(), kink);
    }
    return unit * unit;
}

double FanLcp::coefficient(const Row& row, const Row& column) const {
    using enum Row::Kind;
    const bool of_same_sign = row.link == column.link && row.rate == column.rate && column.kind != contact;
    if (row.kind == slack) {
        if (column.kind == slack || row.link != column.link) return 0;
        if (column.kind == contact) return row.friction;
        return of_same_sign ? -1 : 0;
    }
    if (column.kind == slack) return of_same_sign && row.kind != contact ? 1 : 0;
    return row.unit * column.unit * row.direction.dot(clusters_.response(*row.link, *column.link, column.direction));
}

}  // namespace knap
