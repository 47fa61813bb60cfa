// Every key of the table is set once, read back, resolved and read again.
#include "scenario/write_scenario.hpp"

#include "samples.hpp"
#include "scenario/keys.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

namespace every_key_test {

using namespace knap;
using knap::tests::relative;

namespace {

// Values differ from every default; what each becomes is in `expected`.
const std::string rectangle = R"(knap = 1
name = "all-1"
title = "Everything \"quoted\", ü"
seed = 7
[domain]
shape = "rectangle"
size = ["100 mm", 0.04]
origin = ["-50 mm", "1 mm"]
snap = "0.1 mm"
model = "plane stress"
thickness = "2 mm"
[[domain.hole]]
points = [["1 mm", "2 mm"], ["3 mm", "2 mm"], ["3 mm", "4 mm"]]
arcs = [{ side = 2, through = ["3.5 mm", "3 mm"] }]
name = "window"
[[domain.hole]]
centre = ["20 mm", "20 mm"]
radius = "2 mm"
[[domain.crack]]
points = [["-50 mm", "20 mm"], ["-10 mm", "20 mm"]]
[[domain.crack]]
points = [["-30 mm", "6 mm"], ["-25 mm", "6 mm"]]
interface = "default"
[[domain.region]]
box = ["0 mm", "1 mm", "50 mm", "41 mm"]
material = "steel"
[[domain.region]]
centre = ["-20 mm", "10 mm"]
radius = "3 mm"
material = "steel"
[[domain.region]]
points = [["-30 mm", "30 mm"], ["-25 mm", "30 mm"], ["-25 mm", "35 mm"]]
arcs = [{ side = 1, through = ["-27 mm", "29 mm"] }]
material = "glass"
[mesh]
size = "1 mm"
order = 2
min_angle = "25 deg"
grading = 0.5
refine = [{ inside = ["0 mm", "1 mm", "10 mm", "41 mm"], size = "0.5 mm" },
          { along = [["-50 mm", "20 mm"], ["0 mm", "25 mm"]], width = "4 mm", size = "0.8 mm" }]
[toughness]
meaning = "as measured"
table = ")" KNAP_SOURCE_DIR R"(/tests/scenario/data/toughness.csv"
[strength]
meaning = "as measured"
test = "brazilian"
size = "80 mm"
table = ")" KNAP_SOURCE_DIR R"(/tests/scenario/data/strength.csv"
[material.steel]
density = "8000 kg/m3"
E = "190 GPa"
nu = 0.3
[material.glass]
density = "2.45 g/cm3"
E = "32 GPa"
nu = 0.2
[interface.default]
breakable = false
[interface.glass-steel]
sigma_c = "3 MPa"
G_c = "4 N/m"
gamma = 2
friction = 0.3
restitution = 0.1
[interface.glass-glass]
sigma_c = "2 MPa"
delta_c = "2 um"
[interface.glue]
sigma_c = "1 MPa"
G_c = 1
[[support]]
on = { boundary = "bottom", box = ["0 mm", "0 mm", "10 mm", "2 mm"] }
interface = "glue"
glued = true
[[support]]
on = "left"
interface = "glue"
gap = "1 um"
[[load]]
name = "weight"
on = "top"
traction = ["1 MPa", 2e6]
ramp = "10 us"
[[load]]
on = { box = [0, 0, 1, 1] }
velocity = ["free", "1 mm/ms"]
table = [["0 us", 0], ["10 us", 1], ["20 us", 0.5]]
table_period = "30 us"
[[load]]
on = "window"
displacement = ["1 um", "free"]
[[load]]
body_force = [0, "-3 N/m3"]
[[load]]
acceleration = [0, "-9.81 m/s2"]
[[load]]
on = "top"
force = [0, "1 kN"]
[[load]]
on = "left"
pressure = "5 MPa"
[[load]]
on = { box = [0, 0, 1, 1] }
stress = ["-2 MPa", "-1 MPa", "3 kPa"]
[[obstacle]]
name = "wall"
shape = "half plane"
at = ["-60 mm", "0 mm"]
normal = [2, 0]
friction = 0.3
R_N = 0.5
R_T = 0.6
velocity = ["1 m/s", "free"]
mass = "2 kg"
force = ["0 N", "-3 N"]
table = [["0 us", 0], ["10 us", 1]]
[[obstacle]]
shape = "disc"
centre = ["0 mm", "60 mm"]
radius = "5 mm"
restitution = 0.5
density = "2 g/cm3"
angle = "30 deg"
shift = ["1 mm", "0 mm"]
initial_velocity = [0, "-4 m/s"]
initial_spin = "180 deg/s"
[[obstacle]]
shape = "polygon"
points = [["60 mm", "0 mm"], ["60 mm", "10 mm"], ["70 mm", "10 mm"], ["70 mm", "0 mm"]]
displacement = ["-1 mm", 0]
spin = "1 rad/s"
turns = false
ramp = "10 us"
[[obstacle]]
shape = "polyline"
points = [["1 m", "1 m"], ["50 cm", "1 m"]]
roughness = "1 mm"
roughness_kind = "normal"
spacing = "2 cm"
seed = 7
[[obstacle.range]]
from = "60 cm"
to = "70 cm"
friction = 0.1
restitution = 0.2
roughness = "2 mm"
spacing = "1 cm"
[[obstacle.range]]
from = "80 cm"
R_N = 0.3
R_T = 0.8
[[absorb]]
on = { boundary = "top", box = ["0 mm", "40 mm", "10 mm", "42 mm"] }
[[excavation]]
points = [["-40 mm", "30 mm"], ["-35 mm", "30 mm"], ["-35 mm", "35 mm"]]
arcs = [{ side = 3, through = ["-39 mm", "33 mm"] }]
at = "20 us"
ramp = "10 us"
[[excavation]]
centre = ["30 mm", "20 mm"]
radius = "4 mm"
at = "10 us"
[[excavation]]
box = ["-10 mm", "1 mm", "-5 mm", "5 mm"]
at = "0 us"
[[initial]]
velocity = ["1 m/s", "2 m/s"]
strain_rate = ["10 Hz", 0, "1 kHz"]
stress = ["-1 MPa", "-2*x MPa", 0]
box = [0, 0, 1, 1]
[time]
end = "80 us"
until = "rest"
rest_below = 0.01
rest_for = "5 us"
step = "1 ns"
damping = "3 kHz"
damping_of = "motion"
safety = 0.5
mass_scaling = "2 %"
theta = 0.75
[output]
every = "1 us"
frame_every = "1 us"
history_every = "0.1 us"
compression = "lz4"
checkpoint_every = "5 s"
states = ["0.2 us", "0.4 us"]
fields = false
report = false
breaks = true
[[probe]]
at = ["5 mm", "5 mm"]
watch = "interface"
name = "middle"
[[probe]]
watch = "stress"
box = ["0 mm", "1 mm", "10 mm", "11 mm"]
[[probe]]
watch = "tip"
at = ["5 mm", "5 mm"]
radius = "2 mm"
[[collector]]
name = "net"
from = ["0 mm", "1 mm"]
to = ["0 mm", "5 mm"]
direction = "forward"
[[collector]]
x = "3 mm"
[[figure]]
file = "a.svg"
show = "cracks"
at = "20 us"
colour = "beta"
deform = 10
box = [0, 0, 0.01, 0.02]
range = [0, 1]
paper_width = "84 mm"
font_size = 7.5
title = "Cracks"
aspect = 5
panel = true
measured = [["1 mm", 0.002], [0.003, "4 mm"]]
measured_by = "Somebody, 1990"
[[figure]]
file = "b.pdf"
show = "stress_xy"
at = ["20 us", "40 us"]
range = ["-1 MPa", "1 MPa"]
[[figure]]
file = "c.webp"
every = "10 us"
speed = 1e-5
curves = "energy"
[[figure]]
file = "d.png"
show = "probes"
over = "time"
width = 800
[limits]
penetration = "2 um"
law_lag = 0.3
rotation = "60 deg"
area_change = "50 %"
strain = "8 %"
rotation_work_part = 2e-3
slip = "none"
obstacle_overlap = "1 mm"
obstacle_depth = 0.2
overlap = "3 mm2"
[expect]
energy_residual = { below = 1e-3, above = -1 }
max_tip_speed = { below = "0.65 cR" }
first_growth_time = { at_least = "10 us", at_most = "12 us" }
dissipated = { value = "12 mJ", within = "7 %" }
fragments = { value = 2, within = 0 }
[sweep]
set = ["mesh.size=1 mm,2 mm"]
seeds = 20
quantities = ["broken_length", "fragments"]
show = "materials"
[study]
refine = "both"
levels = [1, 2.5]
seeds = 12
reference = "finest"
set = ["mesh.size=2 mm", "figure="]
[[study.line]]
name = "fine steps"
set = ["time.safety=0.4"]
levels = [3, 4]
[[study.quantity]]
of = "dissipated"
exact = "12 mJ"
scale = 2
name = "surface"
[[study.quantity]]
of = "strain"
at = "10 us"
exact = "1 mJ"
[[study.quantity]]
of = "middle_opening"
reaches = "3 um"
since = "middle_slip"
exact = "20 us"
[[study.quantity]]
of = "load1_force_y"
largest = true
[[study.quantity]]
of = "surface"
slope = ["2 us", "10 us"]
exact = "3 kW"
[study.safety]
laws = ["default"]
factors = [1, 4]
tolerance = 0.01
criterion = "runaway"
runaway = "1 mm"
)";

const std::string polygon = samples::changed("shape = \"rectangle\"\nsize = [0.1, 0.04]\n", R"(shape = "polygon"
points = [[0, 0], ["10 mm", 0], ["10 mm", "10 mm"], [0, "10 mm"]]
sides = ["floor", "wall", "lid", "wall"]
arcs = [{ side = 3, through = ["5 mm", "12 mm"] }]
)");

const std::string disc = samples::changed("shape = \"rectangle\"\nsize = [0.1, 0.04]\n", R"(shape = "disc"
centre = ["1 mm", "2 mm"]
radius = "10 mm"
)");

const std::string mesh_file =
    samples::changed("[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n[mesh]\nsize = 0.001\n",
                     "[mesh]\nfile = \"" KNAP_SOURCE_DIR
                     "/tests/mesh/data/block_41_ascii.msh\"\n"
                     "unit = \"1 mm\"\ncracks = [\"crack\"]\nmaterial = \"glass\"\ngrains = "
                     "true\n[[mesh.joint]]\ncurve = \"joint\"\ninterface = \"default\"\n"
                     "[material.steel]\ndensity = 8000\nE = 190e9\nnu = 0.3\n");

const std::string scene = samples::changed("[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n", R"([[body]]
shape = "rectangle"
size = ["100 mm", "40 mm"]
origin = ["1 mm", "2 mm"]
angle = "10 deg"
snap = "0.05 mm"
material = "glass"
mesh_size = "2 mm"
velocity = ["1 m/s", "2 m/s"]
spin = "90 deg/s"
[[body.hole]]
points = [["11 mm", "12 mm"], ["13 mm", "12 mm"], ["13 mm", "14 mm"]]
arcs = [{ side = 2, through = ["13.5 mm", "13 mm"] }]
name = "window"
[[body.hole]]
centre = ["20 mm", "20 mm"]
radius = "4 mm"
[[body.crack]]
points = [["30 mm", "20 mm"], ["40 mm", "20 mm"]]
interface = "default"
[[body.region]]
box = ["50 mm", "10 mm", "60 mm", "30 mm"]
material = "steel"
[[body.region]]
centre = ["70 mm", "20 mm"]
radius = "5 mm"
material = "steel"
[[body.region]]
points = [["80 mm", "30 mm"], ["90 mm", "30 mm"], ["85 mm", "35 mm"]]
arcs = [{ side = 1, through = ["85 mm", "28 mm"] }]
material = "steel"
[[body]]
name = "cap"
shape = "polygon"
points = [["200 mm", 0], ["210 mm", 0], ["210 mm", "10 mm"], ["200 mm", "10 mm"]]
sides = ["floor", "wall", "lid", "wall"]
arcs = [{ side = 3, through = ["205 mm", "12 mm"] }]
[[body]]
shape = "disc"
centre = ["150 mm", "50 mm"]
radius = "10 mm"
shift = ["1 mm", 0]
[[load]]
on = { body = "cap" }
acceleration = [0, "-9.81 m/s2"]
[[absorb]]
on = { body = "cap", box = ["200 mm", 0, "210 mm", "1 mm"] }
[[support]]
on = { body = "body3" }
[[pressure]]
from = { body = "body1" }
pressure = "1 MPa"
[[initial]]
body = "cap"
spin = "45 deg/s"
[[inclusions]]
size = "3 mm"
number = 1
body = "cap"
[[joints]]
direction = "60 deg"
spacing = "20 mm"
body = "body3"
[[traces]]
file = ")" KNAP_SOURCE_DIR R"(/tests/scenario/data/traces.csv"
property = "class"
class = "joint"
unit = "1 cm"
origin = ["-125 mm", "-20 mm"]
crop = true
interface = "default"
body = "body3"
[[traces]]
file = ")" KNAP_SOURCE_DIR R"(/tests/scenario/data/traces.csv"
class = "fault"
body = "body1"
[material.steel]
density = 8000
E = 190e9
nu = 0.3
[sweep.random]
members = 5
seed = 9
file = ")" KNAP_SOURCE_DIR R"(/tests/scenario/data/members.csv"
[[sweep.random.vary]]
key = "body.cap.shift.x"
uniform = ["-1 mm", "1 mm"]
[[sweep.random.vary]]
key = "body.body3.spin"
normal = ["10 deg/s", "1 rad/s"]
within = [0, 90]
[[sweep.random.vary]]
key = "material.steel.E"
lognormal = ["190 GPa", "10 GPa"]
[[sweep.random.vary]]
key = "domain.model"
choice = ["plane strain", "plane stress"]
[output]
trajectories = true
)");

const std::string patterns = samples::changed("[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n", R"([domain]
rotation = "large"
[[bodies]]
name = "dam"
pattern = "wall"
columns = 3
rows = 2
block = ["20 mm", "10 mm"]
bond = 0.25
gap = "1 mm"
origin = ["5 mm", "6 mm"]
angle = "10 deg"
material = "steel"
mesh_size = "2 mm"
velocity = [0, "2 m/s"]
spin = "30 deg/s"
[[bodies]]
pattern = "voronoi"
box = ["200 mm", 0, "260 mm", "40 mm"]
size = "20 mm"
spread = 0.1
[[bodies]]
pattern = "heap"
box = ["300 mm", 0, "400 mm", "100 mm"]
size = "20 mm"
fraction = 0.2
distance = "2 mm"
corners = 5
elongation = 1.5
direction = "20 deg"
[[bodies]]
name = "sand"
pattern = "heap"
box = ["500 mm", 0, "600 mm", "100 mm"]
size = "20 mm"
number = 3
shift = ["1 mm", 0]
[contact]
friction = 0.6
restitution = 0.3
[[contact.pair]]
materials = ["steel", "glass"]
friction = 0.4
restitution = 0.1
[[contact.pair]]
materials = ["glass", "glass"]
R_N = 0.2
R_T = 0.4
[rigid]
step = "1 ms"
thaw = 0.4
hold = 30
smallest = "3 mm"
sleep = "1 cm/s"
restitution = 0.8
[[support]]
on = { body = "dam", boundary = "bottom" }
beyond = "30 mm"
[limits]
contact_depth = 0.05
[material.steel]
density = 8000
E = 190e9
nu = 0.3
)");

const std::string of_bodies =
    samples::changed("[contact]\nfriction = 0.6\nrestitution = 0.3\n", "[contact]\nR_N = 0.3\nR_T = 0.7\n", patterns);

const std::string schemes = samples::least + "[study]\nschemes = [\"explicit/explicit\", \"implicit/implicit\"]\n";

const std::string adaptive = samples::least + R"([adapt]
size = "0.1 mm"
load = 0.25
margin = 12
every = 100
limit = 2e6
)";

