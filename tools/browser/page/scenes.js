"use strict";
// The scenes. `keys`: what a slider sets, each with a factor or a text of the value; `values` are those that it can have, `value` the first one.
// stress [MPa]: end of the colour scale; deform: by which displacements are magnified.
const strength = (label, keys, values, value) => ({ label, unit: "MPa", keys, values, value });
const fractureEnergy = (keys, values, value) => ({ label: "Fracture energy", unit: "J/m2", keys, values, value });
const meshSize = (values, value) => ({ label: "Mesh (mean edge)", unit: "mm", keys: [["mesh.size"]], values, value });
const seed = value => ({ label: "Seed of mesh and random numbers", unit: "", keys: [["seed"]], values: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], value });

const scenes = [
  {
    name: "edge_cracked_block", title: "A crack in glass", stress: 4, deform: 1,
    see: "The pull arrives at the tip after 5 µs and the crack starts between 10 and 18 µs. It runs to the right and, at the first values, branches. " +
      "With four times the fracture energy a third of that length breaks; a lower strength makes the damaged zone wider.",
    sliders: [
      strength("Strength", [["interface.default.sigma_c"]], [1.5, 2, 2.5, 3.08, 4, 5, 6.5], 3.08),
      fractureEnergy([["interface.default.G_c"]], [1, 1.5, 2, 3, 4, 6, 8, 12], 3),
      meshSize([2, 1.5, 1.2, 1, 0.8, 0.65, 0.5], 1), seed(1),
    ],
  },
  {
    name: "bar_pulled_apart", title: "A bar, exact", stress: 4, deform: 500,
    see: "Only the line in the middle can break. It is broken near 102 µs, and the dissipated energy then is fracture energy times area: 12 mJ for 3 J/m2, " +
      "4 mm and 1 m, whatever the mesh and the strength are. (With more than 3.4 MPa the bar stores more energy than the line can take and snaps.)",
    sliders: [
      strength("Strength", [["interface.left-right.sigma_c"]], [1.5, 2, 2.5, 3.08, 4, 5], 3.08),
      fractureEnergy([["interface.left-right.G_c"]], [2, 2.5, 3, 4, 5], 3),
      meshSize([1, 0.8, 0.6, 0.4, 0.3], 0.6), seed(1),
    ],
  },
  {
    name: "granite_tension", title: "Grains of granite", stress: 12, deform: 50,
    see: "Grains cannot break, their borders can, with random strengths. One crack goes across along the borders, near the weakest ones; a second one often starts and stops. " +
      "Another seed is another sample of the rock.",
    sliders: [
      strength("Strength of borders (with mica: 0.6 of it)",
        [["interface.default.sigma_c"], ["interface.feldspar-mica.sigma_c", 0.6], ["interface.quartz-mica.sigma_c", 0.6]], [5, 7.5, 10, 12.5, 15], 10),
      { label: "Fracture energy of borders (with mica: half)", unit: "J/m2",
        keys: [["interface.default.G_c"], ["interface.feldspar-mica.G_c", 0.5], ["interface.quartz-mica.G_c", 0.5]], values: [5, 10, 20, 30, 40], value: 20 },
      meshSize([2, 1.6, 1.2, 0.9], 1.2), seed(1),
    ],
  },
  {
    name: "compact_tension_concrete", title: "Concrete pulled fast", stress: 8, deform: 10,
    see: "The upper face of the notch is pulled up, the lower one is held. At 3.27 m/s the crack branches in two; at 1.38 m/s it is one crack that inclines towards the pulled side, " +
      "at 0.5 m/s it is nearly straight. The law of the concrete knows no rate: inertia alone does it.",
    sliders: [
      { label: "Speed of the pulled face", unit: "m/s", keys: [["load[0].velocity", v => `["free", "${v} m/s"]`]], values: [0.5, 1, 1.375, 2, 2.5, 3.268, 4], value: 3.268 },
      strength("Strength", [["interface.default.sigma_c"]], [2.5, 3, 3.8, 5, 6], 3.8),
      fractureEnergy([["interface.default.G_c"]], [30, 45, 65, 90, 130], 65),
      meshSize([10, 8, 6.5, 5, 4], 5), seed(1),
    ],
  },
  {
    name: "kalthoff_winkler", title: "An impact between notches", stress: 1200, deform: 1,
    see: "A projectile hits the strip between the two notches. A wave of pressure reaches the tips, and from each a crack leaves the notch at 60 to 70 degrees, after 20 to 30 µs. " +
      "On coarse meshes the angle scatters: try other seeds.",
    sliders: [
      strength("Strength", [["interface.default.sigma_c"]], [600, 700, 844, 1000, 1200], 844),
      { label: "Fracture energy", unit: "kJ/m2", keys: [["interface.default.G_c"]], values: [10, 15, 22.13, 30, 40], value: 22.13 },
      meshSize([4, 3, 2.5, 2, 1.5], 2), seed(1),
    ],
  },
  {
    name: "crushed_grain", title: "A grain is crushed", stress: 60, deform: 1,
    see: "Platens press a grain of quartz and feldspar together, the upper one at 0.5 m/s. Rock is crushed where they touch; then the grain splits along the line of force. " +
      "Pieces turn and meet each other, with friction. It is the slowest scene.",
    sliders: [
      strength("Strength of borders (within crystals: twice)", [["interface.default.sigma_c"], ["interface.within.sigma_c", 2]], [10, 15, 20, 30, 40], 20),
      { label: "Fracture energy of borders (within: twice)", unit: "J/m2", keys: [["interface.default.G_c"], ["interface.within.G_c", 2]], values: [3, 6, 9, 12], value: 6 },
      meshSize([0.8, 0.7, 0.6, 0.5, 0.4], 0.6), seed(1),
    ],
  },
];
