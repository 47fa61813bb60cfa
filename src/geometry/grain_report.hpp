#pragma once
// What the grains of a mesh are like: number, diameters, shape.
#include "geometry/mesh.hpp"

namespace knap {

struct GrainReport {
    Index n_grains = 0;
    Index n_whole = 0;         // that no boundary cuts; the rest is about them
    double mean_diameter = 0;  // [m] of the circle of equal area
    double spread = 0;         // [-] standard deviation of the diameters over their mean
    double elongation = 1;     // [-] length over width of the mean grain: root of the ratio of its mean second moments
    double direction = 0;      // [rad] of its length, -pi/2 to pi/2
    double border_length = 0;  // [m] between different grains
    Index least_triangles = 0;  // in a whole grain
};

GrainReport judge_grains(const Mesh& mesh);

/// Area of every grain [m2].
std::vector<double> grain_areas(const Mesh& mesh);

}  // namespace knap
