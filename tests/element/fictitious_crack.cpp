// The peak load that the scenario three_point_bending is measured by, computed independently: Hillerborg's fictitious
// crack on one half of the beam, quasi-static, with bilinear squares and a straight crack of springs that soften
// linearly (P.-E. Petersson 1981 computed his beams so).
//
// S = stiffness of the half beam for the nodes of the ligament (u_x) and the load (u_y). For every tip i of the
// fictitious crack, nodes below it carry sigma_c B(2 u), node i just sigma_c, and nodes above do not move: a linear
// system for u and the load once the piece of the softening polygon of every node is known, and those follow from u. The
// largest load is the peak. Linear softening: B = 1 - 2 u/w_c; Petersson's bilinear one has its knot at a third.
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fictitious_crack_test {

using namespace knap::tests;

namespace {

constexpr double half_length = 1, height = 0.2, thickness = 0.05, notch = 0.1;  // [m]
constexpr double E = 30e9, nu = 0.2, sigma_c = 3.33e6, G_c = 124;

using Matrix8 = Eigen::Matrix<double, 8, 8>;

/// Stiffness of a square of any size in plane stress, 2 x 2 Gauss points.
Matrix8 square_stiffness() {
    Eigen::Matrix3d D;
    D << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    D *= E / (1 - nu * nu);
    Matrix8 K = Matrix8::Zero();
    const double x[4] = {-1, 1, 1, -1}, y[4] = {-1, -1, 1, 1}, g = 1 / std::sqrt(3.0);
    for (const double xi : {-g, g})
        for (const double eta : {-g, g}) {
            Eigen::Matrix<double, 3, 8> B = Eigen::Matrix<double, 3, 8>::Zero();
            for (int a = 0; a < 4; ++a) {
                const double d_x = x[a] * (1 + y[a] * eta) / 4, d_y = y[a] * (1 + x[a] * xi) / 4;
                B(0, 2 * a) = B(2, 2 * a + 1) = d_x;
                B(1, 2 * a + 1) = B(2, 2 * a) = d_y;
            }
            K += thickness * (B.transpose() * D * B).eval();  // gradients 2/size each, area size^2/4: no size left
        }
    return K;
}

/// S, with `n` squares over the height; the last row and column are those of the load.
Eigen::MatrixXd condensed_stiffness(int n) {
    const int n_x = static_cast<int>(std::lround(n * half_length / height)),
              first = static_cast<int>(std::lround(n * notch / height));
    const auto node = [&](int i, int j) { return i * (n + 1) + j; };
    const int n_kept = n - first + 2;
    std::vector<int> number(2 * (n_x + 1) * (n + 1), 0);  // of the others: from 0 on; kept: -1 - k; fixed: -1000000
    for (int j = first; j <= n; ++j) number[2 * node(0, j)] = -1 - (j - first);
    number[2 * node(0, n) + 1] = -n_kept;
    number[2 * node(n_x, 0) + 1] = -1000000;
    int n_others = 0;
    for (int& k : number)
        if (k == 0) k = n_others++;
    std::vector<Eigen::Triplet<double>> among;
    Eigen::MatrixXd across = Eigen::MatrixXd::Zero(n_others, n_kept), kept = Eigen::MatrixXd::Zero(n_kept, n_kept);
    const Matrix8 K = square_stiffness();
    for (int i = 0; i < n_x; ++i)
        for (int j = 0; j < n; ++j) {
            const int corner[4] = {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)};
            for (int a = 0; a < 8; ++a)
                for (int b = 0; b < 8; ++b) {
                    const int p = number[2 * corner[a / 2] + a % 2], q = number[2 * corner[b / 2] + b % 2];
                    if (p == -1000000 || q == -1000000) continue;
                    if (p >= 0 && q >= 0) among.emplace_back(p, q, K(a, b));
                    else if (p >= 0) across(p, -1 - q) += K(a, b);
                    else if (q < 0) kept(-1 - p, -1 - q) += K(a, b);
                }
        }
    Eigen::SparseMatrix<double> inner(n_others, n_others);
    inner.setFromTriplets(among.begin(), among.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(inner);
    return kept - across.transpose() * factor.solve(across);
}

/// A piece of the softening: B = height - slope w up to the opening w = end [m].
struct Piece {
    double height, slope, end;
};

std::vector<Piece> pieces_of(const std::vector<std::array<double, 2>>& knots) {
    std::vector<Piece> pieces;
    const double unit = G_c / sigma_c;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const double slope = (knots[i][1] - knots[i + 1][1]) / (knots[i + 1][0] - knots[i][0]);
        pieces.push_back({knots[i][1] + slope * knots[i][0], slope / unit, knots[i + 1][0] * unit});
    }
    pieces.push_back({0, 0, INFINITY});
    return pieces;
}

double peak_load(int n, const std::vector<Piece>& softening) {
    const Eigen::MatrixXd S = condensed_stiffness(n);
    const int n_nodes = static_cast<int>(S.rows()) - 1;
    double peak = 0;
    for (int tip = 0; tip < n_nodes - 1; ++tip) {
        // unknown: u of the nodes below the tip, then that of the load
        std::vector<int> moving(tip + 1);
        for (int k = 0; k < tip; ++k) moving[k] = k;
        moving[tip] = n_nodes;
        Eigen::VectorXd u;
        std::vector<std::size_t> piece(tip, 0);
        for (bool settled = false; !settled;) {
            Eigen::MatrixXd A(tip + 1, tip + 1);
            Eigen::VectorXd pull(tip + 1);
            for (int row = 0; row <= tip; ++row) {
                const double area = thickness * height / n * (row == 0 ? 0.5 : 1);
                for (int k = 0; k <= tip; ++k) A(row, k) = S(row, moving[k]);
                if (row < tip) A(row, row) -= area * sigma_c * 2 * softening[piece[row]].slope;
                pull[row] = -area * sigma_c * (row < tip ? softening[piece[row]].height : 1);
            }
            u = A.partialPivLu().solve(pull);
            settled = true;
            for (int k = 0; k < tip; ++k)
                if (2 * u[k] > softening[piece[k]].end) ++piece[k], settled = false;
        }
        double load = 0;
        for (int k = 0; k <= tip; ++k) load -= 2 * S(n_nodes, moving[k]) * u[k];
        peak = std::max(peak, load);
    }
    return peak;
}

}  // namespace

TEST_CASE("the fictitious crack gives the peak load that three_point_bending expects") {
    const std::vector<Piece> linear = pieces_of({{0, 1}, {2, 0}}),
                             petersson = pieces_of({{0, 1}, {0.8, 1. / 3}, {3.6, 0}});
    for (const auto& [softening, expected] : {std::pair{linear, 854.}, {petersson, 755.}}) {
        const double coarse = peak_load(20, softening), fine = peak_load(40, softening);
        MESSAGE("peak ", coarse, " N with 10 elements in the ligament, ", fine, " N with 20");
        CHECK(fine == relative(coarse, 0.01));
        CHECK(fine == relative(expected, 0.01));
    }
}

}  // namespace fictitious_crack_test
