"""Reads a FILE of knap-fit. All its mistakes are reported at once, with the line, the key and what is allowed."""
import difflib
import functools
import pathlib
import re
import subprocess
import tomllib

import numpy as np

import knap


class Mistakes(Exception):
    """What is wrong in FILE, a text for each."""

    def __str__(self):
        number = len(self.args[0])
        return "\n".join(self.args[0]) + f"\n{number} error{'s' * (number > 1)}, nothing was run."


_prefixes = {"": 1, "G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}


def factor(unit, of):
    """Value of one `unit` in the unit `of`, as 1e6 of MPa in Pa; None where they are not of one kind."""
    if unit == of or not unit:
        return 1.0
    if unit == "%" and not of:
        return 0.01
    parts, of_parts = unit.split("/"), of.split("/")
    if len(parts) != len(of_parts):
        return None
    result = 1.0
    for k, (part, base) in enumerate(zip(parts, of_parts)):
        power = int(base[-1]) if base[-1:] in ("2", "3") else 1
        found = [value for prefix, value in _prefixes.items() if part == prefix + base]
        if not found:
            return None
        result *= (found[0] ** power) ** (-1 if k else 1)
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
        if self.log:
            return self.low * (self.high / self.low) ** u
        return self.low + (self.high - self.low) * u

    def place(self, value):
        if self.log:
            return np.log(value / self.low) / np.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def log_prior(self, u):
        """Uniform in u between the bounds; with `normal` also of the value, by its mean and standard deviation."""
        inside = np.where((u >= 0) & (u <= 1), 0.0, -np.inf)
        return inside - (0.5 * ((self.value(np.clip(u, 0, 1)) - self.normal[0]) / self.normal[1]) ** 2 if self.normal else 0)

    def text(self, u):
        return f"{self.value(u):.6g} {self.unit}".strip()


class Measured:
    """What a test gave: a number of the summary, or a curve over `x`. `use`: fit; predict (left out); candidate (a test
    that was not done: would it tell more?). `values`: SI, those of a curve at the places x. `scatter`: standard deviation
    of one specimen, None: that of seeds. `n`: number of specimens of which `values` is the mean."""

    def __init__(self, test, name, use, values, scatter, n=1, x=None, columns=None, factors=(1, 1), unit="", x_unit=""):
        self.test, self.name, self.use, self.values, self.scatter, self.n = test, name, use, values, scatter, n
        self.x, self.columns, self.factors, self.unit, self.x_unit = x, columns, factors, unit, x_unit
        self.part = 0.0  # scatter of a candidate over its value, which is not known yet

    @property
    def title(self):
        return f"{self.test.name}: {self.name}"

    @property
    def size(self):
        return 1 if self.x is None else len(self.x)

    @property
    def level(self):
        """The size of its values, to which parts refer."""
        return float(np.abs(self.values).max()) if self.values is not None and self.size else 1.0

    def of(self, run):
        """Its values in a run; nan where the run has none. A curve takes, of every x, the first time that it is reached."""
        if self.x is None:
            value = run.summary[self.name] if self.name in run.summary else np.nan
            return np.array([np.nan if value is None else float(value)])
        (table, x), (other, y) = self.columns
        table, other = run.table(table), run.table(other)
        if x not in table or y not in other:
            raise knap.KnapError(f"{run.directory} has no column {x if x not in table else y}; there are: {', '.join(other)}")
        x, y = self.factors[0] * table[x], self.factors[1] * other[y]
        if len(x) != len(y):
            x = np.interp(other["time"], table["time"], x)
        keep = np.isfinite(x) & np.isfinite(y)
        x, y = x[keep], y[keep]
        first = np.concatenate([[True], x[1:] > np.maximum.accumulate(x)[:-1]]) if len(x) else []
        if not len(x):
            return np.full(self.size, np.nan)
        return np.interp(self.x, x[first], y[first], left=np.nan, right=np.nan)


class Test:
    def __init__(self, name, scenario, set, seeds, first_seed):
        self.name, self.scenario, self.set, self.seeds, self.first_seed = name, scenario, set, seeds, first_seed
        self.measured = []


class Problem:
    """What FILE asks for: `parameters`, `tests`, `options` of [fit]."""

    def __init__(self, name, parameters, tests, options):
        self.name, self.parameters, self.tests, self.options = name, parameters, tests, {**defaults, **options}

    @property
    def measured(self):
        return [measured for test in self.tests for measured in test.measured]

    def values(self, u):
        return np.array([parameter.value(x) for parameter, x in zip(self.parameters, np.transpose(u))]).T

    def set_of(self, test, u):
        """KEY=VALUE of a run of a test."""
        found = dict(test.set)
        for parameter, x in zip(self.parameters, u):
            for key in parameter.keys:
                of, _, plain = key.rpartition(":")
                if of in ("", test.name):
                    found[plain] = parameter.text(x)
        return found


defaults = {"budget": 60, "seeds": 1, "first": 0, "method": "posterior", "model_error": "auto", "interval": 90, "shrink": 0.03,
            "draws": 2000, "seed": 1, "design": "adaptive"}
_allowed = {
    "": ["knap_fit", "name", "fit", "parameter", "test", "sensitivity", "expect"],
    "fit": [*defaults],
    "sensitivity": ["numbers", "trajectories"],
    "parameter": ["key", "keys", "bounds", "scale", "normal", "start"],
    "test": ["scenario", "set", "seeds", "seed", "measured"],
    "measured": ["number", "values", "scatter", "curve", "points", "units", "x", "y", "factors", "use", "n"],
}


@functools.cache
def _outputs():
    """{table: {name: unit}} of all outputs of the program; a name may begin with *."""
    text = subprocess.run([knap.program(), "schema", "--outputs"], capture_output=True, text=True, check=True).stdout
    tables, rows = {}, {}
    for line in text.splitlines():
        if line.startswith("## "):
            rows = tables.setdefault(line[3:].strip().removesuffix(".csv"), {})
        elif match := re.match(r"\| `([^`]+)` \| ([^|]*) \|", line):
            rows[match[1]] = match[2].strip()
    return tables


def unit_of(table, name):
    """Unit of an output of the program; None where it has none of this name."""
    rows = _outputs().get(table, {})
    for pattern, unit in rows.items():
        if name == pattern or (pattern.startswith("*") and name.endswith(pattern[1:]) and len(name) >= len(pattern)):
            return unit
    return None


class _Reader:
    def __init__(self, file):
        self.file, self.found = pathlib.Path(file), []
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

    def error(self, path, text, allowed=""):
        place = path
        while place and place not in self.lines:
            place = place.rpartition(".")[0]
        number, line = self.lines.get(place, (1, ""))
        self.found.append(f"error: `{path}` {text}\n  --> {self.file}:{number}\n   | {line.strip()}"
                          + (f"\n   = allowed: {allowed}" if allowed else ""))

    def keys(self, table, kind, path):
        """Whether a value is a table; unknown keys in it are mistakes."""
        if not isinstance(table, dict):
            self.error(path, "is not a table")
            return False
        for key in table:
            if key not in _allowed[kind]:
                near = difflib.get_close_matches(key, _allowed[kind], 1)
                self.error(f"{path}.{key}".lstrip("."), "is not a key" + (f"; did you mean `{near[0]}`?" if near else ""),
                           ", ".join(_allowed[kind]))
        return True

    def number(self, table, key, path, default=None, low=-np.inf, high=np.inf, whole=False):
        """A number or a percentage in a range."""
        if key not in table:
            return default
        found = quantity(table[key])
        value = found and factor(found[1], "")
        if value is None or not low <= found[0] * value <= high or (whole and found[0] != int(found[0])):
            self.error(f"{path}.{key}", f"= {table[key]!r} is not allowed",
                       f"{'a whole number' if whole else 'a number'} from {low:g} to {high:g}")
            return default
        return int(found[0]) if whole else found[0] * value

    def quantities(self, values, path, n=None):
        """Numbers with one unit: (array, unit); None after an error."""
        found = [quantity(value) for value in values] if isinstance(values, list) else [None]
        if None in found or not found or (n and len(found) != n):
            self.error(path, f"= {values!r} is not allowed", f"{n or 'one or more'} numbers with their unit, as [\"1 MPa\", \"2 MPa\"]")
            return None
        if len({unit for _, unit in found}) > 1:
            self.error(path, "has values with different units", "one unit for all of them")
            return None
        return np.array([value for value, _ in found]), found[0][1]

    def parameter(self, name, table):
        path = f"parameter.{name}"
        if not self.keys(table, "parameter", path):
            return None
        keys = table.get("keys", [table["key"]] if "key" in table else None)
        if not isinstance(keys, list) or not keys or not all(isinstance(key, str) for key in keys):
            self.error(path, "needs the keys of the scenario that take its value", 'key = "interface.default.sigma_c"; keys = [...] '
                       'for several, "TEST:KEY" for those of one test')
            keys = []
        for of in {key.rpartition(":")[0] for key in keys} - {"", *self.root.get("test", {})}:
            self.error(f"{path}.keys", f"name the test {of!r}, which does not exist", ", ".join(self.root.get("test", {})))
        if "bounds" not in table:
            self.error(path, "has no `bounds`", 'bounds = ["2 MPa", "8 MPa"]')
            return None
        bounds = self.quantities(table["bounds"], f"{path}.bounds", 2)
        if bounds is None:
            return None
        (low, high), unit = bounds
        scale = table.get("scale", "linear")
        if scale not in ("linear", "log"):
            self.error(f"{path}.scale", f"= {scale!r} is not allowed", '"linear", "log"')
        if not low < high or (scale == "log" and low <= 0):
            self.error(f"{path}.bounds", "must ascend" + (", from above 0 on with a log scale" if scale == "log" else ""))
            return None
        found = Parameter(name, keys, (low, high), unit, scale == "log")
        normal = self.quantities(table["normal"], f"{path}.normal", 2) if "normal" in table else None
        start = self.quantities([table["start"]], f"{path}.start", 1) if "start" in table else None
        for key, given in (("normal", normal), ("start", start)):
            if given is not None and given[1] != unit:
                self.error(f"{path}.{key}", f"is in {given[1] or 'no unit'}", f"the unit of the bounds, {unit or 'none'}")
        if normal is not None:
            found.normal = normal[0]
            if not normal[0][1] > 0:
                self.error(f"{path}.normal", "has a standard deviation that is not positive")
        if start is not None:
            found.start = float(start[0][0])
            if not low <= found.start <= high:
                self.error(f"{path}.start", "lies outside of the bounds", f"{low:g} to {high:g} {unit}")
        return found

    def test(self, name, table, seeds):
        path = f"test.{name}"
        if not self.keys(table, "test", path):
            return None
        scenario, values = table.get("scenario"), table.get("set", {})
        if not isinstance(scenario, str):
            self.error(f"{path}.scenario", "must name a scenario", "a file, relative to this one, or the name of a built-in scenario")
            scenario = ""
        elif (self.file.parent / scenario).exists():
            scenario = str((self.file.parent / scenario).resolve())
        elif scenario.endswith(".toml"):
            self.error(f"{path}.scenario", f"= {scenario!r} does not exist", "a file, relative to this one, or the name of a built-in scenario")
        if not isinstance(values, dict):
            self.error(f"{path}.set", "is not a table", 'set = { "mesh.size" = "1 mm" }')
            values = {}
        test = Test(name, scenario, {key: value if isinstance(value, str) else knap._toml(value) for key, value in values.items()},
                    self.number(table, "seeds", path, seeds, 1, 1000, True), self.number(table, "seed", path, 1, 0, 2**31, True))
        entries = table.get("measured", [])
        for i, entry in enumerate(entries if isinstance(entries, list) else [entries]):
            if self.keys(entry, "measured", f"{path}.measured[{i}]"):
                self.measured(test, entry, f"{path}.measured[{i}]")
        return test

    def measured(self, test, table, path):
        use = table.get("use", "fit")
        if use not in ("fit", "predict", "candidate"):
            self.error(f"{path}.use", f"= {use!r} is not allowed", '"fit", "predict" (left out), "candidate" (a test that was not done)')
        n = self.number(table, "n", path, None, 1, 1e6, True)
        kinds = [key for key in ("number", "curve", "points") if key in table]
        if len(kinds) != 1:
            self.error(path, "needs exactly one of number, curve, points", "number: of the summary; curve: a csv file; points: [[x, y], ...]")
            return
        found = (self.one_number if kinds[0] == "number" else self.curve)(test, table, path, use)
        if found is None:
            return
        found.n = n or (len(table["values"]) if kinds[0] == "number" and isinstance(table.get("values"), list) else 1)
        scatter = quantity(table["scatter"]) if "scatter" in table else None
        if found.values is None and scatter is not None and scatter[1] == "%":
            found.part, scatter = scatter[0] / 100, None
        elif scatter is not None:
            value = found.level * scatter[0] / 100 if scatter[1] == "%" else scatter[0] * (factor(scatter[1], found.unit) or np.nan)
            found.scatter = value
        if "scatter" in table and not found.part and (scatter is None or not (found.scatter or 0) >= 0 or not np.isfinite(found.scatter)):
            self.error(f"{path}.scatter", f"= {table['scatter']!r} is not allowed", f"a standard deviation in {found.unit or 'no unit'} or in %")
        if any(other.name == found.name for other in test.measured):
            self.error(path, f"is the second one of {found.name} in this test", "values = [...] of several specimens; another test")
        test.measured.append(found)

    def one_number(self, test, table, path, use):
        name = table["number"]
        unit = unit_of("summary", name) if isinstance(name, str) else None
        if unit is None:
            near = difflib.get_close_matches(str(name), _outputs()["summary"], 3)
            self.error(f"{path}.number", f"= {name!r} is not a number of the summary", ", ".join(near) or "see scenarios/OUTPUTS.md")
            return None
        found = Measured(test, name, use, None, None, unit=unit)
        if use == "candidate" and "values" not in table:
            return found
        given = self.quantities(table.get("values"), f"{path}.values")
        if given is None:
            return None
        if (scale := factor(given[1], unit)) is None:
            self.error(f"{path}.values", f"are in {given[1]}", f"a unit of {name}: {unit or 'none'}")
            return None
        values = given[0] * scale
        found.values = np.array([values.mean()])
        if len(values) > 2 and "scatter" not in table:  # of the specimens themselves
            found.scatter = float(values.std(ddof=1))
        return found

    def curve(self, test, table, path, use):
        columns, units = [], []
        for key in ("x", "y"):
            name, _, column = str(table.get(key, "")).partition(".")
            columns.append((name, column))
            units.append(unit_of(name, column))
            if units[-1] is None:
                known = [f"{name}.{row}" for row in _outputs().get(name, {})] or ["stress_strain.stress", "reactions.NAME_force_x"]
                self.error(f"{path}.{key}", f"= {table.get(key)!r} is not a column of a table of the run", ", ".join(known[:12]))
        factors = table.get("factors", [1, 1])
        if not (isinstance(factors, list) and len(factors) == 2 and all(isinstance(f, (int, float)) and f for f in factors)):
            self.error(f"{path}.factors", "are not allowed", "factors = [1, -1]: of the x and the y of the run")
            factors = [1, 1]
        given = table.get("units", ["", ""])
        if "curve" in table:
            file = self.file.parent / str(table["curve"])
            try:
                points = knap.read_csv(file)
                given = [points.units[name] or unit for name, unit in zip(points, given)]
                points = np.array(list(points.values())[:2], float).T
            except (OSError, ValueError, KeyError, StopIteration, AttributeError) as error:
                self.error(f"{path}.curve", f"= {table['curve']!r} cannot be read: {error}", "a csv file of two columns, `x [UNIT],y [UNIT]` in its first line")
                return None
        else:
            try:
                points = np.array(table["points"], float)
            except (TypeError, ValueError):
                points = np.zeros((0, 0))
        if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 2 or not np.isfinite(points).all() or not (np.diff(points[:, 0]) > 0).all():
            self.error(f"{path}.{'curve' if 'curve' in table else 'points'}", "are not allowed", "two or more pairs of numbers [x, y], x ascending")
            return None
        if None in units:
            return None
        for column in range(2):
            if (scale := factor(given[column], units[column])) is None:
                self.error(f"{path}.units", f"= {given!r}: {given[column]} is not allowed", f"a unit of {table['xy'[column] if 'xy'[column] in table else 'x']}: {units[column]}")
                return None
            points[:, column] *= scale
        return Measured(test, columns[1][1], use, points[:, 1], None, x=points[:, 0], columns=columns, factors=factors, unit=units[1], x_unit=units[0])


def read(file, check_scenarios=True):
    """The Problem of a file; raises Mistakes."""
    reader = _Reader(file)
    root = reader.root
    reader.keys(root, "", "")
    if root.get("knap_fit") != 1:
        reader.error("knap_fit", "is the version of the file", "knap_fit = 1")
    for kind in ("parameter", "test", "expect"):
        if not isinstance(root.get(kind, {}), dict):
            reader.error(kind, "is not a table")
            root[kind] = {}
    options = root.get("fit", {})
    if not reader.keys(options, "fit", "fit"):
        options = {}
    found = {key: reader.number(options, key, "fit", defaults[key], low, high, whole) for key, low, high, whole in (
        ("budget", 1, 1e6, True), ("seeds", 1, 1000, True), ("first", 0, 1e5, True), ("draws", 100, 1e5, True),
        ("seed", 0, 2**31, True), ("shrink", 0, 1, False), ("interval", 0.5, 0.999, False)) if key in options}
    if "interval" in found:
        found["interval"] *= 100
    for key, words in (("method", ["posterior", "least squares"]), ("design", ["adaptive", "random"])):
        found[key] = options.get(key, defaults[key])
        if found[key] not in words:
            reader.error(f"fit.{key}", f"= {found[key]!r} is not allowed", ", ".join(f'"{word}"' for word in words))
    found["model_error"] = options.get("model_error", "auto")
    if found["model_error"] not in ("auto", "none", "fitted"):
        reader.error("fit.model_error", f"= {found['model_error']!r} is not allowed", '"auto" (where the data need one), "none", "fitted"')
    parameters = [reader.parameter(*item) for item in root.get("parameter", {}).items()]
    tests = [reader.test(name, table, found.get("seeds", 1)) for name, table in root.get("test", {}).items()]
    if not parameters:
        reader.error("parameter", "is missing", '[parameter.NAME] with key and bounds')
    if not tests:
        reader.error("test", "is missing", "[test.NAME] with scenario and [[test.NAME.measured]]")
    expect = root.get("expect", {})
    found["expect"] = {}  # name: its value and the part or the value within which the mean of the posterior must lie
    for name, table in expect.items():
        of = next((p for p in parameters if p and p.name == name), None)
        value, within = (quantity(table.get(key)) for key in ("value", "within")) if isinstance(table, dict) else (None, None)
        if of is None or not value or not within or value[1] != of.unit or within[1] not in ("%", of.unit):
            reader.error(f"expect.{name}", "is not allowed", 'PARAMETER = { value = "2 MPa", within = "10 %" }, in the unit of its bounds')
        else:
            found["expect"][name] = (value[0], within[0] * value[0] / 100 if within[1] == "%" and of.unit != "%" else within[0])
    sensitivity = root.get("sensitivity", {})
    if reader.keys(sensitivity, "sensitivity", "sensitivity"):
        found["trajectories"] = reader.number(sensitivity, "trajectories", "sensitivity", 8, 2, 1000, True)
        found["numbers"] = sensitivity.get("numbers", [])
        for name in found["numbers"] if isinstance(found["numbers"], list) else [found["numbers"]]:
            if not isinstance(name, str) or unit_of("summary", name) is None:
                reader.error("sensitivity.numbers", f"{name!r} is not a number of the summary", "see scenarios/OUTPUTS.md")
    if all(parameters) and all(tests) and not any(m.use == "fit" for test in tests for m in test.measured) and not found.get("numbers"):
        reader.error("test", "has nothing measured to fit", "[[test.NAME.measured]]; [sensitivity] numbers for knap-sensitivity")
    problem = Problem(str(root.get("name", pathlib.Path(file).stem)), [p for p in parameters if p], [t for t in tests if t], found)
    if check_scenarios:
        _check_scenarios(reader, problem)
    if reader.found:
        raise Mistakes(reader.found)
    return problem


def _check_scenarios(reader, problem):
    """What the program says of every scenario with its parameters at both bounds."""
    for test in problem.tests:
        if not test.scenario:
            continue
        for u in (0.0, 1.0):
            command = [knap.program(), "sweep", test.scenario, "--print-commands", "-q", "--force", "-o", "/nonexistent/knap_fit"]
            for key, value in problem.set_of(test, [u] * len(problem.parameters)).items():
                command += ["-s", f"{key}={value}"]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                reader.error(f"test.{test.name}", f"with all parameters at their {'upper' if u else 'lower'} bounds:\n{done.stderr.strip()}")
                break
