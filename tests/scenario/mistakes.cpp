// Every kind of mistake, with the exact place of the marks.
#include "scenario/write_scenario.hpp"

#include "samples.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace mistakes_test {

using namespace knap;
using samples::changed;
using samples::least;
using samples::mistakes;

namespace {

struct Case {
    const char* name;
    std::string text;
    const char* code;
    int line, column, length;
    const char* excerpt;  // in message, hint or note
};

std::string with(const std::string& more) { return least + more; }  // `more` begins in line 16

const std::string load = "[[load]]\non = \"top\"\n";  // lines 16, 17

const std::string plane = "[[obstacle]]\nshape = \"half plane\"\nat = [0, -1]\nnormal = [0, 1]\n";  // lines 16 to 19
const std::string disc = "[[obstacle]]\nshape = \"disc\"\ncentre = [0, -1]\nradius = 0.5\n";        // likewise

const std::string driven = "[[load]]\non = \"top\"\nvelocity = [0, 1]\n";                     // lines 16 to 18
const std::string specimen = driven + "[specimen]\ntest = \"tension\"\nforce = \"load0\"\n";  // lines 19 to 21

const std::string layered = changed("nu = 0.2", "nu = 0.2\nbedding = { E = 1e9, nu = 0.1 }");

const std::string heat = "[heat]\ntemperature = \"20\"\n";  // lines 16, 17

/// Of the mesh, with one refined place.
std::string refined(const std::string& place) { return with("[[mesh.refine]]\n" + place); }  // line 17

const Case cases[] = {
    {"a law of one material by its name", with("[interface.glass]\nsigma_c = 1e6\nG_c = 1\n"), "unknown-name", 16, 12,
     5, "did you mean `glass-glass`?"},
    {"a refined place without a place", refined("size = 0.001\n"), "missing-key", 16, 1, 15,
     "exactly one of: inside, along"},
    {"a refined place that is a box and a strip",
     refined("inside = [0, 0, 1, 1]\nalong = [[0, 0], [1, 1]]\nwidth = 0.1\nsize = 0.1\n"), "exclusive-keys", 18, 1, 5,
     "exactly one of: inside, along"},
    {"a strip without a width", refined("along = [[0, 0], [1, 1]]\nsize = 0.1\n"), "missing-key", 16, 1, 15,
     "width of the strip"},
    {"a box with a width", refined("inside = [0, 0, 1, 1]\nwidth = 0.1\nsize = 0.1\n"), "exclusive-keys", 18, 1, 5,
     "corners in `inside` only"},
    {"a strip along a point", refined("along = [[0, 0]]\nwidth = 0.1\nsize = 0.1\n"), "out-of-range", 17, 9, 8,
     "needs at least 2 points"},
    {"a temperature that is no formula", with("[heat]\ntemperature = \"20 + z\"\n"), "bad-formula", 17, 15, 8,
     "unknown at `z`"},
    {"temperatures from a file that is not there", with("[heat]\ntemperature = \"T.csv\"\n"), "missing-file", 17, 15, 7,
     "relative to"},
    {"an exchange of heat without conduction", with(heat + "[[heat.exchange]]\non = \"top\"\nflux = 1\n"),
     "exclusive-keys", 18, 8, 8, "conduction = true"},
    {"conduction without conductivity",
     changed("nu = 0.2\n", "nu = 0.2\nheat_capacity = 900\n", with(heat + "conduction = true\n")), "missing-key", 7, 1,
     16, "conductivity"},
    {"a capacity over temperature that is not positive",
     changed("nu = 0.2\n", "nu = 0.2\nheat_capacity_table = [[0, 900], [9, 0]]\nconductivity = 1\n",
             with(heat + "conduction = true\n")),
     "out-of-range", 11, 23, 18, "not positive"},
    {"two capacities",
     changed("nu = 0.2\n", "nu = 0.2\nheat_capacity_table = [[0, 900], [9, 9]]\nheat_capacity = 1\n", with(heat)),
     "exclusive-keys", 11, 1, 19, "exactly one of"},
    {"convection without a coefficient",
     changed("nu = 0.2\n", "nu = 0.2\nheat_capacity = 900\nconductivity = 1\n",
             with(heat + "conduction = true\n[[heat.exchange]]\non = \"top\"\noutside = 20\n")),
     "missing-key", 23, 11, 2, "transfer"},
    {"frozen temperatures without another run", with("[heat]\ntemperature = \"frozen\"\n"), "exclusive-keys", 17, 1, 11,
     "time.start"},
    {"temperatures in C and in K", with("[heat]\ntemperature = \"20 C\"\nreference = \"293 K\"\n"),
     "mixed-temperatures", 18, 13, 7, "all of them in C, or all in K"},
    {"a temperature below absolute zero", with("[heat]\ntemperature = \"-300 C\"\n"), "out-of-range", 17, 15, 8, ""},
    {"a reference below absolute zero", with("[heat]\ntemperature = \"20 C\"\nreference = -300\n"), "out-of-range", 18,
     13, 4, ""},
    {"a freezing range that counts from another zero",
     changed("nu = 0.2\n", "nu = 0.2\nlatent_heat = 1000\n", with("[heat]\ntemperature = \"260 K\"\n")), "missing-key",
     11, 15, 4, "272.15 K"},
    {"measured points without a source", with("[[figure]]\nfile = \"a.png\"\nmeasured = [[0, 0]]\n"), "missing-key", 18,
     12, 8, "measured_by"},
    {"measured points in a rose",
     with("[[figure]]\nfile = \"a.png\"\nshow = \"rose\"\nmeasured = [[0, 0]]\nmeasured_by = \"B\"\n"),
     "exclusive-keys", 19, 1, 8, "curves over two axes"},
    {"a mark in a figure of cracks", with("[[figure]]\nfile = \"a.png\"\nmark = 1\n"), "exclusive-keys", 18, 1, 4,
     "temperature"},
    {"a strength over temperature without heat", changed("G_c = 3", "G_c = 3\nstrength_table = [[-10, 1], [0, 0.1]]"),
     "no-heat", 14, 18, 20, "[heat]"},
    {"a strength above that of the law",
     changed("G_c = 3", "G_c = 3\nstrength_table = [[-10, 1], [0, 1.5]]", with(heat)), "out-of-range", 14, 18, 20,
     "strongest state"},
    {"temperatures that do not ascend", changed("G_c = 3", "G_c = 3\nfriction_table = [[0, 1], [0, 1]]", with(heat)),
     "out-of-range", 14, 18, 16, "ascend"},
    {"a parameter of another softening beside the default", changed("G_c = 3", "G_c = 3\nplateau = 0.3"),
     "exclusive-keys", 14, 1, 7, "here softening = \"linear\", its default"},
    {"an expected number without a bound", with("[expect]\nfragments = 2\n"), "wrong-type", 17, 13, 1, ""},
    {"a place of a probe that watches a stress", with("[[probe]]\nname = \"p\"\nwatch = \"stress\"\nat = [0.5, 0.5]\n"),
     "exclusive-keys", 19, 1, 2, "here watch = \"stress\", which has `box`"},
    {"a box of a probe that watches a place", with("[[probe]]\nname = \"p\"\nat = [0.5, 0.5]\nbox = [0, 0, 1, 1]\n"),
     "exclusive-keys", 19, 1, 3, "here watch = \"place\", its default"},
    {"friction and a table of it",
     changed("G_c = 3", "G_c = 3\nfriction = 0.5\nfriction_table = [[0, 1], [1, 1]]", with(heat)), "exclusive-keys", 15,
     1, 14, "exactly one of: friction, friction_table, friction_over_pressure, friction_csv"},
    {"a thermal strain with one point", changed("nu = 0.2\n", "nu = 0.2\nexpansion_table = [[0, 1]]\n", with(heat)),
     "out-of-range", 11, 19, 8, "expansion_table = [[0, 0], [570, 0.008]"},
    {"a pressure with one point", with(heat + "[[pressure]]\npressure_table = [[0, 1]]\n"), "out-of-range", 19, 18, 8,
     "pressure_table = [[-5, 5e6], [0, 0]]"},
    {"two pressures of one fluid", with(heat + "[[pressure]]\npressure = 1\npressure_table = [[0, 1], [1, 1]]\n"),
     "exclusive-keys", 20, 1, 14, "exactly one of"},
    {"a freezing range that falls", changed("nu = 0.2\n", "nu = 0.2\nfreezing_range = [0, -1]\n", with(heat)),
     "out-of-range", 11, 18, 7, "ascend"},
    {"a sweep for nothing known", with("[sweep]\nquantities = [\"broken_lenght\"]\n"), "unknown-word", 17, 15, 15,
     "did you mean `broken_length`?"},
    {"a sweep without seeds", with("[sweep]\nseeds = 0\n"), "out-of-range", 17, 9, 1, "at least 1"},
    {"a specimen without a test", with(driven + "[specimen]\nforce = \"load0\"\n"), "missing-key", 19, 1, 10,
     "`specimen.test` is missing"},
    {"a specimen that nothing drives", with("[specimen]\ntest = \"tension\"\nforce = \"load0\"\n"), "unknown-name", 18,
     9, 7, "there is none"},
    {"a specimen driven by another", with(driven + "[specimen]\ntest = \"tension\"\nforce = \"load1\"\n"),
     "unknown-name", 21, 9, 7, "did you mean `load0`?"},
    {"a gauge with one end", with(specimen + "axial = [\"top\"]\n"), "wrong-type", 22, 9, 7,
     "ends of the axial gauge: two boundaries"},
    {"a gauge at nothing", with(specimen + "lateral = [\"left\", \"rigth\"]\n"), "unknown-name", 22, 11, 17,
     "did you mean `right`?"},
    {"a beam without a span", with(driven + "[specimen]\ntest = \"bending\"\nforce = \"load0\"\n"), "missing-key", 19,
     1, 10, "span"},
    {"a modulus between nothing", with(specimen + "modulus_between = [0.6, 0.4]\n"), "out-of-range", 22, 19, 10,
     "does not ascend"},
    {"stress and strain without a specimen", with("[[figure]]\nfile = \"a.png\"\nshow = \"stress_strain\"\n"),
     "nothing-to-show", 18, 8, 15, "add a [specimen]"},
    {"a specimen without breaks", with(specimen + "[output]\nbreaks = false\n"), "exclusive-keys", 23, 1, 6,
     "needs it"},
    {"a strength without a specimen", with("[expect]\npeak_stress = { above = 1 }\n"), "nothing-to-expect", 17, 15, 13,
     "a [specimen]"},
    {"a ratio without a gauge", with(specimen + "[expect]\npoisson_ratio = { above = 0.1 }\n"), "nothing-to-expect", 23,
     17, 15, "lateral gauge"},
    {"an obstacle of no shape", with("[[obstacle]]\nfriction = 0.1\n"), "missing-key", 16, 1, 12, "obstacle[0].shape"},
    {"a key of another outline", with(plane + "radius = 1\n"), "exclusive-keys", 20, 1, 6, "belongs to shape"},
    {"a normal without direction", with("[[obstacle]]\nshape = \"half plane\"\nat = [0, 0]\nnormal = [0, 0]\n"),
     "out-of-range", 19, 10, 6, "no direction"},
    {"density of a half plane", with(plane + "density = 1\n"), "exclusive-keys", 20, 1, 7, "no volume"},
    {"mass and density", with(disc + "mass = 1\ndensity = 1\n"), "exclusive-keys", 21, 1, 7, "mass and density"},
    {"free without mass", with(plane + "velocity = [0, \"free\"]\n"), "missing-key", 20, 12, 11,
     "free in y, but has no mass"},
    {"a half plane that turns", with(plane + "mass = 1\nturns = true\n"), "missing-key", 21, 9, 4,
     "no moment of inertia"},
    {"turns and spins", with(disc + "mass = 1\nturns = true\nspin = 1\n"), "exclusive-keys", 22, 1, 4,
     "cannot turn freely"},
    {"a force on what is driven", with(plane + "velocity = [0, 1]\nforce = [0, 1]\n"), "exclusive-keys", 21, 1, 5,
     "moves freely"},
    {"two obstacles of one name", with(disc + "name = \"a\"\n" + disc + "name = \"a\"\n"), "duplicate-name", 25, 8, 3,
     "`a` is the name of an obstacle already"},
    {"an obstacle with a strange name", with(disc + "name = \"a,b\"\n"), "bad-name", 20, 8, 5, "letters"},
    {"an outline that is not convex",
     with("[[obstacle]]\nshape = \"polygon\"\npoints = [[0, 0], [2, 0], [1, 0.5], [1, 2]]\n"), "out-of-range", 18, 10,
     34, "no convex polygon"},
    {"misspelt key", changed("sigma_c", "sigmac"), "unknown-key", 12, 1, 6, "did you mean `sigma_c`?"},
    {"misspelt table", changed("[mesh]", "[mehs]"), "unknown-key", 5, 2, 4, "did you mean `mesh`?"},
    {"key of another table", changed("size = 0.001", "size = 0.001\nsafety = 0.5"), "unknown-key", 7, 1, 6,
     "there is `time.safety`"},
    {"key of nothing", with("zzzzzzzz = 1\n"), "unknown-key", 16, 1, 8, "keys here: end, until"},
    {"key of a list", with(load + "traktion = [0, 1]\n"), "unknown-key", 18, 1, 8, "did you mean `traction`?"},
    {"unknown quantity in expect", with("[expect]\nbranch = { below = 1 }\n"), "unknown-key", 17, 1, 6,
     "did you mean `branches`?"},
    {"boolean for a number", changed("32e9", "true"), "wrong-type", 9, 5, 4, "must be a pressure [Pa], not true"},
    {"number for a text", changed("\"rectangle\"", "3"), "wrong-type", 3, 9, 1, "one of rectangle, polygon, disc"},
    {"number for a whole number", changed("knap = 1", "knap = 1.5"), "wrong-type", 1, 8, 3, "a whole number"},
    {"text for a boolean", with("[output]\nfields = \"yes\"\n"), "wrong-type", 17, 10, 5, "true or false"},
    {"one number for two", changed("[0.1, 0.04]", "0.1"), "wrong-type", 4, 8, 3, "two values"},
    {"three numbers for two", changed("[0.1, 0.04]", "[0.1, 0.04, 1]"), "wrong-type", 4, 8, 14, "a list of 3"},
    {"empty list", with("[[figure]]\nfile = \"a.png\"\nat = []\n"), "wrong-type", 18, 6, 2, "a list of 0"},
    {"a date", changed("80e-6", "2020-01-01"), "wrong-type", 15, 7, 10, "a date"},
    {"a table for a list of tables", with("[load]\non = \"top\"\n"), "wrong-type", 16, 1, 6, "write [[load]]"},
    {"a value for a table", changed("[mesh]\nsize = 0.001\n", "", changed("knap = 1", "knap = 1\nmesh = 3")),
     "wrong-type", 2, 8, 1, "must be a table"},
    {"flat points", with("[[domain.crack]]\npoints = [0, 1]\n"), "wrong-type", 17, 10, 6, "a list of pairs"},
    {"one flat point", with("[[domain.crack]]\npoints = [[0, 0], 1]\n"), "wrong-type", 17, 19, 1, "a list of pairs"},
    {"wrong unit", changed("32e9", "\"32 mm\""), "wrong-unit", 9, 5, 7,
     "must be a pressure [Pa], and \"32 mm\" is a length"},
    {"wrong unit in a list", changed("0.04]", "\"3 J/m2\"]"), "wrong-unit", 4, 14, 8,
     "must be a length [m], and \"3 J/m2\" is an energy per area"},
    {"no unit", changed("0.001", "\"0.001\""), "wrong-unit", 6, 8, 7, "has no unit"},
    {"unknown unit", changed("0.001", "\"1 inch\""), "wrong-unit", 6, 8, 8, "unknown unit `inch`"},
    {"decimal comma", changed("0.001", "\"0,5 mm\""), "wrong-unit", 6, 8, 8, "comma"},
    {"cR where it has no place", changed("80e-6", "\"1 cR\""), "wrong-unit", 15, 7, 6,
     "multiple of the Rayleigh speed"},
    {"cR for a work", with("[expect]\ndissipated = { below = \"1 cR\" }\n"), "wrong-unit", 17, 24, 6, "an energy"},
    {"cR and SI", with("[expect]\nmax_tip_speed = { below = \"1 cR\", above = 1 }\n"), "wrong-unit", 17, 17, 29,
     "mixes"},
    {"stress range of a velocity", with("[[figure]]\nfile = \"a.png\"\nshow = \"speed\"\nrange = [0, \"1 Pa\"]\n"),
     "wrong-unit", 19, 13, 6, "a speed"},
    {"not positive", changed("0.001", "0"), "out-of-range", 6, 8, 1, "greater than 0, not 0 m"},
    {"not negative", changed("2450", "-2450"), "out-of-range", 8, 11, 5, "greater than 0"},
    {"above the range", changed("0.2", "0.5"), "out-of-range", 10, 6, 3, "less than 0.5, not 0.5"},
    {"not a number", changed("32e9", "nan"), "out-of-range", 9, 5, 3, "finite"},
    {"infinite", changed("32e9", "inf"), "out-of-range", 9, 5, 3, "finite"},
    {"box without area", with("[[initial]]\nvelocity = [0, 0]\nbox = [1, 0, 0, 1]\n"), "out-of-range", 18, 7, 12,
     "no area"},
    {"times descend", with(load + "traction = [0, 1]\ntable = [[1, 0], [0, 1]]\n"), "out-of-range", 19, 9, 16,
     "do not ascend"},
    {"range descends", with("[[figure]]\nfile = \"a.png\"\nrange = [1, 0]\n"), "out-of-range", 18, 9, 6,
     "does not ascend"},
    {"polygon with two corners",
     changed("shape = \"rectangle\"\nsize = [0.1, 0.04]", "shape = \"polygon\"\npoints = [[0, 0], [1, 0]]"),
     "out-of-range", 4, 10, 16, "at least 3 points"},
    {"names for other sides",
     changed("shape = \"rectangle\"\nsize = [0.1, 0.04]",
             "shape = \"polygon\"\npoints = [[0, 0], [1, 0], [1, 1]]\nsides = [\"a\"]"),
     "out-of-range", 5, 9, 5, "1 names for 3 sides"},
    {"crack with one point", with("[[domain.crack]]\npoints = [[0, 1]]\n"), "out-of-range", 17, 10, 8,
     "at least 2 points"},
    {"a hole of a million sides", with("[[domain.hole]]\ncentre = [0, 0]\nradius = 1e9\n"), "out-of-range", 18, 10, 3,
     "too large"},
    {"missing key", changed("nu = 0.2\n", ""), "missing-key", 7, 1, 16, "`material.glass.nu` is missing"},
    {"missing key in a list", with("[[figure]]\nshow = \"energy\"\n"), "missing-key", 16, 1, 10,
     "`figure[0].file` is missing"},
    {"missing table", changed("[time]\nend = 80e-6\n", ""), "missing-key", 0, 0, 0, "`time` is missing"},
    {"missing version", changed("knap = 1\n", ""), "missing-key", 0, 0, 0, "`knap` is missing"},
    {"missing strength", changed("sigma_c = 3.08e6\nG_c = 3\n", ""), "missing-key", 11, 1, 19, "breakable = false"},
    {"missing fracture energy", changed("G_c = 3\n", ""), "missing-key", 11, 1, 19, "exactly one of: G_c, delta_c"},
    {"missing law", changed("interface.default", "interface.glass-glas"), "unknown-name", 11, 12, 10,
     "did you mean `glass-glass`?"},
    {"no kind of load", with(load), "missing-key", 16, 1, 8, "none of traction"},
    {"load without a place", with("[[load]]\ntraction = [0, 1]\n"), "missing-key", 16, 1, 8,
     "boundaries: bottom, right, top, left"},
    {"centre without radius", with("[[domain.hole]]\npoints = [[0, 0], [1, 0], [0, 1]]\ncentre = [0, 0]\n"),
     "missing-key", 18, 10, 6, "belong together"},
    {"value without within", with("[expect]\nfragments = { value = 1 }\n"), "missing-key", 17, 13, 13,
     "value and within"},
    {"expects nothing", with("[expect]\nfragments = {}\n"), "missing-key", 17, 13, 2, "expects nothing"},
    {"both of two keys", changed("G_c = 3", "G_c = 3\ndelta_c = 1e-6"), "exclusive-keys", 14, 1, 7, "G_c and delta_c"},
    {"two kinds of load", with(load + "traction = [0, 1]\nvelocity = [0, 1]\n"), "exclusive-keys", 19, 1, 8,
     "traction and velocity"},
    {"two histories", with(load + "traction = [0, 1]\nramp = 1\ntable = [[0, 1]]\n"), "exclusive-keys", 20, 1, 5,
     "ramp and table"},
    {"key of another shape", changed("size = [0.1, 0.04]", "size = [0.1, 0.04]\nradius = 1"), "exclusive-keys", 5, 1, 6,
     "belongs to shape = \"disc\""},
    {"gravity on a boundary", with(load + "acceleration = [0, 1]\n"), "exclusive-keys", 17, 1, 2, "acts in the body"},
    {"both components free", with(load + "velocity = [\"free\", \"free\"]\n"), "exclusive-keys", 18, 1, 8,
     "prescribes nothing"},
    {"energy without strength", changed("3.08e6", "0"), "exclusive-keys", 13, 1, 3, "no strength"},
    {"glued across a gap", with("[[support]]\non = \"bottom\"\nglued = true\ngap = 1e-6\n"), "exclusive-keys", 19, 1, 3,
     "glued = false"},
    {"glued by nothing",
     with("[interface.floor]\nsigma_c = 0\n[[support]]\non = \"bottom\"\ninterface = \"floor\"\nglued = true\n"),
     "exclusive-keys", 21, 1, 5, "no strength"},
    {"unknown word", changed("rectangle", "rectangl"), "unknown-word", 3, 9, 10, "did you mean `rectangle`?"},
    {"unknown word for a number", changed("[time]", "[time]\nstep = \"atuo\""), "wrong-unit", 15, 8, 6,
     "did you mean `auto`?"},
    {"unknown component", with(load + "velocity = [0, \"fre\"]\n"), "wrong-unit", 18, 16, 5, "did you mean `free`?"},
    {"unknown figure", with("[[figure]]\nfile = \"a.png\"\nshow = \"craks\"\n"), "unknown-word", 18, 8, 7,
     "did you mean `cracks`?"},
    {"unknown boundary", with("[[load]]\non = \"topp\"\ntraction = [0, 1]\n"), "unknown-name", 17, 6, 6,
     "known: bottom, right, top, left"},
    {"unknown boundary in a table",
     with("[[load]]\non = { boundary = \"topp\", box = [0, 0, 1, 1] }\ntraction = [0, 1]\n"), "unknown-name", 17, 19, 6,
     "did you mean `top`?"},
    {"unknown material", with("[[domain.region]]\nbox = [0, 0, 1, 1]\nmaterial = \"glas\"\n"), "unknown-name", 18, 12,
     6, "did you mean `glass`?"},
    {"unknown law", with("[[support]]\non = \"bottom\"\ninterface = \"flor\"\n"), "unknown-name", 18, 13, 6,
     "known: default"},
    {"law of nobody", with("[interface.floor]\nsigma_c = 0\n"), "unknown-name", 16, 12, 5,
     "no pair of materials and no support"},
    {"two laws of a pair",
     with("[material.b]\ndensity = 1\nE = 1\nnu = 0\n[interface.glass-b]\nsigma_c = 0\n[interface.b-glass]\nsigma_c = "
          "0\n"),
     "duplicate-name", 22, 12, 7, "second law"},
    {"reactions of nothing driven", with("[[figure]]\nfile = \"a.png\"\nshow = \"reactions\"\n"), "nothing-to-show", 18,
     8, 11, "no load prescribes a motion"},
    {"probes without one", with("[[figure]]\nfile = \"a.png\"\nshow = \"probes\"\n"), "nothing-to-show", 18, 8, 8,
     "there is none"},
    {"two probes of a name", with("[[probe]]\nat = [0, 0]\nname = \"p\"\n[[probe]]\nat = [0, 0]\nname = \"p\"\n"),
     "duplicate-name", 21, 8, 3, "`p` is the name of a probe already"},
    {"collector without a line", with("[[collector]]\nname = \"net\"\n"), "missing-key", 16, 1, 13,
     "either from and to"},
    {"collector with one end", with("[[collector]]\nfrom = [0, 0]\n"), "missing-key", 16, 1, 13, "either from and to"},
    {"collector that is two lines", with("[[collector]]\nfrom = [0, 0]\nto = [0, 1]\nx = 1\n"), "exclusive-keys", 19, 1,
     1, "a vertical without ends"},
    {"collector without a length", with("[[collector]]\nfrom = [0, 1]\nto = [0, 1]\n"), "out-of-range", 18, 6, 6,
     "has no length"},
    {"two collectors of a name", with("[[collector]]\nx = 0\nname = \"n\"\n[[collector]]\nx = 1\nname = \"n\"\n"),
     "duplicate-name", 21, 8, 3, "`n` is the name of a collector already"},
    {"collector and probe of a name",
     with("[[probe]]\nat = [0, 0]\nname = \"n\"\n[[collector]]\nx = 1\nname = \"n\"\n"), "duplicate-name", 21, 8, 3,
     "`n` is the name of a probe already"},
    {"number of no collector", with("[[collector]]\nx = 0\nname = \"net\"\n[expect.nets_energy_95]\nbelow = 1\n"),
     "unknown-name", 19, 9, 14, "there is no collector `nets`"},
    {"two figures of a name", with("[[figure]]\nfile = \"a.png\"\n[[figure]]\nfile = \"a.png\"\n"), "duplicate-name",
     19, 8, 7, "another figure"},
    {"figure in another directory", with("[[figure]]\nfile = \"../a.png\"\n"), "bad-name", 17, 8, 10, "a plain name"},
    {"figure of another type", with("[[figure]]\nfile = \"a.bmp\"\n"), "unknown-word", 17, 8, 7, "allowed: *.png"},
    {"animation of curves", with("[[figure]]\nfile = \"a.webp\"\nshow = \"energy\"\n"), "exclusive-keys", 17, 1, 4,
     "curves = \"energy\""},
    {"animation at times", with("[[figure]]\nfile = \"a.webp\"\nat = 1e-6\n"), "exclusive-keys", 18, 1, 2, "every"},
    {"animation of too many pictures", with("[[figure]]\nfile = \"a.webp\"\nevery = 1e-12\n"), "out-of-range", 18, 9, 5,
     "5000"},
    {"picture with a speed", with("[[figure]]\nfile = \"a.png\"\nspeed = 1\n"), "exclusive-keys", 18, 1, 5, ".webp"},
    {"material with a dash", with("[material.a-b]\ndensity = 1\nE = 1\nnu = 0\n"), "bad-name", 16, 11, 3, "use _"},
    {"name with a slash", changed("knap = 1", "knap = 1\nname = \"a/b\""), "bad-name", 2, 8, 5, "run directory"},
    {"name with a dot", with("[material.\"a.b\"]\ndensity = 1\nE = 1\nnu = 0\n"), "bad-name", 16, 11, 5,
     "letters, digits, blanks"},
    {"name with a blank at its end", with("[material.\"a \"]\ndensity = 1\nE = 1\nnu = 0\n"), "bad-name", 16, 11, 4,
     "no blank at either end"},
    {"boundary with a comma",
     changed("shape = \"rectangle\"\nsize = [0.1, 0.04]",
             "shape = \"polygon\"\npoints = [[0, 0], [1, 0], [1, 1]]\nsides = [\"a\", \"b,c\", \"d\"]"),
     "bad-name", 5, 15, 5, "is not allowed as a name"},
    {"probe with a slash", with("[[probe]]\nat = [0, 0]\nname = \"a/b\"\n"), "bad-name", 18, 8, 5,
     "is not allowed as a name"},
    {"a law without a name",
     changed("interface.default", "interface",
             with("[interface.floor]\nsigma_c = 0\n[[support]]\non = \"bottom\"\ninterface = \"default\"\n")),
     "missing-name", 11, 2, 9, "write [interface.default]"},
    {"a material without a name", changed("material.glass", "material"), "missing-name", 7, 2, 8,
     "write [material.NAME]"},
    {"a unit in the wrong case", changed("32e9", "\"32 Gpa\""), "wrong-unit", 9, 5, 8, "did you mean `GPa`?"},
    {"a unit in small letters", changed("32e9", "\"32 mpa\""), "wrong-unit", 9, 5, 8, "did you mean `MPa`?"},
    {"a unit as a word", changed("80e-6", "\"80 microns\""), "wrong-unit", 15, 7, 12, "did you mean `um`?"},
    {"softening without a table", changed("G_c = 3", "G_c = 3\nsoftening = \"table\""), "missing-key", 11, 1, 19,
     "exactly one of: table, csv"},
    {"a parameter of another softening", changed("G_c = 3", "G_c = 3\nsoftening = \"power\"\nplateau = 0.5"),
     "exclusive-keys", 15, 1, 7, "softening = \"trapezoid\""},
    {"a traction that grows", changed("G_c = 3", "G_c = 3\nsoftening = \"table\"\ntable = [[0, 1], [1, 2], [2, 0]]"),
     "out-of-range", 15, 9, 24, "opening 0"},
    {"delayed softening that drops",
     changed("G_c = 3", "G_c = 3\nsoftening = \"trapezoid\"\nplateau = 1\nrelaxation_time = \"1 us\""),
     "exclusive-keys", 16, 1, 15, "plateau = 0.9"},
    {"delay without strength", changed("sigma_c = 3.08e6\nG_c = 3", "sigma_c = 0\nrelaxation_time = 1e-6"),
     "exclusive-keys", 13, 1, 15, "no strength"},
    {"incubation in implicit steps",
     changed("G_c = 3", "G_c = 3\nincubation_time = 1e-6", with("bulk = \"implicit\"\n")), "exclusive-keys", 14, 1, 15,
     "longer than the overload lasts"},
    {"slip energy without slip", changed("G_c = 3", "G_c = 3\nG_II = 9\ngamma = 0"), "out-of-range", 14, 8, 1,
     "slip does none"},
    {"slip energy without strength", changed("sigma_c = 3.08e6\nG_c = 3", "sigma_c = 0\nG_II = 9"), "exclusive-keys",
     13, 1, 4, "no strength"},
    {"a mode mix of one energy", changed("G_c = 3", "G_c = 3\nmode_mix = \"power\""), "missing-key", 14, 12, 7,
     "`G_II`"},
    {"layers that give work when they are compressed", changed("nu = 0.2", "nu = 0.2\nbedding = { E = 1e9, nu = 0.5 }"),
     "out-of-range", 11, 27, 3, "do work"},
    {"strength over layers that nobody has", changed("G_c = 3", "G_c = 3\nstrength_over_bedding = [[0, 0.5], [90, 1]]"),
     "missing-key", 14, 25, 19, "bedding"},
    {"strength over an angle of layers beyond 90",
     changed("G_c = 3", "G_c = 3\nstrength_over_bedding = [[0, 0.5], [120, 1]]", layered), "out-of-range", 15, 25, 20,
     "from 0 to 90"},
    {"a facet that is stronger than the strongest one",
     changed("G_c = 3", "G_c = 3\nenergy_over_bedding = [[0, 0.5], [90, 2]]", layered), "out-of-range", 15, 23, 19,
     "strongest facet"},
    {"a slip distance to nowhere", changed("G_c = 3", "G_c = 3\nslip_distance = 1e-3"), "missing-key", 14, 17, 4,
     "`kinetic_friction`"},
    {"friction over pressure that is not concave",
     changed("G_c = 3", "G_c = 3\nfriction_over_pressure = [[0, 0], [1e6, 5e5], [2e6, 2e6]]"), "out-of-range", 14, 26,
     32, "is not concave: its slope grows (pair 3)"},
    {"friction over pressure that falls",
     changed("G_c = 3", "G_c = 3\nfriction_over_pressure = [[0, 0], [1e6, 5e5], [2e6, 2e5]]"), "out-of-range", 14, 26,
     32, "falls with the pressure (pair 3)"},
    {"friction over pressure from a pressure on",
     changed("G_c = 3", "G_c = 3\nfriction_over_pressure = [[1, 0], [1e6, 5e5]]"), "out-of-range", 14, 26, 20,
     "does not start with threshold 0 at pressure 0"},
    {"friction over pressure beside friction",
     changed("G_c = 3", "G_c = 3\nfriction = 0.5\nfriction_over_pressure = [[0, 0], [1e6, 5e5]]"), "exclusive-keys", 15,
     1, 22, "of which only one is allowed"},
    {"friction over pressure in metres",
     changed("G_c = 3", "G_c = 3\nfriction_over_pressure = [[0, 0], [\"1 MPa\", \"5 m\"]]"), "wrong-unit", 14, 45, 5,
     "Pa"},
    {"friction over pressure that also follows the slip",
     changed("G_c = 3",
             "G_c = 3\nfriction_over_pressure = [[0, 0], [1e6, 5e5]]\nkinetic_friction = 0.1\nslip_distance = 1e-3"),
     "exclusive-keys", 16, 1, 13, "over the pressure"},
    {"slip energy of what never breaks", changed("sigma_c = 3.08e6\nG_c = 3", "breakable = false\nG_II = 9"),
     "exclusive-keys", 13, 1, 4, "never breaks"},
    {"slip energy of an implicit norm",
     changed("G_c = 3", "G_c = 3\nG_II = 9\ncoupling = \"norm\"",
             with("bulk = \"implicit\"\ncohesion = \"implicit\"\n")),
     "exclusive-keys", 14, 1, 4, "potential"},
    {"a norm without slip", changed("G_c = 3", "G_c = 3\ncoupling = \"norm\"\ngamma = 0"), "exclusive-keys", 14, 1, 8,
     "gamma = 0.71 or more"},
    {"a norm that drops", changed("G_c = 3", "G_c = 3\nsoftening = \"trapezoid\"\nplateau = 1\ncoupling = \"norm\""),
     "exclusive-keys", 16, 1, 8, "plateau = 0.9"},
    {"a norm beside a sum",
     changed("G_c = 3", "G_c = 3\ncoupling = \"norm\"\n[interface.glass-glass]\nsigma_c = 1e6\nG_c = 3"),
     "exclusive-keys", 14, 1, 8, "the same coupling"},
    {"a norm without strength", changed("sigma_c = 3.08e6\nG_c = 3", "sigma_c = 0\ncoupling = \"norm\""),
     "exclusive-keys", 13, 1, 8, "no strength"},
    {"softening without strength", changed("sigma_c = 3.08e6\nG_c = 3", "sigma_c = 0\nsoftening = \"power\""),
     "exclusive-keys", 13, 1, 9, "no strength"},
    {"softening that drops",
     changed("G_c = 3", "G_c = 3\nsoftening = \"trapezoid\"\nplateau = 1", with("cohesion = \"implicit\"\n")),
     "exclusive-keys", 15, 1, 7, "plateau = 0.9"},
    {"a table that drops",
     changed("G_c = 3", "G_c = 3\nsoftening = \"table\"\ntable = [[0, 1], [1, 1], [1, 0]]",
             with("cohesion = \"implicit\"\n")),
     "exclusive-keys", 15, 1, 5, "a point farther on"},
    {"a unit in a fraction", changed("G_c = 3", "G_c = \"3 Joule/m2\""), "wrong-unit", 13, 7, 12,
     "did you mean `J/m2`?"},
    {"a unit with a raised two", changed("G_c = 3", "G_c = \"3 J/m\u00b2\""), "wrong-unit", 13, 7, 8,
     "did you mean `J/m2`?"},
    {"a density of kilograms", changed("2450", "\"2450 Kg/m^3\""), "wrong-unit", 8, 11, 13, "did you mean `kg/m^3`?"},
    {"an arc of a side that is not there",
     with("[[domain.hole]]\npoints = [[0.02, 0.02], [0.03, 0.02], [0.03, 0.03]]\narcs = [{ side = 4, through = [0.02, "
          "0.03] }]\n"),
     "out-of-range", 18, 18, 1, "there are 3 sides"},
    {"an arc that is straight",
     with("[[domain.hole]]\npoints = [[0.02, 0.02], [0.03, 0.02], [0.03, 0.03]]\narcs = [{ side = 1, through = [0.025, "
          "0.02] }]\n"),
     "out-of-range", 18, 31, 13, "no arc"},
    {"two arcs of one side",
     with("[[domain.hole]]\npoints = [[0.02, 0.02], [0.03, 0.02], [0.03, 0.03]]\narcs = [{ side = 1, through = [0.025, "
          "0.01] }, { side = 1, through = [0.025, 0.011] }]\n"),
     "duplicate-name", 18, 57, 1, "second arc of side 1"},
    {"an arc of a disc",
     with("[[domain.hole]]\ncentre = [0.05, 0.02]\nradius = 0.005\narcs = [{ side = 1, through = [0.025, 0.01] }]\n"),
     "exclusive-keys", 19, 1, 4, "belongs to points"},
    {"an arc of a rectangle",
     changed("size = [0.1, 0.04]", "size = [0.1, 0.04]\narcs = [{ side = 1, through = [0.05, -0.01] }]"),
     "exclusive-keys", 5, 1, 4, "belongs to shape"},
    {"consistent mass without implicit bulk", with("mass = \"consistent\"\n"), "exclusive-keys", 16, 1, 4,
     "needs the implicit bulk"},
    {"excavation without a time", with("[[excavation]]\nbox = [0, 0, 0.01, 0.01]\n"), "missing-key", 16, 1, 14, "at"},
    {"excavation of a round box", with("[[excavation]]\nat = 0\nbox = [0, 0, 0.01, 0.01]\nradius = 1\n"),
     "exclusive-keys", 18, 1, 3, "only one"},
    {"a rest that ends nothing", with("rest_below = 0.1\n"), "exclusive-keys", 16, 1, 10, "belongs to until"},
    {"bulk viscosity of the implicit bulk",
     with("bulk = \"implicit\"\n[material.soft]\ndensity = 1000\nE = 1e9\nnu = 0\nbulk_viscosity = [0.06, 0]\n"),
     "exclusive-keys", 21, 1, 14, "which implicit steps do not resolve"},
    {"shear viscosity of the implicit bulk",
     with("bulk = \"implicit\"\n[material.soft]\ndensity = 1000\nE = 1e9\nnu = 0\nshear_viscosity = 0.1\n"),
     "exclusive-keys", 21, 1, 15, "which implicit steps do not resolve"},
    {"bulk viscosity and an excavation of second order",
     changed("[mesh]", "[mesh]\norder = 2",
             with("[[excavation]]\nat = 0\nbox = [0, 0, 0.01, 0.01]\n[material.soft]\ndensity = 1000\nE = 1e9\nnu = 0\n"
                  "bulk_viscosity = [0.06, 0]\n")),
     "exclusive-keys", 24, 1, 14, "second order"},
    {"damping of a motion without damping", with("damping_of = \"motion\"\n"), "exclusive-keys", 16, 1, 10,
     "belongs to time.damping"},
    {"one-point mass where every edge may break", with("bulk = \"implicit\"\nmass = \"one point\"\n"), "exclusive-keys",
     17, 1, 4, "does not break inside"},
    {"a stress of two", with(load + "stress = [0, 1]\n"), "wrong-type", 18, 10, 6, "three values [a, b, c]"},
    {"pressure and traction", with(load + "pressure = 1\ntraction = [0, 1]\n"), "exclusive-keys", 18, 1, 8,
     "exactly one of: traction, pressure"},
    {"pressure in a length", with(load + "pressure = \"1 m\"\n"), "wrong-unit", 18, 12, 5, "must be a pressure"},
    {"theta for an impact",
     changed("G_c = 3", "G_c = 3\nrestitution = 0.8", with("bulk = \"implicit\"\ntheta = 0.6\n")), "out-of-range", 18,
     9, 3, "0.5555555555555556 of the law `default`"},
    {"theta for the impact of an obstacle", with("bulk = \"implicit\"\ntheta = 0.6\n" + disc + "restitution = 1\n"),
     "out-of-range", 17, 9, 3, "of the obstacle `obstacle1`"},
    {"theta below a half", with("bulk = \"implicit\"\ntheta = 0.4\n"), "out-of-range", 17, 9, 3, "at least 0.5"},
    {"unknown bulk", with("bulk = \"implict\"\n"), "unknown-word", 16, 8, 9, "did you mean `implicit`?"},
    {"unknown mass", with("bulk = \"implicit\"\nmass = \"lump\"\n"), "unknown-word", 17, 8, 6,
     "did you mean `lumped`?"},
    {"unknown start", with("start = \"static\"\n"), "unknown-word", 16, 9, 8, "rest, equilibrium"},
    {"assumption by a truth value", with("assumption_1 = false\n"), "wrong-type", 16, 16, 5, "one of respect, ignore"},
    {"no smallest step", with("bulk = \"implicit\"\nstep_min = 0\n"), "out-of-range", 17, 12, 1, "greater than 0"},
    {"CFL for a time", changed("80e-6", "\"80 CFL\""), "wrong-unit", 15, 7, 8, "a multiple of the stable step"},
    {"step in metres", with("step = \"1 mm\"\n"), "wrong-unit", 16, 8, 6, "a time [s]"},
    {"csv that is not there", with(load + "traction = [0, 1]\ncsv = \"no-such.csv\"\n"), "missing-file", 19, 7, 13,
     "no-such.csv"},
    {"newer format", changed("knap = 1", "knap = 2\nfuture = 3"), "newer-format", 1, 8, 1, "reads up to 1"},
    {"unit without quotes", changed("0.001", "1 mm"), "bad-toml", 6, 10, 1, "text goes into"},
    {"key twice", changed("G_c = 3", "G_c = 3\nG_c = 4"), "bad-toml", 14, 7, 1, "redefine"},
    {"open text", changed("\"rectangle\"", "\"rectangle"), "bad-toml", 3, 19, 1, "string"},
    {"open list", changed("0.04]", "0.04"), "bad-toml", 5, 1, 1, "array"},
    {"empty", "", "empty-file", 0, 0, 0, "has no keys"},
    {"only comments", "# a\n\n  # b\n", "empty-file", 0, 0, 0, "has no keys"},
    {"binary",
     std::string("\x7f"
                 "ELF\0\1\2",
                 7),
     "binary-file", 0, 0, 0, "not a text file"},
    {"not UTF-8", "name = \"\xff\xfe\"\n", "bad-toml", 1, 8, 1, "utf-8"},
    {"behind other letters", changed("knap = 1", "knap = 1\n\ttitle = \"\u00e9\u00e8\" # \u00fc\n\tnmae = 1"),
     "unknown-key", 3, 2, 4, "did you mean `name`?"},
    {"windows lines", "knap = 1\r\nnmae = 1\r\n" + least.substr(9), "unknown-key", 2, 1, 4, "did you mean `name`?"},
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text)
        if (c == '\n') lines.emplace_back();
        else if (c != '\r') lines.back() += c == '\t' ? ' ' : c;
    return lines;
}

}  // namespace

