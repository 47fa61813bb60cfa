#include "base/random.hpp"
#include "model/fans.hpp"

#include <cmath>
#include <map>

namespace knap {
namespace {

/// Pieces of the size of this interface in a piece that has the mean strength of the law. The area of an interface is a
/// third of each adjacent triangle.
double n_pieces(const Scatter& scatter, const Model& model, const Interface& interface) {
    if (scatter.length > 0) return scatter.length / interface.length;
    if (scatter.area <= 0) return 1;
    double area = 0;
    for (const Index t : interface.triangle)
        if (t != rigid_support) area += model.mesh.area(t) / 3;
    return scatter.area / area;
}

/// A facet between two layered triangles has the strength of the weaker side.
void weaken_by_bedding(const StrengthOverBedding& over, const Model& model, const Interface& interface,
                       CohesiveLaw& law) {
    const auto [a, b] = interface.vertex;
    const Vec2 along = model.mesh.vertices[b] - model.mesh.vertices[a];
    double strength = infinity, energy = infinity;
    for (const Index t : interface.triangle) {
        if (t == rigid_support) continue;
        const std::optional<Bedding> bedding = model.elastic(t).bedding;
        if (!bedding) continue;
        const double angle = acute_angle(std::atan2(along.y(), along.x()), bedding->angle);
        strength = std::min(strength, over.strength(angle)), energy = std::min(energy, over.energy(angle));
    }
    if (std::isinf(strength)) return;
    law.sigma_c *= strength, law.G_c *= energy, law.G_II *= energy;
}

}  // namespace

void vary_strength(const ModelInput& input, Model& model) {
    const auto n_laws = static_cast<Index>(input.laws.size());
    const auto scatter_of = [&](Index law) { return law < std::ssize(input.scatter) ? input.scatter[law] : Scatter(); };
    std::map<Index, RandomField> fields;  // of the laws with correlation
    for (Index law = 0; law < n_laws; ++law) {
        if (!scatter_of(law).any() || !(scatter_of(law).correlation > 0)) continue;
        Random random(input.seed + static_cast<std::uint64_t>(law) * 0x9E3779B97F4A7C15ull, "strength field");
        fields.emplace(law, RandomField(scatter_of(law).correlation, random));
    }
    Random random(input.seed, "strength");
    for (Interface& interface : model.interfaces) {
        if (interface.cracked) continue;
        const Scatter scatter = scatter_of(interface.law);
        const bool is_bedded =
            interface.law < std::ssize(input.over_bedding) && input.over_bedding[interface.law].any();
        if (!scatter.any() && !is_bedded) continue;
        CohesiveLaw law = model.laws[interface.law];
        if (is_bedded) weaken_by_bedding(input.over_bedding[interface.law], model, interface, law);
        if (scatter.any()) {
            const auto [a, b] = interface.vertex;
            const auto field = fields.find(interface.law);
            const double hazard =
                field != fields.end()
                    ? normal_hazard(field->second(0.5 * (model.mesh.vertices[a] + model.mesh.vertices[b])))
                    : -std::log(1 - random.uniform()) * n_pieces(scatter, model, interface);
            const double factor = strength_factor(scatter, hazard);
            if (scatter.of_strength) law.sigma_c *= factor;
            if (scatter.of_energy) law.G_c *= factor, law.G_II *= factor;
        }
        interface.law = static_cast<Index>(model.laws.size());
        model.laws.push_back(law);
    }
}

}  // namespace knap
