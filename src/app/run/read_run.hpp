#pragma once
#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace knap {

/// run.json of a run directory, with all that the commands take from it and of the right types. Throws UserError where there is none such.
nlohmann::ordered_json read_run_json(const std::filesystem::path& run);

}  // namespace knap
