"""Tables, pictures and report.html of a fit."""
import html
import pathlib
import platform
import shlex
import sys
from statistics import NormalDist

import numpy as np

import knap

from .inference import data_covariance, pressed
from .problem import label
from .runs import table


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
    problem, posterior, out, level = fit.problem, fit.posterior, fit.runs.directory, f"{100 * fit.problem.options['interval']:g} %"
    names, values = [p.name for p in problem.parameters], problem.values(posterior.u)
    numbers = [np.median(values, axis=0), *posterior.interval(), values.mean(axis=0), values.std(axis=0), fit.narrowed_to()[0],
               problem.values(posterior.best)]
    head = ["parameter", "unit", "median", f"low {level}", f"high {level}", "mean", "deviation", "deviation over that before", "most likely", "determined"]
    rows = [[p.name, p.unit, *map(float, row), state] for p, row, state in zip(problem.parameters, np.transpose(numbers), fit.determined())]
    correlations = [[name, *map(float, row)] for name, row in zip(names, np.atleast_2d(np.corrcoef(posterior.u.T)))]
    drawn = {"posterior.csv": problem.keys_of(*problem.tests)}  # a sweep takes the keys of its scenario alone
    drawn.update({f"posterior_{test.name}.csv": keys for test in problem.tests if (keys := problem.keys_of(test)) != drawn["posterior.csv"]})
    for file, keys in drawn.items():
        table(out / file, [label(key, problem.parameters[i].unit) for key, i in keys.items()], values[:, list(keys.values())].tolist())
    curves, further = fit.predictions(), fit.further_tests()
    residuals, predictions = against_data(fit, curves)
    columns = ["measured", "x", "unit of x", "value", "model", f"low {level}", f"high {level}", "unit"]
    tables = [("Parameters", "parameters.csv", head, rows),
              ("Correlations", "correlations.csv", ["parameter", *names], correlations),
              ("Further tests: by how much they would narrow the intervals", "further_tests.csv", ["measured once", *(f"{name} [%]" for name in names), "with a scatter of [%]", "and a model error of [%]"],
               [[title, *(100 * narrowed).tolist(), 100 * scatter, 100 * error] for title, narrowed, scatter, error in further]),
              ("Residuals", "residuals.csv", [*columns, "residual", "in deviations"], residuals),
              ("Predictions of what was left out", "predictions.csv", [*columns, "inside"], predictions)]
    (out / "parameters.tex").write_text(knap.latex(head[:5], [row[:5] for row in rows], "Parameters of " + problem.name), encoding="utf-8")
    notes = said(fit, further, predictions)
    for row in rows:
        print(f"{row[0]} = {row[2]:.5g} {row[1]}  ({level}: {row[3]:.5g} to {row[4]:.5g}; determined: {row[-1]})")
    print("\n".join(notes))
    page(fit.runs, notes, tables, draw(fit, curves, level))
    print(f"fit:     {out}")
    return meets(problem, dict(zip(names, values.mean(axis=0))))


def meets(problem, values):
    """Whether these values of the parameters are those of [expect]; prints each."""
    missed = {name: abs(values[name] - value) > within for name, (value, within) in problem.options.get("expect", {}).items()}
    for name, (value, within) in problem.options.get("expect", {}).items():
        print(f"expect {name} {values[name]:.5g}, {value:g} within {within:.3g}: {'FAILED' if missed[name] else 'ok'}")
    return not any(missed.values())


def places(m, *rows):
    """Rows of a measurement and what stands for it, in the units of FILE: a line for each place."""
    x = [""] if m.x is None else m.x_in_file.tolist()
    return [[m.title, place, m.x_shown, *line, m.shown] for place, *line in zip(x, *(m.in_file(values).tolist() for values in (m.values, *rows)))]


def against_data(fit, curves):
    """Rows of the residuals of what was fitted, and of the predictions of what was left out."""
    residuals, predictions = [], []
    deviations = 2 * NormalDist().inv_cdf(0.5 + fit.problem.options["interval"] / 2)  # of the interval: 3.29 at 90 %
    for m, low, middle, high in (row for row in curves if row[0].values is not None):
        for row in places(m, middle, low, high):
            value, model, lower, upper = row[3:7]
            if m.use == "fit":
                residuals.append([*row, value - model, (value - model) * deviations / max(upper - lower, 1e-300)])
            else:
                predictions.append([*row, "yes" if lower <= value <= upper else "no"])
    return residuals, predictions


