#pragma once
#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace knap {

/// run.json of a run directory. Throws UserError where there is none that can be read.
nlohmann::ordered_json read_run_json(const std::filesystem::path& run);

}  // namespace knap
