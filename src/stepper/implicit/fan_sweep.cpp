#include "stepper/implicit/fan_sweep.hpp"

#include "base/reserve_capacity.hpp"
#include "base/secant.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_steps_of_fan = 12, max_updates_of_fan = 10;
constexpr double fan_goal = 0.1;  // of the tolerance of the sweep: residual of a fan that is solved

Vec2 impulse_of(const ActivePoint& point, const PointResponse& response) {
    return point.out_of_frame({response.normal(point.law), response.tangential});
}

}  // namespace

FanSweep::FanSweep(const Model& model, const ThetaMatrix& matrix) : model_(model), matrix_(matrix) {
    first_column_.resize(model.fan_corners.size());
    reserve_capacity(model.mesh.n_corners(), touches_);
    columns_.reserve(4 * model.mesh.corners_per_triangle() * model.fan_corners.size());
}

void FanSweep::begin(const std::vector<ActivePoint>& points) {
    has_columns_ = false;
    touches_.assign(matrix_.nodes().n_nodes(), 0);
    for (const ActivePoint& point : points)
        if (point.fan < 0) point.sides.for_each_node([&](Index node, const auto&) { touches_[node] = 1; });
}

void FanSweep::find_columns(const std::vector<ActivePoint>& points) {
    has_columns_ = true;
    columns_.clear();
    Index n = 0, last = -1;
    for (const ActivePoint& point : points) {
        if (point.fan < 0 || point.fan == last) continue;
        last = point.fan;
        const Fan& fan = model_.fans[last];
        for (Index c = fan.first_corner; c < fan.first_corner + fan.n_corners; ++c) {
            const Index corner = model_.fan_corners[c], k = model_.mesh.place_in_triangle(corner);
            const ElementMatrix M_hat = matrix_.element(model_.mesh.triangle_of(corner));
            first_column_[c] = n++;
            for (Index j = 2 * k; j < 2 * k + 2; ++j)
                columns_.insert(columns_.end(), M_hat.col(j).begin(), M_hat.col(j).end());
        }
    }
}

FanSweep::Columns FanSweep::columns(Index fan_corner) const {
    const Index n = 2 * model_.mesh.corners_per_triangle();
    return {&columns_[std::size_t(2 * n) * first_column_[fan_corner]], n, 2};
}

bool FanSweep::is_free(int unknown) const { return matrix_.is_free(node_[unknown / 2], unknown % 2); }

int FanSweep::place(Index node) const {
    const auto end = node_.begin() + n_nodes_, at = std::find(node_.begin(), end, node);
    return at == end ? -1 : static_cast<int>(at - node_.begin());
}

bool FanSweep::is_balanced(double tolerance, const std::vector<Vec2>& residual) const {
    const std::span corners(&model_.fan_corners[fan_->first_corner], fan_->n_corners);
    return std::ranges::all_of(corners, [&](Index corner) {
        return matrix_.largest_free(residual, matrix_.nodes().node_of_corner[corner]) <= tolerance;
    });
}

/// The nodes of the fan and their equations. False: they are left alone.
bool FanSweep::load(std::span<const ActivePoint> points, const std::vector<Vec2>& impulse) {
    if (points.size() > static_cast<std::size_t>(max_nodes)) return false;
    n_nodes_ = 0;
    for (Index c = fan_->first_corner; c < fan_->first_corner + fan_->n_corners; ++c) {
        const Index node = matrix_.nodes().node_of_corner[model_.fan_corners[c]];
        if (touches_[node]) return false;
        if (place(node) >= 0) continue;
        if (n_nodes_ == max_nodes) return false;
        node_[n_nodes_++] = node;
    }
    inertia_.setZero(2 * n_nodes_, 2 * n_nodes_);
    for (Index c = fan_->first_corner; c < fan_->first_corner + fan_->n_corners; ++c) {
        const Index corner = model_.fan_corners[c];
        const int i = place(matrix_.nodes().node_of_corner[corner]);
        inertia_.block<2, 2>(2 * i, 2 * i) += columns(c).middleRows<2>(2 * model_.mesh.place_in_triangle(corner));
    }
    start_.resize(2 * n_nodes_);
    move_.setZero(2 * n_nodes_);
    for (int i = 0; i < n_nodes_; ++i) start_.segment<2>(2 * i) = impulse[node_[i]];
    return true;
}

