// Warnings about bodies that rest by friction under a load which rises faster than they vibrate: they creep.
//
// A piece with its ground is a column that vibrates along the normal of their faces in its quarter wave:
//
//     T = 4 sum of l/c_d        zeta = pi/T (b3 + b1/4) h/c_d (artificial viscosity)      or 2 pi/T (theta - 1/2) step
//
// (b1 counts less, since the column may grow wider.) A load that rises by its size within tau leaves a pressure that
// swings by a = T/(pi tau) of its mean, at most by all of it. Faces that press with N and bear F_T with the safety
// S = mu N/F_T slip where the pressure falls below 1/S, so a > 1 - 1/S; and slipping gives the vibration more of the
// work of the load than friction takes, unless it decays soon. Measured (results/friction_creep.csv; finer meshes and
// smaller steps agree where their viscosity b3 h is the same, so this is a motion of the body and not of the scheme):
//
//     zeta < k (2 - S)^2 (F_T/N)^2,     k = 0.26 where the ground deforms, 0.07 on a rigid one; at most 0.055
#include "app/check/findings.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/time_tables.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/contact/face_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace knap {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double same_plane = 0.98;   // cosine between the normals of faces on which a piece rests
constexpr double near = 1e-3;         // [-] of an edge: faces that rest on each other
constexpr double half_space = 2;      // depth over width of the column that gives way below a piece
constexpr double least_swing = 0.02;  // [-] of the pressure; less decays before it counts
constexpr int max_below = 100;        // pieces in a stack

/// `slope` [-]: F_T/N.
double enough_damping(double safety, double slope, bool on_rigid) {
    return std::min(0.055, (on_rigid ? 0.07 : 0.26) * (2 - safety) * (2 - safety) * slope * slope);
}

class RestingBodies {
public:
    RestingBodies(const ReadResult& read, const Model& model, const StepPlan& plan)
        : time_(read.scenario.time), model_(model), mesh_(model.mesh), plan_(plan) {}

    std::vector<Diagnostic> found(const ReadResult& read) {
        std::vector<Diagnostic> warnings;
        if (!time_.start_run.empty() || model_.corner_loads.empty()) return warnings;
        find_contacts();
        if (contacts_.empty()) return warnings;
        find_forces();
        std::optional<Creep> worst;
        int n = 0;
        for (const auto& [piece, forces] : forces_)
            if (const auto creep = judge(piece, forces))
                if (++n, !worst || creep->lack() > worst->lack()) worst = creep;
        if (worst) warnings.push_back(read.at(item("load", worst->load), text(*worst, n - 1)));
        return warnings;
    }

private:
    struct Contact {
        Index piece, below;  // the lowest triangles of pieces; below: rigid_support for what does not deform
        Vec2 place, normal;  // [m], into the piece
        double friction;
    };
    struct Column {
        double period, damping;  // [s], [-]
    };
    struct Creep {
        std::size_t load;  // the one that pushes most
        Contact rest;
        double safety, swing, enough;  // enough: damping
        Column column;
        double lack() const { return enough - column.damping; }
    };
    using Forces = std::map<Index, Vec2>;  // [N] by history, of factor 1

    void add(Index piece, Index below, const Vec2& place, const Vec2& normal, double friction) {
        if (piece != rigid_support && !pieces_.held[piece])
            contacts_.emplace(piece, Contact{piece, below, place, normal, friction});
    }
    void add_both(Index a, Index b, const Vec2& place, const Vec2& into_a, double friction) {
        if (a == b || !(friction > 0)) return;
        add(a, b, place, into_a, friction), add(b, a, place, -into_a, friction);
    }
    Index piece_of(Index corner) const {
        return corner < 0 || corner >= mesh_.n_corners() ? rigid_support : pieces_.first[mesh_.triangle_of(corner)];
    }

