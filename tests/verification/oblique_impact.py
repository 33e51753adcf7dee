# SPDX-License-Identifier: BSD-2-Clause
"""Oblique impact of an elastic sphere with Coulomb friction, without waves (Maw, Barber and Fawcett 1976, Wear 38, 101; 1981, J.
Lubrication Technol. 103, 74; Jäger 1994, Acta Mech. 107, 101).

A sphere of radius R and mass m meets a half-space of its own material, or two like spheres meet: m and R are then half of theirs,
velocities are relative, R ω is the sum for both, and each sphere has half of the changes of v_x and R ω given below.
Because the materials are the same, tangential tractions do not move the surfaces normally, and the normal motion is that of Hertz.

    v_n, v_t     normal and tangential velocity of the contact point [m/s]: v_t = v_x - R ω, with ω > 0 in forward rolling
    K²           (radius of gyration / R)²: 2/5 for a solid sphere
    κ            ratio of tangential to normal stiffness: 2 (1 - ν) / (2 - ν)
    χ            κ (1 + 1/K²) / 2 = (1 - ν) (1 + 1/K²) / (2 - ν): 3.5 (1 - ν) / (2 - ν) for a solid sphere, 1.4412 at ν = 0.3
    ψ            κ v_t / (μ v_n1), where v_n1 is the normal velocity before the impact; ψ1 before the impact, ψ2 after it

Friction of force Q changes v_t at the rate -(1 + 1/K²) Q / m and normal force N changes v_n at the rate -N / m, thus

    dψ = 2χ Q/(μN) d(v_n/v_n1),      v_n/v_n1 from 1 to -1:

sliding throughout gives ψ2 = ψ1 - 4χ. Under q = μp the surface moves tangentially at μ/κ times the normal velocity, so that sliding
lasts throughout if ψ > v_n/v_n1 throughout, which is ψ1 > 4χ - 1 (if χ > 1/2). The problem depends only on χ and ψ1. ψ2 is odd in ψ1.

Assumption of Maw, Barber and Fawcett. The displacement under tractions q along x is

    u_x = 1/(2πG) ∫ q [(1 - ν)/d + ν Δx²/d³] dA,      d the distance, Δx its component along x.

Under an axisymmetric q, the second term has a mean over the circle, which makes (1 - ν/2)/d of the bracket, and a part with
cos 2θ; u_y has a part with sin 2θ. These parts are neglected. The tangential problem then has the same kernel as the normal one,
1/κ times as soft, and friction is along x everywhere. For ν = 0 this is exact. Otherwise only the direction of slip in an
annulus is inexact: while the circle r < c sticks, q changes by a sum of (x² - r²)^(-1/2), x > c (see below), under each of which
that circle moves uniformly, without the neglected parts; in the annulus they turn the slip away from the friction, by about
ν/(4 - 2ν) = 0.09 at ν = 0.3 (Johnson 1985, section 7.2). If everything slides, q = μp, the neglected parts of u do not change with
time (in Johnson's 3.91 the terms with x² and y² have the constant factor p_0/a): ψ2 = ψ1 - 4χ is exact for all ν.

Reduction to springs, exact for this problem (used by `impact`). Let x be from 0 to a, and let q(r) = -(1/π) ∫_r^a g'(x)
(x² - r²)^(-1/2) dx. The displacement is then (2/π) ∫_0^r w(x) (r² - x²)^(-1/2) dx with w proportional to g: independent springs
(Popov and Heß, Method of Dimensionality Reduction, 2015). For Hertz's pressure the compression of a spring is δ - x²/R: it touches
at the approach s = x²/R. Scale the deflection w of a tangential spring by κ/μ. Let each spring obey Coulomb's law, |w| ≤ δ - s. Then

1. |∂w/∂s| ≤ 1 always: stuck springs keep their slope; sliding ones have the slope ∓1; a spring that touches while the edge sticks
   gets the slope -ψ v_n1/v_n, and the edge sticks if |ψ| v_n1 ≤ v_n. By the first formula |q| ≤ μp everywhere.
2. δ - s ∓ w therefore do not increase in s: springs slide in an outer range c < x < a, in one direction. By the first formula
   q = ±μp in c < r < a, and by the second the annulus slips by a mean of the slips of the springs x < r, which all have the sign of q.
3. Springs x < c do not slip, and therefore the circle r < c does not.

These are all conditions of the three-dimensional problem. `annuli` solves that problem without this reduction, for comparison.

Units below: the maximum approach, v_n1 and m are 1, and the contact radius is 1 at maximum approach. Then with v_n = cos θ,

    δ = sin^(4/5) θ,      a = δ^(1/2),      dt = 4/5 sin^(-1/5) θ dθ,      0 ≤ θ ≤ π.

The nodes of the radius are the radii of the contact at the time steps, during loading and unloading, so that its edge is always a
node. Steps and nodes are of second order."""

