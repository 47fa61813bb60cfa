#include "stepper/implicit/free_motions.hpp"

#include "base/union_find.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr double no_restraint = 1e-10;  // of the largest pivot: a smaller one is the rounding of what is free
constexpr double no_rate = 1e-7;        // of a motion along N: a smaller rate of a point is rounding

}  // namespace

void FreeMotions::set(const CornerPartition& nodes) {
    nodes_ = &nodes;
    const Index n_corners = model_.mesh.n_corners();
    UnionFind joined(nodes.n_nodes());
    const Index per_triangle = model_.mesh.corners_per_triangle();
    for (Index c = 0; c < n_corners; ++c)
        joined.join(nodes.node_of_corner[c], nodes.node_of_corner[c - c % per_triangle]);
    Index n = 0;
    piece_of_node_.assign(nodes.n_nodes(), -1);
    for (Index i = 0; i < nodes.n_nodes(); ++i) {
        const Index first = joined.find(i);  // the lowest
        piece_of_node_[i] = first == i ? n++ : piece_of_node_[first];
    }
    std::vector<Index> piece_of_corner;
    for (Index c = 0; c < n_corners; ++c) piece_of_corner.push_back(piece_of_node_[nodes.node_of_corner[c]]);
    rigid_.find(model_, bulk_, std::move(piece_of_corner), n);
    places_.assign(n, {});
}

void FreeMotions::add_term(Index node, const Vec2& along, std::vector<Term>& terms) const {
    const Index p = piece_of_node_[node];
    const Vec2 place = model_.mesh.corner(nodes_->corner_of_node[node]);
    const auto found = std::ranges::find(terms, p, &Term::piece);
    Term& term = found == terms.end() ? terms.emplace_back(Term{p, Eigen::Vector3d::Zero()}) : *found;
    for (int k = 0; k < 3; ++k) term.along[k] += along.dot(rigid_.pieces[p].motion(k, place));
}

template <class Visit>
void FreeMotions::for_each_restraint(const std::vector<ActivePoint>& points, const Visit& visit) const {
    for (Index i = 0; i < nodes_->n_nodes(); ++i)
        for (int k = 0; k < 2; ++k)
            if (nodes_->prescribed[i][k]) terms_.clear(), add_term(i, Vec2::Unit(k), terms_), visit(terms_);
    for (const Dashpot& dashpot : bulk_.dashpots())
        for (int k = 0; k < 2; ++k)
            terms_.clear(), add_term(nodes_->node_of_corner[dashpot.corner], Vec2::Unit(k), terms_), visit(terms_);
    for (const ActivePoint& point : points) {
        const Eigen::Matrix2d D = tangent(point.law, point.multipliers, point.response, Softening::now);
        for (int row = 0; row < 2; ++row) {
            if (D.row(row).isZero(0) || !D.row(row).allFinite()) continue;
            const Vec2 along = point.out_of_frame(D.row(row).transpose().normalized());
            terms_.clear();
            point.sides.for_each_node(
                [&](Index node, const auto& weight) { add_term(node, transposed(weight) * along, terms_); });
            if (!terms_.empty()) visit(terms_);
        }
    }
}

bool FreeMotions::find(const std::vector<ActivePoint>& points) {
    UnionFind joined(places_.size());
    for_each_restraint(points, [&](const std::vector<Term>& terms) {
        for (const Term& term : terms) joined.join(terms.front().piece, term.piece);
    });
    groups_.clear();
    for (std::size_t p = 0; p < places_.size(); ++p) {
        const Index first = joined.find(static_cast<Index>(p));
        if (first == static_cast<Index>(p))
            places_[p].group = static_cast<Index>(groups_.size()), groups_.emplace_back();
        Group& group = groups_[places_[p].group = places_[first].group];
        places_[p].first = static_cast<Index>(group.n), group.n += 3;
    }
    std::vector<Eigen::MatrixXd> restraints, inertia;  // C' C of C x = 0, and R' M R
    for (const Group& group : groups_) {
        restraints.push_back(Eigen::MatrixXd::Zero(group.n, group.n));
        inertia.push_back(Eigen::MatrixXd::Zero(group.n, group.n));
    }
    for (std::size_t p = 0; p < places_.size(); ++p)
        inertia[places_[p].group].block<3, 3>(places_[p].first, places_[p].first) = rigid_.inertia[p];
    for_each_restraint(points, [&](const std::vector<Term>& terms) {
        for (const Term& a : terms)
            for (const Term& b : terms)
                restraints[places_[a.piece].group].block<3, 3>(places_[a.piece].first, places_[b.piece].first) +=
                    a.along * b.along.transpose();
    });
    bool any = false;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        find_free(groups_[g], restraints[g], inertia[g]);
        any = any || groups_[g].free.cols() > 0;
    }
    return any;
}

