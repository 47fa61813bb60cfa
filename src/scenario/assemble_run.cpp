// [time], [output], [[figure]], [limits] and [expect].
#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "scenario/assemble.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

StepLength step_length(const Values& values, const std::string& path) {
    const std::optional<double> value = values.number(path);  // "auto" is none
    if (!value) return {};
    return {.value = *value, .of_stable_step = values.find(path)->node.unit == "CFL"};
}

void needs_implicit_bulk(const Assembly& assembly, const std::string& path, const std::string& what) {
    assembly.findings.error("exclusive-keys", "`" + path + "`: " + what + " needs the implicit bulk", assembly.at(path)).note =
        "add bulk = \"implicit\" to [time]";
}

/// A triangle by itself would have no inertia against turning.
void check_one_point_mass(const Assembly& assembly) {
    const Scenario& scenario = assembly.scenario;
    if (scenario.order == 2) {
        assembly.findings.error("exclusive-keys", "`time.mass`: the mass of one point is for triangles of first order", assembly.at("time.mass")).note =
            "mesh.order = 1, or mass = \"consistent\"";
        return;
    }
    for (std::size_t a = 0; a < scenario.law_of_pair.size(); ++a) {
        const Index inside = scenario.law_of_pair[a][a];
        if (inside < 0) continue;  // there is none: reported
        const NamedLaw& law = scenario.laws[inside];
        if (!law.law.breakable()) continue;
        assembly.findings.error("exclusive-keys", "`time.mass`: the mass of one point needs a body that does not break inside", assembly.at("time.mass")).note =
            "interface." + law.name + ".breakable = false, or mass = \"consistent\"";
        return;
    }
}

/// Beyond theta = 1/(1 + e) the impact law of the theta scheme gains energy.
void check_theta(const Assembly& assembly) {
    const double theta = assembly.scenario.time.scheme.theta;
    const auto check = [&](const char* what, const std::string& name, double e) {
        if (theta * (1 + e) <= 1 + 1e-12) return;
        assembly.findings.error("out-of-range",
                                "`time.theta` = " + shortest(theta) + " is beyond 1/(1 + restitution) = " + shortest(1 / (1 + e)) + " of the " + what + " `" + name +
                                    "`: its impacts would gain energy",
                                assembly.at("time.theta"))
            .note = "a smaller theta (0.5 is always good), or a smaller restitution";
    };
    for (const NamedLaw& named : assembly.scenario.laws) check("law", named.name, named.law.restitution);
    if (assembly.scenario.time.scheme.bulk != BulkScheme::implicit_theta) return;
    for (const Obstacle& obstacle : assembly.scenario.obstacles) check("obstacle", obstacle.name, obstacle.contact.restitution);
}

void check_file_name(const Assembly& assembly, const std::string& path, const std::string& file, std::set<std::string>& seen) {
    const bool has_type = file.size() > 4 && (file.ends_with(".png") || file.ends_with(".svg") || file.ends_with(".pdf"));
    if (!has_type || file.find_first_of("/\\") != std::string::npos || file.front() == '.')
        assembly.findings.error("bad-name", "`" + file + "` cannot be the file of a figure", assembly.at(path)).note =
            "a plain name that ends in .png, .svg or .pdf; figures go to the run directory";
    if (!seen.insert(file).second) assembly.findings.error("duplicate-name", "two figures are called `" + file + "`", assembly.at(path));
}

void assemble_times(Assembly& assembly, const std::string& path, FigureOptions& figure) {
    const double end = assembly.scenario.time.end;
    if (!assembly.values.given(path) && end > 0) {
        Node list{.type = Node::Type::array};
        list.children.push_back(Node::of_number(end));
        assembly.values.compute(path, std::move(list));
    }
    for (const Node* time : assembly.values.items(path)) {
        figure.at.insert(std::upper_bound(figure.at.begin(), figure.at.end(), time->number), time->number);
        if (end > 0 && time->number > end)
            assembly.findings.warning("never-drawn", "`" + path + "`: the run ends at " + shortest(end) + " s, before " + shortest(time->number) + " s", *time);
    }
}

using Bound = std::optional<double> Expectation::*;
constexpr std::array bounds{std::pair<const char*, Bound>{"below", &Expectation::below}, std::pair<const char*, Bound>{"above", &Expectation::above},
                            std::pair<const char*, Bound>{"at_least", &Expectation::at_least},
                            std::pair<const char*, Bound>{"at_most", &Expectation::at_most}, std::pair<const char*, Bound>{"value", &Expectation::value}};

/// All numbers of one expectation must be in one unit.
void check_units(const Assembly& assembly, const std::string& path, const std::set<std::string>& units) {
    if (units.size() > 1) assembly.findings.error("wrong-unit", "`" + path + "` mixes cR with SI", assembly.at(path));
}

Expectation expectation(const Assembly& assembly, const std::string& name) {
    const std::string path = "expect." + name;
    Expectation expect{.key = name};
    std::set<std::string> units;
    for (const auto& [word, bound] : bounds) {
        const std::string here = path + "." + word;
        expect.*bound = assembly.values.number(here);
        if (assembly.values.has(here)) units.insert(assembly.values.find(here)->node.unit);
    }
    if (const auto within = assembly.values.number(path + ".within")) {
        const std::string& unit = assembly.values.find(path + ".within")->node.unit;
        expect.relative = unit == "%";
        expect.within = expect.relative ? *within / 100 : *within;
        if (!expect.relative) units.insert(unit);
    }
    check_units(assembly, path, units);
    if (!units.empty()) expect.unit = *units.begin();
    return expect;
}

