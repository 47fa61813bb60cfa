#pragma once
// Pairs of keys that do not go together, each with its reason: one table for messages and for `knap schema --markdown`.
#include <span>
#include <string_view>

namespace knap {

struct Exclusion {
    std::string_view one, other;  // "[adapt]", "mesh.order = 2"
    std::string_view because;     // a clause: "its steps are linear in the displacement"
};

std::span<const Exclusion> exclusions();

/// The reason against a pair of the table, in either order.
std::string_view reason_against(std::string_view one, std::string_view other);

}  // namespace knap
