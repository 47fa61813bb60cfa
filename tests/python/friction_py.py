"""Tests of tools/python/knap_friction.py: ctest runs them with KNAP and a directory; exit code 77: skipped."""
import pathlib
import subprocess
import sys
import unittest

from common import np
import knap
import knap_friction as friction

folder = pathlib.Path(sys.argv.pop())
folder.mkdir(parents=True, exist_ok=True)


def is_lawful(table):
    p, t = np.array(table).T
    slope = np.diff(t) / np.diff(p)
    return p[0] == t[0] == 0 and (np.diff(p) > 0).all() and (slope >= 0).all() and (np.diff(slope) <= 1e-9 * slope[0]).all() and len(p) <= 13


def at(table, pressure):
    return np.interp(pressure, *np.array(table).T)


def worst_facet(table, gamma, sigma_c, confinement, shift):
    """sigma_1 at which some facet yields, by search."""
    a = np.radians(np.linspace(0.5, 89.5, 20000))
    low, high = confinement, 1e10
    p, t = np.array(table).T
    last = (t[-1] - t[-2]) / (p[-1] - p[-2])
    for _ in range(200):
        mean = 0.5 * (low + high)
        normal = confinement + (mean - confinement) * np.sin(a)**2
        f = np.interp(normal + shift, p, t) + last * np.maximum(0, normal + shift - p[-1])
        yields = ((mean - confinement) * np.sin(a) * np.cos(a) > gamma * sigma_c + f).any()
        low, high = (low, mean) if yields else (mean, high)
    return low


