// mesh.file: the mesh is read; its physical surfaces are materials, its physical curves boundaries and cracks.
#include "mesh/gmsh.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <cstdio>

namespace knap {
namespace {

/// The file says what the body is: nothing else may.
void check_nothing_else(Reading& reading) {
    for (const Entry& entry : reading.values.entries()) {
        const std::string& path = entry.path;
        const bool of_domain = path.starts_with("domain.") && path != "domain.model" && path != "domain.thickness";
        const bool of_mesh = path == "mesh.min_angle" || path == "mesh.grading" || path.starts_with("mesh.refine[");
        const bool of_a_list = path.find('.') != path.rfind('.');
        if ((of_domain || of_mesh) && !of_a_list && reading.values.given(path))
            reading.table(path).error_at_name("exclusive-keys", "", "has no meaning beside mesh.file",
                                              "the file says what the body and its mesh are");
    }
    for (const char* path : {"mesh.min_angle", "mesh.grading"}) reading.values.leave_out(path);
}

std::optional<GmshMesh> parse_mesh(Reading& reading, const std::string& file, const std::string& bytes) {
    try {
        GmshMesh read = read_gmsh(bytes, (reading.beside.directory / file).string());
        for (const std::string& warning : read.warnings)
            reading.findings.warning("mesh", "`" + file + "`: " + warning, reading.at("mesh.file"));
        return read;
    } catch (const UserError& error) {
        for (const Diagnostic& d : error.diagnostics) reading.findings.error(d.code, d.message) = d;
        return std::nullopt;
    }
}

/// The material of each physical surface.
std::vector<Index> materials_of_groups(const Reading& reading, const std::string& file,
                                       const std::vector<GmshGroup>& groups) {
    const std::vector<std::string> materials = reading.scenario.material_names();
    const auto n = static_cast<Index>(materials.size());
    std::vector<Index> of_group;
    for (const GmshGroup& group : groups) {
        const Index found = index_in(materials, group.name);
        of_group.push_back(found < n ? found : 0);
        if (found < n || n == 0 || (!group.named && n == 1)) continue;  // no material: reported elsewhere
        const bool nameless = group.name.empty();
        const std::string text = nameless
                                     ? "`" + file + "`: " + std::to_string(group.n) +
                                           " triangles are in no physical surface, so their material is not known"
                                     : "the physical surface `" + group.name + "` of `" + file + "` is no material";
        Diagnostic& d = reading.findings.error("unknown-name", text, reading.at("mesh.file"));
        if (!nameless) d.hint = did_you_mean(group.name, materials);
        d.note = nameless ? "give each surface a physical group, with one of the names " + joined(materials) +
                                " (Mesh.SaveAll leaves groups out of format 2.2)"
                          : "materials: " + joined(materials);
    }
    return of_group;
}

void mark_cracks(const Reading& reading, GmshMesh& read) {
    std::vector<std::string> known;
    for (const GmshGroup& group : read.inner_groups) known.push_back(group.name);
    for (const Node* name : reading.values.items("mesh.cracks")) {
        const Index group = index_in(known, name->text);
        if (group == static_cast<Index>(known.size())) {
            const bool on_boundary = std::ranges::count(read.mesh.boundary_names, name->text) > 0;
            Diagnostic& d = reading.findings.error(
                "unknown-name", "there is no physical curve `" + name->text + "` inside the body", *name);
            d.hint = did_you_mean(name->text, known);
            d.note = on_boundary     ? "all of it lies on the boundary"
                     : known.empty() ? "there is none"
                                     : "known: " + joined(known);
        }
        for (const InnerLine& line : read.inner_lines)
            if (line.group == group) read.mesh.interior_edges[line.edge].cracked = true;
    }
}

/// A drawing in millimetres would become a mountain.
void warn_of_metres(const Reading& reading, const std::string& file, const Mesh& mesh) {
    if (mesh.vertices.empty()) return;
    Vec2 low = mesh.vertices.front(), high = low;
    for (const Vec2& x : mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
    char size[80];
    std::snprintf(size, sizeof size, "%.6g m x %.6g m", high.x() - low.x(), high.y() - low.y());
    const std::string text = "`" + file + "` is read in metres, since `mesh.unit` is missing: the body is " + size;
    reading.findings.warning("no-unit", text, reading.at("mesh.file")).note =
        "unit = \"1 m\" in [mesh] if that is right, else what 1 in the file is, as in \"1 mm\"";
}

}  // namespace

void read_mesh_file(Reading& reading) {
    check_nothing_else(reading);
    if (!reading.values.has("mesh.file")) return;
    const std::string file = *reading.values.text("mesh.file");
    std::optional<std::string> bytes = reading.bytes_of("mesh.file", file);
    if (!bytes) return;
    std::optional<GmshMesh> read = parse_mesh(reading, file, *bytes);
    if (!read) return;
    const std::vector<Index> material = materials_of_groups(reading, file, read->surface_groups);
    mark_cracks(reading, *read);
    Mesh& mesh = read->mesh;
    const double unit = reading.values.number("mesh.unit").value_or(1);
    for (Vec2& x : mesh.vertices) x *= unit;
    if (!reading.values.given("mesh.unit")) warn_of_metres(reading, file, mesh);
    for (Index& region : mesh.region) region = material[region];
    for (const std::string& name : mesh.boundary_names)
        if (!name.empty()) reading.scenario.shape.boundary_names.push_back(name);
    reading.scenario.files.push_back({"mesh.file", "mesh.msh", std::move(*bytes)});
    reading.scenario.given = std::make_shared<const MeshFile>(MeshFile{std::move(mesh)});
}

}  // namespace knap
