#pragma once
// Files that are written and read as a whole.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace knap {

/// Writes to a temporary name, "PATH.part", and renames it, so that a reader never sees half a file and an older file
/// stays where the new one fails; to a device or a pipe it writes directly. A file or a symbolic link of the temporary
/// name is removed. Throws OutputError with path and reason. `durable`: the bytes are on the disk (fsync) before the
/// name is theirs, and the name is before this returns: a loss of power leaves one or the other file, not an empty one.
void write_whole_file(const std::filesystem::path& path, std::string_view text, bool durable = false);

/// The same for other writers: `write` is given the name to write to. Its exceptions are passed on, and no half file
/// stays.
void write_whole_file(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

/// The same, durable, but the previous file is renamed to `older`, which it replaces. Both stay as they are until the
/// new one is complete.
void replace_whole_file(const std::filesystem::path& path, const std::filesystem::path& older, std::string_view text);

/// Returns when the bytes of a file, or the names in a directory, are on the disk. Throws OutputError.
void flush_to_disk(const std::filesystem::path& path);

/// All bytes of a file. Throws OutputError with path and reason.
std::string read_whole_file(const std::filesystem::path& path);

}  // namespace knap
