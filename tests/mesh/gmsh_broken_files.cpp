// Damaged files: a truncated or changed file gives a consistent mesh or an error message, never a crash.
#include "mesh/gmsh_files.hpp"

#include <map>

namespace gmsh_broken_files_test {

using namespace knap;
using namespace knap::testing;

namespace {

bool is_sound(const GmshMesh& read) {
    const Mesh& mesh = read.mesh;
    if (mesh.n_triangles() == 0 || mesh.region.size() != mesh.triangles.size()) return false;
    std::map<std::pair<Index, Index>, int> sides;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        if (!(mesh.area(t) > 0) || mesh.region[t] < 0 ||
            mesh.region[t] >= static_cast<Index>(read.surface_groups.size()))
            return false;
        for (Index k = 0; k < 3; ++k) {
            if (mesh.triangles[t][k] < 0 || mesh.triangles[t][k] >= mesh.n_vertices()) return false;
            if (++sides[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] > 1) return false;
        }
    }
    if (2 * mesh.interior_edges.size() + mesh.boundary_edges.size() != sides.size()) return false;
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        if (edge.boundary < 0 || edge.boundary >= static_cast<Index>(mesh.boundary_names.size())) return false;
    for (const InnerLine& line : read.inner_lines)
        if (line.edge >= static_cast<Index>(mesh.interior_edges.size()) ||
            line.group >= static_cast<Index>(read.inner_groups.size()))
            return false;
    return true;
}

/// True when it is read; fails the test when the result is no mesh, or the message has no place.
bool is_read(const std::string& bytes) {
    try {
        const bool sound = is_sound(read_gmsh(bytes, "m.msh"));
        CHECK(sound);
        return true;
    } catch (const UserError& error) {
        const Diagnostic& d = error.diagnostics.front();
        const bool placed = d.file == "m.msh" && (d.line > 0 || d.message.find("(at byte ") != std::string::npos);
        CHECK_MESSAGE(placed, d.message);
        return false;
    }
}

}  // namespace

TEST_CASE("gmsh: a truncated file is rejected at every length") {
    for (const std::string& file : gmsh_files) {
        CAPTURE(file);
        const std::string bytes = gmsh_bytes(file);
        const std::size_t needed = bytes.find("$EndElements") + std::string("$EndElements").size();
        for (std::size_t n = 0; n < needed; ++n) {
            CAPTURE(n);
            CHECK_FALSE(is_read(bytes.substr(0, n)));
        }
        CHECK(is_read(bytes.substr(0, needed)));
    }
}

namespace {

/// Changes every `stride`-th byte.
void change_bytes(std::size_t stride) {
    for (const std::string& file : gmsh_files) {
        CAPTURE(file);
        std::string bytes = gmsh_bytes(file);
        std::size_t n_read = 0, n_refused = 0;
        for (std::size_t i = 0; i < bytes.size(); i += stride) {
            CAPTURE(i);
            const char good = bytes[i];
            for (const char wrong :
                 {static_cast<char>(good ^ 1), static_cast<char>(good ^ 0x80), '\0', '\n', '9', '-'}) {
                bytes[i] = wrong;
                is_read(bytes) ? ++n_read : ++n_refused;
            }
            bytes[i] = good;
        }
        CHECK(n_read > 100 / stride);  // a coordinate a little off, a letter of a name
        CHECK(n_refused > 100 / stride);
    }
}

}  // namespace

TEST_CASE("gmsh: any byte may be changed") { change_bytes(11); }

TEST_CASE("gmsh: every byte may be changed" * doctest::test_suite("slow")) { change_bytes(1); }

}  // namespace gmsh_broken_files_test
