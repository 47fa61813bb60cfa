#include "record/tables.hpp"

#include "record/outputs.hpp"

#include <algorithm>
#include <cassert>

namespace knap {

void Tables::add(History Histories::*table, std::vector<std::string> columns, Line line) {
    (histories_.*table).columns = std::move(columns);
    const char* file = std::ranges::find(history_files, table, &HistoryFile::table)->name;
    sheets_.push_back({file, table, std::move(line), {}});
}

void Tables::open() {
    if (directory_.empty()) return;
    for (Sheet& sheet : sheets_) {
        write(sheet.file, histories_.*sheet.table);
        sheet.growing.emplace(directory_ / sheet.file);
    }
}

void Tables::close() {
    for (Sheet& sheet : sheets_)
        if (sheet.growing) sheet.growing->close(), sheet.growing.reset();
}

void Tables::write_lines(const State& now) {
    for (Sheet& sheet : sheets_)
        if (sheet.line) append(sheet, sheet.line(now));
}

void Tables::add_line(History Histories::*table, std::vector<double> line) {
    append(*std::ranges::find(sheets_, table, &Sheet::table), std::move(line));
}

void Tables::append(Sheet& sheet, std::vector<double> line) {
    History& table = histories_.*sheet.table;
    assert(line.size() == table.columns.size());
    std::vector<std::vector<double>>& rows = table.rows;
    rows.push_back(std::move(line));
    if (sheet.growing) sheet.growing->add(csv_line(rows.back()) + "\n");
}

void Tables::write(const char* file, const History& table) const {
    if (directory_.empty()) return;
    write_csv(table, header_of(file, table.columns, celsius_), directory_ / file);
}

void Tables::write_missing() const {
    for (std::error_code none; const Sheet& sheet : sheets_)
        if (!std::filesystem::exists(directory_ / sheet.file, none)) write(sheet.file, histories_.*sheet.table);
}

}  // namespace knap
