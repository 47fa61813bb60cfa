// [[foundation]], [[load]] and [[initial]]: where something acts, what, and when.
#include <algorithm>
#include <array>
#include <utility>

#include "scenario/assemble.hpp"
#include "scenario/factor_table.hpp"

namespace knap {
namespace {

Selection selection(const Assembly& assembly, const std::string& path) {
    Selection on;
    on.boundary = assembly.values.text(path + ".boundary").value_or("");
    on.box = assembly.values.box(path + ".box");
    const auto& known = assembly.scenario.shape.boundary_names;
    const bool known_all = !known.empty() || assembly.scenario.given;  // else the shape is wrong, and that is said elsewhere
    if (!on.boundary.empty() && known_all && std::find(known.begin(), known.end(), on.boundary) == known.end())
        assembly.unknown_name(path + ".boundary", "boundary", on.boundary, known);
    return on;
}

constexpr std::array kinds{std::pair{"traction", Load::Kind::traction},
                           std::pair{"pressure", Load::Kind::stress},
                           std::pair{"stress", Load::Kind::stress},
                           std::pair{"force", Load::Kind::force},
                           std::pair{"velocity", Load::Kind::velocity},
                           std::pair{"displacement", Load::Kind::displacement},
                           std::pair{"body_force", Load::Kind::body_force},
                           std::pair{"acceleration", Load::Kind::acceleration}};

bool fills_volume(Load::Kind kind) { return kind == Load::Kind::body_force || kind == Load::Kind::acceleration; }

void check_where(const Assembly& assembly, const std::string& load, const std::string& name, Load::Kind kind) {
    const Values& values = assembly.values;
    const bool by_name = values.given(load + ".on.boundary"), by_box = values.given(load + ".on.box");
    const Entry* on = values.find(load + ".on");
    if (on && !on->valid) return;
    if (fills_volume(kind) && by_name)
        assembly.findings.error("exclusive-keys", "`" + load + "." + name + "` acts in the body, not on a boundary", assembly.at(load + ".on.boundary")).note =
            "on = { box = [...] }, or no `on` for the whole body";
    if (!fills_volume(kind) && !by_name && !by_box)
        assembly.findings.error("missing-key", "`" + load + ".on` does not say where", assembly.at(on ? load + ".on" : load)).note =
            "on = \"BOUNDARY\", { box = [...] } or both; boundaries: " + joined(assembly.scenario.shape.boundary_names);
}

void assemble_value(const Assembly& assembly, const std::string& path, Load& load) {
    const auto components = assembly.values.items(path);
    if (components.size() != 2) return;
    for (std::size_t i = 0; i < 2; ++i)
        if (components[i]->is_number()) load.value[i] = components[i]->number;
    if (!load.value[0] && !load.value[1]) assembly.findings.error("exclusive-keys", "`" + path + "` prescribes nothing", assembly.at(path));
}

std::array<double, 3> stress_of(const Assembly& assembly, const std::string& load) {
    if (const auto pressure = assembly.values.number(load + ".pressure")) return {-*pressure, -*pressure, 0};
    const auto components = assembly.values.items(load + ".stress");
    if (components.size() != 3) return {};
    return {components[0]->number, components[1]->number, components[2]->number};
}

Node points_of(const TimeFunction& history) {
    Node list{.type = Node::Type::array};
    for (std::size_t i = 0; i < history.time.size(); ++i) {
        Node point{.type = Node::Type::array};
        point.children = {Node::of_number(history.time[i]), Node::of_number(history.value[i])};
        list.children.push_back(std::move(point));
    }
    return list;
}

}  // namespace

TimeFunction assemble_history(Assembly& assembly, const std::string& load) {
    const std::optional<std::string> which = assembly.the_one(load, {"ramp", "table", "csv"}, false);
    TimeFunction history;
    if (which == "ramp") {
        if (const auto end = assembly.values.number(load + ".ramp")) history = {{0, *end}, {0, 1}};
    } else if (which == "table") {
        for (const Vec2& point : assembly.values.points(load + ".table")) {
            history.time.push_back(point.x());
            history.value.push_back(point.y());
        }
        if (!std::is_sorted(history.time.begin(), history.time.end()))
            assembly.findings.error("out-of-range", "the times of `" + load + ".table` do not ascend", assembly.at(load + ".table"));
    } else if (which == "csv") {
        const std::string path = load + ".csv";
        if (const auto file = assembly.values.text(path)) {
            history = read_factor_table(assembly.beside.directory / *file, assembly.at(path), assembly.findings);
            // the resolved scenario needs no other file
            if (!history.time.empty()) assembly.values.replace(path, load + ".table", points_of(history));
        }
    }
    return history;
}

void assemble_foundations(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("foundation"); ++i) {
        const std::string path = item("foundation", i);
        assembly.scenario.foundations.push_back({.on = selection(assembly, path + ".on"),
                                                 .glued = assembly.values.flag(path + ".glued").value_or(false),
                                                 .gap = assembly.values.number(path + ".gap").value_or(0)});
        const Foundation& made = assembly.scenario.foundations.back();
        if (made.glued && made.gap > 0)
            assembly.findings.error("exclusive-keys", "`" + path + "` is glued across a gap", assembly.at(path + ".gap")).note = "gap = 0, or glued = false";
    }
}

void assemble_loads(Assembly& assembly) {
    for (std::size_t i = 0; i < assembly.values.count("load"); ++i) {
        const std::string path = item("load", i);
        Load load{.name = assembly.values.text(path + ".name").value_or("load" + std::to_string(i)), .on = selection(assembly, path + ".on")};
        if (!assembly.values.given(path + ".name")) assembly.values.compute(path + ".name", Node::of_text(load.name));
        assembly.check_column_name(path + ".name", load.name, "a load");
        const std::optional<std::string> which =
            assembly.the_one(path, {"traction", "pressure", "stress", "force", "velocity", "displacement", "body_force", "acceleration"}, true);
        for (const auto& [name, kind] : kinds)
            if (which == name) load.kind = kind;
        if (which) {
            check_where(assembly, path, *which, load.kind);
            if (load.kind == Load::Kind::stress) load.stress = stress_of(assembly, path);
            else assemble_value(assembly, path + "." + *which, load);
        }
        load.history = assemble_history(assembly, path);
        assembly.scenario.loads.push_back(std::move(load));
    }
    for (std::size_t i = 0; i < assembly.values.count("initial"); ++i) {
        const std::string path = item("initial", i);
        InitialVelocity initial{.value = assembly.values.pair(path + ".velocity").value_or(Vec2::Zero())};
        initial.on.box = assembly.values.box(path + ".box");
        assembly.scenario.initial_velocities.push_back(initial);
    }
}

}  // namespace knap
