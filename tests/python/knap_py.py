"""Tests of tools/python: ctest runs them with KNAP and a directory for the runs; exit code 77: skipped."""
import fcntl
import json
import pathlib
import re
import subprocess
import sys
import unittest

from common import np, tools
import knap

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

    def test_a_run_says_how_it_ended(self):
        self.assertRegex(repr(self.run_), r"ein Stab µ: done, \d+ triangles, \d+ steps")
        self.assertRegex(str(self.run_.frame()), r"frame at .*µs: bulk with \d+ cells \(.*stress")
        other = runs / "ended"
        other.mkdir(exist_ok=True)
        for status, reason, shown in (("failed", "a pivot < 0", "failed (a pivot &lt; 0)"), ("running", "", "killed"), ("interrupted", "", "interrupted")):
            (other / "run.json").write_text(json.dumps({**self.run_.info, "status": status, "reason": reason}))
            (other / "log.txt").write_text("")
            self.assertIn(f"</b>: {shown}, ", knap.read(other)._repr_html_())
        (other / "run.json").write_text(json.dumps({**self.run_.info, "status": "running"}))
        with open(other / "log.txt") as log:
            fcntl.flock(log, fcntl.LOCK_EX)  # as knap does
            self.assertEqual(knap.read(other).status, "running")
        said = subprocess.run([knap.program(), "info", "--json", other], capture_output=True, text=True, check=True).stdout
        self.assertEqual(json.loads(said)["status"], knap.read(other).status)

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

    def test_frames_of_each_compression_are_the_same(self):
        keys = {"mesh.size": "1 mm", "output.every": 10e-6, "load[0].ramp": "10 us", "figure": [], "output.report": False, "expect": {}}
        frames = [knap.run("bar_pulled_apart", {**keys, "output.compression": word}, runs / word, threads=1).frame()
                  for word in ("none", "lz4", "zlib")]
        for frame in frames:
            for part, first in ((frame.bulk, frames[0].bulk), (frame.interfaces, frames[0].interfaces)):
                np.testing.assert_array_equal(part.points, first.points)
                for name in first: np.testing.assert_array_equal(part[name], first[name])

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
        page = sweep._repr_html_()
        self.assertIn("sweep of 4 runs", page)
        self.assertIn("<th>mesh.size</th>", page)
        self.assertIn("<td>1 mm</td>", page)
        self.assertIn("<td>12 mJ</td>", page)
        numbers = sweep.run(0)._repr_html_().rsplit("<table>", 1)[1]
        self.assertIn("<td>dissipated</td><td>12 mJ</td>", numbers)
        self.assertIsNone(re.search(r"[1-9][0-9.]{6}|nan", numbers), numbers)  # digits that nobody reads

    def test_study_is_a_table(self):
        out = runs / "study"
        subprocess.run([knap.program(), "study", "bar_ramp_wave", "--levels", "1,2", "-o", out, "--force", "-q"],
                       check=True, capture_output=True)
        study = knap.read(out)
        self.assertEqual(list(study.table["level"]), [1, 2])
        self.assertEqual(study.table["line"][0], "explicit, explicit")
        self.assertGreater(study.table["order of time of 1.5 mJ"][1], 1.5)
        self.assertIn('alt="convergence ', study._repr_html_())
        self.assertEqual(len(study.runs), 2)
        (out / "study.csv").rename(out / "later.csv")
        with self.assertRaisesRegex(knap.KnapError, "the study goes on, or was stopped.*; 2 of its runs have begun"):
            knap.read(out)


