// Grains, random strength, inclusions, joints and maps in a scenario.
#include "samples.hpp"

#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

namespace grains_test {

using namespace knap;
using knap::tests::relative;
using samples::changed;
using samples::least;
using samples::mistakes;

namespace {

const std::string quartz = "[material.quartz]\ndensity = 2650\nE = 90e9\nnu = 0.1\n";

bool reports(const std::string& text, const std::string& code, const std::string& words) {
    const std::vector<Diagnostic> found = mistakes(text);
    return std::any_of(found.begin(), found.end(), [&](const Diagnostic& d) {
        return d.code == code && (d.message + d.hint + d.note).find(words) != std::string::npos && d.line > 0;
    });
}

}  // namespace

TEST_CASE("grains: which law acts within a grain and between grains") {
    const std::string grains =
        "[[grains]]\nsize = \"5 mm\"\nmineral = [{ material = \"quartz\", fraction = 0.4 }]\n" + quartz;
    {
        const Scenario s = samples::read(least + grains).scenario;  // only the default
        CHECK(s.law_within == std::vector<Index>{0, 0});
        REQUIRE(s.rocks.size() == 1);
        CHECK(s.rocks[0].grains.size == 0.005);
        REQUIRE(s.rocks[0].minerals.size() == 1);
        CHECK(s.rocks[0].minerals[0].region == 1);
        CHECK(s.rocks[0].minerals[0].fraction == 0.4);
    }
    const std::string laws =
        "[interface.within]\nbreakable = false\n[interface.quartz]\nsigma_c = 9e6\nG_c = "
        "9\n[interface.glass-glass]\nsigma_c = 8e6\nG_c = 8\n";
    const Scenario s = samples::read(least + grains + laws).scenario;
    CHECK(s.laws[s.law_within[0]].name == "within");
    CHECK(s.laws[s.law_within[1]].name == "quartz");
    CHECK(s.laws[s.law_of_pair[0][0]].name == "glass-glass");
    CHECK(s.laws[s.law_of_pair[0][1]].name == "default");
    // without grains these names mean nothing
    CHECK(reports(least + laws, "unknown-name", "no pair of materials"));
}

TEST_CASE("grains: mistakes") {
    const auto grains = [](const std::string& more) { return least + "[[grains]]\nsize = \"5 mm\"\n" + more + quartz; };
    CHECK(mistakes(grains("")).empty());
    CHECK(reports(changed("5 mm", "1 mm", grains("")), "out-of-range", "1.5 times mesh.size"));
    CHECK(reports(grains("in = \"glas\"\n"), "unknown-name", "did you mean `glass`?"));
    CHECK(reports(grains("mineral = [{ material = \"quarz\", fraction = 0.1 }]\n"), "unknown-name",
                  "did you mean `quartz`?"));
    CHECK(reports(grains("mineral = [{ material = \"glass\", fraction = 0.1 }]\n"), "duplicate-name",
                  "the others leave"));
    CHECK(reports(
        grains("mineral = [{ material = \"quartz\", fraction = 0.6 }, { material = \"quartz\", fraction = 0.6 }]\n"),
        "out-of-range", "more than 1"));
    CHECK(reports(grains("mineral = [{ material = \"quartz\" }]\n"), "missing-key", "fraction"));
    CHECK(reports(grains("[[grains]]\nsize = \"6 mm\"\n"), "duplicate-name", "second"));
    CHECK(reports(grains("elongation = 0.5\n"), "out-of-range", "at least 1"));
}

TEST_CASE("scatter: read and refused") {
    const auto law = [](const std::string& scatter) {
        return changed("G_c = 3\n", "G_c = 3\nscatter = { " + scatter + " }\n");
    };
    const Scatter s =
        samples::read(law("kind = \"weibull\", modulus = 7, area = \"4 mm2\", of = [\"sigma_c\", \"G_c\"]"))
            .scenario.laws[0]
            .scatter;
    CHECK(s.kind == Scatter::Kind::weibull);
    CHECK(s.modulus == 7);
    CHECK(s.area == relative(4e-6, 1e-12));
    CHECK(s.of_strength);
    CHECK(s.of_energy);
    CHECK_FALSE(samples::read(least).scenario.laws[0].scatter.any());
    CHECK(samples::read(law("kind = \"uniform\", deviation = \"1 %\", of = \"G_c\""))
              .scenario.laws[0]
              .scatter.deviation == relative(0.01, 1e-12));
    CHECK(reports(law("modulus = 7"), "missing-key", "kind"));
    CHECK(reports(law("kind = \"weibull\""), "missing-key", "modulus"));
    CHECK(reports(law("kind = \"normal\", modulus = 7, deviation = 0.1"), "exclusive-keys", "kind = \"weibull\""));
    CHECK(reports(law("kind = \"weibull\", modulus = 7, deviation = 0.1"), "exclusive-keys",
                  "\"normal\" or \"lognormal\" or \"uniform\""));
    CHECK(reports(law("kind = \"gauss\", deviation = 0.1"), "unknown-word", "weibull, normal, lognormal, uniform"));
    CHECK(reports(law("kind = \"normal\", deviation = 0.1, length = \"1 mm\", correlation = \"3 mm\""),
                  "exclusive-keys", "only one"));
    CHECK(reports(law("kind = \"normal\", deviation = 0.1, lowest = 1.2"), "out-of-range", "less than 1"));
    CHECK(reports(
        changed("sigma_c = 3.08e6\nG_c = 3\n", "breakable = false\nscatter = { kind = \"normal\", deviation = 0.1 }\n"),
        "exclusive-keys", "never breaks"));
}

TEST_CASE("inclusions and joints: read and refused") {
    const auto inclusions = [](const std::string& more) {
        return least + "[[inclusions]]\nsize = \"4 mm\"\nfraction = 0.2\n" + more + quartz;
    };
    {
        const Scenario s = samples::read(inclusions("")).scenario;  // pores
        CHECK(s.bodies.at(0).shape.holes.size() > 50);
        CHECK(s.boundary_names().back() == "pores");
        const Scenario t = samples::read(inclusions("material = \"quartz\"\ncorners = 5\n")).scenario;
        CHECK(t.bodies.at(0).shape.regions.size() == s.bodies.at(0).shape.holes.size());
        CHECK(t.bodies.at(0).shape.regions.front().tag == 1);
        CHECK(t.bodies.at(0).shape.regions.front().points.size() == 5);
    }
    CHECK(reports(changed("fraction = 0.2", "fraction = 0.58", inclusions("")), "geometry", "finds no room"));
    CHECK(reports(changed("4 mm", "1 mm", inclusions("")), "out-of-range", "1.5 times"));
    CHECK(reports(inclusions("material = \"quartz\"\nname = \"a\"\n"), "exclusive-keys", "pores"));
    CHECK(reports(inclusions("corners = 2\n"), "out-of-range", "at least 3"));

    const auto joints = [](const std::string& more) {
        return least + "[[joints]]\ndirection = 60\nspacing = \"8 mm\"\n" + more + quartz;
    };
    {
        const Scenario s = samples::read(joints("")).scenario;
        CHECK(s.bodies.at(0).shape.cracks.size() > 8);
        CHECK(s.bodies.at(0).shape.cracks.front().joint == -1);
        const Scenario t =
            samples::read(joints("interface = \"weak\"\n[interface.weak]\nsigma_c = 1e6\nG_c = 1\n")).scenario;
        CHECK(t.bodies.at(0).shape.cracks.front().joint == 0);
        CHECK(t.laws[t.law_of_joint.at(0)].name == "weak");
        const Scenario u = samples::read(joints("thickness = \"1 mm\"\nmaterial = \"quartz\"\n")).scenario;
        CHECK(u.bodies.at(0).shape.cracks.empty());
        CHECK(u.bodies.at(0).shape.regions.size() > 8);
    }
    CHECK(reports(joints("persistence = 0.5\n"), "missing-key", "length"));
    CHECK(reports(joints("thickness = \"1 mm\"\n"), "missing-key", "veins"));
    CHECK(reports(joints("interface = \"weak\"\n"), "unknown-name", "weak"));
    CHECK(reports(changed("8 mm", "0.5 mm", joints("")), "out-of-range", "below mesh.size"));
}

TEST_CASE("maps: colours become materials") {
    const auto map = [](const std::string& colours) {
        return least + quartz +
               "[[map]]\nfile = \"" KNAP_SOURCE_DIR "/tests/scenario/data/two_halves.png\"\ncolour = [" + colours +
               "]\n";
    };
    const std::string right = "{ rgb = \"#2040e0\", material = \"quartz\" }",
                      left = "{ rgb = \"#b81525\", material = \"glass\" }";
    const ReadResult both = samples::read(map(left + ", " + right));
    CHECK(both.warnings.empty());
    REQUIRE(both.scenario.maps.size() == 1);
    const MaterialMap& m = both.scenario.maps[0];
    CHECK(m.width == 20);
    CHECK(m.height == 8);
    CHECK(m.at({0.049, 0.03}) == 0);
    CHECK(m.at({0.051, 0.03}) == 1);
    CHECK(m.at({0.051, 0.041}) == -1);  // outside
    const ReadResult half = samples::read(map(right));
    CHECK(half.scenario.maps[0].at({0.049, 0.03}) == -1);
    REQUIRE(half.warnings.size() == 1);
    CHECK(half.warnings[0].message.find("50 %") != std::string::npos);
    const ReadResult absent = samples::read(map(left + ", " + right + ", { rgb = \"#00ff00\", material = \"glass\" }"));
    REQUIRE(absent.warnings.size() == 1);
    CHECK(absent.warnings[0].message.starts_with("`map[0].colour[2].rgb` = \"#00ff00\" is the colour of no pixel"));
    CHECK(reports(map("{ rgb = \"red\", material = \"quartz\" }"), "bad-value", "no colour"));
    CHECK(reports(map("{ rgb = \"#00ff00\", material = \"quartz\" }"), "bad-value", "no pixel"));
    CHECK(reports(map("{ rgb = \"#2040e0\", material = \"quarz\" }"), "unknown-name", "did you mean"));
    CHECK(reports(map(""), "missing-key", "no colours"));
    CHECK(reports(changed("two_halves.png", "none.png", map(right)), "missing-file", "cannot be read"));
    CHECK(reports(changed("data/two_halves.png", "grains.cpp", map(right)), "bad-file", "not a PNG"));
}

}  // namespace grains_test
