#include "stepper/implicit/step_lcp.hpp"

#include "base/tolerance.hpp"
#include "lcp/solvers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

/// [-] Part of |d . u| in the equivalent opening.
struct SlipTerm {
    Vec2 d;
    double weight;
};

const double side_of_polygon = std::sqrt(2.0) - 1;  // [-] half a side of the octagon round a circle of radius 1

/// [-] Part of u_N in the equivalent opening.
double normal_weight(const CohesiveLaw& law) { return law.coupling == Coupling::norm ? side_of_polygon : 1; }

std::vector<SlipTerm> slip_terms(const CohesiveLaw& law) {
    const double gamma = law.gamma, part = side_of_polygon, inclined = part / std::sqrt(2.0);
    if (law.coupling == Coupling::sum) return {{{0, 1}, gamma}};
    return {{{0, 1}, part * gamma}, {{1, gamma}, inclined}, {{1, -gamma}, inclined}};
}

}  // namespace

StepLcp::StepLcp(const Model& model, const State& begin, double h, const SchemeOptions& options,
                 SharedTemperatures end_temperature)
    : model_(model),
      step_{{.h = h, .theta = options.theta, .implicit_beta = options.cohesion == CohesionScheme::implicit_beta},
            &begin,
            end_temperature ? end_temperature : begin.temperature},
      bulk_(model, options.mass, options.damping, options.absorbing) {
    partition_corners(model, std::vector<std::uint8_t>(model.fans.size(), 1), nodes_);
    bulk_.begin_step(step_);
    factorise(options.mass);
    make_points();
    lay_out();

    const int n = size_, n_jumps = 2 * model.n_points();
    constant_ = Eigen::VectorXd::Zero(n);
    known_impulse_ = Eigen::VectorXd::Zero(n_jumps);
    add_cohesion();
    add_ramps();
    add_contacts();
    if (tangential_) add_tangential_cohesion();
    if (compression_ < size_) add_compressions();

    // rows = rows_of_rate (H w_free + theta W P) + coupling z + constant
    const auto matrix = [](Eigen::Index rows, Eigen::Index columns, const Triplets& entries) {
        LcpMatrix made(rows, columns);
        made.setFromTriplets(entries.begin(), entries.end());
        return made;
    };
    Eigen::VectorXd free_jump(n_jumps);
    for (Index p = 0; p < model.n_points(); ++p) free_jump.segment<2>(2 * p) = points_[p].across(free_rate_);
    const LcpMatrix rows_of_rate = matrix(n, n_jumps, rows_of_rate_);
    impulse_of_z_ = matrix(n_jumps, n, impulse_of_unknown_);
    Matrix W(n_jumps, n_jumps);
    if (H_.cols() > 0) W = H_ * Matrix(M_hat_.solve(Matrix(H_.transpose())));
    const LcpMatrix symmetric_W = 0.5 * (W + Matrix(W.transpose())),
                    of_impulse = step_.theta * rows_of_rate * symmetric_W;
    problem_.M = matrix(n, n, coupling_) + LcpMatrix(of_impulse * impulse_of_z_);
    problem_.q = constant_ + rows_of_rate * free_jump + of_impulse * known_impulse_;
    scale_pressures();
    problem_.M.makeCompressed();
}

bool StepLcp::fits(const Model& model, const SchemeOptions& options) {
    return !has_norm(model) && fits_by_polygon(model, options);
}

bool StepLcp::fits_by_polygon(const Model& model, const SchemeOptions& options) {
    if (model.large_rotation) return false;                                               // its forces are not linear
    if (options.damping > 0 && options.damping_of == DampingOf::vibration) return false;  // W follows from the solution
    if (has_incubation(model)) return false;
    const bool is_explicit = options.cohesion == CohesionScheme::explicit_beta;
    return std::ranges::all_of(model.laws, [&](const CohesiveLaw& law) {
        return law.unloading == Unloading::constant
                   ? is_explicit || !law.has_mode_mix()
                   : is_explicit && law.unloading == Unloading::secant && law.coupling == Coupling::sum;
    });
}

