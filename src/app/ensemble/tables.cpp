// The results of an ensemble as Markdown and CSV.
#include "app/ensemble/ensemble.hpp"
#include "base/text.hpp"
#include "figures/ticks.hpp"
#include "output/history_csv.hpp"
#include "record/outputs.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The numbers among the columns of study.csv and sweep.csv.
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
    {"at_rest", [](const EnsembleRun& run) { return run.result.at_rest; }},
};

bool end_at_rest(const Ensemble& ensemble) {
    return std::ranges::any_of(ensemble.runs, [](const EnsembleRun& run) { return !std::isnan(run.result.at_rest); });
}

/// "-" for a value that is not finite; `format` as of printf.
std::string number_text(double value, const char* format) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return std::isfinite(value) ? text : "-";
}

/// "2.5 mm"
std::string shown(double value, const DisplayUnit& unit, int digits) {
    return std::isfinite(value) ? value_text(value * unit.factor, unit.unit, digits) : "-";
}
std::string shown(double value, std::string_view unit) {
    return std::isfinite(value) ? shown_text(value, unit, 4) : "-";
}

std::string csv_number(double value) { return std::isfinite(value) ? shortest(value + 0.0) : ""; }  // + 0: no "-0.0"

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\n") == text.npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

class Table {
public:
    explicit Table(std::size_t n_rows) : n_rows_(n_rows) {}

    /// A column; `cell(i)`: the text in row i.
    template <class Cell>
    void add(const std::string& header, Cell cell) {
        std::vector<std::string>& column = columns_.emplace_back(1, header);
        for (std::size_t i = 0; i < n_rows_; ++i) column.push_back(cell(i));
    }

    std::string csv() const {
        std::string text;
        for (std::size_t i = 0; i <= n_rows_; ++i) {
            std::vector<std::string> row;
            for (const auto& column : columns_) row.push_back(csv_text(column[i]));
            text += csv_line(row) + "\n";
        }
        return text;
    }

    /// Without columns that have no text.
    std::string markdown() const {
        std::vector<std::string> lines(n_rows_ + 2, "|");
        for (const auto& column : columns_) {
            if (std::all_of(column.begin() + 1, column.end(), [](const auto& t) { return t == "-" || t.empty(); }))
                continue;
            std::size_t width = 0;
            for (const std::string& text : column) width = std::max(width, n_characters(text));
            lines[1] += std::string(width + 2, '-') + "|";
            for (std::size_t i = 0; i <= n_rows_; ++i)
                lines[i == 0 ? 0 : i + 1] += " " + padded(column[i], width) + " |";
        }
        return joined(lines, "\n") + "\n";
    }

private:
    std::size_t n_rows_;
    std::vector<std::vector<std::string>> columns_;
};

/// With the prefix of the largest value of a quantity.
DisplayUnit display_unit_of(const Ensemble& ensemble, std::size_t q) {
    double largest = 0;
    for (std::size_t v = 0; v < ensemble.variants.size(); ++v) {
        const Spread s = ensemble.spread(v, q);
        if (s.n > 0) largest = std::max({largest, std::abs(s.smallest), std::abs(s.largest)});
    }
    return display_unit(largest, ensemble.quantities[q].unit);
}

/// Mean of a number of the runs of a variant that are done, as of its quantities; where none is, of those that have
/// begun, and else of all, whose mesh sizes are known before.
double mean_of(const Ensemble& ensemble, std::size_t v, const Number& number) {
    constexpr bool (*samples[])(const EnsembleRun&) = {[](const EnsembleRun& run) { return run.is_done(); },
                                                       [](const EnsembleRun& run) { return run.result.triangles > 0; },
                                                       [](const EnsembleRun&) { return true; }};
    for (const auto counts : samples) {
        const Spread s = ensemble.spread(v, [&](const EnsembleRun& run) { return counts(run) ? number.of(run) : NAN; });
        if (s.n > 0) return s.mean;
    }
    return NAN;
}

