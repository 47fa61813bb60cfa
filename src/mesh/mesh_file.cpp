#include "mesh/mesh_file.hpp"

#include "mesh/polygon.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

namespace knap {
namespace {

/// Text with numbers that read back to the same bits, whatever the locale.
class Text {
public:
    Text& operator<<(const char* words) { return text += words, *this; }
    Text& operator<<(const std::string& words) { return text += words, *this; }
    template <class Number>
    requires std::is_arithmetic_v<Number> Text& operator<<(Number number) {
        char digits[32];
        text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
        return *this;
    }
    std::string text;
};

Index n_regions(const Mesh& mesh) {
    return mesh.region.empty() ? 0 : 1 + *std::max_element(mesh.region.begin(), mesh.region.end());
}

/// Triangle and side.
std::pair<Index, Index> first_side(const BoundaryEdge& edge) { return {edge.triangle, edge.side}; }
std::pair<Index, Index> first_side(const InteriorEdge& edge) { return {edge.triangle[0], edge.side[0]}; }

/// Gmsh file format 2.2: physical groups are the boundaries (lines), the regions (triangles) and the pre-cracks
/// (lines).
std::string gmsh(const Mesh& mesh, const std::vector<std::string>& region_names) {
    Text out;
    const Index n_boundaries = static_cast<Index>(mesh.boundary_names.size());
    const auto cracked = std::count_if(mesh.interior_edges.begin(), mesh.interior_edges.end(),
                                       [](const InteriorEdge& e) { return e.cracked; });
    const auto unnamed = std::count(mesh.boundary_names.begin(), mesh.boundary_names.end(), "");
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n"
        << n_boundaries - unnamed + n_regions(mesh) + (cracked > 0 ? 1 : 0) << "\n";
    for (Index i = 0; i < n_boundaries; ++i)
        if (!mesh.boundary_names[i].empty()) out << "1 " << i + 1 << " \"" << mesh.boundary_names[i] << "\"\n";
    if (cracked > 0) out << "1 " << n_boundaries + 1 << " \"crack\"\n";
    for (Index i = 0; i < n_regions(mesh); ++i) {
        const bool has_name = i < static_cast<Index>(region_names.size());
        out << "2 " << n_boundaries + 2 + i << " \"" << (has_name ? region_names[i] : "region" + std::to_string(i))
            << "\"\n";
    }
    out << "$EndPhysicalNames\n$Nodes\n" << mesh.n_vertices() << "\n";
    for (Index v = 0; v < mesh.n_vertices(); ++v)
        out << v + 1 << " " << mesh.vertices[v].x() << " " << mesh.vertices[v].y() << " 0\n";
    out << "$EndNodes\n$Elements\n"
        << static_cast<Index>(mesh.boundary_edges.size() + cracked) + mesh.n_triangles() << "\n";
    Index n = 0;
    const auto line = [&](const auto& edge, Index group) {
        const auto [triangle, side] = first_side(edge);
        out << ++n << " 1 2 " << group << " " << group << " " << mesh.triangles[triangle][side] + 1 << " "
            << mesh.triangles[triangle][(side + 1) % 3] + 1 << "\n";
    };
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        line(edge, mesh.boundary_names[edge.boundary].empty() ? 0 : edge.boundary + 1);
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.cracked) line(edge, n_boundaries + 1);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Index group = n_boundaries + 2 + mesh.region[t];
        out << ++n << " 2 2 " << group << " " << group;
        for (const Index v : mesh.triangles[t]) out << " " << v + 1;
        out << "\n";
    }
    out << "$EndElements\n";
    return out.text;
}