void StepLcp::factorise(MassMatrix mass) {
    for (const std::array<bool, 2>& prescribed : nodes_.prescribed)
        for (const bool known : prescribed) unknown_.push_back(known ? -1 : n_unknowns_++);
    const Index n = model_.mesh.corners_per_triangle();
    Triplets entries;
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        ElementMatrix M_hat = theta_element(model_, t, step_.stiffness_factor(), mass, bulk_.mass_factor());
        add_dashpots(model_, t, bulk_.dashpots(), step_.kick(), M_hat);
        const auto unknown = [&](Index i) { return unknown_[2 * nodes_.node_of_corner[n * t + i / 2] + i % 2]; };
        for (Index i = 0; i < 2 * n; ++i)
            for (Index j = 0; j < 2 * n; ++j)
                if (unknown(i) >= 0 && unknown(j) >= 0) entries.emplace_back(unknown(i), unknown(j), M_hat(i, j));
    }
    Matrix M_hat(n_unknowns_, n_unknowns_);
    M_hat.setFromTriplets(entries.begin(), entries.end());
    if (n_unknowns_ > 0) M_hat_.compute(M_hat);

    // w_free = w_0 - M_hat^-1 r(w_0) with the prescribed rates in w_0
    std::vector<Vec2> of_corner, of_node;
    bulk_.set_nodes(nodes_, std::vector<Vec2>(model_.mesh.n_corners(), Vec2::Zero()), free_rate_);
    bulk_.impulse(free_rate_, of_corner);
    bulk_.sum_to_nodes(of_corner, of_node);
    Eigen::VectorXd impulse(n_unknowns_);
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) impulse[unknown_[i]] = -of_node[i / 2][i % 2];
    free_rate_ = rate(impulse);
}

/// [m/s] w_free + M_hat^-1 impulse
std::vector<Vec2> StepLcp::rate(const Eigen::VectorXd& impulse) const {
    std::vector<Vec2> rate = free_rate_;
    if (impulse.size() == 0) return rate;
    const Eigen::VectorXd change = M_hat_.solve(impulse);
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) rate[i / 2][i % 2] += change[unknown_[i]];
    return rate;
}

void StepLcp::make_points() {
    points_.resize(model_.n_points());
    Triplets entries;
    for (std::size_t f = 0; f < model_.fans.size(); ++f)
        for (Index j = 0; j < model_.fans[f].n_points; ++j) {
            const Index i = model_.fans[f].first_point + j, p = model_.fan_points[i].point;
            points_[p] = interface_point(model_, step_, nodes_, static_cast<Index>(f), i);
            if (unbreakable(model_, model_.fan_points[i])) continue;
            const Vec2 axis[2] = {points_[p].normal, turned_left(points_[p].normal)};
            points_[p].sides.for_each_node([&](Index node, const auto& weight) {
                for (int d = 0; d < 2; ++d)
                    for (int k = 0; k < 2; ++k)
                        if (const Index u = unknown_[2 * node + k]; u >= 0)
                            entries.emplace_back(2 * p + d, u, Vec2(transposed(weight) * axis[d])[k]);
            });
        }
    H_.resize(2 * model_.n_points(), n_unknowns_);
    H_.setFromTriplets(entries.begin(), entries.end());
}

void StepLcp::lay_out() {
    for (const FanPoint& at : model_.fan_points) {
        const CohesiveLaw& law = law_of(model_, *step_.begin, at);
        if (unbreakable(model_, at)) continue;
        friction_ = friction_ || law.friction > 0;
        tangential_ = tangential_ || (!at.cracked && law.sigma_c > 0 && law.gamma > 0);
    }
    for (Index p = 0; p < model_.n_points(); ++p) {
        const PointLaw& law = points_[p].law;
        if (unbreakable(model_, model_.fan_points[points_[p].sides.fan_point])) continue;
        if (law.contact.may_touch) contacts_.push_back(p);
        for (int line = 1; law.contact.may_touch && law.pressed && line < law.pressed.law->n_lines(); ++line)
            bends_.push_back({static_cast<int>(contacts_.size()) - 1, line});
        if (law.cohesion == 0) continue;
        cohesive_.push_back(p);
        if (step_.implicit_beta) add_layers(law);
        if (law.ramp > 0) ramps_.push_back(static_cast<int>(cohesive_.size()) - 1);
        const double end_at_bound = law.u_N + reach(law) * law.contact.rate;
        const bool lands = !law.contact.may_touch || end_at_bound < -relative_tolerance * law.material->delta_c();
        if ((step_.implicit_beta || law.ramp > 0) && lands) landing_.push_back(p);
    }
    const auto group = [&](std::size_t n) { return std::exchange(size_, size_ + static_cast<int>(n)); };
    const std::size_t m = cohesive_.size(), c = contacts_.size();
    n_terms_ = has_norm(model_) ? 3 : 1;
    loss_ = group(layers_.size());
    beta_ = group(layers_.size());
    normal_ = group(c);
    slip_ = group(friction_ ? 2 * c : 0);
    slip_rate_ = group(friction_ ? c : 0);
    tangent_ = group(tangential_ ? 2 * n_terms_ * m : 0);
    offset_ = group(tangential_ ? n_terms_ * m : 0);
    opening_ = group(landing_.size());
    pull_ = group(step_.implicit_beta ? 0 : landing_.size());
    ramp_ = group(ramps_.size());
    bend_ = group(bends_.size());
    compression_ = group(friction_ && n_terms_ > 1 ? c : 0);
}

