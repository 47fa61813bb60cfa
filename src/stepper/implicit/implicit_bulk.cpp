#include "stepper/implicit/implicit_bulk.hpp"

#include "base/parallel.hpp"
#include "base/reserve_capacity.hpp"
#include "stepper/common/mean_motions.hpp"
#include "stepper/common/point_work.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

namespace knap {
namespace {

constexpr double rounds_off = std::numeric_limits<double>::epsilon();  // of the single terms of forces

}  // namespace

ElementMatrix theta_element(const Model& model, Index t, double stiffness_factor, MassMatrix mass, double mass_factor) {
    const Elastic material = model.elastic(t);
    const ElementMatrix& shares = mass_matrix(model.mesh.order, mass);
    ElementMatrix M_hat = stiffness_factor * stiffness_matrix(model.mesh, t, material, model.plane, model.thickness);
    const double m = mass_factor * model.triangle_mass(t);
    for (Index i = 0; i < shares.rows(); ++i)
        for (Index j = 0; j < shares.cols(); ++j)
            M_hat.block<2, 2>(2 * i, 2 * j).diagonal().array() += shares(i, j) * m;
    return M_hat;
}

void turn_blocks(const std::array<Rotation, 3>& turns, ElementMatrix& M_hat) {
    std::array<Eigen::Matrix2d, 3> R;
    for (int i = 0; i < 3; ++i) R[i] << turns[i].cosine, -turns[i].sine, turns[i].sine, turns[i].cosine;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            M_hat.block<2, 2>(2 * i, 2 * j) = (R[i] * M_hat.block<2, 2>(2 * i, 2 * j) * R[j].transpose()).eval();
}

void add_dashpots(const Model& model, Index triangle, std::span<const Dashpot> dashpots, double factor,
                  ElementMatrix& M_hat) {
    const Index n = model.mesh.corners_per_triangle(), first = n * triangle;
    for (auto at = std::ranges::lower_bound(dashpots, first, {}, &Dashpot::corner);
         at != dashpots.end() && at->corner < first + n; ++at)
        M_hat.block<2, 2>(2 * (at->corner - first), 2 * (at->corner - first)) += factor * at->C;
}

ImplicitBulk::ImplicitBulk(const Model& model, MassMatrix mass, double damping, const std::vector<Selection>& absorbing)
    : model_(model),
      mass_(mass),
      damping_(damping),
      dashpots_(dashpots_on(model, absorbing)),
      crack_forces_(model),
      forces_(model.mesh, model.materials, model.plane, model.thickness) {
    std::ranges::sort(dashpots_, {}, &Dashpot::corner);
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const ElementMatrix K = stiffness_matrix(model.mesh, t, model.elastic(t), model.plane, model.thickness);
        for (Index k = 0; k < n; ++k) {
            corner_stiffness_.push_back(0.5 * (K(2 * k, 2 * k) + K(2 * k + 1, 2 * k + 1)));
            largest_stiffness_ = std::max(largest_stiffness_, corner_stiffness_.back() * n / model.triangle_mass(t));
        }
    }
    if (model.heat) thermal_.emplace(model.mesh, model.materials, model.plane, model.thickness);
    if (model.large_rotation) {
        turning_.reset(new Turning{.green = {model.mesh, model.materials, model.plane, model.thickness},
                                   .frames = {model, dashpots_}});
        turning_->own_node.resize(model.mesh.n_corners());
        std::iota(turning_->own_node.begin(), turning_->own_node.end(), 0);
    }
    load_.resize(model.mesh.n_corners());
    begin_force_.resize(model.mesh.n_corners());
    reserve_capacity(model.mesh.n_corners(), velocity_, prescribed_end_);
    reserve_capacity(model.histories.size(), amplitude_);
}

