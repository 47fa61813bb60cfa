#include "model/random_strength.hpp"

#include "base/random.hpp"

#include <cmath>
#include <map>

namespace knap {
namespace {

/// [m2] the part of the body that an interface stands for: a third of each triangle beside it.
double area_of(const Model& model, const Interface& interface) {
    double area = 0;
    for (const Index t : interface.triangle)
        if (t != rigid_support) area += model.mesh.area(t) / 3;
    return area;
}

/// How many of it make the piece that the law's mean strength belongs to.
double pieces(const Scatter& scatter, const Model& model, const Interface& interface) {
    if (scatter.length > 0) return scatter.length / interface.length;
    if (scatter.area > 0) return scatter.area / area_of(model, interface);
    return 1;
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
        if (interface.law >= static_cast<Index>(input.scatter.size()) || !input.scatter[interface.law].any() || interface.cracked) continue;
        const Scatter& scatter = input.scatter[interface.law];
        const auto field = fields.find(interface.law);
        double hazard;
        if (field != fields.end()) {
            const Vec2 middle = 0.5 * (model.mesh.vertices[interface.vertex[0]] + model.mesh.vertices[interface.vertex[1]]);
            hazard = normal_hazard(field->second(middle));
        } else {
            hazard = -std::log(1 - random.uniform()) * pieces(scatter, model, interface);
        }
        const double factor = strength_factor(scatter, hazard);
        CohesiveLaw law = model.laws[interface.law];
        if (scatter.of_strength) law.sigma_c *= factor;
        if (scatter.of_energy) law.G_c *= factor;
        interface.law = static_cast<Index>(model.laws.size());
        model.laws.push_back(law);
    }
}

}  // namespace knap
