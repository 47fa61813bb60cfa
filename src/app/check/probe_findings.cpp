// Warnings about what probes watch and what collectors count.
#include "analysis/nearest.hpp"
#include "app/check/findings.hpp"
#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/selections.hpp"

#include <algorithm>

namespace knap {
namespace {

class ProbeFindings {
public:
    ProbeFindings(const ReadResult& read, const Model& model) : read_(read), model_(model) {}

    void look_at(std::size_t number) {
        const ProbeOptions& probe = read_.scenario.probes[number];
        if (probe.watch != ProbeOptions::Watch::place && probe.watch != ProbeOptions::Watch::interface) return;
        key_ = item("probe", number) + ".at", name_ = "probe `" + probe.name + "` at " + place_text(probe.at);
        std::vector<std::string> bodies;
        bool is_inside = false;
        for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
            if (!in_triangle(model_.mesh, t, probe.at)) continue;
            is_inside = true;
            if (const std::string body = body_of(t); bodies.empty() || bodies.back() != body) bodies.push_back(body);
        }
        const NearInterface near = nearest_interface(model_, probe.at);
        if (probe.watch == ProbeOptions::Watch::place) {
            if (bodies.size() > 1)
                warn("ambiguous",
                     "lies on bodies " + joined(bodies, " and ") + ": the mean of their motions is written",
                     "move it into one of them");
            else if (near.interface >= 0) look_at_faces(near);
        } else if (near.interface >= 0 && is_inside) {
            const Interface& interface = model_.interfaces[near.interface];
            if (near.distance > interface.length)
                warn("far",
                     formatted("is %s from the nearest interface that can open, a ",
                               readable(near.distance, "m").c_str()) +
                         kind_of(model_, interface) + ": it watches that one",
                     "move it to the interface that it is to watch");
        }
        if (is_inside) return;
        const NearBoundary nearest = nearest_boundary(model_.mesh, probe.at);
        if (nearest.distance <= 0.1 * nearest.edge) return;  // on a curve that the mesh follows by straight edges
        const Box box = bounding_box(model_.mesh.vertices);
        warn("outside",
             "lies outside the body, " + readable(nearest.distance, "m", 6) + " from its boundary: the nearest " +
                 (probe.watch == ProbeOptions::Watch::interface ? "interface" : "point of it") + " is used",
             "the body extends from " + place_text(box.low) + " to " + place_text(box.high));
    }

    std::vector<Diagnostic> found;

private:
    /// A place on two faces that move apart.
    void look_at_faces(const NearInterface& near) {
        const Interface& interface = model_.interfaces[near.interface];
        if (near.distance < 1e-6 * interface.length && is_open_from_start(model_, interface) &&
            interface.triangle[0] != rigid_support)
            warn("ambiguous", "lies on two faces that move apart: the mean of their motions is written",
                 "move it to one side, or watch = \"interface\", which has opening and slip");
    }

    std::string body_of(Index triangle) const {
        const auto part = std::ranges::find_if(
            model_.mesh.parts, [&](const MeshPart& p) { return triangle < p.first_triangle + p.n_triangles; });
        return part == model_.mesh.parts.end() ? "" : part->name;
    }

    void warn(const char* code, const std::string& message, std::string note) {
        found.push_back(read_.at(key_, {.severity = Diagnostic::Severity::warning,
                                        .code = code,
                                        .message = name_ + " " + message,
                                        .note = std::move(note)}));
    }

    const ReadResult& read_;
    const Model& model_;
    std::string key_, name_;  // of the present probe
};

}  // namespace

std::vector<Diagnostic> findings_of_probes(const ReadResult& read, const Model& model) {
    ProbeFindings findings(read, model);
    for (std::size_t i = 0; i < read.scenario.probes.size(); ++i) findings.look_at(i);
    return std::move(findings.found);
}

std::vector<Diagnostic> findings_of_collectors(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    if (read.scenario.collectors.empty()) return found;
    const State start = initial_state(model);
    for (std::size_t k = 0; k < read.scenario.collectors.size(); ++k) {
        const CollectorOptions& collector = read.scenario.collectors[k];
        if (!collector.x || std::isfinite(ground_below(model, start, {*collector.x, infinity}))) continue;
        found.push_back(read.at(
            item("collector", k) + ".x",
            {.code = "no-ground",
             .message = "no obstacle lies below the collector `" + collector.name + "`: its passages have no height",
             .note = "from and to give a line whose lower end is the origin of heights"}));
    }
    return found;
}

}  // namespace knap
