"""The posterior of the parameters, further runs where they teach most, and what the data determine."""
import itertools

import numpy as np

import knap

from . import need
from .emulator import Emulator, Success, TooFew, students
from .runs import Stop

_contradiction = 0.01  # probability of a misfit below which the model cannot meet the data
_floor = 1e-3  # of the level of a measurement: smaller differences count as none


def sobol(n, dimension, seed):
    """The first n points of a scrambled Sobol sequence: they fill the unit cube, however many there are."""
    sequence = need("the design", "scipy.stats").qmc.Sobol(dimension, seed=seed)
    return sequence.random_base2(int(np.ceil(np.log2(max(n, 2)))))[:n]


def correlation(x):
    """Of errors along a curve: exp(-|x - x'|/L), L a quarter of its range. Neighbouring points err together, so a curve
    of a hundred points tells no more than one of ten."""
    return np.ones((1, 1)) if x is None else np.exp(-np.abs(x[:, None] - x) * 4 / (x[-1] - x[0]))


def data_covariance(m, emulator, tau=0.0):
    """Of the mean of the measured specimens about what the model has on average, with an error of the model, tau of the
    level. Where few specimens tell their own scatter it is that of the normal distribution with the interval, of 90 %
    or more, of Student's t."""
    alike, one = correlation(m.x), np.eye(m.size)
    known = m.scatter is not None
    spread = alike * m.scatter**2 * students(m.freedom, max(m.interval, 0.9)) if known else emulator.seed_covariance()
    floor = known * emulator.rest + (_floor * emulator.level) ** 2
    return (spread + m.noise**2 * one) / m.n + one * floor + np.multiply.outer(tau**2, emulator.level**2 * alike)


class Posterior:
    """Draws of the parameters, a row each: `at`, places of runs; `u`, the same with the scatter of the surpluses by
    which the program divides them. `tau`: part of the level that the model misses. `best`, `best_tau`: the most likely
    of them."""

    def __init__(self, problem, at, tau, log_p, surpluses):
        self.problem, self.at, self.tau = problem, at, tau
        self.best, self.best_tau = at[np.argmax(log_p)], tau[np.argmax(log_p)]
        scatter = np.random.default_rng(1).standard_normal(at.shape) * surpluses
        factors = np.sqrt(1 + scatter**2) + scatter  # exp(asinh): about 1 + scatter, and positive
        self.u = np.array([p.place(p.value(x) * f) for p, x, f in zip(problem.parameters, at.T, factors.T)]).T
        self.tails = [50 * (1 - problem.options["interval"]), 50 * (1 + problem.options["interval"])]

    def interval(self):
        """Lower and upper ends of the parameters."""
        return self.problem.values(np.percentile(self.u, self.tails, axis=0))

    def widths(self):
        return np.diff(np.percentile(self.u, self.tails, axis=0), axis=0)[0]


class Likelihood:
    def __init__(self, problem, emulators, points, has_error):
        self.problem, self.has_error = problem, has_error
        self.parts = [(m, emulators[m.title]) for m in problem.fitted]
        patterns = {e.works.tobytes(): e.works for _, e in self.parts}  # of one run that fails, once
        self.success = [Success(points, works) for works in patterns.values()]

    def __call__(self, u):
        """Logarithm of prior times likelihood, up to a constant; u has log10 of tau in a further column with an error
        term, uniform from 0.001 to 1."""
        k = len(self.problem.parameters)
        found = sum(parameter.log_prior(x) for parameter, x in zip(self.problem.parameters, u.T))
        tau = 10.0 ** u[:, k] if self.has_error else np.zeros(len(u))
        found = np.where((tau > 0) & ((tau < 1e-3) | (tau > 1)), -np.inf, found)
        inside = np.isfinite(found)
        if inside.any():
            at = u[inside, :k]
            found[inside] += sum(log_p for _, log_p in self.terms(at, tau[inside])) + self.log_success(at)
        return found

    def log_success(self, u):
        """Logarithm of the probability that runs at the places u have all that was measured."""
        return sum(success.log(u) for success in self.success)

    def terms(self, u, tau):
        """Of each measurement: residuals in standard deviations, and the logarithm of their probability; a row for each
        u."""
        for m, emulator in self.parts:
            mean, variance = emulator(u)
            factor = np.linalg.cholesky(data_covariance(m, emulator, tau) + emulator.spread(variance))
            z = np.linalg.solve(factor, (m.values - mean)[:, :, None])[:, :, 0]
            yield z, -0.5 * (z**2).sum(axis=1) - np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1)


