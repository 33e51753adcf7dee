# SPDX-License-Identifier: BSD-2-Clause
"""Impact of two bodies that are known by their modes at the point of contact, under Hertz's law: the oracle of a ball on a beam and
of rods with rounded ends."""
import numpy as np


def impact(omega, shape, rate, stiffness, step, duration, seen=None):
    """Times [s], force [N], the final rates of the modes, and what a gauge sees: its values `seen` (n) of the modes times their coordinates.

    The modes of both bodies are stacked: `omega` (n) [rad/s], 0 for a rigid mode, `shape` (n) [kg^-1/2], their displacement at the
    contact, positive towards the other body, and `rate` (n) [kg^1/2 m/s] at the start, when the bodies touch. With the approach
    u = shape·q, F = stiffness u^(3/2) [N] and q̈ + ω² q = −shape F. The force varies linearly over a step, for which the modes
    are exact; its value at the end of the step is found by repetition."""
    x = np.maximum(omega * step, 1e-6)  # the limit for rigid modes, to round-off
    cosine, sine = np.cos(x), np.sin(x) / x * step
    # Displacement and rate at the end of a step under a unit force, and under one that rises from 0 to 1.
    constant, ramp = (
        2 * np.sin(x / 2) ** 2 / x**2 * step**2,
        np.where(x > 1e-3, (1 - np.sin(x) / x) / x**2, 1 / 6) * step**2,
    )
    ramp_rate = constant / step
    q, rate, force = np.zeros_like(omega), rate.copy(), 0.0
    history, seen = [(force, 0.0)], np.zeros_like(omega) if seen is None else seen
    for _ in range(round(duration / step)):
        free = q * cosine + rate * sine - shape * force * (constant - ramp)
        after = force
        for _ in range(6):
            after = stiffness * max(shape @ free - shape @ (shape * ramp) * after, 0.0) ** 1.5
        rate = (
            rate * cosine - q * omega**2 * sine - shape * (force * (sine - ramp_rate) + after * ramp_rate)
        )
        q = free - shape * ramp * after
        force = after
        history.append((force, seen @ q))
    force, sight = np.array(history).T
    return step * np.arange(len(history)), force, rate, sight


def episodes(time, force):
    """Start [s], end [s] and peak [N] of each time of contact."""
    touching = np.concatenate([[False], force > 0, [False]])
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    return [
        (time[max(a - 1, 0)], time[min(b, len(time) - 1)], force[a:b].max())
        for a, b in zip(edges[::2], edges[1::2])
    ]
