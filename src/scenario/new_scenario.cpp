#include "scenario/write_scenario.hpp"

namespace knap {

std::string new_scenario(const std::string& name) {
    std::string text = R"(# A plate with an edge crack, pulled apart. `knap check` says what would happen, `knap run` does it, `knap schema` lists every key.
knap  = 1
name  = "NAME"
title = "Edge-cracked plate in tension"
seed  = 1                                # another seed, another mesh

[domain]
shape = "rectangle"                      # boundaries left, right, bottom, top; or "polygon", "disc"
size  = ["100 mm", "40 mm"]              # numbers without a unit are SI
model = "plane strain"
[[domain.crack]]
points = [["0 mm", "20 mm"], ["50 mm", "20 mm"]]

[mesh]
size = "1 mm"                            # mean edge length

[material.glass]
density = "2450 kg/m3"
E       = "32 GPa"
nu      = 0.2

[interface.default]                      # between all triangles; [interface.glass-steel] would be for a pair of materials
sigma_c  = "3.08 MPa"
G_c      = "3 J/m2"                      # or delta_c
friction = 0.0

[[load]]
on       = "top"
traction = ["0 MPa", "1 MPa"]            # or pressure, velocity, displacement, body_force, acceleration; add ramp = "10 us" for a slower start
[[load]]
on       = "bottom"
traction = ["0 MPa", "-1 MPa"]

[time]
end = "60 us"

[output]
every = "1 us"

[[figure]]
file = "cracks.png"
[[figure]]
file = "energy.png"
show = "energy"

[expect]                                 # what the run must find; remove what you do not know
energy_residual = { below = 1e-10 }
)";
    return text.replace(text.find("NAME"), 4, name);
}

}  // namespace knap
