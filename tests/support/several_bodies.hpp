#pragma once
// Scenes of several bodies that may meet.
#include "support/bodies.hpp"

#include <cmath>

namespace knap::tests {

inline const Elastic rock{.density = 2000, .E = 1e7, .nu = 0.2};

/// Several bodies in one mesh; region: number of the body.
struct Bodies {
    Mesh mesh;
    void add(const Mesh& body, const Vec2& at, double angle = 0) {
        const auto first = static_cast<Index>(mesh.vertices.size());
        const Vec2 e(std::cos(angle), std::sin(angle));
        for (const Vec2& x : body.vertices) mesh.vertices.push_back(at + x.x() * e + x.y() * turned_left(e));
        for (const auto& t : body.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        mesh.region.insert(mesh.region.end(), body.triangles.size(), n_bodies_++);
    }
    /// Unbreakable, with one law of contact.
    ModelInput input(const ContactLaw& contact) {
        ModelInput input;
        find_edges(mesh);
        mesh.boundary_names = {"free"};
        input.mesh = mesh;
        input.materials.assign(n_bodies_, rock);
        input.laws = {{.sigma_c = std::numeric_limits<double>::infinity()}};
        input.law_of_pair.assign(n_bodies_, std::vector<Index>(n_bodies_, 0));
        input.contact_of_pair.assign(n_bodies_, std::vector<ContactLaw>(n_bodies_, contact));
        input.large_rotation = true;
        return input;
    }
    Index n_bodies_ = 0;
};

}  // namespace knap::tests
