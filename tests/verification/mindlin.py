# SPDX-License-Identifier: BSD-2-Clause
"""Closed forms with Coulomb friction: a sphere under a tangential force (Cattaneo 1938, Mindlin 1949, Mindlin and Deresiewicz 1953,
as in Johnson 1985, Contact Mechanics, sections 7.2 and 7.4), a block on a belt, and an elastic rod with friction at its end.

Spheres. A normal force P presses a sphere on a plane, or two spheres on one another, with contact radius a (hertz_theory.radius). P
stays constant and the tangential force T changes, |T| < μP. The tangential displacement of distant points of one body relative to
those of the other is δ, and without slip

    δ = C T / a,      C = Σ (2 - ν_i) / (8 G_i)      summed over the elastic bodies (a rigid one adds nothing).

The bodies are alike (two like spheres, or a sphere on a half-space of its material), or one is rigid and the other incompressible.
Otherwise tangential tractions also move the surface normally, which is neglected: for a sphere with ν = 0.3 on a rigid plane
Dundurs' β = (1 - 2ν) / (2 (1 - ν)) is 0.29. Slip in the annulus is assumed to be along T; for ν > 0 it deviates a little (the
parts with cos 2θ and sin 2θ in oblique_impact.py). Distant points are several a away; on a ball, a « R is assumed."""

from dataclasses import dataclass

import numpy as np

# ---- Sphere under a tangential force ----


def shear_modulus(young, poisson):
    """G [Pa]."""
    return young / (2 * (1 + poisson))


def compliance(*bodies):
    """C [1/Pa] of the elastic bodies, each (Young's modulus [Pa], Poisson's ratio)."""
    return sum((2 - poisson) / (8 * shear_modulus(young, poisson)) for young, poisson in bodies)


def stick_radius(tangential, normal, friction):
    """c/a of the first loading: the annulus c < r < a slips. Forces in N."""
    return np.cbrt(1 - np.abs(tangential) / (friction * normal))


def sliding_displacement(normal, friction, a, compliance):
    """Displacement [m] at which T = μP and everything slides: 3 μ P C / (2a)."""
    return 1.5 * friction * normal * compliance / a


def displacement(tangential, normal, friction, a, compliance):
    """δ [m] of the first loading (Johnson 7.42): (3 μ P C / 2a) (1 - (1 - T/μP)^(2/3)). Odd in T; slope C/a at T = 0."""
    reached = 1 - np.abs(tangential) / (friction * normal)
    return (
        np.sign(tangential) * sliding_displacement(normal, friction, a, compliance) * (1 - reached ** (2 / 3))
    )


def tangential_force(displacement, normal, friction, a, compliance):
    """T [N] of the first loading up to the displacement [m], the inverse of `displacement`; μP beyond the sliding displacement."""
    part = np.minimum(np.abs(displacement) / sliding_displacement(normal, friction, a, compliance), 1)
    return np.sign(displacement) * friction * normal * (1 - (1 - part) ** 1.5)


def traction(r, tangential, normal, friction, a):
    """q [Pa] at the radius r [m] in the first loading: μ times Hertz's pressure, minus the same of the stick circle scaled by c/a."""
    peak = 1.5 * friction * normal / (np.pi * a**2)
    c = stick_radius(tangential, normal, friction)
    whole, inner = (np.sqrt(np.maximum(size**2 - (r / a) ** 2, 0)) for size in (1, c))
    return np.sign(tangential) * peak * (whole - inner)


def unloading(tangential, amplitude, normal, friction, a, compliance):
    """δ [m] while T decreases from the amplitude T* > 0 to -T* (Johnson 7.44): the annulus slips back as under T* - T with 2μ:

    (3 μ P C / 2a) (2 (1 - (T* - T)/2μP)^(2/3) - (1 - T*/μP)^(2/3) - 1)."""
    limit = friction * normal
    back = 2 * (1 - (amplitude - tangential) / (2 * limit)) ** (2 / 3)
    return sliding_displacement(normal, friction, a, compliance) * (
        back - (1 - amplitude / limit) ** (2 / 3) - 1
    )


def reloading(tangential, amplitude, normal, friction, a, compliance):
    """δ [m] while T increases from -T* to T*: by symmetry, -`unloading`(-T)."""
    return -unloading(-tangential, amplitude, normal, friction, a, compliance)


