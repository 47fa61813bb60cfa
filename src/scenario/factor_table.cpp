#include "scenario/factor_table.hpp"

#include <cmath>
#include <fstream>

#include "scenario/units.hpp"

namespace knap {
namespace {

constexpr int most_reports = 5;

std::optional<double> plain_number(const std::string& text) {
    const Quantity quantity = parse_quantity(text);
    if (!quantity.problem.empty() || !quantity.unit.empty()) return std::nullopt;
    return quantity.value;
}

}  // namespace

TimeFunction read_factor_table(const std::filesystem::path& file, const Node& at, Findings& findings) {
    std::error_code code;
    std::ifstream in;
    if (std::filesystem::is_regular_file(file, code)) in.open(file);  // opening a pipe would wait for ever
    if (!in.is_open()) {
        findings.error("missing-file", "cannot read `" + file.string() + "`", at).note = "file names are relative to the scenario file";
        return {};
    }
    TimeFunction history;
    int n_reports = 0;
    const auto report = [&](const std::string& problem, int number, const std::string& line) {
        if (++n_reports > most_reports) return;
        Diagnostic& d = findings.error("bad-csv", problem);
        d.file = file.string();
        d.line = number;
        d.column = 1;
        d.length = std::max<int>(1, static_cast<int>(line.size()));
        d.source_line = line;
        d.note = "each line: time [s], factor";
    };
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (line.ends_with('\r')) line.pop_back();
        const std::string content = line.substr(0, line.find('#'));
        if (content.find_first_not_of(" \t") == std::string::npos) continue;
        const std::size_t comma = content.find_first_of(",;\t");
        const std::optional<double> time = plain_number(content.substr(0, comma));
        const std::optional<double> factor = comma == std::string::npos ? std::nullopt : plain_number(content.substr(comma + 1));
        const bool names = !time && history.time.empty() && n_reports == 0 && number == 1;
        if (names) continue;
        if (!time || !factor)
            report("this line is not `time, factor`", number, line);
        else if (!history.time.empty() && *time < history.time.back())
            report("the times do not ascend", number, line);
        else {
            history.time.push_back(*time);
            history.value.push_back(*factor);
        }
    }
    if (history.time.empty() && n_reports == 0) findings.error("bad-csv", "`" + file.string() + "` holds no line `time, factor`", at);
    return n_reports == 0 ? history : TimeFunction{};
}

}  // namespace knap
