#include "scenario/read_scenario.hpp"

#include <algorithm>

#include "base/whole_file.hpp"
#include "scenario/built_in.hpp"
#include "scenario/reading.hpp"
#include "scenario/resolve.hpp"

namespace knap {
namespace {

constexpr std::int64_t newest_format = 1;
constexpr std::uintmax_t largest_file = 20'000'000;  // bytes: a polygon of 1e5 points has 5 MB

[[noreturn]] void give_up(const Findings& findings) { throw UserError(findings.sorted(Diagnostic::Severity::error)); }

/// What stops the reading at once: no text, not text, not TOML, a format from the future.
Node parsed(const Source& source, Findings& findings) {
    const std::string& text = source.text();
    if (text.find('\0') != std::string::npos) {
        findings.error("binary-file", "`" + source.name() + "` is not a text file").note =
            "a scenario is a TOML file; `knap new` writes one";
        give_up(findings);
    }
    Node root;
    if (const auto error = parse_toml(text, root)) {
        Node at{.place = error->place};
        findings.error("bad-toml", error->message, at).note =
            "a scenario is a TOML file (toml.io); text goes into \"quotes\"";
        give_up(findings);
    }
    if (root.children.empty()) {
        findings.error("empty-file", "`" + source.name() + "` says nothing").note =
            "`knap new` writes a scenario to start from";
        give_up(findings);
    }
    return root;
}

void check_format(const Node& root, Findings& findings) {
    const Node* format = root.find("knap");
    if (!format || format->type != Node::Type::integer || format->integer <= newest_format) return;
    findings
        .error("newer-format",
               "this scenario has format " + std::to_string(format->integer) + ", and this program reads up to " +
                   std::to_string(newest_format),
               *format)
        .note = "use a newer version of knap";
    give_up(findings);
}

/// The file's name without its type; what cannot be in a scenario's name becomes "-".
std::string name_from(const std::string& file) {
    std::string name = std::filesystem::path(file).stem().string();
    std::ranges::replace_if(
        name, [](char c) { return !is_plain(c); }, '-');
    return name.empty() || name.front() == '.' ? "scenario" : name;
}

[[noreturn]] void refuse(const std::string& code, const std::string& message, const std::string& file,
                         const std::string& note) {
    throw UserError({{.code = code, .message = message, .file = file, .note = note}});
}

std::string text_of_file(const std::filesystem::path& file) {
    std::error_code code;
    const std::string name = file.string();
    if (!std::filesystem::exists(file, code)) refuse("missing-file", "there is no file `" + name + "`", "", "");
    if (std::filesystem::is_directory(file, code))
        refuse("not-a-file", "`" + name + "` is a directory", "", "give the scenario file in it");
    if (!std::filesystem::is_regular_file(file, code))
        refuse("not-a-file", "`" + name + "` is not a regular file", "", "");
    if (std::filesystem::file_size(file, code) > largest_file)
        refuse("too-large", "`" + name + "` has more than " + std::to_string(largest_file / 1'000'000) + " MB", "",
               "large meshes are read by mesh.file");
    try {
        return read_whole_file(file);
    } catch (const OutputError& error) {
        refuse("unreadable-file", error.what(), "", "");
    }
}

/// "holes[1]" of a Shape -> "domain.hole[1]" of the scenario.
std::string path_of_part(const std::string& part) {
    if (part == "size") return "mesh.size";
    for (const auto& [theirs, ours] :
         {std::pair{"holes[", "domain.hole["}, {"cracks[", "domain.crack["}, {"regions[", "domain.region["}})
        if (part.starts_with(theirs)) return ours + part.substr(std::string_view(theirs).size());
    return "domain";
}

/// The key in a table that says its shape.
std::string key_of_shape(const Values& values, const std::string& table) {
    for (const char* key : {".points", ".size", ".radius", ".box"})
        if (values.given(table + key)) return table + key;
    return table;
}

/// The built-in scenario that a name means: itself, or the shortest that begins with it where all that do begin with
/// that one (edge-crack: edge_cracked_block, not its variants). Empty: none.
std::string full_name(std::string begin, const std::vector<std::string>& names) {
    std::replace(begin.begin(), begin.end(), '-', '_');
    std::string shortest;
    for (const std::string& name : names) {
        if (name == begin) return name;
        if (begin.size() >= 4 && name.starts_with(begin) && (shortest.empty() || name.size() < shortest.size()))
            shortest = name;
    }
    const auto agrees = [&](const std::string& name) { return !name.starts_with(begin) || name.starts_with(shortest); };
    const bool clear = std::ranges::all_of(names, agrees);
    return clear ? shortest : "";
}

ReadResult read_text(const std::string& text, const std::string& name, const std::vector<std::string>& overrides,
                     const Beside& beside) {
    ReadResult result{.source = Source(name, text)};
    Findings findings(result.source);
    Node root = parsed(result.source, findings);
    check_format(root, findings);
    apply_overrides(root, overrides, findings);
    result.values = resolve(root, findings);
    result.values.compute("name", Node::of_text(name_from(name)));
    Reading reading{result.values, findings, result.scenario, beside};
    read_all(reading);
    if (findings.has_errors()) give_up(findings);
    result.warnings = findings.sorted(Diagnostic::Severity::warning);
    return result;
}

}  // namespace

ReadResult read_scenario_text(const std::string& text, const std::string& name,
                              const std::vector<std::string>& overrides, const std::filesystem::path& directory) {
    return read_text(text, name, overrides, {directory});
}

ReadResult read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    return read_scenario_text(text_of_file(file), file.string(), overrides, file.parent_path());
}

ReadResult open_scenario(const std::string& file_or_name, const std::vector<std::string>& overrides) {
    std::error_code code;
    if (std::filesystem::exists(file_or_name, code)) return read_scenario(file_or_name, overrides);
    const auto names = built_in_scenarios();
    const std::string name = full_name(file_or_name, names);
    if (name.empty()) {
        Diagnostic d{.code = "missing-file",
                     .message = "there is no file and no built-in scenario `" + file_or_name + "`"};
        d.hint = did_you_mean(file_or_name, names);
        d.note = "built in: " + joined(names);
        throw UserError({d});
    }
    return read_text(built_in_scenario(name), name, overrides, {.directory = {}, .in_binary = true});
}

std::vector<std::string> built_in_scenarios() {
    std::vector<std::string> names;
    for (const BuiltIn& scenario : built_ins()) names.push_back(scenario.name);
    return names;
}

const std::string& built_in_scenario(const std::string& name) {
    for (const BuiltIn& scenario : built_ins())
        if (scenario.name == name) return scenario.text;
    throw UserError("missing-file", "there is no built-in scenario `" + name + "`",
                    "built in: " + joined(built_in_scenarios()));
}

Diagnostic locate(const ReadResult& result, const std::string& key_path) {
    Diagnostic d{.file = result.source.name()};
    const Node& node = result.values.place_of(key_path);
    if (!node.is_placed()) return d;
    result.source.point(d, node);
    result.source.quote(d);
    return d;
}

UserError located(const ReadResult& result, const std::string& key_path, const UserError& error) {
    Diagnostic placed = locate(result, key_path);
    const Diagnostic& first = error.diagnostics.front();
    placed.code = first.code;
    placed.message = first.message;
    placed.note = first.note;
    return UserError({placed});
}

Diagnostic locate(const ReadResult& result, const ShapeError& error) {
    const std::string path = path_of_part(error.part);
    Diagnostic d = locate(result, key_of_shape(result.values, path));
    d.code = "bad-shape";
    d.message = "`" + path + "` " + error.what();
    return d;
}

}  // namespace knap
