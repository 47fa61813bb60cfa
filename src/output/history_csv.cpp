#include "output/history_csv.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>

namespace knap {

namespace {

/// An empty cell for NaN, and no minus zero.
std::string cell_text(double value) { return std::isnan(value) ? "" : shortest(value + 0.0); }

std::vector<std::string_view> cells(std::string_view line) {
    std::vector<std::string_view> found;
    while (true) {
        const std::size_t comma = line.find(',');
        found.push_back(line.substr(0, comma));
        if (comma == std::string_view::npos) return found;
        line.remove_prefix(comma + 1);
    }
}

/// The next line without its line end (either kind); false at the end of the file.
bool next_line(std::istream& in, std::string& line) {
    if (!std::getline(in, line)) return false;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
}

}  // namespace

std::string_view name_in_header(std::string_view header) { return header.ends_with(']') ? header.substr(0, header.rfind(" [")) : header; }

std::string csv_line(const std::vector<std::string>& columns) {
    std::string line;
    for (const std::string& name : columns) line += (line.empty() ? "" : ",") + name;
    return line;
}

std::string csv_line(const std::vector<double>& row) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) line += (i == 0 ? "" : ",") + cell_text(row[i]);
    return line;
}

void write_csv(const History& history, const std::vector<std::string>& header, const std::filesystem::path& path) {
    std::string text = csv_line(header) + '\n';
    for (const auto& row : history.rows) text += csv_line(row) + '\n';
    write_whole_file(path, text);
}

History read_csv(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string line;
    if (!in || !next_line(in, line)) throw UserError("missing-file", "cannot read `" + path.string() + "`");
    History history{.file = path.string()};
    for (const std::string_view name : cells(line)) history.columns.emplace_back(name_in_header(name));
    while (next_line(in, line)) {
        if (line.empty()) continue;
        const std::string place = path.string() + ":" + std::to_string(history.rows.size() + 2);
        auto& row = history.rows.emplace_back();
        for (const std::string_view cell : cells(line)) {
            double value = std::numeric_limits<double>::quiet_NaN();
            if (cell.empty() && row.size() + 1 < history.columns.size()) {  // what never happened; every table ends with what always is, so a line that was cut is told
                row.push_back(value);
                continue;
            }
            const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
            if (error != std::errc() || end != cell.data() + cell.size()) throw UserError("damaged-file", place + ": `" + std::string(cell) + "` is not a number");
            row.push_back(value);
        }
        if (row.size() != history.columns.size()) throw UserError("damaged-file", place + ": a row needs " + std::to_string(history.columns.size()) + " numbers");
    }
    return history;
}

}  // namespace knap
