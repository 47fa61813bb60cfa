#pragma once
// The four pairs of a scheme for the bulk and one for the cohesion, by name.
#include "stepper/common/step_scheme.hpp"
#include "support/verification.hpp"

#include <string>
#include <vector>

namespace knap::tests {

inline std::string name_of(const SchemeOptions& scheme) {
    return std::string(scheme.bulk == BulkScheme::explicit_lumped ? "explicit" : "implicit") +
           (scheme.cohesion == CohesionScheme::explicit_beta ? ", explicit" : ", implicit");
}

inline constexpr SchemeOptions both_explicit{},
    both_implicit{.bulk = BulkScheme::implicit_theta, .cohesion = CohesionScheme::implicit_beta};

/// The two pairs that are of second order.
inline std::vector<SchemeOptions> both_paths() { return {both_explicit, both_implicit}; }

inline std::vector<SchemeOptions> all_paths() {
    return {both_explicit,
            {.cohesion = CohesionScheme::implicit_beta},
            {.bulk = BulkScheme::implicit_theta},
            both_implicit};
}

inline void on_path(const SchemeOptions& scheme) { on_path(name_of(scheme)); }

}  // namespace knap::tests
