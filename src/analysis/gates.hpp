#pragma once
// The gates of a run: what it is held against after every step. A gate is kept; or it warns, which is said once while the run goes on; or it is violated,
// which ends the run.
//
// One list of rules makes them all (gates.cpp): a new gate is a row of it. A rule that bounds what knap can compute, not whether it computed rightly, may be
// given another limit by the scenario: [limits] has a key of the same name.
#include "analysis/deformation_watch.hpp"
#include "analysis/energy_ledger.hpp"

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace knap {

enum class GateLevel { ok, warning, violated };
std::string_view name_of(GateLevel level);

struct Gate {
    std::string_view name, unit;  // of literals, like all texts here
    double value;                 // [unit] NaN where there was nothing to judge (ok), or where it is no number (violated)
    double warning, limit;        // [unit] a value beyond warns, or violates; infinity: none does
    GateLevel level;
    std::optional<Vec2> place;    // [m] of the value, in the undeformed body
    std::string_view meaning;     // of the value
    std::string_view cure;        // what it usually comes from, and what to change

    bool pass() const { return level != GateLevel::violated; }
};
using Gates = std::vector<Gate>;

/// A limit that a scenario sets, in the unit of its gate; infinity: none.
struct AllowedLimit {
    std::string gate;
    double limit;
};

/// What gates are judged from.
struct GateView {
    const EnergyLedger& ledger;
    double critical_opening;  // [m] the largest of the laws that can break
    double size;              // [m] diagonal of the body
    bool ended = false;       // no step follows: what is a part of the dissipated energy can be judged
    const DeformationWatch* deformation = nullptr;  // null: not watched
};

struct GateValue {
    double value;                                // [unit]
    std::optional<Vec2> place = std::nullopt;    // [m]
    std::optional<double> limit = std::nullopt;    // [unit] where they depend on the scene: in the place of the rule's
    std::optional<double> warning = std::nullopt;
    bool judged = true;                          // false: there was nothing to judge
};

struct GateRule {
    std::string_view name, unit;
    double warning, limit;  // [unit] infinity: none
    bool allowed;           // the scenario may set another limit
    GateValue (*measure)(const GateView&);
    std::string_view meaning, cure;
};
std::span<const GateRule> gate_rules();

/// All gates, in the order of the rules, into `gates`, whose memory is used again. The warning is never later than the limit.
void judge(const GateView& view, std::span<const AllowedLimit> allowed, Gates& gates);

/// Judges a run step by step and remembers of what it has warned.
class GateKeeper {
public:
    GateKeeper(double critical_opening, double size, std::vector<AllowedLimit> allowed) : critical_opening_(critical_opening), size_(size), allowed_(std::move(allowed)) {}

    const Gates& judge(const EnergyLedger& ledger, const DeformationWatch& deformation, bool ended = false) {
        knap::judge({.ledger = ledger, .critical_opening = critical_opening_, .size = size_, .ended = ended, .deformation = &deformation}, allowed_, gates_);
        return gates_;
    }
    const Gates& gates() const { return gates_; }
    bool pass() const;

    /// Gates that warn and have not been warned of.
    std::vector<const Gate*> new_warnings() const;
    void warned(const Gate& gate, std::string text) { said_.emplace_back(gate.name, std::move(text)); }
    const std::vector<std::pair<std::string, std::string>>& said() const { return said_; }  // name of the gate, text

    template <class Archive>
    void serialize(Archive& archive) { archive(said_); }

private:
    double critical_opening_, size_;  // [m]
    std::vector<AllowedLimit> allowed_;
    Gates gates_;
    std::vector<std::pair<std::string, std::string>> said_;
};

}  // namespace knap
