// [time], [output], [[figure]] and [expect].
#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "scenario/assemble.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

void not_available(const Assembly& assembly, const std::string& path) {
    assembly.findings.error("not-available", "`" + path + "` = \"implicit\" is not available yet", assembly.at(path)).note = "use \"explicit\"";
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
        figure.at.push_back(time->number);
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
    time.step = values.number("time.step").value_or(0);  // "auto": 0
    time.safety = values.number("time.safety").value_or(time.safety);
    time.scheme.theta = values.number("time.theta").value_or(time.scheme.theta);
    if (values.text("time.bulk") == "implicit") not_available(assembly, "time.bulk");
    if (values.text("time.cohesion") == "implicit") not_available(assembly, "time.cohesion");
}

void assemble_output(Assembly& assembly) {
    const double end = assembly.scenario.time.end;
    if (end > 0) {
        assembly.values.compute("output.every", Node::of_number(end / 40));
        assembly.values.compute("output.history_every", Node::of_number(end / 400));
    }
    OutputOptions& output = assembly.scenario.output;
    output.every = assembly.values.number("output.every").value_or(0);
    output.history_every = assembly.values.number("output.history_every").value_or(0);
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
        assemble_times(assembly, path + ".at", figure);
        if (const auto range = values.pair(path + ".range")) {
            figure.range = {range->x(), range->y()};
            if (!(range->x() < range->y())) assembly.findings.error("out-of-range", "`" + path + ".range` does not ascend", assembly.at(path + ".range"));
        }
        assembly.scenario.figures.push_back(std::move(figure));
    }
}

void assemble_expectations(Assembly& assembly) {
    for (const std::string& name : assembly.values.names("expect")) {
        check_bounds(assembly, "expect." + name);
        assembly.scenario.expect.push_back(expectation(assembly, name));
    }
}

}  // namespace knap
