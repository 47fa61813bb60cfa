"""Tests of tools/python/knap_events.py: ctest runs them with KNAP and a directory; exit code 77: skipped."""
import pathlib
import sys
import types
import unittest

from common import np
import knap
import knap_events as events

folder = pathlib.Path(sys.argv.pop())
folder.mkdir(parents=True, exist_ok=True)
E, nu, density = 30e9, 0.25, 2500.0
mu = lame = E / 2.5


def run_of(*breaks):
    """A run with these breaks: time, x, y, angle, length, shear, energy, opening, slip."""
    names = ("time", "x", "y", "angle", "length", "shear", "energy", "opening", "slip")
    (folder / "resolved.toml").write_text(f"[domain]\nthickness = 0.5\n[material.rock]\ndensity = {density}\nE = {E}\nnu = {nu}\n")
    table = knap.Table(zip(names, np.array(breaks, float).reshape(-1, 9).T))
    return types.SimpleNamespace(tables=["breaks"], table=lambda name: table, directory=folder, info={"materials": ["rock"], "title": "", "name": "r"})


class Moments(unittest.TestCase):
    def test_slip_has_mu_a_d_and_opening_its_tensor(self):
        found = events.join(run_of((1, 0, 0, 30, 0.2, 1, 2, 0, 1e-4), (2, 0, 0, 70, 0.2, 0, 2, 1e-4, 0)))
        self.assertEqual(list(found["breaks"]), [1, 1])
        self.assertAlmostEqual(found["moment"][0] / (mu * 0.1 * 1e-4), 1, places=12)
        self.assertAlmostEqual(found["isotropic"][0], 0, places=12)
        self.assertAlmostEqual(found["moment"][1] / (0.1 * 1e-4 * np.sqrt((2 * lame**2 + (lame + 2 * mu)**2) / 2)), 1, places=12)
        self.assertAlmostEqual(found["isotropic"][1], (lame + 2 * mu / 3) / (lame + 2 * mu), places=12)
        self.assertAlmostEqual(found["magnitude"][0], 2 / 3 * (np.log10(mu * 1e-5) - 9.1), places=12)

    def test_opposite_slips_on_one_line_cancel_and_conjugate_ones_add(self):
        cancel = events.join(run_of((1, 0, 0, 30, 0.2, 1, 2, 0, 1e-4), (1, 0.1, 0, 30, 0.2, 1, 2, 0, -1e-4)))
        self.assertEqual(len(cancel["time"]), 1)
        self.assertLess(cancel["moment"][0], 1e-9)
        conjugate = events.join(run_of((1, 0, 0, 30, 0.2, 1, 2, 0, 1e-4), (1, 0.1, 0, 120, 0.2, 1, 2, 0, -1e-4)))
        self.assertAlmostEqual(conjugate["moment"][0] / (2 * mu * 0.1 * 1e-4), 1, places=12)


class Joining(unittest.TestCase):
    def test_breaks_within_a_wave_of_each_other_are_one_event(self):
        later = 0.5 / np.sqrt(mu / density)  # of a shear wave over 2.5 lengths of 0.2 m
        run = run_of((0, 0, 0, 0, 0.2, 0, 1, 1e-6, 0), (0.9 * later, 0.4, 0, 0, 0.2, 1, 3, 1e-6, 0), (1.8 * later, 0.8, 0, 0, 0.2, 0, 1, 1e-6, 0),
                     (1.8 * later, 1.4, 0, 0, 0.2, 0, 1, 1e-6, 0), (4 * later, 0, 0, 0, 0.2, 0, 1, 1e-6, 0))
        found = events.join(run)
        self.assertEqual(list(found["breaks"]), [3, 1, 1])  # a chain is one event
        self.assertAlmostEqual(found["duration"][0], 1.8 * later)
        self.assertAlmostEqual(found["shear"][0], 0.6)
        self.assertAlmostEqual(found["x"][0], 0.4 * 0.6 + 0.8 * 0.2)
        self.assertEqual(len(events.join(run, distance=10, within=1)["time"]), 1)
        self.assertEqual(len(events.join(run_of())["time"]), 0)