def said(fit, further, predictions):
    """Sentences: what the data say, and what they do not."""
    parameters, states = fit.problem.parameters, fit.determined()
    notes = [f"{fit.runs.counted()}; {fit.stopped}."]
    if fit.is_filled:
        notes.append(f"All {len(fit.runs.values)} points fill the space between the bounds (fit.first, fit.budget): none was chosen by what others taught. A larger budget "
                     "narrows the intervals faster.")
    if np.isfinite(fit.p):
        notes.append(f"Misfit: probability {fit.p:.2g} if the model were true." + (
            "" if not fit.contradicted else " THE MODEL CANNOT MEET THESE DATA with any of its parameters, or their scatter and noise are larger than stated; "
            "none of its parameters counts as determined."))
    else:
        notes.append("There are no more numbers than parameters: whether the model can meet the data cannot be judged, and no model error is found. "
                     "See the residuals.")
    for m in (m for m in fit.problem.fitted if m.scatter is None):
        emulator, unknown = fit.emulators[m.title], m in fit.unknown_scatter()
        taken = float(np.sqrt(np.diag(data_covariance(m, emulator)).max() * m.n))
        notes.append(f"{m.title}: no `scatter` is given; that of the seeds is taken, at least 0.1 %: {'at most ' * (m.x is not None)}{m.in_file(taken):.3g} {m.shown}".rstrip() + f" ({100 * taken / m.level:.2g} % of its largest value)."
                     + " Too few runs differ by their seed alone: THE INTERVALS DO NOT HOLD THE SCATTER OF MESHES." * bool(emulator.freedom < 2)
                     + f" Nothing tells that of specimens, and no parameter counts as determined: give `scatter`{', `seeds = 2`, or more runs' * (m.n > 1)}." * unknown)
    if fit.posterior.tau.any():
        tau = np.percentile(fit.posterior.tau, [5, 50, 95]) * 100
        notes.append(f"A model error of {tau[1]:.2g} % ({tau[0]:.2g} to {tau[2]:.2g} %) of the largest value of each measurement is part of the "
                     "intervals.")
    if fit.beyond_error:
        notes.append("THE MODEL ERROR REACHES ITS LARGEST, 100 % of the largest value of each measurement: the model may miss more, and the intervals are too narrow."
                     if fit.posterior.tau.any() else "There is no model error (model_error): the intervals are too narrow.")
    notes += [f"{p.name}: the most likely value, {p.text(u)}, lies outside of the interval: that of all parameters together is a narrow peak, "
              "while most of the probability lies elsewhere. Take the draws of posterior.csv, not one value."
              for p, u, low, high in zip(parameters, fit.posterior.best, *fit.posterior.interval()) if not low <= p.value(u) <= high]
    notes += [f"{p.name} is {'only partly' if s == 'partly' else 'not'} determined by these data." for p, s in zip(parameters, states) if s != "yes"]
    notes += [text[0].upper() + text[1:] + "." for text in fit.combinations()]
    for title, narrowed, scatter, error in further:
        most = ", ".join(f"{p.name} by {100 * part:.0f} %" for p, part in zip(parameters, narrowed) if part >= 0.01)
        notes.append(f"{title} would narrow {f'the intervals: {most}' if most else 'no interval'}, with a scatter of {100 * scatter:.2g} % and "
                     f"{f'the model error of this fit, {100 * error:.2g} %' if error else 'no model error'}.")
    notes += [f"{m.title}: too few runs have a value to say what it would tell." for m in fit.problem.measured if m.title not in fit.emulators]
    notes += dict.fromkeys(text for u in (fit.exact, fit.posterior.u) for text in pressed(fit.problem, u))
    if predictions:
        notes.append(f"Left out: {sum(row[-1] == 'yes' for row in predictions)} of {len(predictions)} values lie in their intervals.")
    for m in (m for m in fit.problem.measured if m.title in fit.emulators):
        works = fit.emulators[m.title].works
        if works.mean() < 0.95:
            notes.append(f"{m.title}: no value at {(~works).sum()} of {len(works)} points, where a run failed or ended too early (time.end); "
                         + "the fit takes parameters there for impossible, and " * (m.use == "fit") + "its interval is that of the others.")
            gates = fit.runs.gates(m.test)
            if gates:
                notes.append(f"{m.test.name}: {sum(gates.values())} of these runs ended at a gate ({', '.join(f'{name} {n}' for name, n in gates.items())}), which shows "
                             "what the run could not resolve, not that its parameters are impossible: a smaller step or a finer mesh may have the value.")
    return notes + [text[0].upper() + text[1:] + "." for text in surpluses(fit.runs)]


