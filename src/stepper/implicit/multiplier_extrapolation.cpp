#include "stepper/implicit/multiplier_extrapolation.hpp"

#include "base/room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace knap {
namespace {

constexpr double unfelt = 1e-3;         // pull on a corner, over the move: what else still moves falls by this much in every round
constexpr double min_ratio = 0.1;     // below it the series is short
constexpr double max_deviation = 0.1;  // of a move from q times the one before
constexpr double max_series = 20;      // of a q near 1 little is known

constexpr double endless = std::numeric_limits<double>::infinity();

/// How often the move can be repeated until a contact, or what sticks, comes to its bound.
double room(std::span<const ActivePoint> fan, std::span<const Vec2> move) {
    double furthest = endless;
    for (std::size_t j = 0; j < fan.size(); ++j) {
        const PointLaw& law = fan[j].law;
        if (fan[j].response.closed && move[j].x() < 0) furthest = std::min(furthest, law.contact_guess / -move[j].x());
        if (!fan[j].response.sticks || move[j].y() == 0) continue;
        const double most = law.friction * law.contact_guess + law.material->gamma * law.strength * fan[j].response.cohesion_theta;
        const double left = most - std::copysign(law.tangential_guess, law.tangential_guess * move[j].y());
        furthest = std::min(furthest, std::max(0.0, left) / std::abs(move[j].y()));
    }
    return furthest;
}

/// q + q^2 + ... if the moves are those of a series; else 0.
double rest_of_series(std::span<const Vec2> before, std::span<const Vec2> move) {
    double square = 0, product = 0, length = 0;
    for (std::size_t j = 0; j < move.size(); ++j) square += before[j].squaredNorm(), product += before[j].dot(move[j]), length += move[j].squaredNorm();
    const double deviation = length - product * product / square;  // squared, from q times the move before
    if (!(product > min_ratio * square) || deviation > max_deviation * max_deviation * length) return 0;
    const double q = product / square;
    return q < 1 ? std::min(q / (1 - q), max_series) : 0;
}

}  // namespace

MultiplierExtrapolation::MultiplierExtrapolation(const Model& model) {
    make_room(model.fan_points.size(), before_, move_);
    make_room(model.mesh.n_corners(), pull_);
}

void MultiplierExtrapolation::apply(const ThetaMatrix& matrix, std::vector<ActivePoint>& points, const std::vector<Vec2>& last, double least) {
    std::vector<Vec2>&move = move_, &pull = pull_;
    move.resize(points.size());
    pull.assign(matrix.n_nodes(), Vec2::Zero());
    for (std::size_t j = 0; j < points.size(); ++j) {
        const ActivePoint& point = points[j];
        move[j] = Vec2(point.law.contact_guess, point.law.tangential_guess) - last[j];
        const Vec2 force = move[j].x() * point.normal + move[j].y() * turned_left(point.normal);
        if (point.beside >= 0) pull[point.beside] += point.share * force;
        if (point.after >= 0) pull[point.after] += (1 - point.share) * force;
        if (point.before >= 0) pull[point.before] -= force;
    }
    const auto felt = [&](Index node) {
        double largest = 0;
        for (int k = 0; node >= 0 && k < 2; ++k)
            if (matrix.is_free(node, k)) largest = std::max(largest, std::abs(pull[node][k]));
        return largest;
    };
    before_.resize(points.size(), Vec2::Zero());
    for (std::size_t first = 0, end; first < points.size(); first = end) {
        double longest = 0, strongest = 0;
        for (end = first; end < points.size() && points[end].fan == points[first].fan; ++end) {
            longest = std::max(longest, move[end].cwiseAbs().maxCoeff());
            strongest = std::max({strongest, felt(points[end].before), felt(points[end].after)});
        }
        if (longest <= least || points[first].fan < 0) continue;  // obstacles meet through the whole body, and may jam it
        const std::size_t n = end - first;
        const std::span moves(move.begin() + first, n);
        const double series = strongest <= unfelt * longest ? endless : rest_of_series({before_.begin() + first, n}, moves);
        const double multiple = series > 0 ? std::min(series, room({points.begin() + first, n}, moves)) : 0;
        const bool extrapolates = multiple > 0 && multiple < endless;
        for (std::size_t j = first; j < end; ++j) {
            before_[j] = extrapolates ? Vec2::Zero() : move[j];
            if (!extrapolates) continue;
            points[j].law.contact_guess = std::max(0.0, points[j].law.contact_guess + multiple * move[j].x());
            points[j].law.tangential_guess += multiple * move[j].y();
        }
    }
}

}  // namespace knap
