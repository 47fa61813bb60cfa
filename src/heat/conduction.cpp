#include "heat/conduction.hpp"

#include "base/error.hpp"
#include "base/secant.hpp"
#include "element/shape_functions.hpp"
#include "element/triangle_matrices.hpp"
#include "heat/corner_pairs.hpp"
#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

namespace knap {
namespace {

constexpr double closed_conductivities = 50;  // h_0 of a closed point over k/l
constexpr double newton_tolerance = 1e-12;  // where heat bends: sum of the errors over all heat, to rounding if it can
constexpr int max_newton_steps = 60;

/// Heat [W] into the corners of a triangle, by conductances w of its pairs; unrolled: cracks make steps of heat short.
template <const auto& pairs, std::size_t n>
void conduct(const double* w, const double* T, double* into) {
    std::array<double, n> sum{};
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [a, b] = pairs[i];
        const double flow = w[i] * (T[b] - T[a]);
        sum[a] += flow, sum[b] -= flow;
    }
    std::ranges::copy(sum, into);
}

}  // namespace

Conduction::Conduction(const Model& model) : model_(model), exchanges_(model) {
    const Mesh& mesh = model.mesh;
    const Heat& heat = *model.heat;
    const auto pairs = corner_pairs(mesh.order);
    const Index n = mesh.corners_per_triangle();
    diagonal_.assign(mesh.n_corners(), 0);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Thermal& thermal = heat.materials[mesh.region[t]];
        bends_ = bends_ || !thermal.has_constant_capacity();
        conductivity_varies_ = conductivity_varies_ || thermal.conductivity_part.varies();
        const auto w = half_cotangents(mesh, t);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const double here = thermal.conductivity * model.thickness * w[i];
            conductance_.push_back(here);
            for (const Index k : pairs[i]) diagonal_[n * t + k] += std::abs(here);
        }
        for (Index k = 0; k < n; ++k)
            capacity_.push_back(thermal.heat_capacity * corner_share(mesh.order, k, model.material_mass(t)) /
                                heat.time_factor);
    }
    for (const auto& at : exchanges_.all()) diagonal_[at.corner] += at.conductance;
    into_.resize(mesh.n_corners());
    of_gaps_.resize(mesh.n_corners());
}

/// [W/(m2 K)] Between two corners on the sides of an edge of this length [m].
double Conduction::closed_conductance(Index a, Index b, double length) const {
    if (const double given = model_.heat->closed_conductance; given >= 0) return given;
    return closed_conductivities * std::min(thermal_of(a).conductivity, thermal_of(b).conductivity) / length;
}

double Conduction::conductance_of(const FanPoint& point, double u_N) const {
    const Heat& heat = *model_.heat;
    const double closed =
        closed_conductance(point.before, point.after, model_.interfaces[model_.interface_of(point.point)].length);
    if (u_N <= 0) return point.area * closed;
    if (closed == 0 || heat.gap_conductivity == 0) return 0;
    return point.area / (u_N / heat.gap_conductivity + 1 / closed);
}

/// Between the corners of split fans, at the openings of `begin`; not across supports.
void Conduction::find_gaps(const State& begin) {
    gaps_.clear();
    std::ranges::fill(of_gaps_, 0.0);
    for (std::size_t rank = 0; rank < begin.split_fans.size(); ++rank) {
        const auto points = model_.points(model_.fans[begin.split_fans[rank]]);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const FanPoint& point = points[i];
            if (point.on_support() || begin.has_retired(point.point)) continue;
            if (is_intact(begin, static_cast<Index>(rank), i)) continue;  // one node
            const double conductance =
                conductance_of(point, begin.opening_of(point, point_frame(model_, begin, point)).x());
            gaps_.push_back({point.before, point.after, conductance});
            of_gaps_[point.before] += conductance, of_gaps_[point.after] += conductance;
        }
    }
    find_pressed_faces(begin);
}