TEST_CASE("mistakes: one of each kind at its place") {
    for (const Case& c : cases) {
        CAPTURE(c.name);
        const std::vector<Diagnostic> found = mistakes(c.text);
        std::string all;
        for (const Diagnostic& d : found) all += format(d);
        CAPTURE(all);
        REQUIRE(found.size() >= 1);
        const auto it = std::find_if(found.begin(), found.end(), [&](const Diagnostic& d) { return d.code == c.code; });
        REQUIRE(it != found.end());
        CHECK(found.size() ==
              (std::string(c.name) == "missing law" ? 2u : 1u));  // a misnamed law leaves its pair without one
        CHECK(it->severity == Diagnostic::Severity::error);
        CHECK(it->file == "sample.toml");
        CHECK(it->line == c.line);
        CHECK(it->column == c.column);
        CHECK(it->length == c.length);
        CHECK((it->message + "\n" + it->hint + "\n" + it->note).find(c.excerpt) != std::string::npos);
        if (c.line > 0) CHECK(it->source_line == lines_of(c.text).at(c.line - 1));
    }
}

TEST_CASE("mistakes: all at once and in the order of the file") {
    std::string text = changed("sigma_c", "sigmac");
    text = changed("0.001", "\"1 s\"", text);
    text = changed("32e9", "true", text);
    text = changed("end = 80e-6", "end = 0", text) + load + "traction = [1]\n[output]\nevery = -1\n";
    std::vector<int> lines;
    for (const Diagnostic& d : mistakes(text)) lines.push_back(d.line);
    CHECK(lines == std::vector<int>{6, 9, 12, 15, 18, 20});
}

