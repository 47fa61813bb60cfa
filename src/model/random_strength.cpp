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

}  // namespace

void scatter_strength(const ModelInput& input, Model& model) {
    std::map<Index, RandomField> fields;  // of the laws with correlation
    for (Index law = 0; law < static_cast<Index>(input.scatter.size()); ++law) {
        if (!input.scatter[law].any() || !(input.scatter[law].correlation > 0)) continue;
        Random random(input.seed + static_cast<std::uint64_t>(law) * 0x9E3779B97F4A7C15ull, "strength field");
        fields.emplace(law, RandomField(input.scatter[law].correlation, random));
    }
    Random random(input.seed, "strength");
    for (Interface& interface : model.interfaces) {
        if (interface.law >= static_cast<Index>(input.scatter.size()) || interface.cracked) continue;
        const Scatter& scatter = input.scatter[interface.law];
        if (!scatter.any()) continue;
        const auto [a, b] = interface.vertex;
        const auto field = fields.find(interface.law);
        const double hazard =
            field != fields.end()
                ? normal_hazard(field->second(0.5 * (model.mesh.vertices[a] + model.mesh.vertices[b])))
                : -std::log(1 - random.uniform()) * n_pieces(scatter, model, interface);
        const double factor = strength_factor(scatter, hazard);
        CohesiveLaw law = model.laws[interface.law];
        if (scatter.of_strength) law.sigma_c *= factor;
        if (scatter.of_energy) law.G_c *= factor, law.G_II *= factor;
        interface.law = static_cast<Index>(model.laws.size());
        model.laws.push_back(law);
    }
}

}  // namespace knap