from dataclasses import dataclass

import numpy as np

SOLID_SPHERE = 2 / 5  # K²
DURATION = 2.943275  # of the contact, in units of (maximum approach) / v_n1


def stiffness_ratio(poisson):
    """κ: tangential divided by normal stiffness of the contact of like bodies (both without slip)."""
    return 2 * (1 - poisson) / (2 - poisson)


def chi(poisson, gyration=SOLID_SPHERE, kappa=None):
    """χ of the module's docstring; `gyration` is K². Another `kappa` than that of like bodies can be given."""
    return (stiffness_ratio(poisson) if kappa is None else kappa) * (1 + 1 / gyration) / 2


def psi(poisson, friction, tangential, normal, kappa=None):
    """ψ of the tangential velocity, where `normal` is the approach velocity before the impact (both m/s)."""
    return (stiffness_ratio(poisson) if kappa is None else kappa) * tangential / (friction * normal)


def rigid_coulomb(psi1, chi):
    """ψ2 of a rigid sphere: sliding slows to rolling, which then lasts. ψ1 - 4χ beyond ψ1 = 4χ, otherwise 0."""
    return np.sign(psi1) * np.maximum(np.abs(psi1) - 4 * chi, 0)


def gross_slip(psi1, chi):
    """ψ2 = ψ1 - 4χ if an elastic sphere slides throughout, which is ψ1 > max(1, 4χ - 1); otherwise nan."""
    return np.where(np.abs(psi1) >= max(1, 4 * chi - 1), np.sign(psi1) * (np.abs(psi1) - 4 * chi), np.nan)


def steps(cells):
    """Time, v_n and δ at the 2 `cells` + 1 steps. Steps are of equal size in a + 2θ/π during loading, and mirrored."""
    dense = np.linspace(0, 1, 20 * cells + 1) ** 2.5 * np.pi / 2
    theta = np.interp(np.linspace(0, 2, cells + 1), np.sin(dense) ** 0.4 + 2 * dense / np.pi, dense)
    point, weight = np.polynomial.legendre.leggauss(5)  # dt = (θ / sin θ)^(1/5) dy with y = θ^(4/5) is smooth
    y = theta**0.8
    inner = ((y[:-1, None] + y[1:, None] + np.diff(y)[:, None] * point) / 2) ** 1.25
    slices = ((inner / np.sin(inner)) ** 0.2 * weight).sum(axis=1) * np.diff(y) / 2
    time = np.concatenate([[0], np.cumsum(np.concatenate([slices, slices[::-1]]))])
    velocity, approach = np.cos(theta), np.sin(theta) ** 0.8
    velocity[-1] = 0
    return (
        time,
        np.concatenate([velocity, -velocity[-2::-1]]),
        np.concatenate([approach, approach[-2::-1]]),
    )


@dataclass
class History:
    """Of one or more impacts; the last axis of 2-D members is that of ψ1."""

    time: np.ndarray  # divided by (maximum approach) / v_n1
    normal: np.ndarray  # normal force divided by its maximum
    psi: np.ndarray
    force: np.ndarray  # tangential force divided by μ times the maximum normal force
    stick: np.ndarray  # radius within which nothing slips in this step, divided by that at maximum approach
    heat: np.ndarray  # frictional work up to this time, scaled so that ψ²/(4χ) is the kinetic energy


