#include "stepper/implicit/multiplier_series.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {
namespace {

// A nodal force that is smaller, over the move, leaves the rates as they are; then q is 1 up to this.
constexpr double no_force = 1e-3;
constexpr double min_ratio = 0.1;      // of a series worth extrapolating
constexpr double max_deviation = 0.1;  // of a move from q times the previous one
// Moves of a series, where q is as uncertain near 1 as a move may deviate; more where it deviates less. (Moves near
// rounding that were multiplied by 1e5 made a random body depend on its units in the last digits.)
constexpr double max_series = 20, max_sure_series = 1e3;
constexpr double sure_part = 0.1;      // over the relative deviation
constexpr double largest_turn = 0.25;  // [-] of the force of an opening point in a series, over it
constexpr double least_part = 1e-3;    // of the longest move of contacts between faces: less belongs to another series

/// Until a point of a curved law leaves its half ellipse or the shear that it bears under compression; where it slides,
/// until it is no longer pressed. Sides that overlap are held at W = 0 by tension and at their bound by compression, so
/// without either they are free. An open point has no bound.
double moves_to_edge(const ActivePoint& point, const Vec2& d) {
    const PointLaw& law = point.law;
    const double C = law.strength * point.response.cohesion_theta, most = law.material->gamma * C;
    const Vec2 q(point.multipliers.contact - law.strength * law.cohesion, point.multipliers.tangential),
        p(q.x() / C, q.y() / most), along(d.x() / C, d.y() / most);  // of the unit circle
    const double a = along.squaredNorm(), b = p.dot(along), c = p.squaredNorm() - 1, root = b * b - a * c;
    if (a == 0) return infinity;
    if (!point.response.sticks)
        return point.response.closed && d.x() < 0 ? std::max(0.0, q.x() + C * point.response.pull) / -d.x() : infinity;
    const double to_rest = -q.x() / d.x(), moves = root > 0 ? (-b + std::sqrt(root)) / a : 0;
    const bool overlaps = law.contact.may_touch && law.contact.rate + law.u_N / law.step->h < 0;
    const double least = overlaps && to_rest > 0 ? to_rest : infinity;
    if (q.x() + moves * d.x() <= 0) return std::min(least, std::max(0.0, moves));
    if (d.y() == 0) return least;
    const double left = law.rubbing(std::max(0.0, q.x())) + most - std::copysign(q.y(), q.y() * d.y());
    return std::min(least, std::max(0.0, left) / std::abs(d.y()));
}

}  // namespace

MultiplierSeries::MultiplierSeries(const Model& model, const ThetaMatrix& matrix) : matrix_(matrix) {
    reserve_capacity(model.mesh.n_corners(), force_);
    reserve_capacity(model.fan_points.size() + 1, last_move_);
}

