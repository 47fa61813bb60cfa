// [adapt]: refinement of the mesh during the run, and what it does not go together with.
#include "base/union_find.hpp"
#include "scenario/reading.hpp"

#include <algorithm>

namespace knap {
namespace {

/// Bodies with names, or parts of a file that share no nodes.
bool has_several_bodies(const Scenario& scenario) {
    if (!scenario.given) return !scenario.bodies.empty() && !scenario.bodies.front().name.empty();
    const Mesh& mesh = scenario.given->mesh;
    UnionFind pieces(mesh.n_triangles());
    for (const InteriorEdge& edge : mesh.interior_edges) pieces.join(edge.triangle[0], edge.triangle[1]);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (pieces.find(t) != pieces.find(0)) return true;
    return false;
}

void exclude_others(Reading& reading, const Table& table) {
    const Scenario& scenario = reading.scenario;
    const auto exclude = [&](bool is_there, const std::string& other, const std::string& cure) {
        if (is_there) table.exclude("", "[adapt]", other, cure);
    };
    const std::string fine_from_start = "[[mesh.refine]] makes a region fine from the start";
    const BulkScheme bulk = scenario.time.scheme.bulk;
    exclude(bulk != BulkScheme::explicit_lumped, words_of(bulk), "bulk = \"explicit\"");
    exclude(scenario.time.mass_scaling > 0, "mass_scaling", "remove mass_scaling from [time]");
    exclude(scenario.order == 2, "mesh.order = 2", "triangles of first order");
    exclude(scenario.large_rotation, "rotation = \"large\"", fine_from_start);
    exclude(has_several_bodies(scenario), "[[body]]", fine_from_start);
    exclude(!scenario.excavations.empty(), "[[excavation]]", fine_from_start);
    exclude(std::ranges::any_of(scenario.probes,
                                [](const ProbeOptions& probe) {
                                    using Watch = ProbeOptions::Watch;
                                    return probe.watch == Watch::interface || probe.watch == Watch::tip;
                                }),
            "a probe of an interface or of a tip", "a probe of a place or of a stress");
    exclude(!scenario.collectors.empty(), "[[collector]]", fine_from_start);
    exclude(std::ranges::any_of(scenario.materials,
                                [](const NamedMaterial& material) { return material.layer_angle != nullptr; }),
            "bedding.angle by place", fine_from_start);
    for (const NamedLaw& law : scenario.laws)
        exclude(law.scatter.any() && law.scatter.correlation == 0, "scatter without a correlation",
                "`interface." + law.name + ".scatter.correlation`, a length over which strengths are alike");
}

/// What came apart at the start keeps its triangles.
void warn_of_what_stays(Reading& reading, const Table& table) {
    if (reading.table("mesh").given("cracks"))
        table.warning("adapt", "", "leaves the triangles at the cracks of mesh.file as they are, also at their tips",
                      "small triangles there in the file");
    for (const Support& support : reading.scenario.supports)
        if (support.glued && support.law >= 0 && reading.scenario.laws[support.law].law.breakable())
            return table.warning("adapt", "",
                                 "leaves the triangles on a glued [[support]] as they are, so it breaks in large ones",
                                 "[[mesh.refine]] along the support");
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
    exclude_others(reading, table);
    warn_of_what_stays(reading, table);
    const Mesh* given = scenario.given ? &scenario.given->mesh : nullptr;
    if (!scenario.adapt.active() || (scenario.bodies.empty() && given == nullptr)) return;  // reported
    scenario.adapt.coarse = given ? mean_edge(*given) : scenario.mesh.size,
    scenario.adapt.grading = scenario.mesh.grading;
    if (scenario.adapt.size >= scenario.adapt.coarse)
        table.error("bad-value", "size",
                    "is not below mesh.size, the size where nothing breaks (of a file: its mean edge)",
                    "mesh.size = 8 to 16 times adapt.size");
    for (Body& body : scenario.bodies) refine_crack_ends(scenario.adapt, body);
}

}  // namespace knap
