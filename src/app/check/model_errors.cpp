// Errors of a scenario that only its mesh shows.
#include "analysis/probes.hpp"
#include "analysis/rest_watch.hpp"
#include "app/check/findings.hpp"
#include "app/setup/adaptation.hpp"
#include "app/setup/process.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "base/union_find.hpp"
#include "figures/animation.hpp"
#include "mesh/polygon.hpp"
#include "model/contradictions.hpp"
#include "model/make_model.hpp"
#include "scenario/reading.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/contact/face_contacts.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <set>

namespace knap {
namespace {

/// An error at a key.
Diagnostic finding(const ReadResult& read, const std::string& key, const char* code, std::string message,
                   std::string note) {
    return read.at(key, {.code = code, .message = std::move(message), .note = std::move(note)});
}

// ---- contradicting loads

/// "`load[0]` (line 16)", "`load[1]` `upper edge` (line 20)"
std::string named(const ReadResult& read, std::size_t load) {
    const std::string path = item("load", load), &name = read.scenario.loads[load].name;
    const int line = read.at(path, {}).line;
    return "`" + path + "`" + (name == "load" + std::to_string(load) ? "" : " `" + name + "`") +
           (line > 0 ? formatted(" (line %d)", line) : "");
}

std::string motion_text(const Load& load, int k) {
    const bool velocity = load.kind == Load::Kind::velocity;
    return (velocity ? "velocity " : "displacement ") +
           formatted("%.6g %s on ", *load.value[k], velocity ? "m/s" : "m") +
           (load.on.boundary.empty() ? "its box" : "`" + load.on.boundary + "`");
}

Diagnostic described(const ReadResult& read, const Contradiction& c) {
    const auto& loads = read.scenario.loads;
    const auto [a, b] = c.load;
    const std::string both = named(read, a) + " and " + named(read, b), k = c.component == 0 ? "x" : "y";
    const char* const selection = "on = { boundary = \"...\", box = [...] }";
    if (c.kind == Contradiction::Kind::motions)
        return finding(read, item("load", b), "contradiction",
                       both + " prescribe different motions in " + k + " of their common nodes at " +
                           place_text(c.where) + ": " + motion_text(loads[a], c.component) + ", " +
                           motion_text(loads[b], c.component),
                       "make " + k +
                           " of one of them \"free\", prescribe the same motion in both, or end one of them "
                           "before that place: " +
                           selection);
    const bool traction = c.kind == Contradiction::Kind::traction;
    return finding(read, item("load", b), "contradiction",
                   both + " apply " + (traction ? "a traction" : "a force") + " and a motion in " + k +
                       " to the same " + (traction ? "edges" : "nodes") + ", first at " + place_text(c.where) +
                       ": the prescribed motion would carry all of it",
                   "remove one of them, make " + k + " of the motion \"free\", or separate them: " + selection);
}

// ---- bodies without support

/// Bodies: triangles connected by interfaces, cracked or not, since contact may hold a cracked one, and by free faces
/// that touch: whether they hold each other shows the search of the equilibrium.
struct BodiesAtStart {
    std::vector<Index> of_triangle;        // the lowest triangle of the body
    std::vector<std::uint8_t> is_carried;  // [0/1] at this triangle: it touches a support, the ground or an obstacle
};

BodiesAtStart bodies_of(const Model& model) {
    constexpr double closed_gap = 1e-5;  // [-] of an edge: the search cannot bring closer what nothing else holds
    const Mesh& mesh = model.mesh;
    const State start = initial_state(model);
    UnionFind bodies(mesh.triangles.size());
    std::vector<Index> carried;  // triangles
    for (const InteriorEdge& edge : mesh.interior_edges) bodies.join(edge.triangle[0], edge.triangle[1]);
    for (const Interface& interface : model.interfaces)
        if (interface.triangle[0] == rigid_support && interface.gap <= closed_gap * interface.length)
            carried.push_back(interface.triangle[1]);
    if (model.faces_meet()) {
        FaceContacts faces(model);
        faces.find(start, 0);
        for (const FaceContact& at : faces.all()) {
            if (at.gap > closed_gap * at.length) continue;
            const Index vertex = at.vertex[1], edge = at.edge[0];
            if (model.ground_at(vertex)) carried.push_back(mesh.triangle_of(edge));
            else if (model.ground_at(edge)) carried.push_back(mesh.triangle_of(vertex));
            else bodies.join(mesh.triangle_of(vertex), mesh.triangle_of(edge));
        }
    }
    ObstacleContacts obstacles(model);
    obstacles.find(start, 0, std::vector<Vec3>(model.obstacles.size(), Vec3::Zero()), {});
    for (const ObstacleContact& at : obstacles.all()) {
        const Index t = mesh.triangle_of(at.corner);
        const double size = bounding_box({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}).diagonal();
        if (at.gap <= closed_gap * size) carried.push_back(t);
    }
    BodiesAtStart found{.of_triangle = {}, .is_carried = std::vector<std::uint8_t>(mesh.triangles.size(), 0)};
    for (Index t = 0; t < mesh.n_triangles(); ++t) found.of_triangle.push_back(bodies.find(t));
    for (const Index t : carried) found.is_carried[bodies.find(t)] = 1;
    return found;
}

/// [m] From a body to what is nearest to it: another body, an obstacle, a support; infinite where there is nothing.
double clearance(const Model& model, const std::vector<Index>& body, Index which) {
    const Mesh& mesh = model.mesh;
    std::vector<Segment> own, others;
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        const auto ends = mesh.side_vertices(edge.triangle, edge.side);
        (body[edge.triangle] == which ? own : others).push_back({mesh.vertices[ends[0]], mesh.vertices[ends[1]]});
    }
    double least = infinity;
    for (const Segment& side : own) {
        if (model.faces_meet())
            for (const Segment& other : others) least = std::min(least, distance_between(side, other));
        for (const Obstacle& obstacle : model.obstacles)
            least = std::min(least, ObstacleSurface(obstacle.outline, obstacle.start).distance_to(side.a).gap);
    }
    for (const Interface& interface : model.interfaces)
        if (interface.triangle[0] == rigid_support && body[interface.triangle[1]] == which)
            least = std::min(least, interface.gap);
    return least;
}

/// Loads on a body at t = 0 and the rigid motions that its supports prevent, in (x, y, rotation about `centre` times
/// `length`).
struct Balance {
    Vec2 centre;
    double length;                                   // [m]
    Eigen::Vector3d load = Eigen::Vector3d::Zero();  // [N]
    double size = 0;                                 // [N] sum of the magnitudes of the forces
    Eigen::Matrix3d held = Eigen::Matrix3d::Zero();  // sum of d d' over the prevented motions d

