#include "model/temperatures.hpp"

namespace knap {

std::shared_ptr<Temperatures> make_temperatures(const Model& model, double time, std::vector<double> of_corner) {
    const Mesh& mesh = model.mesh;
    const Index n = mesh.corners_per_triangle(), n_strains = mesh.order == 1 ? 1 : 3;
    auto made = std::make_shared<Temperatures>();
    made->time = time;
    made->strain.resize(n_strains * mesh.n_triangles());
#pragma omp parallel for schedule(static) if (mesh.n_triangles() > 4096)
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Elastic& elastic = model.materials[mesh.region[t]];
        const Expansion& expansion = model.heat->materials[mesh.region[t]].expansion;
        const double factor = model.plane == PlaneModel::strain ? 1 + elastic.nu : 1,
                     zero = expansion(model.heat->reference);
        if (model.has_vanished(t)) continue;
        std::array<double, 3> e;  // at the vertices
        for (Index k = 0; k < 3; ++k) e[k] = factor * (expansion(of_corner[n * t + k]) - zero);
        if (mesh.order == 1) made->strain[t] = (e[0] + e[1] + e[2]) / 3;
        for (Index k = 0; k < 3 && mesh.order == 2; ++k)
            made->strain[3 * t + k] = 0.5 * (e[(k + 1) % 3] + e[(k + 2) % 3]);
    }
    std::vector<double> energy;  // [Pa] 1/2 A : D A of each material; without layers 2 (lambda + mu)
    for (const Elastic& elastic : model.materials)
        energy.push_back(
            0.5 * elastic.expansion_in_plane(model.plane).cwiseProduct(elastic.stress_of_expansion(model.plane)).sum());
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        double square = 0;
        for (Index k = 0; k < n_strains; ++k)
            square += made->strain[n_strains * t + k] * made->strain[n_strains * t + k];
        made->free_energy += energy[mesh.region[t]] * mesh.area(t) * model.thickness * square / n_strains;
    }
    made->of_corner = std::move(of_corner);
    fit_laws(model, *made);
    return made;
}

double temperature_at(const Temperatures& temperatures, const FanPoint& point) {
    const Index a = point.before, b = point.after;
    const std::vector<double>& T = temperatures.of_corner;
    return point.on_support() ? T[point.corner()] : 0.5 * (T[a] + T[b]);
}

void fit_laws(const Model& model, Temperatures& temperatures) {
    if (!model.laws_follow_temperature) return;
    temperatures.laws.resize(model.n_points());
    const auto n_points = static_cast<Index>(model.fan_points.size());
#pragma omp parallel for schedule(static) if (n_points > 4096)
    for (Index i = 0; i < n_points; ++i) {
        const FanPoint& point = model.fan_points[i];
        temperatures.laws[point.point] = model.laws[point.law].at(temperature_at(temperatures, point));
    }
}

SharedTemperatures field_at(const Model& model, double time) {
    return field_at(model, time, model.heat->field.history(time));
}

SharedTemperatures field_at(const Model& model, double time, double factor) {
    const Heat& heat = *model.heat;
    if (heat.field.is_uniform())
        return make_temperatures(
            model, time,
            std::vector<double>(model.mesh.n_corners(), heat.field_at(model.mesh.corner(0), time, factor)));
    std::vector<double> of_corner(model.mesh.n_corners());
#pragma omp parallel for schedule(static) if (model.mesh.n_corners() > 4096)
    for (Index c = 0; c < model.mesh.n_corners(); ++c) of_corner[c] = heat.field_at(model.mesh.corner(c), time, factor);
    return make_temperatures(model, time, std::move(of_corner));
}

}  // namespace knap
