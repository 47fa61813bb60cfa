#include "scenario/schema.hpp"

#include "analysis/gates.hpp"
#include "record/outputs.hpp"
#include "scenario/keys.hpp"

#include <doctest/doctest.h>

#include <cctype>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

using namespace knap;

namespace {

/// A small JSON reader: throws on anything that is not JSON, and knows the members of objects.
struct Json {
    std::map<std::string, Json> members;
    std::vector<Json> items;
    std::string text;
};

class Reader {
public:
    explicit Reader(const std::string& text) : text_(text) {}
    Json whole() {
        Json value = one();
        space();
        if (at_ != text_.size()) throw std::runtime_error("more after the end");
        return value;
    }

private:
    void space() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    }
    char next() {
        space();
        return text_.at(at_);
    }
    void take(char c) {
        if (next() != c) throw std::runtime_error("expected " + std::string(1, c) + " at " + std::to_string(at_));
        ++at_;
    }
    std::string string() {
        take('"');
        std::string out;
        for (; text_.at(at_) != '"'; ++at_) {
            if (static_cast<unsigned char>(text_[at_]) < 0x20) throw std::runtime_error("control character");
            if (text_[at_] == '\\') ++at_;
            out += text_.at(at_);
        }
        ++at_;
        return out;
    }
    Json one() {
        Json value;
        switch (next()) {
            case '{':
                ++at_;
                for (bool first = true; next() != '}'; first = false) {
                    if (!first) take(',');
                    const std::string name = string();
                    take(':');
                    if (!value.members.emplace(name, one()).second) throw std::runtime_error("twice: " + name);
                }
                ++at_;
                return value;
            case '[':
                ++at_;
                for (bool first = true; next() != ']'; first = false) {
                    if (!first) take(',');
                    value.items.push_back(one());
                }
                ++at_;
                return value;
            case '"': value.text = string(); return value;
            default: break;
        }
        for (const char* word : {"true", "false", "null"})
            if (text_.compare(at_, std::string(word).size(), word) == 0) {
                value.text = word;
                at_ += value.text.size();
                return value;
            }
        std::size_t length = 0;
        std::stod(text_.substr(at_), &length);
        value.text = text_.substr(at_, length);
        at_ += length;
        return value;
    }

    const std::string& text_;
    std::size_t at_ = 0;
};

/// The object schema behind lists, names and shorthands.
const Json& object(const Json& schema) {
    if (schema.members.contains("properties")) return schema;
    if (schema.members.contains("items")) return object(schema.members.at("items"));
    if (schema.members.contains("additionalProperties")) return object(schema.members.at("additionalProperties"));
    return object(schema.members.at("anyOf").items.at(1));
}

}  // namespace

TEST_CASE("schema: JSON Schema is JSON and has every key") {
    const std::string text = json_schema();
    const Json root = Reader(text).whole();
    CHECK(root.members.at("title").text == "knap scenario");
    for (const Key& key : keys()) {
        const std::string path(key.path);
        if (path.ends_with(".*")) continue;
        CAPTURE(path);
        const Json* schema = &root;
        std::size_t begin = 0;
        while (begin <= path.size()) {
            const std::size_t dot = std::min(path.find('.', begin), path.size());
            std::string part = path.substr(begin, dot - begin);
            if (part.ends_with("[]")) part.resize(part.size() - 2);
            if (part != "*") {
                const Json& table = object(*schema);
                REQUIRE(table.members.at("properties").members.contains(part));
                schema = &table.members.at("properties").members.at(part);
            }
            begin = dot + 1;
        }
        CHECK(schema->members.at("description").text.starts_with(std::string(key.doc)));
    }
}

TEST_CASE("schema: text and Markdown name every key") {
    const std::string text = schema_text(), markdown = schema_markdown();
    for (const Key& key : keys()) {
        CAPTURE(std::string(key.path));
        CHECK(text.find(std::string(key.doc)) != std::string::npos);
        CHECK(text.find(key.path.ends_with("*") ? "NAME]" : std::string(key.name())) != std::string::npos);
    }
    for (const char* row : {"| `domain.size` |", "## `[[load]]`\n", "## `[material.NAME]`\n", "| `[[domain.crack]]` |", "| `expect.*.below` |"})
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
        CHECK(section.find(block->kind == Kind::list ? "\n    [[" + name + "]]\n" : "\n    [" + name) != std::string::npos);
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
