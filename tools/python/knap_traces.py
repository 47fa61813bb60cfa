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

Curves of a DXF become polylines; what is no line is left out, and counted on stderr.

The command `knap-traces FILE...` prints the numbers side by side. A trace is `(points, name, class)`, points in m.
csv, GeoJSON, .msh and runs need numpy alone; .dxf needs ezdxf, shapefiles and GeoPackages GDAL (Debian: python3-ezdxf,
python3-gdal).
"""
import argparse
import collections
import csv
import json
import pathlib
import re
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

def read(file, unit=None, property="class", time=np.inf):
    """Traces of a file, or the cracks of a run at a time. `unit`: of coordinates that have none in the file, in m or as "1 km"; without it
    that of a DXF is its $INSUNITS, and 1 m else."""
    file = pathlib.Path(file)
    kind = file.suffix.lower()
    unit = metres(unit) if isinstance(unit, str) else unit
    if file.is_dir():
        return _of_run(knap.read(file), time)
    if kind == ".csv":
        return _of_csv(file, unit or 1.0, property)
    if kind == ".msh":
        return _of_mesh(file)
    if kind == ".dxf":
        return _of_dxf(file, unit)
    if kind in (".json", ".geojson"):
        try:
            root = json.loads(file.read_text(encoding="utf-8-sig"))
        except ValueError as error:
            raise knap.KnapError(f"{file}: this is no JSON: {error}") from None
        return _of_geojson(file, root, unit or 1.0, property)
    return _of_gdal(file, unit or 1.0, property)


def write(file, traces):
    """A csv file for [[traces]]. Traces have their names where these tell them apart, as parts of a trace that a window cut do not; else numbers."""
    names = [trace.name for trace in traces]
    if not all(names) or len(set(names)) < len(names):
        names = range(1, len(traces) + 1)
    with open(file, "w", newline="", encoding="utf-8") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["trace", "x [m]", "y [m]", "class"])
        for name, trace in zip(names, traces):
            for x, y in trace.points:  # the cells of this format have no quotes
                rows.writerow([name, repr(float(x)), repr(float(y)), re.sub(r'[,;\t#"\r\n]+', " ", trace.kind)])


LENGTHS = {"m": 1.0, "nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "km": 1e3}


def metres(text):
    """Of a length as "1 km", "km" or "0.3048"."""
    number, unit = re.fullmatch(r"\s*([-+.\deE]*)\s*(.*?)\s*", text).groups()
    try:
        length = float(number or 1) * LENGTHS[unit or "m"]
    except (ValueError, KeyError):
        length = 0
    if not 0 < length < np.inf:
        raise knap.KnapError(f"the unit {text!r} is no length, as 1 km or 0.3048; units are {', '.join(LENGTHS)}")
    return length


def _of_csv(file, unit, property):
    found, ended, names = [], set(), None
    with open(file, newline="", encoding="utf-8-sig") as lines:
        for number, line in enumerate(lines, 1):
            def fail(problem):
                raise knap.KnapError(f"{file}:{number}: {problem}")

            line = line.split("#")[0]
            if not line.strip():
                continue
            if re.search(r"[;\t]", line) and re.search(r"\d,\d", line):
                fail("this line has decimal commas: 1,5 is 1.5 in this file")
            cells = [cell.strip() for cell in re.split(r"[,;\t]", line)]
            if names is None:
                titles = [re.fullmatch(r"([^\[]*?)\s*(?:\[\s*([^\]]*?)\s*\].*)?", cell).groups() for cell in cells]
                names = [name for name, _ in titles]
                if not {"trace", "x", "y"} <= set(names):
                    fail("the first line is not `trace, x [m], y [m], class`")
                at = {name: names.index(name) for name in names}
                one = [titles[at[axis]][1] for axis in "xy"]
                for text in one:
                    if text and text not in LENGTHS:
                        fail(f"the unit `{text}` is none of {', '.join(LENGTHS)}")
                scale = [LENGTHS[text] if text else unit for text in one]
                continue
            if len(cells) < len(names):
                fail(f"this line has {len(cells)} values for {len(names)} names")
            try:
                point = [float(cells[at[axis]]) * factor for axis, factor in zip("xy", scale)]
            except ValueError:
                point = [np.nan]
            if not np.isfinite(point).all():
                fail("x or y of this line is not a number; units stand in the line of names: x [m], y [m]")
            name = cells[at["trace"]]
            if not found or found[-1][1] != name:
                if name in ended:
                    fail(f"trace `{name}` goes on after another one; the points of a trace follow one another")
                ended.add(name)
                found.append(([], name, cells[at[property]] if property in at else "", number))
            found[-1][0].append(point)
    for points, name, _, number in found:
        if len(points) < 2:
            raise knap.KnapError(f"{file}:{number}: trace `{name}` has one point; a line needs two")
    return [Trace(np.array(points), name, kind) for points, name, kind, _ in found]


def _say_left_out(file, kinds):
    if kinds:
        knap.note(f"{file}: left out, since these are no lines: {', '.join(f'{n} {kind}' for kind, n in sorted(kinds.items()))}")


def _of_geojson(file, root, unit, property):
    found, left_out = [], collections.Counter()

    def add(geometry, kind):
        shape = geometry.get("type")
        if shape == "GeometryCollection":
            for part in geometry["geometries"]:
                add(part, kind)
        elif shape in ("LineString", "MultiLineString"):
            for part in [geometry["coordinates"]] if shape == "LineString" else geometry["coordinates"]:
                points = np.array([point[:2] for point in part], float)
                if len(points) < 2:
                    left_out["line of one point"] += 1
                else:
                    found.append(Trace(unit * points, f"{len(found) + 1}", kind))
        else:
            left_out[str(shape)] += 1

    for number, feature in enumerate(root.get("features", [root]) if isinstance(root, dict) else [root]):
        try:
            geometry = feature.get("geometry", feature)
            kind = (feature.get("properties") or {}).get(property)
            if geometry is not None:
                add(geometry, "" if kind is None else str(kind))
        except (AttributeError, KeyError, TypeError, ValueError, IndexError):
            raise knap.KnapError(f"{file}: features[{number}] has no type and coordinates of a line: [[x, y], [x, y], ...]") from None
    _say_left_out(file, left_out)
    return found


def _of_dxf(file, unit):
    try:
        import ezdxf
        import ezdxf.path
        import ezdxf.units
    except ImportError:
        raise knap.KnapError(f"{file}: a .dxf file needs ezdxf (Debian: python3-ezdxf)") from None
    try:
        drawing = ezdxf.readfile(file)
    except ezdxf.DXFError as error:
        raise knap.KnapError(f"{file}: ezdxf cannot read it: {error}") from None
    if unit is None:
        unit, code = 1.0, drawing.header.get("$INSUNITS", 0)
        if code:
            try:
                unit = float(ezdxf.units.conversion_factor(code, ezdxf.units.M))
            except (KeyError, TypeError, ValueError, ZeroDivisionError):
                raise knap.KnapError(f"{file}: its $INSUNITS = {code} is no known length; give the unit") from None
            knap.note(f"{file}: a unit is {unit:g} m, its $INSUNITS")
    found, left_out = [], collections.Counter()

    def add(entity):
        if entity.dxftype() == "INSERT":  # a block
            for part in entity.virtual_entities():
                add(part)
            return
        try:
            path = ezdxf.path.make_path(entity)
            ends = np.array([tuple(p)[:2] for p in path.control_vertices()], float)
            if len(ends) < 2:
                raise TypeError
            points = [tuple(p)[:2] for p in path.flattening(1e-3 * max(np.ptp(ends, axis=0).max(), 1e-300))]
        except (TypeError, ValueError, ezdxf.DXFError):
            left_out[entity.dxftype()] += 1
            return
        found.append(Trace(unit * np.array(points, float), str(len(found) + 1), entity.dxf.layer))  # the class is the layer

    for entity in drawing.modelspace():
        add(entity)
    _say_left_out(file, left_out)
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
        if system is not None and system.IsGeographic() and not system.GetName().startswith("Undefined"):  # of a GeoPackage without one
            raise knap.KnapError(f"{file}: its coordinates are longitudes and latitudes; project them to metres first")
        for feature in layer:
            features.append(json.loads(feature.ExportToJson()))
    return _of_geojson(file, {"features": features}, unit, property)


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
        on_border |= _distance(ends, a, b) <= TOUCH * np.ptp(window, axis=0).max()
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


def box(traces):
    """The corners of the smallest window of traces, parallel to the axes."""
    points = np.concatenate([t.points for t in traces])
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


def statistics(traces, window=None, touch=None, closed=None):
    """P20 (traces per area), P21 (length per area), lengths and connectivity in a window, a knap.Table with units. A
    trace whose end lies on the border counts half in P20 (M. Mauldon, W. M. Dunne, M. B. Rohrbaugh, J. Struct. Geol. 23
    (2001) 247: half of the ends inside over the area). C_B, C_L: connections per branch and per line.
    `closed`: traces end on the border, as on their own box, the default window; then these ends are inside."""
    closed = window is None if closed is None else closed
    window = np.asarray(box(traces) if window is None else window, float)
    extent = np.ptp(window, axis=0).max()
    touch = touch or TOUCH * extent
    area = 0.5 * abs(_cross(window, np.roll(window, -1, axis=0)).sum())
    if not area > TOUCH * extent * extent:
        raise knap.KnapError("the window, or the box of the traces, has no area: give a window")
    # a border farther out than what counts as on it
    around = window + 4 * TOUCH * extent * np.sign(window - window.mean(axis=0)) if closed else window
    inside = clipped(traces, around)
    lengths = np.array([length(t) for t in inside])
    n = nodes(inside, around, touch) if inside else dict.fromkeys("IYXE", 0)
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
    parser.add_argument("--unit", help="of coordinates without one, in m or as \"1 km\"; default: $INSUNITS of a DXF, else 1 m")
    parser.add_argument("--property", default="class", help="column or property that gives the class")
    parser.add_argument("--touch", type=float, help="in m: ends that are nearer than this to a trace meet it")
    parser.add_argument("-o", "--output", help="write the traces of the first source as a csv file for [[traces]]")
    options = parser.parse_args()
    knap.command_line("knap-traces", lambda: _print(options))


def _print(options):
    unit = metres(options.unit) if options.unit else None
    maps = [read(source, unit, options.property) for source in options.source]
    if not all(maps):
        raise knap.KnapError(f"{options.source[[bool(m) for m in maps].index(False)]}: there are no traces")
    if options.output:
        write(options.output, maps[0])
    if options.window:
        x0, y0, x1, y1 = options.window
        window = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    else:
        window = box(maps[0])
    columns = [statistics(m, window, options.touch, closed=not options.window) for m in maps]
    if options.scanline:
        for m, column in zip(maps, columns):
            column["P10"], column.units["P10"] = p10(m, options.scanline[:2], options.scanline[2:]), "1/m"
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["number", *options.source])
    for name in columns[0]:
        unit = columns[0].units[name]
        rows.writerow([f"{name} [{unit}]" if unit else name, *(f"{column[name]:.6g}" for column in columns)])


if __name__ == "__main__":
    command()
