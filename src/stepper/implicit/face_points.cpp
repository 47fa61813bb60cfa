#include "stepper/implicit/face_points.hpp"

#include <algorithm>

namespace knap {

FacePoints::FacePoints(const Model& model)
    : model_(model), law_{.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = 0, .restitution = 0} {
    if (model.faces_meet()) faces_.emplace(model);
}

bool FacePoints::find(const State& begin, double h, const std::vector<Vec2>& corner_rate) {
    if (!faces_) return true;
    faces_->find(begin, h, &corner_rate);
    rows_.clear();
    for (const FaceContact& contact : faces_->all()) rows_.push_back({contact});
    const auto& refusal = faces_->refusal();
    return !refusal || (model_.large_rotation && refusal->reason == ContactRefusal::Reason::depth);
}

void FacePoints::reject(StepReport& report) const {
    const ContactRefusal& refusal = *faces_->refusal();
    report.reject(Rejection::contact_speed, refusal.place, refusal.value);
}

void FacePoints::turn(const State& begin, double h, const std::vector<Vec2>& corner_rate) {
    const auto way = [&](Index corner) -> Vec2 { return 0.5 * h * corner_rate[corner]; };
    const auto middle = [&](Index c) -> Vec2 { return place_of(model_, begin, c) + unless_ground(c, way); };
    for (Row& row : rows_) {
        const PlacedEdge edge = placed_edge(middle(row.edge[0]), middle(row.edge[1]));
        const Vec2 vertex = 0.5 * (middle(row.vertex[0]) + middle(row.vertex[1]));
        row.normal = edge.outward;
        row.share = edge.share(vertex);
        row.lever = edge.gap(vertex) / edge.length * edge.along * edge.outward.transpose();
    }
}

double FacePoints::change(std::size_t i, const ActivePoint& point) const {
    return (rows_[i].normal + point.normal).norm() + std::abs(rows_[i].share - point.sides.share) +
           (rows_[i].lever - point.sides.lever).norm();
}

Vec2 FacePoints::force_before(std::size_t i, const State& begin) const {
    const double time = model_.large_rotation && begin.last_step > 0 ? begin.last_step : 1;
    return Vec2(rows_[i].contact, rows_[i].tangential) / time;
}

bool FacePoints::lacked(const State& begin, double h, const std::vector<Vec2>& corner_rate) {
    const auto number = [](const FaceContact& contact) { return std::array{contact.vertex[1], contact.edge[0]}; };
    before_.clear();
    for (std::size_t i = 0; i < size(); ++i) before_.push_back(number(rows_[i]));
    if (!find(begin, h, corner_rate)) return true;
    const auto closes = [&](const FaceContact& contact) {
        const auto rate = [&](Index corner) {
            return unless_ground(corner, [&](Index c) -> Vec2 { return corner_rate[c]; });
        };
        const double at_end = contact.gap + h * contact.normal.dot(contact.jump(rate));
        return at_end < std::min(0.0, contact.gap) - 1e-12 * contact.length;
    };
    return std::ranges::any_of(rows_, [&](const FaceContact& contact) {
        return std::ranges::find(before_, number(contact)) == before_.end() && closes(contact);
    });
}

PointSides FacePoints::sides_of(const Row& contact, const CornerPartition& nodes) const {
    const auto node = [&](Index corner) {
        return model_.ground_at(corner) != nullptr ? -1 : nodes.node_of_corner[corner];
    };
    PointSides sides{.fan_point = -1,
                     .before = node(contact.vertex[0]),
                     .after = node(contact.edge[0]),
                     .second_node = node(contact.edge[1]),
                     .share = contact.share,
                     .leaf_corner = model_.ground_at(contact.edge[0]) ? contact.vertex[0] : contact.edge[0],
                     .lever = contact.lever};
    if (const Index other = node(contact.vertex[1]); other != sides.before) sides.before_too = other;
    return sides;
}

const std::vector<PointSides>& FacePoints::sides(const CornerPartition& nodes) {
    sides_.clear();
    for (std::size_t i = 0; i < size(); ++i) sides_.push_back(sides_of(rows_[i], nodes));
    return sides_;
}

/// [m] Rounding of places and displacements: a smaller gap is none. Where blocks are held in many ways, friction that
/// sticks and contacts that close such gaps would contradict each other.
double FacePoints::touching_gap(const State& begin, const FaceContact& contact) const {
    double gap = 0;
    for (const Index corner : {contact.vertex[0], contact.edge[0], contact.edge[1]})
        if (model_.ground_at(corner) == nullptr)
            gap = std::max(
                {gap, 1e-14 * model_.mesh.corner(corner).norm(), 1e-11 * begin.displacement_of(corner).norm()});
    return gap;
}

ActivePoint FacePoints::point(std::size_t i, const StepContext& step, const CornerPartition& nodes) const {
    const FaceContact& contact = rows_[i];
    const State& begin = *step.begin;
    const auto velocity = [&](Index corner) {
        return unless_ground(corner, [&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; });
    };
    const double rate = contact.normal.dot(contact.jump(velocity));
    const ContactLaw law = law_between_faces(model_, begin, contact);
    ActivePoint made{.sides = sides_of(rows_[i], nodes),
                     .fan = between_faces,
                     .normal = -contact.normal,  // from the vertex to the edge
                     .law = {.u_N = contact.gap,
                             .u_T = 0,
                             .strength = 0,
                             .cohesion = 0,
                             .material = &law_,
                             .friction = law.friction,
                             .contact = contact_bound_theta(contact.gap, rate, law.restitution, step.h, step.theta,
                                                            touching_gap(begin, contact)),
                             .step = &step}};
    apply_prescribed(nodes, made);
    made.law.set_staircase();
    return made;
}

void FacePoints::add_impulse(std::size_t i, const Vec2& impulse, std::vector<Vec2>& of_corner) const {
    const Row& contact = rows_[i];
    const auto add = [&](Index corner, const Vec2& part) {
        if (model_.ground_at(corner) == nullptr) of_corner[corner] += part;
    };
    const Vec2 couple = contact.lever.transpose() * impulse;
    add(contact.edge[0], (1 - contact.share) * impulse + couple);
    add(contact.edge[1], contact.share * impulse - couple);
    for (const Index corner : contact.vertex) add(corner, -0.5 * impulse);
}

void FacePoints::store(std::span<const ActivePoint> points, const StepContext& step, State& end,
                       StepReport& report) const {
    const double time = model_.large_rotation ? step.h : 1;
    end.face_contacts.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const FaceContact& contact = rows_[i];
        // with N from the vertex to the edge, both components are the opposite on the vertex along n and t of the edge
        const PointResponse& q = points[i].response;
        report.add_depth((contact.depth - step.h * points[i].rate.x()) / contact.length,
                         place_of(model_, end, contact.vertex[1]));
        end.face_contacts.push_back({.vertex = contact.vertex[1],
                                     .edge = contact.edge[0],
                                     .entering = contact.vertex[0],
                                     .contact = q.contact / step.kick() * time,
                                     .tangential = q.tangential / step.kick() * time});
    }
    report.face_contacts = std::ssize(points);
}

}  // namespace knap
