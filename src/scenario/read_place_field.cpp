// A stress, traction, pressure or angle that varies: formulas of x, y and t, or a csv file of points.
#include "base/error.hpp"
#include "scenario/formulas.hpp"
#include "scenario/reading.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace knap {

bool looks_like_formula(std::string_view text) {
    text = trimmed(text);
    const std::size_t number = std::min(text.find_first_not_of("+-0123456789.eE "), text.size());
    if (number == 0 || number == text.size()) return true;
    return text.substr(number).find_first_of("*+-^()xy") != std::string_view::npos;
}

PlaceField::Formula parse_formula(std::string_view text, std::string_view unit) {
    text = trimmed(text);
    if (const std::size_t blank = text.find_last_of(' '); blank < text.size()) {
        const Quantity one = parse_quantity("1 " + std::string(text.substr(blank + 1)));
        if (one.problem.empty() && one.dimension == dimension_of(unit))
            return {.of_place = Expression(text.substr(0, blank)), .unit = one.value};
    }
    try {
        return {.of_place = Expression(text)};
    } catch (const UserError&) {
        const std::string word(text.substr(std::min(text.find_last_of(' ') + 1, text.size())));
        const Quantity one = parse_quantity("1 " + word);
        if (one.unknown_unit) {
            const std::string meant = unit_suggestion(word, unit);
            if (!meant.empty())
                throw UserError("bad-formula", "`" + word + "` is no unit; " + meant, "a unit that exists");
        }
        if (!one.problem.empty() || one.unit.empty()) throw;
        throw UserError("bad-formula",
                        "`" + word + "` behind it is a unit of " + kind_name(one.dimension) + ", not of " +
                            kind_name(dimension_of(unit)),
                        "a formula of x, y [m] and t [s]");
    }
}

namespace {

constexpr int max_point_reports = 5;  // of the mistakes of one file

/// Reads a csv file of points, and reports its mistakes with their lines.
class PointFile {
public:
    PointFile(const Table& table, const std::string& key, const std::string& bytes,
              const std::vector<std::string>& columns, std::string_view unit)
        : table_(table), key_(key), bytes_(bytes), names_{"x", "y"}, of_values_(unit) {
        names_.insert(names_.end(), columns.begin(), columns.end());
        for (const std::string& name : names_) {
            const bool is_place = name == "x" || name == "y";
            const std::string of_name(is_place ? "m" : unit == "Pa" ? "MPa" : unit);
            note_ += (note_.empty() ? "as `" : ", ") + name + " [" + of_name + "]";
        }
        note_ += "`, or with t [s]: a line for each point";
        names_.emplace_back("t");
    }

    /// Empty after an error.
    std::vector<PointTable::Row> read() {
        std::map<std::array<double, 3>, int> line_at;
        for_each_line(bytes_, [&](int number, std::string_view content) {
            if (has_decimal_comma(content)) return report(number, decimal_comma), false;
            const std::vector<std::string> cells = cells_of(content, ",;\t");
            if (column_.empty()) return read_names(cells, number);
            if (const auto row = row_of(cells, number)) {
                const auto [first, is_new] = line_at.try_emplace({row->time, row->place.x(), row->place.y()}, number);
                if (is_new) rows_.push_back(*row);
                else report(number, "the point of line " + std::to_string(first->second) + " again");
            }
            return true;
        });
        if (n_reports_ == 0 && rows_.size() < 2) report(0, "the file has no two points");
        if (n_reports_ > 0) rows_.clear();
        return std::move(rows_);
    }

