"""Tables, pictures and report.html of a fit."""
import html
import pathlib
import platform
import shlex
import sys
import textwrap
from statistics import NormalDist

import numpy as np

import knap

from .inference import data_covariance
from .problem import label, tomllib

_libraries = ("numpy", "scipy", "sklearn", "emcee", "matplotlib")
_notes = tomllib.loads((pathlib.Path(__file__).parent / "notes.toml").read_text(encoding="utf-8"))
_of_data, _of_model = "#cc3311", "#4477aa"  # colours


def say(name, /, **values):
    """A sentence of notes.toml; one of its values may be a name, too."""
    return _notes[name].format(**values)


def write(fit):
    """All files of a fit, and what a terminal shows; whether they lie where FILE expects them."""
    problem, posterior, out = fit.problem, fit.posterior, fit.runs.directory
    level = f"{100 * problem.options['interval']:g} %"
    names, values = [p.name for p in problem.parameters], problem.values(posterior.u)
    numbers = np.array([np.median(values, axis=0), *posterior.interval(), values.mean(axis=0), values.std(axis=0),
                        fit.narrowed_to()[0], problem.values(posterior.best)])
    head = ["parameter", "unit", "median", f"low {level}", f"high {level}", "mean", "deviation",
            "deviation over that before", "most likely", "determined"]
    rows = [[p.name, p.unit, *row, state]
            for p, row, state in zip(problem.parameters, numbers.T.tolist(), fit.determined())]
    drawn = {f"posterior_{test.name}.csv": problem.keys_of(test) for test in problem.tests}
    drawn["posterior.csv"] = every = problem.keys_of(*problem.tests)  # a sweep takes the keys of its scenario alone
    for file, keys in drawn.items():
        if keys != every or file == "posterior.csv":
            titles = [label(key, problem.parameters[i].unit) for key, i in keys.items()]
            knap.write_csv(out / file, titles, values[: problem.options["draws"], list(keys.values())].tolist())
    curves, further, columns = fit.predictions(), fit.further_tests(), ["measured", "x", "unit of x", "value", "model"]
    deviations = 2 * NormalDist().inv_cdf(0.5 + problem.options["interval"] / 2)  # of the interval: 3.29 at 90 %
    compared = [(m, [*row, unit]) for m, low, middle, high in curves for *row, unit in places(m, middle, low, high)]
    residuals = [[*row, row[3] - row[4], (row[3] - row[4]) * deviations / max(row[6] - row[5], 1e-300)]
                 for m, row in compared if m.use == "fit"]
    predictions = [[*row, "yes" if row[5] <= row[3] <= row[6] else "no"] for m, row in compared if m.use != "fit"]
    columns += [f"low {level}", f"high {level}", "unit"]
    tables = [("Parameters", "parameters.csv", head, rows),
              ("Correlations", "correlations.csv", ["parameter", *names],
               [[name, *map(float, row)] for name, row in zip(names, np.atleast_2d(np.corrcoef(posterior.u.T)))]),
              ("Further tests: by how much they would narrow the intervals", "further_tests.csv",
               ["measured once", *(f"{name} [%]" for name in (*names, "with a scatter of", "and a model error of"))],
               [[title, *(100 * np.array([*part, *errors])).tolist()] for title, part, *errors in further]),
              ("Residuals", "residuals.csv", [*columns, "residual", "in deviations"], residuals),
              ("Predictions of what was left out", "predictions.csv", [*columns, "inside"], predictions)]
    latex = knap.latex(head[:5], [row[:5] for row in rows], "Parameters of " + problem.name)
    (out / "parameters.tex").write_text(latex, encoding="utf-8")
    for row in rows:
        print(f"{row[0]} = {row[2]:.5g} {row[1]}  ({level}: {row[3]:.5g} to {row[4]:.5g}; determined: {row[-1]})")
    pictures = [picture(out, "Posterior", "corner.png", corner, fit), curves_over(fit.runs, curves, f"model, {level}"),
                picture(out, "Convergence of the intervals", "convergence.png", convergence, fit)]
    page(fit.runs, said(fit, further, predictions), tables, pictures)
    return meets(problem, values.mean(axis=0))


