// [domain] and [mesh]: outer ring, holes, cracks, regions, sizes; or a mesh from a file.
#include "mesh/gmsh.hpp"
#include "mesh/size_field.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <numbers>

namespace knap {
namespace {

constexpr double max_sides = 100000;  // of a circle; far beyond what a mesh could follow

std::vector<Vec2> rectangle(const Vec2& low, const Vec2& high) {
    return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

/// Reads closed curves and polylines.
class CurveReader {
public:
    explicit CurveReader(const MeshOptions& mesh) : mesh_(mesh), size_(mesh_, 1) {}

    /// A circle as a polygon with sides of about the local mesh size.
    std::vector<Vec2> circle(const Table& table) const {
        const auto centre = table.get<Vec2>("centre");
        const auto radius = table.number("radius");
        if (!centre || !radius || !(mesh_.size > 0)) return {};
        if (too_fine(table, "radius", {*centre, *radius, 0, 2 * std::numbers::pi})) return {};
        return knap::circle(*centre, *radius, size_);
    }

    std::vector<Vec2> points(const Table& table, std::size_t min) const {
        const auto list = table.get<std::vector<Vec2>>("points");
        if (list && list->size() < min)
            table.error("out-of-range", "points", "needs at least " + std::to_string(min) + " points");
        return list.value_or(std::vector<Vec2>());
    }

    /// A polygon some of whose sides are arcs, and the side to which each of its pieces belongs.
    struct Polygon {
        std::vector<Vec2> points;
        std::vector<std::size_t> side;
    };
    Polygon polygon(const Table& table, const std::vector<Vec2>& corners) const {
        Polygon polygon;
        const auto arc_of = mesh_.size > 0 ? arcs(table, corners) : std::map<std::size_t, Arc>{};
        for (std::size_t side = 0; side < corners.size(); ++side) {
            polygon.points.push_back(corners[side]);
            if (const auto arc = arc_of.find(side); arc != arc_of.end())
                for (const Vec2& p : points_within(arc->second, size_)) polygon.points.push_back(p);
            polygon.side.resize(polygon.points.size(), side);
        }
        return polygon;
    }

    /// The curve of a hole or a region: points, a circle, or (`boxes`) a box.
    std::vector<Vec2> curve(const Table& table, bool boxes) const {
        std::vector<std::string> forms{"points", "radius"};
        if (boxes) forms.emplace_back("box");
        const auto form = table.one_of(forms, true);
        const bool is_round = form == "radius";
        if (form && is_round != table.given("centre"))
            table.error("missing-key", is_round ? "" : "centre", ": centre and radius belong together");
        if (form && form != "points" && table.given("arcs")) table.error("exclusive-keys", "arcs", "belongs to points");
        if (is_round) return circle(table);
        if (form == "points") return polygon(table, points(table, 3)).points;
        if (const auto box = table.get<Box>("box")) return rectangle(box->low, box->high);
        return {};
    }

private:
    bool too_fine(const Table& table, const std::string& key, const Arc& arc) const {
        const bool fine = arc.length() > max_sides * size_.smallest() && sides_of(arc, size_) > max_sides;
        if (fine) table.error("out-of-range", key, "is too large for the mesh size");
        return fine;
    }

    /// The arcs of a table, by side from 0.
    std::map<std::size_t, Arc> arcs(const Table& table, const std::vector<Vec2>& corners) const {
        std::map<std::size_t, Arc> found;
        for (const Table& row : table.list("arcs")) {
            const auto number = row.get<std::int64_t>("side");
            const auto through = row.get<Vec2>("through");
            if (!number || !through || corners.empty()) continue;
            if (*number > std::ssize(corners)) {
                row.error(
                    "out-of-range", "side",
                    "is " + std::to_string(*number) + ", and there are " + std::to_string(corners.size()) + " sides",
                    "side 1 joins the first point to the second, the last side closes the ring");
                continue;
            }
            const std::size_t side = static_cast<std::size_t>(*number) - 1;
            const auto arc = arc_through(corners[side], *through, corners[(side + 1) % corners.size()]);
            if (!arc)
                row.error("out-of-range", "through", "lies on the straight line of its side, so there is no arc",
                          "a point of the arc between the two corners, off their line; a straight side needs no arc");
            else if (!too_fine(row, "through", *arc) && !found.emplace(side, *arc).second)
                row.error("duplicate-name", "side", "gives a second arc of side " + std::to_string(side + 1));
        }
        return found;
    }

    const MeshOptions& mesh_;
    SizeField size_;
};

void check_shape_is_given(const Table& domain, const Table& mesh) {
    if (!domain.given("shape") && (!domain.given() || domain.has("")))
        domain.error("missing-key", domain.given() ? "shape" : "", "is missing",
                     "shape: rectangle, polygon, disc; or a mesh of your own, mesh.file");
    for (const char* key : {"unit", "cracks"})
        if (mesh.given(key))
            mesh.error("exclusive-keys", key, "belongs to mesh.file", "a shape has [[domain.crack]], and units itself");
}

/// One name for each side; computed if not given.
void read_polygon(const Table& domain, const CurveReader& curves, Shape& shape) {
    const std::vector<Vec2> corners = curves.points(domain, 3);
    const CurveReader::Polygon outline = curves.polygon(domain, corners);
    const std::size_t n = corners.size();
    std::vector<Node> sides;
    for (std::size_t i = 1; i <= n; ++i) sides.push_back(Node::of_text("side" + std::to_string(i)));
    if (n > 0) domain.compute("sides", Node::of_list(std::move(sides)));
    std::vector<Index> of_side;
    for (const std::string& name : domain.texts("sides")) of_side.push_back(boundary_index(shape, name));
    shape.outer.points = outline.points;
    for (const std::size_t side : outline.side)
        shape.outer.boundary.push_back(side < of_side.size() ? of_side[side] : 0);
    if (n > 0 && domain.has("sides") && of_side.size() != n)
        domain.error("out-of-range", "sides",
                     "has " + std::to_string(of_side.size()) + " names for " + std::to_string(n) + " sides");
}

void read_shape(const Table& domain, Scenario& scenario) {
    const CurveReader curves(scenario.mesh);
    Shape& shape = scenario.shape;
    const std::string kind = domain.text("shape");
    if (kind == "rectangle") {
        const auto size = domain.get<Vec2>("size"), origin = domain.get<Vec2>("origin");
        if (size && origin) shape.outer.points = rectangle(*origin, *origin + *size);
        for (const char* name : {"bottom", "right", "top", "left"})
            shape.outer.boundary.push_back(boundary_index(shape, name));
    } else if (kind == "disc") {
        shape.outer.points = curves.circle(domain);
        shape.outer.boundary.assign(shape.outer.points.size(), boundary_index(shape, "rim"));
    } else if (kind == "polygon") {
        read_polygon(domain, curves, shape);
    }
    for (const Table& hole : domain.list("hole")) {
        hole.compute("name", Node::of_text("hole" + std::to_string(shape.holes.size() + 1)));
        Ring ring{.points = curves.curve(hole, false)};
        if (hole.has("name")) ring.boundary.assign(ring.points.size(), boundary_index(shape, hole.text("name")));
        shape.holes.push_back(std::move(ring));
    }
    for (const Table& crack : domain.list("crack")) shape.cracks.push_back({.points = curves.points(crack, 2)});
    for (const Table& region : domain.list("region")) {
        std::vector<Vec2> points = curves.curve(region, true);
        shape.regions.push_back({.points = std::move(points), .tag = region.material("material").value_or(0)});
    }
}

// ---- mesh.file: physical surfaces are materials, physical curves boundaries and cracks

/// The file defines the body and its mesh: keys that do so, too, are errors, and their defaults have no meaning.
void check_nothing_else(Reading& reading) {
    const auto exclude = [&](const char* table, std::string_view key) {
        if (!reading.table(table).given(key)) return reading.table(table).leave_out(key);
        reading.table(table).error("exclusive-keys", key, "has no meaning with mesh.file",
                                   "the file defines the body and its mesh");
    };
    for (const Key* key : keys_below("domain"))
        if (key->name() != "model" && key->name() != "thickness") exclude("domain", key->name());
    for (const char* key : {"min_angle", "grading", "refine"}) exclude("mesh", key);
}

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

/// The material of each physical surface.
std::vector<Index> materials_of_groups(const Table& table, const std::vector<GmshGroup>& groups) {
    const std::vector<std::string> materials = table.scenario().material_names();
    std::vector<Index> of_group;
    for (const GmshGroup& group : groups) {
        const auto found = std::ranges::find(materials, group.name);
        of_group.push_back(found == materials.end() ? 0 : static_cast<Index>(found - materials.begin()));
        if (found != materials.end() || materials.empty() || (!group.named && materials.size() == 1)) continue;
        if (group.name.empty())
            table.error("unknown-name", "file",
                        "has " + std::to_string(group.n) +
                            " triangles in no physical surface, so that their material is unknown",
                        "give each surface a physical group, with one of the names " + joined(materials) +
                            " (Mesh.SaveAll leaves groups out of format 2.2)");
        else
            table.error("unknown-name", "file", "has the physical surface `" + group.name + "`, which is no material",
                        "materials: " + joined(materials), did_you_mean(group.name, materials));
    }
    return of_group;
}

void mark_cracks(const Table& table, GmshMesh& read) {
    std::vector<std::string> known;
    for (const GmshGroup& group : read.inner_groups) known.push_back(group.name);
    for (const Node& name : table.items("cracks")) {
        const auto group = std::ranges::find(known, name.text) - known.begin();
        const bool on_boundary = std::ranges::count(read.mesh.boundary_names, name.text) > 0;
        if (group == std::ssize(known))
            table.reading().findings.error("unknown-name",
                                           "there is no physical curve `" + name.text + "` inside the body", name,
                                           on_boundary     ? "it lies on the boundary"
                                           : known.empty() ? "there is none"
                                                           : "known: " + joined(known),
                                           did_you_mean(name.text, known));
        for (const InnerLine& line : read.inner_lines)
            if (line.group == group) read.mesh.interior_edges[line.edge].cracked = true;
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

void read_mesh_file(Reading& reading) {
    const Table table = reading.table("mesh");
    check_nothing_else(reading);
    if (!table.has("file")) return;
    std::optional<std::string> bytes = table.bytes_of("file");
    if (!bytes) return;
    std::optional<GmshMesh> read = parse_mesh(table, *bytes);
    if (!read) return;
    const std::vector<Index> material = materials_of_groups(table, read->surface_groups);
    mark_cracks(table, *read);
    Mesh& mesh = read->mesh;
    const double unit = table.number("unit").value_or(1);
    for (Vec2& x : mesh.vertices) x *= unit;
    if (!table.given("unit")) warn_of_metres(table, mesh);
    for (Index& region : mesh.region) region = material[region];
    for (const std::string& name : mesh.boundary_names)
        if (!name.empty()) reading.scenario.shape.boundary_names.push_back(name);
    reading.scenario.files.push_back({table.path("file"), "mesh.msh", std::move(*bytes)});
    reading.scenario.given = std::make_shared<const MeshFile>(MeshFile{std::move(mesh)});
}

}  // namespace

void read_body(Reading& reading) {
    Scenario& scenario = reading.scenario;
    const Table mesh = reading.table("mesh"), domain = reading.table("domain");
    if (mesh.given() && mesh.has("")) mesh.one_of({"size", "file"}, true);
    mesh.fill(scenario.mesh);
    mesh.fill(scenario);
    domain.fill(scenario);
    scenario.mesh.seed = scenario.seed;
    for (const Table& refine : mesh.list("refine"))
        if (const auto box = refine.get<Box>("inside"); box && refine.has("size"))
            scenario.mesh.refine.push_back({box->low, box->high, *refine.number("size")});
    if (mesh.given("file")) return read_mesh_file(reading);
    check_shape_is_given(domain, mesh);
    read_shape(domain, scenario);
}

}  // namespace knap
