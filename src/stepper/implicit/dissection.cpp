#include "stepper/implicit/dissection.hpp"

#include "base/vertex_cut.hpp"

#include <algorithm>
#include <numeric>

namespace knap {
namespace {

constexpr Index max_in_a_leaf = 24;  // triangles
// The border of two halves may run through the triangles next to the middle, this part of all on each side. Entries and
// operations of the factor of edge_cracked_block_implicit: 3.29e6 and 5.7e8 for 0, 2.28e6 and 2.5e8 for 0.05, 2.20e6
// and 2.4e8 for 0.1, 2.19e6 and 2.4e8 for 0.2.
constexpr double band = 0.1;

class Dissector {
public:
    explicit Dissector(const Model& model)
        : model_(model), local_(model.fans.size(), -1), seen_before_(model.fans.size(), 0) {
        const Mesh& mesh = model.mesh;
        made_.triangles.resize(mesh.n_triangles());
        made_.leaf_of_triangle.resize(mesh.n_triangles());
        std::iota(made_.triangles.begin(), made_.triangles.end(), 0);
        for (const Index t : made_.triangles)
            middle_.push_back(mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2));
    }

    Dissection dissect() {
        dissect_part(0, model_.mesh.n_triangles());
        return std::move(made_);
    }

private:
    struct Halves {
        std::vector<Index> triangles;  // of the first half, then those of the second
        Index n_first = 0, n_cut = 0;  // triangles of the first half; vertices in both
    };

    Index dissect_part(Index first, Index n) {  // the number of the part
        Dissection::Part part{.first_triangle = first, .n_triangles = n};
        if (n > max_in_a_leaf) {
            Halves halves = halve(first, n, 0);
            if (Halves across = halve(first, n, 1); across.n_cut < halves.n_cut) halves = std::move(across);
            std::ranges::copy(halves.triangles, made_.triangles.begin() + first);
            part.child[0] = dissect_part(first, halves.n_first);
            part.child[1] = dissect_part(first + halves.n_first, n - halves.n_first);
        }
        const Index number = static_cast<Index>(made_.parts.size());
        made_.parts.push_back(part);
        if (part.is_leaf())
            for (const Index t : made_.triangles_of(part)) made_.leaf_of_triangle[t] = number;
        else
            for (const Index child : part.child) made_.parts[child].parent = number;
        return number;
    }

    /// The triangles in the order of their middles along an axis, cut at the fewest vertices of the band.
    Halves halve(Index first, Index n, int axis) {
        std::vector<Index> ordered(made_.triangles.begin() + first, made_.triangles.begin() + first + n);
        std::ranges::sort(
            ordered, [&](Index a, Index b) { return std::pair(middle_[a][axis], a) < std::pair(middle_[b][axis], b); });
        const Index begin = n / 2 - static_cast<Index>(band * n), end = n / 2 + static_cast<Index>(band * n);
        const std::span all(ordered), before = all.first(begin), within = all.subspan(begin, end - begin),
                                      behind = all.subspan(end);
        Halves halves;
        const std::vector<CutSide> side = cut_band(before, within, behind, halves.n_cut);
        std::vector<Index>&one = halves.triangles, other(behind.begin(), behind.end()), either;
        one.assign(before.begin(), before.end());
        for (const Index t : within) {
            bool source = false, sink = false;
            for_each_fan(t, [&](Index fan) {
                source |= side[local_[fan]] == CutSide::source, sink |= side[local_[fan]] == CutSide::sink;
            });
            (source ? one : sink ? other : either).push_back(t);
        }
        for (const Index t : either) (one.size() < other.size() ? one : other).push_back(t);
        for (const Index fan : fans_) local_[fan] = -1;
        halves.n_first = static_cast<Index>(one.size());
        one.insert(one.end(), other.begin(), other.end());
        return halves;
    }

    /// Sides of the vertices within the band; counts all that are cut.
    std::vector<CutSide> cut_band(std::span<const Index> before, std::span<const Index> within,
                                  std::span<const Index> behind, Index& n_cut) {
        CutGraph graph;
        fans_.clear();
        for (const Index t : within) {
            int vertex[3], *next = vertex;
            for_each_fan(t, [&](Index fan) {
                if (local_[fan] < 0) local_[fan] = static_cast<int>(fans_.size()), fans_.push_back(fan);
                *next++ = local_[fan];
            });
            for (int k = 0; k < 3; ++k) graph.edges.push_back(std::minmax({vertex[k], vertex[(k + 1) % 3]}));
        }
        std::ranges::sort(graph.edges);
        graph.edges.erase(std::unique(graph.edges.begin(), graph.edges.end()), graph.edges.end());
        graph.at_source.assign(fans_.size(), 0), graph.at_sink.assign(fans_.size(), 0);
        const auto visit = [&](std::span<const Index> triangles, const auto& inside, const auto& outside) {
            for (const Index t : triangles)
                for_each_fan(t,
                             [&](Index fan) { local_[fan] >= 0 ? inside(local_[fan]) : outside(seen_before_[fan]); });
        };
        visit(
            before, [&](int v) { graph.at_source[v] = 1; }, [](std::uint8_t& seen) { seen = 1; });
        visit(
            behind, [&](int v) { graph.at_sink[v] = 1; },
            [&](std::uint8_t& seen) { n_cut += seen, seen = 0; });  // on both sides of an empty band
        visit(
            before, [](int) {}, [](std::uint8_t& seen) { seen = 0; });
        std::vector<CutSide> side = smallest_vertex_cut(graph);
        n_cut += static_cast<Index>(std::ranges::count(side, CutSide::cut));
        return side;
    }

    template <class Visit>
    void for_each_fan(Index triangle, const Visit& visit) const {
        for (int k = 0; k < 3; ++k) visit(model_.fan_of_corner[model_.mesh.corners_per_triangle() * triangle + k]);
    }

    const Model& model_;
    Dissection made_;
    std::vector<Vec2> middle_;               // [m] per triangle, three times its centroid
    std::vector<int> local_;                 // per fan: its number in the band, or -1
    std::vector<Index> fans_;                // of the band
    std::vector<std::uint8_t> seen_before_;  // [0/1] per fan outside the band: in a triangle before it
};

}  // namespace

Dissection dissect(const Model& model) { return Dissector(model).dissect(); }

}  // namespace knap
