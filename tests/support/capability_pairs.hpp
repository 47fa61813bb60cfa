#pragma once
// Small scenarios that have two capabilities of the program at once.
#include "scenario/exclusions.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace knap::tests {

struct Capability {
    std::string_view name;   // as in `exclusions` (scenario/exclusions.hpp), where it is in one of them
    std::string_view needs;  // another one, which it implies
};

inline constexpr std::array<Capability, 49> capabilities{{{"rotation = \"large\"", ""},
                                                          {"[contact]", "rotation = \"large\""},
                                                          {"[rigid]", "[contact]"},
                                                          {"bulk = \"implicit\"", ""},
                                                          {"bulk = \"auto\"", ""},
                                                          {"cohesion = \"implicit\"", ""},
                                                          {"mass = \"consistent\"", "bulk = \"implicit\""},
                                                          {"mesh.order = 2", ""},
                                                          {"damping", ""},
                                                          {"mass_scaling", ""},
                                                          {"[[absorb]]", ""},
                                                          {"bulk_viscosity", ""},
                                                          {"[heat]", ""},
                                                          {"heat.conduction", "[heat]"},
                                                          {"strength_table", "[heat]"},
                                                          {"[[pressure]]", ""},
                                                          {"[[pressure]] rate", "[[pressure]]"},
                                                          {"[[excavation]]", ""},
                                                          {"[specimen]", ""},
                                                          {"until = \"rest\"", ""},
                                                          {"start = \"equilibrium\"", ""},
                                                          {"[adapt]", ""},
                                                          {"[[body]]", ""},
                                                          {"mesh.file", ""},
                                                          {"[[support]]", ""},
                                                          {"[[obstacle]]", ""},
                                                          {"free [[obstacle]]", "[[obstacle]]"},
                                                          {"[[collector]]", ""},
                                                          {"R_N", "[[obstacle]]"},
                                                          {"[[grains]]", ""},
                                                          {"joints", ""},
                                                          {"bedding", ""},
                                                          {"bedding.angle by place", "bedding"},
                                                          {"strength_over_bedding", "bedding"},
                                                          {"[[initial]]", ""},
                                                          {"[[initial]] stress", ""},
                                                          {"scatter", ""},
                                                          {"unloading = \"secant\"", ""},
                                                          {"unloading = \"vertical\"", ""},
                                                          {"G_II", ""},
                                                          {"slip_distance", ""},
                                                          {"friction_over_pressure", ""},
                                                          {"coupling = \"norm\"", ""},
                                                          {"softening = \"petersson\"", ""},
                                                          {"plateau = 1", ""},
                                                          {"relaxation_time", ""},
                                                          {"incubation_time", ""},
                                                          {"toughness = \"as measured\"", ""},
                                                          {"strength = \"as measured\"", ""}}};

/// Those of the list that came after its first version, from which pairs are counted since.
inline constexpr std::array<std::string_view, 14> later_capabilities{
    "[rigid]", "mass_scaling",           "[[pressure]] rate",      "[[collector]]",      "R_N",
    "bedding", "bedding.angle by place", "strength_over_bedding",  "[[initial]] stress", "unloading = \"vertical\"",
    "G_II",    "slip_distance",          "friction_over_pressure", "coupling = \"norm\""};

using CapabilityPair = std::pair<std::size_t, std::size_t>;

/// Two values of one key.
inline bool are_alternatives(const CapabilityPair& pair) {
    const auto is = [&](std::string_view a, std::string_view b) {
        return capabilities[pair.first].name == a && capabilities[pair.second].name == b;
    };
    return is("bulk = \"implicit\"", "bulk = \"auto\"") || is("softening = \"petersson\"", "plateau = 1") ||
           is("unloading = \"secant\"", "unloading = \"vertical\"") ||
           is("slip_distance", "friction_over_pressure");  // of friction
}

inline bool is_of_first_list(const CapabilityPair& pair) {
    return std::ranges::none_of(later_capabilities, [&](std::string_view later) {
        return capabilities[pair.first].name == later || capabilities[pair.second].name == later;
    });
}

/// Those of which a scenario may be asked.
inline std::vector<CapabilityPair> capability_pairs() {
    std::vector<CapabilityPair> pairs;
    for (std::size_t i = 0; i < capabilities.size(); ++i)
        for (std::size_t j = i + 1; j < capabilities.size(); ++j)
            if (!are_alternatives({i, j})) pairs.emplace_back(i, j);
    return pairs;
}

/// Whether the program refuses it (scenario/exclusions.hpp).
inline bool is_excluded(const CapabilityPair& pair) {
    const auto is = [](std::size_t i, std::string_view name) {
        const auto& [own, needs] = capabilities[i];
        if (name == "[heat] that changes") name = "[heat]";
        return own == name || needs == name || (own == "[rigid]" && name == "rotation = \"large\"") ||
               own.starts_with(std::string(name) + " =");
    };
    return std::ranges::any_of(exclusions(), [&](const Exclusion& row) {
        return (is(pair.first, row.one) && is(pair.second, row.other)) ||
               (is(pair.first, row.other) && is(pair.second, row.one));
    });
}

