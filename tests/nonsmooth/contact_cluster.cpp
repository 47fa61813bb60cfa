// The nonsmooth problem of contacts that share nodes: every law holds, no contact does positive work, whatever the
// geometry, the redundancy and the friction.
#include "nonsmooth/contact_cluster.hpp"
#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace contact_cluster_test {

using namespace knap;
using knap::tests::relative;

namespace {

/// Contacts between random nodes with random directions: W = J M^-1 J'. With rigid bodies every second contact has one
/// of them on its side, every fifth two of them alone.
struct RandomCluster {
    RandomCluster(std::uint64_t seed, int n_contacts, int n_nodes, double friction, double restitution, bool redundant,
                  int n_rigid = 0)
        : random(seed, "contacts") {
        Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2 * n_contacts, 2 * n_nodes);
        Eigen::VectorXd inverse_mass(2 * n_nodes), before(2 * n_nodes), free(2 * n_nodes);
        for (int b = 0; b < n_nodes; ++b) {
            inverse_mass.segment<2>(2 * b).setConstant(std::exp(2 * uniform()));
            for (int k = 0; k < 2; ++k) {
                before[2 * b + k] = uniform();
                free[2 * b + k] = before[2 * b + k] + 0.3 * uniform();
            }
        }
        for (int i = 0; i < n_contacts; ++i) {
            if (redundant && i % 2 == 1) {  // the twin of the contact before
                J.middleRows<2>(2 * i) = J.middleRows<2>(2 * i - 2);
                continue;
            }
            if (n_rigid > 0 && i % 5 == 4) continue;
            const double angle = 3 * uniform(), s = 0.5 + 0.5 * uniform();
            const Vec2 n(std::cos(angle), std::sin(angle)), t = turned_left(n);
            const int v = node(n_nodes), a = (v + 1 + node(n_nodes - 1)) % n_nodes, b = (a + 1) % n_nodes;
            for (const auto& [at, weight] : {std::pair(v, 1.), {a, s - 1}, {b, -s}}) {
                J.block<1, 2>(2 * i, 2 * at) += weight * n.transpose();
                J.block<1, 2>(2 * i + 1, 2 * at) += weight * t.transpose();
            }
        }
        W = J * inverse_mass.asDiagonal() * J.transpose();
        cluster.contacts.resize(n_contacts);
        for (int i = 0; i < n_contacts; ++i)
            for (int j = 0; j < n_contacts; ++j)
                if (i == j || !W.block<2, 2>(2 * j, 2 * i).isZero(0)) cluster.couple(i, j, W.block<2, 2>(2 * j, 2 * i));
        for (int b = 0; b < n_rigid; ++b) cluster.bodies.push_back({Vec3(1, 1, 3) * std::exp(2 * uniform())});
        for (int i = 0; i < n_contacts && n_rigid > 0; ++i) {
            const double angle = 3 * uniform(), arm = uniform();
            const Vec3 along_N(std::cos(angle), std::sin(angle), arm), along_T(-std::sin(angle), std::cos(angle), 0.3);
            if (i % 2 == 0 || i % 5 == 4) cluster.add_term(i, {node(n_rigid), along_N, along_T});
            if (i % 5 == 4 && n_rigid > 1)
                cluster.add_term(i, {(cluster.terms.back().body + 1) % n_rigid, -along_N, along_T});
        }
        L.setZero(2 * n_contacts, 3 * n_rigid);
        for (int i = 0; i < n_contacts; ++i)
            for (Index k = cluster.contacts[i].first_term; k < cluster.contacts[i].last_term; ++k) {
                const ClusterTerm& term = cluster.terms[k];
                L.block<1, 3>(2 * i, 3 * term.body) = term.along_N.transpose();
                L.block<1, 3>(2 * i + 1, 3 * term.body) = term.along_T.transpose();
            }
        for (int b = 0; b < n_rigid; ++b)
            W += L.middleCols<3>(3 * b) * cluster.bodies[b].inverse_mass.asDiagonal() *
                 L.middleCols<3>(3 * b).transpose();
        for (int i = 0; i < n_contacts; ++i) {
            const Vec2 V = (J * before).segment<2>(2 * i);
            velocity_before.push_back(V);
            cluster.contacts[i].free = (J * free).segment<2>(2 * i);
            cluster.contacts[i].law = contact_law(0, V, friction, restitution, 1e-3, 1e-3, 1e-12);
        }
    }
    double uniform() { return random.uniform(-1, 1); }
    int node(int n) { return std::min(n - 1, static_cast<int>(n * random.uniform())); }

