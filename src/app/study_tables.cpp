// A study as text, as CSV and as Markdown.
#include "app/convergence.hpp"
#include "app/study.hpp"
#include "app/text_table.hpp"
#include "observe/ticks.hpp"
#include "scenario/units.hpp"

#include <algorithm>

namespace knap {
namespace {

DisplayUnit unit_of(const Study& study, std::size_t q) { return unit_of_column(study.results, q, study.plan.options.quantities[q].unit); }

std::string with_prefix(double value, const char* unit) {
    const DisplayUnit shown = display_unit(std::abs(value), unit);
    return number_text(value * shown.factor, "%.4g") + (std::isfinite(value) ? " " + shown.unit : "");
}

/// Of a run: line, size, step, steps, triangles, processor time; solver work where there is any.
Row what_it_was(const Study& study, std::size_t i, bool first_of_line) {
    const StudyRun& run = study.plan.runs[i];
    const RunResult& result = study.results[i];
    const bool solves = result.linear_solves > 0 && result.steps > 0;
    return {first_of_line ? study.plan.options.lines[run.line].name : "", run.size > 0 ? with_prefix(run.size, "m") : "-", with_prefix(result.step, "s"),
            number_text(result.steps, "%.0f") + (result.n_cuts > 0 ? " (" + number_text(result.n_cuts, "%.0f") + " cut)" : ""), number_text(result.triangles, "%.0f"),
            solves ? number_text(result.linear_solves / result.steps, "%.2g") + ", " + number_text(result.factorisations / result.steps, "%.2g") : "-",
            result.cpu < 0.0005 ? "-" : number_text(result.cpu, "%.3g") + (std::isfinite(result.cpu) ? " s" : "")};
}
const Row what_it_was_header{"line", "mesh", "step", "steps", "triangles", "solves, factorisations a step", "processor time"};

std::string reference_text(const Study& study, std::size_t q) {
    const StudyErrors& errors = study.errors[q];
    const DisplayUnit unit = unit_of(study, q);
    const std::string value = number_text(errors.reference * unit.factor, "%.8g") + (unit.unit.empty() ? "" : " " + unit.unit);
    return errors.exact ? "exact: " + value : "reference: " + value + " (" + study.plan.runs[errors.reference_run].name + ")";
}

bool first_of_line(const Study& study, std::size_t i) { return i == 0 || study.plan.runs[i].line != study.plan.runs[i - 1].line; }

std::vector<Row> error_rows(const Study& study, std::size_t q) {
    const StudyErrors& errors = study.errors[q];
    const DisplayUnit unit = unit_of(study, q);
    std::vector<Row> rows{what_it_was_header};
    rows[0].insert(rows[0].end(), {with_unit("value", unit.unit), "error", "order"});
    for (std::size_t i = 0; i < study.results.size(); ++i) {
        Row row = what_it_was(study, i, first_of_line(study, i));
        const bool reference = i == errors.reference_run;
        row.insert(row.end(), {number_text(study.results[i].values[q] * unit.factor, "%.7g"), reference ? "reference" : number_text(errors.error[i], "%.2e"),
                               number_text(errors.order[i], "%.2f")});
        if (const std::string what = study.results[i].trouble(); !what.empty()) row.push_back(what);
        rows.push_back(std::move(row));
    }
    drop_empty(rows, what_it_was_header.size());
    return rows;
}

/// "differences of 12 mm, 15 mm"
std::string gaps_text(const Study& study, std::size_t q, std::size_t line) {
    const StudyErrors& errors = study.errors[q];
    std::string list;
    for (const double gap : errors.gaps[line])
        if (std::isfinite(gap))
            list += (list.empty() ? "" : ", ") + (errors.exact && errors.relative ? number_text(gap, "%.2g") : with_prefix(gap, study.plan.options.quantities[q].unit.c_str()));
    return (errors.exact ? "errors of " : "differences of ") + list;
}

std::string orders_text(const Study& study, std::size_t q) {
    const StudyErrors& errors = study.errors[q];
    const DisplayUnit unit = unit_of(study, q);
    std::string text;
    for (std::size_t line = 0; line < errors.fitted.size(); ++line) {
        const std::string& name = study.plan.options.lines[line].name;
        if (errors.trend[line] == Trend::does_not_fall) text += name + ": no convergence seen, " + gaps_text(study, q, line) + " do not fall with h\n";
        if (errors.trend[line] == Trend::same) text += name + ": the same on all levels but for rounding\n";
        if (!std::isfinite(errors.fitted[line])) continue;
        text += name + ": order " + number_text(errors.fitted[line], "%.2f") + " (fitted)";
        if (errors.extrapolated[line])
            text += "; extrapolated to " + number_text(*errors.extrapolated[line] * unit.factor, "%.8g") + (unit.unit.empty() ? "" : " " + unit.unit) + " with order " +
                    number_text(*errors.extrapolated_order[line], "%.2f");
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
    row.back() = number_text(sample.mean_cost(study), "%.3g") + " s";
    return row;
}

std::vector<Row> spread_rows(const Study& study, std::size_t q) {
    const DisplayUnit unit = unit_of(study, q);
    std::vector<Row> rows{what_it_was_header};
    rows[0].insert(rows[0].end(), {"happened", with_unit("mean", unit.unit), "deviation", "smallest", "largest"});
    for (const Sample& sample : samples(study)) {
        const Spread s = sample.of(study, q);
        Row row = sample_row(study, sample);
        row.push_back(std::to_string(s.n) + " of " + std::to_string(sample.runs.size()));
        for (const double v : {s.mean, s.deviation, s.smallest, s.largest}) row.push_back(number_text(v * unit.factor, "%.4g"));
        rows.push_back(std::move(row));
    }
    drop_empty(rows, what_it_was_header.size());
    return rows;
}

/// "0.27 ± 0.05 (7 of 10)": what never happened in some runs is counted.
std::string spread_cell(const Spread& s, std::size_t n_runs, double factor) {
    if (s.n == 0) return "never";
    return number_text(s.mean * factor, "%.3g") + " ± " + number_text(s.deviation * factor, "%.2g") + (s.n < static_cast<int>(n_runs) ? " (" + std::to_string(s.n) + ")" : "");
}

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
    std::string text = csv_header("study.csv");
    const auto& quantities = study.plan.options.quantities;
    for (const StudyQuantity& quantity : quantities) {
        text += "," + csv_text(with_unit(quantity.name, quantity.unit));
        if (study.is_statistics()) continue;
        const bool relative = study.errors[static_cast<std::size_t>(&quantity - quantities.data())].relative;
        text += "," + csv_text(with_unit("error of " + quantity.name, relative ? "" : quantity.unit)) + "," + csv_text("order of " + quantity.name);
    }
    text += "\n";
    for (std::size_t i = 0; i < study.results.size(); ++i) {
        const StudyRun& run = study.plan.runs[i];
        const RunResult& r = study.results[i];
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
    std::string text = csv_header("statistics.csv") + "\n";
    const auto& quantities = study.plan.options.quantities;
    for (const Sample& sample : samples(study)) {
        const StudyRun& run = study.plan.runs[sample.runs.front()];
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            const Spread s = sample.of(study, q);
            text += csv_text(study.plan.options.lines[run.line].name) + "," + shortest(run.level) + "," + std::to_string(sample.runs.size()) + "," +
                    csv_text(quantities[q].name) + "," + quantities[q].unit + "," + std::to_string(s.n);
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
        rows[0].push_back(with_unit(quantities[q].name, units[q].unit));
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
                row.insert(row.end(), {number_text(study.results[i].values[q] * units[q].factor, "%.5g"),
                                       i == study.errors[q].reference_run ? "reference" : number_text(study.errors[q].error[i], "%.1e"),
                                       number_text(study.errors[q].order[i], "%.2f")});
            if (const std::string what = study.results[i].trouble(); !what.empty()) row.back() = what;
            rows.push_back(std::move(row));
        }
    }
    drop_empty(rows, rows[0].size());
    return markdown(rows);
}

}  // namespace knap
