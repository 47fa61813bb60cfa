#pragma once
// Files that are written and read as a whole.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace knap {

/// Writes by a temporary name and rename, so that a reader never sees half a file and an older file stays where the new one fails; a device or a pipe is
/// written to. Throws OutputError with path and reason.
void write_whole_file(const std::filesystem::path& path, std::string_view text);

/// The same for what others write: `write` is given the name to write by. What it throws is passed on, and no half file stays.
void write_whole_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

/// The same, where what stood there becomes `older`, in place of that. Both stay as they are until the new one is whole.
void replace_whole_file(const std::filesystem::path& path, const std::filesystem::path& older, std::string_view text);

/// All bytes of a file. Throws OutputError with path and reason.
std::string read_whole_file(const std::filesystem::path& path);

}  // namespace knap
