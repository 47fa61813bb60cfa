#include "figures/ticks.hpp"
#include "figures/colours.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace ticks_test {

using namespace knap;
using knap::tests::relative;

TEST_CASE("ticks: round and inside and no more than requested") {
    for (const double low : {-7.3e-6, -1.0, 0.0, 0.02, 95.0, 1e4}) {
        for (const double width : {1e-6, 0.013, 1.0, 9.99, 12345.0}) {
            const double high = low + width;
            for (const int n : {3, 5, 9}) {
                const Ticks ticks = round_ticks(low, high, n);
                CAPTURE(low);
                CAPTURE(width);
                CAPTURE(n);
                CHECK(ticks.at.size() <= static_cast<std::size_t>(n));
                CHECK(ticks.labels.size() == ticks.at.size());
                const double digit = ticks.step / std::pow(10, std::floor(std::log10(ticks.step) + 1e-9));
                CHECK((std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 2.5) < 1e-6 ||
                       std::abs(digit - 5) < 1e-6));
                for (const double at : ticks.at) CHECK((at >= low - 1e-6 * width && at <= high + 1e-6 * width));
                const Limits range = round_range(low, high, n);
                const Ticks inside = round_ticks(range.low, range.high, n);
                REQUIRE(inside.at.size() >= 2);
                CHECK(std::abs(inside.at.front() - range.low) <= 1e-4 * inside.step);
                CHECK(std::abs(inside.at.back() - range.high) <= 1e-4 * inside.step);
                CHECK(range.low <= low + 1e-6 * width);
                CHECK(range.high >= high - 1e-6 * width);
            }
        }
    }
}

TEST_CASE("ticks: labels have equal decimals and a true minus sign") {
    CHECK(round_ticks(-0.5, 0.5, 3).labels == std::vector<std::string>{"−0.5", "0.0", "0.5"});
    CHECK(round_ticks(0, 100, 6).labels == std::vector<std::string>{"0", "20", "40", "60", "80", "100"});
    CHECK(round_ticks(0, 0.3, 4).labels == std::vector<std::string>{"0.0", "0.1", "0.2", "0.3"});
}

TEST_CASE("ticks: numbers of any size have a label") {
    CHECK(round_ticks(-2e80, 2e80, 5).labels == std::vector<std::string>{"−2e+80", "−1e+80", "0", "1e+80", "2e+80"});
    CHECK(round_ticks(0, 3e15, 4).labels == std::vector<std::string>{"0", "1e+15", "2e+15", "3e+15"});
    CHECK(time_text(1e80) == "1e+80 s");
    CHECK(time_text(1e-80) == "1e-80 s");
}

TEST_CASE("ticks: prefixes") {
    CHECK(display_unit(25e3, "W").unit == "kW");
    CHECK(display_unit(3.08e6, "Pa").unit == "MPa");
    CHECK(display_unit(3.08e6, "Pa").factor == tests::relative(1e-6));
    CHECK(display_unit(0.1, "m").unit == "mm");
    CHECK(display_unit(1.0, "m").unit == "m");
    CHECK(display_unit(80e-6, "s").unit == "µs");
    CHECK(display_unit(2125, "m/s").unit == "m/s");
    CHECK(display_unit(0, "J").unit == "J");
    CHECK(display_unit(0.5, "").unit == "");
    CHECK(display_unit(1e-3, "m2").unit == "m2");  // not mm2, which are 1e-6 m2
    CHECK(readable(6.3e-4, "m") == "630 µm");
    CHECK(readable(-5.866e-5, "s", 4) == "-58.66 µs");
    CHECK(readable(0, "s") == "0 s");
    CHECK(readable(0.1349, "s", 2) == "130 ms");  // not 1.3e+02
    CHECK(readable(2513, "m/s") == "2510 m/s");
    CHECK(readable(999.6, "m/s") == "1000 m/s");
    CHECK(readable(999, "s") == "999 s");
    CHECK(readable(1000, "s") == "16.7 min");
    CHECK(readable(1000, "s", 6) == "1000 s");
    CHECK(readable(36000, "s", 6) == "10 h");
    CHECK(readable(86400, "s") == "1 day");
    CHECK(readable(1e8, "s") == "3.17 year");
    CHECK(readable(123456.5, "s", 9) == "123456.5 s");  // as in the tables of a run
    CHECK(display_unit(1e-3, "kg m/s").unit == "kg m/s");
    CHECK(display_unit(3e6, "Pa m^0.5").unit == "MPa m^0.5");
    CHECK(display_unit(1e-20, "m").unit == "m");
    CHECK(with_unit("time", "µs") == "time [µs]");
    CHECK(with_unit("cohesion", "") == "cohesion");
}