double ImplicitBulk::corner_inertia(Index corner) const {
    const Index k = model_.mesh.place_in_triangle(corner);
    const double mass = mass_ == MassMatrix::lumped ? model_.corner_mass[corner]
                                                    : mass_matrix(model_.mesh.order, mass_)(k, k) *
                                                          model_.triangle_mass(model_.mesh.triangle_of(corner));
    return mass_factor() * mass + step_->stiffness_factor() * corner_stiffness_[corner];
}

double ImplicitBulk::elastic_impulse(Index corner, double speed) const {
    return 1e-2 * (speed * step_->stiffness_factor() * corner_stiffness_[corner]);
}

double ImplicitBulk::largest_elastic_impulse(const std::vector<Vec2>& rate) const {
    double largest = 0;
    for (Index c = 0; c < model_.mesh.n_corners(); ++c)
        largest = std::max(largest, elastic_impulse(c, rate[nodes_->node_of_corner[c]].norm()));
    return std::isfinite(largest) ? largest : 0;  // rates that overflow meet no tolerance
}

void ImplicitBulk::begin_step(const StepContext& step) {
    step_ = &step;
    const State& begin = *step.begin;
    amplitude_.clear();
    for (const TimeFunction& history : model_.histories)
        amplitude_.push_back(history.over_step(begin.time, begin.time + step.h, step.theta));
    if (!model_.state_forces.empty() && !turning_) {
        predicted_ = begin;
        predicted_.time += step.kick();
        for (std::size_t i = 0; i < begin.velocity.size(); ++i)
            predicted_.displacement[i] += step.kick() * begin.velocity[i];
    }
    if (has_injected_fluids()) begin_fluids();
    find_loads(model_.state_forces.empty() || turning_ ? begin : predicted_);
    if (turning_) begin_turning();
    else elastic_force(begin.displacement, begin.node_of_corner, begin_force_);
    begin_impulse_ = 0;
    if (thermal_ && !turning_) {
        for (const Vec2& f : begin_force_)
            begin_impulse_ = std::max(begin_impulse_, step.kick() * f.norm());  // of D eps
        thermal_->add_forces(begin.temperature->strain, 1 - step.theta, begin_force_);
        thermal_->add_forces(step.end_temperature->strain, step.theta, begin_force_);
    }
    // largest terms of the balance: a difference below their rounding has no meaning; D eps and the thermal strain,
    // which cancel in a body that expands freely, are two terms
    double force2 = 0;  // [N^2] the largest
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
        const double speed = begin.velocity[begin.node_of_corner[c]].norm();
        begin_impulse_ =
            std::max({begin_impulse_, mass_factor() * model_.corner_mass[c] * speed, elastic_impulse(c, speed)});
        force2 = std::max({force2, begin_force_[c].squaredNorm(), load_[c].squaredNorm()});
        begin_force_[c] += load_[c];
    }
    begin_impulse_ = std::max(begin_impulse_, step.kick() * std::sqrt(force2));
    balance_scale_ = begin_impulse_;
}

/// Those that depend on the state in this one.
void ImplicitBulk::find_loads(const State& of_forces) {
    std::ranges::fill(load_, Vec2::Zero());
    released_.clear();
    for (const CornerLoad& load : model_.corner_loads) {
        load_[load.corner] += amplitude_[load.history] * force_of(model_, load, of_forces);
        if (load.is_release)
            released_.push_back({.corner = load.corner, .force = amplitude_[load.history] * load.force});
    }
    of_fluids_ = &of_forces;
    for (const CornerLoad& load : find_crack_forces()) load_[load.corner] += amplitude_[load.history] * load.force;
}

/// Formulas are those of t + theta h.
const std::vector<CornerLoad>& ImplicitBulk::find_crack_forces() {
    return crack_forces_.find(*of_fluids_, step_->begin->time + step_->kick(),
                              fluid_pressure_.empty() ? nullptr : &fluid_pressure_);
}

