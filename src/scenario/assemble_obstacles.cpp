// [[obstacle]]: rigid bodies beside the one that is meshed; what each is, how it is driven, and what is free.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenario/assemble.hpp"

namespace knap {
namespace {

constexpr double radians = std::numbers::pi / 180;  // angles are read in degrees

void assemble_outline(const Assembly& assembly, const std::string& path, Obstacle& obstacle) {
    const Values& values = assembly.values;
    const std::string shape = values.text(path + ".shape").value_or("");
    Outline& outline = obstacle.outline;
    if (shape == "half plane") {
        outline.kind = Outline::Kind::half_plane;
        obstacle.start.position = values.pair(path + ".at").value_or(Vec2::Zero());
        const Vec2 normal = values.pair(path + ".normal").value_or(Vec2(0, 1));
        if (normal.isZero(0)) assembly.findings.error("out-of-range", "`" + path + ".normal` has no direction", assembly.at(path + ".normal"));
        else outline.normal = normal.normalized();
    } else if (shape == "disc") {
        outline.kind = Outline::Kind::disc;
        obstacle.start.position = values.pair(path + ".centre").value_or(Vec2::Zero());
        outline.radius = values.number(path + ".radius").value_or(1);
    } else if (shape == "polygon") {
        outline.kind = Outline::Kind::polygon;
        outline.points = values.points(path + ".points");
        if (!values.has(path + ".points")) return;
        if (outline.points.size() < 3 || !is_convex(outline.points)) {
            assembly.findings.error("out-of-range", "`" + path + ".points` is no convex polygon", assembly.at(path + ".points")).note =
                "at least three corners in order; several obstacles make a shape that is not convex";
            outline.points.clear();
            return;
        }
        if (outline.area() < 0) std::reverse(outline.points.begin(), outline.points.end());
        obstacle.start.position = centroid(outline.points);
        for (Vec2& p : outline.points) p -= obstacle.start.position;
    }
}

void assemble_inertia(const Assembly& assembly, const std::string& path, Obstacle& obstacle) {
    const auto which = assembly.the_one(path, {"mass", "density"}, false);
    const double area = obstacle.outline.area(), second_moment = obstacle.outline.second_moment(), thickness = assembly.scenario.thickness;
    if (which == "density" && obstacle.outline.kind == Outline::Kind::half_plane)
        assembly.findings.error("exclusive-keys", "a half plane has no volume, so `" + path + "` has no density", assembly.at(path + ".density")).note = "mass";
    if (which == "density") obstacle.mass = assembly.values.number(path + ".density").value_or(1) * thickness * area;
    if (which == "mass") obstacle.mass = assembly.values.number(path + ".mass").value_or(1);
    obstacle.inertia = area > 0 ? obstacle.mass * second_moment / area : 0;
}

void assemble_drives(const Assembly& assembly, const std::string& path, const TimeFunction& history, Obstacle& obstacle) {
    const Values& values = assembly.values;
    const auto which = assembly.the_one(path, {"velocity", "displacement"}, false);
    const bool has_mass = obstacle.mass > 0, all_free = has_mass && !which;
    for (int k = 0; k < 2; ++k) {
        Drive& drive = obstacle.drive[k];
        if (all_free) drive.kind = Drive::Kind::free;
        if (!which) continue;
        const auto components = values.items(path + "." + *which);
        if (components.size() != 2) continue;
        if (components[k]->is_number()) drive = {which == "velocity" ? Drive::Kind::velocity : Drive::Kind::displacement, components[k]->number, history};
        else drive.kind = Drive::Kind::free;
        if (drive.kind == Drive::Kind::free && !has_mass)
            assembly.findings.error("missing-key", "`" + path + "` is free in " + (k == 0 ? "x" : "y") + ", but has no mass", assembly.at(path + "." + *which)).note =
                "mass or density";
    }
    const bool turns = values.flag(path + ".turns").value_or(all_free && obstacle.inertia > 0), spins = values.given(path + ".spin");
    if (turns && spins)
        assembly.findings.error("exclusive-keys", "`" + path + "` cannot turn freely and have its spin prescribed", assembly.at(path + ".spin"));
    if (turns && !(obstacle.inertia > 0))
        assembly.findings.error("missing-key", "`" + path + "` is free to turn, but has no moment of inertia", assembly.at(path + ".turns")).note =
            "a disc or polygon with mass or density";
    if (turns) obstacle.drive[2].kind = Drive::Kind::free;
    if (spins) obstacle.drive[2] = {Drive::Kind::velocity, values.number(path + ".spin").value_or(0) * radians, history};
}

void assemble_free_motion(const Assembly& assembly, const std::string& path, const TimeFunction& history, Obstacle& obstacle) {
    const Values& values = assembly.values;
    const auto needs_freedom = [&](const char* key, bool free) {
        if (values.given(path + "." + key) && !free)
            assembly.findings.error_at_name("exclusive-keys", "`" + path + "." + key + "` belongs to what moves freely", assembly.at(path + "." + key)).note =
                "give it mass or density, and leave components free";
    };
    const bool moves = obstacle.is_free(0) || obstacle.is_free(1);
    needs_freedom("force", moves);
    needs_freedom("initial_velocity", moves);
    needs_freedom("initial_spin", obstacle.is_free(2));
    if (const auto force = values.pair(path + ".force")) obstacle.forces.push_back({.value = Vec3(force->x(), force->y(), 0), .history = history});
    obstacle.initial_velocity.head<2>() = values.pair(path + ".initial_velocity").value_or(Vec2::Zero());
    obstacle.initial_velocity.z() = values.number(path + ".initial_spin").value_or(0) * radians;
}

}  // namespace

void assemble_obstacles(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("obstacle"); ++i) {
        const std::string path = item("obstacle", i);
        Obstacle obstacle;
        obstacle.name = assembly.values.text(path + ".name").value_or("obstacle" + std::to_string(i + 1));
        obstacle.contact.friction = assembly.values.number(path + ".friction").value_or(0);
        obstacle.contact.restitution = assembly.values.number(path + ".restitution").value_or(0);
        const TimeFunction history = assemble_history(assembly, path);
        assemble_outline(assembly, path, obstacle);
        assemble_inertia(assembly, path, obstacle);
        assemble_drives(assembly, path, history, obstacle);
        assemble_free_motion(assembly, path, history, obstacle);
        if (!assembly.values.given(path + ".name")) assembly.values.compute(path + ".name", Node::of_text(obstacle.name));
        assembly.check_column_name(path + ".name", obstacle.name, "an obstacle");
        assembly.scenario.obstacles.push_back(std::move(obstacle));
    }
}

}  // namespace knap
