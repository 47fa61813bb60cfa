#pragma once
// What a run writes: every number of its summary, every column of its tables, every array of its frames, every entry of run.json, each with its unit and its one
// meaning. This is the only list of them: headers of tables, run.json, what is printed, and scenarios/OUTPUTS.md (`knap schema --outputs`) take their units from it.
//
// Most rows say how their number is had as well (Measure); those stand where the number is known: the summary in summary.cpp, columns in the classes of analysis,
// breaks.cpp and fragments.cpp. To add a number is to add a row.
#include "output/outputs.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace knap {

const std::vector<OutputTable>& output_tables();
const OutputTable& output_table(std::string_view name);

/// A row by table and name; by pattern where the scenario gave a part of the name. Null when there is none.
const Output* find_output(std::string_view table, std::string_view name);

/// "" where there is no such row.
std::string_view unit_of(std::string_view table, std::string_view name);

/// Of a column of energy.csv, cracks.csv, reactions.csv, probes.csv or stress_strain.csv, and of its change in time.
std::string_view unit_of_column(std::string_view column);
std::string_view unit_of_slope(std::string_view column);

/// Column names as they stand in the header of a table: "time [s]". A pure number has no brackets.
std::vector<std::string> header_of(const std::string& table, const std::vector<std::string>& columns);

/// "12.5 mm/s" in four digits or `digits`, "none" for what is not there; never "-0".
std::string value_text(double value, std::string_view unit, int digits = 6);

/// All of it as Markdown: scenarios/OUTPUTS.md.
std::string outputs_markdown();

}  // namespace knap
