#pragma once
// The driven double cantilever beam as N. A. Collins-Craft, F. Bourrier and V. Acary compute it (Comput. Methods Appl. Mech. Engrg. 400 (2022)
// 115545 and the code published with it), written anew and apart from everything below src: own matrices, own interface problem, no scaling.
// Units N, mm, ms, g. Arm of 2 x 0.2 mm in plane stress: left end held, upper right corner driven upwards at 1 mm/ms and held in x.
//
//     (M + (theta h)^2 K) v+ = (M - theta (1 - theta) h^2 K) v - h K u + H' q,     u+ = u + h (theta v+ + (1 - theta) v),     theta = 1/2
//     q = S (p - h sigma_c beta_theta),  beta_theta = theta beta+ + (1 - theta) beta
//     0 <= p  perp  v_N+ >= 0   where u_N + h/2 v_N <= 1e-8 mm, else p = 0
//     beta+ = min(beta, max(0, 1 - u_N+/delta_c))           the solution of their complementarity problem; 0 for good from 1e-12 on
//
// M of one Gauss point a triangle: m/9 for each pair of corners. A node of the glue has the area of half its two edges; the held one has no
// point, and leaves its area to its neighbour. Their solver of the complementarity problem is Lemke's method. It has one solution as long as
// Assumption 1 holds, and what finds it here is an active set; `worst` says how well it is met.
#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

namespace knap::tests {

struct PublishedBeam {
    using Vector = Eigen::VectorXd;
    using Sparse = Eigen::SparseMatrix<double>;

    static constexpr double E = 2700, nu = 0.39, density = 1.18e-3, sigma_c = 45, G_c = 0.14,
                            delta_c = 2 * G_c / sigma_c;
    static constexpr double theta = 0.5, speed = 1, touching = 1e-8, broken = 1e-12;
    static constexpr double length = 2, height = 0.2, glued = 1.6;  // [mm]

    struct Energies {
        double strain, kinetic, surface;  // [mJ]
    };

    /// What may be done otherwise than they do.
    struct Options {
        bool one_point = true;        // mass of one Gauss point; else the exact consistent one
        bool leaves_its_area = true;  // the held node to its neighbour; else its part of the glue never opens
        bool hovers =
            true;  // contact stops a point where its middle of the step would touch; else it lands on the wall, or stops
    };

    /// Nodes [mm] and the nodes of the triangles, counterclockwise.
    PublishedBeam(std::vector<std::array<double, 2>> nodes, std::vector<std::array<int, 3>> triangles,
                  const Options& options)
        : x(std::move(nodes)), triangle(std::move(triangles)), hovers(options.hovers) {
        assemble(options.one_point);
        hold_and_drive();
        glue(options.leaves_its_area);
        u = Vector::Zero(2 * n_nodes());
        v = Vector::Zero(2 * n_nodes());
        for (int d = 0; d < 2 * n_nodes(); ++d) v[d] = given[d];
    }

    void step(double h) {
        const StepMatrix& matrix = matrix_of(h);
        const Vector i_hat = M * v - theta * (1 - theta) * h * h * (K * v) - h * (K * u);
        const auto free_velocity =
            [&](const Vector& impulse) {  // free components of M_hat v+ = impulse, the others are given
                const Vector left = impulse - M * given - theta * theta * h * h * (K * given);
                Vector right(n_free);
                for (int d = 0; d < left.size(); ++d)
                    if (number[d] >= 0) right[number[d]] = left[d];
                const Vector solved = matrix.factor.solve(right);
                Vector all = given;
                for (int d = 0; d < left.size(); ++d)
                    if (number[d] >= 0) all[d] = solved[number[d]];
                return all;
            };
        const Vector a = at_points(free_velocity(i_hat)), v_N = at_points(v), u_N = at_points(u);
        const Vector q = interface_impulses(h, matrix.W, a, u_N, v_N);
        Vector impulse = i_hat;
        for (int i = 0; i < n_points(); ++i) impulse[2 * node[i] + 1] += q[i];
        const Vector after = free_velocity(impulse);
        u += h * ((1 - theta) * v + theta * after);
        v = after;
        time += h;
    }

    Energies energies() const {
        double surface = 0;
        const Vector u_N = at_points(u).cwiseMax(0);  // they let penetrations work, too
        for (int i = 0; i < n_points(); ++i)
            surface += area[i] * (sigma_c * beta[i] * u_N[i] + G_c * (1 - beta[i]) * (1 - beta[i]));
        return {.strain = 0.5 * u.dot(K * u), .kinetic = 0.5 * v.dot(M * v), .surface = surface};
    }

    /// [mm] of glue from its end up to the last broken point.
    double crack() const {
        double furthest = glued;
        for (int i = 0; i < n_points(); ++i)
            if (beta[i] <= broken) furthest = std::min(furthest, x[node[i]][0]);
        return glued - furthest;
    }

    int n_nodes() const { return static_cast<int>(x.size()); }
    int n_points() const { return static_cast<int>(node.size()); }

