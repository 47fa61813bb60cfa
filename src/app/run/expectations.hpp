#pragma once
// [expect]: what a scenario says its run must find.
#include "record/summary.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace knap {

struct ExpectResult {
    std::string name, limit;  // "max_tip_speed", "below 0.65 cR"
    double value;             // SI; NaN: it never happened, which fails every bound
    bool pass;
};

std::vector<ExpectResult> judge_expectations(const std::vector<Expectation>& expectations, const Summary& summary, double rayleigh_speed);

}  // namespace knap
