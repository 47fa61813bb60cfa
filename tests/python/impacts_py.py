"""Tests of tools/python/impact_energies.py: ctest runs them with KNAP and a directory; exit code 77: skipped."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

from common import np, repo, tools

folder = pathlib.Path(sys.argv.pop())
folder.mkdir(parents=True, exist_ok=True)
measured = (0.21, 1.11, 0.55, 0.42, 0.50, 0.47)  # energy after over before of a drop test (scenarios/rockfall_whole.toml)


def last_line(sweep, *more):
    """Number of impacts; least, largest, quartiles, mean of the ratios."""
    answer = subprocess.run([sys.executable, tools / "impact_energies.py", sweep, *more], capture_output=True, text=True, check=True)
    n, *ratios = map(float, re.findall(r"\d+\.?\d*", answer.stdout.splitlines()[-1]))
    return n, ratios


class Impacts(unittest.TestCase):
    def test_a_rebound_by_R_N_and_R_T_leaves_their_part(self):
        g, R_N, R_T, every = 9.81, 0.5, 0.8, 0.02
        place = folder / "exact/runs/m1"
        place.mkdir(parents=True, exist_ok=True)
        fall = np.sqrt(2 * 20 / g)  # [s] from 20 m
        t = every * np.arange(150)
        since = t - fall
        y = np.where(since < 0, 20 - 0.5 * g * t**2, R_N * g * fall * since - 0.5 * g * since**2)
        v_y = np.where(since < 0, -g * t, R_N * g * fall - g * since)
        v_x = np.where(since < 0, 10, R_T * 10)
        x = np.where(since < 0, 10 * t, 10 * fall + R_T * 10 * since)
        table = np.column_stack((t, x, y, np.hypot(v_x, v_y)))
        np.savetxt(place / "trajectories.csv", table, "%.15g", ",", header="time,x,y,speed", comments="")
        n, ratios = last_line(folder / "exact")
        self.assertEqual(n, 1)
        before = (g * fall)**2 + 100
        self.assertAlmostEqual(ratios[-1], (R_N**2 * (g * fall)**2 + R_T**2 * 100) / before, delta=0.01)  # the place of the impact: within 20 ms

    def test_drops_leave_more_than_the_drop_test(self):
        # the soil of the test is ploughed up, which neither R_N nor R_T says: the medians differ by seven standard errors and more
        subprocess.run([os.environ["KNAP"], "sweep", repo / "scenarios/rockfall_whole.toml", "-j", "1", "-q", "--force", "-s", "sweep.random.members=12",
                        "-s", "figure=[]", "-o", folder / "drops"], capture_output=True, check=True)
        n, (low, high, quarter, median, three, mean) = last_line(folder / "drops", "--speeds", "16.7", "28.8")
        self.assertGreater(n, 50)
        error = 1.25 * (three - quarter) / 1.35 / np.sqrt(n)  # of a median
        recorded = 0.84  # of a hundred drops (scenarios/results/drop_test_impacts.csv)
        self.assertLess(abs(median - recorded), 3 * error + 0.02)
        self.assertGreater(median - np.median(measured), 7 * error)
        self.assertLess(np.sort(measured)[-2], quarter)  # five of the six lie below three quarters of the drops
        self.assertLess(high, 1.2)  # as the sixth: energy of rotation that becomes one of the path


unittest.main()
