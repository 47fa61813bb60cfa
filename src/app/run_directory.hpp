#pragma once
// The directory of a run: made before anything is computed, never overwritten unless told to, complete and movable afterwards.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace knap {

/// Name and text of the files that a run begins with.
using FirstFiles = std::vector<std::pair<std::string, std::string>>;

/// Makes the directory with fields/, figures/ and the first files, all at once (under another name, then renamed). An existing one is refused
/// (UserError) unless `replace`, and even then only a directory that an earlier run made (it holds a run.json) is cleared.
void make_run_directory(const std::filesystem::path& directory, bool replace, const FirstFiles& files);

/// Whether a run stands there that began with these very files (run.json aside).
bool began_with(const std::filesystem::path& directory, const FirstFiles& files);

}  // namespace knap
