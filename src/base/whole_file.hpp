#pragma once
// Files that are written and read as a whole.
#include <cstdint>
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
/// The same of a file that a command reads: throws UserError `code`.
std::string read_given_file(const std::filesystem::path& path, const std::string& code);
/// The first `n` bytes of a file, or all where it has fewer. Throws OutputError.
std::string read_begin(const std::filesystem::path& path, std::size_t n);

/// What is wrong with a file that should end with `mark` (and a few blanks): "is empty"; "" where it does.
std::string fault_of_end(const std::filesystem::path& path, std::string_view mark);
/// The same of one whose bytes should have this checksum: "is damaged: ...".
std::string fault_of_bytes(const std::filesystem::path& path, std::uint64_t sum);

/// The text of an errno of open() or write().
std::string error_text(int error);

}  // namespace knap
