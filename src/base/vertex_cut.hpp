#pragma once
// The fewest vertices of a graph whose removal separates two of its sides (K. Menger 1927), by as many paths without
// common vertices from one side to the other: E. Dinic, Soviet Math. Dokl. 11, 1970.
#include <cstdint>
#include <utility>
#include <vector>

namespace knap {

struct CutGraph {
    std::vector<std::pair<int, int>> edges;        // pairs of vertices, each once
    std::vector<std::uint8_t> at_source, at_sink;  // [0/1] per vertex: it lies at this side, or at both, and may be cut
};

enum class CutSide : std::uint8_t { source, cut, sink };

/// Per vertex; among the smallest cuts the one next to the source.
std::vector<CutSide> smallest_vertex_cut(const CutGraph& graph);

}  // namespace knap
