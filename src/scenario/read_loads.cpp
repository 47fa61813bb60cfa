// [[support]], [[load]], [[pressure]], [[initial]] and [[obstacle]]: place, value and history of what acts on the body.
#include "base/formatted.hpp"
#include "scenario/reading.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The points of `table` or `csv` again and again up to time.end. Where they end before their period, the last value
/// stays until its end. `has_points`: they are given, though there are none after an error.
void repeat(const Table& table, bool has_points, TimeFunction& history) {
    constexpr double max_points = 2e5;
    if (!table.has("table_period")) return;
    const double period = *table.number("table_period"), end = table.reading().table("time").number("end").value_or(0);
    const TimeFunction once = history;
    if (!has_points)
        return table.error("missing-key", "table_period", "belongs to the points of a table", "table or csv");
    if (once.time.empty()) return;
    if (once.time.front() < 0 || once.time.back() > period * (1 + 1e-12))
        return table.error("out-of-range", "table_period",
                           "= " + readable(period, "s", 6) + ", but the table has times from " +
                               readable(once.time.front(), "s", 6) + " to " + readable(once.time.back(), "s", 6),
                           "times from 0 to the period");
    const double n = std::ceil(end / period);
    if (n * static_cast<double>(once.time.size() + 1) > max_points)
        return table.error("out-of-range", "table_period",
                           "= " + readable(period, "s", 6) + formatted(" repeats %.3g times until time.end", n),
                           formatted("a run keeps at most %.0f points of a table", max_points));
    const auto add = [&](double time, double value) {
        if (history.time.empty() || history.time.back() != time || history.value.back() != value)
            history.time.push_back(time), history.value.push_back(value);
    };
    history = {};
    for (double k = 0; k < n; ++k) {
        if (k > 0) add(k * period, once.value.back()), add(k * period, once.value.front());
        for (std::size_t i = 0; i < once.time.size(); ++i) add(k * period + once.time[i], once.value[i]);
    }
}

}  // namespace

TimeFunction read_history(const Table& table) {
    const auto form = table.one_of({"ramp", "table", "csv"}, false);
    const bool has_points = table.given("table") || table.given("csv");
    TimeFunction history;
    if (form == "ramp" && table.has("ramp")) history = {{0, *table.number("ramp")}, {0, 1}};
    if (form == "table") {
        for (const Vec2& point : table.get<std::vector<Vec2>>("table").value_or(std::vector<Vec2>())) {
            history.time.push_back(point.x());
            history.value.push_back(point.y());
        }
        if (!std::ranges::is_sorted(history.time)) table.error("out-of-range", "table", "has times that do not ascend");
    }
    if (form == "csv" && table.has("csv"))
        for (const Vec2& point : read_pairs(
                 table, {.line = "time, factor",
                        .first = "times",
                        .note = "each line: time, factor, with a line of names `time [us], factor` or times in s",
                        .first_unit = "s"})) {
            history.time.push_back(point.x());
            history.value.push_back(point.y());
        }
    repeat(table, has_points, history);
    return history;
}

namespace {

void check_body(const Table& table, const Selection& on) {
    if (!on.body.empty()) table.reading().find(table.path("body"), "body", on.body, table.scenario().body_names());
}

/// Boundaries of a body or a group of bodies, by full names and by those within the body: for `wall`, `wall.left` and
/// `left`.
std::vector<std::string> boundaries_of(const Scenario& scenario, const std::string& name) {
    std::vector<std::string> full, among;
    const auto add = [&](const Body& body) {
        for (const std::string& boundary : body.shape.boundary_names) {
            full.push_back(boundary);
            const std::string own = boundary.substr(boundary.find('.') + 1);
            if (std::ranges::find(among, own) == among.end()) among.push_back(own);
        }
    };
    for (const Body& body : scenario.bodies)
        if (body.name == name) add(body);
    for (const BodyGroup& group : scenario.groups)
        for (std::size_t b = group.first; group.name == name && b < group.first + group.n; ++b) add(scenario.bodies[b]);
    among.insert(among.end(), full.begin(), full.end());
    return among;
}

}  // namespace

