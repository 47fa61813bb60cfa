"""Reads a FILE of knap-fit. All its mistakes are reported at once, with line, key and what is allowed (keys.toml)."""
import csv
import difflib
import functools
import itertools
import pathlib
import re
import subprocess
import tempfile

import numpy as np

import knap

from . import need

tomllib = need("a FILE", "tomllib")
keys = tomllib.loads((pathlib.Path(__file__).parent / "keys.toml").read_text(encoding="utf-8"))
prose = keys.pop("prose")
heads = {"top": "At the top", "parameter": "[parameter.NAME]", "test": "[test.NAME]",
         "measured": "[[test.NAME.measured]]"}
defaults = {name: key["default"] for name, key in keys["fit"].items() if "default" in key}


class Mistakes(Exception):
    """What is wrong in FILE, a text for each, and what was run."""

    def __init__(self, texts, ran="nothing was run"):
        super().__init__("\n".join(texts) + f"\n{len(texts)} error{'s' * (len(texts) > 1)}, {ran}.")


def mistake(text, where, remedy=""):
    return f"error: {text}\n  --> {where}" + f"\n   = allowed: {remedy}" * bool(remedy)


class Parameter:
    """A free parameter: u in [0, 1] stands for its value between two bounds, in their unit."""

    def __init__(self, name, keys, bounds, unit, log, normal=None, start=None, expect=None):
        self.name, self.keys, self.unit, self.log, self.normal, self.start = name, keys, unit, log, normal, start
        (self.low, self.high), self.expect = bounds, expect

    def value(self, u):
        return self.low * (self.high / self.low) ** u if self.log else self.low + (self.high - self.low) * u

    def place(self, value):
        scale = np.log if self.log else np.asarray
        return (scale(value) - scale(self.low)) / (scale(self.high) - scale(self.low))

    def log_prior(self, u):
        """Uniform in u between the bounds; with `normal` also of the value, by its mean and standard deviation."""
        inside = np.where((u >= 0) & (u <= 1), 0.0, -np.inf)
        mean, deviation = (0.0, np.inf) if self.normal is None else self.normal
        return inside - 0.5 * ((self.value(np.clip(u, 0, 1)) - mean) / deviation) ** 2

    def deviation(self, function):
        """Standard deviation of a function of its value, before the data."""
        grid = np.linspace(0.0005, 0.9995, 1000)
        return np.sqrt(np.cov(function(self.value(grid)), aweights=np.exp(self.log_prior(grid)), ddof=0))

    def text(self, u):
        return f"{self.value(u):.6g} {self.unit}".strip()


def label(name, unit):
    return f"{name} [{unit}]" if unit else name


