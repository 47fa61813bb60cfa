#pragma once
// The wanted mean edge length at a point: smallest in the refine boxes, growing linearly with the distance from them.
#include "geometry/triangulate.hpp"

#include <algorithm>

namespace knap {

class SizeField {
public:
    SizeField(const MeshOptions& options, double factor) : options_(options), factor_(factor) {}

    /// [m], times the factor given.
    double operator()(const Vec2& p) const {
        double size = options_.size;
        for (const RefineBox& box : options_.refine) {
            const Vec2 outside = (box.low - p).cwiseMax(p - box.high).cwiseMax(Vec2::Zero());
            size = std::min(size, box.size + options_.grading * outside.norm());
        }
        return factor_ * size;
    }

    double smallest() const {
        double size = options_.size;
        for (const RefineBox& box : options_.refine) size = std::min(size, box.size);
        return factor_ * size;
    }

    double largest() const { return factor_ * options_.size; }

    /// Largest change of the size per distance.
    double slope() const { return options_.refine.empty() ? 0 : factor_ * options_.grading; }

private:
    const MeshOptions& options_;
    double factor_;
};

}  // namespace knap
