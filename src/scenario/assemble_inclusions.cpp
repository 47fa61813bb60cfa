// [[inclusions]] and [[joints]]: what lies in a rock at random. They become regions, holes and cracks of the shape.
#include <algorithm>
#include <numbers>

#include "geometry/inclusions.hpp"
#include "geometry/joints.hpp"
#include "scenario/assemble.hpp"

namespace knap {
namespace {

double radians(double degree) { return degree * std::numbers::pi / 180; }

/// They change a shape; with a mesh file or without a good body there is none.
bool has_body(const Assembly& assembly, const std::string& path) {
    if (assembly.values.given("mesh.file")) {
        assembly.findings.error_at_name("exclusive-keys", "`" + path + "` has no meaning beside mesh.file", assembly.at(path)).note =
            "the file says what the body is; grains and maps go with it";
        return false;
    }
    return assembly.scenario.shape.outer.points.size() >= 3 && assembly.scenario.mesh.size > 0 && !assembly.findings.has_errors();
}

Index boundary_number(Shape& shape, const std::string& name) {
    const auto found = std::find(shape.boundary_names.begin(), shape.boundary_names.end(), name);
    const auto number = static_cast<Index>(found - shape.boundary_names.begin());
    if (found == shape.boundary_names.end()) shape.boundary_names.push_back(name);
    return number;
}

void inclusions(Assembly& assembly, const std::string& path, std::size_t number) {
    Values& values = assembly.values;
    Scenario& scenario = assembly.scenario;
    const double size = scenario.mesh.size;
    InclusionOptions options;
    options.size = values.number(path + ".size").value_or(0);
    options.spread = values.number(path + ".spread").value_or(0);
    const std::optional<std::string> amount = assembly.the_one(path, {"fraction", "number"}, true);
    options.fraction = values.number(path + ".fraction").value_or(0);
    options.number = static_cast<int>(values.number(path + ".number").value_or(0));
    if (!values.given(path + ".distance") && size > 0) values.compute(path + ".distance", Node::of_number(0.5 * size));
    options.distance = values.number(path + ".distance").value_or(0);
    options.corners = static_cast<int>(values.number(path + ".corners").value_or(0));
    options.elongation = values.number(path + ".elongation").value_or(1);
    if (const auto direction = values.number(path + ".direction")) options.direction = radians(*direction);
    options.tag = assembly.material_at(path + ".material");
    options.mesh = scenario.mesh;
    const bool pores = !values.given(path + ".material");
    if (pores && !values.given(path + ".name")) values.compute(path + ".name", Node::of_text("pores"));
    if (const auto name = values.text(path + ".name")) check_name(assembly, path + ".name", *name, "a boundary");
    if (!pores && values.given(path + ".name"))
        assembly.findings.error_at_name("exclusive-keys", "`" + path + ".name` belongs to pores, which have no material", assembly.at(path + ".name"));
    if (values.has(path + ".size") && options.size < 1.5 * size)
        assembly.findings.error("out-of-range", "`" + path + ".size` is below 1.5 times mesh.size", assembly.at(path + ".size")).note =
            "larger inclusions or a finer mesh";
    if (values.has(path + ".distance") && options.distance < 0.2 * size)
        assembly.findings.error("out-of-range", "`" + path + ".distance` is below a fifth of mesh.size", assembly.at(path + ".distance"));
    if (!amount || !has_body(assembly, path)) return;
    if (pores) options.boundary = boundary_number(scenario.shape, values.text(path + ".name").value_or("pores"));
    RandomSet set{.path = path, .part = pores ? RandomSet::Part::holes : RandomSet::Part::regions};
    set.first = pores ? scenario.shape.holes.size() : scenario.shape.regions.size();
    try {
        const PlacedInclusions placed = place_inclusions(scenario.shape, options, scenario.seed, "inclusions " + std::to_string(number));
        set.n = placed.n;
        set.fraction = placed.fraction;
    } catch (const ShapeError& error) {
        assembly.findings.error("geometry", "`" + path + "` " + error.what(), assembly.at(path + "." + *amount)).note =
            "a smaller " + *amount + ", a smaller distance" + (options.number > 0 ? ", or smaller inclusions" : "");
    }
    scenario.random_sets.push_back(set);
}

void joints(Assembly& assembly, const std::string& path, std::size_t number) {
    const Values& values = assembly.values;
    Scenario& scenario = assembly.scenario;
    JointOptions options;
    options.direction = radians(values.number(path + ".direction").value_or(0));
    options.spread = radians(values.number(path + ".spread").value_or(0));
    options.spacing = values.number(path + ".spacing").value_or(0);
    options.persistence = values.number(path + ".persistence").value_or(1);
    options.length = values.number(path + ".length").value_or(0);
    options.thickness = values.number(path + ".thickness").value_or(0);
    options.tag = assembly.material_at(path + ".material");
    options.nearest = 0.2 * scenario.mesh.size;
    if (values.has(path + ".persistence") && (options.persistence < 1) != values.given(path + ".length"))
        assembly.findings.error("missing-key", "`" + path + "`: length belongs to a persistence below 1", assembly.at(path)).note =
            "both, or none of them for joints from end to end";
    if (values.given(path + ".thickness") != values.given(path + ".material"))
        assembly.findings.error("missing-key", "`" + path + "`: thickness and material belong together", assembly.at(path)).note = "they make veins";
    if (values.given(path + ".interface")) assembly.the_one(path, {"interface", "thickness"}, false);
    if (values.has(path + ".spacing") && options.spacing < scenario.mesh.size)
        assembly.findings.error("out-of-range", "`" + path + ".spacing` is below mesh.size", assembly.at(path + ".spacing"));
    if (values.has(path + ".thickness") && options.thickness < 0.5 * scenario.mesh.size)
        assembly.findings.error("out-of-range", "`" + path + ".thickness` is below half of mesh.size", assembly.at(path + ".thickness"));
    if (!has_body(assembly, path)) return;
    if (values.given(path + ".interface")) {
        options.joint = static_cast<Index>(scenario.law_of_joint.size());
        scenario.law_of_joint.push_back(-1);  // found with the laws
    }
    RandomSet set{.path = path, .part = options.tag ? RandomSet::Part::regions : RandomSet::Part::cracks};
    const auto size_of_part = [&] { return options.tag ? scenario.shape.regions.size() : scenario.shape.cracks.size(); };
    set.first = size_of_part();
    int n_left_out = 0;
    try {
        n_left_out = place_joints(scenario.shape, options, scenario.seed, "joints " + std::to_string(number));
    } catch (const ShapeError& error) {
        assembly.findings.error("geometry", "`" + path + "` " + error.what(), assembly.at(path + ".spacing")).note = "a larger spacing or length, or a smaller body";
    }
    set.n = static_cast<int>(size_of_part() - set.first);
    scenario.random_sets.push_back(set);
    if (n_left_out > 0)
        assembly.findings.warning("geometry", std::to_string(n_left_out) + " traces of `" + path + "` found no place beside the other lines", assembly.at(path));
}

}  // namespace

void assemble_inclusions(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("inclusions"); ++i) inclusions(assembly, item("inclusions", i), i);
}

void assemble_joints(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("joints"); ++i) joints(assembly, item("joints", i), i);
}

}  // namespace knap