/// Free faces that press on each other, where they cover each other: edges that meet at a contact, turned against each
/// other, each pair once. What flows over the common length is spread on the ends of both edges.
void Conduction::find_pressed_faces(const State& begin) {
    const Mesh& mesh = model_.mesh;
    const auto place = [&](Index corner) -> Vec2 { return mesh.corner(corner) + begin.displacement_of(corner); };
    std::set<std::pair<Index, Index>> pairs;
    for (const FaceContactState& at : begin.face_contacts) {
        if (at.contact <= 0) continue;
        const std::array corners{at.vertex, at.edge, at.entering};
        if (std::ranges::any_of(corners, [&](Index c) { return model_.ground_at(c) != nullptr; })) continue;
        for (const Index face : {at.vertex, previous_in_triangle(at.entering)})
            pairs.insert(std::minmax(face, at.edge));
    }
    for (const auto& [one, other] : pairs) {
        const std::array<Index, 4> corner{one, next_in_triangle(one), other, next_in_triangle(other)};
        const Vec2 a = place(corner[0]), along = place(corner[1]) - a;
        const double length = along.norm(), undeformed = (mesh.corner(corner[1]) - mesh.corner(corner[0])).norm();
        if (!(along.dot(place(corner[3]) - place(corner[2])) < 0)) continue;
        const auto part_of = [&](Index c) { return along.dot(place(c) - a) / (length * length); };
        const double from = std::max(0.0, part_of(corner[3])), to = std::min(1.0, part_of(corner[2]));
        if (!(from < to)) continue;
        const double middle = 0.5 * (from + to),
                     there = nearest_parameter(place(corner[2]), place(corner[3]), a + middle * along),
                     whole = (to - from) * undeformed * model_.thickness * closed_conductance(one, other, undeformed);
        const std::array<double, 4> share{1 - middle, middle, 1 - there, there};
        for (const int i : {0, 1})
            for (const int j : {2, 3}) {
                const double conductance = share[i] * share[j] * whole;
                gaps_.push_back({corner[i], corner[j], conductance});
                of_gaps_[corner[i]] += conductance, of_gaps_[corner[j]] += conductance;
            }
    }
}

/// At these temperatures; with the means of k between the temperatures of two corners a steady state obeys Kirchhoff's
/// transform.
void Conduction::follow_conductivity(const std::vector<double>& T) {
    if (!conductivity_varies_) return;
    const Mesh& mesh = model_.mesh;
    const auto pairs = corner_pairs(mesh.order);
    const Index n = mesh.corners_per_triangle();
    present_.resize(conductance_.size());
#pragma omp parallel for schedule(static) if (mesh.n_triangles() > 4096)
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Thermal& thermal = model_.heat->materials[mesh.region[t]];
        for (std::size_t i = pairs.size() * t; i < pairs.size() * (t + 1); ++i) {
            const auto [a, b] = pairs[i - pairs.size() * t];
            const bool varies = thermal.conductivity_part.varies();
            present_[i] = conductance_[i] * (varies ? thermal.mean_conductivity_part(T[n * t + a], T[n * t + b]) : 1);
        }
    }
}

double Conduction::add_heat(const std::vector<double>& T, std::vector<double>& into) const {
    const Mesh& mesh = model_.mesh;
    const std::vector<double>& w = present();
    const bool linear = mesh.order == 1;
#pragma omp parallel for schedule(static) if (mesh.n_triangles() > 4096)
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (linear) conduct<linear_pairs, 3>(&w[3 * t], &T[3 * t], &into[3 * t]);
        else conduct<quadratic_pairs, 7>(&w[12 * t], &T[7 * t], &into[7 * t]);
    for (const Gap& gap : gaps_) {
        const double flow = gap.conductance * (T[gap.b] - T[gap.a]);
        into[gap.a] += flow, into[gap.b] -= flow;
    }
    return exchanges_.add_heat(T, into);
}

/// Whether a point of a split fan still conducts as the whole body does.
bool Conduction::is_intact(const State& begin, Index rank, std::size_t point) const {
    const Fan& fan = model_.fans[begin.split_fans[rank]];
    return unbreakable(model_, model_.points(fan)[point]) ||
           begin.points[begin.first_point[rank] + point].cohesion == 1;
}

