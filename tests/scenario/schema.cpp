#include "scenario/schema.hpp"

#include "analysis/gates.hpp"
#include "record/outputs.hpp"
#include "scenario/keys.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

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
