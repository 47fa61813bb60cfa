// A few steps of scenarios that have two capabilities of the program at once: their books close.
#include "app/program.hpp"
#include "app/run/run.hpp"
#include "support/capability_pairs.hpp"

#include <nlohmann/json.hpp>

#include <random>

namespace run_pairs_test {

using namespace knap;
using namespace knap::tests;
using program::Folder;

namespace {

void run_pairs(const Folder& folder, std::vector<CapabilityPair> pairs) {
    std::erase_if(pairs, is_excluded);
    std::ofstream(folder.path / "pairs.msh") << file_of_pairs();
    int n = 0;
    for (const CapabilityPair& pair : pairs) {
        const std::string name = name_of(pair);
        CAPTURE(name);
        try {
            ReadResult read = read_scenario_text(scene_of(pair), "pair.toml", {"time.end=2e-5"}, folder.path);
            const ExitCode code = run_scenario(
                std::move(read), {.output = folder.path / "run", .force = true, .quiet = true, .threads = 1});
            const auto record = nlohmann::json::parse(program::text_of(folder.path / "run/run.json"));
            CHECK_MESSAGE(code == exit_done, record.value("reason", ""));
            CHECK(record["summary"]["energy_residual"].get<double>() < 1e-11);
            ++n;
        } catch (const UserError& error) {
            const std::string text = error.what();
            CHECK_MESSAGE(text.find("no surplus") != std::string::npos, text);  // no calibration
        }
    }
    CHECK(n > 9 * pairs.size() / 10 - 6);
}

}  // namespace

TEST_CASE("pairs: sixty drawn ones run with closed books") {
    std::vector<CapabilityPair> drawn, all = capability_pairs();
    std::ranges::sample(all, std::back_inserter(drawn), 60, std::mt19937(46));
    for (const CapabilityPair& pair : all)  // once had the viscous stress in the energy of thermal strains
        if (name_of(pair) == "bulk_viscosity and [heat]") drawn.push_back(pair);
    run_pairs(Folder("pairs drawn"), std::move(drawn));
}

TEST_CASE("pairs: all that are accepted run with closed books" * doctest::test_suite("slow")) {
    run_pairs(Folder("pairs all"), capability_pairs());
}

}  // namespace run_pairs_test
