// Every two capabilities of the program go together, but for the pairs of scenario/exclusions.hpp.
#include "support/capability_pairs.hpp"

#include "scenario/read_scenario.hpp"
#include "scenario/write_scenario.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

namespace pairs_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("pairs: two capabilities are refused where the table of exclusions says so and with its reason") {
    const std::filesystem::path folder = std::filesystem::path(KNAP_BINARY_DIR) / "test_pairs";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "pairs.msh") << file_of_pairs();
    int n_refused = 0, n_refused_of_first = 0;
    std::vector<std::string> without_rows;
    for (const CapabilityPair& pair : capability_pairs()) {
        CAPTURE(name_of(pair));
        try {
            const std::string resolved = resolved_toml(read_scenario_text(scene_of(pair), "pair.toml", {}, folder));
            CHECK(!is_excluded(pair));
            CHECK(resolved_toml(read_scenario_text(resolved, "resolved.toml", {}, folder)) == resolved);
        } catch (const UserError& error) {
            if (error.diagnostics.front().message.find("no surplus") != std::string::npos) {  // no calibration
                without_rows.push_back(name_of(pair));
                continue;
            }
            ++n_refused, n_refused_of_first += is_of_first_list(pair);
            INFO(error.what());
            CHECK(is_excluded(pair));
            const bool has_reason = std::ranges::any_of(exclusions(), [&](const Exclusion& row) {
                return std::string(error.what()).find(row.because) != std::string::npos;
            });
            CHECK((has_reason || error.diagnostics.front().code == "no-calibration"));
        }
    }
    const int n = static_cast<int>(capabilities.size()), n_first = n - static_cast<int>(later_capabilities.size());
    const auto counted = [](int refused, int of) {
        return std::to_string(refused) + " of the " + std::to_string(of * (of - 1) / 2) + " pairs of " +
               std::to_string(of);
    };
    CAPTURE(counted(n_refused, n));
    CAPTURE(counted(n_refused_of_first, n_first));
    CHECK(n_refused_of_first <= 22);
    std::ifstream file(std::filesystem::path(KNAP_SOURCE_DIR) / "scenarios/KEYS.md");
    const std::string keys{std::istreambuf_iterator<char>(file), {}};
    CHECK(keys.find(counted(n_refused, n)) != std::string::npos);
    CHECK(keys.find(counted(n_refused_of_first, n_first)) != std::string::npos);
    for (const std::string& name : without_rows) MESSAGE("no row of a surplus: " << name);
    CHECK(without_rows.size() <= 15);  // six of them by keys that no row has
}

}  // namespace pairs_test
