#include "mesh/mesh_report.hpp"

#include "base/quantile.hpp"
#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

namespace knap {
namespace {

/// The vertices that every vertex shares an edge with.
Grouped<Index> neighbours_of_vertices(const Mesh& mesh) {
    return {mesh.vertices.size(), [&](const auto& visit) {
                const auto edge = [&](Index t, Index k) {
                    const auto [a, b] = mesh.side_vertices(t, k);
                    visit(a, b), visit(b, a);
                };
                for (const InteriorEdge& e : mesh.interior_edges) edge(e.triangle[0], e.side[0]);
                for (const BoundaryEdge& e : mesh.boundary_edges) edge(e.triangle, e.side);
            }};
}

void judge_triangles(const Mesh& mesh, MeshReport& report) {
    std::vector<double> smallest_angles;
    report.smallest_altitude = infinity;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        double smallest = 180, longest_edge = 0;
        for (Index k = 0; k < 3; ++k) {
            const Vec2 to_next = mesh.side_vector(t, k), to_last = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
            const double angle = std::atan2(cross(to_next, to_last), to_next.dot(to_last)) / degree;
            smallest = std::min(smallest, angle);
            report.largest_angle = std::max(report.largest_angle, angle);
            longest_edge = std::max(longest_edge, to_next.norm());
        }
        smallest_angles.push_back(smallest);
        report.mean_smallest_angle += smallest / mesh.n_triangles();
        report.area += mesh.area(t);
        report.smallest_altitude = std::min(report.smallest_altitude, 2 * mesh.area(t) / longest_edge);
    }
    report.smallest_angle = std::ranges::min(smallest_angles);
    for (std::size_t i = 0; i < 3; ++i)
        report.smallest_angle_percentiles[i] = quantile(smallest_angles, std::array{0.01, 0.1, 0.5}[i]);
}

void judge_edges(const Mesh& mesh, const Grouped<Index>& graph, MeshReport& report) {
    double sum = 0;
    Index n_sides = 0;
    report.smallest_edge = infinity;
    for (Index v = 0; v < mesh.n_vertices(); ++v)
        for (const Index w : graph[v]) {
            const double length = (mesh.vertices[w] - mesh.vertices[v]).norm();
            report.smallest_edge = std::min(report.smallest_edge, length);
            report.largest_edge = std::max(report.largest_edge, length);
            sum += length;
            ++n_sides;
        }
    report.mean_edge = sum / n_sides;
}

/// Calls found(vertex, path length) for the vertices within the straight distance `reach` [m] of a source, nearest by
/// path along edges first (Dijkstra). `lengths` is scratch: infinity for every vertex, before and after.
template <class Found>
void visit_shortest_paths(const Mesh& mesh, const Grouped<Index>& graph, Index source, double reach,
                          std::vector<double>& lengths, const Found& found) {
    using Entry = std::pair<double, Index>;
    std::vector<Index> touched{source};
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    lengths[source] = 0;
    queue.emplace(0.0, source);
    while (!queue.empty()) {
        const auto [length, v] = queue.top();
        queue.pop();
        if (length > lengths[v]) continue;
        found(v, length);
        for (const Index w : graph[v]) {
            if ((mesh.vertices[w] - mesh.vertices[source]).squaredNorm() > reach * reach) continue;
            const double through = length + (mesh.vertices[w] - mesh.vertices[v]).norm();
            if (through >= lengths[w]) continue;
            lengths[w] = through;
            touched.push_back(w);
            queue.emplace(through, w);
        }
    }
    for (const Index v : touched) lengths[v] = infinity;
}

struct Source {
    Index vertex;
    double reach;  // [m]
};

/// Random vertices with a free disc of `n_edges` local edge lengths around them, so that every straight line in it lies
/// in the body.
std::vector<Source> sources_within(const Mesh& mesh, const Grouped<Index>& graph, int n_edges,
                                   std::size_t n_requested) {
    Random random(1, "path ratio");
    std::vector<Source> sources;
    for (int attempt = 0; attempt < 200 && sources.size() < n_requested; ++attempt) {
        const Index v = static_cast<Index>(random.bits() % mesh.vertices.size());
        double local_edge = 0;
        for (const Index w : graph[v])
            local_edge += (mesh.vertices[w] - mesh.vertices[v]).norm() / static_cast<double>(graph[v].size());
        const double reach = n_edges * local_edge;
        if (std::ranges::none_of(mesh.boundary_edges, [&](const BoundaryEdge& edge) {
                return (mesh.corner(edge.triangle, edge.side) - mesh.vertices[v]).squaredNorm() < reach * reach;
            }))
            sources.push_back({v, reach});
    }
    return sources;
}

/// Lengths over the reach of their source.
struct PathSum {
    double straight = 0, path = 0;
    int n = 0;

