"""Parameters from measurements: knap-fit and knap-sensitivity. The guide of knap (scenarios/README.md) shows a FILE.

    keys.toml  every key of FILE
    problem    reads FILE and reports all its mistakes
    runs       runs the scenarios at points of the parameters, and goes on where it was stopped
    emulator   what the runs show between these points, with its uncertainty, by Kriging
    inference  posterior of the parameters, which of them the data determine, predictions
    report     tables and report.html
    notes.toml the sentences of a report
    command    the command lines

All parameters are places in the unit cube, u = 0 and 1 at their bounds, linear or in the logarithm. Measured values
have the units of FILE."""
import importlib.util
import sys


def need(what, *modules):
    """The first of some libraries that only a part needs. Where some are missing the program names the Debian packages
    of all of them, and ends with exit code 2."""
    missing = [name for name in modules if importlib.util.find_spec(name.split(".")[0]) is None]
    if missing:
        # tomllib is part of Python 3.11
        packages = ["python3" + f"-{name.split('.')[0]}" * (name != "tomllib") for name in missing]
        print(f"error: {what} needs {', '.join(missing)}: apt install {' '.join(packages)}", file=sys.stderr)
        raise SystemExit(2)
    return importlib.import_module(modules[0])
