"""Which parameters the numbers of runs depend on."""
import numpy as np

import knap

from . import need, report
from .emulator import Emulator
from .inference import sobol
from .runs import Stop


def trajectories(k, n, seed, levels=4):
    """Design of Morris (Technometrics 33 (1991) 161): n walks through a grid of the unit cube, each of k + 1 points, of
    which two successive ones differ in one parameter by levels/(2 (levels - 1))."""
    rng, step = np.random.default_rng(seed), levels / (2 * (levels - 1))
    points = np.empty((n, k + 1, k))
    for walk in points:
        low, up = rng.integers(0, levels // 2, k) / (levels - 1), rng.integers(0, 2, k) == 1
        walk[:] = np.where(up, low, low + step)
        for j, i in enumerate(rng.permutation(k), 1):
            walk[j:, i] += step if up[i] else -step
    return points


def morris(y, points):
    """(mean of the absolute effects, deviation of the effects) of each parameter, over its whole range. A large
    deviation: the effect depends on the other parameters, or is not linear."""
    du, dy = np.diff(points, axis=1), np.diff(y.reshape(points.shape[:2]), axis=1)[:, :, None]
    effects = np.divide(dy, du, out=np.full(du.shape, np.nan), where=du != 0).reshape(-1, du.shape[2])
    effects = [column[np.isfinite(column)] for column in effects.T]
    return [(np.mean(np.abs(e)), np.std(e, ddof=1)) if len(e) > 1 else (np.nan, np.nan) for e in effects]


def sobol_indices(function, k, n):
    """(first order, total) parts of the variance of function(u), of each parameter: estimators of Saltelli et al.
    (Comput. Phys. Commun. 181 (2010) 259, table 2) and of Jansen (1999). A function may give several columns, each with
    indices of its own."""
    base = sobol(n, 2 * k, seed=1)
    a, b = base[:, :k], base[:, k:]
    mixed = [np.where(np.arange(k) == i, b, a) for i in range(k)]
    fa, fb, *f = np.split(function(np.vstack([a, b, *mixed])), k + 2)
    variance = np.var(np.concatenate([fa, fb]), axis=0)
    return np.mean(fb * (f - fa), axis=1) / variance, np.mean((fa - f) ** 2, axis=1) / 2 / variance


def write(problem, runs):
    """Tables, and what a terminal shows."""
    k, out = len(problem.parameters), runs.directory
    points = trajectories(k, problem.options["trajectories"], problem.options["seed"])
    place = runs.at(np.concatenate(points))
    need("knap-sensitivity", "scipy.stats", "sklearn")
    runs.at(sobol(6 * k, k, problem.options["seed"]))  # also inside, for the emulator
    names = {(test, name) for test in problem.tests for name in problem.options.get("numbers") or
             [m.name for m in test.measured if m.x is None]}
    rows = []
    for test, name in sorted(names, key=lambda pair: (pair[0].name, pair[1])):
        y = runs.numbers(test, name)
        n, effects = np.isfinite(y).sum(), morris(y[place], points)
        is_short = bool(n < 3 * (k + 1) or not np.isfinite(effects).all())
        if is_short or not np.nanstd(y) > 1e-12 * np.nanmax(np.abs(y)):
            text = f"too few values: {n} of {len(y)} points have one (bounds, trajectories)" * is_short
            rows += [[test.name, name, p.name, text, text, *[""] * 7] for p in problem.parameters]
            continue
        emulator = Emulator(runs.points, y[:, None, None], float(np.nanmax(np.abs(y))))
        first, total = sobol_indices(lambda u: emulator(u)[0][:, 0], k, 2048)
        errors = np.std(sobol_indices(emulator.draws, k, 256), axis=2)  # what the runs leave open
        seeds, unit = (emulator.noise[0] / np.nanvar(y)), knap.unit_of_output("summary", name) or ""
        for p, (mu, sigma), *indices in zip(problem.parameters, effects, first, errors[0], total, errors[1]):
            relative = mu / max(np.nanmean(np.abs(y)), 1e-300)
            numbers = [float(value) for value in (relative, *indices, seeds)]
            rows.append([test.name, name, p.name, float(mu), float(sigma), unit, *numbers])
    if all(str(row[3]).startswith("too few") for row in rows):
        raise Stop(f"{rows[0][3]}; {runs.remedy(problem.tests[0])}")
    head = ["test", "number", "parameter", "mean effect", "deviation of effects", "unit", "effect over the mean",
            "Sobol first order", "deviation of first order", "Sobol total", "deviation of total", "part of the seeds"]
    latex = knap.latex(head, rows, "Sensitivity of " + problem.name, digits=3)
    (out / "sensitivity.tex").write_text(latex, encoding="utf-8")
    for row in rows:
        text = row[3] or "it is the same in all runs"
        if isinstance(row[6], float):
            text = f"{row[6]:.2g} of its mean over the bounds, {max(row[9], 0):.2f} +- {row[10]:.2f} of its variance"
        print(f"{row[0]}: {row[1]} on {row[2]}: {text}")
    notes = [report.say("sensitivity", counted=runs.counted())]
    report.page(runs, notes, [("Sensitivity", "sensitivity.csv", head, rows)], [])
    return True
