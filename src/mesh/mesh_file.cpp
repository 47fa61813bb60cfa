#include "mesh/mesh_file.hpp"

#include "base/text.hpp"
#include "mesh/polygon.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace knap {
namespace {

/// Text with numbers that read back to the same bits, whatever the locale.
class Text {
public:
    Text& operator<<(const std::string& words) { return text += words, *this; }
    template <class Number>
    requires std::is_arithmetic_v<Number> Text& operator<<(Number number) { return text += decimal(number), *this; }
    std::string text;
};

Index n_regions(const Mesh& mesh) { return mesh.region.empty() ? 0 : 1 + std::ranges::max(mesh.region); }

std::array<Index, 2> ends(const Mesh& mesh, const BoundaryEdge& e) { return mesh.side_vertices(e.triangle, e.side); }
std::array<Index, 2> ends(const Mesh& mesh, const InteriorEdge& e) {
    return mesh.side_vertices(e.triangle[0], e.side[0]);
}

/// Format 2.2. Physical groups are boundaries, pre-cracks and joint sets (lines) and regions (triangles).
std::string gmsh(const Mesh& mesh, const std::vector<std::string>& region_names) {
    Text out;
    const Index n_boundaries = static_cast<Index>(mesh.boundary_names.size());
    const auto n_cracked = std::ranges::count(mesh.interior_edges, true, &InteriorEdge::cracked);
    const auto n_unnamed = std::ranges::count(mesh.boundary_names, "");
    const auto n_joined = std::ranges::count_if(mesh.interior_edges, [](const auto& e) { return e.joint >= 0; });
    Index n_joints = 0;
    for (const InteriorEdge& edge : mesh.interior_edges) n_joints = std::max(n_joints, edge.joint + 1);
    const Index first_joint = n_boundaries + 2 + n_regions(mesh);
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n"
        << n_boundaries - n_unnamed + n_regions(mesh) + (n_cracked > 0 ? 1 : 0) + n_joints << "\n";
    for (Index i = 0; i < n_boundaries; ++i)
        if (!mesh.boundary_names[i].empty()) out << "1 " << i + 1 << " \"" << mesh.boundary_names[i] << "\"\n";
    if (n_cracked > 0) out << "1 " << n_boundaries + 1 << " \"crack\"\n";
    for (Index i = 0; i < n_regions(mesh); ++i) {
        const bool has_name = i < std::ssize(region_names);
        out << "2 " << n_boundaries + 2 + i << " \"" << (has_name ? region_names[i] : "region" + std::to_string(i))
            << "\"\n";
    }
    for (Index i = 0; i < n_joints; ++i) out << "1 " << first_joint + i << " \"joint" << i << "\"\n";
    out << "$EndPhysicalNames\n$Nodes\n" << mesh.n_vertices() << "\n";
    for (Index v = 0; v < mesh.n_vertices(); ++v)
        out << v + 1 << " " << mesh.vertices[v].x() << " " << mesh.vertices[v].y() << " 0\n";
    out << "$EndNodes\n$Elements\n"
        << std::ssize(mesh.boundary_edges) + n_cracked + n_joined + mesh.n_triangles() << "\n";
    Index n = 0;
    const auto element = [&](int type, Index group, const auto& vertices) {
        out << ++n << " " << type << " 2 " << group << " " << group;
        for (const Index v : vertices) out << " " << v + 1;
        out << "\n";
    };
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        element(1, mesh.boundary_names[edge.boundary].empty() ? 0 : edge.boundary + 1, ends(mesh, edge));
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.cracked) element(1, n_boundaries + 1, ends(mesh, edge));
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.joint >= 0) element(1, first_joint + edge.joint, ends(mesh, edge));
    for (Index t = 0; t < mesh.n_triangles(); ++t) element(2, n_boundaries + 2 + mesh.region[t], mesh.triangles[t]);
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

/// The parts of a picture and their names, a line of the page after another.
class SvgLegend {
public:
    SvgLegend(double left, double top, double right) : left_(left), right_(right), x_(left), y_(top) {}

    void area(const std::string& colour, const std::string& name) {
        add(name, "<rect width=\"24\" height=\"14\" y=\"-12\" stroke=\"#8a8a8a\" fill=\"" + colour + "\"/>");
    }
    void line(const std::string& colour, const std::string& name) {
        add(name, "<path d=\"M0 -5L24 -5\" stroke-width=\"3\" stroke=\"" + colour + "\"/>");
    }
    const std::string& text() const { return text_; }
    double bottom() const { return text_.empty() ? y_ : y_ + height; }

private:
    static constexpr double height = 26, of_letter = 9, of_symbol = 56;  // [pixel]

