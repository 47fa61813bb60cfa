"""What a measurement would be at any place of the parameters, with its uncertainty, from the runs that were made."""
import functools
import warnings

import numpy as np

from . import need


class TooFew(Exception):
    """Too few runs have a value."""


@functools.lru_cache  # scipy takes a third of a chain for it
def students(freedom, interval=0.9):
    """By how much the variance of a normal distribution is larger than one that few numbers tell when its interval is
    as wide as that of Student's t."""
    stats, end = need("an interval", "scipy.stats"), 0.5 + interval / 2
    return (stats.t.ppf(end, min(freedom, 1e9)) / stats.norm.ppf(end)) ** 2


class _Process:
    """The most likely of the Gaussian processes that scikit-learn finds from some starts. Its values are written out
    here: scikit-learn checks all that it is given, at each step of a chain, which takes five times as long."""

    def __init__(self, u, y, noises, noise_bounds):
        gp, k = need("the emulator", "sklearn.gaussian_process"), u.shape[1]
        kernels = gp.kernels
        starts = [kernels.ConstantKernel(4.0, (0.1, 1e3)) * kernels.Matern([length] * k, [(0.05, 30)] * k, nu=2.5)
                  + kernels.WhiteKernel(np.clip(noise, *noises), noise_bounds)
                  for length, noise in ((1.0, 1e-2), (0.3, 1e-2), (3.0, 1e-2), (1.0, 1e-5), (3.0, 1e-5))]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a length at its bound: the value does not depend on that parameter
            found = max((gp.GaussianProcessRegressor(start, random_state=1).fit(u, y) for start in starts),
                        key=lambda process: process.log_marginal_likelihood_value_)
        self.u, self.noise = u, found.kernel_.k2.noise_level
        self.variance, self.length = found.kernel_.k1.k1.constant_value, found.kernel_.k1.k2.length_scale
        self.weights, self.inverse_root = found.alpha_, np.linalg.inv(found.L_)

    def prior(self, a, b):
        """Covariance between the places a and b: s^2 (1 + r + r^2/3) exp(-r), r = 5^(1/2) |a - b|/length (Matern)."""
        r = np.sqrt(5) * np.linalg.norm((a[:, None] - b) / self.length, axis=2)
        return self.variance * (1 + r + r**2 / 3) * np.exp(-r)

    def mean(self, u):
        return self.prior(u, self.u) @ self.weights

    def mean_and_variance(self, u):
        known = self.prior(u, self.u)
        return known @ self.weights, self.variance - ((known @ self.inverse_root.T) ** 2).sum(axis=1)

    def covariance(self, u):
        known = self.prior(u, self.u) @ self.inverse_root.T
        return self.prior(u, u) - known @ known.T


