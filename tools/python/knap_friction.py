"""Friction over pressure of rock joints and rock, as the key `friction_over_pressure` takes it.

    import knap, knap_friction as friction
    table = friction.barton_bandis(JRC=8, JCS=60e6, phi_b=28, up_to=5e6)      # pairs [pressure, shear], Pa
    table = friction.of_tests(*friction.read("shear_box.csv"))                # the nearest concave polygon
    table, gamma = friction.of_strengths([0, 20e6], [127e6, 405e6], sigma_c=9e6)
    print(friction.toml(table))                                               # a line for the scenario
    knap.run("joint", set={"interface.joint.friction_over_pressure": table})

All are polygons from (0, 0) on, concave and not falling, of at most 12 pieces; beyond its end the last slope goes on.
Needs numpy.
"""
import knap
import numpy as np

most_pieces = 12
largest_angle = 70  # degrees, of Barton's law: below the pressure at which it is reached, the angle stays


class FrictionError(knap.KnapError, ValueError):
    """An argument or a file of which no table can be made."""


def barton_bandis(JRC, JCS, phi_b, up_to, length=None, sample=0.1, pieces=most_pieces):
    """N. Barton, S. Bandis (1982): tau = sigma_n tan(phi_b + JRC log10(JCS/sigma_n)), angles in degrees, stresses in
    Pa, at most 70 degrees, as points on the curve up to the pressure `up_to`, at most JCS. From 1e-5 up_to on 12 chords
    are at most 3 % below it with phi_b of 20 degrees or more (6 % with 10); further below, the first one goes on to 0.
    With `length` [m], that of the joint in the field, of samples of the length `sample`:
    JRC (length/sample)^(-0.02 JRC), JCS (length/sample)^(-0.03 JRC)."""
    _check_pieces(pieces)
    if not 0 <= JRC <= 20 or not 0 < phi_b < largest_angle:
        raise FrictionError(f"JRC is from 0 to 20 and phi_b from 0 to {largest_angle} degrees, not {JRC:.4g} and "
                            f"{phi_b:.4g}")
    if length is not None:
        if not 0 < length < np.inf or not 0 < sample < np.inf:
            raise FrictionError(f"the lengths of joint and sample are above 0 m, not {length:.4g} and {sample:.4g}")
        ratio = length / sample
        JRC, JCS = JRC * ratio**(-0.02 * JRC), JCS * ratio**(-0.03 * JRC)
    if not 0 < up_to <= JCS:
        raise FrictionError(f"the pressure must be above 0 and at most JCS = {JCS:.4g} Pa, where the law ends, not "
                            f"{up_to:.4g} Pa")

    def shear(pressure):
        return pressure * np.tan(np.radians(np.minimum(phi_b + JRC * np.log10(JCS / pressure), largest_angle)))

    bend = JCS * 10**(-(largest_angle - phi_b) / JRC) if JRC > 0 else np.inf  # where 70 degrees are reached
    if bend >= up_to or JRC == 0:
        return [[0, 0], [up_to, float(shear(up_to))]]
    knots = np.geomspace(up_to, max(bend, 1e-5 * up_to), pieces)[::-1]  # chords miss the curve by equal parts of it
    return [[0, 0]] + [[float(p), float(shear(p))] for p in knots]


def of_tests(pressure, shear, pieces=most_pieces):
    """The concave polygon through (0, 0) that does not fall and misses the points of a test series least in the sense
    of least squares. What shear the series has without pressure is the cohesion of the interface: subtract
    gamma sigma_c first."""
    _check_pieces(pieces)
    pressure, shear = np.asarray(pressure, float), np.asarray(shear, float)
    if len(pressure) < 1 or pressure.shape != shear.shape or not np.isfinite([pressure, shear]).all():
        raise FrictionError("a test series has as many pressures as shears, all of them numbers")
    if (pressure <= 0).any() or (shear < 0).any():
        raise FrictionError("pressures of tests are above 0 and shears at least 0 (compression positive)")
    knots = np.unique(pressure)
    # f = sum a_j min(p, p_j), a_j >= 0, are all of these polygons, with a_n p for the last slope
    knots = np.append(knots[:-1], np.inf)
    while True:
        weights = _least_squares(np.minimum(pressure[:, None], knots), shear)
        used = weights > 1e-9 * weights.max(initial=0)
        if not used.any():
            raise FrictionError("the test series has no friction")
        used[-1] = True  # the last piece, which may be level
        if used.sum() <= pieces:
            break
        knots = knots[used]  # leave out the bend that matters least
        costs = [_misfit(np.minimum(pressure[:, None], np.delete(knots, j)), shear) for j in range(len(knots) - 1)]
        knots = np.delete(knots, int(np.argmin(costs)))
    knots, weights = knots[used], weights[used]
    ends = [0.0] + [float(k) for k in knots if np.isfinite(k)]
    ends.append(max(float(pressure.max()), 2 * ends[-1]))
    return [[p, float(np.sum(weights * np.minimum(p, knots)))] for p in ends]