/// Of C' C = P' L L' P with the largest pivots first the rows of P' [-L_11^-T L_21'; I], behind the last pivot.
/// (Eigen's LDLT takes its pivots from the diagonal of C' C itself, and may find a zero before others.)
void FreeMotions::find_free(Group& group, const Eigen::MatrixXd& restraints, const Eigen::MatrixXd& inertia) const {
    Eigen::MatrixXd A = restraints;
    std::vector<Eigen::Index> order(group.n);
    std::iota(order.begin(), order.end(), 0);
    const double least = no_restraint * std::max(1.0, A.diagonal().maxCoeff());
    Eigen::Index rank = 0;
    for (; rank < group.n; ++rank) {
        const Eigen::Index k = rank, n_left = group.n - k - 1;
        Eigen::Index j = k;
        if (A.diagonal().tail(n_left + 1).maxCoeff(&j) <= least) break;
        j += k;
        A.row(k).swap(A.row(j)), A.col(k).swap(A.col(j)), std::swap(order[k], order[j]);
        A(k, k) = std::sqrt(A(k, k));
        A.col(k).tail(n_left) /= A(k, k);
        A.bottomRightCorner(n_left, n_left) -= A.col(k).tail(n_left) * A.col(k).tail(n_left).transpose();
    }
    const Eigen::Index n_free = group.n - rank;
    const Eigen::MatrixXd L = A.topLeftCorner(rank, rank).triangularView<Eigen::Lower>();
    Eigen::MatrixXd held = -A.bottomLeftCorner(n_free, rank).transpose();
    L.transpose().triangularView<Eigen::Upper>().solveInPlace(held);
    group.free.setZero(group.n, n_free);
    for (Eigen::Index i = 0; i < rank; ++i) group.free.row(order[i]) = held.row(i);
    for (Eigen::Index i = 0; i < n_free; ++i) group.free(order[rank + i], i) = 1;
    for (Eigen::Index i = 0; i < n_free; ++i) group.free.col(i) /= group.free.col(i).cwiseAbs().maxCoeff();
    if (n_free > 0) group.inertia.compute(group.free.transpose() * inertia * group.free);
}

void FreeMotions::remove_resultants(const std::vector<Vec2>& rate, std::vector<Vec2>& impulse) const {
    bulk_.external_impulse(rate, of_corner_);
    std::vector<Eigen::Vector3d> resultant(places_.size(), Eigen::Vector3d::Zero());
    const auto add = [&](Index node, const Vec2& place, const Vec2& internal) {
        for (int k = 0; k < 3; ++k)
            resultant[piece_of_node_[node]][k] += internal.dot(rigid_.pieces[piece_of_node_[node]].motion(k, place));
    };
    for (Index i = 0; i < nodes_->n_nodes(); ++i) add(i, model_.mesh.corner(nodes_->corner_of_node[i]), impulse[i]);
    for (Index c = 0; c < model_.mesh.n_corners(); ++c)
        add(nodes_->node_of_corner[c], model_.mesh.corner(c), -of_corner_[c]);
    for (std::size_t p = 0; p < places_.size(); ++p) resultant[p] = rigid_.inertia[p].ldlt().solve(resultant[p]).eval();
    for (Index c = 0; c < model_.mesh.n_corners(); ++c)
        for (int k = 0; k < 3; ++k)
            impulse[nodes_->node_of_corner[c]] -=
                resultant[piece_of_node_[nodes_->node_of_corner[c]]][k] * rigid_.momentum[c][k];
}

double FreeMotions::complete(const std::vector<ActivePoint>& points, const std::vector<Vec2>& rate,
                             std::vector<Vec2>& change) const {
    bulk_.external_impulse(rate, of_corner_);
    std::vector<Eigen::VectorXd> lack;  // b - N' M d, per group: first of the motions R
    for (const Group& group : groups_) lack.push_back(Eigen::VectorXd::Zero(group.n));
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
        const Index node = nodes_->node_of_corner[c];
        const Place& piece = places_[piece_of_node_[node]];
        Vec2 impulse = of_corner_[c];
        for (int k = 0; k < 2; ++k)
            if (nodes_->prescribed[node][k]) impulse[k] = 0;
        for (int k = 0; k < 3; ++k)
            lack[piece.group][piece.first + k] -=
                impulse.dot(rigid_.motion(c, k, model_.mesh.corner(c))) + rigid_.momentum[c][k].dot(change[node]);
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) lack[g] = groups_[g].free.transpose() * lack[g];
    for (const ActivePoint& point : points)
        for (int k = 0; k < 2; ++k) {
            const double q = k == 0 ? point.response.normal(point.law) : point.response.tangential;
            if (q == 0) continue;
            terms_.clear();
            const Vec2 along = point.out_of_frame(Vec2::Unit(k));
            point.sides.for_each_node(
                [&](Index node, const auto& weight) { add_term(node, transposed(weight) * along, terms_); });
            if (terms_.empty()) continue;
            const Index g = places_[terms_.front().piece].group;  // without a slope its sides may be of two groups
            Eigen::VectorXd of_point = Eigen::VectorXd::Zero(groups_[g].free.cols());
            for (const Term& term : terms_) {
                const Place& piece = places_[term.piece];
                if (piece.group == g) of_point += groups_[g].free.middleRows<3>(piece.first).transpose() * term.along;
                else
                    lack[piece.group] +=
                        q * (groups_[piece.group].free.middleRows<3>(piece.first).transpose() * term.along);
            }
            lack[g] += q * (of_point.array().abs() > no_rate).select(of_point, 0.0);
        }
    double largest = 0;
    std::vector<Eigen::VectorXd> added;
    for (std::size_t g = 0; g < groups_.size(); ++g)
        added.push_back(groups_[g].free.cols() > 0
                            ? Eigen::VectorXd(groups_[g].free * groups_[g].inertia.solve(lack[g]))
                            : Eigen::VectorXd::Zero(groups_[g].n));
    for (Index i = 0; i < nodes_->n_nodes(); ++i) {
        const Place& piece = places_[piece_of_node_[i]];
        const Index corner = nodes_->corner_of_node[i];
        Vec2 sum = Vec2::Zero();
        for (int k = 0; k < 3; ++k)
            sum += added[piece.group][piece.first + k] * rigid_.motion(corner, k, model_.mesh.corner(corner));
        for (int k = 0; k < 2; ++k)
            if (nodes_->prescribed[i][k]) sum[k] = 0;
        change[i] += sum;
        largest = std::max(largest, sum.norm());
    }
    return largest;
}

}  // namespace knap
