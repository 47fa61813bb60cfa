#include "stepper/implicit/dissection.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr Index max_in_a_leaf = 24;

class Cutter {
public:
    Cutter(const Model& model, Dissection& made) : model_(model), made_(made) {
        const Index n = model.mesh.n_triangles();
        middle_.resize(n);
        made_.triangles.resize(n);
        made_.leaf_of_triangle.assign(n, 0);
        seen_in_.assign(model.fans.size(), {-1, -1});
        for (Index t = 0; t < n; ++t) {
            made_.triangles[t] = t;
            middle_[t] = model.mesh.corner(t, 0) + model.mesh.corner(t, 1) + model.mesh.corner(t, 2);
        }
    }

    Index cut(Index first, Index n) {
        Dissection::Part part{.first_triangle = first, .n_triangles = n};
        if (n > max_in_a_leaf) {
            halve(first, n, n_cut_by_halving(first, n, 0) <= n_cut_by_halving(first, n, 1) ? 0 : 1);
            part.child[0] = cut(first, n / 2);
            part.child[1] = cut(first + n / 2, n - n / 2);
        }
        const Index number = static_cast<Index>(made_.parts.size());
        made_.parts.push_back(part);
        for (const Index child : part.child)
            if (child >= 0) made_.parts[child].parent = number;
        if (part.is_leaf())
            for (const Index t : made_.triangles_of(part)) made_.leaf_of_triangle[t] = number;
        return number;
    }

private:
    void halve(Index first, Index n, int axis) {
        const auto begin = made_.triangles.begin() + first;
        std::nth_element(begin, begin + n / 2, begin + n, [&](Index a, Index b) {
            return middle_[a][axis] != middle_[b][axis] ? middle_[a][axis] < middle_[b][axis] : a < b;
        });
    }

    Index n_cut_by_halving(Index first, Index n, int axis) {
        halve(first, n, axis);
        ++round_;
        Index n_cut = 0;
        for (Index i = 0; i < n; ++i)
            for (int k = 0; k < 3; ++k) {
                auto& seen = seen_in_[model_.fan_of_corner[model_.mesh.corners_per_triangle() * made_.triangles[first + i] + k]];
                const int half = i < n / 2 ? 0 : 1;
                if (seen[half] == round_) continue;
                seen[half] = round_;
                n_cut += seen[1 - half] == round_;
            }
        return n_cut;
    }

    const Model& model_;
    Dissection& made_;
    std::vector<Vec2> middle_;                      // [m] per triangle, thrice
    std::vector<std::array<Index, 2>> seen_in_;     // per fan: the last round in which it was met in either half
    Index round_ = 0;
};

}  // namespace

Dissection dissect(const Model& model) {
    Dissection made;
    Cutter(model, made).cut(0, model.mesh.n_triangles());
    return made;
}

}  // namespace knap
