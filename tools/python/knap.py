"""Reads runs, studies and sweeps of knap as arrays, and starts runs. One file; needs Python 3.9 and numpy.

    import knap
    run = knap.run("edge_cracked_block", set={"mesh.size": "1 mm"}, out="runs/coarse")   # or knap.read("runs/coarse")
    run.summary["dissipated"], run.summary.units["dissipated"]     # 0.31, "J"; nan: it never happened
    energy = run.table("energy")                                   # energy.csv: energy["time"], energy.units["time"]
    frame = run.frame(40e-6)                                       # the frame nearest to 40 us
    frame.bulk.points, frame.bulk.cells, frame.bulk["stress"]      # m, corners of triangles, Pa
    sweep = knap.read("sweeps/plate")
    sweep.table["mesh.size"], sweep.table.units["mesh.size"], sweep.table["dissipated"], sweep.run(0)
    net = sweep.passages("net")                                    # what went through a collector in all runs
    energy, part = knap.exceedance(net["energy"])                  # part of the passages with this energy or more
    knap.percentile(net["energy"], 95, of=net["run"])              # value and the ends of its 95 % interval

All names, units and meanings: scenarios/OUTPUTS.md.
"""
import base64
import csv
import functools
import html
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import xml.etree.ElementTree as xml
import zlib

try:
    import fcntl
except ImportError:
    fcntl = None

import numpy as np


class KnapError(Exception):
    """A run that failed, or a file that cannot be read."""


def note(text):
    """What a reader did that its user did not ask for, on stderr."""
    print(text, file=sys.stderr)


def command_line(name, work):
    """Does the work of a command; mistakes are a line, and where `head` reads no more of what it prints it ends without a word."""
    try:
        work()
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python complains at its end
        sys.exit(141)  # as of SIGPIPE
    except (KnapError, OSError, ValueError) as error:
        sys.exit(f"{name}: {error}")


class Table(dict):
    """Values by name, in the order of the file, and their `units` by name ("" for pure numbers, counts and texts)."""

    def __init__(self, values=(), units=()):
        super().__init__(values)
        self.units = dict(units)

    def __missing__(self, name):
        raise KeyError(f"{name!r}; there are: {', '.join(self)}")

    @property
    def titles(self):
        """Names with units, as "time [s]"."""
        return [f"{name} [{self.units[name]}]" if self.units.get(name) else name for name in self]

    def __str__(self):
        """Its columns, aligned; of single values a line each."""
        shapes = {np.shape(column) for column in self.values()}
        if shapes == {()}:
            return aligned(("name", "value", "unit"), [(name, value, self.units.get(name, "")) for name, value in self.items()])
        return aligned(self.titles, zip(*self.values())) if len(shapes) == 1 and len(next(iter(shapes))) == 1 else dict.__repr__(self)


class Grid(Table):
    """A .vtu file: arrays by name, a row per point or cell; `points` [m]; `cells`: numbers of the points of each cell."""

    def __init__(self, points, cells, values, units):
        super().__init__(values, units)
        self.points, self.cells = points, cells


class Frame:
    """One moment of a run: `time` [s] and the grids `bulk`, `interfaces` and `obstacles` (None where the run has none).
    Interfaces that are intact inside the body are not stored."""

    def __init__(self, directory, time, files):
        self.time = time
        grids = {pathlib.Path(file).name.rsplit("_", 1)[0]: read_vtu(directory / file) for file in files}
        self.bulk, self.interfaces, self.obstacles = map(grids.get, ("bulk", "interfaces", "obstacles"))

    def __repr__(self):
        return f"frame at {_readable(self.time, 's')}: " + ", ".join(
            f"{name} with {len(grid.cells)} cells ({', '.join(grid)})" for name, grid in vars(self).items() if isinstance(grid, Grid))


