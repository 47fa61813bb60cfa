// The nonsmooth problem of contacts that share nodes: every law holds, no contact does positive work, whatever the
// geometry, the redundancy and the friction.
#include "nonsmooth/contact_cluster.hpp"
#include "base/random.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace contact_cluster_test {

using namespace knap;

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

}  // namespace contact_cluster_test
