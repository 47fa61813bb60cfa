#pragma once
// Complementarity problems of implicit cohesive steps, of any size: the LCP (22)-(24) of the method (law at k+1, forces at k+theta) on a
// structured mesh with moved vertices, every interior edge an interface (redundant: more impulses than velocities) or one straight line.
// Units: strength, critical opening and mean area of a point are 1, velocities are openings per step. With P the impulses,
//     V = V_free + W P,   W = h^2 theta H (M + h^2 theta^2 K)^-1 H',   P_N = p_N - theta S beta+ - (1 - theta) S beta,   P_T = p_T + r_T
//     S A     beta - beta+                                           [the layout of lcp/spurious_breaking.hpp]
//     S beta+ A + beta+ - 1 + (u_N + V_N) + gamma chi
//     p_N     V_N + e' V_N(begin)
//     p_T+-   +-V_T + zeta                                           zeta      mu p_N - p_T+ - p_T-
//     r_T+-   +-(u_T + V_T) + chi                                    chi       gamma S beta_theta - r_T+ - r_T-
#include "base/random.hpp"
#include "lcp/problem.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace knap::tests {

struct CohesiveScene {
    int n_x = 2, n_y = 2;    // cells of two triangles
    bool every_edge = true;  // else one line of interfaces at half height
    double step = 2;         // in units of the smallest height of a triangle over the wave speed
    double theta = 1, restitution = 0, gamma = 1, friction = 0.5;
    double stiffness = 100;  // E: the cohesive length is half as many critical openings, a triangle two wide
    double stretch = 1.2;    // speed of the ends, in units of the one that reaches the strength as a plane wave
    double shear = 0.3;      // the same along the ends
    double notch = 0.4;      // part of the length that is broken at half height from the start
    double noise =
        0.2;  // random speeds of the vertices at the start, in the same units: without, much is at rest and ties
    int seed = 1;
};

class CohesiveBody {
public:
    explicit CohesiveBody(const CohesiveScene& scene) : scene_(scene) {
        make_mesh();
        make_points();
        make_operators();
        make_state();
    }

    int n_points() const { return static_cast<int>(points_.size()); }
    int n_contacts() const { return static_cast<int>(contacts().size()); }

    LcpProblem problem() const {
        const int m = n_points();
        const std::vector<int> touching = contacts();
        const Rows rows(m, static_cast<int>(touching.size()));
        const Eigen::VectorXd V = rates();
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd q = Eigen::VectorXd::Zero(rows.size());
        // columns of an impulse in direction d (0 normal, 1 tangent) of point j
        const auto impulses = [&](int j, int d) {
            std::vector<std::pair<int, double>> columns;
            const int k = place(touching, j);
            if (d == 0) columns.push_back({rows.beta(j), -scene_.theta});
            if (d == 0 && k >= 0) columns.push_back({rows.normal(k), 1.0});
            if (d == 1 && k >= 0) columns.insert(columns.end(), {{rows.slip(k), 1.0}, {rows.slip(k) + 1, -1.0}});
            if (d == 1) columns.insert(columns.end(), {{rows.tangent(j), 1.0}, {rows.tangent(j) + 1, -1.0}});
            return columns;
        };
        for (int i = 0; i < m; ++i) {
            const int k = place(touching, i);
            for (int d = 0; d < 2; ++d) {
                std::vector<std::pair<int, double>>
                    targets;  // rows that hold the rate of this point and direction, with their sign
                if (d == 0) targets.push_back({rows.beta(i), 1.0});
                if (d == 0 && k >= 0) targets.push_back({rows.normal(k), 1.0});
                if (d == 1 && k >= 0) targets.insert(targets.end(), {{rows.slip(k), 1.0}, {rows.slip(k) + 1, -1.0}});
                if (d == 1) targets.insert(targets.end(), {{rows.tangent(i), 1.0}, {rows.tangent(i) + 1, -1.0}});
                for (LcpMatrix::InnerIterator entry(W_, 2 * i + d); entry; ++entry)
                    for (const auto& [column, c] :
                         impulses(static_cast<int>(entry.col()) / 2, static_cast<int>(entry.col()) % 2))
                        for (const auto& [row, sign] : targets)
                            entries.emplace_back(row, column, sign * entry.value() * c);
                for (const auto& [row, sign] : targets) q[row] += sign * V[2 * i + d];
            }
            const double S = points_[i].area;
            entries.emplace_back(i, rows.beta(i), -1 / S);
            entries.emplace_back(rows.beta(i), i, 1 / S);
            entries.emplace_back(rows.beta(i), rows.beta(i), 1 / S);
            entries.emplace_back(rows.beta(i), rows.chi(i), scene_.gamma);
            entries.emplace_back(rows.chi(i), rows.beta(i), scene_.gamma * scene_.theta);
            q[i] = beta_[i];
            q[rows.beta(i)] += opening(i, 0) - 1;
            q[rows.chi(i)] = (1 - scene_.theta) * scene_.gamma * S * beta_[i];
            for (int side = 0; side < 2; ++side) {
                q[rows.tangent(i) + side] += (side == 0 ? 1 : -1) * opening(i, 1);
                entries.emplace_back(rows.tangent(i) + side, rows.chi(i), 1.0);
                entries.emplace_back(rows.chi(i), rows.tangent(i) + side, -1.0);
                if (k < 0) continue;
                entries.emplace_back(rows.slip(k) + side, rows.zeta(k), 1.0);
                entries.emplace_back(rows.zeta(k), rows.slip(k) + side, -1.0);
            }
            if (k < 0) continue;
            entries.emplace_back(rows.zeta(k), rows.normal(k), scene_.friction);
            q[rows.normal(k)] += (scene_.theta * (1 + scene_.restitution) - 1) * (H_ * v_)[2 * i];
        }
        LcpProblem problem{LcpMatrix(rows.size(), rows.size()), q};
        problem.M.setFromTriplets(entries.begin(), entries.end());
        problem.M.prune(0.0, 0.0);
        return problem;
    }