/// visit(corners of the node): all corners of a bonded fan; of a split fan those that intact points join.
template <class Visit>
void Conduction::for_each_node_of(Index f, const State& begin, std::vector<Index>& memory, const Visit& visit) const {
    const auto corners = model_.corners(model_.fans[f]);
    const Index rank = begin.split_rank[f];
    if (rank < 0) return visit(corners);
    const std::size_t n = corners.size();
    memory.resize(2 * n);
    const std::span<Index> group(memory.data(), n), node(memory.data() + n, n);
    std::ranges::copy(corners, group.begin());  // the name of a group is one of its corners
    const auto group_of = [&](Index corner) { return group[std::ranges::find(corners, corner) - corners.begin()]; };
    const auto points = model_.points(model_.fans[f]);
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!points[i].on_support() && is_intact(begin, rank, i))
            std::ranges::replace(group, group_of(points[i].after), group_of(points[i].before));
    for (const Index name : corners) {
        std::size_t size = 0;
        for (std::size_t i = 0; i < n; ++i)
            if (group[i] == name) node[size++] = corners[i];
        if (size > 0) visit(std::span<const Index>(node.data(), size));
    }
}

template <class Visit>
void Conduction::for_each_node(const State& begin, const Visit& visit) const {
    const auto n_fans = static_cast<Index>(model_.fans.size());
#pragma omp parallel if (n_fans > 4096)
    {
        std::vector<Index> memory;
#pragma omp for schedule(static)
        for (Index f = 0; f < n_fans; ++f) for_each_node_of(f, begin, memory, visit);
    }
}

const Thermal& Conduction::thermal_of(Index corner) const {
    return model_.heat->materials[model_.mesh.region[model_.mesh.triangle_of(corner)]];
}

double Conduction::level(Index corner, double T) const { return bends_ ? thermal_of(corner).heat_level(T) : T; }

double Conduction::apparent_capacity(Index corner, double T) const {
    return capacity_[corner] * thermal_of(corner).apparent_capacity(T);
}

/// From bend to bend of the stored heat, whose slope is linear between them.
double Conduction::warmed(std::span<const Index> corners, double T, double heat) const {
    double C = 0;  // the smallest: no bend farther than heat/C is reached
    for (const Index c : corners) C += capacity_[c];
    for (;;) {
        double bend = T + heat / C;
        if (bend == T) return T;
        for (const Index c : corners)
            thermal_of(c).for_each_bend([&](double at) {
                if (heat > 0 ? at > T && at < bend : at < T && at > bend) bend = at;
            });
        const auto slope_at = [&](double part) {
            double slope = 0;
            for (const Index c : corners) slope += apparent_capacity(c, T + part * (bend - T));
            return slope;
        };
        const double slope = slope_at(0.5), taken = slope * (bend - T);
        if (std::abs(taken) >= std::abs(heat)) {
            const double rise = slope_at(0.75) - slope_at(0.25);  // of the slope, over half of the way
            if (rise == 0) return T + heat / slope;
            const double first = slope - rise, curve = 2 * rise / (bend - T);  // heat = first x + curve x^2/2
            return T + 2 * heat / (first + std::sqrt(std::max(0.0, first * first + 2 * curve * heat)));
        }
        heat -= taken, T = bend;
    }
}

double Conduction::stable_step(const State& begin) {
    find_gaps(begin);
    into_.assign(model_.mesh.n_corners(), infinity);
    node_capacity_.resize(model_.mesh.n_corners());
    for_each_node(begin, [&](std::span<const Index> corners) {
        double C = 0, sum = 0;
        for (const Index c : corners) C += capacity_[c], sum += diagonal_[c] + of_gaps_[c];
        node_capacity_[corners[0]] = C;
        if (sum > 0) into_[corners[0]] = C / sum;
    });
    return std::ranges::min(into_);
}