    Random random;
    ContactCluster cluster;
    std::vector<Vec2> velocity_before;
    Eigen::MatrixXd W, L;  // with rigid bodies
};

/// The norm of the opening: K is the half ellipse P_N = -C sqrt(1 - (P_T/(gamma C))^2) and the strip of contact behind it.
struct HalfEllipse : RowLaw {
    double C, gamma;
    HalfEllipse(double cohesive, double shear) : C(cohesive), gamma(shear) {}
    Projection project(const Vec2& Q, double) const override {
        const Vec2 axis(C, gamma * C);
        if (Q.x() >= 0) {
            const bool inside = std::abs(Q.y()) <= axis.y();
            return {{Q.x(), std::clamp(Q.y(), -axis.y(), axis.y())}, Vec2(1, inside).asDiagonal()};
        }
        if (Q.cwiseQuotient(axis).squaredNorm() <= 1) return {Q, Eigen::Matrix2d::Identity()};
        // P = a^2 Q/(a^2 + s) with sum (a Q/(a^2 + s))^2 = 1, which falls and is convex
        const Vec2 a2 = axis.cwiseAbs2();
        double s = 0;
        Vec2 part, slope;
        for (int i = 0; i < 100; ++i) {
            const Vec2 sum = a2 + Vec2(s, s);
            part = axis.cwiseProduct(Q).cwiseQuotient(sum);
            slope = -2 * part.cwiseAbs2().cwiseQuotient(sum);
            const double change = (1 - part.squaredNorm()) / slope.sum();
            s += change;
            if (std::abs(change) <= 1e-15 * s) break;
        }
        const Vec2 sum = a2 + Vec2(s, s), ratio = a2.cwiseQuotient(sum),
                   of_s = -ratio.cwiseProduct(Q).cwiseQuotient(sum);
        const Vec2 s_of_Q = -2 * part.cwiseProduct(axis).cwiseQuotient(sum) / slope.sum();
        return {ratio.cwiseProduct(Q), Eigen::Matrix2d(ratio.asDiagonal()) + of_s * s_of_Q.transpose()};
    }
};

/// Contact with friction below f(p) = mu p/(1 + p/p_0), concave.
struct ConcaveFriction : RowLaw {
    double mu, p_0;
    ConcaveFriction(double friction, double pressure) : mu(friction), p_0(pressure) {}
    double most(double p) const { return mu * p / (1 + p / p_0); }
    Projection project(const Vec2& Q, double) const override {
        const double p = std::max(Q.x(), 0.0), bound = most(p), one = 1 + p / p_0;
        Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();
        slope(0, 0) = Q.x() > 0;
        if (std::abs(Q.y()) <= bound) slope(1, 1) = 1;
        else slope(1, 0) = slope(0, 0) * std::copysign(mu / (one * one), Q.y());
        return {{p, std::clamp(Q.y(), -bound, bound)}, slope};
    }
};

/// How far V misses minus the normal cone of the half ellipse at P: V . (Z - P) >= 0 for all Z of K.
double missed(const HalfEllipse& law, const Vec2& V, const Vec2& P) {
    double most = std::max(0.0, -V.x());  // Z far behind
    const auto look = [&](const Vec2& Z) { most = std::max(most, -V.dot(Z - P)); };
    for (int i = 0; i <= 2000; ++i) {
        const double angle = 3.14159265358979 * (0.5 + i / 2000.);
        look({law.C * std::cos(angle), law.gamma * law.C * std::sin(angle)});
    }
    for (const double side : {-1, 1})
        if (P.x() > 0) look({P.x(), side * law.gamma * law.C});
    return most;
}

}  // namespace