std::string vtu(const Mesh& mesh) {
    Text out;
    const auto array = [&](const char* attributes, const auto& rows, const auto& add_row) {
        out << "<DataArray " << attributes << " format=\"ascii\">\n";
        for (const auto& row : rows) add_row(row), out << "\n";
        out << "</DataArray>";
    };
    const auto number = [&](Index i) { out << i; };
    Index end = 0;  // of the vertices of a triangle
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << mesh.n_vertices() << "\" NumberOfCells=\""
        << mesh.n_triangles() << "\">\n<CellData>";
    array("type=\"Int32\" Name=\"region\"", mesh.region, number);
    out << "\n";
    if (!mesh.grain.empty()) array("type=\"Int32\" Name=\"grain\"", mesh.grain, number), out << "\n";
    out << "</CellData>\n<Points>";
    array("type=\"Float64\" NumberOfComponents=\"3\"", mesh.vertices,
          [&](const Vec2& x) { out << x.x() << " " << x.y() << " 0"; });
    out << "</Points>\n<Cells>";
    array("type=\"Int32\" Name=\"connectivity\"", mesh.triangles,
          [&](const auto& t) { out << t[0] << " " << t[1] << " " << t[2]; });
    array("type=\"Int32\" Name=\"offsets\"", mesh.triangles, [&](const auto&) { out << (end += 3); });
    array("type=\"UInt8\" Name=\"types\"", mesh.triangles, [&](const auto&) { out << 5; });
    out << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    return out.text;
}

std::string svg(const Mesh& mesh) {
    const Box box = bounding_box(mesh.vertices);
    constexpr double width = 1600, margin = 10;  // [pixel]
    const double pixels = width / box.extent().x();
    Text out;
    const auto point = [&](const char* command, const Vec2& x) {
        out << command << margin + pixels * (x.x() - box.low.x()) << " " << margin + pixels * (box.high.y() - x.y());
    };
    const auto lines = [&](const char* colour, double line_width, const auto& edges, const auto& is_drawn) {
        out << "<path fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << line_width << "\" d=\"";
        for (const auto& edge : edges) {
            if (!is_drawn(edge)) continue;
            const auto [triangle, side] = first_side(edge);
            point("M", mesh.corner(triangle, side));
            point("L", mesh.corner(triangle, (side + 1) % 3));
        }
        out << "\"/>\n";
    };
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width + 2 * margin << "\" height=\""
        << pixels * box.extent().y() + 2 * margin << "\">\n";
    static constexpr std::array<const char*, 8> fills{"#ffffff", "#f0c8b4", "#bcd8ea", "#d6e2ae",
                                                      "#f0e0a4", "#d8c4e6", "#aee2d4", "#f0c0d4"};
    for (Index region = 1; region < n_regions(mesh); ++region) {
        out << "<path fill=\"" << fills[region % fills.size()] << "\" d=\"";
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            if (mesh.region[t] != region) continue;
            for (Index k = 0; k < 3; ++k) point(k == 0 ? "M" : "L", mesh.corner(t, k));
            out << "Z";
        }
        out << "\"/>\n";
    }
    using Interior = const InteriorEdge&;
    const auto& interior = mesh.interior_edges;
    lines("#8a8a8a", 0.4, interior, [](Interior e) { return !e.cracked; });
    lines("#2f5d8a", 1.2, interior, [&](Interior e) { return !mesh.grain.empty() && !mesh.within_grain(e); });
    lines("#c0392b", 0.8, interior, [](Interior e) { return e.joint >= 0; });
    lines("#000000", 1.2, mesh.boundary_edges, [](const BoundaryEdge&) { return true; });
    lines("#c0392b", 1.6, interior, [](Interior e) { return e.cracked; });
    out << "</svg>\n";
    return out.text;
}

}  // namespace

std::string mesh_as_text(const Mesh& mesh, const std::string& ending, const std::vector<std::string>& region_names) {
    if (ending == ".msh") return gmsh(mesh, region_names);
    if (ending == ".vtu") return vtu(mesh);
    if (ending == ".svg") return svg(mesh);
    throw std::invalid_argument("a mesh is written as .msh, .vtu or .svg, not as `" + ending + "`");
}

}  // namespace knap
