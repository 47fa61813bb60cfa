"""Runs the tests of a problem at points of its parameters, with all seeds, and goes on where it was stopped."""
import hashlib
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import time

import numpy as np

import knap

from .problem import label

# the runs draw nothing, keep no frames, and may miss [expect]
_short = {"output.fields": "false", "output.report": "false", "figure": "", "expect": "", "study": "", "sweep": ""}
_early = "the run ended before it had one, as where a specimen has not failed: a later time.end"
_interrupted = 130  # exit code


class Stop(Exception):
    """No run is started: the text says why."""


class Commands(Exception):
    """No run is started: the text has the command lines of those that remain."""


class Runs:
    """`values`: of the parameters at each point, with six digits (points.csv). `why[job]`, for each job (point, test,
    seed) that is done: "", or why it failed. Points and run.json of the runs are the whole state. `own_seeds`: every
    point has seeds of its own, so that the emulator averages over meshes; otherwise all points share theirs, for
    slopes."""

    def __init__(self, problem, directory, jobs=1, print_commands=False, force=False, own_seeds=True):
        self.problem, self.directory, self.jobs = problem, pathlib.Path(directory), jobs
        self.print_commands, self.own_seeds = print_commands, own_seeds
        self.values, self.why, self._answers = [], {}, {}
        self.per_point = sum(test.seeds for test in problem.tests)
        self._start(force)

    @property
    def n_runs(self):
        return len(self.why)

    @property
    def points(self):
        """Places in the unit cube, a row each."""
        columns = np.reshape(self.values, (-1, len(self.problem.parameters))).T
        return np.array([p.place(column) for p, column in zip(self.problem.parameters, columns)]).T

    def counted(self):
        failed = [self.why[job] for job in self._jobs() if self.why.get(job)]
        lost = {job for m in self.problem.fitted for job, run in zip(self._jobs(m.test), self.answers(m.test))
                if run and not np.isfinite(m.of(run)).all()}
        return (f"{len(self.why)} runs, {len(failed)} failed" + (f" (the first: {failed[0][:120]})" if failed else "")
                + f", {len(lost)} without a value ({_early})" * bool(lost))

    def cause(self, test, k=None):
        """Why a point, or any, has no value of a test."""
        found = (why for (point, of, _), why in self.why.items() if why and of is test and k in (None, point))
        return next(found, _early)

    def remedy(self, test):
        """Of a test without values: the cause, and what may help."""
        return (f"the first run without one: {self.cause(test)}\n = allowed: bounds around parameters with which the "
                f"test works; a later time.end, a smaller step or a finer mesh, in `set` of [test.{test.name}]")

    def surplus_scatter(self):
        """Of each parameter, what its law "as measured" divides it by scatters by, over its mean: `knap check` at the
        middle."""
        found = np.zeros(len(self.problem.parameters))
        for test in self.problem.tests:
            if not any(np.isfinite(self.numbers(test, f"measured_{name}")).any() for name in ("sigma_c", "G_c")):
                continue
            words = [knap.program(), "check", test.scenario, *self._sets(self.problem.set_of(test, [0.5] * len(found)))]
            said = subprocess.run(words, capture_output=True, text=True).stdout
            surplus = r"  law (\S+): a (crack|specimen).* surplus of this mesh is (\S+) \+- (\S+)"
            for law, what, mean, deviation in re.findall(surplus, said):
                i = self.problem.keys_of(test).get(f"interface.{law}.{'G_c' if what == 'crack' else 'sigma_c'}")
                if i is not None:
                    found[i] = max(found[i], float(deviation) / float(mean))
        return found

    def _start(self, force):
        """Finds the runs that the directory has. Other bounds, scales and measurements change none of them, but what
        they say."""
        self.directory.mkdir(parents=True, exist_ok=True)
        tests, parameters, measured = self.problem.tests, self.problem.parameters, self.problem.measured
        texts = {t.scenario: hashlib.sha256(pathlib.Path(t.scenario).read_bytes()).hexdigest() for t in tests
                 if pathlib.Path(t.scenario).is_file()}
        made = [self.own_seeds, [[p.name, p.keys, p.unit] for p in parameters],
                [[t.name, texts.get(t.scenario, t.scenario), t.set, t.seeds, t.first_seed] for t in tests]]
        data = [[[p.low, p.high, p.log, None if p.normal is None else p.normal.tolist()] for p in parameters],
                [[m.title, m.n, m.scatter, m.noise, m.freedom, np.ravel(m.values).tolist()] for m in measured],
                [self.problem.options[key] for key in ("interval", "model_error", "seed")]]
        mark, points = self.directory / "problem.json", self.directory / "points.csv"
        old = json.loads(mark.read_text()) if mark.exists() else [made, data]
        if force:
            points.unlink(missing_ok=True)
            shutil.rmtree(self.directory / "runs", ignore_errors=True)
        elif points.exists():
            self.values = list(zip(*(map(float, column) for column in knap.read_csv(points).values())))
        if not force and (old[0] != made or (np.abs(self.points - 0.5) > 0.50001).any()):
            raise Stop(f"{self.directory} has runs of other parameters, scenarios or seeds, or outside of these "
                       "bounds; -o for another directory, --force to delete them and begin anew")
        if force or old != [made, data]:
            (self.directory / "convergence.csv").unlink(missing_ok=True)
        mark.write_text(json.dumps([made, data]))

    def add(self, points):
        """Adds points and does what remains to be done of all of them."""
        self.values += [self.problem.rounded(u) for u in np.reshape(points, (-1, len(self.problem.parameters)))]
        titles = [label(p.name, p.unit) for p in self.problem.parameters]
        knap.write_csv(self.directory / "points.csv", titles, self.values)
        self.finish()

    def at(self, points):
        """The numbers of these points, after those that are new have been added."""
        rows = [self.problem.rounded(u) for u in points]
        self.add(list({row: u for u, row in zip(points, rows) if row not in self.values}.values()))
        return [self.values.index(row) for row in rows]

    def _jobs(self, *tests):
        return [(k, test, seed) for k in range(len(self.values)) for test in tests or self.problem.tests
                for seed in range(test.first_seed, test.first_seed + test.seeds)]

    def folder(self, k, test, seed):
        return self.directory / "runs" / f"{test.name}_p{k + 1}_s{seed}"

    def seed(self, k, test, seed):
        return seed + k * test.seeds if self.own_seeds else seed

    @staticmethod
    def _sets(values):
        return [text for key, value in values.items() for text in ("-s", f"{key}={value}")]

    def command(self, k, test, seed):
        words = [knap.program(), "run", test.scenario, "-j", "1", "-q", "-o", str(self.folder(k, test, seed))]
        values = {**_short, **self.problem.set_of(test, self.points[k]), "seed": self.seed(k, test, seed)}
        return words + self._sets(values)

    def _recorded(self, job):
        """What run.json says of a run, whichever process made it: "" where it is good, why it failed; None: it is not
        done."""
        file = self.folder(*job) / "run.json"
        info = json.loads(file.read_text()) if file.exists() else {}
        if info.get("status") == "failed":
            return info.get("reason") or "no reason given"
        missed = ", ".join(gate["name"] for gate in info.get("gates", []) if not gate["pass"])
        return None if info.get("status") != "done" else f"gate {missed}" if missed else ""

    def _run(self, job):
        """Starts a run."""
        return subprocess.Popen(self.command(*job), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def finish(self):
        """Does the runs that remain; a failed one (exit code 3; 2: no scenario there) is noted and the rest goes on.
        When this process is interrupted it ends its runs; each leaves a checkpoint from which it goes on."""
        jobs = [job for job in self._jobs() if job not in self.why]
        self.why.update((job, why) for job in jobs if (why := self._recorded(job)) is not None)
        jobs, running = [job for job in jobs if job not in self.why], {}
        if jobs and self.print_commands:
            raise Commands("\n".join(shlex.join(self.command(*job)) for job in jobs))
        try:
            while jobs or running:
                while jobs and len(running) < self.jobs:
                    job = jobs.pop(0)
                    running[job] = self._run(job)
                for job in [job for job, child in running.items() if child.poll() is not None]:
                    child = running.pop(job)
                    code, text = child.returncode, (child.communicate()[1].strip() or "no message").splitlines()[0]
                    if code == _interrupted:
                        raise KeyboardInterrupt
                    if code not in (0, 2, 3, 4) or text.startswith("error[run-"):  # of another process or program
                        cure = "; -o for another directory, --force to begin anew" * text.startswith("error[run-exists")
                        raise Stop(f"a run ended with exit code {code}: {text}{cure}")
                    self.why[job] = "" if code in (0, 4) else self._recorded(job) or text
                time.sleep(0.01 * bool(running))
        finally:
            for child in running.values():
                child.terminate()
            for child in running.values():
                child.wait()

    def answers(self, test):
        """The Run of each point and seed of a test; None where it failed."""
        jobs = self._jobs(test)
        self._answers.update((job, knap.Run(self.folder(*job))) for job in jobs
                             if job not in self._answers and self.why.get(job) == "")
        return [self._answers.get(job) for job in jobs]

    def of(self, measured):
        """Values of a measurement: an array over points, seeds and places; nan: the run failed or has no such value."""
        found = [measured.of(run) if run else np.full(measured.size, np.nan) for run in self.answers(measured.test)]
        return np.reshape(found, (len(self.values), measured.test.seeds, measured.size))

    def numbers(self, test, name):
        """A number of the summary, mean over seeds, for every point."""
        found = [run.summary.get(name, np.nan) if run else np.nan for run in self.answers(test)]
        found = np.ma.masked_invalid(np.reshape(np.array(found, float), (-1, test.seeds)))
        return found.mean(axis=1).filled(np.nan)
