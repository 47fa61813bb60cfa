"""Tables, pictures and report.html of a fit."""
import html
import pathlib
from statistics import NormalDist

import numpy as np

import knap

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
    numbers = [np.median(values, axis=0), *posterior.interval(), values.mean(axis=0), values.std(axis=0), posterior.u.std(axis=0) / fit.prior_deviation(),
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
              ("Further tests: by how much they would narrow the intervals", "further_tests.csv", ["measured once", *(f"{name} [%]" for name in names)],
               [[title, *(100 * narrowed).tolist()] for title, narrowed in further]),
              ("Residuals", "residuals.csv", [*columns, "residual", "in deviations"], residuals),
              ("Predictions of what was left out", "predictions.csv", [*columns, "inside"], predictions)]
    for _, file, titles, lines in tables:
        table(out / file, titles, lines)
    (out / "parameters.tex").write_text(knap.latex(head[:5], [row[:5] for row in rows], "Parameters of " + problem.name), encoding="utf-8")
    notes = said(fit, further, predictions)
    for row in rows:
        print(f"{row[0]} = {row[2]:.5g} {row[1]}  ({level}: {row[3]:.5g} to {row[4]:.5g}; determined: {row[-1]})")
    print("\n".join(notes))
    _page(out / "report.html", problem.name, notes, [(title, *rest) for title, _, *rest in tables], draw(fit, curves))
    print(f"fit:     {out}")
    return meets(problem, dict(zip(names, values.mean(axis=0))))


def meets(problem, values):
    """Whether these values of the parameters are those of [expect]; prints each."""
    missed = {name: abs(values[name] - value) > within for name, (value, within) in problem.options.get("expect", {}).items()}
    for name, (value, within) in problem.options.get("expect", {}).items():
        print(f"expect {name} {values[name]:.5g}, {value:g} within {within:.3g}: {'FAILED' if missed[name] else 'ok'}")
    return not any(missed.values())


def against_data(fit, curves):
    """Rows of the residuals of what was fitted, and of the predictions of what was left out, in the units of FILE."""
    residuals, predictions = [], []
    deviations = 2 * NormalDist().inv_cdf(0.5 + fit.problem.options["interval"] / 2)  # of the interval: 3.29 at 90 %
    for m, *of_model in curves:
        if m.values is None:
            continue
        places = [""] if m.x is None else m.x_in_file.tolist()
        for x, value, low, middle, high in zip(places, *(m.in_file(values).tolist() for values in (m.values, *of_model))):
            row = [m.title, x, m.x_shown, value, middle, low, high, m.shown]
            if m.use == "fit":
                residuals.append([*row, value - middle, (value - middle) * deviations / max(high - low, 1e-300)])
            else:
                predictions.append([*row, "yes" if low <= value <= high else "no"])
    return residuals, predictions