    std::vector<std::array<double, 2>> x;
    std::vector<std::array<int, 3>> triangle;
    bool hovers;
    std::vector<int> node;           // of the points, along the glue
    std::vector<double> area, beta;  // [mm2], [-]
    Vector u, v;                     // [mm], [mm/ms]
    double time = 0;                 // [ms]
    double worst = 0;                // residual of all steps: velocities [mm/ms]
    int max_rounds = 0;              // of the active set in a step

private:
    struct StepMatrix {
        Eigen::SimplicialLDLT<Sparse> factor;
        Eigen::MatrixXd W;  // H M_hat^-1 H'
    };
    enum class Contact { open, closed };
    enum class Cohesion { holds, falls, gone };
    struct PointState {
        Contact contact = Contact::closed;
        Cohesion cohesion = Cohesion::holds;
        bool operator==(const PointState&) const = default;
    };

    void assemble(bool one_point) {
        Eigen::Matrix3d D;  // plane stress
        D << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
        D *= E / (1 - nu * nu);
        std::vector<Eigen::Triplet<double>> stiffness, mass;
        for (const auto& t : triangle) {
            Eigen::Matrix<double, 3, 6> B = Eigen::Matrix<double, 3, 6>::Zero();
            const auto edge = [&](int i, int j, int k) { return x[t[j % 3]][k] - x[t[i % 3]][k]; };
            const double twice = edge(0, 1, 0) * edge(0, 2, 1) - edge(0, 2, 0) * edge(0, 1, 1);
            for (int i = 0; i < 3; ++i) {
                const double dx = -edge(i + 1, i + 2, 1) / twice, dy = edge(i + 1, i + 2, 0) / twice;
                B.block<3, 2>(0, 2 * i) << dx, 0, 0, dy, dy, dx;
            }
            const Eigen::Matrix<double, 6, 6> k = 0.5 * twice * B.transpose() * D * B;
            const double m = density * 0.5 * twice;
            for (int i = 0; i < 6; ++i)
                for (int j = 0; j < 6; ++j) {
                    const int row = 2 * t[i / 2] + i % 2, column = 2 * t[j / 2] + j % 2;
                    stiffness.emplace_back(row, column, k(i, j));
                    if (i % 2 == j % 2) mass.emplace_back(row, column, one_point ? m / 9 : (i == j ? m / 6 : m / 12));
                }
        }
        K.resize(2 * n_nodes(), 2 * n_nodes());
        M.resize(2 * n_nodes(), 2 * n_nodes());
        K.setFromTriplets(stiffness.begin(), stiffness.end());
        M.setFromTriplets(mass.begin(), mass.end());
    }

    bool is_at(int n, double at_x, double at_y) const {
        return std::abs(x[n][0] - at_x) + std::abs(x[n][1] - at_y) < 1e-9;
    }
    bool is_held(int n) const { return std::abs(x[n][0]) < 1e-9; }

    void hold_and_drive() {
        given = Vector::Zero(2 * n_nodes());
        for (int n = 0; n < n_nodes(); ++n) {
            const bool driven = is_at(n, length, height);
            if (driven) given[2 * n + 1] = speed;
            for (int k = 0; k < 2; ++k) number.push_back(driven || is_held(n) ? -1 : n_free++);
        }
    }

    void glue(bool held_node_leaves_its_area) {
        for (int n = 0; n < n_nodes(); ++n)
            if (std::abs(x[n][1]) < 1e-9 && x[n][0] < glued + 1e-9) node.push_back(n);
        std::sort(node.begin(), node.end(), [&](int a, int b) { return x[a][0] < x[b][0]; });
        std::vector<double> share(node.size(), 0);
        for (std::size_t i = 1; i < node.size(); ++i) {
            const double half = 0.5 * (x[node[i]][0] - x[node[i - 1]][0]);
            share[i] += half;
            share[i == 1 && held_node_leaves_its_area ? 1 : i - 1] += half;
        }
        node.erase(node.begin());
        area.assign(share.begin() + 1, share.end());
        beta.assign(node.size(), 1);
        state.resize(node.size());
    }

    Vector at_points(const Vector& all) const {
        Vector some(n_points());
        for (int i = 0; i < n_points(); ++i) some[i] = all[2 * node[i] + 1];
        return some;
    }

    const StepMatrix& matrix_of(double h) {
        const auto [found, is_new] = matrices.try_emplace(h);
        if (!is_new) return found->second;
        std::vector<Eigen::Triplet<double>> entries;
        const Sparse all = M + theta * theta * h * h * K;
        for (int column = 0; column < all.outerSize(); ++column)
            for (Sparse::InnerIterator entry(all, column); entry; ++entry)
                if (number[entry.row()] >= 0 && number[column] >= 0)
                    entries.emplace_back(number[entry.row()], number[column], entry.value());
        Sparse matrix(n_free, n_free);
        matrix.setFromTriplets(entries.begin(), entries.end());
        found->second.factor.compute(matrix);
        if (found->second.factor.info() != Eigen::Success)
            throw std::runtime_error("the matrix of a step cannot be factorised");
        found->second.W.resize(n_points(), n_points());
        for (int j = 0; j < n_points(); ++j) {
            const Vector column = found->second.factor.solve(Vector::Unit(n_free, number[2 * node[j] + 1]));
            for (int i = 0; i < n_points(); ++i) found->second.W(i, j) = column[number[2 * node[i] + 1]];
        }
        return found->second;
    }

