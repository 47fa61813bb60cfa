// Loads that contradict each other, that nothing holds, or that jump.
#include "app/run/model_findings.hpp"

#include "app/run/run.hpp"
#include "base/union_find.hpp"
#include "model/contradictions.hpp"
#include "model/obstacle.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace knap {
namespace {

const char* const axis[] = {"x", "y"};

/// "`load[1]` (line 20)", "`load[1]` `upper edge` (line 20)"
std::string named(const ReadResult& read, std::size_t load) {
    const std::string path = item("load", load);
    const Diagnostic at = read.at(path, {});
    const std::string& name = read.scenario.loads[load].name;
    return "`" + path + "`" + (name == "load" + std::to_string(load) ? "" : " `" + name + "`") + (at.line > 0 ? " (line " + std::to_string(at.line) + ")" : "");
}

std::string boundary_of(const Load& load) { return load.on.boundary.empty() ? "its box" : "`" + load.on.boundary + "`"; }

const char* unit_of(Load::Kind kind) { return kind == Load::Kind::velocity ? "m/s" : "m"; }

std::string motion_text(const Load& load, int k) {
    return (load.kind == Load::Kind::velocity ? "velocity " : "displacement ") + with_unit(*load.value[k], unit_of(load.kind)) + " on " + boundary_of(load);
}

Diagnostic described(const ReadResult& read, const Contradiction& c) {
    const auto& loads = read.scenario.loads;
    const auto [a, b] = c.load;
    Diagnostic d = read.at(item("load", b), {});
    d.code = "contradiction";
    const std::string both = named(read, a) + " and " + named(read, b), k = axis[c.component], at = place_text(c.where);
    if (c.kind == Contradiction::Kind::motions) {
        d.message = both + " prescribe different motions in " + k + " of what they share at " + at + ": " + motion_text(loads[a], c.component) + ", " +
                    motion_text(loads[b], c.component);
        d.note = "make " + k + " of one of them \"free\", give both the same motion, or let one end before the place: on = { boundary = \"...\", box = [...] }";
    } else {
        const std::string what = c.kind == Contradiction::Kind::traction ? "a traction" : "a force";
        d.message = both + " give " + what + " and a motion in " + k + " to the same " + (c.kind == Contradiction::Kind::traction ? "edges" : "nodes") + ", first at " + at +
                    ": the support alone would carry it";
        d.note = "leave one of them out, make " + k + " of the motion \"free\", or part them: on = { boundary = \"...\", box = [...] }";
    }
    return d;
}

/// Triangles that an interface joins, cracked or not, are one body: contact may hold what is cracked.
std::vector<Index> bodies_of(const Model& model) {
    UnionFind bodies(model.mesh.triangles.size());
    for (const InteriorEdge& edge : model.mesh.interior_edges) bodies.join(edge.triangle[0], edge.triangle[1]);
    std::vector<Index> body(model.mesh.n_triangles());
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) body[t] = bodies.find(t);
    return body;
}

/// Loads on a body at t = 0 and what its supports leave free, in (x, y, turn about `centre` times `length`).
struct Balance {
    Vec2 centre;
    double length;                                        // [m]
    Eigen::Vector3d load = Eigen::Vector3d::Zero();       // [N]
    double size = 0;                                      // [N] sum of the forces' sizes
    Eigen::Matrix3d held = Eigen::Matrix3d::Zero();       // sum of the held directions' squares

    static Eigen::Vector3d direction(int k, const Vec2& arm) { return k == 0 ? Eigen::Vector3d(1, 0, -arm.y()) : Eigen::Vector3d(0, 1, arm.x()); }
    void add_force(const Vec2& x, const Vec2& force) {
        for (int k = 0; k < 2; ++k) load += force[k] * direction(k, (x - centre) / length);
        size += force.norm();
    }
    void hold(const Vec2& x, int k) {
        const Eigen::Vector3d row = direction(k, (x - centre) / length);
        held += row * row.transpose();
    }
    /// The part of the load that no support takes.
    Eigen::Vector3d unheld() const {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(held);
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i)
            if (modes.eigenvalues()[i] <= 1e-9 * std::max(1.0, modes.eigenvalues()[2])) sum += modes.eigenvectors().col(i).dot(load) * modes.eigenvectors().col(i);
        return sum;
    }
};

Balance balance_of(const Model& model, const std::vector<Index>& body, Index which) {
    const Mesh& mesh = model.mesh;
    Vec2 low = Vec2::Constant(1e300), high = -low;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (Index k = 0; k < 3 && body[t] == which; ++k) low = low.cwiseMin(mesh.corner(t, k)), high = high.cwiseMax(mesh.corner(t, k));
    Balance balance{.centre = 0.5 * (low + high), .length = 0.5 * (high - low).norm()};
    for (const CornerLoad& at : model.corner_loads)
        if (body[mesh.triangle_of(at.corner)] == which) balance.add_force(mesh.corner(at.corner), model.histories[at.history](0) * at.force);
    for (Index c = 0; c < mesh.n_corners(); ++c) {
        const Index motion = model.prescribed_of_corner[c];
        if (motion < 0 || body[mesh.triangle_of(c)] != which) continue;
        for (int k = 0; k < 2; ++k)
            if (model.prescribed[motion].component[k]) balance.hold(mesh.corner(c), k);
    }
    return balance;
}

