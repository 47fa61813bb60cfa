#pragma once
// The gates of a run: criteria that are checked after every step. A gate is ok; or it warns, once, while the run goes
// on; or it is violated, which ends the run. A new gate is a row of the table in gates.cpp.
#include "base/vec.hpp"

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

class DeformationWatch;
class EnergyLedger;

enum class GateLevel { ok, warning, violated };
std::string_view name_of(GateLevel level);

struct GateTexts {
    std::string_view name, unit;  // of literals, like all texts here
    std::string_view meaning;     // of the value
    std::string_view cure;        // usual causes, and what to change
};

struct Gate : GateTexts {
    double value;           // [unit] NaN where there was nothing to judge (ok), or where it is not a number (violated)
    double warning, limit;  // [unit] a larger value warns, or violates; infinity: none does
    GateLevel level;
    std::optional<Vec2> place;  // [m] of the value, in the undeformed body

    bool pass() const { return level != GateLevel::violated; }
};
using Gates = std::vector<Gate>;

/// A limit from the scenario, in the unit of its gate; infinity: none.
struct AllowedLimit {
    std::string gate;
    double limit;
};

/// What gates are judged from.
struct GateView {
    const EnergyLedger& ledger;
    double critical_opening;                        // [m] the largest of the laws that can break
    double size;                                    // [m] diagonal of the body
    bool ended = false;                             // no step follows: parts of the dissipated energy can be judged
    const DeformationWatch* deformation = nullptr;  // null: not watched
    double kinetic_part = std::nan("");             // [-] as in the summary, at the end; NaN: not yet
};

struct GateValue {
    double value;                                                        // [unit]
    std::optional<Vec2> place = std::nullopt;                            // [m]
    std::optional<double> limit = std::nullopt, warning = std::nullopt;  // [unit] where they depend on the run
    bool judged = true;                                                  // false: there was nothing to judge
};

struct GateLimits {
    double warning, limit;  // [unit] infinity: none, or from the value
    bool allowed;           // [limits] may set another limit: a bound of what knap can model, not of its correctness
};

struct GateRule : GateTexts, GateLimits {
    GateValue (*measure)(const GateView&);
};
std::span<const GateRule> gate_rules();

/// All gates, in the order of the rules, into `gates`, whose memory is reused. A warning is at most the limit.
void judge(const GateView& view, std::span<const AllowedLimit> allowed, Gates& gates);

/// Judges a run step by step and remembers which warnings it gave.
class GateKeeper {
public:
    GateKeeper(double critical_opening, double size, std::vector<AllowedLimit> allowed)
        : critical_opening_(critical_opening), size_(size), allowed_(std::move(allowed)) {}

    void judge(const EnergyLedger& ledger, const DeformationWatch& deformation) {
        knap::judge({ledger, critical_opening_, size_, false, &deformation}, allowed_, gates_);
    }
    void judge_end(const EnergyLedger& ledger, const DeformationWatch& deformation);
    const Gates& gates() const { return gates_; }
    bool pass() const;

    /// Gates that warn and have not given a warning yet.
    std::vector<const Gate*> new_warnings() const;
    void warned(const Gate& gate, std::string text) { warnings_.emplace_back(gate.name, std::move(text)); }
    /// Names of gates and what they warned of.
    const std::vector<std::pair<std::string, std::string>>& warnings() const { return warnings_; }

    void serialize(auto& archive) { archive(warnings_); }

private:
    double critical_opening_, size_;  // [m]
    std::vector<AllowedLimit> allowed_;
    Gates gates_;
    std::vector<std::pair<std::string, std::string>> warnings_;
};

}  // namespace knap
