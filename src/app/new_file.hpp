#pragma once
// A file that the user named on the command line: nothing is overwritten unless told to, and where it cannot be written the option was wrong.
#include <filesystem>
#include <string>

namespace knap {

/// Throws UserError where it exists, saying what helps.
void refuse_existing(const std::filesystem::path& file, const std::string& help = "choose another name, or replace it with --force");

/// As a whole. Throws UserError with the reason where it cannot be.
void write_new_file(const std::filesystem::path& file, const std::string& text);

}  // namespace knap
