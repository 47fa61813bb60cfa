#include "scenario/schema.hpp"

#include "base/text.hpp"
#include "record/outputs.hpp"
#include "scenario/built_in.hpp"
#include "scenario/exclusions.hpp"
#include "scenario/keys.hpp"
#include "scenario/units.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;

std::string condition(const Key& key) {
    const std::string values = joined(key.condition.values, " or ");
    return values.empty() ? "" : "only with " + std::string(key.condition.neighbour) + "=" + values;
}

/// Condition, range and default of a key: "required; greater than 0".
std::string properties(const Key& key) {
    std::vector<std::string> parts{condition(key), key.is_required ? "required" : "", key.range.text()};
    if (!key.default_toml.empty()) parts.push_back("default " + key.default_toml);
    if (!key.default_doc.empty()) parts.push_back("default: " + std::string(key.default_doc));
    std::erase(parts, "");
    return joined(parts, "; ");
}

/// "[domain]", "[material.NAME]", "[[load]]"
std::string header(const Key& table) {
    std::string path = table.path;
    if (table.kind == Kind::list) return "[[" + path.substr(0, path.size() - 2) + "]]";
    if (path.ends_with(".*")) path.replace(path.size() - 1, 1, "NAME");
    return "[" + path + "]";
}

// ---- Markdown

/// The block of a key, "load" of "load[]" and "load[].on.box"; "" for the keys at the top.
std::string_view block_of(const Key& key) {
    const std::string_view path = key.path;
    return !key.is_table() && key.parent().empty() ? "" : path.substr(0, path.find_first_of(".["));
}

std::string heading_of(std::string_view block) {
    for (const char* ending : {".*", "[]", ""})
        if (const Key* key = find_key(std::string(block) + ending)) return "`" + header(*key) + "`";
    return "At the top";
}

/// The lines of a block's example, indented.
std::string example_of(std::string_view block) {
    std::string_view rest = block_examples();
    while (rest.find("\n\n") != std::string_view::npos) {
        rest.remove_prefix(rest.find("\n\n") + 2);
        const std::string_view example = rest.substr(0, rest.find("\n\n"));
        std::string_view header = example.substr(0, example.starts_with('[') ? example.find_first_of(".]\n") : 0);
        header.remove_prefix(std::min(header.find_first_not_of('['), header.size()));
        if (header != block) continue;
        std::string lines = "    ";
        for (const char c : example) lines += c == '\n' ? "\n    " : std::string{c};
        return lines.substr(0, lines.find_last_not_of(" \n") + 1) + "\n";
    }
    return "";
}

std::string escaped(std::string text) {
    for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
    return text;
}

/// A heading with an anchor, the meaning of the block, an example, its keys.
std::string block_markdown(std::string_view block) {
    std::string meaning = "Keys above the first table.", rows;
    for (const Key& key : keys()) {
        if (block_of(key) != block) continue;
        if (key.is_table() && key.parent().empty()) {
            meaning = std::string(key.doc) + (key.is_required ? "; required." : ".");
            meaning[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(meaning[0])));
        } else {
            rows += "| `" + (key.is_table() ? header(key) : key.path) + "` | " +
                    (key.is_table() ? "" : escaped(describe(key, key.unit))) + " | " + escaped(properties(key)) +
                    " | " + escaped(std::string(key.doc)) + " |\n";
        }
    }
    const std::string anchor(block.empty() ? "top" : block);
    return "\n<a id=\"" + anchor + "\"></a>\n\n## " + heading_of(block) + "\n\n" + meaning + "\n\n" +
           example_of(block) + "\n| key | value | | meaning |\n|---|---|---|---|\n" + rows;
}

std::string pairs_markdown() {
    std::string rows;
    for (const auto& [one, other, because] : exclusions())
        rows += "| `" + std::string(one) + "` | `" + std::string(other) + "` | " + std::string(because) + " |\n";
    return "\n<a id=\"pairs\"></a>\n\n## Pairs that do not go together\n\nAll others do. With [contact] rotations are "
           "large, with a mass that is not lumped the bulk is implicit.\n\nA test tries every two of a list of "
           "capabilities in one scene, with what each of them needs, and counts a pair of which one needs what the "
           "other refuses, too: 51 of the 1176 pairs of 49 are refused, and 22 of the 595 pairs of 35 that the list "
           "had at first.\n\n| | | because |\n|---|---|---|\n" +
           rows;
}

// ---- JSON

Json json_words(const std::vector<std::string>& words) {
    std::vector<std::string> whole, beginnings, endings;
    for (const std::string& word : words)
        if (word.starts_with("*.")) endings.push_back("\\" + word.substr(1));
        else if (word.starts_with('*')) endings.push_back(word.substr(1));
        else if (word.ends_with('*')) beginnings.push_back(word.substr(0, word.size() - 1));
        else whole.push_back(word);
    Json any = Json::array();
    if (!whole.empty()) any.push_back({{"enum", whole}});
    const auto add = [&](const std::string& pattern) { any.push_back({{"type", "string"}, {"pattern", pattern}}); };
    if (!endings.empty()) add(".(" + joined(endings, "|") + ")$");
    if (!beginnings.empty()) add("^(" + joined(beginnings, "|") + ").");
    return any.size() == 1 ? any[0] : Json{{"anyOf", any}};
}

