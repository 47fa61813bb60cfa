#pragma once
// Nested dissection (A. George 1973): the triangles are halved again and again, each time across the axis that cuts
// fewer vertices, along the fewest vertices near the middle (base/vertex_cut.hpp). Unknowns inside a half are
// eliminated there, those of the cut vertices after both halves: little fill-in, and a local change reaches only the
// parts that contain it.
#include "model/model.hpp"

#include <span>
#include <vector>

namespace knap {

struct Dissection {
    struct Part {
        Index first_triangle, n_triangles;  // into `triangles`
        Index parent = -1;                  // -1: the whole body
        Index child[2] = {-1, -1};          // -1: a leaf
        bool is_leaf() const { return child[0] < 0; }
    };
    std::vector<Part> parts;  // children before parents
    std::vector<Index> triangles;
    std::vector<Index> leaf_of_triangle;

    Index smallest_common(Index a, Index b) const {
        while (a != b) (a < b ? a : b) = parts[a < b ? a : b].parent;
        return a;
    }
    std::span<const Index> triangles_of(const Part& part) const {
        return {&triangles[part.first_triangle], static_cast<std::size_t>(part.n_triangles)};
    }
};

Dissection dissect(const Model& model);

}  // namespace knap
