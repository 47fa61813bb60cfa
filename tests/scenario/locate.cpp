// From what other layers say back to a line of the file.
#include "samples.hpp"

#include <doctest/doctest.h>

namespace locate_test {

using namespace knap;

namespace {

const std::string text = samples::least + R"([[domain.hole]]
centre = [0.05, 0.02]
radius = 0.001
[[domain.crack]]
points = [[0, 0.02], [0.02, 0.02]]
[[domain.crack]]
points = [[0, 0.03],
          [0.02, 0.03]]
[[domain.region]]
box = [0, 0, 0.01, 0.01]
material = "glass"
)";

}  // namespace

TEST_CASE("locate: parts of a shape") {
    struct Case {
        const char* part;
        int line, column, length;
    };
    const ReadResult result = samples::read(text);
    for (const Case& c : {Case{"outer", 4, 8, 11}, Case{"holes[0]", 18, 10, 5}, Case{"cracks[0]", 20, 10, 25},
                          Case{"cracks[1]", 22, 10, 11}, Case{"regions[0]", 25, 7, 18}, Case{"size", 6, 8, 5}}) {
        CAPTURE(c.part);
        const Diagnostic d = result.at_shapes(ShapeError(c.part, "is no good")).front();
        CHECK(d.code == "bad-shape");
        CHECK(d.severity == Diagnostic::Severity::error);
        CHECK(d.message.ends_with("is no good"));
        CHECK(d.file == "sample.toml");
        CHECK(d.line == c.line);
        CHECK(d.column == c.column);
        CHECK(d.length == c.length);
    }
    CHECK(result.at_shapes(ShapeError("cracks[1]", "x")).front().message == "`domain.crack[1]` x");
}

TEST_CASE("locate: keys and tables above them") {
    const ReadResult result = samples::read(text, {"mesh.grading=0.5"});
    CHECK(result.at("mesh.size", {}).line == 6);
    CHECK(result.at("mesh.min_angle", {}).line == 5);  // a default: its table
    CHECK(result.at("time.safety", {}).line == 14);
    CHECK(result.at("output.every", {}).line == 0);
    CHECK(result.at("output.every", {}).file == "sample.toml");
    CHECK(result.at("mesh.grading", {}).file == "--set mesh.grading=0.5");
    CHECK(result.at("mesh.grading", {}).line == 0);
}

}  // namespace locate_test
