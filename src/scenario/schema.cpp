#include "scenario/schema.hpp"

#include <cmath>

#include "observe/outputs.hpp"
#include "scenario/check_value.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

/// "default 0.8", "required", ... and what the range is.
std::string conditions(const Key& key) {
    std::vector<std::string> parts;
    if (const std::string when = key.condition.text(); !when.empty()) parts.push_back("only with " + when);
    if (key.is_required) parts.emplace_back("required");
    if (!key.range.text().empty()) parts.push_back(key.range.text());
    if (!key.default_toml.empty()) parts.push_back("default " + key.default_toml);
    if (!key.default_doc.empty()) parts.push_back("default: " + std::string(key.default_doc));
    return joined(parts, "; ");
}

std::string header(const Key& key) {
    std::string path(key.path);
    if (key.kind != Kind::list) {
        if (path.ends_with(".*")) path.replace(path.size() - 1, 1, "NAME");
        return "[" + path + "]";
    }
    return "[[" + path.substr(0, path.size() - 2) + "]]";
}

// ---- JSON

std::string json_words(const std::vector<std::string>& words) {
    std::string list, endings;
    for (const std::string& word : words)
        if (word.starts_with('*')) endings += (endings.empty() ? "" : "|") + word.substr(1);
        else list += (list.empty() ? "" : ", ") + toml_quoted(word);
    const std::string exact = "{\"enum\": [" + list + "]}";
    return endings.empty() ? exact
                           : "{\"anyOf\": [" + exact +
                                 ", {\"type\": \"string\", \"pattern\": " + toml_quoted(".(" + endings + ")$") + "}]}";
}

std::string json_range(const Range& range) {
    std::string text;
    if (std::isfinite(range.low))
        text +=
            std::string(", \"") + (range.low_included ? "minimum" : "exclusiveMinimum") + "\": " + shortest(range.low);
    if (std::isfinite(range.high))
        text += std::string(", \"") + (range.high_included ? "maximum" : "exclusiveMaximum") +
                "\": " + shortest(range.high);
    return text;
}

std::string json_scalar(const Key& key) {
    switch (key.kind) {
        case Kind::boolean: return "{\"type\": \"boolean\"}";
        case Kind::integer: return "{\"type\": \"integer\"" + json_range(key.range) + "}";
        case Kind::text: return key.words.empty() ? "{\"type\": \"string\"}" : json_words(key.words);
        default: break;
    }
    std::string any =
        "{\"type\": \"number\"" + json_range(key.range) + "}, {\"type\": \"string\", \"pattern\": \"^ *[-+]?[0-9.]\"}";
    if (!key.words.empty()) any += ", " + json_words(key.words);
    return "{\"anyOf\": [" + any + "]}";
}

std::string json_array(const std::string& items, int least, int most) {
    std::string text = "{\"type\": \"array\", \"items\": " + items + ", \"minItems\": " + std::to_string(least);
    if (most > 0) text += ", \"maxItems\": " + std::to_string(most);
    return text + "}";
}

std::string json_form(const Key& key) {
    const std::string one = json_scalar(key);
    switch (key.form) {
        case Form::one: return one;
        case Form::pair: return json_array(one, 2, 2);
        case Form::triple: return json_array(one, 3, 3);
        case Form::box: return json_array(one, 4, 4);
        case Form::list: return json_array(one, 1, 0);
        case Form::one_or_list: return "{\"anyOf\": [" + one + ", " + json_array(one, 1, 0) + "]}";
        case Form::points: return json_array(json_array(one, 2, 2), 1, 0);
    }
    return one;
}

/// `{...}` with a description (and a default) put in front.
std::string described(const Key& key, const std::string& schema) {
    std::string doc(key.doc);
    if (key.kind == Kind::number && !key.unit.empty() && key.unit != "*") doc += " [" + std::string(key.unit) + "]";
    if (const std::string when = key.condition.text(); !when.empty()) doc += " (only with " + when + ")";
    if (!key.default_doc.empty()) doc += " (default: " + std::string(key.default_doc) + ")";
    std::string front = "{\"description\": " + toml_quoted(doc);
    if (!key.default_toml.empty()) front += ", \"default\": " + key.default_toml;  // these TOML values are JSON as well
    return front + ", " + schema.substr(1);
}