/// [s] From the start of the step to where the cohesion looks at the opening.
double StepLcp::reach(const PointLaw& law) const { return law.ramp > 0 ? step_.theta * step_.h : step_.h; }

/// The layers of the last point of `cohesive_`.
void StepLcp::add_layers(const PointLaw& law) {
    const CohesiveLaw& material = *law.material;
    const int i = static_cast<int>(cohesive_.size()) - 1;
    // delayed softening: beta+ falls on the same intervals of s by the relaxed part, and what is left on the last piece
    const double part = material.relaxed_part(step_.h), delta = material.delta_c();
    if (!material.softening) {
        layers_.push_back({i, law.cohesion, (1 - part) / part * law.cohesion * delta + delta, delta / part});
        return;
    }
    double left = law.cohesion;
    const std::vector<Vec2>& knots = material.softening->knots();
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
        const double low = knots[k + 1].y(), start = part * (std::min(law.cohesion, knots[k].y()) - low);
        if (!(start > 0)) continue;
        const bool is_last = k + 2 == knots.size();
        const double more = is_last && part < 1 ? left - start : 0,
                     length = material.piece_length(static_cast<int>(k)) / part;
        layers_.push_back(
            {i, start + more, knots[k + 1].x() * material.G_c / material.sigma_c + more * length, length});
        left -= start;
    }
}

/// Two unknowns r+, r- >= 0 of a force (r+ - r-) along `factor`, with |r| <= the bound whose row is `bound`; rows: the
/// unknown of that row plus and minus (factor . w + constant).
void StepLcp::add_sign(int first, int bound, Index point, const Vec2& factor, double constant) {
    for (const int sign : {1, -1}) {
        const int row = first + (sign < 0);
        for (const int k : {0, 1})
            if (factor[k] != 0) {
                rows_of_rate_.emplace_back(row, 2 * point + k, sign * factor[k]);
                impulse_of_unknown_.emplace_back(2 * point + k, row, sign * factor[k]);
            }
        constant_[row] = sign * constant;
        coupling_.emplace_back(row, bound, 1);
        coupling_.emplace_back(bound, row, -1);
    }
}

void StepLcp::add_cohesion() {
    const double theta = step_.theta, h = step_.h;
    for (int i = 0; i < static_cast<int>(cohesive_.size()); ++i) {
        const Index p = cohesive_[i];
        const PointLaw& law = points_[p].law;
        const double S = model_.fan_points[points_[p].sides.fan_point].area,
                     strength = normal_weight(*law.material) * law.material->sigma_c;
        if (!step_.implicit_beta) {
            if (!lands(p)) known_impulse_[2 * p] = -h * S * strength * law.cohesion;
            continue;
        }
        known_impulse_[2 * p] = -h * strength * (1 - theta) * S * law.cohesion;
    }
    for (int k = 0; k < static_cast<int>(landing_.size()); ++k) {
        const Index p = landing_[k];
        const PointLaw& law = points_[p].law;
        if (law.ramp > 0) {  // the rest is in add_ramps
            const int opening = opening_ + k, pull = pull_ + k;
            coupling_.emplace_back(opening, pull, -1);
            coupling_.emplace_back(pull, opening, 1);
            rows_of_rate_.emplace_back(pull, 2 * p, -reach(law));
            constant_[pull] = -law.u_N;
            impulse_of_unknown_.emplace_back(2 * p, pull, -h * theta);
            continue;
        }
        const double S = model_.fan_points[points_[p].sides.fan_point].area,
                     stiffness = S * law.material->sigma_c / law.material->delta_c();  // [N/m]
        coupling_.emplace_back(opening_ + k, opening_ + k, stiffness);
        rows_of_rate_.emplace_back(opening_ + k, 2 * p, -stiffness * reach(law));
        constant_[opening_ + k] = -stiffness * law.u_N;
    }
    for (int l = 0; l < static_cast<int>(layers_.size()); ++l) {
        const Layer& layer = layers_[l];
        const Index p = cohesive_[layer.cohesive];
        const PointLaw& law = points_[p].law;
        const double S = model_.fan_points[points_[p].sides.fan_point].area, strength = law.material->sigma_c;
        const int loss = loss_ + l, beta = beta_ + l;
        coupling_.emplace_back(loss, beta, -theta / S);
        constant_[loss] = theta * layer.start;
        coupling_.emplace_back(beta, loss, theta / S);
        coupling_.emplace_back(beta, beta, theta * strength * layer.length / S);
        constant_[beta] = -theta * strength * layer.end;
        if (tangential_)
            for (int offset = offset_ + n_terms_ * layer.cohesive; const SlipTerm& term : slip_terms(*law.material))
                coupling_.emplace_back(beta, offset++, theta * strength * term.weight);
        const double along_N = normal_weight(*law.material) * strength;
        add_opening(beta, p, theta * along_N);
        impulse_of_unknown_.emplace_back(2 * p, beta, -h * along_N * theta);
    }
}