inline std::string name_of(const CapabilityPair& pair) {
    return std::string(capabilities[pair.first].name) + " and " + std::string(capabilities[pair.second].name);
}

/// A block of 80 x 80 mm with a crack from the left, pulled at its top; the files that it names are `file_of_pairs`.
inline std::string scene_of(const CapabilityPair& pair) {
    const auto has = [&](std::string_view name) {
        return std::ranges::any_of(std::array{pair.first, pair.second}, [&](std::size_t i) {
            return capabilities[i].name == name || capabilities[i].needs == name ||
                   (capabilities[i].name == "[rigid]" && name == "rotation = \"large\"");
        });
    };
    const bool adapts = has("[adapt]"), bodies = has("[[body]]"), file = has("mesh.file"), tests = has("[specimen]"),
               implicit = has("bulk = \"implicit\""), changes = has("bulk = \"auto\"");
    const std::string prefix = bodies ? "block." : "";
    const std::string width = adapts                  ? "0.0625"
                              : file                  ? "0.29"
                              : has("mesh.order = 2") ? "0.125"
                                                      : "0.25",
                      energy = adapts                  ? "2.34"
                               : file                  ? "10.9"
                               : has("mesh.order = 2") ? "4.7"
                                                       : "9.4";
    std::string text = "knap = 1\n";
    const auto add = [&](bool is_there, std::string_view more) {
        if (is_there) text += more;
    };
    add(has("toughness = \"as measured\""), "toughness = \"as measured\"\n");
    add(has("strength = \"as measured\""),
        "strength = { meaning = \"as measured\", test = \"compression\", size = " + width + " }\n");
    text += "[domain]\n";
    add(has("rotation = \"large\""), "rotation = \"large\"\n");
    const std::string outline = "shape = \"rectangle\"\nsize = [0.08, 0.08]\n",
                      crack = "crack = [{ points = [[0, 0.04], [0.02, 0.04]] }]\n";
    add(!bodies && !file, outline + crack);
    add(bodies, "[[body]]\nname = \"block\"\n" + outline + crack);
    add(bodies, "[[body]]\nname = \"other\"\nshape = \"rectangle\"\nsize = [0.02, 0.02]\norigin = [0.1, 0]\n");
    text += "[mesh]\n";
    add(!file, "size = 0.02\n");
    add(file, "file = \"pairs.msh\"\nunit = \"1 m\"\n");
    add(has("mesh.order = 2"), "order = 2\n");
    add(file && has("joints"), "[[mesh.joint]]\ncurve = \"seam\"\ninterface = \"default\"\n");
    add(adapts, "[adapt]\nsize = 0.005\nevery = 2\nload = 0.02\nmargin = 1\nlimit = 600\n");
    text += "[material.rock]\ndensity = 2500\nE = 30e9\nnu = 0.2\n";
    add(has("bedding"), std::string("bedding = { E = 20e9, nu = 0.15, angle = ") +
                            (has("bedding.angle by place") ? "\"30 + 400*x\"" : "30") + " }\n");
    add(has("bulk_viscosity"), "bulk_viscosity = [0.06, 1.2]\n");
    add(has("[heat]"), "expansion = 1e-5\n");
    add(has("heat.conduction"), "conductivity = 2\nheat_capacity = 800\n");
    text += "[interface.default]\nsigma_c = 3e6\n";
    add(has("friction_over_pressure"), "friction_over_pressure = [[0, 0], [4e6, 1.2e6], [20e6, 3e6]]\n");
    add(!has("friction_over_pressure"), "friction = 0.3\n");
    text += "G_c = ";
    text += has("strength = \"as measured\"") ? energy + "\n" : "30\n";
    add(has("strength_table"), "strength_table = [[0, 1], [100, 0.5]]\n");
    add(has("strength_over_bedding"), "strength_over_bedding = [[0, 0.5], [30, 1]]\n");
    add(has("unloading = \"secant\""), "unloading = \"secant\"\n");
    add(has("unloading = \"vertical\""), "unloading = \"vertical\"\n");
    add(has("G_II"), "G_II = 90\n");
    add(has("slip_distance"), "kinetic_friction = 0.1\nslip_distance = 1e-6\n");
    add(has("coupling = \"norm\""), "coupling = \"norm\"\n");
    add(has("softening = \"petersson\""), "softening = \"petersson\"\n");
    add(has("plateau = 1"), "softening = \"trapezoid\"\nplateau = 1\n");
    add(has("relaxation_time"), "relaxation_time = 1e-6\n");
    add(has("incubation_time"), "incubation_time = 1e-6\n");
    add(has("scatter"), "[interface.default.scatter]\nkind = \"weibull\"\nmodulus = 10\n");
    add(has("scatter") && adapts, "correlation = 0.01\n");
    add(has("[contact]"), "[contact]\n");
    add(has("[rigid]"), "[rigid]\n");
    add(has("[heat]"), "[heat]\ntemperature = \"30*t/1e-4 + 100*x\"\n");
    add(has("heat.conduction"), "conduction = true\n[[heat.exchange]]\non = \"" + prefix + "right\"\nflux = 1e6\n");
    add(has("[[pressure]] rate"), "[[pressure]]\nrate = 1e-3\nstorage = 1e-13\n");
    add(has("[[pressure]]") && !has("[[pressure]] rate"), "[[pressure]]\npressure = 1e5\n");
    add(has("[[excavation]]"), std::string("[[excavation]]\nbox = ") +
                                   (tests ? "[0.03, 0.03, 0.06, 0.06]" : "[0.04, 0, 0.08, 0.02]") +
                                   "\nat = 1e-5\nramp = 1e-5\n");
    add(has("[[grains]]"), "[[grains]]\nsize = 0.04\n");
    add(has("joints") && !file, "[[joints]]\ndirection = 60\nspacing = 0.03\n");
    add(has("joints") && bodies, "body = \"block\"\n");
    add(has("[[initial]]"), "[[initial]]\nvelocity = [0, 0.01]\n");
    add(has("[[initial]] stress"), "[[initial]]\nstress = [\"-1e5*(1 + 10*y)\", \"-2e5*x*y/0.0064\", \"10 kPa\"]\n");
    add(has("[[absorb]]"), "[[absorb]]\non = \"" + prefix + "right\"\n");
    if (has("[[support]]")) text += "[[support]]\non = \"" + prefix + "bottom\"\nglued = true\n";
    else text += "[[load]]\non = \"" + prefix + "bottom\"\ndisplacement = [0, 0]\n";
    text += "[[load]]\nname = \"top\"\n";
    if (has("[rigid]")) text += "acceleration = [0, -9.81]\n";
    else text += "on = \"" + prefix + "top\"\nramp = 1e-5\n";
    if (!has("[rigid]")) text += tests ? "displacement = [\"free\", 1e-6]\n" : "traction = [0, 2e5]\n";
    add(tests, "[specimen]\ntest = \"tension\"\nforce = \"top\"\nheight = 0.08\nwidth = 0.08\n");
    if (has("free [[obstacle]]"))
        text +=
            "[[obstacle]]\nshape = \"disc\"\ncentre = [-0.03, 0.06]\nradius = 0.02\nmass = 1\n"
            "initial_velocity = [1, 0]\n";
    else add(has("[[obstacle]]"), "[[obstacle]]\nshape = \"half plane\"\nat = [-0.01, 0]\nnormal = [1, 0]\n");
    add(has("R_N"), "R_N = 0.3\nR_T = 0.5\nfriction = 0.5\n");
    add(has("[[collector]]"), "[[collector]]\nname = \"line\"\nx = 0.04\n");
    text += "[time]\nend = 1e-4\n";
    add(implicit && !changes, "bulk = \"implicit\"\n");
    add(changes, "bulk = \"auto\"\n");
    add(has("cohesion = \"implicit\""), "cohesion = \"implicit\"\n");
    add(has("mass = \"consistent\""), "mass = \"consistent\"\n");
    add(has("damping"), "damping = 1e3\n");
    add(has("mass_scaling"), "mass_scaling = 0.05\n");
    add(has("until = \"rest\""), "until = \"rest\"\n");
    add(has("start = \"equilibrium\""), "start = \"equilibrium\"\n");
    return text + "[output]\nfields = false\nreport = false\nevery = 2e-5\n";
}