/// A row per variant: values, finished runs, mean numbers of its runs, and some of the quantities.
std::string variants_table(const Ensemble& ensemble, const std::vector<std::size_t>& quantities) {
    const bool errors = !ensemble.errors.empty(), extremes = ensemble.has_statistics() && quantities.size() == 1;
    Table table(ensemble.variants.size());
    for (std::size_t k = 0; k < ensemble.keys.size(); ++k)
        table.add(ensemble.keys[k], [&](std::size_t v) { return ensemble.variants[v].values[k]; });
    if (!errors)
        table.add("done", [&](std::size_t v) {
            const auto runs = ensemble.runs_of(v);
            const auto n_done =
                std::ranges::count(runs, "done", [](const EnsembleRun& run) { return run.result.status; });
            return std::to_string(n_done) + " of " + std::to_string(runs.size());
        });
    if (end_at_rest(ensemble))
        table.add("at rest", [&](std::size_t v) {
            return std::to_string(
                std::ranges::count(ensemble.runs_of(v), 1, [](const EnsembleRun& run) { return run.result.at_rest; }));
        });
    for (const Number& number : numbers) {
        if (number.name == "at_rest") continue;
        table.add(std::string(number.name), [&](std::size_t v) {
            const double mean = mean_of(ensemble, v, number);
            return mean > 0 ? shown(mean, unit_of("study.csv", number.name)) : "-";
        });
    }
    for (const std::size_t q : quantities) {
        const DisplayUnit unit = display_unit_of(ensemble, q);
        table.add(with_unit(ensemble.quantities[q].name, unit.unit), [&](std::size_t v) {
            const Spread s = ensemble.spread(v, q);
            const std::size_t n_runs = ensemble.runs_of(v).size();
            if (errors || s.n == 0) return number_text(s.mean * unit.factor, "%.7g");
            // "93.9 ± 6.9 (2)": with the number of runs that have a value, if not all have; one alone has no deviation
            return number_text(s.mean * unit.factor, "%.4g") +
                   (s.n > 1 ? " ± " + number_text(s.deviation * unit.factor, "%.2g") : "") +
                   (s.n < static_cast<int>(n_runs) ? " (" + std::to_string(s.n) + ")" : "");
        });
        if (extremes) {
            table.add("smallest",
                      [&](std::size_t v) { return number_text(ensemble.spread(v, q).smallest * unit.factor, "%.4g"); });
            table.add("largest",
                      [&](std::size_t v) { return number_text(ensemble.spread(v, q).largest * unit.factor, "%.4g"); });
        }
        if (!errors) continue;
        const QuantityErrors& e = ensemble.errors[q];
        table.add("error",
                  [&](std::size_t v) { return v == e.reference_run ? "reference" : number_text(e.error[v], "%.2e"); });
        table.add("order", [&](std::size_t v) { return number_text(e.order[v], "%.2f"); });
    }
    return table.markdown();
}

/// "dissipated, reference: 27.6 mJ (explicit_r4)"
std::string heading(const Ensemble& study, std::size_t q) {
    const std::string name = study.quantities[q].name + (study.errors.empty() && study.n_seeds == 0 ? "" : ", ");
    if (study.errors.empty()) return name + (study.n_seeds > 0 ? std::to_string(study.n_seeds) + " seeds" : "");
    const QuantityErrors& errors = study.errors[q];
    const std::string value = shown(errors.reference, display_unit_of(study, q), 8);
    return name + (errors.reference_run ? "reference: " + value + " (" + study.runs[*errors.reference_run].name + ")"
                                        : "exact: " + value);
}

/// "differences of 12 mm, 15 mm"
std::string gaps_text(const QuantityErrors& errors, const std::vector<double>& gaps, const std::string& unit) {
    const bool relative = !errors.reference_run && errors.relative;
    std::vector<std::string> texts;
    for (const double gap : gaps)
        if (std::isfinite(gap)) texts.push_back(relative ? number_text(gap, "%.2g") : shown(gap, unit));
    return (errors.reference_run ? "differences of " : "errors of ") + joined(texts);
}

/// A list item for each line whose convergence is known.
std::string orders_text(const Ensemble& study, std::size_t q) {
    std::string text;
    for (std::size_t i = 0; i < study.errors[q].lines.size(); ++i) {
        const LineOrder& line = study.errors[q].lines[i];
        if (line.trend == Trend::unknown) continue;
        text += "- " + study.study.lines[i].name + ": ";
        if (line.trend == Trend::same) text += "the same on all levels except for rounding";
        if (line.trend == Trend::does_not_fall)
            text += "no convergence seen, " + gaps_text(study.errors[q], line.gaps, study.quantities[q].unit) +
                    (line.errors_grow ? " fall, but errors grow" : " do not fall with h");
        if (line.trend == Trend::falls) text += "order " + number_text(line.fitted, "%.2f") + " (fitted)";
        if (line.limit)
            text += "; extrapolated to " + shown(line.limit->value, display_unit_of(study, q), 8) + " with order " +
                    number_text(line.limit->order, "%.2f");
        text += "\n";
    }
    return text.empty() ? "" : text + "\n";
}

}  // namespace

