#pragma once
// Histories as files: comma-separated, one header line of names with units ("time [s]"), the shortest digits that read back to the same bits; what never
// happened is an empty field; no locale.
#include "observe/frame.hpp"

#include <filesystem>
#include <string>

namespace knap {

/// One line of a file, without the line end.
std::string csv_line(const std::vector<std::string>& columns);
std::string csv_line(const std::vector<double>& row);

/// With the units that its file name has in the list of outputs. Throws OutputError naming the path.
void write_csv(const History& history, const std::filesystem::path& path);

/// Columns get their names without the units. Throws UserError naming the path and line.
History read_csv(const std::filesystem::path& path);

}  // namespace knap
