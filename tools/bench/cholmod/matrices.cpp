#include "matrices.hpp"

#include "app/setup/setup.hpp"
#include "scenario/read_scenario.hpp"
#if __has_include("element/triangle_matrices.hpp")
#include "element/triangle_matrices.hpp"
#else
#include "element/triangle_matrices.hpp"
#endif

#include <algorithm>
#include <cmath>

namespace knap {

CrackedBody cracked_body(const std::string& scenario_name, const std::string& mesh_size, int n_split) {
    std::vector<std::string> overrides;
    if (!mesh_size.empty()) overrides.push_back("mesh.size=" + mesh_size);
    const Scenario scenario = open_scenario(scenario_name, overrides).scenario;
    CrackedBody body{scenario_name + (mesh_size.empty() ? "" : " " + mesh_size), build_model(scenario)};
    const Model& model = body.model;
    const std::vector<double> stable = stable_steps(model.mesh, model.materials, model.plane);
    const double h = scenario.time.step.seconds(0.8 * *std::ranges::min_element(stable)),
                 theta = scenario.time.scheme.theta;
    body.stiffness_factor = theta * theta * h * h;
    body.mass = scenario.time.scheme.mass;

    // from the tip of the crack on, or of the glue from its end on: fans next to the line, those that are nearer to its begin first
    bool glued = false;
    Vec2 tip = Vec2::Zero();
    const auto holds = [&](const FanPoint& p) { return !p.cracked && model.laws[p.law].breakable(); };
    for (const FanPoint& p : model.fan_points)
        glued = glued || ((p.before == rigid_support || p.after == rigid_support) && holds(p));
    const auto place = [&](const Fan& fan) -> Vec2 {
        return fan.vertex < 0 ? Vec2::Constant(1e9) : model.mesh.vertices[fan.vertex];
    };
    for (const Fan& fan : model.fans)
        if (fan.split_at_start && !glued && place(fan).x() > tip.x()) tip = place(fan);
    const double band = 1.2 * mean_edge(model.mesh);
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        bool may = false;
        for (Index i = fan.first_point; i < fan.first_point + fan.n_points; ++i) {
            const FanPoint& p = model.fan_points[i];
            const bool on_support = p.before == rigid_support || p.after == rigid_support;
            may = may || (holds(p) && on_support == glued);
        }
        const Vec2 at = place(fan);
        if (may && (glued || (!fan.split_at_start && at.x() > tip.x() && std::abs(at.y() - tip.y()) < band)))
            body.path.push_back(static_cast<Index>(f));
    }
    std::ranges::sort(body.path, [&](Index a, Index b) {
        const double xa = place(model.fans[a]).x(), xb = place(model.fans[b]).x();
        return xa != xb ? (glued ? xa > xb : xa < xb) : a < b;
    });
    body.path.resize(std::min<std::size_t>(body.path.size(), n_split));
    return body;
}

Setting::Setting(const CrackedBody& body, Index n_split, Index n_stronger) {
    const Model& model = body.model;
    std::vector<std::uint8_t> active(model.fans.size(), 0), of_path(model.fans.size(), 0);
    for (std::size_t f = 0; f < model.fans.size(); ++f) active[f] = model.fans[f].split_at_start;
    for (Index i = 0; i < n_split; ++i) active[body.path[i]] = of_path[body.path[i]] = 1;
    partition_corners(model, active, partition);

    for (const std::array<bool, 2>& node : partition.prescribed)
        for (const bool fixed : node) unknown.push_back(fixed ? -1 : n_unknowns++);

    const double stiffness =
        0.3 * body.stiffness_factor * model.materials[0].E * model.thickness;  // of the size of the diagonal of M_hat
    const auto add_points = [&](Index f, bool split) {
        const Fan& fan = model.fans[f];
        for (Index i = fan.first_point; i < fan.first_point + fan.n_points; ++i) {
            const FanPoint& p = model.fan_points[i];
            if (p.cracked || !model.laws[p.law].breakable()) continue;
            const bool on_support = p.before == rigid_support || p.after == rigid_support;
            if (on_support ? split : !split || i % 3 == 0) continue;
            const Index before = p.before == rigid_support ? -1 : partition.node_of_corner[p.before],
                        after = p.after == rigid_support ? -1 : partition.node_of_corner[p.after];
            if (before == after) continue;
            const Eigen::Matrix2d block = stiffness * (n_stronger-- > 0 ? 1.5 : 1) * Eigen::Matrix2d::Identity();
            points.push_back({{i, before, after}, block, block});
        }
    };
    for (Index i = 0; i < static_cast<Index>(body.path.size()); ++i)
        add_points(body.path[i], i < n_split);  // those of the path first, in its order
    for (std::size_t f = 0; f < model.fans.size(); ++f)
        if (std::ranges::find(body.path, static_cast<Index>(f)) == body.path.end())
            add_points(static_cast<Index>(f), false);
}

std::vector<Vec2> Setting::right_hand_side() const {
    std::vector<Vec2> b(partition.n_nodes(), Vec2::Zero());
    for (Index i = 0; i < partition.n_nodes(); ++i)
        for (int k = 0; k < 2; ++k)
            if (!partition.prescribed[i][k]) b[i][k] = 1 + (7 * i + 3 * k) % 11;
    return b;
}

Eigen::VectorXd Setting::as_vector(const std::vector<Vec2>& of_node) const {
    Eigen::VectorXd x(n_unknowns);
    for (std::size_t i = 0; i < unknown.size(); ++i)
        if (unknown[i] >= 0) x[unknown[i]] = of_node[i / 2][i % 2];
    return x;
}

double element_matrices(const CrackedBody& body) {
    const Model& model = body.model;
    double sum = 0;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        sum +=
            stiffness_matrix(model.mesh, t, model.materials[model.mesh.region[t]], model.plane, model.thickness)(0, 0) *
                body.stiffness_factor +
            model.triangle_mass(t);
    return sum;
}

SparseMatrix assembled(const CrackedBody& body, const Setting& setting) {
    const Model& model = body.model;
    std::vector<Eigen::Triplet<double, int>> entries;
    const auto add = [&](Index a, int i, Index b, int j, double value) {
        if (a < 0 || b < 0) return;
        const Index row = setting.unknown[2 * a + i], column = setting.unknown[2 * b + j];
        if (row >= 0 && column >= 0) entries.emplace_back(row, column, value);
    };
    const Index n = model.mesh.corners_per_triangle();
    const ElementMatrix& M = mass_matrix(model.mesh.order, body.mass);
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const ElementMatrix K =
            stiffness_matrix(model.mesh, t, model.materials[model.mesh.region[t]], model.plane, model.thickness);
        const double mass = model.triangle_mass(t);
        const Index* node = &setting.partition.node_of_corner[n * t];
        for (int i = 0; i < 2 * n; ++i)
            for (int j = 0; j < 2 * n; ++j)
                add(node[i / 2], i % 2, node[j / 2], j % 2,
                    body.stiffness_factor * K(i, j) + (i % 2 == j % 2 ? mass * M(i / 2, j / 2) : 0));
    }
    for (const PointTangent& p : setting.points)
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                const auto& [before, after] = std::pair(p.sides.before, p.sides.after);
                add(after, i, after, j, p.block(i, j)), add(before, i, before, j, p.block(i, j));
                add(after, i, before, j, -p.block(i, j)), add(before, i, after, j, -p.block(i, j));
            }
    SparseMatrix A(setting.n_unknowns, setting.n_unknowns);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
}

}  // namespace knap