void check_bounds(const Assembly& assembly, const std::string& path) {
    const auto given = [&](const char* word) { return assembly.values.given(path + "." + word); };
    if (given("value") != given("within"))
        assembly.findings.error("missing-key", "`" + path + "`: value and within belong together", assembly.at(path));
    else if (std::none_of(bounds.begin(), bounds.end(), [&](const auto& bound) { return given(bound.first); }))
        assembly.findings.error("missing-key", "`" + path + "` expects nothing", assembly.at(path)).note =
            "below, above, at_least, at_most, or value and within";
}

}  // namespace

void assemble_time(Assembly& assembly) {
    const Values& values = assembly.values;
    TimeOptions& time = assembly.scenario.time;
    time.end = values.number("time.end").value_or(0);
    time.step = step_length(values, "time.step");
    time.step_cracking = step_length(values, "time.step_cracking");
    time.step_min = step_length(values, "time.step_min");
    time.safety = values.number("time.safety").value_or(time.safety);
    time.start_in_equilibrium = values.text("time.start") == "equilibrium";
    SchemeOptions& scheme = time.scheme;
    const bool implicit_bulk = values.text("time.bulk") == "implicit", implicit_cohesion = values.text("time.cohesion") == "implicit";
    if (implicit_bulk) scheme.bulk = BulkScheme::implicit_theta;
    if (implicit_cohesion) scheme.cohesion = CohesionScheme::implicit_beta;
    for (const MassMatrix mass : {MassMatrix::consistent, MassMatrix::one_point})
        if (values.text("time.mass") == name_of(mass)) scheme.mass = mass;
    scheme.theta = values.number("time.theta").value_or(scheme.theta);
    scheme.respect_assumption_1 = values.text("time.assumption_1") != "ignore";
    if (implicit_bulk || implicit_cohesion) check_theta(assembly);
    if (scheme.mass == MassMatrix::one_point) check_one_point_mass(assembly);
    if (!values.has("time.bulk") || implicit_bulk) return;
    if (scheme.mass != MassMatrix::lumped) needs_implicit_bulk(assembly, "time.mass", "a mass that is not lumped");
}

void assemble_output(Assembly& assembly) {
    const double end = assembly.scenario.time.end;
    if (end > 0) {  // the defaults, here and nowhere else
        assembly.values.compute("output.every", Node::of_number(end / 40));
        assembly.values.compute("output.history_every", Node::of_number(end / 400));
    }
    OutputOptions& output = assembly.scenario.output;
    output.every = assembly.values.number("output.every").value_or(0);
    output.history_every = assembly.values.number("output.history_every").value_or(0);
    output.checkpoint_every = assembly.values.number("output.checkpoint_every").value_or(output.checkpoint_every);
    output.fields = assembly.values.flag("output.fields").value_or(true);
}

void assemble_figures(Assembly& assembly) {
    const Values& values = assembly.values;
    std::set<std::string> files;
    for (std::size_t i = 0; i < values.count("figure"); ++i) {
        const std::string path = item("figure", i);
        FigureOptions figure;
        figure.file = values.text(path + ".file").value_or("");
        if (values.has(path + ".file")) check_file_name(assembly, path + ".file", figure.file, files);
        figure.show = values.text(path + ".show").value_or(figure.show);
        figure.colour = values.text(path + ".colour").value_or(figure.colour);
        figure.deform = values.number(path + ".deform").value_or(figure.deform);
        figure.box = values.box(path + ".box");
        figure.width = static_cast<int>(values.number(path + ".width").value_or(figure.width));
        figure.title = values.text(path + ".title").value_or("");
        figure.over = values.text(path + ".over").value_or(figure.over);
        figure.aspect = values.number(path + ".aspect").value_or(figure.aspect);
        figure.panel = values.flag(path + ".panel").value_or(figure.panel);
        assemble_times(assembly, path + ".at", figure);
        if (const auto range = values.pair(path + ".range")) {
            figure.range = {range->x(), range->y()};
            if (!(range->x() < range->y())) assembly.findings.error("out-of-range", "`" + path + ".range` does not ascend", assembly.at(path + ".range"));
        }
        assembly.scenario.figures.push_back(std::move(figure));
    }
}

void assemble_limits(Assembly& assembly) {
    for (const GateRule& rule : gate_rules()) {
        const std::string path = "limits." + std::string(rule.name);
        const auto allow = [&](double limit) { assembly.scenario.allowed_limits.push_back({std::string(rule.name), limit}); };
        if (const auto limit = assembly.values.number(path)) allow(*limit);
        else if (assembly.values.text(path) == "none") allow(std::numeric_limits<double>::infinity());
    }
}

void assemble_expectations(Assembly& assembly) {
    for (const std::string& name : assembly.values.names("expect")) {
        check_bounds(assembly, "expect." + name);
        assembly.check_summary_number("expect." + name, name);
        assembly.scenario.expect.push_back(expectation(assembly, name));
    }
}

}  // namespace knap