TEST_CASE("a lawful motion is found for random clusters of contacts and no contact does positive work") {
    for (const bool redundant : {false, true})
        for (const double friction : {0., 0.3, 1.})
            for (const double restitution : {0., 0.7, 1.}) {
                int unsolved = 0;
                for (int seed = 1; seed <= 200; ++seed) {
                    const int n = 2 + seed % 14;
                    RandomCluster random(seed, n, 3 + seed % 11, friction, restitution, redundant);
                    ContactCluster& cluster = random.cluster;
                    const double residual = cluster.solve(1, 1e-15);
                    if (residual > 1e-11) {
                        ++unsolved;
                        continue;
                    }
                    for (int i = 0; i < n; ++i) {
                        const ClusterContact& c = cluster.contacts[i];
                        const Vec2 mean = 0.5 * (c.velocity + random.velocity_before[i]);
                        const double scale = 1e-10 * (1 + c.impulse.norm());
                        CHECK(c.impulse.x() >= 0);
                        CHECK(c.velocity.x() >= c.law.contact.rate - 1e-10);
                        CHECK(c.impulse.x() * (c.velocity.x() - c.law.contact.rate) <= scale);
                        CHECK(std::abs(c.impulse.y()) <= friction * c.impulse.x() + scale);
                        CHECK(c.impulse.x() * mean.x() <= scale);
                        CHECK(c.impulse.y() * mean.y() <= scale);
                    }
                }
                CAPTURE(redundant);
                CAPTURE(friction);
                CAPTURE(restitution);
                CHECK(unsolved <= (friction == 0 ? 0 : 2));
            }
}

TEST_CASE("contacts that rigid bodies couple move as their whole Delassus operator says") {
    // few of them by a dense matrix, many by blocks with the velocities of the bodies as unknowns
    for (const int n : {8, 60})
        for (const int n_rigid : {1, 3})
            for (const double friction : {0., 0.3})
                for (int seed = 1; seed <= 20; ++seed) {
                    CAPTURE(n);
                    CAPTURE(n_rigid);
                    CAPTURE(friction);
                    CAPTURE(seed);
                    RandomCluster random(seed, n, n / 2 + 3, friction, 0, false, n_rigid);
                    ContactCluster& cluster = random.cluster;
                    CHECK(cluster.solve(1, 1e-15) <= 1e-11);
                    Eigen::VectorXd P(2 * n);
                    for (int i = 0; i < n; ++i) P.segment<2>(2 * i) = cluster.contacts[i].impulse;
                    const Eigen::VectorXd V = random.W * P, wrench = random.L.transpose() * P;
                    const double scale = 1 + V.cwiseAbs().maxCoeff();
                    for (int i = 0; i < n; ++i) {
                        const ClusterContact& c = cluster.contacts[i];
                        CHECK((c.velocity - c.free - V.segment<2>(2 * i)).norm() <= 1e-12 * scale);
                        CHECK(c.impulse.x() >= 0);
                        CHECK(c.velocity.x() >= c.law.contact.rate - 1e-10);
                        CHECK(c.impulse.x() * (c.velocity.x() - c.law.contact.rate) <= 1e-10 * (1 + P.norm()));
                        CHECK(std::abs(c.impulse.y()) <= friction * c.impulse.x() + 1e-10 * (1 + P.norm()));
                    }
                    for (int b = 0; b < n_rigid; ++b) {
                        const ClusterBody& body = cluster.bodies[b];
                        CHECK((body.change - body.inverse_mass.cwiseProduct(wrench.segment<3>(3 * b))).norm() <=
                              1e-12 * scale);
                    }
                }
}

