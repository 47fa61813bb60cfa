"""Maps of fractures: densities, lengths, orientations and connectivity of what was mapped, meshed or cracked.

    import knap_traces as traces
    drawn  = traces.read("faults.csv")                        # or .geojson, .dxf, .shp, .gpkg; .msh of `knap mesh`; a run
    meshed = traces.read("faults.msh")
    cracks = traces.read("runs/tunnel", time=0.02)            # broken interfaces, joined to lines
    window = [[0, 0], [50, 0], [50, 30], [0, 30]]             # m; default: the box of the traces
    numbers = traces.statistics(drawn, window)                # numbers["P21"], numbers.units["P21"]
    traces.p10(drawn, (0, 15), (50, 15))                      # crossings per metre of a scan line
    traces.rose(drawn, bins=18)                               # ends of the classes [deg], length in each [m]
    traces.write("faults.csv", drawn)                         # as [[traces]] reads it

The command `knap-traces FILE...` prints the numbers side by side. A trace is `(points, name, class)`, points in m.
csv, GeoJSON, .msh and runs need numpy alone; .dxf needs ezdxf, shapefiles and GeoPackages GDAL (Debian: python3-ezdxf,
python3-gdal).
"""
import argparse
import csv
import json
import pathlib
import sys
from typing import NamedTuple

import knap
import numpy as np

TOUCH = 1e-6  # of the extent of a map: points nearer than this are one


class Trace(NamedTuple):
    points: np.ndarray  # [m] one row each
    name: str = ""
    kind: str = ""


# ---- files

def read(file, unit=1.0, property="class", time=np.inf):
    """Traces of a file, or the cracks of a run at a time. `unit` [m]: of coordinates that have none in the file."""
    file = pathlib.Path(file)
    kind = file.suffix.lower()
    if file.is_dir():
        return _of_run(knap.read(file), time)
    if kind == ".csv":
        return _of_csv(file, unit, property)
    if kind == ".msh":
        return _of_mesh(file)
    if kind == ".dxf":
        return _of_dxf(file, unit)
    if kind in (".json", ".geojson"):
        return _of_geojson(json.loads(file.read_text()), unit, property)
    return _of_gdal(file, unit, property)


def write(file, traces):
    """A csv file for [[traces]]."""
    with open(file, "w", newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["trace", "x [m]", "y [m]", "class"])
        for number, trace in enumerate(traces, 1):
            for x, y in trace.points:
                rows.writerow([trace.name or number, repr(float(x)), repr(float(y)), trace.kind])


