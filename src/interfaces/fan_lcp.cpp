#include "interfaces/fan_lcp.hpp"

#include "lcp/lemke.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// Bodies that unbreakable links join move as one; the ground is the last cluster.
struct Clusters {
    std::vector<Index> of_body;
    std::vector<Vec2> inverse_mass, free_velocity;

    explicit Clusters(const FanProblem& problem) {
        const Index n = static_cast<Index>(problem.bodies.size());
        for (Index b = 0; b <= n; ++b) of_body.push_back(b);
        for (const FanLink& link : problem.links)
            if (link.unbreakable) {
                const Index a = at(link.before), b = at(link.after);
                std::replace(of_body.begin(), of_body.end(), std::min(a, b), std::max(a, b));
            }
        std::vector<Vec2> mass(n + 1, Vec2::Zero());
        inverse_mass.assign(n + 1, Vec2::Zero());
        free_velocity.assign(n + 1, Vec2::Zero());
        for (int k = 0; k < 2; ++k) {
            for (Index b = 0; b < n; ++b) {
                const FanBody& body = problem.bodies[b];
                if (body.inverse_mass[k] == 0) continue;
                mass[of_body[b]][k] += 1 / body.inverse_mass[k];
                free_velocity[of_body[b]][k] += body.free_velocity[k] / body.inverse_mass[k];
            }
            for (Index c = 0; c < n; ++c) {
                if (mass[c][k] == 0) continue;
                inverse_mass[c][k] = 1 / mass[c][k];
                free_velocity[c][k] *= inverse_mass[c][k];
            }
            for (Index b = 0; b < n; ++b)  // what is prescribed rules its cluster, and so does the ground
                if (problem.bodies[b].inverse_mass[k] == 0) {
                    inverse_mass[of_body[b]][k] = 0;
                    free_velocity[of_body[b]][k] = problem.bodies[b].free_velocity[k];
                }
            inverse_mass[of_body[n]][k] = free_velocity[of_body[n]][k] = 0;
        }
    }

    Index at(Index body) const { return body < 0 ? of_body.back() : of_body[body]; }
};

/// One unknown impulse of the problem: its direction at its link, and how its own row reads.
struct Row {
    enum class Kind { contact, forward, backward, slack } kind;
    Index link;
    double velocity;            // b of a contact, k of a sign
    double weight, of_contact;  // w0, w1 of the sign
};

class FanLcp {
public:
    FanLcp(const FanProblem& problem, const std::vector<LinkLaw>& laws, double speed)
        : problem_(problem), clusters_(problem), speed_(speed), unit_(problem.links.size(), 0.0) {
        for (Index i = 0; i < static_cast<Index>(problem.links.size()); ++i) {
            const FanLink& link = problem.links[i];
            if (link.unbreakable) continue;
            const Vec2 w = clusters_.inverse_mass[clusters_.at(link.after)] + clusters_.inverse_mass[clusters_.at(link.before)];
            unit_[i] = w.sum() > 0 ? std::sqrt(2 / w.sum()) : 1;
            mass_ = std::max(mass_, unit_[i] * unit_[i]);
            if (laws[i].may_touch()) rows_.push_back({Row::Kind::contact, i, laws[i].bound(), 0, 0});
            for (const LinkLaw::Kink& kink : laws[i].kinks(laws[i].may_touch())) {
                rows_.push_back({Row::Kind::forward, i, kink.velocity, kink.cohesive, kink.contact});
                rows_.push_back({Row::Kind::backward, i, kink.velocity, kink.cohesive, kink.contact});
                rows_.push_back({Row::Kind::slack, i, kink.velocity, kink.cohesive, kink.contact});
            }
        }
        speed_ *= std::sqrt(mass_);
    }

