// The results of an ensemble: Markdown for people, CSV for programs.
#include "app/ensemble/ensemble.hpp"
#include "base/text.hpp"
#include "figures/ticks.hpp"
#include "output/history_csv.hpp"
#include "record/outputs.hpp"

#include <algorithm>

namespace knap {
namespace {

using Row = std::vector<std::string>;  // of cells

/// Columns of study.csv and sweep.csv that are numbers.
struct Number {
    std::string_view name;
    double (*of)(const EnsembleRun&);
};
constexpr Number numbers[] = {
    {"size", [](const EnsembleRun& run) { return run.mesh_size; }},
    {"step", [](const EnsembleRun& run) { return run.result.step; }},
    {"triangles", [](const EnsembleRun& run) { return run.result.triangles; }},
    {"steps", [](const EnsembleRun& run) { return run.result.steps; }},
    {"cuts", [](const EnsembleRun& run) { return run.result.cutbacks; }},
    {"linear_solves", [](const EnsembleRun& run) { return run.result.linear_solves; }},
    {"factorisations", [](const EnsembleRun& run) { return run.result.factorisations; }},
    {"cpu", [](const EnsembleRun& run) { return run.result.cpu; }},
};

void append(Row& row, const Row& more) { row.insert(row.end(), more.begin(), more.end()); }

/// "-" for what is not finite; `format` as of printf.
std::string number_text(double value, const char* format) {
    if (!std::isfinite(value)) return "-";
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// "2.5 mm"
std::string shown(double value, const DisplayUnit& unit, const char* format) {
    return number_text(value * unit.factor, format) +
           (unit.unit.empty() || !std::isfinite(value) ? "" : " " + unit.unit);
}
std::string prefixed(double value, std::string_view unit) {
    return shown(value, display_unit(std::abs(value), std::string(unit)), "%.4g");
}

/// "93.9 ± 6.9 (2)": without deviation of a single run; with the number of runs that have a value where it is not all.
std::string spread_text(const Spread& s, std::size_t n_runs, double factor) {
    if (s.n == 0) return "-";
    std::string text = number_text(s.mean * factor, "%.4g");
    if (n_runs > 1) text += " ± " + number_text(s.deviation * factor, "%.2g");
    return text + (s.n < static_cast<int>(n_runs) ? " (" + std::to_string(s.n) + ")" : "");
}

std::string csv_number(double value) { return std::isfinite(value) ? shortest(value + 0.0) : ""; }

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csv(const std::vector<Row>& rows) {
    std::string text;
    for (Row row : rows) {
        std::ranges::transform(row, row.begin(), csv_text);
        text += csv_line(row) + "\n";
    }
    return text;
}

/// With columns of the same width; the first row is the header. Leaves out those of the first `n` columns that are
/// empty below it.
std::string markdown(const std::vector<Row>& rows, std::size_t n) {
    std::vector<std::string> lines(rows.size() + 1, "|");
    for (std::size_t k = 0; k < rows[0].size(); ++k) {
        if (k < n &&
            std::all_of(rows.begin() + 1, rows.end(), [k](const Row& row) { return row[k] == "-" || row[k].empty(); }))
            continue;
        std::size_t width = 0;
        for (const Row& row : rows) width = std::max(width, n_characters(row[k]));
        lines[1] += std::string(width + 2, '-') + "|";
        for (std::size_t i = 0; i < rows.size(); ++i)
            lines[i == 0 ? 0 : i + 1] += " " + rows[i][k] + std::string(width - n_characters(rows[i][k]), ' ') + " |";
    }
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

/// With the prefix of the largest value of a quantity.
DisplayUnit display_unit_of(const Ensemble& ensemble, std::size_t q) {
    double largest = 0;
    for (std::size_t v = 0; v < ensemble.variants.size(); ++v) {
        const Spread s = ensemble.spread(v, q);
        if (s.n > 0) largest = std::max({largest, std::abs(s.smallest), std::abs(s.largest)});
    }
    return display_unit(largest, ensemble.quantities[q].unit);
}

/// A row for each variant: its values, finished runs, means of the numbers of its runs, some of the quantities.
std::string variants_table(const Ensemble& ensemble, const std::vector<std::size_t>& quantities) {
    std::vector<Row> rows{ensemble.keys};
    const bool errors = !ensemble.errors.empty(), extremes = ensemble.n_seeds > 0 && quantities.size() == 1;
    append(rows[0], {"done"});
    for (const Number& number : numbers) append(rows[0], {std::string(number.name)});
    const std::size_t n_description = rows[0].size();
    for (std::size_t v = 0; v < ensemble.variants.size(); ++v) {
        const auto runs = ensemble.runs_of(v);
        const auto n_done = std::ranges::count(runs, "done", [](const EnsembleRun& run) { return run.result.status; });
        Row& row = rows.emplace_back(ensemble.variants[v].values);
        append(row, {errors ? "-" : std::to_string(n_done) + " of " + std::to_string(runs.size())});
        for (const Number& number : numbers) {
            const double mean = ensemble.spread(v, number.of).mean;
            append(row, {mean > 0 ? prefixed(mean, unit_of("study.csv", number.name)) : "-"});
        }
    }
    for (const std::size_t q : quantities) {
        const DisplayUnit unit = display_unit_of(ensemble, q);
        append(rows[0], {with_unit(ensemble.quantities[q].name, unit.unit)});
        if (errors) append(rows[0], {"error", "order"});
        if (extremes) append(rows[0], {"smallest", "largest"});
        for (std::size_t v = 0; v < ensemble.variants.size(); ++v) {
            const Spread s = ensemble.spread(v, q);
            Row& row = rows[v + 1];
            append(row, {errors ? number_text(s.mean * unit.factor, "%.7g")
                                : spread_text(s, ensemble.runs_of(v).size(), unit.factor)});
            if (extremes)
                append(row,
                       {number_text(s.smallest * unit.factor, "%.4g"), number_text(s.largest * unit.factor, "%.4g")});
            if (!errors) continue;
            const QuantityErrors& e = ensemble.errors[q];
            append(row, {v == e.reference_run ? "reference" : number_text(e.error[v], "%.2e"),
                         number_text(e.order[v], "%.2f")});
        }
    }
    return markdown(rows, n_description);
}

std::string reference_text(const Ensemble& study, std::size_t q) {
    const QuantityErrors& errors = study.errors[q];
    const std::string value = shown(errors.reference, display_unit_of(study, q), "%.8g");
    return errors.reference_run ? "reference: " + value + " (" + study.runs[*errors.reference_run].name + ")"
                                : "exact: " + value;
}

/// "differences of 12 mm, 15 mm"
std::string gaps_text(const QuantityErrors& errors, const std::vector<double>& gaps, const std::string& unit) {
    const bool relative = !errors.reference_run && errors.relative;
    std::string list;
    for (const double gap : gaps)
        if (std::isfinite(gap))
            list += (list.empty() ? "" : ", ") + (relative ? number_text(gap, "%.2g") : prefixed(gap, unit));
    return (errors.reference_run ? "differences of " : "errors of ") + list;
}

/// An item for each line whose convergence can be judged.
std::string orders_text(const Ensemble& study, std::size_t q) {
    const QuantityErrors& errors = study.errors[q];
    std::string text;
    for (std::size_t i = 0; i < errors.lines.size(); ++i) {
        const LineOrder& line = errors.lines[i];
        if (line.trend == Trend::unknown) continue;
        text += "- " + study.study.lines[i].name + ": ";
        if (line.trend == Trend::same) text += "the same on all levels but for rounding";
        if (line.trend == Trend::does_not_fall)
            text += "no convergence seen, " + gaps_text(errors, line.gaps, study.quantities[q].unit) +
                    (line.errors_grow ? " fall, but errors grow" : " do not fall with h");
        if (line.trend == Trend::falls) text += "order " + number_text(line.fitted, "%.2f") + " (fitted)";
        if (line.limit)
            text += "; extrapolated to " + shown(line.limit->value, display_unit_of(study, q), "%.8g") +
                    " with order " + number_text(line.limit->order, "%.2f");
        text += "\n";
    }
    return text;
}

}  // namespace

std::string overview(const Ensemble& ensemble) {
    std::string text;
    std::vector<std::size_t> all;
    for (std::size_t q = 0; q < ensemble.quantities.size(); ++q) {
        all.push_back(q);
        if (!ensemble.is_study()) continue;
        const bool errors = !ensemble.errors.empty();
        text += ensemble.quantities[q].name + ", " +
                (errors ? reference_text(ensemble, q) : std::to_string(ensemble.n_seeds) + " seeds") + "\n\n";
        text += variants_table(ensemble, {q}) + "\n";
        if (const std::string orders = errors ? orders_text(ensemble, q) : ""; !orders.empty()) text += orders + "\n";
    }
    if (!ensemble.is_study()) text = variants_table(ensemble, all) + "\n";
    std::string troubles;
    for (const EnsembleRun& run : ensemble.runs)
        if (const std::string trouble = run.result.trouble(); !trouble.empty())
            troubles += "- " + run.name + ": " + trouble + "\n";
    return text + troubles + (troubles.empty() ? "" : "\n");
}

std::string runs_csv(const Ensemble& ensemble) {
    const std::string file = ensemble.kind + ".csv";
    Row names;  // of the columns before those of the quantities; a sweep has its keys after the first one
    for (const Output& output : output_table(file).rows) names.emplace_back(output.name);
    std::vector<Row> rows{header_of(file, names)};
    if (!ensemble.is_study()) rows[0].insert(rows[0].begin() + 1, ensemble.keys.begin(), ensemble.keys.end());
    for (std::size_t q = 0; q < ensemble.quantities.size(); ++q) {
        const std::string &name = ensemble.quantities[q].name, &unit = ensemble.quantities[q].unit;
        append(rows[0], {with_unit(name, unit)});
        if (!ensemble.errors.empty())
            append(rows[0],
                   {with_unit("error of " + name, ensemble.errors[q].relative ? "" : unit), "order of " + name});
    }
    for (std::size_t i = 0; i < ensemble.runs.size(); ++i) {
        const EnsembleRun& run = ensemble.runs[i];
        const RunResult& result = run.result;
        Row& row = rows.emplace_back();
        if (!ensemble.is_study()) append(row, {run.name});
        append(row, ensemble.variants[run.variant].values);
        append(row, {std::to_string(run.seed), result.status});
        if (ensemble.is_study()) append(row, {result.bulk, result.cohesion});
        for (const Number& number : numbers)
            if (std::ranges::count(names, number.name) > 0) append(row, {csv_number(number.of(run))});
        for (std::size_t q = 0; q < ensemble.quantities.size(); ++q) {
            append(row, {csv_number(result.values[q])});
            if (!ensemble.errors.empty())
                append(row, {csv_number(ensemble.errors[q].error[i]), csv_number(ensemble.errors[q].order[i])});
        }
    }
    return csv(rows);
}

std::string statistics_csv(const Ensemble& ensemble) {
    std::vector<Row> rows{ensemble.keys};
    append(rows[0], {"runs", "quantity", "unit", "happened", "mean", "deviation", "smallest", "largest"});
    for (std::size_t v = 0; v < ensemble.variants.size(); ++v)
        for (std::size_t q = 0; q < ensemble.quantities.size(); ++q) {
            const Spread s = ensemble.spread(v, q);
            Row& row = rows.emplace_back(ensemble.variants[v].values);
            append(row, {std::to_string(ensemble.runs_of(v).size()), ensemble.quantities[q].name,
                         ensemble.quantities[q].unit, std::to_string(s.n)});
            for (const double number : {s.mean, s.deviation, s.smallest, s.largest}) append(row, {csv_number(number)});
        }
    return csv(rows);
}

}  // namespace knap
