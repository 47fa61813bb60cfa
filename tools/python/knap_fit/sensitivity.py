"""Which parameters the numbers of runs depend on."""
import numpy as np

import knap

from . import report
from .emulator import Emulator, need
from .inference import sobol


def trajectories(k, n, seed, levels=4):
    """Design of Morris (Technometrics 33 (1991) 161): n walks through a grid of the unit cube, each of k + 1 points, of which
    two successive ones differ in one parameter by levels/(2 (levels - 1)). Returns points and the parameter of each step."""
    rng, step = np.random.default_rng(seed), levels / (2 * (levels - 1))
    points, steps = [], []
    for _ in range(n):
        u = rng.integers(0, levels // 2, k) / (levels - 1)
        up = rng.integers(0, 2, k) == 1
        points.append(np.where(up, u, u + step))
        for i in rng.permutation(k):
            u = points[-1].copy()
            u[i] += step if up[i] else -step
            points.append(u)
            steps.append((len(points) - 2, len(points) - 1, i))
    return np.array(points), steps


def morris(y, points, steps, k):
    """(mean of the absolute effects, deviation of the effects) of each parameter, over its whole range. A large deviation: the
    effect depends on the other parameters, or is not linear."""
    effects = [[] for _ in range(k)]
    for a, b, i in steps:
        if np.isfinite(y[a]) and np.isfinite(y[b]):
            effects[i].append((y[b] - y[a]) / (points[b, i] - points[a, i]))
    return [(np.mean(np.abs(e)), np.std(e, ddof=1)) if len(e) > 1 else (np.nan, np.nan) for e in effects]


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
    points, steps = trajectories(k, problem.options.get("trajectories", 8), problem.options["seed"])
    need("sklearn", "python3-sklearn", "the emulator")
    filling = sobol(6 * k, k, problem.options["seed"])  # so that the emulator knows the inside, too
    everything = np.vstack([points, filling])
    runs.add(everything[len(runs.points):])
    runs.finish()
    names = {(test, name) for test in problem.tests for name in problem.options.get("numbers") or
             [m.name for m in test.measured if m.x is None]}
    rows = []
    for test, name in sorted(names, key=lambda pair: (pair[0].name, pair[1])):
        y = runs.numbers(test, name)
        if np.isfinite(y).sum() < k + 2 or not np.nanstd(y) > 1e-12 * np.nanmax(np.abs(y)):
            rows += [[test.name, name, p.name, *["" if np.isfinite(y).any() else "no value"] * 2, "", "", "", ""] for p in problem.parameters]
            continue
        emulator = Emulator(runs.points, y[:, None, None], float(np.nanmax(np.abs(y))))
        part = float(emulator.noise[0] / np.nanvar(y))
        indices = sobol_indices(lambda u: emulator(u)[0][:, 0], k)
        for p, (mu, sigma), (first, total) in zip(problem.parameters, morris(y[:len(points)], points, steps, k), indices):
            rows.append([test.name, name, p.name, float(mu), float(sigma), float(mu / max(np.nanmean(np.abs(y)), 1e-300)), first, total, part])
    head = ["test", "number", "parameter", "mean effect", "deviation of effects", "effect over the mean", "Sobol first order", "Sobol total",
            "part of the seeds"]
    report._table(out / "sensitivity.csv", head, rows)
    (out / "sensitivity.tex").write_text(knap.latex(head, rows, "Sensitivity of " + problem.name, digits=3), encoding="utf-8")
    for row in rows:
        print(f"{row[0]}: {row[1]} on {row[2]}: " + (f"{row[5]:+.2g} of its mean over the bounds, {max(row[7], 0):.2f} of its variance"
                                                    if isinstance(row[5], float) else "it is the same in all runs or has no value"))
    failed = sum(code not in (0, 4) for code in runs.exits.values())
    notes = [f"{runs.n_runs} runs, {failed} failed. Effects: over the whole range of a parameter, from trajectories (Morris). Sobol: parts of the "
             "variance of the mean over seeds, from an emulator; total minus first order is interaction."]
    report._page(out / "report.html", problem.name, notes, [("Sensitivity", head, rows)], _draw(rows, out))
    print(f"{notes[0]}\nsensitivity: {out}")


def _draw(rows, out):
    plt = report.pyplot()
    numbers = list(dict.fromkeys((row[0], row[1]) for row in rows if isinstance(row[7], float)))
    if plt is None or not numbers:
        return []
    figure, axes = plt.subplots(len(numbers), 1, figsize=(7, 1 + 1.8 * len(numbers)), squeeze=False)
    for axis, number in zip(axes[:, 0], numbers):
        mine = [row for row in rows if (row[0], row[1]) == number]
        place = np.arange(len(mine))
        axis.barh(place + 0.2, [row[7] for row in mine], 0.4, label="total", color="#bbccee")
        axis.barh(place - 0.2, [row[6] for row in mine], 0.4, label="first order", color="#4477aa")
        axis.set_yticks(place, [row[2] for row in mine])
        axis.set_title(f"{number[0]}: {number[1]}", fontsize="medium")
    axes[-1, 0].set_xlabel("part of the variance")
    axes[0, 0].legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(out / "sensitivity.png", dpi=110)
    plt.close(figure)
    return [("Parts of the variance", "sensitivity.png")]
