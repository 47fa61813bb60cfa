// [[grains]]: which material becomes grains, how large, of which minerals.
#include <algorithm>
#include <numbers>

#include "scenario/assemble.hpp"

namespace knap {
namespace {

/// Grains of fewer triangles than these would have no shape.
constexpr double least_size = 1.5;  // [mesh size]

std::vector<Mineral> minerals(const Assembly& assembly, const std::string& grains, Index base) {
    std::vector<Mineral> found;
    double sum = 0;
    for (std::size_t i = 0; i < assembly.values.count(grains + ".mineral"); ++i) {
        const std::string path = item(grains + ".mineral", i);
        const double fraction = assembly.values.number(path + ".fraction").value_or(0);
        sum += fraction;
        const std::optional<Index> material = assembly.material_at(path + ".material");
        if (!material) continue;
        found.push_back({*material, fraction});
        if (*material == base)
            assembly.findings.error("duplicate-name", "`" + path + "` is of the material that the other grains keep", assembly.at(path + ".material")).note =
                "its fraction is what the others leave";
    }
    if (sum > 1 + 1e-9)
        assembly.findings.error("out-of-range", "the fractions of `" + grains + "` sum to more than 1", assembly.at(item(grains + ".mineral", 0) + ".fraction"));
    return found;
}

}  // namespace

void assemble_grains(Assembly& assembly) {
    Scenario& scenario = assembly.scenario;
    const Values& values = assembly.values;
    std::vector<Index> taken;
    for (std::size_t i = 0; i < values.count("grains"); ++i) {
        const std::string path = item("grains", i);
        GrainedRock rock;
        if (!values.given(path + ".in") && !scenario.materials.empty()) assembly.values.compute(path + ".in", Node::of_text(scenario.materials.front().name));
        rock.material = assembly.material_at(path + ".in").value_or(0);
        if (std::find(taken.begin(), taken.end(), rock.material) != taken.end())
            assembly.findings.error("duplicate-name", "`" + path + "` is the second that makes grains of this material", assembly.at(path));
        taken.push_back(rock.material);
        rock.grains.size = values.number(path + ".size").value_or(0);
        rock.grains.spread = values.number(path + ".spread").value_or(rock.grains.spread);
        rock.grains.elongation = values.number(path + ".elongation").value_or(1);
        rock.grains.direction = values.number(path + ".direction").value_or(0) * std::numbers::pi / 180;
        rock.minerals = minerals(assembly, path, rock.material);
        if (values.has(path + ".size") && rock.grains.size < least_size * scenario.mesh.size)
            assembly.findings.error("out-of-range", "`" + path + ".size` is below 1.5 times mesh.size", assembly.at(path + ".size")).note =
                "a grain needs a few triangles: larger grains or a finer mesh";
        scenario.rocks.push_back(std::move(rock));
    }
}

}  // namespace knap