std::string json_members(std::string_view pattern, const std::string& indent);

std::string json_key(const Key& key, const std::string& indent) {
    if (!key.is_table()) return json_form(key);
    if (key.kind == Kind::list) return "{\"type\": \"array\", \"items\": " + json_members(key.path, indent) + "}";
    if (key.kind == Kind::table) {
        const std::string table = json_members(key.path, indent);
        return key.text_key.empty() ? table : "{\"anyOf\": [{\"type\": \"string\"}, " + table + "]}";
    }
    const Key& row = *find_key(key.path + ".*");
    const std::string allowed = row.words.empty() ? "" : ", \"propertyNames\": " + json_words(row.words);
    return "{\"type\": \"object\"" + allowed + ", \"additionalProperties\": " + json_members(row.path, indent) + "}";
}

std::string json_members(std::string_view pattern, const std::string& indent) {
    const std::string inner = indent + "  ";
    std::string properties, required;
    for (const Key* key : keys_below(pattern)) {
        properties += (properties.empty() ? "" : ",") + ("\n" + inner) + toml_quoted(std::string(key->name())) + ": " +
                      described(*key, json_key(*key, inner));
        if (key->is_required && key->condition.values.empty())
            required += (required.empty() ? "" : ", ") + toml_quoted(std::string(key->name()));
    }
    return "{\"type\": \"object\", \"additionalProperties\": false, \"required\": [" + required +
           "], \"properties\": {" + properties + "}}";
}

}  // namespace

std::string schema_text() {
    std::string out;
    for (const Key& key : keys()) {
        const std::string also = conditions(key);
        if (key.is_table()) {
            out += "\n" + header(key) + "\n    " + std::string(key.doc) + (key.is_required ? " (required)" : "") + "\n";
            continue;
        }
        const bool plain = key.kind == Kind::text && key.words.empty() && key.form == Form::one;
        out += std::string(key.name()) + " = " + (plain ? "a text" : describe(key)) +
               (also.empty() ? "" : "  (" + also + ")") + "\n    " + std::string(key.doc) + "\n";
    }
    out += "\nNumbers that [expect] can bound\n";
    for (const Output& row : output_table("summary").rows)
        out += "    " + std::string(row.name) + (row.unit.empty() ? "" : " [" + std::string(row.unit) + "]") + ": " +
               std::string(row.doc) + "\n";
    out +=
        "\nA number is in the unit shown, or a text with a unit: \"40 mm\", \"3.08 MPa\", \"3 J/m2\", \"2450 kg/m3\", "
        "\"80 us\", \"1 mm/ms\".\n\nUnits\n" +
        units_markdown();
    out += "\nNames: " + std::string(rule_for_names) + "\n";
    return out;
}

std::string json_schema() {
    return "{\"$schema\": \"https://json-schema.org/draft/2020-12/schema\", \"title\": \"knap scenario\", " +
           json_members("", "").substr(1) + "\n";
}

std::string schema_markdown() {
    const auto escaped = [](std::string text) {
        for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
        return text;
    };
    std::string out = "| key | value | | meaning |\n|---|---|---|---|\n";
    for (const Key& key : keys())
        out += "| `" + (key.is_table() ? header(key) : key.path) + "` | " +
               (key.is_table() ? "" : escaped(describe(key))) + " | " + escaped(conditions(key)) + " | " +
               escaped(std::string(key.doc)) + " |\n";
    out +=
        "\n## Units\n\nA number is in the unit shown above, or a text with a unit of the same kind: `\"40 mm\"`, "
        "`\"3.08 MPa\"`, `\"3 J/m2\"`.\n\n" +
        units_markdown();
    out += "\n## Names\n\nMaterials, interfaces, boundaries, loads, probes and obstacles have names by one rule: " +
           std::string(rule_for_names) +
           ". A name with blanks stands in quotes where it is a key: `[material.\"hard rock\"]`. A material's name has "
           "no `-`, which joins two of them in `[interface.A-B]`. "
           "Names of boundaries that come from a Gmsh file are taken as they are.\n";
    return out;
}

}  // namespace knap
