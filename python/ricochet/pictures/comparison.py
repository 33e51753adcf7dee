# SPDX-License-Identifier: BSD-2-Clause
"""Force laws of rigid bodies, for comparison with an impact: the laws of Hertz and of Hunt and Crossley.

    m δ'' = −F,   F = k δ^(3/2) (1 + χ δ')   while δ > 0 and F > 0,   from δ = 0 with δ' = v

m is the reduced mass of the two bodies, v their approach. χ = 0 is Hertz's law; Hunt and Crossley (J. Appl. Mech. 42, 1975) take
χ = (3/2) (1 − e)/v with the restitution e, which is accurate for e near 1.
"""
from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import Any

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.pictures.loaded_result import LoadedResult

LAWS = {"hertz": "Hertz", "hunt-crossley": "Hunt–Crossley"}
STEPS = 2000  # over the duration of a blow without loss, 2.943 δ/v


@dataclass(frozen=True)
class Law:
    kind: str  #: one of LAWS
    stiffness: float | None = None  #: k [N/m^1.5]; None: such that the peak force is that of the impact


def law_of(text: str) -> Law:
    """The law of "hertz", "hunt-crossley", or either with "=K" [N/m^1.5]. Raises ValueError."""
    kind, equals, number = text.partition("=")
    if kind not in LAWS:
        raise ValueError(f"{text}: must be {' or '.join(LAWS)}, or one of them with =K [N/m^1.5]")
    stiffness = float(number) if equals else None
    if stiffness is not None and not 0 < stiffness < math.inf:
        raise ValueError(f"{text}: the stiffness must be above 0")
    return Law(kind, stiffness)


def blow(mass: float, speed: float, stiffness: float, loss: float) -> tuple[Array, Array]:
    """Times [s] from the first touch, and forces [N], of a law with χ = `loss` [s/m]: the classical Runge–Kutta
    method, until the force ends."""
    depth = (1.25 * mass * speed**2 / stiffness) ** 0.4  # the largest without loss
    step = 2.943 * depth / speed / STEPS

    def rate(state: Array) -> Array:
        force = stiffness * max(state[0], 0.0) ** 1.5 * (1 + loss * state[1])
        return np.array([state[1], -max(force, 0.0) / mass])

    state, forces = np.array([0.0, speed]), [0.0]
    while True:
        a = rate(state)
        b = rate(state + step / 2 * a)
        c = rate(state + step / 2 * b)
        d = rate(state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        forces.append(-mass * float(rate(state)[1]))
        if forces[-1] == 0:
            return step * np.arange(len(forces)), np.array(forces)


def reduced_mass(result: LoadedResult) -> float:
    """Of the two sides of the point with the largest impulse [kg]; obstacles and supported bodies do not move."""
    scene: Mapping[str, Any] = result.scene.get("bodies", {})
    sides = [name for name in result.sides_names(result.strongest) if name in result.bodies]
    inverse = sum(1 / result.bodies[name].mass for name in sides if not scene.get(name, {}).get("support"))
    return 1 / inverse if inverse else math.inf


def compared(result: LoadedResult, law: Law) -> tuple[str, Array, Array]:
    """Name, times and forces of a law for the mass, the approach and, for its loss, the restitution of the impact.
    Raises InputError if the impact has none of these."""
    summary = result.summary
    speed, restitution = next(
        ((one.get("approach_m_per_s"), summary.get("restitution")) for one in summary.get("episodes", ())),
        (None, None),
    )
    mass = reduced_mass(result)
    if not speed or speed <= 0 or not math.isfinite(mass) or restitution is None:
        raise InputError(
            f"{result.path}: --compare {law.kind} needs a pair that approaches and parts, and a body without supports"
        )
    loss = 1.5 * max(0.0, 1 - restitution) / speed if law.kind == "hunt-crossley" else 0.0
    stiffness, told = law.stiffness, f"k = {law.stiffness:.3g} N/m$^{{3/2}}$" if law.stiffness else ""
    if stiffness is None:
        # With the same v and χ, forces are proportional to k^(2/5).
        found = float(blow(mass, speed, 1.0, loss)[1].max())
        stiffness = (summary["peak_force_n"] / found) ** 2.5
        told = "same peak"
    when, force = blow(mass, speed, stiffness, loss)
    return f"{LAWS[law.kind]}, {told}", when + summary["contact_start_s"], force