def of_strengths(confinement, strength, sigma_c, coupling="norm"):
    """Of largest stresses over confinements [Pa, compression positive]: their polygon sigma_1 = a + K sigma_3, concave,
    piece by piece as Coulomb's lines with mu = (K - 1)/(2 sqrt K), c = a/(2 sqrt K). Returns the table and gamma, with
    which the law bears just these stresses in its worst direction. Coupling "sum" has friction on the pressure that
    balances the tensile strength sigma_c, too, and can bear them only where the first line has shear left at
    -sigma_c."""
    if coupling not in ("sum", "norm"):
        raise FrictionError(f'coupling is "sum" or "norm", not {coupling!r}')
    if not 0 < sigma_c < np.inf:
        raise FrictionError(f"sigma_c is above 0 Pa, not {sigma_c:.4g}")
    at, top = (np.asarray(x, float) for x in (confinement, strength))
    if len(at) < 2 or at.shape != top.shape or (np.diff(at) <= 0).any() or at[0] < 0:
        raise FrictionError("strengths belong to at least two confinements that ascend from 0 or more on")
    if not np.isfinite([at, top]).all() or (top <= 0).any():
        raise FrictionError("confinements and strengths are numbers, and strengths above 0")
    K = np.diff(top) / np.diff(at)
    if (np.diff(K) > 1e-9 * K[0]).any():
        raise FrictionError("the strengths are not concave over the confinement")
    if (K < 1).any():
        raise FrictionError("a strength grows by less than the confinement: this is no friction")
    mu, c = (K - 1) / (2 * np.sqrt(K)), (top[:-1] - K * at[:-1]) / (2 * np.sqrt(K))
    shift = 0 if coupling == "norm" else sigma_c  # of the pressure that friction sees
    c = c - mu * shift
    if c[0] < 0:
        raise FrictionError(f"the first two strengths leave a shear of {c[0]:.4g} Pa at the tension sigma_c: no law of "
                            f"coupling = \"sum\" has both, whatever its friction; a smaller sigma_c, or "
                            f"coupling = \"norm\"")
    bends = [float((c[i + 1] - c[i]) / (mu[i] - mu[i + 1])) for i in range(len(mu) - 1) if mu[i] > mu[i + 1]]
    _check_pieces(len(bends) + 1)
    ends = [0.0] + bends + [2 * max(bends, default=float(top.max()))]
    return [[p, float(np.min(mu * p + c) - c[0])] for p in ends], float(c[0] / sigma_c)


def read(file):
    """Pressures and shears [Pa] of a csv file with a line of names `pressure [MPa], shear [MPa]`. # starts a
    comment."""
    read = knap.read_csv(file, comment="#")
    table = knap.Table({name.strip(): read[name] for name in read},
                       {name.strip(): unit for name, unit in read.units.items()})
    missing = [name for name in ("pressure", "shear") if name not in table]
    if missing:
        raise FrictionError(f"{file} has no column {' and '.join(missing)}")
    factor = {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
    for name in ("pressure", "shear"):
        if table.units.get(name) not in factor:
            raise FrictionError(f"{file}: the unit of {name} is not one of {', '.join(factor)}")
    return tuple(table[name] * factor[table.units[name]] for name in ("pressure", "shear"))


def toml(table):
    """The line of a scenario."""
    pairs = ", ".join(f'["{p / 1e6:.6g} MPa", "{t / 1e6:.6g} MPa"]' for p, t in table)
    return f"friction_over_pressure = [{pairs}]"


def _check_pieces(pieces):
    if pieces not in range(1, most_pieces + 1):
        raise FrictionError(f"a table has 1 to {most_pieces} pieces, not {pieces}")


def _misfit(A, b):
    return np.linalg.norm(A @ _least_squares(A, b) - b)


def _least_squares(A, b):
    """The x >= 0 of least |A x - b| (C. L. Lawson, R. J. Hanson 1974)."""
    size = np.linalg.norm(A, axis=0)
    size[~np.isfinite(size) | (size == 0)] = 1
    A = A / size
    x, used = np.zeros(A.shape[1]), np.zeros(A.shape[1], bool)
    for _ in range(10 * A.shape[1]):
        gain = A.T @ (b - A @ x)
        gain[used] = -np.inf
        if gain.max(initial=-np.inf) <= 1e-12 * np.linalg.norm(b):
            break
        used[int(np.argmax(gain))] = True
        while True:
            y = np.zeros_like(x)
            y[used] = np.linalg.lstsq(A[:, used], b, rcond=None)[0]
            falls = used & (y <= 0)
            if not falls.any():
                break
            part = np.min(x[falls] / (x[falls] - y[falls]))
            x = x + part * (y - x)
            used &= x > 1e-14 * x.max(initial=0)
            x[~used] = 0
        x = y
    return x / size
