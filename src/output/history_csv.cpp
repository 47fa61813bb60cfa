#include "output/history_csv.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <ranges>
#include <sstream>

namespace knap {
namespace {

std::vector<std::string_view> cells(std::string_view line) {
    std::vector<std::string_view> found;
    for (const auto cell : std::views::split(line, ',')) found.emplace_back(cell.begin(), cell.end());
    return found;
}

/// The next line without its line end (LF or CR LF); false at the end of the file.
bool next_line(std::istream& in, std::string& line) {
    if (!std::getline(in, line)) return false;
    if (line.ends_with('\r')) line.pop_back();
    return true;
}

}  // namespace

bool History::has(const std::string& column) const { return std::ranges::count(columns, column) > 0; }

std::size_t History::place_of(const std::string& name) const {
    const auto j = static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin());
    if (j == columns.size())
        throw UserError("damaged-file",
                        (file.empty() ? "a history" : "`" + file + "`") + " has no column `" + name + "`");
    return j;
}

std::vector<double> History::column(const std::string& name) const {
    const std::size_t j = place_of(name);
    std::vector<double> values;
    for (const auto& row : rows) values.push_back(row.at(j));
    return values;
}

std::string_view name_in_header(std::string_view header) {
    return header.ends_with(']') ? header.substr(0, header.rfind(" [")) : header;
}

std::string csv_line(const std::vector<std::string>& columns) { return joined(columns, ","); }

std::string csv_line(const std::vector<double>& row) {
    std::vector<std::string> texts;
    for (const double value : row) texts.push_back(std::isnan(value) ? "" : shortest(value + 0.0));  // no minus zero
    if (!row.empty() && std::isnan(row.back())) texts.back() = "nan";  // an empty one would be a line that is cut off
    return joined(texts, ",");
}

void write_csv(const History& history, const std::vector<std::string>& header, const std::filesystem::path& path) {
    std::string text = csv_line(header) + '\n';
    for (const auto& row : history.rows) text += csv_line(row) + '\n';
    write_whole_file(path, text);
}

History read_csv(const std::filesystem::path& path) {
    std::istringstream in(read_given_file(path, "missing-file"));
    std::string line;
    if (!next_line(in, line)) throw UserError("damaged-file", "`" + path.string() + "` is empty");
    History history{.file = path.string()};
    for (const std::string_view name : cells(line)) history.columns.emplace_back(name_in_header(name));
    const std::size_t n_columns = history.columns.size();
    while (next_line(in, line)) {
        if (line.empty()) continue;
        auto& row = history.rows.emplace_back();
        const auto fail = [&](const std::string& problem) {
            const std::string number = std::to_string(history.rows.size() + 1);
            throw UserError("damaged-file", path.string() + ":" + number + ": " + problem);
        };
        for (const std::string_view cell : cells(line)) {
            row.push_back(std::numeric_limits<double>::quiet_NaN());
            // the last column is never empty, so an empty one means that the line is cut off
            if (cell.empty() && row.size() < n_columns) continue;
            const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row.back());
            if (error != std::errc() || end != cell.data() + cell.size())
                fail("`" + std::string(cell) + "` is not a number");
        }
        if (row.size() != n_columns) fail("a row needs " + std::to_string(n_columns) + " numbers");
    }
    return history;
}

}  // namespace knap
