#pragma once
// One run of a scene of flying bodies, held against what no run may ever do.
#include "properties/flying_bodies.hpp"

#include <string>

namespace knap::tests {

struct FlyingOutcome {
    bool rejected = false;   // no scene: bodies that overlap at the start
    std::string broken_law;  // with numbers; empty for a good run
    std::string refusal;     // why the program ended the run before its end, which it may; empty: it did not
    int n_steps = 0, n_cuts = 0;
    long n_contacts = 0;              // of all steps
    int n_broken = 0, n_retired = 0;  // points at the end
    double depth = 0;                 // [-] reported by the contacts, over the edge
    double overlap = 0;               // [-] of two triangles, over the longest edge of both
    double injected = 0;              // [-] positive works of contacts, over what friction and impacts dissipated
    double residual = 0;              // [-] of contacts
    double energy_error = 0, momentum_error = 0, moment_error = 0;  // [-]
};

FlyingOutcome run_flying(const FlyingScene& scene);

/// The smallest scene found that breaks the same law, in small steps.
FlyingScene shrunk(FlyingScene scene, const std::string& broken_law);

std::string text_of(const FlyingScene& scene);

}  // namespace knap::tests
