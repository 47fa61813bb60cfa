// [time], [output], [[probe]], [[figure]], [limits] and [expect].
#include "record/outputs.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

namespace knap {
namespace {

StepLength read_step(const Table& time, const std::string& key) {
    const std::optional<double> value = time.number(key);  // "auto" is none
    return value ? StepLength{.value = *value, .of_stable_step = time.unit(key) == "CFL"} : StepLength{};
}

/// A triangle by itself would have no inertia against turning.
void check_one_point_mass(const Table& time) {
    const Scenario& scenario = time.reading().scenario;
    const auto refuse = [&](const std::string& text, const std::string& cure) {
        time.report("exclusive-keys", "mass", "`time.mass`: the mass of one point " + text).note =
            cure + ", or mass = \"consistent\"";
    };
    if (scenario.order == 2) return refuse("is for triangles of first order", "mesh.order = 1");
    for (std::size_t a = 0; a < scenario.law_of_pair.size(); ++a) {
        const Index inside = scenario.law_of_pair[a][a];
        if (inside < 0 || !scenario.laws[inside].law.breakable()) continue;  // without a law: reported elsewhere
        return refuse("needs a body that does not break inside",
                      "interface." + scenario.laws[inside].name + ".breakable = false");
    }
}

/// Beyond theta = 1/(1 + e) the impact law of the theta scheme gains energy.
void check_theta(const Table& time) {
    const Scenario& scenario = time.reading().scenario;
    const double theta = scenario.time.scheme.theta;
    const auto check = [&](const std::string& owner, double e) {
        if (theta * (1 + e) <= 1 + 1e-12) return;
        const std::string bound = "1/(1 + restitution) = " + shortest(1 / (1 + e)) + " of the " + owner;
        time.report("out-of-range", "theta",
                    "`time.theta` = " + shortest(theta) + " is beyond " + bound + ": its impacts would gain energy")
            .note = "a smaller theta (0.5 is always good), or a smaller restitution";
    };
    for (const NamedLaw& named : scenario.laws) check("law `" + named.name + "`", named.law.restitution);
    if (scenario.time.scheme.bulk != BulkScheme::implicit_theta) return;
    for (const Obstacle& obstacle : scenario.obstacles)
        check("obstacle `" + obstacle.name + "`", obstacle.contact.restitution);
}

void read_time(Reading& reading) {
    const Table table = reading.table("time");
    TimeOptions& time = reading.scenario.time;
    SchemeOptions& scheme = time.scheme;
    table.fill(time);
    table.fill(scheme);
    time.step = read_step(table, "step");
    time.step_cracking = read_step(table, "step_cracking");
    time.step_min = read_step(table, "step_min");
    time.start_in_equilibrium = table.text("start") == "equilibrium";
    const bool implicit_bulk = table.text("bulk") == "implicit",
               implicit_cohesion = table.text("cohesion") == "implicit";
    if (implicit_bulk) scheme.bulk = BulkScheme::implicit_theta;
    if (implicit_cohesion) scheme.cohesion = CohesionScheme::implicit_beta;
    for (const MassMatrix mass : {MassMatrix::consistent, MassMatrix::one_point})
        if (table.text("mass") == name_of(mass)) scheme.mass = mass;
    scheme.respect_assumption_1 = table.text("assumption_1") != "ignore";
    if (implicit_bulk || implicit_cohesion) check_theta(table);
    if (scheme.mass == MassMatrix::one_point) check_one_point_mass(table);
    if (table.has("bulk") && !implicit_bulk && scheme.mass != MassMatrix::lumped)
        table.report("exclusive-keys", "mass", "`time.mass`: a mass that is not lumped needs the implicit bulk").note =
            "add bulk = \"implicit\" to [time]";
}

void read_output(Reading& reading) {
    const Table table = reading.table("output");
    if (const double end = reading.scenario.time.end; end > 0) {
        table.compute("every", Node::of_number(end / 40));
        table.compute("history_every", Node::of_number(end / 400));
    }
    table.fill(reading.scenario.output);
}

void read_probe(const Table& table, std::size_t number) {
    table.compute("name", Node::of_text("probe" + std::to_string(number)));
    table.check_column_name("name", table.text("name"), "a probe");
    if (!table.has("at")) return;
    ProbeOptions probe{.name = {}, .at = Vec2::Zero(), .interface = table.text("watch") == "interface"};
    table.fill(probe);
    table.reading().scenario.probes.push_back(std::move(probe));
}

/// Figures of what a run does not have.
void check_subject(const Table& figure) {
    const Reading& reading = figure.reading();
    const std::vector<ProbeOptions>& probes = reading.scenario.probes;
    const std::string show = figure.text("show");
    const auto refuse = [&](const std::string& text, const std::string& cure) {
        figure.report("nothing-to-show", "show", "`" + figure.path() + "` shows " + text).note = cure;
    };
    if (show == "reactions" && reading.drivers().empty())
        refuse("reactions, but no load prescribes a motion and there is no obstacle",
               "a reaction is the force of a load with velocity or displacement");
    if ((show == "probes" || show == "probe_velocities") && reading.values.count("probe") == 0)
        refuse("probes, but there is none", "add a [[probe]]");
    const bool only_interfaces = std::ranges::all_of(probes, &ProbeOptions::interface);
    if (show == "probe_velocities" && !probes.empty() && only_interfaces)
        refuse("velocities, but all probes watch interfaces", "add a [[probe]] that watches a place");
}

void read_figure(const Table& table, std::set<std::string>& files) {
    Scenario& scenario = table.reading().scenario;
    const double end = scenario.time.end;
    if (end > 0) table.compute("at", Node::of_list({Node::of_number(end)}));
    FigureOptions figure;
    table.fill(figure);
    const std::string& file = figure.file;
    const bool has_type =
        file.size() > 4 && (file.ends_with(".png") || file.ends_with(".svg") || file.ends_with(".pdf"));
    if (table.has("file") && (!has_type || file.find_first_of("/\\") != std::string::npos || file.front() == '.'))
        table.report("bad-name", "file", "`" + file + "` cannot be the file of a figure").note =
            "a plain name that ends in .png, .svg or .pdf; figures go to the run directory";
    if (table.has("file") && !files.insert(file).second)
        table.report("duplicate-name", "file", "two figures are called `" + file + "`");
    std::ranges::sort(figure.at);
    for (const Node* time : table.items("at"))
        if (end > 0 && time->number > end)
            table.reading().findings.warning("never-drawn",
                                             "`" + table.path("at") + "`: the run ends at " + shortest(end) +
                                                 " s, before " + shortest(time->number) + " s",
                                             *time);
    if (const auto range = table.pair("range")) {
        figure.range = {range->x(), range->y()};
        if (!(range->x() < range->y())) table.error("out-of-range", "range", "does not ascend");
    }
    scenario.figures.push_back(std::move(figure));
}

void read_limits(Reading& reading) {
    const Table table = reading.table("limits");
    for (const GateRule& rule : gate_rules()) {
        const std::string name(rule.name);
        const auto allow = [&](double limit) { reading.scenario.allowed_limits.push_back({name, limit}); };
        if (const auto limit = table.number(name)) allow(*limit);
        else if (table.text(name) == "none") allow(std::numeric_limits<double>::infinity());
    }
}

void read_expectation(const Table& table, const std::string& name) {
    const auto says = [&](const std::string& text, const std::string& note = {}) {
        table.report("missing-key", "", "`" + table.path() + "`" + text).note = note;
    };
    constexpr std::array bounds{"below", "above", "at_least", "at_most", "value"};
    if (table.given("value") != table.given("within")) says(": value and within belong together");
    else if (std::ranges::none_of(bounds, [&](const char* bound) { return table.given(bound); }))
        says(" expects nothing", "below, above, at_least, at_most, or value and within");
    table.reading().check_summary_number(table.path(), name);

    Expectation expect{.key = name};
    table.fill(expect);
    expect.relative = table.unit("within") == "%";
    if (expect.relative) expect.within /= 100;
    std::set<std::string> units;  // all numbers must be in one
    for (const char* bound : bounds)
        if (table.has(bound)) units.insert(table.unit(bound));
    if (table.has("within") && !expect.relative) units.insert(table.unit("within"));
    if (units.size() > 1) table.report("wrong-unit", "", "`" + table.path() + "` mixes cR with SI");
    if (!units.empty()) expect.unit = *units.begin();
    table.reading().scenario.expect.push_back(std::move(expect));
}

}  // namespace

void read_run(Reading& reading) {
    read_time(reading);
    read_output(reading);
    std::size_t n_probes = 0;
    for (const Table& table : reading.list("probe")) read_probe(table, ++n_probes);
    for (const Table& table : reading.list("figure")) check_subject(table);
    read_specimen(reading);
    std::set<std::string> files;
    for (const Table& table : reading.list("figure")) read_figure(table, files);
    read_limits(reading);
    for (const std::string& name : reading.values.names("expect"))
        read_expectation(reading.table("expect." + name), name);
}

}  // namespace knap