const std::string implicit = samples::least + R"(bulk = "implicit"
cohesion = "implicit"
step = "20 CFL"
step_cracking = "0.1 us"
step_min = "1e-3 CFL"
theta = 0.6
mass = "consistent"
start = "equilibrium"
assumption_1 = "ignore"
)";

const std::string changing = samples::least + R"(bulk = "auto"
quiet_below = 1e-3
quiet_for = "3 ms"
)";

const std::string norm = samples::changed("G_c = 3\n", "G_c = 3\ncoupling = \"norm\"\n");

const std::string slate = samples::changed(
    "G_c = 3\n",
    "G_c = 3\nstrength_over_bedding = [[0, 0.2], [\"30 deg\", 1]]\nenergy_over_bedding = [[10, 0.5], [90, 1]]\n",
    samples::changed("nu = 0.2\n",
                     "nu = 0.2\nbedding = { E = \"20 GPa\", nu = 0.15, G = \"9 GPa\", angle = \"30 deg\" }\n"));

const std::string pressed =
    samples::changed("G_c = 3\n", "G_c = 3\nfriction_over_pressure = [[0, 0], [\"2 MPa\", \"3 MPa\"]]\n");

const std::string rock = samples::changed("G_c = 3\n", R"(G_c = 3
softening = "power"
exponent = 3
unloading = "secant"
G_II = "6 J/m2"
mode_mix = "benzeggagh-kenane"
mix_exponent = 2
friction = 0.6
kinetic_friction = 0.1
slip_distance = "1 mm"
relaxation_time = "1 us"
incubation_time = "2 us"
scatter = { kind = "weibull", modulus = 8, of = ["sigma_c", "G_c"], length = "1 mm", lowest = 0.1, highest = 3 }
[interface.within]
sigma_c = 1e7
G_c = 10
softening = "trapezoid"
plateau = 0.6
scatter = { kind = "normal", deviation = "5 %", area = "2 mm2" }
[interface.weak]
sigma_c = 1e6
G_c = 1
softening = "table"
table = [[0, 3], [0.5, 1], [2, 0]]
scatter = { kind = "lognormal", deviation = 0.2, correlation = "3 mm" }
[material.quartz]
density = 2650
E = 90e9
nu = 0.1
[[grains]]
size = "5 mm"
spread = 0.3
elongation = 1.5
direction = "30 deg"
in = "quartz"
[[grains.mineral]]
material = "glass"
fraction = 0.2
[[inclusions]]
size = "4 mm"
fraction = "5 %"
spread = 0.1
distance = "1 mm"
corners = 5
elongation = 2
direction = 10
material = "quartz"
[[inclusions]]
size = "3 mm"
number = 12
name = "bubbles"
[[pressure]]
pressure = "2 MPa"
from = { boundary = "top", box = ["0 mm", "40 mm", "10 mm", "42 mm"] }
ramp = "10 us"
name = "water"
gradient = "9810 Pa/m"
level = "40 mm"
process_zone = true
[[pressure]]
pressure = "1e5 - 1e5*x"
[[pressure]]
rate = "0.001 m2/s"
storage = "1e-12 m2/Pa"
[[pressure]]
pressure = "3 MPa"
joints = "weak"
table = [[0, 0], ["10 us", 1]]
[[joints]]
direction = "60 deg"
spread = 5
spacing = "20 mm"
persistence = 0.5
length = "10 mm"
interface = "weak"
[[joints]]
direction = -30
spacing = "40 mm"
thickness = "2 mm"
material = "quartz"
)");

