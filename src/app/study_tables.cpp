// A study as text, as CSV and as Markdown.
#include "app/convergence.hpp"
#include "app/study.hpp"
#include "observe/ticks.hpp"
#include "scenario/units.hpp"

#include <algorithm>
#include <cstdio>

namespace knap {
namespace {

using Row = std::vector<std::string>;

std::string number(double value, const char* format) {
    if (!std::isfinite(value)) return "-";
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// A column in one unit: its prefix is that of the largest value.
DisplayUnit unit_of(const Study& study, std::size_t q) {
    double largest = 0;
    for (const StudyResult& result : study.results)
        if (std::isfinite(result.values[q])) largest = std::max(largest, std::abs(result.values[q]));
    return display_unit(largest, study.plan.options.quantities[q].unit);
}

std::string with_prefix(double value, const char* unit) {
    const DisplayUnit shown = display_unit(std::abs(value), unit);
    return number(value * shown.factor, "%.4g") + (std::isfinite(value) ? " " + shown.unit : "");
}

/// Of a run: line, size, step, steps, triangles, processor time; solver work where there is any.
Row what_it_was(const Study& study, std::size_t i, bool first_of_line) {
    const StudyRun& run = study.plan.runs[i];
    const StudyResult& result = study.results[i];
    const bool solves = result.linear_solves > 0 && result.steps > 0;
    return {first_of_line ? study.plan.options.lines[run.line].name : "", run.size > 0 ? with_prefix(run.size, "m") : "-", with_prefix(result.step, "s"),
            number(result.steps, "%.0f") + (result.n_cuts > 0 ? " (" + number(result.n_cuts, "%.0f") + " cut)" : ""), number(result.triangles, "%.0f"),
            solves ? number(result.linear_solves / result.steps, "%.2g") + ", " + number(result.factorisations / result.steps, "%.2g") : "-",
            result.cpu < 0.0005 ? "-" : number(result.cpu, "%.3g") + (std::isfinite(result.cpu) ? " s" : "")};
}
const Row what_it_was_header{"line", "mesh", "step", "steps", "triangles", "solves, factorisations a step", "processor time"};

/// What stands in the place of the numbers of a run that has none, or has lost a gate.
std::string trouble(const StudyResult& result) {
    if (result.status != "done") return result.status + ": " + result.reason.substr(0, 90);
    return result.gates_hold ? "" : "a gate is violated";
}

std::string padded(const std::vector<Row>& rows) {
    std::vector<std::size_t> width;
    const auto columns = [](const std::string& text) { return std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }); };
    for (const Row& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i == width.size()) width.push_back(0);
            width[i] = std::max<std::size_t>(width[i], columns(row[i]));
        }
    std::string text;
    for (const Row& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) line += (i ? "  " : "") + row[i] + std::string(i + 1 < row.size() ? width[i] - columns(row[i]) : 0, ' ');
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

/// Leaves out columns that say nothing ("-" in every row); `first` is the number of columns that may go.
void drop_empty(std::vector<Row>& rows, std::size_t first) {
    for (std::size_t k = first; k-- > 0;) {
        const bool empty = std::all_of(rows.begin() + 1, rows.end(), [&](const Row& row) { return k >= row.size() || row[k] == "-" || row[k].empty(); });
        if (!empty) continue;
        for (Row& row : rows)
            if (k < row.size()) row.erase(row.begin() + static_cast<std::ptrdiff_t>(k));
    }
}

std::string reference_text(const Study& study, std::size_t q) {
    const StudyErrors& errors = study.errors[q];
    const DisplayUnit unit = unit_of(study, q);
    const std::string value = number(errors.reference * unit.factor, "%.8g") + (unit.unit.empty() ? "" : " " + unit.unit);
    return errors.exact ? "exact: " + value : "reference: " + value + " (" + study.plan.runs[errors.reference_run].name + ")";
}

bool first_of_line(const Study& study, std::size_t i) { return i == 0 || study.plan.runs[i].line != study.plan.runs[i - 1].line; }

std::vector<Row> error_rows(const Study& study, std::size_t q) {
    const StudyErrors& errors = study.errors[q];
    const DisplayUnit unit = unit_of(study, q);
    std::vector<Row> rows{what_it_was_header};
    rows[0].insert(rows[0].end(), {"value" + (unit.unit.empty() ? "" : " [" + unit.unit + "]"), "error", "order"});
    for (std::size_t i = 0; i < study.results.size(); ++i) {
        Row row = what_it_was(study, i, first_of_line(study, i));
        const bool reference = i == errors.reference_run;
        row.insert(row.end(), {number(study.results[i].values[q] * unit.factor, "%.7g"), reference ? "reference" : number(errors.error[i], "%.2e"),
                               number(errors.order[i], "%.2f")});
        if (const std::string what = trouble(study.results[i]); !what.empty()) row.push_back(what);
        rows.push_back(std::move(row));
    }
    drop_empty(rows, what_it_was_header.size());
    return rows;
}

std::string orders_text(const Study& study, std::size_t q) {
    const StudyErrors& errors = study.errors[q];
    const DisplayUnit unit = unit_of(study, q);
    std::string text;
    for (std::size_t line = 0; line < errors.fitted.size(); ++line) {
        if (!std::isfinite(errors.fitted[line])) continue;
        text += study.plan.options.lines[line].name + ": order " + number(errors.fitted[line], "%.2f") + " (fitted)";
        if (errors.extrapolated[line])
            text += "; extrapolated to " + number(*errors.extrapolated[line] * unit.factor, "%.8g") + (unit.unit.empty() ? "" : " " + unit.unit) + " with order " +
                    number(*errors.extrapolated_order[line], "%.2f");
        text += "\n";
    }
    return text;
}

// ---- statistics

/// Runs of one line and level, which differ in the seed.
struct Sample {
    std::vector<std::size_t> runs;
    Spread of(const Study& study, std::size_t q) const {
        std::vector<double> values;
        for (const std::size_t run : runs) values.push_back(study.results[run].values[q]);
        return spread_of(values);
    }
    double mean_cost(const Study& study) const {
        std::vector<double> values;
        for (const std::size_t run : runs) values.push_back(study.results[run].cpu);
        return spread_of(values).mean;
    }
};

std::vector<Sample> samples(const Study& study) {
    std::vector<Sample> found;
    for (std::size_t i = 0; i < study.plan.runs.size(); ++i) {
        const bool next = i == 0 || study.plan.runs[i].line != study.plan.runs[i - 1].line || study.plan.runs[i].level != study.plan.runs[i - 1].level;
        if (next) found.emplace_back();
        found.back().runs.push_back(i);
    }
    return found;
}

Row sample_row(const Study& study, const Sample& sample) {
    Row row = what_it_was(study, sample.runs.front(), first_of_line(study, sample.runs.front()));
    row.back() = number(sample.mean_cost(study), "%.3g") + " s";
    return row;
}

std::vector<Row> spread_rows(const Study& study, std::size_t q) {
    const DisplayUnit unit = unit_of(study, q);
    std::vector<Row> rows{what_it_was_header};
    rows[0].insert(rows[0].end(), {"happened", "mean" + (unit.unit.empty() ? "" : " [" + unit.unit + "]"), "deviation", "smallest", "largest"});
    for (const Sample& sample : samples(study)) {
        const Spread s = sample.of(study, q);
        Row row = sample_row(study, sample);
        row.push_back(std::to_string(s.n) + " of " + std::to_string(sample.runs.size()));
        for (const double v : {s.mean, s.deviation, s.smallest, s.largest}) row.push_back(number(v * unit.factor, "%.4g"));
        rows.push_back(std::move(row));
    }
    drop_empty(rows, what_it_was_header.size());
    return rows;
}

/// "0.27 ± 0.05 (7 of 10)": what never happened in some runs is counted.
std::string spread_cell(const Spread& s, std::size_t n_runs, double factor) {
    if (s.n == 0) return "never";
    return number(s.mean * factor, "%.3g") + " ± " + number(s.deviation * factor, "%.2g") + (s.n < static_cast<int>(n_runs) ? " (" + std::to_string(s.n) + ")" : "");
}

std::string csv_number(double value) { return std::isfinite(value) ? shortest(value) : ""; }

std::string csv_text(const std::string& text) { return text.find_first_of(",\"") == std::string::npos ? text : "\"" + text + "\""; }

}  // namespace