SharedTemperatures Conduction::explicit_step(const State& begin, double end) {
    const double start = begin.temperature->time, duration = end - start;
    const double limit = safety * stable_step(begin);
    const int n_steps = std::max(1, static_cast<int>(std::ceil(duration / limit)));
    const double dt = duration / n_steps;
    std::vector<double> T = begin.temperature->of_corner;
    double heat_in = 0;
    for (int i = 0; i < n_steps; ++i) {
        const double time = start + i * dt;
        follow_conductivity(T);
        exchanges_.begin_step(time, time + dt, 0);
        heat_in += dt * add_heat(T, into_);
        for_each_node(begin, [&](std::span<const Index> corners) {
            const double C = node_capacity_[corners[0]];
            double flow = 0, held = 0;
            bool is_held = false;
            for (const Index c : corners) {
                flow += into_[c];
                if (exchanges_.hold(c)) is_held = true, held = exchanges_.held(c);
            }
            const double T_start = T[corners[0]], T_end = is_held  ? held
                                                          : bends_ ? warmed(corners, T_start, dt * flow)
                                                                   : T_start + dt / C * flow;
            double stored = C * (T_end - T_start);
            if (is_held && bends_) {
                stored = 0;
                for (const Index c : corners) stored += capacity_[c] * (level(c, T_end) - level(c, T_start));
            }
            for (const Index c : corners) T[c] = T_end;
            if (!exchanges_.hold_any()) return;
            // what the prescription supplies, kept to be summed in order
            into_[corners[0]] = is_held ? stored - dt * flow : 0;
            for (const Index c : corners.subspan(1)) into_[c] = 0;
        });
        if (exchanges_.hold_any())
            for (const double supplied : into_) heat_in += supplied;
    }
    return finished(begin, end, std::move(T), heat_in);
}

/// H(T+) - H(T) = dt (heat at T+, with the exchanges of the end) for the free nodes; the prescribed ones are known. One
/// linear system, (C + dt K) dT = dt (heat at T), where capacities are constant; else Newton's method with the apparent
/// capacities. The equations are the gradient of a convex function of T+ (H grows, K is symmetric), which decreases
/// along every Newton direction, so it converges with a line search.
SharedTemperatures Conduction::implicit_step(const State& begin, double end) {
    const Mesh& mesh = model_.mesh;
    const double dt = end - begin.temperature->time;
    const std::vector<double>& T = begin.temperature->of_corner;
    find_gaps(begin);
    exchanges_.begin_step(begin.temperature->time, end, 1);
    follow_conductivity(T);
    // unknowns: nodes that are not held
    std::vector<Index> unknown(mesh.n_corners(), -1);
    std::vector<double> dT(mesh.n_corners(), 0.0);
    Index n_unknowns = 0;
    std::vector<Index> memory;
    for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f)
        for_each_node_of(f, begin, memory, [&](std::span<const Index> corners) {
            const auto held = std::ranges::find_if(corners, [&](Index c) { return exchanges_.hold(c); });
            for (const Index c : corners)
                if (held == corners.end()) unknown[c] = n_unknowns;
                else dT[c] = exchanges_.held(*held) - T[c];
            n_unknowns += held == corners.end();
        });
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n_unknowns);
    const auto couple = [&](Index a, Index b, double w) {
        for (const auto& [i, j] : {std::pair{a, b}, {b, a}}) {
            if (unknown[i] < 0) continue;
            entries.emplace_back(unknown[i], unknown[i], dt * w);
            if (unknown[j] >= 0) entries.emplace_back(unknown[i], unknown[j], -dt * w);
            else right[unknown[i]] += dt * w * dT[j];
        }
    };
    const auto pairs = corner_pairs(mesh.order);
    const Index n = mesh.corners_per_triangle();
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (std::size_t i = 0; i < pairs.size(); ++i)
            couple(n * t + pairs[i][0], n * t + pairs[i][1], present()[pairs.size() * t + i]);
    std::vector<Index> pattern = unknown;  // free faces that meet couple corners without becoming one node
    for (const Gap& gap : gaps_) couple(gap.a, gap.b, gap.conductance), pattern.insert(pattern.end(), {gap.a, gap.b});
    for (const auto& at : exchanges_.all())
        if (unknown[at.corner] >= 0) entries.emplace_back(unknown[at.corner], unknown[at.corner], dt * at.conductance);
    const std::size_t n_constant = entries.size();

    std::vector<double> T_end = T;
    double content = 0, last_error = 0;  // [J] the scale of a remaining error
    // what the nodes have still to store at T_end
    const auto add_error = [&](Eigen::VectorXd& error) {
        content = 0;
        add_heat(T_end, into_);
        for (Index c = 0; c < mesh.n_corners(); ++c) {
            if (unknown[c] < 0) continue;
            error[unknown[c]] += dt * into_[c] - capacity_[c] * (level(c, T_end[c]) - level(c, T[c]));
            content += capacity_[c] * std::abs(level(c, T_end[c]));
        }
    };
    add_error(right);
    for (Index c = 0; c < mesh.n_corners() && n_unknowns == 0; ++c) T_end[c] += dT[c];
    for (int i = 0; n_unknowns > 0 && (i == 0 || bends_); ++i) {
        const double error = right.lpNorm<1>();
        if (i > 0 && error <= newton_tolerance * content && error >= 0.5 * last_error) break;
        last_error = error;
        entries.resize(n_constant);
        for (Index c = 0; c < mesh.n_corners(); ++c)
            if (unknown[c] >= 0) entries.emplace_back(unknown[c], unknown[c], apparent_capacity(c, T_end[c]));
        Eigen::SparseMatrix<double> matrix(n_unknowns, n_unknowns);
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (pattern != analysed_) factor_.analyzePattern(matrix), analysed_ = pattern;
        factor_.factorize(matrix);
        if (factor_.info() != Eigen::Success || i == max_newton_steps)
            throw SimulationError(
                i < max_newton_steps
                    ? "the equations of heat conduction have no solution: check conductivities and "
                      "heat capacities, and mesh.quality for flat triangles"
                    : "no temperatures were found: try a smaller time.step, a wider freezing_range, or "
                      "a smoother heat_capacity_table");
        const Eigen::VectorXd found = factor_.solve(right);
        const double slope = -found.dot(right);  // of the convex function along `found`
        double part = 0;
        const auto go_to = [&](double to) {
            for (Index c = 0; c < mesh.n_corners(); ++c)
                if (unknown[c] >= 0) T_end[c] += (to - part) * found[unknown[c]];
            part = to;
        };
        const auto slope_at = [&](double to) {
            go_to(to);
            right.setZero();
            add_error(right);
            return -found.dot(right);
        };
        if (!bends_ || i == 0) {  // prescribed nodes come to their temperatures
            for (Index c = 0; c < mesh.n_corners(); ++c)
                if (unknown[c] < 0) T_end[c] += dT[c];
            if (bends_) slope_at(1);
            else go_to(1);
        } else if (const double at_one = slope_at(1); at_one > 0.5 * std::abs(slope)) {
            zero_between(0, slope, 1, at_one, 1e-3 * std::abs(slope), 30, slope_at);
        }
    }
    // through the boundary at the end, and what holds the prescribed nodes
    double heat_in = dt * add_heat(T_end, into_);
    for (Index c = 0; c < mesh.n_corners(); ++c)
        if (unknown[c] < 0) heat_in += capacity_[c] * (level(c, T_end[c]) - level(c, T[c])) - dt * into_[c];
    return finished(begin, end, std::move(T_end), heat_in);
}

