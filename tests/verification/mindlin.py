# SPDX-License-Identifier: BSD-2-Clause
"""Closed forms with Coulomb friction: a sphere under a tangential force (Cattaneo 1938, Mindlin 1949, Mindlin and Deresiewicz 1953,
as in Johnson 1985, Contact Mechanics, sections 7.2 and 7.4).

A normal force P presses a sphere on a plane, or two spheres on one another, with contact radius a (hertz_theory.radius). P
stays constant and the tangential force T changes, |T| < μP. The tangential displacement of distant points of one body relative to
those of the other is δ, and without slip

    δ = C T / a,      C = Σ (2 - ν_i) / (8 G_i)      summed over the elastic bodies (a rigid one adds nothing).

The bodies are alike (two like spheres, or a sphere on a half-space of its material), or one is rigid and the other incompressible.
Otherwise tangential tractions also move the surface normally, which is neglected: for a sphere with ν = 0.3 on a rigid plane
Dundurs' β = (1 - 2ν) / (2 (1 - ν)) is 0.29. Slip in the annulus is assumed to be along T; for ν > 0 it deviates a little (the
parts with cos 2θ and sin 2θ in oblique_impact.py). Distant points are several a away; on a ball, a « R is assumed."""

import numpy as np


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