TEST_CASE("mistakes: as the user sees them") {
    const std::vector<Diagnostic> found = mistakes(changed("sigma_c", "sigmac "));
    REQUIRE(found.size() == 1);
    CHECK(format(found[0]) ==
          "error[unknown-key]: `interface.default.sigmac` is not a key of a scenario\n"
          "  --> sample.toml:12:1\n"
          "   |\n"
          "12 | sigmac  = 3.08e6\n"
          "   | ^^^^^^ did you mean `sigma_c`?\n"
          "   = keys here: breakable, sigma_c, G_c, delta_c, softening, plateau, exponent, table, csv, coupling, "
          "unloading, "
          "relaxation_time, incubation_time, gamma, G_II, mode_mix, mix_exponent, "
          "strength_table, friction_table, friction_over_pressure, friction_csv, strength_over_bedding, "
          "energy_over_bedding, friction, restitution, kinetic_friction, slip_distance, scatter\n");
}

TEST_CASE("mistakes: very many in one line and very long ones are short messages") {
    std::string points;
    for (int i = 0; i < 5000; ++i) points += "[" + std::to_string(i) + ", \"é\"], ";
    const std::vector<Diagnostic> many =
        mistakes("knap = 1\n[domain]\nshape = \"polygon\"\npoints = [" + points + "]\n");
    REQUIRE(many.size() > 5000);
    std::size_t n_quoted = 0;
    for (const Diagnostic& d : many) n_quoted += d.source_line.size();
    CHECK(n_quoted < 20'000'000);                        // copies of this line would be 400 MB
    CHECK(many[49].source_line.size() > points.size());  // those that are shown
    CHECK(format(many[49]).size() < 1000);
    std::string long_text;
    for (int i = 0; i < 100'000; ++i) long_text += "ß";
    for (const std::string& text :
         {"knap = 1\n\"" + long_text + "\" = 1\n", "knap = 1\n[domain]\nshape = \"" + long_text + "\"\n",
          "knap = 1\n[material.\"" + long_text + "\"]\nE = 1\n"})
        for (const Diagnostic& d : mistakes(text)) {
            const std::string message = format(d);
            CHECK(message.size() < 4000);
            const auto n_bytes = [&](int top) {
                return std::count_if(message.begin(), message.end(), [top](char c) { return (c & 0xC0) == top; });
            };
            CHECK(n_bytes(0xC0) == n_bytes(0x80));  // no letter is cut in two
        }
}

TEST_CASE("mistakes: about files") {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_scenario_files";
    std::filesystem::create_directories(directory);
    const auto code = [](const auto& call) -> std::string {
        try {
            call();
        } catch (const UserError& error) {
            return error.diagnostics.at(0).code;
        }
        return "";
    };
    CHECK(code([&] { read_scenario(directory / "none.toml"); }) == "missing-file");
    CHECK(code([&] { read_scenario(directory); }) == "not-a-file");
    CHECK(code([&] { open_scenario(directory.string()); }) == "not-a-file");
    CHECK(code([&] { read_scenario("/dev/null"); }) == "not-a-file");
    std::ofstream(directory / "good.toml") << least;
    CHECK(code([&] { open_scenario((directory / "good.toml").string()); }) == "");
    CHECK(read_scenario(directory / "good.toml").scenario.name == "good");
    try {
        open_scenario("edge_cracked_blok");
        FAIL("read");
    } catch (const UserError& error) {
        CHECK(error.diagnostics.at(0).hint == "did you mean `edge_cracked_block`?");
    }
}

TEST_CASE("warnings: a figure after the end") {
    const ReadResult result = samples::read(least + "[[figure]]\nfile = \"a.png\"\nat = [\"40 us\", \"90 us\"]\n");
    REQUIRE(result.warnings.size() == 1);
    CHECK(result.warnings[0].severity == Diagnostic::Severity::warning);
    CHECK(result.warnings[0].line == 18);
    CHECK(result.warnings[0].column == 16);
    CHECK(result.warnings[0].length == 7);
}

namespace {

/// The one warning of a text.
Diagnostic warning_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
    const ReadResult result = samples::read(text, overrides);
    REQUIRE(result.warnings.size() == 1);
    CHECK(result.warnings[0].severity == Diagnostic::Severity::warning);
    return result.warnings[0];
}

bool reports(const Diagnostic& d, const std::string& words) {
    return (d.message + d.hint + d.note).find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("warnings: triangles of first order lock where the material is nearly incompressible") {
    CHECK(warning_of(changed("nu = 0.2", "nu = 0.49")).code == "locking");
    CHECK(reports(warning_of(changed("nu = 0.2", "nu = 0.49")), "mesh.order = 2"));
    const auto silent = [](const std::string& text) { return samples::read(text).warnings.empty(); };
    CHECK(silent(changed("nu = 0.2", "nu = 0.45")));
    CHECK(silent(changed("nu = 0.2", "nu = 0.49", changed("[mesh]", "[mesh]\norder = 2"))));
}

TEST_CASE("warnings: values that hardly anybody means with their place and what was meant") {
    const Diagnostic soft = warning_of(changed("32e9", "3.2e2", changed("3.08e6", "30")));
    CHECK(soft.code == "implausible");
    CHECK(soft.line == 9);
    CHECK(soft.column == 5);
    CHECK(soft.length == 5);
    CHECK(soft.message == "`material.glass.E` = 320 Pa is softer than any gel");
    CHECK(soft.hint == "did you mean \"320 GPa\"?");
    CHECK(reports(soft, "plausible: 1000 to 2e+12 Pa"));
    CHECK(warning_of(changed("2450", "2.45")).hint == "did you mean \"2.45 g/cm3\"?");
    CHECK(reports(warning_of(changed("3.08e6", "3.08")), "weaker than any gel"));
    CHECK(reports(warning_of(changed("G_c = 3", "delta_c = 1.5")), "did you mean \"1.5 um\"?"));
    CHECK(reports(warning_of(changed("G_c = 3", "G_c = 3\nfriction = 30")), "tan(30 deg) = 0.577"));
    CHECK(reports(warning_of(changed("3.08e6", "\"33 GPa\"")), "above the largest E, 32 GPa"));
    CHECK(reports(warning_of(with(load + "pressure = \"4 GPa\"\n")), "a stress of 4 GPa"));
    CHECK(reports(warning_of(with(load + "velocity = [0, \"16 km/s\"]\n")), "faster than waves"));
    CHECK(warning_of(least, {"material.glass.E=32"}).file == "--set material.glass.E=32");
    const auto expands = [](const std::string& value) {
        return changed("nu = 0.2\n", "nu = 0.2\nexpansion = " + value + "\n", with(heat));
    };
    CHECK(reports(warning_of(expands("8")), "did you mean \"8 um/m/K\"?"));
    for (const char* value : {"8e-6", "\"8e-6 1/K\"", "\"8 um/m/K\"", "-1e-6"})
        CHECK(samples::read(expands(value)).warnings.empty());
    CHECK(samples::read(changed("32e9", "2e3", changed("3.08e6", "500", changed("G_c = 3", "G_c = 0.1"))))
              .warnings.empty());  // a gel
    CHECK(samples::read(changed("sigma_c = 3.08e6\nG_c = 3", "sigma_c = 0")).warnings.empty());
}

TEST_CASE("warnings: what begins after the end") {
    CHECK(
        reports(warning_of(changed("G_c = 3", "G_c = 3\nrelaxation_time = 2")), "= 2 s is longer than the run, 80 µs"));
    const Diagnostic table = warning_of(with(load + "traction = [0, 1]\ntable = [[90, 0], [100, 1]]\n"));
    CHECK(table.code == "after-the-end");
    CHECK(table.line == 19);
    CHECK(reports(table, "begins at 90 s, and the run ends at 80 µs: its factor is 0 all the time"));
    const Diagnostic seconds = warning_of(with(load + "traction = [0, 1]\ntable = [[0, 0], [100, 1]]\n"));
    CHECK(seconds.code == "after-the-end");
    CHECK(reports(seconds, "has a factor of at most 8e-07 until the run ends at 80 µs"));
    CHECK(samples::read(with(load + "traction = [0, 1]\ntable = [[0, 0], [1e-3, 1]]\n")).warnings.empty());
    CHECK(reports(warning_of(with("[[study.quantity]]\nof = \"surface\"\nat = \"1 ms\"\n")), "there is no such value"));
}

TEST_CASE("names may have blanks everywhere and the resolved scenario reads back") {
    const std::string text = changed(
        "shape = \"rectangle\"\nsize = [0.1, 0.04]",
        "shape = \"polygon\"\npoints = [[0, 0], [1, 0], [1, 1]]\nsides = [\"the floor\", \"b\", \"H\u00e4nge\"]\n"
        "[[domain.hole]]\ncentre = [0.7, 0.3]\nradius = 0.1\nname = \"round hole\"",
        changed("size = 0.001", "size = 0.05",
                changed("material.glass", "material.\"hard glass\"",
                        changed("interface.default", "interface.\"hard glass-hard glass\"",
                                with("[interface.\"on the floor\"]\nsigma_c = 0\n[[support]]\n"
                                     "on = \"the floor\"\ninterface = \"on the floor\"\n[[probe]]\nat = [0.5, "
                                     "0.1]\nname = \"near the floor\"\n" +
                                     disc + "name = \"a ball\"\n")))));
    const ReadResult once = samples::read(text, {"material.hard glass.nu=0.25"});
    CHECK(once.scenario.materials[0].elastic.nu == 0.25);
    CHECK(once.scenario.law_of_pair[0][0] == 0);
    const ReadResult twice = samples::read(resolved_toml(once));
    CHECK(resolved_toml(twice) == resolved_toml(once));
    CHECK(twice.scenario.materials[0].name == "hard glass");
    CHECK(twice.scenario.probes[0].name == "near the floor");
    CHECK(twice.scenario.obstacles[0].name == "a ball");
}

TEST_CASE("mistakes: keys and brackets that go too deep") {
    const auto times = [](int n, const std::string& text) {
        std::string all;
        for (int i = 0; i < n; ++i) all += text;
        return all;
    };
    const std::string deep = "a" + times(50'000, ".a"), inner = "b" + times(200, ".b");
    for (const std::string& text :
         {deep + " = 1\n", "[" + deep + "]\nx = 1\n", "[[" + deep + "]]\nx = 1\n", "x = { " + deep + " = 1 }\n",
          "x = [ { " + deep + " = 1 } ]\n", "\"x\".y" + times(50'000, ".'a.b'") + " = 1\n", "x = " + times(50'000, "["),
          "x = " + times(50'000, "[{a="), deep, "x = { y = " + times(256, "{ " + inner + " = ") + "1",
          "['" + times(300, ".") + "']\nx = [\n" + times(200, "[\n") + times(201, "]") + "\n" + deep + " = 1\n"}) {
        CAPTURE(text.substr(0, 60));
        const std::vector<Diagnostic> found = mistakes(least + text);
        REQUIRE(found.size() == 1);
        CHECK(found[0].code == "bad-toml");
        CHECK((found[0].message == "a key has more than 16 parts" ||
               found[0].message == "brackets go deeper than 256 levels"));
        CHECK(found[0].line > 14);
    }
    const std::vector<Diagnostic> placed = mistakes(least + "\n# [\nx = { y = " + times(300, "[1.5, ") + "\n");
    REQUIRE(placed.size() == 1);
    CHECK(placed[0].line == 18);
    CHECK(placed[0].message == "brackets go deeper than 256 levels");
    CHECK(placed[0].column > 11 + 6 * 250);  // time.x.y and most of 256 lists
    CHECK(placed[0].column < 11 + 6 * 258);
}

TEST_CASE("mistakes: what only looks deep is not") {
    std::string many;
    for (int i = 0; i < 300; ++i) many += "a.[{";
    for (const std::string& text :
         {"title = \"" + many + "\\\"" + many + "\"\n", "title = '" + many + "'\n",
          "title = '''\n" + many + "\n'" + many + "'''\n", "title = \"\"\"" + many + "\n\\\"\"" + many + "\"\"\"\n",
          "# " + many + "\n", "seed = 1 # " + many + "\n"}) {
        CAPTURE(text.substr(0, 30));
        CHECK(mistakes(text + least).empty());
    }
    std::string points;
    for (int i = 0; i < 300; ++i) points += "[0.0, 0.5],\n";
    CHECK(mistakes(changed("\"rectangle\"\nsize = [0.1, 0.04]", "\"polygon\"\npoints = [" + points + "[1.0, 0.0]]"))
              .empty());
}

TEST_CASE("mistakes: a cut-off scenario never crashes") {
    const std::string& text = built_in_scenario("kalthoff_winkler").text;
    int n_refused = 0;
    for (std::size_t n = 0; n < text.size(); n += 7) n_refused += !mistakes(text.substr(0, n)).empty();
    CHECK(n_refused > 100);
}

TEST_CASE("a specimen whose other end moves is warned of where it has no gauge") {
    const std::string other = "[[load]]\non = \"bottom\"\nvelocity = [0, -1]\n";
    CHECK(samples::read(with(specimen)).warnings.empty());
    const auto warnings = samples::read(with(specimen + other)).warnings;
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].line == 19);
    CHECK(warnings[0].message.find("`load1` moves as well") != std::string::npos);
    CHECK(samples::read(with(specimen + "axial = [\"top\", \"bottom\"]\n" + other)).warnings.empty());
    CHECK(samples::read(with(specimen + "[[load]]\non = \"bottom\"\nvelocity = [1, 0]\n")).warnings.empty());
}

TEST_CASE("mistakes in the pressure of a fluid are told apart") {
    const auto codes = [](const std::string& keys, const std::string& more = "") {
        std::string found;
        for (const Diagnostic& d : samples::mistakes(samples::least + more + "[[pressure]]\n" + keys))
            found += d.code + " ";
        return found;
    };
    CHECK(codes("rate = 1e-3\nstorage = 1e-12\n") == "");
    CHECK(codes("gradient = 9810\nlevel = 1\n") == "");
    CHECK(codes("pressure = \"1e5*x\"\nname = \"water\"\n") == "");
    CHECK(codes("rate = 1e-3\n") == "missing-key ");
    CHECK(codes("pressure = 1\nstorage = 1e-12\n") == "missing-key ");
    CHECK(codes("pressure = 1\nlevel = 1\n") == "missing-key ");
    CHECK(codes("pressure = \"1e5*z\"\n") == "bad-formula ");
    CHECK(codes("rate = \"1 m/s\"\nstorage = 1e-12\n") == "wrong-unit ");
    CHECK(codes("rate = 1e-3\npressure = 1\nstorage = 1e-12\n").find("exclusive-keys") != std::string::npos);
    const std::string excavation = "[[excavation]]\nbox = [0.01, 0.01, 0.02, 0.02]\nat = 1e-7\n";
    CHECK(codes("rate = 1e-3\nstorage = 1e-12\n", excavation) == "exclusive-keys ");
    CHECK(codes("pressure = 1\n", excavation) == "");
}

}  // namespace mistakes_test
