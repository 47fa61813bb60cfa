// [adapt]: refinement of the mesh during the run, and what it does not go together with.
#include "scenario/reading.hpp"

#include <algorithm>

namespace knap {
namespace {

/// Parts of a scenario whose place on a refined mesh is not defined yet.
void refuse_others(Reading& reading, const Table& table) {
    const Scenario& scenario = reading.scenario;
    const auto refuse = [&](bool is_there, const std::string& what, const std::string& cure) {
        if (is_there) table.error("exclusive-keys", "", "does not go together with " + what, cure);
    };
    const char* fine_from_start = "[[mesh.refine]] makes a region fine from the start";
    refuse(scenario.time.scheme.takes_implicit_steps(), "implicit steps of time.bulk", "bulk = \"explicit\"");
    refuse(scenario.order == 2, "mesh.order = 2", "triangles of first order");
    refuse(scenario.large_rotation, "rotation = \"large\" and [contact]", fine_from_start);
    refuse(scenario.given != nullptr, "mesh.file", "a shape that is meshed here");
    refuse(!scenario.bodies.empty() && !scenario.bodies.front().name.empty(), "[[body]]", fine_from_start);
    refuse(!scenario.supports.empty(), "[[support]]", "prescribed motions");
    refuse(!scenario.obstacles.empty(), "[[obstacle]]", "loads or prescribed motions");
    refuse(!scenario.rocks.empty() || !scenario.maps.empty(), "grains and maps of materials", fine_from_start);
    refuse(scenario.heat.has_value(), "[heat]", fine_from_start);
    refuse(!scenario.excavations.empty(), "[[excavation]]", fine_from_start);
    refuse(!scenario.crack_pressures.empty(), "[[pressure]]", fine_from_start);
    refuse(scenario.specimen.has_value(), "[specimen]", fine_from_start);
    refuse(scenario.time.rest.ends_run, "time.until = \"rest\"", "time.end alone");
    refuse(std::ranges::any_of(scenario.probes,
                               [](const ProbeOptions& probe) {
                                   using Watch = ProbeOptions::Watch;
                                   return probe.watch == Watch::interface || probe.watch == Watch::tip;
                               }),
           "a probe of an interface or of a tip", "a probe of a place or of a stress");
    for (const NamedLaw& law : scenario.laws) {
        refuse(law.scatter.any() && law.scatter.correlation == 0,
               "strengths that scatter from interface to interface (`" + law.name + "`)",
               "`interface." + law.name + ".scatter.correlation`, a length over which strengths are alike");
        refuse(law.law.breakable() && law.law.incubation_time > 0, "an incubation_time", fine_from_start);
    }
}

/// The vertices at the ends of cracks split at the start, so they must be fine then.
void refine_crack_ends(const AdaptOptions& adapt, Body& body) {
    const std::vector<Segment> border = sides_of(body.shape.outer.points, true);
    const double reach = adapt.margin * adapt.size;
    for (const Crack& crack : body.shape.cracks)
        for (const Vec2& end : {crack.points.front(), crack.points.back()}) {
            const bool inside = body.shape.contains(end) && std::ranges::all_of(border, [&](const Segment& side) {
                                    return distance_to_segment(side.a, side.b, end) > body.shape.tolerance();
                                });
            if (crack.joint < 0 && inside)
                body.mesh.refine.push_back(
                    {.box = {end - Vec2::Constant(reach), end + Vec2::Constant(reach)}, .size = adapt.size});
        }
}

}  // namespace

void read_adapt(Reading& reading) {
    const Table table = reading.table("adapt");
    if (!table.given()) return;
    Scenario& scenario = reading.scenario;
    table.fill(scenario.adapt);
    refuse_others(reading, table);
    if (!scenario.adapt.active() || scenario.bodies.empty()) return;  // reported
    scenario.adapt.coarse = scenario.mesh.size, scenario.adapt.grading = scenario.mesh.grading;
    if (scenario.adapt.size >= scenario.mesh.size)
        table.error("bad-value", "size", "is not below mesh.size, the size where nothing breaks",
                    "mesh.size = 8 to 16 times adapt.size");
    refine_crack_ends(scenario.adapt, scenario.bodies.front());
}

}  // namespace knap