const std::string tested = samples::least + R"([[load]]
on = "top"
velocity = ["free", 1]
[specimen]
test = "bending"
force = "load0"
axis = "x"
height = "40 mm"
width = "9 mm"
span = "80 mm"
axial = ["top", "load0"]
modulus_between = [0.1, "30 %"]
window = "0.1 us"
)";

const std::string stretched = samples::changed(
    "\"bending\"", "\"tension\"", samples::changed("span = \"80 mm\"", "lateral = [\"left\", \"right\"]", tested));

const std::string painted = samples::least + R"([[map]]
file = ")" KNAP_SOURCE_DIR R"(/tests/scenario/data/two_halves.png"
box = [0, 0, "100 mm", "40 mm"]
grains = true
least_pixels = 4
smooth = true
[[map.colour]]
rgb = "#C01020"
material = "glass"
)";

const std::string warm = samples::changed("nu = 0.2\n", R"(nu = 0.2
conductivity_table = [[0, "30 W/m/K"], ["100 K", 20]]
heat_capacity_table = [[0, "880 J/kg/K"], [100, 900]]
expansion = 8e-6
latent_heat = "3 kJ/kg"
freezing_range = [-2, -0.5]
[interface.weak]
sigma_c = "1 MPa"
G_c = 1
strength_table = [[-10, 1], [-0.5, 0.3], [0, 0.001]]
friction_table = [[-10, 0.7], [0, 0.5]]
[[joints]]
direction = 60
spacing = "40 mm"
interface = "weak"
[[pressure]]
pressure_table = [["-4 K", "5 MPa"], [0, 0]]
joints = "weak"
[material.steel]
density = 7800
E = "210 GPa"
nu = 0.3
expansion_table = [[20, 0], [573, 0.009], [583, 0.015]]
conductivity = 45
heat_capacity = 460
[heat]
reference = "20 K"
temperature = "20 + 100*x"
ramp = "2 ms"
conduction = true
every = 5
time_factor = 100
gap_conductivity = 0.6
closed_conductance = 1e5
[[heat.exchange]]
on = "left"
temperature = 300
table = [[0, 0], ["1 ms", 1]]
[[heat.exchange]]
on = { boundary = "top", box = [0, 0, 1, 1] }
outside = 20
transfer = "5e4 W/m2/K"
ramp = "1 us"
[[heat.exchange]]
on = "right"
flux = "1 kW/m2"
[[heat.exchange]]
source = "2 MW/m3"
[limits]
temperature_overshoot = 0.01
[[probe]]
at = [0.01, 0.01]
[[figure]]
show = "temperature"
file = "T.png"
mark = ["50 K", 60]
)");
const std::string mapped_heat =
    samples::changed("nu = 0.2\n", "nu = 0.2\nexpansion = 8e-6\n[heat]\ntemperature = \"" KNAP_SOURCE_DIR
                                   "/tests/scenario/data/temperature.csv\"\n");
const std::string turning =
    samples::changed("nu = 0.2\n", "nu = 0.2\nbulk_viscosity = [0.06, 1.2]\nshear_viscosity = 0.02\n",
                     samples::changed("[mesh]", "rotation = \"large\"\n[mesh]"));

struct Case {
    const std::string& text;
    const char* path;
    const char* expected;
};

