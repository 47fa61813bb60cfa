#pragma once
// Draws crack graphs by hand.
#include "analysis/crack_history.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace crack_drawing {

using knap::CrackOptions;
using knap::Index;
using knap::InterfaceGraph;
using knap::InterfaceStatus;
using knap::Vec2;

/// Edges between grid points (i, j) at (i, j) mm; equal points are one vertex.
struct Drawing {
    InterfaceGraph graph;
    std::vector<InterfaceStatus> status;
    std::map<std::pair<int, int>, Index> vertex_at;

    Index vertex(int i, int j) {
        const auto [it, is_new] = vertex_at.try_emplace({i, j}, static_cast<Index>(graph.vertices.size()));
        if (is_new) {
            graph.vertices.push_back(1e-3 * Vec2(i, j));
            graph.on_boundary.push_back(0);
        }
        return it->second;
    }
    void boundary(int i, int j) { graph.on_boundary[vertex(i, j)] = 1; }

    void edge(int i0, int j0, int i1, int j1, InterfaceStatus s) {
        const Index a = vertex(i0, j0), b = vertex(i1, j1);
        graph.ends.push_back({a, b});
        graph.length.push_back((graph.vertices[b] - graph.vertices[a]).norm());
        status.push_back(s);
    }
    /// A straight row of n edges from (i, j), each by (di, dj).
    void row(int i, int j, int di, int dj, int n, InterfaceStatus s = InterfaceStatus::broken) {
        for (int k = 0; k < n; ++k) edge(i + k * di, j + k * dj, i + (k + 1) * di, j + (k + 1) * dj, s);
    }
    /// A pre-crack from the boundary at (-n, 0) to (0, 0).
    void notch(int n = 5) {
        boundary(-n, 0);
        row(-n, 0, 1, 0, n, InterfaceStatus::precrack);
    }
};

/// Ways of less than four edges are twigs.
inline CrackOptions options() { return {.arm_edges = 4, .short_arm_edges = 4, .speed_edges = 10}; }

inline constexpr double mm = 1e-3;

}  // namespace crack_drawing