class Run:
    """A run directory. `info`: run.json; `summary`: its numbers, with units."""

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        self.info = json.loads((self.directory / "run.json").read_text(encoding="utf-8"))
        numbers = {name: np.nan if value is None else value for name, value in self.info.get("summary", {}).items()}
        self.summary = Table(numbers, self.info.get("summary_units", {}))
        self._frames = []  # (time, files)

    @property
    def status(self):
        """That of run.json; "killed" where no process goes on with it, as `knap info` says."""
        status = self.info["status"]
        return "killed" if status in ("running", "starting") and not _has_process(self.directory) else status

    def __repr__(self):
        """Its directory, and how it ended."""
        return f"{self.directory}: {self._state()}"

    def _state(self):
        reason = f" ({self.info['reason']})" if self.info.get("reason") else ""
        return f"{self.status}{reason}, {self.info.get('triangles', 0)} triangles, {self.info.get('steps', 0)} steps, " \
               f"{self.info.get('cpu_s', 0):.3g} s of processor time"

    @property
    def reached_end(self):
        """Whether it went to the `time.end` of its scenario, and was not ended before by what it waited for."""
        return self.info["time_s"] >= 0.999 * float(settings(self.directory / "resolved.toml")["time.end"])

    def _repr_html_(self):
        """In a notebook: its state, its numbers and its first picture."""
        rows = [(name, _readable(value, self.summary.units.get(name, ""))) for name, value in self.summary.items()]
        state = f"<b>{html.escape(self.info.get('name', ''))}</b>: {html.escape(self._state())}"
        return f"<p>{state}</p>{_first_picture(self.directory)}<details><summary>numbers</summary>{html_table(('number', 'value', 'unit'), rows)}</details>"

    @property
    def tables(self):
        """Names of its tables."""
        return sorted(file.stem for file in self.directory.glob("*.csv"))

    def table(self, name):
        """A table by the name of its file without .csv, as "energy"; missing values are nan."""
        file = self.directory / f"{name}.csv"
        if not file.exists():
            raise KnapError(f"{self.directory} has no {name}.csv; there are: {', '.join(self.tables)}")
        return read_csv(file)

    @property
    def frame_times(self):
        """Times [s] of the stored frames."""
        if not self._frames and (self.directory / "run.pvd").exists():
            by_time = {}
            for item in xml.parse(self.directory / "run.pvd").iter("DataSet"):
                by_time.setdefault(float(item.get("timestep")), []).append(item.get("file"))
            self._frames = list(by_time.items())
        return np.array([time for time, _ in self._frames])

    def frame(self, time=np.inf):
        """The frame nearest to `time` [s]; without it the last one."""
        times = self.frame_times
        if len(times) == 0:
            raise KnapError(f"{self.directory} has no frames")
        return Frame(self.directory, *self._frames[-1 if time == np.inf else int(np.argmin(np.abs(times - time)))])


class Ensemble:
    """A directory of `knap study` or `knap sweep`. `table`: a line per run, the combination and its results;
    `statistics`: over seeds (empty without them)."""

    def __init__(self, directory, kind):
        self.directory, self.kind = pathlib.Path(directory), kind
        self.table = read_csv(self.directory / f"{kind}.csv")
        statistics = self.directory / "statistics.csv"
        self.statistics = read_csv(statistics) if statistics.exists() else Table()

    def __len__(self):
        return len(self.table["status"])

    def __repr__(self):
        return f"{self.directory}: {self.kind} of {len(self)} runs"

    def _repr_html_(self):
        """In a notebook: its picture and the first lines of its table."""
        most = 20
        rows = [[_readable(column[i], self.table.units[name]) for name, column in self.table.items()] for i in range(min(len(self), most))]
        more = f"<p>and {len(self) - most} more</p>" if len(self) > most else ""
        return f"<p>{self.kind} of {len(self)} runs</p>{_first_picture(self.directory)}{html_table(list(self.table), rows)}{more}"

    def run(self, line):
        """The run of a line of the table of a sweep."""
        return Run(self.directory / "runs" / self.table["run"][line])

    def passages(self, collector):
        """The passages through a collector in all runs of a sweep that are done, with the name of the run in `run`."""
        table = read_csv(self.directory / "passages.csv")
        names = table["collector"].astype(str) if len(table["collector"]) else np.array([], str)
        if collector not in names and not any(f"{collector}_passages" in run.summary for run in self.runs.values()):
            raise KnapError(f"{self.directory} has no collector {collector!r}")
        return Table({name: column[names == collector] for name, column in table.items()}, table.units)

    @property
    def runs(self):
        """All runs that were started, by name."""
        return {file.parent.name: Run(file.parent) for file in sorted(self.directory.glob("runs/*/run.json"))}