    void find_contacts() {
        const auto may_slide = [&](const FanPoint& point) {
            return (point.cracked || model_.laws[point.law].sigma_c <= 0) &&
                   point.gap <= near * model_.interfaces[model_.interface_of(point.point)].length;
        };
        if (model_.obstacles.empty() && !model_.faces_meet() && std::ranges::none_of(model_.fan_points, may_slide))
            return;
        const State start = initial_state(model_);
        pieces_ = pieces_of_body(model_, start, dashpots_on(model_, time_.scheme.absorbing));
        if (std::ranges::all_of(pieces_.held, [](auto held) { return held; })) return;
        for (const FanPoint& point : model_.fan_points)
            if (may_slide(point))
                add_both(piece_of(point.after), piece_of(point.before), mesh_.corner(point.corner()), point.normal,
                         model_.laws[point.law].friction);
        const double h = plan_.stable_step;
        if (!model_.obstacles.empty()) {
            ObstacleContacts obstacles(model_);
            obstacles.find(start, h, std::vector<Vec3>(model_.obstacles.size(), Vec3::Zero()), {});
            for (const ObstacleContact& contact : obstacles.all()) {
                const Index t = mesh_.triangle_of(contact.corner);
                const Vec2 place = contact.of_body([&](Index corner) { return mesh_.corner(corner); });
                if (contact.gap <= near * std::sqrt(2 * mesh_.area(t)))
                    add_both(pieces_.first[t], rigid_support, place, contact.normal,
                             obstacles.law_of(contact, start).friction);
            }
        }
        if (!model_.faces_meet()) return;
        FaceContacts faces(model_);
        faces.find(start, h);
        for (const FaceContact& contact : faces.all())
            if (contact.gap <= near * contact.length)
                add_both(piece_of(contact.vertex[1]), piece_of(contact.edge[0]), place_of(contact.vertex[1]),
                         contact.normal, law_between_faces(model_, start, contact).friction);
    }

    Vec2 place_of(Index corner) const {
        const GroundVertex* ground = model_.ground_at(corner);
        return ground != nullptr ? ground->place : Vec2(mesh_.corner(corner));
    }

    void find_forces() {
        const State start = initial_state(model_);
        for (const CornerLoad& load : model_.corner_loads) {
            const Index piece = piece_of(load.corner);
            if (load.is_release || !contacts_.contains(piece)) continue;
            forces_[piece].try_emplace(load.history, Vec2::Zero()).first->second += force_of(model_, load, start);
        }
        for (Index c = 0; c < mesh_.n_corners(); ++c) {
            const Index piece = piece_of(c);
            if (!model_.initial_velocity_of(c).isZero()) forces_.erase(piece);  // moves
            corners_[piece].push_back(c);
        }
    }

    std::optional<Creep> judge(Index piece, const Forces& forces) const {
        const auto [load, at] = main_load(forces);
        Vec2 force = Vec2::Zero();
        for (const auto& [number, each] : forces) force += model_.histories[number](at) * each;
        const auto rest = rest_of(piece, force);
        if (!rest) return {};
        const double pressing = -rest->normal.dot(force), sliding = std::abs(cross(rest->normal, force)),
                     safety = rest->friction * pressing / std::max(sliding, 1e-300);
        if (!(safety >= 1 && safety < 2)) return {};
        const Column column = column_below(*rest, force);
        if (!time_.scheme.takes_explicit_steps() && plan_.limits.largest > 0.5 * column.period) return {};
        double swing = 0;
        for (const auto& [number, each] : forces) {
            const TimeFunction& history = model_.histories[number];
            const double before = time_.start_in_equilibrium ? history(0) : 0;
            swing += each.norm() / force.norm() * largest_rise(history, before, column.period / pi, time_.end).size;
        }
        const double enough = enough_damping(safety, sliding / pressing, rest->below == rigid_support);
        const Creep creep{load, *rest, safety, std::min(swing, 1.), enough, column};
        if (swing <= std::max(1 - 1 / safety, least_swing) || creep.lack() <= 0) return {};
        return creep;
    }

    /// The load that pushes most, and when it first does [s].
    std::pair<std::size_t, double> main_load(const Forces& forces) const {
        double largest = 0, when = 0;  // [N], [s]
        Index load = 0;
        for (const auto& force : forces) {
            const TimeFunction& history = model_.histories[force.first];
            const auto look_at = [&](double t) {
                const double size = std::abs(history(t)) * force.second.norm();
                if (t >= 0 && t <= time_.end && size > 1.01 * largest) largest = size, when = t, load = force.first;
            };
            look_at(0);
            std::ranges::for_each(history.time, look_at);
        }
        return {static_cast<std::size_t>(load), when};
    }

    /// The faces that bear a force on a piece as one plane, with the least friction of all; none where they are
    /// wedges or steps.
    std::optional<Contact> rest_of(Index piece, const Vec2& force) const {
        std::vector<const Contact*> bearing;
        const auto [first, last] = contacts_.equal_range(piece);
        for (auto c = first; c != last; ++c)
            if (c->second.normal.dot(force) < -near * force.norm()) bearing.push_back(&c->second);
        if (bearing.empty()) return {};
        Contact rest = *bearing[0];
        rest.place = rest.normal = Vec2::Zero();
        for (const Contact* contact : bearing) {
            rest.place += contact->place / static_cast<double>(bearing.size()), rest.normal += contact->normal;
            if (contact->friction < rest.friction) rest.friction = contact->friction, rest.below = contact->below;
        }
        rest.normal.normalize();
        const bool plane = std::ranges::all_of(
            bearing, [&](const Contact* contact) { return contact->normal.dot(rest.normal) > same_plane; });
        return plane ? std::optional(rest) : std::nullopt;
    }

