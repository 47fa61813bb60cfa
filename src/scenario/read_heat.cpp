// [heat]: temperatures, conduction, and the thermal properties of the materials.
#include "base/error.hpp"
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace knap {
namespace {

struct KindOfExchange {
    const char* key;
    HeatExchange::Kind kind;
};
constexpr KindOfExchange exchanges[] = {{"temperature", HeatExchange::Kind::temperature},
                                        {"outside", HeatExchange::Kind::convection},
                                        {"flux", HeatExchange::Kind::flux},
                                        {"source", HeatExchange::Kind::source}};

/// An error at a temperature below absolute zero, where the zero is that of degrees Celsius.
void check_physical(const Table& table, const char* key, double temperature, const Heat& heat) {
    if (heat.celsius && temperature < -273.15)
        table.error("out-of-range", key, "= " + shortest(temperature) + " C is below absolute zero, -273.15 C");
}

void read_exchange(const Table& table, Heat& heat) {
    HeatExchange exchange;
    table.fill(exchange);
    std::vector<std::string> keys;
    for (const KindOfExchange& kind : exchanges) keys.emplace_back(kind.key);
    const auto key = table.one_of(keys, true);
    exchange.history = read_history(table);
    if (key == "temperature" || key == "outside")
        check_physical(table, key->c_str(), table.number(*key).value_or(0), heat);
    for (const KindOfExchange& kind : exchanges) {
        if (key != kind.key) continue;
        exchange.kind = kind.kind;
        exchange.value = table.number(kind.key).value_or(0);
        exchange.on = read_place(table, kind.key, kind.kind == HeatExchange::Kind::source);
        const bool convects = kind.kind == HeatExchange::Kind::convection;
        if (convects && !table.given("transfer"))
            table.error("missing-key", "outside", "needs the coefficient of convection", "transfer = ...");
        if (!convects && table.given("transfer"))
            table.error("exclusive-keys", "transfer", "belongs to convection, with `outside`");
    }
    heat.exchanges.push_back(std::move(exchange));
}

constexpr const char* thermal_keys[] = {"expansion",     "expansion_table",     "conductivity", "conductivity_table",
                                        "heat_capacity", "heat_capacity_table", "latent_heat",  "freezing_range"};

/// A conductivity or heat capacity: one value, or the `bound` of the values of its table and the others as parts of it.
PropertyOverTemperature read_property(const Table& table, const std::string& key, bool needed, double& bound,
                                      double (*bound_of)(const std::vector<double>&)) {
    const std::string over_temperature = key + "_table";
    table.one_of({key, over_temperature}, false);
    if (needed && !table.given(key) && !table.given(over_temperature))
        table.error("missing-key", key, "is needed for heat.conduction", key + " = ...");
    TemperatureTable read = read_over_temperature(table, over_temperature.c_str());
    if (read.empty()) return {};
    if (std::ranges::min(read.value) <= 0) {
        table.error("out-of-range", over_temperature, "has a value that is not positive");
        return {};
    }
    bound = bound_of(read.value);
    for (double& value : read.value) value /= bound;
    return PropertyOverTemperature(std::move(read));
}

Thermal read_thermal(const Table& table, bool conduction) {
    Thermal thermal;
    table.fill(thermal);
    thermal.expansion.coefficient = table.number("expansion").value_or(0);
    table.one_of({"expansion", "expansion_table"}, false);
    TemperatureTable strain = read_over_temperature(table, "expansion_table");
    thermal.expansion.temperature = std::move(strain.temperature);
    thermal.expansion.strain = std::move(strain.value);
    const Vec2 range = table.get<Vec2>("freezing_range").value_or(Vec2(-1, 0));
    thermal.freezing_range = {range.x(), range.y()};
    if (!(range.x() < range.y()))
        table.error("out-of-range", "freezing_range", "= [from, to] must ascend", "freezing_range = [-1, 0]");
    using Values = std::vector<double>;
    thermal.conductivity_part = read_property(table, "conductivity", conduction, thermal.conductivity,
                                              [](const Values& k) { return std::ranges::max(k); });
    thermal.capacity_part = read_property(table, "heat_capacity", conduction, thermal.heat_capacity,
                                          [](const Values& c) { return std::ranges::min(c); });
    return thermal;
}

/// Lines of three or four numbers; an error names the first one that is none.
std::shared_ptr<const GridTable> read_grid(const Table& table) {
    const auto bytes = table.bytes_of("temperature");
    if (!bytes) return nullptr;
    bool is_refused = false;
    const auto refuse = [&](const std::string& problem, int number = 0) {
        table.error_in_file("bad-csv", "temperature", *bytes, number, problem,
                            "each line: x, y, temperature or x, y, t, temperature [m, s, K]");
        is_refused = true;
        return nullptr;
    };
    std::vector<std::array<double, 4>> rows;
    std::size_t n_columns = 0;
    for_each_line(*bytes, [&](int number, std::string_view line) {
        if (has_decimal_comma(line)) return refuse(decimal_comma, number), false;
        std::string content(line);
        std::ranges::replace_if(
            content, [](char c) { return c == ',' || c == ';' || c == '\t'; }, ' ');
        std::istringstream words(content);
        std::vector<double> numbers;
        bool valid = true;
        for (std::string word; words >> word;) {
            const Quantity quantity = parse_quantity(word);
            valid = valid && quantity.problem.empty() && quantity.unit.empty() && std::isfinite(quantity.value);
            numbers.push_back(quantity.value);
        }
        if (!valid && rows.empty() && number == 1) return true;  // names
        if (n_columns == 0) n_columns = numbers.size();
        if (!valid || numbers.size() != n_columns || n_columns < 3 || n_columns > 4)
            refuse("this line is not `x, y, temperature` or `x, y, t, temperature`, as all others", number);
        else rows.push_back({numbers[0], numbers[1], n_columns == 4 ? numbers[2] : 0, numbers.back()});
        return !is_refused;
    });
    if (is_refused) return nullptr;
    if (rows.empty()) return refuse("the file has no line of numbers");
    table.scenario().files.push_back({table.path("temperature"), "temperature.csv", *bytes});
    try {
        return std::make_shared<GridTable>(rows);
    } catch (const UserError& error) {
        return refuse(error.diagnostics.front().message + "; " + error.diagnostics.front().note);
    }
}

/// All temperatures of a scenario count from one zero. It is that of degrees Celsius where one of them has the unit C.
struct Zero {
    const Node *celsius = nullptr, *kelvin = nullptr;  // the first ones of each unit

    void look_at(const Node& node) {
        if (node.unit == "C" && !celsius) celsius = &node;
        if (node.is_kelvin && !kelvin) kelvin = &node;
        for (const Node& child : node.children) look_at(child);
    }
};

/// One temperature in the place of a formula: "400 C".
std::optional<Node> constant_field(const Table& table) {
    const Quantity quantity = parse_quantity(table.text("temperature"));
    if (!quantity.problem.empty() || quantity.dimension != dimension_of("K")) return std::nullopt;
    Node node = Node::of_number(quantity.value);
    node.take_place(table.reading().values.place_of(table.path("temperature")));
    if (quantity.unit == "C") node.unit = "C";
    else node.is_kelvin = true;
    return node;
}

/// Whether the scenario counts in degrees Celsius.
bool read_zero(const Table& table) {
    Zero zero;
    zero.look_at(table.reading().values.root);
    const auto constant = constant_field(table);
    if (constant) zero.look_at(*constant);
    const auto line = [](const Node& node) {
        return node.set_by.empty() ? "line " + std::to_string(node.place.line) : node.set_by;
    };
    if (zero.celsius && zero.kelvin)
        table.reading().findings.error("mixed-temperatures",
                                       "temperatures in C (" + line(*zero.celsius) + ") and in K (" +
                                           line(*zero.kelvin) + ") are mixed: all count from one zero",
                                       *zero.kelvin, "give all of them in C, or all in K (0 C = 273.15 K)");
    for (const Table& material : table.reading().list("material"))
        if (zero.kelvin && material.given("latent_heat") && !material.given("freezing_range"))
            material.error("missing-key", "latent_heat", "needs the freezing range, whose default counts from 0 C",
                           "freezing_range = [\"272.15 K\", \"273.15 K\"]");
    return zero.celsius != nullptr;
}

void read_field(const Table& table, TemperatureField& field) {
    field.history = read_history(table);
    if (!table.has("temperature")) return;
    if (const auto constant = constant_field(table)) {
        field.value = Expression(shortest(constant->number));
        return;
    }
    const std::string text = table.text("temperature");
    if (text == "frozen") {  // what is there before the state at the start is read does not matter
        field.frozen = true, field.value = Expression("0");
        return;
    }
    if (text.ends_with(".csv")) {
        field.grid = read_grid(table);
        return;
    }
    if (const auto formula = table.formula("temperature")) field.value = *formula;
}

/// Example of a table over temperature.
const char* table_example(std::string_view key) {
    return key == "expansion_table"  ? "[[0, 0], [570, 0.008], [575, 0.013]]"
           : key == "pressure_table" ? "[[-5, 5e6], [0, 0]]"
           : key == "friction_table" ? "[[-2, 0.6], [-0.5, 0.4]]"
                                     : "[[-10, 1], [-1, 0.3], [0, 0.001]]";
}

/// Keys beside temperatures that stay.
void refuse_with_frozen(Reading& reading) {
    const Table table = reading.table("heat");
    const auto refuse = [&](const char* key) {
        table.error("exclusive-keys", key, "has no meaning where temperatures are frozen",
                    "a temperature, or temperature = \"frozen\" alone");
    };
    if (table.get<bool>("conduction") == true) refuse("conduction");  // a resolved text says that there is none
    for (const char* key : {"ramp", "table", "csv", "table_period"})
        if (table.given(key)) refuse(key);
    if (!starts_from_run(reading))
        table.error("exclusive-keys", "temperature", "= \"frozen\" needs temperatures of another run",
                    "time.start = \"run:DIR@TIME\" of a run with [heat]");
}

}  // namespace

TemperatureTable read_over_temperature(const Table& table, const char* key) {
    TemperatureTable read;
    for (const Vec2& point : table.get<std::vector<Vec2>>(key).value_or(std::vector<Vec2>())) {
        read.temperature.push_back(point.x());
        read.value.push_back(point.y());
    }
    const std::vector<double>& T = read.temperature;
    if (T.size() != 1 && std::ranges::adjacent_find(T, std::greater_equal()) == T.end()) return read;
    table.error("out-of-range", key, "needs at least two pairs [temperature, value] with temperatures that ascend",
                std::string(key) + " = " + table_example(key));
    return {};
}

const char* cure_without_heat(Reading& reading) {
    return starts_from_run(reading) ? "[heat] with temperature = \"frozen\" keeps those of the other run" : "[heat]";
}

void read_heat(Reading& reading) {
    const Table table = reading.table("heat");
    if (!table.given()) {
        for (const Table& material : reading.list("material"))
            for (const char* key : thermal_keys)
                if (material.given(key)) {
                    material.warning("no-heat", key, "has no effect without [heat]");
                    break;
                }
        return;
    }
    Heat heat;
    table.fill(heat);
    heat.celsius = read_zero(table);
    check_physical(table, "reference", heat.reference, heat);
    read_field(table, heat.field);
    for (const Table& material : reading.list("material"))
        heat.materials.push_back(read_thermal(material, heat.conduction));
    for (const Table& exchange : table.list("exchange")) read_exchange(exchange, heat);
    if (!heat.exchanges.empty() && !heat.conduction)
        table.error("exclusive-keys", "exchange", "has no meaning where temperatures are prescribed",
                    "conduction = true in [heat]");
    const auto expands = [](const Thermal& m) {
        return m.expansion.coefficient != 0 || !m.expansion.temperature.empty();
    };
    const auto follows = [](const NamedLaw& named) { return named.law.of_temperature != nullptr; };
    const bool presses = std::ranges::any_of(reading.list("pressure"),
                                             [](const Table& pressure) { return pressure.given("pressure_table"); });
    if (std::ranges::none_of(heat.materials, expands) && std::ranges::none_of(reading.scenario.laws, follows) &&
        !presses)
        table.warning("no-expansion", "", "strains nothing: no material has an expansion",
                      "expansion in [material.NAME]");
    if (heat.field.frozen) {
        refuse_with_frozen(reading);
        reading.scenario.heat = std::move(heat);
        return;
    }
    const std::vector<Body>& bodies = reading.scenario.bodies;
    for (const Body& body : bodies)
        if (body.shape.outer.points.empty()) return;  // reported
    const std::shared_ptr<const MeshFile>& given = reading.scenario.given;
    const Box box = given            ? bounding_box(given->mesh.vertices)
                    : bodies.empty() ? Box{}
                                     : bounding_box(bodies.front().shape.outer.points);
    double coldest = infinity;
    for (const double t : {0.0, reading.scenario.time.end})
        for (const Vec2& place : {box.low, box.high, box.middle()}) {
            const double T = heat.field_at(place, t);
            if (!std::isfinite(T))
                return table.error("out-of-range", "temperature", "is no finite number everywhere in the body");
            coldest = std::min(coldest, T);
        }
    check_physical(table, "temperature", coldest, heat);
    reading.scenario.heat = std::move(heat);
}

}  // namespace knap
