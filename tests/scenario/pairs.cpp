// Every two capabilities of the program go together, but for the pairs of scenario/exclusions.hpp.
#include "support/capability_pairs.hpp"

#include "scenario/read_scenario.hpp"

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
    int n_refused = 0;
    std::vector<std::string> without_rows;
    for (const CapabilityPair& pair : capability_pairs()) {
        CAPTURE(name_of(pair));
        try {
            read_scenario_text(scene_of(pair), "pair.toml", {}, folder);
            CHECK(!is_excluded(pair));
        } catch (const UserError& error) {
            if (error.diagnostics.front().message.find("no surplus") != std::string::npos) {
                without_rows.push_back(name_of(pair));
                continue;
            }
            ++n_refused;
            INFO(error.what());
            CHECK(is_excluded(pair));
            const bool has_reason = std::ranges::any_of(exclusions(), [&](const Exclusion& row) {
                return std::string(error.what()).find(row.because) != std::string::npos;
            });
            CHECK((has_reason || error.diagnostics.front().code == "no-calibration"));
        }
    }
    MESSAGE("refused: " << n_refused << " of " << capability_pairs().size() + 4);
    CHECK(n_refused <= 54);
    for (const std::string& name : without_rows) MESSAGE("no row of a surplus: " << name);
    CHECK(without_rows.size() <= 15);  // six of them by keys that no row has
}

}  // namespace pairs_test
