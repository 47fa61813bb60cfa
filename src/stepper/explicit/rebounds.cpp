#include "stepper/explicit/rebounds.hpp"

#include "base/tolerance.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double most_given = 0.9;    // [-] of the approach: what gives way altogether stops nothing
constexpr double rests_below = 0.02;  // [-] of the approach: with R_N = 0 a slower rebound is none
constexpr double slowest = 1e-6;      // [-] of the speed of waves: a slower approach is no impact
constexpr double longest_impact = 100, longest_pause = 6, longest_slip = 24;  // [-] passages of a wave
constexpr double many_steps = 20;                                             // an impact of fewer has no mean force
constexpr double deepest = 0.3, deepest_face = 0.05;  // [-] of an edge: deeper no surface gives way
constexpr double hard = 1e-4;  // [-] of the speed of waves: of slower impacts what the surface cannot take is no lack

}  // namespace

double natural_rebound(std::size_t n_triangles) {
    const auto n = static_cast<double>(n_triangles);
    return 0.8 * n / (n + 2);  // few triangles vibrate more: one rebounds with 0.28 to 0.6
}

Rebounds::Rebounds(const Model& model, std::span<const Dashpot> dashpots) : model_(model), dashpots_(dashpots) {
    const auto needs = [](const ContactLaw& law) { return law.is_of_bodies(); };
    for (const Obstacle& obstacle : model.obstacles) is_needed_ = is_needed_ || obstacle.any_law(needs);
    for (const auto& of_material : model.contact_of_pair)
        is_needed_ = is_needed_ || std::ranges::any_of(of_material, needs);
    for (const Elastic& material : model.materials)
        wave_speed_ = std::max(wave_speed_, material.dilatational_speed(model.plane));
}

double Rebounds::depth_of_obstacles() { return deepest; }

double Rebounds::depth_of_faces() { return deepest_face; }

void Rebounds::begin(const State& begin) {
    if (is_idle()) return;
    const Index n = model_.mesh.n_triangles();
    const auto n_broken = std::ranges::count(begin.points, 0.0, &PointState::cohesion) +
                          std::ranges::count(begin.retired, Retirement::parted);
    if (n_broken != n_broken_) {
        n_broken_ = n_broken;
        const PiecesOfBody triangles = pieces_of_body(model_, begin, dashpots_, Hinges::part);
        first_.assign(triangles.first.begin(), triangles.first.end());
        pieces_.assign(n, {});
        for (Index t = 0; t < n; ++t) {
            Piece& piece = pieces_[first_[t]];
            piece.triangles.push_back(t);
            piece.size += model_.mesh.area(t);
            piece.held = piece.held || triangles.held[t];
        }
        for (Piece& piece : pieces_) piece.size = std::sqrt(piece.size);
    }
    for (Piece& piece : pieces_) piece.is_known = false;
    time_ = begin.time;
    lack_ = 0;
    impacts_.clear();
    for (const Impact& impact : begin.impacts) {
        const double passage = pieces_[impact.piece].size / wave_speed_;
        if (passage > 0 && time_ - impact.touched <= longest_pause * passage &&
            time_ - impact.start <= longest_impact * passage)
            impacts_.push_back(impact);
    }
}

Rebounds::Piece& Rebounds::motion_of(Index first_triangle, const State& begin) {
    Piece& piece = pieces_[first_triangle];
    if (piece.is_known || piece.held) return piece;
    const Mesh& mesh = model_.mesh;
    double mass = 0, inertia = 0, angular = 0;
    Vec2 first = Vec2::Zero(), momentum = Vec2::Zero();
    const Vec2 origin = mesh.corner(mesh.corners_per_triangle() * first_triangle) +
                        begin.displacement_of(mesh.corners_per_triangle() * first_triangle);
    for (const Index t : piece.triangles)
        for (Index k = 0; k < mesh.corners_per_triangle(); ++k) {
            const Index corner = mesh.corners_per_triangle() * t + k;
            const double m = model_.corner_mass[corner];
            const Vec2 y = mesh.corner(corner) + begin.displacement_of(corner) - origin,
                       p = m * begin.velocity[begin.node_of_corner[corner]];
            mass += m, first += m * y, momentum += p, angular += cross(y, p), inertia += m * y.squaredNorm();
        }
    const Vec2 centre = first / mass;
    piece.centre = origin + centre;
    piece.velocity = momentum / mass;
    piece.spin = (angular - cross(centre, momentum)) / (inertia - mass * centre.squaredNorm());
    piece.is_known = true;
    return piece;
}

Vec2 Rebounds::velocity_at(Index first_triangle, const Vec2& place, const State& begin) {
    const Piece& piece = motion_of(first_triangle, begin);
    if (piece.held) return Vec2::Zero();
    return piece.velocity + piece.spin * turned_left(place - piece.centre);
}

