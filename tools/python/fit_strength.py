#!/usr/bin/env python3
"""Finds the strength sigma_c of the interfaces with which a specimen has a measured strength, by bisection:

    tools/python/fit_strength.py brazilian_disc --measured 6.2e6 --between 4e6 8e6 --set mesh.size="1.2 mm"

A run per step; a finer mesh, another seed or G_c change the answer, so fit with those of the study."""
import argparse
import pathlib

import knap

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scenario", help="with a [specimen]: its strength is compared")
parser.add_argument("--measured", type=float, required=True, help="measured strength in Pa")
parser.add_argument("--between", type=float, nargs=2, required=True, metavar=("LOW", "HIGH"), help="of sigma_c, in Pa")
parser.add_argument("--tolerance", type=float, default=0.01, help="of the strength, relative")
parser.add_argument("--interface", default="default", help="its sigma_c is varied")
parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="further values, as texts")
parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("runs/fit_strength"))
options = parser.parse_args()


def strength(sigma_c):
    """[Pa] of the specimen. Exit code 4 (a value of [expect] failed) is no failure here: expectations hold for the
    strength that the scenario has."""
    values = dict(text.split("=", 1) for text in options.set)
    values[f"interface.{options.interface}.sigma_c"] = f"{sigma_c} Pa"
    found = knap.run(options.scenario, values, options.output / f"{sigma_c:.6g}", accept=(0, 4)).summary["strength"]
    if found is None:
        raise SystemExit(f"sigma_c = {sigma_c:.6g} Pa: the specimen did not fail; a later time.end?")
    print(f"sigma_c = {sigma_c:.6g} Pa: strength {found:.6g} Pa", flush=True)
    return found


low, high = sorted(options.between)
if not strength(low) <= options.measured <= strength(high):
    raise SystemExit(f"the strengths at {low:g} and {high:g} Pa do not enclose {options.measured:g} Pa: widen --between")
while True:
    middle = (low + high) / 2
    found = strength(middle)
    if abs(found - options.measured) <= options.tolerance * options.measured:
        break
    if high - low < 1e-6 * high:
        raise SystemExit(f"the strength jumps at sigma_c = {middle:g} Pa: no sigma_c meets it within {options.tolerance:g}")
    low, high = (middle, high) if found < options.measured else (low, middle)
print(f"sigma_c = {middle:.6g} Pa")