/// The first guess of the pressures is that of the last step.
void ImplicitBulk::begin_fluids() {
    const State& begin = *step_->begin;
    fluid_pressure_ = begin.fluid_pressure;
    fluid_volume_.clear();
    crack_forces_.find(begin);
    if (fluid_pressure_.empty()) fluid_pressure_ = crack_forces_.injected_pressures();
    for (std::size_t f = 0; f < model_.crack_fluids.size(); ++f)
        fluid_volume_.push_back(crack_forces_.volume(f, begin));
}

void ImplicitBulk::set_fluid_pressure(std::size_t fluid, double pressure) {
    fluid_pressure_[fluid] = pressure;
    const auto add = [&](const std::vector<CornerLoad>& loads, double sign) {
        for (const CornerLoad& load : loads) {
            const Vec2 force = sign * amplitude_[load.history] * load.force;
            load_[load.corner] += force, begin_force_[load.corner] += force;
            if (sign > 0) begin_impulse_ = std::max(begin_impulse_, step_->kick() * load_[load.corner].norm());
        }
    };
    const std::vector<CornerLoad> before = crack_forces_.found();
    add(before, -1);
    add(find_crack_forces(), 1);
    largest_impulse_ = std::max(largest_impulse_, begin_impulse_);
}

FluidStep ImplicitBulk::fluid_step(const std::vector<Vec2>& rate, const std::function<bool()>& solve) {
    return {.balance =
                [&, this](std::size_t fluid) {
                    const double change = crack_forces_.volume_rate(
                        fluid, *of_fluids_,
                        [&](Index corner) -> const Vec2& { return rate[nodes_->node_of_corner[corner]]; });
                    return crack_forces_.balance(fluid, fluid_volume_[fluid] + step_->h * change,
                                                 step_->begin->time + step_->h);
                },
            .compliance = [this](std::size_t fluid) { return fluid_compliance(fluid); },
            .solve_with =
                [solve, this](std::size_t fluid, double pressure) {
                    set_fluid_pressure(fluid, pressure);
                    return solve();
                }};
}

/// pi a^2/(2 E') per thickness, of a crack of length a in a wide body.
double ImplicitBulk::fluid_compliance(std::size_t fluid) const {
    double stiffest = 0;
    for (const Elastic& material : model_.materials) stiffest = std::max(stiffest, material.E);
    const double length = crack_forces_.length(fluid, *of_fluids_);
    return crack_forces_.storage(fluid) + 0.5 * std::numbers::pi * length * length / stiffest * model_.thickness;
}

GreenStep::Motion ImplicitBulk::motion() const {
    GreenStep::Motion motion{
        .displacement = turning_->begin, .change = turning_->change, .thermal_strain = {}, .thermal_change = {}};
    motion.theta = step_->theta;
    if (thermal_)
        motion.thermal_strain = step_->begin->temperature->strain, motion.thermal_change = turning_->thermal_change;
    return motion;
}

/// Forces at the start of the step.
void ImplicitBulk::begin_turning() {
    const State& begin = *step_->begin;
    Turning& turning = *turning_;
    turning.begin.clear();
    for (const Index node : begin.node_of_corner) turning.begin.push_back(Vec2(begin.displacement[node]));
    turning.change.assign(turning.begin.size(), Vec2::Zero());
    if (thermal_) {
        const std::vector<double>&before = begin.temperature->strain, &after = step_->end_temperature->strain;
        turning.thermal_change.resize(after.size());
        std::ranges::transform(after, before, turning.thermal_change.begin(), std::minus());
    }
    turning.frames.begin(begin, turning.green, motion());
    begin_force_.resize(turning.begin.size());
    green_force(begin_force_);
}

void ImplicitBulk::green_force(std::vector<Vec2>& of_corner) const {
    const GreenStep::Motion at = motion();
    for_triangles([&](Index first, Index last) {
        for (Index t = first; t < last; ++t) turning_->green.find_forces(t, at, &of_corner[3 * t]);
    });
}