def _has_process(directory):
    """Whether a process holds the lock of log.txt, as knap does while it runs."""
    if fcntl is None:
        return True  # Windows does not tell
    try:
        with open(directory / "log.txt", "rb") as log:
            fcntl.flock(log, fcntl.LOCK_SH | fcntl.LOCK_NB)  # closing it gives it back
    except BlockingIOError:
        return True
    except OSError:
        pass
    return False


def _first_picture(directory):
    """That of a sweep of a [[figure]] is sweep.png; others are in figures."""
    pictures = [*directory.glob("sweep.png"), *sorted(directory.glob("figures/*.png"))]
    return image(pictures[0], f"{pictures[0].stem.replace('_', ' ')} of {directory}") if pictures else ""


def _readable(value, unit):
    """"375 mJ": four digits with the unit; whole numbers and texts as they are."""
    if isinstance(value, str) or np.isnan(value):
        return str(value) if isinstance(value, str) else ""
    if float(value).is_integer() and not unit:
        return f"{value:.0f}"
    thousands = int(np.floor(np.log10(abs(value)) / 3)) if value and unit in ("m", "s", "J", "N", "Pa", "W", "Hz") else 0
    if not -4 <= thousands <= 4:
        thousands = 0
    return f"{value / 1000.0 ** thousands:.4g} {'pnµm kMGT'[thousands + 4].strip()}{unit}".rstrip()


def shown(value, digits=6):
    """Text of a cell of a table; of a number that is nan none."""
    if isinstance(value, (float, np.floating)):
        return "" if np.isnan(value) else f"{value:.{digits}g}"
    return "" if value is None else str(value)


def html_table(titles, rows, digits=4):
    def line(cells, kind):
        return "<tr>" + "".join(f"<{kind}>{html.escape(shown(cell, digits))}</{kind}>" for cell in cells) + "</tr>"
    return f'<div style="overflow-x: auto"><table>{line(titles, "th")}{"".join(line(row, "td") for row in rows)}</table></div>'


def image(file, words=""):
    """A picture inside a page; `words` say what it shows."""
    kind = file.suffix[1:].replace("svg", "svg+xml")
    return f'<img style="max-width: 100%" alt="{html.escape(words or file.name)}" src="data:image/{kind};base64,{base64.b64encode(file.read_bytes()).decode()}">'


def _sides(head, rows):
    """Of each column whether it has numbers alone, which stand at its right side."""
    return [all(isinstance(value, (int, float, np.number)) for value in column) and len(column) > 0 for column in list(zip(*rows)) or [()] * len(head)]


def aligned(head, rows, digits=6):
    """A table as text: names, rows of numbers and texts."""
    rows = list(rows)
    cells = [[shown(value, digits) for value in row] for row in [head, *rows]]
    columns = [[cell.rjust(width) if right else cell.ljust(width) for cell in column] for column, right in zip(zip(*cells), _sides(head, rows))
               for width in [max(map(len, column))]]
    return "\n".join("  ".join(line).rstrip() for line in zip(*columns))


def exceedance(values, total=None):
    """The exceedance curve: the values in ascending order, and for each the part of all that is as large or larger.
    `total`: number of all where some have no value, as drops that never reach a barrier."""
    values = np.sort(np.asarray(values, float)[np.isfinite(values)])
    first = np.searchsorted(values, values, side="left")  # equal values have one part
    return values, (len(values) - first) / (total or max(len(values), 1))


