// Warnings about slender parts of first order with few edges across: constant strains cannot bend.
#include "app/check/findings.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "base/union_find.hpp"
#include "model/obstacle_gap.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace knap {
namespace {

constexpr double enough_edges = 6;    // across: a beam then lacks less than 5 % of its deflection
constexpr double slender = 6;         // [-] length over thickness
constexpr double much_across = 0.05;  // [-] of all loads: across a part
constexpr double same_face = 0.8;     // cosine between the normals of neighbouring edges

/// A face of the body, at its boundary or at a crack.
struct Face {
    Index triangle, side;
    Vec2 inward;       // normal
    double length;     // [m]
    double thickness;  // [m] of the body behind it; infinite where there are many edges
    double edge;       // [m] mean one on the way
};

class ThinParts {
public:
    explicit ThinParts(const Model& model) : model_(model), mesh_(model.mesh) {
        neighbour_.assign(3 * mesh_.n_triangles(), -1);
        std::vector<std::pair<Index, Index>> at_surface;  // triangle, side
        for (std::size_t e = 0; e < mesh_.interior_edges.size(); ++e) {
            const InteriorEdge& edge = mesh_.interior_edges[e];
            for (int k = 0; k < 2; ++k)
                if (model.interfaces[e].cracked) at_surface.emplace_back(edge.triangle[k], edge.side[k]);
                else neighbour_[3 * edge.triangle[k] + edge.side[k]] = edge.triangle[1 - k];
        }
        for (const BoundaryEdge& edge : mesh_.boundary_edges) at_surface.emplace_back(edge.triangle, edge.side);
        is_supported_.assign(mesh_.n_corners(), 0);
        for (const FanPoint& point : model.fan_points)
            if (point.on_support()) is_supported_[point.corner()] = 1;
        for (const auto& [triangle, side] : at_surface)
            if (const Face face = face_at(triangle, side); face.thickness < infinity) faces_.push_back(face);
        bends_ = find_actions();
    }

    struct Part {
        double length, thickness, edges;  // [m, m, -] edges across
        Vec2 place;                       // [m]
    };
    /// The one with the fewest edges across, of those that something can bend.
    std::optional<Part> thinnest() const {
        UnionFind parts(faces_.size());
        std::map<Index, std::vector<std::size_t>> at_vertex;
        for (std::size_t i = 0; i < faces_.size(); ++i)
            for (const Index k : {faces_[i].side, (faces_[i].side + 1) % 3})
                at_vertex[mesh_.triangles[faces_[i].triangle][k]].push_back(i);
        for (const auto& [vertex, faces] : at_vertex)
            for (const std::size_t i : faces)
                if (faces_[i].inward.dot(faces_[faces[0]].inward) > same_face) parts.join(i, faces[0]);
        std::map<std::size_t, std::vector<std::size_t>> groups;
        for (std::size_t i = 0; i < faces_.size(); ++i) groups[parts.find(i)].push_back(i);
        std::optional<Part> found;
        for (const auto& [first, group] : groups) {
            double length = 0, across = 0, edges = 0;
            bool bends = false;
            for (const std::size_t i : group) {
                const Face& face = faces_[i];
                length += face.length, across += face.length * face.thickness;
                edges += face.length * face.thickness / face.edge;
                bends = bends || is_bent(face.inward);
            }
            const Face& middle = faces_[group[group.size() / 2]];
            const Part part{length, across / length, edges / length, mesh_.corner(middle.triangle, middle.side)};
            if (!bends || part.edges >= enough_edges || length < slender * part.thickness) continue;
            if (!found || part.edges < found->edges) found = part;
        }
        return found;
    }

private:
    Face face_at(Index triangle, Index side) const {
        const Vec2 along = mesh_.side_vector(triangle, side);
        Face face{.triangle = triangle,
                  .side = side,
                  .inward = turned_left(along).normalized(),
                  .length = along.norm(),
                  .thickness = infinity,
                  .edge = 0};
        const Vec2 start = mesh_.corner(triangle, side) + 0.5 * along;
        double sum = 0;
        constexpr int most = static_cast<int>(4 * enough_edges);  // triangles on the way across
        for (int n = 1; n <= most; ++n) {
            for (Index k = 0; k < 3; ++k) sum += mesh_.side_vector(triangle, k).norm() / 3;
            double leaves = 0;
            Index exit = -1;
            for (Index k = 0; k < 3; ++k) {
                const Vec2 a = mesh_.corner(triangle, k), s = mesh_.side_vector(triangle, k);
                const double speed = cross(face.inward, s);  // out of the triangle: positive
                if (k == side || speed <= 0) continue;
                const double at = cross(a - start, s) / speed;
                if (exit < 0 || at < leaves) leaves = at, exit = k;
            }
            if (exit < 0) return face;
            const Index next = neighbour_[3 * triangle + exit];
            if (next < 0) {
                const Vec2 axis = turned_left(face.inward);  // along which faces move where a part bends
                if (is_held(triangle, exit, face.inward) || is_held(face.triangle, face.side, face.inward) ||
                    (is_held(triangle, exit, axis) && is_held(face.triangle, face.side, axis)))
                    return face;
                face.thickness = leaves, face.edge = sum / n;
                return face;
            }
            for (side = 0; side < 3 && neighbour_[3 * next + side] != triangle;) ++side;
            triangle = next;
        }
        return face;
    }

