// [domain] and [mesh]: outer ring, holes, cracks, regions, sizes.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "geometry/arcs.hpp"
#include "scenario/assemble.hpp"

namespace knap {
namespace {

constexpr double most_sides = 100000;  // of a circle; far beyond what a mesh could follow

Index boundary_number(Shape& shape, const std::string& name) {
    const auto found = std::find(shape.boundary_names.begin(), shape.boundary_names.end(), name);
    const auto number = static_cast<Index>(found - shape.boundary_names.begin());
    if (found == shape.boundary_names.end()) shape.boundary_names.push_back(name);
    return number;
}

std::vector<Vec2> rectangle(const Vec2& low, const Vec2& high) { return {low, {high.x(), low.y()}, high, {low.x(), high.y()}}; }

bool too_fine(const Assembly& assembly, const std::string& path, const Arc& arc) {
    const MeshOptions& mesh = assembly.scenario.mesh;
    const bool fine = arc.length() > most_sides * SizeField(mesh, 1).smallest() && sides_of(arc, SizeField(mesh, 1)) > most_sides;
    if (fine) assembly.findings.error("out-of-range", "`" + path + "` is too large for the mesh size", assembly.at(path));
    return fine;
}

/// A circle as a polygon with sides of about the local mesh size.
std::vector<Vec2> round(const Assembly& assembly, const std::string& table) {
    const std::optional<Vec2> centre = assembly.values.pair(table + ".centre");
    const std::optional<double> radius = assembly.values.number(table + ".radius");
    if (!centre || !radius || !(assembly.scenario.mesh.size > 0)) return {};
    if (too_fine(assembly, table + ".radius", {*centre, *radius, 0, 2 * std::numbers::pi})) return {};
    return circle(*centre, *radius, SizeField(assembly.scenario.mesh, 1));
}

/// A polygon some of whose sides are arcs, and the side that each of its pieces belongs to.
struct Curve {
    std::vector<Vec2> points;
    std::vector<std::size_t> side;
};

/// The arcs of a table, by side from 0.
std::map<std::size_t, Arc> arcs(const Assembly& assembly, const std::string& table, const std::vector<Vec2>& corners) {
    std::map<std::size_t, Arc> found;
    for (std::size_t i = 0; i < assembly.values.count(table + ".arcs"); ++i) {
        const std::string path = item(table + ".arcs", i);
        const std::optional<double> number = assembly.values.number(path + ".side");
        const std::optional<Vec2> through = assembly.values.pair(path + ".through");
        if (!number || !through || corners.empty()) continue;
        if (*number > static_cast<double>(corners.size())) {
            assembly.findings.error("out-of-range", "`" + path + ".side` is " + std::to_string(static_cast<long long>(*number)) + ", and there are " +
                                                        std::to_string(corners.size()) + " sides",
                                    assembly.at(path + ".side")).note = "side 1 leads from the first point to the second, the last one back to the first";
            continue;
        }
        const std::size_t side = static_cast<std::size_t>(*number) - 1;
        const std::optional<Arc> arc = arc_through(corners[side], *through, corners[(side + 1) % corners.size()]);
        if (!arc)
            assembly.findings.error("out-of-range", "`" + path + ".through` lies on the straight line of its side, so there is no arc", assembly.at(path + ".through")).note =
                "a point of the arc between the two corners, beside their line; a straight side needs no arc";
        else if (!too_fine(assembly, path + ".through", *arc) && !found.emplace(side, *arc).second)
            assembly.findings.error("duplicate-name", "`" + path + "` is the second arc of side " + std::to_string(side + 1), assembly.at(path + ".side"));
    }
    return found;
}

Curve curved(const Assembly& assembly, const std::string& table, const std::vector<Vec2>& corners) {
    Curve curve;
    const std::map<std::size_t, Arc> arc_of = assembly.scenario.mesh.size > 0 ? arcs(assembly, table, corners) : std::map<std::size_t, Arc>{};
    for (std::size_t side = 0; side < corners.size(); ++side) {
        curve.points.push_back(corners[side]);
        if (const auto arc = arc_of.find(side); arc != arc_of.end())
            for (const Vec2& p : points_within(arc->second, SizeField(assembly.scenario.mesh, 1))) curve.points.push_back(p);
        curve.side.resize(curve.points.size(), side);
    }
    return curve;
}

std::vector<Vec2> points(const Assembly& assembly, const std::string& path, std::size_t least) {
    std::vector<Vec2> list = assembly.values.points(path);
    if (assembly.values.has(path) && list.size() < least)
        assembly.findings.error("out-of-range", "`" + path + "` needs at least " + std::to_string(least) + " points", assembly.at(path));
    return list;
}

/// The curve of a hole or a region: points, a circle, or (`boxes`) a box.
std::vector<Vec2> curve(const Assembly& assembly, const std::string& table, bool boxes) {
    const auto which = boxes ? assembly.the_one(table, {"points", "radius", "box"}, true) : assembly.the_one(table, {"points", "radius"}, true);
    const bool is_round = which == "radius";
    if (is_round != assembly.values.given(table + ".centre") && which)
        assembly.findings.error("missing-key", "`" + table + "`: centre and radius belong together", assembly.at(table + (is_round ? "" : ".centre")));
    if (which && which != "points" && assembly.values.count(table + ".arcs") > 0)
        assembly.findings.error_at_name("exclusive-keys", "`" + table + ".arcs` belongs to points", assembly.at(item(table + ".arcs", 0)));
    if (is_round) return round(assembly, table);
    if (which == "points") return curved(assembly, table, points(assembly, table + ".points", 3)).points;
    if (const std::optional<Box> box = assembly.values.box(table + ".box")) return rectangle(box->low, box->high);
    return {};
}

void check_shape_is_given(const Assembly& assembly) {
    const Values& values = assembly.values;
    const bool domain = values.given("domain"), known_wrong = domain && !values.has("domain");
    if (!values.given("domain.shape") && !known_wrong)
        assembly.findings.error("missing-key", domain ? "`domain.shape` is missing" : "`domain` is missing", assembly.at("domain")).note =
            "shape: rectangle, polygon, disc; or a mesh of your own, mesh.file";
    for (const char* key : {"mesh.unit", "mesh.cracks"})
        if (values.given(key))
            assembly.findings.error_at_name("exclusive-keys", "`" + std::string(key) + "` belongs to mesh.file", assembly.at(key)).note =
                "a shape has [[domain.crack]] and units of its own";
}

void assemble_outer(Assembly& assembly) {
    const Values& values = assembly.values;
    Shape& shape = assembly.scenario.shape;
    const std::string kind = values.text("domain.shape").value_or("");
    if (kind == "rectangle") {
        const std::optional<Vec2> size = values.pair("domain.size"), origin = values.pair("domain.origin");
        if (size && origin) shape.outer.points = rectangle(*origin, *origin + *size);
        for (const char* name : {"bottom", "right", "top", "left"}) shape.outer.boundary.push_back(boundary_number(shape, name));
    } else if (kind == "disc") {
        shape.outer.points = round(assembly, "domain");
        shape.outer.boundary.assign(shape.outer.points.size(), boundary_number(shape, "rim"));
    } else if (kind == "polygon") {
        const std::vector<Vec2> corners = points(assembly, "domain.points", 3);
        const Curve outline = curved(assembly, "domain", corners);
        shape.outer.points = outline.points;
        const std::size_t n = corners.size();
        if (!values.given("domain.sides")) {
            Node names{.type = Node::Type::array};
            for (std::size_t i = 1; i <= n; ++i) names.children.push_back(Node::of_text("side" + std::to_string(i)));
            if (n > 0) assembly.values.compute("domain.sides", std::move(names));
        }
        const auto names = values.items("domain.sides");
        std::vector<Index> of_side;
        for (const Node* name : names) {
            check_name(assembly, "domain.sides", name->text, "a boundary");
            of_side.push_back(boundary_number(shape, name->text));
        }
        for (const std::size_t side : outline.side) shape.outer.boundary.push_back(side < of_side.size() ? of_side[side] : 0);
        if (n > 0 && values.has("domain.sides") && names.size() != n)
            assembly.findings.error("out-of-range", "`domain.sides` has " + std::to_string(names.size()) + " names for " + std::to_string(n) + " sides",
                                    assembly.at("domain.sides"));
    }
}

void assemble_holes(Assembly& assembly) {
    Shape& shape = assembly.scenario.shape;
    for (std::size_t i = 0; i < assembly.values.count("domain.hole"); ++i) {
        const std::string hole = item("domain.hole", i);
        if (!assembly.values.given(hole + ".name")) assembly.values.compute(hole + ".name", Node::of_text("hole" + std::to_string(i + 1)));
        Ring ring{.points = curve(assembly, hole, false)};
        if (const auto name = assembly.values.text(hole + ".name")) check_name(assembly, hole + ".name", *name, "a boundary");
        if (const auto name = assembly.values.text(hole + ".name")) ring.boundary.assign(ring.points.size(), boundary_number(shape, *name));
        shape.holes.push_back(std::move(ring));
    }
}

void assemble_regions(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("domain.region"); ++i) {
        const std::string region = item("domain.region", i);
        Region part{.points = curve(assembly, region, true)};
        part.tag = assembly.material_at(region + ".material").value_or(0);
        assembly.scenario.shape.regions.push_back(std::move(part));
    }
}

}  // namespace

