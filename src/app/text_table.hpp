#pragma once
// Tables of text: for people, as Markdown, as CSV.
#include <cstddef>
#include <string>
#include <vector>

namespace knap {

using Row = std::vector<std::string>;  // of cells

/// "-" for what is not finite; `format` as of printf.
std::string number_text(double value, const char* format);

/// With columns of the same width.
std::string padded(const std::vector<Row>& rows);

std::string markdown(const std::vector<Row>& rows);

/// Leaves out columns that say nothing ("-" in every row but the first); `first` is the number of columns that may go.
void drop_empty(std::vector<Row>& rows, std::size_t first);

/// The header of a table whose columns are all in the list of outputs.
std::string csv_header(const std::string& table);

/// Cells of a CSV file: nothing for what is not finite; quoted where it must be.
std::string csv_number(double value);
std::string csv_text(const std::string& text);

}  // namespace knap