struct Jump {
    double size = 0, time = 0;  // [m], [s]
    void meet(double other, double when) {
        if (other > size) size = other, time = when;
    }
};

/// The largest that a history times a value [m] makes before the end of the run: from nothing at t = 0, unless the body begins deformed by it; between two values
/// of one time; and within less than a step where it goes faster than `fast` [m/s].
Jump largest_jump(const TimeFunction& history, double value, const Scenario& scenario, double step, double fast) {
    Jump jump;
    if (!scenario.time.start_in_equilibrium) jump.meet(std::abs(value * history(0)), 0);
    for (std::size_t i = 0; i + 1 < history.time.size(); ++i) {
        const double from = history.time[i], lasts = history.time[i + 1] - from;
        if (from < 0 || from >= scenario.time.end || lasts >= step) continue;
        const double moved = std::abs(value * ((lasts > 0 ? history(from + step) : history.value[i + 1]) - history.value[i]));
        if (lasts == 0 || moved > fast * step) jump.meet(moved, from);
    }
    return jump;
}

void warn_of_jump(const ReadResult& read, double h, double wave, const std::string& path, const Jump& jump, std::vector<Diagnostic>& found) {
    if (jump.size == 0) return;
    const double speed = jump.size / h;
    char text[280];
    std::snprintf(text, sizeof text,
                  "`%s.displacement` jumps by %.3g m at once at t = %.3g s: in a step of %.3g s that is a velocity of %.3g m/s, %.2g times the speed of waves", path.c_str(),
                  jump.size, jump.time, h, speed, speed / wave);
    char cure[200];
    std::snprintf(cure, sizeof cure,
                  "ramp = \"%.2g s\" would move it at 1 m/s; or a table that begins at 0; or time.start = \"equilibrium\" for what is there before t = 0", jump.size);
    found.push_back(warning_at(read, path + ".displacement", "jump", text, cure));
}

}  // namespace

void refuse_contradictions(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    for (const Contradiction& c : find_contradictions(model, read.scenario.loads)) found.push_back(described(read, c));
    if (!found.empty()) throw UserError(std::move(found));
}

void refuse_unheld_body(const ReadResult& read, const Model& model) {
    if (!read.scenario.time.start_in_equilibrium || !model.obstacles.empty()) return;  // obstacles may hold it
    const std::vector<Index> body = bodies_of(model);
    std::vector<char> stands(body.size(), 0);  // on a support, which may hold it
    for (const Interface& interface : model.interfaces)
        if (interface.triangle[0] == rigid_support) stands[body[interface.triangle[1]]] = 1;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        if (body[t] != t || stands[t]) continue;
        const Balance balance = balance_of(model, body, t);
        const Eigen::Vector3d unheld = balance.unheld();
        if (!(unheld.norm() > 1e-6 * balance.size)) continue;
        char text[300];
        std::snprintf(text, sizeof text,
                      "`time.start` asks for equilibrium, and nothing holds the body round (%.6g, %.6g) m: a force of (%.3g, %.3g) N and a moment of %.3g N m "
                      "of the loads at t = 0 would move it away",
                      balance.centre.x(), balance.centre.y(), unheld.x(), unheld.y(), unheld.z() * balance.length);
        Diagnostic d = read.at("time.start", {});
        d.code = "not-held";
        d.message = text;
        d.note = "hold it (a load with displacement = [0, 0], a [[support]]), balance the loads, let them begin with a ramp, or start = \"rest\"";
        throw UserError({d});
    }
}

std::vector<Diagnostic> findings_of_loads(const ReadResult& read, const Model& model, const StepPlan& plan) {
    std::vector<Diagnostic> found;
    const Scenario& scenario = read.scenario;
    double wave = 0;
    for (const Elastic& material : model.materials) wave = std::max(wave, material.dilatational_speed(model.plane));
    const double h = plan.limits.largest, fast = 0.1 * wave;  // faster than any solid bears
    for (std::size_t i = 0; i < scenario.loads.size(); ++i) {
        const Load& load = scenario.loads[i];
        if (load.kind != Load::Kind::displacement) continue;
        const Vec2 value(load.value[0].value_or(0), load.value[1].value_or(0));
        warn_of_jump(read, h, wave, item("load", i), largest_jump(load.history, value.norm(), scenario, h, fast), found);
    }
    for (std::size_t i = 0; i < scenario.obstacles.size(); ++i) {
        Jump jump;
        for (const Drive& drive : scenario.obstacles[i].drive) {
            if (drive.kind != Drive::Kind::displacement) continue;
            const Jump other = largest_jump(drive.history, drive.value, scenario, h, fast);
            jump.meet(other.size, other.time);
        }
        warn_of_jump(read, h, wave, item("obstacle", i), jump, found);
    }
    return found;
}

}  // namespace knap
