// [adapt]: refinement of the mesh during the run, and what it does not go together with.
#include "mesh/edge_graph.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace knap {
namespace {

/// A place where triangles of a file meet in a node alone, or in two nodes of one piece.
std::optional<Vec2> place_of_bad_node(const Mesh& mesh) {
    const std::vector<Index> piece = pieces_of(mesh);
    const double scale = 1e9 / bounding_box(mesh.vertices).diagonal();  // nearer ones are at one place
    std::map<Index, int> at_node;                                       // ends of edges of the boundary
    std::map<std::tuple<Index, double, double>, int> at_place;
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        for (const Index v : mesh.side_vertices(edge.triangle, edge.side)) {
            const Vec2& x = mesh.vertices[v];
            const std::tuple place{piece[edge.triangle], std::round(scale * x.x()), std::round(scale * x.y())};
            if (++at_node[v] > 2 || ++at_place[place] > 2) return x;
        }
    return std::nullopt;
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
    scenario.adapt.coarse = given ? mean_edge(*given) : 0;
    for (const Body& body : scenario.bodies) scenario.adapt.coarse = std::max(scenario.adapt.coarse, body.mesh.size);
    scenario.adapt.grading = scenario.mesh.grading;
    if (!(scenario.adapt.size < scenario.adapt.coarse))  // also where a file has no edge between triangles
        table.error("bad-value", "size",
                    "is not below mesh.size, the size where nothing breaks (of bodies the largest mesh_size, of a "
                    "file its mean edge)",
                    "mesh.size = 8 to 16 times adapt.size");
    const std::optional<Vec2> bad_node = given ? place_of_bad_node(*given) : std::nullopt;
    if (bad_node)
        reading.table("mesh").error("geometry", "file",
                                    "has triangles that meet at " + place_text(*bad_node) +
                                        " in a node and no edge, and [adapt] cannot tell what is joined there",
                                    "an edge in common, or nodes and pieces of their own");
    for (Body& body : scenario.bodies) refine_crack_ends(scenario.adapt, body);
}

}  // namespace knap
