// [domain] and [mesh]: outer ring, holes, cracks, regions, sizes.
#include "mesh/size_field.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
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
    explicit CurveReader(Reading& reading) : mesh_(reading.scenario.mesh), size_(mesh_, 1) {}

    /// A circle as a polygon with sides of about the local mesh size.
    std::vector<Vec2> circle(const Table& table) const {
        const std::optional<Vec2> centre = table.pair("centre");
        const std::optional<double> radius = table.number("radius");
        if (!centre || !radius || !(mesh_.size > 0)) return {};
        if (too_fine(table, "radius", {*centre, *radius, 0, 2 * std::numbers::pi})) return {};
        return knap::circle(*centre, *radius, size_);
    }

    std::vector<Vec2> points(const Table& table, std::size_t least) const {
        std::vector<Vec2> list = table.points("points");
        if (table.has("points") && list.size() < least)
            table.error("out-of-range", "points", "needs at least " + std::to_string(least) + " points");
        return list;
    }

    /// A polygon some of whose sides are arcs, and the side that each of its pieces belongs to.
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
        const auto which =
            boxes ? table.the_one({"points", "radius", "box"}, true) : table.the_one({"points", "radius"}, true);
        const bool is_round = which == "radius";
        if (which && is_round != table.given("centre"))
            table.report("missing-key", is_round ? "" : "centre",
                         "`" + table.path() + "`: centre and radius belong together");
        if (which && which != "points" && !table.list("arcs").empty())
            table.reading().findings.error_at_name("exclusive-keys", "`" + table.path("arcs") + "` belongs to points",
                                                   table.reading().at(table.list("arcs")[0].path()));
        if (is_round) return circle(table);
        if (which == "points") return polygon(table, points(table, 3)).points;
        if (const std::optional<Box> box = table.box("box")) return rectangle(box->low, box->high);
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
            const std::optional<double> number = row.number("side");
            const std::optional<Vec2> through = row.pair("through");
            if (!number || !through || corners.empty()) continue;
            if (*number > static_cast<double>(corners.size())) {
                const auto n = static_cast<long long>(*number);
                row.error("out-of-range", "side",
                          "is " + std::to_string(n) + ", and there are " + std::to_string(corners.size()) + " sides",
                          "side 1 leads from the first point to the second, the last one back to the first");
                continue;
            }
            const std::size_t side = static_cast<std::size_t>(*number) - 1;
            const std::optional<Arc> arc = arc_through(corners[side], *through, corners[(side + 1) % corners.size()]);
            if (!arc)
                row.error(
                    "out-of-range", "through", "lies on the straight line of its side, so there is no arc",
                    "a point of the arc between the two corners, beside their line; a straight side needs no arc");
            else if (!too_fine(row, "through", *arc) && !found.emplace(side, *arc).second)
                row.report("duplicate-name", "side",
                           "`" + row.path() + "` is the second arc of side " + std::to_string(side + 1));
        }
        return found;
    }

    const MeshOptions& mesh_;
    SizeField size_;
};

void check_shape_is_given(Reading& reading) {
    const Table domain = reading.table("domain"), mesh = reading.table("mesh");
    const bool known_wrong = domain.given() && !domain.has();
    if (!domain.given("shape") && !known_wrong) {
        const std::string missing = domain.given() ? "`domain.shape`" : "`domain`";
        reading.findings.error("missing-key", missing + " is missing", reading.at("domain")).note =
            "shape: rectangle, polygon, disc; or a mesh of your own, mesh.file";
    }
    for (const char* key : {"unit", "cracks"})
        if (mesh.given(key))
            mesh.error_at_name("exclusive-keys", key, "belongs to mesh.file",
                               "a shape has [[domain.crack]] and units of its own");
}

/// One name a side; those of a polygon are computed where they are not given.
void read_polygon(const Table& domain, const CurveReader& curves, Shape& shape) {
    const std::vector<Vec2> corners = curves.points(domain, 3);
    const CurveReader::Polygon outline = curves.polygon(domain, corners);
    const std::size_t n = corners.size();
    std::vector<Node> sides;
    for (std::size_t i = 1; i <= n; ++i) sides.push_back(Node::of_text("side" + std::to_string(i)));
    if (n > 0) domain.compute("sides", Node::of_list(std::move(sides)));
    std::vector<Index> of_side;
    for (const Node* name : domain.items("sides")) {
        domain.check_name("sides", name->text, "a boundary");
        of_side.push_back(boundary_index(shape, name->text));
    }
    shape.outer.points = outline.points;
    for (const std::size_t side : outline.side)
        shape.outer.boundary.push_back(side < of_side.size() ? of_side[side] : 0);
    if (n > 0 && domain.has("sides") && of_side.size() != n)
        domain.error("out-of-range", "sides",
                     "has " + std::to_string(of_side.size()) + " names for " + std::to_string(n) + " sides");
}

void read_shape(Reading& reading) {
    const Table domain = reading.table("domain");
    const CurveReader curves(reading);
    Shape& shape = reading.scenario.shape;
    const std::string kind = domain.text("shape");
    if (kind == "rectangle") {
        const std::optional<Vec2> size = domain.pair("size"), origin = domain.pair("origin");
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
        if (hole.has("name")) {
            hole.check_name("name", hole.text("name"), "a boundary");
            ring.boundary.assign(ring.points.size(), boundary_index(shape, hole.text("name")));
        }
        shape.holes.push_back(std::move(ring));
    }
    for (const Table& crack : domain.list("crack")) shape.cracks.push_back({.points = curves.points(crack, 2)});
    for (const Table& region : domain.list("region")) {
        std::vector<Vec2> points = curves.curve(region, true);
        shape.regions.push_back({.points = std::move(points), .tag = region.material("material").value_or(0)});
    }
}

}  // namespace

void read_body(Reading& reading) {
    Scenario& scenario = reading.scenario;
    const Table mesh = reading.table("mesh"), domain = reading.table("domain");
    if (mesh.has()) mesh.the_one({"size", "file"}, true);
    mesh.fill(scenario.mesh);
    mesh.fill(scenario);
    domain.fill(scenario);
    scenario.mesh.seed = scenario.seed;
    for (const Table& refine : mesh.list("refine")) {
        const std::optional<Box> box = refine.box("inside");
        const std::optional<double> size = refine.number("size");
        if (box && size) scenario.mesh.refine.push_back({box->low, box->high, *size});
    }
    if (mesh.given("file")) {
        read_mesh_file(reading);
    } else {
        check_shape_is_given(reading);
        read_shape(reading);
    }
    if (domain.text("model") == "plane stress") scenario.plane = PlaneModel::stress;
}

}  // namespace knap