bool StepLcp::lands(Index point) const { return std::ranges::binary_search(landing_, point); }

/// factor max(u_N, 0) in a row.
void StepLcp::add_opening(int row, Index point, double factor) {
    if (lands(point)) {
        const auto landing = std::ranges::lower_bound(landing_, point) - landing_.begin();
        coupling_.emplace_back(row, opening_ + static_cast<int>(landing), factor);
        return;
    }
    rows_of_rate_.emplace_back(row, 2 * point, factor * reach(points_[point].law));
    constant_[row] += factor * points_[point].law.u_N;
}

void StepLcp::add_ramps() {
    for (int k = 0; k < static_cast<int>(ramps_.size()); ++k) {
        const Index p = cohesive_[ramps_[k]];
        const PointLaw& law = points_[p].law;
        const double S = model_.fan_points[points_[p].sides.fan_point].area,
                     strength = law.material->sigma_c * law.cohesion, traction = strength / step_.theta;
        const int row = ramp_ + k;
        coupling_.emplace_back(row, row, traction * law.ramp / S);
        constant_[row] = -traction * law.ramp;
        add_opening(row, p, traction);
        if (lands(p)) {
            const int opening = opening_ + static_cast<int>(std::ranges::lower_bound(landing_, p) - landing_.begin());
            constant_[opening] = traction * S;
            coupling_.emplace_back(opening, row, -traction);
        } else {
            impulse_of_unknown_.emplace_back(2 * p, row, step_.h * strength);
        }
        if (!tangential_) continue;
        coupling_.emplace_back(row, offset_ + ramps_[k], traction * law.material->gamma);
        coupling_.emplace_back(offset_ + ramps_[k], row, -traction * law.material->gamma);
    }
}

void StepLcp::add_contacts() {
    for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
        const Index p = contacts_[k];
        rows_of_rate_.emplace_back(normal_ + k, 2 * p, 1);
        constant_[normal_ + k] = -points_[p].law.contact.rate;
        impulse_of_unknown_.emplace_back(2 * p, normal_ + k, 1);
        if (!friction_) continue;
        coupling_.emplace_back(slip_rate_ + k, pressing(k), points_[p].law.rubbing_slope(0));
        add_sign(slip_ + 2 * k, slip_rate_ + k, p, {0, 1}, 0);
    }
    for (int b = 0; b < static_cast<int>(bends_.size()); ++b) {
        const auto& [k, line] = bends_[b];
        const PressedFriction& pressed = points_[contacts_[k]].law.pressed;
        coupling_.emplace_back(bend_ + b, bend_ + b, 1);
        coupling_.emplace_back(bend_ + b, pressing(k), -1);
        constant_[bend_ + b] = pressed.unit / step_.theta * pressed.law->start(line);
        coupling_.emplace_back(slip_rate_ + k, bend_ + b, pressed.line(line).slope - pressed.line(line - 1).slope);
    }
}

/// What presses the sides of a contact: its impulse, and with the norm the compression that is left of it.
int StepLcp::pressing(int contact) const { return (compression_ < size_ ? compression_ : normal_) + contact; }

