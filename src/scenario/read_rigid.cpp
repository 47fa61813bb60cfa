// [rigid]: pieces that move as rigid bodies while nothing can break them, and what such pieces do not know.
#include "scenario/reading.hpp"

#include <algorithm>
#include <optional>

namespace knap {
namespace {

/// Forces on faces and in volumes stress a body without any contact: a rigid piece would never break under them.
void refuse_loads(Reading& reading) {
    const std::vector<Load>& loads = reading.scenario.loads;
    const std::vector<Table> tables = reading.list("load");
    for (std::size_t i = 0; i < std::min(loads.size(), tables.size()); ++i) {
        const Load& load = loads[i];
        if (load.kind == Load::Kind::acceleration) continue;
        if (load.drives()) {
            const auto [x, y] = load.value;
            if (x == 0. && y == 0.) continue;
            const bool is_roller = (x == 0. && !y) || (y == 0. && !x);
            tables[i].error("exclusive-keys", "",
                            is_roller ? "and [rigid]: a roller leaves its piece one direction, and a rigid piece is "
                                        "either held or free"
                                      : "and [rigid]: a driven boundary deforms its piece, and a rigid one has no "
                                        "stresses",
                            is_roller ? "an [[obstacle]] without friction, a boundary that is held (displacement = "
                                        "[0, 0]), or no [rigid]"
                                      : "an [[obstacle]] that is driven, or no [rigid]; a boundary may be held: "
                                        "displacement = [0, 0]");
            continue;
        }
        tables[i].error("exclusive-keys", "",
                        "and [rigid]: this load stresses its piece without any contact, and a rigid one has no "
                        "stresses, so it would never break",
                        "acceleration (gravity), an [[obstacle]], or no [rigid]");
    }
}

/// An obstacle that gives no restitution has that of [contact], if this gives one, before rigid.restitution.
void share_restitution(const Table& contact, std::vector<Obstacle>& obstacles) {
    using Rebound = ContactLaw::Rebound;
    const std::optional<double> of_bodies = contact.given("R_N") ? contact.number("R_N") : std::nullopt,
                                of_faces = contact.given("restitution") ? contact.number("restitution") : std::nullopt;
    if (!of_bodies && !of_faces) return;
    const auto share = [&](ContactLaw& law) {
        if (law.gives_restitution) return;
        law.rebound = of_bodies ? Rebound::of_bodies : Rebound::of_faces;
        law.restitution = of_bodies.value_or(of_faces.value_or(0)), law.gives_restitution = true;
    };
    for (Obstacle& obstacle : obstacles) {
        share(obstacle.contact);
        for (SurfaceRange& range : obstacle.ranges) share(range.law);
    }
}

}  // namespace

void read_rigid(Reading& reading) {
    const Table table = reading.table("rigid");
    Scenario& scenario = reading.scenario;
    RigidOptions& rigid = scenario.time.scheme.rigid;
    if (!table.given()) return;
    for (const auto& [key, value] : {std::pair{"step", 5e-4}, std::pair{"thaw", rigid.thaw},
                                     std::pair{"hold", rigid.hold}, std::pair{"smallest", rigid.smallest},
                                     std::pair{"sleep", rigid.sleep}, std::pair{"restitution", rigid.restitution}})
        table.compute(key, Node::of_number(value));
    table.fill(rigid);
    scenario.time.rest.sleeps = rigid.sleep > 0;
    if (!reading.table("contact").given())
        table.error("exclusive-keys", "", "needs contact between pieces", "[contact]");
    const auto exclude = [&](bool is_there, const std::string& other, const std::string& cure) {
        if (is_there) table.exclude("", "[rigid]", other, cure + ", or no [rigid]");
    };
    share_restitution(reading.table("contact"), scenario.obstacles);
    exclude(scenario.heat && scenario.heat->changes(), "[heat] that changes",
            "temperatures that stay (those of another run: time.start and temperature = \"frozen\")");
    exclude(!scenario.crack_pressures.empty(), "[[pressure]]", "no [[pressure]]");
    exclude(!scenario.initial_stresses.empty(), "[[initial]] stress", "no stress in [[initial]]");
    exclude(!scenario.excavations.empty(), "[[excavation]]", "no [[excavation]]");
    exclude(!scenario.time.scheme.absorbing.empty(), "[[absorb]]", "a support or an obstacle");
    exclude(reading.table("specimen").given(), "[specimen]", "no [specimen]");
    exclude(std::ranges::any_of(reading.list("probe"), [](const Table& at) { return at.text("watch") == "stress"; }),
            "a probe of stress", "no such probe");
    const auto any_law = [&](const auto& has) {
        return std::ranges::any_of(scenario.laws,
                                   [&](const NamedLaw& law) { return law.law.breakable() && has(law.law); });
    };
    exclude(any_law([](const CohesiveLaw& law) { return law.incubation_time > 0; }), "incubation_time",
            "incubation_time = 0");
    exclude(any_law([](const CohesiveLaw& law) { return law.over_pressure != nullptr; }), "friction_over_pressure",
            "friction, the chord at the pressure in question");
    exclude(any_law([](const CohesiveLaw& law) { return law.unloading == Unloading::vertical; }),
            "unloading = \"vertical\"", "unloading = \"secant\"");
    refuse_loads(reading);
}

}  // namespace knap
