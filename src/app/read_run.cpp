#include "app/read_run.hpp"

#include "base/error.hpp"

#include <nlohmann/json.hpp>

#include <fstream>

namespace knap {

nlohmann::ordered_json read_run_json(const std::filesystem::path& run) {
    std::ifstream file(run / "run.json");
    if (!file) throw UserError("no-run", "`" + run.string() + "` is no run directory: it has no run.json");
    try {
        return nlohmann::ordered_json::parse(file);
    } catch (const nlohmann::ordered_json::exception& error) {
        throw UserError("bad-run", "`" + (run / "run.json").string() + "` cannot be read: " + error.what());
    }
}

}  // namespace knap
