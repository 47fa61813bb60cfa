#include "app/run_result.hpp"

#include "app/read_run.hpp"
#include "base/text.hpp"
#include "observe/history_csv.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace knap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double number(const Json& value) { return value.is_number() ? value.get<double>() : NAN; }

/// Time and one column of the history that has it; empty where none has.
struct Column {
    std::vector<double> time, value;
};

/// The explicit bulk has its velocities in the middle of a step, and its kinetic and strain energy and the work of the loads are those of that time.
void shift_to_middle(const History& energy, std::vector<double>& time) {
    const std::vector<double> step = energy.column("step");
    for (std::size_t i = 0; i < time.size(); ++i) time[i] -= 0.5 * step[i];
}

Column column_of(const fs::path& run, const std::string& name, bool explicit_bulk) {
    for (const char* file : {"energy.csv", "cracks.csv", "reactions.csv", "probes.csv", "stress_strain.csv"}) {
        if (!fs::exists(run / file)) continue;
        const History history = read_csv(run / file);
        if (!history.has(name)) continue;
        Column column{history.column("time"), history.column(name)};
        if (explicit_bulk && (name == "kinetic" || name == "strain" || name == "external_work")) shift_to_middle(history, column.time);
        return column;
    }
    return {};
}

/// Linear between two lines.
double between(double x, double x0, double y0, double x1, double y1) { return x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) : y1; }

double value_at(const Column& column, double time) {
    const auto& t = column.time;
    const double slack = 1e-9 * (t.back() - t.front());
    if (time > t.back() + slack || time < t.front() - slack) return NAN;  // never reached
    const std::size_t i = std::lower_bound(t.begin(), t.end(), time - slack) - t.begin();
    if (i == 0 || t[i] <= time + slack) return column.value[i];
    return between(time, t[i - 1], column.value[i - 1], t[i], column.value[i]);
}

/// First time, from whichever side it starts.
double time_when(const Column& column, double value) {
    const double side = column.value.front() < value ? 1 : -1;
    for (std::size_t i = 0; i < column.value.size(); ++i) {
        if (side * column.value[i] < side * value) continue;
        if (i == 0) return column.time[0];
        return between(side * value, side * column.value[i - 1], column.time[i - 1], side * column.value[i], column.time[i]);
    }
    return NAN;
}

/// Of the line of least squares through what lies between two times: sum (t - mean t)(y - mean y)/sum (t - mean t)^2.
double mean_slope(const Column& column, double from, double to) {
    if (to > column.time.back() + 1e-9 * (to - from)) return NAN;  // never reached
    double n = 0, t = 0, y = 0, tt = 0, ty = 0;
    const auto each = [&](auto&& add) {
        for (std::size_t i = 0; i < column.time.size(); ++i)
            if (column.time[i] >= from && column.time[i] <= to) add(column.time[i] - from, column.value[i]);
    };
    each([&](double a, double b) { n += 1, t += a, y += b; });
    each([&](double a, double b) { tt += (a - t / n) * (a - t / n), ty += (a - t / n) * (b - y / n); });
    return n > 1 ? ty / tt : NAN;
}

double value_of(const StudyQuantity& quantity, const Json& summary, const fs::path& run, bool explicit_bulk) {
    if (!quantity.from_history() && summary.contains(quantity.of)) return number(summary[quantity.of]);
    const Column column = column_of(run, quantity.of, explicit_bulk);
    if (column.time.empty()) return NAN;
    if (quantity.slope) return mean_slope(column, (*quantity.slope)[0], (*quantity.slope)[1]);
    if (quantity.at) return value_at(column, *quantity.at);
    if (quantity.reaches && quantity.since.empty()) return time_when(column, *quantity.reaches);
    if (quantity.reaches) {
        const Column earlier = column_of(run, quantity.since, explicit_bulk);
        return earlier.time.empty() ? NAN : time_when(column, *quantity.reaches) - time_when(earlier, *quantity.reaches);
    }
    return quantity.largest ? *std::max_element(column.value.begin(), column.value.end()) : column.value.back();
}

}  // namespace

std::string RunResult::trouble() const {
    if (status == "done") return gates_hold ? "" : "a gate is violated";
    constexpr std::size_t longest = 120;
    return status + ": " + reason.substr(0, character_begin(reason, longest));
}

bool is_under_way(const std::string& status) { return status == "running" || status == "starting"; }

std::string said_in(const fs::path& log) {
    std::ifstream file(log);
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("error")) return line.substr(std::min(line.find(": ") + 2, line.size()));
    return "see " + log.filename().string();
}

ExitCode exit_code_of(const std::vector<RunResult>& results) {
    return std::all_of(results.begin(), results.end(), [](const RunResult& result) { return result.trouble().empty(); }) ? exit_done : exit_failed;
}

DisplayUnit unit_of_column(const std::vector<RunResult>& results, std::size_t quantity, const std::string& unit) {
    double largest = 0;
    for (const RunResult& result : results)
        if (std::isfinite(result.values[quantity])) largest = std::max(largest, std::abs(result.values[quantity]));
    return display_unit(largest, unit);
}

RunResult read_result(const fs::path& run, const std::vector<StudyQuantity>& quantities) {
    RunResult result{.status = "refused"};
    result.values.assign(quantities.size(), NAN);
    if (!fs::exists(run / "run.json")) {
        result.reason = said_in(run.string() + ".log");
        return result;
    }
    const Json record = read_run_json(run);
    result.status = record.value("status", "");
    result.reason = is_under_way(result.status) ? said_in(run.string() + ".log") : record.value("reason", "");
    result.bulk = record["scheme"].value("bulk", "");
    result.cohesion = record["scheme"].value("cohesion", "");
    for (const Json& gate : record["gates"]) result.gates_hold = result.gates_hold && gate.value("pass", false);
    result.triangles = number(record["triangles"]);
    result.steps = number(record["steps"]);
    for (const auto& cut : record["cuts"].items()) result.n_cuts += number(cut.value());
    result.linear_solves = number(record["linear_solves"]);
    result.factorisations = number(record["factorisations"]);
    result.step = number(record["step_s"]);
    result.cpu = number(record["cpu_s"]) - number(record["cpu_parts_s"]["output"]);
    if (result.status != "done") return result;
    for (std::size_t q = 0; q < quantities.size(); ++q) result.values[q] = value_of(quantities[q], record["summary"], run, result.bulk == "explicit");
    return result;
}

}  // namespace knap
