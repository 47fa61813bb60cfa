#include "stepper/implicit/dissection.hpp"

#include <algorithm>
#include <numeric>

namespace knap {

Dissection dissect(const Model& model) {
    constexpr Index max_in_a_leaf = 24;
    const Mesh& mesh = model.mesh;
    Dissection made{.triangles = std::vector<Index>(mesh.n_triangles()),
                    .leaf_of_triangle = std::vector<Index>(mesh.n_triangles())};
    std::iota(made.triangles.begin(), made.triangles.end(), 0);
    std::vector<Vec2> middle;  // [m] per triangle, three times its centroid
    for (const Index t : made.triangles) middle.push_back(mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2));

    const auto halve = [&](Index first, Index n, int axis) {
        const auto begin = made.triangles.begin() + first;
        std::nth_element(begin, begin + n / 2, begin + n, [&](Index a, Index b) {
            return std::pair(middle[a][axis], a) < std::pair(middle[b][axis], b);
        });
    };
    Index round = 0;
    std::vector<std::array<Index, 2>> seen_in(model.fans.size(), {-1, -1});  // per fan and half: the last round there
    const auto n_cut_vertices = [&](Index first, Index n, int axis) {        // vertices in both halves
        halve(first, n, axis);
        ++round;
        Index n_cut = 0;
        for (Index i = 0; i < n; ++i)
            for (int k = 0; k < 3; ++k) {
                const Index corner = mesh.corners_per_triangle() * made.triangles[first + i] + k;
                auto& seen = seen_in[model.fan_of_corner[corner]];
                const int half = i < n / 2 ? 0 : 1;
                if (seen[half] != round) n_cut += seen[1 - half] == round;
                seen[half] = round;
            }
        return n_cut;
    };
    const auto cut = [&](const auto& self, Index first, Index n) -> Index {  // the number of the part
        Dissection::Part part{.first_triangle = first, .n_triangles = n};
        if (n > max_in_a_leaf) {
            halve(first, n, n_cut_vertices(first, n, 0) <= n_cut_vertices(first, n, 1) ? 0 : 1);
            part.child[0] = self(self, first, n / 2);
            part.child[1] = self(self, first + n / 2, n - n / 2);
        }
        const Index number = static_cast<Index>(made.parts.size());
        made.parts.push_back(part);
        if (part.is_leaf())
            for (const Index t : made.triangles_of(part)) made.leaf_of_triangle[t] = number;
        else
            for (const Index child : part.child) made.parts[child].parent = number;
        return number;
    };
    cut(cut, 0, mesh.n_triangles());
    return made;
}

}  // namespace knap