Rebounds::Sides Rebounds::sides_of(const ObstacleContact& contact) const {
    return {piece_of(contact.corner), -1 - contact.obstacle};
}

Rebounds::Sides Rebounds::sides_of(const FaceContact& contact) const {
    const auto [first, second] = std::minmax({piece_of(contact.vertex[1]), piece_of(contact.edge[0])});
    return {first, second};  // rates are those of the gap, whichever has the vertex
}

Impact* Rebounds::impact_of(const Sides& sides) {
    const auto found = std::ranges::find_if(
        impacts_, [&](const Impact& impact) { return impact.piece == sides.piece && impact.other == sides.other; });
    return found == impacts_.end() ? nullptr : &*found;
}

GivingWay Rebounds::find(const Sides& sides, const Vec2& place, const Vec2& rate, double gap, double deepest_gap,
                         const ContactLaw& law, const State& begin) {
    GivingWay found{.lies_deep = law.rebound == ContactLaw::Rebound::of_bodies};
    const bool touches = gap <= geometric_rounding * deepest_gap;
    Impact* impact = impact_of(sides);
    if (!impact) {
        if (!touches || -rate.x() <= slowest * wave_speed_) return found;
        impacts_.push_back({sides.piece, sides.other, begin.time, begin.time, -rate.x(), rate.y()});
        impact = &impacts_.back();
    }
    if (touches) impact->touched = begin.time, impact->approach = std::max(impact->approach, -rate.x());
    const double time = begin.time - impact->start;
    // [m/s] the change of a rate by which it grows in half a step, at the mean force since the first touch
    const auto half_a_step = [&](double change) {
        return time > many_steps * begin.last_step ? 0.25 * begin.last_step * change / time : 0;
    };
    const auto natural_of = [&](Index piece) { return natural_rebound(pieces_[piece].triangles.size()); };
    double e_0 = natural_of(sides.piece);
    if (sides.other >= 0) e_0 = std::min(e_0, natural_of(sides.other));
    const double R = law.restitution;
    if (law.rebound == ContactLaw::Rebound::of_bodies && gap <= -deepest_gap && R < e_0 && rate.x() < 0 && time > 0 &&
        impact->approach > hard * wave_speed_) {
        const double part = rate.x() * rate.x() / (impact->approach * impact->approach);
        if (part > lack_) lack_ = part, lack_place_ = place;
    }
    if (law.rebound == ContactLaw::Rebound::of_bodies && gap > -deepest_gap) {
        found.rate = std::clamp(1 - R * R / (e_0 * e_0), 0.0, most_given) * std::max(-rate.x(), 0.0);
        found.pushes =
            rate.x() + half_a_step(rate.x() + impact->approach) < std::max(R, rests_below) * impact->approach;
    }
    const double before = std::abs(impact->slip), slip = impact->slip < 0 ? -rate.y() : rate.y();
    found.rubs = time > longest_slip * pieces_[sides.piece].size / wave_speed_ ||
                 slip - half_a_step(before - slip) > law.tangential * before;
    return found;
}

GivingWay Rebounds::find(const ObstacleContact& contact, const ContactLaw& law, const State& begin) {
    if (is_idle() || !law.is_of_bodies()) return {};
    const Obstacle& obstacle = model_.obstacles[contact.obstacle];
    const ObstacleState& state = begin.obstacles[contact.obstacle];
    const Sides sides = sides_of(contact);
    if (pieces_[sides.piece].held && !obstacle.is_free()) return {};
    const Vec2 place = state.pose.position + contact.arm;
    const Vec2 V = velocity_at(sides.piece, place, begin) - knap::velocity_at(state.velocity, contact.arm);
    const Vec2 &n = contact.normal, t = turned_left(n);
    const double length = std::sqrt(2 * model_.mesh.area(model_.mesh.triangle_of(contact.corner)));
    return find(sides, place, Vec2(n.dot(V), t.dot(V)), contact.gap, deepest * length, law, begin);
}

GivingWay Rebounds::find(const FaceContact& contact, const ContactLaw& law, const State& begin) {
    if (is_idle() || !law.is_of_bodies()) return {};
    for (const Index corner : {contact.vertex[1], contact.edge[0]})
        if (model_.ground_at(corner) != nullptr) return {};
    const Sides sides = sides_of(contact);
    if (sides.piece == sides.other || (pieces_[sides.piece].held && pieces_[sides.other].held)) return {};
    const Vec2 place = model_.mesh.corner(contact.vertex[1]) + begin.displacement_of(contact.vertex[1]),
               V = velocity_at(piece_of(contact.vertex[1]), place, begin) -
                   velocity_at(piece_of(contact.edge[0]), place, begin);
    const Vec2 &n = contact.normal, t = turned_left(n);
    return find(sides, place, Vec2(n.dot(V), t.dot(V)), contact.gap, deepest_face * contact.length, law, begin);
}

}  // namespace knap
