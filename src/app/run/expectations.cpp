#include "app/run/expectations.hpp"

#include "record/outputs.hpp"

#include <cmath>
#include <cstdio>

namespace knap {
namespace {

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

}  // namespace

std::vector<ExpectResult> judge_expectations(const std::vector<Expectation>& expectations, const Summary& summary, double rayleigh_speed) {
    std::vector<ExpectResult> results;
    for (const Expectation& expected : expectations) {
        const double unit = expected.unit == "cR" ? rayleigh_speed : 1, value = summary[expected.key];
        const std::string said(expected.unit.empty() ? unit_of("summary", expected.key) : expected.unit), tail = said.empty() ? "" : " " + said;
        const auto bound = [&](const std::optional<double>& limit, const char* word, auto holds) {
            if (limit) results.push_back({expected.key, word + number(*limit) + tail, value, holds(value, *limit * unit)});
        };
        bound(expected.below, "below ", [](double a, double b) { return a < b; });
        bound(expected.above, "above ", [](double a, double b) { return a > b; });
        bound(expected.at_least, "at least ", [](double a, double b) { return a >= b; });
        bound(expected.at_most, "at most ", [](double a, double b) { return a <= b; });
        if (expected.value) {
            const double wanted = *expected.value * unit;
            const double allowed = expected.relative ? expected.within * std::abs(wanted) : expected.within * unit;
            const std::string within = expected.relative ? number(100 * expected.within) + " %" : number(expected.within) + tail;
            results.push_back({expected.key, number(*expected.value) + tail + " within " + within, value, std::abs(value - wanted) <= allowed});
        }
    }
    return results;
}

}  // namespace knap
