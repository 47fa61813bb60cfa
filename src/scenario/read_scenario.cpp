#include "scenario/read_scenario.hpp"

#include "base/whole_file.hpp"
#include "scenario/built_in.hpp"
#include "scenario/reading.hpp"
#include "scenario/resolve.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr std::int64_t newest_format = 1;
constexpr std::uintmax_t largest_file = 20'000'000;  // bytes: a polygon of 1e5 points has 5 MB

/// The tree of a text. Reading stops if it is no text, no TOML, or of a newer format.
Node parsed(const Source& source, Findings& findings) {
    const auto stop = [&](const std::string& code, const std::string& message, const Node& at, const char* note) {
        findings.error(code, message, at, note);
        throw UserError(findings.sorted(Diagnostic::Severity::error));
    };
    if (source.text().find('\0') != std::string::npos)
        stop("binary-file", "`" + source.name() + "` is not a text file", Node{},
             "a scenario is a TOML file; `knap new` writes one");
    Node root;
    if (const auto error = parse_toml(source.text(), root))
        stop("bad-toml", error->message, Node{.place = error->place},
             "a scenario is a TOML file (toml.io); text goes into \"quotes\"");
    if (root.children.empty())
        stop("empty-file", "`" + source.name() + "` has no keys", Node{}, "`knap new` writes a scenario to start from");
    const Node* format = root.find("knap");
    if (format && format->type == Node::Type::integer && format->integer > newest_format)
        stop("newer-format",
             "this scenario has format " + std::to_string(format->integer) + ", and this program reads up to " +
                 std::to_string(newest_format),
             *format, "use a newer version of knap");
    return root;
}

/// The file's name without its type; characters that a scenario's name cannot have become "-".
std::string name_from(const std::string& file) {
    std::string name = std::filesystem::path(file).stem().string();
    std::ranges::replace_if(
        name, [](char c) { return !is_plain(c); }, '-');
    return name.empty() || name.front() == '.' ? "scenario" : name;
}

std::string text_of_file(const std::filesystem::path& file) {
    const std::string name = "`" + file.string() + "`";
    std::error_code code;
    if (!std::filesystem::exists(file, code)) throw UserError("missing-file", "there is no file " + name);
    if (std::filesystem::is_directory(file, code))
        throw UserError("not-a-file", name + " is a directory", "give the scenario file in it");
    if (!std::filesystem::is_regular_file(file, code)) throw UserError("not-a-file", name + " is not a regular file");
    if (std::filesystem::file_size(file, code) > largest_file)
        throw UserError("too-large", name + " has more than " + std::to_string(largest_file / 1'000'000) + " MB",
                        "large meshes are read by mesh.file");
    try {
        return read_whole_file(file);
    } catch (const OutputError& error) {
        throw UserError("unreadable-file", error.what());
    }
}

/// "traces[0] (line 12)": between the table that placed a line and the line of its file.
constexpr std::string_view line_of_file = " (line ";

/// Paths of tables by the parts of a Shape.
class PathsOfParts {
public:
    explicit PathsOfParts(const Scenario& scenario) : scenario_(scenario) {}

    /// "holes[1]" -> "domain.hole[1]", "body[2].holes[1]" -> "body[2].hole[1]", and of those that were placed the table
    /// that placed them: "joints[0]".
    std::string of(const std::string& part) const {
        const std::size_t dot = part.find('.');
        const bool of_domain = dot == std::string::npos;
        const std::string table = of_domain ? "domain" : part.substr(0, dot),
                          own = of_domain ? part : part.substr(dot + 1);
        if (own == "size") return of_domain ? "mesh.size" : table + ".mesh_size";
        for (const auto& [list, key, kind] : {std::tuple{"holes[", ".hole", PlacedSet::Part::holes},
                                              {"cracks[", ".crack", PlacedSet::Part::cracks},
                                              {"regions[", ".region", PlacedSet::Part::regions}})
            if (own.starts_with(list)) {
                const std::size_t number = std::stoul(own.substr(std::string_view(list).size()));
                for (std::size_t body = 0; body < scenario_.bodies.size(); ++body)
                    if (scenario_.bodies[body].path == table)
                        return scenario_.table_of_part(body, kind, number, table + key);
            }
        return table;
    }

    /// The text of a fault with the tables of the parts that it names: "of cracks[107] at" -> "of `domain.crack[107]`
    /// at".
    std::string in_text(std::string text, const std::string& part) const {
        const std::string prefix = part.substr(0, part.find('.') == std::string::npos ? 0 : part.find('.') + 1);
        for (const char* const list : {"holes[", "cracks[", "regions["})
            for (std::size_t at = 0; (at = text.find(list, at)) != std::string::npos;) {
                const std::size_t length = text.find(']', at) + 1 - at;
                const std::string path = quoted(of(prefix + text.substr(at, length)));
                text.replace(at, length, path), at += path.size();
            }
        return text;
    }

    /// "traces[0] (line 12)" -> "`traces[0]` (line 12)"
    static std::string quoted(const std::string& path) {
        const std::size_t end = std::min(path.find(' '), path.size());
        return "`" + path.substr(0, end) + "`" + path.substr(end);
    }

private:
    const Scenario& scenario_;
};