class Tables(unittest.TestCase):
    def test_barton_and_bandis_lie_on_their_law(self):
        for JRC in (0, 4, 12, 20):
            table = friction.barton_bandis(JRC, 60e6, 28, 5e6)
            self.assertTrue(is_lawful(table))
            for p, t in table[1:]:
                angle = min(70, 28 + JRC * np.log10(60e6 / p))
                self.assertAlmostEqual(t / (p * np.tan(np.radians(angle))), 1, places=12)
            pressure = np.linspace(0.01e6, 5e6, 500)
            curve = pressure * np.tan(np.radians(np.minimum(70, 28 + JRC * np.log10(60e6 / pressure))))
            self.assertLess(np.abs(at(table, pressure) / curve - 1).max(), 0.02)  # twelve pieces

    def test_chords_miss_barton_and_bandis_by_3_percent_at_most(self):
        for JRC, up_to in ((0.5, 5e6), (4, 50e6), (8, 50e6), (10, 60e6), (20, 60e6)):
            for phi_b in (20, 28, 35):
                table = friction.barton_bandis(JRC, 60e6, phi_b, up_to)
                self.assertTrue(is_lawful(table))
                self.assertEqual(table[-1][0], up_to)
                pressure = np.geomspace(1e-5 * up_to, up_to, 5000)
                angle = np.minimum(70, phi_b + JRC * np.log10(60e6 / pressure))
                self.assertLess(np.abs(at(table, pressure) / pressure / np.tan(np.radians(angle)) - 1).max(), 0.03)
        for pieces in (1, 2, 12):
            table = friction.barton_bandis(8, 60e6, 28, 50e6, pieces=pieces)
            self.assertEqual((len(table), table[-1][0]), (pieces + 1, 50e6))

    def test_long_joints_are_smoother(self):
        short, long = (at(friction.barton_bandis(12, 60e6, 28, 2e6, length=L), 1e6) for L in (0.1, 10))
        self.assertAlmostEqual(short, at(friction.barton_bandis(12, 60e6, 28, 2e6), 1e6))
        ratio = 100**(-0.02 * 12), 100**(-0.03 * 12)
        self.assertAlmostEqual(long / at(friction.barton_bandis(12 * ratio[0], 60e6 * ratio[1], 28, 2e6), 1e6), 1)
        self.assertLess(long, 0.8 * short)

    def test_series_of_a_polygon_gives_it_back(self):
        truth = [[0, 0], [2e6, 3e6], [6e6, 5.4e6], [20e6, 8.2e6]]
        pressure = np.array([1, 2, 4, 6, 12, 20]) * 1e6
        found = friction.of_tests(pressure, at(truth, pressure))
        self.assertLess(np.abs(at(found, pressure) / at(truth, pressure) - 1).max(), 1e-9)
        self.assertTrue(is_lawful(found))

    def test_scattered_series_have_a_concave_polygon_of_least_squares(self):
        rng = np.random.default_rng(5)
        pressure = np.sort(rng.uniform(0.2e6, 20e6, 60))
        shear = 1.4e6 * (pressure / 1e6)**0.7 * rng.lognormal(0, 0.1, 60)
        found = friction.of_tests(pressure, shear)
        self.assertTrue(is_lawful(found))
        misfit = np.sum((at(found, pressure) - shear)**2)
        for factor in (0.99, 1.01):  # no multiple of it is nearer
            self.assertGreaterEqual(np.sum((factor * at(found, pressure) - shear)**2), misfit * (1 - 1e-9))
        straight = np.sum((pressure * (pressure @ shear) / (pressure @ pressure) - shear)**2)
        self.assertLess(misfit, 0.6 * straight)
        few = friction.of_tests(pressure, shear, pieces=2)
        self.assertLessEqual(len(few), 3)
        self.assertTrue(is_lawful(few))

    def test_a_level_end_is_a_piece_of_a_series_too(self):
        pressure = np.arange(1, 16) * 1e6
        shear = pressure * (31e6 - pressure) / 31e6
        shear[-1] = shear[-2] - 1e5  # so that the last piece is level
        for pieces in (1, 2, 12):
            found = friction.of_tests(pressure, shear, pieces=pieces)
            self.assertTrue(is_lawful(found))
            self.assertLessEqual(len(found), pieces + 1)

    def test_strengths_are_borne_by_the_worst_facet(self):
        confinement, strength = np.array([0, 5, 20, 60]) * 1e6, np.array([130, 210, 400, 700]) * 1e6
        for coupling, sigma_c in (("norm", 10e6), ("sum", 6e6)):
            table, gamma = friction.of_strengths(confinement, strength, sigma_c, coupling)
            self.assertTrue(is_lawful(table))
            for s3, s1 in zip(confinement, strength):
                found = worst_facet(table, gamma, sigma_c, s3, sigma_c if coupling == "sum" else 0)
                self.assertAlmostEqual(found / s1, 1, places=5)

    def test_what_no_law_bears_is_refused(self):
        for bad in (lambda: friction.barton_bandis(8, 60e6, 28, 70e6), lambda: friction.barton_bandis(25, 60e6, 28, 1e6),
                    lambda: friction.of_tests([0, 1], [0, 1]), lambda: friction.of_tests([1, 2], [0, 0]),
                    lambda: friction.of_strengths([0, 10, 20], [1, 30, 100], 1), lambda: friction.of_strengths([0, 10], [50, 55], 1),
                    lambda: friction.of_strengths([0, 20e6], [126.6e6, 404.8e6], 10.27e6, "sum")):
            with self.assertRaises(knap.KnapError):
                bad()

    def test_wrong_arguments_are_value_errors_with_what_is_allowed(self):
        def strengths(at=(0, 20e6), top=(127e6, 405e6), sigma_c=9e6, coupling="norm"):
            return lambda: friction.of_strengths(at, top, sigma_c, coupling)

        def joint(**more):
            return lambda: friction.barton_bandis(**{"JRC": 8, "JCS": 60e6, "phi_b": 28, "up_to": 5e6, **more})

        nan, inf = np.nan, np.inf
        steep = np.arange(14) * 1e6
        for bad, allowed in (
                (strengths(coupling="nrm"), '"sum" or "norm"'), (strengths(sigma_c=0), "above 0"),
                (strengths(sigma_c=-1), "above 0"), (strengths(sigma_c=nan), "above 0"),
                (strengths(sigma_c=inf), "above 0"), (strengths(top=(nan, 405e6)), "strengths above 0"),
                (strengths(top=(0, 405e6)), "strengths above 0"), (strengths(top=(127e6, inf)), "strengths above 0"),
                (strengths(at=(nan, 20e6)), "strengths above 0"), (strengths(at=(0, inf)), "strengths above 0"),
                (strengths(steep, 100e6 + 30 * steep - 4e-7 * steep**2), "1 to 12"),
                (joint(pieces=20), "1 to 12"), (joint(pieces=0), "1 to 12"), (joint(pieces=2.5), "1 to 12"),
                (joint(length=0), "above 0"), (joint(length=-1), "above 0"), (joint(length=nan), "above 0"),
                (joint(length=1, sample=0), "above 0"), (joint(JRC=nan), "0 to 20"),
                (joint(JRC=25, length=10), "0 to 20"),
                (lambda: friction.of_tests([1, 2], [1, 2], pieces=0), "1 to 12"),
                (lambda: friction.of_tests([1, 2], [1, 2], pieces=13), "1 to 12")):
            with self.assertRaises(ValueError) as caught:
                bad()
            self.assertIn(allowed, str(caught.exception))

    def test_files_and_scenarios(self):
        file = folder / "series.csv"
        file.write_text("pressure [MPa], shear [kPa]\n1, 800\n2, 1400\n5, 2600\n")
        pressure, shear = friction.read(file)
        self.assertEqual(list(pressure), [1e6, 2e6, 5e6])
        self.assertEqual(list(shear), [0.8e6, 1.4e6, 2.6e6])
        file.write_text("# shear box\n\npressure [MPa], shear [kPa] # of a joint\n1, 800\n # wet:\n2, 1400 # again\n")
        self.assertEqual([list(column) for column in friction.read(file)], [[1e6, 2e6], [0.8e6, 1.4e6]])
        scenario = folder / "joint.toml"
        scenario.write_text('knap = 1\nname = "joint"\n[domain]\nshape = "rectangle"\nsize = ["1 m", "1 m"]\n[mesh]\nsize = "0.5 m"\n'
                            '[material.rock]\ndensity = "2600 kg/m3"\nE = "30 GPa"\nnu = 0.2\n[interface.default]\nsigma_c = "0 Pa"\n'
                            + friction.toml(friction.of_tests(pressure, shear)) + '\n[time]\nend = "1 us"\n')
        checked = subprocess.run([knap.program(), "check", str(scenario)], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertIn("over pressure", checked.stdout)


unittest.main(verbosity=2)