def unloading_stick_radius(tangential, amplitude, normal, friction):
    """c'/a while T decreases from T*: slip has changed its direction in c' < r < a."""
    return np.cbrt(1 - (amplitude - tangential) / (2 * friction * normal))


def loop_energy(amplitude, normal, friction, a, compliance):
    """Frictional work [J] in a cycle of T between ±T* (Johnson 7.45 with Σ (2 - ν)/G = 8C), with x = T*/μP:

    (36/5) (μP)² C / a (1 - (1 - x)^(5/3) - (5x/6) (1 + (1 - x)^(2/3))),

    which is (2/9) (C / a) T*³ / μP to the lowest order. It is the area ∮ T dδ of `unloading` and `reloading`.
    """
    limit = friction * normal
    x = amplitude / limit
    return 7.2 * limit**2 * compliance / a * (1 - (1 - x) ** (5 / 3) - 5 * x / 6 * (1 + (1 - x) ** (2 / 3)))


# ---- Block on a belt ----


@dataclass
class Belt:
    """The limit cycle of a block on a belt. Times in s, lengths in m, energies in J per cycle; the spring is relaxed at x = 0."""

    stick: float  # time
    slip: float  # time
    amplitude: float  # of the sinusoidal slip about `centre`
    centre: float
    release: float  # x at which the block begins to slip
    capture: float  # x at which it sticks again
    heat: float  # frictional work, supplied by the belt

    @property
    def period(self):
        return self.stick + self.slip


def belt(mass, stiffness, speed, normal, static, dynamic):
    """Limit cycle of a block [kg] that a spring [N/m] holds on a belt of the speed v > 0 [m/s] and the normal force [N]
    presses on it. `static` and `dynamic` are the coefficients of friction; if they are equal, the cycle has no stick.

    Stick: x moves with v up to x_s = μ_s N/k. Slip: m x'' = -k x + μ_d N, from x = x_s, x' = v. With y = x - x_d, x_d = μ_d N/k and
    ω² = k/m, y = A cos(ωt - φ), where A cos φ = Δ = x_s - x_d and A ω sin φ = v:

        A = (Δ² + (v/ω)²)^(1/2),      φ = atan2(v/ω, Δ).

    x' < v until ωt = π + 2φ, where y = -Δ and x' = v: the block sticks again, since there |k x| = |2μ_d - μ_s| N < μ_s N. Hence

        slip time (π + 2φ)/ω,      stick time 2Δ/v.

    In the slip the block moves by -2Δ and the belt by v times its time: work μ_d N (v (π + 2φ)/ω + 2Δ) is heat. After any start,
    the first stick leads to this cycle. If μ_s = μ_d, A = v/ω is the largest of the free oscillations about x_d that do not stick.
    """
    if speed <= 0 or static < dynamic:
        raise ValueError("the belt needs a positive speed, and static friction not below dynamic friction")
    omega = np.sqrt(stiffness / mass)
    release, centre = static * normal / stiffness, dynamic * normal / stiffness
    delta = release - centre
    slip = (np.pi + 2 * np.arctan2(speed / omega, delta)) / omega
    return Belt(
        stick=2 * delta / speed,
        slip=slip,
        amplitude=np.hypot(delta, speed / omega),
        centre=centre,
        release=release,
        capture=centre - delta,
        heat=dynamic * normal * (speed * slip + 2 * delta),
    )


def belt_motion(time, mass, stiffness, speed, normal, static, dynamic):
    """x [m], x' [m/s] and whether the block sticks at the times [s], if it starts relaxed and moves with the belt: x = x' - v = 0."""
    cycle = belt(mass, stiffness, speed, normal, static, dynamic)
    omega = np.sqrt(stiffness / mass)
    # the start is as if the block had stuck since `capture`
    phase = (np.asarray(time, float) - cycle.capture / speed) % cycle.period
    early = (
        np.asarray(time, float) < cycle.release / speed
    )  # a capture beyond x = 0 comes later than the start
    sticks = early | (phase < cycle.stick)
    angle = omega * (phase - cycle.stick) - np.arctan2(speed / omega, cycle.release - cycle.centre)
    x = np.where(sticks, cycle.capture + speed * phase, cycle.centre + cycle.amplitude * np.cos(angle))
    x = np.where(early, speed * np.asarray(time, float), x)
    return x, np.where(sticks, speed, -cycle.amplitude * omega * np.sin(angle)), sticks


