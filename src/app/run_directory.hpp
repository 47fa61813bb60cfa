#pragma once
// The directory of a run: made before anything is computed, never overwritten unless told to, complete and movable afterwards.
#include <filesystem>
#include <string>

namespace knap {

/// Makes the directory with fields/ and figures/. An existing one is refused (UserError) unless `force`, and even then only a directory
/// that an earlier run made (it holds a run.json) is cleared.
void make_run_directory(const std::filesystem::path& directory, bool force);

/// Writes by a temporary name and rename, so that a reader never sees half a file. Throws SimulationError naming the path.
void write_whole_file(const std::filesystem::path& path, const std::string& text);

}  // namespace knap