TEST_CASE("rows with a half ellipse obey it in clusters with other contacts and with rigid bodies") {
    for (const bool redundant : {false, true})
        for (const int n : {3, 12, 40})
            for (int seed = 1; seed <= 20; ++seed) {
                CAPTURE(redundant);
                CAPTURE(n);
                CAPTURE(seed);
                RandomCluster random(seed, n, n / 2 + 3, 0, 0, redundant, redundant ? 0 : 2);
                ContactCluster& cluster = random.cluster;
                const HalfEllipse strong(0.3, 2), weak(0.05, 0.5);
                for (int i = 0; i < n; i += 2) cluster.contacts[i].other = i % 4 == 0 ? &strong : &weak;
                CHECK(cluster.solve(1, 1e-15) <= 1e-11);
                Eigen::VectorXd P(2 * n);
                for (int i = 0; i < n; ++i) P.segment<2>(2 * i) = cluster.contacts[i].impulse;
                const Eigen::VectorXd V = random.W * P;
                for (int i = 0; i < n; ++i) {
                    const ClusterContact& c = cluster.contacts[i];
                    CHECK((c.velocity - c.free - V.segment<2>(2 * i)).norm() <= 1e-12);
                    if (c.other) {
                        const auto& law = static_cast<const HalfEllipse&>(*c.other);
                        const double from_edge = c.impulse.x() < 0
                                                     ? c.impulse.cwiseQuotient(Vec2(law.C, law.gamma * law.C)).norm()
                                                     : std::abs(c.impulse.y()) / (law.gamma * law.C);
                        CHECK(from_edge <= 1 + 1e-10);
                        CHECK(missed(law, c.velocity, c.impulse) <= 1e-10);
                    } else {
                        CHECK(c.impulse.x() >= 0);
                        CHECK(c.velocity.x() >= c.law.contact.rate - 1e-10);
                        CHECK(c.impulse.x() * (c.velocity.x() - c.law.contact.rate) <= 1e-10);
                    }
                }
            }
}

TEST_CASE("rows with a friction that is concave in the pressure slide at its bound or stick below it") {
    int unsolved = 0;
    for (const int n : {3, 12, 40})
        for (int seed = 1; seed <= 20; ++seed) {
            CAPTURE(n);
            CAPTURE(seed);
            RandomCluster random(seed, n, n / 2 + 3, 0.3, 0, false, 2);
            ContactCluster& cluster = random.cluster;
            const ConcaveFriction law(0.8, 0.1);
            for (int i = 0; i < n; i += 2) cluster.contacts[i].other = &law;
            if (cluster.solve(1, 1e-15) > 1e-11 && ++unsolved > 0) continue;
            Eigen::VectorXd P(2 * n);
            for (int i = 0; i < n; ++i) P.segment<2>(2 * i) = cluster.contacts[i].impulse;
            const Eigen::VectorXd V = random.W * P;
            for (int i = 0; i < n; ++i) {
                const ClusterContact& c = cluster.contacts[i];
                const double bound = law.most(c.impulse.x());
                CHECK((c.velocity - c.free - V.segment<2>(2 * i)).norm() <= 1e-12 * (1 + P.norm()));
                if (!c.other) continue;
                CHECK(c.impulse.x() >= -1e-15);
                CHECK(c.velocity.x() >= -1e-10);
                CHECK(c.impulse.x() * c.velocity.x() <= 1e-10);
                CHECK(std::abs(c.impulse.y()) <= bound + 1e-12);
                // P_T V_T = -f(p) |V_T|
                CHECK(std::abs(c.impulse.y() * c.velocity.y() + bound * std::abs(c.velocity.y())) <= 1e-10);
            }
        }
    CHECK(unsolved <= 1);
}

