"""The command lines knap-fit and knap-sensitivity."""
import argparse
import os
import pathlib
import sys

import knap

from . import problem as files
from .runs import Runs, Stop


def _options(program, description, folder):
    parser = argparse.ArgumentParser(prog=program, description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", metavar="FILE", help="a TOML file; the guide (scenarios/README.md) shows one")
    parser.add_argument("-o", "--output", type=pathlib.Path, help=f"directory; default {folder}/NAME")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="runs at the same time, with one thread each")
    parser.add_argument("--force", action="store_true", help="begin anew where other runs are")
    parser.add_argument("--print-commands", action="store_true",
                        help="run nothing, print a command line for each run that comes next; after them the same command again goes on")
    parser.add_argument("-q", "--quiet", action="store_true", help="no line for every round")
    return parser


def _within_errors(work):
    """Exit codes are those of knap: 2 for a mistake in FILE, 3 where the runs or the data give no answer, 4 where a value of [expect] is missed."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices of a hundred rows
    try:
        work()
    except files.Mistakes as mistakes:
        print(mistakes, file=sys.stderr)
        sys.exit(2)
    except (Stop, knap.KnapError) as stop:
        print(stop, file=sys.stderr)
        sys.exit(3)
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("interrupted: the same command goes on", file=sys.stderr)
        sys.exit(130)


def _start(options, folder):
    found = files.read(options.file)
    directory = options.output or pathlib.Path(folder) / found.name
    return found, Runs(found, directory, options.jobs, options.print_commands, options.force,
                       own_seeds=folder == "fits" and found.options["method"] == "posterior")


def fit(arguments=None):
    """knap-fit"""
    parser = _options("knap-fit", """Finds parameters of scenarios from measurements, with intervals. FILE names scenarios, free keys with
bounds, and what was measured. The directory gets points.csv, parameters.csv, posterior.csv (which [sweep.random] file draws
from), residuals.csv, predictions.csv, parameters.tex and report.html. The same command goes on where it was stopped.""", "fits")
    options = parser.parse_args(arguments)

    def work():
        from . import inference, report
        found, runs = _start(options, "fits")
        log = (lambda text: None) if options.quiet else (lambda text: print(text, flush=True, file=sys.stderr if options.print_commands else None))
        try:
            if found.options["method"] == "least squares":
                u, residuals = inference.least_squares(found, runs, log)
                report.write_least_squares(found, runs, u, residuals)
            else:
                if not report.write(inference.Fit(found, runs, log).run()):
                    sys.exit(4)
        except Stop as stop:
            if not options.print_commands:
                raise
            print(stop)

    _within_errors(work)


def sensitivity(arguments=None):
    """knap-sensitivity"""
    parser = _options("knap-sensitivity", """Which parameters the numbers of a run depend on. FILE is one of knap-fit, [sensitivity] numbers names
numbers of the summary of all its tests. Effects of single steps by Morris, from trajectories of runs; parts of the variance by
Sobol, from an emulator of the same runs.""", "sensitivities")
    options = parser.parse_args(arguments)

    def work():
        from . import sensitivity as part
        found, runs = _start(options, "sensitivities")
        try:
            part.write(found, runs)
        except Stop as stop:
            if not options.print_commands:
                raise
            print(stop)

    _within_errors(work)
