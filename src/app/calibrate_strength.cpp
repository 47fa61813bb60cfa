// The surplus of specimens with the laws and the mesh of a scenario: plates under compression
// (uniaxial_compression.toml) or discs (brazilian_disc.toml).
#include "app/calibrate.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

using Texts = std::vector<std::string>;

constexpr double fewest_edges = 8;  // over the size of a specimen
// In passages of a dilatational wave over the height of the specimen; half the speed changes the strength by 0.8 %.
constexpr double peak_passages = 45, start_passages = 12, all_passages = 73;
constexpr double disc_speed = 0.068;  // of each platen, over that of a wave times sigma_c over the modulus
constexpr double flat_angle = 10 * std::numbers::pi / 180;  // half a flat of the disc
constexpr int rim_sides = 24;                               // of each half
constexpr double fell_before = 0.97;                        // of the last strain: the load has had its peak

/// One specimen: the scenario of the program, its values, and the strain at its end.
struct SpecimenRun {
    const char* scenario;
    Texts set;
    double last_strain;
};

/// The disc of the scenario with another radius.
std::string disc_points(double radius) {
    std::string points;
    for (const double side : {-0.5, 0.5})
        for (int i = 0; i <= rim_sides; ++i) {
            const double angle =
                side * std::numbers::pi + flat_angle + i * (std::numbers::pi - 2 * flat_angle) / rim_sides;
            points += (points.empty() ? "" : ", ") + pair_text(radius * std::cos(angle), radius * std::sin(angle));
        }
    return "[" + points + "]";
}

SpecimenRun specimen_of(const CalibratedLaw& of, double sigma_c, int seeds) {
    const Scenario& scenario = of.scenario();
    const StrengthOptions& strength = scenario.strength;
    const bool disc = strength.test == SpecimenOptions::Test::brazilian;
    const double size = strength.size, height = disc ? size : 2 * size, modulus = of.plane_modulus(),
                 wave = of.material.elastic.dilatational_speed(scenario.plane), passage = height / wave,
                 edge = of.edge() * scenario.order;
    CohesiveLaw law = of.law.law;
    law.sigma_c = sigma_c;
    const double speed = disc ? disc_speed * wave * sigma_c / modulus
                              : wave * strength_by_law(strength.test, law) / modulus / peak_passages,
                 end = all_passages * passage, ramp = start_passages * passage,
                 travel = (disc ? 2 : 1) * speed * (end - 0.5 * ramp);
    const double top = disc ? 0.5 * height * std::cos(flat_angle) : height, bottom = disc ? -top : 0;
    Texts set{"name=" + scenario.name + "-" + of.law.name,
              "domain.model=" + model_text(scenario),
              "mesh.order=" + std::to_string(scenario.order),
              "material.sandstone" + matter_text(of),
              "interface.default" + law_text(of, sigma_c, of.law.law.G_c),
              "obstacle[0].at=" + pair_text(0, top),
              "obstacle[0].velocity=" + pair_text(0, -speed),
              "obstacle[0].ramp=" + shortest(ramp),
              "obstacle[1].at=" + pair_text(0, bottom),
              "time.end=" + shortest(end),
              "time.safety=" + shortest(scenario.time.safety),
              "output.every=" + shortest(0.05 * end),
              "output.history_every=" + shortest(0.002 * end),
              "output.fields=false",
              "output.report=false",
              "limits.overlap=none",
              "figure=",
              "expect=",
              "sweep={ seeds = " + std::to_string(seeds) + ", quantities = [\"strength_ratio\", \"peak_strain\"] }"};
    if (disc) {
        set.push_back("domain.points=" + disc_points(0.5 * size));
        set.push_back("mesh.size=" + shortest(1.6 * edge));
        set.push_back("mesh.refine[0]={ inside = [" + shortest(-0.1 * size) + ", " + shortest(-0.5 * size) + ", " +
                      shortest(0.1 * size) + ", " + shortest(0.5 * size) + "], size = " + shortest(edge) + " }");
        set.push_back("obstacle[1].velocity=" + pair_text(0, speed));
        set.push_back("obstacle[1].ramp=" + shortest(ramp));
        set.push_back("specimen.height=" + shortest(size));
    } else {
        set.push_back("domain.size=" + pair_text(size, height));
        set.push_back("domain.origin=" + pair_text(-0.5 * size, 0));
        set.push_back("mesh.size=" + shortest(edge));
    }
    return {disc ? "brazilian_disc" : "uniaxial_compression", set, travel / height};
}

/// The row of specimens whose interfaces have sigma_c; none if interrupted.
std::optional<StrengthRow> row_with(const CalibratedLaw& of, double sigma_c, const CalibrateOptions& options,
                                    const char* round) {
    const SpecimenRun specimen = specimen_of(of, sigma_c, options.seeds);
    const std::optional<Ensemble> sweep = calibration_sweep(
        specimen.scenario, specimen.set, options.batch, of.scenario().name + "-" + of.law.name + "-strength" + round);
    if (!sweep) return {};
    const auto broke = [&](const EnsembleRun& run) {
        return run.is_done() && run.result.values[1] < fell_before * specimen.last_strain;
    };
    const Spread ratio =
        sweep->spread(0, [&](const EnsembleRun& run) { return broke(run) ? run.result.values[0] : NAN; });
    StrengthRow row{.law = tested_law(of.scenario(), of.within),
                    .through = static_cast<double>(std::ranges::count_if(sweep->runs, broke)) / options.seeds,
                    .seeds = options.seeds};
    const double change = sigma_c / of.law.law.sigma_c;
    row.law.zones *= change * change;
    if (ratio.n > 0) row.surplus = ratio.mean, row.deviation = ratio.deviation;
    return row;
}

}  // namespace

Calibration calibrate_strength(const std::vector<CalibratedLaw>& laws, const CalibrateOptions& options) {
    std::vector<StrengthRow> rows;
    for (const CalibratedLaw& of : laws) {
        const Scenario& scenario = of.scenario();
        if (!(scenario.strength.size > 0))
            throw UserError("missing-key", "`strength.size` is missing: the scenario has no [specimen] with its test",
                            "width of the plate, twice as high, or diameter of the disc whose strength was measured");
        if (const std::string reason = not_tested(scenario, of.within.law); !reason.empty())
            throw UserError("no-calibration", "no specimen can be made of `" + of.law.name + "`: " + reason,
                            "allowed: laws whose strength is one number");
        const double edges = tested_law(scenario, of.within).edges;
        if (!(edges >= fewest_edges))
            throw UserError("resolution",
                            formatted("a specimen of %.4g mm is covered by %.2g edges: too few to break",
                                      1e3 * scenario.strength.size, edges),
                            formatted("at least %g: a smaller mesh.size, or another strength.size", fewest_edges));
        // the interfaces will have the strength over the surplus, and so a longer process zone
        double sigma_c = of.law.law.sigma_c;
        for (const char* round : {"", "-2"}) {
            const std::optional<StrengthRow> row = row_with(of, sigma_c, options, round);
            if (!row) return {};
            rows.push_back(*row);
            if (!(row->surplus > 1.01)) break;
            sigma_c /= row->surplus;
        }
    }
    const bool broke =
        std::ranges::all_of(rows, [](const StrengthRow& row) { return row.through >= least_part_through; });
    return {strength_csv(rows), broke ? "" : "fewer than four of five specimens of a row had their peak load"};
}

}  // namespace knap
