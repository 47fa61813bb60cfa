"""The posterior of the parameters, further runs where they teach most, and what the data determine."""
import itertools
import math

import numpy as np

import knap

from . import need
from .emulator import Emulator, Success
from .problem import unit_of
from .runs import Stop, table

_unmeasurable = ("law_", "interface_", "measured_", "scheme_", "unresolved_", "overlap_", "largest_penetration", "crossing_",
                 "cohesive_")  # in no test
_contradiction = 0.01  # probability of a misfit below which the model cannot meet the data
_floor = 1e-3  # of the level of a measurement: smaller differences count as none


def sobol(n, dimension, seed):
    """The first n points of a scrambled Sobol sequence: they fill the unit cube, however many there are."""
    sequence = need("scipy.stats", "python3-scipy", "the design").qmc.Sobol(dimension, seed=seed)
    return sequence.random_base2(int(np.ceil(np.log2(max(n, 2)))))[:n]


def correlation(x):
    """Of errors along a curve: exp(-|x - x'|/L), L a quarter of its range. Neighbouring points err together, so a curve of a
    hundred points tells no more than one of ten."""
    if x is None:
        return np.ones((1, 1))
    return np.exp(-np.abs(x[:, None] - x[None, :]) * 4 / (x[-1] - x[0]))


class Posterior:
    """Draws of the parameters, `u` (a row each), and of the part of the level that the model misses, `tau`; `best`: the most
    likely of them."""

    def __init__(self, problem, u, tau, log_p):
        self.problem, self.u, self.tau = problem, u, tau
        self.best, self.best_tau = u[np.argmax(log_p)], tau[np.argmax(log_p)]
        self.tails = [50 * (1 - problem.options["interval"]), 50 * (1 + problem.options["interval"])]

    def interval(self):
        """Lower and upper ends of the parameters."""
        return self.problem.values(np.percentile(self.u, self.tails, axis=0))

    def widths(self):
        return np.diff(np.percentile(self.u, self.tails, axis=0), axis=0)[0]


def data_covariance(measured, emulator):
    """Of the mean of the measured specimens about what the model has on average."""
    known = measured.scatter is not None
    spread = measured.scatter**2 * correlation(measured.x) if known else emulator.seed_covariance()
    return (spread + measured.noise**2 * np.eye(len(spread))) / measured.n + np.diag(known * emulator.rest + (_floor * measured.level) ** 2)


class Likelihood:
    def __init__(self, problem, emulators, points, with_error):
        self.problem, self.with_error = problem, with_error
        self.parts = [(m, emulators[m.title], data_covariance(m, emulators[m.title]), m.level**2 * correlation(m.x))
                      for m in problem.fitted]
        patterns = {emulator.works.tobytes(): emulator.works for _, emulator, _, _ in self.parts}  # of one run that fails, once
        self.success = [Success(points, works) for works in patterns.values()]

    def __call__(self, u):
        """Logarithm of prior times likelihood, up to a constant; u has log10 of tau in a further column with an error term,
        uniform from 0.001 to 1."""
        k = len(self.problem.parameters)
        found = sum(parameter.log_prior(x) for parameter, x in zip(self.problem.parameters, u.T))
        tau = np.zeros(len(u))
        if self.with_error:
            tau = 10.0 ** u[:, k]
            found = np.where((tau < 1e-3) | (tau > 1), -np.inf, found)
        inside = np.isfinite(found)
        if inside.any():
            found[inside] += sum(log_p for _, log_p in self.terms(u[inside, :k], tau[inside])) + self.log_success(u[inside, :k])
        return found

    def log_success(self, u):
        """Logarithm of the probability that runs at the places u have all that was measured."""
        return sum(success.log(u) for success in self.success)

    def terms(self, u, tau):
        """Of each measurement: residuals in standard deviations, and the logarithm of their probability; a row for each u."""
        for measured, emulator, covariance, error in self.parts:
            mean, variance = emulator(u)
            factor = np.linalg.cholesky(covariance + emulator.spread(variance) + tau[:, None, None] ** 2 * error)
            z = np.linalg.solve(factor, (measured.values - mean)[:, :, None])[:, :, 0]
            yield z, -0.5 * (z**2).sum(axis=1) - np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1)


