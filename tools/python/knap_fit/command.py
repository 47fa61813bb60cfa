"""The command lines knap-fit and knap-sensitivity."""
import argparse
import contextlib
import os
import pathlib
import signal
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: sums of several threads have other last bits

from . import need  # noqa: E402

need(pathlib.Path(sys.argv[0]).name or "knap-fit", "numpy")
import knap  # noqa: E402

from . import problem as files  # noqa: E402
from .runs import Commands, Runs, Stop  # noqa: E402


def _main(program, folder, description, work, arguments):
    """Exit codes are those of knap: 2 for a mistake in FILE, 3 where the runs or the data give no answer, 4 where a
    parameter does not lie where FILE expects it, 130 after Ctrl-C, SIGTERM and SIGHUP."""
    parser = argparse.ArgumentParser(prog=program, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     description=description + "\nThe same command goes on where it was stopped.")
    parser.add_argument("file", metavar="FILE", help="a TOML file; the guide (scenarios/README.md) shows one")
    parser.add_argument("-o", "--output", type=pathlib.Path, help=f"directory; default {folder}/NAME")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="runs at the same time, with one thread each")
    parser.add_argument("--force", action="store_true", help="begin anew where other runs are")
    parser.add_argument("--print-commands", action="store_true",
                        help="run nothing, print on stdout nothing but a command line for each run that comes next; "
                             "after them the same command again goes on; none: there is no further run")
    parser.add_argument("-q", "--quiet", action="store_true", help="no line for every round")
    parser.add_argument("--keys", action="version", version=files.markdown().rstrip(), help="print all keys of FILE")
    options = parser.parse_args(arguments)
    for one in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.default_int_handler)
    stdout, code, said = sys.stdout, 0, None
    try:
        # a shell reads the command lines
        with contextlib.redirect_stdout(sys.stderr if options.print_commands else sys.stdout):
            is_fit = program == "knap-fit"
            found = files.read(options.file, fit=is_fit)
            runs = Runs(found, options.output or pathlib.Path(folder) / found.name, max(options.jobs, 1),
                        options.print_commands, options.force, is_fit and found.options["method"] == "posterior")
            code = 0 if work(found, runs, lambda text: options.quiet or print(text, flush=True)) else 4
    except Commands as lines:
        print(lines, file=stdout)
    except files.Mistakes as mistakes:
        code, said = 2, mistakes
    except (OSError, Stop, knap.KnapError) as error:
        code, said = 2 if isinstance(error, OSError) else 3, f"error: {error}"
    except KeyboardInterrupt:
        code, said = 130, "interrupted: the same command goes on"
    sys.exit(print(said, file=sys.stderr) or code if said else code)


def fit(arguments=None):
    """knap-fit"""
    def work(found, runs, log):
        from . import inference, report
        if found.options["method"] == "posterior":
            return report.write(inference.Fit(found, runs, log).run())
        return report.write_least_squares(found, runs, *inference.least_squares(found, runs, log))

    _main("knap-fit", "fits", """Finds parameters of scenarios from measurements, with intervals. FILE names scenarios,
free keys with bounds, and what was measured. The directory gets points.csv, parameters.csv, posterior.csv (which
[sweep.random] file draws from; posterior_TEST.csv where tests have keys of their own), residuals.csv, predictions.csv,
further_tests.csv, convergence.csv, parameters.tex and report.html.""", work, arguments)


def sensitivity(arguments=None):
    """knap-sensitivity"""
    def work(found, runs, log):
        from . import sensitivity as part
        return part.write(found, runs)

    _main("knap-sensitivity", "sensitivities", """Which parameters the numbers of a run depend on. FILE is one of
knap-fit; [sensitivity] numbers names numbers of the summary of all its tests. Effects of single steps by Morris, from
trajectories of runs; parts of the variance by Sobol, from an emulator of the same runs.""", work, arguments)