    void report(int line, const std::string& problem) {
        if (++n_reports_ <= max_point_reports) table_.error_in_file("bad-csv", key_, bytes_, line, problem, note_);
    }

private:
    /// The places and units of the columns; false after an error.
    bool read_names(const std::vector<std::string>& cells, int number) {
        std::vector<ColumnTitle> titles;
        for (const std::string& cell : cells)
            if (titles.push_back(column_title(cell)); std::ranges::find(names_, titles.back().name) == names_.end())
                return report(number, "the first line has a column `" + titles.back().name + "` that nothing reads"),
                       false;
        for (const std::string& name : names_) {
            const auto title = std::ranges::find(titles, name, &ColumnTitle::name);
            if (title == titles.end() && name == "t") return names_.pop_back(), true;  // it is the last one
            if (title == titles.end()) return report(number, "the first line names no column `" + name + "`"), false;
            if (!title->unit) return report(number, "the column `" + name + "` has no unit"), false;
            const std::string_view kind = name == "x" || name == "y" ? "m" : name == "t" ? "s" : of_values_;
            const Quantity one = parse_quantity("1 " + *title->unit);
            if (!one.problem.empty() || one.dimension != dimension_of(kind))
                return report(number, "the unit `" + *title->unit + "` of " + name + " is not one of " +
                                          kind_name(dimension_of(kind))),
                       false;
            column_.push_back(title - titles.begin()), unit_.push_back(one.value);
        }
        return true;
    }

    std::optional<PointTable::Row> row_of(const std::vector<std::string>& cells, int number) {
        PointTable::Row row{.place = Vec2::Zero()};
        for (std::size_t k = 0; k < names_.size(); ++k) {
            const std::string text = column_[k] < cells.size() ? cells[column_[k]] : "";
            const Quantity quantity = parse_quantity(text);
            if (!quantity.problem.empty() || !quantity.unit.empty() || !std::isfinite(quantity.value)) {
                report(number, names_[k] + " of this line is not a number");
                return std::nullopt;
            }
            (k < 2              ? row.place[static_cast<Index>(k)]
             : names_[k] == "t" ? row.time
                                : row.value[k - 2]) = unit_[k] * quantity.value;
        }
        return row;
    }

    const Table& table_;
    const std::string key_;
    const std::string& bytes_;
    std::vector<std::string> names_;
    std::string_view of_values_;  // their unit in SI
    std::string note_;
    std::vector<std::size_t> column_;  // of each name
    std::vector<double> unit_;
    std::vector<PointTable::Row> rows_;
    int n_reports_ = 0;
};

std::shared_ptr<const PointTable> read_points(const Table& table, const std::string& key,
                                              const std::vector<std::string>& columns, std::string_view unit) {
    const auto bytes = table.bytes_of(key);
    if (!bytes) return nullptr;
    PointFile file(table, key, *bytes, columns, unit);
    const std::vector<PointTable::Row> rows = file.read();
    if (rows.empty()) return nullptr;
    std::string name = table.path(key);
    std::ranges::replace_if(
        name, [](char c) { return c == '[' || c == '.'; }, '_');
    std::erase(name, ']');
    table.scenario().files.push_back({table.path(key), name + ".csv", *bytes});
    try {
        return std::make_shared<const PointTable>(rows);
    } catch (const UserError& error) {
        file.report(0, error.diagnostics.front().message);
        return nullptr;
    }
}

}  // namespace

std::shared_ptr<const PlaceField> read_place_field(const Table& table, const std::string& key,
                                                   const std::vector<std::string>& columns, bool also_of_numbers) {
    const Node* const given = table.has(key) ? table.reading().values.find(table.path(key)) : nullptr;
    if (given == nullptr) return nullptr;
    PlaceField field{.path = table.path(key), .text = given->text, .n_values = columns.size()};
    if (given->text.ends_with(".csv")) {
        field.table = read_points(table, key, columns, given->key->unit);
        return field.table ? std::make_shared<const PlaceField>(std::move(field)) : nullptr;
    }
    bool varies = also_of_numbers;
    for (std::size_t k = 0; k < columns.size(); ++k) {
        const Node& node = given->children.empty() ? *given : given->children[k];
        varies = varies || !node.is_number();
        field.formulas[k] = parse_formula(node.is_number() ? shortest(node.number) : node.text, given->key->unit);
    }
    return varies ? std::make_shared<const PlaceField>(std::move(field)) : nullptr;
}

}  // namespace knap