/// The name of a kind of values in "$defs": "J/m2" -> "J_m2".
std::string name_of_kind(std::string_view unit) {
    std::string name(unit.empty() ? "number" : unit == "*" ? "any" : unit);
    std::ranges::replace_if(
        name, [](unsigned char c) { return !std::isalnum(c); }, '_');
    return name;
}

/// Texts with a number and a unit, by the unit of plain numbers.
Json json_kinds() {
    Json kinds = Json::object();
    const auto add = [&](std::string_view unit) {
        if (unit == "=" || kinds.contains(name_of_kind(unit))) return;
        kinds[name_of_kind(unit)] = {
            {"type", "string"}, {"title", describe_unit(unit)}, {"pattern", quantity_pattern(unit)}};
    };
    kinds["positive"] = {{"title", "greater than 0"}, {"pattern", "^ *[+]?0*(?:[1-9]|\\.0*[1-9])"}};
    kinds["not_negative"] = {{"title", "at least 0"}, {"pattern", "^ *[^- ]"}};
    for (const Key& key : keys()) {
        if (key.kind != Kind::number) continue;
        add(key.unit), add(key.second_unit);
        for (const std::string& multiple : key.multiples) add(multiple);
    }
    for (const Output& row : output_table("summary").rows) add(row.unit);  // bounds in [expect]
    return kinds;
}

/// A text such as a formula, and no number with a unit.
Json json_formula() {
    const char* const number_and_letter =
        "^ *[-+]?(?:[0-9]+\\.?[0-9]*|\\.[0-9]+)(?:[eE][-+]?[0-9]+)? *"
        "(?:[A-DF-Za-df-zµμ%]|[eE](?:[^-+0-9]|$))";  // the e of 1e2 is none
    return {{"type", "string"}, {"title", "a formula of x, y, t"}, {"not", {{"pattern", number_and_letter}}}};
}

Json json_value(const Key& key, std::string_view unit) {
    const Range& range = key.range;
    const auto ranged = [&](const char* type) {
        Json json{{"type", type}};
        if (std::isfinite(range.low)) json[range.low_included ? "minimum" : "exclusiveMinimum"] = range.low;
        if (std::isfinite(range.high)) json[range.high_included ? "maximum" : "exclusiveMaximum"] = range.high;
        return json;
    };
    if (key.kind == Kind::boolean) return {{"type", "boolean"}};
    if (key.kind == Kind::integer) return ranged("integer");
    if (key.kind == Kind::text && !key.unit.empty())
        return {{"anyOf", {{{"$ref", "#/$defs/" + name_of_kind(key.unit)}}, json_formula()}}};
    if (key.kind == Kind::text) return key.words.empty() ? Json{{"type", "string"}} : json_words(key.words);
    const char* const sign = range.low < 0 ? "" : range.low > 0 || !range.low_included ? "positive" : "not_negative";
    Json any = Json::array({ranged("number")});
    const auto add = [&](std::string_view unit_of_text) {
        Json all = Json::array({{{"$ref", "#/$defs/" + name_of_kind(unit_of_text)}}});
        if (*sign) all.push_back({{"$ref", std::string("#/$defs/") + sign}});
        any.push_back({{"allOf", all}});
    };
    add(unit);
    for (const std::string& multiple : key.multiples) add(multiple);
    if (!key.words.empty()) any.push_back(json_words(key.words));
    if (key.takes_formulas) any.push_back(json_formula());
    return {{"anyOf", any}};
}

Json json_array(const Json& items, std::size_t min, std::size_t max) {
    Json json{{"type", "array"}, {"items", items}, {"minItems", min}};
    if (max > 0) json["maxItems"] = max;
    return json;
}

Json json_form(const Key& key) {
    const Json one = json_value(key, key.unit);
    if (key.form == Form::one) return one;
    const FormRule rule = key.rule();
    Json point = json_array(one, 2, 2);
    if (key.second_unit != "=") {
        point.erase("items");
        point["prefixItems"] = {one, json_value(key, key.second_unit)};
    }
    const Json list = json_array(key.form == Form::points ? point : one, rule.min, rule.max);
    if (key.takes_formulas)
        return {{"anyOf", {list, {{"type", "string"}, {"title", "a csv file of points"}, {"pattern", "\\.csv$"}}}}};
    return key.form == Form::one_or_list ? Json{{"anyOf", {one, list}}} : list;
}

/// `unit`: of the numbers whose unit the key table leaves open.
Json json_members(std::string_view table, std::string_view unit = "*");

/// [expect]: a number of the summary is bounded in its own unit.
Json json_expectations() {
    Json named = Json::object(), patterns = Json::object();
    for (const Output& output : output_table("summary").rows) {
        const std::string name(output.name);
        Json& place = name.starts_with('*') ? patterns[name.substr(1) + "$"] : named[name];
        place["$ref"] = "#/$defs/expected_" + name_of_kind(output.unit);
    }
    return {
        {"type", "object"}, {"additionalProperties", false}, {"properties", named}, {"patternProperties", patterns}};
}

