// The rows of the key table for the laws of interfaces.
#include "scenario/key_table.hpp"
#include "scenario/scenario.hpp"

namespace knap {

// clang-format off
void add_keys_of_laws(KeyTable& t) {
    t.names("interface", "interface laws: `default`; `A-B` between two materials, A-A inside one or between two of its "
        "grains; `A` inside grains of a material, `within` inside all grains (without them A-A); any other name for "
        "supports and joint sets. A law inherits nothing from `default`").required();
    t.table("interface.*", "a cohesive law with contact, friction and impact");
    t.flag("breakable", "false: the interface never breaks").otherwise("true");
    t.number("sigma_c", "Pa", "tensile strength; 0: contact and friction only; required unless breakable = false")
        .at_least(0);
    t.number("G_c", "J/m2", "fracture energy, dissipated as G_c (1 - beta)^2 with linear softening; "
        "either G_c or delta_c").above(0);
    t.number("delta_c", "m", "opening at which the cohesion is lost, 2 G_c/sigma_c with linear softening; either G_c "
        "or delta_c").above(0);
    using Shape = SofteningOptions::Shape;
    t.word("softening", {"linear", "petersson", "mc2010", "exponential", "trapezoid", "power", "table"},
        "traction over opening after the strength is reached, with the area G_c: petersson and mc2010 are bilinear "
        "(1/3 of the strength at 0.8 G_c/sigma_c, 1/5 at G_c/sigma_c), exponential is cut at 1 % of the strength; "
        "curves are polygons of 12 pieces").otherwise("linear")
        .to(&SofteningOptions::shape, {Shape::linear, Shape::petersson, Shape::mc2010, Shape::exponential,
            Shape::trapezoid, Shape::power, Shape::table});
    t.number("plateau", "", "part of delta_c at full strength; 1: the traction drops from the strength to 0 (Dugdale), "
        "with cohesion = \"explicit\" only")
        .at_least(0).at_most(1).otherwise("0.5").only_with("softening", {"trapezoid"}).to(&SofteningOptions::plateau);
    t.number("exponent", "", "n of the traction sigma_c (1 - s/delta_c)^n; 1: linear, above: convex")
        .at_least(0.1).at_most(10).otherwise("2").only_with("softening", {"power"}).to(&SofteningOptions::exponent);
    t.number("table", "", "2 to 13 pairs [opening, traction] from opening 0 down to traction 0, in any units: scaled "
        "to sigma_c and G_c").points().second("").only_with("softening", {"table"}).to(&SofteningOptions::table);
    t.text("csv", "file with lines `opening, traction` instead of a table, relative to the scenario file; # "
        "starts a comment").only_with("softening", {"table"});
    t.word("coupling", {"sum", "norm"}, "equivalent opening: sum: u_N + gamma |u_T|, as in the reference; norm: "
        "sqrt(u_N^2 + gamma^2 u_T^2), with a half ellipse as strength and friction on compression alone: slow cracks "
        "across meshes cost nearly what they cost along a straight path").otherwise("sum")
        .to(&CohesiveLaw::coupling, {Coupling::sum, Coupling::norm});
    t.word("unloading", {"constant", "secant", "vertical"}, "traction of a damaged interface below its largest "
        "opening: constant beta sigma_c; secant: falls to 0 with the opening; vertical: 0, so that nothing is given "
        "back, and at the largest opening anything up to beta sigma_c").otherwise("constant")
        .to(&CohesiveLaw::unloading, {Unloading::constant, Unloading::secant, Unloading::vertical});
    t.number("relaxation_time", "s", "delayed softening: the cohesion follows the softening curve in this time, so "
        "that fast openings cost more energy (viscous_dissipation); the strength stays. 0: at once")
        .at_least(0).otherwise("0").to(&CohesiveLaw::relaxation_time);
    t.number("incubation_time", "s", "a vertex inside the body splits only once the overload of its interfaces, which "
        "a memory of this time follows, has reached 1; it then has the strength and fracture energy times the overload "
        "of that moment. In explicit steps; not on supports and initial cracks. 0: at once")
        .at_least(0).otherwise("0").to(&CohesiveLaw::incubation_time);
    t.number("gamma", "", "shear strength over tensile strength, without friction. Sliding alone costs G_c (1 + "
        "friction/gamma), with coupling = \"norm\" G_c (with a G_II that instead of G_c); 0: cohesion in mode I only")
        .at_least(0).otherwise("1").to(&CohesiveLaw::gamma);
    t.number("G_II", "J/m2", "fracture energy of slip alone (mode II), with gamma above 0 and without friction, which "
        "adds G_II friction/gamma, since it acts on the cohesion, too; what slip dissipates beyond G_c is "
        "`mixed_dissipation`. Without it G_c").above(0).to(&CohesiveLaw::G_II);
    t.word("mode_mix", {"power", "benzeggagh-kenane"}, "fracture energy G where slip does the part m of the work: "
        "power: G^-a = ((1 - m)/G_c)^a + (m/G_II)^a; benzeggagh-kenane: G = G_c + (G_II - G_c) m^a. Exact for openings "
        "in one proportion, power with a = 1 for all").computed("power")
        .to(&CohesiveLaw::mode_mix, {ModeMix::power, ModeMix::benzeggagh_kenane});
    t.number("mix_exponent", "", "exponent a of mode_mix").at_least(1).at_most(10).computed("1")
        .to(&CohesiveLaw::mix_exponent);
    t.number("strength_table", "K", "factor on sigma_c and G_c over temperature as pairs [temperature, factor], with "
        "[heat]: from 0 (no strength, computed as 1e-6) to 1, linear between them and constant outside, at the mean "
        "temperature of the two sides. delta_c stays; what has opened does not heal, what has not opened is as strong "
        "again when it freezes again").points().second("");
    t.number("friction_table", "K", "friction coefficient over temperature as pairs [temperature, coefficient], with "
        "[heat], instead of friction").points().second("");
    t.number("friction_over_pressure", "Pa", "instead of friction: 2 to 13 pairs [pressure, shear] from [0, 0] on, the "
        "shear that closed faces bear over their pressure, concave and not falling, closed by its last slope; with "
        "coupling = \"sum\" over the pressure that balances the cohesion, too. knap_friction of the Python "
        "package makes such tables from Barton and Bandis's joints, test series and strengths").points().second("Pa");
    t.text("friction_csv", "file with a line of names `pressure [MPa], shear [MPa]` and lines of numbers instead of "
        "friction_over_pressure, relative to the scenario file; # starts a comment");
    t.number("strength_over_bedding", "deg", "factor on sigma_c and G_c over the angle of the facet to the layers of "
        "its material (bedding), as pairs [angle, factor], with angles from 0 to 90 and factors up to 1: linear "
        "between them and constant outside. Between two layered triangles the weaker side counts")
        .points().second("");
    t.number("energy_over_bedding", "deg", "likewise on G_c (and G_II) alone; without it as strength_over_bedding")
        .points().second("");
    add_contact<CohesiveLaw>(t);
    t.number("kinetic_friction", "", "friction coefficient after the slip_distance; in between it changes linearly "
        "with the way that the sides have slid, from friction (static) on").at_least(0)
        .to(&CohesiveLaw::kinetic_friction);
    t.number("slip_distance", "m", "slip, forth and back, over which friction changes to kinetic_friction; faces that "
        "were never joined keep friction").above(0)
        .to(&CohesiveLaw::slip_distance);
    t.table("interface.*.scatter", "random strength of every interface, drawn with the seed; its mean is the value of "
        "the law");
    t.word("kind", {"weibull", "normal", "lognormal", "uniform"}, "distribution").required().to(&Scatter::kind,
        {Scatter::Kind::weibull, Scatter::Kind::normal, Scatter::Kind::lognormal, Scatter::Kind::uniform});
    t.number("modulus", "", "Weibull modulus m; larger: less scatter")
        .at_least(1).required().only_with("kind", {"weibull"}).to(&Scatter::modulus);
    t.number("deviation", "", "standard deviation over the mean, as 0.01 or \"1 %\"")
        .above(0).required().only_with("kind", {"normal", "lognormal", "uniform"}).to(&Scatter::deviation);
    t.word("of", {"sigma_c", "G_c"}, "the random properties; both are multiplied by the same factor")
        .one_or_list().otherwise("sigma_c");
    t.number("length", "m", "interface length with the given mean; shorter interfaces are stronger, so that the "
        "strength of a chain of interfaces does not depend on the mesh (weakest link)").above(0).to(&Scatter::length);
    t.number("area", "m2", "area of the body with the given mean, for cracks that may start anywhere (volume effect); "
        "finer meshes give stronger bodies, unlike with correlation").above(0).to(&Scatter::area);
    t.number("correlation", "m", "correlation length L of a random field with the correlation exp(-(r/L)^2), the same "
        "for every mesh; without it interfaces are independent").above(0).to(&Scatter::correlation);
    t.number("lowest", "", "lower bound of the value over the mean; smaller values are redrawn")
        .at_least(0).below(1).otherwise("0").to(&Scatter::lowest);
    t.number("highest", "", "upper bound of the value over the mean; larger values are redrawn; without it unbounded")
        .above(1).to(&Scatter::highest);
}
// clang-format on

}  // namespace knap