def march(psi1, chi, cells, update, rounds=4):
    """Time steps of ψ. `update(k, old, edge, travel)` gives the new state of the contact of edge node `edge`, the ratio Q/(μN), the
    number of stuck nodes and the frictional work, if the bodies have moved by `travel` relative to one another.
    """
    time, velocity, approach = steps(cells)
    rows = len(time)
    out = History(
        time, approach**1.5, np.zeros((rows, len(psi1))), *(np.zeros((rows, len(psi1))) for _ in "123")
    )
    radius = np.sqrt(approach)
    ratio = np.clip(psi1, -1, 1)
    out.psi[0] = psi1
    state = None
    for k in range(1, rows):
        edge = min(k, rows - 1 - k)
        before, factor = out.psi[k - 1], chi * (velocity[k] - velocity[k - 1])
        after = before + factor * 2 * ratio
        for _ in range(
            rounds
        ):  # each multiplies the error by a small multiple of the square of the time step
            new, fresh, stuck, heat = update(
                state, edge, (before + after) / 2 * (time[k] - time[k - 1]), ratio
            )
            after = before + factor * (ratio + fresh)
        state, ratio = new, fresh
        out.psi[k] = after
        out.force[k] = ratio * approach[k] ** 1.5
        out.stick[k] = radius[stuck]
        out.heat[k] = out.heat[k - 1] + heat
    return out


def springs(psi1, chi, cells):
    """`History` by independent springs, for an array of ψ1."""
    depth = steps(cells)[2][: cells + 1]  # approach at which the springs touch
    slices = np.diff(depth**1.5) / np.diff(depth)  # Q/(μN) = -Σ slices Δw / δ^(3/2)
    # ∫ f dx of a function that is linear in s = x² between the nodes
    lower = (depth[1:] * np.diff(depth**0.5) - np.diff(depth**1.5) / 3) / np.diff(depth)
    upper = np.diff(depth**0.5) - lower

    def update(old, edge, travel, ratio):
        old = np.zeros((cells + 1, len(psi1))) if old is None else old
        new = np.zeros_like(old)
        room = (depth[edge] - depth[:edge])[:, None]
        free = old[:edge] + travel
        new[:edge] = np.clip(free, -room, room)
        slip = free - new[:edge]
        stuck = (slip == 0).sum(axis=0)
        if edge == 0:
            return new, ratio, stuck, 0
        fresh = -(np.diff(new[: edge + 1], axis=0) * slices[:edge, None]).sum(axis=0) / depth[edge] ** 1.5
        power = np.zeros((edge + 1, len(psi1)))
        power[:-1] = slip * (old[:edge] + new[:edge]) / 2
        heat = 15 / 8 * (lower[:edge, None] * power[:-1] + upper[:edge, None] * power[1:]).sum(axis=0)
        return new, fresh, stuck, heat

    return march(np.asarray(psi1, float), chi, cells, update)


def disc_displacement(r, a):
    """Mean tangential displacement at the radius r under the traction (a² - r²)^(1/2), scaled so that it is a² - r²/2 in the circle
    r ≤ a (Johnson 1985, equations 3.41a and 3.42a; mean over the circle of radius r)."""
    out = np.maximum(r, a)
    beyond = ((2 * a**2 - out**2) * np.arcsin(a / out) + a * np.sqrt(out**2 - a**2)) / np.pi
    return np.where(r <= a, a**2 - r**2 / 2, beyond)