SharedTemperatures Conduction::finished(const State& begin, double end, std::vector<double> T, double heat_in) const {
    const Temperatures& before = *begin.temperature;
    // A temperature is rounded, and so is the heat that it stores, and that it sends on in the step: the latter counts
    // where a step is far beyond the passage of an edge.
    constexpr double much_sent = 1e-4;
    double low = std::ranges::min(before.of_corner), high = std::ranges::max(before.of_corner), change = 0, moved = 0,
           content = 0, sent = 0;
    for (std::size_t c = 0; c < T.size(); ++c) {
        const double after = level(static_cast<Index>(c), T[c]),
                     heat = capacity_[c] * (after - level(static_cast<Index>(c), before.of_corner[c]));
        change += heat, moved += std::abs(heat);
        content += capacity_[c] * std::abs(after);
        sent += (end - before.time) * (diagonal_[c] + of_gaps_[c]) * std::abs(T[c]);
    }
    exchanges_.widen(before.time, end, low, high);
    const double beyond = std::max(std::ranges::max(T) - high, low - std::ranges::min(T)),
                 rounding = 1e-12 * std::max(std::abs(low), std::abs(high)),
                 overshoot = exchanges_.give_heat() || beyond <= rounding ? 0 : beyond;
    const auto made = make_temperatures(model_, end, std::move(T));
    made->heat = before.heat + change;
    made->heat_in = before.heat_in + heat_in;
    made->heat_moved = before.heat_moved + moved;
    made->heat_scale = std::max({before.heat_scale, content, much_sent * sent});
    made->range = std::max(before.range, high - low);
    made->overshoot = std::max(before.overshoot, overshoot);
    return made;
}

}  // namespace knap
