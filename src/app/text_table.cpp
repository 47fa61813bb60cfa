#include "app/text_table.hpp"

#include "base/text.hpp"
#include "observe/history_csv.hpp"
#include "observe/outputs.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {

std::string number_text(double value, const char* format) {
    if (!std::isfinite(value)) return "-";
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string padded(const std::vector<Row>& rows) {
    std::vector<std::size_t> width;
    for (const Row& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i == width.size()) width.push_back(0);
            width[i] = std::max(width[i], n_characters(row[i]));
        }
    std::string text;
    for (const Row& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) line += (i ? "  " : "") + row[i] + std::string(i + 1 < row.size() ? width[i] - n_characters(row[i]) : 0, ' ');
        text += line + "\n";
    }
    return text;
}

std::string markdown(const std::vector<Row>& rows) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        text += "|";
        for (const std::string& cell : rows[i]) text += " " + cell + " |";
        text += "\n";
        if (i > 0) continue;
        text += "|";
        for (std::size_t k = 0; k < rows[i].size(); ++k) text += "---|";
        text += "\n";
    }
    return text;
}

void drop_empty(std::vector<Row>& rows, std::size_t first) {
    for (std::size_t k = first; k-- > 0;) {
        const bool empty = std::all_of(rows.begin() + 1, rows.end(), [&](const Row& row) { return k >= row.size() || row[k] == "-" || row[k].empty(); });
        if (!empty) continue;
        for (Row& row : rows)
            if (k < row.size()) row.erase(row.begin() + static_cast<std::ptrdiff_t>(k));
    }
}

std::string csv_header(const std::string& table) {
    std::vector<std::string> names;
    for (const Output& row : output_table(table).rows) names.emplace_back(row.name);
    return csv_line(header_of(table, names));
}

std::string csv_number(double value) { return std::isfinite(value) ? shortest(value + 0.0) : ""; }

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace knap