def meets(problem, values):
    """Whether these values of the parameters lie where FILE expects them; prints each."""
    met = True
    for p, value in ((p, value) for p, value in zip(problem.parameters, values) if p.expect is not None):
        low, high = p.expect
        is_met = bool(low <= value <= high)
        print(f"expect {p.name} {value:.5g}, {low:g} to {high:g} {p.unit}: {'ok' if is_met else 'FAILED'}")
        met = met and is_met
    return met


def places(m, *rows):
    """Rows of what was measured and what stands for it: a line for each place."""
    columns = [] if m.values is None else [[""] if m.x is None else m.x, m.values, *rows]
    columns = [column if isinstance(column, list) else column.tolist() for column in columns]
    return [[m.title, x, m.x_unit if m.x is not None else "", *line, m.unit] for x, *line in zip(*columns)]


def said(fit, further, predictions):
    """Sentences: what the data say, and what they do not."""
    parameters, posterior, emulators = fit.problem.parameters, fit.posterior, fit.emulators
    notes = [say("counted", counted=fit.runs.counted(), stopped=fit.stopped)]
    notes += [say("filled", n=len(fit.runs.values))] * fit.is_filled
    notes += [say("no_misfit" if np.isnan(fit.p) else "misfit", p=fit.p)] + [say("contradicted")] * fit.contradicted
    for m in (m for m in fit.problem.fitted if m.scatter is None):
        taken = float(np.sqrt(np.diag(data_covariance(m, emulators[m.title])).max() * m.n))
        notes.append(say("scatter", m=m, taken=taken, part=100 * taken / m.level))
        notes += [say("few_seeds", m=m)] * bool(emulators[m.title].freedom < 2)
        more = ", `seeds = 2`, or more runs" * (m.n > 1)
        notes += [say("one_specimen", m=m, more=more)] * (m in fit.unknown_scatter())
    notes += [say("unconverged", m=m, ratio=ratio) for m, ratio in fit.unconverged()]
    notes += [say("surplus", p=p, part=100 * part) for p, part in zip(parameters, fit.surpluses) if part > 0]
    if posterior.tau.any():
        notes.append(say("error", tau=np.percentile(posterior.tau, [5, 50, 95]) * 100))
    notes += [say("largest" if posterior.tau.any() else "no_error")] * fit.beyond_error
    ends = zip(parameters, posterior.best, *posterior.interval())
    notes += [say("peak", p=p, value=p.text(u)) for p, u, low, high in ends if not low <= p.value(u) <= high]
    notes += [say("undetermined", p=p, how="only partly" if state == "partly" else "not")
              for p, state in zip(parameters, fit.determined()) if state != "yes"]
    notes += [text[0].upper() + text[1:] + "." for text in fit.combinations()]
    for title, narrowed, scatter, error in further:
        most = ", ".join(f"{p.name} by {100 * part:.0f} %" for p, part in zip(parameters, narrowed) if part >= 0.01)
        what = f"the intervals: {most}" if most else "no interval"
        error = f"the model error of this fit, {100 * error:.2g} %" if error else "no model error"
        notes.append(say("further", title=title, what=what, scatter=100 * scatter, error=error))
    notes += [say("no_emulator", m=m) for m in fit.problem.measured if m.title not in emulators]
    notes += dict.fromkeys(text for u in (fit.exact, posterior.at) for text in pressed(fit.problem, u))
    if predictions:
        notes.append(say("left_out", inside=sum(row[-1] == "yes" for row in predictions), n=len(predictions)))
    for m in (m for m in fit.problem.measured if m.title in emulators and emulators[m.title].works.mean() < 0.95):
        works, is_fitted = emulators[m.title].works, m.use == "fit"
        notes.append(say("no_value", m=m, lost=(~works).sum(), n=len(works), cause=textwrap.shorten(fit.runs.cause(m.test), 120),
                         fitted="the fit takes parameters there for impossible, and " * is_fitted))
    return notes + surpluses(fit.runs)


