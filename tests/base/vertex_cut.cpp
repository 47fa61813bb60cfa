// The fewest vertices that separate two sides of a graph.
#include "base/vertex_cut.hpp"

#include "base/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>

namespace vertex_cut_test {

using namespace knap;

namespace {

/// No way leads from the source to the sink past the vertices of `cut`, one bit each.
bool separates(const CutGraph& graph, unsigned cut) {
    const int n = static_cast<int>(graph.at_source.size());
    unsigned reached = 0;
    for (int v = 0; v < n; ++v) reached |= (graph.at_source[v] && !(cut >> v & 1) ? 1u : 0u) << v;
    for (int sweep = 0; sweep < n; ++sweep)
        for (const auto& [a, b] : graph.edges) {
            if ((reached >> a & 1) && !(cut >> b & 1)) reached |= 1u << b;
            if ((reached >> b & 1) && !(cut >> a & 1)) reached |= 1u << a;
        }
    for (int v = 0; v < n; ++v)
        if (graph.at_sink[v] && (reached >> v & 1)) return false;
    return true;
}

}  // namespace

TEST_CASE("a vertex cut separates its sides and is as small as the smallest of all sets that do") {
    Random random(1, "vertex_cut");
    int largest = 0;
    for (int trial = 0; trial < 200; ++trial) {
        constexpr int n = 10;
        CutGraph graph{.edges = {}, .at_source = std::vector<std::uint8_t>(n), .at_sink = std::vector<std::uint8_t>(n)};
        for (int a = 0; a < n; ++a)
            for (int b = a + 1; b < n; ++b)
                if (random.bits() % 10 < 4) graph.edges.emplace_back(a, b);
        for (int v = 0; v < n; ++v) graph.at_source[v] = v < 4, graph.at_sink[v] = v >= 7 || random.bits() % 16 == 0;

        const std::vector<CutSide> side = smallest_vertex_cut(graph);
        unsigned cut = 0;
        for (int v = 0; v < n; ++v) cut |= (side[v] == CutSide::cut ? 1u : 0u) << v;
        int fewest = n;
        for (unsigned other = 0; other < 1u << n; ++other)
            if (separates(graph, other)) fewest = std::min(fewest, std::popcount(other));
        CHECK(separates(graph, cut));
        CHECK(std::popcount(cut) == fewest);
        for (const auto& [a, b] : graph.edges) {
            const bool across = (side[a] == CutSide::source && side[b] == CutSide::sink) ||
                                (side[a] == CutSide::sink && side[b] == CutSide::source);
            CHECK(!across);
        }
        largest = std::max(largest, fewest);
    }
    CHECK(largest == 4);
}

}  // namespace vertex_cut_test