    bool is_held(Index triangle, Index side, const Vec2& direction) const {
        return std::ranges::all_of(std::array{side, (side + 1) % 3}, [&](Index k) {
            const Index corner = 3 * triangle + k;
            const PrescribedMotion* motion = model_.motion_of(corner);
            const int component = std::abs(direction.x()) > std::abs(direction.y()) ? 0 : 1;
            return is_supported_[corner] || (motion != nullptr && motion->component[component]);
        });
    }

    /// [-] What acts, as parts of its kind: forces, driven motions, initial velocities, obstacles.
    std::vector<Vec2> find_actions() const {
        std::vector<Vec2> forces, motions, velocities, actions;
        for (const CornerLoad& load : model_.corner_loads) forces.push_back(load.force);
        for (const PrescribedMotion& motion : model_.prescribed) {
            Vec2 value = Vec2::Zero();
            for (int k = 0; k < 2; ++k)
                if (motion.component[k]) value[k] = motion.value[k];
            motions.push_back(value);
        }
        for (const Vec2& v : model_.initial_velocity) velocities.push_back(v);
        for (const std::vector<Vec2>* kind : {&forces, &motions, &velocities}) {
            Vec2 sum = Vec2::Zero();
            for (const Vec2& v : *kind) sum += v.cwiseAbs();
            if (sum.norm() > 0) actions.push_back(sum / sum.norm());
        }
        for (const Obstacle& obstacle : model_.obstacles)
            if (obstacle.outline.kind == Outline::Kind::half_plane) actions.push_back(obstacle.outline.normal);
            else actions.push_back((obstacle.start.position - centre()).normalized());
        return actions;
    }
    Vec2 centre() const {
        Vec2 sum = Vec2::Zero();
        for (const Vec2& x : mesh_.vertices) sum += x;
        return sum / static_cast<double>(mesh_.vertices.size());
    }
    bool is_bent(const Vec2& across) const {
        const bool by_heat = model_.heat != nullptr && (model_.heat->conduction || !model_.heat->field.is_uniform());
        return by_heat || !model_.crack_fluids.empty() || std::ranges::any_of(bends_, [&](const Vec2& action) {
                   return std::abs(action.x() * across.x()) + std::abs(action.y() * across.y()) > much_across;
               });
    }

    const Model& model_;
    const Mesh& mesh_;
    std::vector<Index> neighbour_;  // per triangle and side; -1: a surface
    std::vector<std::uint8_t> is_supported_;
    std::vector<Face> faces_;  // with few edges behind them
    std::vector<Vec2> bends_;
};

}  // namespace

/// In figures: what a clamped beam lacks of its deflection under a force at its end.
std::vector<Diagnostic> findings_of_bending(const ReadResult& read, const Model& model) {
    if (model.mesh.order != 1) return {};
    const auto part = ThinParts(model).thinnest();
    if (!part) return {};
    const std::string key = read.scenario.given ? "mesh.file" : "mesh.size";
    return {read.at(
        key,
        {.severity = Diagnostic::Severity::warning,
         .code = "bending",
         .message =
             formatted("a part of %s by %s at %s has %.1f edges across: triangles of first order are too stiff in "
                       "bending (a beam with 1, 2, 4 or 8 edges across bends by 71, 35, 10 or 3 %% too little)",
                       readable(part->length, "m").c_str(), readable(part->thickness, "m").c_str(),
                       place_text(part->place).c_str(), part->edges),
         .note = formatted("mesh.order = 2, or edges of %s there", readable(part->thickness / 8, "m", 2).c_str())})};
}

}  // namespace knap
