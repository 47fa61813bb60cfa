// The rows of the key table for temperatures and heat.
#include "scenario/key_table.hpp"
#include "scenario/scenario.hpp"

namespace knap {

// clang-format off
void add_place(KeyTable& t, const std::string& table, std::string_view doc, std::string_view key) {
    t.table(joined_path(table, key), doc).or_text("boundary");
    t.text("boundary", "name of a boundary; with `body` also that among its boundaries: `left` for `NAME.left`, of a "
        "group that of all its bodies").to(&Selection::boundary);
    t.number("box", "m", "lower left and upper right corner, in the undeformed body: what is there at the start stays "
        "selected").box().to(&Selection::box);
    t.text("body", "name of a body, or of a group of bodies").to(&Selection::body);
    t.in(table);
}

void add_history(KeyTable& t, std::string_view what, std::string_view csv) {
    t.number("ramp", "s", what).above(0);
    t.number("table", "s", "factor over time as pairs [time, factor], linear between them and constant outside")
        .points().second("");
    t.text("csv", csv);
    t.number("table_period", "s", "the points of table or csv, with times from 0 to this, repeat until time.end; at "
        "the end of a period the factor jumps where the first and the last one differ").above(0).computed("none");
}

void add_thermal(KeyTable& t) {
    t.number("expansion", "1/K", "coefficient of thermal expansion, with [heat]; either expansion or expansion_table");
    t.number("expansion_table", "K", "thermal strain over temperature as pairs [temperature, strain]: linear "
        "between them, "
        "with the end slopes outside; a transition of a crystal is a steep piece").points().second("");
    t.number("conductivity", "W/m/K", "conductivity of heat; it or conductivity_table is required with "
        "heat.conduction").above(0).to(&Thermal::conductivity);
    t.number("conductivity_table", "K", "conductivity over temperature as pairs [temperature, conductivity]: linear "
        "between them, constant outside").points().second("W/m/K");
    t.number("heat_capacity", "J/kg/K", "heat capacity per mass; it or heat_capacity_table is required with "
        "heat.conduction").above(0).to(&Thermal::heat_capacity);
    t.number("heat_capacity_table", "K", "heat capacity over temperature as pairs [temperature, heat capacity]: linear "
        "between them, constant outside; the stored heat is its integral").points().second("J/kg/K");
    t.number("latent_heat", "J/kg", "heat per mass of the material that melting takes up and freezing releases, "
        "uniformly over the freezing range, with heat.conduction: 334 kJ/kg times the mass fraction of water")
        .at_least(0).otherwise("0").to(&Thermal::latent_heat);
    t.number("freezing_range", "K", "temperatures between which the water freezes")
        .pair().otherwise("[-1, 0]");
}

void add_keys_of_heat(KeyTable& t) {
    t.table("heat", "temperatures, which strain the body (thermal stress). All count from one zero: in C where one of "
        "them has that unit (\"20 C\"), which figures and tables then have, too; in K otherwise. Plain numbers, "
        "formulas and files follow, nothing is converted, and C and K together are an error. The motion does not heat "
        "the body. With [contact] heat crosses free faces where they press on each other");
    t.number("reference", "K", "temperature without thermal strain").otherwise("0").to(&Heat::reference);
    t.text("temperature", "the temperature as \"400 C\", or as a formula of x, y [m] and t [s], as "
        "\"20 + 300*exp(-x/0.01)\", with + - * / ^ ( ) pi sin cos tan atan tanh exp log sqrt abs erf erfc min max; or "
        "a file \"NAME.csv\" with lines `x, y, temperature` or `x, y, t, temperature` in any order, one for each place "
        "of a grid, linear between them and constant outside; prescribed, with conduction that of the start; a "
        "factor over time, by at most one of ramp, table, csv, multiplies its difference to the reference. \"frozen\": "
        "that of the run from which this one starts, which stays").required().unit = "K";
    add_history(t, "rise time: the factor grows linearly from 0 to 1 and stays 1");
    t.flag("conduction", "temperatures follow from conduction; without it they are prescribed")
        .otherwise("false").to(&Heat::conduction);
    t.integer("every", "steps of the explicit bulk for one of the temperature; the thermal strain is "
        "constant in between")
        .at_least(1).at_most(1000000).otherwise("10").to(&Heat::every);
    t.number("time_factor", "", "heat runs so many times faster than the motion (heat capacities are divided by it): "
        "t times the factor is the time of the heat. The motion stays quasi-static while its kinetic energy is small "
        "against the strain energy").at_least(1).otherwise("1").to(&Heat::time_factor);
    t.number("gap_conductivity", "W/m/K", "conductivity of what fills open cracks: air 0.025, water 0.6, ice 2.2; "
        "0: none")
        .at_least(0).otherwise("0.025").to(&Heat::gap_conductivity);
    t.number("closed_conductance", "W/m2/K", "conductance of closed points of cracks; 0: cracks are insulated")
        .at_least(0).computed("50 conductivities over the length of the edge").to(&Heat::closed_conductance);
    t.list("heat.exchange[]", "heat through a boundary or into a region, with conduction: exactly one of "
        "temperature, outside, flux, source; boundaries without one are insulated, and so are new faces of cracks; a "
        "factor over time by at most one of ramp, table, csv multiplies flux and source, and differences of "
        "temperatures to heat.reference");
    add_place(t, "heat.exchange[]", "place: a boundary, a box, a body, or what they have in common; source without it "
        "acts on all bodies");
    t.number("temperature", "K", "prescribed temperature of the vertices");
    t.number("outside", "K", "temperature outside, of convection; needs transfer");
    t.number("transfer", "W/m2/K", "transfer coefficient of convection").above(0).to(&HeatExchange::transfer);
    t.number("flux", "W/m2", "heat per area and time into the body");
    t.number("source", "W/m3", "heat per volume and time in the triangles");
    add_history(t, "rise time: the factor grows linearly from 0 to 1 and stays 1");
}
// clang-format on

}  // namespace knap