/// The built-in scenario that a name means: itself, or the shortest name with this beginning if all others with it
/// begin with that name (edge-crack: edge_cracked_block, not its variants). Empty: none.
std::string full_name(std::string begin, const std::vector<std::string>& names) {
    std::ranges::replace(begin, '-', '_');
    std::string shortest;
    for (const std::string& name : names) {
        if (name == begin) return name;
        if (begin.size() >= 4 && name.starts_with(begin) && (shortest.empty() || name.size() < shortest.size()))
            shortest = name;
    }
    const auto agrees = [&](const std::string& name) { return !name.starts_with(begin) || name.starts_with(shortest); };
    return std::ranges::all_of(names, agrees) ? shortest : "";
}

/// The scenario files in the folder of a file that does not exist, as the user would name them.
std::vector<std::string> scenarios_beside(const std::filesystem::path& missing) {
    namespace fs = std::filesystem;
    const fs::path folder = missing.parent_path();
    std::vector<std::string> names;
    std::error_code none;
    for (fs::directory_iterator at(folder.empty() ? "." : folder, none), end; !none && at != end; at.increment(none))
        if (at->path().extension() == ".toml") names.push_back((folder / at->path().filename()).string());
    std::ranges::sort(names);
    return names;
}

/// `files`: others that may be meant.
const BuiltIn& built_in_or_files(const std::string& name, std::vector<std::string> files) {
    const auto names = built_in_scenarios();
    const auto found = std::ranges::find(built_ins(), full_name(name, names), &BuiltIn::name);
    if (found != built_ins().end()) return *found;
    files.insert(files.end(), names.begin(), names.end());
    throw UserError({{.code = "missing-file",
                      .message = "there is no file and no built-in scenario `" + name + "`",
                      .hint = did_you_mean(name, files),
                      .note = "built in: " + joined(names)}});
}

ReadResult read_text(const std::string& text, const std::string& name, const std::vector<std::string>& overrides,
                     const FileSource& files) {
    ReadResult result{.source = Source(name, text)};
    Findings findings(result.source);
    Node root = parsed(result.source, findings);
    apply_overrides(root, overrides, findings);
    result.values = resolve(root, findings);
    Reading reading{result.values, findings, result.scenario, files};
    Table(reading, "", result.values.root).compute("name", Node::of_text(name_from(name)));
    read_all(reading);
    if (findings.has_errors()) throw UserError(findings.sorted(Diagnostic::Severity::error));
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
    // a folder with the name of a built-in scenario is the output of an earlier run: it does not hide the scenario
    const bool is_folder_of_name =
        std::filesystem::is_directory(file_or_name, code) && std::ranges::count(built_in_scenarios(), file_or_name) > 0;
    if (std::filesystem::exists(file_or_name, code) && !is_folder_of_name)
        return read_scenario(file_or_name, overrides);
    const BuiltIn& found = built_in_or_files(file_or_name, scenarios_beside(file_or_name));
    return read_text(found.text, found.name, overrides, {.directory = {}, .in_program = true});
}

std::vector<std::string> built_in_scenarios() {
    std::vector<std::string> names;
    for (const BuiltIn& scenario : built_ins()) names.push_back(scenario.name);
    return names;
}

const BuiltIn& built_in_scenario(const std::string& name) { return built_in_or_files(name, {}); }

std::string Scenario::table_of_part(std::size_t body, PlacedSet::Part part, std::size_t i,
                                    const std::string& path) const {
    for (const PlacedSet& set : placed_sets) {
        if (set.body != body || set.part != part || i < set.first || i >= set.first + static_cast<std::size_t>(set.n))
            continue;
        return set.path +
               (set.is_random() ? "" : std::string(line_of_file) + std::to_string(set.file_lines[i - set.first]) + ")");
    }
    const Body& owner = bodies[body];
    const std::size_t first_excavation = owner.shape.regions.size() - owner.excavations.size();
    if (part == PlacedSet::Part::regions && i >= first_excavation)
        return item("excavation", owner.excavations[i - first_excavation]);
    return item(path, i);
}

Diagnostic ReadResult::at(const std::string& key_path, Diagnostic message) const {
    if (const std::size_t line = key_path.find(line_of_file); line != std::string::npos)
        return in_file(key_path.substr(0, line) + ".file", std::stoi(key_path.substr(line + line_of_file.size())),
                       std::move(message));
    message.file = source.name();
    if (const Node& node = values.place_of(key_path); node.is_placed()) {
        source.set_place(message, node);
        source.quote(message);
    }
    return message;
}

Diagnostic ReadResult::in_file(const std::string& key_path, int line, Diagnostic message) const {
    const auto file = std::ranges::find(scenario.files, key_path, &NamedFile::key);
    if (file == scenario.files.end()) return at(key_path, std::move(message));
    return at_line(std::move(message), std::filesystem::path(source.name()).parent_path() / values.find(key_path)->text,
                   file->bytes, line);
}

std::vector<Diagnostic> ReadResult::at_shapes(const ShapeError& error) const {
    std::vector<Diagnostic> found;
    const PathsOfParts paths(scenario);
    for (const ShapeFault& fault : error.faults) {
        const std::string named = paths.of(fault.part), path = named.substr(0, named.find(' '));
        std::string key = named.find(line_of_file) == std::string::npos ? path : named;
        for (const char* outline : {".box", ".radius", ".size", ".points"})
            if (const Node* node = values.find(path + outline); node && node->is_given()) key = path + outline;
        found.push_back(
            at(key, {.code = "bad-shape",
                     .message = PathsOfParts::quoted(named) + " " + paths.in_text(fault.text, fault.part)}));
    }
    std::ranges::stable_sort(found, {}, &Diagnostic::line);
    return found;
}

}  // namespace knap