void MultiplierSeries::extrapolate(const std::vector<Vec2>& move, double min_move, std::vector<ActivePoint>& points) {
    assert(move.size() == points.size());
    force_.resize(matrix_.nodes().n_nodes());
    last_move_.resize(points.size(), Vec2::Zero());
    const auto force_on = [&](Index node) {
        double largest = 0;
        for (int k = 0; k < 2; ++k)
            if (matrix_.is_free(node, k)) largest = std::max(largest, std::abs(force_[node][k]));
        return largest;
    };
    for (std::size_t first = 0, end; first < points.size(); first = end) {
        // H' d of this group alone: moves that cancel with those of others must not go on without them
        for (end = first; end < points.size() && points[end].fan == points[first].fan; ++end)
            points[end].sides.for_each_node([&](Index node, const auto&) { force_[node].setZero(); });
        for (std::size_t j = first; j < end; ++j) points[j].sides.add_force(points[j].out_of_frame(move[j]), force_);
        double longest = 0, strongest = 0, square = 0, product = 0, length = 0;  // of the previous move and this one
        // Faces are one group, in which a few points may march; some of the others are always near their bounds.
        const bool faces = points[first].fan == between_faces;
        double least = 0;
        for (std::size_t j = first; faces && j < end; ++j)
            least = std::max(least, least_part * move[j].cwiseAbs().maxCoeff());
        bool is_rigid = true;        // else ramps decide how redundant points share their forces
        double to_turn = infinity;   // moves until the force of an opening point has turned
        double to_bound = infinity;  // moves until a contact, or a sticking point, is at its bound
        for (std::size_t j = first; j < end; ++j) {
            const ActivePoint& point = points[j];
            const Vec2& d = move[j];
            longest = std::max(longest, d.cwiseAbs().maxCoeff());
            point.sides.for_each_node(
                [&](Index node, const auto&) { strongest = std::max(strongest, force_on(node)); });
            square += last_move_[j].squaredNorm();
            product += last_move_[j].dot(d);
            length += d.squaredNorm();
            const PointLaw& law = point.law;
            const Multipliers& multipliers = point.multipliers;
            const bool turns = point.response.curvature > 0 && point.response.opens;
            is_rigid = is_rigid && !turns && (!point.response.on_ramp || point.law.drops);
            if (turns)
                to_turn = std::min(to_turn, largest_turn * law.strength * point.response.cohesion_theta / d.norm());
            if (d.cwiseAbs().maxCoeff() < least) continue;
            if (law.is_curved()) {
                to_bound = std::min(to_bound, moves_to_edge(point, d));
                continue;
            }
            if (point.response.lands) {  // it is held with tension from none to what its slip on the ramp leaves
                const double tension = law.strength * law.cohesion - multipliers.contact,
                             left = d.x() > 0 ? tension : law.strength * point.response.cohesion_theta - tension;
                if (d.x() != 0) to_bound = std::min(to_bound, std::max(0.0, left) / std::abs(d.x()));
            } else if ((point.response.closed || law.holds_cohesion()) && d.x() < 0)
                to_bound = std::min(to_bound, multipliers.contact / -d.x());
            if (law.drops && point.response.on_ramp && !point.response.closed && d.x() > 0)  // until it bears nothing
                to_bound = std::min(to_bound, std::max(0.0, law.strength * law.cohesion - multipliers.contact) / d.x());
            if (!point.response.sticks || d.y() == 0) continue;
            const double bound =
                law.rubbing(multipliers.contact) + law.material->gamma * law.strength * point.response.cohesion_theta;
            const double left = bound - std::copysign(multipliers.tangential, multipliers.tangential * d.y());
            to_bound = std::min(to_bound, std::max(0.0, left) / std::abs(d.y()));
        }
        if (longest <= min_move || points[first].fan == at_obstacle) continue;
        double series = 0;  // moves
        const double q = product / square, deviation2 = std::max(0.0, length - product * product / square);
        const bool is_straight = deviation2 <= max_deviation * max_deviation * length,
                   marches = strongest <= no_force * longest && q >= 1 - no_force;
        if (is_rigid && marches) series = infinity;
        else if (marches && to_turn < infinity && is_straight)  // the force turns until it points along the misfit
            series = std::min(to_turn, q / (std::max(0.0, 1 - q) + deviation2 / length));
        else if (product > min_ratio * square && is_straight && q < 1)
            series = std::min(q / (1 - q),
                              std::clamp(sure_part * std::sqrt(length / deviation2), max_series, max_sure_series));
        const bool projects = faces && series < infinity;
        const double multiple = projects ? series : std::min(series, to_bound);
        const bool extrapolates = multiple > 0 && multiple < infinity;
        for (std::size_t j = first; j < end; ++j) {
            last_move_[j] = extrapolates ? Vec2::Zero() : move[j];
            if (!extrapolates || (!projects && move[j].cwiseAbs().maxCoeff() < least)) continue;
            Multipliers& at = points[j].multipliers;
            at.contact = std::max(0.0, at.contact + multiple * move[j].x());
            at.tangential += multiple * move[j].y();
            const double bound = points[j].law.rubbing(at.contact);
            if (projects) at.tangential = std::clamp(at.tangential, -bound, bound);
        }
    }
}

}  // namespace knap
