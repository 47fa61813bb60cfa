#include "stepper/rigid/freeze.hpp"

#include "element/elastic_forces.hpp"
#include "element/thermal_stress.hpp"
#include "stepper/common/mean_motions.hpp"
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/common/surface_energy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {
namespace {

constexpr double few_edges = 10;      // [-] D/L up to which sigma_c/(rho c) breaks a piece
constexpr double small_swing = 0.01;  // [-] of the kinetic energy: an impact spends many times as much

/// [m/s] The particle velocity of a wave whose stress breaks a point now, and that stress [Pa]; infinite where nothing
/// can.
struct Weakness {
    double velocity = infinity, stress = 0;
};
Weakness weakness_of(const Model& model, const State& state, Index fan, std::size_t j) {
    const FanPoint& point = model.points(model.fans[fan])[j];
    if (point.cracked || point.on_support()) return {};
    const CohesiveLaw& law = law_of(model, state, point);
    const Index rank = state.split_rank[fan];
    const double beta = rank < 0 ? 1 : state.points[state.first_point[rank] + static_cast<Index>(j)].cohesion;
    if (!law.breakable() || !(law.sigma_c > 0) || !(beta > 0)) return {};
    double impedance = 0;
    for (const Index corner : {point.before, point.after}) {
        const Elastic& material = model.materials[model.mesh.region[model.mesh.triangle_of(corner)]];
        impedance = std::max(impedance, std::sqrt(material.E * material.density));
    }
    const double stress = beta * state.strength_factor(fan) * law.sigma_c;
    return {stress / impedance, stress};
}

}  // namespace

double least_blow(const FrozenBody::Piece& piece, const RigidOptions& options) {
    if (!can_break(piece, options)) return infinity;
    // smaller pieces bear more, but as rigid ones they would not rebound
    return options.thaw * piece.weakest * std::min(1.0, std::sqrt(few_edges * piece.edge() / std::sqrt(piece.area)));
}

double unrest(const FrozenBody::Piece& piece, const RigidPiece& motion, double vibration, const RigidOptions& options) {
    const double blow = least_blow(piece, options);
    const double twice = piece.mass * motion.velocity.squaredNorm() + piece.inertia * motion.spin * motion.spin;
    return std::sqrt(2 * vibration / std::max(piece.mass * blow * blow, small_swing * twice));
}

FrozenPieces freeze(const Model& model, State& state) {
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f)
        if (state.split_rank[f] < 0 && std::ranges::any_of(model.points(model.fans[f]), [&](const FanPoint& point) {
                return !unbreakable(model, point) && !(model.laws[point.law].sigma_c > 0);
            }))
            split(model, f, state);
    const Mesh& mesh = model.mesh;
    const PiecesOfBody of_body = pieces_of_body(model, state, {});
    FrozenPieces frozen;
    const auto body = std::make_shared<FrozenBody>();
    body->piece_of_triangle.assign(mesh.n_triangles(), -1);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Index first = of_body.first[t];
        if (first == t) {
            body->piece_of_triangle[t] = static_cast<Index>(body->pieces.size());
            body->pieces.push_back({.first_triangle = t, .weakest = infinity, .held = of_body.held[t] != 0});
        }
        const Index p = body->piece_of_triangle[t] = body->piece_of_triangle[first];
        FrozenBody::Piece& piece = body->pieces[p];
        ++piece.n_triangles, piece.area += mesh.area(t);
    }
    frozen.pieces.resize(body->pieces.size());
    const auto for_corners = [&](const auto& visit) {
        for (Index c = 0; c < mesh.n_corners(); ++c) visit(c, body->piece_of_triangle[mesh.triangle_of(c)]);
    };
    // about the place of the first corner, whose rounding is small
    std::vector<Vec2> origin;
    for (const FrozenBody::Piece& piece : body->pieces)
        origin.push_back(place_of(model, state, mesh.corners_per_triangle() * piece.first_triangle));
    const MeanMotions mean = mean_motions(origin, [&](const auto& visit) {
        for_corners([&](Index c, Index p) {
            visit(p, model.corner_mass[c], place_of(model, state, c), state.velocity[state.node_of_corner[c]]);
        });
    });
    for (std::size_t p = 0; p < origin.size(); ++p) {
        body->pieces[p].mass = mean.mass[p], body->pieces[p].inertia = mean.inertia[p];
        RigidPiece& piece = frozen.pieces[p];
        piece.centre = mean.centre[p];
        if (!body->pieces[p].held) piece.velocity = mean.velocity[p], piece.spin = mean.spin[p];
        piece.begin_slow(state.time), piece.last_step = state.last_step;
    }
    body->arm.assign(state.displacement.size(), Vec2::Zero());
    body->piece_of_node.assign(state.displacement.size(), -1);
    for_corners([&](Index c, Index p) {
        const Index node = state.node_of_corner[c];
        const Vec2 arm = place_of(model, state, c) - frozen.pieces[p].centre;
        body->arm[node] = arm, body->piece_of_node[node] = p;
        body->pieces[p].radius = std::max(body->pieces[p].radius, arm.norm());
    });
    frozen.vibration.assign(origin.size(), 0);
    for_corners([&](Index c, Index p) {
        const Index node = state.node_of_corner[c];
        const Vec2 rigid = frozen.pieces[p].velocity + frozen.pieces[p].spin * turned_left(body->arm[node]);
        frozen.vibration[p] += 0.5 * model.corner_mass[c] * (state.velocity[node] - rigid).squaredNorm();
    });
    for (std::size_t p = 0; p < origin.size(); ++p)
        frozen.kinetic += 0.5 * (body->pieces[p].mass * frozen.pieces[p].velocity.squaredNorm() +
                                 body->pieces[p].inertia * frozen.pieces[p].spin * frozen.pieces[p].spin);
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const auto points = model.points(model.fans[f]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Weakness found = weakness_of(model, state, f, j);
            if (!(found.velocity < infinity)) continue;
            FrozenBody::Piece& piece = body->pieces[body->piece_of_triangle[mesh.triangle_of(points[j].before)]];
            if (found.velocity < piece.weakest) piece.weakest = found.velocity, piece.strength = found.stress;
        }
    }
    const ElasticForces elastic(mesh, model.materials, model.plane, model.thickness, model.large_rotation);
    std::array<Vec2, 3> force;  // of first order, since rotations are large
    std::vector<std::uint8_t> unused;
    const auto strain_of = [&](Index t) -> double& { return body->pieces[body->piece_of_triangle[t]].strain; };
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        strain_of(t) += elastic.evaluate(t, t + 1, state.displacement, state.node_of_corner, force.data(), unused);
    if (state.temperature) {
        const ThermalStress thermal(mesh, model.materials, model.plane, model.thickness, model.large_rotation);
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            strain_of(t) +=
                thermal.energy(t, t + 1, state.displacement, state.node_of_corner, state.temperature->strain);
    }
    for (const FrozenBody::Piece& piece : body->pieces) frozen.strain += piece.strain;
    const StepReport surface = surface_energy(model, state);
    body->dissipated = surface.dissipated, body->recoverable = surface.recoverable;
    body->interface_elastic = surface.interface_elastic;
    frozen.body = body;
    return frozen;
}