/// Adds -theta h A K A' (w - w_0), with w per corner.
void ImplicitBulk::add_turned_stiffness(const std::vector<Vec2>& rate, std::vector<Vec2>& force) const {
    Turning& turning = *turning_;
    turning.turned.resize(rate.size());
    for (std::size_t c = 0; c < rate.size(); ++c)
        turning.turned[c] =
            turning.frames.of_triangle(static_cast<Index>(c) / 3).turned_back(rate[c] - turning.rate[c]);
    elastic_force(turning.turned, turning.own_node, turning.force);
    for (std::size_t c = 0; c < rate.size(); ++c)
        force[c] += step_->kick() * turning.frames.of_triangle(static_cast<Index>(c) / 3).turned(turning.force[c]);
}

void ImplicitBulk::turn_rates(std::vector<Vec2>& corner_rate) const {
    const PieceFrames& frames = turning_->frames;
    const auto at = [&](Index c) -> Vec2 { return model_.mesh.corner(c) + turning_->begin[c]; };
    std::vector<Vec2> near(frames.n_pieces());
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) near[frames.piece_of(c / 3)] = at(c);
    const MeanMotions mean = mean_motions(near, [&](const auto& visit) {
        for (Index c = 0; c < model_.mesh.n_corners(); ++c)
            visit(frames.piece_of(c / 3), model_.corner_mass[c], at(c), corner_rate[c]);
    });
    // velocities belong to the start of the step, rates to the middle of the last one
    const State& begin = *step_->begin;
    const double between = 0.5 * (step_->h + (begin.has_end_velocities() ? begin.last_step : 0));
    std::vector<Rotation> turns;
    for (const double spin : mean.spin)
        turns.push_back(std::abs(between * spin) <= PieceFrames::largest_turn ? Rotation::by(between * spin)
                                                                              : Rotation{});
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
        const Index p = frames.piece_of(c / 3);
        corner_rate[c] = mean.velocity[p] + turns[p].turned(corner_rate[c] - mean.velocity[p]);
    }
}

void ImplicitBulk::linearise(const std::vector<Vec2>& corner_rate) {
    Turning& turning = *turning_;
    turning.rate = corner_rate;
    for (std::size_t c = 0; c < corner_rate.size(); ++c) turning.change[c] = step_->h * corner_rate[c];
    rounding_ = 0;
    for (std::size_t c = 0; c < corner_rate.size(); ++c)
        rounding_ = std::max(rounding_, corner_stiffness_[c] * turning.change[c].norm());
    rounding_ *= rounds_off * step_->kick();
    turning.frames.find(turning.green, motion());
    if (!model_.state_forces.empty() || !crack_forces_.empty()) {  // in the middle of the step
        State& middle = predicted_;
        middle = *step_->begin;
        middle.time += step_->kick();
        middle.node_of_corner = turning.own_node;
        middle.displacement = turning.begin, middle.velocity = corner_rate;
        for (std::size_t c = 0; c < corner_rate.size(); ++c) middle.displacement[c] += 0.5 * turning.change[c];
        find_loads(middle);
    }
    green_force(begin_force_);
    for (std::size_t c = 0; c < load_.size(); ++c) begin_force_[c] += load_[c];
}

void ImplicitBulk::set_nodes(const CornerPartition& nodes, const std::vector<Vec2>& corner_rate,
                             std::vector<Vec2>& rate) {
    nodes_ = &nodes;
    const State& begin = *step_->begin;
    velocity_.clear();
    rate.clear();
    prescribed_end_.assign(nodes.n_nodes(), Vec2::Zero());
    largest_impulse_ = begin_impulse_;
    for (Index i = 0; i < nodes.n_nodes(); ++i) {
        const Index corner = nodes.corner_of_node[i], at = begin.node_of_corner[corner];
        velocity_.push_back(Vec2(begin.velocity[at]));
        rate.push_back(Vec2(corner_rate[corner]));
        Vec2 prescribed = Vec2::Zero();
        for (int k = 0; k < 2; ++k) {
            if (!nodes.prescribed[i][k]) continue;
            if (nodes.motion[i] >= 0) {
                const PrescribedRate given = model_.prescribed[nodes.motion[i]].rate(
                    k, model_.histories, begin.displacement[at][k], step_->times());
                prescribed[k] = given.rate;
                prescribed_end_[i][k] = given.end_velocity;
            }
            rate[i][k] = prescribed[k];
        }
        const double inertia =
            mass_factor() * model_.corner_mass[corner] + step_->stiffness_factor() * corner_stiffness_[corner];
        largest_impulse_ = std::max(largest_impulse_, prescribed.norm() * inertia);
    }
}

