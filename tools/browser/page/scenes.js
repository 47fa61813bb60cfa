"use strict";
// The scenes. `keys`: what a slider sets, each with a factor or a text of the value; `values` are those that it can have, `value` the first one.
// stress [MPa]: end of the colour scale; deform: by which displacements are magnified. All have sliders for the mesh and the seed.
const strength = (values, value, keys = [["interface.default.sigma_c"]], where = "") => ({ label: "Strength" + where, unit: "MPa", keys, values, value });
const fractureEnergy = (values, value, keys = [["interface.default.G_c"]], where = "", unit = "J/m2") =>
  ({ label: "Fracture energy" + where, unit, keys, values, value });
const sceneOf = (name, title, [stress, deform], see, sizes, size, ...sliders) => ({
  name, title, stress, deform, see, sliders: [...sliders,
    { label: "Mesh (mean edge)", unit: "mm", keys: [["mesh.size"]], values: sizes, value: size },
    { label: "Seed of mesh and random numbers", unit: "", keys: [["seed"]], values: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], value: 1 }],
});

const scenes = [
  sceneOf("edge_cracked_block", "A crack in glass", [4, 1],
    "The pull arrives at the tip after 5 µs and the crack starts between 10 and 18 µs. It runs to the right and, at the first values, branches. " +
    "With four times the fracture energy a third of that length breaks; a lower strength makes the damaged zone wider.",
    [2, 1.5, 1.2, 1, 0.8, 0.65, 0.5], 1,
    strength([1.5, 2, 2.5, 3.08, 4, 5, 6.5], 3.08),
    fractureEnergy([1, 1.5, 2, 3, 4, 6, 8, 12], 3)),
  sceneOf("bar_pulled_apart", "A bar, exact", [4, 500],
    "Only the line in the middle can break. It is broken near 102 µs, and the dissipated energy then is fracture energy times area: 12 mJ for 3 J/m2, " +
    "4 mm and 1 m, whatever the mesh and the strength are. (With more than 3.4 MPa the bar stores more energy than the line can take and snaps.)",
    [1, 0.8, 0.6, 0.4, 0.3], 0.6,
    strength([1.5, 2, 2.5, 3.08, 4, 5], 3.08, [["interface.left-right.sigma_c"]]),
    fractureEnergy([2, 2.5, 3, 4, 5], 3, [["interface.left-right.G_c"]])),
  sceneOf("granite_tension", "Grains of granite", [12, 50],
    "Grains cannot break, their borders can, with random strengths. One crack goes across along the borders, near the weakest ones; a second one often starts and stops. " +
    "Another seed is another sample of the rock.",
    [2, 1.6, 1.2, 0.9], 1.2,
    strength([5, 7.5, 10, 12.5, 15], 10,
      [["interface.default.sigma_c"], ["interface.feldspar-mica.sigma_c", 0.6], ["interface.quartz-mica.sigma_c", 0.6]], " of borders (with mica: 0.6 of it)"),
    fractureEnergy([5, 10, 20, 30, 40], 20,
      [["interface.default.G_c"], ["interface.feldspar-mica.G_c", 0.5], ["interface.quartz-mica.G_c", 0.5]], " of borders (with mica: half)")),
  sceneOf("compact_tension_concrete", "Concrete pulled fast", [8, 10],
    "The upper face of the notch is pulled up, the lower one is held. At 3.27 m/s the crack branches in two; at 1.38 m/s it is one crack that inclines towards the pulled side, " +
    "at 0.5 m/s it is nearly straight. The law of the concrete knows no rate: inertia alone does it.",
    [10, 8, 6.5, 5, 4], 5,
    { label: "Speed of the pulled face", unit: "m/s", keys: [["load[0].velocity", v => `["free", "${v} m/s"]`]], values: [0.5, 1, 1.375, 2, 2.5, 3.268, 4], value: 3.268 },
    strength([2.5, 3, 3.8, 5, 6], 3.8),
    fractureEnergy([30, 45, 65, 90, 130], 65)),
  sceneOf("kalthoff_winkler", "An impact between notches", [1200, 1],
    "A projectile hits the strip between the two notches. A wave of pressure reaches the tips, and from each a crack leaves the notch at 60 to 70 degrees, after 20 to 30 µs. " +
    "On coarse meshes the angle scatters: try other seeds.",
    [4, 3, 2.5, 2, 1.5], 2,
    strength([600, 700, 844, 1000, 1200], 844),
    fractureEnergy([10, 15, 22.13, 30, 40], 22.13, undefined, "", "kJ/m2")),
  sceneOf("crushed_grain", "A grain is crushed", [60, 1],
    "Platens press a grain of quartz and feldspar together, the upper one at 0.5 m/s. Rock is crushed where they touch; then the grain splits along the line of force. " +
    "Pieces turn and meet each other, with friction. It is the slowest scene.",
    [0.8, 0.7, 0.6, 0.5, 0.4], 0.6,
    strength([10, 15, 20, 30, 40], 20, [["interface.default.sigma_c"], ["interface.within.sigma_c", 2]], " of borders (within crystals: twice)"),
    fractureEnergy([3, 6, 9, 12], 6, [["interface.default.G_c"], ["interface.within.G_c", 2]], " of borders (within: twice)")),
];
