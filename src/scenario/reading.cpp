#include "scenario/reading.hpp"

#include "record/outputs.hpp"
#include "scenario/built_in.hpp"

#include <algorithm>
#include <fstream>
#include <numbers>

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
    return in ? std::optional(std::move(bytes)) : std::nullopt;
}

Index index_in(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<Index>(std::ranges::find(names, name) - names.begin());
}

Index boundary_index(Shape& shape, const std::string& name) {
    const Index found = index_in(shape.boundary_names, name);
    if (found == static_cast<Index>(shape.boundary_names.size())) shape.boundary_names.push_back(name);
    return found;
}

Table Reading::table(const std::string& path) { return {*this, path}; }

std::vector<Table> Reading::list(const std::string& path) {
    std::vector<Table> tables;
    for (std::size_t i = 0; i < values.count(path); ++i) tables.emplace_back(*this, item(path, i));
    return tables;
}

void Reading::unknown_name(const std::string& path, const std::string& what, const std::string& name,
                           const std::vector<std::string>& known) const {
    Diagnostic& d = findings.error("unknown-name", "there is no " + what + " `" + name + "`", at(path));
    d.hint = did_you_mean(name, known);
    d.note = known.empty() ? "there is none" : "known: " + joined(known);
}

std::optional<std::string> Reading::bytes_of(const std::string& path, const std::string& file) const {
    std::optional<std::string> bytes = beside.bytes_of(file);
    if (!bytes)
        findings.error("missing-file", "cannot read `" + (beside.directory / file).string() + "`", at(path)).note =
            "file names are relative to the scenario file";
    return bytes;
}

std::vector<std::string> Reading::drivers() const {
    std::vector<std::string> names;
    for (const Load& load : scenario.loads)
        if (load.drives()) names.push_back(load.name);
    for (const Obstacle& obstacle : scenario.obstacles) names.push_back(obstacle.name);
    return names;
}

void Reading::check_summary_number(const std::string& path, const std::string& name) const {
    const Output* row = find_output("summary", name);
    if (!row || !row->name.starts_with('*')) return;
    const std::string of = name.substr(0, name.size() + 1 - row->name.size());
    const std::vector<std::string> known = drivers();
    if (std::ranges::count(known, of) == 0)
        unknown_name(path, "load that prescribes a motion, or obstacle,", of, known);
}

double Table::radians(const std::string& key) const { return number(key).value_or(0) * std::numbers::pi / 180; }

void Table::error(const std::string& code, const std::string& key, const std::string& text,
                  const std::string& note) const {
    reading_.findings.error(code, "`" + path(key) + "` " + text, reading_.at(path(key))).note = note;
}

void Table::error_at_name(const std::string& code, const std::string& key, const std::string& text,
                          const std::string& note) const {
    reading_.findings.error_at_name(code, "`" + path(key) + "` " + text, reading_.at(path(key))).note = note;
}

void Table::warning(const std::string& code, const std::string& key, const std::string& text,
                    const std::string& note) const {
    reading_.findings.warning(code, "`" + path(key) + "` " + text, reading_.at(path(key))).note = note;
}

std::optional<std::string> Table::the_one(std::initializer_list<const char*> names, bool needed) const {
    const std::vector<std::string> all(names.begin(), names.end());
    std::vector<std::string> chosen;
    std::ranges::copy_if(all, std::back_inserter(chosen), [&](const std::string& name) { return given(name); });
    if (chosen.size() == 1) return chosen.front();
    const std::string note = "exactly one of: " + joined(all);
    if (chosen.size() > 1) {
        const std::string text = "`" + path_ + "` has " + joined(chosen, " and ") + ", and only one of them can hold";
        reading_.findings.error_at_name("exclusive-keys", text, reading_.at(path(chosen.back()))).note = note;
    } else if (needed) {
        error("missing-key", "", "says none of " + joined(all), note);
    }
    return std::nullopt;
}

std::optional<Index> Table::material(const std::string& key) const {
    if (!has(key)) return std::nullopt;
    const std::vector<std::string> known = reading_.scenario.material_names();
    const Index found = index_in(known, text(key));
    if (found < static_cast<Index>(known.size())) return found;
    reading_.unknown_name(path(key), "material", text(key), known);
    return std::nullopt;
}

void Table::check_name(const std::string& key, const std::string& name, const std::string& what) const {
    if (is_name(name)) return;
    reading_.findings.error("bad-name", "`" + name + "` cannot be the name of " + what, reading_.at(path(key))).note =
        rule_for_names;
}

void Table::check_column_name(const std::string& key, const std::string& name, const std::string& what) const {
    check_name(key, name, what);
    const auto duplicate = [&](const std::string& text) {
        reading_.findings.error("duplicate-name", text, reading_.at(path(key))).note = "choose another name";
    };
    const auto taken = [&](const std::string& kind) {
        duplicate("`" + name + "` is the name of " + kind + " already, and both have columns");
    };
    const Scenario& scenario = reading_.scenario;
    if (std::ranges::count(scenario.loads, name, &Load::name) > 0) taken("a load");
    else if (std::ranges::count(scenario.obstacles, name, &Obstacle::name) > 0) taken("an obstacle");
    else if (std::ranges::count(scenario.probes, name, &ProbeOptions::name) > 0) taken("a probe");
    const std::vector<Output>& numbers = output_table("summary").rows;  // a study's "largest_slip" means one thing
    for (const char* file : {"probes.csv", "reactions.csv"})
        for (const Output& row : output_table(file).rows) {
            const std::string column = name + std::string(row.name.substr(1));
            if (row.name.starts_with('*') && std::ranges::count(numbers, column, &Output::name) > 0)
                duplicate("`" + column + "` would be a column, and is a number of the summary");
        }
}

void read_all(Reading& reading) {
    Scenario& scenario = reading.scenario;
    reading.values.fill("", scenario);
    const std::string& name = scenario.name;
    if (reading.values.has("name") && (name.empty() || name.front() == '.' || !std::ranges::all_of(name, is_plain)))
        reading.findings.error("bad-name", "`" + name + "` cannot be the name of a scenario", reading.at("name")).note =
            "letters, digits, - _ and . (it names the run directory)";
    for (const auto read : {read_materials, read_body, read_microstructure, read_supports, read_laws, read_loads,
                            read_run, read_study, read_sweep, warn_of_implausible})
        read(reading);
}

}  // namespace knap
