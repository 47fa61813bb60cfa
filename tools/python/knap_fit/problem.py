"""Reads a FILE of knap-fit. All its mistakes are reported at once, with the line, the key and what is allowed (keys.toml)."""
import csv
import difflib
import functools
import pathlib
import re
import subprocess
import tempfile

import numpy as np

import knap

from . import need

tomllib = need("tomllib", "python3 (3.11 or later)", "a FILE")
keys = tomllib.loads((pathlib.Path(__file__).parent / "keys.toml").read_text(encoding="utf-8"))
prose = keys.pop("prose")
defaults = {name: key["default"] for name, key in keys["fit"].items() if "default" in key}
_prefixes = {"": 1, "G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}


class Mistakes(Exception):
    """What is wrong in FILE, a text for each, and what was run."""

    def __init__(self, texts, ran="nothing was run"):
        super().__init__("\n".join(texts) + f"\n{len(texts)} error{'s' * (len(texts) > 1)}, {ran}.")


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
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value), ""
    match = re.fullmatch(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*", value) if isinstance(value, str) else None
    return (float(match[1]), match[2]) if match else None


class Parameter:
    """A free parameter: u in [0, 1] stands for its value between two bounds, in their unit."""

    def __init__(self, name, keys, bounds, unit, log, normal=None, start=None):
        self.name, self.keys, self.unit, self.log, self.normal, self.start = name, keys, unit, log, normal, start
        self.low, self.high = bounds

    def value(self, u):
        return self.low * (self.high / self.low) ** u if self.log else self.low + (self.high - self.low) * u

    def place(self, value):
        return np.log(value / self.low) / np.log(self.high / self.low) if self.log else (value - self.low) / (self.high - self.low)

    def log_prior(self, u):
        """Uniform in u between the bounds; with `normal` also of the value, by its mean and standard deviation."""
        inside = np.where((u >= 0) & (u <= 1), 0.0, -np.inf)
        return inside - (0.5 * ((self.value(np.clip(u, 0, 1)) - self.normal[0]) / self.normal[1]) ** 2 if self.normal is not None else 0)

    def deviation(self, function):
        """Standard deviation of a function of its value, before the data."""
        grid = np.linspace(0.0005, 0.9995, 1000)
        return np.sqrt(np.cov(function(self.value(grid)), aweights=np.exp(self.log_prior(grid)), ddof=0))

    def text(self, u):
        return f"{self.value(u):.6g} {self.unit}".strip()

    @property
    def title(self):
        return label(self.name, self.unit)


def label(name, unit):
    return f"{name} [{unit}]" if unit else name


class Measured:
    """What a test gave: a number of the summary, or a curve over `x`. `use`: fit; predict (left out); candidate (a test
    that was not done: would it tell more?). `values`: SI, those of a curve at the places x. `scatter`: standard deviation
    of one specimen, None: that of seeds. `n`: number of specimens of which `values` is the mean."""

    def __init__(self, test, name, use, values, scatter, n=1, x=None, columns=None, factors=(1, 1), unit="", x_unit=""):
        self.test, self.name, self.use, self.values, self.scatter, self.n = test, name, use, values, scatter, n
        self.x, self.columns, self.factors, self.unit, self.x_unit = x, columns, factors, unit, x_unit
        self.shown, self.x_shown = unit, x_unit  # units of FILE, which tables and pictures have
        self.noise = 0.0  # standard deviation of each point by itself
        self.part = 0.0  # scatter of a candidate over its value, which is not known yet
        self.where = test and test.name  # file and line

    @property
    def title(self):
        return f"{self.test.name}: {self.name}" + {"fit": "", "predict": " (left out)", "candidate": " (not measured)"}[self.use]

    @property
    def size(self):
        return 1 if self.x is None else len(self.x)

    @property
    def level(self):
        """The size of its values, to which parts refer."""
        return float(np.abs(self.values).max()) if self.values is not None and self.size else 1.0

    def in_file(self, values):
        """Values in the unit of FILE."""
        return values / factor(self.shown, self.unit)

    @property
    def x_in_file(self):
        return self.x / factor(self.x_shown, self.x_unit)

    @functools.cache
    def of(self, run):
        """Its values in a run; nan where the run has none."""
        if self.x is None:
            value = run.summary[self.name] if self.name in run.summary else np.nan
            return np.array([np.nan if value is None else float(value)])
        return _first(*self.course(run), self.x)

    def course(self, run):
        """x and y of the curve that a run has."""
        (table, x), (other, y) = self.columns
        table, other = run.table(table), run.table(other)
        try:
            x, y = self.factors[0] * table[x], self.factors[1] * other[y]
        except KeyError as missing:
            raise knap.KnapError(f"a run has no column {missing.args[0]}") from None
        if len(x) != len(y):
            x = np.interp(other["time"], table["time"], x)
        keep = np.isfinite(x) & np.isfinite(y)
        return x[keep], y[keep]

    def mistake(self, run):
        """What the first run shows of FILE, and what is allowed; None: nothing. It lacks a column; it lies on the other side of zero where a
        sign was forgotten; it reaches the end of its time before the end of the curve."""
        try:
            x, y = self.course(run)
        except knap.KnapError as error:
            return str(error), ""
        if not len(x):
            return None
        signs = [-1 if np.clip(x, *self.x[[0, -1]]).ptp() == 0 < np.clip(-x, *self.x[[0, -1]]).ptp() else 1, 1]
        product = _first(signs[0] * x, y, self.x) * self.values
        signs[1] = -1 if (product < 0).sum() > 1 and not (product > 0).any() else 1
        if signs != [1, 1]:
            return "the first run has its curve on the other side of zero", f"factors = {[float(sign * old) for sign, old in zip(signs, self.factors)]}"
        if not x.min() <= self.x[0] < self.x[-1] <= x.max() and run.reached_end:
            low, high, first, last = (f"{value / factor(self.x_shown, self.x_unit):.4g}" for value in (x.min(), x.max(), *self.x[[0, -1]]))
            return (f"the first run has its curve from {low} to {high} {self.x_shown}, what was measured goes from {first} to {last} {self.x_shown}",
                    "a later time.end, in `set`; the part that runs have, between = [...]")
        return None


def _first(x, y, places):
    """y at places of x, of every x the first time that it is reached; nan outside."""
    if not len(x):
        return np.full(len(places), np.nan)
    first = np.concatenate([[True], x[1:] > np.maximum.accumulate(x)[:-1]])
    return np.interp(places, x[first], y[first], left=np.nan, right=np.nan)


class Test:
    def __init__(self, name, scenario, set, seeds, first_seed):
        self.name, self.scenario, self.set, self.seeds, self.first_seed = name, scenario, set, seeds, first_seed
        self.measured = []


class Problem:
    """What FILE asks for: `parameters`, `tests`, `options` of [fit]."""

    def __init__(self, name, parameters, tests, options):
        self.name, self.parameters, self.tests, self.options = name, parameters, tests, {**defaults, **options}
        self.file = None  # FILE

    @property
    def measured(self):
        return [measured for test in self.tests for measured in test.measured]

    @property
    def fitted(self):
        return [measured for measured in self.measured if measured.use == "fit"]

    def check_first(self, runs):
        """Mistakes of FILE that the first run of each test shows."""
        texts = []
        for m in (m for m in self.measured if m.x is not None):
            for text, remedy in (found for run in runs.answers(m.test)[:1] if run and (found := m.mistake(run))):
                texts.append(f"error: {m.title}: {text}\n  --> {m.where}" + f"\n   = allowed: {remedy}" * bool(remedy))
        if texts:
            raise Mistakes(texts, "the first run was done")

    def values(self, u):
        return np.array([parameter.value(x) for parameter, x in zip(self.parameters, np.transpose(u))]).T

    def rounded(self, u):
        """The values that a run gets, a tuple."""
        return tuple(float(f"{value:.6g}") for value in self.values(u))

    def keys_of(self, *tests):
        """{key of the scenarios of these tests: number of the parameter that sets it}; TEST:KEY where several parameters do, each in a
        test of its own."""
        names = ("", *(test.name for test in tests))
        keys = [(*key.rpartition(":"), i) for i, parameter in enumerate(self.parameters) for key in parameter.keys if key.rpartition(":")[0] in names]
        owners = {plain: {i for _, _, other, i in keys if other == plain} for _, _, plain, _ in keys}
        return {plain if len(owners[plain]) == 1 else f"{of}:{plain}": i for of, _, plain, i in keys}

    def set_of(self, test, u):
        """KEY=VALUE of a run of a test."""
        return {**test.set, **{key: self.parameters[i].text(u[i]) for key, i in self.keys_of(test).items()}}


def outputs_of(table):
    """{name: unit} of the outputs of the program in the summary or a csv file; a name may begin with *."""
    outputs = knap.schema("--outputs")
    return outputs.get(table) or outputs.get(f"{table}.csv", {})


def unit_of(table, name):
    """Unit of an output of the program; None where it has none of this name."""
    rows = outputs_of(table)
    return next((unit for pattern, unit in rows.items() if name == pattern or (pattern[0] == "*" and name.endswith(pattern[1:]) and len(name) >= len(pattern))), None)


def allowed(key):
    """What a key of keys.toml may be, in words."""
    kind = key["kind"]
    if "allowed" in key:
        return key["allowed"]
    if isinstance(kind, list):
        return ", ".join(f'"{word}"' for word in kind)
    if "range" in key:
        return f"{'a whole number' if kind == 'whole' else 'a number or a percentage'} from {key['range'][0]:g} to {key['range'][1]:g}"
    return {"text": "a text", "table": "a table", "tables": "tables"}[kind]


def markdown():
    """scenarios/FIT_KEYS.md"""
    heads = {"top": "At the top", "parameter": "[parameter.NAME]", "test": "[test.NAME]", "measured": "[[test.NAME.measured]]",
             "expect": "[expect.PARAMETER]"}
    lines = [prose.rstrip()]
    for kind, rows in keys.items():
        lines += ["", f"## {heads.get(kind, f'[{kind}]')}", "", "| key | value | default | meaning |", "|---|---|---|---|"]
        for name, key in rows.items():
            default = key.get("standard", key.get("default"))
            default = "required" if key.get("required") else default if default else "0" if default == 0 else ""
            lines.append(f"| `{name}` | {allowed(key)} | {default} | {key['meaning']} |")
    return "\n".join(lines) + "\n"


def _checked(key, given):
    """The value of a key in the form that the program uses; None where it is not allowed."""
    kind, count = key["kind"], key.get("count")
    if isinstance(kind, list):
        return given if given in kind else None
    if kind in ("text", "table"):
        return given if isinstance(given, str if kind == "text" else dict) else None
    if kind in ("whole", "number", "quantity"):
        found = quantity(given)
        if kind == "quantity" or found is None:
            return found
        value, (low, high) = found[0] * (factor(found[1], "") or np.nan), key["range"]
        return None if not low <= value <= high or (kind == "whole" and value != int(value)) else int(value) if kind == "whole" else value
    if kind == "array":
        try:
            found = np.array(given, float)
        except (TypeError, ValueError):
            return None
        return found if found.ndim == len(key["shape"]) and found.shape[-1] == 2 and np.isfinite(found).all() else None
    given = given if isinstance(given, list) or count else [given]
    if not isinstance(given, list) or not given or (count and len(given) != count):
        return None
    if kind == "quantities":
        found = [quantity(value) for value in given]
        return (np.array([value for value, _ in found]), found[0][1]) if None not in found and len({unit for _, unit in found}) == 1 else None
    return given if all(isinstance(value, str if kind == "texts" else dict) for value in given) else None


class _Reader:
    def __init__(self, file):
        self.file, self.found = pathlib.Path(file), []
        self.owners = {}  # the parameter that sets a key of a test
        text = self.file.read_text(encoding="utf-8")
        try:
            self.root = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise Mistakes([f"error: {error}\n  --> {file}"]) from None
        self.lines, counts, head = {}, {}, ""
        for number, line in enumerate(text.splitlines(), 1):
            if match := re.match(r"\s*(\[\[?)([^\]]+)\]", line):
                head = match[2].strip().replace('"', "")
                if match[1] == "[[":
                    counts[head] = counts.get(head, -1) + 1
                    head = f"{head}[{counts[head]}]"
                self.lines.setdefault(head, (number, line))
            elif match := re.match(r'\s*"?([\w.\-\[\]]+)"?\s*=', line):
                self.lines.setdefault(f"{head}.{match[1]}".lstrip("."), (number, line))

    def line(self, path):
        """Number and text of the line of a key, or of the table that would have it."""
        while path and path not in self.lines:
            path = path.rpartition(".")[0]
        return self.lines.get(path, (1, ""))

    def error(self, path, text, remedy=""):
        number, line = self.line(path)
        self.found.append(f"error: `{path}` {text}\n  --> {self.file}:{number}\n   | {line.strip()}"
                          + (f"\n   = allowed: {remedy}" if remedy else ""))

    def refuse(self, kind, name, path, given):
        """A mistake in the value of a key of a table; what was `given` has it."""
        self.error(f"{path}.{name}".lstrip("."), f"= {given[name]!r} is not allowed", allowed(keys[kind][name]))

    def table(self, given, kind, path):
        """{key: value} of a table, with defaults; a key that is not there and has none is None."""
        found = {name: key.get("default") for name, key in keys[kind].items()}
        if not isinstance(given, dict):
            self.error(path, "is not a table")
            return found
        for name in given:
            if name not in found:
                near = difflib.get_close_matches(name, found, 1)
                self.error(f"{path}.{name}".lstrip("."), "is not a key" + (f"; did you mean `{near[0]}`?" if near else ""), ", ".join(found))
            elif (value := _checked(keys[kind][name], given[name])) is not None:
                found[name] = value
            else:
                self.refuse(kind, name, path, given)
        for name, key in keys[kind].items():
            if key.get("required") and name not in given:
                self.error(path or name, f"has no `{name}`", allowed(key))
        return found

    def number(self, name, path):
        """The unit of a number of the summary; a mistake where there is none of this name."""
        unit = unit_of("summary", name)
        if unit is None:
            near = difflib.get_close_matches(name, outputs_of("summary"), 3)
            self.error(path, f"= {name!r} is not a number of the summary", ", ".join(near) or "see scenarios/OUTPUTS.md")
        return unit

    def parameter(self, name, given, tests):
        path = f"parameter.{name}"
        table = self.table(given, "parameter", path)
        found = Parameter(name, table["key"] or [], (0.0, 1.0), "", table["scale"] == "log")
        for key in found.keys:
            of, _, plain = key.rpartition(":")
            if of and of not in tests:
                self.error(f"{path}.key", f"names the test {of!r}, which does not exist", ", ".join(tests))
            for test in [of] if of else tests:
                other = self.owners.setdefault((test, plain), name)
                if other != name:
                    self.error(f"{path}.key", f"has {key!r}, which the parameter {other} has, too", "a key of one parameter alone")
                    break
        if table["bounds"] is None:
            return found
        (low, high), unit = table["bounds"]
        if not low < high or (found.log and low <= 0):
            self.refuse("parameter", "bounds", path, given)
            found.log = False  # what follows looks for other mistakes between bounds of 0 and 1
            return found
        found.low, found.high, found.unit = low, high, unit
        found.normal, found.start = (table[key] and table[key][0] for key in ("normal", "start"))
        for key, good in (("normal", lambda value: low <= value[0] <= high and value[1] > 0), ("start", lambda value: low <= value <= high)):
            if table[key] and not (table[key][1] == unit and good(table[key][0])):
                self.refuse("parameter", key, path, given)
        return found

    def test(self, name, given, seeds):
        path = f"test.{name}"
        table = self.table(given, "test", path)
        scenario = table["scenario"] or ""
        if (self.file.parent / scenario).is_file():
            scenario = str((self.file.parent / scenario).resolve())
        elif scenario.endswith(".toml"):
            self.refuse("test", "scenario", path, given)
        values = {key: value if isinstance(value, str) else knap._toml(value) for key, value in table["set"].items()}
        test = Test(name, scenario, values, table["seeds"] or seeds, table["seed"])
        for key in table["set"]:
            if owner := self.owners.get((name, key)):
                self.error(f"{path}.set", f"has {key!r}, which the parameter {owner} sets", "other keys of the scenario")
        for i, entry in enumerate(table["measured"]):
            self.measured(test, entry, f"{path}.measured[{i}]")
        return test

    def measured(self, test, given, path):
        table = self.table(given, "measured", path)
        kinds = [name for name in ("number", "curve", "points") if name in given]
        if len(kinds) != 1:
            self.error(path, "needs exactly one of number, curve, points")
        if len(kinds) != 1 or table[kinds[0]] is None:
            return
        found = (self.one_number if kinds[0] == "number" else self.curve)(test, table, path, given)
        if found is None:
            return
        found.n = table["n"] or found.n
        for key in ("scatter", "noise"):
            value, unit = table[key] or (None, "")
            if value is not None and unit == "%" and found.values is None:
                found.part = value = float(np.hypot(found.part, value / 100)) * np.sign(value)
            elif value is not None:
                value *= found.level / 100 if unit == "%" else factor(unit, found.unit) or np.nan
                setattr(found, key, value)
            if value is not None and unit == "%" and found.values is not None and not found.level > 0:
                self.error(f"{path}.{key}", "is a part of a measured 0", f"a {key} in {found.unit or 'the unit of the number'}")
            elif value is not None and not value >= 0:
                self.refuse("measured", key, path, given)
            elif value is not None and found.values is None and unit != "%":
                found.shown = unit or found.shown
        if any((other.name, other.use) == (found.name, found.use) for other in test.measured):
            self.error(path, f"is the second one of {found.name} in this test", "values = [...] of several specimens; another test; another `use`")
        found.where, found.path = f"{self.file}:{self.line(path)[0]}", f"{path}.{kinds[0]}"
        test.measured.append(found)

    def one_number(self, test, table, path, given):
        unit = self.number(table["number"], f"{path}.number")
        found = Measured(test, table["number"], table["use"], None, None, unit=unit)
        if table["values"] is None:
            if table["use"] != "candidate" and "values" not in given:
                self.error(path, "has no `values`", keys["measured"]["values"]["allowed"])
        elif unit is not None:
            values, own = table["values"]
            scale = factor(own, unit)
            if scale is None:
                self.error(f"{path}.values", f"are in {own}", f"a unit of {found.name}: {unit or 'none'}")
                return None
            found.values, found.n, found.shown = np.array([values.mean() * scale]), len(values), own or unit
            if len(values) > 2:  # of the specimens themselves
                found.scatter = float(values.std(ddof=1)) * scale
        return found

    def curve(self, test, table, path, given):
        points, own, columns, units = table["points"], table["units"], [], []
        for key in "xy":
            name, _, column = (table[key] or "").partition(".")
            columns.append((name, column))
            units.append(unit_of(name, column))
            if units[-1] is None:
                known = [f"{name}.{row}" for row in outputs_of(name)]
                self.error(f"{path}.{key}", f"= {table[key]!r} is not a column of a table of the run",
                           ", ".join(known[:12]) or allowed(keys["measured"][key]))
        if table["curve"]:
            points, own = self.csv(table["curve"], own, f"{path}.curve")
            if points is None:
                return None
        elif len(points) < 2 or not (np.diff(points[:, 0]) > 0).all():
            self.refuse("measured", "points", path, given)
            return None
        scales = [factor(unit, of or "") for unit, of in zip(own, units)]
        if None in scales and None not in units:
            self.error(f"{path}.units", f"= {own!r} is not allowed", f"units of {table['x']}: {units[0]}, of {table['y']}: {units[1]}")
        if None in scales or None in units:
            return None
        x, y = (points * scales).T
        if table["between"]:
            (low, high), unit = table["between"]
            keep = (x >= low * (factor(unit, units[0]) or np.nan)) & (x <= high * (factor(unit, units[0]) or np.nan))
            if keep.sum() < 2:
                self.refuse("measured", "between", path, given)
                return None
            x, y = x[keep], y[keep]
        found = Measured(test, columns[1][1], table["use"], y, None, x=x, columns=columns, factors=table["factors"], unit=units[1], x_unit=units[0])
        found.x_shown, found.shown = (unit or of for unit, of in zip(own, units))
        return found

    def csv(self, name, units, path):
        """Points and units of a csv file; all its mistakes are one error with a line for each. None: it has some."""
        try:
            head, *rows = csv.reader((self.file.parent / name).read_text(encoding="utf-8-sig").splitlines() or [""])
        except (OSError, UnicodeDecodeError) as error:
            self.error(path, f"= {name!r} cannot be read: {getattr(error, 'strerror', None) or error}", keys["measured"]["curve"]["allowed"])
            return None, units
        titles, points, wrong = [knap.name_and_unit(title) for title in head], [], []
        if len(head) != 2 or any(quantity(title) or (title.endswith(")") and not unit) for title, unit in titles):
            wrong.append((1, f"{','.join(head)!r} are not two names with units"))
        for number, row in ((number, row) for number, row in enumerate(rows, 2) if row):
            try:
                x, y = map(float, row)
            except ValueError:
                x = y = np.nan
            if not np.isfinite([x, y]).all():
                wrong.append((number, f"{','.join(row)!r} is not two numbers"))
            elif points and x <= points[-1][0]:
                wrong.append((number, f"x = {x:g} is not larger than {points[-1][0]:g} before it"))
            else:
                points.append((x, y))
        if len(points) < 2:
            wrong.append((len(rows) + 1, "it ends with fewer than two points"))
        if wrong:
            lines = "".join(f"\n  --> {self.file.parent / name}:{number}: {text}" for number, text in wrong[:20]) + "\n  ..." * (len(wrong) > 20)
            self.error(path, f"= {name!r} has {len(wrong)} mistake{'s' * (len(wrong) > 1)}", keys["measured"]["curve"]["allowed"] + lines)
            return None, units
        return np.array(points), [unit or other for (_, unit), other in zip(titles, units)]

    def expect(self, name, given, parameters):
        """Value of the mean of the posterior, and how far from it the mean may lie."""
        table, unit = self.table(given, "expect", f"expect.{name}"), next((p.unit for p in parameters if p.name == name), None)
        if unit is None:
            self.error(f"expect.{name}", "is not a parameter", ", ".join(p.name for p in parameters))
            return None
        for key, units in (("value", [unit]), ("within", ["%", unit])):
            if table[key] and table[key][1] not in units:
                self.refuse("expect", key, f"expect.{name}", given)
        (value, _), (within, of) = table["value"] or (0, ""), table["within"] or (0, "")
        return value, within * value / 100 if of == "%" != unit else within


def read(file, check_scenarios=True, fit=True):
    """The Problem of a file; raises Mistakes. For a `fit` each test has something measured; knap-sensitivity can do with the names
    of numbers."""
    reader = _Reader(file)
    top = reader.table(reader.root, "top", "")
    options = {**reader.table(top["fit"], "fit", "fit"), **reader.table(top["sensitivity"], "sensitivity", "sensitivity")}
    parameters = [reader.parameter(name, table, top["test"]) for name, table in top["parameter"].items()]
    tests = [reader.test(name, table, options["seeds"]) for name, table in top["test"].items()]
    options["expect"] = {name: reader.expect(name, table, parameters) for name, table in top["expect"].items()}
    for name in options["numbers"]:
        reader.number(name, "sensitivity.numbers")
    problem = Problem(top["name"] or pathlib.Path(file).stem, parameters, tests, options)
    problem.file = pathlib.Path(file)
    per_point = sum(test.seeds for test in tests)
    if fit and options["budget"] < per_point * max(options["first"], 1):
        reader.error("fit.first" if options["first"] else "fit.budget", f"needs more runs than the budget of {options['budget']}",
                     f"{per_point} runs for each point: the number of tests times seeds")
    for name, table in top["test"].items():
        if not (isinstance(table, dict) and table.get("measured")) and (fit or not options["numbers"]):
            reader.error(f"test.{name}", "has nothing measured", f"[[test.{name}.measured]]" + "; [sensitivity] numbers" * (not fit))
    if fit and not problem.fitted and not reader.found:
        reader.error("test", "has nothing measured to fit", "[[test.NAME.measured]] with use = \"fit\"")
    if check_scenarios:
        _check_scenarios(reader, problem)
    if reader.found:
        raise Mistakes(reader.found)
    return problem


def _check_scenarios(reader, problem):
    """What the program says of every scenario with its parameters at both bounds, and of every number that it would not have."""
    def said(test, u, *more):
        with tempfile.TemporaryDirectory() as folder:
            command = [knap.program(), "sweep", test.scenario, "--print-commands", "-q", "-o", folder]
            for key, value in [*problem.set_of(test, [u] * len(problem.parameters)).items(), *more]:
                command += ["-s", f"{key}={value}"]
            done = subprocess.run(command, capture_output=True, text=True)
        return done.stderr.strip() if done.returncode else ""

    for test in (test for test in problem.tests if test.scenario):
        if wrong := next(((side, text) for side, u in (("lower", 0.0), ("upper", 1.0)) if (text := said(test, u))), None):
            reader.error(f"test.{test.name}", "with all parameters at their {} bounds:\n{}".format(*wrong))
            continue
        for m in (m for m in test.measured if m.x is None and m.unit is not None):
            text = said(test, 0.0, ("expect", f'{{ {m.name} = {{ below = "1 {m.unit}" }} }}' if m.unit else f"{{ {m.name} = {{ below = 1 }} }}"))
            if text.startswith("error[nothing-to-expect]"):
                reader.error(m.path, f"= {m.name!r} is no number of {test.scenario}: {text.splitlines()[0].split('` ', 1)[-1]}")
