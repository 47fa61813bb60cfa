#include "stepper/implicit/dissection.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

constexpr Index max_in_a_leaf = 24;

class Cutter {
public:
    Cutter(const Model& model, Dissection& made)
        : model_(model), made_(made), seen_in_(model.fans.size(), std::array<Index, 2>{-1, -1}) {
        made_.triangles.resize(model.mesh.n_triangles());
        made_.leaf_of_triangle.resize(model.mesh.n_triangles());
        std::iota(made_.triangles.begin(), made_.triangles.end(), 0);
        for (const Index t : made_.triangles)
            middle_.push_back(model.mesh.corner(t, 0) + model.mesh.corner(t, 1) + model.mesh.corner(t, 2));
    }

    /// The number of the part that holds n triangles from `first` on.
    Index cut(Index first, Index n) {
        Dissection::Part part{.first_triangle = first, .n_triangles = n};
        if (n > max_in_a_leaf) {
            halve(first, n, n_cut_vertices(first, n, 0) <= n_cut_vertices(first, n, 1) ? 0 : 1);
            part.child[0] = cut(first, n / 2);
            part.child[1] = cut(first + n / 2, n - n / 2);
        }
        const Index number = static_cast<Index>(made_.parts.size());
        made_.parts.push_back(part);
        if (!part.is_leaf())
            for (const Index child : part.child) made_.parts[child].parent = number;
        else
            for (const Index t : made_.triangles_of(part)) made_.leaf_of_triangle[t] = number;
        return number;
    }

private:
    void halve(Index first, Index n, int axis) {
        const auto begin = made_.triangles.begin() + first;
        std::nth_element(begin, begin + n / 2, begin + n, [&](Index a, Index b) {
            return std::pair(middle_[a][axis], a) < std::pair(middle_[b][axis], b);
        });
    }

    /// Vertices that lie in both halves.
    Index n_cut_vertices(Index first, Index n, int axis) {
        halve(first, n, axis);
        ++round_;
        Index n_cut = 0;
        for (Index i = 0; i < n; ++i)
            for (int k = 0; k < 3; ++k) {
                const Index corner = model_.mesh.corners_per_triangle() * made_.triangles[first + i] + k;
                auto& seen = seen_in_[model_.fan_of_corner[corner]];
                const int half = i < n / 2 ? 0 : 1;
                if (seen[half] != round_) n_cut += seen[1 - half] == round_;
                seen[half] = round_;
            }
        return n_cut;
    }

    const Model& model_;
    Dissection& made_;
    std::vector<Vec2> middle_;                   // [m] per triangle, three times its centroid
    std::vector<std::array<Index, 2>> seen_in_;  // per fan and half: the last round in which it was met there
    Index round_ = 0;
};

}  // namespace

Dissection dissect(const Model& model) {
    Dissection made;
    Cutter(model, made).cut(0, model.mesh.n_triangles());
    return made;
}

}  // namespace knap