def coulomb_oscillator(mass, stiffness, displacement, normal, static, dynamic):
    """Turning points [m] of a block on a table at rest, released at the `displacement` [m] of its spring [N/m], and the time [s] from
    one to the next. It slips in half periods π (m/k)^(1/2), each about ±μ_d N/k, so that the amplitude falls by 2 μ_d N/k, and
    sticks at the first turning point with k |x| ≤ μ_s N."""
    points = [float(displacement)]
    while stiffness * abs(points[-1]) > static * normal:
        points.append(-np.sign(points[-1]) * (abs(points[-1]) - 2 * dynamic * normal / stiffness))
    return np.array(points), np.pi * np.sqrt(mass / stiffness)


# ---- Elastic rod with friction at its end ----


@dataclass
class Rod:
    """Pieces of constant values, each of the time L/c. Members belong to the end with friction."""

    time: np.ndarray  # [s] edges of the pieces, one more than pieces
    velocity: np.ndarray  # [m/s]
    friction: np.ndarray  # [N], on the rod, positive along x
    stick: np.ndarray  # whether the piece sticks
    mean_velocity: np.ndarray  # [m/s] of the rod, at the edges
    energy: np.ndarray  # [J] kinetic and strain energy of the rod, at the edges
    heat: np.ndarray  # [J] frictional work until the edges
    work: np.ndarray  # [J] work of the pull until the edges

    @property
    def stop(self):
        """Time [s] after which the end sticks for good within the computed time; inf if it slips in the last piece."""
        slips = np.flatnonzero(~self.stick)
        return (
            self.time[slips[-1] + 1]
            if len(slips) and slips[-1] + 1 < len(self.stick)
            else np.inf
            if len(slips)
            else 0.0
        )


def rod(length, wave_speed, impedance, velocity, friction, pieces, pull=0.0):
    """Longitudinal motion of an elastic rod 0 < x < L whose end x = 0 rubs on a wall at rest with at most the force F_c [N] of Coulomb
    friction (`friction`). The other end is free, or pulled along x with the constant force [N] from t = 0. The rod starts
    without strain at the velocity [m/s]. Length in m, wave speed c in m/s, impedance Z = ρ c A in kg/s.

    Characteristics: velocity p(t - x/c) + q(t + x/c), tension Z (q - p). At x = 0 the friction f on the end balances the tension,
    f + Z (q - p) = 0, so that p = q + f/Z and

        the end's velocity is 2q + f/Z:      if |2q| ≤ F_c/Z it sticks, f = -2qZ; else it slips, f = -F_c sign(q).

    At x = L the tension is the pull: q returns as p + pull/Z. Everything is thus constant between multiples of L/c, and

        q_j = p_(j-2) + pull/Z (j ≥ 1),      q_0 = p_(-1) = velocity/2.

    Without pull the velocity of the end is v - F_c/Z, then falls by 2F_c/Z after each time 2L/c, until |2q| ≤ F_c/Z. There q only
    changes its sign at each stick: the end never slips again and the rod keeps the energy 2 Z (L/c) q².

    Energy: the density of p² + q² is Z/c. In the times jL/c, the pieces p_(j-1) and q_j fill the rod. Exact to round-off.
    """
    unit = length / wave_speed
    q = np.zeros(pieces + 1)
    p = np.zeros(pieces + 1)  # p[j] is p_(j-1)
    p[0] = q[0] = velocity / 2
    force, stick = np.zeros(pieces), np.zeros(pieces, bool)
    for j in range(pieces):
        stick[j] = abs(2 * q[j]) * impedance <= friction
        force[j] = -2 * q[j] * impedance if stick[j] else -friction * np.sign(q[j])
        p[j + 1] = q[j] + force[j] / impedance
        q[j + 1] = p[j] + pull / impedance
    end = np.where(stick, 0.0, q[:-1] + p[1:])
    far = p[:-1] + q[1:]  # velocity of the pulled end
    return Rod(
        time=unit * np.arange(pieces + 1),
        velocity=end,
        friction=force,
        stick=stick,
        mean_velocity=p + q,
        energy=impedance * unit * (p**2 + q**2),
        heat=unit * np.concatenate([[0], np.cumsum(-force * end)]),
        work=unit * np.concatenate([[0], np.cumsum(pull * far)]),
    )