def sample(problem, likelihood, steps, rng, points):
    """Draws from the posterior by emcee (affine-invariant ensembles, Goodman and Weare 2010). The walkers start at the
    most likely of a thousand places and of the `points` of the runs, which were chosen where it matters, and once more
    at the most likely places of a first short chain: a narrow posterior is found, and its width is that of the second
    chain alone."""
    emcee = need("the posterior", "emcee")
    k, dimension = len(problem.parameters), len(problem.parameters) + likelihood.has_error
    start = sobol(1024 + len(points), dimension, int(rng.integers(2**31)))
    start[1024:, :k] = points
    start[:, k:] = -3 + 3 * start[:, k:]
    n = max(24, 4 * dimension)
    log_p = likelihood(start)
    for part in (max(steps // 3, 50), steps):
        start = start[np.argsort(-log_p)[:n]]
        sampler = emcee.EnsembleSampler(n, dimension, likelihood, vectorize=True,
                                        moves=[(emcee.moves.DEMove(), 0.7), (emcee.moves.StretchMove(), 0.3)])
        sampler.log_prob_fn = likelihood  # emcee's wrapper prints a traceback when the user interrupts it
        sampler.random_state = np.random.RandomState(int(rng.integers(2**31))).get_state()
        sampler.run_mcmc(start, part, skip_initial_state_check=True)
        start, first = np.unique(sampler.get_chain(flat=True), axis=0, return_index=True)
        log_p = sampler.get_log_prob(flat=True)[first]
    chain, log_p = (getter(discard=steps // 3, flat=True) for getter in (sampler.get_chain, sampler.get_log_prob))
    order = rng.permutation(len(chain))  # any part of the draws is a sample
    chain, log_p = chain[order], log_p[order]
    return chain[:, :k], 10.0 ** chain[:, k] if likelihood.has_error else np.zeros(len(chain)), log_p


class Fit:
    """A fit: `run` makes the runs; `posterior`; `history` of (runs, share, widths of the intervals); `p`: probability
    of a misfit as large as this one if the model were true. Each round depends on the runs before it alone, and
    convergence.csv keeps the history, so that a fit that was stopped goes on as if it had not been."""

    last_chain = 1500  # steps of the chain at the end

    def __init__(self, problem, runs, log=lambda text: None):
        self.problem, self.runs, self.log = problem, runs, log
        self.emulators, self.history, self.posterior, self.p, self.stopped = {}, [], None, np.nan, ""
        self.is_filled = False  # whether the budget ends with the points that fill the space
        self.surpluses = None  # of each parameter, the scatter of that by which the program divides it

    def design(self, n, seed=None):
        return sobol(n, len(self.problem.parameters), self.problem.options["seed"] if seed is None else seed)

    def first_points(self, n):
        """The middle of the bounds, and what fills the space. Where a test has neither a scatter nor several seeds a
        quarter of all, at least two, are the middle again, of which each has another seed: the scatter of meshes is
        that of these runs."""
        unknown = any(m.scatter is None and m.test.seeds == 1 for m in self.problem.fitted)
        middle = np.full((min(1 + max(2, n // 4) * unknown, n), len(self.problem.parameters)), 0.5)
        return np.vstack([middle, self.design(n - len(middle))]) if n > 1 else middle

    def filling_points(self, n):
        """Further points that fill the space with those before them."""
        return self.design(len(self.runs.values) + n)[-n:]

    def run(self):
        options = self.problem.options
        most = max(options["budget"] // self.runs.per_point, 1)
        first = min(options["first"] or 6 * len(self.problem.parameters), most)
        self.is_filled = first == most
        batch = options["batch"] or -(-most // 12)
        for n in (1, first):  # one alone, which shows mistakes
            self.runs.add(self.first_points(n)[len(self.runs.values):])
            self.problem.check_first(self.runs)
            need("knap-fit", "scipy.stats", "sklearn", "emcee")
        for m in self.problem.fitted:  # a waste of the rest of the budget, or too few for an emulator at its end
            works = np.isfinite(self.runs.of(m)[:first]).all(axis=2).any(axis=1)
            if works.mean() < 0.1 or works.mean() * most < len(self.problem.parameters) + 2:
                raise Stop(f"{m.title}: only {works.sum()} of {len(works)} points have a value; "
                           f"{self.runs.remedy(m.test)}")
        while not self.stopped:
            n = min(batch, most - len(self.runs.values))
            if not self.emulate(last=n < 1):
                self.runs.add(self.filling_points(n))  # too few runs have a value to choose by
                continue
            self.infer(steps=150)
            self.remember()
            intervals = zip(self.problem.parameters, *self.posterior.interval())
            shown = "; ".join(f"{p.name} {low:.4g} to {high:.4g} {p.unit}" for p, low, high in intervals)
            self.log(f"{self.runs.n_runs} runs; {shown}")
            if n < 1:
                self.stopped = "the budget is used up"
            elif len(self.history) > 2 and all(map(self.steady, self.history[-2:], self.history[-3:])):
                self.stopped = "the intervals no longer shrink"
            else:
                self.runs.add(self.next_points(n))
        self.infer(self.last_chain)
        return self

    def steady(self, now, before):
        """Whether the geometric mean of the widths stays: each of them alone scatters as short chains do."""
        return now[1] < 0.1 and np.abs(np.log(now[2] / before[2]).mean()) < self.problem.options["shrink"]

    def remember(self):
        """Adds this round to the history, and those with fewer runs that convergence.csv has from a process before this
        one."""
        file = self.runs.directory / "convergence.csv"
        if not self.history and file.exists():
            rows = np.array(list(knap.read_csv(file).values())).T
            self.history = [(int(row[0]), row[1], row[2:]) for row in rows if row[0] < self.runs.n_runs]
        self.history.append((self.runs.n_runs, self.variances(self.posterior.at[:200]), self.posterior.widths()))
        titles = [f"{p.name}: width over that of the bounds" for p in self.problem.parameters]
        knap.write_csv(file, ["runs", "variance of emulators over that of the data", *titles],
                       [[n, share, *widths] for n, share, widths in self.history], digits=17)

    def emulate(self, last=True):
        """Whether there are emulators of all that is fitted; too few runs with a value end the fit when they are the
        `last`."""
        for m in self.problem.measured:
            try:
                level = None if m.values is None else m.level
                self.emulators[m.title] = Emulator(self.runs.points, self.runs.of(m), level)
            except TooFew as error:
                if m.use == "fit" and last:
                    raise Stop(f"{m.title}: {error}; {self.runs.remedy(m.test)}") from None
                if m.use == "fit":
                    return False
        return True

    def infer(self, steps):
        """The posterior from the emulators. An error term of the model is added where the data need one; `exact` has
        the draws without it, since it hides that the data lie beyond a bound."""
        rng, stats = np.random.default_rng(self.problem.options["seed"]), need("knap-fit", "scipy.stats")
        self.surpluses = self.runs.surplus_scatter() if self.surpluses is None else self.surpluses
        self.likelihood = Likelihood(self.problem, self.emulators, self.runs.points, False)
        drawn = sample(self.problem, self.likelihood, steps, rng, self.runs.points)
        z = np.hstack([z[0] for z, _ in self.likelihood.terms(drawn[0][[np.argmax(drawn[2])]], np.zeros(1))])
        # chi-squared of all residuals, and twice the tail beyond the largest, times their number: one may contradict
        freedom, largest = len(z) - len(self.problem.parameters), float(2 * len(z) * stats.norm.sf(np.abs(z).max()))
        self.p = min(float(stats.chi2.sf(z @ z, freedom)) if freedom > 0 else 1.0, largest)
        if freedom < 1 and largest >= _contradiction:
            self.p = np.nan
        self.exact, wanted = drawn[0], self.problem.options["model_error"]
        if wanted == "fitted" or (wanted == "auto" and self.contradicted):
            self.likelihood = Likelihood(self.problem, self.emulators, self.runs.points, True)
            drawn = sample(self.problem, self.likelihood, steps, rng, self.runs.points)
        self.posterior = Posterior(self.problem, *drawn, self.surpluses)

    def variances(self, u, *some):
        """Of the emulators over those of the data, mean over the places u and the measurements, or `some` of them: what
        further runs can take away."""
        found, tau = [], self.posterior.best_tau
        for m in some or self.problem.fitted:
            emulator = self.emulators[m.title]
            variance = np.diagonal(emulator.spread(emulator(u)[1]), axis1=1, axis2=2)
            found.append(variance / np.diag(data_covariance(m, emulator, tau)))
        return float(np.mean([part.mean() for part in found]))

    def next_points(self, n):
        """Of draws of the posterior, and of a few places anywhere, those whose runs would take most off the variance
        that the emulators have over all draws, in variances of the data (active learning of Cohn, J. Artif. Intell.
        Res. 4 (1996) 129). A run counts by its probability to have a value."""
        draws, parts, chosen = self.posterior.at[:300], [], []
        u = np.vstack([draws, self.design(60, seed=len(self.runs.values))])
        for m, emulator in self.likelihood.parts:
            covariance = data_covariance(m, emulator, self.posterior.best_tau)
            weight = (emulator.v * np.linalg.solve(covariance, emulator.v)).sum(axis=0)
            parts += zip(weight, emulator.covariances(u), emulator.noise + 1e-9 * emulator.scale**2)
        success = np.exp(self.likelihood.log_success(u))
        for _ in range(n):
            gain = sum(w * (c[: len(draws)] ** 2).mean(axis=0) / (np.diag(c) + noise) for w, c, noise in parts)
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
        return bool(self.contradicted and (not self.posterior.tau.any() or np.percentile(self.posterior.tau, 95) > 0.9))

    def unconverged(self):
        """(measurement, variance of its emulator over that of the data at the most likely place) where the runs tell
        less than the data."""
        return [(m, ratio) for m in self.problem.fitted if (ratio := self.variances(self.posterior.best[None], m)) > 1]

    def unknown_scatter(self):
        """Measurements of which nothing tells the scatter: one specimen, or runs of too few seeds."""
        return [m for m in self.problem.fitted
                if m.scatter is None and (m.n == 1 or self.emulators[m.title].freedom < 2)]

    def narrowed_to(self):
        """Of each parameter, deviation over that before, and the part of its variance in directions that the data
        narrow by less than half: eigenvectors of the covariance in units of that before. There the bounds alone limit
        it, or those of others."""
        before = np.array([p.deviation(p.place) for p in self.problem.parameters])
        covariance = np.atleast_2d(np.cov(self.posterior.u.T / before[:, None], bias=True))
        values, vectors = np.linalg.eigh(covariance)
        return np.sqrt(np.diag(covariance)), vectors**2 @ np.where(values > 0.25, values, 0) / np.diag(covariance)

    def determined(self):
        """Of each parameter: "yes" below 0.4 of the standard deviation that it had before, "partly" below 0.75, "no".
        Parameters most of whose variance lies in directions that the data do not tell, of a model that cannot meet the
        data, from data of unknown scatter, or by an emulator that knows less than the data are at most "partly"
        determined, and "no" where no error term takes up the misfit."""
        part, untold = self.narrowed_to()
        if self.beyond_error:
            return ["no"] * len(part)
        is_hidden = self.contradicted or self.unknown_scatter() or self.unconverged()
        is_told = (part < 0.4) & (untold < 0.5) & (not is_hidden)
        return np.where(is_told, "yes", np.where(part < 0.75, "partly", "no")).tolist()

    def combinations(self):
        """Texts: parameters that the data determine together only, of those that are not determined alone: sums of
        values or products, whichever are known best. Of each set of them the narrowest direction of the covariance, in
        units of that before: v_i (x_i - mean)/d_i is known, so sum_i v_i/d_i x_i is; small whole powers where they are
        at most 1.5 times as wide."""
        free, found, named = np.flatnonzero(np.max(self.narrowed_to() / np.array([[0.4], [0.5]]), axis=0) > 1), [], []
        for is_log, scale in ((False, np.asarray), (True, np.log)):
            some = [(i, self.problem.parameters[i], self.posterior.at[:, i]) for i in free]
            some = [(i, p, u) for i, p, u in some if p.low > 0 or not is_log]
            if len(some) > 1 and (is_log or len({p.unit for _, p, _ in some}) == 1):  # values of two units have no sum
                deviation = np.array([p.deviation(scale) for _, p, _ in some])
                covariance = np.cov([scale(p.value(u)) / d for (_, p, u), d in zip(some, deviation)])
                found.append((covariance, deviation, [i for i, _, _ in some], is_log))
        if not found:
            return []
        covariance, deviation, of, is_log = min(found, key=lambda row: np.linalg.eigvalsh(row[0])[0])

        def width(powers):
            w = powers * deviation
            return np.sqrt(w @ covariance @ w / (w @ w))

        texts, indices = [], range(len(of))
        for some in (list(some) for size in indices for some in itertools.combinations(indices, size + 1) if size):
            vector = np.linalg.eigh(covariance[np.ix_(some, some)])[1][:, 0]
            chosen = np.zeros(len(of))
            chosen[some] = vector / deviation[some] / (vector[0] / deviation[some[0]] or 1)
            whole = [np.round(n * chosen) for n in (1, 2, 3)] if is_log else []
            chosen = next((row for row in whole if row[some].all() and width(row) < 1.5 * width(chosen)), chosen)
            is_new = len(of) - 1 > len(named) < np.linalg.matrix_rank([*named, chosen])  # as many tell each of them
            if np.abs(vector).min() > 0.1 and width(chosen) < 0.4 and is_new:
                named.append(chosen)
                texts.append(self._combined([of[i] for i in some], chosen[some], is_log))
        return texts

    def _combined(self, of, powers, is_log):
        """A sentence on what is determined of the parameters `of` these numbers: a product of `powers`, or a sum with
        these coefficients, of which the first is positive; with its value and interval. Where the data determine
        another function, of which this is the tangent, it bends along the draws: a parabola leaves less than half of
        the variance that a plane leaves."""
        some, powers = [self.problem.parameters[i] for i in of], [float(f"{c:.{3 - is_log}g}") for c in powers]
        x = np.array([p.value(self.posterior.u[:, i]) for i, p in zip(of, some)])
        if is_log:
            units = {p.unit: sum(c for other, c in zip(some, powers) if other.unit == p.unit) for p in some if p.unit}
            unit = " ".join(name if c == 1 else f"({name})^{c:g}" for name, c in units.items() if c)
            text = "".join("/ "[c > 0] + p.name + f"^{abs(c):g}" * (abs(c) != 1) for p, c in zip(some, powers)).strip()
            x = np.log(x)
        else:
            text, unit = some[0].name, some[0].unit
            text += "".join(f" {'-' if c < 0 else '+'} {abs(c):g} {p.name}" for p, c in zip(some[1:], powers[1:]))
        y, z = powers @ x, (x - x.mean(axis=1, keepdims=True))[1:]
        plane = np.vstack([np.ones(len(y)), *z])
        bent = np.vstack([plane, *(a * b for a, b in itertools.combinations_with_replacement(z, 2))])
        of_plane, of_bent = (np.var(y - np.linalg.lstsq(a.T, y, rcond=None)[0] @ a) for a in (plane, bent))
        what = "a combination near the" if of_bent < 0.5 * of_plane else "the"
        kind = (("product", "ratio") if is_log else ("sum", "difference"))[int(len(of) == 2 and powers[1] < 0)]
        y = np.percentile(np.exp(y) if is_log else y, [50, *self.posterior.tails])
        middle, low, high = (f"{end:.4g}" for end in y)
        text += f" = {middle} {unit}".rstrip() + f" ({100 * self.problem.options['interval']:g} %: {low} to {high})"
        return (f"only {what} {kind} {text} is determined, not each of "
                + ", ".join(p.name for p in some))

    def further_tests(self):
        """(what would be measured, part by which the interval of each parameter would shrink, the scatter and the model
        error of this, over its level) of all candidates and left-out measurements, measured once: with the scatter of
        seeds, at least 3 %, where none is given, and the model error that the fit found. Linear regression of the
        draws."""
        x, error, found = self.posterior.at - self.posterior.at.mean(axis=0), float(np.median(self.posterior.tau)), []
        for m in (m for m in self.problem.measured if m.use != "fit" and m.title in self.emulators):
            mean, emulator = self.emulators[m.title](self.posterior.at)[0], self.emulators[m.title]
            level = np.abs(mean).max() if m.values is None else m.level
            scatter = m.scatter or max((m.part or 0.03) * level, np.sqrt(np.diag(emulator.seed_covariance()).max()))
            f, one = mean - mean.mean(axis=0), np.eye(m.size)
            of_data = (scatter**2 + (error * level) ** 2) * correlation(m.x) + m.noise**2 * one
            both = f.T @ x / len(f)
            gain = (both * np.linalg.solve(f.T @ f / len(f) + of_data, both)).sum(axis=0) / x.var(axis=0)
            found.append((m.title, 1 - np.sqrt(np.clip(1 - gain, 0, 1)), float(scatter / level), error))
        return found

    def predictions(self):
        """(measured, low, middle, high) of one mean of specimens as those that were measured."""
        rng, found, tau = np.random.default_rng(1), [], self.posterior.tau[:500]
        for m in (m for m in self.problem.measured if m.title in self.emulators):
            emulator = self.emulators[m.title]
            mean, variance = emulator(self.posterior.at[:500])
            factor = np.linalg.cholesky(data_covariance(m, emulator, tau) + emulator.spread(variance))
            y = mean + (factor @ rng.standard_normal((*mean.shape, 1)))[:, :, 0]
            found.append((m, *np.percentile(y, [self.posterior.tails[0], 50, self.posterior.tails[1]], axis=0)))
        return found


def least_squares(problem, runs, log=lambda text: None):
    """(place, residuals in standard deviations) of the best of all runs: bounded least squares from the starts by
    scipy. Slopes are differences over a tenth of the bounds, so that the roughness of one mesh does not turn their
    sign; where the search ends far from the data it goes on from the best of all runs, over a fifth, to the other side.
    A run without a value is a refused step."""
    start = np.clip([0.5 if p.start is None else float(p.place(p.start)) for p in problem.parameters], 0.01, 0.99)
    best, fitted = (np.inf, "", start, None), problem.fitted

    def residuals(u):
        nonlocal best
        if problem.rounded(u) not in runs.values and runs.n_runs + runs.per_point > problem.options["budget"]:
            raise Stop(f"the budget of {problem.options['budget']} runs is used up; the best so far: {best[1]} "
                       f"(root of the sum of squares {best[0]:.3g} deviations)")
        where = ", ".join(f"{p.name} = {p.text(x)}" for p, x in zip(problem.parameters, u))
        k = runs.at([u])[0]
        values = [runs.of(m)[k] for m in fitted]
        for m in (m for m, found in zip(fitted, values) if not np.isfinite(found).all(axis=1).any()):
            text = f"{m.title}: no value at {where}: {runs.cause(m.test, k)}"
            if np.isinf(best[0]):
                raise Stop(text)
            log(text)
            return np.full(sum(m.size for m in fitted), np.nan)
        found = np.concatenate([(np.nanmean(of, axis=0) - m.values) / (m.scatter or 0.01 * m.level) / m.size**0.5
                                for m, of in zip(fitted, values)])
        root = float(np.sqrt(found @ found))
        numbers = [f"{m.title} {np.nanmean(of):.6g} {m.unit}, " for m, of in zip(fitted, values) if m.size == 1]
        log(f"{where}: {''.join(numbers)}root of the sum of squares {root:.3g} deviations")
        best = min(best, (root, where, u, found), key=lambda one: one[0])
        return found

    def slopes(u):
        columns, here = [], residuals(u)
        for i, x in enumerate(u):
            sides = [h for h in (step, -step, step / 4, -step / 4) if 0 <= x + h <= 1]
            found = ((residuals(u + h * (np.arange(len(u)) == i)) - here) / h for h in sides)
            columns.append(next((column for column in found if np.isfinite(column).all()), np.zeros(len(here))))
        return np.array(columns).T

    if not runs.values:
        runs.add([start])
        problem.check_first(runs)
    optimize, found = need("least squares", "scipy.optimize"), None
    for step in (0.1, -0.2):
        try:
            found = optimize.least_squares(residuals, best[2], slopes, bounds=(0, 1), xtol=2e-3, ftol=1e-4)
        except Stop:
            if found is None:
                raise
        if 2 * found.cost <= 4 * len(fitted):
            break
    return best[2:]