    /// [mm/ms] Least v+ of a point that may touch. Else than theirs: theta v+ + (1 - theta) v >= min(-u/h, -(1 - theta) max(-v, 0)).
    double min_velocity(double h, double u_N, double v_N) const {
        if (hovers) return 0;
        const double stops = -(1 - theta) * std::max(-v_N, 0.0), lands = u_N > 0 ? -u_N / h : 0;
        return (std::min(lands, stops) - (1 - theta) * v_N) / theta;
    }

    /// In given states the problem is linear; points whose state does not fit change it, all at once, late in a step one at a time.
    Vector interface_impulses(double h, const Eigen::MatrixXd& W, const Vector& a, const Vector& u_N,
                              const Vector& v_N) {
        std::vector<char> may_touch(n_points());
        for (int i = 0; i < n_points(); ++i) may_touch[i] = !hovers || u_N[i] + h / 2 * v_N[i] <= touching;
        for (int i = 0; i < n_points(); ++i) {
            if (!may_touch[i]) state[i].contact = Contact::open;
            if (beta[i] <= broken) state[i].cohesion = Cohesion::gone;
        }
        for (int round = 1; round <= 2000; ++round) {
            const Vector q = solve_states(h, W, a, u_N, v_N);
            const Vector after = a + W * q;
            bool fits = true;
            for (int i = 0; i < n_points(); ++i) {
                const PointState right = fitting(i, h, may_touch[i], q[i], after[i], u_N[i], v_N[i]);
                if (right == state[i]) continue;
                fits = false;
                state[i] = right;
                if (round > 50) break;
            }
            if (!fits) continue;
            max_rounds = std::max(max_rounds, round);
            for (int i = 0; i < n_points(); ++i) {
                if (state[i].contact == Contact::closed)
                    worst = std::max(worst, std::abs(after[i] - min_velocity(h, u_N[i], v_N[i])));
                beta[i] = cohesion_at(i, u_N[i] + h * ((1 - theta) * v_N[i] + theta * after[i]));
                if (beta[i] <= broken) beta[i] = 0;
            }
            return q;
        }
        throw std::runtime_error("the interface problem does not settle");
    }

    double cohesion_at(int i, double opening) const { return std::min(beta[i], std::max(0.0, 1 - opening / delta_c)); }

    Vector solve_states(double h, const Eigen::MatrixXd& W, const Vector& a, const Vector& u_N,
                        const Vector& v_N) const {
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n_points(), n_points());
        Vector b(n_points());
        for (int i = 0; i < n_points(); ++i) {
            const double full = h * sigma_c * area[i];
            if (state[i].contact == Contact::closed) {  // v+ = a + W q
                A.row(i) = W.row(i) / W(i, i);
                b[i] = (min_velocity(h, u_N[i], v_N[i]) - a[i]) / W(i, i);
                continue;
            }
            A(i, i) = 1;
            b[i] = -full * (1 - theta) * beta[i];
            if (state[i].cohesion == Cohesion::holds) b[i] -= full * theta * beta[i];
            if (state[i].cohesion ==
                Cohesion::falls) {  // beta+ = 1 - (u + h (1 - theta) v + h theta (a + W q))/delta_c
                A.row(i) -= full * theta * theta * h / delta_c * W.row(i);
                b[i] -= full * theta * (1 - (u_N[i] + h * (1 - theta) * v_N[i] + h * theta * a[i]) / delta_c);
            }
        }
        return A.partialPivLu().solve(b);
    }

    PointState fitting(int i, double h, bool may_touch, double q, double after, double u_N, double v_N) const {
        const double opening = u_N + h * ((1 - theta) * v_N + theta * after), requested = 1 - opening / delta_c;
        const double full = h * sigma_c * area[i],
                     p = q + full * (theta * cohesion_at(i, opening) + (1 - theta) * beta[i]);
        PointState right = state[i];
        if (state[i].contact == Contact::closed && p < -1e-12 * full) right.contact = Contact::open;
        if (state[i].contact == Contact::open && may_touch && after < min_velocity(h, u_N, v_N))
            right.contact = Contact::closed;
        right.cohesion = beta[i] <= broken || requested <= 0 ? Cohesion::gone
                         : requested < beta[i]               ? Cohesion::falls
                                                             : Cohesion::holds;
        return right;
    }

    Sparse K, M;
    Vector given;             // [mm/ms] of the components that are, else 0
    std::vector<int> number;  // of the free components, else -1
    int n_free = 0;
    std::vector<PointState> state;
    std::map<double, StepMatrix> matrices;  // by their step
};

}  // namespace knap::tests