const Case cases[] = {
    {rectangle, "knap", "1"},
    {rectangle, "name", "\"all-1\""},
    {rectangle, "title", "\"Everything \\\"quoted\\\", ü\""},
    {rectangle, "seed", "7"},
    {rectangle, "domain.shape", "\"rectangle\""},
    {rectangle, "domain.size", "[0.1, 0.04]"},
    {rectangle, "domain.origin", "[-0.05, 0.001]"},
    {rectangle, "domain.snap", "1e-04"},
    {rectangle, "domain.model", "\"plane stress\""},
    {rectangle, "domain.thickness", "0.002"},
    {turning, "material.glass.bulk_viscosity", "[0.06, 1.2]"},
    {turning, "material.glass.shear_viscosity", "0.02"},
    {turning, "domain.rotation", "\"large\""},
    {rectangle, "domain.hole[0].points", "[[0.001, 0.002], [0.003, 0.002], [0.003, 0.004]]"},
    {rectangle, "domain.hole[0].name", "\"window\""},
    {rectangle, "domain.hole[0].arcs[0].side", "2"},
    {rectangle, "domain.hole[0].arcs[0].through", "[0.0035, 0.003]"},
    {rectangle, "domain.region[2].arcs[0].side", "1"},
    {rectangle, "domain.region[2].arcs[0].through", "[-0.027, 0.029]"},
    {rectangle, "domain.hole[1].centre", "[0.02, 0.02]"},
    {rectangle, "domain.hole[1].radius", "0.002"},
    {rectangle, "domain.hole[1].name", "\"hole2\""},
    {rectangle, "domain.crack[1].interface", "\"default\""},
    {rectangle, "domain.crack[0].points", "[[-0.05, 0.02], [-0.01, 0.02]]"},
    {rectangle, "domain.region[0].box", "[0, 0.001, 0.05, 0.041]"},
    {rectangle, "domain.region[0].material", "\"steel\""},
    {rectangle, "domain.region[1].centre", "[-0.02, 0.01]"},
    {rectangle, "domain.region[1].radius", "0.003"},
    {rectangle, "domain.region[2].points", "[[-0.03, 0.03], [-0.025, 0.03], [-0.025, 0.035]]"},
    {rectangle, "mesh.size", "0.001"},
    {rectangle, "mesh.min_angle", "25"},
    {rectangle, "mesh.order", "2"},
    {rectangle, "mesh.grading", "0.5"},
    {rectangle, "mesh.refine[0].inside", "[0, 0.001, 0.01, 0.041]"},
    {rectangle, "mesh.refine[0].size", "5e-04"},
    {rectangle, "mesh.refine[1].along", "[[-0.05, 0.02], [0, 0.025]]"},
    {rectangle, "mesh.refine[1].width", "0.004"},
    {rectangle, "mesh.refine[1].size", "8e-04"},
    {rectangle, "toughness.meaning", "\"as measured\""},
    {rectangle, "toughness.table", "\"" KNAP_SOURCE_DIR "/tests/scenario/data/toughness.csv\""},
    {rectangle, "strength.meaning", "\"as measured\""},
    {rectangle, "strength.test", "\"brazilian\""},
    {rectangle, "strength.size", "0.08"},
    {rectangle, "strength.table", "\"" KNAP_SOURCE_DIR "/tests/scenario/data/strength.csv\""},
    {rectangle, "material.steel.density", "8000"},
    {rectangle, "material.glass.density", "2450"},
    {rectangle, "material.glass.E", "3.2e+10"},
    {rectangle, "material.glass.nu", "0.2"},
    {rectangle, "interface.default.breakable", "false"},
    {rectangle, "interface.glass-steel.sigma_c", "3e+06"},
    {rectangle, "interface.glass-steel.G_c", "4"},
    {rectangle, "interface.glass-steel.gamma", "2"},
    {rectangle, "interface.glass-steel.friction", "0.3"},
    {rectangle, "interface.glass-steel.restitution", "0.1"},
    {rectangle, "interface.glass-glass.delta_c", "2e-06"},
    {rectangle, "absorb[0].on.boundary", "\"top\""},
    {rectangle, "absorb[0].on.box", "[0, 0.04, 0.01, 0.042]"},
    {rectangle, "excavation[0].points", "[[-0.04, 0.03], [-0.035, 0.03], [-0.035, 0.035]]"},
    {rectangle, "excavation[0].arcs[0].side", "3"},
    {rectangle, "excavation[0].arcs[0].through", "[-0.039, 0.033]"},
    {rectangle, "excavation[0].at", "2e-05"},
    {rectangle, "excavation[0].ramp", "1e-05"},
    {rectangle, "excavation[1].centre", "[0.03, 0.02]"},
    {rectangle, "excavation[1].radius", "0.004"},
    {rectangle, "excavation[1].ramp", "0"},
    {rectangle, "excavation[2].box", "[-0.01, 0.001, -0.005, 0.005]"},
    {rectangle, "support[0].on.boundary", "\"bottom\""},
    {rectangle, "support[0].on.box", "[0, 0, 0.01, 0.002]"},
    {rectangle, "support[0].interface", "\"glue\""},
    {rectangle, "support[0].glued", "true"},
    {rectangle, "support[1].gap", "1e-06"},
    {rectangle, "load[0].name", "\"weight\""},
    {rectangle, "load[0].on.boundary", "\"top\""},
    {rectangle, "load[0].traction", "[1e+06, 2e+06]"},
    {rectangle, "load[0].ramp", "1e-05"},
    {rectangle, "load[1].on.box", "[0, 0, 1, 1]"},
    {rectangle, "load[1].velocity", "[\"free\", 1]"},
    {rectangle, "load[1].table", "[[0, 0], [1e-05, 1], [2e-05, 0.5]]"},
    {rectangle, "load[1].table_period", "3e-05"},
    {rectangle, "load[2].displacement", "[1e-06, \"free\"]"},
    {rectangle, "load[3].body_force", "[0, -3]"},
    {rectangle, "load[4].acceleration", "[0, -9.81]"},
    {rectangle, "load[5].force", "[0, 1000]"},
    {rectangle, "load[6].pressure", "5e+06"},
    {rectangle, "load[7].stress", "[-2e+06, -1e+06, 3000]"},
    {rectangle, "obstacle[0].name", "\"wall\""},
    {rectangle, "obstacle[0].shape", "\"half plane\""},
    {rectangle, "obstacle[0].at", "[-0.06, 0]"},
    {rectangle, "obstacle[0].normal", "[2, 0]"},
    {rectangle, "obstacle[0].friction", "0.3"},
    {rectangle, "obstacle[0].R_N", "0.5"},
    {rectangle, "obstacle[0].R_T", "0.6"},
    {rectangle, "obstacle[0].velocity", "[1, \"free\"]"},
    {rectangle, "obstacle[0].mass", "2"},
    {rectangle, "obstacle[0].force", "[0, -3]"},
    {rectangle, "obstacle[0].table", "[[0, 0], [1e-05, 1]]"},
    {rectangle, "obstacle[1].name", "\"obstacle2\""},
    {rectangle, "obstacle[1].centre", "[0, 0.06]"},
    {rectangle, "obstacle[1].radius", "0.005"},
    {rectangle, "obstacle[1].restitution", "0.5"},
    {rectangle, "obstacle[1].density", "2000"},
    {rectangle, "obstacle[1].angle", "30"},
    {rectangle, "obstacle[1].shift", "[0.001, 0]"},
    {rectangle, "obstacle[1].initial_velocity", "[0, -4]"},
    {rectangle, "obstacle[1].initial_spin", "180"},
    {rectangle, "obstacle[2].points", "[[0.06, 0], [0.06, 0.01], [0.07, 0.01], [0.07, 0]]"},
    {rectangle, "obstacle[2].displacement", "[-0.001, 0]"},
    {rectangle, "obstacle[2].spin", "57.29577951308232"},
    {rectangle, "obstacle[2].turns", "false"},
    {rectangle, "obstacle[2].ramp", "1e-05"},
    {rectangle, "obstacle[3].roughness", "0.001"},
    {rectangle, "obstacle[3].roughness_kind", "\"normal\""},
    {rectangle, "obstacle[3].spacing", "0.02"},
    {rectangle, "obstacle[3].seed", "7"},
    {rectangle, "obstacle[3].range[0].from", "0.6"},
    {rectangle, "obstacle[3].range[0].to", "0.7"},
    {rectangle, "obstacle[3].range[0].friction", "0.1"},
    {rectangle, "obstacle[3].range[0].restitution", "0.2"},
    {rectangle, "obstacle[3].range[0].roughness", "0.002"},
    {rectangle, "obstacle[3].range[0].spacing", "0.01"},
    {rectangle, "obstacle[3].range[1].R_N", "0.3"},
    {rectangle, "obstacle[3].range[1].R_T", "0.8"},
    {rectangle, "initial[0].velocity", "[1, 2]"},
    {rectangle, "initial[0].box", "[0, 0, 1, 1]"},
    {rectangle, "initial[0].strain_rate", "[10, 0, 1000]"},
    {rectangle, "initial[0].stress", "[-1e+06, \"-2*x MPa\", 0]"},
    {rectangle, "time.end", "8e-05"},
    {adaptive, "adapt.size", "1e-04"},
    {adaptive, "adapt.load", "0.25"},
    {adaptive, "adapt.margin", "12"},
    {adaptive, "adapt.every", "100"},
    {adaptive, "adapt.limit", "2e+06"},
    {implicit, "time.bulk", "\"implicit\""},
    {implicit, "time.cohesion", "\"implicit\""},
    {changing, "time.quiet_below", "0.001"},
    {changing, "time.quiet_for", "0.003"},
    {implicit, "time.step", "\"20 CFL\""},
    {implicit, "time.step_cracking", "1e-07"},
    {implicit, "time.step_min", "\"0.001 CFL\""},
    {implicit, "time.mass", "\"consistent\""},
    {implicit, "time.start", "\"equilibrium\""},
    {implicit, "time.assumption_1", "\"ignore\""},
    {rectangle, "time.step", "1e-09"},
    {rectangle, "time.until", "\"rest\""},
    {rectangle, "time.rest_below", "0.01"},
    {rectangle, "time.rest_for", "5e-06"},
    {rectangle, "time.damping", "3000"},
    {rectangle, "time.damping_of", "\"motion\""},
    {rectangle, "time.safety", "0.5"},
    {rectangle, "time.mass_scaling", "0.02"},
    {rectangle, "time.theta", "0.75"},
    {rectangle, "output.every", "1e-06"},
    {rectangle, "output.frame_every", "1e-06"},
    {rectangle, "output.history_every", "1e-07"},
    {rectangle, "output.checkpoint_every", "5"},
    {rectangle, "output.states", "[2e-07, 4e-07]"},
    {rectangle, "output.fields", "false"},
    {rectangle, "output.compression", "\"lz4\""},
    {rectangle, "output.report", "false"},
    {rectangle, "output.breaks", "true"},
    {tested, "specimen.test", "\"bending\""},
    {tested, "specimen.force", "\"load0\""},
    {tested, "specimen.axis", "\"x\""},
    {tested, "specimen.height", "0.04"},
    {tested, "specimen.width", "0.009"},
    {tested, "specimen.span", "0.08"},
    {tested, "specimen.axial", "[\"top\", \"load0\"]"},
    {tested, "specimen.modulus_between", "[0.1, 0.3]"},
    {tested, "specimen.window", "1e-07"},
    {stretched, "specimen.lateral", "[\"left\", \"right\"]"},
    {rectangle, "probe[0].at", "[0.005, 0.005]"},
    {rectangle, "probe[0].watch", "\"interface\""},
    {rectangle, "probe[0].name", "\"middle\""},
    {rectangle, "probe[1].box", "[0, 0.001, 0.01, 0.011]"},
    {rectangle, "probe[2].radius", "0.002"},
    {rectangle, "collector[0].name", "\"net\""},
    {rectangle, "collector[0].from", "[0, 0.001]"},
    {rectangle, "collector[0].to", "[0, 0.005]"},
    {rectangle, "collector[0].direction", "\"forward\""},
    {rectangle, "collector[1].x", "0.003"},
    {rectangle, "figure[0].file", "\"a.svg\""},
    {rectangle, "figure[1].show", "\"stress_xy\""},
    {rectangle, "figure[0].at", "[2e-05]"},
    {rectangle, "figure[1].at", "[2e-05, 4e-05]"},
    {rectangle, "figure[0].colour", "\"beta\""},
    {rectangle, "figure[0].deform", "10"},
    {rectangle, "figure[0].box", "[0, 0, 0.01, 0.02]"},
    {rectangle, "figure[0].range", "[0, 1]"},
    {rectangle, "figure[1].range", "[-1e+06, 1e+06]"},
    {rectangle, "figure[3].width", "800"},
    {rectangle, "figure[0].paper_width", "0.084"},
    {rectangle, "figure[0].font_size", "7.5"},
    {rectangle, "figure[0].title", "\"Cracks\""},
    {rectangle, "limits.penetration", "2e-06"},
    {rectangle, "limits.law_lag", "0.3"},
    {rectangle, "limits.rotation", "60"},
    {rectangle, "limits.area_change", "0.5"},
    {rectangle, "limits.strain", "0.08"},
    {rectangle, "limits.rotation_work_part", "0.002"},
    {rectangle, "limits.slip", "\"none\""},
    {rectangle, "limits.overlap", "3e-06"},
    {rectangle, "limits.obstacle_overlap", "0.001"},
    {rectangle, "limits.obstacle_depth", "0.2"},
    {rectangle, "figure[2].every", "1e-05"},
    {rectangle, "figure[2].speed", "1e-05"},
    {rectangle, "figure[2].curves", "\"energy\""},
    {rectangle, "figure[3].over", "\"time\""},
    {rectangle, "figure[0].aspect", "5"},
    {rectangle, "figure[0].panel", "true"},
    {rectangle, "figure[0].measured", "[[0.001, 0.002], [0.003, 0.004]]"},
    {rectangle, "figure[0].measured_by", "\"Somebody, 1990\""},
    {rectangle, "expect.energy_residual.below", "0.001"},
    {rectangle, "expect.energy_residual.above", "-1"},
    {rectangle, "expect.max_tip_speed.below", "\"0.65 cR\""},
    {rectangle, "expect.first_growth_time.at_least", "1e-05"},
    {rectangle, "expect.first_growth_time.at_most", "1.2e-05"},
    {rectangle, "expect.dissipated.value", "0.012"},
    {rectangle, "expect.dissipated.within", "\"7 %\""},
    {rectangle, "sweep.set", "[\"mesh.size=1 mm,2 mm\"]"},
    {rectangle, "sweep.seeds", "20"},
    {rectangle, "sweep.quantities", "[\"broken_length\", \"fragments\"]"},
    {rectangle, "sweep.show", "\"materials\""},
    {rectangle, "study.refine", "\"both\""},
    {rectangle, "study.levels", "[1, 2.5]"},
    {rectangle, "study.seeds", "12"},
    {rectangle, "study.reference", "\"finest\""},
    {rectangle, "study.set", "[\"mesh.size=2 mm\", \"figure=\"]"},
    {rectangle, "study.line[0].name", "\"fine steps\""},
    {rectangle, "study.line[0].set", "[\"time.safety=0.4\"]"},
    {rectangle, "study.line[0].levels", "[3, 4]"},
    {rectangle, "study.quantity[0].of", "\"dissipated\""},
    {rectangle, "study.quantity[0].exact", "0.012"},
    {rectangle, "study.quantity[0].scale", "2"},
    {rectangle, "study.quantity[0].name", "\"surface\""},
    {rectangle, "study.quantity[1].at", "1e-05"},
    {rectangle, "study.quantity[1].exact", "0.001"},
    {rectangle, "study.quantity[2].reaches", "3e-06"},
    {rectangle, "study.quantity[2].exact", "2e-05"},
    {rectangle, "study.quantity[2].since", "\"middle_slip\""},
    {rectangle, "study.quantity[3].largest", "true"},
    {rectangle, "study.quantity[4].slope", "[2e-06, 1e-05]"},
    {rectangle, "study.quantity[4].exact", "3000"},
    {rectangle, "study.safety.laws", "[\"default\"]"},
    {rectangle, "study.safety.factors", "[1, 4]"},
    {rectangle, "study.safety.tolerance", "0.01"},
    {rectangle, "study.safety.criterion", "\"runaway\""},
    {rectangle, "study.safety.runaway", "0.001"},
    {schemes, "study.schemes", "[\"explicit/explicit\", \"implicit/implicit\"]"},
    {polygon, "domain.points", "[[0, 0], [0.01, 0], [0.01, 0.01], [0, 0.01]]"},
    {polygon, "domain.arcs[0].side", "3"},
    {polygon, "domain.arcs[0].through", "[0.005, 0.012]"},
    {polygon, "domain.sides", "[\"floor\", \"wall\", \"lid\", \"wall\"]"},
    {disc, "domain.centre", "[0.001, 0.002]"},
    {disc, "domain.radius", "0.01"},
    {scene, "body[0].shape", "\"rectangle\""},
    {scene, "body[0].name", "\"body1\""},
    {scene, "body[0].size", "[0.1, 0.04]"},
    {scene, "body[0].origin", "[0.001, 0.002]"},
    {scene, "body[0].angle", "10"},
    {scene, "body[0].snap", "5e-05"},
    {scene, "body[0].material", "\"glass\""},
    {scene, "body[0].mesh_size", "0.002"},
    {scene, "body[0].velocity", "[1, 2]"},
    {scene, "body[0].spin", "90"},
    {scene, "body[0].hole[0].points", "[[0.011, 0.012], [0.013, 0.012], [0.013, 0.014]]"},
    {scene, "body[0].hole[0].arcs[0].side", "2"},
    {scene, "body[0].hole[0].arcs[0].through", "[0.0135, 0.013]"},
    {scene, "body[0].hole[0].name", "\"window\""},
    {scene, "body[0].hole[1].centre", "[0.02, 0.02]"},
    {scene, "body[0].hole[1].radius", "0.004"},
    {scene, "body[0].crack[0].points", "[[0.03, 0.02], [0.04, 0.02]]"},
    {scene, "body[0].crack[0].interface", "\"default\""},
    {scene, "traces[0].file", "\"" KNAP_SOURCE_DIR "/tests/scenario/data/traces.csv\""},
    {scene, "traces[0].property", "\"class\""},
    {scene, "traces[0].class", "\"joint\""},
    {scene, "traces[0].unit", "0.01"},
    {scene, "traces[0].origin", "[-0.125, -0.02]"},
    {scene, "traces[0].crop", "true"},
    {scene, "traces[0].interface", "\"default\""},
    {scene, "traces[0].body", "\"body3\""},
    {scene, "body[0].region[0].box", "[0.05, 0.01, 0.06, 0.03]"},
    {scene, "body[0].region[0].material", "\"steel\""},
    {scene, "body[0].region[1].centre", "[0.07, 0.02]"},
    {scene, "body[0].region[1].radius", "0.005"},
    {scene, "body[0].region[2].points", "[[0.08, 0.03], [0.09, 0.03], [0.085, 0.035]]"},
    {scene, "body[0].region[2].arcs[0].side", "1"},
    {scene, "body[0].region[2].arcs[0].through", "[0.085, 0.028]"},
    {scene, "body[1].name", "\"cap\""},
    {scene, "body[1].points", "[[0.2, 0], [0.21, 0], [0.21, 0.01], [0.2, 0.01]]"},
    {scene, "body[1].sides", "[\"floor\", \"wall\", \"lid\", \"wall\"]"},
    {scene, "body[1].arcs[0].side", "3"},
    {scene, "body[1].arcs[0].through", "[0.205, 0.012]"},
    {scene, "body[1].mesh_size", "0.001"},
    {scene, "body[1].material", "\"steel\""},
    {scene, "body[2].name", "\"body3\""},
    {scene, "body[2].centre", "[0.15, 0.05]"},
    {scene, "body[2].radius", "0.01"},
    {scene, "body[2].shift", "[0.001, 0]"},
    {scene, "sweep.random.members", "5"},
    {scene, "sweep.random.seed", "9"},
    {scene, "sweep.random.file", "\"" KNAP_SOURCE_DIR "/tests/scenario/data/members.csv\""},
    {scene, "sweep.random.vary[0].key", "\"body.cap.shift.x\""},
    {scene, "sweep.random.vary[0].uniform", "[-0.001, 0.001]"},
    {scene, "sweep.random.vary[1].normal", "[10, 57.29577951308232]"},
    {scene, "sweep.random.vary[1].within", "[0, 90]"},
    {scene, "sweep.random.vary[2].lognormal", "[1.9e+11, 1e+10]"},
    {scene, "sweep.random.vary[3].choice", "[\"plane strain\", \"plane stress\"]"},
    {scene, "output.trajectories", "true"},
    {scene, "load[0].on.body", "\"cap\""},
    {scene, "absorb[0].on.body", "\"cap\""},
    {scene, "support[0].on.body", "\"body3\""},
    {scene, "pressure[0].from.body", "\"body1\""},
    {scene, "initial[0].body", "\"cap\""},
    {scene, "initial[0].spin", "45"},
    {scene, "inclusions[0].body", "\"cap\""},
    {scene, "joints[0].body", "\"body3\""},
    {patterns, "bodies[0].name", "\"dam\""},
    {patterns, "bodies[0].pattern", "\"wall\""},
    {patterns, "bodies[0].columns", "3"},
    {patterns, "bodies[0].rows", "2"},
    {patterns, "bodies[0].block", "[0.02, 0.01]"},
    {patterns, "bodies[0].bond", "0.25"},
    {patterns, "bodies[0].gap", "0.001"},
    {patterns, "bodies[0].origin", "[0.005, 0.006]"},
    {patterns, "bodies[0].angle", "10"},
    {patterns, "bodies[0].material", "\"steel\""},
    {patterns, "bodies[0].mesh_size", "0.002"},
    {patterns, "bodies[0].velocity", "[0, 2]"},
    {patterns, "bodies[0].spin", "30"},
    {patterns, "bodies[1].name", "\"voronoi\""},
    {patterns, "bodies[1].box", "[0.2, 0, 0.26, 0.04]"},
    {patterns, "bodies[1].size", "0.02"},
    {patterns, "bodies[1].spread", "0.1"},
    {patterns, "bodies[3].shift", "[0.001, 0]"},
    {patterns, "bodies[2].fraction", "0.2"},
    {patterns, "bodies[2].distance", "0.002"},
    {patterns, "bodies[2].corners", "5"},
    {patterns, "bodies[2].elongation", "1.5"},
    {patterns, "bodies[2].direction", "20"},
    {patterns, "bodies[3].number", "3"},
    {patterns, "bodies[3].distance", "1e-04"},
    {patterns, "contact.friction", "0.6"},
    {patterns, "contact.restitution", "0.3"},
    {patterns, "contact.pair[0].materials", "[\"steel\", \"glass\"]"},
    {patterns, "contact.pair[0].friction", "0.4"},
    {patterns, "contact.pair[0].restitution", "0.1"},
    {patterns, "rigid.step", "0.001"},
    {patterns, "rigid.thaw", "0.4"},
    {patterns, "rigid.hold", "30"},
    {patterns, "rigid.smallest", "0.003"},
    {patterns, "rigid.sleep", "0.01"},
    {patterns, "rigid.restitution", "0.8"},
    {patterns, "contact.pair[1].R_N", "0.2"},
    {patterns, "contact.pair[1].R_T", "0.4"},
    {of_bodies, "contact.R_N", "0.3"},
    {of_bodies, "contact.R_T", "0.7"},
    {patterns, "support[0].beyond", "0.03"},
    {patterns, "limits.contact_depth", "0.05"},
    {warm, "material.steel.expansion_table", "[[20, 0], [573, 0.009], [583, 0.015]]"},
    {warm, "material.glass.expansion", "8e-06"},
    {warm, "material.glass.conductivity_table", "[[0, 30], [100, 20]]"},
    {warm, "material.glass.heat_capacity_table", "[[0, 880], [100, 900]]"},
    {warm, "material.glass.latent_heat", "3000"},
    {warm, "material.glass.freezing_range", "[-2, -0.5]"},
    {warm, "interface.weak.strength_table", "[[-10, 1], [-0.5, 0.3], [0, 0.001]]"},
    {warm, "interface.weak.friction_table", "[[-10, 0.7], [0, 0.5]]"},
    {warm, "pressure[0].pressure_table", "[[-4, 5e+06], [0, 0]]"},
    {warm, "material.steel.conductivity", "45"},
    {warm, "material.steel.heat_capacity", "460"},
    {warm, "heat.reference", "20"},
    {warm, "heat.temperature", "\"20 + 100*x\""},
    {warm, "heat.ramp", "0.002"},
    {mapped_heat, "heat.temperature", "\"" KNAP_SOURCE_DIR "/tests/scenario/data/temperature.csv\""},
    {warm, "heat.conduction", "true"},
    {warm, "heat.every", "5"},
    {warm, "heat.time_factor", "100"},
    {warm, "heat.gap_conductivity", "0.6"},
    {warm, "heat.closed_conductance", "1e+05"},
    {warm, "heat.exchange[0].temperature", "300"},
    {warm, "heat.exchange[0].on.boundary", "\"left\""},
    {warm, "heat.exchange[0].table", "[[0, 0], [0.001, 1]]"},
    {warm, "heat.exchange[1].on.box", "[0, 0, 1, 1]"},
    {warm, "heat.exchange[1].outside", "20"},
    {warm, "heat.exchange[1].transfer", "50000"},
    {warm, "heat.exchange[1].ramp", "1e-06"},
    {warm, "heat.exchange[2].flux", "1000"},
    {warm, "heat.exchange[3].source", "2e+06"},
    {warm, "limits.temperature_overshoot", "0.01"},
    {warm, "figure[0].mark", "[50, 60]"},
    {mesh_file, "mesh.file", "\"" KNAP_SOURCE_DIR "/tests/mesh/data/block_41_ascii.msh\""},
    {mesh_file, "mesh.unit", "0.001"},
    {mesh_file, "mesh.cracks", "[\"crack\"]"},
    {mesh_file, "mesh.material", "\"glass\""},
    {mesh_file, "mesh.grains", "true"},
    {mesh_file, "mesh.joint[0].curve", "\"joint\""},
    {mesh_file, "mesh.joint[0].interface", "\"default\""},
    {slate, "material.glass.bedding.E", "2e+10"},
    {slate, "material.glass.bedding.nu", "0.15"},
    {slate, "material.glass.bedding.G", "9e+09"},
    {slate, "material.glass.bedding.angle", "30"},
    {slate, "interface.default.strength_over_bedding", "[[0, 0.2], [30, 1]]"},
    {slate, "interface.default.energy_over_bedding", "[[10, 0.5], [90, 1]]"},
    {rock, "interface.default.softening", "\"power\""},
    {rock, "interface.default.exponent", "3"},
    {norm, "interface.default.coupling", "\"norm\""},
    {pressed, "interface.default.friction_over_pressure", "[[0, 0], [2e+06, 3e+06]]"},
    {rock, "interface.default.unloading", "\"secant\""},
    {rock, "interface.default.G_II", "6"},
    {rock, "interface.default.mode_mix", "\"benzeggagh-kenane\""},
    {rock, "interface.default.mix_exponent", "2"},
    {rock, "interface.default.kinetic_friction", "0.1"},
    {rock, "interface.default.slip_distance", "0.001"},
    {rock, "interface.default.relaxation_time", "1e-06"},
    {rock, "interface.default.incubation_time", "2e-06"},
    {rock, "interface.within.plateau", "0.6"},
    {rock, "interface.weak.table", "[[0, 3], [0.5, 1], [2, 0]]"},
    {rock, "interface.default.scatter.kind", "\"weibull\""},
    {rock, "interface.default.scatter.modulus", "8"},
    {rock, "interface.default.scatter.of", "[\"sigma_c\", \"G_c\"]"},
    {rock, "interface.default.scatter.length", "0.001"},
    {rock, "interface.default.scatter.lowest", "0.1"},
    {rock, "interface.default.scatter.highest", "3"},
    {rock, "interface.within.scatter.deviation", "0.05"},
    {rock, "interface.within.scatter.area", "2e-06"},
    {rock, "interface.weak.scatter.correlation", "0.003"},
    {rock, "grains[0].size", "0.005"},
    {rock, "grains[0].spread", "0.3"},
    {rock, "grains[0].elongation", "1.5"},
    {rock, "grains[0].direction", "30"},
    {rock, "grains[0].in", "\"quartz\""},
    {rock, "grains[0].mineral[0].material", "\"glass\""},
    {rock, "grains[0].mineral[0].fraction", "0.2"},
    {rock, "inclusions[0].size", "0.004"},
    {rock, "inclusions[0].fraction", "0.05"},
    {rock, "inclusions[0].spread", "0.1"},
    {rock, "inclusions[0].distance", "0.001"},
    {rock, "inclusions[0].corners", "5"},
    {rock, "inclusions[0].elongation", "2"},
    {rock, "inclusions[0].direction", "10"},
    {rock, "inclusions[0].material", "\"quartz\""},
    {rock, "inclusions[1].number", "12"},
    {rock, "inclusions[1].distance", "5e-04"},
    {rock, "inclusions[1].name", "\"bubbles\""},
    {rock, "joints[0].direction", "60"},
    {rock, "joints[0].spread", "5"},
    {rock, "joints[0].spacing", "0.02"},
    {rock, "joints[0].persistence", "0.5"},
    {rock, "joints[0].length", "0.01"},
    {rock, "joints[0].interface", "\"weak\""},
    {rock, "joints[1].thickness", "0.002"},
    {rock, "pressure[0].pressure", "2e+06"},
    {rock, "pressure[0].from.boundary", "\"top\""},
    {rock, "pressure[0].from.box", "[0, 0.04, 0.01, 0.042]"},
    {rock, "pressure[0].ramp", "1e-05"},
    {rock, "pressure[0].name", "\"water\""},
    {rock, "pressure[0].gradient", "9810"},
    {rock, "pressure[0].level", "0.04"},
    {rock, "pressure[0].process_zone", "true"},
    {rock, "pressure[1].pressure", "\"1e5 - 1e5*x\""},
    {rock, "pressure[2].rate", "0.001"},
    {rock, "pressure[2].storage", "1e-12"},
    {rock, "pressure[3].joints", "\"weak\""},
    {rock, "pressure[3].table", "[[0, 0], [1e-05, 1]]"},
    {rock, "joints[1].material", "\"quartz\""},
    {painted, "map[0].file", "\"" KNAP_SOURCE_DIR "/tests/scenario/data/two_halves.png\""},
    {painted, "map[0].box", "[0, 0, 0.1, 0.04]"},
    {painted, "map[0].grains", "true"},
    {painted, "map[0].least_pixels", "4"},
    {painted, "map[0].smooth", "true"},
    {painted, "map[0].colour[0].rgb", "\"#C01020\""},
    {painted, "map[0].colour[0].material", "\"glass\""},
};

