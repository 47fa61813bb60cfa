// mesh.file: the mesh is read; its physical surfaces are materials, its physical curves boundaries and cracks.
#include <algorithm>
#include <cstdio>

#include "geometry/gmsh_mesh.hpp"
#include "scenario/assemble.hpp"

namespace knap {
namespace {

/// The file says what the body is: nothing else may.
void check_nothing_else(Assembly& assembly) {
    for (const Entry& entry : assembly.values.entries()) {
        const bool of_domain = entry.path.starts_with("domain.") && entry.path != "domain.model" && entry.path != "domain.thickness";
        const bool of_mesh = entry.path == "mesh.min_angle" || entry.path == "mesh.grading" || entry.path.starts_with("mesh.refine[");
        const bool of_a_list = entry.path.find('.') != entry.path.rfind('.');
        if ((of_domain || of_mesh) && !of_a_list && assembly.values.given(entry.path))
            assembly.findings
                .error_at_name("exclusive-keys", "`" + entry.path + "` has no meaning beside mesh.file", assembly.at(entry.path))
                .note = "the file says what the body and its mesh are";
    }
    for (const char* path : {"mesh.min_angle", "mesh.grading"}) assembly.values.leave_out(path);
}

std::optional<GmshMesh> read_mesh(Assembly& assembly, const std::string& file, std::string& bytes) {
    const Node& at = assembly.at("mesh.file");
    const std::filesystem::path path = assembly.beside.directory / file;
    std::optional<std::string> found = assembly.beside.bytes_of(file);
    if (!found) {
        assembly.findings.error("missing-file", "cannot read `" + path.string() + "`", at).note =
            "file names are relative to the scenario file";
        return std::nullopt;
    }
    bytes = std::move(*found);
    try {
        GmshMesh read = read_gmsh(bytes, path.string());
        for (const std::string& warning : read.warnings) assembly.findings.warning("mesh", "`" + file + "`: " + warning, at);
        return read;
    } catch (const UserError& error) {
        for (const Diagnostic& d : error.diagnostics) assembly.findings.error(d.code, d.message) = d;
        return std::nullopt;
    }
}

/// The material of each physical surface.
std::vector<Index> materials_of_groups(const Assembly& assembly, const std::string& file, const std::vector<GmshGroup>& groups) {
    std::vector<std::string> materials;
    for (const NamedMaterial& material : assembly.scenario.materials) materials.push_back(material.name);
    std::vector<Index> of_group;
    for (const GmshGroup& group : groups) {
        const auto found = std::find(materials.begin(), materials.end(), group.name);
        of_group.push_back(found == materials.end() ? 0 : static_cast<Index>(found - materials.begin()));
        if (found != materials.end() || materials.empty() || (!group.named && materials.size() == 1)) continue;  // no material: reported
        const Node& at = assembly.at("mesh.file");
        if (group.name.empty()) {
            assembly.findings
                .error(
                    "unknown-name",
                    "`" + file + "`: " + std::to_string(group.n) + " triangles are in no physical surface, so their material is not known",
                    at)
                .note = "give each surface a physical group, with one of the names " + joined(materials) +
                        " (Mesh.SaveAll leaves groups out of format 2.2)";
        } else {
            Diagnostic& d =
                assembly.findings.error("unknown-name", "the physical surface `" + group.name + "` of `" + file + "` is no material", at);
            d.hint = did_you_mean(group.name, materials);
            d.note = "materials: " + joined(materials);
        }
    }
    return of_group;
}

void mark_cracks(const Assembly& assembly, GmshMesh& read) {
    std::vector<std::string> known;
    for (const GmshGroup& group : read.inner_groups) known.push_back(group.name);
    for (const Node* name : assembly.values.items("mesh.cracks")) {
        const auto found = std::find(known.begin(), known.end(), name->text);
        if (found == known.end()) {
            const auto& outside = read.mesh.boundary_names;
            const bool on_boundary = std::find(outside.begin(), outside.end(), name->text) != outside.end();
            Diagnostic& d =
                assembly.findings.error("unknown-name", "there is no physical curve `" + name->text + "` inside the body", *name);
            d.hint = did_you_mean(name->text, known);
            d.note = on_boundary ? "all of it lies on the boundary" : known.empty() ? "there is none" : "known: " + joined(known);
        }
        for (const InnerLine& line : read.inner_lines)
            if (line.group == found - known.begin()) read.mesh.interior_edges[line.edge].cracked = true;
    }
}

/// A drawing in millimetres would become a mountain.
void warn_of_metres(const Assembly& assembly, const std::string& file, const Mesh& mesh) {
    if (mesh.vertices.empty()) return;
    Vec2 low = mesh.vertices.front(), high = low;
    for (const Vec2& x : mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
    char text[80];
    std::snprintf(text, sizeof text, "%.6g m x %.6g m", high.x() - low.x(), high.y() - low.y());
    assembly.findings.warning("no-unit", "`" + file + "` is read in metres, since `mesh.unit` is missing: the body is " + text, assembly.at("mesh.file")).note =
        "unit = \"1 m\" in [mesh] if that is right, else what 1 in the file is, as in \"1 mm\"";
}

}  // namespace

void assemble_mesh_file(Assembly& assembly) {
    check_nothing_else(assembly);
    const std::optional<std::string> file = assembly.values.text("mesh.file");
    if (!file) return;
    MeshFile given;
    std::string bytes;
    std::optional<GmshMesh> read = read_mesh(assembly, *file, bytes);
    if (!read) return;
    const std::vector<Index> material = materials_of_groups(assembly, *file, read->surface_groups);
    mark_cracks(assembly, *read);
    given.mesh = std::move(read->mesh);
    const double unit = assembly.values.number("mesh.unit").value_or(1);
    for (Vec2& x : given.mesh.vertices) x *= unit;
    if (!assembly.values.given("mesh.unit")) warn_of_metres(assembly, *file, given.mesh);
    for (Index& region : given.mesh.region) region = material[region];
    for (const std::string& name : given.mesh.boundary_names)
        if (!name.empty()) assembly.scenario.shape.boundary_names.push_back(name);
    assembly.scenario.files.push_back({"mesh.file", "mesh.msh", std::move(bytes)});
    assembly.scenario.given = std::make_shared<const MeshFile>(std::move(given));
}

}  // namespace knap