    /// Ends the step with the solution z of problem().
    void advance(const Eigen::VectorXd& z) {
        const std::vector<int> touching = contacts();
        const Rows rows(n_points(), static_cast<int>(touching.size()));
        Eigen::VectorXd P = Eigen::VectorXd::Zero(2 * n_points());
        last_ = Eigen::MatrixXd::Zero(n_points(), 9);
        for (int i = 0; i < n_points(); ++i) {
            const int k = place(touching, i), r = rows.tangent(i);
            P[2 * i] = -scene_.theta * z[rows.beta(i)] - (1 - scene_.theta) * points_[i].area * beta_[i];
            P[2 * i + 1] = z[r] - z[r + 1];
            last_.row(i).head(5) << z[i], z[rows.beta(i)], z[r], z[r + 1], z[rows.chi(i)];
            beta_[i] = std::clamp(z[rows.beta(i)] / points_[i].area, 0.0, beta_[i]);
            if (k < 0) continue;
            P[2 * i] += z[rows.normal(k)];
            P[2 * i + 1] += z[rows.slip(k)] - z[rows.slip(k) + 1];
            last_.row(i).tail(4) << z[rows.normal(k)], z[rows.slip(k)], z[rows.slip(k) + 1], z[rows.zeta(k)];
        }
        const Eigen::VectorXd mean =
            free_motion() + scene_.theta * h_ * Eigen::VectorXd(M_hat_.solve(H_.transpose() * P));  // v at k + theta
        u_ += h_ * mean;
        v_ += (mean - v_) / scene_.theta;
    }

    /// The last solution, point by point, in the numbering of the problem that comes now.
    Eigen::VectorXd start() const {
        const std::vector<int> touching = contacts();
        const Rows rows(n_points(), static_cast<int>(touching.size()));
        Eigen::VectorXd z = Eigen::VectorXd::Zero(rows.size());
        for (int i = 0; i < static_cast<int>(last_.rows()); ++i) {
            const int k = place(touching, i), r = rows.tangent(i);
            z[i] = last_(i, 0), z[rows.beta(i)] = last_(i, 1), z[r] = last_(i, 2), z[r + 1] = last_(i, 3),
            z[rows.chi(i)] = last_(i, 4);
            if (k < 0) continue;
            z[rows.normal(k)] = last_(i, 5), z[rows.slip(k)] = last_(i, 6), z[rows.slip(k) + 1] = last_(i, 7),
            z[rows.zeta(k)] = last_(i, 8);
        }
        return z;
    }

    int n_broken() const { return static_cast<int>(std::count(beta_.begin(), beta_.end(), 0.0)); }
    int n_damaged() const {
        return static_cast<int>(std::count_if(beta_.begin(), beta_.end(), [](double b) { return b > 0 && b < 1; }));
    }

private:
    struct Point {
        int a, b;  // nodes; side b is the one the normal points to
        Eigen::Vector2d normal;
        double area;
    };

    /// First row of each group.
    struct Rows {
        Rows(int m, int c) : m(m), c(c) {}
        int beta(int i) const { return m + i; }
        int normal(int k) const { return 2 * m + k; }
        int slip(int k) const { return 2 * m + c + 2 * k; }
        int zeta(int k) const { return 2 * m + 3 * c + k; }
        int tangent(int i) const { return 2 * m + 4 * c + 2 * i; }
        int chi(int i) const { return 4 * m + 4 * c + i; }
        int size() const { return 5 * m + 4 * c; }
        int m, c;
    };