class Numbers(unittest.TestCase):
    def test_b_of_drawn_magnitudes_lies_within_its_error(self):
        off = []
        for seed in range(200):
            m = -4 + np.random.default_rng(seed).exponential(np.log10(np.e) / 1.3, 400)
            b, error, completeness = events.b_value(m, completeness=-4)
            off.append((b - 1.3) / error)
        self.assertLess(abs(np.mean(off)), 0.2)
        self.assertLess(abs(np.std(off) - 1), 0.15)
        self.assertTrue(np.isnan(events.b_value(m[:5])[0]))

    def test_b_of_rounded_magnitudes_is_that_of_the_exact_ones(self):
        off = []
        for seed in range(200):  # from below -4.05 on, of which -4.0 is the first complete class
            m = -4.05 + np.random.default_rng(seed).exponential(np.log10(np.e) / 1.3, 400)
            b, error, _ = events.b_value(np.round(m, 1), -4.0)
            off.append((b - 1.3) / error)
        self.assertLess(abs(np.mean(off)), 0.25)  # without the correction by 0.05 it is 3
        uncorrected, error, _ = events.b_value(np.round(m, 1), -4.0, 0.0)
        self.assertGreater(uncorrected - events.b_value(np.round(m, 1), -4.0)[0], error)
        self.assertAlmostEqual(events.b_value(np.round(m, 1))[2], -4.0)

    def test_rates_count_all_events(self):
        run = run_of(*[(t, t, 0, 0, 0.01, 0, 1, 1e-6, 0) for t in (1, 2, 3, 3.5, 10)])
        at, rate = events.rate(run, events.join(run), bins=3)
        np.testing.assert_allclose(rate * 3, [4, 0, 1])

    def test_rates_over_a_load_count_all_events_and_their_energy(self):
        run = run_of(*[(t, t, 0, 0, 0.01, 0, 1, 1e-6, 0) for t in (1, 2, 3, 3.5, 10)])
        breaks, force = run.table("breaks"), knap.Table({"time": np.array([0, 10.0]), "top_force_y": np.array([0, -20.0])}, {"top_force_y": "N"})
        run.tables, run.table = ["breaks", "reactions"], {"breaks": breaks, "reactions": force}.__getitem__
        rates = events.rates_of(run, events.join(run), "reactions.top_force_y", 3)
        np.testing.assert_allclose(rates["top_force_y"], [-17, -11, -5])
        np.testing.assert_allclose(rates["rate"] * 6, [1, 0, 4])
        np.testing.assert_allclose(rates["energy"], [1, 0, 4])
        self.assertEqual(rates.titles, ["top_force_y [N]", "events", "rate [1/N]", "energy [J]"])
        with self.assertRaises(knap.KnapError):
            events.rates_of(run, events.join(run), "reactions.top_force_z")


class Minerals(unittest.TestCase):
    def test_each_break_has_the_moduli_of_its_two_sides(self):
        run = run_of((1, 1, 0, 90, 2, 1, 2, 0, 1e-4), (2, 2, 0, 135, 2, 1, 2, 0, 1e-4))
        (folder / "resolved.toml").write_text("[material.soft]\nE = 1e10\nnu = 0.25\ndensity = 2500\n[material.stiff]\nE = 3e10\nnu = 0.25\ndensity = 2500\n")
        run.info["materials"] = ["soft", "stiff"]
        points = np.array([[1, -1], [1, 1], [0, 0], [1, -1], [3, -1], [1, 1], [3, -1], [3, 1], [1, 1]], float)
        bulk = knap.Table({"region": np.array([0, 1, 1])})
        bulk.points, bulk.cells = points, np.arange(9).reshape(3, 3)
        run.frame_times, run.frame = [0.0], lambda time: types.SimpleNamespace(bulk=bulk)
        found = events.join(run)
        np.testing.assert_allclose(found["moment"], [0.5 * (1e10 + 3e10) / 2.5 * 2e-4, 3e10 / 2.5 * 2e-4])
        run.frame_times = []
        with self.assertRaises(knap.KnapError):
            events.join(run)


class ARun(unittest.TestCase):
    def test_events_of_a_run_have_its_fracture_energy(self):
        run = knap.run("bar_pulled_apart", {"mesh.size": "1 mm", "output.breaks": True, "output.report": False, "figure": [], "expect": {}},
                       folder / "bar", threads=1)
        found = events.join(run)
        self.assertAlmostEqual(found["energy"].sum() / run.summary["dissipated"], 1, places=9)
        self.assertEqual(found["shear"].max(), 0)
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("python3-matplotlib is not installed")
        events.plot(run, found, folder / "events.png", over="energy.strain")
        self.assertGreater((folder / "events.png").stat().st_size, 10000)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