std::string study_text(const Study& study) {
    std::string text;
    const auto& quantities = study.plan.options.quantities;
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        text += "\n" + quantities[q].name;
        if (study.is_statistics()) {
            text += ", " + std::to_string(study.plan.options.n_seeds) + " seeds\n" + padded(spread_rows(study, q));
            continue;
        }
        text += ", " + reference_text(study, q) + "\n" + padded(error_rows(study, q)) + orders_text(study, q);
    }
    return text;
}

std::string study_csv(const Study& study) {
    std::string text = "line,level,seed,status,bulk,cohesion,size_m,step_s,triangles,steps,cuts,linear_solves,factorisations,cpu_s";
    const auto& quantities = study.plan.options.quantities;
    for (const StudyQuantity& quantity : quantities) {
        text += "," + csv_text(quantity.name);
        if (!study.is_statistics()) text += "," + csv_text("error of " + quantity.name) + "," + csv_text("order of " + quantity.name);
    }
    text += "\n";
    for (std::size_t i = 0; i < study.results.size(); ++i) {
        const StudyRun& run = study.plan.runs[i];
        const StudyResult& r = study.results[i];
        text += csv_text(study.plan.options.lines[run.line].name) + "," + shortest(run.level) + "," + std::to_string(run.seed) + "," + r.status + "," + r.bulk + "," + r.cohesion;
        for (const double v : {run.size, r.step, r.triangles, r.steps, r.n_cuts, r.linear_solves, r.factorisations, r.cpu}) text += "," + csv_number(v);
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            text += "," + csv_number(r.values[q]);
            if (!study.is_statistics()) text += "," + csv_number(study.errors[q].error[i]) + "," + csv_number(study.errors[q].order[i]);
        }
        text += "\n";
    }
    return text;
}