    void make_mesh() {
        Random random(scene_.seed, "cohesive mesh");
        const int nx = scene_.n_x, ny = scene_.n_y;
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) {
                Eigen::Vector2d x(2.0 * i, 2.0 * j);
                const bool fixed = i == 0 || j == 0 || i == nx || j == ny || 2 * j == ny;
                if (!fixed) x += Eigen::Vector2d(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4));
                vertices_.push_back(x);
            }
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) {
                const int a = j * (nx + 1) + i, b = a + 1, d = a + nx + 1, c = d + 1;
                if (random.uniform(0, 1) < 0.5) triangles_.insert(triangles_.end(), {{a, b, c}, {a, c, d}});
                else triangles_.insert(triangles_.end(), {{a, b, d}, {b, c, d}});
            }
    }

    /// Half of the mesh that a triangle belongs to where only the line is split.
    int side_of(std::size_t triangle) const {
        return static_cast<int>(triangle / (2 * scene_.n_x)) >= scene_.n_y / 2 ? 1 : 0;
    }

    void make_points() {
        std::map<std::pair<int, int>, int> nodes;  // (vertex, half or triangle)
        node_.resize(triangles_.size());
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (int k = 0; k < 3; ++k) {
                const int part = scene_.every_edge ? static_cast<int>(t) : side_of(t);
                node_[t][k] = nodes.try_emplace({triangles_[t][k], part}, static_cast<int>(nodes.size())).first->second;
            }
        n_nodes_ = static_cast<int>(nodes.size());
        std::map<std::pair<int, int>, std::pair<std::size_t, int>> open;  // edge by its vertices -> (triangle, side)
        std::map<std::pair<int, int>, std::size_t> by_nodes;  // points of two edges between the same nodes are one
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (int k = 0; k < 3; ++k) {
                const int p = triangles_[t][k], r = triangles_[t][(k + 1) % 3];
                const auto [other, is_new] = open.try_emplace({std::min(p, r), std::max(p, r)}, t, k);
                if (is_new || (!scene_.every_edge && side_of(t) == side_of(other->second.first))) continue;
                const auto [s, l] = other->second;
                const Eigen::Vector2d along = vertices_[r] - vertices_[p];
                const Eigen::Vector2d normal = Eigen::Vector2d(-along.y(), along.x()).normalized();  // into triangle t
                for (int end = 0; end < 2; ++end) {
                    const int a = node_[s][end == 0 ? (l + 1) % 3 : l], b = node_[t][end == 0 ? k : (k + 1) % 3];
                    const auto [found, fresh] = by_nodes.try_emplace({a, b}, points_.size());
                    if (fresh)
                        points_.push_back({a, b, normal, 0.5 * along.norm()}),
                            where_.push_back(vertices_[end == 0 ? p : r]);
                    else points_[found->second].area += 0.5 * along.norm();
                }
            }
    }

    void make_operators() {
        const double nu = 0.25, lambda = scene_.stiffness * nu / ((1 + nu) * (1 - 2 * nu)),
                     shear = scene_.stiffness / (2 * (1 + nu));
        const double speed = std::sqrt(lambda + 2 * shear);
        std::vector<Eigen::Triplet<double>> stiffness, mass;
        double min_height = 1e300;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            Eigen::Matrix3d corners;
            for (int k = 0; k < 3; ++k) corners.col(k) << 1, vertices_[triangles_[t][k]];
            const double area = 0.5 * corners.determinant();
            const Eigen::Matrix3d inverse = corners.inverse();
            for (int k = 0; k < 3; ++k) {
                const Eigen::Vector2d g = inverse.row(k).tail(2);
                min_height = std::min(min_height, 1 / g.norm());
                for (int l = 0; l < 3; ++l) {
                    const Eigen::Vector2d f = inverse.row(l).tail(2);
                    const Eigen::Matrix2d block = area * (lambda * g * f.transpose() + shear * f * g.transpose() +
                                                          shear * g.dot(f) * Eigen::Matrix2d::Identity());
                    for (int i = 0; i < 2; ++i)
                        for (int j = 0; j < 2; ++j)
                            stiffness.emplace_back(2 * node_[t][k] + i, 2 * node_[t][l] + j, block(i, j));
                }
                for (int i = 0; i < 2; ++i) mass.emplace_back(2 * node_[t][k] + i, 2 * node_[t][k] + i, area / 3);
            }
        }
        K_.resize(2 * n_nodes_, 2 * n_nodes_), M_.resize(2 * n_nodes_, 2 * n_nodes_);
        K_.setFromTriplets(stiffness.begin(), stiffness.end());
        M_.setFromTriplets(mass.begin(), mass.end());
        h_ = scene_.step * min_height / speed;
        M_hat_.compute(M_ + std::pow(h_ * scene_.theta, 2) * K_);
        std::vector<Eigen::Triplet<double>> jumps;
        for (int i = 0; i < n_points(); ++i) {
            const Eigen::Vector2d n = points_[i].normal, t(-n.y(), n.x());
            for (int d = 0; d < 2; ++d)
                for (int k = 0; k < 2; ++k) {
                    const double x = d == 0 ? n[k] : t[k];
                    jumps.emplace_back(2 * i + d, 2 * points_[i].a + k, -x);
                    jumps.emplace_back(2 * i + d, 2 * points_[i].b + k, x);
                }
        }
        H_.resize(2 * n_points(), 2 * n_nodes_);
        H_.setFromTriplets(jumps.begin(), jumps.end());
        const Eigen::SparseMatrix<double> transpose = H_.transpose();
        const Eigen::SparseMatrix<double> response = M_hat_.solve(transpose);
        W_ = h_ * h_ * scene_.theta * (H_ * response);
        W_ = LcpMatrix(0.5 * (Eigen::SparseMatrix<double>(W_) + Eigen::SparseMatrix<double>(W_.transpose())));
    }

    /// At rest with the two ends drawn apart and along each other: a wave comes in from both.
    void make_state() {
        u_ = Eigen::VectorXd::Zero(2 * n_nodes_), v_ = u_;
        beta_.assign(points_.size(), 1.0);
        const double height = 2.0 * scene_.n_y, length = 2.0 * scene_.n_x,
                     impedance = std::sqrt(1.2 * scene_.stiffness);
        Random random(scene_.seed, "cohesive state");
        std::vector<Eigen::Vector2d> noise(vertices_.size());
        for (Eigen::Vector2d& v : noise) v << random.uniform(-1, 1), random.uniform(-1, 1);
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (int k = 0; k < 3; ++k) {
                const Eigen::Vector2d x = vertices_[triangles_[t][k]];
                const double far = (2 * x.y() - height) / height;  // -1 ... 1
                const double growth = std::copysign(far * far, far) / impedance;
                v_.segment<2>(2 * node_[t][k]) << scene_.shear * growth, scene_.stretch * growth;
                v_.segment<2>(2 * node_[t][k]) += scene_.noise / impedance * noise[triangles_[t][k]];
            }
        for (int i = 0; i < n_points(); ++i)
            if (std::abs(2 * where_[i].y() - height) < 1e-9 && std::abs(points_[i].normal.x()) < 1e-9 &&
                where_[i].x() < scene_.notch * length)
                beta_[i] = 0;
    }

    Eigen::VectorXd free_motion() const { return M_hat_.solve(M_ * v_ - scene_.theta * h_ * (K_ * u_)); }

    /// Rates at k + theta without the impulses that are unknown.
    Eigen::VectorXd rates() const {
        Eigen::VectorXd known = Eigen::VectorXd::Zero(2 * n_points());
        for (int i = 0; i < n_points(); ++i) known[2 * i] = -(1 - scene_.theta) * points_[i].area * beta_[i];
        return h_ * (H_ * free_motion()) + W_ * known;
    }

    double opening(int i, int d) const { return H_.row(2 * i + d).dot(u_); }

    std::vector<int> contacts() const {
        const Eigen::VectorXd u = H_ * u_;
        std::vector<int> touching;
        for (int i = 0; i < n_points(); ++i)
            if (u[2 * i] <= 1e-9) touching.push_back(i);
        return touching;
    }
    static int place(const std::vector<int>& sorted, int i) {
        const auto found = std::lower_bound(sorted.begin(), sorted.end(), i);
        return found != sorted.end() && *found == i ? static_cast<int>(found - sorted.begin()) : -1;
    }

    CohesiveScene scene_;
    std::vector<Eigen::Vector2d> vertices_, where_;
    std::vector<std::array<int, 3>> triangles_, node_;
    std::vector<Point> points_;
    int n_nodes_ = 0;
    double h_ = 0;
    Eigen::SparseMatrix<double> K_, M_;
    LcpMatrix H_, W_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> M_hat_;
    Eigen::VectorXd u_, v_;
    std::vector<double> beta_;
    Eigen::MatrixXd last_;  // [points, 9]
};

}  // namespace knap::tests
