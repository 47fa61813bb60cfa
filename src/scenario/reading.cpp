#include "scenario/reading.hpp"

#include "analysis/fluids.hpp"
#include "base/whole_file.hpp"
#include "record/outputs.hpp"
#include "scenario/built_in.hpp"
#include "scenario/exclusions.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace knap {

std::optional<std::string> FileSource::bytes_of(const std::string& file) const {
    if (in_program)
        for (const BuiltIn& built_in : built_in_files())
            if (built_in.name == file) return built_in.text;
    std::error_code code;
    const std::filesystem::path path = directory / file;
    if (!std::filesystem::is_regular_file(path, code)) return std::nullopt;  // opening a pipe would block
    try {
        return read_whole_file(path);
    } catch (const OutputError&) {
        return std::nullopt;
    }
}

Index boundary_index(Shape& shape, const std::string& name) {
    const auto found = std::ranges::find(shape.boundary_names, name) - shape.boundary_names.begin();
    if (found == std::ssize(shape.boundary_names)) shape.boundary_names.push_back(name);
    return static_cast<Index>(found);
}

std::vector<std::string> cells_of(std::string_view line, std::string_view separators) {
    std::vector<std::string> cells;
    while (true) {
        const std::size_t end = std::min(line.find_first_of(separators), line.size());
        cells.emplace_back(trimmed(line.substr(0, end)));
        if (end == line.size()) return cells;
        line.remove_prefix(end + 1);
    }
}

bool has_decimal_comma(std::string_view line) {
    if (line.find_first_of(";\t") == std::string_view::npos) return false;
    const auto is_digit = [&](std::size_t i) { return i < line.size() && line[i] >= '0' && line[i] <= '9'; };
    for (std::size_t i = line.find(','); i < line.size(); i = line.find(',', i + 1))
        if (i > 0 && is_digit(i - 1) && is_digit(i + 1)) return true;
    return false;
}

ColumnTitle column_title(std::string_view cell) {
    const std::size_t open = std::min(cell.find('['), cell.size()), close = cell.find(']', open);
    ColumnTitle title{.name = std::string(trimmed(cell.substr(0, open)))};
    if (close != std::string_view::npos) title.unit = trimmed(cell.substr(open + 1, close - open - 1));
    return title;
}

std::vector<Vec2> read_pairs(const Table& table, const PairsFile& file) {
    constexpr int max_reports = 5;
    const auto bytes = table.bytes_of(file.source);
    if (!bytes) return {};
    const std::size_t between = file.line.find(", ");
    const std::array<std::string, 2> expected{file.line.substr(0, between), file.line.substr(between + 2)};
    std::array<std::string, 2> unit;  // by the line of names
    bool lacks_unit = false, has_content = false;
    const auto number_in = [&](const std::string& text, int column) -> std::optional<double> {
        Quantity quantity = parse_quantity(text);
        if (!quantity.problem.empty()) return std::nullopt;
        if (file.unit.empty() && !quantity.unit.empty()) return std::nullopt;
        if (quantity.unit.empty() && !unit[column].empty()) quantity = parse_quantity(text + " " + unit[column]);
        if (file.unit.empty()) return quantity.value;
        lacks_unit = lacks_unit || quantity.unit.empty();
        const bool fits = quantity.problem.empty() && quantity.dimension == dimension_of(file.unit);
        return fits ? std::optional(quantity.value) : std::nullopt;
    };
    /// Columns in the other order would be taken for one another; columns with units must have the names, too.
    const auto fault_of_names = [&](const std::array<std::string, 2>& names) -> std::string {
        const bool are_swapped = names[0] == expected[1] && names[1] == expected[0];
        if (are_swapped || (!file.unit.empty() && names != expected))
            return "the columns are `" + names[0] + ", " + names[1] + "` and not `" + file.line + "`";
        const std::string_view kind = file.unit.empty() ? file.first_unit : file.unit;
        for (const std::string& given : unit)
            if (const Quantity one = parse_quantity("1 " + given);
                !given.empty() && (!one.problem.empty() || one.dimension != dimension_of(kind)))
                return "the unit `" + given + "` is not one of the kind of `" + std::string(kind) + "`";
        return {};
    };
    std::vector<Vec2> pairs;
    double direction = file.unit.empty() ? 1 : 0;
    int n_reports = 0;
    for_each_line(*bytes, [&](int number, std::string_view line) {
        const auto report = [&](const std::string& problem) {
            if (++n_reports <= max_reports)
                table.error_in_file("bad-csv", file.source, *bytes, number, problem, file.note);
        };
        const std::string content(line);
        if (has_decimal_comma(line)) return report(decimal_comma), false;
        const std::size_t comma = std::min(content.find_first_of(",;\t"), content.size());
        const std::string column_1 = content.substr(0, comma),
                          column_2 = content.substr(std::min(comma + 1, content.size()));
        lacks_unit = false;
        const auto first = number_in(column_1, 0), second = number_in(column_2, 1);
        if (!std::exchange(has_content, true) && !first && !lacks_unit) {  // names
            const ColumnTitle title_1 = column_title(column_1), title_2 = column_title(column_2);
            if (!file.unit.empty()) unit = {title_1.unit.value_or(""), title_2.unit.value_or("")};
            else if (!file.first_unit.empty()) unit[0] = title_1.unit.value_or("");
            if (const std::string fault = fault_of_names({title_1.name, title_2.name}); !fault.empty()) {
                report(fault);
                return false;
            }
            return true;
        }
        const double change = pairs.empty() || !first ? 0 : *first - pairs.back().x();
        if (direction == 0) direction = change;
        if (lacks_unit) report("a number of this line has no unit, and the line of names gives none");
        else if (!first || !second) report("this line is not `" + file.line + "`");
        else if (change * direction < 0)
            report("the " + file.first +
                   (file.unit.empty() ? " do not ascend"
                                      : " turn back: the lines are out of order (`points` may overhang)"));
        else pairs.emplace_back(*first, *second);
        return true;
    });
    if (pairs.empty() && n_reports == 0) table.error("bad-csv", file.source, "has no line `" + file.line + "`");
    if (n_reports > 0) return {};
    std::vector<Node> points;
    for (const Vec2& pair : pairs)
        points.push_back(Node::of_list({Node::of_number(pair.x()), Node::of_number(pair.y())}));
    if (!points.empty()) table.replace(file.source, file.key, Node::of_list(std::move(points)));
    return pairs;
}

