// The rows of the key table. A new key is a row here; where its value is a member of an options struct as it stands,
// `.to(&Struct::member)` is all that reads it. Other values are read, and checked against each other, in read_*.cpp.
#include "scenario/key_table.hpp"
#include "microstructure/inclusions.hpp"
#include "scenario/scenario.hpp"

namespace knap {

// clang-format off
void add_keys_of_body(KeyTable& t) {
    t.integer("knap", "version of the scenario format; this program reads 1").at_least(1).required();
    t.text("name", "short name: letters, digits, - _ and .").computed("the name of the file").to(&Scenario::name);
    t.text("title", "one line for people").otherwise("").to(&Scenario::title);
    t.integer("seed", "the only source of randomness (mesh, grains, inclusions, joints, strength)")
        .at_least(0).otherwise("1").to(&Scenario::seed);

    t.table("domain", "the body; with mesh.file only model and thickness");
    t.word("shape", {"rectangle", "polygon", "disc"},
        "needed without mesh.file; rectangle has the boundaries left, right, bottom, top; disc has rim");
    t.number("size", "m", "width and height").pair().above(0).required().only_with("shape", {"rectangle"});
    t.number("origin", "m", "lower left corner").pair().otherwise("[0, 0]").only_with("shape", {"rectangle"});
    t.number("points", "m", "corners in order, the first one not repeated")
        .points().required().only_with("shape", {"polygon"});
    t.text("sides", "boundary names, one for each side from a point to the next; a name may come back")
        .list().computed("side1, side2, ...").only_with("shape", {"polygon"});
    t.list("domain.arcs[]", "sides that are arcs of a circle; they keep their boundary name")
        .only_with("shape", {"polygon"});
    t.integer("side", "number of the side: 1 leads from the first point to the second, the last one back to the first")
        .at_least(1).required();
    t.number("through", "m",
        "a point of the arc between the two corners; the arc becomes a polygon with sides of the local mesh size, "
        "corners on the arc").pair().required();
    t.in("domain");
    t.number("centre", "m", "centre").pair().otherwise("[0, 0]").only_with("shape", {"disc"});
    t.number("radius", "m", "radius; the rim becomes a polygon with sides of the local mesh size")
        .above(0).required().only_with("shape", {"disc"});
    t.word("model", {"plane strain", "plane stress"}, "what is zero across the plane").otherwise("plane strain");
    t.number("thickness", "m", "thickness of the body").above(0).otherwise("1").to(&Scenario::thickness);
    t.list("domain.hole[]", "a hole: points, or centre and radius");
    t.number("points", "m", "corners in order").points();
    t.list("domain.hole[].arcs[]", "sides between the points that are arcs of a circle, as domain.arcs");
    t.integer("side", "number of the side, from 1").at_least(1).required();
    t.number("through", "m", "a point of the arc between the two corners").pair().required();
    t.in("domain.hole[]");
    t.number("centre", "m", "centre of a round hole").pair();
    t.number("radius", "m", "radius of a round hole, a polygon with sides of the local mesh size, at least twelve")
        .above(0);
    t.text("name", "boundary name of its border").computed("hole1, hole2, ...");
    t.list("domain.crack[]", "a closed crack: no cohesion; contact and friction of the material pair it lies between");
    t.number("points", "m", "the crack as a polyline").points().required();
    t.list("domain.region[]",
        "a part with a material of its own: points, centre and radius, or box; later ones lie over earlier ones");
    t.number("points", "m", "corners in order").points();
    t.list("domain.region[].arcs[]", "sides between the points that are arcs of a circle, as domain.arcs");
    t.integer("side", "number of the side, from 1").at_least(1).required();
    t.number("through", "m", "a point of the arc between the two corners").pair().required();
    t.in("domain.region[]");
    t.number("centre", "m", "centre of a disc").pair();
    t.number("radius", "m", "radius of a disc").above(0);
    t.number("box", "m", "lower left and upper right corner").box();
    t.text("material", "name of a material").required();

    t.table("mesh", "the triangle mesh").required();
    t.number("size", "m", "wanted mean edge length; or file").above(0).to(&MeshOptions::size);
    t.number("min_angle", "deg", "wanted smallest angle")
        .at_least(0).at_most(30).otherwise("20").to(&MeshOptions::min_angle);
    t.number("grading", "", "growth of the size per distance away from a refine box")
        .above(0).otherwise("0.3").to(&MeshOptions::grading);
    t.integer("order",
        "of the displacement on a triangle; 2: seven nodes, three points an interface, more accurate in waves, "
        "impact and bending; use triangles of twice the size")
        .at_least(1).at_most(2).otherwise("1").to(&Scenario::order);
    t.list("mesh.refine[]", "a box with smaller triangles; the smallest size wins where boxes overlap");
    t.number("inside", "m", "lower left and upper right corner").box().required();
    t.number("size", "m", "wanted mean edge length inside").above(0).required();
    t.in("mesh");
    t.text("file",
        "a Gmsh mesh (.msh 2.2 or 4.1) beside the scenario, instead of meshing: physical curves name boundaries, "
        "physical surfaces materials");
    t.number("unit", "m", "what 1 in the coordinates of mesh.file is, as in \"1 mm\"; 1 m without it")
        .at_least(1e-12).at_most(1e6);
    t.text("cracks", "physical curves of mesh.file inside the body that are closed cracks").list();
}

void add_keys_of_materials(KeyTable& t) {
    t.names("material", "materials by name; the first one is that of the domain").required();
    t.table("material.*", "a linear elastic material; no - in its name");
    t.number("density", "kg/m3", "density").above(0).required().to(&Elastic::density);
    t.number("E", "Pa", "Young's modulus").above(0).required().to(&Elastic::E);
    t.number("nu", "", "Poisson's ratio").above(-1).below(0.5).required().to(&Elastic::nu);

    t.list("inclusions[]",
        "random discs or polygons of a material, or pores; they do not overlap, nor touch borders and cracks");
    t.number("size", "m", "mean diameter, of the circle of equal area; at least 1.5 mesh sizes")
        .above(0).required().to(&InclusionOptions::size);
    t.number("fraction", "", "of the area of the body; equal discs find no room above about 0.5; or number")
        .above(0).at_most(0.6).to(&InclusionOptions::fraction);
    t.integer("number", "how many; or fraction").at_least(1).at_most(1000000).to(&InclusionOptions::number);
    t.number("spread", "", "standard deviation of the diameters (lognormal) over their mean")
        .at_least(0).at_most(1).otherwise("0").to(&InclusionOptions::spread);
    t.number("distance", "m", "least distance between them, and from borders and cracks")
        .above(0).computed("mesh.size/2").to(&InclusionOptions::distance);
    t.integer("corners", "of random polygons; none: discs (ellipses)")
        .at_least(3).at_most(12).to(&InclusionOptions::corners);
    t.number("elongation", "", "length over width")
        .at_least(1).at_most(5).otherwise("1").to(&InclusionOptions::elongation);
    t.number("direction", "deg", "of the length, from x; none: at random");
    t.text("material", "name of a material; none: pores");
    t.text("name", "boundary name of pores").computed("pores");

    t.list("joints[]", "a set of joints: closed cracks, or interfaces with a law; with thickness and material veins");
    t.number("direction", "deg", "of the traces, from x").required();
    t.number("spread", "deg", "standard deviation of the direction").at_least(0).at_most(30).otherwise("0");
    t.number("spacing", "m", "mean distance across").above(0).required().to(&JointOptions::spacing);
    t.number("persistence", "", "part of a row that is joint, the rest is bridges of rock; 1: from end to end")
        .above(0).at_most(1).otherwise("1").to(&JointOptions::persistence);
    t.number("length", "m", "mean length of a trace; needed with persistence below 1")
        .above(0).to(&JointOptions::length);
    t.text("interface", "name of the law of the joints; none: cracked from the start");
    t.number("thickness", "m", "of veins; at least half a mesh size").above(0).to(&JointOptions::thickness);
    t.text("material", "of veins: name of a material");

    t.list("map[]", "a picture whose colours are materials; each triangle takes the one that covers most of it");
    t.text("file", "a PNG picture beside the scenario").required();
    t.number("box", "m", "where the picture lies: lower left and upper right corner").box().computed("round the body");
    t.list("map[].colour[]",
        "a colour and its material; pixels take the nearest colour, those of none leave what is there");
    t.text("rgb", "as \"#rrggbb\"").required();
    t.text("material", "name of a material").required();

    t.list("grains[]",
        "grains in place of one material; between grains of materials A and B acts `A-B`, within a grain `A` or "
        "`within` (below)");
    t.number("size", "m", "mean diameter, of the circle of equal area; at least 1.5 mesh sizes")
        .above(0).required().to(&GrainOptions::size);
    t.number("spread", "", "standard deviation of the diameters (lognormal) over their mean")
        .at_least(0).at_most(0.6).otherwise("0.25").to(&GrainOptions::spread);
    t.number("elongation", "", "length over width")
        .at_least(1).at_most(10).otherwise("1").to(&GrainOptions::elongation);
    t.number("direction", "deg", "of the length, from x").otherwise("0");
    t.text("in", "the material that becomes grains").computed("the first material");
    t.list("grains[].mineral[]", "a material of some of the grains; the rest keeps the one they are in");
    t.text("material", "name of a material").required();
    t.number("fraction", "", "of the area of these grains").at_least(0).at_most(1).required();

    t.names("interface",
        "cohesive laws: `default`, `A-B` for a pair of materials (A-A inside one, or between two grains), within a "
        "grain `A`, for all grains `within` (without them A-A), or a free name for a support or a set of joints; "
        "each stands by itself").required();
    t.table("interface.*", "a cohesive law with contact, friction and impact");
    t.flag("breakable", "false: never breaks, whatever sigma_c and G_c say").otherwise("true");
    t.number("sigma_c", "Pa", "tensile strength; 0 = contact and friction only; needed unless breakable = false")
        .at_least(0);
    t.number("G_c", "J/m2",
        "fracture energy; or delta_c. G_c (1 - beta)^2 is dissipated; unloading keeps beta and the traction beta "
        "sigma_c, and closing gives beta sigma_c s back").above(0);
    t.number("delta_c", "m", "opening at which it is broken, 2 G_c/sigma_c; or G_c").above(0);
    t.number("gamma", "", "mode II over mode I traction; 0 = mode I only")
        .at_least(0).otherwise("1").to(&CohesiveLaw::gamma);
    t.number("friction", "", "Coulomb's coefficient").at_least(0).otherwise("0").to(&CohesiveLaw::friction);
    t.number("restitution", "", "Newton's coefficient of impact")
        .at_least(0).at_most(1).otherwise("0").to(&CohesiveLaw::restitution);
    t.table("interface.*.scatter",
        "random strength, drawn for every interface with the seed; the mean is the law's value");
    t.word("kind", {"weibull", "normal", "lognormal", "uniform"}, "distribution").required();
    t.number("modulus", "", "Weibull's modulus m")
        .at_least(1).required().only_with("kind", {"weibull"}).to(&Scatter::modulus);
    t.number("deviation", "", "standard deviation over the mean, also \"1 %\"")
        .above(0).required().only_with("kind", {"normal", "lognormal", "uniform"}).to(&Scatter::deviation);
    t.word("of", {"sigma_c", "G_c"}, "what scatters; both by the same factor").one_or_list().otherwise("sigma_c");
    t.number("length", "m",
        "length of the piece of interface that the mean belongs to: shorter pieces are stronger, so that chains of "
        "them do not depend on the mesh").above(0).to(&Scatter::length);
    t.number("area", "m2",
        "likewise, area of the part of the body that the mean belongs to; for cracks that may start anywhere; a body "
        "grows stronger with finer meshes then, unlike with correlation").above(0).to(&Scatter::area);
    t.number("correlation", "m",
        "correlation length L of a random field, correlation exp(-(r/L)^2), the same for every mesh; none: every "
        "interface by itself").above(0).to(&Scatter::correlation);
    t.number("lowest", "", "smallest value over the mean; what is below is drawn again")
        .at_least(0).below(1).otherwise("0").to(&Scatter::lowest);
    t.number("highest", "", "largest value over the mean, likewise; none").above(1).to(&Scatter::highest);
}

void add_keys_of_loads(KeyTable& t) {
    t.list("support[]", "a rigid, fixed body that a boundary rests on or is glued to");
    t.table("support[].on", "a boundary, all of it or inside a box").required().or_text("boundary");
    t.text("boundary", "name of a boundary").required().to(&Selection::boundary);
    t.number("box", "m", "only the part inside this box").box().to(&Selection::box);
    t.in("support[]");
    t.text("interface", "name of the law between body and support").otherwise("default");
    t.flag("glued", "true: held by the law's cohesion; false: contact and friction only")
        .otherwise("false").to(&Support::glued);
    t.number("gap", "m", "distance at the start; not of what is glued").at_least(0).otherwise("0").to(&Support::gap);

    t.list("load[]",
        "exactly one of traction, pressure, stress, force, velocity, displacement, body_force, acceleration; at most "
        "one of ramp, table, csv (none: constant)");
    t.text("name",
        "letters, digits, blanks, _ and -: names its columns of reactions.csv, its force in the summary, in specimen.force, "
        "expect and studies").computed("load0, load1, ...").to(&Load::name);
    t.table("load[].on",
        "where: a boundary, a box, or a boundary inside a box; body_force and acceleration without it act everywhere")
        .or_text("boundary");
    t.text("boundary", "name of a boundary").to(&Selection::boundary);
    t.number("box", "m", "lower left and upper right corner").box().to(&Selection::box);
    t.in("load[]");
    t.number("traction", "Pa", "force per area on boundary edges, x and y").pair();
    t.number("pressure", "Pa",
        "force per area on boundary edges against their outward normal, of the body as it was at first: it does not "
        "follow what turns");
    t.number("stress", "Pa",
        "the traction on boundary edges that a stress [xx, yy, xy] around the body has there, tension positive "
        "(stress in situ)").triple();
    t.number("force", "N", "force, shared equally by the vertices on a boundary or in a box, x and y").pair();
    t.number("velocity", "m/s", "prescribed velocity, x and y").pair().or_word("free");
    t.number("displacement", "m", "prescribed displacement, x and y").pair().or_word("free");
    t.number("body_force", "N/m3", "force per volume, x and y").pair();
    t.number("acceleration", "m/s2", "body force per mass (gravity), x and y").pair();
    t.number("ramp", "s", "grows linearly from zero over this time, then constant").above(0);
    t.number("table", "s", "[[time, factor], ...], linear in between, constant outside").points().second("");
    t.text("csv", "file with lines `time, factor` [s, -], beside the scenario; # begins a comment");

    t.list("obstacle[]",
        "a rigid body beside the meshed one, in contact with it: held, driven (velocity or displacement), or free "
        "where it has a mass and nothing is prescribed");
    t.text("name", "name in reactions.csv").computed("obstacle1, obstacle2, ...").to(&Obstacle::name);
    t.word("shape", {"half plane", "disc", "polygon"}, "its outline, convex").required();
    t.number("at", "m", "a point on its border").pair().required().only_with("shape", {"half plane"});
    t.number("normal", "", "direction out of it, towards the body")
        .pair().required().only_with("shape", {"half plane"});
    t.number("centre", "m", "centre").pair().required().only_with("shape", {"disc"});
    t.number("radius", "m", "radius").above(0).required().only_with("shape", {"disc"});
    t.number("points", "m", "corners in order").points().required().only_with("shape", {"polygon"});
    t.number("friction", "", "Coulomb's coefficient between it and the body")
        .at_least(0).otherwise("0").to(&CohesiveLaw::friction);
    t.number("restitution", "", "Newton's coefficient of impact")
        .at_least(0).at_most(1).otherwise("0").to(&CohesiveLaw::restitution);
    t.number("velocity", "m/s", "prescribed velocity, x and y").pair().or_word("free");
    t.number("displacement", "m", "prescribed displacement, x and y").pair().or_word("free");
    t.number("spin", "deg/s", "prescribed angular velocity, counterclockwise");
    t.number("mass", "kg", "its mass; or density").above(0);
    t.number("density", "kg/m3", "density of a disc or polygon as thick as the body; or mass").above(0);
    t.flag("turns", "free to turn about its centre of mass").computed("with a mass and nothing prescribed");
    t.number("force", "N", "force on its free components, x and y; gravity (acceleration) acts on it, too").pair();
    t.number("initial_velocity", "m/s", "of its free components at the start").pair();
    t.number("initial_spin", "deg/s", "angular velocity at the start");
    t.number("ramp", "s", "what is prescribed, and the force, grow linearly from zero over this time").above(0);
    t.number("table", "s", "[[time, factor], ...] of what is prescribed and of the force").points().second("");
    t.text("csv", "file with lines `time, factor` [s, -], as in load");

    t.list("initial[]", "velocity at the start; later ones lie over earlier ones");
    t.number("velocity", "m/s", "velocity, x and y").pair().required().to(&InitialVelocity::value);
    t.number("box", "m", "only triangles with their centroid inside; everywhere without").box().to(&Selection::box);
}

// clang-format on

std::span<const Key> keys() {
    static const KeyTable all = [] {
        KeyTable t;
        for (const auto add :
             {add_keys_of_body, add_keys_of_materials, add_keys_of_loads, add_keys_of_run, add_keys_of_ensembles})
            add(t);
        return t;
    }();
    return all.rows;
}

}  // namespace knap
