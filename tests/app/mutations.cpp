// Mistakes that can be read are refused with a place when the mesh and the model are made, or can be run.
#include "support/mutations.hpp"

#include "app/check/findings.hpp"
#include "scenario/built_in.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <map>

namespace app_mutations_test {

using namespace knap;

namespace {

constexpr std::size_t n_parts = 4;  // each within the time of a test
constexpr double most_triangles = 20000;

/// About how many the mesh of a scenario has.
double triangles_of(const Scenario& scenario) {
    if (scenario.given) return scenario.given->mesh.n_triangles();
    double n = 0;
    for (const Body& body : scenario.bodies) n += body.shape.area() / (0.433 * body.mesh.size * body.mesh.size);
    for (const RefinedPlace& place : scenario.mesh.refine) n += place.area() / (0.433 * place.size * place.size);
    return n;
}

/// The mistakes of each kind of key in the scenario where it costs least.
void check_part(std::size_t part) {
    const std::filesystem::path directory = KNAP_SOURCE_DIR "/scenarios";
    struct Chosen {
        double cost;
        const BuiltIn* in;
        tests::Mutation mutation;
    };
    std::map<std::string, Chosen> chosen;
    for (const BuiltIn& built_in : built_ins()) {
        const double cost = triangles_of(open_scenario(built_in.name).scenario);
        for (const tests::Mutation& mutation : tests::mutations_of(built_in.text)) {
            const std::string kind = pattern_of(mutation.path) + "=" + mutation.value;
            if (std::hash<std::string>()(kind) % n_parts != part) continue;
            const auto [at, is_new] = chosen.try_emplace(kind, Chosen{cost, &built_in, mutation});
            if (!is_new && cost < at->second.cost) at->second = {cost, &built_in, mutation};
        }
    }
    int n_meshed = 0;
    for (const auto& [kind, one] : chosen) {
        CAPTURE(one.in->name);
        CAPTURE(kind);
        try {
            ReadResult read = tests::read_mutated(one.in->text, one.mutation, directory);
            if (triangles_of(read.scenario) > most_triangles) continue;
            ++n_meshed;
            const Model model = model_of(read);
            check_model(read, model);
            plan_of(read, model, read.scenario.time.end);
        } catch (const UserError& error) {
            CHECK_MESSAGE(tests::has_place(error, one.mutation), error.what());
        } catch (const SimulationError& error) {
            CHECK(std::string(error.what()) != "");
        }
    }
    CHECK(n_meshed > 50);
}

}  // namespace

TEST_CASE("mutations: with meshes part 1" * doctest::test_suite("slow")) { check_part(0); }
TEST_CASE("mutations: with meshes part 2" * doctest::test_suite("slow")) { check_part(1); }
TEST_CASE("mutations: with meshes part 3" * doctest::test_suite("slow")) { check_part(2); }
TEST_CASE("mutations: with meshes part 4" * doctest::test_suite("slow")) { check_part(3); }

}  // namespace app_mutations_test