Vec2 ImplicitBulk::end_velocity(Index node, const Vec2& rate) const {
    Vec2 end = (rate - (1 - step_->theta) * velocity_[node]) / step_->theta;
    for (int k = 0; k < 2; ++k)
        if (nodes_->prescribed[node][k]) end[k] = prescribed_end_[node][k];
    return end;
}

void ImplicitBulk::elastic_force(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                                 std::vector<Vec2>& of_corner) const {
    std::vector<std::uint8_t> no_criterion;
    of_corner.resize(model_.mesh.n_corners());
    forces_.evaluate(displacement, node_of_corner, of_corner, no_criterion);
}

/// work(first, last) for blocks of triangles, in parallel.
template <class Work>
void ImplicitBulk::for_triangles(const Work& work) const {
    constexpr Index block = 1024;
    const Index n = model_.mesh.n_triangles();
    for_blocks((n + block - 1) / block, [&](std::ptrdiff_t i) {
        const Index first = static_cast<Index>(i) * block;
        work(first, std::min(n, first + block));
    });
}

template <class Velocity>
void ImplicitBulk::add_mass_times(const Velocity& of_corner, std::vector<Vec2>& sum) const {
    const Index n = model_.mesh.corners_per_triangle();
    const ElementMatrix& shares = mass_matrix(model_.mesh.order, mass_);
    for_triangles([&](Index first, Index last) {
        if (mass_ == MassMatrix::lumped) {
            for (Index c = n * first; c < n * last; ++c) sum[c] += model_.corner_mass[c] * of_corner(c);
            return;
        }
        for (Index t = first; t < last; ++t) {
            const double m = model_.triangle_mass(t);
            for (Index j = 0; j < n; ++j) {
                const Vec2 a = of_corner(n * t + j);
                for (Index i = 0; i < n; ++i) sum[n * t + i] += shares(i, j) * m * a;
            }
        }
    });
}

