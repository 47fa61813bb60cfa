#pragma once
// Histories as files: comma-separated, one header line of names with units ("time [s]"), the shortest digits that read back to the same bits; what never
// happened is an empty field; no locale.
#include "output/frame.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

/// "time [s]" -> "time"
std::string_view name_in_header(std::string_view header);

/// One line of a file, without the line end.
std::string csv_line(const std::vector<std::string>& columns);
std::string csv_line(const std::vector<double>& row);

/// `header`: the columns with their units, "time [s]". Throws OutputError naming the path.
void write_csv(const History& history, const std::vector<std::string>& header, const std::filesystem::path& path);

/// Columns get their names without the units. Throws UserError naming the path and line.
History read_csv(const std::filesystem::path& path);

}  // namespace knap