    Eigen::Vector3d direction(int k, const Vec2& x) const {
        const Vec2 arm = (x - centre) / length;
        return k == 0 ? Eigen::Vector3d(1, 0, -arm.y()) : Eigen::Vector3d(0, 1, arm.x());
    }
    /// The part of the load that no support carries.
    Eigen::Vector3d unheld() const {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(held);
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i)
            if (modes.eigenvalues()[i] <= 1e-9 * std::max(1.0, modes.eigenvalues()[2]))
                sum += modes.eigenvectors().col(i).dot(load) * modes.eigenvectors().col(i);
        return sum;
    }
};

Balance balance_of(const Model& model, const std::vector<Index>& body, Index which) {
    const Mesh& mesh = model.mesh;
    std::vector<Vec2> corners;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (Index k = 0; k < 3 && body[t] == which; ++k) corners.push_back(mesh.corner(t, k));
    const Box box = bounding_box(corners);
    Balance balance{.centre = 0.5 * (box.low + box.high), .length = 0.5 * (box.high - box.low).norm()};
    for (const CornerLoad& at : model.corner_loads) {
        if (body[mesh.triangle_of(at.corner)] != which) continue;
        const Vec2 force = model.histories[at.history](0) * at.force;
        for (int k = 0; k < 2; ++k) balance.load += force[k] * balance.direction(k, mesh.corner(at.corner));
        balance.size += force.norm();
    }
    for (Index c = 0; c < mesh.n_corners(); ++c) {
        const Index motion = model.prescribed_of_corner[c];
        if (motion < 0 || body[mesh.triangle_of(c)] != which) continue;
        for (int k = 0; k < 2; ++k) {
            if (!model.prescribed[motion].component[k]) continue;
            const Eigen::Vector3d direction = balance.direction(k, mesh.corner(c));
            balance.held += direction * direction.transpose();
        }
    }
    return balance;
}

void refuse_unheld_bodies(const ReadResult& read, const Model& model) {
    if (!read.scenario.time.start_in_equilibrium) return;
    const auto [body, is_carried] = bodies_of(model);
    const auto n_bodies = std::set<Index>(body.begin(), body.end()).size();
    std::string first, cure;
    int n_unheld = 0;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        if (body[t] != t || is_carried[t]) continue;
        const Balance balance = balance_of(model, body, t);
        const Eigen::Vector3d unheld = balance.unheld();
        if (unheld.norm() <= 1e-6 * balance.size || n_unheld++ > 0) continue;
        const double gap = clearance(model, body, t);
        const bool passes = n_bodies > 1 && !model.faces_meet(), hovers = !passes && gap < balance.length;
        first = formatted(
            "`time.start` requests equilibrium, but nothing holds the body around %s%s: a force of (%.3g, "
            "%.3g) N and a moment of %s of the loads at t = 0 would move it away",
            place_text(balance.centre).c_str(),
            hovers ? (", which hovers " + readable(gap, "m") + " from what is nearest").c_str() : "", unheld.x(),
            unheld.y(),
            readable(std::abs(unheld.z()) > 1e-9 * balance.size ? unheld.z() * balance.length : 0, "N m").c_str());
        if (hovers) cure = "close the gap (faces touch within 1e-5 of an edge), ";
        if (passes) cure = "let bodies meet each other ([contact]), ";
    }
    if (n_unheld > 1) first += formatted("; so it is with %d more", n_unheld - 1);
    if (n_unheld > 0)
        throw UserError(
            {finding(read, "time.start", "not-held", first,
                     cure + "hold it (a load with displacement = [0, 0], a [[support]]), balance the loads, "
                            "let them start with a ramp, or use start = \"rest\"")});
}

