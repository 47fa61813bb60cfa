// The numbers of a run, from its run.json and its histories.
#include "app/ensemble/ensemble.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "output/history_csv.hpp"
#include "record/run_record.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

namespace knap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double number(const Json& value) { return value.is_number() ? value.get<double>() : NAN; }

struct Column {
    std::vector<double> time, value;
};

/// Empty where no history has the column.
Column column_of(const fs::path& run, const std::string& name, bool explicit_bulk) {
    for (const HistoryFile& file : history_files) {
        if (!file.regular || !fs::exists(run / file.name)) continue;
        const History history = read_csv(run / file.name);
        if (!history.has(name)) continue;
        Column column{history.column("time"), history.column(name)};
        // with the explicit bulk these terms belong to the middle of a step, as its velocities do
        if (explicit_bulk && (name == "kinetic" || name == "strain" || name == "external_work")) {
            const std::vector<double> step = history.column("step");
            for (std::size_t i = 0; i < step.size(); ++i) column.time[i] -= 0.5 * step[i];
        }
        return column;
    }
    return {};
}

double interpolated(double x, double x0, double y0, double x1, double y1) {
    return x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) : y1;
}

/// NaN outside of the times of the column.
double value_at(const Column& column, double time) {
    const auto& t = column.time;
    const double tolerance = 1e-9 * (t.back() - t.front());
    if (time > t.back() + tolerance || time < t.front() - tolerance) return NAN;
    const std::size_t i = std::lower_bound(t.begin(), t.end(), time - tolerance) - t.begin();
    if (i == 0 || t[i] <= time + tolerance) return column.value[i];
    return interpolated(time, t[i - 1], column.value[i - 1], t[i], column.value[i]);
}

/// The first time at which the column reaches `value`, from the side of its first value; NaN if it does not.
double time_of(const Column& column, double value) {
    const auto& v = column.value;
    const auto first = std::ranges::find_if(v, [](double x) { return std::isfinite(x); });
    if (first == v.end()) return NAN;
    const double side = *first < value ? 1 : -1;
    const std::size_t i = std::find_if(first, v.end(), [&](double x) { return side * x >= side * value; }) - v.begin();
    if (i == v.size()) return NAN;
    if (i == 0 || !std::isfinite(v[i - 1])) return column.time[i];
    return interpolated(side * value, side * v[i - 1], column.time[i - 1], side * v[i], column.time[i]);
}

/// Least-squares slope between two times; NaN where the run ended before.
double mean_slope(const Column& column, double from, double to) {
    if (to > column.time.back() + 1e-9 * (to - from)) return NAN;
    Column part;
    for (std::size_t i = 0; i < column.time.size(); ++i)
        if (column.time[i] >= from && column.time[i] <= to)
            part.time.push_back(column.time[i] - from), part.value.push_back(column.value[i]);
    return least_squares_slope(part.time, part.value);
}

double value_of(const StudyQuantity& quantity, const Json& summary, const fs::path& run, bool explicit_bulk) {
    if (!quantity.from_history() && summary.contains(quantity.of)) return number(summary[quantity.of]);
    const Column column = column_of(run, quantity.of, explicit_bulk);
    if (column.time.empty()) return NAN;
    if (quantity.slope) return mean_slope(column, (*quantity.slope)[0], (*quantity.slope)[1]);
    if (quantity.at) return value_at(column, *quantity.at);
    if (quantity.largest) return spread_of(column.value).largest;
    if (!quantity.reaches) return column.value.back();
    const double time = time_of(column, *quantity.reaches);
    return quantity.since.empty() ? time
                                  : time - time_of(column_of(run, quantity.since, explicit_bulk), *quantity.reaches);
}

/// The first error in the log of a run.
std::string error_in(const fs::path& log) {
    std::string text;
    try {
        if (std::error_code none; fs::exists(log, none)) text = read_whole_file(log);
    } catch (const OutputError& error) {
        return error.what();
    }
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("error")) return line.substr(std::min(line.find(": ") + 2, line.size()));
    return "see " + log.filename().string();
}

}  // namespace

std::string RunResult::trouble() const {
    if (status == "done") return gates_hold ? "" : "a gate is violated";
    return reason.empty() ? status : status + ": " + reason;
}

RunResult read_result(const fs::path& run, const std::vector<StudyQuantity>& quantities) {
    const fs::path log = run.string() + ".log";
    RunResult result{.status = "refused", .values = std::vector<double>(quantities.size(), NAN)};
    if (!fs::exists(run / "run.json")) {
        result.reason = error_in(log);
        return result;
    }
    const Json record = read_run_json(run);
    result.status = record.value("status", "");
    result.reason = result.is_under_way() ? error_in(log) : record.value("reason", "");
    result.bulk = record["scheme"].value("bulk", "");
    result.cohesion = record["scheme"].value("cohesion", "");
    for (const Json& gate : record["gates"]) result.gates_hold = result.gates_hold && gate.value("pass", false);
    result.triangles = number(record["triangles"]);
    result.steps = number(record["steps"]);
    for (const Json& n : record["cuts"]) result.cutbacks += number(n);
    result.linear_solves = number(record["linear_solves"]);
    result.factorisations = number(record["factorisations"]);
    result.step = number(record["step_s"]);
    result.cpu = number(record["cpu_s"]) - number(record["cpu_parts_s"]["output"]);
    for (const Json& warning : record["warnings"]) result.warnings.push_back(warning.get<std::string>());
    if (result.status != "done") return result;
    if (const Json& summary = record["summary"]; summary.contains("rest_time"))
        result.at_rest = summary["rest_time"].is_null() ? 0 : 1;
    for (std::size_t q = 0; q < quantities.size(); ++q)
        result.values[q] = value_of(quantities[q], record["summary"], run, result.bulk == "explicit");
    return result;
}

}  // namespace knap
