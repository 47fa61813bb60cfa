#pragma once
// Scenes of separate bodies whose places and velocities are set by hand.
#include "model/make_model.hpp"
#include "model/state.hpp"
#include "stepper/contact/face_contacts.hpp"
#include "stepper/contact/retirement.hpp"
#include "support/meshes.hpp"

#include <cmath>

namespace knap::tests {

/// A regular or irregular star-shaped polygon as a fan of triangles round its centre.
inline Mesh star_mesh(const std::vector<Vec2>& outline) {
    Mesh mesh;
    mesh.vertices = outline;
    Vec2 centre = Vec2::Zero();
    for (const Vec2& x : outline) centre += x / double(outline.size());
    mesh.vertices.push_back(centre);
    const Index n = static_cast<Index>(outline.size());
    for (Index i = 0; i < n; ++i) mesh.triangles.push_back({i, (i + 1) % n, n});
    mesh.region.assign(n, 0);
    return mesh;
}

/// Body b consists of the triangles of the b-th mesh.
class Pieces {
public:
    explicit Pieces(const std::vector<Mesh>& bodies)
        : model(make_model(input_of(bodies))), state(initial_state(model)) {
        for (std::size_t b = 0; b < bodies.size(); ++b)
            body.insert(body.end(), bodies[b].triangles.size(), static_cast<Index>(b));
        state.retired.assign(model.n_points(), Retirement::none);
    }

    /// Two steps: what only turns follows the other end of its edge.
    void retire() {
        for (int step = 0; step < 2; ++step) retire_points(model, std::vector(state.retired), state);
    }

    static ModelInput input_of(const std::vector<Mesh>& bodies) {
        ModelInput input;
        for (const Mesh& mesh : bodies) {
            const Index first = input.mesh.n_vertices();
            input.mesh.vertices.insert(input.mesh.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
            for (const auto& [a, b, c] : mesh.triangles)
                input.mesh.triangles.push_back({first + a, first + b, first + c});
        }
        return input_of(std::move(input.mesh));
    }
    static ModelInput input_of(Mesh mesh) {
        ModelInput input{.mesh = std::move(mesh)};
        input.mesh.region.assign(input.mesh.n_triangles(), 0);
        input.mesh.boundary_names = {"free"};
        find_edges(input.mesh);
        input.materials = {{.density = 1, .E = 1, .nu = 0}};
        input.laws = {{.sigma_c = 1, .G_c = 1}};
        input.law_of_pair = {{0}};
        input.contact_of_pair = {{ContactLaw{}}};
        return input;
    }

    Vec2& displacement(Index corner) { return state.displacement[state.node_of_corner[corner]]; }
    Vec2 place(Index corner) const { return model.mesh.corner(corner) + state.displacement_of(corner); }
    /// Calls visit(corner) for the corners of body b.
    template <class Visit>
    void for_corners(Index b, const Visit& visit) const {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            if (body[c / 3] == b) visit(c);
    }
    /// The body turned about `centre` (of its reference place) and then shifted, with the velocity of a rigid body.
    void put(Index b, const Vec2& shift, double angle = 0, const Vec2& centre = Vec2::Zero(),
             const Vec2& velocity = Vec2::Zero(), double spin = 0) {
        for_corners(b, [&](Index c) {
            const Vec2 arm = turned(model.mesh.corner(c) - centre, angle);
            displacement(c) = centre + arm + shift - model.mesh.corner(c);
            state.velocity[state.node_of_corner[c]] = velocity + spin * turned_left(arm);
        });
    }
    Index body_of(Index corner) const { return body[corner / 3]; }

    std::vector<FaceContact> contacts(double h) const {
        FaceContacts found(model);
        found.find(state, h);
        return {found.all().begin(), found.all().end()};
    }
    /// Makes these the contacts of the step before.
    void remember(const std::vector<FaceContact>& contacts) {
        state.face_contacts.clear();
        for (const FaceContact& contact : contacts)
            state.face_contacts.push_back({contact.vertex[1], contact.edge[0], 1, 0});
    }

    Model model;
    State state;
    std::vector<Index> body;  // per triangle
};

}  // namespace knap::tests
