"""Which parameters the numbers of runs depend on."""
import numpy as np

import knap

from . import need, report
from .emulator import Emulator
from .inference import sobol
from .problem import unit_of


def trajectories(k, n, seed, levels=4):
    """Design of Morris (Technometrics 33 (1991) 161): n walks through a grid of the unit cube, each of k + 1 points, of which
    two successive ones differ in one parameter by levels/(2 (levels - 1))."""
    rng, step = np.random.default_rng(seed), levels / (2 * (levels - 1))
    points = np.empty((n, k + 1, k))
    for walk in points:
        low, up = rng.integers(0, levels // 2, k) / (levels - 1), rng.integers(0, 2, k) == 1
        walk[:] = np.where(up, low, low + step)
        for j, i in enumerate(rng.permutation(k), 1):
            walk[j:, i] += step if up[i] else -step
    return points


def morris(y, points):
    """(mean of the absolute effects, deviation of the effects) of each parameter, over its whole range. A large deviation: the
    effect depends on the other parameters, or is not linear."""
    du, dy = np.diff(points, axis=1), np.diff(y.reshape(points.shape[:2]), axis=1)[:, :, None]
    effects = np.divide(dy, du, out=np.full(du.shape, np.nan), where=du != 0).reshape(-1, du.shape[2])
    return [(np.mean(np.abs(e)), np.std(e, ddof=1)) if len(e) > 1 else (np.nan, np.nan) for e in (column[np.isfinite(column)] for column in effects.T)]


def sobol_indices(function, k, seed=1, n=2048):
    """(first order, total) parts of the variance of function(u): estimators of Saltelli et al. (Comput. Phys. Commun. 181 (2010)
    259, table 2) and of Jansen (1999)."""
    base = sobol(n, 2 * k, seed)
    a, b = base[:, :k], base[:, k:]
    fa, fb = function(a), function(b)
    variance, found = np.var(np.concatenate([fa, fb])), []
    for i in range(k):
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        f = function(mixed)
        found.append((float(np.mean(fb * (f - fa)) / variance), float(np.mean((fa - f) ** 2) / 2 / variance)))
    return found


def write(problem, runs):
    """Tables and a picture; what a terminal shows."""
    k, out = len(problem.parameters), runs.directory
    points = trajectories(k, problem.options["trajectories"], problem.options["seed"])
    place = runs.at(np.concatenate(points))
    need("scipy.stats", "python3-scipy", "knap-sensitivity", ("sklearn", "python3-sklearn"))
    runs.at(sobol(6 * k, k, problem.options["seed"]))  # also inside, for the emulator
    names = {(test, name) for test in problem.tests for name in problem.options.get("numbers") or
             [m.name for m in test.measured if m.x is None]}
    rows = []
    for test, name in sorted(names, key=lambda pair: (pair[0].name, pair[1])):
        y = runs.numbers(test, name)
        if np.isfinite(y).sum() < k + 2 or not np.nanstd(y) > 1e-12 * np.nanmax(np.abs(y)):
            rows += [[test.name, name, p.name, *["" if np.isfinite(y).any() else "no value"] * 2, "", "", "", "", ""] for p in problem.parameters]
            continue
        emulator = Emulator(runs.points, y[:, None, None], float(np.nanmax(np.abs(y))))
        part = float(emulator.noise[0] / np.nanvar(y))
        indices = sobol_indices(lambda u: emulator(u)[0][:, 0], k)
        for p, (mu, sigma), (first, total) in zip(problem.parameters, morris(y[place], points), indices):
            rows.append([test.name, name, p.name, float(mu), float(sigma), unit_of("summary", name) or "", float(mu / max(np.nanmean(np.abs(y)), 1e-300)), first, total, part])
    head = ["test", "number", "parameter", "mean effect", "deviation of effects", "unit", "effect over the mean", "Sobol first order", "Sobol total",
            "part of the seeds"]
    (out / "sensitivity.tex").write_text(knap.latex(head, rows, "Sensitivity of " + problem.name, digits=3), encoding="utf-8")
    for row in rows:
        print(f"{row[0]}: {row[1]} on {row[2]}: " + (f"{row[6]:.2g} of its mean over the bounds, {max(row[8], 0):.2f} of its variance"
                                                    if isinstance(row[6], float) else "it is the same in all runs or has no value"))
    notes = [f"{runs.counted()}. Effects: over the whole range of a parameter, from trajectories (Morris). Sobol: parts of the "
             "variance of the mean over seeds, from an emulator; total minus first order is interaction."]
    report.page(runs, notes, [("Sensitivity", "sensitivity.csv", head, rows)], _draw(rows, out))
    print(f"{notes[0]}\nsensitivity: {out}")
    return True


def _draw(rows, out):
    numbers = list(dict.fromkeys((row[0], row[1]) for row in rows if isinstance(row[8], float)))
    figure = report.figure_of(7, 1 + 1.8 * len(numbers))
    if figure is None or not numbers:
        return []
    axes = figure.subplots(len(numbers), squeeze=False)
    for axis, number in zip(axes[:, 0], numbers):
        mine = [row for row in rows if (row[0], row[1]) == number]
        place = np.arange(len(mine))
        axis.barh(place + 0.2, [row[8] for row in mine], 0.4, label="total", color="#bbccee")
        axis.barh(place - 0.2, [row[7] for row in mine], 0.4, label="first order", color="#4477aa")
        axis.set_yticks(place, [row[2] for row in mine])
        axis.set_title(f"{number[0]}: {number[1]}", fontsize="medium")
    axes[-1, 0].set_xlabel("part of the variance")
    axes[0, 0].legend(fontsize="small")
    return [report.save(figure, out, "Parts of the variance", "sensitivity.png")]
