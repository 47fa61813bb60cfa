// What a run is held against: three levels, limits that a scenario sets, warnings that come once.
#include "observe/gates.hpp"

#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <set>

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double none = std::numeric_limits<double>::infinity();

const Gate& named(const Gates& gates, std::string_view name) {
    return *std::find_if(gates.begin(), gates.end(), [&](const Gate& gate) { return gate.name == name; });
}

}  // namespace

TEST_CASE("gates: every rule has a name of its own and a meaning and a cure") {
    std::set<std::string_view> names;
    for (const GateRule& rule : gate_rules()) {
        CAPTURE(rule.name);
        CHECK(names.insert(rule.name).second);
        CHECK_FALSE(rule.meaning.empty());
        CHECK_FALSE(rule.cure.empty());
    }
}

TEST_CASE("gates: a limit of the scenario holds for the gate that it names where gates allow that") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    const State start = initial_state(model);
    EnergyLedger ledger(model, start);
    ledger.add(start, {.kinetic = 1, .external_work = 1, .residual = 2e-10, .penetration = 0.5});
    Gates gates;
    judge({ledger, 0.25, 1}, {}, gates);
    CHECK(named(gates, "penetration").limit == 0.25);
    CHECK(named(gates, "penetration").level == GateLevel::violated);
    CHECK(named(gates, "interface_residual").level == GateLevel::violated);

    const std::vector<AllowedLimit> more{{"penetration", 0.5}, {"interface_residual", none}};
    judge({ledger, 0.25, 1}, more, gates);
    CHECK(named(gates, "penetration").level == GateLevel::ok);  // at its limit
    CHECK(named(gates, "interface_residual").limit == 1e-10);   // the laws are kept in every scene
    judge({ledger, 0.25, 1}, std::vector<AllowedLimit>{{"penetration", none}}, gates);
    CHECK(named(gates, "penetration").pass());
}