class Statistics(unittest.TestCase):
    def test_exceedance_counts_what_is_as_large(self):
        values, part = knap.exceedance([3, 1, np.nan, 2, 2])
        self.assertEqual(list(values), [1, 2, 2, 3])
        self.assertEqual(list(part), [1, 0.75, 0.75, 0.25])
        self.assertEqual(list(knap.exceedance([5, 7], total=8)[1]), [0.25, 0.125])
        self.assertEqual(len(knap.exceedance([])[0]), 0)

    def test_percentile_of_draws_is_that_of_numpy(self):
        random = np.random.default_rng(1)
        values = random.exponential(size=60)
        n, again, draws = len(values), np.random.default_rng(0), []
        for _ in range(300):
            draws.append(np.percentile(np.sort(values)[again.integers(0, n, n)], 95))
        value, low, high = knap.percentile(np.sort(values), 95, draws=300)
        self.assertAlmostEqual(value, np.percentile(values, 95), delta=1e-14)
        self.assertAlmostEqual(low, np.percentile(draws, 2.5), delta=1e-12)
        self.assertAlmostEqual(high, np.percentile(draws, 97.5), delta=1e-12)
        self.assertEqual(knap.percentile([2, 2, 2], 99), (2, 2, 2))
        self.assertTrue(np.isnan(knap.percentile([], 95)).all())

    def test_interval_has_its_confidence(self):
        random, hits, true = np.random.default_rng(2), 0, -np.log(0.05)
        for i in range(60):
            _, low, high = knap.percentile(random.exponential(size=400), 95, draws=200, seed=i)
            hits += low <= true <= high
        self.assertGreater(hits, 48)  # the percentile method covers 92 % of such samples: 55, and 48 is three deviations less

    def test_pieces_of_a_drop_are_not_independent(self):
        drops = np.random.default_rng(3).normal(size=40)
        pieces, of = np.repeat(drops, 50), np.repeat(np.arange(40), 50)
        one, all_of_one = (knap.percentile(*arguments, draws=500) for arguments in ((drops, 95), (pieces, 95, of)))
        self.assertLess(abs((all_of_one[2] - all_of_one[1]) / (one[2] - one[1]) - 1), 0.3)
        alone = knap.percentile(pieces, 95, draws=500)
        self.assertLess(alone[2] - alone[1], 0.5 * (all_of_one[2] - all_of_one[1]))

    def test_sweep_has_the_passages_of_its_runs(self):
        out, scene = runs / "drops", runs / "drops.toml"
        scene.write_text(drops, encoding="utf-8")
        subprocess.run([knap.program(), "sweep", scene, "-o", out, "--force", "-q"], check=True, capture_output=True)
        sweep = knap.read(out)
        net = sweep.passages("net")
        self.assertEqual(list(net["run"]), ["m1", "m2", "m3"])
        self.assertEqual(net.units["energy"], "J")
        speeds = [sweep.runs[name].summary["net_largest_speed"] for name in net["run"]]
        self.assertEqual(list(net["speed"]), speeds)
        self.assertEqual(len(sweep.passages("far")["run"]), 0)
        self.assertEqual(len(sweep.table["body.stone.velocity.x"]), 3)
        self.assertEqual(sweep.table.units["body.stone.velocity.x"], "m/s")
        with self.assertRaisesRegex(knap.KnapError, "no collector 'nett'"):
            sweep.passages("nett")


drops = """knap = 1
[domain]
rotation = "large"
[mesh]
size = 1
[[body]]
name = "stone"
shape = "rectangle"
size = [1, 1]
velocity = [5, 0]
[material.rock]
density = 2600
E = "20 MPa"
nu = 0.25
[interface.default]
breakable = false
[[collector]]
name = "net"
from = [1, -5]
to = [1, 5]
[[collector]]
name = "far"
from = [9, -5]
to = [9, 5]
[time]
end = 0.4
[sweep.random]
members = 3
[[sweep.random.vary]]
key = "body.stone.velocity.x"
uniform = ["5 m/s", "6 m/s"]
"""


class Examples(unittest.TestCase):
    def call(self, *words):
        return subprocess.run([sys.executable, *map(str, words)], check=True, capture_output=True, text=True).stdout

    def test_strength_is_found(self):
        try:
            import scipy  # noqa: F401
        except ImportError:
            self.skipTest("no scipy (Debian: python3-scipy)")
        out = self.call(tools / "fit_strength.py", "brazilian_disc", "--measured", "5e6", "--between", "4e6", "6e6",
                        "--set", "mesh.size=3 mm", "--set", "mesh.refine=", "--set", "figure=", "--tolerance", "0.02",
                        "-o", runs / "fit")
        found = dict(re.findall(r"sigma_c = (\S+) Pa: specimen: strength (\S+) Pa", out))
        last = re.search(r"^sigma_c = (\S+) Pa$", out, re.MULTILINE)[1]
        self.assertLess(abs(float(found[last]) - 5e6), 0.02 * 5e6)
        self.assertGreater(len(found), 2)
        self.assertIn("<h2>How it was made</h2>", (runs / "fit" / "report.html").read_text())
        with self.assertRaises(subprocess.CalledProcessError) as caught:  # the platens have hardly moved
            self.call(tools / "fit_strength.py", "brazilian_disc", "--measured", "5e6", "--between", "4e6", "6e6", "--set", "mesh.size=3 mm", "--set", "mesh.refine=",
                      "--set", "time.end=50 us", "-o", runs / "short")
        self.assertIn("no value at sigma_c = 5e+06 Pa: the run ended before it had one, as where a specimen has not failed: a later time.end", caught.exception.stderr)

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