std::string first_of(std::vector<std::string> names) {
    constexpr std::size_t max = 24;
    const std::size_t n = names.size();
    if (n <= max) return joined(names);
    names.resize(max);
    return joined(names) + ", ... (" + std::to_string(n) + ")";
}

Table Reading::table(const std::string& path) {
    static Node absent{.origin = Origin::constant_default};
    const Node* node = values.find(path);
    return {*this, path, node ? const_cast<Node&>(*node) : absent};
}

std::vector<Table> Reading::list(const std::string& path) {
    std::vector<Table> tables;
    Node* node = const_cast<Node*>(values.find(path));
    for (std::size_t i = 0; node && i < node->children.size(); ++i) {
        Node& child = node->children[i];
        tables.emplace_back(*this, child.name.empty() ? item(path, i) : joined_path(path, child.name), child);
    }
    return tables;
}

std::optional<Index> Reading::find(const std::string& path, const std::string& what, const std::string& name,
                                   const std::vector<std::string>& known) const {
    const auto found = std::ranges::find(known, name);
    if (found != known.end()) return static_cast<Index>(found - known.begin());
    findings.error("unknown-name", "there is no " + what + " `" + name + "`", values.place_of(path),
                   known.empty() ? "there is none" : "known: " + first_of(known), did_you_mean(name, known));
    return std::nullopt;
}

std::vector<NamedEnd> Reading::drivers() const {
    std::vector<NamedEnd> found;
    for (Index i = 0; const Load& load : scenario.loads) {
        if (load.drives()) found.emplace_back(load.name, GaugeEnd{.kind = GaugeEnd::Kind::load, .number = i});
        ++i;
    }
    for (Index i = 0; const Obstacle& obstacle : scenario.obstacles)
        found.emplace_back(obstacle.name, GaugeEnd{.kind = GaugeEnd::Kind::obstacle, .number = i++});
    return found;
}

void Reading::check_summary_number(const std::string& path, const std::string& name) const {
    const Output* row = find_output("summary", name);
    if (!row || !row->name.starts_with('*')) return;
    const auto has = [&](const auto& numbers) { return std::ranges::count(numbers, row->name, &Output::name) > 0; };
    const char* what = "load with prescribed motion, or obstacle,";
    std::vector<std::string> known;
    if (has(collector_numbers())) {
        what = "collector";
        for (const CollectorOptions& collector : scenario.collectors) known.push_back(collector.name);
    } else if (has(fluid_numbers())) {
        what = "[[pressure]]";
        for (const CrackPressure& fluid : scenario.crack_pressures) known.push_back(fluid.name);
    } else {
        for (const auto& [driver, end] : drivers()) known.push_back(driver);
    }
    find(path, what, name.substr(0, name.size() + 1 - row->name.size()), known);
}

void Table::compute(std::string_view key, Node value) const {
    if (Node* node = at(key); node && node->origin == Origin::computed_default) assign(*node, std::move(value));
}

void Table::replace(std::string_view key, const std::string& by, Node value) const {
    Node& node = *at(key);
    assign(node, std::move(value));
    node.name = by;
    node.key = find_key(joined_path(node.key->parent(), by));
}

