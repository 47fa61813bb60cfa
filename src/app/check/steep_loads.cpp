// Warnings about loads that rise faster than the mesh carries a wave.
#include "app/check/findings.hpp"

#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/selections.hpp"
#include "model/time_tables.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double edges_of_front = 5;
/// [-] of the strength: a front that returns from a free face and meets another one, and overshoots by a third, stays
/// below the strength where it rises by less.
constexpr double much = 1. / 3;

/// Like largest_rise, of the slope of a history [1/s].
Rise rise_of_slope(const TimeFunction& history, double first, double passage, double end) {
    Rise rise;
    for (std::size_t i = 0; i < history.time.size(); ++i) {
        const double t = history.time[i], before = t <= 0 ? first : history.slope_before(t);
        if (t < 0 || t >= end) continue;
        for (std::size_t j = i + 1; j < history.time.size(); ++j) {
            rise.include(history.slope_before(history.time[j]) - before, t);
            if (history.time[j] >= t + passage) break;
        }
    }
    return rise;
}

class SteepLoads {
public:
    SteepLoads(const ReadResult& read, const Model& model)
        : time_(read.scenario.time), loads_(read.scenario.loads), model_(model), mesh_(model.mesh) {
        for (const CohesiveLaw& law : model.laws)
            if (law.breakable() && law.sigma_c > 0) strength_ = std::min(strength_, law.sigma_c);
        is_at_rest_ = !time_.start_in_equilibrium && time_.start_run.empty() && model.initial_stress.empty();
    }

    std::vector<Diagnostic> found(const ReadResult& read) const {
        std::vector<Diagnostic> warnings;
        for (std::size_t i = 0; i < loads_.size() && std::isfinite(strength_); ++i)
            if (auto warning = judge(item("load", i), loads_[i]))
                warnings.push_back(read.at(item("load", i), *warning));
        return warnings;
    }

private:
    struct Face {
        const BoundaryEdge* edge = nullptr;
        double length = 0, passage = 0;  // [m] mean edge over the order, [s] of a wave through it
    };
    /// The face of the load through which a wave takes longest, in a material without viscosity.
    Face slowest(const Load& load) const {
        Face slow;
        for (const std::size_t e : selected_edges(mesh_, load.on)) {
            const BoundaryEdge& edge = mesh_.boundary_edges[e];
            const Elastic& material = model_.materials[mesh_.region[edge.triangle]];
            double length = 0;
            for (Index k = 0; k < 3; ++k) length += mesh_.side_vector(edge.triangle, k).norm() / 3 / mesh_.order;
            const double passage = length / material.dilatational_speed(model_.plane);
            if (!material.has_viscosity() && passage > slow.passage) slow = {&edge, length, passage};
        }
        return slow;
    }

    /// [Pa] Of the wave that enters at the face, and when it starts to rise.
    Rise stress_rise(const Load& load, const Face& face) const {
        const double window = edges_of_front * face.passage, end = time_.end;
        const Vec2 along = mesh_.side_vector(face.edge->triangle, face.edge->side);
        if (!load.drives()) {
            const Vec2 middle = mesh_.corner(face.edge->triangle, face.edge->side) + 0.5 * along,
                       traction = load.traction_on(turned_left(along).normalized(), middle, 0);
            Rise rise = largest_rise(load.history, is_at_rest_ ? 0 : load.history(0), window, end);
            return rise.size *= traction.norm(), rise;
        }
        const Elastic& material = model_.materials[mesh_.region[face.edge->triangle]];
        // behind the face: corners with a prescribed velocity start with it
        const Index behind = mesh_.corners_per_triangle() * face.edge->triangle + (face.edge->side + 2) % 3;
        const Vec2 start = model_.initial_velocity_of(behind);
        Rise largest;
        for (int k = 0; k < 2; ++k) {
            const double value = load.value[k].value_or(0);
            if (value == 0) continue;
            const bool slope = load.kind == Load::Kind::displacement;
            const double first = is_at_rest_ ? start[k] / value : slope ? 0 : load.history(0);
            const Rise rise = (slope ? rise_of_slope : largest_rise)(load.history, first, window, end);
            largest.include(material.density * material.dilatational_speed(model_.plane) * value * rise.size,
                            rise.time);
        }
        return largest;
    }

    std::optional<Diagnostic> judge(const std::string& path, const Load& load) const {
        using Kind = Load::Kind;
        if (load.kind == Kind::force || load.kind == Kind::body_force || load.kind == Kind::acceleration) return {};
        const Face face = slowest(load);
        if (face.edge == nullptr) return {};
        const Rise rise = stress_rise(load, face);
        if (!(rise.size > much * strength_)) return {};
        const double front = edges_of_front * face.passage;
        return Diagnostic{
            .severity = Diagnostic::Severity::warning,
            .code = "steep-wave",
            .message = formatted(
                "`%s` sends a wave whose stress changes by %s at t = %s within %s, in which it passes %g edges at %s: "
                "behind such a front the mesh overshoots by up to a third, and the smallest strength is %s",
                path.c_str(), readable(rise.size, "Pa").c_str(), readable(rise.time, "s").c_str(),
                readable(front, "s").c_str(), edges_of_front,
                place_text(mesh_.corner(face.edge->triangle, face.edge->side)).c_str(),
                readable(strength_, "Pa").c_str()),
            .note = formatted("bulk_viscosity = [0.06, 1.2] in its material, a ramp longer than %s, smaller edges (%s "
                              "there), or mesh.order = 2",
                              readable(front, "s", 2).c_str(), readable(face.length * mesh_.order, "m", 2).c_str())};
    }

    const TimeOptions& time_;
    const std::vector<Load>& loads_;
    const Model& model_;
    const Mesh& mesh_;
    double strength_ = infinity;  // [Pa] smallest of all laws
    bool is_at_rest_;             // the run does not start in an equilibrium under the loads, nor with a stress of its
                                  // own, whose part that they do not balance is another warning
};

}  // namespace

std::vector<Diagnostic> findings_of_steep_loads(const ReadResult& read, const Model& model) {
    if (read.scenario.time.scheme.bulk == BulkScheme::implicit_theta) return {};
    return SteepLoads(read, model).found(read);
}

}  // namespace knap
