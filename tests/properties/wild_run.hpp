#pragma once
// One run of a wild body, held against what no run may ever do.
#include "properties/wild_body.hpp"

#include <array>
#include <string>

namespace knap::tests {

struct WildOutcome {
    std::string broken_law;           // what it did wrong, with place and numbers; empty for a good run
    std::string stop;                 // why it ended early, which is legal if it says why; empty for a run to its end
    int n_steps = 0;                  // taken
    int n_cuts = 0;                   // steps not taken
    int n_damaged = 0, n_broken = 0;  // points at the end
    State end;
};

WildOutcome run_wild(const WildBody& wild);

/// The same run in units that are powers of two: the same bits, or what differs.
std::string difference_in_other_units(const WildBody& wild, const WildOutcome& outcome);

}  // namespace knap::tests