void Table::error(const std::string& code, std::string_view key, const std::string& text, const std::string& note,
                  const std::string& hint) const {
    reading_.findings.error(code, message(key, text), reading_.values.place_of(path(key)), note, hint);
}

void Table::warning(const std::string& code, std::string_view key, const std::string& text, const std::string& note,
                    const std::string& hint) const {
    reading_.findings.warning(code, message(key, text), reading_.values.place_of(path(key)), note, hint);
}

void Table::error_in_file(const std::string& code, std::string_view key, const std::string& text, int line,
                          const std::string& problem, const std::string& note) const {
    reading_.findings.add(at_line({.code = code, .message = problem, .note = note},
                                  reading_.files.directory / this->text(key), text, line));
}

Index Table::new_joint_set() const {
    reading_.joint_tables.push_back(path_);
    scenario().law_of_joint.push_back(-1);
    return static_cast<Index>(scenario().law_of_joint.size()) - 1;
}

void Table::exclude(std::string_view key, std::string_view one, std::string_view other, const std::string& cure) const {
    const std::size_t value = one.find(" =");
    std::string text = value < one.size() ? std::string(one.substr(value + 1)) + " " : "";
    if (value < one.size() && !one.starts_with(key)) text = "makes " + std::string(one) + ", which ";
    error("exclusive-keys", key,
          text + "does not go together with " + std::string(other) + ": " + std::string(reason_against(one, other)),
          cure);
}

std::optional<std::string> Table::one_of(const std::vector<std::string>& names, bool needed) const {
    std::vector<std::string> chosen;
    std::ranges::copy_if(names, std::back_inserter(chosen), [&](const std::string& name) { return given(name); });
    if (chosen.size() == 1) return chosen.front();
    const std::string note = "exactly one of: " + joined(names);
    if (chosen.size() > 1)
        reading_.findings.error("exclusive-keys",
                                "`" + path_ + "` has " + joined(chosen, " and ") + ", of which only one is allowed",
                                *at(chosen.back()), note);
    else if (needed) error("missing-key", "", "has none of " + joined(names), note);
    return std::nullopt;
}

std::optional<Index> Table::material(std::string_view key) const {
    return has(key) ? reading_.find(path(key), "material", text(key), scenario().material_names()) : std::nullopt;
}

std::optional<Expression> Table::formula(std::string_view key) const {
    try {
        return Expression(text(key));
    } catch (const UserError& problem) {
        error("bad-formula", key, "is no formula: " + problem.diagnostics.front().message,
              problem.diagnostics.front().note);
        return std::nullopt;
    }
}

std::optional<std::string> Table::bytes_of(std::string_view key) const {
    std::optional<std::string> bytes = reading_.files.bytes_of(text(key));
    if (!bytes)
        error("missing-file", key, "cannot be read: " + (reading_.files.directory / text(key)).string(),
              "file names are relative to the scenario file");
    return bytes;
}

void Table::check_column_name(const std::string& name) const {
    const auto is_used = [&](const auto& list) {
        return std::ranges::any_of(list, [&](const auto& other) { return other.name == name; });
    };
    const std::string other = is_used(scenario().loads)             ? "a load"
                              : is_used(scenario().obstacles)       ? "an obstacle"
                              : is_used(scenario().crack_pressures) ? "a fluid"
                              : is_used(scenario().probes)          ? "a probe"
                              : is_used(scenario().collectors)      ? "a collector"
                                                                    : "";
    if (!other.empty())
        error("duplicate-name", "name", ": `" + name + "` is the name of " + other + " already, and both have columns");
    const std::vector<Output>& numbers = output_table("summary").rows;  // "largest_slip" must have one meaning
    for (const char* file : {"probes.csv", "reactions.csv", "fluids.csv", "summary"})
        for (const Output& row : output_table(file).rows) {
            const std::string column = name + std::string(row.name.substr(1));
            if (row.name.starts_with('*') && std::ranges::count(numbers, column, &Output::name) > 0)
                error("duplicate-name", "name", ": its column `" + column + "` has the name of a summary number");
        }
}

void read_all(Reading& reading) {
    const Table top(reading, "", reading.values.root);
    top.fill(reading.scenario);
    const std::string& name = reading.scenario.name;
    if (top.has("name") && (name.empty() || name.front() == '.' || !std::ranges::all_of(name, is_plain)))
        top.error("bad-name", "name", "= \"" + name + "\" cannot name a run directory", "letters, digits, - _ and .");
    for (const auto read : {read_materials, read_body, read_microstructure, read_supports, read_laws, read_loads,
                            read_pressures, read_run, check_laws, read_heat, read_contact, read_excavations, read_rigid,
                            read_adapt, read_strength, read_toughness, read_study, read_sweep, warn_of_implausible})
        read(reading);
}

}  // namespace knap
