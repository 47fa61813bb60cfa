// [[support]], [[load]], [[initial]] and [[obstacle]]: where something acts, what, and when.
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <numbers>
#include <utility>

namespace knap {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr int max_reports = 5;  // of wrong lines in a file

std::optional<double> plain_number(const std::string& text) {
    const Quantity quantity = parse_quantity(text);
    return quantity.problem.empty() && quantity.unit.empty() ? std::optional(quantity.value) : std::nullopt;
}

/// A history from a CSV file: lines `time, factor` in seconds and without unit; a first line of names and # comments
/// are skipped. Empty where something is wrong.
TimeFunction read_factor_table(const std::filesystem::path& file, const Node& at, Findings& findings) {
    std::error_code code;
    std::ifstream in;
    if (std::filesystem::is_regular_file(file, code)) in.open(file);  // opening a pipe would wait for ever
    if (!in.is_open()) {
        findings.error("missing-file", "cannot read `" + file.string() + "`", at).note =
            "file names are relative to the scenario file";
        return {};
    }
    TimeFunction history;
    int n_reports = 0, number = 0;
    std::string line;
    const auto report = [&](const std::string& problem) {
        if (++n_reports > max_reports) return;
        findings.error("bad-csv", problem) = {.code = "bad-csv",
                                              .message = problem,
                                              .file = file.string(),
                                              .line = number,
                                              .column = 1,
                                              .length = std::max<int>(1, static_cast<int>(line.size())),
                                              .source_line = line,
                                              .hint = {},
                                              .note = "each line: time [s], factor"};
    };
    while (std::getline(in, line)) {
        ++number;
        if (line.ends_with('\r')) line.pop_back();
        const std::string content = line.substr(0, line.find('#'));
        if (content.find_first_not_of(" \t") == std::string::npos) continue;
        const std::size_t comma = content.find_first_of(",;\t");
        const std::optional<double> time = plain_number(content.substr(0, comma));
        const std::optional<double> factor =
            comma == std::string::npos ? std::nullopt : plain_number(content.substr(comma + 1));
        if (!time && number == 1) continue;  // names
        if (!time || !factor) {
            report("this line is not `time, factor`");
        } else if (!history.time.empty() && *time < history.time.back()) {
            report("the times do not ascend");
        } else {
            history.time.push_back(*time);
            history.value.push_back(*factor);
        }
    }
    if (history.time.empty() && n_reports == 0)
        findings.error("bad-csv", "`" + file.string() + "` holds no line `time, factor`", at);
    return n_reports == 0 ? history : TimeFunction{};
}

/// The history of a load or an obstacle: its ramp, table or csv.
TimeFunction read_history(const Table& table) {
    Reading& reading = table.reading();
    const std::optional<std::string> which = table.the_one({"ramp", "table", "csv"}, false);
    TimeFunction history;
    if (which == "ramp") {
        if (const auto end = table.number("ramp")) history = {{0, *end}, {0, 1}};
    } else if (which == "table") {
        for (const Vec2& point : table.points("table")) {
            history.time.push_back(point.x());
            history.value.push_back(point.y());
        }
        if (!std::ranges::is_sorted(history.time))
            table.report("out-of-range", "table", "the times of `" + table.path("table") + "` do not ascend");
    } else if (which == "csv" && table.has("csv")) {
        const std::string path = table.path("csv");
        history = read_factor_table(reading.beside.directory / table.text("csv"), reading.at(path), reading.findings);
        std::vector<Node> points;  // the resolved scenario needs no other file
        for (std::size_t i = 0; i < history.time.size(); ++i)
            points.push_back(Node::of_list({Node::of_number(history.time[i]), Node::of_number(history.value[i])}));
        if (!points.empty()) reading.values.replace(path, table.path("table"), Node::of_list(std::move(points)));
    }
    return history;
}

Selection read_selection(const Table& table) {
    Selection on;
    table.fill(on);
    const Scenario& scenario = table.reading().scenario;
    const auto& known = scenario.shape.boundary_names;
    const bool known_all = !known.empty() || scenario.given;  // else the shape is wrong, which is reported elsewhere
    if (!on.boundary.empty() && known_all && std::ranges::count(known, on.boundary) == 0)
        table.reading().unknown_name(table.path("boundary"), "boundary", on.boundary, known);
    return on;
}

bool fills_volume(Load::Kind kind) { return kind == Load::Kind::body_force || kind == Load::Kind::acceleration; }

void check_where(const Table& load, const std::string& name, Load::Kind kind) {
    const Table on = load.table("on");
    if (on.given() && !on.has()) return;
    if (fills_volume(kind) && on.given("boundary"))
        on.report("exclusive-keys", "boundary", "`" + load.path(name) + "` acts in the body, not on a boundary").note =
            "on = { box = [...] }, or no `on` for the whole body";
    if (!fills_volume(kind) && !on.given("boundary") && !on.given("box"))
        on.error("missing-key", "", "does not say where",
                 "on = \"BOUNDARY\", { box = [...] } or both; boundaries: " +
                     joined(load.reading().scenario.shape.boundary_names));
}

void read_components(const Table& table, const std::string& key, Load& load) {
    const auto components = table.items(key);
    if (components.size() != 2) return;
    for (std::size_t i = 0; i < 2; ++i)
        if (components[i]->is_number()) load.value[i] = components[i]->number;
    if (!load.value[0] && !load.value[1]) table.error("exclusive-keys", key, "prescribes nothing");
}

std::array<double, 3> read_stress(const Table& load) {
    if (const auto pressure = load.number("pressure")) return {-*pressure, -*pressure, 0};
    const auto components = load.items("stress");
    if (components.size() != 3) return {};
    return {components[0]->number, components[1]->number, components[2]->number};
}

void read_load(const Table& table) {
    constexpr std::array kinds{
        std::pair{"traction", Load::Kind::traction},     std::pair{"pressure", Load::Kind::stress},
        std::pair{"stress", Load::Kind::stress},         std::pair{"force", Load::Kind::force},
        std::pair{"velocity", Load::Kind::velocity},     std::pair{"displacement", Load::Kind::displacement},
        std::pair{"body_force", Load::Kind::body_force}, std::pair{"acceleration", Load::Kind::acceleration}};
    std::vector<Load>& loads = table.reading().scenario.loads;
    Load load{.on = read_selection(table.table("on"))};
    load.name = "load" + std::to_string(loads.size());
    table.compute("name", Node::of_text(load.name));
    table.fill(load);
    table.check_column_name("name", load.name, "a load");
    const std::optional<std::string> which = table.the_one(
        {"traction", "pressure", "stress", "force", "velocity", "displacement", "body_force", "acceleration"}, true);
    for (const auto& [name, kind] : kinds)
        if (which == name) load.kind = kind;
    if (which) {
        check_where(table, *which, load.kind);
        if (load.kind == Load::Kind::stress) load.stress = read_stress(table);
        else read_components(table, *which, load);
    }
    load.history = read_history(table);
    loads.push_back(std::move(load));
}

// ---- obstacles: what each is, how it is driven, and what is free

void read_outline(const Table& table, Obstacle& obstacle) {
    const std::string shape = table.text("shape");
    Outline& outline = obstacle.outline;
    if (shape == "half plane") {
        outline.kind = Outline::Kind::half_plane;
        obstacle.start.position = table.pair("at").value_or(Vec2::Zero());
        const Vec2 normal = table.pair("normal").value_or(Vec2(0, 1));
        if (normal.isZero(0)) table.error("out-of-range", "normal", "has no direction");
        else outline.normal = normal.normalized();
    } else if (shape == "disc") {
        outline.kind = Outline::Kind::disc;
        obstacle.start.position = table.pair("centre").value_or(Vec2::Zero());
        outline.radius = table.number("radius").value_or(1);
    } else if (shape == "polygon") {
        outline.kind = Outline::Kind::polygon;
        if (!table.has("points")) return;
        std::vector<Vec2> points = table.points("points");
        if (points.size() < 3 || !is_convex(points))
            return table.error("out-of-range", "points", "is no convex polygon",
                               "at least three corners in order; several obstacles make a shape that is not convex");
        outline.points = std::move(points);
        if (outline.area() < 0) std::ranges::reverse(outline.points);
        obstacle.start.position = centroid(outline.points);
        for (Vec2& p : outline.points) p -= obstacle.start.position;
    }
}

void read_inertia(const Table& table, Obstacle& obstacle) {
    const Outline& outline = obstacle.outline;
    const auto which = table.the_one({"mass", "density"}, false);
    const double area = outline.area(), second_moment = outline.second_moment(),
                 thickness = table.reading().scenario.thickness;
    if (which == "density" && outline.kind == Outline::Kind::half_plane)
        table
            .report("exclusive-keys", "density", "a half plane has no volume, so `" + table.path() + "` has no density")
            .note = "mass";
    if (which == "density") obstacle.mass = table.number("density").value_or(1) * thickness * area;
    if (which == "mass") obstacle.mass = table.number("mass").value_or(1);
    obstacle.inertia = area > 0 ? obstacle.mass * second_moment / area : 0;
}

void read_drives(const Table& table, const TimeFunction& history, Obstacle& obstacle) {
    const auto which = table.the_one({"velocity", "displacement"}, false);
    const bool has_mass = obstacle.mass > 0, all_free = has_mass && !which;
    const auto components = which ? table.items(*which) : std::vector<const Node*>();
    for (std::size_t k = 0; k < 2; ++k) {
        Drive& drive = obstacle.drive[k];
        if (all_free) drive.kind = Drive::Kind::free;
        if (components.size() != 2) continue;
        const Drive::Kind kind = which == "velocity" ? Drive::Kind::velocity : Drive::Kind::displacement;
        if (components[k]->is_number()) drive = {kind, components[k]->number, history};
        else drive.kind = Drive::Kind::free;
        if (drive.kind == Drive::Kind::free && !has_mass)
            table
                .report("missing-key", *which,
                        "`" + table.path() + "` is free in " + (k == 0 ? "x" : "y") + ", but has no mass")
                .note = "mass or density";
    }
    const bool turns = table.flag("turns").value_or(all_free && obstacle.inertia > 0), spins = table.given("spin");
    if (turns && spins)
        table.report("exclusive-keys", "spin",
                     "`" + table.path() + "` cannot turn freely and have its spin prescribed");
    if (turns && !(obstacle.inertia > 0))
        table.report("missing-key", "turns", "`" + table.path() + "` is free to turn, but has no moment of inertia")
            .note = "a disc or polygon with mass or density";
    if (turns) obstacle.drive[2].kind = Drive::Kind::free;
    if (spins) obstacle.drive[2] = {Drive::Kind::velocity, table.number("spin").value_or(0) * degree, history};
}

void read_free_motion(const Table& table, const TimeFunction& history, Obstacle& obstacle) {
    const auto needs_freedom = [&](const char* key, bool free) {
        if (table.given(key) && !free)
            table.error_at_name("exclusive-keys", key, "belongs to what moves freely",
                                "give it mass or density, and leave components free");
    };
    const bool moves = obstacle.is_free(0) || obstacle.is_free(1);
    needs_freedom("force", moves);
    needs_freedom("initial_velocity", moves);
    needs_freedom("initial_spin", obstacle.is_free(2));
    if (const auto force = table.pair("force")) obstacle.forces.push_back({Vec3(force->x(), force->y(), 0), history});
    obstacle.initial_velocity.head<2>() = table.pair("initial_velocity").value_or(Vec2::Zero());
    obstacle.initial_velocity.z() = table.number("initial_spin").value_or(0) * degree;
}

void read_obstacle(const Table& table) {
    std::vector<Obstacle>& obstacles = table.reading().scenario.obstacles;
    Obstacle obstacle;
    obstacle.name = "obstacle" + std::to_string(obstacles.size() + 1);
    table.compute("name", Node::of_text(obstacle.name));
    table.fill(obstacle);
    table.fill(obstacle.contact);
    const TimeFunction history = read_history(table);
    read_outline(table, obstacle);
    read_inertia(table, obstacle);
    read_drives(table, history, obstacle);
    read_free_motion(table, history, obstacle);
    table.check_column_name("name", obstacle.name, "an obstacle");
    obstacles.push_back(std::move(obstacle));
}

}  // namespace

void read_supports(Reading& reading) {
    for (const Table& table : reading.list("support")) {
        Support& support =
            reading.scenario.supports.emplace_back(Support{.on = read_selection(table.table("on"))});
        table.fill(support);
        if (support.glued && support.gap > 0)
            table.report("exclusive-keys", "gap", "`" + table.path() + "` is glued across a gap").note =
                "gap = 0, or glued = false";
    }
}

void read_loads(Reading& reading) {
    for (const Table& table : reading.list("load")) read_load(table);
    for (const Table& table : reading.list("initial")) {
        InitialVelocity initial{.on = {}, .value = Vec2::Zero()};
        table.fill(initial);
        table.fill(initial.on);
        reading.scenario.initial_velocities.push_back(initial);
    }
    for (const Table& table : reading.list("obstacle")) read_obstacle(table);
}

}  // namespace knap