def said(fit, further, predictions):
    """Sentences: what the data say, and what they do not."""
    parameters, states = fit.problem.parameters, fit.determined()
    notes = [f"{fit.runs.counted()}; {fit.stopped}."]
    if np.isfinite(fit.p):
        notes.append(f"Misfit: probability {fit.p:.2g} if the model were true." + (
            "" if not fit.contradicted else " THE MODEL CANNOT MEET THESE DATA with any of its parameters, or their scatter and noise are larger than stated; "
            "none of its parameters counts as determined."))
    else:
        notes.append("There are no more numbers than parameters: whether the model can meet the data cannot be judged, and no model error is found. "
                     "See the residuals.")
    notes += [f"{m.title}: nothing tells its scatter, since too few runs differ by their seed alone: THE INTERVALS DO NOT HOLD THE SCATTER OF MESHES, and no parameter counts "
              "as determined. Give `scatter`, `seeds = 2`, or more runs." for m in fit.unknown_scatter()]
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
    for title, narrowed in further:
        most = ", ".join(f"{p.name} by {100 * part:.0f} %" for p, part in zip(parameters, narrowed) if part >= 0.01)
        notes.append(f"{title} would narrow the intervals: {most}." if most else f"{title} would narrow no interval.")
    notes += [f"{m.title}: too few runs have a value to say what it would tell." for m in fit.problem.measured if m.title not in fit.emulators]
    for u, p in zip(fit.posterior.u.T, parameters):
        if np.mean(u < 0.03) > 0.15 or np.mean(u > 0.97) > 0.15:
            notes.append(f"{p.name} leans on a bound, {p.low:g} to {p.high:g} {p.unit}: widen it if the bound is no knowledge.")
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
    values = problem.values(u)
    table(runs.directory / "parameters.csv", ["parameter", "unit", "best"], [[p.name, p.unit, float(v)] for p, v in zip(problem.parameters, values)])
    for p, x in zip(problem.parameters, u):
        print(f"{p.name} = {p.text(x)}")
    print(f"{runs.counted()}; root of the sum of squares {np.sqrt((residuals**2).sum()):.3g} deviations\nfit:     {runs.directory}")
    return meets(problem, {p.name: float(value) for p, value in zip(problem.parameters, values)})


def _page(file, name, notes, tables, pictures):
    """The notes, the first table, the pictures, the other tables."""
    blocks = [f"<h2>{html.escape(title)}</h2>\n{knap.html_table(head, rows)}\n" for title, head, rows in tables if rows]
    blocks[1:1] = [f"<h2>{title}</h2>\n<img src=\"{picture}\" alt=\"{html.escape(title)}\">\n" for title, picture in pictures]
    body = "".join(f"<p>{html.escape(note)}</p>\n" for note in notes) + "".join(blocks)
    page = (pathlib.Path(__file__).parent / "page.html").read_text(encoding="utf-8")
    file.write_text(page.replace("NAME", html.escape(name)).replace("BODY", body), encoding="utf-8")


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
    return title, name


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


def draw(fit, curves):
    """(title, file) of the pictures."""
    out, parameters, level = fit.runs.directory, fit.problem.parameters, 100 * fit.problem.options["interval"]
    figure = figure_of(2.2 * len(parameters) + 1, 2.2 * len(parameters) + 1)
    if figure is None:
        return []
    pictures = [save(corner(figure, fit), out, "Posterior", "corner.png")]
    figure = figure_of(7, 3.2 * len(curves))
    axes = figure.subplots(len(curves), squeeze=False)
    for axis, (m, *of_model) in zip(axes[:, 0], curves):
        x, number = (np.arange(2), 2) if m.x is None else (m.x_in_file, 1)  # a number is a line from 0 to 1
        low, middle, high = (np.tile(m.in_file(values), number) for values in of_model)
        axis.plot(x, np.tile(m.in_file(fit.runs.of(m)).reshape(-1, m.size), number).T, color="#cccccc", lw=0.5)
        axis.fill_between(x, low, high, color="#4477aa", alpha=0.4, label=f"model, {level:g} %")
        axis.plot(x, middle, color="#4477aa")
        if m.values is not None:
            axis.plot(x, np.tile(m.in_file(m.values), number), "o-" if number == 1 else "-", color="#cc3311", label="measured")
        axis.set(ylabel=label(m.name, m.shown), xlabel=label(m.columns[0][1], m.x_shown) if number == 1 else "", **({"xticks": []} if number == 2 else {}))
        axis.set_title(m.title, fontsize="medium")
        axis.legend(fontsize="small")
    pictures.append(save(figure, out, "Measured and model", "curves.png"))
    figure, (runs, _, widths) = figure_of(7, 3.2), zip(*fit.history)
    axis = figure.subplots()
    axis.plot(runs, widths, "o-", label=[p.name for p in parameters])
    axis.set(xlabel="runs", ylabel="width over that of the bounds", ylim=0)
    axis.legend()
    return [*pictures, save(figure, out, "Convergence of the intervals", "convergence.png")]
