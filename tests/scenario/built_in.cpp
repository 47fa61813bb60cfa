// The files of scenarios/, in the binary and on disk.
#include "scenario/write_scenario.hpp"

#include "samples.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace built_in_test {

using namespace knap;

namespace {

std::string text_of(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

bool same(const Ring& a, const Ring& b) { return a.points == b.points && a.boundary == b.boundary; }

bool same(const Shape& a, const Shape& b) {
    const auto same_rings = [](const Ring& x, const Ring& y) { return same(x, y); };
    const auto same_cracks = [](const Crack& x, const Crack& y) { return x.points == y.points; };
    const auto same_regions = [](const Region& x, const Region& y) { return x.points == y.points && x.tag == y.tag; };
    return same(a.outer, b.outer) && a.boundary_names == b.boundary_names &&
           std::equal(a.holes.begin(), a.holes.end(), b.holes.begin(), b.holes.end(), same_rings) &&
           std::equal(a.cracks.begin(), a.cracks.end(), b.cracks.begin(), b.cracks.end(), same_cracks) &&
           std::equal(a.regions.begin(), a.regions.end(), b.regions.begin(), b.regions.end(), same_regions);
}

bool same(const std::optional<Box>& a, const std::optional<Box>& b) {
    return a.has_value() == b.has_value() && (!a || (a->low == b->low && a->high == b->high));
}

bool same(const Selection& a, const Selection& b) { return a.boundary == b.boundary && same(a.box, b.box); }

bool same(const Load& a, const Load& b) {
    return a.kind == b.kind && same(a.on, b.on) && a.value == b.value && a.history.time == b.history.time &&
           a.history.value == b.history.value;
}

bool same(const CohesiveLaw& a, const CohesiveLaw& b) {
    return a.sigma_c == b.sigma_c && a.G_c == b.G_c && a.gamma == b.gamma && a.friction == b.friction &&
           a.restitution == b.restitution;
}

bool same(const FigureOptions& a, const FigureOptions& b) {
    return a.file == b.file && a.show == b.show && a.at == b.at && a.colour == b.colour && a.deform == b.deform &&
           same(a.box, b.box) && a.range == b.range && a.width == b.width && a.title == b.title && a.over == b.over &&
           a.aspect == b.aspect && a.panel == b.panel;
}

bool same(const Expectation& a, const Expectation& b) {
    return a.key == b.key && a.below == b.below && a.above == b.above && a.at_least == b.at_least &&
           a.at_most == b.at_most && a.value == b.value && a.within == b.within && a.relative == b.relative &&
           a.unit == b.unit;
}

/// Bit for bit.
void check_same(const Scenario& a, const Scenario& b) {
    CHECK(a.name == b.name);
    CHECK(a.title == b.title);
    CHECK(a.seed == b.seed);
    REQUIRE(a.bodies.size() == b.bodies.size());
    for (std::size_t i = 0; i < a.bodies.size(); ++i) CHECK(same(a.bodies[i].shape, b.bodies[i].shape));
    CHECK(a.plane == b.plane);
    CHECK(a.thickness == b.thickness);
    CHECK(a.mesh.size == b.mesh.size);
    CHECK(a.mesh.grading == b.mesh.grading);
    CHECK(a.mesh.min_angle == b.mesh.min_angle);
    REQUIRE(a.mesh.refine.size() == b.mesh.refine.size());
    for (std::size_t i = 0; i < a.mesh.refine.size(); ++i) CHECK(a.mesh.refine[i].size == b.mesh.refine[i].size);
    REQUIRE(a.materials.size() == b.materials.size());
    for (std::size_t i = 0; i < a.materials.size(); ++i) {
        CHECK(a.materials[i].name == b.materials[i].name);
        CHECK(a.materials[i].elastic.density == b.materials[i].elastic.density);
        CHECK(a.materials[i].elastic.E == b.materials[i].elastic.E);
        CHECK(a.materials[i].elastic.nu == b.materials[i].elastic.nu);
    }
    REQUIRE(a.laws.size() == b.laws.size());
    for (std::size_t i = 0; i < a.laws.size(); ++i)
        CHECK((a.laws[i].name == b.laws[i].name && same(a.laws[i].law, b.laws[i].law)));
    CHECK(a.law_of_pair == b.law_of_pair);
    REQUIRE(a.loads.size() == b.loads.size());
    for (std::size_t i = 0; i < a.loads.size(); ++i) CHECK(same(a.loads[i], b.loads[i]));
    REQUIRE(a.supports.size() == b.supports.size());
    for (std::size_t i = 0; i < a.supports.size(); ++i)
        CHECK((same(a.supports[i].on, b.supports[i].on) && a.supports[i].law == b.supports[i].law &&
               a.supports[i].glued == b.supports[i].glued && a.supports[i].gap == b.supports[i].gap));
    REQUIRE(a.initial_velocities.size() == b.initial_velocities.size());
    for (std::size_t i = 0; i < a.initial_velocities.size(); ++i)
        CHECK((same(a.initial_velocities[i].on, b.initial_velocities[i].on) &&
               a.initial_velocities[i].value == b.initial_velocities[i].value));
    CHECK(a.time.end == b.time.end);
    CHECK(a.time.step == b.time.step);
    CHECK(a.time.step_cracking == b.time.step_cracking);
    CHECK(a.time.step_min == b.time.step_min);
    CHECK(a.time.start_in_equilibrium == b.time.start_in_equilibrium);
    CHECK(a.time.scheme.bulk == b.time.scheme.bulk);
    CHECK(a.time.scheme.cohesion == b.time.scheme.cohesion);
    CHECK(a.time.scheme.theta == b.time.scheme.theta);
    CHECK(a.time.scheme.mass == b.time.scheme.mass);
    CHECK(a.time.safety == b.time.safety);
    CHECK(a.output.every == b.output.every);
    CHECK(a.output.history_every == b.output.history_every);
    CHECK(a.output.fields == b.output.fields);
    REQUIRE(a.figures.size() == b.figures.size());
    for (std::size_t i = 0; i < a.figures.size(); ++i) CHECK(same(a.figures[i], b.figures[i]));
    REQUIRE(a.expect.size() == b.expect.size());
    for (std::size_t i = 0; i < a.expect.size(); ++i) CHECK(same(a.expect[i], b.expect[i]));
}

}  // namespace

TEST_CASE("built-in: every file of the folder is in the binary as it is") {
    std::set<std::string> on_disk;
    for (const auto& file : std::filesystem::directory_iterator(std::string(KNAP_SOURCE_DIR) + "/scenarios")) {
        if (file.path().extension() != ".toml") continue;
        const std::string name = file.path().stem().string();
        on_disk.insert(name);
        CHECK(built_in_scenario(name).text == text_of(file.path()));
    }
    const auto names = built_in_scenarios();
    CHECK(on_disk.size() >= 7);
    CHECK(on_disk == std::set<std::string>(names.begin(), names.end()));
}

TEST_CASE("built-in: each reads without a warning and resolves to itself") {
    for (const std::string& name : built_in_scenarios()) {
        CAPTURE(name);
        const ReadResult once = open_scenario(name);
        CHECK(once.warnings.empty());
        CHECK(once.scenario.name == name);
        CHECK_FALSE(once.scenario.expect.empty());
        CHECK(once.source.text().starts_with("# "));
        const ReadResult twice =
            read_scenario_text(resolved_toml(once), "resolved.toml", {}, KNAP_SOURCE_DIR "/scenarios");
        check_same(once.scenario, twice.scenario);
        CHECK(resolved_toml(twice) == resolved_toml(once));
    }
}

TEST_CASE("new: what knap new writes is a scenario") {
    const ReadResult result = read_scenario_text(new_scenario("my-plate"), "my-plate.toml");
    CHECK(result.scenario.name == "my-plate");
    CHECK(result.warnings.empty());
}

TEST_CASE("listing: every key with its value and origin") {
    const std::string text = full_listing(samples::read(samples::least, {"seed=9"}));
    const auto has = [&](const std::string& part) { return text.find(part) != std::string::npos; };
    CHECK(has("sample.toml:6"));
    CHECK(has("--set seed=9"));
    CHECK(has("default, time.end/40"));
    CHECK(has("mesh.size                          0.001 m"));
}

TEST_CASE("built-in: a folder of that name is the output of a run and hides it not") {
    const std::string name = "bar_pulled_apart";
    REQUIRE(!std::filesystem::exists(name));
    std::filesystem::create_directory(name);
    CHECK(open_scenario(name).scenario.name == name);
    CHECK_THROWS_WITH_AS(open_scenario("."), doctest::Contains("is a directory"), UserError);
    std::filesystem::remove(name);
}

TEST_CASE("built-in: a clear begin of a name is enough") {
    CHECK(open_scenario("edge-crack", {}).scenario.name == "edge_cracked_block");
    CHECK(open_scenario("edge_cracked_block_f", {}).scenario.name == "edge_cracked_block_fine");
    CHECK_THROWS_AS(open_scenario("dcb_", {}), UserError);  // dcb_displacement, dcb_force, dcb_williams
    CHECK_THROWS_AS(open_scenario("edg", {}), UserError);   // too short to be meant
}

}  // namespace built_in_test
