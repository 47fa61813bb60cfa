// The surplus of a mesh with the laws of a scenario, by cracks in strips (mesh_toughness.toml).
#include "app/calibrate.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using Texts = std::vector<std::string>;

constexpr const char* strip_scenario = "mesh_toughness";
// The strip in process zones: height, length, initial crack, straight line behind it, end and half height of the part
// with small triangles, size of the others.
constexpr double strip_height = 40. / 3, strip_length = 40, crack_end = 10, line_end = 40. / 3, fine_start = 28. / 3,
                 fine_end = 104. / 3, fine_half = 2;
constexpr double ramp_passages = 4, end_passages = 13.3;  // of a dilatational wave over the height
constexpr double through_at = 0.9;                        // of the way to the end of the small triangles

std::string box_text(double x0, double y0, double x1, double y1) {
    return "[" + shortest(x0) + ", " + shortest(y0) + ", " + shortest(x1) + ", " + shortest(y1) + "]";
}

/// The strip of a law: KEY=VALUE for scenarios/mesh_toughness.toml. `loads`: energy release rates over G_c.
Texts strip_of(const CalibratedLaw& of, const std::vector<double>& loads, int seeds) {
    const Scenario& scenario = of.scenario();
    const double z = of.process_zone(), half = 0.5 * strip_height * z, G_c = of.law.law.G_c,
                 edge = of.edge() * scenario.order;
    const Elastic& elastic = of.material.elastic;
    const double speed = elastic.dilatational_speed(scenario.plane),
                 modulus = elastic.density * speed * speed,  // [Pa] of uniaxial strain, in the plane
        passage = strip_height * z / speed;
    // the G_c as given, also if the scenario calls it that of a specimen
    const std::string matter = matter_text(of), law = law_text(of, of.law.law.sigma_c, G_c),
                      fine = box_text(fine_start * z, -fine_half * z, fine_end * z, fine_half * z);
    Texts set{"name=" + scenario.name + "-" + of.law.name,
              "domain.size=" + pair_text(strip_length * z, 2 * half),
              "domain.origin=" + pair_text(0, -half),
              "domain.model=" + model_text(scenario),
              "domain.crack[0].points=[" + pair_text(0, 0) + ", " + pair_text(crack_end * z, 0) + "]",
              "domain.region[0].box=" + fine,
              "domain.region[1].box=" + box_text(fine_start * z, 0, line_end * z, fine_half * z),
              "mesh.order=" + std::to_string(scenario.order),
              "mesh.size=" + shortest(std::max(z, edge)),
              "mesh.refine[0].inside=" + fine,
              "mesh.refine[0].size=" + shortest(edge),
              "material.glass" + matter,
              "material.free" + matter,
              "material.start" + matter,
              "interface.free-free" + law,
              "interface.free-start" + law,
              "load[0].ramp=" + shortest(ramp_passages * passage),
              "load[1].displacement=" + pair_text(0, 0),
              "load[1].ramp=",
              "time.end=" + shortest(end_passages * passage),
              "time.safety=" + shortest(scenario.time.safety),
              "output.every=" + shortest(passage),
              "output.history_every=" + shortest(0.04 * passage),
              "output.report=false",
              "figure=",
              "expect=",
              "sweep={ seeds = " + std::to_string(seeds) +
                  ", quantities = [\"steady_work_per_advance\", \"main_length\", \"mean_tip_speed\"] }"};
    // G = M d^2/(2 H), all of it by the upper side
    std::string displacements;
    for (const double load : loads) {
        const double d = std::sqrt(2 * strip_height * z * load * G_c / modulus);
        displacements += (displacements.empty() ? "" : ",") + pair_text(0, d);
    }
    set.push_back("load[0].displacement=" + displacements);
    return set;
}

/// The rows of a finished sweep: one for each load.
std::vector<ToughnessRow> rows_of(const Ensemble& sweep, const CalibratedLaw& of, const std::vector<double>& loads) {
    std::vector<ToughnessRow> rows;
    const double way = (fine_end - crack_end) * of.process_zone(), G_c = of.law.law.G_c,
                 rayleigh = of.material.elastic.rayleigh_speed(of.scenario().plane);
    for (std::size_t v = 0; v < sweep.variants.size(); ++v) {
        const auto went_through = [&](const EnsembleRun& run) {
            return run.is_done() && run.result.values[1] >= through_at * way;
        };
        const auto runs = sweep.runs_of(v);
        const auto spread_of = [&](std::size_t quantity) {
            return sweep.spread(
                v, [&](const EnsembleRun& run) { return went_through(run) ? run.result.values[quantity] : NAN; });
        };
        const Spread work = spread_of(0), speed = spread_of(2);
        ToughnessRow row{.law = of.within.meshed,
                         .load = loads[v],
                         .through = static_cast<double>(std::ranges::count_if(runs, went_through)) /
                                    static_cast<double>(runs.size()),
                         .seeds = static_cast<int>(runs.size())};
        if (work.n > 0) row.surplus = work.mean / G_c, row.deviation = work.deviation / G_c;
        if (speed.n > 0) row.speed = speed.mean / rayleigh;
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

Calibration calibrate_toughness(const std::vector<CalibratedLaw>& laws, const CalibrateOptions& options) {
    std::vector<ToughnessRow> rows;
    for (const CalibratedLaw& of : laws) {
        const double edges = of.within.meshed.edges;
        if (!(edges >= 1))
            throw UserError("resolution",
                            formatted("the process zone of `%s` is covered by %.2g edges: no strip can be made of it",
                                      of.law.name.c_str(), edges),
                            "at least one edge, better five: a smaller mesh.size");
        const std::optional<Ensemble> sweep =
            calibration_sweep(strip_scenario, strip_of(of, options.loads, options.seeds), options.batch,
                              of.scenario().name + "-" + of.law.name);
        if (!sweep) return {};
        std::ranges::move(rows_of(*sweep, of, options.loads), std::back_inserter(rows));
    }
    return {toughness_csv(rows),
            std::ranges::none_of(rows, &ToughnessRow::breaks)
                ? "fewer than four of five cracks crossed the plate at any load; larger ones by --loads"
                : ""};
}

}  // namespace knap
