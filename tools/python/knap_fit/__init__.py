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


def need(module, package, what):
    """A library that only a part needs; without it the program names the Debian package and ends with exit code 2."""
    try:
        return __import__(module, fromlist=["*"])
    except ImportError:
        print(f"error: {what} needs {module}: apt install {package}", file=sys.stderr)
        raise SystemExit(2) from None