/// Probes that find nothing, and tips that cannot be integrated.
void refuse_probes(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    for (std::size_t i = 0; i < read.scenario.probes.size(); ++i) try {
            Probes(model, {read.scenario.probes[i]});
        } catch (const SimulationError& error) {
            found.push_back(finding(read, item("probe", i), "probe", error.what(), ""));
        }
    if (!found.empty()) throw UserError(std::move(found));
}

/// The entry of [[initial]] that has velocity or stress `number` of the scenario.
std::size_t entry_of_initial(const ReadResult& read, std::size_t number, bool velocity) {
    std::vector<std::size_t> entries;
    for (std::size_t i = 0; i < read.values.count("initial"); ++i) {
        const auto has = [&](const char* key) { return read.values.has(item("initial", i) + "." + key); };
        if (velocity ? std::ranges::any_of(keys_of_initial_motion, has) : has("stress")) entries.push_back(i);
    }
    const std::size_t n_of_bodies = velocity ? read.scenario.initial_velocities.size() - entries.size() : 0;
    return entries.at(number - n_of_bodies);  // those of bodies come first
}

constexpr double much_of_map = 0.2;  // [-] of the length or number of cracks, that snap leaves out

/// The first crack of a body that stands in a data file, with its line; empty where none does.
std::string first_of_file(const Scenario& scenario, const Body& body) {
    for (const PlacedSet& set : scenario.placed_sets)
        if (&scenario.bodies[set.body] == &body && !set.is_random())
            return scenario.table_of_part(set.body, set.part, set.first, body.path + ".crack");
    return "";
}

/// Cracks that the snap of their body leaves out: an error where none is left, a warning where many are missing.
std::vector<Diagnostic> findings_of_snap(const ReadResult& read) {
    std::vector<Diagnostic> found;
    for (const Body& body : read.scenario.bodies) {
        if (!(body.shape.snap > 0) || body.shape.cracks.empty()) continue;
        const CrackLengths lengths(body.shape);
        std::vector<double> inside;  // [m] each
        double drawn = 0, lost = 0;  // [m] snap may make others longer
        std::size_t n_lost = 0;
        for (std::size_t i = 0; i < lengths.drawn.size(); ++i) {
            drawn += lengths.drawn[i], lost += std::max(0.0, lengths.drawn[i] - lengths.after[i]);
            if (lengths.drawn[i] > 0) inside.push_back(lengths.drawn[i]), n_lost += lengths.after[i] == 0;
        }
        const double n = static_cast<double>(inside.size());
        if (inside.empty() || (lost < much_of_map * drawn && static_cast<double>(n_lost) < much_of_map * n)) continue;
        const auto middle = inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 2);
        std::ranges::nth_element(inside, middle);
        const std::string key = body.path + ".snap";
        const std::string data = n_lost == inside.size() ? first_of_file(read.scenario, body) : "";
        found.push_back(read.at(
            data.empty() ? key : data,
            {.severity = n_lost == inside.size() ? Diagnostic::Severity::error : Diagnostic::Severity::warning,
             .code = "lost-cracks",
             .message = formatted("`%s` = %s leaves out %zu of %zu cracks, and %s of their %s", key.c_str(),
                                  readable(body.shape.snap, "m").c_str(), n_lost, inside.size(),
                                  readable(lost, "m").c_str(), readable(drawn, "m").c_str()),
             .note = "a snap far below the length of the cracks, half of which are shorter than " +
                     readable(*middle, "m") +
                     (data.empty() ? "" : "; or the right unit of the file, whose coordinates may have another")}));
    }
    return found;
}

}  // namespace