def surpluses(runs):
    """What is fitted is what the mesh of the user shows: a line for each test whose summary has its surpluses."""
    found = []
    for test in runs.problem.tests:
        for name in ("", "sigma_c", "G_c"):
            ratio = runs.numbers(test, f"measured_{name}" if name else "strength_ratio")
            ratio = ratio / runs.numbers(test, f"interface_{name}") if name else ratio
            if np.isfinite(ratio).any():
                kind = "as_measured" if name else "ratio"
                found.append(say(kind, test=test.name, name=name, value=np.nanmean(ratio)))
    return found or [say("of_the_mesh")]


def pressed(problem, u):
    """Texts: parameters that lie at a bound, of rows of u: more than 15 % of them within 3 % of it."""
    return [say("pressed", p=p, side=side, keys=", ".join(p.keys), bound=p.text(end))
            for p, x in zip(problem.parameters, u.T) for side, end in (("lower", 0.0), ("upper", 1.0))
            if (np.abs(x - end) < 0.03).mean() > 0.15]


def write_least_squares(problem, runs, u, residuals):
    """All files of a fit by least squares, and what a terminal shows; whether they lie where FILE expects them."""
    values = {p.name: float(p.value(x)) for p, x in zip(problem.parameters, u)}
    answers = ((m, runs.of(m)[runs.values.index(problem.rounded(u))]) for m in problem.measured if m.values is not None)
    best = [(m, np.nanmean(found, axis=0)) for m, found in answers if np.isfinite(found).any()]
    tables = [("Parameters", "parameters.csv", ["parameter", "unit", "best"],
               [[p.name, p.unit, values[p.name]] for p in problem.parameters]),
              ("Measured and model", "residuals.csv",
               ["measured", "x", "unit of x", "value", "model", "unit", "residual"],
               [[*row, row[3] - row[4]] for m, found in best for row in places(m, found)])]
    known, square = all(m.scatter for m in problem.fitted), residuals @ residuals
    unknown = "" if known else " (without `scatter` 1 % of the largest value)"
    notes = [say("least", counted=runs.counted(), root=np.sqrt(square), unknown=unknown), *pressed(problem, u[None])]
    notes += [say("least_misses")] * bool(known and square > 4 * len(problem.fitted))
    print(*(f"{p.name} = {p.text(x)}" for p, x in zip(problem.parameters, u)), sep="\n")
    page(runs, notes, tables, [curves_over(runs, [(m, found, found, found) for m, found in best], "model")])
    return meets(problem, values.values())


def page(runs, notes, tables, pictures):
    """The notes on the terminal, the tables as csv, and report.html, one file: notes, the first table, pictures, the
    other tables, and how it was made."""
    problem, safe = runs.problem, html.escape
    for _, file, head, rows in tables:
        knap.write_csv(runs.directory / file, head, rows)
    blocks = [f"<h2>{safe(title)}</h2>\n{knap.html_table(head, rows)}" for title, _, head, rows in tables if rows]
    blocks[1:1] = [f"<h2>{title}</h2>\n{knap.image(file, title)}" for title, file in filter(None, pictures)]
    made = next((run.info for test in problem.tests for run in runs.answers(test) if hasattr(run, "info")), {})
    versions = [f"knap {made.get('version', '')} {made.get('git', {}).get('hash', '')}",
                f"Python {platform.python_version()}"]
    versions += [f"{name} {sys.modules[name].__version__}" for name in _libraries if name in sys.modules]
    blocks.append(f"<h2>How it was made</h2>\n<p><code>{safe(shlex.join(map(str, sys.argv)))}</code></p>\n"
                  f"<p>{', '.join(versions)}</p>")
    files = [*filter(None, [problem.file]), *(test.scenario for test in problem.tests)]
    for file in dict.fromkeys(map(pathlib.Path, files)):
        text = file.read_text(encoding="utf-8") if file.is_file() else f"built into knap: knap new NAME --from {file}"
        blocks.append(f"<details><summary>{safe(file.name)}</summary><pre>{safe(text)}</pre></details>")
    body = "\n".join([*(f"<p>{safe(note)}</p>" for note in notes), *blocks, ""])
    text = (pathlib.Path(__file__).parent / "page.html").read_text(encoding="utf-8")
    text = text.replace("NAME", safe(problem.name)).replace("BODY", body)
    (runs.directory / "report.html").write_text(text, encoding="utf-8")
    print(*notes, f"{'results:':<8} {runs.directory}", sep="\n")


