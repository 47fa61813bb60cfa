"""Events of a run, as acoustic emission and seismology count them: breaks that follow each other closely are one event.

    import knap, knap_events as events
    run = knap.read("runs/uniaxial_compression")               # with output.breaks = true
    found = events.join(run)                                   # a knap.Table: found["time"], ["x"], ["moment"], ...
    b, error, completeness = events.b_value(found["magnitude"])
    strain, rate = events.rate(run, found, over="stress_strain.axial_strain", bins=20)
    events.plot(run, found, "events.png", over="stress_strain.axial_strain")

`knap-events RUN --over stress_strain.axial_strain -o events.csv --rate rate.csv --figure events.png` writes all of it. Needs numpy; the
figure matplotlib (Debian: python3-matplotlib).

Columns of events: time [s] of the first break, duration [s], x, y [m] (mean by energy), breaks, length [m], energy [J] (fracture energy),
shear (part of the energy of breaks that slid more than they opened), moment [N m], isotropic, magnitude, with --over the load at that time.
Of rates: the middle of each class of the load, events, their number over the width of the class, energy [J].

Moment tensor of a break with the jump u and the area A, normal n (K. Aki, P. G. Richards, Quantitative Seismology, 2002,
eq. 3.21), for a plane strain, with Lame's constants of the material, between two materials their means (a run of several ones needs a frame):

    M = A (lambda (u . n) I + mu (u n^T + n u^T)),     M_0 = sqrt(M : M / 2),     magnitude = 2/3 (log10(M_0) - 9.1)

of an event the sum of the tensors of its breaks; isotropic = |tr M|/3 over the largest eigenvalue, between 0 (slip) and 1. The jumps are
those of the moment at which interfaces broke: later slip does not count.
"""
import argparse
import csv

import knap
import numpy as np


def join(run, distance=None, within=None):
    """Events of a run. Breaks nearer than `distance` [m] (default: 2.5 median lengths of an interface) and within this time [s] (default: the
    time of a shear wave over the distance) belong to one event, and so does what belongs to them."""
    if "breaks" not in run.tables:
        raise knap.KnapError(f"{run.directory} has no breaks.csv: run it with output.breaks = true")
    breaks = run.table("breaks")
    if "slip" not in breaks:
        raise knap.KnapError(f"{run.directory}/breaks.csv has no column slip: it was written by knap 0.2.0 or older")
    keys = knap.settings(run.directory / "resolved.toml")
    E, nu, density = (np.array([float(keys[f"material.{material}.{name}"]) for material in run.info["materials"]]) for name in ("E", "nu", "density"))
    thickness = float(keys.get("domain.thickness", 1))
    shear_moduli, lame_moduli = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    names = {"time": "s", "duration": "s", "x": "m", "y": "m", "breaks": "", "length": "m", "energy": "J", "shear": "", "moment": "N m",
             "isotropic": "", "magnitude": ""}
    rows = []
    if len(breaks["time"]):
        distance = distance or 2.5 * np.median(breaks["length"])
        within = within or distance / np.sqrt(shear_moduli / density).max()
        sides = _materials(run, breaks) if len(E) > 1 else np.zeros((len(breaks["time"]), 2), int)
        mu, lame = shear_moduli[sides].mean(axis=1), lame_moduli[sides].mean(axis=1)
        event = _joined(breaks["time"], breaks["x"], breaks["y"], distance, within)
        angle = np.radians(breaks["angle"])
        n, t = np.stack([-np.sin(angle), np.cos(angle)], 1), np.stack([np.cos(angle), np.sin(angle)], 1)  # the left side: +n
        u = breaks["opening"][:, None] * n + breaks["slip"][:, None] * t
        area = breaks["length"] * thickness
        M = np.zeros((len(area), 3, 3))
        M[:, :2, :2] = mu[:, None, None] * (u[:, :, None] * n[:, None, :] + n[:, :, None] * u[:, None, :])
        M += (lame * breaks["opening"])[:, None, None] * np.eye(3)
        M *= area[:, None, None]
        for e in range(event.max() + 1):
            own = event == e
            time, energy, tensor = breaks["time"][own], breaks["energy"][own], M[own].sum(axis=0)
            weight = energy / energy.sum() if energy.sum() > 0 else np.full(len(energy), 1 / len(energy))
            moment = np.sqrt((tensor * tensor).sum() / 2)
            largest = np.abs(np.linalg.eigvalsh(tensor)).max()
            rows.append([time.min(), np.ptp(time), weight @ breaks["x"][own], weight @ breaks["y"][own], own.sum(), breaks["length"][own].sum(),
                         energy.sum(), weight @ (breaks["shear"][own] > 0.5), moment, abs(np.trace(tensor)) / 3 / largest if largest > 0 else 0,
                         2 / 3 * (np.log10(moment) - 9.1) if moment > 0 else -np.inf])
    rows.sort(key=lambda row: row[0])
    return knap.Table(zip(names, np.array(rows, float).reshape(-1, len(names)).T), names)


