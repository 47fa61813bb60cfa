// [time], [output], [[probe]], [specimen], [[figure]], [limits] and [expect].
#include "record/outputs.hpp"

#include "base/display_unit.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace knap {
namespace {

/// One quadrature point gives a free triangle no moment of inertia, so triangles must not break.
void check_one_point_mass(const Table& time) {
    const Scenario& scenario = time.scenario();
    const auto error = [&](const std::string& text, const std::string& cure) {
        time.error("exclusive-keys", "mass", "= \"one point\" " + text, cure + ", or mass = \"consistent\"");
    };
    if (scenario.order == 2) return error("is for triangles of first order", "mesh.order = 1");
    for (std::size_t a = 0; a < scenario.law_of_pair.size(); ++a) {
        const Index inside = scenario.law_of_pair[a][a];
        if (inside < 0 || !scenario.laws[inside].law.breakable()) continue;  // without a law: reported already
        return error("needs a body that does not break inside",
                     "interface." + scenario.laws[inside].name + ".breakable = false");
    }
}

/// Of interface laws and obstacles.
void check_thetas(const Table& time) {
    const Scenario& scenario = time.scenario();
    for (const NamedLaw& named : scenario.laws) check_theta(time, "law `" + named.name + "`", named.law.restitution);
    if (!scenario.time.scheme.takes_implicit_steps()) return;
    for (const Obstacle& obstacle : scenario.obstacles)
        check_theta(time, "obstacle `" + obstacle.name + "`", obstacle.largest_restitution());
}

void check_large_rotation(const Table& domain) {
    if (domain.scenario().order == 2)
        domain.exclude("rotation", "rotation = \"large\"", "mesh.order = 2", "mesh.order = 1, or rotation = \"small\"");
}

/// Faces that rub while the body flutters slip where their mean force would hold them, so viscosity is on there, unless
/// something else that the file says does not go with it. With friction over pressure or slip their mean force is too
/// small besides, and the viscosity larger, whatever the bulk has.
void read_viscosity(Reading& reading) {
    Scenario& scenario = reading.scenario;
    const TimeOptions& time = scenario.time;
    const bool changes =
                   std::ranges::any_of(scenario.laws, [](const NamedLaw&of) { return of.law.friction_changes(); }),
               rubs = reading.table("contact").given() || changes ||
                      std::ranges::any_of(
                          scenario.obstacles,
                          [](const Obstacle&obstacle) {
                              return obstacle.any_law([](const ContactLaw& law) { return law.friction > 0; });
                          }),
               only_implicit = !time.scheme.takes_explicit_steps(),
               cuts_order_2 = scenario.order == 2 && reading.values.has("excavation"),
               fixed_step =  // viscosity may make it unstable
               !time.scheme.takes_implicit_steps() && time.step.value > 0 && !time.step.of_stable_step;
    const bool is_on = rubs && !only_implicit && !cuts_order_2 && !fixed_step;
    const std::array<double, 2> otherwise = is_on ? std::array{0., 1.2} : std::array{0., 0.};
    std::size_t i = 0;
    bool is_missing = false;
    for (const Table& table : reading.list("material")) {
        Elastic& material = scenario.materials[i++].elastic;
        const bool is_given = table.given("bulk_viscosity");
        is_missing = is_missing || !(is_given || table.given("shear_viscosity"));
        if (!is_given) {
            material.bulk_viscosity = otherwise;
            table.compute("bulk_viscosity",
                          Node::of_list({Node::of_number(otherwise[0]), Node::of_number(otherwise[1])}));
        }
        if (!table.given("shear_viscosity")) {
            material.shear_viscosity = !is_on ? 0 : changes ? 0.3 : is_given ? 0 : 0.1;
            table.compute("shear_viscosity", Node::of_number(material.shear_viscosity));
        }
        if (!material.has_viscosity()) continue;
        const char* key = material.shear_viscosity > 0 ? "shear_viscosity" : "bulk_viscosity";
        if (only_implicit)
            table.exclude(key, "bulk_viscosity", "bulk = \"implicit\"",
                          "bulk = \"explicit\" or \"auto\", or theta > 0.5");
        if (cuts_order_2)
            table.error("exclusive-keys", key, "does not go together with [[excavation]] and triangles of second order",
                        "mesh.order = 1, or remove one of them");
    }
    if (rubs && fixed_step && is_missing)
        reading.table("time").warning(
            "no-viscosity", "step",
            "in seconds leaves out the viscosity that faces which rub have by default, since the step may be too "
            "large for it: what friction holds may creep",
            "step = \"0.8 CFL\", or shear_viscosity = 0.1 and bulk_viscosity = [0, 1.2] in [material.*] (the largest "
            "step is 16 % smaller then), 0.3 with friction over pressure or slip; bulk_viscosity = [0, 0] says that "
            "none is "
            "meant");
}

/// bulk = "auto": both schemes have a lumped mass, and each its own cohesion.
void read_automatic(const Table& table, SchemeOptions& scheme) {
    if (table.given("cohesion")) table.exclude("cohesion", "cohesion", "bulk = \"auto\"", "remove it");
    table.leave_out("cohesion");
    scheme.cohesion = CohesionScheme::implicit_beta;
    if (scheme.mass != MassMatrix::lumped)
        table.exclude("mass", "mass = \"consistent\"", "bulk = \"auto\"", "bulk = \"implicit\", or remove mass");
}

/// Two keys of [time] that mean nothing without `other`; the first one has a default.
void refuse_without(const char* other, std::array<const char*, 2> keys, const Table& table) {
    for (const char* key : keys)
        if (table.given(key))
            table.error("exclusive-keys", key, std::string("belongs to ") + other,
                        std::string("add ") + other + " to [time]");
    table.leave_out(keys.front());
}

void read_time(const Table& table, TimeOptions& time) {
    SchemeOptions& scheme = time.scheme;
    table.fill(time);
    table.fill(time.scheme);
    table.fill(time.rest);
    table.fill(time.change);
    if (scheme.bulk == BulkScheme::automatic) read_automatic(table, scheme);
    else refuse_without("bulk = \"auto\"", {"quiet_below", "quiet_for"}, table);
    if (!time.rest.ends_run) refuse_without("until = \"rest\"", {"rest_below", "rest_for"}, table);
    const bool explicit_bulk = !scheme.takes_implicit_steps();
    if (!explicit_bulk || scheme.cohesion == CohesionScheme::implicit_beta) check_thetas(table);
    if (scheme.damping == 0) {
        if (table.given("damping_of"))
            table.error("exclusive-keys", "damping_of", "belongs to time.damping", "add damping to [time]");
        table.leave_out("damping_of");
    }
    if (time.mass_scaling > 0 && !scheme.takes_explicit_steps())
        table.exclude("mass_scaling", "mass_scaling", "bulk = \"implicit\"", "remove it");
    if (scheme.mass == MassMatrix::one_point) check_one_point_mass(table);
    if (table.has("bulk") && explicit_bulk && scheme.mass != MassMatrix::lumped)
        table.error("exclusive-keys", "mass", "that is not lumped needs the implicit bulk",
                    "add bulk = \"implicit\" to [time]");
}

void read_probe(const Table& table, std::size_t number) {
    table.compute("name", Node::of_text("probe" + std::to_string(number)));
    table.check_column_name(table.text("name"));
    if (!table.has("at") && table.text("watch") != "stress") return;
    ProbeOptions probe;
    table.fill(probe);
    probe.heat = table.reading().table("heat").given();
    table.scenario().probes.push_back(std::move(probe));
}

void read_collector(const Table& table, std::size_t number) {
    table.compute("name", Node::of_text("collector" + std::to_string(number)));
    table.check_column_name(table.text("name"));
    CollectorOptions collector;
    table.fill(collector);
    const bool vertical = table.given("x"), ends = table.given("from") || table.given("to");
    if (vertical && ends)
        table.error("exclusive-keys", "x", "is a vertical without ends, and from and to are the ends of a line");
    if (!vertical && !(table.given("from") && table.given("to")))
        table.error("missing-key", "", "has no line", "either from and to, its ends, or x, a vertical without ends");
    if (table.has("from") && table.has("to") && collector.from == collector.to)
        table.error("out-of-range", "to", "is the same point as from: the line has no length");
    table.scenario().collectors.push_back(std::move(collector));
}

FigureNeed need_of(const Table& figure) {
    const FigureOptions usual;
    return need_of_figure(figure.has("show") ? figure.text("show") : usual.show,
                          figure.has("colour") ? figure.text("colour") : usual.colour);
}

/// Figures of data that the run does not have.
void check_subject(const Table& figure) {
    const auto need = [&](bool met, const std::string& lacks, const std::string& cure) {
        if (!met) figure.error("nothing-to-show", "show", "= \"" + figure.text("show") + "\", but " + lacks, cure);
        return met;
    };
    using Watch = ProbeOptions::Watch;
    const auto need_probe = [&](std::initializer_list<Watch> of, const char* lacks, const char* cure) {
        const std::vector<ProbeOptions>& probes = figure.scenario().probes;
        if (!need(!figure.reading().list("probe").empty(), "there is none", "add a [[probe]]") || probes.empty())
            return;
        need(std::ranges::any_of(probes, [&](const auto& p) { return std::ranges::count(of, p.watch) > 0; }), lacks,
             cure);
    };
    switch (need_of(figure)) {
        case FigureNeed::heat:
            need(figure.reading().table("heat").given(), "nothing has a temperature", "[heat]");
            break;
        case FigureNeed::driver:
            need(!figure.reading().drivers().empty(), "no load prescribes a motion and there is no obstacle",
                 "a reaction is the force of a load with velocity or displacement");
            break;
        case FigureNeed::probe_of_motion:
            need_probe({Watch::place, Watch::interface, Watch::tip}, "no probe watches a place, an interface or a tip",
                       "another figure, or another probe");
            break;
        case FigureNeed::probe_of_place:
            need_probe({Watch::place}, "no probe watches a place", "add a [[probe]] that watches a place");
            break;
        case FigureNeed::probe_of_stress:
            need_probe({Watch::stress}, "no probe watches a stress", "add a [[probe]] with watch = \"stress\"");
            break;
        case FigureNeed::probe_of_tip:
            need_probe({Watch::tip}, "no probe watches a tip", "add a [[probe]] with watch = \"tip\"");
            break;
        case FigureNeed::specimen:
            need(figure.reading().table("specimen").given(), "there is no specimen", "add a [specimen]");
            break;
        case FigureNeed::fluid:
            need(!figure.reading().list("pressure").empty(), "there is no fluid in cracks", "add a [[pressure]]");
            break;
        case FigureNeed::nothing:
        case FigureNeed::breaks:  // read_breaks
        case FigureNeed::fragments: break;
    }
}

/// Times of an animation are those of its pictures.
void read_animation(const Table& table, FigureOptions& figure) {
    constexpr double max_pictures = 5000;
    if (!shows_body(figure.show))
        table.error("exclusive-keys", "file", "is an animation, which shows the body",
                    "show = \"cracks\" with curves = \"" + figure.show + "\"");
    const double end = table.scenario().time.end, n = end / figure.every;
    if (!(end > 0 && figure.every > 0)) return;
    if (n > max_pictures)
        return table.error("out-of-range", "every",
                           "asks for " + shortest(std::ceil(n)) + " pictures, " + shortest(max_pictures) + " at most",
                           "a larger every");
    figure.at.clear();
    for (int k = 0; k <= static_cast<int>(n * (1 + 1e-9)); ++k) figure.at.push_back(k * figure.every);
    if (figure.at.back() < end * (1 - 1e-9)) figure.at.push_back(end);
}

void read_figure(const Table& table, std::set<std::string>& files) {
    const double end = table.scenario().time.end;
    FigureOptions figure;
    figure.file = table.has("file") ? table.text("file") : "";
    const bool animation = figure.is_animation();
    if (end > 0 && !animation) table.compute("at", Node::of_list({Node::of_number(end)}));
    if (animation) table.compute("every", Node::of_number(table.scenario().output.every));
    table.compute("width", Node::of_integer(animation ? animation_width : figure.width));
    table.fill(figure);
    const std::string& file = figure.file;
    const bool is_plain_name = file.find_first_of("/\\") == std::string::npos && !file.starts_with('.');
    if (table.has("file") && !is_plain_name)
        table.error("bad-name", "file", "= \"" + file + "\" cannot be the file of a figure",
                    "a plain name; figures are written to the run directory");
    // resolved.toml has keys without an effect, with their usual values
    FigureOptions given = figure;
    if (given.at == std::vector{end}) given.at.clear();
    for (const IdleKey& idle : idle_keys(given))
        if (table.has("file") && table.given(idle.key) && !idle.is_usual)
            table.error("exclusive-keys", idle.key, "belongs to " + idle.owner, idle.cure);
    if (animation) read_animation(table, figure);
    if (table.has("file") && !files.insert(file).second)
        table.error("duplicate-name", "file", "= \"" + file + "\" is the file of another figure, too");
    std::ranges::sort(figure.at);
    for (const Node& time : table.items("at"))
        if (end > 0 && time.number > end)
            table.reading().findings.warning("never-drawn",
                                             "`" + table.path("at") + "`: the run ends at " + readable(end, "s", 6) +
                                                 ", before " + readable(time.number, "s", 6),
                                             time);
    if (table.has("range") && !(figure.range[0] < figure.range[1]))
        table.error("out-of-range", "range", "does not ascend");
    if (!figure.mark.empty() && !takes_marks(figure.show))
        table.error("exclusive-keys", "mark", "belongs to show = \"temperature\" or curves of probes and reactions");
    if (table.has("measured") && !takes_measured(figure.show))
        table.error("exclusive-keys", "measured", "belongs to the body or to curves over two axes");
    if (table.has("measured") && figure.measured_by.empty())
        table.error("missing-key", "measured", "has no source", "measured_by = \"authors, year\"");
    if (table.given("font_size") == (figure.font_size > 0)) try {  // else its error was reported
            check_type(figure);
        } catch (const UserError& error) {
            const Diagnostic& fault = error.diagnostics.front();
            table.error("figure-font",
                        fault.code == "figure-font" && figure.font_size > 0 ? "font_size" : "paper_width",
                        "is not possible: " + fault.message);
        }
    table.scenario().figures.push_back(std::move(figure));
}

// ---- [specimen], output.breaks, and figures and expectations that need them

/// All possible ends of a gauge.
std::vector<NamedEnd> gauge_ends(const Reading& reading) {
    std::vector<NamedEnd> found;
    for (const std::string& boundary : reading.scenario.boundary_names())
        found.emplace_back(boundary, GaugeEnd{.boundary = boundary});
    for (const ProbeOptions& probe : reading.scenario.probes)
        if (probe.watch == ProbeOptions::Watch::place)
            found.emplace_back(probe.name, GaugeEnd{.kind = GaugeEnd::Kind::place, .at = probe.at});
    for (NamedEnd& driver : reading.drivers()) found.push_back(std::move(driver));
    return found;
}

/// The end of this name; none, and an error, if there is no such end.
std::optional<GaugeEnd> find_end(const Table& table, const char* key, const char* what, const std::string& name,
                                 const std::vector<NamedEnd>& ends) {
    std::vector<std::string> known;
    for (const NamedEnd& end : ends) known.push_back(end.first);
    const auto found = table.reading().find(table.path(key), what, name, known);
    return found ? std::optional(ends[*found].second) : std::nullopt;
}

std::optional<GaugeEnds> read_gauge(const Table& table, const char* key) {
    if (!table.has(key)) return std::nullopt;
    const std::vector<NamedEnd> ends = gauge_ends(table.reading());
    const std::vector<std::string> names = table.texts(key);
    GaugeEnds found;
    for (std::size_t i = 0; i < names.size() && i < 2; ++i)
        if (const auto end = find_end(table, key, "boundary, probe, obstacle or driving load", names[i], ends))
            found[i] = *end;
    return found;
}

/// Whether a driver moves along an axis.
bool moves(const Scenario& scenario, const GaugeEnd& driver, int axis) {
    if (driver.kind == GaugeEnd::Kind::load) return scenario.loads[driver.number].value[axis].value_or(0) != 0;
    const Drive& drive = scenario.obstacles[driver.number].drive[axis];
    return drive.kind == Drive::Kind::free || drive.value != 0;
}

/// Without a gauge, the strain is the displacement of the driver over the height: the other end must be fixed.
void check_other_end(const Table& table, const SpecimenOptions& specimen) {
    if (specimen.axial) return;
    for (const auto& [name, driver] : table.reading().drivers()) {
        const bool itself = driver.kind == specimen.driver.kind && driver.number == specimen.driver.number;
        if (itself || !moves(table.scenario(), driver, specimen.axis)) continue;
        return table.warning(
            "other-end", "",
            "has a strain from the displacement of specimen.force alone, but `" + name + "` moves as well",
            "axial = [...] names the two ends of a gauge");
    }
}

/// Expected numbers that need a specimen or breaks.
void check_expectations(Reading& reading) {
    const Table expect = reading.table("expect"), specimen = reading.table("specimen");
    const auto need = [&](const char* what, bool met, std::initializer_list<const char*> numbers) {
        for (const char* number : numbers)
            if (!met && expect.given(number)) expect.error("nothing-to-expect", number, std::string("needs ") + what);
    };
    need("a [specimen]", specimen.given(),
         {"peak_stress", "strength", "peak_strain", "tangent_modulus", "crack_initiation_stress"});
    need("a [specimen] with a lateral gauge", specimen.given("lateral"),
         {"youngs_modulus", "poisson_ratio", "dilatancy_stress", "crack_damage_stress"});
    need("output.breaks = true", reading.scenario.output.breaks, {"tensile_breaks", "shear_breaks"});
}

void read_breaks(Reading& reading, bool specimen) {
    std::string user = specimen ? "a [specimen]" : "";
    for (const Table& figure : reading.list("figure")) {
        const bool of_body = !figure.has("show") || shows_body(figure.text("show"));
        if (user.empty() && need_of(figure) == FigureNeed::breaks)
            user = "`" + figure.path(of_body ? "colour" : "show") + "`";
    }
    const Table output = reading.table("output");
    output.compute("breaks", Node::of_boolean(!user.empty()));
    output.fill(reading.scenario.output);
    if (!reading.scenario.output.breaks && !user.empty())
        output.error("exclusive-keys", "breaks", "is false, but " + user + " needs it");
}

void read_specimen(Reading& reading) {
    const Table table = reading.table("specimen");
    read_breaks(reading, table.given());
    check_expectations(reading);
    if (!table.given()) return;
    SpecimenOptions specimen;
    table.fill(specimen);
    std::optional<GaugeEnd> driver;
    if (table.has("force"))
        driver =
            find_end(table, "force", "obstacle or load with prescribed motion", table.text("force"), reading.drivers());
    if (driver) specimen.driver = *driver;
    specimen.axial = read_gauge(table, "axial");
    specimen.lateral = read_gauge(table, "lateral");
    if (driver) check_other_end(table, specimen);
    if (!(specimen.modulus_between[0] < specimen.modulus_between[1]))
        table.error("out-of-range", "modulus_between", "does not ascend");
    for (const char* key : {"height", "width"})
        if (reading.scenario.bodies.size() > 1 && !table.given(key))
            table.error("missing-key", key, "is missing: there are several bodies", "the size of the specimen");
    reading.scenario.specimen = specimen;
}

// ----

void read_limits(const Table& table) {
    for (const GateRule& rule : gate_rules()) {
        const std::string name(rule.name);
        const auto limit = table.text(name) == "none" ? infinity : table.number(name);
        if (limit) table.scenario().allowed_limits.push_back({name, *limit});
    }
}

void read_expectation(const Table& table) {
    if (!table.has("")) return;  // no table: reported
    std::vector<std::string> keys;
    for (const Key* key : keys_below("expect.*"))
        if (table.given(key->name())) keys.emplace_back(key->name());
    if (table.given("value") != table.given("within"))
        table.error("missing-key", "", ": value and within belong together");
    else if (keys.empty())
        table.error("missing-key", "", "expects nothing", "below, above, at_least, at_most, or value and within");
    table.reading().check_summary_number(table.path(), table.name());

    Expectation expect{.key = table.name()};
    table.fill(expect);
    expect.relative = table.unit("within") == "%";
    if (expect.relative) expect.within /= 100;
    std::set<std::string> units;  // all numbers must be in one
    for (const std::string& key : keys)
        if (table.has(key) && table.unit(key) != "%") units.insert(table.unit(key));
    if (units.size() > 1) table.error("wrong-unit", "", "mixes cR with SI");
    if (!units.empty()) expect.unit = *units.begin();
    table.scenario().expect.push_back(std::move(expect));
}

}  // namespace

