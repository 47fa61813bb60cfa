#include "scenario/keys.hpp"

#include <algorithm>

#include "observe/figures.hpp"
#include "scenario/units.hpp"

namespace knap {
namespace {

const Range positive{.low = 0, .low_included = false};
const Range not_negative{.low = 0};

std::vector<std::string> summary_names() {
    std::vector<std::string> names;
    for (const SummaryKey& key : summary_keys()) names.emplace_back(key.name);
    return names;
}

// clang-format off
const std::vector<Key>& table() {
    static const std::vector<Key> rows{
    {.path = "knap", .kind = Kind::integer, .range = {.low = 1}, .required = true, .doc = "version of the scenario format; this program reads 1"},
    {.path = "name", .kind = Kind::text, .otherwise = "the name of the file", .doc = "short name: letters, digits, - _ and ."},
    {.path = "title", .kind = Kind::text, .standard = "\"\"", .doc = "one line for people"},
    {.path = "seed", .kind = Kind::integer, .range = not_negative, .standard = "1", .doc = "the only source of randomness (mesh, grains, inclusions, joints, strength)"},

    {.path = "domain", .kind = Kind::table, .doc = "the body; with mesh.file only model and thickness"},
    {.path = "domain.shape", .kind = Kind::text, .words = {"rectangle", "polygon", "disc"},
     .doc = "needed without mesh.file; rectangle has the boundaries left, right, bottom, top; disc has rim"},
    {.path = "domain.size", .kind = Kind::number, .form = Form::pair, .unit = "m", .range = positive, .required = true, .when = "shape=rectangle",
     .doc = "width and height"},
    {.path = "domain.origin", .kind = Kind::number, .form = Form::pair, .unit = "m", .standard = "[0, 0]", .when = "shape=rectangle",
     .doc = "lower left corner"},
    {.path = "domain.points", .kind = Kind::number, .form = Form::points, .unit = "m", .required = true, .when = "shape=polygon",
     .doc = "corners in order, the first one not repeated"},
    {.path = "domain.sides", .kind = Kind::text, .form = Form::list, .otherwise = "side1, side2, ...", .when = "shape=polygon",
     .doc = "boundary names, one for each side from a point to the next; a name may come back"},
    {.path = "domain.centre", .kind = Kind::number, .form = Form::pair, .unit = "m", .standard = "[0, 0]", .when = "shape=disc", .doc = "centre"},
    {.path = "domain.radius", .kind = Kind::number, .unit = "m", .range = positive, .required = true, .when = "shape=disc",
     .doc = "radius; the rim becomes a polygon with sides of the mesh size"},
    {.path = "domain.model", .kind = Kind::text, .words = {"plane strain", "plane stress"}, .standard = "\"plane strain\"",
     .doc = "what is zero across the plane"},
    {.path = "domain.thickness", .kind = Kind::number, .unit = "m", .range = positive, .standard = "1", .doc = "thickness of the body"},

    {.path = "domain.hole[]", .kind = Kind::list, .doc = "a hole: points, or centre and radius"},
    {.path = "domain.hole[].points", .kind = Kind::number, .form = Form::points, .unit = "m", .doc = "corners in order"},
    {.path = "domain.hole[].centre", .kind = Kind::number, .form = Form::pair, .unit = "m", .doc = "centre of a round hole"},
    {.path = "domain.hole[].radius", .kind = Kind::number, .unit = "m", .range = positive, .doc = "radius of a round hole"},
    {.path = "domain.hole[].name", .kind = Kind::text, .otherwise = "hole1, hole2, ...", .doc = "boundary name of its border"},
    {.path = "domain.crack[]", .kind = Kind::list, .doc = "a closed crack: no cohesion; contact and friction of the material pair it lies between"},
    {.path = "domain.crack[].points", .kind = Kind::number, .form = Form::points, .unit = "m", .required = true, .doc = "the crack as a polyline"},
    {.path = "domain.region[]", .kind = Kind::list, .doc = "a part with a material of its own: points, centre and radius, or box; later ones lie over earlier ones"},
    {.path = "domain.region[].points", .kind = Kind::number, .form = Form::points, .unit = "m", .doc = "corners in order"},
    {.path = "domain.region[].centre", .kind = Kind::number, .form = Form::pair, .unit = "m", .doc = "centre of a disc"},
    {.path = "domain.region[].radius", .kind = Kind::number, .unit = "m", .range = positive, .doc = "radius of a disc"},
    {.path = "domain.region[].box", .kind = Kind::number, .form = Form::box, .unit = "m", .doc = "lower left and upper right corner"},
    {.path = "domain.region[].material", .kind = Kind::text, .required = true, .doc = "name of a material"},

    {.path = "mesh", .kind = Kind::table, .required = true, .doc = "the triangle mesh"},
    {.path = "mesh.size", .kind = Kind::number, .unit = "m", .range = positive, .doc = "wanted mean edge length; or file"},
    {.path = "mesh.min_angle", .kind = Kind::number, .unit = "deg", .range = {.low = 0, .high = 30}, .standard = "20", .doc = "wanted smallest angle"},
    {.path = "mesh.grading", .kind = Kind::number, .range = positive, .standard = "0.3", .doc = "growth of the size per distance away from a refine box"},
    {.path = "mesh.order", .kind = Kind::integer, .range = {.low = 1, .high = 2}, .standard = "1",
     .doc = "of the displacement on a triangle; 2: seven nodes, three points an interface, more accurate in waves, impact and bending; use triangles of twice the size"},
    {.path = "mesh.refine[]", .kind = Kind::list, .doc = "a box with smaller triangles; the smallest size wins where boxes overlap"},
    {.path = "mesh.refine[].inside", .kind = Kind::number, .form = Form::box, .unit = "m", .required = true, .doc = "lower left and upper right corner"},
    {.path = "mesh.refine[].size", .kind = Kind::number, .unit = "m", .range = positive, .required = true, .doc = "wanted mean edge length inside"},
    {.path = "mesh.file", .kind = Kind::text,
     .doc = "a Gmsh mesh (.msh 2.2 or 4.1) beside the scenario, instead of meshing: physical curves name boundaries, physical surfaces materials"},
    {.path = "mesh.unit", .kind = Kind::number, .unit = "m", .range = {.low = 1e-12, .high = 1e6},
     .doc = "what 1 in the coordinates of mesh.file is, as in \"1 mm\"; 1 m without it"},
    {.path = "mesh.cracks", .kind = Kind::text, .form = Form::list, .doc = "physical curves of mesh.file inside the body that are closed cracks"},

    {.path = "material", .kind = Kind::names, .required = true, .doc = "materials by name; the first one is that of the domain"},
    {.path = "material.*", .kind = Kind::table, .doc = "a linear elastic material; no - in its name"},
    {.path = "material.*.density", .kind = Kind::number, .unit = "kg/m3", .range = positive, .required = true, .doc = "density"},
    {.path = "material.*.E", .kind = Kind::number, .unit = "Pa", .range = positive, .required = true, .doc = "Young's modulus"},
    {.path = "material.*.nu", .kind = Kind::number, .range = {.low = -1, .high = 0.5, .low_included = false, .high_included = false}, .required = true,
     .doc = "Poisson's ratio"},

    {.path = "inclusions[]", .kind = Kind::list, .doc = "random discs or polygons of a material, or pores; they do not overlap, nor touch borders and cracks"},
    {.path = "inclusions[].size", .kind = Kind::number, .unit = "m", .range = positive, .required = true,
     .doc = "mean diameter, of the circle of equal area; at least 1.5 mesh sizes"},
    {.path = "inclusions[].fraction", .kind = Kind::number, .range = {.low = 0, .high = 0.6, .low_included = false}, .required = true,
     .doc = "of the area of the body; equal discs find no room above about 0.5"},
    {.path = "inclusions[].spread", .kind = Kind::number, .range = {.low = 0, .high = 1}, .standard = "0",
     .doc = "standard deviation of the diameters (lognormal) over their mean"},
    {.path = "inclusions[].distance", .kind = Kind::number, .unit = "m", .range = positive, .otherwise = "mesh.size/2",
     .doc = "least distance between them, and from borders and cracks"},
    {.path = "inclusions[].corners", .kind = Kind::integer, .range = {.low = 3, .high = 12}, .doc = "of random polygons; none: discs (ellipses)"},
    {.path = "inclusions[].elongation", .kind = Kind::number, .range = {.low = 1, .high = 5}, .standard = "1", .doc = "length over width"},
    {.path = "inclusions[].direction", .kind = Kind::number, .unit = "deg", .doc = "of the length, from x; none: at random"},
    {.path = "inclusions[].material", .kind = Kind::text, .doc = "name of a material; none: pores"},
    {.path = "inclusions[].name", .kind = Kind::text, .otherwise = "pores", .doc = "boundary name of pores"},

    {.path = "joints[]", .kind = Kind::list, .doc = "a set of joints: closed cracks, or interfaces with a law; with thickness and material veins"},
    {.path = "joints[].direction", .kind = Kind::number, .unit = "deg", .required = true, .doc = "of the traces, from x"},
    {.path = "joints[].spread", .kind = Kind::number, .unit = "deg", .range = {.low = 0, .high = 30}, .standard = "0", .doc = "standard deviation of the direction"},
    {.path = "joints[].spacing", .kind = Kind::number, .unit = "m", .range = positive, .required = true, .doc = "mean distance across"},
    {.path = "joints[].persistence", .kind = Kind::number, .range = {.low = 0, .high = 1, .low_included = false}, .standard = "1",
     .doc = "part of a row that is joint, the rest is bridges of rock; 1: from end to end"},
    {.path = "joints[].length", .kind = Kind::number, .unit = "m", .range = positive, .doc = "mean length of a trace; needed with persistence below 1"},
    {.path = "joints[].interface", .kind = Kind::text, .doc = "name of the law of the joints; none: cracked from the start"},
    {.path = "joints[].thickness", .kind = Kind::number, .unit = "m", .range = positive, .doc = "of veins; at least half a mesh size"},
    {.path = "joints[].material", .kind = Kind::text, .doc = "of veins: name of a material"},

    {.path = "map[]", .kind = Kind::list, .doc = "a picture whose colours are materials; each triangle takes the one that covers most of it"},
    {.path = "map[].file", .kind = Kind::text, .required = true, .doc = "a PNG picture beside the scenario"},
    {.path = "map[].box", .kind = Kind::number, .form = Form::box, .unit = "m", .otherwise = "round the body", .doc = "where the picture lies: lower left and upper right corner"},
    {.path = "map[].colour[]", .kind = Kind::list, .doc = "a colour and its material; pixels take the nearest colour, those of none leave what is there"},
    {.path = "map[].colour[].rgb", .kind = Kind::text, .required = true, .doc = "as \"#rrggbb\""},
    {.path = "map[].colour[].material", .kind = Kind::text, .required = true, .doc = "name of a material"},

    {.path = "grains[]", .kind = Kind::list,
     .doc = "grains in place of one material; between grains of materials A and B acts `A-B`, within a grain `A` or `within` (below)"},
    {.path = "grains[].size", .kind = Kind::number, .unit = "m", .range = positive, .required = true,
     .doc = "mean diameter, of the circle of equal area; at least 1.5 mesh sizes"},
    {.path = "grains[].spread", .kind = Kind::number, .range = {.low = 0, .high = 0.6}, .standard = "0.25",
     .doc = "standard deviation of the diameters (lognormal) over their mean"},
    {.path = "grains[].elongation", .kind = Kind::number, .range = {.low = 1, .high = 10}, .standard = "1", .doc = "length over width"},
    {.path = "grains[].direction", .kind = Kind::number, .unit = "deg", .standard = "0", .doc = "of the length, from x"},
    {.path = "grains[].in", .kind = Kind::text, .otherwise = "the first material", .doc = "the material that becomes grains"},
    {.path = "grains[].mineral[]", .kind = Kind::list, .doc = "a material of some of the grains; the rest keeps the one they are in"},
    {.path = "grains[].mineral[].material", .kind = Kind::text, .required = true, .doc = "name of a material"},
    {.path = "grains[].mineral[].fraction", .kind = Kind::number, .range = {.low = 0, .high = 1}, .required = true, .doc = "of the area of these grains"},

    {.path = "interface", .kind = Kind::names, .required = true,
     .doc = "cohesive laws: `default`, `A-B` for a pair of materials (A-A inside one, or between two grains), within a grain `A`, for all grains `within`"
            " (without them A-A), or a free name for a foundation or a set of joints; each stands by itself"},
    {.path = "interface.*", .kind = Kind::table, .doc = "a cohesive law with contact, friction and impact"},
    {.path = "interface.*.breakable", .kind = Kind::boolean, .standard = "true", .doc = "false: never breaks, whatever sigma_c and G_c say"},
    {.path = "interface.*.sigma_c", .kind = Kind::number, .unit = "Pa", .range = not_negative,
     .doc = "tensile strength; 0 = contact and friction only; needed unless breakable = false"},
    {.path = "interface.*.G_c", .kind = Kind::number, .unit = "J/m2", .range = positive, .doc = "fracture energy; or delta_c"},
    {.path = "interface.*.delta_c", .kind = Kind::number, .unit = "m", .range = positive, .doc = "opening at which it is broken, 2 G_c/sigma_c; or G_c"},
    {.path = "interface.*.gamma", .kind = Kind::number, .range = not_negative, .standard = "1", .doc = "mode II over mode I traction; 0 = mode I only"},
    {.path = "interface.*.friction", .kind = Kind::number, .range = not_negative, .standard = "0", .doc = "Coulomb's coefficient"},
    {.path = "interface.*.restitution", .kind = Kind::number, .range = {.low = 0, .high = 1}, .standard = "0", .doc = "Newton's coefficient of impact"},

    {.path = "interface.*.scatter", .kind = Kind::table, .doc = "random strength, drawn for every interface with the seed; the mean is the law's value"},
    {.path = "interface.*.scatter.kind", .kind = Kind::text, .words = {"weibull", "normal", "lognormal", "uniform"}, .required = true, .doc = "distribution"},
    {.path = "interface.*.scatter.modulus", .kind = Kind::number, .range = {.low = 1}, .required = true, .when = "kind=weibull", .doc = "Weibull's modulus m"},
    {.path = "interface.*.scatter.deviation", .kind = Kind::number, .range = positive, .required = true, .when = "kind=normal or lognormal or uniform",
     .doc = "standard deviation over the mean, also \"1 %\""},
    {.path = "interface.*.scatter.of", .kind = Kind::text, .form = Form::one_or_list, .words = {"sigma_c", "G_c"}, .standard = "\"sigma_c\"",
     .doc = "what scatters; both by the same factor"},
    {.path = "interface.*.scatter.length", .kind = Kind::number, .unit = "m", .range = positive,
     .doc = "length of the piece of interface that the mean belongs to: shorter pieces are stronger, so that chains of them do not depend on the mesh"},
    {.path = "interface.*.scatter.area", .kind = Kind::number, .unit = "m2", .range = positive,
     .doc = "likewise, area of the part of the body that the mean belongs to; for cracks that may start anywhere"
              "; a body grows stronger with finer meshes then, unlike with correlation"},
    {.path = "interface.*.scatter.correlation", .kind = Kind::number, .unit = "m", .range = positive,
     .doc = "correlation length L of a random field, correlation exp(-(r/L)^2), the same for every mesh; none: every interface by itself"},
    {.path = "interface.*.scatter.lowest", .kind = Kind::number, .range = {.low = 0, .high = 1, .high_included = false}, .standard = "0",
     .doc = "smallest value over the mean; what is below is drawn again"},
    {.path = "interface.*.scatter.highest", .kind = Kind::number, .range = {.low = 1, .low_included = false}, .doc = "largest value over the mean, likewise; none"},

    {.path = "foundation[]", .kind = Kind::list, .doc = "a rigid, fixed foundation that a boundary stands on"},
    {.path = "foundation[].on", .kind = Kind::table, .required = true, .shorthand = "boundary", .doc = "a boundary, all of it or inside a box"},
    {.path = "foundation[].on.boundary", .kind = Kind::text, .required = true, .doc = "name of a boundary"},
    {.path = "foundation[].on.box", .kind = Kind::number, .form = Form::box, .unit = "m", .doc = "only the part inside this box"},
    {.path = "foundation[].interface", .kind = Kind::text, .standard = "\"default\"", .doc = "name of the law between body and foundation"},
    {.path = "foundation[].glued", .kind = Kind::boolean, .standard = "false", .doc = "true: held by the law's cohesion; false: contact and friction only"},
    {.path = "foundation[].gap", .kind = Kind::number, .unit = "m", .range = not_negative, .standard = "0", .doc = "distance at the start; not of what is glued"},

    {.path = "load[]", .kind = Kind::list,
     .doc = "exactly one of traction, pressure, stress, force, velocity, displacement, body_force, acceleration; at most one of ramp, table, csv (none: constant)"},
    {.path = "load[].on", .kind = Kind::table, .shorthand = "boundary",
     .doc = "where: a boundary, a box, or a boundary inside a box; body_force and acceleration without it act everywhere"},
    {.path = "load[].on.boundary", .kind = Kind::text, .doc = "name of a boundary"},
    {.path = "load[].on.box", .kind = Kind::number, .form = Form::box, .unit = "m", .doc = "lower left and upper right corner"},
    {.path = "load[].traction", .kind = Kind::number, .form = Form::pair, .unit = "Pa", .doc = "force per area on boundary edges, x and y"},
    {.path = "load[].pressure", .kind = Kind::number, .unit = "Pa",
     .doc = "force per area on boundary edges against their outward normal, of the body as it was at first: it does not follow what turns"},
    {.path = "load[].stress", .kind = Kind::number, .form = Form::triple, .unit = "Pa",
     .doc = "the traction on boundary edges that a stress [xx, yy, xy] around the body has there, tension positive (stress in situ)"},
    {.path = "load[].force", .kind = Kind::number, .form = Form::pair, .unit = "N",
     .doc = "force, shared equally by the vertices on a boundary or in a box, x and y"},
    {.path = "load[].velocity", .kind = Kind::number, .form = Form::pair, .unit = "m/s", .words = {"free"}, .doc = "prescribed velocity, x and y"},
    {.path = "load[].displacement", .kind = Kind::number, .form = Form::pair, .unit = "m", .words = {"free"}, .doc = "prescribed displacement, x and y"},
    {.path = "load[].body_force", .kind = Kind::number, .form = Form::pair, .unit = "N/m3", .doc = "force per volume, x and y"},
    {.path = "load[].acceleration", .kind = Kind::number, .form = Form::pair, .unit = "m/s2", .doc = "body force per mass (gravity), x and y"},
    {.path = "load[].ramp", .kind = Kind::number, .unit = "s", .range = positive, .doc = "grows linearly from zero over this time, then constant"},
    {.path = "load[].table", .kind = Kind::number, .form = Form::points, .unit = "s", .second_unit = "",
     .doc = "[[time, factor], ...], linear in between, constant outside"},
    {.path = "load[].csv", .kind = Kind::text, .doc = "file with lines `time, factor` [s, -], beside the scenario; # begins a comment"},

    {.path = "obstacle[]", .kind = Kind::list,
     .doc = "a rigid body beside the meshed one, in contact with it: held, driven (velocity or displacement), or free where it has a mass and nothing is prescribed"},
    {.path = "obstacle[].name", .kind = Kind::text, .otherwise = "obstacle1, obstacle2, ...", .doc = "name in reactions.csv"},
    {.path = "obstacle[].shape", .kind = Kind::text, .words = {"half plane", "disc", "polygon"}, .required = true, .doc = "its outline, convex"},
    {.path = "obstacle[].at", .kind = Kind::number, .form = Form::pair, .unit = "m", .required = true, .when = "shape=half plane", .doc = "a point on its border"},
    {.path = "obstacle[].normal", .kind = Kind::number, .form = Form::pair, .required = true, .when = "shape=half plane",
     .doc = "direction out of it, towards the body"},
    {.path = "obstacle[].centre", .kind = Kind::number, .form = Form::pair, .unit = "m", .required = true, .when = "shape=disc", .doc = "centre"},
    {.path = "obstacle[].radius", .kind = Kind::number, .unit = "m", .range = positive, .required = true, .when = "shape=disc", .doc = "radius"},
    {.path = "obstacle[].points", .kind = Kind::number, .form = Form::points, .unit = "m", .required = true, .when = "shape=polygon", .doc = "corners in order"},
    {.path = "obstacle[].friction", .kind = Kind::number, .range = not_negative, .standard = "0", .doc = "Coulomb's coefficient between it and the body"},
    {.path = "obstacle[].restitution", .kind = Kind::number, .range = {.low = 0, .high = 1}, .standard = "0", .doc = "Newton's coefficient of impact"},
    {.path = "obstacle[].velocity", .kind = Kind::number, .form = Form::pair, .unit = "m/s", .words = {"free"}, .doc = "prescribed velocity, x and y"},
    {.path = "obstacle[].displacement", .kind = Kind::number, .form = Form::pair, .unit = "m", .words = {"free"}, .doc = "prescribed displacement, x and y"},
    {.path = "obstacle[].spin", .kind = Kind::number, .unit = "deg/s", .doc = "prescribed angular velocity, counterclockwise"},
    {.path = "obstacle[].mass", .kind = Kind::number, .unit = "kg", .range = positive, .doc = "its mass; or density"},
    {.path = "obstacle[].density", .kind = Kind::number, .unit = "kg/m3", .range = positive, .doc = "density of a disc or polygon as thick as the body; or mass"},
    {.path = "obstacle[].turns", .kind = Kind::boolean, .otherwise = "with a mass and nothing prescribed", .doc = "free to turn about its centre of mass"},
    {.path = "obstacle[].force", .kind = Kind::number, .form = Form::pair, .unit = "N", .doc = "force on its free components, x and y; gravity (acceleration) acts on it, too"},
    {.path = "obstacle[].initial_velocity", .kind = Kind::number, .form = Form::pair, .unit = "m/s", .doc = "of its free components at the start"},
    {.path = "obstacle[].initial_spin", .kind = Kind::number, .unit = "deg/s", .doc = "angular velocity at the start"},
    {.path = "obstacle[].ramp", .kind = Kind::number, .unit = "s", .range = positive, .doc = "what is prescribed, and the force, grow linearly from zero over this time"},
    {.path = "obstacle[].table", .kind = Kind::number, .form = Form::points, .unit = "s", .second_unit = "",
     .doc = "[[time, factor], ...] of what is prescribed and of the force"},
    {.path = "obstacle[].csv", .kind = Kind::text, .doc = "file with lines `time, factor` [s, -], as in load"},

    {.path = "initial[]", .kind = Kind::list, .doc = "velocity at the start; later ones lie over earlier ones"},
    {.path = "initial[].velocity", .kind = Kind::number, .form = Form::pair, .unit = "m/s", .required = true, .doc = "velocity, x and y"},
    {.path = "initial[].box", .kind = Kind::number, .form = Form::box, .unit = "m", .doc = "only triangles with their centroid inside; everywhere without"},

    {.path = "time", .kind = Kind::table, .required = true, .doc = "time and the stepper"},
    {.path = "time.end", .kind = Kind::number, .unit = "s", .range = positive, .required = true, .doc = "time simulated"},
    {.path = "time.bulk", .kind = Kind::text, .words = {"explicit", "implicit"}, .standard = "\"explicit\"",
     .doc = "explicit: lumped mass, steps up to the stable one; implicit: theta scheme, steps of any size"},
    {.path = "time.cohesion", .kind = Kind::text, .words = {"explicit", "implicit"}, .standard = "\"explicit\"",
     .doc = "explicit: cohesion frozen over a step; implicit: part of the complementarity problem"},
    {.path = "time.step", .kind = Kind::number, .unit = "s", .range = positive, .words = {"auto"}, .standard = "\"auto\"",
     .doc = "step, also as a multiple of the stable step of the explicit bulk, \"20 CFL\"; auto: safety x stable step, with the implicit bulk 20 CFL"},
    {.path = "time.step_cracking", .kind = Kind::number, .unit = "s", .range = positive, .otherwise = "time.step",
     .doc = "implicit bulk: the largest step from the first loss of cohesion on; CFL as in time.step"},
    {.path = "time.step_min", .kind = Kind::number, .unit = "s", .range = positive, .otherwise = "2^-20 time.step_cracking",
     .doc = "implicit bulk or cohesion: a run that needs a smaller step stops; CFL as in time.step"},
    {.path = "time.safety", .kind = Kind::number, .range = {.low = 0, .high = 1, .low_included = false}, .standard = "0.8",
     .doc = "fraction of the stable step that auto takes"},
    {.path = "time.theta", .kind = Kind::number, .range = {.low = 0.5, .high = 1}, .standard = "0.5",
     .doc = "of the implicit bulk and the implicit cohesion: 0.5 keeps the energy, more damps; at most 1/(1 + restitution)"},
    {.path = "time.mass", .kind = Kind::text, .words = {"lumped", "consistent", "one point"}, .standard = "\"lumped\"",
     .doc = "mass matrix of a triangle; consistent: the exact integral; one point: from its centroid alone; both with the implicit bulk only"},
    {.path = "time.start", .kind = Kind::text, .words = {"rest", "equilibrium"}, .standard = "\"rest\"",
     .doc = "rest: undeformed; equilibrium: deformed by the loads at t = 0"},
    {.path = "time.assumption_1", .kind = Kind::text, .words = {"respect", "ignore"}, .standard = "\"respect\"",
     .doc = "implicit cohesion: where a step has several solutions, cut it (respect) or take one of them (ignore)"},

    {.path = "output", .kind = Kind::table, .doc = "what is written"},
    {.path = "output.every", .kind = Kind::number, .unit = "s", .range = positive, .otherwise = "time.end/40", .doc = "between two field frames"},
    {.path = "output.history_every", .kind = Kind::number, .unit = "s", .range = positive, .otherwise = "time.end/400",
     .doc = "between two lines of energy.csv and cracks.csv"},
    {.path = "output.checkpoint_every", .kind = Kind::number, .unit = "s", .range = not_negative, .standard = "60",
     .doc = "wall time between two checkpoints; an unfinished run goes on from the last one when it is started again"},
    {.path = "output.fields", .kind = Kind::boolean, .standard = "true", .doc = "write .vtu frames"},
    {.path = "output.breaks", .kind = Kind::boolean, .otherwise = "true with a specimen or a figure of breaks",
     .doc = "write breaks.csv: a line for every interface that breaks, with time, place, direction, length, mode (part of sliding in it) and energy"},

    {.path = "specimen", .kind = Kind::table, .doc = "the body is the specimen of a rock test: stress_strain.csv, strength, moduli, crack initiation and damage"},
    {.path = "specimen.test", .kind = Kind::text, .words = {"compression", "tension", "brazilian", "bending"}, .required = true,
     .doc = "what the stress is: force over width x thickness, of a disc 2 P/(pi height thickness), of a beam 3 P span/(2 height^2 thickness); "
            "compression and shortening are positive but in tension"},
    {.path = "specimen.force", .kind = Kind::text, .required = true,
     .doc = "whose reaction is the force: name of an obstacle, or load0, load1, ... (number of a [[load]] that prescribes motion)"},
    {.path = "specimen.axis", .kind = Kind::text, .words = {"x", "y"}, .standard = "\"y\"", .doc = "direction of the test"},
    {.path = "specimen.height", .kind = Kind::number, .unit = "m", .range = positive, .otherwise = "that of the body",
     .doc = "along the axis: diameter of a disc, height of a beam (of the ligament above a notch)"},
    {.path = "specimen.width", .kind = Kind::number, .unit = "m", .range = positive, .otherwise = "that of the body", .doc = "across"},
    {.path = "specimen.span", .kind = Kind::number, .unit = "m", .range = positive, .required = true, .when = "test=bending", .doc = "between the supports"},
    {.path = "specimen.axial", .kind = Kind::text, .form = Form::list, .otherwise = "the travel of what gives the force, over the height (the other end stands still)",
     .doc = "the two ends of the axial gauge, each a boundary (mean along it), a probe, an obstacle or a load"},
    {.path = "specimen.lateral", .kind = Kind::text, .form = Form::list, .when = "test=compression or tension",
     .doc = "the two ends of the lateral gauge, likewise; none: no Poisson's ratio, no volumetric strain"},
    {.path = "specimen.modulus_between", .kind = Kind::number, .form = Form::pair, .range = {.low = 0, .high = 1}, .standard = "[0.4, 0.6]",
     .doc = "parts of the peak between which modulus and Poisson's ratio are fitted"},

    {.path = "probe[]", .kind = Kind::list, .doc = "a place that is watched; goes to probes.csv"},
    {.path = "probe[].at", .kind = Kind::number, .form = Form::pair, .unit = "m", .required = true, .doc = "where; outside of the body the nearest vertex"},
    {.path = "probe[].watch", .kind = Kind::text, .words = {"place", "interface"}, .standard = "\"place\"",
     .doc = "place: displacement and velocity; interface: opening, slip and cohesion of the nearest one that can break, mean of its points"},
    {.path = "probe[].name", .kind = Kind::text, .otherwise = "probe1, probe2, ...", .doc = "name of its columns"},

    {.path = "figure[]", .kind = Kind::list, .doc = "a picture that the run draws"},
    {.path = "figure[].file", .kind = Kind::text, .required = true, .doc = "file name, .png, .svg or .pdf; with several times the time is put into it"},
    {.path = "figure[].show", .kind = Kind::text, .words = figure_subjects(), .standard = "\"cracks\"", .doc = "what it shows"},
    {.path = "figure[].at", .kind = Kind::number, .form = Form::one_or_list, .unit = "s", .range = not_negative, .otherwise = "time.end", .doc = "times"},
    {.path = "figure[].colour", .kind = Kind::text, .words = figure_colours(), .standard = "\"opening\"", .doc = "what colours the cracks"},
    {.path = "figure[].deform", .kind = Kind::number, .range = not_negative, .standard = "1", .doc = "exaggeration of the displacement"},
    {.path = "figure[].box", .kind = Kind::number, .form = Form::box, .unit = "m", .otherwise = "the whole body", .doc = "the part that is shown"},
    {.path = "figure[].range", .kind = Kind::number, .form = Form::pair, .unit = "*", .otherwise = "from the data", .doc = "colour range, in the unit of what is shown"},
    {.path = "figure[].width", .kind = Kind::integer, .range = {.low = 200, .high = 20000}, .standard = "1600", .doc = "width in pixels"},
    {.path = "figure[].title", .kind = Kind::text, .standard = "\"\"", .doc = "title above the picture"},

    {.path = "expect", .kind = Kind::names, .doc = "what the run must find, by number of its summary: a bound, or value and within"},
    {.path = "expect.*", .kind = Kind::table, .words = summary_names(), .doc = "bounds on one number"},
    {.path = "expect.*.below", .kind = Kind::number, .unit = "*", .doc = "less than this; a speed may be a multiple of the Rayleigh speed, \"0.65 cR\""},
    {.path = "expect.*.above", .kind = Kind::number, .unit = "*", .doc = "more than this"},
    {.path = "expect.*.at_least", .kind = Kind::number, .unit = "*", .doc = "this or more"},
    {.path = "expect.*.at_most", .kind = Kind::number, .unit = "*", .doc = "this or less"},
    {.path = "expect.*.value", .kind = Kind::number, .unit = "*", .doc = "this, up to `within`"},
    {.path = "expect.*.within", .kind = Kind::number, .unit = "*", .range = not_negative, .doc = "allowed deviation from `value`, or relative: \"2 %\""},

    {.path = "sweep", .kind = Kind::table, .doc = "what `knap sweep` varies: all combinations"},
    {.path = "sweep.set", .kind = Kind::text, .form = Form::list, .doc = "KEY=VALUE,VALUE,... as with its --set; commas in quotes and brackets are part of a value"},
    {.path = "sweep.seeds", .kind = Kind::integer, .range = {.low = 1, .high = 100000}, .doc = "every combination is run with this many seeds, from `seed` on"},
    {.path = "sweep.quantities", .kind = Kind::text, .form = Form::list, .words = summary_names(),
     .otherwise = "with a specimen peak_stress and tangent_modulus, broken_length, dissipated, fragments", .doc = "numbers of the summary in the table"},
    {.path = "sweep.show", .kind = Kind::text, .words = figure_subjects(), .standard = "\"cracks\"", .doc = "what the contact sheet shows of every run"},

    {.path = "study", .kind = Kind::table, .doc = "what `knap study` varies and compares"},
    {.path = "study.refine", .kind = Kind::text, .words = {"step", "mesh", "both"}, .otherwise = "step",
     .doc = "what a level divides: time.step, the sizes of [mesh], or both; a step in CFL or auto follows the mesh by itself"},
    {.path = "study.levels", .kind = Kind::number, .form = Form::list, .range = positive, .otherwise = "[1, 2, 4, 8], with seeds [1]",
     .doc = "the divisors: 4 is a quarter of the step, 0.5 twice the step"},
    {.path = "study.seeds", .kind = Kind::integer, .range = {.low = 2, .high = 10000},
     .doc = "statistics: every level is run with this many seeds, from `seed` on"},
    {.path = "study.schemes", .kind = Kind::text, .form = Form::list,
     .words = {"all", "explicit/explicit", "explicit/implicit", "implicit/explicit", "implicit/implicit"}, .otherwise = "the scenario's own",
     .doc = "pairs bulk/cohesion, a line of the diagram each; or line"},
    {.path = "study.reference", .kind = Kind::text, .words = {"auto", "finest"}, .otherwise = "auto",
     .doc = "what errors are taken from; auto: exact, else the value in [expect], else the finest run of the first line"},
    {.path = "study.set", .kind = Kind::text, .form = Form::list, .doc = "KEY=VALUE in all runs, as with --set; \"KEY=\" leaves a key out"},
    {.path = "study.line[]", .kind = Kind::list, .doc = "a line of the diagram: a variant of the scenario"},
    {.path = "study.line[].name", .kind = Kind::text, .otherwise = "its scheme", .doc = "what the key says"},
    {.path = "study.line[].set", .kind = Kind::text, .form = Form::list, .doc = "KEY=VALUE in its runs"},
    {.path = "study.line[].levels", .kind = Kind::number, .form = Form::list, .range = positive, .otherwise = "study.levels", .doc = "its divisors"},
    {.path = "study.quantity[]", .kind = Kind::list,
     .doc = "a number that is compared; without one those with a value in [expect], or external_work, dissipated, strain_energy and kinetic_energy"},
    {.path = "study.quantity[].of", .kind = Kind::text, .required = true,
     .doc = "a number of the summary, or a column of energy.csv, cracks.csv, reactions.csv, probes.csv or stress_strain.csv: its value at the end"},
    {.path = "study.quantity[].at", .kind = Kind::number, .unit = "s", .range = not_negative, .doc = "the column's value at this time"},
    {.path = "study.quantity[].reaches", .kind = Kind::number, .unit = "*", .doc = "the time when the column first reaches this"},
    {.path = "study.quantity[].since", .kind = Kind::text,
     .doc = "another column: the time since that one reached the same; between two probes it is the speed of what runs by"},
    {.path = "study.quantity[].largest", .kind = Kind::boolean, .otherwise = "false", .doc = "the column's largest value"},
    {.path = "study.quantity[].slope", .kind = Kind::number, .form = Form::pair, .unit = "s", .range = not_negative,
     .doc = "between these two times: slope of the line of least squares through the column; of surface it is the crack's speed times G_c, free of the edges it jumps"},
    {.path = "study.quantity[].exact", .kind = Kind::number, .unit = "*", .doc = "what it should be"},
    {.path = "study.quantity[].scale", .kind = Kind::number, .unit = "*", .range = positive, .otherwise = "the reference, absolute if that is 0",
     .doc = "errors are parts of this"},
    {.path = "study.quantity[].name", .kind = Kind::text, .otherwise = "from the rest", .doc = "title of its table and figures"},
    };
    return rows;
}
// clang-format on

}  // namespace

bool Range::contains(double value) const {
    return (low_included ? value >= low : value > low) && (high_included ? value <= high : value < high);
}

std::string Range::text() const {
    const bool has_low = low > -std::numeric_limits<double>::infinity(), has_high = high < std::numeric_limits<double>::infinity();
    std::string text;
    if (has_low) text += (low_included ? "at least " : "greater than ") + shortest(low);
    if (has_low && has_high) text += " and ";
    if (has_high) text += (high_included ? "at most " : "less than ") + shortest(high);
    return text;
}

std::string_view Key::name() const {
    std::string_view name = path.substr(path.rfind('.') + 1);
    if (name.ends_with("[]")) name.remove_suffix(2);
    return name;
}

std::string_view Key::parent() const {
    const std::size_t dot = path.rfind('.');
    return dot == std::string_view::npos ? std::string_view() : path.substr(0, dot);
}

std::span<const Key> keys() { return table(); }

const Key* find_key(std::string_view pattern) {
    for (const Key& key : keys())
        if (key.path == pattern) return &key;
    return nullptr;
}

std::vector<const Key*> keys_below(std::string_view pattern) {
    std::vector<const Key*> below;
    for (const Key& key : keys())
        if (key.parent() == pattern) below.push_back(&key);
    return below;
}

std::string pattern_of(std::string_view path) {
    std::string pattern;
    while (!path.empty()) {
        const std::size_t dot = path.find('.');
        std::string part(path.substr(0, dot));
        path.remove_prefix(dot == std::string_view::npos ? path.size() : dot + 1);
        if (const std::size_t bracket = part.find('['); bracket != std::string::npos) part = part.substr(0, bracket) + "[]";
        const Key* parent = find_key(pattern);
        if (parent && parent->kind == Kind::names) part = "*";
        pattern += (pattern.empty() ? "" : ".") + part;
    }
    return pattern;
}

}  // namespace knap
