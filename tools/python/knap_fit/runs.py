"""Runs the tests of a problem at points of its parameters, with all seeds, and goes on where it was stopped."""
import concurrent.futures
import csv
import hashlib
import json
import pathlib
import shlex
import shutil
import subprocess

import numpy as np

import knap

# the runs draw nothing, keep no frames, and may miss [expect]
_short = {"output.fields": "false", "output.report": "false", "figure": "", "expect": "", "study": "", "sweep": ""}


class Stop(Exception):
    """No run is started: the text says why."""


class Runs:
    """`points`: places in the unit cube, a row each. `values[measured]`: an array over points, seeds and its places; nan: the
    run failed or has no such value. `exits`: exit code of every (point, test, seed). `simulate(test, u, seed)`, for tests of
    this package, stands for a run: it returns what has `summary` and `table`. `own_seeds`: every point has seeds of its own, so
    that the emulator averages over meshes; otherwise all points share theirs, for slopes."""

    def __init__(self, problem, directory, jobs=1, print_commands=False, force=False, simulate=None, own_seeds=True):
        self.problem, self.directory, self.jobs, self.print_commands = problem, pathlib.Path(directory), jobs, print_commands
        self.own_seeds, self.simulate, self.exits, self.why = own_seeds, simulate, {}, {}
        self.points = np.zeros((0, len(problem.parameters)))
        self.values, self.summaries = {}, {}
        self._start(force)

    @property
    def n_runs(self):
        return len(self.exits)

    @property
    def per_point(self):
        return sum(test.seeds for test in self.problem.tests)

    def _start(self, force):
        self.directory.mkdir(parents=True, exist_ok=True)
        described = [[p.name, p.keys, p.low, p.high, p.unit, p.log] for p in self.problem.parameters]
        for test in self.problem.tests:
            file = pathlib.Path(test.scenario)
            text = hashlib.sha256(file.read_bytes()).hexdigest() if file.exists() else test.scenario
            described.append([test.name, text, test.set, test.seeds, test.first_seed])
        mark, text = self.directory / "problem.json", json.dumps(described)
        old = mark.read_text() if mark.exists() else text
        if old != text and not force:
            raise Stop(f"{self.directory} has runs of other parameters, scenarios or seeds; -o for another directory, --force to begin anew")
        if old != text or force:
            for name in ("points.csv", "exits.csv"):
                (self.directory / name).unlink(missing_ok=True)
            shutil.rmtree(self.directory / "runs", ignore_errors=True)
        mark.write_text(text)
        if (self.directory / "points.csv").exists():
            table = knap.read_csv(self.directory / "points.csv")
            self.points = np.array([table[p.name] for p in self.problem.parameters]).T.reshape(-1, len(self.problem.parameters))
        if (self.directory / "exits.csv").exists():
            with open(self.directory / "exits.csv", newline="") as lines:
                for point, test, seed, code, why in list(csv.reader(lines))[1:]:
                    self.exits[int(point), test, int(seed)], self.why[int(point), test, int(seed)] = int(code), why
        self._fill()

    def add(self, points):
        """Adds points and does what remains to be done of all of them."""
        self.points = np.vstack([self.points, np.reshape(points, (-1, len(self.problem.parameters)))])
        with open(self.directory / "points.csv", "w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow([p.name for p in self.problem.parameters])
            rows.writerows([[repr(float(x)) for x in u] for u in self.points])
        self.finish()

    def remaining(self):
        return [(k, test, seed) for k in range(len(self.points)) for test in self.problem.tests
                for seed in range(test.first_seed, test.first_seed + test.seeds) if (k, test.name, seed) not in self.exits]

    def folder(self, k, test, seed):
        return self.directory / "runs" / f"{test.name}_p{k + 1}_s{seed}"

    def seed(self, k, test, seed):
        return seed + k * test.seeds if self.own_seeds else seed

    def command(self, k, test, seed):
        words = [knap.program(), "run", test.scenario, "-j", "1", "-q", "-o", str(self.folder(k, test, seed))]
        for key, value in {**_short, **self.problem.set_of(test, self.points[k]), "seed": self.seed(k, test, seed)}.items():
            words += ["-s", f"{key}={value}"]
        return words

    def _run(self, job):
        k, test, seed = job
        if self.simulate:
            try:
                return job, 0, "", self.simulate(test, self.points[k], self.seed(k, test, seed))
            except knap.KnapError as error:
                return job, 3, str(error), None
        done = subprocess.run(self.command(*job), capture_output=True, text=True)
        why = "" if done.returncode in (0, 4) else (done.stderr.strip().splitlines() or ["no message"])[0]
        file = self.folder(*job) / "run.json"
        if done.returncode == 3 and file.exists():
            why = json.loads(file.read_text()).get("reason") or why
        return job, done.returncode, why, None

    def finish(self):
        """Does the runs that remain; a failed one (exit code 3; 2: no scenario there) is noted and the rest goes on."""
        jobs = [job for job in self.remaining() if not self._is_there(job)]
        if jobs and self.print_commands:
            raise Stop("\n".join(" ".join(map(shlex.quote, self.command(*job))) for job in jobs))
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            for (k, test, seed), code, why, run in pool.map(self._run, jobs):
                if code not in (0, 2, 3, 4) or why.startswith("error[run-"):  # of another process, of another program
                    raise Stop(f"a run ended with exit code {code}: {why}")
                self._note(k, test, seed, code, why)
                if run is not None:
                    self._take(k, test, seed, run)
        self._fill()

    def _is_there(self, job):
        """Whether a run is done that another process started, as by --print-commands; it is noted."""
        file = self.folder(*job) / "run.json"
        info = json.loads(file.read_text()) if file.exists() else {}
        if info.get("status") not in ("done", "failed"):
            return False
        good = info["status"] == "done" and all(gate["pass"] for gate in info["gates"])
        self._note(*job, 0 if good else 3, "" if good else info.get("reason", "a gate"))
        return True

    def _note(self, k, test, seed, code, why):
        self.exits[k, test.name, seed], self.why[k, test.name, seed] = code, why
        new = not (self.directory / "exits.csv").exists()
        with open(self.directory / "exits.csv", "a", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            if new:
                rows.writerow(["point", "test", "seed", "exit", "why"])
            rows.writerow([k, test.name, seed, code, why])

    def _take(self, k, test, seed, run):
        self.summaries[k, test.name, seed] = {name: value for name, value in run.summary.items() if isinstance(value, (int, float))}
        for measured in test.measured:
            self.values[measured.title, k, seed] = measured.of(run)

    def _fill(self):
        for k in range(len(self.points)):
            for test in self.problem.tests:
                for seed in range(test.first_seed, test.first_seed + test.seeds):
                    if self.exits.get((k, test.name, seed)) in (0, 4) and (k, test.name, seed) not in self.summaries and not self.simulate:
                        self._take(k, test, seed, knap.Run(self.folder(k, test, seed)))

    def of(self, measured):
        """Values of a measurement: an array over points, seeds and places."""
        test, nothing = measured.test, np.full(measured.size, np.nan)
        return np.array([[self.values.get((measured.title, k, seed), nothing) for seed in range(test.first_seed, test.first_seed + test.seeds)]
                         for k in range(len(self.points))]).reshape(len(self.points), test.seeds, measured.size)

    def numbers(self, test, name):
        """A number of the summary, mean over seeds, for every point."""
        found = [[self.summaries.get((k, test.name, seed), {}).get(name, np.nan) for seed in range(test.first_seed, test.first_seed + test.seeds)]
                 for k in range(len(self.points))]
        found = np.array([[np.nan if value is None else value for value in row] for row in found], float)
        count = np.isfinite(found).sum(axis=1)
        return np.where(count > 0, np.nansum(found, axis=1) / np.maximum(count, 1), np.nan)