def sample(problem, likelihood, steps, rng, points):
    """Draws from the posterior by emcee (affine-invariant ensembles, Goodman and Weare 2010). The walkers start at the most likely
    of a thousand places and of the `points` of the runs, which were chosen where it matters, and once more at the most likely
    places of a first short chain: a narrow posterior is found, and its width is that of the second chain alone."""
    emcee = need("emcee", "python3-emcee", "the posterior")
    k, dimension = len(problem.parameters), len(problem.parameters) + likelihood.with_error
    start = sobol(1024 + len(points), dimension, int(rng.integers(2**31)))
    start[1024:, :k] = points
    if likelihood.with_error:
        start[:, -1] = -3 + 3 * start[:, -1]
    n = max(24, 4 * dimension)
    log_p = likelihood(start)
    for part in (max(steps // 3, 50), steps):
        start = start[np.argsort(-log_p)[:n]]
        sampler = emcee.EnsembleSampler(n, dimension, likelihood, vectorize=True,
                                        moves=[(emcee.moves.DEMove(), 0.7), (emcee.moves.StretchMove(), 0.3)])
        sampler.log_prob_fn = likelihood  # without the wrapper of emcee, which prints a traceback when the user interrupts it
        sampler.random_state = np.random.RandomState(int(rng.integers(2**31))).get_state()
        sampler.run_mcmc(start, part, skip_initial_state_check=True)
        start, first = np.unique(sampler.get_chain(flat=True), axis=0, return_index=True)
        log_p = sampler.get_log_prob(flat=True)[first]
    chain, log_p = (getter(discard=steps // 3, flat=True) for getter in (sampler.get_chain, sampler.get_log_prob))
    keep = rng.permutation(len(chain))[: max(problem.options["draws"], 400)]
    chain, log_p = chain[keep], log_p[keep]
    return chain[:, :k], 10.0 ** chain[:, k] if likelihood.with_error else np.zeros(len(chain)), log_p


def _same(a, b):
    """Whether two numbers of the runs tell the same, as a force and its stress."""
    both = np.isfinite(a) & np.isfinite(b)
    with np.errstate(invalid="ignore", divide="ignore"):  # one that is the same in all runs tells nothing
        return both.sum() > 2 and np.abs(np.corrcoef(a[both], b[both])[0, 1]) > 0.98


def _combined(members, log):
    """A sentence on what is determined of the (name, power or coefficient) of each of some parameters; the first one is positive."""
    text = ""
    for name, c in members:
        if log:
            text += ("/" if c < 0 else " ") + name + f"^{abs(c):.2g}" * (f"{abs(c):.2g}" != "1")
        else:
            text += f" {'-' if c < 0 else '+'} {abs(c):.3g} {name}" if text else name
    unlike = bool(len(members) == 2 and members[1][1] < 0)
    kind = (("product", "ratio") if log else ("sum", "difference"))[unlike]
    return f"only the {kind} {text.strip()} is determined, not each of {', '.join(name for name, _ in members)}"


def _whole_powers(n):
    """Products of two or three of n parameters, by whole powers up to three."""
    for size in (2, 3):
        for place, powers in itertools.product(itertools.combinations(range(n), size), itertools.product((1, 2, 3, -1, -2, -3), repeat=size)):
            if powers[0] > 0 and math.gcd(*powers) == 1:
                found = np.zeros(n)
                found[list(place)] = powers
                yield found


class Fit:
    """A fit: `run` makes the runs; `posterior`; `history` of (runs, share, widths of the intervals); `p`: probability of a misfit as
    large as this one if the model were true. Each round depends on the runs before it alone, and convergence.csv keeps
    the history, so that a fit that was stopped goes on as if it had not been."""

    def __init__(self, problem, runs, log=lambda text: None):
        self.problem, self.runs, self.log = problem, runs, log
        self.emulators, self.history, self.posterior, self.p, self.stopped = {}, [], None, np.nan, ""
        self.is_filled = False  # whether the budget ends with the points that fill the space

    def design(self, n, seed=None):
        return sobol(n, len(self.problem.parameters), self.problem.options["seed"] if seed is None else seed)

    def first_points(self, n):
        """The middle of the bounds, and what fills the space. Where a test has neither a scatter nor several seeds a quarter of all,
        at least two, are the middle again, of which each has another seed: the scatter of meshes is that of these runs."""
        unknown = any(m.scatter is None and m.test.seeds == 1 for m in self.problem.fitted)
        middle = np.full((min(1 + max(2, n // 4) * unknown, n), len(self.problem.parameters)), 0.5)
        return np.vstack([middle, self.design(n - len(middle))]) if n > 1 else middle

    def filling_points(self, n):
        """Further points that fill the space with those before them."""
        return self.design(len(self.runs.values) + n)[-n:]

    def unknown_scatter(self):
        """Measurements of which nothing tells the scatter: one specimen, or runs of too few seeds."""
        return [m for m in self.problem.fitted if m.scatter is None and (m.n == 1 or self.emulators[m.title].freedom < 2)]

    def run(self):
        options = self.problem.options
        most = max(options["budget"] // self.runs.per_point, 1)
        first = min(options["first"] or 6 * len(self.problem.parameters), most)
        self.is_filled = first == most
        batch = options["batch"] or -(-most // 12)
        for n in (1, first):  # one alone, which shows mistakes
            self.runs.add(self.first_points(min(n, first))[len(self.runs.values):])
            self.problem.check_first(self.runs)
            need("scipy.stats", "python3-scipy", "knap-fit", ("sklearn", "python3-sklearn"), ("emcee", "python3-emcee"))
        while not self.stopped:
            n = min(batch, most - len(self.runs.values))
            if not self.emulate(last=n < 1):
                self.runs.add(self.filling_points(n))  # too few runs have a value to choose by
                continue
            self.infer(steps=150)
            self.remember()
            self.log(f"{self.runs.n_runs} runs; " + "; ".join(
                f"{p.name} {low:.4g} to {high:.4g} {p.unit}" for p, low, high in zip(self.problem.parameters, *self.posterior.interval())))
            if n < 1:
                self.stopped = "the budget is used up"
            elif len(self.history) > 2 and all(self.steady(now, before) for now, before in zip(self.history[-2:], self.history[-3:])):
                self.stopped = "the intervals no longer shrink"
            else:
                self.runs.add(self.next_points(n))
        self.infer(steps=600)
        return self

    def steady(self, now, before):
        """Whether the geometric mean of the widths stays: each of them alone scatters as short chains do."""
        return now[1] < 0.1 and np.abs(np.log(now[2] / before[2]).mean()) < self.problem.options["shrink"]

    def remember(self):
        """Adds this round to the history, and those with fewer runs that convergence.csv has from a process before this one."""
        file = self.runs.directory / "convergence.csv"
        if not self.history and file.exists():
            rows = np.array(list(knap.read_csv(file).values())).T
            self.history = [(int(row[0]), row[1], row[2:]) for row in rows if row[0] < self.runs.n_runs]
        self.history.append((self.runs.n_runs, self.variances(self.posterior.u[:200]).mean(), self.posterior.widths()))
        titles = ["runs", "variance of emulators over that of the data", *(f"{p.name}: width over that of the bounds" for p in self.problem.parameters)]
        table(file, titles, [[n, repr(float(share)), *map(repr, map(float, widths))] for n, share, widths in self.history])

    def emulate(self, last=True):
        """Whether there are emulators of all that is fitted; too few runs with a value end the fit when they are the `last` ones."""
        for measured in self.problem.measured:
            try:
                self.emulators[measured.title] = Emulator(self.runs.points, self.runs.of(measured), measured.level)
            except ValueError as error:
                why = next((text for text in self.runs.why.values() if text), "")
                if measured.use == "fit" and last:
                    raise Stop(f"{measured.title}: {error}" + (f"; the first run that failed: {why}" if why else "")) from None
                if measured.use == "fit":
                    return False
        return True

    def infer(self, steps):
        """The posterior from the emulators. An error term of the model is added where the data need one; `exact` has the draws without it,
        since it hides that the data lie beyond a bound."""
        rng, stats = np.random.default_rng(self.problem.options["seed"]), need("scipy.stats", "python3-scipy", "the test of the misfit")
        self.likelihood = Likelihood(self.problem, self.emulators, self.runs.points, False)
        drawn = sample(self.problem, self.likelihood, steps, rng, self.runs.points)
        z = np.hstack([z[0] for z, _ in self.likelihood.terms(drawn[0][[np.argmax(drawn[2])]], np.zeros(1))])
        # chi-squared of all residuals, and twice the tail beyond the largest one, times their number: one number alone may contradict
        freedom, largest = len(z) - len(self.problem.parameters), float(2 * len(z) * stats.norm.sf(np.abs(z).max()))
        if freedom > 0:
            self.p = min(float(stats.chi2.sf(z @ z, freedom)), largest)
        else:
            self.p = largest if largest < _contradiction else np.nan
        self.exact, wanted = drawn[0], self.problem.options["model_error"]
        if wanted == "fitted" or (wanted == "auto" and self.contradicted):
            self.likelihood = Likelihood(self.problem, self.emulators, self.runs.points, True)
            drawn = sample(self.problem, self.likelihood, steps, rng, self.runs.points)
        self.posterior = Posterior(self.problem, *drawn)

    def variances(self, u):
        """Of the emulators over those of the data, mean over the measurements: what further runs can take away."""
        found = []
        for measured, emulator, covariance, error in self.likelihood.parts:
            variance = np.diagonal(emulator.spread(emulator(u)[1]), axis1=1, axis2=2)
            found.append((variance / np.diag(covariance + self.posterior.best_tau**2 * error)).mean(axis=1))
        return np.mean(found, axis=0)

    def next_points(self, n):
        """Of draws of the posterior, and of a few places anywhere, those whose runs would take most off the variance that the
        emulators have over all draws, in variances of the data (active learning of Cohn, J. Artif. Intell. Res. 4 (1996) 129).
        A run counts by its probability to have a value."""
        draws, parts, chosen = self.posterior.u[:300], [], []
        u = np.vstack([draws, self.design(60, seed=len(self.runs.values))])
        for _, emulator, covariance, error in self.likelihood.parts:
            weight = (emulator.v * np.linalg.solve(covariance + self.posterior.best_tau**2 * error, emulator.v)).sum(axis=0)
            parts += zip(weight, emulator.covariances(u), emulator.noise + 1e-9 * emulator.scale**2)
        success = np.exp(self.likelihood.log_success(u))
        for _ in range(n):
            gain = sum(weight * (c[: len(draws)] ** 2).mean(axis=0) / (np.diag(c) + noise) for weight, c, noise in parts)
            best = np.argmax(success * gain)
            chosen.append(u[best])
            for _, c, noise in parts:
                c -= success[best] * np.outer(c[:, best], c[best]) / (c[best, best] + noise)  # after this run
        return np.array(chosen)

    # ---- what the data say

    @property
    def contradicted(self):
        """Whether the model cannot meet the data."""
        return self.p < _contradiction

    @property
    def beyond_error(self):
        """Whether the model misses more of the data than its largest error term takes up."""
        return self.contradicted and (not self.posterior.tau.any() or np.percentile(self.posterior.tau, 95) > 0.9)

    def narrowed_to(self):
        """Of each parameter, deviation over that before, and the part of its variance in directions that the data narrow by less than half:
        eigenvectors of the covariance in units of that before. There the bounds alone limit it, its own or those of others."""
        before = np.array([p.deviation(p.place) for p in self.problem.parameters])
        covariance = np.atleast_2d(np.cov(self.posterior.u.T / before[:, None], bias=True))
        values, vectors = np.linalg.eigh(covariance)
        return np.sqrt(np.diag(covariance)), vectors**2 @ np.where(values > 0.25, values, 0) / np.diag(covariance)

    def determined(self):
        """Of each parameter: "yes" below 0.4 of the standard deviation that it had before, "partly" below 0.75, "no". Parameters most of whose
        variance lies in directions that the data do not tell, of a model that cannot meet the data, or from data of unknown scatter are
        at most "partly" determined, and "no" where no error term takes up the misfit."""
        doubted = self.contradicted or bool(self.unknown_scatter())
        return ["no" if self.beyond_error else "yes" if part < 0.4 and untold < 0.5 and not doubted else "partly" if part < 0.75 else "no"
                for part, untold in zip(*self.narrowed_to())]

    def combinations(self):
        """Texts: parameters that the data determine together only. Directions of the covariance of those that are not determined
        alone, of their values (sums) or of the logarithms (products), whichever has the narrowest one, over what they had before:
        v_i (x_i - mean)/d_i is known, so sum_i v_i/d_i x_i is. A product of few parameters with small whole powers stands for a
        direction where it is at most 1.5 times as wide."""
        (part, untold), found = self.narrowed_to(), {}
        for log in (False, True):
            free = [i for i, p in enumerate(self.problem.parameters) if (part[i] > 0.4 or untold[i] > 0.5) and (p.low > 0 or not log)]
            if len(free) < 2 or (not log and len({p.unit for p in map(self.problem.parameters.__getitem__, free) if p.low > 0}) > 1):
                continue  # values of two units have no sum
            scale, parameters = np.log if log else np.asarray, [self.problem.parameters[i] for i in free]
            deviation = np.array([p.deviation(scale) for p in parameters])
            covariance = np.cov([scale(p.value(self.posterior.u[:, i])) / d for i, p, d in zip(free, parameters, deviation)])
            found[log] = (*np.linalg.eigh(covariance), covariance, parameters, deviation)
        texts, named = [], []
        for log in sorted(found, key=lambda log: found[log][0][0])[:1]:
            values, vectors, covariance, parameters, deviation = found[log]

            def width(powers):
                w = powers * deviation
                return np.sqrt(w @ covariance @ w / (w @ w))
            simple = sorted(_whole_powers(len(parameters)) if log else [], key=lambda powers: ((powers != 0).sum(), np.abs(powers).sum(), width(powers)))
            for value, vector in zip(np.sqrt(values), vectors.T):
                vector = np.where(np.abs(vector) >= min(0.3, np.abs(vector).max()), vector, 0) / deviation
                vector /= vector[np.flatnonzero(vector)[0]]
                known = [powers for powers in simple if width(powers) < min(1.5 * value, 0.4)] + [vector]
                chosen = next((powers for powers in known if np.linalg.matrix_rank([*named, powers]) > len(named)), vector)
                if value < 0.4 and (chosen != 0).sum() > 1:
                    named.append(chosen)
                    texts.append(_combined([(p.name, c) for p, c in zip(parameters, chosen) if c], log))
        return texts

    def further_tests(self):
        """(what would be measured, part by which the interval of each parameter would shrink, the scatter and the model error of this, over
        its level): of all candidates and left-out measurements by their emulators; of other numbers of the same tests by a linear fit over
        the points, the three that tell most of each parameter that is not determined. Measured once, with the scatter of seeds or of
        that fit, at least 3 %, and the model error that the fit found."""
        u, error, asked, others = self.posterior.u, float(np.median(self.posterior.tau)), [], []
        for m in self.problem.measured:
            if m.use != "fit" and m.title in self.emulators:
                emulator = self.emulators[m.title]
                mean = emulator(u)[0]
                level = np.abs(mean).max() if m.values is None else m.level
                scatter = m.scatter or max((m.part or 0.03) * level, np.sqrt(np.diag(emulator.seed_covariance()).max()))
                together = (scatter**2 + (error * level) ** 2) * correlation(m.x)
                asked.append((m.title, self.narrowed(mean, together + m.noise**2 * np.eye(m.size)), float(scatter / level), error))
        known = [self.runs.numbers(m.test, m.name) for m in self.problem.measured if m.x is None]
        design = np.hstack([np.ones((len(self.runs.points), 1)), self.runs.points])
        for test in self.problem.tests:
            for name in sorted({name for run in self.runs.answers(test) if run for name in run.summary}):
                y = self.runs.numbers(test, name)
                keep = np.isfinite(y)
                if name.startswith(_unmeasurable) or unit_of("summary", name) not in ("Pa", "N", "m", "J") or any(_same(y, other) for other in known):
                    continue
                if keep.sum() < 3 * design.shape[1] or not y[keep].std() > 1e-9 * np.abs(y[keep]).max():
                    continue
                known.append(y)
                slope = np.linalg.lstsq(design[keep], y[keep], rcond=None)[0]
                rest = (y[keep] - design[keep] @ slope).std()
                if rest < 0.5 * y[keep].std():
                    level = np.abs(y[keep]).mean()
                    scatter = max(rest / level, 0.03)
                    narrowed = self.narrowed((u @ slope[1:] + slope[0])[:, None], np.array([[(scatter**2 + error**2) * level**2]]))
                    others.append((f"{test.name}: {name}", narrowed, float(scatter), error))
        told = np.array([row[1] for row in others]).reshape(-1, u.shape[1])
        most = (told > 0.1) & (told >= np.sort(told, axis=0)[-3:][:1]) & (np.array(self.determined()) != "yes")
        return asked + [row for row, shown in zip(others, most) if shown.any()]

    def narrowed(self, f, covariance):
        """Part by which the deviation of each parameter would shrink if f, a row for each draw, were measured with errors of this
        covariance: linear regression."""
        x, f = self.posterior.u - self.posterior.u.mean(axis=0), f - f.mean(axis=0)
        both = f.T @ x / len(f)
        gain = (both * np.linalg.solve(f.T @ f / len(f) + covariance, both)).sum(axis=0)
        return 1 - np.sqrt(np.clip(1 - gain / x.var(axis=0), 0, 1))

    def predictions(self):
        """(measured, low, middle, high) of one mean of specimens as those that were measured."""
        rng, found = np.random.default_rng(1), []
        u, tau = self.posterior.u[:500], self.posterior.tau[:500]
        for m in (m for m in self.problem.measured if m.title in self.emulators):
            emulator = self.emulators[m.title]
            mean, variance = emulator(u)
            y = mean + (rng.standard_normal(variance.shape) @ emulator.root.T * np.sqrt(variance)) @ emulator.v.T
            y += rng.multivariate_normal(np.zeros(m.size), data_covariance(m, emulator), len(u), method="eigh")
            y += tau[:, None] * m.level * rng.multivariate_normal(np.zeros(m.size), correlation(m.x), len(u), method="eigh")
            found.append((m, *np.percentile(y, [self.posterior.tails[0], 50, self.posterior.tails[1]], axis=0)))
        return found


def pressed(problem, u):
    """Texts: parameters that lie at a bound, of rows of u: more than 15 % of them within 3 % of it."""
    return [f"{p.name} is pressed against its {side} bound, {', '.join(p.keys)} = {bound:g} {p.unit}".rstrip() + ": widen it, unless it is knowledge; the data may lie beyond."
            for p, x in zip(problem.parameters, u.T) for side, bound, near in (("lower", p.low, x < 0.03), ("upper", p.high, x > 0.97)) if near.mean() > 0.15]


def least_squares(problem, runs, log=lambda text: None):
    """(values, residuals in standard deviations): bounded least squares from the starts by scipy, a step of 0.05 of the
    bounds for slopes, so that rough answers do not mislead them."""
    best = (np.inf, "")

    def residuals(u):
        nonlocal best
        if problem.rounded(u) not in runs.values and runs.n_runs + runs.per_point > problem.options["budget"]:
            raise Stop(f"the budget of {problem.options['budget']} runs is used up; the best so far: {best[1]} "
                       f"(root of the sum of squares {best[0]:.3g} deviations)")
        k, found, where = runs.at([u])[0], [], ", ".join(f"{p.name} = {p.text(x)}" for p, x in zip(problem.parameters, u))
        for m in problem.fitted:
            values = runs.of(m)[k]
            values = values[np.isfinite(values).all(axis=1)]
            if not len(values):
                raise Stop(f"{m.title}: no value at {where}: {runs.cause(k, m.test)}")
            found.append((values.mean(axis=0) - m.values) / ((m.scatter or 0.01 * m.level) * np.sqrt(m.size)))
        log(f"{where}: " + ", ".join(f"{m.title} {m.in_file(runs.of(m)[k].mean()):.6g} {m.shown}" for m in problem.fitted if m.x is None))
        found = np.concatenate(found)
        best = min(best, (float(np.sqrt(found @ found)), where))
        return found

    start = np.array([0.5 if p.start is None else float(p.place(p.start)) for p in problem.parameters])
    start = np.clip(start, 0.01, 0.99)
    if not runs.values:
        runs.add([start])
        problem.check_first(runs)
    optimize = need("scipy.optimize", "python3-scipy", "least squares")
    found = optimize.least_squares(residuals, start, bounds=(0, 1), diff_step=0.05, xtol=2e-3, ftol=1e-4, x_scale=1.0)
    return found.x, found.fun
