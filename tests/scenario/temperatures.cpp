// Temperatures in degrees Celsius or in K: one zero for all, nothing is converted.
#include "samples.hpp"

#include "scenario/write_scenario.hpp"

#include <doctest/doctest.h>

namespace temperatures_test {

using namespace knap;

namespace {

std::string warm(const std::string& reference, const std::string& temperature) {
    return samples::least + "[heat]\nreference = " + reference + "\ntemperature = \"" + temperature + "\"\n";
}

}  // namespace

TEST_CASE("temperatures: one unit says where all of them count from") {
    const auto heat = [](const std::string& text) { return *samples::read(text).scenario.heat; };
    CHECK(heat(warm("\"20 C\"", "20 + 300*x")).celsius);
    CHECK(heat(warm("20", "300 C")).celsius);
    CHECK_FALSE(heat(warm("20", "300")).celsius);
    CHECK_FALSE(heat(warm("\"293 K\"", "300 K")).celsius);
    CHECK(heat(warm("\"20 C\"", "-7.5 C")).reference == 20);
    CHECK(heat(warm("\"20 C\"", "-7.5 C")).field_at({0, 0}, 0) == -7.5);
    CHECK(heat(warm("\"20 C\"", "300") +
               "[[figure]]\nfile = \"T.png\"\nshow = \"temperature\"\nmark = \"0 C\"\nrange = [0, \"9 C\"]\n")
              .celsius);
}

TEST_CASE("temperatures: a resolved scenario has the same zero") {
    const ReadResult first = samples::read(warm("\"20 C\"", "300"));
    const std::string resolved = resolved_toml(first);
    CHECK(resolved.find(" C\"") != std::string::npos);
    const Scenario again = samples::read(resolved).scenario;
    CHECK(again.heat->celsius);
    CHECK(again.heat->reference == 20);
    CHECK(full_listing(first).find("C\" K") == std::string::npos);
}

TEST_CASE("temperatures: one that the command line mixes in is named by its option") {
    try {
        samples::read(warm("\"20 C\"", "300"), {"heat.reference=293 K", "heat.temperature=20 C"});
        FAIL("read");
    } catch (const UserError& error) {
        const std::string& message = error.diagnostics.at(0).message;
        CHECK(message.find("--set heat.reference=293 K") != std::string::npos);
        CHECK(message.find("line 0") == std::string::npos);
    }
}

}  // namespace temperatures_test