Selection read_selection(const Table& table) {
    Selection on;
    table.fill(on);
    check_body(table, on);
    const Scenario& scenario = table.scenario();
    std::vector<std::string> known = scenario.boundary_names();
    const std::vector<std::string> bodies = scenario.body_names();
    const bool shape_is_known = !known.empty() || scenario.given;  // otherwise the shape has an error
    if (std::vector<std::string> own = boundaries_of(scenario, on.body); !on.body.empty() && !own.empty())
        known = std::move(own);
    if (on.boundary.empty() || !shape_is_known) return on;
    if (std::ranges::count(bodies, on.boundary) > 0)
        table.error("unknown-name", "boundary", "= \"" + on.boundary + "\" is a body, not a boundary",
                    "on = { body = \"" + on.boundary + "\" }, or one of its boundaries, as \"NAME.left\"");
    else if (const std::string group = on.boundary.substr(0, on.boundary.find('.'));
             on.body.empty() && group != on.boundary && std::ranges::count(known, on.boundary) == 0 &&
             std::ranges::count(scenario.groups, group, &BodyGroup::name) > 0)
        table.error("unknown-name", "boundary", "= \"" + on.boundary + "\": `" + group + "` is a group of bodies",
                    "on = { body = \"" + group + "\", boundary = \"" + on.boundary.substr(group.size() + 1) + "\" }");
    else table.reading().find(table.path("boundary"), "boundary", on.boundary, known);
    return on;
}

Selection read_place(const Table& entry, const std::string& what, bool in_volume) {
    const Table on = entry.table("on");
    if (entry.given("on") && !entry.has("on")) return {};  // it has an error
    if (in_volume && on.given("boundary"))
        entry.error("exclusive-keys", "on", "names a boundary, but " + what + " acts in the body",
                    "on = { box = [...] }, or no `on` for the whole body");
    if (!in_volume && !on.given("boundary") && !on.given("box") && !on.given("body"))
        entry.error("missing-key", "on", "names no boundary, box or body",
                    "on = \"BOUNDARY\", { box = [...] }, { body = \"NAME\" } or several of them; boundaries: " +
                        first_of(entry.scenario().boundary_names()));
    return read_selection(on);
}

