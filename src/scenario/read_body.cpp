// [domain], [[body]] and [mesh]: the bodies of a scene, their places and sizes.
#include "base/formatted.hpp"
#include "base/random.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <numbers>

namespace knap {
namespace {

/// Bodies may lie in each other by this part of the mesh size, as bodies in contact may (stepper/contact).
constexpr double allowed_overlap = 1e-3;

void check_shape_is_given(const Table& domain, const Table& mesh) {
    if (!domain.given("shape") && (!domain.given() || domain.has("")))
        domain.error("missing-key", domain.given() ? "shape" : "", "is missing",
                     "shape: rectangle, polygon, disc; several bodies, [[body]]; or a mesh of your own, mesh.file");
    for (const char* key : {"unit", "cracks"})
        if (mesh.given(key))
            mesh.error("exclusive-keys", key, "belongs to mesh.file", "a shape has [[domain.crack]], and units itself");
}

/// Keys of a shape have no meaning in [domain] when something else defines the bodies; nor have their defaults.
void exclude_shape_of_domain(Reading& reading, const std::string& other, const std::string& note) {
    const Table domain = reading.table("domain");
    for (const Key* key : keys_below("domain")) {
        if (std::ranges::count(keys_below("body[]"), key->name(), &Key::name) == 0) continue;  // no key of a shape
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
    for (const Table& table : reading.list("body"))
        table.error("exclusive-keys", "", "has no meaning with mesh.file",
                    "a file may have several bodies: parts that share no nodes");
}

// ---- [[body]]

/// Adds a body without a shape. Its mesh depends on the seed and its name only, not on the other bodies.
Body& add_body(const Table& table, const std::string& name) {
    Scenario& scenario = table.scenario();
    const std::vector<std::string> used = scenario.body_names();
    if (std::ranges::find(used, name) != used.end())
        table.error("duplicate-name", "name", ": `" + name + "` is the name of another body");
    if (scenario.mesh.size > 0) table.compute("mesh_size", Node::of_number(scenario.mesh.size));
    if (!scenario.materials.empty()) table.compute("material", Node::of_text(scenario.materials.front().name));
    Body& body = scenario.bodies.emplace_back(Body{.name = name, .path = table.path(), .mesh = scenario.mesh});
    body.shape.tag = table.material("material").value_or(0);
    body.mesh.size = table.number("mesh_size").value_or(0);
    body.mesh.seed = Random(scenario.seed, "body " + name).bits();
    body.own_mesh_size = table.given("mesh_size");
    InitialVelocity initial{.on = {.body = name}, .value = Vec2::Zero()};
    table.fill(initial);
    if (table.given("velocity") || table.given("spin")) scenario.initial_velocities.push_back(initial);
    return body;
}

void read_one_body(const Table& table) {
    table.compute("name", Node::of_text("body" + std::to_string(table.scenario().bodies.size() + 1)));
    const std::string name = table.text("name");
    Body& body = add_body(table, name);
    Shape& shape = body.shape;
    read_shape(table, body.mesh, name + ".", shape);
    const double degrees = table.number("angle").value_or(0);
    if (degrees == 0 || shape.outer.points.empty()) return;
    const bool round = table.text("shape") == "disc";
    turn(shape, round ? table.get<Vec2>("centre").value_or(Vec2::Zero()) : Vec2(shape.outer.points.front()),
         degrees * std::numbers::pi / 180);
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
                       formatted("(body `%s`) lies in body `%s` by %.3g m at (%.6g, %.6g) m", bodies[b].name.c_str(),
                                 bodies[a].name.c_str(), found->depth, found->place.x(), found->place.y()),
                       "move one of them; bodies may touch, to a thousandth of the mesh size");
        }
}

void read_bodies(Reading& reading) {
    exclude_shape_of_domain(reading, "[[body]]", "every body has a shape of its own; [domain] has what is common");
    for (const Table& table : reading.list("body")) read_one_body(table);
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
    for (const Table& refine : mesh.list("refine"))
        if (const auto box = refine.get<Box>("inside"); box && refine.has("size"))
            scenario.mesh.refine.push_back({box->low, box->high, *refine.number("size")});
    if (mesh.given("file")) return check_nothing_else(reading), read_mesh_file(reading);
    if (!reading.list("body").empty()) return read_bodies(reading);
    check_shape_is_given(domain, mesh);
    Body& body = scenario.bodies.emplace_back(Body{.path = "domain", .mesh = scenario.mesh});
    read_shape(domain, body.mesh, "", body.shape);
}

}  // namespace knap
