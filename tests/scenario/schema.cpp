#include "scenario/schema.hpp"

#include "analysis/gates.hpp"
#include "record/outputs.hpp"
#include "scenario/built_in.hpp"
#include "scenario/keys.hpp"
#include "scenario/units.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <regex>
#include <sstream>

namespace schema_test {

using namespace knap;

namespace {

using Json = nlohmann::json;

/// The object schema behind lists, names and shorthands.
const Json& object(const Json& schema) {
    if (schema.contains("properties")) return schema;
    if (schema.contains("items")) return object(schema.at("items"));
    if (schema.contains("additionalProperties")) return object(schema.at("additionalProperties"));
    return object(schema.at("anyOf").at(1));
}

}  // namespace

TEST_CASE("schema: JSON Schema is JSON and has every key") {
    const Json root = Json::parse(json_schema());
    CHECK(root.at("title") == "knap scenario");
    CHECK(root.at("required") == Json{"knap", "mesh", "material", "interface", "time"});
    for (const Key& key : keys()) {
        if (key.path.ends_with(".*")) continue;
        CAPTURE(key.path);
        const bool of_expect = key.path.starts_with("expect.*.");  // whose unit follows from the name
        const Json* schema = of_expect ? &root.at("$defs").at("expected_J") : &root;
        std::istringstream parts(of_expect ? key.path.substr(9) : std::string(key.path));
        for (std::string part; std::getline(parts, part, '.');) {
            if (part == "*") continue;
            const Json& properties = object(*schema).at("properties");
            part = part.substr(0, part.find("[]"));
            REQUIRE(properties.contains(part));
            schema = &properties.at(part);
        }
        CHECK(schema->at("description").get<std::string>().starts_with(std::string(key.doc)));
    }
}

TEST_CASE("schema: an editor takes of each kind of unit what the program takes and marks the rest") {
    const Json kinds = Json::parse(json_schema()).at("$defs");
    std::map<std::string_view, std::regex> patterns;
    for (const Key& key : keys())
        for (const std::string_view unit : {key.unit, key.second_unit})
            if (key.kind == Kind::number && unit != "*" && unit != "=" && !patterns.contains(unit)) {
                std::string name(unit.empty() ? "number" : unit);
                std::ranges::replace_if(
                    name, [](unsigned char c) { return !std::isalnum(c); }, '_');
                patterns.emplace(unit, std::regex(kinds.at(name).at("pattern").get<std::string>()));
            }
    CHECK(patterns.size() > 15);
    std::map<std::string_view, int> n_good;
    for (const char* text :
         {"3",       " +3.0e0 ",  "-.5",         "7 %",        "1 mm/m",       "MPa",        "three",      "",
          "3,0 m",   "+-3 m",     "--3 m",       "84 mm",      "-84 mm",       "84 m^1",     "84 ms",      "84 Mmm",
          "2 m2",    "2 cm^2",    "2 m*mm",      "2 m m",      "3 kg",         "3 t",        "80 us",      "80 \u00b5s",
          "3 day",   "3 1/s",     "3 /s",        "2 s-1",      "5 kHz",        "1 %/s",      "1 %/day",    "90 deg",
          "1 rad",   "90 deg/s",  "1 mm/ms",     "1 m s-1",    "2 km/h",       "9.81 m/s2",  "9.81 m/s/s", "9.81 N/kg",
          "3 N",     "3 kg m/s2", "3 kg*m*s^-2", "3 J/m",      "32 GPa",       "32 N/mm2",   "32 kg/m/s2", "1 bar",
          "3 J",     "3 N m",     "3 kg m2/s2",  "3 J/m2",     "3J/m^2",       "3 N/m",      "3e-3 kJ/m2", "1 MPa*mm",
          "2 J m-2", "4 kg/s2",   "1 J /m2",     "3 W s/m2",   "3 J/m/m",      "3 Jm",       "3 J/m2 x",   "3 J/m2 x y",
          "J/m2",    "25 kN/m3",  "2.45 g/cm3",  "2450 kg/m3", "2450 kg/m2",   "-10 C",      "263 K",      "1e-5 1/K",
          "1e-5 /K", "2 W/m/K",   "2 W/m K",     "2 W/m2/K",   "50 W m-2 K-1", "800 J/kg/K", "334 kJ/kg",  "100 W/m2",
          "3 W/m3",  "0.4 cR",    "20 CFL",      "20 cfl",     "1e-9 m2/Pa",   "2 m2/s"}) {
        const Quantity read = parse_quantity(text);
        CAPTURE(text);
        for (const auto& [unit, pattern] : patterns) {
            CAPTURE(unit);
            const bool is_good = read.problem.empty() && read.dimension == dimension_of(unit);
            CHECK(std::regex_match(text, pattern) == is_good);
            n_good[unit] += is_good;
        }
    }
    for (const auto& [unit, n] : n_good) CHECK_MESSAGE(n > 0, unit);
}

TEST_CASE("schema: an editor marks texts that the program refuses") {
    const Json root = Json::parse(json_schema());
    const std::function<bool(const Json&, const std::string&)> takes = [&](const Json& schema,
                                                                           const std::string& text) {
        const auto it_takes = [&](const Json& part) { return takes(part, text); };
        const auto matches = [&](const Json& of) {
            return std::regex_search(text, std::regex(of.at("pattern").get<std::string>()));
        };
        if (schema.contains("$ref") && !it_takes(root.at("$defs").at(schema.at("$ref").get<std::string>().substr(8))))
            return false;
        if (schema.contains("anyOf") && std::ranges::none_of(schema.at("anyOf"), it_takes)) return false;
        if (schema.contains("allOf") && !std::ranges::all_of(schema.at("allOf"), it_takes)) return false;
        if (schema.contains("enum") && std::ranges::count(schema.at("enum"), Json(text)) == 0) return false;
        if (schema.contains("not") && matches(schema.at("not"))) return false;
        return schema.value("type", "string") == "string" && (!schema.contains("pattern") || matches(schema));
    };
    const auto members = [](const Json& of, const char* key) { return object(of.at(key)).at("properties"); };
    const Json of = root.at("properties"), law = members(of, "interface"), load = members(of, "load");
    const auto expected = [&](const char* name) {
        const std::string kind = of.at("expect").at("properties").at(name).at("$ref");
        return root.at("$defs").at(kind.substr(8)).at("properties").at("value");
    };
    const auto component = [](const Json& of_three) { return of_three.at("anyOf").at(0).at("items"); };
    const struct {
        const char* what;
        Json schema;
        std::vector<const char*> good, bad;
    } cases[] = {
        {"a length by the name of a result", expected("broken_length"), {"80 mm", "0.4 cR"}, {"80 mJ", "80 us", "80"}},
        {"an energy by the name of a result", expected("dissipated"), {"3 mJ", "-3 N m"}, {"3 J/m2", "3 mm"}},
        {"greater than 0",
         law.at("G_c"),
         {"3 J/m2", "+3 J/m2", "0.03 J/m2", ".5 J/m2", "00.10e-3 kJ/m2"},
         {"-3 J/m2", "0 J/m2", "0.0e5 J/m2", "3", "3 J", "three"}},
        {"at least 0", law.at("friction"), {"0 %", "0.3"}, {"-1 %", "1 deg"}},
        {"a temperature", members(of, "heat").at("reference"), {"-10 C", "263 K"}, {"-10", "3 J"}},
        {"a temperature or a formula or a file",
         members(of, "heat").at("temperature"),
         {"400 K", "-5C", "20", "20 + 300*exp(-x/0.01)", "1e2*x", "-.5*y", "map.csv", "frozen"},
         {"400 kg", "4e2m"}},
        {"a stress or a formula",
         component(load.at("traction")),
         {"3 MPa", "-1e6*x", "-0.027*(100 - y) MPa", "2e6", "exp(-t) kPa"},
         {"3 J", "3J", "1e3 m", "3 %", "1 MPa*x", "2x"}},
        {"a stress around the body", component(load.at("stress")), {"-20 MPa", "1e6*y"}, {"-20 m", "20 J/m2"}},
        {"a stress of the undeformed body",
         component(members(of, "initial").at("stress")),
         {"-20 MPa", "y MPa"},
         {"3 J"}},
        {"a file in place of three stresses",
         members(of, "initial").at("stress"),
         {"stress.csv"},
         {"stress.txt", "3 MPa"}},
        {"a pressure",
         members(of, "pressure").at("pressure"),
         {"3 MPa", "2e6*exp(-x/0.1) + 1e9*t", "1e6", "p.csv"},
         {"3 J", "1 m"}},
        {"a picture",
         members(of, "figure").at("file"),
         {"c.png", "a b.svg", "c.pdf", "c.webp", "c.gif", "c.mp4"},
         {"c.jpeg", "c.jpg", "c.PNG", "cpng", ".png", "c.png.bak"}},
    };
    for (const auto& [what, schema, good, bad] : cases) {
        CAPTURE(what);
        for (const char* text : good) CHECK_MESSAGE(takes(schema, text), text);
        for (const char* text : bad) CHECK_MESSAGE(!takes(schema, text), text);
    }
    CHECK(members(of, "toughness").at("meaning").at("enum") ==
          of.at("toughness").at("anyOf").at(0).at("enum"));  // of toughness = "as measured"
}

TEST_CASE("schema: an editor marks a crack with one point and a hole with two") {
    const Json domain = object(Json::parse(json_schema()).at("properties").at("domain")).at("properties");
    CHECK(object(domain.at("crack")).at("properties").at("points").at("minItems") == 2);
    CHECK(object(domain.at("hole")).at("properties").at("points").at("minItems") == 3);
}

TEST_CASE("schema: every quantity of the built-in scenarios has the pattern of its unit") {
    std::map<std::string_view, std::regex> patterns;
    const auto fits = [&](std::string_view unit, const std::string& text) {
        if (unit == "*" || unit == "=") return unit == "*";
        if (!patterns.contains(unit)) patterns.emplace(unit, std::regex(quantity_pattern(unit)));
        return std::regex_match(text, patterns.at(unit));
    };
    int n = 0;
    const std::function<void(const Key&, const Node&)> check = [&](const Key& key, const Node& node) {
        for (const Node& child : node.children) check(key, child);
        if (node.type != Node::Type::text || is_word(key.words, node.text) || key.takes_formulas) return;
        CAPTURE(key.path);
        CAPTURE(node.text);
        ++n;
        CHECK((fits(key.unit, node.text) || fits(key.second_unit, node.text) ||
               std::ranges::any_of(key.multiples, [&](const auto& unit) { return fits(unit, node.text); })));
    };
    const std::function<void(const Node&, const std::string&)> walk = [&](const Node& node, const std::string& path) {
        const Key* const key = path.empty() ? nullptr : key_at(path);
        if (key && key->kind == Kind::number) return check(*key, node);
        if (key && !key->is_table()) return;
        for (std::size_t i = 0; i < node.children.size(); ++i) {
            const Node& child = node.children[i];
            walk(child,
                 node.type == Node::Type::array ? path + "[" + std::to_string(i) + "]" : joined_path(path, child.name));
        }
    };
    for (const BuiltIn& scenario : built_ins()) {
        CAPTURE(scenario.name);
        Node root;
        REQUIRE_FALSE(parse_toml(scenario.text, root));
        walk(root, "");
    }
    CHECK(n > 500);
}

TEST_CASE("schema: text and Markdown name every key") {
    const std::string text = schema_text(), markdown = schema_markdown();
    for (const Key& key : keys()) {
        CAPTURE(std::string(key.path));
        CHECK(text.find(std::string(key.doc)) != std::string::npos);
        CHECK(text.find(key.path.ends_with("*") ? "NAME]" : std::string(key.name())) != std::string::npos);
    }
    for (const char* row : {"| `domain.size` |", "## `[[load]]`\n", "## `[material.NAME]`\n", "| `[[domain.crack]]` |",
                            "| `expect.*.below` |"})
        CHECK(markdown.find(row) != std::string::npos);
    for (const Output& row : output_table("summary").rows) CHECK(text.find(std::string(row.name)) != std::string::npos);
}

TEST_CASE("schema: every block has a section with an anchor and an example of its own") {
    const std::string markdown = schema_markdown();
    for (const Key* block : keys_below("")) {
        if (!block->is_table()) continue;
        const std::string name(block->name());
        CAPTURE(name);
        const std::size_t begin = markdown.find("<a id=\"" + name + "\"></a>");
        REQUIRE(begin != std::string::npos);
        const std::string section = markdown.substr(begin, markdown.find("<a id", begin + 1) - begin);
        CHECK(section.find(block->kind == Kind::list ? "\n    [[" + name + "]]\n" : "\n    [" + name) !=
              std::string::npos);
        CHECK(section.find("| `" + name) != std::string::npos);
        CHECK(markdown.find("](#" + name + ")") < begin);
    }
}

TEST_CASE("schema: there is a key for every gate that a scenario may move and for no other") {
    std::size_t n = 0;
    for (const GateRule& rule : gate_rules()) {
        const Key* key = find_key("limits." + std::string(rule.name));
        CAPTURE(std::string(rule.name));
        REQUIRE((key != nullptr) == rule.allowed);
        if (key == nullptr) continue;
        ++n;
        CHECK(key->unit == rule.unit);
        CHECK(key->words == std::vector<std::string>{"none"});
    }
    CHECK(keys_below("limits").size() == n);
}

}  // namespace schema_test