def _materials(run, breaks):
    """Numbers of the materials on both sides of each break: of the triangles whose sides have its middle, in a frame from before or after it."""
    if len(run.frame_times) == 0:
        raise knap.KnapError(f"{run.directory} has several materials and no frames, which tell what lies beside a break: run it with output.fields = true")
    place = np.stack([breaks["x"], breaks["y"]], 1)
    found = np.full((len(place), 2), -1)
    for time in (0, np.inf):  # a mesh that follows the cracks has other triangles at the end
        bulk = run.frame(time).bulk
        corners = bulk.points[bulk.cells[:, :3]]
        middles = 0.5 * (corners + np.roll(corners, -1, axis=1)).reshape(-1, 2)
        order = np.argsort(middles[:, 0])
        x, material = middles[order, 0], np.repeat(bulk["region"], 3)[order]
        y = middles[order, 1]
        for i in np.flatnonzero(found[:, 0] < 0):
            near = 1e-3 * breaks["length"][i]
            first, end = np.searchsorted(x, [place[i, 0] - near, place[i, 0] + near])
            here = material[first:end][np.abs(y[first:end] - place[i, 1]) <= near]
            if len(here):
                found[i] = here[0], here[-1]
    if (found < 0).any():
        raise knap.KnapError(f"{(found[:, 0] < 0).sum()} breaks of {run.directory} lie between no triangles of its frames: give output.every a smaller value")
    return found


def _joined(time, x, y, distance, within):
    """Number of the event of each break, by the time of its first one."""
    root = np.arange(len(time))

    def top(i):
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    order = np.argsort(time, kind="stable")
    first = 0
    for k, i in enumerate(order):
        while time[order[first]] < time[i] - within:
            first += 1
        before = order[first:k]
        for j in before[np.hypot(x[before] - x[i], y[before] - y[i]) <= distance]:
            a, b = top(i), top(j)
            root[max(a, b)] = min(a, b)
    tops = np.array([top(i) for i in range(len(time))])
    firsts = {t: time[tops == t].min() for t in set(tops)}
    number = {t: k for k, t in enumerate(sorted(firsts, key=lambda t: (firsts[t], t)))}
    return np.array([number[t] for t in tops])


def b_value(magnitudes, completeness=None, width=None):
    """b of log10 N = a - b M by maximum likelihood, its standard error, and the magnitude from which the list is complete (default: that of the
    fullest class of 0.1). `width`: of the classes to which magnitudes were rounded (default: 1, 0.1 or 0.01 if all are multiples of it, else 0);
    half of it goes off the completeness (T. Utsu, Geophys. Bull. Hokkaido Univ. 13 (1965) 99). K. Aki, Bull. Earthq. Res. Inst. 43 (1965) 237;
    Y. Shi, B. A. Bolt, Bull. Seismol. Soc. Am. 72 (1982) 1677. nan with fewer than ten events."""
    m = np.asarray(magnitudes, float)
    m = m[np.isfinite(m)]
    if width is None:
        width = next((w for w in (1, 0.1, 0.01) if len(m) and np.abs(m / w - np.round(m / w)).max() < 1e-6), 0.0)
    if completeness is None and len(m):
        step = max(width, 0.1)
        ends = step * np.arange(np.floor(m.min() / step), m.max() / step + 2) - width / 2  # rounded ones lie in the middle of their class
        number, _ = np.histogram(m, bins=ends)
        completeness = ends[number.argmax()] + width / 2
    m = m[m >= completeness - width / 2] if len(m) else m
    if len(m) < 10 or np.ptp(m) == 0:
        return np.nan, np.nan, completeness
    b = np.log10(np.e) / (m.mean() - (completeness - width / 2))
    return b, np.log(10) * b**2 * np.sqrt(((m - m.mean()) ** 2).sum() / (len(m) * (len(m) - 1))), completeness


def load(run, over, time):
    """A load "TABLE.COLUMN" at these times, and its unit; or "time" itself."""
    if over == "time":
        return np.asarray(time), "s"
    name, _, column = over.partition(".")
    if name not in run.tables or column not in run.table(name) or "time" not in run.table(name):
        raise knap.KnapError(f"{run.directory} has no `{over}`: it is `time` or TABLE.COLUMN, a column of a table over time, as reactions.load0_u_y")
    table = run.table(name)
    return np.interp(time, table["time"], table[column]), table.units.get(column, "")


def rate(run, found, over="time", bins=20):
    """Middles of classes of a load, "TABLE.COLUMN" or "time", and the events in each over its width: events per unit of the load."""
    rates = rates_of(run, found, over, bins)
    return rates[over.partition(".")[2] or over], rates["rate"]


