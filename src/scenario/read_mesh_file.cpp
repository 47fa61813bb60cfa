// mesh.file: physical surfaces are materials, physical curves boundaries and cracks.
#include "mesh/gmsh.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

namespace knap {
namespace {

std::optional<GmshMesh> parse_mesh(const Table& table, const std::string& bytes) {
    Findings& findings = table.reading().findings;
    try {
        GmshMesh read = read_gmsh(bytes, (table.reading().files.directory / table.text("file")).string());
        for (const std::string& warning : read.warnings) table.warning("mesh", "file", ": " + warning);
        return read;
    } catch (const UserError& error) {
        for (const Diagnostic& d : error.diagnostics) findings.add(d);
        return std::nullopt;
    }
}

/// The material of each physical surface; those that have mesh.material are others of the file.
std::vector<Index> materials_of_groups(const Table& table, const std::vector<GmshGroup>& groups, MeshFile& file) {
    file.of_others = table.material("material").value_or(0);
    const std::vector<std::string> materials = table.scenario().material_names();
    std::vector<Index> of_group;
    std::vector<std::string> unnamed;
    for (const GmshGroup& group : groups) {
        const auto found = std::ranges::find(materials, group.name);
        of_group.push_back(found == materials.end() ? file.of_others : static_cast<Index>(found - materials.begin()));
        if (table.given("material") && found == materials.end() && group.n > 0)
            file.others.push_back(group.name.empty() ? "no group" : group.name);
        if (table.given("material")) continue;
        if (found == materials.end() && !group.named && !group.name.empty()) unnamed.push_back(group.name);
        if (found != materials.end() || materials.empty() || (!group.named && materials.size() == 1)) continue;
        if (group.name.empty())
            table.error("unknown-name", "file",
                        "has " + std::to_string(group.n) +
                            " triangles in no physical surface, so that their material is unknown",
                        "give each surface a physical group, with one of the names " + joined(materials) +
                            " (Mesh.SaveAll leaves groups out of format 2.2), or all of them one by mesh.material");
        else
            table.error("unknown-name", "file", "has the physical surface `" + group.name + "`, which is no material",
                        "materials: " + joined(materials) + "; mesh.material is that of all without such a name",
                        did_you_mean(group.name, materials));
    }
    if (materials.size() == 1 && unnamed.size() > 1)
        table.warning("merged-surfaces", "file",
                      "has " + std::to_string(unnamed.size()) + " physical surfaces without a name (" +
                          first_of(unnamed) + "): all are the one material `" + materials.front() + "`",
                      "names of materials for them, in Gmsh as in Physical Surface(\"NAME\") = {...}, tell them apart; "
                      "material = \"" +
                          materials.front() + "\" in [mesh] says that it is right");
    return of_group;
}

/// mark(edge) for the edges on a physical curve inside the body.
void mark_curve(const Table& table, const Node& name, GmshMesh& read, const auto& mark) {
    std::vector<std::string> known;
    for (const GmshGroup& group : read.inner_groups) known.push_back(group.name);
    const auto group = std::ranges::find(known, name.text) - known.begin();
    const bool on_boundary = std::ranges::count(read.mesh.boundary_names, name.text) > 0;
    if (group == std::ssize(known))
        table.reading().findings.error("unknown-name", "there is no physical curve `" + name.text + "` inside the body",
                                       name,
                                       on_boundary     ? "it lies on the boundary"
                                       : known.empty() ? "there is none"
                                                       : "known: " + joined(known),
                                       did_you_mean(name.text, known));
    for (const InnerLine& line : read.inner_lines)
        if (line.group == group) mark(read.mesh.interior_edges[line.edge]);
}

/// Cracks, and joints, whose laws read_laws finds. What a curve is that nothing names, the file does not tell.
void mark_curves(const Table& table, GmshMesh& read) {
    std::vector<std::string> idle;
    for (const GmshGroup& group : read.inner_groups)
        if (group.n > 0) idle.push_back(group.name);
    std::set<std::string> named;
    for (const Node& name : table.items("cracks")) {
        named.insert(name.text);
        mark_curve(table, name, read, [](InteriorEdge& edge) { edge.cracked = true; });
        std::erase(idle, name.text);
    }
    for (const Table& joint : table.list("joint")) {
        if (!joint.has("interface")) continue;  // reported
        const Index number = joint.new_joint_set();
        if (!joint.has("curve")) continue;
        if (const std::string curve = joint.text("curve"); !named.insert(curve).second)
            joint.error("duplicate-name", "curve",
                        "= \"" + curve + "\" is in mesh.cracks or another [[mesh.joint]], too",
                        "one of them: a curve has one law, or none as a crack");
        mark_curve(table, table.reading().values.place_of(joint.path("curve")), read,
                   [&](InteriorEdge& edge) { edge.joint = number; });
        std::erase(idle, joint.text("curve"));
    }
    if (!idle.empty())
        table.warning("unused-curve", "file",
                      "has physical curves inside the body that are neither cracks nor joints: " + first_of(idle),
                      "cracks = [\"" + idle.front() + "\"] in [mesh] or a [[mesh.joint]] with curve = \"" +
                          idle.front() + "\"; a curve that is to be neither needs no physical group");
}

/// [[domain.region]] over the mesh: the triangles whose centroids lie inside. They leave their grains, so that the
/// edges round them have the law of the two materials.
void lay_regions(Reading& reading, Mesh& mesh) {
    MeshOptions sizes;
    sizes.size = mean_edge(mesh);
    for (const Table& region : reading.table("domain").list("region")) {
        const std::optional<Index> material = region.material("material");
        const std::vector<Vec2> outline = read_curve(region, sizes);
        if (outline.empty() || !material) continue;  // reported
        const std::vector<Index> inside = triangles_in(mesh, outline);
        if (inside.empty())
            region.error("empty-region", "", "has no triangle of mesh.file: it is smaller than one, or lies elsewhere",
                         "coordinates of the body, after mesh.unit");
        for (const Index t : inside) {
            mesh.region[t] = *material;
            if (!mesh.grain.empty()) mesh.grain[t] = -1;
        }
    }
}

/// A drawing in millimetres would become a mountain.
void warn_of_metres(const Table& table, const Mesh& mesh) {
    if (mesh.vertices.empty()) return;
    const Box box = bounding_box(mesh.vertices);
    char size[80];
    std::snprintf(size, sizeof size, "%.6g m x %.6g m", box.high.x() - box.low.x(), box.high.y() - box.low.y());
    table.warning("no-unit", "file", std::string("is read in metres, without `mesh.unit`: the body is ") + size,
                  "unit = \"1 m\" in [mesh] if that is right, else the length of one unit, as \"1 mm\"");
}

}  // namespace

void read_mesh_file(Reading& reading) {
    const Table table = reading.table("mesh");
    if (!table.has("file")) return;
    std::optional<std::string> bytes = table.bytes_of("file");
    if (!bytes) return;
    std::optional<GmshMesh> read = parse_mesh(table, *bytes);
    if (!read) return;
    MeshFile file;
    const std::vector<Index> material = materials_of_groups(table, read->surface_groups, file);
    mark_curves(table, *read);
    Mesh& mesh = read->mesh;
    const double unit = table.number("unit").value_or(1);
    for (Vec2& x : mesh.vertices) x *= unit;
    if (!table.given("unit")) warn_of_metres(table, mesh);
    for (Index& region : mesh.region) region = material[region];
    if (table.get<bool>("grains").value_or(false)) mesh.grain = std::move(read->surface);
    lay_regions(reading, mesh);
    reading.scenario.files.push_back({table.path("file"), "mesh.msh", std::move(*bytes)});
    file.mesh = std::move(mesh);
    reading.scenario.given = std::make_shared<const MeshFile>(std::move(file));
}

}  // namespace knap
