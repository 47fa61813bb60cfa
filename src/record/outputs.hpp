#pragma once
// The list of all outputs of a run: every number of its summary, column of its tables, array of its frames and member
// of run.json, with unit and meaning. Headers of tables, run.json, printed texts and scenarios/OUTPUTS.md
// (`knap schema --outputs`) take their units from it.
//
// Most rows also contain the function that computes the number (Measure) and stand where the number is known: summary
// in summary.cpp, run.json in run_record.cpp, columns in analysis/. To add a number, add a row.
#include "output/outputs.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace knap {

/// In output_list.cpp, which looks at all that has rows.
const std::vector<OutputTable>& output_tables();
const OutputTable& output_table(std::string_view name);

/// A row by table and name; by pattern where the scenario gives a part of the name. Null where there is none.
const Output* find_output(std::string_view table, std::string_view name);

/// "" where there is no such row.
std::string_view unit_of(std::string_view table, std::string_view name);

/// Unit of a column of energy.csv, cracks.csv, reactions.csv, probes.csv or stress_strain.csv, and of its time
/// derivative.
std::string_view unit_of_column(std::string_view column);
std::string_view unit_of_slope(std::string_view column);

/// Column names as in the header of a table: "time [s]". A pure number has no brackets.
std::vector<std::string> header_of(const std::string& table, const std::vector<std::string>& columns,
                                   bool celsius = false);

/// "0.0125 m/s"; "none" for NaN; never "-0".
std::string value_text(double value, std::string_view unit, int digits = 6);
/// The same with the prefix that suits the value: "12.5 mm/s".
std::string shown_text(double value, std::string_view unit, int digits = 6);

/// The list as Markdown: scenarios/OUTPUTS.md.
std::string outputs_markdown();

}  // namespace knap
