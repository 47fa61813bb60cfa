// Warnings about fluids in cracks on their mesh.
#include "app/run/findings.hpp"

#include "stepper/common/crack_forces.hpp"

#include <algorithm>
#include <ranges>

namespace knap {

/// A fluid may wait for a crack: at a joint that still holds. At other places that is rarely meant.
std::vector<Diagnostic> findings_of_fluids(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    if (model.crack_fluids.empty()) return found;
    const std::vector<double> wetted = CrackForces(model).wetted(initial_state(model));
    for (std::size_t i = 0; i < wetted.size(); ++i) {
        const auto begins_at_source = [&](std::size_t edge) {
            return model.mesh.interior_edges[edge].joint >= 0 &&
                   std::ranges::any_of(model.interfaces[edge].vertex,
                                       [&](Index v) { return model.crack_fluids[i].is_source[v] != 0; });
        };
        const auto edges = std::views::iota(std::size_t{0}, model.mesh.interior_edges.size());
        if (wetted[i] > 0 || std::ranges::any_of(edges, begins_at_source)) continue;
        const std::string path = item("pressure", i);
        found.push_back(read.at(
            path, {.severity = Diagnostic::Severity::warning,
                   .code = "pressure-enters-nothing",
                   .message = "`" + path +
                              "` presses on nothing at t = 0: no crack and no joint begins at its source, and it "
                              "enters only cracks that will begin there",
                   .note = "from = { boundary = \"...\" } or { box = [...] } where a [[domain.crack]] begins, or "
                           "joints = \"NAME\"; on the boundary itself: [[load]] with pressure"}));
    }
    return found;
}

}  // namespace knap