def picture(out, title, name, draw, *arguments, size=(7, 3.2)):
    """(title, file) of what a function of a Figure draws; None, and a note, where matplotlib is missing."""
    try:
        import matplotlib.figure
    except ImportError:
        return print("no pictures: matplotlib is missing (apt install python3-matplotlib)")
    figure = matplotlib.figure.Figure(figsize=size)
    draw(figure, *arguments)
    figure.tight_layout()
    figure.savefig(out / name, dpi=110)
    return title, out / name


def corner(figure, fit):
    """Histograms and pairs of the posterior, in the scales of the parameters: over less than two decades with ticks at
    few round numbers."""
    import matplotlib.ticker as ticker
    parameters, u = fit.problem.parameters, fit.posterior.u[:2000]
    values, k = fit.problem.values(u), len(parameters)
    limits = np.percentile(values, [0.5, 99.5], axis=0).T
    figure.set_size_inches(2.2 * k + 1, 2.2 * k + 1)
    for (i, j), axes in np.ndenumerate(figure.subplots(k, k, squeeze=False)):
        if j > i:
            axes.axis("off")
            continue
        if i == j:
            axes.hist(values[:, i], parameters[i].value(np.linspace(u[:, i].min(), u[:, i].max(), 31)), color=_of_model)
            axes.set_yticks([])
        else:
            axes.plot(values[:, j], values[:, i], ".", ms=2, color=_of_model, alpha=0.3, mec="none")
        for axis, n, is_outer in ((axes.xaxis, j, i == k - 1), *[(axes.yaxis, i, j == 0)] * (i != j)):
            p, name = parameters[n], axis.axis_name
            axes.set(**{f"{name}scale": "log" if p.log else "linear", f"{name}lim": limits[n],
                        f"{name}label": label(p.name, p.unit) * is_outer})
            if not p.log or limits[n][1] < 100 * limits[n][0]:
                axis.set_major_locator(ticker.MaxNLocator(3))
                axis.set_major_formatter("{x:.4g}")
                axis.set_minor_locator(ticker.NullLocator())
            axis.set_tick_params(rotation=45, labelsize="small")


def curves_over(runs, curves, of_model):
    """The picture of curves (measured, low, middle, high) over the measurements and the runs."""
    def draw(figure):
        for axis, (m, *found) in zip(figure.subplots(len(curves), squeeze=False)[:, 0], curves):
            x, number = (np.arange(2), 2) if m.x is None else (m.x, 1)  # a number is a line from 0 to 1
            low, middle, high = (np.tile(values, number) for values in found)
            axis.plot(x, np.tile(runs.of(m).reshape(-1, m.size), number).T, color="#cccccc", lw=0.5)
            axis.fill_between(x, low, high, color=_of_model, alpha=0.4, label=of_model)
            axis.plot(x, middle, color=_of_model)
            if m.values is not None:
                axis.plot(x, np.tile(m.values, number), "o-" if number == 1 else "-", color=_of_data, label="measured")
            axis.set(ylabel=label(m.name, m.unit))
            if number == 1:
                axis.set(xlabel=label(m.columns[0].partition(".")[2], m.x_unit))
            else:
                axis.set(xticks=[])
            axis.set_title(m.title, fontsize="medium")
            axis.legend(fontsize="small")

    return curves and picture(runs.directory, "Measured and model", "curves.png", draw, size=(7, 3.2 * len(curves)))


def convergence(figure, fit):
    """Widths of the intervals over the runs."""
    axis, (runs, _, widths) = figure.subplots(), zip(*fit.history)
    axis.plot(runs, widths, "o-", label=[p.name for p in fit.problem.parameters])
    axis.set(xlabel="runs", ylabel="width over that of the bounds", ylim=0)
    axis.legend()