def write_least_squares(problem, runs, u, residuals):
    """All files of a fit by least squares, and what a terminal shows; whether the values of [expect] are met."""
    values = problem.values(u)
    rows = [[p.name, p.unit, float(value)] for p, value in zip(problem.parameters, values)]
    answers = ((m, runs.of(m)[runs.values.index(problem.rounded(u))]) for m in problem.measured if m.values is not None)
    best = [(m, np.nanmean(found, axis=0)) for m, found in answers if np.isfinite(found).any()]
    compared = [[*row[:5], row[-1], row[3] - row[4]] for m, found in best for row in places(m, found)]
    tables = [("Parameters", "parameters.csv", ["parameter", "unit", "best"], rows),
              ("Measured and model", "residuals.csv", ["measured", "x", "unit of x", "value", "model", "unit", "residual"], compared)]
    notes = [f"{runs.counted()}; root of the sum of squares {np.sqrt((residuals**2).sum()):.3g} deviations"
             + " (without `scatter` 1 % of the largest value)" * (not all(m.scatter for m in problem.fitted)) + ". Least squares give the best values alone, without intervals "
             "(method)." + " THE MODEL MISSES THESE DATA by more than their scatter." * (all(m.scatter for m in problem.fitted) and residuals @ residuals > 4 * len(problem.fitted)), *pressed(problem, u[None])]
    page(runs, notes, tables, [curves_over(runs, [(m, found, found, found) for m, found in best], "model")])
    print(*(f"{p.name} = {p.text(x)}" for p, x in zip(problem.parameters, u)), *notes, f"fit:     {runs.directory}", sep="\n")
    return meets(problem, {p.name: float(value) for p, value in zip(problem.parameters, values)})


def page(runs, notes, tables, pictures):
    """The tables as csv, and report.html, one file: the notes, the first table, the pictures, the other tables, and how it was made."""
    problem = runs.problem
    for _, file, head, rows in tables:
        table(runs.directory / file, head, rows)
    blocks = [f"<h2>{html.escape(title)}</h2>\n{knap.html_table(head, rows)}\n" for title, _, head, rows in tables if rows]
    blocks[1:1] = [f"<h2>{title}</h2>\n{knap.image(file, title)}\n" for title, file in filter(None, pictures)]
    made = next((run.info for test in problem.tests for run in runs.answers(test) if hasattr(run, "info")), {})
    versions = {"knap": f"{made.get('version', '')} {made.get('git', {}).get('hash', '')}", "Python": platform.python_version(),
                **{name: sys.modules[name].__version__ for name in ("numpy", "scipy", "sklearn", "emcee", "matplotlib") if name in sys.modules}}
    blocks += [f"<h2>How it was made</h2>\n<p><code>{html.escape(shlex.join(map(str, sys.argv)))}</code></p>\n",
               f"<p>{html.escape(', '.join(' '.join(version) for version in versions.items()))}</p>\n"]
    for file in dict.fromkeys([*([problem.file] if problem.file else []), *(pathlib.Path(test.scenario) for test in problem.tests)]):
        text = file.read_text(encoding="utf-8") if file.is_file() else "built into knap: knap new --from " + str(file)
        blocks.append(f"<details><summary>{html.escape(file.name)}</summary><pre>{html.escape(text)}</pre></details>\n")
    body = "".join(f"<p>{html.escape(note)}</p>\n" for note in notes) + "".join(blocks)
    text = (pathlib.Path(__file__).parent / "page.html").read_text(encoding="utf-8")
    (runs.directory / "report.html").write_text(text.replace("NAME", html.escape(problem.name)).replace("BODY", body), encoding="utf-8")