    FanLcpSolution solve() const {
        const int n = static_cast<int>(rows_.size());
        Eigen::MatrixXd M(n, n);
        Eigen::VectorXd q(n);
        for (int i = 0; i < n; ++i) {
            q[i] = constant(i);
            for (int j = 0; j < n; ++j) M(i, j) = coefficient(i, j);
        }
        FanLcpSolution found;
        const Eigen::VectorXd z = solve_lcp_by_lemke(M, q);
        found.solved = z.size() == n;
        if (!found.solved) return found;
        if (n > 0) found.residual = (M * z + q).cwiseMin(z).cwiseAbs().maxCoeff();
        found.impulse.assign(problem_.links.size(), Vec2::Zero());
        for (std::size_t i = 0; i < problem_.links.size(); ++i) found.impulse[i] = -problem_.links[i].cohesive * problem_.links[i].normal;
        for (int i = 0; i < n; ++i)
            if (rows_[i].kind != Row::Kind::slack) found.impulse[rows_[i].link] += speed_ * unit_[rows_[i].link] * z[i] * direction(i);
        std::vector<Vec2> velocity = clusters_.free_velocity;
        for (std::size_t i = 0; i < problem_.links.size(); ++i) {
            const Index after = clusters_.at(problem_.links[i].after), before = clusters_.at(problem_.links[i].before);
            velocity[after] += clusters_.inverse_mass[after].cwiseProduct(found.impulse[i]);
            velocity[before] -= clusters_.inverse_mass[before].cwiseProduct(found.impulse[i]);
        }
        for (std::size_t b = 0; b < problem_.bodies.size(); ++b) found.velocity.push_back(velocity[clusters_.of_body[b]]);
        return found;
    }

private:
    const FanLink& link(int row) const { return problem_.links[rows_[row].link]; }

    Vec2 direction(int row) const {
        const Vec2 normal = link(row).normal;
        if (rows_[row].kind == Row::Kind::contact) return normal;
        return rows_[row].kind == Row::Kind::forward ? turned_left(normal) : Vec2(-turned_left(normal));
    }

    /// a . V of the link of row i for an impulse at link j
    double response(Index i, const Vec2& a, Index j, const Vec2& impulse) const {
        const Index after = clusters_.at(problem_.links[i].after), before = clusters_.at(problem_.links[i].before);
        Vec2 velocity = Vec2::Zero();
        const auto add = [&](Index cluster, double sign) {
            if (cluster == after) velocity += sign * clusters_.inverse_mass[cluster].cwiseProduct(impulse);
            if (cluster == before) velocity -= sign * clusters_.inverse_mass[cluster].cwiseProduct(impulse);
        };
        add(clusters_.at(problem_.links[j].after), 1);
        add(clusters_.at(problem_.links[j].before), -1);
        return a.dot(velocity);
    }

    double coefficient(int i, int j) const {
        const Row &row = rows_[i], &column = rows_[j];
        const bool same_sign = row.link == column.link && row.velocity == column.velocity && column.kind != Row::Kind::contact;
        if (row.kind == Row::Kind::slack) {
            if (column.kind == Row::Kind::slack || row.link != column.link) return 0;
            if (column.kind == Row::Kind::contact) return row.of_contact;
            return same_sign ? -1 : 0;
        }
        if (column.kind == Row::Kind::slack) return same_sign && row.kind != Row::Kind::contact ? 1 : 0;
        return unit_[row.link] * unit_[column.link] * response(row.link, direction(i), column.link, direction(j));
    }

    double constant(int i) const {
        const Row& row = rows_[i];
        const double unit = unit_[row.link];
        if (row.kind == Row::Kind::slack) return row.weight / (speed_ * unit);
        const Vec2 a = direction(i);
        double velocity = a.dot(clusters_.free_velocity[clusters_.at(link(i).after)] - clusters_.free_velocity[clusters_.at(link(i).before)]);
        for (Index j = 0; j < static_cast<Index>(problem_.links.size()); ++j)
            velocity += response(row.link, a, j, -problem_.links[j].cohesive * problem_.links[j].normal);
        return unit * (velocity - (row.kind == Row::Kind::backward ? -1 : 1) * row.velocity) / speed_;
    }

    const FanProblem& problem_;
    Clusters clusters_;
    double mass_ = 0;           // [kg] largest of the links
    double speed_;              // [m/s sqrt kg] with it
    std::vector<double> unit_;  // [sqrt kg] per link: scales impulses up and velocities down, so that W has a unit diagonal
    std::vector<Row> rows_;
};

}  // namespace

FanLcpSolution solve_fan_lcp(const FanProblem& problem, const std::vector<LinkLaw>& laws, double speed) {
    return FanLcp(problem, laws, speed).solve();
}

}  // namespace knap
