// [domain], [[body]] and [mesh]: the bodies of a scenario, their places and sizes.
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "base/random.hpp"
#include "microstructure/body_patterns.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>

namespace knap {
namespace {

/// Bodies may lie in each other by this part of the mesh size, as bodies in contact may (stepper/contact).
constexpr double allowed_overlap = 1e-3;
constexpr int max_bodies = 5000;  // of one pattern

void check_shape_is_given(const Table& domain, const Table& mesh) {
    if (!domain.given("shape") && (!domain.given() || domain.has("")))
        domain.error("missing-key", domain.given() ? "shape" : "", "is missing",
                     "shape: rectangle, polygon, disc; several bodies, [[body]]; or a mesh of your own, mesh.file");
    for (const char* key : {"unit", "cracks", "joint", "material", "grains"})
        if (mesh.given(key))
            mesh.error("exclusive-keys", key, "belongs to mesh.file", "a shape has [[domain.crack]], and units itself");
}

/// Keys of a shape have no meaning in [domain] when something else defines the bodies; nor have their defaults.
void exclude_shape_of_domain(Reading& reading, const std::string& other, const std::string& note) {
    const Table domain = reading.table("domain");
    for (const Key* key : keys_below("domain")) {
        if (std::ranges::count(keys_below("body[]"), key->name(), &Key::name) == 0) continue;  // no key of a shape
        if (other == "mesh.file" && key->name() == "region") continue;                         // over the mesh
        if (!domain.given(key->name())) domain.leave_out(key->name());
        else domain.error("exclusive-keys", key->name(), "has no meaning with " + other, note);
    }
}

void check_nothing_else(Reading& reading) {
    exclude_shape_of_domain(reading, "mesh.file", "the file defines the body and its mesh");
    for (const char* key : {"min_angle", "grading", "refine"})
        if (!reading.table("mesh").given(key)) reading.table("mesh").leave_out(key);
        else
            reading.table("mesh").error("exclusive-keys", key, "has no meaning with mesh.file",
                                        "the file defines the body and its mesh");
    for (const char* list : {"body", "bodies"})
        for (const Table& table : reading.list(list)) table.exclude("", "[[body]]", "mesh.file", "one of them");
}

void read_refined_place(const Table& table) {
    std::vector<RefinedPlace>& places = table.scenario().mesh.refine;
    const auto kind = table.one_of({"inside", "along"}, true);
    const auto box = table.get<Box>("inside");
    const auto points = table.get<std::vector<Vec2>>("along");
    const auto width = table.number("width"), size = table.number("size");
    if (kind == "along" && !table.given("width"))
        table.error("missing-key", "width", "is missing", "the width of the strip along the polyline");
    if (kind == "inside" && table.given("width"))
        table.error("exclusive-keys", "width", "belongs to along", "a box has the corners in `inside` only");
    if (!kind || !size) return;
    if (box) places.push_back({*box, *size});
    if (points && width) places.push_back(refined_strip(*points, *width, *size));
}

// ---- [[body]]

void check_is_new(const Table& table, const std::string& name) {
    const auto has_name = [&](const auto& other) { return other.name == name; };
    if (std::ranges::any_of(table.scenario().bodies, has_name) ||
        std::ranges::any_of(table.scenario().groups, has_name))
        table.error("duplicate-name", "name", ": `" + name + "` is the name of another body");
}

/// Computes the defaults of mesh size and material; returns the mesh options with the size.
MeshOptions compute_matter(const Table& table) {
    const Scenario& scenario = table.scenario();
    MeshOptions mesh = scenario.mesh;
    if (mesh.size > 0) table.compute("mesh_size", Node::of_number(mesh.size));
    if (!scenario.materials.empty()) table.compute("material", Node::of_text(scenario.materials.front().name));
    mesh.size = table.number("mesh_size").value_or(0);
    return mesh;
}

/// Adds a body without a shape. Its mesh depends on the seed and its name only, not on the other bodies.
Body& add_body(const Table& table, const std::string& name) {
    Scenario& scenario = table.scenario();
    check_is_new(table, name);
    Body& body = scenario.bodies.emplace_back(Body{.name = name, .path = table.path(), .mesh = compute_matter(table)});
    body.shape.tag = table.material("material").value_or(0);
    body.mesh.seed = Random(scenario.seed, "body " + name).bits();
    body.own_mesh_size = table.given("mesh_size");
    InitialVelocity initial{.on = {.body = name}, .value = Vec2::Zero()};
    table.fill(initial);
    if (table.given("velocity") || table.given("spin")) scenario.initial_velocities.push_back(initial);
    return body;
}

/// Turns a shape about a point and shifts it, as the keys of its table say.
void place(const Table& table, const Vec2& about, Shape& shape) {
    if (const double degrees = table.number("angle").value_or(0); degrees != 0) turn(shape, about, degrees * degree);
    if (const Vec2 shift = table.get<Vec2>("shift").value_or(Vec2::Zero()); !shift.isZero(0)) move(shape, shift);
}

void read_one_body(const Table& table) {
    table.compute("name", Node::of_text("body" + std::to_string(table.scenario().bodies.size() + 1)));
    const std::string name = table.text("name");
    Body& body = add_body(table, name);
    Shape& shape = body.shape;
    read_shape(table, body.mesh, name + ".", shape);
    if (shape.outer.points.empty()) return;
    const bool round = table.text("shape") == "disc";
    place(table, round ? table.get<Vec2>("centre").value_or(Vec2::Zero()) : Vec2(shape.outer.points.front()), shape);
}

// ---- [[bodies]]

/// None, and an error, where the pattern is not possible.
Outlines read_wall(const Table& table, double mesh_size) {
    WallOptions options;
    table.fill(options);
    options.columns = static_cast<int>(table.get<std::int64_t>("columns").value_or(0));
    options.rows = static_cast<int>(table.get<std::int64_t>("rows").value_or(0));
    const double step = options.block.x() + options.gap;
    const double shorter = std::min(options.bond, 1 - options.bond) * step - options.gap;
    if (options.rows > 1 && options.bond > 0 && shorter < 0.5 * mesh_size)
        table.error("out-of-range", "bond",
                    "leaves blocks of " + readable(shorter, "m") + " at the ends of every second row",
                    "at least half of mesh_size: another bond, a smaller gap, or bond = 0");
    if (static_cast<double>(options.columns) * options.rows > max_bodies)
        table.error("out-of-range", "rows", formatted("makes more than %d bodies", max_bodies));
    return table.reading().findings.has_errors() ? Outlines{} : wall(options);
}

/// Cells or stones in a box.
Outlines read_box(const Table& table, const std::string& stream, const MeshOptions& mesh) {
    const auto box = table.get<Box>("box");
    const bool stones = table.text("pattern") == "heap";
    InclusionOptions options{.mesh = mesh};
    table.fill(options);
    if (options.size < 1.5 * mesh.size)
        table.error("out-of-range", "size", "is below 1.5 times the mesh size", "larger bodies or a finer mesh");
    const auto amount = stones ? table.one_of({"number", "fraction"}, true) : std::nullopt;
    if (options.corners == 1 || options.corners == 2)
        table.error("out-of-range", "corners", "must be 0 for discs, or at least 3");
    if (!box || !(options.size > 0) || table.reading().findings.has_errors()) return {};
    const Vec2 extent = box->extent();
    if (extent.x() * extent.y() > max_bodies * options.size * options.size) {
        table.error("out-of-range", "size", formatted("makes more than %d bodies in this box", max_bodies));
        return {};
    }
    if (!stones)
        return cells_of_box({.size = options.size, .spread = options.spread}, *box, table.number("gap").value_or(0),
                            0.25 * mesh.size, table.scenario().seed, stream);
    try {
        return heap(options, *box, table.scenario().seed, stream);
    } catch (const ShapeError& error) {
        table.error("geometry", amount.value_or("fraction"), std::string("cannot be met: ") + error.what(),
                    "a larger box, fewer or smaller stones");
    }
    return {};
}

void read_pattern(const Table& table) {
    Scenario& scenario = table.scenario();
    table.compute("name", Node::of_text(table.text("pattern")));
    const std::string name = table.text("name");
    check_is_new(table, name);
    const MeshOptions mesh = compute_matter(table);
    if (mesh.size > 0) table.compute("distance", Node::of_number(0.1 * mesh.size));
    const bool blocks = table.text("pattern") == "wall";
    if (!table.has("pattern") || !(mesh.size > 0)) return;
    const Outlines outlines = blocks ? read_wall(table, mesh.size) : read_box(table, "bodies " + name, mesh);
    if (outlines.empty()) return;
    const Vec2 origin = blocks ? table.get<Vec2>("origin").value_or(Vec2::Zero()) : table.get<Box>("box")->low;
    const BodyGroup group{name, scenario.bodies.size(), outlines.size()};
    for (const std::vector<Vec2>& points : outlines) {
        const std::string own = name + std::to_string(scenario.bodies.size() - group.first + 1);
        Shape& shape = add_body(table, own).shape;
        shape.outer.points = points;
        for (std::size_t side = 0; side < points.size(); ++side)
            shape.outer.boundary.push_back(boundary_index(
                shape, own + (blocks ? std::array{".bottom", ".right", ".top", ".left"}[side] : ".rim")));
        place(table, origin, shape);
    }
    scenario.groups.push_back(group);
}

/// Bodies do not lie in each other.
void check_places(Reading& reading) {
    constexpr int max_reports = 5;
    const std::vector<Body>& bodies = reading.scenario.bodies;
    std::vector<Box> boxes;
    for (const Body& body : bodies) {
        if (body.shape.outer.points.size() < 3) return;  // reported
        boxes.push_back(bounding_box(body.shape.outer.points));
    }
    int n_reports = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t a = 0; a < b && n_reports < max_reports; ++a) {
            if ((boxes[a].low.array() >= boxes[b].high.array()).any() ||
                (boxes[b].low.array() >= boxes[a].high.array()).any())
                continue;
            const double tolerance = allowed_overlap * std::min(bodies[a].mesh.size, bodies[b].mesh.size);
            const auto found = overlap(bodies[a].shape, bodies[b].shape, tolerance);
            if (!found) continue;
            ++n_reports;
            reading.table(bodies[b].path)
                .error("overlap", "",
                       formatted("(body `%s`) lies in body `%s` by %s at %s", bodies[b].name.c_str(),
                                 bodies[a].name.c_str(), readable(found->depth, "m").c_str(),
                                 place_text(found->place).c_str()),
                       "move one of them; bodies may touch, to a thousandth of the mesh size");
        }
}

void read_bodies(Reading& reading) {
    exclude_shape_of_domain(reading, "[[body]]", "every body has a shape of its own; [domain] has what is common");
    for (const Table& table : reading.list("body")) read_one_body(table);
    for (const Table& table : reading.list("bodies")) read_pattern(table);
    check_places(reading);
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
    for (const Table& place : mesh.list("refine")) read_refined_place(place);
    if (!mesh.given("file") && !mesh.given("grains")) mesh.leave_out("grains");
    if (mesh.given("file")) return check_nothing_else(reading), read_mesh_file(reading);
    if (!reading.list("body").empty() || !reading.list("bodies").empty()) return read_bodies(reading);
    check_shape_is_given(domain, mesh);
    Body& body = scenario.bodies.emplace_back(Body{.path = "domain", .mesh = scenario.mesh});
    read_shape(domain, body.mesh, "", body.shape);
}

}  // namespace knap