std::string value(const ReadResult& result, const std::string& path) {
    return result.values.has(path) ? toml_text(*result.values.find(path)) : "(none)";
}

}  // namespace

TEST_CASE("keys: each is read and survives the resolved scenario") {
    for (const Case& c : cases) {
        CAPTURE(std::string(c.path));
        const ReadResult once = samples::read(c.text);
        CHECK(value(once, c.path) == c.expected);
        const ReadResult twice = samples::read(resolved_toml(once));
        CHECK(value(twice, c.path) == c.expected);
        CHECK(resolved_toml(twice) == resolved_toml(once));
    }
}

TEST_CASE("keys: each is in the test above and is found by its pattern") {
    std::set<std::string> tested{"load[].csv",
                                 "obstacle[].csv",
                                 "pressure[].csv",
                                 "interface.*.csv",
                                 "interface.*.friction_csv",
                                 "heat.csv",
                                 "heat.table",
                                 "heat.exchange[].csv",
                                 "heat.exchange[].on.body",
                                 "obstacle[].table_period",
                                 "pressure[].table_period",
                                 "heat.table_period",
                                 "heat.exchange[].table_period"};  // the same readers, with tests of their own
    for (const Case& c : cases) tested.insert(pattern_of(c.path));
    std::set<std::string_view> seen;
    for (const Key& key : keys()) {
        CAPTURE(std::string(key.path));
        CHECK(seen.insert(key.path).second);
        CHECK(find_key(key.path) == &key);
        CHECK_FALSE(key.doc.empty());
        const bool table = key.kind == Kind::table || key.kind == Kind::list || key.kind == Kind::names;
        if (!table) CHECK(tested.contains(std::string(key.path)));
        if (!key.parent().empty()) CHECK(find_key(key.parent()) != nullptr);
    }
}