/// A Gmsh file of the same block: 4 x 4 squares of two triangles.
inline std::string file_of_pairs() {
    constexpr int n = 4;
    const auto node = [](int i, int j) { return std::to_string(j * (n + 1) + i + 1); };
    std::string nodes, elements;
    int n_elements = 0;
    const auto add = [&](const std::string& what) { elements += std::to_string(++n_elements) + " " + what + "\n"; };
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            nodes += node(i, j) + " " + std::to_string(0.02 * i) + " " + std::to_string(0.02 * j) + " 0\n";
    for (int i = 0; i < n; ++i) {
        add("1 2 1 1 " + node(i, 0) + " " + node(i + 1, 0));
        add("1 2 2 2 " + node(n, i) + " " + node(n, i + 1));
        add("1 2 3 3 " + node(i, n) + " " + node(i + 1, n));
        add("1 2 5 5 " + node(i, 2) + " " + node(i + 1, 2));
        for (int j = 0; j < n; ++j) {
            add("2 2 4 4 " + node(i, j) + " " + node(i + 1, j) + " " + node(i + 1, j + 1));
            add("2 2 4 4 " + node(i, j) + " " + node(i + 1, j + 1) + " " + node(i, j + 1));
        }
    }
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n"
           "2 4 \"rock\"\n1 5 \"seam\"\n$EndPhysicalNames\n$Nodes\n" +
           std::to_string((n + 1) * (n + 1)) + "\n" + nodes + "$EndNodes\n$Elements\n" + std::to_string(n_elements) +
           "\n" + elements + "$EndElements\n";
}

}  // namespace knap::tests