void check_theta(const Table& time, const std::string& owner, double e) {
    const double theta = time.scenario().time.scheme.theta;
    if (theta * (1 + e) <= 1 + 1e-12) return;
    time.error("out-of-range", "theta",
               "= " + shortest(theta) + " is beyond 1/(1 + restitution) = " + shortest(1 / (1 + e)) + " of the " +
                   owner + ": its impacts would gain energy",
               "a smaller theta (0.5 is always possible), or a smaller restitution");
}

void read_run(Reading& reading) {
    Scenario& scenario = reading.scenario;
    read_time(reading.table("time"), scenario.time);
    read_viscosity(reading);
    if (scenario.large_rotation) check_large_rotation(reading.table("domain"));
    const Table output = reading.table("output");
    if (const double end = scenario.time.end; end > 0) {
        output.compute("every", Node::of_number(end / 40));
        output.compute("history_every", Node::of_number(end / 400));
        reading.table("specimen").compute("window", Node::of_number(end / 400));
    }
    output.fill(scenario.output);
    read_start(reading.table("time"));
    check_states(output, scenario.time.end);
    std::size_t n_probes = 0;
    for (const Table& table : reading.list("probe")) read_probe(table, ++n_probes);
    std::size_t n_collectors = 0;
    for (const Table& table : reading.list("collector")) read_collector(table, ++n_collectors);
    for (const Table& table : reading.list("figure")) check_subject(table);
    read_specimen(reading);
    std::set<std::string> files;
    for (const Table& table : reading.list("figure")) read_figure(table, files);
    read_limits(reading.table("limits"));
    for (const Table& table : reading.list("expect")) read_expectation(table);
}

}  // namespace knap