/// (N, T) of a motion of the nodes across a point.
Vec2 FanSweep::turn(const ActivePoint& point, const Vector& x) const {
    Vec2 jump = Vec2::Zero();
    point.sides.for_each_node([&](Index node, const auto& weight) { jump += weight * x.segment<2>(2 * place(node)); });
    return point.in_frame(jump);
}

void FanSweep::add_impulse(const ActivePoint& point, const Vec2& impulse, Vector& x) const {
    point.sides.for_each_node(
        [&](Index node, const auto& weight) { x.segment<2>(2 * place(node)) += transposed(weight) * impulse; });
}

double FanSweep::largest_residual() const {
    double largest = 0;
    for (int i = 0; i < 2 * n_nodes_; ++i) largest = std::max(largest, std::abs(residual_[i]));
    return std::isfinite(residual_.sum()) ? largest : infinity;
}

void FanSweep::find_residual(std::span<const ActivePoint> points) {
    residual_ = start_;
    residual_.noalias() += inertia_ * move_;
    for (std::size_t j = 0; j < points.size(); ++j) {
        const ActivePoint& point = points[j];
        const Vec2 rate = point.rate + turn(point, move_);
        response_[j] = respond(point.law, point.multipliers, rate.x(), rate.y());
        add_impulse(point, -impulse_of(point, response_[j]), residual_);
    }
    for (int i = 0; i < 2 * n_nodes_; ++i)
        if (!is_free(i)) residual_[i] = 0;
}

/// Newton's. False: the matrix is not definite.
bool FanSweep::find_direction(std::span<const ActivePoint> points, Softening softening) {
    const auto rows = [&](Index node) {
        const int x = 2 * place(node);
        return std::array{x, x + 1};
    };
    matrix_of_step_ = inertia_;
    bool symmetric = true;
    for (std::size_t j = 0; j < points.size(); ++j) {
        const Eigen::Matrix2d D = tangent(points[j].law, points[j].multipliers, response_[j], softening);
        if (D.isZero(0)) continue;
        symmetric = symmetric && D(0, 1) == D(1, 0);
        const Eigen::Matrix2d axes = points[j].axes();
        points[j].sides.add_block(axes * D * axes.transpose(), rows, matrix_of_step_);
    }
    for (int i = 0; i < 2 * n_nodes_; ++i) {
        if (is_free(i)) continue;
        matrix_of_step_.row(i).setZero();
        matrix_of_step_.col(i).setZero();
        matrix_of_step_(i, i) = 1;
    }
    if (symmetric) {
        const Eigen::LLT<Eigen::Ref<Matrix>> factor(matrix_of_step_);
        if (factor.info() != Eigen::Success) return false;
        step_ = factor.solve(-residual_);
    } else {
        step_ = matrix_of_step_.partialPivLu().solve(-residual_);
    }
    return step_.allFinite();
}

/// To the zero of the slope along the step, as for the body.
double FanSweep::step_length(std::span<const ActivePoint> points) const {
    const double slope_of_start = step_.dot(start_), slope_of_move = step_.dot(inertia_ * move_),
                 curvature = step_.dot(inertia_ * step_);
    std::array<Vec2, max_nodes> rate, along;
    for (std::size_t j = 0; j < points.size(); ++j) {
        rate[j] = points[j].rate + turn(points[j], move_);
        along[j] = turn(points[j], step_);
    }
    const auto slope = [&](double a) {
        double sum = slope_of_start + slope_of_move + a * curvature;
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Vec2 at = rate[j] + a * along[j];
            const PointResponse q = respond(points[j].law, points[j].multipliers, at.x(), at.y());
            sum -= q.normal(points[j].law) * along[j].x() + q.tangential * along[j].y();
        }
        return sum;
    };
    const double at_start = slope(0), at_end = slope(1);
    if (at_start >= 0 || at_end <= 0.1 * std::abs(at_start)) return 1;
    return zero_between(0, at_start, 1, at_end, 1e-2 * std::abs(at_start), 20, slope);
}

