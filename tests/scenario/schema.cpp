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
        const Json* schema = &root;
        std::istringstream parts(key.path);
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

TEST_CASE("schema: an editor marks units of another kind") {
    const Json root = Json::parse(json_schema());
    const auto takes = [&](const char* kind, const std::string& text) {
        return std::regex_match(text, std::regex(root.at("$defs").at(kind).at("pattern").get<std::string>()));
    };
    for (const char* text :
         {"3 J/m2", "3J/m^2", " 3.0e0 N/m ", "3e-3 kJ/m2", "1 MPa*mm", "2 J m-2", "3", "4 kg/s2", "1 J /m2"})
        CHECK_MESSAGE(takes("J_m2", text), text);
    for (const char* text : {"3 J", "3 Jm", "3 J/m", "3 MPa", "three", "3 J/m2 x y", "3,0 J/m2", "", "J/m2"})
        CHECK_MESSAGE(takes("J_m2", text) == (std::string(text) == "3 J/m2 x y"), text);  // three factors: form alone
    CHECK(takes("m", "84 mm"));
    CHECK(takes("m", "84 m^1"));
    CHECK_FALSE(takes("m", "84 ms"));
    CHECK(takes("s", "80 us"));
    CHECK(takes("s", "3 day"));
    CHECK_FALSE(takes("s", "80 um"));
    CHECK(takes("Hz", "3 1/s"));
    CHECK(takes("Hz", "3 /s"));
    CHECK(takes("Hz", "2 s-1"));
    CHECK(takes("number", "7 %"));
    CHECK(takes("number", "1 mm/m"));
    CHECK_FALSE(takes("number", "7 mm"));
    CHECK(takes("kg_m3", "2.45 g/cm3"));
    CHECK(takes("m_s", "1 mm/ms"));
    CHECK(takes("W_m2_K", "50 W/m2/K"));
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
        if (node.type != Node::Type::text || is_word(key.words, node.text)) return;
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