Json json_key(const Key& key) {
    if (!key.is_table()) return json_form(key);
    if (key.kind == Kind::list) return {{"type", "array"}, {"items", json_members(key.path)}};
    if (key.kind == Kind::table) {
        const Json table = json_members(key.path);
        if (key.text_key.empty()) return table;
        return {{"anyOf", {json_form(*find_key(joined_path(key.path, key.text_key))), table}}};
    }
    const Key& row = *find_key(key.path + ".*");
    if (key.path == "expect") return json_expectations();
    Json json{{"type", "object"}};
    if (!row.words.empty()) json["propertyNames"] = json_words(row.words);
    json["additionalProperties"] = json_members(row.path);
    return json;
}

Json json_members(std::string_view table, std::string_view unit) {
    Json members = Json::object(), required = Json::array();
    for (const Key* row : keys_below(table)) {
        Key of_unit = *row;
        if (row->unit == "*") of_unit.unit = unit;
        const Key* const key = &of_unit;
        std::string doc(key->doc);
        if (key->has_fixed_unit()) doc += " [" + std::string(key->unit) + "]";
        if (const std::string only = condition(*key); !only.empty()) doc += " (" + only + ")";
        if (!key->default_doc.empty()) doc += " (default: " + std::string(key->default_doc) + ")";
        Json member{{"description", doc}};
        if (!key->default_toml.empty()) member["default"] = Json::parse(key->default_toml);  // is JSON, too
        member.update(json_key(*key));
        members[std::string(key->name())] = std::move(member);
        if (key->is_required && key->condition.values.empty()) required.push_back(std::string(key->name()));
    }
    return {{"type", "object"}, {"additionalProperties", false}, {"required", required}, {"properties", members}};
}

}  // namespace

std::string schema_text() {
    std::string out;
    for (const Key& key : keys()) {
        const std::string doc = "\n    " + std::string(key.doc), more = properties(key);
        if (key.is_table()) out += "\n" + header(key) + doc + (key.is_required ? " (required)" : "") + "\n";
        else
            out += std::string(key.name()) + " = " + describe(key, key.unit) +
                   (more.empty() ? "" : "  (" + more + ")") + doc + "\n";
    }
    out += "\nNumbers that [expect] can bound\n";
    for (const Output& row : output_table("summary").rows)
        out += "    " + std::string(row.name) + (row.unit.empty() ? "" : " [" + std::string(row.unit) + "]") + ": " +
               std::string(row.doc) + "\n";
    return out +
           "\nA number is in the unit shown, or a text with a unit: \"40 mm\", \"3.08 MPa\", \"3 J/m2\", "
           "\"2450 kg/m3\", \"80 us\", \"1 mm/ms\".\n\nUnits\n" +
           units_markdown() + "\nNames: " + rule_for_names + "\n";
}

std::string json_schema() {
    Json root{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "knap scenario"}};
    root.update(json_members(""));
    root["$defs"] = json_kinds();
    for (const Output& row : output_table("summary").rows)
        root["$defs"]["expected_" + name_of_kind(row.unit)] = json_members("expect.*", row.unit);
    return root.dump(2) + "\n";
}

std::string schema_markdown() {
    std::vector<std::string_view> blocks;
    for (const Key& key : keys())
        if (std::ranges::count(blocks, block_of(key)) == 0) blocks.push_back(block_of(key));
    std::vector<std::string> contents;
    std::string sections;
    for (const std::string_view block : blocks) {
        contents.push_back("[" + heading_of(block) + "](#" + std::string(block.empty() ? "top" : block) + ")");
        sections += block_markdown(block);
    }
    return "# Keys of a scenario\n\nWritten by `knap schema --markdown`. The outputs of a run are in "
           "[OUTPUTS.md](OUTPUTS.md).\nBlocks: " +
           joined(contents, ",\n") + ";\n[pairs that do not go together](#pairs), [units](#units), [names](#names).\n" +
           sections + pairs_markdown() +
           "\n## Units\n\nA number is in the unit shown above, or a text with a unit of the same kind: `\"40 mm\"`, "
           "`\"3.08 MPa\"`, `\"3 J/m2\"`.\n\n" +
           units_markdown() +
           "\n## Names\n\nMaterials, interfaces, boundaries, loads, probes, collectors and obstacles have names by one "
           "rule: " +
           rule_for_names +
           ". As a key, a name with blanks is in quotes: `[material.\"hard rock\"]`. A material's name has "
           "no `-`, which joins two of them in `[interface.A-B]`. "
           "Names of boundaries from a Gmsh file are not restricted.\n"
           "\n## Outputs\n\n[OUTPUTS.md](OUTPUTS.md) lists every number that a run writes; those of the summary can be "
           "bounded in [`[expect.NAME]`](#expect).\n";
}

}  // namespace knap
