#include "scenario/assemble.hpp"

#include <algorithm>
#include <fstream>

#include "observe/outputs.hpp"
#include "scenario/built_in.hpp"
#include "scenario/names.hpp"

namespace knap {

std::optional<std::string> Beside::bytes_of(const std::string& file) const {
    if (in_binary)
        for (const BuiltIn& built_in : built_in_files())
            if (built_in.name == file) return built_in.text;
    std::error_code code;
    const std::filesystem::path path = directory / file;
    if (!std::filesystem::is_regular_file(path, code)) return std::nullopt;  // opening a pipe would wait for ever
    std::ifstream in(path, std::ios::binary);
    if (!in) return std::nullopt;
    std::string bytes(std::filesystem::file_size(path, code), '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!in) return std::nullopt;
    return bytes;
}

const Node& Assembly::at(std::string path) const {
    static const Node nowhere;
    while (!path.empty()) {
        if (const Entry* entry = values.find(path); entry && (entry->node.place.line > 0 || !entry->node.set_by.empty())) return entry->node;
        const std::size_t cut = path.find_last_of(".[");
        path.resize(cut == std::string::npos ? 0 : cut);
    }
    return nowhere;
}

std::optional<std::string> Assembly::the_one(const std::string& table, std::initializer_list<const char*> names, bool needed) const {
    std::vector<std::string> all, given;
    for (const char* name : names) {
        all.emplace_back(name);
        if (values.given(table + "." + name)) given.emplace_back(name);
    }
    if (given.size() == 1) return given.front();
    if (given.size() > 1) {
        const std::string last = table + "." + given.back();
        findings.error_at_name("exclusive-keys", "`" + table + "` has " + joined(given, " and ") + ", and only one of them can hold", at(last)).note =
            "exactly one of: " + joined(all);
    } else if (needed) {
        findings.error("missing-key", "`" + table + "` says none of " + joined(all), at(table)).note = "exactly one of: " + joined(all);
    }
    return std::nullopt;
}

void Assembly::unknown_name(const std::string& path, const std::string& what, const std::string& name,
                            const std::vector<std::string>& known) const {
    Diagnostic& d = findings.error("unknown-name", "there is no " + what + " `" + name + "`", at(path));
    d.hint = did_you_mean(name, known);
    d.note = known.empty() ? "there is none" : "known: " + joined(known);
}

std::optional<Index> Assembly::material_at(const std::string& path) const {
    const std::optional<std::string> name = values.text(path);
    if (!name) return std::nullopt;
    std::vector<std::string> known;
    for (const NamedMaterial& material : scenario.materials) known.push_back(material.name);
    const auto found = std::find(known.begin(), known.end(), *name);
    if (found != known.end()) return static_cast<Index>(found - known.begin());
    unknown_name(path, "material", *name, known);
    return std::nullopt;
}

void check_name(const Assembly& assembly, const std::string& path, const std::string& name, const std::string& what) {
    if (!is_name(name)) assembly.findings.error("bad-name", "`" + name + "` cannot be the name of " + what, assembly.at(path)).note = rule_for_names;
}

void Assembly::check_column_name(const std::string& path, const std::string& name, const std::string& what) const {
    check_name(*this, path, name, what);
    const auto taken = [&](const std::string& kind) {
        findings.error("duplicate-name", "`" + name + "` is the name of " + kind + " already, and both have columns", at(path)).note = "choose another name";
    };
    if (std::ranges::find(scenario.loads, name, &Load::name) != scenario.loads.end()) taken("a load");
    else if (std::ranges::find(scenario.obstacles, name, &Obstacle::name) != scenario.obstacles.end()) taken("an obstacle");
    else if (std::ranges::find(scenario.probes, name, &ProbeOptions::name) != scenario.probes.end()) taken("a probe");
    const std::vector<Output>& numbers = output_table("summary").rows;  // a study that asks for "largest_slip" means one thing
    for (const char* table : {"probes.csv", "reactions.csv"})
        for (const Output& row : output_table(table).rows)
            if (const std::string column = name + std::string(row.name.substr(1)); row.name.starts_with('*') && std::ranges::count(numbers, column, &Output::name) > 0)
                findings.error("duplicate-name", "`" + column + "` would be a column, and is a number of the summary", at(path)).note = "choose another name";
}

std::vector<std::string> Assembly::drivers() const {
    std::vector<std::string> names;
    for (const Load& load : scenario.loads)
        if (load.drives()) names.push_back(load.name);
    for (const Obstacle& obstacle : scenario.obstacles) names.push_back(obstacle.name);
    return names;
}

void Assembly::check_summary_number(const std::string& path, const std::string& name) const {
    const Output* row = find_output("summary", name);
    if (!row || !row->name.starts_with('*')) return;
    const std::string of = name.substr(0, name.size() + 1 - row->name.size());
    const std::vector<std::string> known = drivers();
    if (std::find(known.begin(), known.end(), of) == known.end()) unknown_name(path, "load that prescribes a motion, or obstacle,", of, known);
}

void assemble(Assembly& assembly) {
    Scenario& scenario = assembly.scenario;
    const Values& values = assembly.values;
    scenario.name = values.text("name").value_or("");
    scenario.title = values.text("title").value_or("");
    scenario.seed = static_cast<std::uint64_t>(values.has("seed") ? values.find("seed")->node.integer : 1);
    if (values.has("name") && (scenario.name.empty() || scenario.name.front() == '.' || !std::all_of(scenario.name.begin(), scenario.name.end(), is_plain)))
        assembly.findings.error("bad-name", "`" + scenario.name + "` cannot be the name of a scenario", assembly.at("name")).note =
            "letters, digits, - _ and . (it names the run directory)";

    assemble_materials(assembly);
    assemble_mesh_options(assembly);
    assemble_shape(assembly);
    assemble_inclusions(assembly);
    assemble_joints(assembly);
    assemble_maps(assembly);
    assemble_grains(assembly);
    assemble_foundations(assembly);
    assemble_laws(assembly);
    assemble_loads(assembly);
    assemble_obstacles(assembly);
    assemble_time(assembly);
    assemble_output(assembly);
    assemble_probes(assembly);
    assemble_specimen(assembly);
    assemble_figures(assembly);
    assemble_limits(assembly);
    assemble_expectations(assembly);
    assemble_study(assembly);
    assemble_sweep(assembly);
    assemble_plausibility(assembly);
}

}  // namespace knap
