#!/usr/bin/env python3
"""What impacts leave of the energy of the centre of mass, in the trajectories of a sweep of whole boulders:

    tools/python/impact_energies.py sweeps/rockfall_whole --speeds 16.7 28.8

A line per impact between two flights: its run, time, speed before it, angle of the path to the horizontal, energy after
over before; the last line has their number and quantiles. Trajectories need a point every 20 ms or so."""
import argparse
import pathlib

import knap
import numpy as np

g, flight = 9.81, 3  # [m/s2], points of a flight on each side of an impact

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("sweep", type=pathlib.Path)
parser.add_argument("--speeds", type=float, nargs=2, default=(0, np.inf), metavar=("LOW", "HIGH"), help="before the impact, in m/s")
options = parser.parse_args()

ratios = []
print("run,time [s],speed [m/s],angle [deg],energy after over before")
for file in sorted(options.sweep.glob("runs/*/trajectories.csv"), key=lambda path: int(path.parent.name[1:])):
    table = knap.read_csv(file)
    t, x, y, v = table["time"], table["x"], table["y"], table["speed"]
    head = 0.5 * v**2 + g * y  # [J/kg] constant in flight
    jumps = np.flatnonzero(np.abs(np.diff(head)) > 1e-6 * head.max())
    for i in jumps:  # between the points i and i + 1
        if np.any((jumps != i) & (np.abs(jumps - i) <= flight)) or i < flight or i + flight >= len(t):
            continue
        place = 0.5 * (y[i] + y[i + 1])
        before, after = 2 * (head[i] - g * place), 2 * (head[i + 1] - g * place)
        if not options.speeds[0] <= np.sqrt(before) <= options.speeds[1]:
            continue
        ratios.append(after / before)
        fall = (y[i] - y[i - 1]) / (t[i] - t[i - 1]) - 0.5 * g * (t[i] - t[i - 1])
        print(f"{file.parent.name},{t[i]:.2f},{np.sqrt(before):.2f},"
              f"{np.degrees(np.arctan2(-fall, (x[i] - x[i - 1]) / (t[i] - t[i - 1]))):.1f},{ratios[-1]:.3f}")
low, quarter, median, three, high = np.quantile(ratios, (0, 0.25, 0.5, 0.75, 1))
print(f"# {len(ratios)} impacts: {low:.2f} to {high:.2f}, quartiles {quarter:.2f}, {median:.2f}, {three:.2f}, mean {np.mean(ratios):.3f}")