std::string overview(const Ensemble& ensemble) {
    std::string text, troubles;
    std::vector<std::size_t> all;
    for (std::size_t q = 0; q < ensemble.quantities.size(); ++q) {
        all.push_back(q);
        if (!ensemble.is_study()) continue;
        text += heading(ensemble, q) + "\n\n" + variants_table(ensemble, {q}) + "\n";
        if (!ensemble.errors.empty()) text += orders_text(ensemble, q);
    }
    if (!ensemble.is_study()) text = variants_table(ensemble, all) + "\n";
    std::vector<std::string> restless;
    for (const EnsembleRun& run : ensemble.runs) {
        if (ensemble.safety) break;  // its verdict says it
        if (run.is_left()) continue;
        if (const std::string trouble = run.result.trouble(); !trouble.empty())
            troubles += "- " + run.name + ": " + trouble + "\n";
        if (run.result.at_rest == 0) restless.push_back(run.name);
    }
    if (!restless.empty())
        troubles += "- not at rest at time.end, " + std::to_string(restless.size()) + " of " +
                    std::to_string(ensemble.runs.size()) + " runs: " + joined(restless) + "\n";
    return text + troubles + (troubles.empty() ? "" : "\n");
}

std::string runs_csv(const Ensemble& ensemble) {
    const auto& runs = ensemble.runs;
    Table table(runs.size());
    const auto value = [&](std::size_t i, std::size_t k) { return ensemble.variants[runs[i].variant].values[k]; };
    for (const Output& output : output_table(ensemble.kind + ".csv").rows) {
        if (output.name == "at_rest" && !end_at_rest(ensemble)) continue;
        table.add(with_unit(std::string(output.name), std::string(output.unit)), [&](std::size_t i) {
            const EnsembleRun& run = runs[i];
            if (output.name == "run") return run.name;
            if (output.name == "line") return value(i, 0);
            if (output.name == "level") return value(i, 1);
            if (output.name == "seed") return std::to_string(run.seed);
            if (output.name == "status") return run.result.status;
            if (output.name == "verdict") return verdict_of(ensemble, run);
            if (output.name == "bulk") return run.result.bulk;
            if (output.name == "cohesion") return run.result.cohesion;
            return csv_number(std::ranges::find(numbers, output.name, &Number::name)->of(run));
        });
        if (output.name != "run") continue;
        for (std::size_t k = 0; k < ensemble.keys.size(); ++k)  // of a sweep
            table.add(ensemble.keys[k], [&](std::size_t i) { return value(i, k); });
        for (std::size_t k = 0; k < ensemble.random.keys.size(); ++k)
            table.add(with_unit(ensemble.random.keys[k].key, ensemble.random.keys[k].unit),
                      [&](std::size_t i) { return runs[i].drawn[k]; });
    }
    for (std::size_t q = 0; q < ensemble.quantities.size(); ++q) {
        const auto& [name, unit] = std::pair(ensemble.quantities[q].name, ensemble.quantities[q].unit);
        table.add(with_unit(name, unit), [&](std::size_t i) { return csv_number(runs[i].result.values[q]); });
        if (ensemble.errors.empty()) continue;
        const QuantityErrors& errors = ensemble.errors[q];
        table.add(with_unit("error of " + name, errors.relative ? "" : unit),
                  [&](std::size_t i) { return csv_number(errors.error[i]); });
        table.add("order of " + name, [&](std::size_t i) { return csv_number(errors.order[i]); });
    }
    return table.csv();
}

std::string statistics_csv(const Ensemble& ensemble) {
    const std::size_t n = ensemble.quantities.size();
    Table table(ensemble.variants.size() * n);
    for (std::size_t k = 0; k < ensemble.keys.size(); ++k)
        table.add(ensemble.keys[k], [&](std::size_t i) { return ensemble.variants[i / n].values[k]; });
    table.add("runs", [&](std::size_t i) { return std::to_string(ensemble.runs_of(i / n).size()); });
    table.add("quantity", [&](std::size_t i) { return ensemble.quantities[i % n].name; });
    table.add("unit", [&](std::size_t i) { return ensemble.quantities[i % n].unit; });
    table.add("happened", [&](std::size_t i) { return std::to_string(ensemble.spread(i / n, i % n).n); });
    for (const auto& [name, number] :
         {std::pair{"mean", &Spread::mean}, std::pair{"deviation", &Spread::deviation},
          std::pair{"smallest", &Spread::smallest}, std::pair{"largest", &Spread::largest}})
        table.add(name,
                  [&, member = number](std::size_t i) { return csv_number(ensemble.spread(i / n, i % n).*member); });
    return table.csv();
}

}  // namespace knap