def percentile(values, q, of=None, confidence=95, draws=2000, seed=0):
    """The q-th percentile of values, and the lower and the upper end of its confidence interval [%] by the bootstrap (Efron
    1979, percentile method). `of`: the run of each value. Then runs are drawn with all their values, as pieces of one drop
    are not independent. Nan where there is no value."""
    values, keep = np.asarray(values, float), np.isfinite(values)
    _, group = np.unique(np.asarray(of)[keep] if of is not None else np.arange(keep.sum()), return_inverse=True)
    values = values[keep]
    if len(values) == 0:
        return np.nan, np.nan, np.nan
    order = np.argsort(values, kind="stable")
    values, group = values[order], group[order]
    n, random, found = group.max() + 1, np.random.default_rng(seed), []
    for _ in range(draws):
        count = np.bincount(random.integers(0, n, n), minlength=n)[group]  # how often each value was drawn
        last = np.cumsum(count)
        place = q / 100 * (last[-1] - 1) if last[-1] else 0
        low, high = (np.searchsorted(last, rank, side="right") for rank in (np.floor(place), np.ceil(place)))
        found.append(values[low] + (place - np.floor(place)) * (values[high] - values[low]))
    ends = np.percentile(found, [(100 - confidence) / 2, (100 + confidence) / 2])
    return float(np.percentile(values, q)), float(ends[0]), float(ends[1])


def read(directory):
    """A Run, or an Ensemble of a study or a sweep."""
    directory = pathlib.Path(directory)
    if (directory / "run.json").exists():
        return Run(directory)
    for kind in ("sweep", "study"):
        if (directory / f"{kind}.csv").exists():
            return Ensemble(directory, kind)
    inside = sorted(file.parent for place in ("runs/*", "*") for file in directory.glob(f"{place}/run.json"))
    for kind in ("sweep", "study"):
        if (directory / f"{kind}.toml").exists():
            raise KnapError(f"{directory} has no {kind}.csv: the {kind} goes on, or was stopped, and the same command continues it; "
                            f"{len(inside)} of its runs have begun")
    raise KnapError(f"{directory} has none of run.json, sweep.csv, study.csv" + (f"; it has {len(inside)} runs, as {inside[0]}" if inside else ""))


def program():
    """Path of knap: $KNAP, else the one that was built beside this file, else that of $PATH."""
    built = pathlib.Path(__file__).resolve().parents[2] / "build/release/knap"
    found = os.environ.get("KNAP") or (str(built) if built.exists() else shutil.which("knap"))
    if not found:
        raise KnapError("knap was not found: build it, put it on PATH, or set KNAP to its path")
    return found


def run(scenario, set=None, out=None, threads=None, force=True, accept=(0,)):
    """Runs a scenario, a file or the name of a built-in one, and returns its Run.

    set     values of keys: {"mesh.size": "1 mm", "load[0].traction": ["0 MPa", "2 MPa"]}; a text as after --set
    out     directory of the run; default runs/<name>
    force   replace an earlier run; without it a finished run of the same scenario is read again
    accept  exit codes that are no error, as 4: a value of [expect] failed
    """
    command = [program(), "run", str(scenario), "--quiet"]
    for key, value in (set or {}).items():
        command += ["--set", f"{key}={value if isinstance(value, str) else _toml(value)}"]
    command += ["--output", str(out)] if out else []
    command += ["--threads", str(threads)] if threads else []
    command += ["--force"] if force else []
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8")
    if done.returncode not in accept:
        raise KnapError(f"knap ended with exit code {done.returncode}: {' '.join(command)}\n{done.stderr or done.stdout}")
    return Run(re.findall(r"^run: +(.+)$", done.stdout, re.MULTILINE)[-1])


def _toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value.item() if isinstance(value, np.generic) else value, ensure_ascii=False)


def read_csv(file, comment=None):
    """A table with its units. A column with texts other than numbers stays text, but "0.6 mm", "1 mm" of a sweep are
    numbers in mm. Lines end where `comment` stands, and empty ones are left out then."""
    with open(file, newline="", encoding="utf-8") as lines:
        if comment:
            lines = filter(None, (line.split(comment)[0].strip() for line in lines))
        header, *rows = csv.reader(lines)
    table = Table()
    for title, column in zip(header, zip(*rows) if rows else [()] * len(header)):
        name, unit = name_and_unit(title)
        table[name], table.units[name] = _numbers(column, unit)
    return table