    /// [m] Of a piece in a direction.
    std::array<double, 2> range(Index piece, const Vec2& direction) const {
        std::array range{infinity, -infinity};
        for (const Index c : corners_.at(piece)) {
            const double x = direction.dot(mesh_.corner(c));
            range = {std::min(range[0], x), std::max(range[1], x)};
        }
        return range;
    }

    const Elastic& material_of(Index triangle) const { return model_.materials[mesh_.region[triangle]]; }

    Column column_below(const Contact& contact, const Vec2& force) const {
        const Vec2& n = contact.normal;
        const auto across = range(contact.piece, turned_left(n));
        const double width = across[1] - across[0];
        double passage = 0, length = 0;  // [s], [m]
        std::vector<Index> pieces;
        const Contact* at = &contact;
        const auto add_layer = [&](Index piece, double thickness) {
            pieces.push_back(piece);
            length += thickness, passage += thickness / material_of(piece).dilatational_speed(model_.plane);
        };
        while (at != nullptr && pieces.size() < max_below) {
            const auto along = range(at->piece, n);
            add_layer(at->piece, along[1] - along[0]);
            const Index below = at->below;
            at = nullptr;
            if (below == rigid_support) break;
            if (pieces_.held[below]) {
                add_layer(below, std::min(half_space * width, n.dot(contact.place) - range(below, n)[0]));
                break;
            }
            const auto [first, last] = contacts_.equal_range(below);
            for (auto c = first; c != last && at == nullptr; ++c)
                if (c->second.normal.dot(force) < 0 && std::ranges::find(pieces, c->second.below) == pieces.end())
                    at = &c->second;
        }
        const double period = 4 * passage;
        double delay = 0, area = 0;  // [s] (b3 + b1/4) h/c_d, mean of the triangles near the contact
        for (const Index piece : pieces)
            for (const Index c : corners_.at(piece)) {
                const Index t = mesh_.triangle_of(c);
                const Elastic& material = material_of(t);
                if (c % mesh_.corners_per_triangle() != 0 || (mesh_.centroid(t) - contact.place).norm() > length)
                    continue;
                delay += mesh_.area(t) * (material.shear_viscosity + material.bulk_viscosity[0] / 4) *
                         std::sqrt(2 * mesh_.area(t)) / mesh_.order / material.dilatational_speed(model_.plane);
                area += mesh_.area(t);
            }
        double damping = pi / period * (area > 0 ? delay / area : 0);
        if (!time_.scheme.takes_explicit_steps())
            damping = 2 * pi / period * (time_.scheme.theta - 0.5) * plan_.limits.largest;
        else if (time_.scheme.damping_of == DampingOf::motion) damping += time_.scheme.damping * period / (4 * pi);
        return {period, damping};
    }

    std::string name_of(Index piece) const {
        const auto part = std::ranges::find_if(
            mesh_.parts, [&](const MeshPart& p) { return piece < p.first_triangle + p.n_triangles; });
        return part == mesh_.parts.end() || part->name.empty() ? "a piece of the body" : "`" + part->name + "`";
    }

    Diagnostic text(const Creep& creep, int others) const {
        const double ramp = 2 * creep.column.period / pi / std::max(1 - 1 / creep.safety, least_swing);
        return {.severity = Diagnostic::Severity::warning,
                .code = "friction-creep",
                .message = formatted(
                    "%s rests at %s%s by friction, with a safety of %.3g, and `%s` rises faster than it vibrates there "
                    "(period about %s, damping %.2g %%): it slips where its pressure falls, by up to %.0f %%, and "
                    "slipping keeps alive what is damped by less than about %.2g %%, so it may go on creeping",
                    name_of(creep.rest.piece).c_str(), place_text(creep.rest.place).c_str(),
                    others > 0 ? formatted(" (and %d more elsewhere)", others).c_str() : "", creep.safety,
                    item("load", creep.load).c_str(), readable(creep.column.period, "s", 2).c_str(),
                    100 * creep.column.damping, 100 * creep.swing, 100 * creep.enough),
                .note = "time.start = \"equilibrium\", or a ramp of at least " + readable(ramp, "s", 2)};
    }

    const TimeOptions& time_;
    const Model& model_;
    const Mesh& mesh_;
    const StepPlan& plan_;
    PiecesOfBody pieces_;
    std::multimap<Index, Contact> contacts_;  // by piece
    std::map<Index, Forces> forces_;          // by piece
    std::map<Index, std::vector<Index>> corners_;
};

}  // namespace

std::vector<Diagnostic> findings_of_resting_bodies(const ReadResult& read, const Model& model, const StepPlan& plan) {
    return RestingBodies(read, model, plan).found(read);
}

}  // namespace knap