def rates_of(run, found, over="time", bins=20):
    """A knap.Table with a line for each class of the load: its middle, `events`, `rate` (events per unit of the load) and `energy` [J]."""
    at, unit = load(run, over, found["time"])
    number, ends = np.histogram(at, bins)
    energy, _ = np.histogram(at, ends, weights=found["energy"])
    name = over.partition(".")[2] or over
    return knap.Table({name: 0.5 * (ends[1:] + ends[:-1]), "events": number, "rate": number / np.diff(ends), "energy": energy},
                      {name: unit, "rate": f"1/{unit}" if unit else "", "energy": "J"})


def plot(run, found, file, over=None):
    """Magnitudes over time, and how many events reach each magnitude, with b; with `over` the rate of events over this load, too."""
    try:
        import matplotlib
    except ImportError:
        raise knap.KnapError("the figure needs matplotlib (Debian: python3-matplotlib)") from None
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    if not len(found["time"]):
        raise knap.KnapError(f"{run.directory} has no breaks to draw")
    figure, axes = plt.subplots(1, 3 if over else 2, figsize=(13 if over else 9, 3.6), constrained_layout=True)
    left, right = axes[:2]
    m = np.sort(found["magnitude"][np.isfinite(found["magnitude"])])
    size = 4 + 40 * found["length"] / max(found["length"].max(), 1e-300)
    mode = left.scatter(1e3 * found["time"], found["magnitude"], s=size, c=found["shear"], cmap="cividis", vmin=0, vmax=1)
    figure.colorbar(mode, ax=left, label="part of shear")
    left.set(xlabel="time [ms]", ylabel="moment magnitude", title=run.info["title"] or run.info["name"])
    right.semilogy(m, np.arange(len(m), 0, -1), ".", color="black")
    b, error, completeness = b_value(m)
    if np.isfinite(b):
        line = np.array([completeness, m.max()])
        right.semilogy(line, (m >= completeness).sum() * 10 ** (-b * (line - completeness)), color="crimson", label=f"b = {b:.2f} ± {error:.2f}")
        right.legend(frameon=False)
    right.set(xlabel="moment magnitude", ylabel="events of this magnitude or more", title=f"{len(found['time'])} events")
    if over:
        rates = rates_of(run, found, over)
        name, title = next(zip(rates, rates.titles))
        width = np.diff(rates[name])[:1] if len(rates[name]) > 1 else 1
        axes[2].bar(rates[name], rates["rate"], width=width, color="tab:gray")
        axes[2].set(xlabel=title.replace("_", " "), ylabel=f"events per {rates.units[name] or 'unit of it'}", title="rate of events")
    figure.savefig(file, dpi=150)
    plt.close(figure)


def command():
    """knap-events"""
    parser = argparse.ArgumentParser(prog="knap-events", description="Events of a run: breaks of interfaces that follow each other closely, with moment and magnitude.")
    parser.add_argument("run", help="run directory, of a scenario with output.breaks = true")
    parser.add_argument("--distance", type=float, help="in m: breaks nearer than this may be one event; default 2.5 median lengths of an interface")
    parser.add_argument("--within", type=float, help="in s; default: a shear wave over the distance")
    parser.add_argument("--over", help="a load, TABLE.COLUMN as stress_strain.axial_strain or reactions.top_force_y: its value at each event, and "
                        "the rate of events over it; default time")
    parser.add_argument("--bins", type=int, default=20, help="classes of the load; default 20")
    parser.add_argument("-o", "--output", help="csv file of the events")
    parser.add_argument("--rate", help="csv file of the rate of events over the load")
    parser.add_argument("--figure", help="picture: magnitudes over time, their frequency, and with --over the rate over the load")
    options = parser.parse_args()
    knap.command_line("knap-events", lambda: _write(options))


def _write(options):
    run = knap.read(options.run)
    found = join(run, options.distance, options.within)
    if options.over:
        found[options.over], found.units[options.over] = load(run, options.over, found["time"])
    for file, table in ((options.output, found), (options.rate, options.rate and rates_of(run, found, options.over or "time", options.bins))):
        if file:
            with open(file, "w", newline="") as out:
                rows = csv.writer(out, lineterminator="\n")
                rows.writerow(table.titles)
                rows.writerows([f"{value:.9g}" for value in row] for row in zip(*table.values()))
    if options.figure:
        plot(run, found, options.figure, options.over)
    b, error, completeness = b_value(found["magnitude"])
    print(f"{len(found['time'])} events of {int(found['breaks'].sum())} breaks" +
          (f"; b = {b:.2f} +- {error:.2f} from magnitude {completeness:.1f} on" if np.isfinite(b) else "; too few for b"))


if __name__ == "__main__":
    command()