    void add(double straight_length, double path_length) { straight += straight_length, path += path_length, ++n; }
};

void judge_paths(const Mesh& mesh, const Grouped<Index>& graph, MeshReport& report) {
    constexpr std::size_t n_sources = 24;
    std::vector<Source> sources;
    for (const int n_edges : {70, 50, 35, 25, 18, 12}) {
        sources = sources_within(mesh, graph, n_edges, n_sources);
        if (sources.size() >= n_sources / 2) break;
    }
    if (sources.empty()) return;

    std::array<Index, MeshReport::n_directions> n_found{};
    PathSum half, full;
    std::vector<double> lengths(mesh.vertices.size(), infinity);
    for (const auto& [vertex, reach] : sources)
        visit_shortest_paths(
            mesh, graph, vertex, reach, lengths, [&, vertex = vertex, reach = reach](Index v, double length) {
                const Vec2 straight = mesh.vertices[v] - mesh.vertices[vertex];
                const double part = straight.norm() / reach;
                if (part > 0.4 && part < 0.5) half.add(straight.norm() / reach, length / reach);
                if (part < 0.85 || part > 0.95) return;
                full.add(straight.norm() / reach, length / reach);
                report.path_reach += straight.norm();
                const double turn =
                    std::atan2(straight.y(), straight.x()) / std::numbers::pi * MeshReport::n_directions;
                const auto direction = (std::lround(turn) + MeshReport::n_directions) % MeshReport::n_directions;
                report.path_excess[direction] += length / straight.norm() - 1;
                ++n_found[direction];
            });
    double sum_of_squares = 0;
    for (int d = 0; d < MeshReport::n_directions; ++d) {
        report.path_excess[d] /= std::max(n_found[d], Index{1});
        report.mean_path_excess += report.path_excess[d] / MeshReport::n_directions;
        report.n_paths += n_found[d];
    }
    report.path_reach /= std::max(report.n_paths, Index{1});
    if (half.n > 0 && full.n > 0)
        report.far_path_excess =
            (full.path / full.n - half.path / half.n) / (full.straight / full.n - half.straight / half.n) - 1;
    for (const double excess : report.path_excess) sum_of_squares += std::pow(excess - report.mean_path_excess, 2);
    report.path_excess_spread = std::sqrt(sum_of_squares / MeshReport::n_directions);
}

}  // namespace

MeshReport judge(const Mesh& mesh) {
    MeshReport report;
    report.n_triangles = mesh.n_triangles();
    report.n_vertices = mesh.n_vertices();
    report.n_interior_edges = static_cast<Index>(mesh.interior_edges.size());
    report.n_boundary_edges = static_cast<Index>(mesh.boundary_edges.size());
    report.n_cracked_edges = static_cast<Index>(std::ranges::count(mesh.interior_edges, true, &InteriorEdge::cracked));
    if (mesh.triangles.empty()) return report;
    const Grouped<Index> graph = neighbours_of_vertices(mesh);
    judge_triangles(mesh, report);
    judge_edges(mesh, graph, report);
    judge_paths(mesh, graph, report);
    return report;
}

}  // namespace knap
