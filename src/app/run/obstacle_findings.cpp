// Errors and warnings about rigid obstacles that do not touch each other.
#include "app/run/findings.hpp"

#include "base/formatted.hpp"
#include "model/obstacle_gap.hpp"

#include <cmath>

namespace knap {
namespace {

constexpr double negligible = 1e-9;  // [-] of the size: obstacles that start in contact

std::string named(const Obstacle& obstacle, Index number) {
    return "`" + item("obstacle", number) + "` (" + obstacle.name + ")";
}

}  // namespace

std::vector<Diagnostic> findings_of_obstacles(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    for (const auto& [i, j] : obstacles_that_may_meet(model.obstacles)) {
        const Obstacle &a = model.obstacles[i], &b = model.obstacles[j];
        const auto [gap, place] = gap_between({a.outline, a.start}, {b.outline, b.start});
        const std::string both = named(a, i) + " and " + named(b, j);
        const double size = place.norm() + std::sqrt(std::abs((b.is_free() ? b : a).outline.area()));
        if (gap < -negligible * size)
            found.push_back(read.at(item("obstacle", j),
                                    {.severity = Diagnostic::Severity::error,
                                     .code = "obstacles-overlap",
                                     .message = both + formatted(" overlap by %.3g m at ", -gap) + place_text(place),
                                     .note = "obstacles do not touch each other; move them apart, or give one of them "
                                             "a [[body]] instead"}));
        else
            found.push_back(read.at(
                item("obstacle", j),
                {.severity = Diagnostic::Severity::warning,
                 .code = "obstacles-pass",
                 .message = both + " may meet: obstacles do not touch each other, a free one passes through others",
                 .note = "make one of them a [[body]] of a stiff material, or let it move only where it meets none "
                         "(motion, turns = false); the gate obstacle_overlap ends the run where they meet"}));
    }
    return found;
}

}  // namespace knap
