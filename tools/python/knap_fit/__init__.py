"""Parameters from measurements: knap-fit and knap-sensitivity. The guide of knap (scenarios/README.md) shows a FILE.

    keys.toml  every key of FILE
    problem    reads FILE and reports all its mistakes
    runs       runs the scenarios at points of the parameters, and goes on where it was stopped
    emulator   what the runs show between these points, with its uncertainty, by Kriging
    inference  posterior of the parameters, which of them the data determine, predictions
    report     tables and report.html
    command    the command lines

All parameters are places in the unit cube, u = 0 and 1 at their bounds, linear or in the logarithm. Measured values are SI."""
import sys


def need(module, package, what, *more):
    """A library that only a part needs. Without it, or one of the pairs of `more`, the program names the Debian packages of all that
    are missing, and ends with exit code 2."""
    missing, found = [], None
    for name, of in ((module, package), *more):
        try:
            library = __import__(name, fromlist=["*"])
            found = found or library
        except ImportError as error:
            if not missing or (error.name or name).split(".")[0] == name.split(".")[0]:  # not that one library lacks another one
                missing.append((name, of))
    if missing:
        names, packages = zip(*missing)
        print(f"error: {what} needs {', '.join(names)}: apt install {' '.join(packages)}", file=sys.stderr)
        raise SystemExit(2)
    return found