/// r >= P_N, where all unknowns of P_N are known.
void StepLcp::add_compressions() {
    std::vector<int> contact_of(model_.n_points(), -1);
    for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
        contact_of[contacts_[k]] = k;
        coupling_.emplace_back(compression_ + k, compression_ + k, 1);
        constant_[compression_ + k] = -known_impulse_[2 * contacts_[k]];
    }
    for (const auto& entry : impulse_of_unknown_)
        if (const int k = contact_of[entry.row() / 2]; entry.row() % 2 == 0 && k >= 0)
            coupling_.emplace_back(compression_ + k, entry.col(), -entry.value());
}

/// Rows of pressures by the mobility of their contact: then they are velocities as the row of p_N, and of its size.
void StepLcp::scale_pressures() {
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(size_);
    const auto set = [&](int row, int contact) {
        const int normal = normal_ + contact;
        if (const double mobility = problem_.M.coeff(normal, normal); mobility > 0) scale[row] = mobility;
    };
    for (int b = 0; b < static_cast<int>(bends_.size()); ++b) set(bend_ + b, bends_[b].contact);
    for (int k = 0; compression_ + k < size_; ++k) set(compression_ + k, k);
    if ((scale.array() == 1).all()) return;
    problem_.M = LcpMatrix(scale.asDiagonal() * problem_.M);
    problem_.q = scale.cwiseProduct(problem_.q);
}

void StepLcp::add_tangential_cohesion() {
    for (int i = 0; i < static_cast<int>(cohesive_.size()); ++i) {
        const Index p = cohesive_[i];
        const PointLaw& law = points_[p].law;
        const double S = model_.fan_points[points_[p].sides.fan_point].area;
        for (int k = n_terms_ * i; const SlipTerm& term : slip_terms(*law.material)) {
            const double traction = term.weight * law.material->sigma_c / (law.ramp > 0 ? step_.theta : 1);
            constant_[offset_ + k] = traction * (step_.implicit_beta ? 1 - step_.theta : 1) * S * law.cohesion;
            add_sign(tangent_ + 2 * k, offset_ + k, p, reach(law) * term.d, term.d.dot(Vec2(law.u_N, law.u_T)));
            ++k;
        }
    }
    for (int l = 0; l < static_cast<int>(layers_.size()); ++l) {
        const int i = layers_[l].cohesive;
        const CohesiveLaw& law = *points_[cohesive_[i]].law.material;
        for (int offset = offset_ + n_terms_ * i; const SlipTerm& term : slip_terms(law))
            coupling_.emplace_back(offset++, beta_ + l, step_.theta * term.weight * law.sigma_c);
    }
}

StepLcpEnd StepLcp::end(const Eigen::VectorXd& z) const {
    const Eigen::VectorXd P = impulse_of_z_ * z + known_impulse_;
    const std::vector<Vec2> rate = this->rate(step_.theta * (H_.transpose() * P));
    StepLcpEnd end;
    for (const Index node : nodes_.node_of_corner) {
        end.rate.push_back(Vec2(rate[node]));
        end.velocity.push_back(bulk_.end_velocity(node, rate[node]));
    }
    for (Index p = 0; p < model_.n_points(); ++p) {
        const PointLaw& law = points_[p].law;
        const Vec2 u = Vec2(law.u_N, law.u_T) + step_.h * points_[p].across(rate);
        const bool breaks = !unbreakable(model_, model_.fan_points[points_[p].sides.fan_point]);
        end.opening.push_back(u);
        end.impulse.push_back(P.segment<2>(2 * p));
        end.cohesion.push_back(breaks ? law.material->next_cohesion(law.cohesion, u.x(), u.y(), step_.h) : 1);
    }
    end.contact.assign(model_.n_points(), 0);
    for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) end.contact[contacts_[k]] = z[normal_ + k];
    end.held = end.contact;
    for (const int ramp : ramps_) {
        const Index p = cohesive_[ramp];
        end.held[p] = end.impulse[p].x() + points_[p].law.strength * points_[p].law.cohesion / step_.theta;
    }
    for (const Layer& layer : layers_) end.cohesion[cohesive_[layer.cohesive]] = 0;
    for (int l = 0; l < static_cast<int>(layers_.size()); ++l) {
        const Index p = cohesive_[layers_[l].cohesive];
        end.cohesion[p] += z[beta_ + l] / model_.fan_points[points_[p].sides.fan_point].area;
    }
    return end;
}

std::optional<StepLcpEnd> StepLcp::solve() const {
    const LcpSolution found = solve_by_default(problem_, {.exhaustive = false});
    return found.status == LcpStatus::solved ? std::optional(end(found.z)) : std::nullopt;
}

}  // namespace knap
