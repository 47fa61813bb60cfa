#pragma once
// The triangles round every vertex.
#include "geometry/mesh.hpp"

#include <span>

namespace knap {

class VertexStars {
public:
    /// Only vertices and triangles are used.
    explicit VertexStars(const Mesh& mesh) : begin_(mesh.vertices.size() + 1, 0), triangles_(3 * mesh.triangles.size()) {
        for (const auto& corners : mesh.triangles)
            for (const Index v : corners) ++begin_[v + 1];
        for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
        std::vector<Index> next(begin_.begin(), begin_.end() - 1);
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            for (const Index v : mesh.triangles[t]) triangles_[next[v]++] = t;
    }

    std::span<const Index> operator[](Index vertex) const {
        return {triangles_.data() + begin_[vertex], triangles_.data() + begin_[vertex + 1]};
    }

private:
    std::vector<Index> begin_, triangles_;
};

}  // namespace knap
