"""Runs the tests of a problem at points of its parameters, with all seeds, and goes on where it was stopped."""
import collections
import concurrent.futures
import csv
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import threading

import numpy as np

import knap

# the runs draw nothing, keep no frames, and may miss [expect]
_short = {"output.fields": "false", "output.report": "false", "figure": "", "expect": "", "study": "", "sweep": ""}
_interrupted = 130  # exit code


class Stop(Exception):
    """No run is started: the text says why."""


class Commands(Exception):
    """The command lines of the runs that come next, which others are to start."""


def table(file, head, rows):
    """Writes a csv file; a reader, or a process that was ended, finds the old one or the new one."""
    new = file.with_suffix(".new")
    with open(new, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(head)
        writer.writerows([[f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row] for row in rows])
    os.replace(new, file)


class Runs:
    """`points`: places in the unit cube, a row each, of the values that the runs get (six digits; points.csv). `why[job]`, for
    each job (point, test, seed) that is done: "", or why it failed. Points and run.json of the runs are the whole state.
    `own_seeds`: every point has seeds of its own, so that the emulator averages over meshes; otherwise all points share theirs,
    for slopes."""

    def __init__(self, problem, directory, jobs=1, print_commands=False, force=False, own_seeds=True):
        self.problem, self.directory, self.jobs, self.print_commands = problem, pathlib.Path(directory), jobs, print_commands
        self.own_seeds = own_seeds
        self.why, self._answers = {}, {}
        self._children, self._lock, self._ended = set(), threading.Lock(), False
        self.values = []  # of the parameters at each point, in the units of the keys
        self._start(force)

    @property
    def n_runs(self):
        return len(self.why)

    def counted(self):
        failed = [why for why in self.why.values() if why]
        return f"{len(self.why)} runs, {len(failed)} failed" + (f" (the first: {failed[0][:120]})" if failed else "")

    def gates(self, test):
        """{gate: runs of a test that it ended}."""
        found = [re.match(r"gate (\w+)", why) for (_, of, _), why in self.why.items() if of is test]
        return collections.Counter(gate[1] for gate in found if gate)

    def cause(self, k, test):
        """Why a point has no value of a test."""
        return next((why for (point, of, _), why in self.why.items() if why and (point, of) == (k, test)), "the run ended before it had one; a later time.end?")

    @property
    def per_point(self):
        return sum(test.seeds for test in self.problem.tests)

    @property
    def points(self):
        parameters = self.problem.parameters
        return np.array([[p.place(value) for p, value in zip(parameters, row)] for row in self.values]).reshape(-1, len(parameters))

    def _start(self, force):
        self.directory.mkdir(parents=True, exist_ok=True)
        described = [self.own_seeds, *([p.name, p.keys, p.low, p.high, p.unit, p.log] for p in self.problem.parameters)]
        for test in self.problem.tests:
            file = pathlib.Path(test.scenario)
            text = hashlib.sha256(file.read_bytes()).hexdigest() if file.exists() else test.scenario
            described.append([test.name, text, test.set, test.seeds, test.first_seed])
        data = [[m.title, m.use, m.n, m.scatter, np.ravel(m.values).tolist()] for m in self.problem.measured if m.values is not None]
        data += [self.problem.options[key] for key in ("interval", "model_error", "seed")]
        mark, points = self.directory / "problem.json", self.directory / "points.csv"
        old = json.loads(mark.read_text()) if mark.exists() else [described, data]
        if points.exists() and not force:
            self.values = list(zip(*(map(float, column) for column in knap.read_csv(points).values())))
        # other bounds and scales change no run
        one, other = ([[*row[:2], *row[4:5]] if 0 < i <= len(self.problem.parameters) else row for i, row in enumerate(rows)] for rows in (old[0], described))
        same = one == other and bool(((self.points > -1e-5) & (self.points < 1 + 1e-5)).all())
        if not same and not force:
            raise Stop(f"{self.directory} has runs of other parameters, scenarios or seeds, or outside of these bounds; -o for another directory, "
                       "--force to delete them and begin anew")
        if force:
            points.unlink(missing_ok=True)
            shutil.rmtree(self.directory / "runs", ignore_errors=True)
        if old != [described, data] or force:
            (self.directory / "convergence.csv").unlink(missing_ok=True)  # of other measurements of the same runs
        if old != [described, data] or not mark.exists():
            mark.write_text(json.dumps([described, data]))

    def add(self, points):
        """Adds points and does what remains to be done of all of them."""
        self.values += [self.problem.rounded(u) for u in np.reshape(points, (-1, len(self.problem.parameters)))]
        table(self.directory / "points.csv", [p.title for p in self.problem.parameters], self.values)
        self.finish()

    def at(self, points):
        """The numbers of these points, after those that are new have been added."""
        rows = [self.problem.rounded(u) for u in points]
        self.add(list({row: u for u, row in zip(points, rows) if row not in self.values}.values()))
        return [self.values.index(row) for row in rows]

    def _jobs(self):
        return [(k, test, seed) for k in range(len(self.values)) for test in self.problem.tests
                for seed in range(test.first_seed, test.first_seed + test.seeds)]

    def folder(self, k, test, seed):
        return self.directory / "runs" / f"{test.name}_p{k + 1}_s{seed}"

    def seed(self, k, test, seed):
        return seed + k * test.seeds if self.own_seeds else seed

    def command(self, k, test, seed):
        words = [knap.program(), "run", test.scenario, "-j", "1", "-q", "-o", str(self.folder(k, test, seed))]
        for key, value in {**_short, **self.problem.set_of(test, self.points[k]), "seed": self.seed(k, test, seed)}.items():
            words += ["-s", f"{key}={value}"]
        return words

    def _recorded(self, job):
        """What run.json says of a run, whichever process made it: "" where it is good, why it failed; None: it is not done."""
        file = self.folder(*job) / "run.json"
        info = json.loads(file.read_text()) if file.exists() else {}
        if info.get("status") not in ("done", "failed"):
            return None
        missed = [gate["name"] for gate in info["gates"] if not gate["pass"]] if info["status"] == "done" else []
        return f"gate {', '.join(missed)}" if missed else "" if info["status"] == "done" else info.get("reason") or "no reason given"

    def _run(self, job):
        """Does a run; returns its exit code and what it said."""
        with self._lock:
            if self._ended:
                return _interrupted, ""
            child = subprocess.Popen(self.command(*job), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self._children.add(child)
        lines = child.communicate()[1].strip().splitlines()
        with self._lock:
            self._children.discard(child)
        return child.returncode, lines[0] if lines else "no message"

    def finish(self):
        """Does the runs that remain; a failed one (exit code 3; 2: no scenario there) is noted and the rest goes on. When this
        process is interrupted it ends its runs; each leaves a checkpoint from which it goes on."""
        jobs = []
        for job in self._jobs():
            if job not in self.why and (why := self._recorded(job)) is not None:
                self.why[job] = why
            elif job not in self.why:
                jobs.append(job)
        if jobs and self.print_commands:
            raise Commands("\n".join(" ".join(map(shlex.quote, self.command(*job))) for job in jobs))
        pool = concurrent.futures.ThreadPoolExecutor(self.jobs)
        try:
            for job, (code, text) in zip(jobs, pool.map(self._run, jobs)):
                if code == _interrupted:
                    raise KeyboardInterrupt
                if code not in (0, 2, 3, 4) or text.startswith("error[run-"):  # of another process, of another program
                    raise Stop(f"a run ended with exit code {code}: {text}")
                self.why[job] = "" if code in (0, 4) else self._recorded(job) or text
        except BaseException:
            with self._lock:
                self._ended = True
                for child in self._children:
                    child.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)

    def answers(self, test):
        """The Run of each point and seed of a test; None where it failed."""
        jobs = [job for job in self._jobs() if job[1] is test]
        for job in jobs:
            if job not in self._answers and self.why.get(job) == "":
                self._answers[job] = knap.Run(self.folder(*job))
        return [self._answers.get(job) for job in jobs]

    def of(self, measured):
        """Values of a measurement: an array over points, seeds and places; nan: the run failed or has no such value."""
        found = [measured.of(run) if run else np.full(measured.size, np.nan) for run in self.answers(measured.test)]
        return np.reshape(found, (len(self.values), measured.test.seeds, measured.size))

    def numbers(self, test, name):
        """A number of the summary, mean over seeds, for every point."""
        found = np.array([run.summary.get(name, np.nan) if run else np.nan for run in self.answers(test)], float).reshape(-1, test.seeds)
        count = np.isfinite(found).sum(axis=1)
        return np.where(count > 0, np.nansum(found, axis=1) / np.maximum(count, 1), np.nan)