TEST_CASE("a body on a floor with concave friction brakes as its bound says") {
    // m (V - V0) = (N, -f(N)): 2 kg at 3 m/s, whose weight presses with N = 0.4 N s in the step
    const double m = 2, N = 0.4, v = 3;
    const ConcaveFriction law(0.6, 0.2);
    ContactCluster cluster;
    cluster.contacts.resize(1);
    cluster.couple(0, 0, Eigen::Matrix2d::Identity() / m);
    cluster.contacts[0].free = Vec2(-N / m, v);
    cluster.contacts[0].other = &law;
    CHECK(cluster.solve(v, 0) <= 1e-13 * v);
    CHECK(cluster.contacts[0].impulse.x() == relative(N, 1e-14));
    CHECK(cluster.contacts[0].velocity.y() == relative(v - 0.6 * N / (1 + N / 0.2) / m, 1e-14));
}

TEST_CASE("sweeps over stacked rigid bodies find the motion of the whole method") {
    for (int seed = 1; seed <= 20; ++seed)
        for (const int n : {3, 10, 40}) {  // blocks between two walls, two contacts below and one at each side
            const double friction = seed % 2 == 0 ? 0 : 0.4;
            Random random(seed, "stack");
            ContactCluster cluster;
            std::vector<Vec3> before, free;
            for (int b = 0; b < n; ++b) {
                const double mass = std::exp(random.uniform(-2, 2));
                cluster.bodies.push_back({{1 / mass, 1 / mass, 6 / mass}});
                before.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
                free.push_back(before.back() + Vec3(0, -0.2, 0));
            }
            std::vector<Vec2> V_before;
            const auto add = [&](int one, int other, const Vec2& normal, const Vec2& arm, const Vec2& other_arm) {
                const Vec2 t = turned_left(normal);
                const auto i = static_cast<Index>(cluster.contacts.size());
                Vec2 V = Vec2::Zero(), V_free = V;
                cluster.contacts.emplace_back();
                for (const auto& [body, sign, at] : {std::tuple(one, 1., arm), std::tuple(other, -1., other_arm)}) {
                    if (body < 0) continue;
                    const Vec3 N = sign * Vec3(normal.x(), normal.y(), cross(at, normal)),
                               T = sign * Vec3(t.x(), t.y(), cross(at, t));
                    cluster.add_term(i, {body, N, T});
                    V += Vec2(N.dot(before[body]), T.dot(before[body]));
                    V_free += Vec2(N.dot(free[body]), T.dot(free[body]));
                }
                cluster.couple(i, i, Eigen::Matrix2d::Zero());
                cluster.contacts[i].free = V_free;
                cluster.contacts[i].law = contact_law(0, V, friction, 0, 1e-3, infinity, 1e-12);
                V_before.push_back(V);
            };
            for (int b = 0; b < n; ++b) {
                for (const double x : {-0.5, 0.5}) add(b, b - 1, {0, 1}, {x, -0.5}, {x, 0.5});
                add(b, -1, {1, 0}, {-0.5, 0.1}, {}), add(b, -1, {-1, 0}, {0.5, -0.1}, {});
            }
            ContactCluster whole = cluster;
            const double residual = cluster.solve(1, 1e-15, ClusterEffort::sweeps);
            CAPTURE(n);
            CAPTURE(seed);
            CHECK(whole.solve(1, 1e-15) <= 1e-11);
            CHECK(residual <= (4 * n <= 30 ? 1e-8 : 1e-3));  // where the active set cycles sweeps alone go on
            double positive = 0, losses = 0;
            for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
                const ClusterContact& c = cluster.contacts[i];
                CHECK(c.impulse.x() >= 0);
                CHECK(std::abs(c.impulse.y()) <= (friction + 1e-12) * c.impulse.x());
                if (friction == 0)  // with friction there may be several solutions
                    CHECK(std::abs(c.velocity.x() - whole.contacts[i].velocity.x()) <= 100 * residual + 1e-6);
                for (int k = 0; k < 2; ++k) {
                    const double work = 0.5 * c.impulse[k] * (c.velocity[k] + V_before[i][k]);
                    positive += std::max(0., work), losses -= std::min(0., work);
                }
            }
            CHECK(positive <= 1e-3 * losses);
        }
}

}  // namespace contact_cluster_test