class Emulator:
    """Kriging (scikit-learn) of the values of one measurement. A curve is written by the principal components of its
    values over their deviations: the mean is m + sum_j g_j(u) v_j, its covariance sum_jk v_j v_k r_jk sqrt(var g_j var
    g_k); what the components leave out is `rest` at each place. `noise`: of runs with other seeds at one place, found
    with the other parameters of the covariance (white noise), within the 90 % interval of what runs at the same place
    show. `freedom`: how many numbers tell it. r_jk is the correlation of what the processes leave of the components,
    shrunk by Ledoit and Wolf (J. Multivariate Anal. 88 (2004) 365): a strong peak and a late fall go together."""

    def __init__(self, u, values, level):
        """u: points; values: over points, seeds and places, nan where a run failed; level: to which parts refer, None:
        their own. The search for the covariances starts from fixed places alone: the same runs give the same
        emulator."""
        stats, cov = need("the emulator", "scipy.stats"), need("the emulator", "sklearn.covariance")
        seeds, k = np.isfinite(values).all(axis=2), np.shape(u)[1]
        self.works, n = seeds.any(axis=1), seeds.any(axis=1).sum()  # points
        if n < k + 2:
            raise TooFew(f"only {n} of {len(u)} points have a value")
        count = seeds.sum(axis=1)[self.works]
        y = np.where(seeds[:, :, None], values, 0).sum(axis=1)[self.works] / count[:, None]
        self.n_seeds = count.mean()
        self.u = np.asarray(u)[self.works]
        self.level = np.abs(y).max() if level is None else level
        self.mean, deviation = y.mean(axis=0), np.maximum(y.std(axis=0), max(1e-3 * self.level, 1e-300))
        _, s, v = np.linalg.svd((y - self.mean) / deviation, full_matrices=False)
        part = 1 - np.cumsum(s**2) / max((s**2).sum(), 1e-300)
        r = min(int(np.argmax(part < 1e-4)) + 1, 8) if len(s) > 1 else 1
        self.v, self.dual = (v[:r] * deviation).T, (v[:r] / deviation).T
        g = (y - self.mean) @ self.dual
        self.rest = ((y - self.mean - g @ self.v.T) ** 2).mean(axis=0)
        self.scale = np.maximum(g.std(axis=0), 1e-9)
        # single runs about the mean of all at the same place
        place = np.unique(self.u, axis=0, return_inverse=True)[1].repeat(count)
        runs = (values[self.works][seeds[self.works]] - self.mean) @ self.dual / self.scale
        about = runs - np.array([np.bincount(place, column) / np.bincount(place) for column in runs.T]).T[place]
        repeats = len(runs) - place.max() - 1
        self.processes, self.noise, freedom, bounds = [], np.zeros(r), np.zeros(r), (1e-6, 2.0)
        for j in range(r):
            if repeats:
                square = (about[:, j] ** 2).sum() / self.n_seeds
                bounds = np.clip(square / stats.chi2.ppf([0.95, 0.05], repeats), 1e-6, 2.0)
            exact = bounds[1] < 1.01e-6  # the seeds change nothing
            self.processes.append(_Process(self.u, g[:, j] / self.scale[j], bounds, "fixed" if exact else bounds))
            noise = self.processes[j].noise
            self.noise[j] = noise * self.scale[j] ** 2 if noise > 1.01e-6 else 0
            # n - trace(K (K + noise)^-1) of the points, and those of the seeds
            freedom[j] = np.inf if exact else noise * (self.processes[j].inverse_root**2).sum() + len(runs) - n
        self.freedom = freedom[np.argmax(self.noise)]
        left = np.array([process.mean(self.u) for process in self.processes]).T - g / self.scale
        left = np.where(self.noise > 0, left / np.maximum(left.std(axis=0), 1e-12), 0)
        alike = cov.ledoit_wolf(left, assume_centered=True)[0] if r > 1 else np.eye(1)
        np.fill_diagonal(alike, 1)
        self.root = np.linalg.cholesky(alike)
        self.noise_factor = students(max(self.freedom, 1))

    def __call__(self, u):
        """Mean (places of u, places of the curve) and the variances of its components (places of u, components)."""
        g, variance = np.transpose([process.mean_and_variance(u) for process in self.processes], (1, 2, 0))
        return self.mean + g * self.scale @ self.v.T, np.maximum(variance, 1e-12) * self.scale**2

    def spread(self, variance):
        """Covariance of the values, of variances of the components."""
        w = self.v @ (np.sqrt(variance)[..., None] * self.root)
        return w @ np.swapaxes(w, -1, -2)

    def seed_covariance(self):
        """Of the values of single runs that differ in their seed."""
        return (self.spread(self.noise) + np.diag(self.rest)) * self.n_seeds * self.noise_factor

    def covariances(self, u):
        """Of each component between all places of u."""
        return [s**2 * process.covariance(u) for s, process in zip(self.scale, self.processes)]

    def draws(self, u, n=100):
        """Of a number: n functions as probable as the runs leave them, a column of values at the places u for each."""
        factor = np.linalg.cholesky(self.covariances(u)[0] + 1e-6 * self.scale[0] ** 2 * np.eye(len(u)))
        return self(u)[0] + self.v[0, 0] * factor @ np.random.default_rng(1).standard_normal((len(u), n))


class Success:
    """Where runs have a value, by a Gaussian process of the points that have one (`works`) and those that have none
    (scikit-learn): failed runs tell where the parameters cannot be, and where no further run is worth its time."""

    def __init__(self, u, works):
        self.process = None
        if not works.all():
            gp = need("the emulator", "sklearn.gaussian_process")
            lengths = gp.kernels.Matern([1.0] * u.shape[1], (0.1, 10), nu=2.5)
            kernel = gp.kernels.ConstantKernel(4.0, (0.5, 100)) * lengths
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a length at its bound: failure does not depend on that parameter
                self.process = gp.GaussianProcessClassifier(kernel, random_state=1).fit(u, works)

    def log(self, u):
        """Logarithm of the probability of a value at each place of u, at least 0.001."""
        if self.process is None:
            return np.zeros(len(u))
        return np.log(np.maximum(self.process.predict_proba(u)[:, 1], 1e-3))
