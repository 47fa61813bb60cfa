// [contact]: which law acts between free faces of which materials.
#include "base/text.hpp"
#include "scenario/reading.hpp"

#include <algorithm>
#include <set>

namespace knap {
namespace {

/// R_N and R_T of an obstacle or of a range of it, of faces or of a pair of materials.
void refuse_rebounds(const Table& table) {
    const SchemeOptions& scheme = table.scenario().time.scheme;
    for (const char* key : {"R_N", "R_T"})
        if (table.given(key) && scheme.takes_implicit_steps())
            return table.exclude(key, "R_N", words_of(scheme.bulk),
                                 "time.bulk = \"explicit\", or friction and restitution");
}

void warn_of_ghosts(Reading& reading) {
    if (reading.scenario.bodies.size() < 2) return;
    reading.table(reading.scenario.bodies[1].path)
        .warning("no-contact", "", "is a second body, and without [contact] bodies pass through each other",
                 "[contact], with rotation = \"large\" in [domain]");
}

/// A block that topples over or slides leaves the faces that it stood on.
void warn_of_supports(Reading& reading) {
    const std::vector<Support>& supports = reading.scenario.supports;
    for (std::size_t i = 0; i < supports.size(); ++i) {
        const Support& support = supports[i];
        const Table table = reading.table(item("support", i));
        if (support.law < 0) continue;                                                       // reported
        if (support.glued && !reading.scenario.laws[support.law].law.breakable()) continue;  // the body stays
        if (table.given("beyond")) continue;
        table.warning(
            "support-ends", "",
            "ends where the faces end that stand on it at the start: pieces that get beyond fall past it",
            "beyond = \"1 m\" for a ground that goes on straight at its ends, or beyond = 0 if it ends there; "
            "an [[obstacle]] for one that moves or is endless");
    }
}

/// Without [contact].
void refuse_ground(Reading& reading) {
    const std::vector<Support>& supports = reading.scenario.supports;
    for (std::size_t i = 0; i < supports.size(); ++i)
        if (supports[i].beyond > 0)
            reading.table(item("support", i))
                .error("exclusive-keys", "beyond", "is a ground for contact between free faces",
                       "[contact], or no `beyond`: without [contact] a support is an endless plane");
}

/// Implicit steps with contact between free faces.
void check_implicit_contact(Reading& reading) {
    const Table time = reading.table("time");
    double e = 0;
    for (const std::vector<ContactLaw>& of_material : reading.scenario.contact_of_pair)
        for (const ContactLaw& law : of_material) e = std::max(e, law.restitution);
    check_theta(time, "free faces ([contact])", e);
    if (const double theta = reading.scenario.time.scheme.theta; theta < 0.55 && e == 0)
        time.warning("no-rest", "theta",
                     "= " + shortest(theta) +
                         ": bodies that lie on each other go on to vibrate, and their contacts open and close in each "
                         "step",
                     "theta = 1 (it brakes a spin w: its energy falls by 2 (theta - 1/2) step w^2 of itself per time)");
}

}  // namespace

void read_contact_law(const Table& table, ContactLaw& law) {
    const bool has_R_N = table.given("R_N");
    if (has_R_N && table.given("restitution"))
        table.error("exclusive-keys", "R_N", "is the rebound of bodies, restitution that of faces", "one of both");
    if (has_R_N) table.leave_out("restitution");
    table.fill(law);
    if (table.given("friction")) law.changing = -1;
    law.gives_restitution |= has_R_N || table.given("restitution");
    if (table.given("restitution")) law.rebound = ContactLaw::Rebound::of_faces;
    if (has_R_N) law.rebound = ContactLaw::Rebound::of_bodies, law.restitution = table.number("R_N").value_or(0);
    if (table.given("R_T") && law.tangential < 1 && law.friction == 0)
        table.warning("no-friction", "R_T", "has no effect: it is friction that brakes the slip, and friction is 0",
                      "friction = 0.5");
}

void read_contact(Reading& reading) {
    for (const Table& obstacle : reading.list("obstacle")) {
        refuse_rebounds(obstacle);
        for (const Table& range : obstacle.list("range")) refuse_rebounds(range);
    }
    const Table table = reading.table("contact");
    if (!table.given()) {
        refuse_ground(reading);
        return warn_of_ghosts(reading);
    }
    if (reading.table("domain").text("rotation") == "small")  // any other word has its own error
        table.error("exclusive-keys", "", "needs large rotations", "rotation = \"large\" in [domain]");
    const SchemeOptions& scheme = reading.scenario.time.scheme;
    if (!scheme.takes_implicit_steps() && scheme.cohesion != CohesionScheme::explicit_beta)
        table.exclude("", "[contact]", "cohesion = \"implicit\"",
                      "time.cohesion = \"explicit\", and the explicit bulk");
    warn_of_supports(reading);
    const std::vector<std::string> materials = reading.scenario.material_names();
    const std::size_t n = materials.size();
    std::vector<std::vector<ContactLaw>>& contact_of_pair = reading.scenario.contact_of_pair;
    contact_of_pair.assign(n, std::vector<ContactLaw>(n));
    for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
            ContactLaw& law = contact_of_pair[a][b];
            if (const Index number = reading.scenario.law_of_pair[a][b]; number >= 0) {  // otherwise reported
                const CohesiveLaw& of = reading.scenario.laws[number].law;
                law = {.friction = of.friction, .restitution = of.restitution};
                if (of.friction_changes()) law.changing = static_cast<int>(number);
            }
            read_contact_law(table, law);
            law.gives_restitution |= law.restitution > 0;
        }
    std::set<std::pair<Index, Index>> pairs;
    for (const Table& row : table.list("pair")) {
        std::vector<Index> material;
        for (const std::string& name : row.texts("materials"))
            if (const auto found = reading.find(row.path("materials"), "material", name, materials))
                material.push_back(*found);
        if (material.size() != 2) continue;
        const auto [a, b] = std::minmax(material[0], material[1]);
        if (!pairs.emplace(a, b).second)
            row.error("duplicate-name", "materials", "is the second entry of this pair of materials");
        if (!row.given("friction") && !row.given("restitution") && !row.given("R_N") && !row.given("R_T"))
            row.error("missing-key", "", "has neither friction nor restitution, R_N or R_T");
        read_contact_law(row, contact_of_pair[a][b]);
        contact_of_pair[b][a] = contact_of_pair[a][b];
    }
    refuse_rebounds(table);
    for (const Table& row : table.list("pair")) refuse_rebounds(row);
    if (scheme.takes_implicit_steps()) check_implicit_contact(reading);
}

}  // namespace knap
