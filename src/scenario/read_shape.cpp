// The shape of [domain] or of a [[body]]: outer ring, holes, cracks, regions.
#include "mesh/size_field.hpp"
#include "scenario/reading.hpp"

#include <map>
#include <numbers>

namespace knap {
namespace {

constexpr double max_sides = 100000;  // of a circle; far beyond what a mesh could follow

std::vector<Vec2> rectangle(const Vec2& low, const Vec2& high) {
    return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

std::vector<Vec2> points_of(const Table& table) {
    return table.get<std::vector<Vec2>>("points").value_or(std::vector<Vec2>());
}

/// Reads closed curves.
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
        if (form == "points") return polygon(table, points_of(table)).points;
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

/// One name for each side; computed if not given.
void read_polygon(const Table& table, const CurveReader& curves, const std::string& prefix, Shape& shape) {
    const std::vector<Vec2> corners = points_of(table);
    const CurveReader::Polygon outline = curves.polygon(table, corners);
    const std::size_t n = corners.size();
    std::vector<Node> sides;
    for (std::size_t i = 1; i <= n; ++i) sides.push_back(Node::of_text("side" + std::to_string(i)));
    if (n > 0) table.compute("sides", Node::of_list(std::move(sides)));
    std::vector<Index> of_side;
    for (const std::string& name : table.texts("sides")) of_side.push_back(boundary_index(shape, prefix + name));
    shape.outer.points = outline.points;
    for (const std::size_t side : outline.side)
        shape.outer.boundary.push_back(side < of_side.size() ? of_side[side] : 0);
    if (n > 0 && table.has("sides") && of_side.size() != n)
        table.error("out-of-range", "sides",
                    "has " + std::to_string(of_side.size()) + " names for " + std::to_string(n) + " sides");
}

}  // namespace

std::vector<Vec2> read_curve(const Table& table, const MeshOptions& mesh) {
    return CurveReader(mesh).curve(table, true);
}

void read_shape(const Table& table, const MeshOptions& mesh, const std::string& prefix, Shape& shape) {
    const CurveReader curves(mesh);
    shape.snap = table.number("snap").value_or(0);
    const std::string kind = table.text("shape");
    if (kind == "rectangle") {
        const auto size = table.get<Vec2>("size"), origin = table.get<Vec2>("origin");
        if (size && origin) shape.outer.points = rectangle(*origin, *origin + *size);
        for (const char* name : {"bottom", "right", "top", "left"})
            shape.outer.boundary.push_back(boundary_index(shape, prefix + name));
    } else if (kind == "disc") {
        shape.outer.points = curves.circle(table);
        shape.outer.boundary.assign(shape.outer.points.size(), boundary_index(shape, prefix + "rim"));
    } else if (kind == "polygon") {
        read_polygon(table, curves, prefix, shape);
    }
    for (const Table& hole : table.list("hole")) {
        hole.compute("name", Node::of_text("hole" + std::to_string(shape.holes.size() + 1)));
        Ring ring{.points = curves.curve(hole, false)};
        if (hole.has("name"))
            ring.boundary.assign(ring.points.size(), boundary_index(shape, prefix + hole.text("name")));
        if (!ring.points.empty()) shape.holes.push_back(std::move(ring));
    }
    for (const Table& crack : table.list("crack"))
        if (std::vector<Vec2> points = points_of(crack); !points.empty())
            shape.cracks.push_back(
                {.points = std::move(points), .joint = crack.given("interface") ? crack.new_joint_set() : -1});
    for (const Table& region : table.list("region")) {
        const Index tag = region.material("material").value_or(shape.tag);
        if (std::vector<Vec2> points = curves.curve(region, true); !points.empty())
            shape.regions.push_back({.points = std::move(points), .tag = tag});
    }
}

}  // namespace knap