void ImplicitBulk::impulse(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const {
    // K u and K w apart: digits that cancel in K u of a body far from its origin must not blur the equation of w
    const double theta_h = step_->kick();
    if (turning_) {
        std::vector<Vec2>& corner_rate = turning_->corner_rate;
        corner_rate.clear();
        for (const Index node : nodes_->node_of_corner) corner_rate.push_back(Vec2(rate[node]));
        of_corner = begin_force_;
        add_turned_stiffness(corner_rate, of_corner);
        for (Vec2& r : of_corner) r *= -theta_h;
    } else {
        elastic_force(rate, nodes_->node_of_corner, of_corner);
        const Index n = model_.mesh.corners_per_triangle();
        for_triangles([&](Index first, Index last) {
            for (Index c = n * first; c < n * last; ++c)
                of_corner[c] = -theta_h * (begin_force_[c] + theta_h * of_corner[c]);
        });
    }
    add_change_of_momentum(rate, of_corner);
    add_damping(rate, of_corner);
}

/// [N s] theta h (alpha M (w - W) + C w)
void ImplicitBulk::add_damping(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const {
    const Index* node = nodes_->node_of_corner.data();
    if (const double d = step_->kick() * damping_; d > 0)
        add_mass_times(
            [&](Index c) -> Vec2 {
                return carried_ ? Vec2(d * (rate[node[c]] - (*carried_)[c])) : Vec2(d * rate[node[c]]);
            },
            of_corner);
    for (const Dashpot& dashpot : dashpots_)
        of_corner[dashpot.corner] += step_->kick() * dashpot.C * rate[node[dashpot.corner]];
}

/// [m/s] theta (v+ - v)
Vec2 ImplicitBulk::change_of_velocity(Index node, const Vec2& rate) const {
    if (!nodes_->prescribed[node][0] && !nodes_->prescribed[node][1]) return rate - velocity_[node];
    return step_->theta * (end_velocity(node, rate) - velocity_[node]);
}

/// [N s] theta M (v+ - v)
void ImplicitBulk::add_change_of_momentum(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const {
    const Index* node = nodes_->node_of_corner.data();
    add_mass_times([&](Index c) { return change_of_velocity(node[c], rate[node[c]]); }, of_corner);
}

void ImplicitBulk::momentum(const std::vector<Vec2>& velocity, std::vector<Vec2>& of_corner) const {
    of_corner.assign(model_.mesh.n_corners(), Vec2::Zero());
    add_mass_times([&](Index c) -> const Vec2& { return velocity[c]; }, of_corner);
}

void ImplicitBulk::momentum_of_nodes(const std::vector<Vec2>& velocity, std::vector<Vec2>& sum) const {
    std::vector<Vec2> of_corner(model_.mesh.n_corners(), Vec2::Zero());
    add_mass_times([&](Index c) -> const Vec2& { return velocity[nodes_->node_of_corner[c]]; }, of_corner);
    for (std::size_t c = 0; c < of_corner.size(); ++c) sum[nodes_->node_of_corner[c]] += of_corner[c];
}

void ImplicitBulk::external_impulse(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const {
    of_corner.clear();
    for (const Vec2& force : load_) of_corner.push_back(-step_->kick() * force);
    add_change_of_momentum(rate, of_corner);
    add_damping(rate, of_corner);
}

void ImplicitBulk::sum_to_nodes(const std::vector<Vec2>& of_corner, std::vector<Vec2>& of_node) const {
    of_node.assign(nodes_->n_nodes(), Vec2::Zero());
    for (std::size_t c = 0; c < of_corner.size(); ++c) of_node[nodes_->node_of_corner[c]] += of_corner[c];
}

/// At the rates of the nodes.
void ImplicitBulk::account_green_strains(const std::vector<Vec2>& rate, StepReport& report) const {
    for (std::size_t c = 0; c < turning_->change.size(); ++c)
        turning_->change[c] = step_->h * rate[nodes_->node_of_corner[c]];
    const GreenStep::Motion at = motion();
    GreenStep::Energies sum;
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) sum += turning_->green.energies(t, at);
    report.strain += sum.end, report.scheme_dissipation += sum.dissipated, report.thermal_work += sum.thermal;
}

void ImplicitBulk::account(const std::vector<Vec2>& rate, const std::vector<Vec2>& reaction, Workspace& work,
                           StepReport& report) const {
    const State& begin = *step_->begin;
    const double theta = step_->theta, h = step_->h;
    const Index n = nodes_->n_nodes();
    std::vector<Vec2>&of_corner = work.of_corner, &of_node = work.of_node;
    work.end_velocity.resize(n);
    for (Index i = 0; i < n; ++i) work.end_velocity[i] = end_velocity(i, rate[i]);
    const auto end = [&](Index i) -> const Vec2& { return work.end_velocity[i]; };
    const auto change = [&](Index i) -> Vec2 { return end(i) - velocity_[i]; };
    const auto momentum = [&](const auto& velocity) {  // of_corner = M velocity
        of_corner.assign(model_.mesh.n_corners(), Vec2::Zero());
        add_mass_times([&](Index c) -> Vec2 { return velocity(nodes_->node_of_corner[c]); }, of_corner);
    };
    const auto half_product = [&](const auto& value) {  // 1/2 of_corner . value
        double sum = 0;
        for (std::size_t c = 0; c < of_corner.size(); ++c)
            sum += 0.5 * of_corner[c].dot(value(nodes_->node_of_corner[c]));
        return sum;
    };
    // 1/2 int (eps - e) : D : (eps - e) of the displacements in of_node
    const auto elastic_energy = [&](const std::vector<double>* strain) {
        elastic_force(of_node, nodes_->node_of_corner, of_corner);
        if (strain) thermal_->add_forces(*strain, 1, of_corner);
        const double energy = -half_product([&](Index i) -> const Vec2& { return of_node[i]; });
        return strain ? energy - 0.5 * thermal_->product(of_node, nodes_->node_of_corner, *strain, *strain) : energy;
    };

    momentum(end);
    report.kinetic += half_product(end);
    of_node.resize(n);
    for (Index i = 0; i < n; ++i) {
        of_node[i] = begin.displacement[begin.node_of_corner[nodes_->corner_of_node[i]]] + h * rate[i];
        report.largest_speed = std::max(report.largest_speed, end(i).norm());
    }
    const auto account_small_strains = [&] {
        report.strain += elastic_energy(thermal_ ? &step_->end_temperature->strain : nullptr);
        const bool heats = thermal_ && step_->end_temperature != begin.temperature;
        std::vector<double> growth;  // e+ - e
        if (heats) {
            const std::vector<double>&before = begin.temperature->strain, &after = step_->end_temperature->strain;
            growth.resize(after.size());
            std::ranges::transform(after, before, growth.begin(), std::minus());
            report.thermal_work -=
                theta * thermal_->product(of_node, nodes_->node_of_corner, after, growth) +
                (1 - theta) * thermal_->product(begin.displacement, begin.node_of_corner, before, growth);
        }
        if (theta > 0.5) {  // scheme dissipation: (theta - 1/2) (|v+ - v|_M^2 + |h w|_K^2)
            for (Index i = 0; i < n; ++i) of_node[i] = h * rate[i];
            report.scheme_dissipation += 2 * (theta - 0.5) * elastic_energy(heats ? &growth : nullptr);
        }
    };
    if (turning_) account_green_strains(rate, report);
    else account_small_strains();
    if (damping_ > 0) {
        of_corner.assign(model_.mesh.n_corners(), Vec2::Zero());
        add_damping(rate, of_corner);
        double work = 0;  // of damping and dashpots
        for (std::size_t c = 0; c < of_corner.size(); ++c)
            work -= of_corner[c].dot(rate[nodes_->node_of_corner[c]]) / theta;
        report.damping_work += work;
    }
    for (const Dashpot& dashpot : dashpots_) {
        const Vec2& w = rate[nodes_->node_of_corner[dashpot.corner]];
        const double work = -h * w.dot(dashpot.C * w);
        report.radiated_work += work;
        if (damping_ > 0) report.damping_work -= work;
    }
    momentum(change);
    if (theta > 0.5) report.scheme_dissipation += 2 * (theta - 0.5) * half_product(change);

    for (std::size_t c = 0; c < load_.size(); ++c)
        report.external_work += h * load_[c].dot(rate[nodes_->node_of_corner[c]]);
    for (const CornerLoad& load : released_) {
        const double work = h * load.force.dot(rate[nodes_->node_of_corner[load.corner]]);
        report.external_work -= work, report.excavation_work += work;
    }
    // a prescribed motion works with its reaction, and on the mass where its v+ is not that of the theta scheme
    sum_to_nodes(of_corner, of_node);
    for (Index i = 0; i < n; ++i)
        for (int k = 0; k < 2; ++k) {
            if (!nodes_->prescribed[i][k]) continue;
            const double deviation = rate[i][k] - 0.5 * (end(i)[k] + velocity_[i][k]) - (theta - 0.5) * change(i)[k];
            account_drive(reaction[i][k] / theta, rate[i][k], report, -deviation * of_node[i][k]);
        }
}

}  // namespace knap
