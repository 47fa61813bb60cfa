// [[excavation]]: regions that vanish. Their outlines become lines that the mesh follows.
#include "scenario/reading.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

bool meets(const Box& a, const Box& b) {
    return (a.low.array() < b.high.array()).all() && (b.low.array() < a.high.array()).all();
}

/// Sizes for the sides of circles and arcs: those of the mesh.
MeshOptions sizes_of(MeshOptions sizes, const MeshFile* given) {
    if (given == nullptr) return sizes;
    const Mesh& mesh = given->mesh;
    double area = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) area += mesh.area(t);
    sizes.size = std::sqrt(2 * area / mesh.n_triangles());
    return sizes;
}

void read_excavation(const Table& table, const MeshOptions& sizes, TimeOptions& time, std::vector<Body>& bodies,
                     std::vector<Excavation>& excavations) {
    Excavation excavation;
    table.fill(excavation);
    excavation.outline = read_curve(table, sizes);
    if (table.has("at") && excavation.at >= time.end && time.end > 0)
        table.warning("never", "at", "is not before time.end: the region does not vanish in this run");
    time.rest.not_before = std::max(time.rest.not_before, excavation.at + excavation.ramp);
    const std::size_t number = excavations.size();
    for (Body& body : bodies) {
        const std::vector<Vec2>& outer = body.shape.outer.points;
        if (outer.empty() || excavation.outline.empty()) continue;  // reported
        if (!meets(bounding_box(outer), bounding_box(excavation.outline))) continue;
        body.shape.regions.push_back({.points = excavation.outline, .tag = body.shape.tag, .only_line = true});
        body.excavations.push_back(number);
    }
    excavations.push_back(std::move(excavation));
}

}  // namespace

void read_excavations(Reading& reading) {
    const std::vector<Table> tables = reading.list("excavation");
    if (tables.empty()) return;
    const MeshOptions sizes = sizes_of(reading.scenario.mesh, reading.scenario.given.get());
    for (const Table& table : tables)
        read_excavation(table, sizes, reading.scenario.time, reading.scenario.bodies, reading.scenario.excavations);
}

}  // namespace knap