def write_csv(file, head, rows, digits=6):
    """Writes a table; a reader, or a process that was ended, finds the old one or the new one."""
    new = pathlib.Path(f"{file}.new")
    with open(new, "w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(head)
        writer.writerows([[f"{cell:.{digits}g}" if isinstance(cell, float) else cell for cell in row] for row in rows])
    os.replace(new, file)


_prefixes = {"": 1, "G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}


def factor(unit, of):
    """Value of one `unit` in the unit `of`, as 1e6 of MPa in Pa; None where they are not of one kind."""
    if unit == of or not unit:
        return 1.0
    if unit == "%" and not of:
        return 0.01
    result, parts, of_parts = 1.0, unit.split("/"), of.split("/")
    for k, (part, base) in enumerate(zip(parts, of_parts)):
        prefix = _prefixes.get(part.removesuffix(base)) if part.endswith(base) else None
        if prefix is None or len(parts) != len(of_parts):
            return None
        power = int(base[-1]) if base[-1:] in ("2", "3") else 1
        result *= prefix ** (-power if k else power)
    return result


def quantity(value):
    """Number and unit of 3, "3 MPa", "5 %"; None where it is none."""
    number = r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return (float(value), "") if np.isfinite(value) else None
    match = re.fullmatch(number, value) if isinstance(value, str) else None
    return (float(match[1]), match[2]) if match else None


def name_and_unit(title):
    """("time", "s") of the title "time [s]" of a column."""
    name, unit = re.fullmatch(r"(.*?)(?: \[(.*)\])?", title, re.DOTALL).groups()
    return name, unit or ""


def _numbers(texts, unit):
    try:
        return np.array([float(text) if text else np.nan for text in texts]), unit
    except ValueError:
        pass
    parts = [re.fullmatch(r"([-+0-9.eE]+) *(\S+)", text) for text in texts]
    if not unit and all(parts) and len({part[2] for part in parts}) == 1:
        try:
            return np.array([float(part[1]) for part in parts]), parts[0][2]
        except ValueError:
            pass
    return np.array(texts), unit


_types = {"Float32": "f4", "Float64": "f8", "Int32": "i4", "Int64": "i8", "UInt8": "u1"}


def read_vtu(file):
    """A Grid of a .vtu file as runs of knap write it: raw appended data, whole or in blocks of LZ4 or zlib."""
    data = pathlib.Path(file).read_bytes()
    start = data.find(b"<AppendedData")
    compressor = re.search(rb'compressor="vtk(\w*)DataCompressor"', data[:max(start, 0)])
    unpacked = {b"LZ4": _lz4, b"ZLib": _inflated}.get(compressor[1]) if compressor else _whole
    if start < 0 or not unpacked:
        raise KnapError(f"{file} is not a frame of knap: it has no appended data that are whole or compressed by LZ4 or zlib")
    root = xml.fromstring(data[:start] + b"</VTKFile>")
    appended = data.index(b"_", start) + 1
    encoded = b'encoding="base64"' in data[start:appended]  # small files, whole
    head = {"UInt32": "I", "UInt64": "Q"}[root.get("header_type", "UInt32")]

    def array(item):
        try:
            return array_at(item)
        except (struct.error, base64.binascii.Error):
            raise KnapError(f"{file} is cut off") from None

    def array_at(item):
        at = appended + int(item.get("offset"))
        if encoded:
            (size,) = struct.unpack(f"<{head}", base64.b64decode(data[at:at + 8 * struct.calcsize(head) // 4])[:struct.calcsize(head)])
            whole = struct.calcsize(head) + size
            return shaped(_whole(base64.b64decode(data[at:at + 4 * -(-whole // 3)])[struct.calcsize(head):], size), item)
        if not compressor:
            begin, (size,) = at + struct.calcsize(head), struct.unpack_from(f"<{head}", data, at)
            return shaped(_whole(data[begin:begin + size], size), item)
        n, size, last = struct.unpack_from(f"<3{head}", data, at)
        packed = struct.unpack_from(f"<{n}{head}", data, at + 3 * struct.calcsize(head))
        at += (3 + n) * struct.calcsize(head)
        blocks = []
        for i, length in enumerate(packed):
            blocks.append(unpacked(data[at:at + length], last if last and i == n - 1 else size))
            at += length
        return shaped(b"".join(blocks), item)

    def shaped(bytes_, item):
        values = np.frombuffer(bytes_, "<" + _types[item.get("type")])
        width = int(item.get("NumberOfComponents", 1))
        return values.reshape(-1, width) if width > 1 else values

    values, units = {}, {}
    for item in [*root.iterfind(".//PointData/DataArray"), *root.iterfind(".//CellData/DataArray")]:
        name, unit = item.get("Name"), item.find("InformationKey[@name='UNITS_LABEL']")
        values[name], units[name] = array(item), "" if unit is None else unit.text.strip()
    cells = {item.get("Name"): item for item in root.iterfind(".//Cells/DataArray")}
    connectivity, offsets = array(cells["connectivity"]), array(cells["offsets"])
    points = array(root.find(".//Points/DataArray")).reshape(-1, 3)[:, :2]
    return Grid(points, connectivity.reshape(len(offsets), -1) if len(connectivity) else connectivity, values, units)


def _inflated(block, size):
    """Decompresses a block of zlib to `size` bytes."""
    try:
        out = zlib.decompress(block)
    except zlib.error:
        raise KnapError("a compressed block is damaged") from None
    return _whole(out, size)


def _whole(out, size):
    if len(out) != size:
        raise KnapError(f"an array or its block has {len(out)} bytes instead of {size}")
    return out


def _lz4(block, size):
    """Decompresses an LZ4 block to `size` bytes."""
    out, at, end = bytearray(), 0, len(block)
    try:
        while at < end:
            token = block[at]
            at += 1
            length = token >> 4
            if length == 15:
                while (more := block[at]) == 255:
                    length, at = length + 255, at + 1
                length, at = length + more, at + 1
            out += block[at:at + length]
            at += length
            if at >= end:
                break
            distance = block[at] | block[at + 1] << 8
            at += 2
            length = token & 15
            if length == 15:
                while (more := block[at]) == 255:
                    length, at = length + 255, at + 1
                length, at = length + more, at + 1
            length += 4
            start = len(out) - distance
            if distance >= length:
                out += out[start:start + length]
            else:  # the copy overlaps what it writes: a pattern that repeats
                pattern = bytes(out[start:])
                out += (pattern * (length // distance + 1))[:length]
    except IndexError:
        raise KnapError("a compressed block ends too early") from None
    return _whole(out, size)


def compare(one, other, within=1e-12):
    """A Table of what differs between two runs (a Run or its directory each): kind, name, one, other, unit, `ratio` of numbers.
    Rows are keys of resolved.toml and numbers of the summary that differ by more than this part; print shows it aligned, latex
    makes a table of it."""
    one, other = (run if isinstance(run, Run) else Run(run) for run in (one, other))
    found = []
    keys = [{key: _number(text) for key, text in settings(run.directory / "resolved.toml").items()} for run in (one, other)]
    for kind, (a, b) in (("key", keys), ("number", (one.summary, other.summary))):
        for name in [*a, *(name for name in b if name not in a)]:
            x, y = a.get(name), b.get(name)
            numbers = all(isinstance(value, (int, float)) for value in (x, y))
            same = x == y or (numbers and (abs(x - y) <= within * max(abs(x), abs(y)) or (np.isnan(x) and np.isnan(y))))
            if not same:
                unit = unit_of_key(name) if kind == "key" else one.summary.units.get(name) or other.summary.units.get(name, "")
                found.append((kind, name, x, y, unit, y / x if numbers and x else np.nan))
    return Table(zip(("kind", "name", "one", "other", "unit", "ratio"), zip(*found) if found else [()] * 6))


def _number(text):
    try:
        return float(text)
    except ValueError:
        return text


@functools.cache
def schema(what):
    """{heading: {name: second column}} of what `knap schema --markdown` (keys) or `--outputs` says."""
    text = subprocess.run([program(), "schema", what], capture_output=True, text=True, check=True).stdout
    tables, rows = {}, {}
    for line in text.splitlines():
        if line.startswith("## "):
            rows = tables.setdefault(line[3:].strip(), {})
        elif match := re.match(r"\| `([^`]+)` \| ([^|]*) \|", line):
            rows[match[1]] = match[2].strip()
    return tables


def outputs_of(table):
    """{name: unit} of the summary or a csv file of a run; a name may begin with *."""
    outputs = schema("--outputs")
    return outputs.get(table) or outputs.get(f"{table}.csv", {})


def unit_of_output(table, name):
    """SI unit of a number of the summary or a column of a table; None where there is none of this name."""
    return next((unit for pattern, unit in outputs_of(table).items()
                 if name == pattern or (pattern[0] == "*" and name.endswith(pattern[1:]) and len(name) >= len(pattern))), None)


def unit_of_key(path):
    """SI unit of a key of a resolved scenario, as "J/m2" of interface.default.G_c; "" where it is no number with a unit."""
    for rows in schema("--markdown").values():
        for name, value in rows.items():
            if re.fullmatch(re.escape(name).replace(r"\*", "[^.]+").replace(r"\[\]", r"\[\d+\]"), path):
                return (re.search(r"\[([^\]]+)\]", value) or ("", ""))[1]
    return ""


def toml_lines(text):
    """Of every line of a TOML file that begins a table or has a key: its number, itself, the path, and the text of the value or None."""
    head, counts = "", {}
    for number, line in enumerate(text.splitlines(), 1):
        if match := re.match(r"\s*(\[\[?)([^\]\"]+|[^\]]*)\]\]?\s*(#.*)?$", line):
            head = match[2].strip()
            if match[1] == "[[":
                counts[head] = counts.get(head, -1) + 1
                head = f"{head}[{counts[head]}]"
            yield number, line, head, None
        elif match := re.match(r"\s*([\w.\-\"\[\]]+)\s*=\s*(.*?)\s*$", line):
            yield number, line, f"{head}.{match[1]}".lstrip("."), match[2]


def settings(file):
    """{path of a key: text of its value} of a resolved scenario."""
    return {path: value for *_, path, value in toml_lines(file.read_text(encoding="utf-8")) if value is not None}


def course(run, x, y):
    """The tables that have the columns "TABLE.COLUMN" of a curve, and its x and y: x at the times of y where they are of tables
    with other lines, and nothing that is unknown."""
    (table, x), (other, y) = (name.split(".", 1) for name in (x, y))
    tables = run.table(table), run.table(other)
    x, y = tables[0][x], tables[1][y]
    if len(x) != len(y):
        x = np.interp(tables[1]["time"], tables[0]["time"], x)
    keep = np.isfinite(x) & np.isfinite(y)
    return tables, x[keep], y[keep]


def plot_over(runs, x, y, labels=None, axis=None):
    """Curves of several runs over each other, by matplotlib: `x`, `y` as "stress_strain.stress". Returns the axis."""
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise KnapError("plot_over needs matplotlib: apt install python3-matplotlib") from None
    axis = axis or plt.subplots()[1]
    for k, run in enumerate(runs):
        run = run if isinstance(run, Run) else Run(run)
        tables, *curve = course(run, x, y)
        axis.plot(*curve, label=labels[k] if labels else run.directory.name)
    axis.set(**{f"{axis_name}label": name + (f" [{table.units[name]}]" if table.units[name] else "")
                for axis_name, table, name in zip("xy", tables, (x.split(".", 1)[1], y.split(".", 1)[1]))})
    axis.legend()
    return axis


_special = {**{c: "\\" + c for c in "&%$#_{}"}, "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


def latex(head, rows=(), caption="", digits=4):
    """A table for LaTeX (package booktabs): names, rows of numbers and texts; or a Table, as of compare or of a csv file."""
    if isinstance(head, Table):
        head, rows = head.titles, zip(*head.values())
    def cell(value):
        text = shown(value, digits)
        if not isinstance(value, (int, float, np.number)) or not text:
            return "".join(_special.get(c, c) for c in text)
        return re.sub(r"(.*)e([-+])0*(\d+)", lambda m: f"${m[1]}\\times10^{{{m[2].strip('+')}{m[3]}}}$", text) if "e" in text else f"${text}$"
    rows = [list(row) for row in rows]
    lines = [" & ".join(map(cell, row)) + r" \\" for row in [head, *rows]]
    sides = "".join("r" if right else "l" for right in _sides(head, rows))
    return "\n".join([r"\begin{table}", *([rf"\caption{{{cell(caption)}}}"] if caption else []),
                      rf"\begin{{tabular}}{{{sides}}}", r"\toprule", lines[0], r"\midrule", *lines[1:], r"\bottomrule",
                      r"\end{tabular}", r"\end{table}", ""])