TEST_CASE("scenario: the structs hold the values of the file") {
    const Scenario s = samples::read(rectangle).scenario;
    CHECK(s.name == "all-1");
    CHECK(s.seed == 7);
    CHECK(s.mesh.seed == 7);
    CHECK(s.plane == PlaneModel::stress);
    CHECK(s.thickness == 2e-3);
    REQUIRE(s.bodies.at(0).shape.outer.points.size() == 4);
    CHECK(s.bodies.at(0).shape.outer.points[2] == Vec2(-0.05 + 0.1, 0.001 + 0.04));
    CHECK(s.boundary_names() == std::vector<std::string>{"bottom", "right", "top", "left", "window", "hole2"});
    CHECK(s.bodies.at(0).shape.outer.boundary == std::vector<Index>{0, 1, 2, 3});
    REQUIRE(s.bodies.at(0).shape.holes.size() == 2);
    CHECK(s.bodies.at(0).shape.holes[0].boundary == std::vector<Index>(s.bodies.at(0).shape.holes[0].points.size(), 4));
    CHECK(s.bodies.at(0).shape.holes[0].points.size() == 3 + 4);  // an arc of 2.32 mm in sides of 0.5 mm
    CHECK(s.bodies.at(0).shape.holes[1].points.size() == 13);     // 2 pi 2 mm / 1 mm
    REQUIRE(s.bodies.at(0).shape.regions.size() == 3 + 3);        // those of excavations follow
    CHECK(s.bodies.at(0).shape.regions[3].only_line);
    REQUIRE(s.materials.size() == 2);
    CHECK(s.materials[0].name == "steel");  // the order of the file, not of the alphabet
    CHECK(s.bodies.at(0).shape.regions[0].tag == 0);
    CHECK(s.bodies.at(0).shape.regions[2].tag == 1);
    REQUIRE(s.mesh.refine.size() == 2);
    CHECK(s.mesh.refine[0].size == 0.5e-3);
    CHECK(s.mesh.refine[0].box.high == Vec2(0.01, 0.041));
    CHECK(s.mesh.refine[1].line.size() == 1);
    CHECK(s.mesh.refine[1].half_width == 2e-3);
    REQUIRE(s.laws.size() == 4);
    CHECK(s.law_of_pair == std::vector<std::vector<Index>>{{0, 1}, {1, 2}});
    CHECK_FALSE(s.laws[0].law.breakable());
    CHECK(s.laws[1].law.friction == 0.3);
    CHECK(s.laws[2].measured_G_c == tests::relative(2, 1e-15));
    CHECK(s.laws[2].law.G_c == tests::relative(2 / 1.125, 1e-15));  // the surplus in data/toughness.csv
    CHECK(s.laws[2].measured_sigma_c == 2e6);
    CHECK(s.laws[2].law.sigma_c == tests::relative(2e6 / 1.25, 1e-15));  // likewise data/strength.csv
    CHECK(s.laws[2].law.delta_c() == tests::relative(2e-6 / 1.125 * 1.25, 1e-15));
    REQUIRE(s.supports.size() == 2);
    CHECK(s.supports[0].law == 3);
    CHECK(s.supports[0].glued);
    CHECK(s.supports[1].gap == 1e-6);
    CHECK(s.supports[0].on.box->high == Vec2(0.01, 0.002));
    REQUIRE(s.loads.size() == 8);
    CHECK(s.loads[0].kind == Load::Kind::traction);
    CHECK(s.loads[0].on.boundary == "top");
    CHECK(s.loads[0].history(5e-6) == relative(0.5));
    CHECK(s.loads[0].history(1) == 1);
    CHECK(s.loads[1].kind == Load::Kind::velocity);
    CHECK_FALSE(s.loads[1].value[0].has_value());
    CHECK(s.loads[1].value[1] == 1.0);
    CHECK(s.loads[1].history(15e-6) == relative(0.75));
    CHECK(s.loads[2].kind == Load::Kind::displacement);
    CHECK(s.loads[2].history(3) == 1);
    CHECK(s.loads[3].kind == Load::Kind::body_force);
    CHECK(s.loads[3].on.boundary.empty());
    CHECK(s.loads[4].kind == Load::Kind::acceleration);
    CHECK(s.loads[5].kind == Load::Kind::force);
    CHECK(s.loads[5].value[1] == 1000.0);
    CHECK(s.loads[6].kind == Load::Kind::stress);
    CHECK(s.loads[6].stress == std::array<double, 3>{-5e6, -5e6, 0});
    CHECK(s.loads[7].kind == Load::Kind::stress);
    CHECK(s.loads[7].stress == std::array<double, 3>{-2e6, -1e6, 3e3});
    CHECK(s.initial_velocities.at(0).value == Vec2(1, 2));
    CHECK(s.time.step == StepLength{1e-9});
    CHECK(s.time.scheme.damping == 3000);
    CHECK(s.time.mass_scaling == 0.02);
    CHECK(s.time.scheme.damping_of == DampingOf::motion);
    CHECK(s.time.rest.ends_run);
    CHECK(s.time.rest.below == 0.01);
    CHECK(s.time.rest.duration == tests::relative(5e-6, 1e-15));
    REQUIRE(s.excavations.size() == 3);
    CHECK(s.excavations[0].outline.size() > 3);
    CHECK(s.excavations[0].at == 20e-6);
    CHECK(s.excavations[0].ramp == 10e-6);
    CHECK(s.excavations[2].outline.size() == 4);
    CHECK(s.bodies.at(0).excavations == std::vector<std::size_t>{0, 1, 2});
    CHECK(s.time.rest.not_before == tests::relative(30e-6, 1e-15));
    REQUIRE(s.time.scheme.absorbing.size() == 1);
    CHECK(s.time.scheme.absorbing[0].boundary == "top");
    CHECK(s.time.scheme.absorbing[0].box);
    CHECK(s.time.scheme.bulk == BulkScheme::explicit_lumped);
    CHECK_FALSE(s.output.fields);
    CHECK(s.figures.at(1).at == std::vector<double>{20e-6, 40e-6});
    CHECK(s.figures.at(0).range == std::vector<double>{0, 1});
    CHECK(s.figures.at(2).at.size() == 9);
    CHECK(s.figures.at(2).width == animation_width);
    REQUIRE(s.expect.size() == 5);
    CHECK(s.expect[1].unit == "cR");
    CHECK(s.expect[1].below == 0.65);
    CHECK(s.expect[3].relative);
    CHECK(s.expect[3].within == 0.07);
    CHECK(s.expect[3].value == 0.012);
}

