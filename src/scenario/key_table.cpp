// The rows of the key table. A new key is a row here. If its value is a member of an options struct,
// `.to(&Struct::member)` is all that reads it. Other values are read, and checked against each other, in read_*.cpp.
#include "scenario/key_table.hpp"

#include "microstructure/body_patterns.hpp"
#include "scenario/scenario.hpp"

#include <numbers>

namespace knap {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

// clang-format off
void add_arcs(KeyTable& t, const std::string& table, std::string_view doc, std::vector<std::string> shapes = {}) {
    t.list(joined_path(table, "arcs[]"), doc).only_with("shape", std::move(shapes));
    t.integer("side", "number of the side; side 1 joins the first point to the second, the last side closes the ring")
        .at_least(1).required();
    t.number("through", "m", "point on the arc between the ends of the side; the arc becomes a polygon with its "
        "corners on the arc and sides of the local mesh size").pair().required();
    t.in(table);
}

/// Outline of a body: of `table`, whose keys follow.
void add_outline(KeyTable& t, const std::string& table) {
    t.number("size", "m", "width and height").pair().above(0).required().only_with("shape", {"rectangle"});
    t.number("origin", "m", "lower left corner").pair().otherwise("[0, 0]").only_with("shape", {"rectangle"});
    t.number("points", "m", "corners in order, without repeating the first one")
        .points(3).required().only_with("shape", {"polygon"});
    t.text("sides", "boundary names of the sides, in the order of the points; sides may share a name")
        .list().a_name().computed("side1, side2, ...").only_with("shape", {"polygon"});
    add_arcs(t, table, "sides of the polygon that are circular arcs; they keep their boundary names", {"polygon"});
    t.number("centre", "m", "centre of the disc").pair().otherwise("[0, 0]").only_with("shape", {"disc"});
    t.number("radius", "m", "radius of the disc, meshed as a polygon with sides of the local mesh size")
        .above(0).required().only_with("shape", {"disc"});
}

/// Holes, cracks and regions of a body: lists of `table`.
void add_parts(KeyTable& t, const std::string& table) {
    t.number("snap", "m", "of cracks: ends, corners and crossings that are nearer than this to each other or to a line "
        "are joined, shorter pieces left out, and counted by `check`").above(0).computed("none");
    t.list(table + ".hole[]", "a hole, given by points, or by centre and radius");
    t.number("points", "m", "corners in order").points(3);
    add_arcs(t, table + ".hole[]", "sides between the points that are circular arcs");
    t.number("centre", "m", "centre of a round hole").pair();
    t.number("radius", "m", "radius of a round hole, meshed as a polygon with at least twelve sides").above(0);
    t.text("name", "boundary name of its edge").a_name().computed("hole1, hole2, ...");
    t.list(table + ".crack[]", "a closed crack without cohesion, with contact and friction by the law of its "
        "materials; or a joint with a law of its own");
    t.number("points", "m", "polyline of the crack").points(2).required();
    t.text("interface", "name of the interface law of a joint; without it there is no cohesion");
    t.list(table + ".region[]", "a part of another material: points, centre and radius, or a box; the last one counts");
    t.number("points", "m", "corners in order").points(3);
    add_arcs(t, table + ".region[]", "sides between the points that are circular arcs");
    t.number("centre", "m", "centre of a disc").pair();
    t.number("radius", "m", "radius of a disc").above(0);
    t.number("box", "m", "lower left and upper right corner").box();
    t.text("material", "name of a material").required();
}

/// What bodies have besides their shape.
void add_matter_and_motion(KeyTable& t) {
    t.text("material", "name of a material").computed("the first material");
    t.number("mesh_size", "m", "requested mean edge length of its mesh").above(0).computed("mesh.size");
    t.number("velocity", "m/s", "initial velocity, x and y; entries of [[initial]] overwrite it")
        .pair().to(&InitialVelocity::value);
    t.number("spin", "deg/s", "initial angular velocity about the centre of mass, counterclockwise")
        .to(&InitialVelocity::spin, radians);
}

/// The rebound of bodies: of an obstacle, a range of a terrain, pairs of materials.
void add_rebound(KeyTable& t) {
    t.number("R_N", "", "normal coefficient of restitution of bodies, instead of restitution: of a rigid one exactly "
        "that of its point of contact; a deformable one rebounds with it where it would with more, since the surface "
        "gives way by a part of an edge (check says up to which speed, the gate rebound_lack what was missed); "
        "explicit steps").at_least(0).at_most(1);
    t.number("R_T", "", "tangential coefficient of restitution of bodies: an impact leaves R_T of the slip of the "
        "point of contact (not of the centre), more where friction times the normal impulse cannot take as much, less "
        "where the normal impulse alone takes more; what slides, rolls or rests has friction alone. Explicit steps")
        .at_least(0).at_most(1).computed("0").to(&ContactLaw::tangential);
}

void add_keys_of_body(KeyTable& t) {
    t.integer("knap", "version of the scenario format; this program reads version 1").at_least(1).required();
    t.text("name", "name of the run directory: letters, digits, - _ and .")
        .computed("the name of the file").to(&Scenario::name);
    t.text("title", "title of the run in its figures; empty: its name").otherwise("").to(&Scenario::title);
    t.integer("seed", "seed of all random numbers: mesh, grains, inclusions, joints, strength")
        .at_least(0).otherwise("1").to(&Scenario::seed);

    t.table("domain", "the body, and what all bodies have in common; with mesh.file or [[body]] only the latter");
    t.word("shape", {"rectangle", "polygon", "disc"}, "outline of the body, required without mesh.file and [[body]]; a "
        "rectangle has the boundaries left, right, bottom, top, a disc the boundary rim");
    add_outline(t, "domain");
    t.word("model", {"plane strain", "plane stress"}, "assumption on the out-of-plane direction")
        .otherwise("plane strain").to(&Scenario::plane, {PlaneModel::strain, PlaneModel::stress});
    t.word("rotation", {"small", "large"}, "assumption on rotations: small (linear strain), or large (Green's strain, "
        "strains still small): fragments turn as far as they like, and pressure and stress loads follow their faces; "
        "with a start at rest and mesh.order = 1. Implicit steps are cut where a piece turns by more than 0.3 rad, or "
        "bends too far in one, and theta above 0.5 brakes a spin")
        .otherwise("small").to(&Scenario::large_rotation, {false, true});
    t.number("thickness", "m", "out-of-plane thickness; forces and energies are those of this thickness")
        .above(0).otherwise("1").to(&Scenario::thickness);
    add_parts(t, "domain");

    t.list("body[]", "a body of a scenario of several bodies, in place of the shape of [domain]. Bodies may touch, "
        "they are not joined, and each has a mesh of its own. Boundaries are named NAME.left, NAME.rim, ...; "
        "on = { body = \"NAME\" } selects the body");
    t.text("name", "name of the body").a_name().computed("body1, body2, ...");
    t.word("shape", {"rectangle", "polygon", "disc"}, "outline, with the keys and boundaries of [domain]").required();
    add_outline(t, "body[]");
    t.number("angle", "deg", "angle by which it is turned, with holes, cracks and regions: about the origin of a "
        "rectangle, the first point of a polygon, the centre of a disc").otherwise("0");
    t.number("shift", "m", "vector by which it is moved, with all its parts, after that").pair().otherwise("[0, 0]");
    add_matter_and_motion(t);
    add_parts(t, "body[]");

    t.list("bodies[]", "many bodies in a pattern, named NAME1, NAME2, ...; NAME is the group of all, for "
        "on = { body = \"NAME\" }. Boundaries of blocks are left, right, bottom, top, of polygons and stones rim");
    t.text("name", "name of the group").a_name().computed("its pattern");
    t.word("pattern", {"wall", "voronoi", "heap"}, "wall: rows of blocks in bond, from the bottom left; voronoi: "
        "polygons that fill a box (power diagram; its cells have the requested sizes); heap: convex polygons or discs "
        "at random places in a box that do not touch, the largest first").required();
    t.integer("columns", "number of blocks in a row")
        .at_least(1).at_most(10000).required().only_with("pattern", {"wall"});
    t.integer("rows", "number of rows").at_least(1).at_most(10000).required().only_with("pattern", {"wall"});
    t.number("block", "m", "width and height of a block")
        .pair().above(0).required().only_with("pattern", {"wall"}).to(&WallOptions::block);
    t.number("bond", "", "shift of every second row over block and gap, with shorter blocks at its ends; 0: "
        "stacked columns").at_least(0).below(1).otherwise("0.5").only_with("pattern", {"wall"}).to(&WallOptions::bond);
    t.number("origin", "m", "lower left corner of the wall")
        .pair().otherwise("[0, 0]").only_with("pattern", {"wall"}).to(&WallOptions::origin);
    t.number("gap", "m", "distance between neighbours; 0: they touch")
        .at_least(0).otherwise("0").only_with("pattern", {"wall", "voronoi"}).to(&WallOptions::gap);
    t.number("box", "m", "box of the pattern: lower left and upper right corner")
        .box().required().only_with("pattern", {"voronoi", "heap"});
    t.number("size", "m", "mean diameter (of the circle of equal area), at least 1.5 times mesh_size")
        .above(0).required().only_with("pattern", {"voronoi", "heap"}).to(&InclusionOptions::size);
    t.number("spread", "", "standard deviation of the lognormal distribution of diameters over their mean")
        .at_least(0).at_most(0.6).otherwise("0.25").only_with("pattern", {"voronoi", "heap"})
        .to(&InclusionOptions::spread);
    t.integer("number", "number of stones; either number or fraction")
        .at_least(1).at_most(5000).only_with("pattern", {"heap"}).to(&InclusionOptions::number);
    t.number("fraction", "", "area fraction of the stones in the box; random placement fails above about 0.5; either "
        "number or fraction").above(0).at_most(0.6).only_with("pattern", {"heap"}).to(&InclusionOptions::fraction);
    t.number("distance", "m", "minimum distance between stones, and to the border of the box")
        .above(0).computed("mesh_size/10").only_with("pattern", {"heap"}).to(&InclusionOptions::distance);
    t.integer("corners", "number of corners of a stone, fewer where its convex hull has fewer; 0: discs")
        .at_least(0).at_most(12).otherwise("7").only_with("pattern", {"heap"}).to(&InclusionOptions::corners);
    t.number("elongation", "", "length over width of a stone")
        .at_least(1).at_most(5).otherwise("1").only_with("pattern", {"heap"}).to(&InclusionOptions::elongation);
    t.number("direction", "deg", "angle of the long axis to x; without it random")
        .only_with("pattern", {"heap"}).to(&InclusionOptions::direction, radians);
    t.number("angle", "deg", "angle by which the pattern is turned about its origin or the lower left "
        "corner of its box").otherwise("0");
    t.number("shift", "m", "vector by which it is moved after that").pair().otherwise("[0, 0]");
    add_matter_and_motion(t);

    t.table("mesh", "the triangle mesh").required();
    t.number("size", "m", "requested mean edge length; required without mesh.file").above(0).to(&MeshOptions::size);
    t.number("min_angle", "deg", "requested minimum angle of the triangles")
        .at_least(0).at_most(30).otherwise("20").to(&MeshOptions::min_angle);
    t.number("grading", "", "growth of the edge length per distance from a refined place")
        .above(0).otherwise("0.3").to(&MeshOptions::grading);
    t.integer("order", "order of the displacement in a triangle; 2: seven nodes a triangle and three points an "
        "interface, more accurate in waves, impact and bending, with triangles of twice the size")
        .at_least(1).at_most(2).otherwise("1").to(&Scenario::order);
    t.list("mesh.refine[]", "a place with smaller triangles, a box or a strip; the smallest size holds "
        "where places overlap");
    t.number("inside", "m", "lower left and upper right corner of a box; or along").box();
    t.number("along", "m", "polyline in the middle of a strip, such as the path of a crack")
        .points(2);
    t.number("width", "m", "of the strip from side to side, required with along; its ends are round").above(0);
    t.number("size", "m", "requested mean edge length inside").above(0).required();
    t.in("mesh");
    t.text("file", "Gmsh mesh (.msh 2.2 or 4.1) that replaces shape and size, relative to the scenario file; its "
        "physical curves name boundaries, its physical surfaces materials");
    t.number("unit", "m", "length of one unit of the coordinates in mesh.file, as in \"1 mm\"; default 1 m")
        .at_least(1e-12).at_most(1e6);
    t.text("cracks", "physical curves of mesh.file inside the body that are closed initial cracks").list();
    t.text("material", "name of the material of all physical surfaces of mesh.file that have no name of a material")
        .computed("an error, where there are several materials");
    t.flag("grains", "true: each surface of mesh.file (physical and elementary tag of its triangles) is a grain, with "
        "the interface laws of [[grains]]").otherwise("false");
    t.list("mesh.joint[]", "a physical curve of mesh.file inside the body that is a joint");
    t.text("curve", "name of the physical curve").required();
    t.text("interface", "name of its interface law").required();
    t.in("mesh");

    t.table("adapt", "refinement of the mesh during the run, where interfaces may break soon: mesh.size is the size of "
        "all else, and mesh.grading holds between. Where the forecast of knap check finds no gain, the mesh is uniform "
        "from the start");
    t.number("size", "m", "mean edge length where interfaces may break").above(0).required().to(&AdaptOptions::size);
    t.number("load", "", "part of the strength, as the stress of a triangle in its worst direction, from which it is "
        "to be fine").above(0).below(1).otherwise("0.3").to(&AdaptOptions::load);
    t.number("margin", "", "fine edges around such triangles").at_least(1).otherwise("10").to(&AdaptOptions::margin);
    t.integer("every", "steps between two looks at the mesh; cracks run 0.1 edges in a step")
        .at_least(1).otherwise("150").to(&AdaptOptions::every);
    t.number("limit", "", "largest number of triangles").above(0).otherwise("5e6").to(&AdaptOptions::limit);
}

void add_keys_of_microstructure(KeyTable& t) {
    t.names("material", "materials by name; the first one is that of the domain").required();
    t.table("material.*", "a linear elastic material, isotropic but for bedding; its name has no -");
    t.number("density", "kg/m3", "mass density").above(0).required().to(&Elastic::density);
    t.number("E", "Pa", "Young's modulus").above(0).required().to(&Elastic::E);
    t.number("nu", "", "Poisson's ratio").above(-1).below(0.5).required().to(&Elastic::nu);
    t.number("bulk_viscosity", "", "linear (b1) and quadratic (b2, in compression) bulk viscosity of explicit steps")
        .pair().at_least(0).computed("[0, 1.2] with [contact], friction on an obstacle or friction over pressure or "
        "slip, unless the step is in s or order 2 meets [[excavation]]; else [0, 0]").to(&Elastic::bulk_viscosity);
    t.number("shear_viscosity", "", "viscosity (b3) of explicit steps that resists changes of shape")
        .at_least(0).computed("0.3 with friction over pressure or slip, unless the step is in s or "
        "order 2 meets [[excavation]]; else 0.1 where bulk_viscosity is [0, 1.2] by default; else 0")
        .to(&Elastic::shear_viscosity);
    add_thermal(t);
    t.table("material.*.bedding", "layers with these constants across them (transverse isotropy): E and nu of the "
        "material hold along them. Their strike is normal to the plane");
    t.number("E", "Pa", "Young's modulus across the layers").above(0).required().to(&Bedding::E);
    t.number("nu", "", "contraction along the layers over extension across them, under a stress across them")
        .above(-1).below(1).required().to(&Bedding::nu);
    t.number("G", "Pa", "shear modulus along the layers").above(0).computed("Saint-Venant's rule, 1/G = 1/E_along + "
        "(1 + 2 nu)/E").to(&Bedding::G);
    t.number("angle", "deg", "of the layers to the x axis, counterclockwise, in the body as it is placed: a number, a "
        "formula of x and y [m] (folds: \"atan(0.3*cos(20*x)) rad\"), or a csv file with columns `x [m], y [m], angle "
        "[deg]` as that of the stress of [[initial]], taken at the centroid of every triangle")
        .otherwise("0").or_formula().to(&Bedding::angle, radians);

    t.list("inclusions[]", "random discs or polygons of a material, or pores, that touch neither each other nor "
        "boundaries nor cracks");
    t.number("size", "m", "mean diameter (of the circle of equal area), at least 1.5 times mesh.size")
        .above(0).required().to(&InclusionOptions::size);
    t.number("fraction", "", "area fraction of the body; random placement of equal discs fails above about 0.5; "
        "either fraction or number").above(0).at_most(0.6).to(&InclusionOptions::fraction);
    t.integer("number", "number of inclusions; either fraction or number")
        .at_least(1).at_most(1000000).to(&InclusionOptions::number);
    t.number("spread", "", "standard deviation of the lognormal distribution of diameters over their mean")
        .at_least(0).at_most(1).otherwise("0").to(&InclusionOptions::spread);
    t.number("distance", "m", "minimum distance between inclusions, and to boundaries and cracks")
        .above(0).computed("mesh.size/2").to(&InclusionOptions::distance);
    t.integer("corners", "number of corners of random polygons; without it discs (ellipses)")
        .at_least(3).at_most(12).to(&InclusionOptions::corners);
    t.number("elongation", "", "length over width")
        .at_least(1).at_most(5).otherwise("1").to(&InclusionOptions::elongation);
    t.number("direction", "deg", "angle of the long axis to x; without it random")
        .to(&InclusionOptions::direction, radians);
    t.text("material", "name of a material; without it pores");
    t.text("body", "name of the body; required where there are several");
    t.text("name", "boundary name of the edges of pores").a_name().computed("pores");

    t.list("joints[]", "a joint set: closed cracks, or interfaces with a law of their own; with thickness "
        "and material veins");
    t.number("direction", "deg", "mean angle of the traces to x").required().to(&JointOptions::direction, radians);
    t.number("spread", "deg", "standard deviation of the angle")
        .at_least(0).at_most(30).otherwise("0").to(&JointOptions::spread, radians);
    t.number("spacing", "m", "mean distance between traces, across them")
        .above(0).required().to(&JointOptions::spacing);
    t.number("persistence", "", "joint length over total length along a row of traces; the rest are rock bridges; "
        "1: traces cross the body").above(0).at_most(1).otherwise("1").to(&JointOptions::persistence);
    t.number("length", "m", "mean length of a trace, required with persistence below 1")
        .above(0).to(&JointOptions::length);
    t.text("interface", "name of the interface law of the joints; without it they are cracked from the start");
    t.number("thickness", "m", "thickness of veins, at least half of mesh.size").above(0).to(&JointOptions::thickness);
    t.text("material", "material of veins");
    t.text("body", "name of the body; required where there are several");

    t.list("traces[]", "traces of joints and faults as they were mapped: closed cracks, or interfaces with a law of "
        "their own. domain.snap joins ends that nearly meet");
    t.text("file", "csv file, relative to the scenario file, with a line of names `trace, x [m], y [m], class` (the "
        "class may be missing) and a line for each point of a trace, or GeoJSON (.geojson, .json) with lines")
        .required();
    t.text("class", "the traces of this class alone; other [[traces]] take the other classes of the file. Without it "
        "all of them");
    t.text("property", "column of the csv file, or property of GeoJSON, that gives the class").otherwise("class");
    t.number("unit", "m", "length of one unit of coordinates that have none in the file; required for GeoJSON, whose "
        "longitudes and latitudes must be projected before");
    t.number("origin", "m", "coordinates of the file that are (0, 0) in the body").pair().otherwise("[0, 0]");
    t.flag("crop", "true: what lies outside the body is left out; false: it is an error").otherwise("false");
    t.text("interface", "name of the interface law of the traces; without it they are cracked from the start");
    t.text("body", "name of the body; required where there are several");

    t.list("map[]", "a picture whose colours are materials; a triangle takes the material that covers most of it. TIFF "
        "and JPEG become PNG by knap-convert");
    t.text("file", "PNG picture, relative to the scenario file").required();
    t.number("box", "m", "position of the picture: lower left and upper right corner")
        .box().computed("the bounding box of the body");
    t.flag("grains", "true: each connected patch of pixels of exactly one colour is a grain, with the interface laws "
        "of [[grains]]; patches below least_pixels join a neighbour").otherwise("false").to(&MaterialMap::grains);
    t.integer("least_pixels", "pixels of the smallest grain: noise and soft edges have fewer")
        .at_least(1).at_most(1000000).otherwise("16").to(&MaterialMap::least_pixels);
    t.flag("smooth", "true: single teeth vanish, and vertices move onto the borders in the picture as far as their "
        "triangles stay good; false: borders run along the edges as they are")
        .computed("the value of grains").to(&MaterialMap::smooth);
    t.list("map[].colour[]", "a colour and its material; a pixel counts as the nearest colour of the list, and changes "
        "nothing if all are far");
    t.text("rgb", "colour as \"#rrggbb\"").required();
    t.text("material", "name of a material").required();

    t.list("grains[]", "grains that replace one material; the interface law is `A-B` between grains of materials A and "
        "B, and `A` or `within` inside a grain");
    t.number("size", "m", "mean diameter (of the circle of equal area), at least 1.5 times mesh.size")
        .above(0).required().to(&GrainOptions::size);
    t.number("spread", "", "standard deviation of the lognormal distribution of diameters over their mean")
        .at_least(0).at_most(0.6).otherwise("0.25").to(&GrainOptions::spread);
    t.number("elongation", "", "length over width")
        .at_least(1).at_most(10).otherwise("1").to(&GrainOptions::elongation);
    t.number("direction", "deg", "angle of the long axis to x").otherwise("0").to(&GrainOptions::direction, radians);
    t.text("in", "the replaced material").computed("the first material");
    t.list("grains[].mineral[]", "a material for a part of the grains; the other grains keep the replaced material");
    t.text("material", "name of a material").required();
    t.number("fraction", "", "area fraction of the grains").at_least(0).at_most(1).required().to(&Mineral::fraction);
}

void add_keys_of_loads(KeyTable& t) {
    t.list("support[]", "a rigid, fixed body that a boundary stands on or is glued to; with [contact] a ground that "
        "everything meets, as long as the faces that stand on it at the start and `beyond`");
    add_place(t, "support[]", "place: a boundary, a box, a body, or what they have in common; required");
    t.text("interface", "name of the interface law between body and support").otherwise("default");
    t.flag("glued", "true: held by the cohesion of the law; false: contact and friction only")
        .otherwise("false").to(&Support::glued);
    t.number("gap", "m", "initial distance from the boundary; 0 if glued").at_least(0).otherwise("0").to(&Support::gap);
    t.number("beyond", "m", "how far the support goes on straight beyond its ends, for pieces that slide, turn or "
        "fall there; with [contact]").at_least(0).otherwise("0").to(&Support::beyond);

    t.list("absorb[]", "an absorbing boundary: waves leave the body as if it went on (viscous: traction -rho c_p v_n "
        "along the normal, -rho c_s v_t along the edge); also with a stress or traction");
    add_place(t, "absorb[]", "place: a boundary, a box, a body, or what they have in common; required");

    t.list("load[]", "a load or prescribed motion: exactly one of traction, pressure, stress, force, velocity, "
        "displacement, body_force, acceleration; its factor over time by at most one of ramp, table, csv, "
        "otherwise constant");
    t.text("name", "name of the load in reactions.csv, in the summary, in specimen.force, [expect] and [study]; "
        "letters, digits, blanks, _ and -").a_name().computed("load0, load1, ...").to(&Load::name);
    add_place(t, "load[]", "place: a boundary, a box, a body, or what they have in common; body_force and "
        "acceleration without it act on all bodies");
    t.number("traction", "Pa", "force per area on the boundary, x and y; that of a place and a time by formulas, or of "
        "points (tx, ty) by a csv file, as the stress of [[initial]]").pair().or_formula();
    t.number("pressure", "Pa", "normal force per area on the boundary, towards the body; the face is that of the "
        "undeformed body, with domain.rotation = \"large\" the present one, also of fragments that fly away. That of a "
        "place and a time by a formula, or of points (p) by a csv file, as the stress of [[initial]]").or_formula();
    t.number("stress", "Pa", "stress [xx, yy, xy] around the body (in situ stress), applied to the boundary as its "
        "traction, with domain.rotation = \"large\" that of the present face; tension is positive. That of a place "
        "and a time by formulas, or by a csv file, as the stress of [[initial]]").triple().or_formula();
    t.number("force", "N", "total force, x and y, shared equally by the vertices on the boundary or in the box").pair();
    t.number("velocity", "m/s", "prescribed velocity, x and y").pair().or_word("free");
    t.number("displacement", "m", "prescribed displacement, x and y").pair().or_word("free");
    t.number("body_force", "N/m3", "force per volume, x and y").pair();
    t.number("acceleration", "m/s2", "force per mass, x and y, as gravity").pair();
    add_history(t, "rise time: the factor grows linearly from 0 to 1 and stays 1");

    t.list("pressure[]", "the pressure of a fluid (water, gas, ice) in cracks: it acts on both faces of every broken "
        "interface that others connect to the source, and follows a crack that grows; without from and joints in all "
        "cracks. One of pressure, pressure_table, rate; its factor over time by at most one of ramp, table, "
        "csv, otherwise constant");
    t.text("name", "name of the fluid in fluids.csv, in the summary and in [expect]; letters, digits, blanks, _ and -")
        .a_name().computed("fluid0, fluid1, ...").to(&CrackPressure::name);
    t.number("pressure", "Pa", "pressure; that of a place and a time by a formula, or of points (p) by a csv file, as "
        "the stress of [[initial]]; negative: a warning").or_formula().to(&CrackPressure::pressure);
    t.number("rate", "m2/s", "volume per thickness of the body that enters in a time, and compresses with it; the "
        "pressure follows from the volume of the cracks that the fluid fills, and is never negative; the factor over "
        "time multiplies the rate").at_least(0).to(&CrackPressure::rate);
    t.number("storage", "m2/Pa", "volume per thickness that a pressure stores: compressibility times volume of the "
        "fluid in well, pump and crack; required with rate")
        .above(0).to(&CrackPressure::storage);
    t.number("gradient", "Pa/m", "growth of the pressure with the depth below `level` (water: 9810 Pa/m), added to "
        "pressure, pressure_table or rate, or alone: a water table; the sum is at least 0, and where it is, no water")
        .to(&CrackPressure::gradient);
    t.number("level", "m", "y where the gradient begins: the water table, or the place at which the other pressure is "
        "given").otherwise("0").to(&CrackPressure::level);
    t.number("pressure_table", "K", "pressure over temperature as pairs [temperature, pressure in Pa], with [heat]: "
        "linear between them and constant outside, at the mean temperature of the two faces; of ice in a closed joint "
        "at most 1.12 MPa per K below 0 C (Clapeyron), until it is squeezed out").points().second("Pa");
    t.flag("process_zone", "true: the fluid also enters interfaces that have begun to open and still hold in part, up "
        "to the tip, as linear elastic theories of hydraulic fracture assume; false: only broken ones")
        .otherwise("false").to(&CrackPressure::in_process_zone);
    add_place(t, "pressure[]", "the source: cracks that begin on a boundary, in a box, at a body, or on what they have "
        "in common", "from");
    t.text("joints", "the source: all joints with the interface law of this name, which the fluid fills also where "
        "they hold");
    add_history(t, "rise time: the factor grows linearly from 0 to 1 and stays 1");

    t.list("obstacle[]", "a rigid body in contact with the meshed body: fixed, driven (velocity or displacement), or "
        "free if it has a mass and nothing is prescribed. Free ones meet each other and all other obstacles");
    t.text("name", "name in reactions.csv").a_name().computed("obstacle1, obstacle2, ...").to(&Obstacle::name);
    t.word("shape", {"half plane", "disc", "polygon", "polyline"}, "outline; a polygon is convex, a polyline an open "
        "terrain, fixed or driven, with the ground on its left").required();
    t.number("at", "m", "point on the surface").pair().required().only_with("shape", {"half plane"});
    t.number("normal", "", "outward normal of the surface, towards the body")
        .pair().required().only_with("shape", {"half plane"});
    t.number("centre", "m", "centre").pair().required().only_with("shape", {"disc"});
    t.number("radius", "m", "radius").above(0).required().only_with("shape", {"disc"}).to(&Outline::radius);
    t.number("points", "m", "corners in order; of a polyline instead of csv").points(2)
        .only_with("shape", {"polygon", "polyline"});
    t.number("angle", "deg", "angle by which it is turned about its centre of mass").otherwise("0")
        .only_with("shape", {"disc", "polygon"});
    t.number("shift", "m", "vector by which it is moved after that").pair().otherwise("[0, 0]");
    add_contact<ContactLaw>(t);
    add_rebound(t);
    t.number("roughness", "m", "offsets of the points of a polyline along its normal: the largest one, or their "
        "standard deviation where they are normal; less than its segments are long")
        .at_least(0).otherwise("0").only_with("shape", {"polyline"}).to(&Roughness::size);
    t.word("roughness_kind", {"uniform", "normal"}, "distribution of the offsets; normal ones beyond three standard "
        "deviations are redrawn").otherwise("uniform").only_with("shape", {"polyline"})
        .to(&Roughness::kind, {Roughness::Kind::uniform, Roughness::Kind::normal});
    t.number("spacing", "m", "longer segments of a rough polyline are divided evenly; without it only the given points "
        "are offset").above(0).only_with("shape", {"polyline"}).to(&Roughness::spacing);
    t.integer("seed", "seed of the roughness; the same seed gives the same terrain").at_least(0).computed("seed")
        .only_with("shape", {"polyline"});
    t.number("velocity", "m/s", "prescribed velocity, x and y").pair().or_word("free");
    t.number("displacement", "m", "prescribed displacement, x and y").pair().or_word("free");
    t.number("spin", "deg/s", "prescribed angular velocity, counterclockwise");
    t.number("mass", "kg", "mass of free components; either mass or density").above(0);
    t.number("density", "kg/m3", "density of a disc or polygon, as thick as the body; either mass or density").above(0);
    t.flag("turns", "free to rotate about its centre of mass").computed("with a mass and nothing prescribed");
    t.number("force", "N", "force on the free components, x and y, in addition to gravity (acceleration)").pair();
    t.number("initial_velocity", "m/s", "initial velocity of the free components, x and y").pair();
    t.number("initial_spin", "deg/s", "initial angular velocity, counterclockwise");
    add_history(t, "rise time: the factor of prescribed motion and force grows linearly from 0 to 1 and stays 1",
        "file with lines `time, factor` instead of a table, relative to the scenario file; times in s, or as the line "
        "of names says: `time [us], factor`; # starts a comment. Of a polyline: lines `x, y` of its points in order "
        "(x does not turn back), with units in the line of names, `x [m], y [m]`, "
        "or behind the numbers; its factor is then by ramp or table");
    t.list("obstacle[].range[]", "a part of a polyline with values of its own; ranges do not overlap")
        .only_with("shape", {"polyline"});
    t.number("from", "m", "x where it begins").computed("the smallest x of the terrain");
    t.number("to", "m", "x where it ends").computed("the largest x of the terrain");
    t.number("friction", "", "Coulomb friction coefficient").at_least(0).computed("that of the obstacle")
        .to(&ContactLaw::friction);
    t.number("restitution", "", "Newton's coefficient of restitution").at_least(0).at_most(1)
        .computed("that of the obstacle").to(&ContactLaw::restitution);
    add_rebound(t);
    t.number("roughness", "m", "largest offset, or standard deviation").at_least(0).computed("that of the obstacle")
        .to(&Roughness::size);
    t.number("spacing", "m", "longer segments are divided evenly").above(0).computed("that of the obstacle")
        .to(&Roughness::spacing);

    t.table("contact", "contact between all free faces of all bodies and fragments, without a penalty; without this "
        "table faces that are no neighbours pass through each other. Two faces of joints with one law keep its "
        "friction and restitution, whatever is given here. It needs domain.rotation = \"large\", and with "
        "bulk = \"explicit\" also cohesion = \"explicit\". Implicit steps are for what is slow or at rest: they are "
        "cut where a contact moves by more than a twentieth of an edge");
    t.number("friction", "", "Coulomb friction coefficient of all pairs of materials")
        .at_least(0).computed("that of the interface law between the two materials").to(&ContactLaw::friction);
    t.number("restitution", "", "Newton's coefficient of restitution of all pairs: 0 plastic, 1 elastic impact")
        .at_least(0).at_most(1).computed("that of the interface law between the two materials")
        .to(&ContactLaw::restitution);
    add_rebound(t);
    t.list("contact.pair[]", "values of one pair of materials, in place of those of [contact]");
    t.text("materials", "two materials; a material twice: contact between its faces").pair().required();
    t.number("friction", "", "Coulomb friction coefficient").at_least(0).computed("as in [contact]")
        .to(&ContactLaw::friction);
    t.number("restitution", "", "Newton's coefficient of restitution").at_least(0).at_most(1)
        .computed("as in [contact]").to(&ContactLaw::restitution);
    add_rebound(t);

    t.table("rigid", "pieces of the body move as rigid ones, in steps of milliseconds, while nothing can break them: "
        "free flight, sliding, rolling, rest. A harder blow makes a piece deformable until it has not broken for a "
        "while (with supports and free obstacles all pieces). The energy of a vibration that ends so is "
        "`vibration_booked`. It needs [contact], loads that are accelerations, and temperatures that stay; what "
        "else a rigid piece does not know is in the table at the end; without this table all is deformable always");
    t.number("step", "s", "largest step of rigid pieces; it is divided where faces that meet move by more than a "
        "fifth of an edge, and what passes others by more than an edge, down to half the stable step of the mesh. "
        "Velocities and kinetic energies of tables are those of the middle of the last step (leapfrog): of what "
        "falls, g step/2 behind; those of [[collector]] are exact").above(0).computed("0.5 ms")
        .to(&RigidOptions::step);
    t.number("thaw", "", "k of the blow k sigma_c/(rho c) min(1, sqrt(10 L/D)) (a speed; c = sqrt(E/rho), L edge, D = "
        "sqrt(area) of the piece, sigma_c its smallest strength now) from which on a piece may break; 0: pieces are "
        "never rigid").at_least(0).computed("0.3").to(&RigidOptions::thaw);
    t.number("hold", "", "time for which a piece stays deformable after its last blow and its last loss of cohesion, "
        "in passages D/c of a wave through it, and then until what moves in it is slower than a blow that may break it "
        "or has a hundredth of its kinetic energy")
        .above(0).computed("20").to(&RigidOptions::hold);
    t.number("smallest", "m", "pieces of a smaller diameter (fragments.csv) never break; run.json has their mass")
        .at_least(0).computed("0").to(&RigidOptions::smallest);
    t.number("sleep", "m/s", "pieces that stay slower for 0.2 s and do not set out (the speed of what slides from rest "
        "grows) or go on with no loss, press on what stands still, and whose contacts would bear them at rest (not "
        "where they turn back, or on a corner), fall asleep, after 2 s also those that only creep in a heap: they "
        "stand still until they are hit faster; 0: none does")
        .at_least(0).computed("2 cm/s").to(&RigidOptions::sleep);
    t.number("restitution", "", "Newton's coefficient of rigid pieces that cannot break, where neither the pair of "
        "materials or the obstacle, nor [contact] (obstacles that give none have its R_N or restitution), nor the "
        "interface law gives one; what can break has 0 below the blow, or R_N. Bodies of many triangles rebound "
        "with 0.9 and more, single triangles with 0.3 to 0.6")
        .at_least(0).at_most(1).computed("0.9").to(&RigidOptions::restitution);

    t.list("excavation[]", "a region of the body that vanishes at a time, given by points, by centre and radius, or "
        "by a box, in the undeformed body: what is there at the start vanishes, wherever it has moved. The mesh "
        "follows its outline. Until then it is ordinary material; then the forces that it exerted on the rest decrease "
        "linearly to zero, and the new faces are free. Its loads and supports vanish with it");
    t.number("points", "m", "corners in order").points(3);
    add_arcs(t, "excavation[]", "sides between the points that are circular arcs");
    t.number("centre", "m", "centre of a disc").pair();
    t.number("radius", "m", "radius of a disc").above(0);
    t.number("box", "m", "lower left and upper right corner").box();
    t.number("at", "s", "time at which it vanishes, at the start of a step").at_least(0).required().to(&Excavation::at);
    t.number("ramp", "s", "time in which the forces decrease to zero; 0: at once")
        .at_least(0).otherwise("0").to(&Excavation::ramp);

    t.list("initial[]", "an initial velocity, or a stress of the undeformed body; later ones overwrite earlier ones");
    t.number("velocity", "m/s", "velocity, x and y; one or more of velocity, spin, strain_rate")
        .pair().to(&InitialVelocity::value);
    t.number("spin", "deg/s", "angular velocity about the centre of mass of the selected triangles, counterclockwise")
        .to(&InitialVelocity::spin, radians);
    t.number("strain_rate", "Hz", "rate of strain [xx, yy, xy] about the same centre: the body expands")
        .triple().to(&InitialVelocity::strain_rate);
    t.number("stress", "Pa", "stress [xx, yy, xy] of the undeformed body (in situ or residual stress), tension "
        "positive: numbers, formulas of x and y [m] in Pa or with a unit behind (\"-0.027*(100 - y) MPa\"), or a csv "
        "file with columns `x [m], y [m], xx [MPa], yy [MPa], xy [MPa]`, linear on the Delaunay triangles of its "
        "points and an error outside them. What the loads at t = 0 do not balance of it moves the body, or with "
        "time.start = \"equilibrium\" strains it before the start. It acts as a load: its work is external_work, and "
        "the elastic energy counts from the undeformed body").triple().or_formula();
    t.number("box", "m", "box of the centroids of the triangles that have it; without it all")
        .box().to(&Selection::box);
    t.text("body", "name of a body, or of a group of bodies; without it all").to(&Selection::body);
}
// clang-format on

}  // namespace

std::span<const Key> keys() {
    static const std::vector<Key> rows = [] {
        KeyTable t;
        for (const auto add : {add_keys_of_body, add_keys_of_microstructure, add_keys_of_laws, add_keys_of_loads,
                               add_keys_of_heat, add_keys_of_run, add_keys_of_calibration, add_keys_of_ensembles})
            add(t);
        return std::move(t.rows);
    }();
    return rows;
}

}  // namespace knap
