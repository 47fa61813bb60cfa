#include "scenario/schema.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ranges>
#include <utility>

#include "record/outputs.hpp"
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

// ---- Markdown

/// Of every block of a scenario a few lines that can be read (tests/scenario/test_readme.cpp reads each).
constexpr std::pair<std::string_view, std::string_view> block_examples[] = {
    {"", R"(knap = 1
name = "plate"
seed = 7
)"},
    {"domain", R"([domain]
shape = "rectangle"
size  = ["100 mm", "40 mm"]
)"},
    {"mesh", R"([mesh]
size   = "1 mm"
refine = [{ inside = ["45 mm", "10 mm", "100 mm", "30 mm"], size = "0.5 mm" }]
)"},
    {"material", R"([material.glass]
density = "2450 kg/m3"
E       = "32 GPa"
nu      = 0.2
)"},
    {"inclusions", R"([[inclusions]]
size     = "2 mm"
fraction = "5 %"
material = "quartz"
)"},
    {"joints", R"([[joints]]
direction = "60 deg"
spacing   = "20 mm"
)"},
    {"map", R"([[map]]
file   = "thin_section.png"
colour = [{ rgb = "#d0d0d0", material = "quartz" }, { rgb = "#202020", material = "mica" }]
)"},
    {"grains", R"([[grains]]
size    = "3 mm"
mineral = [{ material = "quartz", fraction = "30 %" }]
)"},
    {"interface", R"([interface.default]
sigma_c  = "8 MPa"
G_c      = "20 J/m2"
friction = 0.3
)"},
    {"support", R"([[support]]
on    = "bottom"
glued = true
)"},
    {"load", R"([[load]]
on       = "top"
velocity = ["free", "1 m/s"]
ramp     = "10 us"
)"},
    {"obstacle", R"([[obstacle]]
shape  = "half plane"
at     = ["0 mm", "40 mm"]
normal = [0, -1]
)"},
    {"initial", R"([[initial]]
velocity = ["0 m/s", "-5 m/s"]
box      = ["0 mm", "0 mm", "50 mm", "40 mm"]
)"},
    {"time", R"([time]
end  = "1 ms"
bulk = "implicit"
step = "20 CFL"
)"},
    {"output", R"([output]
every         = "1 us"
history_every = "0.2 us"
)"},
    {"specimen", R"([specimen]
test    = "compression"
force   = "upper platen"
lateral = ["left", "right"]
)"},
    {"probe", R"([[probe]]
name = "gauge"
at   = ["30 mm", "20 mm"]
)"},
    {"figure", R"([[figure]]
file = "stress.png"
show = "principal_stress"
at   = ["10 us", "20 us"]
)"},
    {"limits", R"([limits]
slip     = 2
rotation = "none"
)"},
    {"expect", R"([expect]
energy_residual = { below = 1e-10 }
broken_length   = { value = "50 mm", within = "5 %" }
)"},
    {"sweep", R"([sweep]
set   = ["interface.default.sigma_c=8 MPa,10 MPa,12 MPa"]
seeds = 20
)"},
    {"study", R"([study]
refine = "both"
levels = [1, 2, 4]
)"},
};

/// "load" of "load[]" and "load[].on.box"; the keys at the top have none.
std::string_view block_of(const Key& key) {
    const std::string_view path = key.path;
    if (!key.is_table() && key.parent().empty()) return "";
    return path.substr(0, std::min(path.find('.'), path.find('[')));
}

std::string block_heading(std::string_view block) {
    if (block.empty()) return "At the top";
    for (const std::string& row : {std::string(block) + ".*", std::string(block) + "[]", std::string(block)})
        if (const Key* key = find_key(row)) return "`" + header(*key) + "`";
    return "";
}

std::string escaped(std::string text) {
    for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
    return text;
}

std::string sentence(const Key& table) {
    std::string text(table.doc);
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text + (table.is_required ? "; required" : "") + ".\n";
}

std::string key_row(const Key& key) {
    const std::string value = key.is_table() ? "" : escaped(describe(key));
    return "| `" + (key.is_table() ? header(key) : key.path) + "` | " + value + " | " + escaped(conditions(key)) + " | " +
           escaped(std::string(key.doc)) + " |\n";
}

/// A heading with an anchor of the block's name, what the block is, an example, its keys.
std::string block_markdown(std::string_view block) {
    const std::string anchor(block.empty() ? "top" : block);
    std::string said = "Keys above the first table.\n", example, rows;
    for (const auto& [name, lines] : block_examples)
        if (name == block)
            for (const auto line : std::views::split(lines.substr(0, lines.size() - 1), '\n'))
                example += "    " + std::string(line.begin(), line.end()) + "\n";
    for (const Key& key : keys()) {
        if (block_of(key) != block) continue;
        if (key.is_table() && key.parent().empty())
            said = sentence(key);
        else
            rows += key_row(key);
    }
    return "\n<a id=\"" + anchor + "\"></a>\n\n## " + block_heading(block) + "\n\n" + said + "\n" + example +
           "\n| key | value | | meaning |\n|---|---|---|---|\n" + rows;
}

