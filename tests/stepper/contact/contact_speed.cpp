// What detection costs beside the forces of the bulk, in one run on one thread.
#include "base/random.hpp"
#include "base/stopwatch.hpp"
#include "element/elastic_forces.hpp"
#include "support/bodies.hpp"
#include "support/pieces.hpp"

#include <doctest/doctest.h>

#include <numbers>

namespace contact_speed_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double h = 1e-3;

struct Cost {
    double bulk, detection;  // [ns] per triangle and step
    double per_edge, per_contact;
};

/// Moves all nodes with their velocities for some steps.
Cost measure(Pieces& scene, int n_steps) {
    const Model& model = scene.model;
    const Index n = model.mesh.n_triangles();
    const ElasticForces bulk(model.mesh, model.materials, model.plane, model.thickness);
    std::vector<Vec2> force(3 * n);
    std::vector<std::uint8_t> candidate(model.fans.size());
    FaceContacts contacts(model);
    contacts.find(scene.state, h);
    double bulk_time = 0, time = 0;
    std::size_t n_contacts = 0;
    for (int i = 0; i < n_steps; ++i) {
        Stopwatch watch;
        bulk.evaluate(0, n, scene.state.displacement, scene.state.node_of_corner, force.data(), candidate);
        bulk_time += watch.cpu();
        watch = {};
        contacts.find(scene.state, h);
        time += watch.cpu();
        n_contacts += contacts.all().size();
        for (std::size_t k = 0; k < scene.state.displacement.size(); ++k)
            scene.state.displacement[k] += h * scene.state.velocity[k];
    }
    const double ns = 1e9 / n_steps;
    const std::size_t n_edges = contacts.boundary().edges().size();
    std::printf(
        "  %7d triangles, %7zu edges, %6.0f contacts: bulk %5.1f ns a triangle, detection %6.1f ns a triangle, %6.1f "
        "an edge, %6.0f a contact\n",
        n, n_edges, double(n_contacts) / n_steps, ns * bulk_time / n, ns * time / n, ns * time / n_edges,
        n_contacts == 0 ? 0 : 1e9 * time / n_contacts);
    return {ns * bulk_time / n, ns * time / n, ns * time / n_edges, n_contacts == 0 ? 0 : 1e9 * time / n_contacts};
}

Mesh square(int n, const Vec2& at) {
    Mesh mesh = bar_mesh(n, n, 1, 1);
    for (Vec2& x : mesh.vertices) x += at;
    return mesh;
}

}  // namespace

TEST_CASE("detection of contacts is cheap beside the bulk" * doctest::test_suite("slow")) {
    Random random(1, "speed");
    std::printf("\n");
    {  // nothing touches
        Pieces scene({square(140, {0, 0})});
        CHECK(measure(scene, 200).detection < 1);
    }
    {  // squares on a lattice with small gaps and slow random motion
        std::vector<Mesh> bodies;
        for (int i = 0; i < 20; ++i)
            for (int j = 0; j < 20; ++j) bodies.push_back(square(4, {1.0001 * i + 0.3 * (j % 2), 1.0001 * j}));
        Pieces scene(bodies);
        for (Index b = 0; b < 400; ++b)
            scene.put(b, {0, 0}, 0, {0, 0}, {random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3)});
        const Cost cost = measure(scene, 200);
        CHECK(cost.per_contact < 500);
    }
    for (const double speed : {0.0, 0.1, 1.0}) {  // single triangles that fly
        Mesh mesh = bar_mesh(140, 140, 140, 140);
        Pieces scene({mesh});
        for (Index f = 0; f < Index(scene.model.fans.size()); ++f) split(scene.model, f, scene.state);
        std::ranges::fill(scene.state.retired, Retirement::retired);
        for (Index t = 0; t < scene.model.mesh.n_triangles(); ++t) {
            const Vec2 shift = 0.5 * scene.model.mesh.centroid(t),
                       velocity(speed * random.uniform(-1, 1), speed * random.uniform(-1, 1));
            for (Index c = 3 * t; c < 3 * t + 3; ++c)
                scene.displacement(c) = shift, scene.state.velocity[scene.state.node_of_corner[c]] = velocity;
        }
        CHECK(measure(scene, 100).per_edge < 200);
    }
}

}  // namespace contact_speed_test
