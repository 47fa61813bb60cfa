// How far an initial stress and the loads at t = 0 balance each other.
#include "app/check/stress_balance.hpp"

#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/state.hpp"

#include <algorithm>

namespace knap {
namespace {

struct StressBalance {
    double stress = 0;        // [Pa] the largest component
    double forces = 0;        // [N] of the stress on all corners, sum of the magnitudes
    double of_stress = 0;     // [N] of the stress on all vertices likewise: what something has to balance
    double unbalanced = 0;    // [N] with the loads, where nothing is held
    double acceleration = 0;  // [m/s2] the largest one
    Vec2 where = Vec2::Zero();

    bool holds() const { return unbalanced <= 1e-9 * forces; }
};

StressBalance stress_balance_of(const Model& model) {
    StressBalance balance;
    for (const auto& of_place : model.initial_stress)
        for (const double component : of_place) balance.stress = std::max(balance.stress, std::abs(component));
    const State start = initial_state(model);
    std::vector<Vec2> stress(model.fans.size(), Vec2::Zero()), sum = stress;
    for (const CornerLoad& load : model.corner_loads) {
        const Vec2 force = model.histories[load.history](0) * force_of(model, load, start);
        const Index fan = model.fan_of_corner[load.corner];
        sum[fan] += force;
        if (load.history != model.history_of_initial_stress) continue;
        stress[fan] += force, balance.forces += force.norm();
    }
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        const auto points = model.points(fan);
        if (std::ranges::any_of(points, &FanPoint::on_support)) continue;  // it pushes back
        const Index corner = model.corners(fan)[0];
        const PrescribedMotion* const motion = model.motion_of(corner);
        for (int k = 0; k < 2; ++k)
            if (motion && motion->component[k]) sum[f][k] = stress[f][k] = 0;
        balance.of_stress += stress[f].norm(), balance.unbalanced += sum[f].norm();
        if (const double a = sum[f].norm() / fan.mass; a > balance.acceleration)
            balance.acceleration = a, balance.where = model.mesh.corner(corner);
    }
    return balance;
}

std::string part_text(const StressBalance& balance) {
    return formatted("%.3g %% of the forces that it puts on the vertices of the mesh",
                     100 * balance.unbalanced / std::max(balance.of_stress, balance.unbalanced));
}

}  // namespace

std::string initial_stress_text(const Scenario& scenario, const Model& model) {
    if (model.initial_stress.empty()) return "";
    const StressBalance balance = stress_balance_of(model);
    return "  initial stress up to " + readable(balance.stress, "Pa") +
           (balance.holds()                      ? ", which loads and supports balance"
            : scenario.time.start_in_equilibrium ? "; before the start the body strains for " + part_text(balance)
                                                 : "; nothing balances " + part_text(balance)) +
           "\n";
}

std::vector<Diagnostic> findings_of_initial_stress(const ReadResult& read, const Model& model) {
    const TimeOptions& time = read.scenario.time;
    if (model.initial_stress.empty() || time.start_in_equilibrium || !time.start_run.empty()) return {};
    const StressBalance balance = stress_balance_of(model);
    if (balance.holds()) return {};
    return {read.at(read.scenario.initial_stresses.front().field.path,
                    {.severity = Diagnostic::Severity::warning,
                     .code = "unbalanced-stress",
                     .message = "at t = 0 neither loads nor supports balance " + part_text(balance) +
                                formatted(": the body moves at once, with up to %.3g m/s2 at ", balance.acceleration) +
                                place_text(balance.where),
                     .note = "start = \"equilibrium\" in [time] strains the body before the start; a linear stress is "
                             "in balance with a uniform weight and with its own tractions on the boundary"})};
}

}  // namespace knap
