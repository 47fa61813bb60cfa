#include "stepper/implicit/face_points.hpp"

#include <algorithm>

namespace knap {

FacePoints::FacePoints(const Model& model)
    : model_(model), law_{.sigma_c = 0, .G_c = 0, .gamma = 1, .friction = 0, .restitution = 0} {
    if (!model.contact_of_pair.empty()) faces_.emplace(model);
}

bool FacePoints::find(const State& begin, double h, const std::vector<Vec2>& corner_rate) {
    if (!faces_) return true;
    faces_->find(begin, h, &corner_rate);
    return !faces_->refusal();
}

bool FacePoints::lacked(const State& begin, double h, const std::vector<Vec2>& corner_rate) {
    const auto number = [](const FaceContact& contact) { return std::array{contact.vertex[1], contact.edge[0]}; };
    before_.clear();
    for (std::size_t i = 0; i < size(); ++i) before_.push_back(number(faces_->all()[i]));
    if (!find(begin, h, corner_rate)) return true;
    const auto closes = [&](const FaceContact& contact) {
        const auto rate = [&](Index corner) -> Vec2 {
            return model_.ground_at(corner) ? Vec2(Vec2::Zero()) : corner_rate[corner];
        };
        return contact.gap + h * contact.normal.dot(contact.jump(rate)) < -1e-12 * contact.length;
    };
    return faces_ && std::ranges::any_of(faces_->all(), [&](const FaceContact& contact) {
               return std::ranges::find(before_, number(contact)) == before_.end() && closes(contact);
           });
}

PointSides FacePoints::sides_of(const FaceContact& contact, const CornerPartition& nodes) const {
    const auto node = [&](Index corner) {
        return model_.ground_at(corner) != nullptr ? -1 : nodes.node_of_corner[corner];
    };
    PointSides sides{.fan_point = -1,
                     .before = node(contact.vertex[0]),
                     .after = node(contact.edge[0]),
                     .second_node = node(contact.edge[1]),
                     .share = contact.share,
                     .leaf_corner = model_.ground_at(contact.edge[0]) ? contact.vertex[0] : contact.edge[0]};
    if (const Index other = node(contact.vertex[1]); other != sides.before) sides.before_too = other;
    return sides;
}

const std::vector<PointSides>& FacePoints::sides(const CornerPartition& nodes) {
    sides_.clear();
    for (std::size_t i = 0; i < size(); ++i) sides_.push_back(sides_of(faces_->all()[i], nodes));
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
    const FaceContact& contact = faces_->all()[i];
    const State& begin = *step.begin;
    const auto velocity = [&](Index corner) -> Vec2 {
        return model_.ground_at(corner) ? Vec2(Vec2::Zero()) : begin.velocity[begin.node_of_corner[corner]];
    };
    const double rate = contact.normal.dot(contact.jump(velocity));
    ActivePoint made{
        .sides = sides_of(contact, nodes),
        .fan = between_faces,
        .normal = -contact.normal,  // from the vertex to the edge
        .law = {.u_N = contact.gap,
                .u_T = 0,
                .strength = 0,
                .cohesion = 0,
                .material = &law_,
                .friction = law_between_faces(model_, contact).friction,
                .contact = contact_bound_theta(contact.gap, rate, 0, step.h, step.theta, touching_gap(begin, contact)),
                .step = &step}};
    apply_prescribed(nodes, made);
    made.law.set_staircase();
    return made;
}

void FacePoints::add_impulse(std::size_t i, const Vec2& impulse, std::vector<Vec2>& of_corner) const {
    const FaceContact& contact = faces_->all()[i];
    const auto add = [&](Index corner, double weight) {
        if (model_.ground_at(corner) == nullptr) of_corner[corner] += weight * impulse;
    };
    add(contact.edge[0], 1 - contact.share), add(contact.edge[1], contact.share);
    for (const Index corner : contact.vertex) add(corner, -0.5);
}

void FacePoints::store(std::span<const ActivePoint> points, double kick, State& end) const {
    end.face_contacts.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const FaceContact& contact = faces_->all()[i];
        // with N from the vertex to the edge, both components are the opposite on the vertex along n and t of the edge
        const PointResponse& q = points[i].response;
        end.face_contacts.push_back({.vertex = contact.vertex[1],
                                     .edge = contact.edge[0],
                                     .entering = contact.vertex[0],
                                     .contact = q.contact / kick,
                                     .tangential = q.tangential / kick});
    }
}

}  // namespace knap