def _of_csv(file, unit, property):
    with open(file, newline="") as lines:
        rows = [row for row in csv.reader(line.split("#")[0] for line in lines) if any(cell.strip() for cell in row)]
    names = [cell.split("[")[0].strip() for cell in rows[0]]
    units = dict(zip(names, (cell.split("[")[1].rstrip("] ") if "[" in cell else "" for cell in rows[0])))
    metres = {"": unit, "m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3}
    if not {"trace", "x", "y"} <= set(names) or units["x"] not in metres or units["y"] not in metres:
        raise knap.KnapError(f"{file}: the first line is not `trace, x [m], y [m], class`")
    at = {name: names.index(name) for name in names}
    found = []
    for row in rows[1:]:
        name, point = row[at["trace"]].strip(), (float(row[at["x"]]) * metres[units["x"]], float(row[at["y"]]) * metres[units["y"]])
        if not found or found[-1][1] != name:
            found.append(([], name, row[at[property]].strip() if property in at else ""))
        found[-1][0].append(point)
    return [Trace(np.array(points), name, kind) for points, name, kind in found]


def _of_geojson(root, unit, property):
    found = []
    for number, feature in enumerate(root.get("features", [root])):
        geometry = feature.get("geometry", feature)
        if geometry is None:
            continue
        parts = {"LineString": lambda g: [g], "MultiLineString": lambda g: g}.get(geometry["type"], lambda g: [])(geometry["coordinates"])
        for part in parts:
            found.append(Trace(unit * np.array([point[:2] for point in part], float), f"{number + 1}",
                               str((feature.get("properties") or {}).get(property, ""))))
    return found


def _of_dxf(file, unit):
    try:
        import ezdxf
    except ImportError:
        raise knap.KnapError(f"{file}: a .dxf file needs ezdxf (Debian: python3-ezdxf)") from None
    found = []
    for entity in ezdxf.readfile(file).modelspace():  # the class is the layer
        if entity.dxftype() == "LINE":
            points = [tuple(entity.dxf.start)[:2], tuple(entity.dxf.end)[:2]]
        elif entity.dxftype() == "LWPOLYLINE":
            points = [p[:2] for p in entity.get_points()]
        elif entity.dxftype() == "POLYLINE":
            points = [tuple(p)[:2] for p in entity.points()]
        else:
            continue
        found.append(Trace(unit * np.array(points, float), str(len(found) + 1), entity.dxf.layer))
    return found


def _of_gdal(file, unit, property):
    try:
        from osgeo import ogr
    except ImportError:
        raise knap.KnapError(f"{file}: this format needs GDAL (Debian: python3-gdal)") from None
    source = ogr.Open(str(file))
    if source is None:
        raise knap.KnapError(f"{file}: GDAL cannot read it")
    features = []
    for layer in (source.GetLayer(i) for i in range(source.GetLayerCount())):
        system = layer.GetSpatialRef()
        if system is not None and system.IsGeographic():
            raise knap.KnapError(f"{file}: its coordinates are longitudes and latitudes; project them to metres first")
        for feature in layer:
            features.append(json.loads(feature.ExportToJson()))
    return _of_geojson({"features": features}, unit, property)


def _of_mesh(file):
    """Lines of the groups `crack` and `joint0`, ... of a mesh that `knap mesh` wrote."""
    sections = {part.split("\n", 1)[0]: part.split("\n")[1:] for part in file.read_text().split("$")}
    names = {int(row.split()[1]): row.split('"')[1] for row in sections["PhysicalNames"][1:] if row.startswith("1 ")}
    nodes = np.array([[float(cell) for cell in row.split()[1:3]] for row in sections["Nodes"][1:] if row])
    edges = {}
    for row in sections["Elements"][1:]:
        cells = [int(cell) for cell in row.split()]
        if len(cells) == 7 and cells[1] == 1 and names.get(cells[3], "").startswith(("crack", "joint")):
            edges.setdefault(names[cells[3]], []).append([cells[5] - 1, cells[6] - 1])
    return [Trace(nodes[line], "", kind) for kind, pairs in edges.items() for line in _chains(pairs)]


def _of_run(run, time):
    """Interfaces that are broken, or cracked from the start, at a time."""
    grid = run.frame(time).interfaces
    if not grid.cells.size:
        return []
    places, number = np.unique(np.round(grid.points / (TOUCH * np.ptp(grid.points, axis=0).max())).astype(int), axis=0, return_inverse=True)
    points = np.zeros((len(places), 2))
    points[number] = grid.points[:, :2]
    found = []
    for status, kind in ((3, "cracked from the start"), (2, "broken")):
        cells = grid.cells[(grid["status"][grid.cells] == status).all(axis=1)]
        found += [Trace(points[line], "", kind) for line in _chains(number[cells].tolist())]
    return found


def _chains(pairs):
    """Edges joined to polylines that end where three or more meet, or at a tip."""
    at = {}
    for a, b in pairs:
        at.setdefault(a, []).append(b)
        at.setdefault(b, []).append(a)
    used, lines = set(), []

    def walk(a, b):
        line = [a, b]
        used.add(frozenset((a, b)))
        while len(at[line[-1]]) == 2:
            onward = [c for c in at[line[-1]] if frozenset((line[-1], c)) not in used]
            if not onward:
                break
            used.add(frozenset((line[-1], onward[0])))
            line.append(onward[0])
        lines.append(line)

    for starts in ([n for n in at if len(at[n]) != 2], list(at)):  # then closed rings
        for a in starts:
            for b in at[a]:
                if frozenset((a, b)) not in used:
                    walk(a, b)
    return lines


# ---- numbers

def _segments(traces):
    """Ends of all segments [m], and the trace of each."""
    parts = [np.stack([t.points[:-1], t.points[1:]], axis=1) for t in traces]
    return np.concatenate(parts) if parts else np.zeros((0, 2, 2)), np.repeat(np.arange(len(traces)), [len(p) for p in parts])


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _meetings(one, other, touch):
    """Pairs of segments of two lists that meet, and their positions s, t in [0, 1] along both, with some room `touch` [m]."""
    found = []
    low, high = other.min(axis=1) - touch, other.max(axis=1) + touch
    for i, (a, b) in enumerate(one):
        near = np.flatnonzero(((low <= np.maximum(a, b)) & (high >= np.minimum(a, b))).all(axis=1))
        u, v, w = b - a, other[near, 1] - other[near, 0], other[near, 0] - a
        across = _cross(u, v)
        lu, lv = np.hypot(*u), np.hypot(*v.T)
        with np.errstate(divide="ignore", invalid="ignore"):
            s, t = _cross(w, v) / across, _cross(w, u) / across
        rs, rt = touch / max(lu, 1e-300), touch / np.maximum(lv, 1e-300)
        meet = (np.abs(across) > 1e-9 * lu * lv) & (s >= -rs) & (s <= 1 + rs) & (t >= -rt) & (t <= 1 + rt)
        found += [(i, j, min(max(x, 0), 1), min(max(y, 0), 1)) for j, x, y in zip(near[meet], s[meet], t[meet])]
    return found


def _inside(points, window):
    """Even-odd rule."""
    a, b = window, np.roll(window, -1, axis=0)
    x, y = points[:, :1], points[:, 1:2]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return (((a[:, 1] > y) != (b[:, 1] > y)) & (x < crossing)).sum(axis=1) % 2 == 1


def clipped(traces, window):
    """What lies in a polygon; a trace that leaves it and returns becomes several."""
    window = np.asarray(window, float)
    border = np.stack([window, np.roll(window, -1, axis=0)], axis=1)
    found = []
    for trace in traces:
        ends = np.stack([trace.points[:-1], trace.points[1:]], axis=1)
        cuts = {}
        for i, _, s, _ in _meetings(ends, border, 0):
            cuts.setdefault(i, set()).add(s)
        line = []
        for i, (a, b) in enumerate(ends):
            places = [0.0, *sorted(cuts.get(i, set()) - {0.0, 1.0}), 1.0]
            for p, q in zip(places, places[1:]):
                if _inside((a + 0.5 * (p + q) * (b - a))[None], window)[0]:
                    line = line or [a + p * (b - a)]
                    line.append(a + q * (b - a))
                elif line:
                    found.append(trace._replace(points=np.array(line)))
                    line = []
        if line:
            found.append(trace._replace(points=np.array(line)))
    return found


def length(trace):
    """[m]"""
    return np.hypot(*np.diff(trace.points, axis=0).T).sum()


def p10(traces, start, end):
    """[1/m] Crossings of a scan line over its length."""
    scan = np.array([[start, end]], float)
    segments, owner = _segments(traces)
    met = {(owner[j], round(s, 9)) for _, j, s, _ in _meetings(scan, segments, 0)}  # a bend on the line counts once
    return len(met) / np.hypot(*(scan[0, 1] - scan[0, 0]))


def rose(traces, bins=18):
    """Ends of equal classes of the angle to x, 0 to 180 [deg], and the length of the traces in each [m]."""
    segments, _ = _segments(traces)
    d = segments[:, 1] - segments[:, 0]
    length_in, ends = np.histogram(np.degrees(np.arctan2(d[:, 1], d[:, 0])) % 180, bins, (0, 180), weights=np.hypot(*d.T))
    return ends, length_in


def nodes(traces, window, touch):
    """Numbers of isolated tips (I), of ends on another trace (Y), of crossings (X), and of ends on the border of the
    window (E), after D. J. Sanderson, C. W. Nixon, J. Struct. Geol. 72 (2015) 55."""
    segments, owner = _segments(traces)
    border = np.stack([window, np.roll(window, -1, axis=0)], axis=1)
    ends = np.array([p for t in traces for p in (t.points[0], t.points[-1])])
    on_border = np.zeros(len(ends), bool)
    for a, b in border:
        on_border |= _distance(ends, a, b) <= touch
    places = [segments[i, 0] + s * (segments[i, 1] - segments[i, 0])
              for i, j, s, _ in _meetings(segments, segments, touch) if owner[i] < owner[j]]
    tips = ends[~on_border]
    points = np.concatenate([tips, np.reshape(places, (-1, 2))])
    # arms: how many traces end or pass at each place
    counts = {"I": 0, "Y": 0, "X": 0, "E": int(on_border.sum())}
    for place in _unique(points, touch):
        n_ends = int((np.hypot(*(ends - place).T) <= touch).sum())
        passing = {owner[k] for k in np.flatnonzero(_distance_to_all(place, segments) <= touch)}
        n_passing = len(passing) - len({k // 2 for k in np.flatnonzero(np.hypot(*(ends - place).T) <= touch)})
        arms = n_ends + 2 * n_passing
        if arms != 2:  # where two ends meet a trace goes on
            counts["I" if arms == 1 else "Y" if arms == 3 else "X"] += 1
    return counts


def _distance(points, a, b):
    d = b - a
    s = np.clip(((points - a) @ d) / max(d @ d, 1e-300), 0, 1)
    return np.hypot(*(points - a - s[:, None] * d).T)


def _distance_to_all(point, segments):
    d = segments[:, 1] - segments[:, 0]
    s = np.clip(((point - segments[:, 0]) * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-300), 0, 1)
    return np.hypot(*(point - segments[:, 0] - s[:, None] * d).T)


def _unique(points, touch):
    cells = {}
    for p in points:
        key = tuple(np.round(p / (2 * touch)).astype(int))
        near = [q for i in (-1, 0, 1) for j in (-1, 0, 1) for q in cells.get((key[0] + i, key[1] + j), [])]
        if all(np.hypot(*(p - q)) > touch for q in near):
            cells.setdefault(key, []).append(p)
    return [p for cell in cells.values() for p in cell]


def statistics(traces, window=None, touch=None):
    """P20 (traces per area), P21 (length per area), lengths and connectivity in a window, a knap.Table with units. A
    trace whose end lies on the border counts half in P20 (M. Mauldon, W. M. Dunne, M. B. Rohrbaugh, J. Struct. Geol. 23
    (2001) 247: half of the ends inside over the area). C_B, C_L: connections per branch and per line."""
    everything = np.concatenate([t.points for t in traces])
    low, high = everything.min(axis=0), everything.max(axis=0)
    if window is None:
        window = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    window = np.asarray(window, float)
    touch = touch or TOUCH * np.ptp(window, axis=0).max()
    area = 0.5 * abs(_cross(window, np.roll(window, -1, axis=0)).sum())
    inside = clipped(traces, window)
    lengths = np.array([length(t) for t in inside])
    n = nodes(inside, window, touch) if inside else dict.fromkeys("IYXE", 0)
    n_lines, n_branches = (n["I"] + n["Y"]) / 2, (n["I"] + 3 * n["Y"] + 4 * n["X"]) / 2
    table = knap.Table()
    for name, value, unit in (
            ("traces", len(inside), ""), ("area", area, "m2"), ("P20", (2 * len(inside) - n["E"]) / 2 / area, "1/m2"),
            ("P21", lengths.sum() / area, "m/m2"), ("mean_length", lengths.mean() if inside else np.nan, "m"),
            ("median_length", np.median(lengths) if inside else np.nan, "m"), ("longest", lengths.max() if inside else np.nan, "m"),
            ("I", n["I"], ""), ("Y", n["Y"], ""), ("X", n["X"], ""), ("E", n["E"], ""),
            ("C_L", 2 * (n["Y"] + n["X"]) / n_lines if n_lines else np.nan, ""),
            ("C_B", (3 * n["Y"] + 4 * n["X"]) / n_branches if n_branches else np.nan, "")):
        table[name], table.units[name] = value, unit
    return table


def command():
    """knap-traces"""
    parser = argparse.ArgumentParser(prog="knap-traces", description="Statistics of maps of traces, of meshes and of the cracks of runs, side by side.")
    parser.add_argument("source", nargs="+", help=".csv, .geojson, .dxf, .shp, .gpkg; .msh of `knap mesh`; a run")
    parser.add_argument("--window", type=float, nargs=4, metavar=("X0", "Y0", "X1", "Y1"), help="in m; default: the box of the first source")
    parser.add_argument("--scanline", type=float, nargs=4, metavar=("X0", "Y0", "X1", "Y1"), help="P10 along it")
    parser.add_argument("--unit", type=float, default=1.0, help="of coordinates without one, in m")
    parser.add_argument("--property", default="class", help="column or property that gives the class")
    parser.add_argument("--touch", type=float, help="in m: ends that are nearer than this to a trace meet it")
    parser.add_argument("-o", "--output", help="write the traces of the first source as a csv file for [[traces]]")
    options = parser.parse_args()
    try:
        maps = [read(source, options.unit, options.property) for source in options.source]
        if not all(maps):
            raise knap.KnapError(f"{options.source[[bool(m) for m in maps].index(False)]}: there are no traces")
        if options.output:
            write(options.output, maps[0])
        if options.window:
            x0, y0, x1, y1 = options.window
        else:
            points = np.concatenate([t.points for t in maps[0]])
            (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
        window = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
        columns = [statistics(m, window, options.touch) for m in maps]
        if options.scanline:
            for m, column in zip(maps, columns):
                column["P10"], column.units["P10"] = p10(m, options.scanline[:2], options.scanline[2:]), "1/m"
    except (knap.KnapError, OSError, ValueError) as error:
        sys.exit(f"knap-traces: {error}")
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["number", *options.source])
    for name in columns[0]:
        unit = columns[0].units[name]
        rows.writerow([f"{name} [{unit}]" if unit else name, *(f"{column[name]:.6g}" for column in columns)])


if __name__ == "__main__":
    command()
