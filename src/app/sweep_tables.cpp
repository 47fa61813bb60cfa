// What came of a sweep, as text and CSV.
#include "app/convergence.hpp"
#include "app/sweep.hpp"
#include "app/text_table.hpp"
#include "observe/ticks.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// Runs that differ in the seed only: they stand together in the plan.
struct Combination {
    std::size_t first, n;
    Spread of(const std::vector<RunResult>& results, std::size_t q) const {
        std::vector<double> values;
        for (std::size_t i = first; i < first + n; ++i) values.push_back(results[i].values[q]);
        return spread_of(values);
    }
};

std::vector<Combination> combinations(const SweepPlan& plan) {
    std::vector<Combination> found;
    for (std::size_t first = 0; first < plan.runs.size(); first += plan.n_seeds) found.push_back({first, plan.n_seeds});
    return found;
}

double cost(const std::vector<RunResult>& results, const Combination& combination) {
    double sum = 0;
    for (std::size_t i = combination.first; i < combination.first + combination.n; ++i)
        if (std::isfinite(results[i].cpu)) sum += results[i].cpu;
    return sum;
}

/// "12 ± 3", with the number of runs in which it happened where that is not all.
std::string cell(const Spread& s, std::size_t n_runs, double factor) {
    if (s.n == 0) return "-";
    std::string text = number_text(s.mean * factor, "%.4g");
    if (n_runs > 1) text += " ± " + number_text(s.deviation * factor, "%.2g");
    return text + (s.n < static_cast<int>(n_runs) ? " (" + std::to_string(s.n) + ")" : "");
}

std::string trouble(const SweepPlan& plan, const std::vector<RunResult>& results) {
    std::string text;
    for (std::size_t i = 0; i < results.size(); ++i)
        if (const std::string what = results[i].trouble(); !what.empty()) text += plan.runs[i].name + ": " + what + "\n";
    return text;
}

std::string csv_values(const SweepPlan& plan, const SweepRun& run) {
    std::string text;
    for (std::size_t k = 0; k < plan.keys.size(); ++k) text += csv_text(run.values[k]) + ",";
    return text;
}

std::string csv_keys(const SweepPlan& plan) {
    std::string text;
    for (const SweepKey& key : plan.keys) text += csv_text(key.key) + ",";
    return text;
}

}  // namespace

std::string sweep_text(const SweepPlan& plan, const std::vector<RunResult>& results) {
    std::vector<Row> rows(1);
    for (const SweepKey& key : plan.keys) rows[0].push_back(key.name());
    rows[0].push_back("done");
    std::vector<DisplayUnit> units;
    for (std::size_t q = 0; q < plan.quantities.size(); ++q) {
        units.push_back(unit_of_column(results, q, plan.quantities[q].unit));
        rows[0].push_back(with_unit(plan.quantities[q].name, units[q].unit));
    }
    rows[0].push_back("processor time");
    for (const Combination& combination : combinations(plan)) {
        Row row = plan.runs[combination.first].values;
        const auto first = results.begin() + static_cast<std::ptrdiff_t>(combination.first);
        const auto n_done = std::count_if(first, first + static_cast<std::ptrdiff_t>(combination.n), [](const RunResult& r) { return r.status == "done"; });
        row.push_back(std::to_string(n_done) + " of " + std::to_string(combination.n));
        for (std::size_t q = 0; q < plan.quantities.size(); ++q) row.push_back(cell(combination.of(results, q), combination.n, units[q].factor));
        row.push_back(number_text(cost(results, combination), "%.3g") + " s");
        rows.push_back(std::move(row));
    }
    return padded(rows) + trouble(plan, results);
}

std::string sweep_csv(const SweepPlan& plan, const std::vector<RunResult>& results) {
    std::string text = "run," + csv_keys(plan) + "seed,status,triangles,steps," + with_unit("cpu", "s");
    for (const StudyQuantity& quantity : plan.quantities) text += "," + csv_text(with_unit(quantity.name, quantity.unit));
    text += "\n";
    for (std::size_t i = 0; i < results.size(); ++i) {
        const RunResult& r = results[i];
        text += csv_text(plan.runs[i].name) + "," + csv_values(plan, plan.runs[i]) + std::to_string(plan.runs[i].seed) + "," + r.status;
        for (const double v : {r.triangles, r.steps, r.cpu}) text += "," + csv_number(v);
        for (const double v : r.values) text += "," + csv_number(v);
        text += "\n";
    }
    return text;
}

std::string sweep_statistics_csv(const SweepPlan& plan, const std::vector<RunResult>& results) {
    std::string text = csv_keys(plan) + "runs,quantity,unit,happened,mean,deviation,smallest,largest\n";
    for (const Combination& combination : combinations(plan))
        for (std::size_t q = 0; q < plan.quantities.size(); ++q) {
            const Spread s = combination.of(results, q);
            text += csv_values(plan, plan.runs[combination.first]) + std::to_string(combination.n);
            text += "," + csv_text(plan.quantities[q].name) + "," + plan.quantities[q].unit + "," + std::to_string(s.n);
            for (const double v : {s.mean, s.deviation, s.smallest, s.largest}) text += "," + csv_number(v);
            text += "\n";
        }
    return text;
}

}  // namespace knap