namespace {

struct KindOfLoad {
    const char* key;
    Load::Kind kind;
    bool in_volume = false;
};
constexpr KindOfLoad kinds_of_load[] = {{"traction", Load::Kind::traction},
                                        {"pressure", Load::Kind::stress},
                                        {"stress", Load::Kind::stress},
                                        {"force", Load::Kind::force},
                                        {"velocity", Load::Kind::velocity},
                                        {"displacement", Load::Kind::displacement},
                                        {"body_force", Load::Kind::body_force, true},
                                        {"acceleration", Load::Kind::acceleration, true}};

void read_load(const Table& table) {
    std::vector<Load>& loads = table.scenario().loads;
    Load load{.name = "load" + std::to_string(loads.size())};
    table.compute("name", Node::of_text(load.name));
    table.fill(load);
    table.check_column_name(load.name);
    std::vector<std::string> keys;
    for (const KindOfLoad& kind : kinds_of_load) keys.emplace_back(kind.key);
    const auto key = table.one_of(keys, true);
    for (const KindOfLoad& kind : kinds_of_load) {
        if (key != kind.key) continue;
        load.kind = kind.kind;
        load.on = read_place(table, kind.key, kind.in_volume);
        if (const auto pressure = table.number("pressure")) load.stress = {-*pressure, -*pressure, 0};
        load.field = key == "traction"   ? read_place_field(table, *key, {"tx", "ty"})
                     : key == "stress"   ? read_place_field(table, *key, {"xx", "yy", "xy"})
                     : key == "pressure" ? read_place_field(table, *key, {"p"})
                                         : nullptr;
        if (load.field || !table.text(*key).empty()) continue;
        if (const auto stress = table.get<std::array<double, 3>>("stress")) load.stress = *stress;
        const std::vector<Node> components = table.items(kind.key);
        if (load.kind == Load::Kind::stress || components.size() != 2) continue;
        for (std::size_t i = 0; i < 2; ++i) load.value[i] = value_as<double>(components[i]);
        if (!load.value[0] && !load.value[1]) table.error("exclusive-keys", *key, "prescribes nothing");
    }
    load.history = read_history(table);
    loads.push_back(std::move(load));
}

// ---- obstacles: outline, inertia, prescribed and free components

void read_outline(const Table& table, Obstacle& obstacle) {
    const std::string shape = table.text("shape");
    Outline& outline = obstacle.outline;
    table.fill(outline);
    if (shape == "half plane") {
        outline.kind = Outline::Kind::half_plane;
        obstacle.start.position = table.get<Vec2>("at").value_or(Vec2::Zero());
        const Vec2 normal = table.get<Vec2>("normal").value_or(Vec2(0, 1));
        if (normal.isZero(0)) table.error("out-of-range", "normal", "has no direction");
        else outline.normal = normal.normalized();
    } else if (shape == "disc") {
        outline.kind = Outline::Kind::disc;
        obstacle.start.position = table.get<Vec2>("centre").value_or(Vec2::Zero());
    } else if (shape == "polygon") {
        outline.kind = Outline::Kind::polygon;
        auto points = table.get<std::vector<Vec2>>("points");
        if (!table.given("points")) table.error("missing-key", "points", "is missing");
        if (!points) return;
        if (points->size() < 3 || !is_convex(*points))
            return table.error("out-of-range", "points", "is no convex polygon",
                               "at least three corners in order; a shape that is not convex needs several obstacles");
        outline.points = std::move(*points);
        if (outline.area() < 0) std::ranges::reverse(outline.points);
        obstacle.start.position = centroid(outline.points);
        for (Vec2& p : outline.points) p -= obstacle.start.position;
    } else if (shape == "polyline") {
        read_polyline(table, obstacle);
    }
}

void read_inertia(const Table& table, Obstacle& obstacle) {
    const Outline& outline = obstacle.outline;
    const auto key = table.one_of({"mass", "density"}, false);
    if (key && table.text("shape") == "polyline")
        return table.error("exclusive-keys", *key,
                           "belongs to an obstacle that may be free; an open polyline is fixed or driven",
                           "a polygon, or a [[body]]");
    const double area = outline.area(), value = key ? table.number(*key).value_or(1) : 0;
    if (key == "density" && outline.kind == Outline::Kind::half_plane)
        table.error("exclusive-keys", "density", "belongs to a disc or polygon; a half plane has no volume", "mass");
    obstacle.mass = key == "density" ? value * table.scenario().thickness * area : value;
    obstacle.inertia = area > 0 ? obstacle.mass * outline.second_moment() / area : 0;
}

void read_drives(const Table& table, const TimeFunction& history, Obstacle& obstacle) {
    const auto key = table.one_of({"velocity", "displacement"}, false);
    const bool has_mass = obstacle.mass > 0, all_free = has_mass && !key;
    const std::vector<Node> components = key ? table.items(*key) : std::vector<Node>();
    for (std::size_t k = 0; k < 2; ++k) {
        Drive& drive = obstacle.drive[k];
        if (all_free) drive.kind = Drive::Kind::free;
        if (components.size() != 2) continue;
        const Drive::Kind kind = key == "velocity" ? Drive::Kind::velocity : Drive::Kind::displacement;
        if (components[k].is_number()) drive = {kind, components[k].number, history};
        else drive.kind = Drive::Kind::free;
        if (drive.kind == Drive::Kind::free && !has_mass)
            table.error("missing-key", *key, std::string("is free in ") + "xy"[k] + ", but has no mass",
                        "mass or density");
    }
    const bool turns = table.get<bool>("turns").value_or(all_free && obstacle.inertia > 0);
    if (turns && table.given("spin"))
        table.error("exclusive-keys", "spin", "is prescribed, so that the obstacle cannot turn freely");
    if (turns && !(obstacle.inertia > 0))
        table.error("missing-key", "turns", "needs inertia, and there is no moment of inertia",
                    "a disc or polygon with mass or density");
    if (turns) obstacle.drive[2].kind = Drive::Kind::free;
    if (table.given("spin"))
        obstacle.drive[2] = {Drive::Kind::velocity, table.number("spin").value_or(0) * degree, history};
}

void read_free_motion(const Table& table, const TimeFunction& history, Obstacle& obstacle) {
    const bool moves = obstacle.is_free(0) || obstacle.is_free(1);
    for (const auto& [key, free] :
         {std::pair{"force", moves}, {"initial_velocity", moves}, {"initial_spin", obstacle.is_free(2)}})
        if (table.given(key) && !free)
            table.error("exclusive-keys", key, "belongs to an obstacle that moves freely",
                        "give it mass or density, and leave components free");
    if (const auto force = table.get<Vec2>("force"))
        obstacle.forces.push_back({Vec3(force->x(), force->y(), 0), history});
    obstacle.initial_velocity.head<2>() = table.get<Vec2>("initial_velocity").value_or(Vec2::Zero());
    obstacle.initial_velocity.z() = table.number("initial_spin").value_or(0) * degree;
}

void read_obstacle(const Table& table) {
    std::vector<Obstacle>& obstacles = table.scenario().obstacles;
    Obstacle obstacle;
    obstacle.name = "obstacle" + std::to_string(obstacles.size() + 1);
    table.compute("name", Node::of_text(obstacle.name));
    table.fill(obstacle);
    read_contact_law(table, obstacle.contact);
    read_outline(table, obstacle);  // first: csv of a polyline has its points, and stays only after an error
    obstacle.start.angle = table.number("angle").value_or(0) * degree;
    const Vec2 shift = table.get<Vec2>("shift").value_or(Vec2::Zero());
    obstacle.start.position += shift;
    for (SurfaceRange& range : obstacle.ranges) range.from += shift.x(), range.to += shift.x();
    const bool has_bad_points = table.text("shape") == "polyline" && table.given("csv");
    const TimeFunction history = has_bad_points ? TimeFunction() : read_history(table);
    read_inertia(table, obstacle);
    read_drives(table, history, obstacle);
    read_free_motion(table, history, obstacle);
    table.check_column_name(obstacle.name);
    obstacles.push_back(std::move(obstacle));
}

}  // namespace