def annuli(psi1, chi, cells):
    """`History` by tractions of the half-space, for one or more ψ1: Mindlin's basis (a_j² - r²)^(1/2) of all radii a_j of nodes.
    At each node either its displacement changes by that of the bodies, and |q| < μp, or q = ±μp and it slips along q. A node
    that touches retains the displacement it had outside of the contact. `heat` is not computed."""
    radius = np.sqrt(steps(cells)[2][: cells + 1])
    here, edges = radius[:-1, None], radius[1:]
    traction = np.sqrt(np.maximum(edges**2 - here**2, 0))
    basis = np.linalg.inv(traction)  # upper triangular, so that its leading blocks belong to smaller contacts
    flexibility = disc_displacement(here, edges) @ basis
    force = edges**3 @ basis

    def one(old, edge, travel, memory):
        new = np.zeros(cells)
        if edge == 0:
            return new, 0, None
        bound = traction[:edge, edge - 1]
        target = flexibility[:edge] @ old + travel
        slides = np.concatenate([memory[:edge], np.zeros(max(edge - len(memory), 0))])
        block = flexibility[:edge, :edge]
        for round in range(200):
            stuck, q = slides == 0, slides * bound
            if stuck.any():
                rest = target[stuck] - block[np.ix_(stuck, ~stuck)] @ q[~stuck]
                q[stuck] = np.linalg.solve(block[np.ix_(stuck, stuck)], rest)
            slip = target - block @ q
            starts = stuck & (np.abs(q) > bound * (1 + 1e-12))
            ends = ~stuck & (slip * slides < -1e-12)
            if not (starts | ends).any():
                break
            if round > 20:  # one change a round ends in every case that was seen
                first = np.flatnonzero(starts | ends)[-1]
                starts, ends = (mask & (np.arange(edge) == first) for mask in (starts, ends))
            slides = np.where(starts, np.sign(q), np.where(ends, 0, slides))
        else:
            raise ArithmeticError(f"no consistent sets of stick and slip with {edge} annuli")
        new[:edge] = q
        return new, force[:edge] @ q / radius[edge] ** 3, slides

    def update(old, edge, travel, ratio):
        old = [(np.zeros(cells), np.zeros(0))] * len(travel) if old is None else old
        new, fresh, stuck = [], ratio.copy(), np.zeros(len(travel), int)
        for i, (q, slides) in enumerate(old):
            traction, part, slides = one(q, edge, travel[i], slides)
            new.append((traction, slides))
            if edge:
                fresh[i], stuck[i] = part, np.argmax(np.append(slides, 1) != 0)
        return new, fresh, stuck, 0

    return march(np.atleast_1d(np.asarray(psi1, float)), chi, cells, update)


@dataclass
class Impact:
    """Numbers of one impact, or arrays for an array of ψ1."""

    psi1: float
    psi2: float
    chi: float
    velocity_ratio: float  # tangential velocity after the impact divided by the normal velocity before, v_t2 / v_n1
    restitution: float  # tangential: -v_t2 / v_t1; nan for ψ1 = 0
    spin: float  # change of R ω / v_n1, positive in the direction of forward rolling
    slowing: float  # decrease of the velocity v_x of the centre, divided by v_n1
    dissipated: float  # frictional work divided by the energy m v_n1² / 2 of the normal motion
    error: float  # of ψ2, estimated: its change when the number of cells was doubled, usually 3 times the error


def impact(poisson, friction, psi1, cells=200, gyration=SOLID_SPHERE, kappa=None):
    """`Impact` of spheres with Poisson's ratio `poisson` and coefficient of friction `friction`, incident at ψ1 (`psi`), a number
    or an array. All results are dimensionless. `cells` are those of the contact radius: with 200, ψ2 has errors below 0.0002. The
    bodies are alike; another `kappa` makes a Hertz contact with another ratio of stiffnesses, without coupling.
    """
    ratio = stiffness_ratio(poisson) if kappa is None else kappa
    inertia = chi(poisson, gyration, kappa)
    incident = np.atleast_1d(np.asarray(psi1, float))
    coarse = springs(incident, inertia, cells // 2).psi[-1]
    fine = springs(incident, inertia, cells)
    psi2 = fine.psi[-1]
    change = friction / ratio * (incident - psi2)
    with np.errstate(divide="ignore", invalid="ignore"):
        restitution = -psi2 / incident
    values = [
        incident,
        psi2,
        np.full_like(psi2, inertia),
        friction / ratio * psi2,
        np.where(incident == 0, np.nan, restitution),
        change / (1 + gyration),  # (1/K²) / (1 + 1/K²)
        change * gyration / (1 + gyration),
        2 * (friction / ratio) ** 2 * ratio * fine.heat[-1],
        np.abs(psi2 - coarse),
    ]
    return Impact(*(value if np.ndim(psi1) else float(value[0]) for value in values))


def history(poisson, psi1, cells=200, gyration=SOLID_SPHERE, kappa=None):
    """`History` of the impacts with an array of ψ1, for figures."""
    return springs(np.atleast_1d(np.asarray(psi1, float)), chi(poisson, gyration, kappa), cells)
