#pragma once
// Histories as files: comma-separated, one header line, the shortest digits that read back to the same bits; no locale.
#include "observe/frame.hpp"

#include <filesystem>
#include <string>

namespace knap {

/// One line of a file, without the line end.
std::string csv_line(const std::vector<std::string>& columns);
std::string csv_line(const std::vector<double>& row);

/// Throws OutputError naming the path.
void write_csv(const History& history, const std::filesystem::path& path);

/// Throws UserError naming the path and line.
History read_csv(const std::filesystem::path& path);

}  // namespace knap