Model model_of(ReadResult& read) {
    try {
        Model model = build_model(read.scenario);
        if (const std::string reason = replace_where_it_does_not_pay(read.scenario, model.mesh); !reason.empty()) {
            read.warnings.push_back(read.at("adapt", {.severity = Diagnostic::Severity::warning,
                                                      .code = "adapt",
                                                      .message = reason,
                                                      .note = "a larger adapt.load, a smaller adapt.size, or "
                                                              "[[mesh.refine]] along a path that is known"}));
            model = build_model(read.scenario);
        }
        std::vector<Diagnostic> found;
        for (Diagnostic& of_snap : findings_of_snap(read))
            (of_snap.severity == Diagnostic::Severity::error ? found : read.warnings).push_back(std::move(of_snap));
        for (const Contradiction& c : find_contradictions(model, read.scenario.loads))
            found.push_back(described(read, c));
        if (!found.empty()) throw UserError(std::move(found));
        return model;
    } catch (const ShapeError& error) {
        throw UserError(read.at_shapes(error));
    } catch (const ObstacleInBody& error) {
        throw UserError({read.at(item("obstacle", error.number), error.diagnostics.front())});
    } catch (const EmptySelection& error) {
        const char* const lists[] = {"load", "support", "initial", "pressure", "initial"};  // of EmptySelection::List
        const bool velocity = error.list == EmptySelection::initial_velocities,
                   initial = velocity || error.list == EmptySelection::initial_stresses;
        const std::size_t number = initial ? entry_of_initial(read, error.number, velocity) : error.number;
        throw UserError(
            {read.at(item(lists[error.list], number) + (initial ? ".box" : ".on"), error.diagnostics.front())});
    } catch (const BadPlace& error) {
        throw UserError({read.in_file(error.path, 0, error.diagnostics.front())});
    }
}

StepPlan plan_of(const ReadResult& read, const Model& model, double until) {
    try {
        StepPlan plan = plan_steps(read.scenario.time, read.scenario.adapt, model, until);
        for (const AllowedLimit& limit : read.scenario.allowed_limits)
            if (limit.gate == "contact_depth") plan.limits.contact_depth = limit.limit;
        return plan;
    } catch (const BadStep& error) {
        throw UserError({read.at(error.key, error.diagnostics.front())});
    }
}

void check_picture_size(const FigureOptions& figure, const Vec2& extent) {
    const Vec2 size = picture_size(figure, extent);
    const double longest = longest_side(figure), memory = drawing_memory(figure, extent), free = free_memory();
    const auto refuse = [&](double factor, const std::string& text) {
        throw UserError("figure-width",
                        formatted("`width` = %d: the picture would have about %.0f x %.0f pixels, ", figure.width,
                                  size.x(), size.y()) +
                            text,
                        formatted("a width of at most %.0f", std::floor(factor * figure.width / 100) * 100));
    };
    if (size.maxCoeff() > longest)
        refuse(longest / size.maxCoeff(),
               formatted("and `%s` can have %.0f on a side at most", figure.file.c_str(), longest));
    if (memory > free)
        refuse(0.9 * std::sqrt(free / memory), formatted("needs some %.2g GB of memory while it is drawn, and %.2g GB "
                                                         "are free",
                                                         1e-9 * memory, 1e-9 * free));
}

std::vector<Diagnostic> check_model(const ReadResult& read, const Model& model) {
    const Vec2 extent = bounding_box(model.mesh.vertices).extent();
    for (std::size_t i = 0; i < read.scenario.figures.size(); ++i) try {
            const FigureOptions& figure = read.scenario.figures[i];
            check_picture_size(figure, figure.box ? figure.box->extent() : extent);
        } catch (const UserError& error) {
            throw UserError({read.at(item("figure", i) + ".width", error.diagnostics.front())});
        }
    for (std::size_t i = 0; i < read.scenario.figures.size(); ++i)
        if (const FigureOptions& figure = read.scenario.figures[i]; figure.is_animation()) try {
                check_animation(figure.file);  // not only at the end of a long run
            } catch (const UserError& error) {
                throw UserError({read.at(item("figure", i) + ".file", error.diagnostics.front())});
            }
    if (read.scenario.specimen) try {
            Specimen(model, Reactions(model), *read.scenario.specimen);
        } catch (const UserError& error) {
            throw UserError({read.at("specimen", error.diagnostics.front())});
        }
    refuse_probes(read, model);
    refuse_unheld_bodies(read, model);
    std::vector<Diagnostic> of_obstacles = findings_of_obstacles(read, model);
    for (const Diagnostic& found : of_obstacles)
        if (found.severity == Diagnostic::Severity::error) throw UserError({found});
    if (read.scenario.time.rest.ends_run && std::isinf(settling_time(model)) && settling_time(model) > 0)
        throw UserError({finding(read, "time.until", "never-rests",
                                 "`time.until` = \"rest\", but a load or an obstacle is driven at a velocity for ever",
                                 "until = \"end\", or a history that ends at 0")});
    return of_obstacles;
}

}  // namespace knap
