#include "geometry/mesh_file.hpp"

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

/// Gmsh file format 2.2: physical groups are the boundaries (lines), the regions (triangles) and the pre-cracks (lines).
std::string gmsh(const Mesh& mesh, const std::vector<std::string>& region_names) {
    Text out;
    const Index n_boundaries = static_cast<Index>(mesh.boundary_names.size());
    const Index n_regions = mesh.region.empty() ? 0 : 1 + *std::max_element(mesh.region.begin(), mesh.region.end());
    const auto cracked =
        std::count_if(mesh.interior_edges.begin(), mesh.interior_edges.end(), [](const InteriorEdge& e) { return e.cracked; });
    const auto unnamed = std::count(mesh.boundary_names.begin(), mesh.boundary_names.end(), "");
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n" << n_boundaries - unnamed + n_regions + (cracked > 0 ? 1 : 0) << "\n";
    for (Index i = 0; i < n_boundaries; ++i)
        if (!mesh.boundary_names[i].empty()) out << "1 " << i + 1 << " \"" << mesh.boundary_names[i] << "\"\n";
    if (cracked > 0) out << "1 " << n_boundaries + 1 << " \"crack\"\n";
    for (Index i = 0; i < n_regions; ++i) {
        const bool has_name = i < static_cast<Index>(region_names.size());
        out << "2 " << n_boundaries + 2 + i << " \"" << (has_name ? region_names[i] : "region" + std::to_string(i)) << "\"\n";
    }
    out << "$EndPhysicalNames\n$Nodes\n" << mesh.n_vertices() << "\n";
    for (Index v = 0; v < mesh.n_vertices(); ++v) out << v + 1 << " " << mesh.vertices[v].x() << " " << mesh.vertices[v].y() << " 0\n";
    out << "$EndNodes\n$Elements\n" << static_cast<Index>(mesh.boundary_edges.size() + cracked) + mesh.n_triangles() << "\n";
    Index n = 0;
    const auto line = [&](Index triangle, Index side, Index group) {
        out << ++n << " 1 2 " << group << " " << group << " " << mesh.triangles[triangle][side] + 1 << " "
            << mesh.triangles[triangle][(side + 1) % 3] + 1 << "\n";
    };
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        line(edge.triangle, edge.side, mesh.boundary_names[edge.boundary].empty() ? 0 : edge.boundary + 1);
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.cracked) line(edge.triangle[0], edge.side[0], n_boundaries + 1);
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
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
        << "<Piece NumberOfPoints=\"" << mesh.n_vertices() << "\" NumberOfCells=\"" << mesh.n_triangles() << "\">\n"
        << "<CellData><DataArray type=\"Int32\" Name=\"region\" format=\"ascii\">\n";
    for (const Index region : mesh.region) out << region << "\n";
    out << "</DataArray>\n";
    if (!mesh.grain.empty()) {
        out << "<DataArray type=\"Int32\" Name=\"grain\" format=\"ascii\">\n";
        for (const Index grain : mesh.grain) out << grain << "\n";
        out << "</DataArray>\n";
    }
    out << "</CellData>\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
    for (const Vec2& x : mesh.vertices) out << x.x() << " " << x.y() << " 0\n";
    out << "</DataArray></Points>\n<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n";
    for (const auto& t : mesh.triangles) out << t[0] << " " << t[1] << " " << t[2] << "\n";
    out << "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n";
    for (Index t = 0; t < mesh.n_triangles(); ++t) out << 3 * (t + 1) << "\n";
    out << "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
    for (Index t = 0; t < mesh.n_triangles(); ++t) out << "5\n";
    out << "</DataArray></Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    return out.text;
}

std::string svg(const Mesh& mesh) {
    Vec2 low = mesh.vertices.front(), high = low;
    for (const Vec2& x : mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
    const Vec2 size = high - low;
    const double pixels = 1600 / size.x(), margin = 10;
    const auto at = [&](const Vec2& x) -> Vec2 { return {margin + pixels * (x.x() - low.x()), margin + pixels * (high.y() - x.y())}; };
    Text out;
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << 1600 + 2 * margin << "\" height=\"" << pixels * size.y() + 2 * margin
        << "\">\n";
    const auto edge = [&](Index triangle, Index side) {
        const Vec2 a = at(mesh.corner(triangle, side)), b = at(mesh.corner(triangle, (side + 1) % 3));
        out << "M" << a.x() << " " << a.y() << "L" << b.x() << " " << b.y();
    };
    const auto path = [&](const char* colour, double width, const auto& add) {
        out << "<path fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << width << "\" d=\"";
        add();
        out << "\"/>\n";
    };
    static constexpr std::array<const char*, 8> fills{"#ffffff", "#f0c8b4", "#bcd8ea", "#d6e2ae", "#f0e0a4", "#d8c4e6", "#aee2d4", "#f0c0d4"};
    const Index n_regions = mesh.region.empty() ? 0 : 1 + *std::max_element(mesh.region.begin(), mesh.region.end());
    for (Index region = 1; region < n_regions; ++region) {
        out << "<path fill=\"" << fills[region % fills.size()] << "\" d=\"";
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            if (mesh.region[t] != region) continue;
            const Vec2 a = at(mesh.corner(t, 0)), b = at(mesh.corner(t, 1)), c = at(mesh.corner(t, 2));
            out << "M" << a.x() << " " << a.y() << "L" << b.x() << " " << b.y() << "L" << c.x() << " " << c.y() << "Z";
        }
        out << "\"/>\n";
    }
    path("#8a8a8a", 0.4, [&] {
        for (const InteriorEdge& e : mesh.interior_edges)
            if (!e.cracked) edge(e.triangle[0], e.side[0]);
    });
    path("#2f5d8a", 1.2, [&] {
        for (const InteriorEdge& e : mesh.interior_edges)
            if (!mesh.grain.empty() && !mesh.within_grain(e)) edge(e.triangle[0], e.side[0]);
    });
    path("#c0392b", 0.8, [&] {
        for (const InteriorEdge& e : mesh.interior_edges)
            if (e.joint >= 0) edge(e.triangle[0], e.side[0]);
    });
    path("#000000", 1.2, [&] {
        for (const BoundaryEdge& e : mesh.boundary_edges) edge(e.triangle, e.side);
    });
    path("#c0392b", 1.6, [&] {
        for (const InteriorEdge& e : mesh.interior_edges)
            if (e.cracked) edge(e.triangle[0], e.side[0]);
    });
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
