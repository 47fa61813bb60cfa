// What a scenario may name of a run's results, with units: numbers of the summary, columns of its tables, fields of its figures.
#include "scenario/keys.hpp"

#include <array>

namespace knap {
namespace {

constexpr std::array summary{
    SummaryKey{"energy_residual", "", "largest error of the energy balance, relative to the largest energy"},
    SummaryKey{"law_lag", "", "largest lag of the cohesive law of explicit beta, relative to the largest energy"},
    SummaryKey{"crossing_loss", "", "energy lost where slips cross zero, relative to the largest energy"},
    SummaryKey{"external_work", "J", "work of loads and prescribed motions"},
    SummaryKey{"dissipated", "J", "surface energy of broken and damaged interfaces"},
    SummaryKey{"friction_work", "J", "work of friction, never positive"},
    SummaryKey{"impact_work", "J", "work of impacts, never positive"},
    SummaryKey{"scheme_dissipation", "J", "what theta > 1/2 took away, never negative"},
    SummaryKey{"kinetic_energy", "J", "at the end"},
    SummaryKey{"strain_energy", "J", "at the end"},
    SummaryKey{"momentum_x", "kg m/s", "of the whole body at the end"},
    SummaryKey{"momentum_y", "kg m/s", "likewise"},
    SummaryKey{"mean_displacement_x", "m", "of the centre of mass at the end"},
    SummaryKey{"mean_displacement_y", "m", "likewise"},
    SummaryKey{"reaction_x", "N", "force on the body of the first load, or obstacle, that moves, at the end"},
    SummaryKey{"reaction_y", "N", "likewise"},
    SummaryKey{"largest_reaction", "N", "its largest size over the run"},
    SummaryKey{"broken_length", "m", "length of broken interfaces"},
    SummaryKey{"crack_length", "m", "length of the cracks that count, without single broken interfaces"},
    SummaryKey{"first_growth_time", "s", "first crack growth"},
    SummaryKey{"max_tip_speed", "m/s", "largest speed of the main crack tip"},
    SummaryKey{"mean_tip_speed", "m/s", "its mean over the second half of the crack's growth"},
    SummaryKey{"max_tip_speed_over_cR", "", "the same over the Rayleigh speed"},
    SummaryKey{"tips", "", "number of crack tips at the end"},
    SummaryKey{"branches", "", "number of branchings at the end"},
    SummaryKey{"first_branch_time", "s", "first branching"},
    SummaryKey{"first_branch_x", "m", "where it was"},
    SummaryKey{"first_branch_y", "m", "likewise"},
    SummaryKey{"fragments", "", "number of pieces at the end"},
    SummaryKey{"largest_fragment", "", "its part of the mass, at the end"},
    SummaryKey{"median_fragment", "m", "diameter that half of the mass does not exceed (circle of the same area), at the end"},
    SummaryKey{"tensile_breaks", "", "interfaces that broke more by opening than by sliding; with output.breaks"},
    SummaryKey{"shear_breaks", "", "interfaces that broke more by sliding; with output.breaks"},
    SummaryKey{"peak_stress", "Pa", "largest stress of the specimen: its strength"},
    SummaryKey{"peak_strain", "", "axial strain there"},
    SummaryKey{"tangent_modulus", "Pa", "slope of stress over axial strain, in the plane, of a specimen"},
    SummaryKey{"youngs_modulus", "Pa", "of the material of a specimen: in plane strain the tangent modulus times 1 - nu^2, which needs a lateral gauge"},
    SummaryKey{"poisson_ratio", "", "of the material of a specimen with a lateral gauge"},
    SummaryKey{"crack_initiation_stress", "Pa", "stress of a specimen with 1 % of the breaks of the peak (Potyondy and Cundall 2004)"},
    SummaryKey{"dilatancy_stress", "Pa", "stress from which the crack volumetric strain leaves zero (Martin and Chandler 1994); compression with a lateral gauge"},
    SummaryKey{"crack_damage_stress", "Pa", "stress at which the volumetric strain turns from shrinking to growing (Martin and Chandler 1994); likewise"},
    SummaryKey{"largest_penetration", "m", "largest overlap in contact"},
    SummaryKey{"largest_speed", "m/s", "largest speed of any corner"},
};

}  // namespace

std::span<const SummaryKey> summary_keys() { return summary; }

std::string_view unit_of_column(std::string_view column) {
    struct Ending {
        std::string_view end, unit;
    };
    for (const Ending& e : {Ending{"_u_x", "m"}, {"_u_y", "m"}, {"_v_x", "m/s"}, {"_v_y", "m/s"}, {"_force_x", "N"}, {"_force_y", "N"}, {"_opening", "m"},
                            {"_slip", "m"}, {"_cohesion", ""}, {"length", "m"}, {"tip_x", "m"}, {"tip_y", "m"}, {"speed", "m/s"}})
        if (column.ends_with(e.end)) return e.unit;
    if (column == "stress") return "Pa";
    for (const std::string_view energy : {"kinetic", "strain", "surface", "external_work", "cohesive_work", "friction_work", "impact_work", "residual", "law_lag",
                                          "crossing_loss", "scheme_dissipation", "step_change_work"})
        if (column == energy) return "J";
    return column == "time" || column == "step" ? "s" : "";
}

std::string_view unit_of_slope(std::string_view column) {
    const std::string_view unit = unit_of_column(column);
    return unit == "J" ? "W" : unit == "m" ? "m/s" : unit == "m/s" ? "m/s2" : unit == "N" ? "N/s" : unit == "s" ? "" : "1/s";
}

std::string_view unit_of_field(std::string_view field) {
    if (field.starts_with("displacement") || field == "cracks") return "m";
    if (field.starts_with("velocity") || field == "speed") return "m/s";
    if (field.starts_with("stress") || field == "principal_stress") return "Pa";
    return "";
}

}  // namespace knap