void read_supports(Reading& reading) {
    for (const Table& table : reading.list("support")) {
        Support& support = reading.scenario.supports.emplace_back(
            Support{.on = read_place(table, "a support"), .law = -1});  // set by read_laws
        table.fill(support);
        if (support.glued && support.gap > 0)
            table.error("exclusive-keys", "gap", "belongs to a support that is not glued", "gap = 0, or glued = false");
    }
}

namespace {

/// How the pressure of a fluid follows.
void read_pressure(const Table& table, CrackPressure& pressure) {
    Reading& reading = table.reading();
    if (table.given("name")) table.check_column_name(pressure.name);
    const bool has_gradient = table.given("gradient");
    const auto form = table.one_of({"pressure", "pressure_table", "rate"}, !has_gradient);
    if (!has_gradient && !table.given("level")) table.leave_out("level");
    else if (!has_gradient) table.error("missing-key", "level", "belongs to a gradient", "gradient = \"9810 Pa/m\"");
    if ((form == "rate") != table.given("storage"))
        table.error("missing-key", form == "rate" ? "rate" : "storage", "belong together: rate and storage",
                    "storage = \"4.5e-12 m2/Pa\": compressibility times volume of the fluid, per thickness");
    if (form == "pressure") pressure.field = read_place_field(table, "pressure", {"p"});
    if (form != "rate") return;
    const char* cure = "pressure in the place of rate";
    const auto exclude = [&](bool is_there, const char* other) {
        if (is_there) table.exclude("rate", "[[pressure]] rate", other, cure);
    };
    exclude(reading.table("contact").given(), "[contact]");
    exclude(!reading.list("excavation").empty(), "[[excavation]]");
    exclude(starts_from_run(reading), "start = \"run:DIR@TIME\"");
}

}  // namespace

void read_pressures(Reading& reading) {
    for (const Table& table : reading.list("pressure")) {
        Scenario& scenario = reading.scenario;
        CrackPressure pressure;
        table.fill(pressure);
        read_pressure(table, pressure);
        pressure.over_temperature = read_over_temperature(table, "pressure_table");
        if (table.given("pressure_table") && !reading.table("heat").given())
            table.error("no-heat", "pressure_table", "needs temperatures", cure_without_heat(reading));
        if (table.given("from")) pressure.from = read_selection(table.table("from"));
        if (const auto name = table.get<std::string>("joints"); name && table.has("joints")) {
            std::vector<std::string> known;
            for (const Index law : scenario.law_of_joint) known.push_back(law < 0 ? "" : scenario.laws[law].name);
            if (reading.find(table.path("joints"), "interface law of a joint set", *name, known))
                pressure.joint_law = scenario.law_of_joint[std::ranges::find(known, *name) - known.begin()];
        }
        pressure.history = read_history(table);
        if (pressure.name.empty()) pressure.name = "fluid" + std::to_string(scenario.crack_pressures.size());
        const auto pulls = [](const std::vector<double>& values) {
            return !values.empty() && std::ranges::min(values) < 0;
        };
        if (pressure.pressure < 0 || pulls(pressure.over_temperature.value) || pulls(pressure.history.value))
            table.warning("implausible", "", "is negative at times: it draws the faces of cracks together",
                          "a fluid presses with a positive value; the value is used as given");
        scenario.crack_pressures.push_back(pressure);
    }
}

namespace {

void read_initial(const Table& table) {
    InitialVelocity velocity{.on = {}, .value = Vec2::Zero()};
    table.fill(velocity);
    table.fill(velocity.on);
    check_body(table, velocity.on);
    const bool moves = std::ranges::any_of(keys_of_initial_motion, [&](const char* key) { return table.given(key); });
    if (!moves && !table.given("stress"))
        table.error("missing-key", "", "has no velocity, spin, strain_rate or stress", "one or more of them");
    if (moves) table.scenario().initial_velocities.push_back(velocity);
    if (!table.has("stress")) return;
    const auto field = read_place_field(table, "stress", {"xx", "yy", "xy"}, true);
    if (!field) return;
    if (field->depends_on_time())
        table.error("bad-formula", "stress", "depends on t, and the stress of the undeformed body does not",
                    "a formula of x and y; a [[load]] may change over time");
    table.scenario().initial_stresses.push_back({.on = velocity.on, .field = *field});
}

}  // namespace

void read_loads(Reading& reading) {
    for (const Table& table : reading.list("load")) read_load(table);
    for (const Table& table : reading.list("initial")) read_initial(table);
    for (const Table& table : reading.list("obstacle")) read_obstacle(table);
    for (const Table& table : reading.list("absorb"))
        reading.scenario.time.scheme.absorbing.push_back(read_place(table, "an absorbing boundary"));
}

}  // namespace knap