// ---- JSON

std::string json_words(const std::vector<std::string>& words) {
    std::string list, endings;
    for (const std::string& word : words)
        if (word.starts_with('*'))
            endings += (endings.empty() ? "" : "|") + word.substr(1);
        else
            list += (list.empty() ? "" : ", ") + toml_quoted(word);
    const std::string exact = "{\"enum\": [" + list + "]}";
    return endings.empty()
               ? exact
               : "{\"anyOf\": [" + exact + ", {\"type\": \"string\", \"pattern\": " + toml_quoted(".(" + endings + ")$") + "}]}";
}

std::string json_range(const Range& range) {
    std::string text;
    if (std::isfinite(range.low))
        text += std::string(", \"") + (range.low_included ? "minimum" : "exclusiveMinimum") + "\": " + shortest(range.low);
    if (std::isfinite(range.high))
        text += std::string(", \"") + (range.high_included ? "maximum" : "exclusiveMaximum") + "\": " + shortest(range.high);
    return text;
}

std::string json_scalar(const Key& key) {
    switch (key.kind) {
        case Kind::boolean:
            return "{\"type\": \"boolean\"}";
        case Kind::integer:
            return "{\"type\": \"integer\"" + json_range(key.range) + "}";
        case Kind::text:
            return key.words.empty() ? "{\"type\": \"string\"}" : json_words(key.words);
        default:
            break;
    }
    std::string any = "{\"type\": \"number\"" + json_range(key.range) + "}, {\"type\": \"string\", \"pattern\": \"^ *[-+]?[0-9.]\"}";
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
        case Form::one:
            return one;
        case Form::pair:
            return json_array(one, 2, 2);
        case Form::triple:
            return json_array(one, 3, 3);
        case Form::box:
            return json_array(one, 4, 4);
        case Form::list:
            return json_array(one, 1, 0);
        case Form::one_or_list:
            return "{\"anyOf\": [" + one + ", " + json_array(one, 1, 0) + "]}";
        case Form::points:
            return json_array(json_array(one, 2, 2), 1, 0);
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
    return "{\"type\": \"object\", \"additionalProperties\": false, \"required\": [" + required + "], \"properties\": {" + properties +
           "}}";
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
        out += std::string(key.name()) + " = " + (plain ? "a text" : describe(key)) + (also.empty() ? "" : "  (" + also + ")") + "\n    " +
               std::string(key.doc) + "\n";
    }
    out += "\nNumbers that [expect] can bound\n";
    for (const Output& row : output_table("summary").rows)
        out += "    " + std::string(row.name) + (row.unit.empty() ? "" : " [" + std::string(row.unit) + "]") + ": " + std::string(row.doc) +
               "\n";
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
    std::vector<std::string_view> blocks;
    for (const Key& key : keys())
        if (std::ranges::find(blocks, block_of(key)) == blocks.end()) blocks.push_back(block_of(key));
    std::string contents, sections;
    for (const std::string_view block : blocks) {
        contents += (contents.empty() ? "" : ",\n") + std::string("[") + block_heading(block) + "](#" +
                    std::string(block.empty() ? "top" : block) + ")";
        sections += block_markdown(block);
    }
    return "# Keys of a scenario\n\nWritten by `knap schema --markdown`. What a run writes is in "
           "[OUTPUTS.md](OUTPUTS.md).\nBlocks: " +
           contents + ";\n[units](#units), [names](#names).\n" + sections +
           "\n## Units\n\nA number is in the unit shown above, or a text with a unit of the same kind: `\"40 mm\"`, "
           "`\"3.08 MPa\"`, `\"3 J/m2\"`.\n\n" +
           units_markdown() + "\n## Names\n\nMaterials, interfaces, boundaries, loads, probes and obstacles have names by one rule: " +
           std::string(rule_for_names) +
           ". A name with blanks stands in quotes where it is a key: `[material.\"hard rock\"]`. A material's name has "
           "no `-`, which joins two of them in `[interface.A-B]`. "
           "Names of boundaries that come from a Gmsh file are taken as they are.\n"
           "\n## Outputs\n\n[OUTPUTS.md](OUTPUTS.md) lists every number that a run writes; those of the summary can be "
           "bounded in [`[expect.NAME]`](#expect).\n";
}

}  // namespace knap
