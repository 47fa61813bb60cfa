#include "samples.hpp"

#include <doctest/doctest.h>

namespace overrides_test {

using namespace knap;
using samples::least;
using samples::mistakes;
using samples::read;

namespace {
const std::string loaded =
    least + "[[load]]\non = \"top\"\ntraction = [0, 1]\n[[load]]\non = \"bottom\"\ntraction = [0, -1]\n";
}

TEST_CASE("set: values as TOML or bare") {
    CHECK(read(least, {"mesh.size=0.25 mm"}).scenario.mesh.size == 0.25e-3);
    CHECK(read(least, {"mesh.size=\"0.25 mm\""}).scenario.mesh.size == 0.25e-3);
    CHECK(read(least, {"mesh.size=0.25e-3"}).scenario.mesh.size == 0.25e-3);
    CHECK(read(least, {" mesh.size = 2 mm "}).scenario.mesh.size == 2e-3);
    CHECK(read(least, {"domain.model=plane stress"}).scenario.plane == PlaneModel::stress);
    CHECK(read(least, {"name=2026"}).scenario.name == "2026");
    CHECK(read(least, {"title=a = b"}).scenario.title == "a = b");
    CHECK(read(least, {"title="}).scenario.title == "");
    CHECK(read(least, {"seed=3"}).scenario.seed == 3);
    CHECK(read(least, {"output.fields=false"}).scenario.output.fields == false);
    CHECK(read(least, {"domain.size=[\"1 m\", 2]"}).scenario.bodies.at(0).shape.outer.points.at(2) == Vec2(1, 2));
    CHECK(read(least, {"interface.default.breakable=false"}).scenario.laws.at(0).law.breakable() == false);
    CHECK(read(least, {"time.step=auto"}).scenario.time.step.value == 0);
}

TEST_CASE("set: lists and tables") {
    CHECK(read(loaded, {"load[1].traction=[0, \"-2 MPa\"]"}).scenario.loads.at(1).value[1] == -2e6);
    CHECK(read(loaded, {"load[0].on=left"}).scenario.loads.at(0).on.boundary == "left");
    CHECK(read(loaded, {"load[0].ramp=1 us"}).scenario.loads.at(0).history.time.back() == 1e-6);
    CHECK(read(least, {"expect.branches.at_least=1"}).scenario.expect.at(0).at_least == 1.0);
    CHECK(read(least, {"mesh={ size = 1 }"}).scenario.mesh.size == 1);
    CHECK(read(least, {"material.b={ density = 1, E = 1, nu = 0 }"}).scenario.materials.at(1).name == "b");
}

TEST_CASE("set: an empty value leaves the key out") {
    CHECK(read(loaded, {"load="}).scenario.loads.empty());
    CHECK(read(loaded, {"load[0]="}).scenario.loads.at(0).on.boundary == "bottom");
    CHECK(read(least, {"seed=3", "seed="}).scenario.seed == 1);
    CHECK(read(least, {"seed=", "time.step_cracking=", "expect=", "figure="}).scenario.seed == 1);  // were not there
    CHECK(mistakes(least, {"mesh.size="}).at(0).code == "missing-key");
    CHECK(mistakes(least, {"mesh.sise="}).at(0).code == "bad-override");
}

TEST_CASE("set: a later one wins and the origin is kept") {
    const ReadResult result = read(least, {"seed=3", "seed=4"});
    CHECK(result.scenario.seed == 4);
    REQUIRE(result.values.find("seed"));
    CHECK(result.values.find("seed")->origin == Origin::command_line);
    CHECK(result.values.find("mesh.size")->origin == Origin::file);
    CHECK(result.values.find("mesh.grading")->origin == Origin::constant_default);
    CHECK(result.values.find("output.every")->origin == Origin::computed_default);
}

TEST_CASE("set: mistakes name the option") {
    struct Case {
        const char* set;
        const char* code;
        const char* excerpt;
    };
    for (const Case& c :
         {Case{"mesh.sise=1", "unknown-key", "did you mean `size`?"},
          Case{"mehs.size=1", "unknown-key", "did you mean `mesh`?"}, Case{"mesh.size=1 s", "wrong-unit", "a time"},
          Case{"mesh.size=-1", "out-of-range", "greater than 0"}, Case{"mesh.size=true", "wrong-type", "a length"},
          Case{"domain.model=plain strain", "unknown-word", "plane strain"},
          Case{"load[5].traction=1", "bad-override", "has 2"}, Case{"mesh[0]=", "bad-override", "cannot be left out"},
          Case{"load.traction=1", "bad-override", "no `traction` in this list"},
          Case{"load[x].traction=1", "bad-override", "not a path"}, Case{"mesh..size=1", "bad-override", "not a path"},
          Case{"load[0].velocity.z=1", "bad-override", "has the components x and y"},
          Case{"mesh.size.x=1", "bad-override", "no table"}, Case{"mesh.size", "bad-override", "KEY=VALUE"},
          Case{"=3", "bad-override", "KEY=VALUE"}, Case{"load[0].on=topp", "unknown-name", "did you mean `top`?"},
          Case{"load[0].velocity=[0, 1]", "exclusive-keys", "velocity"}}) {
        CAPTURE(c.set);
        const std::vector<Diagnostic> found = mistakes(loaded, {c.set});
        REQUIRE(found.size() == 1);
        CHECK(found[0].code == c.code);
        CHECK(found[0].file == std::string("--set ") + c.set);
        CHECK(found[0].line == 0);
        CHECK((found[0].message + found[0].hint + found[0].note).find(c.excerpt) != std::string::npos);
    }
}

TEST_CASE("set: what is not UTF-8 is refused as it is in a file") {
    for (const char* text :
         {"L\xf6we", "\xff", "\xc3", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"}) {
        CAPTURE(text);
        const std::vector<Diagnostic> found = mistakes(least, {std::string("title=") + text});
        REQUIRE(found.size() == 1);
        CHECK(found[0].code == "bad-override");
        CHECK(!mistakes("title = \"" + std::string(text) + "\"\n" + least).empty());
    }
    for (const char* text : {"Löwe", "σ_c € 𝛽", "\xed\x9f\xbf", "\xf4\x8f\xbf\xbf"}) {
        CHECK(read(least, {std::string("title=") + text}).scenario.title == text);
        CHECK(read("title = \"" + std::string(text) + "\"\n" + least).scenario.title == text);
    }
}

TEST_CASE("set: a path of very many keys is refused") {
    std::string path = "a";
    for (int i = 0; i < 50'000; ++i) path += ".a";
    const std::vector<Diagnostic> found = mistakes(least, {path + "=1"});
    REQUIRE(found.size() == 1);
    CHECK(found[0].code == "bad-override");
}

}  // namespace overrides_test