    void add(const std::string& name, const std::string& symbol) {
        const double width = of_symbol + of_letter * static_cast<double>(name.size());
        if (x_ > left_ && x_ + width > right_) x_ = left_, y_ += height;
        text_ += "<g transform=\"translate(" + decimal(x_) + "," + decimal(y_ + height - 8) + ")\">" + symbol +
                 "<text x=\"32\" font-family=\"sans-serif\" font-size=\"16\">" + xml_text(name) + "</text></g>\n";
        x_ += width;
    }

    double left_, right_, x_, y_;
    std::string text_;
};

std::string svg(const Mesh& mesh, const std::vector<std::string>& region_names,
                const std::vector<std::string>& joint_names) {
    const Box box = bounding_box(mesh.vertices);
    constexpr double width = 1600, margin = 10;  // [pixel]
    const double pixels = width / box.extent().x();
    Text out;
    const auto point = [&](const char* command, Index vertex) {
        const Vec2& x = mesh.vertices[vertex];
        out << command << margin + pixels * (x.x() - box.low.x()) << " " << margin + pixels * (box.high.y() - x.y());
    };
    const auto lines = [&](const char* colour, double line_width, const auto& edges, const auto& is_drawn) {
        if (std::ranges::none_of(edges, is_drawn)) return false;
        out << "<path fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << line_width << "\" d=\"";
        for (const auto& edge : edges)
            if (is_drawn(edge)) point("M", ends(mesh, edge)[0]), point("L", ends(mesh, edge)[1]);
        out << "\"/>\n";
        return true;
    };
    SvgLegend legend(margin, pixels * box.extent().y() + 2 * margin, width);
    constexpr const char* fills[]{"#ffffff", "#f0c8b4", "#bcd8ea", "#d6e2ae",
                                  "#f0e0a4", "#d8c4e6", "#aee2d4", "#f0c0d4"};
    for (Index region = 0; region < n_regions(mesh); ++region) {
        const char* const fill = fills[region % std::size(fills)];
        const bool is_there = std::ranges::count(mesh.region, region) > 0;
        if (n_regions(mesh) > 1 && is_there && region < std::ssize(region_names))
            legend.area(fill, region_names[region]);
        if (region == 0 || !is_there) continue;  // the colour of the page
        out << "<path fill=\"" << fill << "\" d=\"";
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            if (mesh.region[t] != region) continue;
            const auto& [a, b, c] = mesh.triangles[t];
            point("M", a), point("L", b), point("L", c), out << "Z";
        }
        out << "\"/>\n";
    }
    using Interior = const InteriorEdge&;
    const auto& interior = mesh.interior_edges;
    lines("#8a8a8a", 0.4, interior, [](Interior e) { return !e.cracked; });
    if (lines("#2f5d8a", 1.2, interior, [&](Interior e) { return !mesh.grain.empty() && !mesh.within_grain(e); }))
        legend.line("#2f5d8a", "borders of grains");
    constexpr const char* of_joints[]{"#1b7f3b", "#7b3fa0", "#d98200", "#00808a", "#9a6324", "#d6006f"};
    std::vector<std::string> names;  // of joint sets
    for (const InteriorEdge& e : interior)
        while (e.joint >= std::ssize(names))
            names.push_back(names.size() < joint_names.size() ? joint_names[names.size()]
                                                              : "joint" + std::to_string(names.size()));
    std::set<std::string> drawn;
    for (const std::string& name : names) {
        const char* const stroke = of_joints[drawn.size() % std::size(of_joints)];
        if (!drawn.insert(name).second) continue;
        if (lines(stroke, 2, interior, [&](Interior e) { return e.joint >= 0 && names[e.joint] == name; }))
            legend.line(stroke, name);
    }
    lines("#000000", 1.2, mesh.boundary_edges, [](const BoundaryEdge&) { return true; });
    if (lines("#c0392b", 2, interior, [](Interior e) { return e.cracked; })) legend.line("#c0392b", "cracked");
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + decimal(width + 2 * margin) + "\" height=\"" +
           decimal(legend.bottom()) + "\">\n" + out.text + legend.text() + "</svg>\n";
}

}  // namespace

std::string mesh_as_text(const Mesh& mesh, const std::string& ending, const std::vector<std::string>& region_names,
                         const std::vector<std::string>& joint_names) {
    if (ending == ".msh") return gmsh(mesh, region_names);
    if (ending == ".vtu") return vtu(mesh);
    if (ending == ".svg") return svg(mesh, region_names, joint_names);
    throw std::invalid_argument("a mesh is written as .msh, .vtu or .svg, not as `" + ending + "`");
}

}  // namespace knap
