// [domain] and [mesh]: outer ring, holes, cracks, regions, sizes.
#include <algorithm>
#include <cmath>
#include <numbers>

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

/// A circle as a polygon with sides of about the mesh size.
std::vector<Vec2> round(const Assembly& assembly, const std::string& table) {
    const std::optional<Vec2> centre = assembly.values.pair(table + ".centre");
    const std::optional<double> radius = assembly.values.number(table + ".radius");
    const double size = assembly.scenario.mesh.size;
    if (!centre || !radius || !(size > 0)) return {};
    const double n_sides = std::max(12.0, std::ceil(2 * std::numbers::pi * *radius / size));
    if (n_sides > most_sides) {
        assembly.findings.error("out-of-range", "`" + table + ".radius` is too large for the mesh size", assembly.at(table + ".radius"));
        return {};
    }
    return circle(*centre, *radius, static_cast<int>(n_sides));
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
    if (is_round) return round(assembly, table);
    if (which == "points") return points(assembly, table + ".points", 3);
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
        shape.outer.points = points(assembly, "domain.points", 3);
        const std::size_t n = shape.outer.points.size();
        if (!values.given("domain.sides")) {
            Node names{.type = Node::Type::array};
            for (std::size_t i = 1; i <= n; ++i) names.children.push_back(Node::of_text("side" + std::to_string(i)));
            if (n > 0) assembly.values.compute("domain.sides", std::move(names));
        }
        const auto names = values.items("domain.sides");
        for (const Node* name : names) shape.outer.boundary.push_back(boundary_number(shape, name->text));
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