class Measured:
    """What a test gave: a number of the summary, or a curve over `x`; of `places` of a curve also its largest value or
    the area below it, which are numbers. `use`: fit; predict (left out); candidate (a test that was not done: would it
    tell more?). `scatter`: standard deviation of one specimen, None: that of seeds. `n`: number of specimens of which
    `values` is the mean. What a run has is multiplied by `factors` and, since all this has the units of FILE, divided
    by `scales`."""

    def __init__(self, test, name, use, values, scatter, n=1, x=None, columns=None, factors=(1, 1), unit="", x_unit=""):
        self.test, self.name, self.use, self.values, self.scatter, self.n = test, name, use, values, scatter, n
        self.x, self.columns, self.factors, self.scales = x, columns, factors, (1, 1)
        self.unit, self.x_unit, self.places, self.curve, self.take = unit, x_unit, x, values, "all"
        self.noise = 0.0  # standard deviation of each point by itself
        self.freedom, self.interval = np.inf, 0.9  # degrees of freedom of the scatter, which few specimens tell
        self.stretch = ""  # which part of a curve, in words
        self.part = 0.0  # scatter of a candidate over its value, which is not known yet
        self.where = test and test.name  # file and line

    @property
    def title(self):
        use = {"fit": "", "predict": " (left out)", "candidate": " (not measured)"}[self.use]
        of = {"all": "", "largest": "largest ", "area": "area below "}[self.take]
        return f"{self.test.name}: {of}{self.name}{self.stretch}{use}"

    @property
    def size(self):
        return 1 if self.x is None else len(self.x)

    @property
    def level(self):
        """The size of its values, to which parts refer."""
        return float(np.abs(self.values).max()) if self.values is not None else 1.0

    @functools.cache
    def of(self, run):
        """Its values in a run; nan where the run has none."""
        if self.places is None:
            value = run.summary.get(self.name)
            return np.array([np.nan if value is None else float(value)]) / self.scales[-1]
        return self.taken(*self.course(run))

    def course(self, run):
        """x and y of the curve that a run has."""
        _, *curve = knap.course(run, *self.columns)
        return [factor * values / scale for factor, scale, values in zip(self.factors, self.scales, curve)]

    def taken(self, x, y):
        """Of a curve what is measured. The area has the same places for both, and with them the same error."""
        found, inside = _first(x, y, self.places), (x >= self.places[0]) & (x <= self.places[-1])
        if self.take == "all":
            return found
        is_whole = np.isfinite(found).all()
        return np.array([np.nan if not is_whole else np.trapz(found, self.places) if self.take == "area"
                         else y[inside].max()])

    def mistake(self, run):
        """(what the first run shows of FILE, what is allowed): it lies on the other side of zero where a sign was
        forgotten; it reaches the end of its time before the end of the curve. None: nothing."""
        x, y = self.course(run)
        if not len(x):
            return None
        agree = {signs: (_first(signs[0] * x, signs[1] * y, self.places) * self.curve > 0).sum()
                 for signs in itertools.product((1, -1), repeat=2)}
        signs, ends = max(agree, key=agree.get), self.places[[0, -1]]
        if agree[signs] > 1 and not agree[1, 1]:
            remedy = [float(sign * old) for sign, old in zip(signs, self.factors)]
            return "the first run has its curve on the other side of zero", f"factors = {remedy}"
        if not x.min() <= ends[0] < ends[1] <= x.max() and run.reached_end:
            of_run, of_data = (f"from {a:.4g} to {b:.4g} {self.x_unit}" for a, b in ((x.min(), x.max()), ends))
            return (f"the first run has its curve {of_run}, what was measured goes {of_data}",
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

    def __init__(self, name, parameters, tests, options, file=None):
        self.name, self.parameters, self.tests, self.file = name, parameters, tests, file
        self.options = {**defaults, **options}

    @property
    def measured(self):
        return [measured for test in self.tests for measured in test.measured]

    @property
    def fitted(self):
        return [measured for measured in self.measured if measured.use == "fit"]

    def check_first(self, runs):
        """Mistakes of FILE that the first run of each test shows."""
        curves = [m for m in self.measured if m.places is not None]
        found = [(m, m.mistake(run)) for m in curves for run in runs.answers(m.test)[:1] if run]
        if texts := [mistake(f"{m.title}: {wrong[0]}", m.where, wrong[1]) for m, wrong in found if wrong]:
            raise Mistakes(texts, "the first run was done")

    def values(self, u):
        return np.array([parameter.value(x) for parameter, x in zip(self.parameters, np.transpose(u))]).T

    def rounded(self, u):
        """The values that a run gets, a tuple."""
        return tuple(float(f"{value:.6g}") for value in self.values(u))

    def keys_of(self, *tests):
        """{key of the scenarios of these tests: number of the parameter that sets it}; TEST:KEY where several
        parameters do, each in a test of its own."""
        names = ("", *(test.name for test in tests))
        keys = [(*key.rpartition(":"), i) for i, p in enumerate(self.parameters) for key in p.keys]
        keys = [(of, plain, i) for of, _, plain, i in keys if of in names]
        owners = {plain: {i for _, other, i in keys if other == plain} for _, plain, _ in keys}
        return {plain if len(owners[plain]) == 1 else f"{of}:{plain}": i for of, plain, i in keys}

    def set_of(self, test, u):
        """KEY=VALUE of a run of a test."""
        return {**test.set, **{key: self.parameters[i].text(u[i]) for key, i in self.keys_of(test).items()}}


def allowed(key):
    """What a key of keys.toml may be, in words."""
    if "allowed" in key:
        return key["allowed"]
    if "range" in key:
        kind = "a whole number" if key["kind"] == "whole" else "a number or a percentage"
        return f"{kind} from {key['range'][0]:g} to {key['range'][1]:g}"
    return ", ".join(f'"{word}"' for word in key["kind"])


def markdown():
    """scenarios/FIT_KEYS.md"""
    lines = [prose.rstrip()]
    for kind, rows in keys.items():
        lines += ["", f"## {heads.get(kind, f'[{kind}]')}", ""]
        lines += ["| key | value | default | meaning |", "|---|---|---|---|"]
        for name, key in rows.items():
            default = "required" if key.get("required") else key.get("standard", key.get("default"))
            default = default if default or default == 0 else ""
            lines.append(f"| `{name}` | {allowed(key)} | {default} | {key['meaning']} |")
    return "\n".join(lines) + "\n"


def _one(key, given):
    """A value in the form that the program uses; None where it is not allowed."""
    kind = key["kind"]
    if kind == "quantity":
        return knap.quantity(given)
    if kind in ("whole", "number"):
        value, unit = knap.quantity(given) or (np.nan, "")
        value *= knap.factor(unit, "") or np.nan
        is_allowed = key["range"][0] <= value <= key["range"][1] and (kind == "number" or value == int(value))
        return None if not is_allowed else value if kind == "number" else int(value)
    is_allowed = given in kind if isinstance(kind, list) else isinstance(given, {"text": str, "table": dict}[kind])
    return given if is_allowed else None


def _checked(key, given):
    """The same of a key that may have many values: quantities become an array and their unit."""
    if not key.get("many"):
        return _one(key, given)
    found = [_one(key, item) for item in (given if isinstance(given, list) else [given])]
    if not found or None in found or key.get("count", len(found)) != len(found):
        return None
    if key["kind"] != "quantity":
        return found
    values, units = zip(*found)
    return (np.array(values), units[0]) if len(set(units)) == 1 else None


class _Reader:
    def __init__(self, file):
        self.file, self.found, self.options = pathlib.Path(file), [], {}
        self.owners = {}  # the parameter that sets a key of a test
        text = self.file.read_text(encoding="utf-8")
        try:
            self.root = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise Mistakes([mistake(error, file)]) from None
        self.lines = {path.replace('"', ""): place for *place, path, _ in reversed([*knap.toml_lines(text)])}

    def line(self, path):
        """Number and text of the line of a key, or of the table that would have it."""
        while path and path not in self.lines:
            path = path.rpartition(".")[0]
        return self.lines.get(path, (1, ""))

    def error(self, path, text, remedy=""):
        number, line = self.line(path.lstrip("."))
        self.found.append(mistake(f"`{path.lstrip('.')}` {text}", f"{self.file}:{number}\n   | {line.strip()}", remedy))

    def refuse(self, kind, name, path, given, more=""):
        """A mistake in the value of a key of a table; what was `given` has it."""
        self.error(f"{path}.{name}", f"= {given[name]!r} is not allowed", allowed(keys[kind][name]) + more)

    def table(self, given, kind, path):
        """{key: value} of a table, with defaults; a key that is not there and has none is None."""
        found, meant = {name: key.get("default") for name, key in keys[kind].items()}, set()
        if not isinstance(given, dict):
            self.error(path, "is not a table")
            return {**found, "given": keys[kind].keys()}
        for name in given:
            if name not in found:
                near = difflib.get_close_matches(name, found.keys() - given.keys(), 1)
                meant.update(near)
                hint = "".join(f"; did you mean `{key}`?" for key in near)
                hint += "".join(f"; {heads.get(other, f'[{other}]')} has it: {allowed(rows[name])}"
                                for other, rows in keys.items() if not near and name in rows)
                self.error(f"{path}.{name}", f"is not a key{hint}", ", ".join(found))
            elif (value := _checked(keys[kind][name], given[name])) is not None:
                found[name] = value
            else:
                self.refuse(kind, name, path, given)
        found["given"] = given.keys() | meant  # what is asked for again would be a second message of one mistake
        for name in (name for name, key in keys[kind].items() if key.get("required") and name not in found["given"]):
            self.error(path or name, f"has no `{name}`", allowed(keys[kind][name]))
        return found

    def unit(self, name, path):
        """SI unit of TABLE.COLUMN; None, and a mistake, where runs have none of this name."""
        table, _, column = name.partition(".")
        unit, known = knap.unit_of_output(table, column), knap.outputs_of(table)
        what, near = f"{name!r} is not a column of a table of the run", [f"{table}.{other}" for other in known][:12]
        if table == "summary":
            what, near = f"{column!r} is not a number of the summary", difflib.get_close_matches(column, known, 3)
        if unit is None:
            self.error(path, f"= {what}", ", ".join(near) or "see scenarios/OUTPUTS.md")
        return unit

    def parameter(self, name, given, tests):
        """A Parameter; one with a mistake sets no key, so that no scenario is asked about it."""
        path, n = f"parameter.{name}", len(self.found)
        table = self.table(given, "parameter", path)
        (low, high), unit = table["bounds"] or ((0.0, 1.0), "")
        normal, start, expect = (table[key] and table[key][0] for key in ("normal", "start", "expect"))
        found = Parameter(name, table["key"] or [], (low, high), unit, table["scale"] == "log", normal, start, expect)
        for key in found.keys:
            of, _, plain = key.rpartition(":")
            others = {self.owners.setdefault((test, plain), name) for test in ([of] if of else tests)} - {name}
            if of and of not in tests:
                self.error(f"{path}.key", f"names the test {of!r}, which does not exist", ", ".join(tests))
            elif others:
                self.error(f"{path}.key", f"has {key!r}, which the parameter {others.pop()} has, too",
                           "a key of one parameter alone")
        if table["bounds"] and (not low < high or (found.log and low <= 0)):
            self.refuse("parameter", "bounds", path, given)
        found.keys = found.keys if len(self.found) == n else []
        for key, is_good in (("normal", normal is None or low <= normal[0] <= high and normal[1] > 0),
                             ("start", start is None or low <= start <= high),
                             ("expect", expect is None or max(low, expect[0]) < min(high, expect[1]))):
            if found.keys and table[key] and not (table[key][1] == unit and is_good):
                self.refuse("parameter", key, path, given)
        return found

    def test(self, name, given):
        path = f"test.{name}"
        table = self.table(given, "test", path)
        scenario = table["scenario"] or ""
        if (self.file.parent / scenario).is_file():
            scenario = str((self.file.parent / scenario).resolve())
        elif scenario.endswith(".toml"):
            self.refuse("test", "scenario", path, given)
            scenario = ""
        values = {key: value if isinstance(value, str) else knap._toml(value) for key, value in table["set"].items()}
        test = Test(name, scenario, values, table["seeds"] or self.options["seeds"], table["seed"])
        for key, owner in ((key, self.owners.get((name, key))) for key in table["set"]):
            if owner:
                self.error(f"{path}.set", f"has {key!r}, which the parameter {owner} sets", "others of the scenario")
        for i, entry in enumerate(table["measured"]):
            self.measured(test, entry, f"{path}.measured[{i}]")
        test.is_empty = "measured" not in table["given"]
        return test

    def measured(self, test, given, path):
        n, table = len(self.found), self.table(given, "measured", path)
        kinds = [kind for kind in ("number", "curve") if kind in table["given"]]
        if len(kinds) != 1:
            self.error(path, "needs exactly one of number, curve")
        if len(kinds) != 1 or table[kinds[0]] is None:
            return
        is_curve, points, own = kinds == ["curve"], None, [""]
        for key in sorted(given.keys() & ({"values"} if is_curve else {"x", "y", "between", "take", "factors"})):
            self.error(f"{path}.{key}", f"is of a measurement with `{'number' if is_curve else 'curve'}`",
                       f"number or curve; this one has `{kinds[0]}`")
        if 0 in (table["factors"] or []):
            self.refuse("measured", "factors", path, given)
        names = {key: table[key] for key in "xy"} if is_curve else {"number": f"summary.{table['number']}"}
        units = [self.unit(name or "", f"{path}.{key}") for key, name in names.items()
                 if name or key not in table["given"]]
        if is_curve:
            points, own = self.csv(table["curve"], f"{path}.curve")
        elif "values" not in table["given"] and table["use"] != "candidate":
            self.error(path, "has no `values`", keys["measured"]["values"]["allowed"])
        elif table["values"]:
            points, own = table["values"][0].mean()[None, None], table["values"][1:]
        else:  # a candidate
            own = [table[key][1] for key in ("scatter", "noise") if table[key] and table[key][1] != "%"][:1] or [""]
        if len(self.found) > n:
            return
        scales, columns = [knap.factor(*pair) for pair in zip(own, units)], [*names.values()]
        if None in scales:
            of = [f"{name.removeprefix('summary.')}: {unit or 'none'}" for name, unit in zip(columns, units)]
            self.error(f"{path}.{'curve' if is_curve else 'values'}", f"has the unit {', '.join(own)}",
                       f"a unit of {', of '.join(of)}")
            return
        found = Measured(test, columns[-1].partition(".")[2], table["use"], None, None, columns=columns,
                         factors=table["factors"], unit=own[-1] or units[-1], x_unit=(own[0] or units[0]) * is_curve)
        found.where, found.path, found.scales = f"{self.file}:{self.line(path)[0]}", path, scales
        if is_curve:
            x, y = np.transpose(points)
            (low, high), unit = table["between"] or (x[[0, -1]], "")
            scale = (knap.factor(unit or own[0], units[0]) or np.nan) / scales[0]
            inside = (x >= low * scale) & (x <= high * scale)
            if inside.sum() < 2:
                self.refuse("measured", "between", path, given,
                            f"; the curve goes from {x[0]:g} to {x[-1]:g} {found.x_unit}")
                return
            found.places, found.curve, found.take = x[inside], y[inside], table["take"]
            found.values = found.taken(found.places, found.curve)
            found.x = found.places if found.take == "all" else None
            found.stretch = f" at {found.places[0]:g} to {found.places[-1]:g} {found.x_unit}" * bool(table["between"])
            found.unit += f" {found.x_unit}" * (found.take == "area")
        elif points is not None:
            found.values, found.n = points[0], len(table["values"][0])
            if found.n > 1 and not table["scatter"]:  # of the specimens themselves
                found.scatter, found.freedom = float(table["values"][0].std(ddof=1)), found.n - 1
        found.n, found.interval = table["n"] or found.n, self.options["interval"]
        for key in (key for key in ("scatter", "noise") if table[key]):
            value, unit = table[key]
            scale = (knap.factor(unit or own[-1], units[-1]) or np.nan) / scales[-1]
            scale = 0.01 * found.level if unit == "%" else scale
            if unit == "%" and not found.level > 0:
                self.error(f"{path}.{key}", "is a part of a measured 0", f"a {key} in {found.unit or 'no unit'}")
            elif not value * scale >= 0:
                self.refuse("measured", key, path, given)
            elif unit == "%" and found.values is None:
                found.part = float(np.hypot(found.part, value * scale))
            else:
                setattr(found, key, value * scale)
        if any(other.title == found.title for other in test.measured):
            self.error(path, f"is the second one of {found.name} in this test",
                       "values = [...] of several specimens; another test; another `use`")
        test.measured.append(found)

    def csv(self, name, path):
        """Points and units of a csv file; all its mistakes are one error with a line for each."""
        file, wrong, points, remedy = self.file.parent / name, [], [], keys["measured"]["curve"]["allowed"]
        try:
            head, *rows = csv.reader(file.read_text(encoding="utf-8-sig").splitlines() or [""])
        except (OSError, UnicodeDecodeError) as error:
            self.error(path, f"= {name!r} cannot be read: {getattr(error, 'strerror', None) or error}", remedy)
            return points, ()
        titles = [knap.name_and_unit(title) for title in head]
        if len(head) != 2 or any(knap.quantity(title) or (title.endswith(")") and not unit) for title, unit in titles):
            wrong.append(f"1: {','.join(head)!r} are not two names with units")
        for number, row in ((number, row) for number, row in enumerate(rows, 2) if row):
            numbers = [found[0] for found in map(knap.quantity, row) if found and not found[1]]
            if not len(numbers) == len(row) == 2:
                wrong.append(f"{number}: {','.join(row)!r} is not two numbers")
            elif points and numbers[0] <= points[-1][0]:
                wrong.append(f"{number}: x = {numbers[0]:g} is not larger than {points[-1][0]:g} before it")
            else:
                points.append(numbers)
        if wrong or len(points) < 2:
            wrong = wrong or [f"{len(rows) + 1}: it ends with fewer than two points"]
            lines = [f"\n  --> {file}:{text}" for text in wrong[:20]] + ["\n  ..."] * (len(wrong) > 20)
            self.error(path, f"= {name!r} has {len(wrong)} mistake{'s' * (len(wrong) > 1)}", remedy + "".join(lines))
        return points, [unit for _, unit in titles]


def read(file, check_scenarios=True, fit=True):
    """The Problem of a file; raises Mistakes. For a `fit` each test has something measured; knap-sensitivity can do
    with the names of numbers."""
    reader = _Reader(file)
    top, options = reader.table(reader.root, "top", ""), reader.options
    for name in ("fit", "sensitivity"):
        options.update(reader.table(top[name], name, name))
    parameters = [reader.parameter(name, table, top["test"]) for name, table in top["parameter"].items()]
    tests = [reader.test(name, table) for name, table in top["test"].items()]
    for name in options["numbers"]:
        reader.unit(f"summary.{name}", "sensitivity.numbers")
    for path, name in (("name", top["name"] or ""), *((f"test.{name}", name) for name in top["test"])):
        if re.search(r"/|^\.", name):
            reader.error(path, f"= {name!r} is no name of a directory", "a name without / that does not begin with .")
    problem = Problem(top["name"] or pathlib.Path(file).stem, parameters, tests, options, pathlib.Path(file))
    per_point = sum(test.seeds for test in tests)
    if fit and options["budget"] < per_point * max(options["first"], 1):
        reader.error("fit.first" if options["first"] else "fit.budget",
                     f"needs more runs than the budget of {options['budget']}",
                     f"{per_point} runs for each point: the number of tests times seeds")
    for test in tests:
        if fit and test.is_empty:
            reader.error(f"test.{test.name}", "has nothing measured", f"[[test.{test.name}.measured]]")
        if not (fit or reader.found or options["numbers"] or any(m.places is None for m in test.measured)):
            reader.error(f"test.{test.name}", "has no number", "[sensitivity] numbers; measured with `number`")
    if fit and not problem.fitted and not reader.found:
        reader.error("test", "has nothing measured to fit", "[[test.NAME.measured]] with use = \"fit\"")
    told = {}  # {(path, side, text, whether all tests have the key): names of tests of which the program says it}
    for test in (test for test in tests if check_scenarios and test.scenario):
        _check_scenario(reader, problem, test, told)
    for (path, side, text, is_shared), names in told.items():
        is_of_some = is_shared and len(names) < len(tests)
        where = f" of [test.{'], [test.'.join(names)}]" * is_of_some
        cure = '"TEST:key" for each test that has the key' * is_of_some
        reader.error(path, f"at the {side} bounds{where}: {text}", cure)
    if reader.found:
        raise Mistakes(list(dict.fromkeys(reader.found)))
    return problem


def _check_scenario(reader, problem, test, told):
    """What the program says of a scenario with its parameters at both bounds, and of every number and column that it
    would not have. Columns are those of a run of one step."""
    curves, numbers = ([m for m in test.measured if (m.places is None) == is_number] for is_number in (False, True))
    expect = ", ".join({m.name: f'{m.name} = {{ below = "1 {m.unit}" }}' for m in numbers}.values())

    def ask(u, *words, **values):
        values |= {**problem.set_of(test, [u] * len(problem.parameters)), "figure": "", "study": "", "sweep": ""}
        sets = [text for pair in values.items() for text in ("-s", "=".join(pair))]
        return subprocess.run([knap.program(), *words, test.scenario, "-q", *sets], capture_output=True, text=True)

    with tempfile.TemporaryDirectory() as folder:
        for side, u in (("lower", 0.0), ("upper", 1.0)):
            said = ask(u, "sweep", "--print-commands", "-o", folder, expect=f"{{ {expect} }}")
            last = {}
            for text in re.split(r"\n(?=error)", said.stderr.strip().rpartition("\n")[0]) if said.returncode else []:
                key = (re.search(r"--set ([^=\s]+)=", text) or ("", ""))[1]
                owner = reader.owners.get((test.name, key))
                is_key = re.search("error.(unknown|missing)", text)  # else its value is wrong
                path = f"parameter.{owner}.{'key' if is_key else 'bounds'}" if owner else f"test.{test.name}"
                path = next((f"{m.path}.number" for m in numbers if key == "expect" and m.name in text), path)
                last[path, key or text] = text  # what else the program says of a key follows from the same mistake
            for (path, key), text in last.items():
                is_shared = path.endswith(".key") and any(key in p.keys for p in problem.parameters)
                told.setdefault((path, side, text, is_shared), []).append(test.name)
            if said.returncode:
                return
        values = {"time.end": "1 ns", "expect": ""}
        if not curves or ask(0.0, "run", "-j", "1", "-o", f"{folder}/step", **values).returncode:
            return
        run = knap.Run(f"{folder}/step")
        for m, key, name in ((m, *pair) for m in curves for pair in zip("xy", m.columns)):
            table, column = name.split(".", 1)
            known = run.table(table) if table in run.tables else {}
            if column not in known:
                reader.error(f"{m.path}.{key}", f"= {name!r} is no column of {test.scenario}",
                             ", ".join(f"{table}.{name}" for name in known) or "tables: " + ", ".join(run.tables))