void place_nodes(const Model& model, State& state) {
    const FrozenBody& body = *state.frozen;
    std::vector<Rotation> turned;
    turned.reserve(state.rigid_pieces.size());
    for (const RigidPiece& piece : state.rigid_pieces) turned.push_back(Rotation::by(piece.angle));
    const auto place = [&](Index node, const Vec2& reference) {
        if (node >= std::ssize(body.piece_of_node)) return;  // a fan that split since
        const Index p = body.piece_of_node[node];
        const RigidPiece& piece = state.rigid_pieces[p];
        if (piece.state == PieceState::deformable) return;
        const Vec2 arm = turned[p].cosine * body.arm[node] + turned[p].sine * turned_left(body.arm[node]);
        state.displacement[node] = piece.centre + arm - reference;
        state.velocity[node] = piece.velocity + piece.spin * turned_left(arm);
    };
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const auto corners = model.corners(model.fans[f]);
        const Index vertex = model.fans[f].vertex;  // none: of second order
        const Vec2& reference = vertex >= 0 ? model.mesh.vertices[vertex] : model.mesh.corner(corners[0]);
        if (state.split_rank[f] < 0) place(static_cast<Index>(f), reference);
        else
            for (const Index corner : corners) place(state.node_of_corner[corner], reference);
    }
}

}  // namespace knap
