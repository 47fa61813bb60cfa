"""Tables, pictures and report.html of a fit."""
import csv
import html
from statistics import NormalDist

import numpy as np

import knap


def _table(file, head, rows):
    with open(file, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(head)
        writer.writerows([[f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row] for row in rows])


def _html(head, rows):
    cells = lambda row, tag: "".join(f"<{tag}>{html.escape(f'{c:.4g}' if isinstance(c, float) else str(c))}</{tag}>" for c in row)
    return f"<table><tr>{cells(head, 'th')}</tr>" + "".join(f"<tr>{cells(row, 'td')}</tr>" for row in rows) + "</table>\n"


def surpluses(runs):
    """What is fitted is what the mesh of the user shows: a line for each test whose summary has its surpluses."""
    lines = []
    for test in runs.problem.tests:
        ratio = runs.numbers(test, "strength_ratio")
        if np.isfinite(ratio).any():
            lines.append(f"{test.name}: the specimens bear {np.nanmean(ratio):.3g} times the strength of their law (strength_ratio)")
        for given, has in (("measured_sigma_c", "interface_sigma_c"), ("measured_G_c", "interface_G_c")):
            part = runs.numbers(test, given) / runs.numbers(test, has)
            if np.isfinite(part).any():
                lines.append(f"{test.name}: {given[9:]} is as measured; the interfaces have it over {np.nanmean(part):.3g}")
    return lines or ["strength and toughness of the fit are those of the interfaces of this mesh; another mesh has other surpluses"]


def write(fit):
    """All files of a fit, and what a terminal shows; whether the values of [expect] are met."""
    problem, posterior, out = fit.problem, fit.posterior, fit.runs.directory
    low, high = posterior.interval()
    best, values = problem.values(posterior.best), problem.values(posterior.u)
    states, part = fit.determined(), posterior.u.std(axis=0) / fit.prior_deviation()
    level = f"{problem.options['interval']:g} %"
    head = ["parameter", "unit", "best", f"low {level}", f"high {level}", "mean", "deviation", "deviation over that before", "determined"]
    rows = [[p.name, p.unit, float(best[i]), float(low[i]), float(high[i]), float(values[:, i].mean()), float(values[:, i].std()), float(part[i]),
             states[i]] for i, p in enumerate(problem.parameters)]
    _table(out / "parameters.csv", head, rows)
    (out / "parameters.tex").write_text(knap.latex(head[:5], [row[:5] for row in rows], "Parameters of " + problem.name), encoding="utf-8")
    _table(out / "correlations.csv", ["parameter", *(p.name for p in problem.parameters)],
           [[p.name, *map(float, row)] for p, row in zip(problem.parameters, posterior.correlations())])
    keys = [(key.rpartition(":")[2], i) for i, p in enumerate(problem.parameters) for key in p.keys]
    keys = list(dict(keys).items())
    units = [problem.parameters[i].unit for _, i in keys]
    _table(out / "posterior.csv", [label(key, unit) for (key, _), unit in zip(keys, units)],
           [[float(row[i]) for _, i in keys] for row in values])
    residuals, predictions, curves = [], [], fit.predictions()
    for m, lower, middle, upper in curves:
        if m.values is None:
            continue
        r = m.values - middle
        deviations = 2 * NormalDist().inv_cdf(0.5 + problem.options["interval"] / 200)  # of the interval: 3.29 at 90 %
        z = r / np.maximum((upper - lower) / deviations, 1e-300)
        for j in range(m.size):
            row = [m.title, float(m.x[j]) if m.x is not None else "", m.unit, float(m.values[j]), float(middle[j]), float(lower[j]), float(upper[j])]
            if m.use == "fit":
                residuals.append([*row, float(r[j]), float(z[j])])
            else:
                predictions.append([*row, "yes" if lower[j] <= m.values[j] <= upper[j] else "no"])
    columns = ["measured", "x", "unit", "value", "model", f"low {level}", f"high {level}"]
    _table(out / "residuals.csv", [*columns, "residual", "in deviations"], residuals)
    _table(out / "predictions.csv", [*columns, "inside"], predictions)
    _table(out / "convergence.csv", ["runs", *(f"{p.name}: width over that of the bounds" for p in problem.parameters)],
           [[n, *map(float, width)] for n, width in fit.history])

    failed = sum(code not in (0, 4) for code in fit.runs.exits.values())
    notes = [f"{fit.runs.n_runs} runs, {failed} failed; {fit.stopped}."]
    if np.isfinite(fit.p):
        notes.append(f"Misfit: probability {fit.p:.2g} if the model were true." + (
            "" if fit.p >= 0.01 else " THE MODEL CANNOT MEET THESE DATA with any of its parameters."))
    if posterior.tau.any():
        tau = np.percentile(posterior.tau, [5, 50, 95]) * 100
        notes.append(f"A model error of {tau[1]:.2g} % ({tau[0]:.2g} to {tau[2]:.2g} %) of the largest value of each measurement is part of the "
                     "intervals.")
    notes += [f"{p.name} is {'only partly' if s == 'partly' else 'not'} determined by these data." for p, s in zip(problem.parameters, states) if s != "yes"]
    notes += [text[0].upper() + text[1:] + "." for text in fit.combinations()]
    notes += [f"{title} would take {100 * gain:.0f} % off the deviation of {name}." for name, title, gain in fit.further_tests()]
    for u, p in zip(posterior.u.T, problem.parameters):
        if np.mean(u < 0.03) > 0.15 or np.mean(u > 0.97) > 0.15:
            notes.append(f"{p.name} leans on a bound, {p.low:g} to {p.high:g} {p.unit}: widen it if the bound is no knowledge.")
    if predictions:
        notes.append(f"Left out: {sum(row[-1] == 'yes' for row in predictions)} of {len(predictions)} values lie in their intervals.")
    notes += [text[0].upper() + text[1:] + "." for text in surpluses(fit.runs)]
    for row in rows:
        print(f"{row[0]} = {row[2]:.5g} {row[1]}  ({level}: {row[3]:.5g} to {row[4]:.5g}; determined: {row[-1]})")
    print("\n".join(notes))
    pictures = draw(fit, curves)
    _page(out / "report.html", problem.name, notes, [("Parameters", head, rows), ("Residuals", [*columns, "residual", "in deviations"], residuals),
                                                   ("Predictions of what was left out", [*columns, "inside"], predictions)], pictures)
    print(f"fit:     {out}")
    expected = [(p.name, float(values[:, i].mean()), *problem.options["expect"][p.name])
                for i, p in enumerate(problem.parameters) if p.name in problem.options.get("expect", {})]
    for name, mean, value, within in expected:
        print(f"expect {name} {mean:.5g}, {value:g} within {within:.3g}: {'ok' if abs(mean - value) <= within else 'FAILED'}")
    return all(abs(mean - value) <= within for _, mean, value, within in expected)


def write_least_squares(problem, runs, u, residuals):
    values = problem.values(u)
    _table(runs.directory / "parameters.csv", ["parameter", "unit", "best"], [[p.name, p.unit, float(v)] for p, v in zip(problem.parameters, values)])
    for p, x in zip(problem.parameters, u):
        print(f"{p.name} = {p.text(x)}")
    print(f"{runs.n_runs} runs; root of the sum of squares {np.sqrt((residuals**2).sum()):.3g} deviations\nfit:     {runs.directory}")


def _page(file, name, notes, tables, pictures):
    body = "".join(f"<p>{html.escape(note)}</p>\n" for note in notes)
    body += "".join(f"<h2>{title}</h2>\n<img src=\"{picture}\" alt=\"{html.escape(title)}\">\n" for title, picture in pictures)
    body += "".join(f"<h2>{title}</h2>\n{_html(head, rows)}" for title, head, rows in tables if rows)
    file.write_text(f"""<!DOCTYPE html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(name)}</title>
<style>body{{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}table{{border-collapse:collapse;display:block;overflow-x:auto}}
td,th{{border-bottom:1px solid #ccc;padding:.2em .6em;text-align:left}}img{{max-width:100%}}</style>
<h1>{html.escape(name)}</h1>
{body}</html>
""", encoding="utf-8")


def label(name, unit):
    return f"{name} [{unit}]" if unit else name


def pyplot():
    """matplotlib.pyplot without a display; None, and a note, where it is missing."""
    try:
        import matplotlib
    except ImportError:
        print("no pictures: matplotlib is missing (apt install python3-matplotlib)")
        return None
    matplotlib.use("Agg")
    return __import__("matplotlib.pyplot").pyplot


def draw(fit, curves):
    """(title, file) of the pictures."""
    plt = pyplot()
    if plt is None:
        return []
    problem, posterior, out = fit.problem, fit.posterior, fit.runs.directory
    values, k = problem.values(posterior.u), len(problem.parameters)
    pictures = []

    def save(figure, title, name):
        figure.tight_layout()
        figure.savefig(out / name, dpi=110)
        plt.close(figure)
        pictures.append((title, name))

    figure, axes = plt.subplots(k, k, figsize=(2.2 * k + 1, 2.2 * k + 1), squeeze=False)
    for i in range(k):
        for j in range(k):
            axis = axes[i, j]
            if j > i:
                axis.axis("off")
                continue
            if i == j:
                axis.hist(values[:, i], 30, color="#4477aa")
                axis.set_yticks([])
            else:
                axis.plot(values[:, j], values[:, i], ",", color="#4477aa", alpha=0.4)
                axis.set_ylim(*np.percentile(values[:, i], [0.5, 99.5]))
            axis.set_xlim(*np.percentile(values[:, j], [0.5, 99.5]))
            if i == k - 1:
                axis.set_xlabel(label(problem.parameters[j].name, problem.parameters[j].unit))
            if j == 0 and i:
                axis.set_ylabel(label(problem.parameters[i].name, problem.parameters[i].unit))
    save(figure, "Posterior", "corner.png")

    figure, axes = plt.subplots(len(curves), 1, figsize=(7, 3.2 * len(curves)), squeeze=False)
    for axis, (m, low, middle, high) in zip(axes[:, 0], curves):
        runs = fit.runs.of(m).reshape(-1, m.size)
        x = np.arange(1) if m.x is None else m.x
        if m.x is None:
            axis.hist(runs[np.isfinite(runs)], 20, color="#cccccc", label="runs")
            axis.axvspan(float(low[0]), float(high[0]), color="#4477aa", alpha=0.4, label=f"model, {problem.options['interval']:g} %")
            if m.values is not None:
                axis.axvline(float(m.values[0]), color="#cc3311", label="measured")
            axis.set_xlabel(label(m.name, m.unit))
        else:
            axis.plot(x, runs.T, color="#cccccc", lw=0.5)
            axis.fill_between(x, low, high, color="#4477aa", alpha=0.4, label=f"model, {problem.options['interval']:g} %")
            axis.plot(x, middle, color="#4477aa")
            if m.values is not None:
                axis.plot(x, m.values, "o-", color="#cc3311", label="measured")
            axis.set_xlabel(label(m.columns[0][1], m.x_unit))
            axis.set_ylabel(label(m.name, m.unit))
        axis.set_title(m.title + {"fit": "", "predict": " (left out)", "candidate": " (not measured)"}[m.use], fontsize="medium")
        axis.legend(fontsize="small")
    save(figure, "Measured and model", "curves.png")

    figure, axis = plt.subplots(figsize=(7, 3.2))
    for i, p in enumerate(problem.parameters):
        axis.plot([n for n, _ in fit.history], [width[i] for _, width in fit.history], "o-", label=p.name)
    axis.set_xlabel("runs")
    axis.set_ylabel("width over that of the bounds")
    axis.set_ylim(0)
    axis.legend()
    save(figure, "Convergence of the intervals", "convergence.png")
    return pictures
