#!/usr/bin/env python3
"""Draws a field with the cracks of one frame of a run, and its energies:

    tools/python/draw_cracks.py runs/edge_cracked_block --at 40e-6 -o cracks.png

Needs matplotlib (Debian: python3-matplotlib)."""
import argparse

import knap
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("run", help="run directory")
parser.add_argument("--at", type=float, default=np.inf, help="time in s; default the end")
parser.add_argument("--deform", type=float, default=0, help="magnification of the displacement")
parser.add_argument("-o", "--output", default="cracks.png")
options = parser.parse_args()

run = knap.read(options.run)
frame = run.frame(options.at)
bulk, interfaces = frame.bulk, frame.interfaces
x = 1e3 * (bulk.points + options.deform * bulk["displacement"][:, :2])  # mm
stress = 1e-6 * bulk["principal_stress"]  # MPa
figure, (body, curves) = plt.subplots(2, 1, figsize=(8, 7), height_ratios=[3, 2], constrained_layout=True)

low, high = np.quantile(stress, [0.01, 0.99])
field = body.tripcolor(x[:, 0], x[:, 1], bulk.cells, facecolors=stress, vmin=low, vmax=high, cmap="cividis")
figure.colorbar(field, ax=body, label="largest principal stress [MPa]", shrink=0.8)
# an interface is broken (2) or a pre-crack (3) where both of its ends are
ends = interfaces["status"][interfaces.cells] if interfaces.cells.size else np.zeros((0, 2), int)
place = 1e3 * (interfaces.points + options.deform * interfaces["displacement"][:, :2])
for status, colour in (3, "grey"), (2, "crimson"):
    body.add_collection(LineCollection(place[interfaces.cells[(ends == status).all(axis=1)]], colors=colour, linewidths=1))
body.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title=f"{run.info['title'] or run.info['name']}, {1e6 * frame.time:.4g} µs")

energy = run.table("energy")
for name in "kinetic", "strain", "dissipated", "external_work":
    curves.plot(1e6 * energy["time"], energy[name], label=name.replace("_", " "))
curves.axvline(1e6 * frame.time, color="grey", linewidth=0.5)
curves.set(xlabel="time [µs]", ylabel=f"energy [{energy.units['kinetic']}]")
curves.legend()
figure.savefig(options.output, dpi=150)