TEST_CASE("scenario: the structs hold the obstacles") {
    const Scenario s = samples::read(rectangle).scenario;
    REQUIRE(s.obstacles.size() == 4);
    const Obstacle &wall = s.obstacles[0], &disc = s.obstacles[1], &jaw = s.obstacles[2];
    CHECK(wall.outline.normal == Vec2(1, 0));
    CHECK(wall.start.position == Vec2(-0.06, 0));
    CHECK(wall.drive[0].kind == Drive::Kind::velocity);
    CHECK(wall.is_free(1));
    CHECK(wall.drive[2].kind == Drive::Kind::displacement);  // held
    CHECK(wall.mass == 2);
    CHECK(force_at(wall, 5e-6) == Vec3(0, -1.5, 0));
    CHECK(wall.contact.friction == 0.3);
    const double mass = 2000 * 2e-3 * M_PI * 25e-6;
    CHECK(disc.mass == tests::relative(mass, 1e-14));
    CHECK(disc.inertia == tests::relative(0.5 * mass * 25e-6, 1e-14));
    CHECK(disc.is_free(2));
    CHECK((disc.initial_velocity - Vec3(0, -4, M_PI)).norm() < 1e-14);
    CHECK((jaw.start.position - Vec2(0.065, 0.005)).norm() < 1e-15);
    CHECK(jaw.outline.area() == tests::relative(1e-4, 1e-12));  // turned counterclockwise
    CHECK_FALSE(jaw.is_free());
    CHECK(jaw.drive[0].value == -1e-3);
    CHECK(jaw.drive[0].history(5e-6) == relative(0.5));
    CHECK(jaw.drive[2].value == tests::relative(1, 1e-14));
}

TEST_CASE("scenario: the structs hold the refinement during the run") {
    const std::string text = samples::changed(
        "size = [0.1, 0.04]\n", "size = [0.1, 0.04]\n[[domain.crack]]\npoints = [[0, 0.02], [0.05, 0.02]]\n", adaptive);
    const Scenario s = samples::read(text).scenario;
    CHECK(s.adapt.size == 1e-4);
    CHECK(s.adapt.load == 0.25);
    CHECK(s.adapt.margin == 12);
    CHECK(s.adapt.every == 100);
    CHECK(s.adapt.limit == 2e6);
    CHECK(s.adapt.coarse == s.mesh.size);
    CHECK(s.adapt.grading == s.mesh.grading);
    CHECK(s.works().adaptation);
    REQUIRE(s.bodies.at(0).mesh.refine.size() == 1);  // the tip; the other end is on the border
    CHECK_FALSE(samples::read(samples::least).scenario.adapt.active());
}

TEST_CASE("scenario: the structs hold changes between the schemes") {
    const TimeOptions time = samples::read(changing).scenario.time;
    CHECK(time.scheme.bulk == BulkScheme::automatic);
    CHECK(time.scheme.cohesion == CohesionScheme::implicit_beta);  // of the implicit steps
    CHECK(time.change.quiet_below == 1e-3);
    CHECK(time.change.quiet_for == tests::relative(3e-3, 1e-15));
}

TEST_CASE("scenario: the structs hold the implicit path") {
    const TimeOptions time = samples::read(implicit).scenario.time;
    CHECK(time.scheme.bulk == BulkScheme::implicit_theta);
    CHECK(time.scheme.cohesion == CohesionScheme::implicit_beta);
    CHECK(time.scheme.theta == 0.6);
    CHECK(time.scheme.mass == MassMatrix::consistent);
    CHECK_FALSE(time.scheme.respect_assumption_1);
    CHECK(time.start_in_equilibrium);
    CHECK(time.step == StepLength{20, true});
    CHECK(time.step.seconds(2e-9) == tests::relative(40e-9, 1e-15));
    CHECK(time.step_cracking == StepLength{1e-7});
    CHECK(time.step_min.seconds(2e-9) == tests::relative(2e-12, 1e-15));
}

TEST_CASE("scenario: defaults") {
    const Scenario s = samples::read(samples::least).scenario;
    CHECK(s.name == "sample");
    CHECK(s.seed == 1);
    CHECK(s.plane == PlaneModel::strain);
    CHECK_FALSE(s.large_rotation);
    CHECK(s.thickness == 1);
    CHECK(s.mesh.min_angle == 20);
    CHECK(s.order == 1);
    CHECK(s.mesh.grading == 0.3);
    CHECK(s.time.step == StepLength{});
    CHECK(s.time.step_cracking == StepLength{});
    CHECK_FALSE(s.time.start_in_equilibrium);
    CHECK(s.time.scheme.respect_assumption_1);
    CHECK(s.time.scheme.mass == MassMatrix::lumped);
    CHECK(s.time.safety == 0.8);
    CHECK(s.output.every == 80e-6 / 40);
    CHECK(s.output.history_every == 80e-6 / 400);
    CHECK(s.laws.at(0).law.gamma == 1);
    CHECK(s.laws.at(0).law.restitution == 0);
    CHECK(s.law_of_pair == std::vector<std::vector<Index>>{{0}});
    CHECK(samples::read(samples::least + "[[figure]]\nfile = \"a.png\"\n").scenario.figures.at(0).at ==
          std::vector<double>{80e-6});
}