std::string statistics_csv(const Study& study) {
    std::string text = "line,level,runs,quantity,happened,mean,deviation,smallest,largest\n";
    const auto& quantities = study.plan.options.quantities;
    for (const Sample& sample : samples(study)) {
        const StudyRun& run = study.plan.runs[sample.runs.front()];
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            const Spread s = sample.of(study, q);
            text += csv_text(study.plan.options.lines[run.line].name) + "," + shortest(run.level) + "," + std::to_string(sample.runs.size()) + "," +
                    csv_text(quantities[q].name) + "," + std::to_string(s.n);
            for (const double v : {s.mean, s.deviation, s.smallest, s.largest}) text += "," + csv_number(v);
            text += "\n";
        }
    }
    return text;
}

std::string study_markdown(const Study& study) {
    const auto& quantities = study.plan.options.quantities;
    std::vector<Row> rows{what_it_was_header};
    std::vector<DisplayUnit> units;
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        units.push_back(unit_of(study, q));
        const std::string title = quantities[q].name + (units[q].unit.empty() ? "" : " [" + units[q].unit + "]");
        rows[0].push_back(title);
        if (!study.is_statistics()) rows[0].insert(rows[0].end(), {"error", "order"});
    }
    if (study.is_statistics()) {
        for (const Sample& sample : samples(study)) {
            Row row = sample_row(study, sample);
            for (std::size_t q = 0; q < quantities.size(); ++q) row.push_back(spread_cell(sample.of(study, q), sample.runs.size(), units[q].factor));
            rows.push_back(std::move(row));
        }
    } else {
        for (std::size_t i = 0; i < study.results.size(); ++i) {
            Row row = what_it_was(study, i, first_of_line(study, i));
            for (std::size_t q = 0; q < quantities.size(); ++q)
                row.insert(row.end(), {number(study.results[i].values[q] * units[q].factor, "%.5g"),
                                       i == study.errors[q].reference_run ? "reference" : number(study.errors[q].error[i], "%.1e"), number(study.errors[q].order[i], "%.2f")});
            if (const std::string what = trouble(study.results[i]); !what.empty()) row.back() = what;
            rows.push_back(std::move(row));
        }
    }
    drop_empty(rows, rows[0].size());
    return markdown(rows);
}

}  // namespace knap