/// False: the fan stays where it is, since its balance would be missed by more.
bool FanSweep::solve(double tolerance, std::span<ActivePoint> points) {
    find_residual(points);
    const double at_start = largest_residual();
    std::array<Multipliers, max_nodes> before;
    double augmentation = 1;
    for (std::size_t j = 0; j < points.size(); ++j) {
        before[j] = points[j].multipliers;
        augmentation = std::max(augmentation, points[j].multipliers.rho_N / points[j].mass);
    }
    const double goal = fan_goal * tolerance;
    bool found = false;
    for (int step = 0, update = 0; !found && step < max_steps_of_fan && update < max_updates_of_fan;
         find_residual(points)) {
        if (largest_residual() <= goal) {
            found = update_multipliers(points) <= goal * augmentation;
            ++update;
            continue;
        }
        if (!find_direction(points, Softening::now) && !find_direction(points, Softening::none)) break;
        move_ += step_length(points) * step_;
        ++step;
    }
    if (largest_residual() <= at_start) return true;
    for (std::size_t j = 0; j < points.size(); ++j) points[j].multipliers = before[j];
    return false;
}

/// The largest change [N s].
double FanSweep::update_multipliers(std::span<ActivePoint> points) const {
    double change = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
        Multipliers& at = points[j].multipliers;
        const PointResponse& q = response_[j];
        const double held = q.held(points[j].law);
        change = std::max({change, std::abs(held - at.contact), std::abs(q.tangential - at.tangential)});
        at.contact = held, at.tangential = q.tangential;
    }
    return change;
}

/// The fan to its solution; the impulses and residuals of all nodes of its triangles follow.
void FanSweep::move(std::span<ActivePoint> points, std::vector<Vec2>& rate, std::vector<Vec2>& impulse,
                    std::vector<Vec2>& residual) const {
    for (std::size_t j = 0; j < points.size(); ++j) {
        ActivePoint& point = points[j];
        point.sides.add_force(impulse_of(point, point.response) - impulse_of(point, response_[j]), residual);
        point.rate += turn(point, move_);
        point.response = response_[j];
    }
    for (int i = 0; i < n_nodes_; ++i) rate[node_[i]] += move_.segment<2>(2 * i);
    const std::vector<Index>& node_of_corner = matrix_.nodes().node_of_corner;
    const Index n = model_.mesh.corners_per_triangle();
    for (Index c = fan_->first_corner; c < fan_->first_corner + fan_->n_corners; ++c) {
        const Index corner = model_.fan_corners[c], first = n * model_.mesh.triangle_of(corner);
        const Vec2 d = move_.segment<2>(2 * place(node_of_corner[corner]));
        for (Index i = 0; i < n; ++i) {
            const Vec2 change = columns(c).middleRows<2>(2 * i) * d;
            impulse[node_of_corner[first + i]] += change;
            residual[node_of_corner[first + i]] += change;
        }
    }
}

void FanSweep::sweep(double tolerance, std::vector<ActivePoint>& points, std::vector<Vec2>& rate,
                     std::vector<Vec2>& impulse, std::vector<Vec2>& residual) {
    if (!has_columns_) find_columns(points);
    for (std::size_t first = 0, end; first < points.size(); first = end) {
        end = end_of_fan(points, first);
        const std::span<ActivePoint> of_fan = std::span(points).subspan(first, end - first);
        if (of_fan[0].fan < 0) continue;
        fan_ = &model_.fans[of_fan[0].fan];
        if (is_balanced(tolerance, residual) || !load(of_fan, impulse)) continue;
        if (solve(tolerance, of_fan)) move(of_fan, rate, impulse, residual);
    }
}

}  // namespace knap