TEST_CASE("scenario: polygon and disc") {
    const Scenario p = samples::read(polygon).scenario;
    CHECK(p.boundary_names() == std::vector<std::string>{"floor", "wall", "lid"});
    std::vector<Index> in_order = p.bodies.at(0).shape.outer.boundary;
    in_order.erase(std::unique(in_order.begin(), in_order.end()), in_order.end());
    CHECK(in_order == std::vector<Index>{0, 1, 2, 1});
    CHECK(p.bodies.at(0).shape.outer.points.size() == 4 + 11);  // a lid of 11.03 mm
    const std::string unnamed = samples::changed("sides = [\"floor\", \"wall\", \"lid\", \"wall\"]\n", "", polygon);
    CHECK(samples::read(unnamed).scenario.boundary_names() ==
          std::vector<std::string>{"side1", "side2", "side3", "side4"});
    const Scenario d = samples::read(disc).scenario;
    CHECK(d.bodies.at(0).shape.outer.points.size() == 63);  // 2 pi 10 mm / 1 mm
    CHECK(d.boundary_names() == std::vector<std::string>{"rim"});
    for (const Vec2& point : d.bodies.at(0).shape.outer.points)
        CHECK((point - Vec2(1e-3, 2e-3)).norm() == tests::relative(10e-3));
}

TEST_CASE("scenario: a softening law from a csv file is part of the resolved scenario") {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_scenario_softening";
    std::filesystem::create_directories(directory);
    const auto write = [&](const char* content) { std::ofstream(directory / "curve.csv") << content; };
    std::ofstream(directory / "s.toml") << samples::changed("G_c = 3\n",
                                                            "G_c = 3\nsoftening = \"table\"\ncsv = \"curve.csv\"\n");
    const auto read = [&] { return read_scenario(directory / "s.toml"); };
    write("opening [mm], stress [MPa]\n0, 3\n0.1, 1\n0.5, 0\n");
    const ReadResult found = read();
    REQUIRE(found.scenario.laws[0].law.softening);
    CHECK(found.scenario.laws[0].law.softening->traction(found.scenario.laws[0].law.softening->final_opening() / 5) ==
          tests::relative(1. / 3, 1e-12));
    CHECK(found.values.find("interface.default.csv") == nullptr);
    const ReadResult again = samples::read(resolved_toml(found));
    CHECK(again.scenario.laws[0].law.softening->knots() == found.scenario.laws[0].law.softening->knots());
    for (const auto& [content, code] : {std::pair{"0, 3\n0.1, 4\n0.5, 0\n", "out-of-range"},
                                        {"0, 3\n0.1, 1\n0.05, 0\n", "bad-csv"},
                                        {"traction, opening\n0, 3\n0.5, 0\n", "bad-csv"},
                                        {"0, 3\n0.5, one\n", "bad-csv"}}) {
        write(content);
        CAPTURE(content);
        const std::vector<Diagnostic> mistakes = samples::mistakes_of(read);
        REQUIRE(!mistakes.empty());
        CHECK(mistakes[0].code == code);
    }
    std::filesystem::remove_all(directory);
}

TEST_CASE("scenario: temperatures from a csv file") {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_scenario_grid";
    std::filesystem::create_directories(directory);
    const auto read = [&](const std::string& lines) {
        std::ofstream(directory / "s.toml") << samples::least + "[heat]\ntemperature = \"T.csv\"\n";
        std::ofstream(directory / "T.csv") << lines;
        return read_scenario(directory / "s.toml");
    };
    const ReadResult result = read("x, y, T\n# comment\n0; 0; 20\r\n1 0 30 # corner\n\n0, 1, 40\n1\t1\t70\n");
    CHECK(result.scenario.heat->field_at({0.5, 0.5}, 3) == tests::relative(40, 1e-15));
    CHECK(result.scenario.heat->field.is_constant());
    CHECK(result.scenario.files.at(0).name == "temperature.csv");
    for (const auto& [lines, line, message] : {std::tuple{"0,0,20\n0,1\n", 2, "as all others"},
                                               {"0,0,20\n0,0 m,3\n", 2, "as all others"},
                                               {"# nothing\n", 0, "no line"},
                                               {"0,0,20\n1,1,20\n", 0, "no line for x = 1, y = 0"},
                                               {"0,0,20\n0,0,20\n", 0, "second line"}}) {
        CAPTURE(lines);
        try {
            read(lines);
            FAIL("read");
        } catch (const UserError& error) {
            CHECK(error.diagnostics[0].code == "bad-csv");
            CHECK(error.diagnostics[0].line == line);
            CHECK_MESSAGE(error.diagnostics[0].message.find(message) != std::string::npos,
                          error.diagnostics[0].message);
        }
    }
    std::filesystem::remove_all(directory);
}

TEST_CASE("scenario: a table with a period repeats until the end of the run") {
    const auto load = [](const std::string& keys) {
        return samples::least + "[[load]]\non = \"top\"\ntraction = [0, 1]\n" + keys;
    };
    const std::string of_least = "table = [[0, 0], [\"1 us\", 2], [\"2 us\", 1]]\n";
    const ReadResult result = samples::read(load(of_least + "table_period = \"3 us\"\n"));
    const double end = result.scenario.time.end;
    REQUIRE(end > 9e-6);
    const TimeFunction& factor = result.scenario.loads.at(0).history;
    double sum = 0;  // of one period: 1 + 1.5 + 1 us
    for (const double t : {0.25e-6, 1.5e-6, 2.5e-6})
        for (int k = 0; k * 3e-6 + t < end; ++k) CHECK(factor(k * 3e-6 + t) == relative(factor(t), 1e-9));
    for (int k = 0; k < 3; ++k)
        sum += 3e-6 *
               (factor.beyond_trapezoid(k * 3e-6, (k + 1) * 3e-6) + 0.5 * (factor(k * 3e-6) + factor((k + 1) * 3e-6)));
    CHECK(sum == relative(3 * 3.5e-6));
    CHECK(factor(2.9e-6) == 1);  // the last value stays, then the factor jumps
    CHECK(factor(3.1e-6) == relative(0.2));
    const auto refused = [&](const std::string& keys, const std::string& words) {
        try {
            samples::read(load(keys));
            FAIL("read ", keys);
        } catch (const UserError& error) {
            CHECK_MESSAGE(std::string(error.what()).find(words) != std::string::npos, error.what());
        }
    };
    refused("table_period = \"3 us\"\n", "belongs to the points of a table");
    refused("ramp = \"1 us\"\ntable_period = \"3 us\"\n", "belongs to the points of a table");
    refused(of_least + "table_period = \"1.5 us\"\n", "has times from 0 s to 2 ");
    refused("table = [[0, 0], [\"1 ps\", 1]]\ntable_period = \"1 ps\"\n", "repeats");
}

TEST_CASE("scenario: a history from a csv file is part of the resolved scenario") {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_scenario_csv";
    std::filesystem::create_directories(directory);
    const auto write = [&](const char* name, const std::string& text) { std::ofstream(directory / name) << text; };
    const std::string text = samples::least + "[[load]]\non = \"top\"\ntraction = [0, 1]\ncsv = \"pulse.csv\"\n";
    write("s.toml", text);
    write("pulse.csv", "time, factor\n# comment\n0, 0\r\n1e-6, 1 # peak\n\n3e-6; 0.25\n");
    const ReadResult result = read_scenario(directory / "s.toml");
    CHECK(result.scenario.loads.at(0).history.time == std::vector<double>{0, 1e-6, 3e-6});
    CHECK(result.scenario.loads.at(0).history.value == std::vector<double>{0, 1, 0.25});
    const Scenario again = read_scenario_text(resolved_toml(result), "elsewhere.toml").scenario;
    CHECK(again.loads.at(0).history.time == result.scenario.loads.at(0).history.time);
    CHECK(again.loads.at(0).history.value == result.scenario.loads.at(0).history.value);

    write("pulse.csv", "time [us], factor\n0, 0\n1, 1\n3, 0.25\n");
    CHECK(read_scenario(directory / "s.toml").scenario.loads.at(0).history.time[2] == tests::relative(3e-6, 1e-14));
    write("pulse.csv", "time [mm], factor\n0, 0\n1, 1\n");
    CHECK_THROWS_WITH_AS(read_scenario(directory / "s.toml"), doctest::Contains("the unit `mm`"), UserError);

    write("pulse.csv", "0, 0\n2, 1\n1, 1\nx, y\n");
    write("s.toml", text + "table_period = \"4 s\"\n");  // which has no error of its own
    try {
        read_scenario(directory / "s.toml");
        FAIL("read");
    } catch (const UserError& error) {
        REQUIRE(error.diagnostics.size() == 2);
        CHECK(error.diagnostics[0].code == "bad-csv");
        CHECK(error.diagnostics[0].line == 3);
        CHECK(error.diagnostics[0].file.ends_with("pulse.csv"));
        CHECK(error.diagnostics[1].line == 4);
    }
    std::filesystem::remove(directory / "pulse.csv");
    try {
        read_scenario(directory / "s.toml");
        FAIL("read");
    } catch (const UserError& error) {
        REQUIRE(error.diagnostics.size() == 1);
        CHECK(error.diagnostics[0].code == "missing-file");
        CHECK(error.diagnostics[0].line == 19);
    }
}

}  // namespace every_key_test