def figure_of(*size):
    """A Figure of matplotlib; None, and a note, where it is missing."""
    try:
        return __import__("matplotlib.figure").figure.Figure(figsize=size)
    except ImportError:
        print("no pictures: matplotlib is missing (apt install python3-matplotlib)")
        return None


def save(figure, out, title, name):
    """Title and file, for a page."""
    figure.tight_layout()
    figure.savefig(out / name, dpi=110)
    return title, out / name


def corner(figure, fit):
    """Histograms and pairs of the posterior, in the scales of the parameters."""
    ticker, problem, posterior = __import__("matplotlib.ticker").ticker, fit.problem, fit.posterior
    values, k = problem.values(posterior.u), len(problem.parameters)
    axes = figure.subplots(k, k, squeeze=False)
    limits = np.percentile(values, [0.5, 99.5], axis=0).T

    def scale(axis, i, label):
        """Of one axis of a plot; within two decades it has ticks at round numbers."""
        axis.axes.set(**{f"{axis.axis_name}scale": "log" if problem.parameters[i].log else "linear"})
        axis.axes.set(**{f"{axis.axis_name}lim": limits[i], f"{axis.axis_name}label": label})
        if not problem.parameters[i].log or limits[i][1] < 100 * limits[i][0]:
            axis.set_major_locator(ticker.MaxNLocator(3))
            axis.set_major_formatter("{x:.4g}")
            axis.set_minor_locator(ticker.NullLocator())
    for i, of in enumerate(problem.parameters):
        for j, over in enumerate(problem.parameters):
            axis = axes[i, j]
            if j > i:
                axis.axis("off")
                continue
            if i == j:
                axis.hist(values[:, i], of.value(np.linspace(*np.percentile(posterior.u[:, i], [0, 100]), 31)), color="#4477aa")
                axis.set_yticks([])
            else:
                axis.plot(values[:, j], values[:, i], ".", ms=2, color="#4477aa", alpha=0.3, mec="none")
                scale(axis.yaxis, i, of.title if j == 0 else "")
            scale(axis.xaxis, j, over.title if i == k - 1 else "")
    return figure


def curves_over(runs, curves, label_of_model):
    """The picture of curves (measured, low, middle, high) over the measurements and the runs; None without matplotlib."""
    figure = figure_of(7, 3.2 * len(curves))
    if figure is None or not curves:
        return None
    for axis, (m, *of_model) in zip(figure.subplots(len(curves), squeeze=False)[:, 0], curves):
        x, number = (np.arange(2), 2) if m.x is None else (m.x_in_file, 1)  # a number is a line from 0 to 1
        low, middle, high = (np.tile(m.in_file(values), number) for values in of_model)
        axis.plot(x, np.tile(m.in_file(runs.of(m)).reshape(-1, m.size), number).T, color="#cccccc", lw=0.5)
        axis.fill_between(x, low, high, color="#4477aa", alpha=0.4, label=label_of_model)
        axis.plot(x, middle, color="#4477aa")
        if m.values is not None:
            axis.plot(x, np.tile(m.in_file(m.values), number), "o-" if number == 1 else "-", color="#cc3311", label="measured")
        axis.set(ylabel=label(m.name, m.shown), xlabel=label(m.columns[0][1], m.x_shown) if number == 1 else "", **({"xticks": []} if number == 2 else {}))
        axis.set_title(m.title, fontsize="medium")
        axis.legend(fontsize="small")
    return save(figure, runs.directory, "Measured and model", "curves.png")


def draw(fit, curves, level):
    """(title, file) of the pictures."""
    out, parameters = fit.runs.directory, fit.problem.parameters
    figure = figure_of(2.2 * len(parameters) + 1, 2.2 * len(parameters) + 1)
    if figure is None:
        return []
    pictures = [save(corner(figure, fit), out, "Posterior", "corner.png"), curves_over(fit.runs, curves, f"model, {level}")]
    figure, (runs, _, widths) = figure_of(7, 3.2), zip(*fit.history)
    axis = figure.subplots()
    axis.plot(runs, widths, "o-", label=[p.name for p in parameters])
    axis.set(xlabel="runs", ylabel="width over that of the bounds", ylim=0)
    axis.legend()
    return [*pictures, save(figure, out, "Convergence of the intervals", "convergence.png")]
