#!/usr/bin/env python3
"""Finds the strength sigma_c of the interfaces with which a specimen has a measured strength: knap-fit in its simplest case.

    tools/python/fit_strength.py brazilian_disc --measured 6.2e6 --between 4e6 8e6 --set mesh.size="1.2 mm"

A finer mesh, another seed or G_c change the answer, so fit with those of the study. More parameters, several tests and
intervals: knap-fit."""
import argparse
import pathlib

import numpy as np

from knap_fit import inference, report
from knap_fit.problem import Measured, Parameter, Problem, Test
from knap_fit.runs import Runs, Stop

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scenario", help="with a [specimen]: its strength is compared")
parser.add_argument("--measured", type=float, required=True, help="measured strength in Pa")
parser.add_argument("--between", type=float, nargs=2, required=True, metavar=("LOW", "HIGH"), help="of sigma_c, in Pa")
parser.add_argument("--tolerance", type=float, default=0.01, help="of the strength, relative")
parser.add_argument("--interface", default="default", help="its sigma_c is varied")
parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="further values, as texts")
parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("runs/fit_strength"))
options = parser.parse_args()

sigma_c = Parameter("sigma_c", [f"interface.{options.interface}.sigma_c"], sorted(options.between), "Pa", False)
test = Test("specimen", options.scenario, dict(text.split("=", 1) for text in options.set), 1, 1)
test.measured = [Measured(test, "strength", "fit", np.array([options.measured]), options.tolerance * options.measured, unit="Pa")]
problem = Problem("fit_strength", [sigma_c], [test], {"budget": 30})
runs = Runs(problem, options.output, own_seeds=False)
try:
    place, residual = inference.least_squares(problem, runs, lambda text: print(text, flush=True))
except Stop as stop:
    raise SystemExit(str(stop)) from None
report.write_least_squares(problem, runs, place, residual)
if np.abs(residual).max() > 1:
    raise SystemExit(f"no sigma_c between {sigma_c.low:g} and {sigma_c.high:g} Pa meets {options.measured:g} Pa within {options.tolerance:g}: it jumps "
                     "there, or widen --between; where runs have no value, --set time.end=...: a later one")
