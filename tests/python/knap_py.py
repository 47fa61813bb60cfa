"""Tests of tools/python: ctest runs them with KNAP and a directory for the runs; exit code 77: skipped."""
import pathlib
import re
import subprocess
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: this python3 has no numpy (Debian: python3-numpy)")
    sys.exit(77)

tools = pathlib.Path(__file__).resolve().parents[2] / "tools" / "python"
sys.path.insert(0, str(tools))
import knap  # noqa: E402

runs = pathlib.Path(sys.argv.pop())


class OneRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = knap.run("bar_pulled_apart", {"mesh.size": "1 mm", "output.every": 10e-6, "load[0].ramp": "10 us",
                                                 "output.breaks": True, "expect": {}}, runs / "ein Stab µ", threads=1)

    def test_summary_has_numbers_with_units(self):
        summary = self.run_.summary
        self.assertEqual(self.run_.status, "done")
        self.assertAlmostEqual(summary["dissipated"], 12e-3, delta=1e-12)
        self.assertEqual((summary.units["dissipated"], summary.units["fragments"]), ("J", ""))
        self.assertTrue(np.isnan(summary["first_branch_time"]))
        self.assertEqual(summary["fragments"], 2)

    def test_tables_are_those_of_the_files(self):
        energy = self.run_.table("energy")
        self.assertEqual((energy.units["time"], energy.units["kinetic"]), ("s", "J"))
        last = (self.run_.directory / "energy.csv").read_text().splitlines()[-1].split(",")
        self.assertEqual([column[-1] for column in energy.values()], [float(text) for text in last])
        residual = (energy["kinetic"] + energy["strain"] + energy["cohesive_work"] - energy["external_work"]
                 - energy["friction_work"] - energy["impact_work"] + energy["scheme_dissipation"] - energy["step_change_work"])
        self.assertLess(np.abs(residual).max(), 1e-12 * energy["external_work"].max())
        self.assertAlmostEqual(self.run_.table("breaks")["energy"].sum(), 12e-3, delta=1e-12)
        with self.assertRaisesRegex(knap.KnapError, "no probes.csv; there are: .*energy"):
            self.run_.table("probes")
        with self.assertRaisesRegex(KeyError, "'heat'; there are: time, kinetic"):
            energy["heat"]

    def test_frames_are_the_fields(self):
        times = self.run_.frame_times
        self.assertEqual(len(times), 16)
        self.assertEqual(times[0], 0)
        self.assertAlmostEqual(times[-1], 150e-6, delta=1e-9)
        start, frame = self.run_.frame(0), self.run_.frame()
        self.assertEqual(frame.time, times[-1])
        self.assertEqual(self.run_.frame(53e-6).time, times[np.argmin(np.abs(times - 50e-6))])
        bulk = frame.bulk
        self.assertEqual(bulk.cells.shape, (self.run_.info["triangles"], 3))
        (ax, ay), (bx, by), (cx, cy) = (bulk.points[bulk.cells[:, i]].T for i in range(3))
        areas = 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
        self.assertAlmostEqual(areas.sum(), 16e-3 * 4e-3, delta=1e-15)
        squares = (bulk["velocity"] ** 2).sum(axis=1)[bulk.cells].sum(axis=1)  # each corner has a third of the mass
        kinetic = 0.5 * 2450 * (squares * areas / 3).sum()
        self.assertAlmostEqual(kinetic, self.run_.summary["kinetic_energy"], delta=1e-6 * kinetic)
        self.assertAlmostEqual(areas[bulk["region"] == 1].sum(), 8e-3 * 4e-3, delta=1e-15)
        self.assertEqual(bulk.units["velocity"], "m/s")
        xx, yy, zz, xy, yz, zx = bulk["stress"].T
        self.assertEqual(np.abs([zz, yz, zx]).max(), 0)  # plane stress
        mises = np.sqrt(xx**2 - xx * yy + yy**2 + 3 * xy**2)
        self.assertLess(np.abs(bulk["von_mises"] - mises).max(), 1e-5 * mises.max())
        self.assertLess(np.abs(start.bulk["displacement"]).max(), 1e-12)
        self.assertEqual(len(start.interfaces.cells), 0)
        broken = frame.interfaces
        self.assertTrue((broken["status"] == 2).all())
        ends = broken.points[broken.cells]
        self.assertAlmostEqual(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum(), 4e-3, delta=1e-12)
        self.assertIsNone(frame.obstacles)
        sides = bulk.points[broken["sides"]]
        self.assertLess(np.abs(sides[:, 0] - sides[:, 1]).max(), 1e-15)  # both corners of a point are at one place

    def test_frames_of_earlier_versions_are_read(self):
        old = tools.parents[1] / "tests/output/data/three_stresses/fields/bulk_0001.vtu"
        grid = knap.read_vtu(old)
        self.assertEqual(grid["stress"].shape, (len(grid.cells), 3))

    def test_mistakes_are_those_of_the_program(self):
        with self.assertRaisesRegex(knap.KnapError, "exit code 2(?s:.*)mesh.siz"):
            knap.run("bar_pulled_apart", {"mesh.siz": "1 mm"}, runs / "mistake")
        with self.assertRaisesRegex(knap.KnapError, "none of run.json"):
            knap.read(runs)
        whole = next(self.run_.directory.glob("fields/bulk_0003.vtu")).read_bytes()
        cut = runs / "cut.vtu"
        cut.write_bytes(whole[:len(whole) // 2])
        with self.assertRaises(knap.KnapError):
            knap.read_vtu(cut)

    def test_expectation_that_fails_is_an_error_unless_accepted(self):
        arguments = "bar_pulled_apart", {"mesh.size": "2 mm", "expect.fragments": {"value": 3, "within": 0}}, runs / "expect"
        with self.assertRaisesRegex(knap.KnapError, "exit code 4"):
            knap.run(*arguments)
        self.assertEqual(knap.run(*arguments, accept=(0, 4)).summary["fragments"], 2)


class ManyRuns(unittest.TestCase):
    def test_sweep_is_a_table(self):
        out = runs / "sweep"
        subprocess.run([knap.program(), "sweep", "bar_pulled_apart", "-s", "mesh.size=1 mm,2 mm", "--seeds", "1..2", "-o", out,
                        "--force", "-q"], check=True, capture_output=True)
        sweep = knap.read(out)
        self.assertEqual((sweep.kind, len(sweep)), ("sweep", 4))
        self.assertEqual(list(sweep.table["mesh.size"]), [1, 1, 2, 2])
        self.assertEqual(sweep.table.units["mesh.size"], "mm")
        self.assertEqual(list(sweep.table["seed"]), [1, 2, 1, 2])
        self.assertLess(np.abs(sweep.table["dissipated"] - 12e-3).max(), 1e-12)
        self.assertEqual(sweep.run(2).info["triangles"], sweep.table["triangles"][2])
        self.assertEqual(set(sweep.runs), set(sweep.table["run"]))
        self.assertEqual(list(sweep.statistics["runs"]), [2] * len(sweep.statistics["runs"]))

    def test_study_is_a_table(self):
        out = runs / "study"
        subprocess.run([knap.program(), "study", "bar_ramp_wave", "--levels", "1,2", "-o", out, "--force", "-q"],
                       check=True, capture_output=True)
        study = knap.read(out)
        self.assertEqual(list(study.table["level"]), [1, 2])
        self.assertEqual(study.table["line"][0], "explicit, explicit")
        self.assertGreater(study.table["order of time of 1.5 mJ"][1], 1.5)
        self.assertEqual(len(study.runs), 2)


class Examples(unittest.TestCase):
    def call(self, *words):
        return subprocess.run([sys.executable, *map(str, words)], check=True, capture_output=True, text=True).stdout

    def test_strength_is_found(self):
        out = self.call(tools / "fit_strength.py", "brazilian_disc", "--measured", "5e6", "--between", "4e6", "6e6",
                        "--set", "mesh.size=3 mm", "--set", "mesh.refine=", "--set", "figure=", "--tolerance", "0.02",
                        "-o", runs / "fit")
        found = re.findall(r"sigma_c = (\S+) Pa: strength (\S+) Pa", out)
        self.assertLess(abs(float(found[-1][1]) - 5e6), 0.02 * 5e6)
        self.assertEqual(out.splitlines()[-1], f"sigma_c = {found[-1][0]} Pa")
        self.assertGreater(len(found), 2)

    def test_figure_is_drawn(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("no matplotlib (Debian: python3-matplotlib)")
        run, picture = knap.run("bar_pulled_apart", {"mesh.size": "2 mm"}, runs / "drawn"), runs / "cracks.png"
        picture.unlink(missing_ok=True)
        self.call(tools / "draw_cracks.py", run.directory, "--at", "0.00012", "--deform", "100", "-o", picture)
        self.assertGreater(picture.stat().st_size, 20000)


if __name__ == "__main__":
    runs.mkdir(parents=True, exist_ok=True)
    unittest.main()