TEST_CASE("ticks: times read well") {
    CHECK(time_text(40e-6) == "40 µs");
    CHECK(time_text(40.03e-6) == "40 µs");
    CHECK(time_text(12.54e-6) == "12.54 µs");
    CHECK(time_text(117.5e-6) == "117.5 µs");
    CHECK(time_text(0) == "0 s");
    CHECK(time_text(2) == "2 s");
    CHECK(time_text(1200) == "1200 s");
    CHECK(time_text(40e-6, true) == "40us");
    CHECK(time_text(0.0125, true) == "12.5ms");
}

namespace {

Limits robust_range(const std::vector<double>& values, double outside, bool symmetric) {
    const ValueSpan span = span_of(values, outside);
    return round_limits(span.low, span.high, symmetric);
}

}  // namespace

TEST_CASE("colour range: a few peaks do not set it and a constant field has one") {
    std::vector<double> values(1000, 1e6);
    for (int i = 0; i < 500; ++i) values[i] = -2e6;
    values[10] = 1e9;
    const Limits range = robust_range(values, 0.005, true);
    CHECK(range.low == relative(-2e6));
    CHECK(range.high == relative(2e6));
    for (const double constant : {0.0, 3.0, -3.0}) {
        for (const bool symmetric : {false, true}) {
            const Limits one = robust_range({constant, constant}, 0.005, symmetric);
            CHECK(one.low <= constant);
            CHECK(one.high >= constant);
            CHECK(one.low < one.high);
        }
    }
    // signed, but of one sign: no half of the bar stands for nothing
    CHECK(robust_range({-8e6, -1e6}, 0, true).low == relative(-8e6));
    CHECK(robust_range({-8e6, -1e6}, 0, true).high == 0);
    CHECK(robust_range({1e6, 8e6}, 0, true).low == 0);
    CHECK(robust_range({}, 0.1, false).low < robust_range({}, 0.1, false).high);
    CHECK(robust_range({std::nan(""), 1, 2}, 0, false).high == relative(2));
}

TEST_CASE("colour map: grows in lightness or is symmetric") {
    const auto lightness = [](const Colour& c) {
        return 0.2126 * std::pow(c.red, 2.2) + 0.7152 * std::pow(c.green, 2.2) + 0.0722 * std::pow(c.blue, 2.2);
    };
    for (const ColourMap& map : {ColourMap::viridis, ColourMap::plasma})
        for (int i = 0; i < 100; ++i) CHECK(lightness(map(0.01 * i)) < lightness(map(0.01 * (i + 1))));
    const ColourMap map = ColourMap::diverging;
    for (int i = 0; i < 50; ++i) {
        CHECK(lightness(map(0.01 * i)) < lightness(map(0.01 * (i + 1))));
        CHECK(lightness(map(1 - 0.01 * i)) < lightness(map(1 - 0.01 * (i + 1))));
        CHECK(std::abs(std::sqrt(lightness(map(0.01 * i))) - std::sqrt(lightness(map(1 - 0.01 * i)))) < 0.12);
    }
    CHECK(map(-3).blue == map(0).blue);
    CHECK(map(7).red == map(1).red);
}

}  // namespace ticks_test