void assemble_mesh_options(Assembly& assembly) {
    const Values& values = assembly.values;
    MeshOptions& mesh = assembly.scenario.mesh;
    if (values.has("mesh")) assembly.the_one("mesh", {"size", "file"}, true);
    mesh.size = values.number("mesh.size").value_or(0);
    mesh.min_angle = values.number("mesh.min_angle").value_or(mesh.min_angle);
    mesh.grading = values.number("mesh.grading").value_or(mesh.grading);
    mesh.seed = assembly.scenario.seed;
    if (values.has("mesh.order")) assembly.scenario.order = static_cast<Index>(values.find("mesh.order")->node.integer);
    for (std::size_t i = 0; i < values.count("mesh.refine"); ++i) {
        const std::string refine = item("mesh.refine", i);
        const std::optional<Box> box = values.box(refine + ".inside");
        const std::optional<double> size = values.number(refine + ".size");
        if (box && size) mesh.refine.push_back({box->low, box->high, *size});
    }
}

void assemble_shape(Assembly& assembly) {
    if (assembly.values.given("mesh.file")) {
        assemble_mesh_file(assembly);
    } else {
        check_shape_is_given(assembly);
        assemble_outer(assembly);
        assemble_holes(assembly);
        for (std::size_t i = 0; i < assembly.values.count("domain.crack"); ++i)
            assembly.scenario.shape.cracks.push_back({.points = points(assembly, item("domain.crack", i) + ".points", 2)});
        assemble_regions(assembly);
    }
    assembly.scenario.plane = assembly.values.text("domain.model") == "plane stress" ? PlaneModel::stress : PlaneModel::strain;
    assembly.scenario.thickness = assembly.values.number("domain.thickness").value_or(1);
}

}  // namespace knap
