#pragma once
// [sweep]: which keys and seeds of a scenario are varied.
#include <string>
#include <vector>

namespace knap {

struct SweepOptions {
    std::vector<std::string> set;         // KEY=VALUE,VALUE,...
    int n_seeds = 0;                      // 0: the scenario's own
    std::vector<std::string> quantities;  // numbers of the summary in the table
    std::string show = "cracks";          // what the contact sheet shows
};

}  // namespace knap
