# SPDX-License-Identifier: BSD-2-Clause
"""Impacts of balls as Foerster, Louge, Chang and Allia describe them (1994, Phys. Fluids 6, 1108): the tangential velocity of the
contact after the impact is -β₀ times that before where the contact sticks; where it slides, friction μ changes it by 3.5 μ (1 + e)
times the normal velocity of approach v_n. Velocities of this module are divided by v_n."""
from dataclasses import dataclass

import numpy as np

from case import BLUE, GREY, ORANGE


@dataclass
class Measured:
    """Coefficients of a pair of bodies, with the errors of e and β₀ that the authors give."""

    restitution: float
    restitution_error: float
    sticking: float  # β₀
    sticking_error: float
    friction: float

    def limit(self):
        """Incident tangential velocity at which the lines of impacts that stick and that slide cross."""
        return 3.5 * self.friction * (1 + self.restitution) / (1 + self.sticking)

    def described(self, incident):
        """Tangential velocity after the impact."""
        return np.maximum(-self.sticking * incident, incident - 3.5 * self.friction * (1 + self.restitution))


def slope(incident, after):
    """β₀ of the line through the origin that fits the impacts best."""
    return -(incident * after).sum() / (incident**2).sum()


def compare(bench, pairs, incidents, ours):
    """Lines on β₀ and e of each pair. `pairs` have a name, `measured`, and the reasons `differs` and `loses` of known failures of
    β₀ and e, or None; `incidents` (n) and `ours` (n, 2), of each: v_t before; e and v_t after."""
    for pair, incident, velocities in zip(pairs, incidents, ours):
        bench.compare(
            f"{pair.name}: β₀",
            slope(incident, velocities[:, 1]),
            pair.measured.sticking,
            pair.measured.sticking_error,
            "the authors' error",
            absolute=True,
            known=pair.differs,
        )
    for pair, velocities in zip(pairs, ours):
        bench.compare(
            f"{pair.name}: restitution e",
            velocities[:, 0].mean(),
            pair.measured.restitution,
            0.03,
            "ours loses energy to vibrations only",
            known=pair.loses,
        )


def draw(axes, pairs, incidents, ours):
    """Left, β₀ of each pair, measured and ours; right, tangential velocities before and after. Arguments as in `compare`; pairs have
    a `colour`."""
    left, right = axes
    after = [velocities[:, 1] for velocities in ours]
    places = np.arange(len(pairs))
    left.errorbar(
        places - 0.1,
        [pair.measured.sticking for pair in pairs],
        yerr=[pair.measured.sticking_error for pair in pairs],
        fmt="o",
        color=ORANGE,
        markersize=5,
        capsize=3,
        label="measured, with the authors' error",
    )
    left.plot(
        places + 0.1,
        list(map(slope, incidents, after)),
        "s",
        color=BLUE,
        markersize=5,
        label="ours, not fitted",
    )
    left.set_xticks(places, [pair.name.replace(" ", "\n") for pair in pairs])
    left.set(ylim=(0, 0.85), ylabel="β₀", title="Tangential restitution of impacts that stick")
    left.legend(loc="upper right")
    for pair, incident, velocity in zip(pairs, incidents, after):
        measured, friction = pair.measured, pair.measured.friction
        fine = np.linspace(0, 1.1 * measured.limit(), 200)
        line, marks = {"color": pair.colour, "linewidth": 0.9}, {"color": pair.colour, "markersize": 3.5}
        right.plot(fine / friction, measured.described(fine) / friction, "--", **line)
        right.plot(incident / friction, velocity / friction, "s-", label=pair.name, **marks)
    right.plot([], [], "--", color=GREY, linewidth=0.9, label="authors' fit")
    right.set(
        xlabel="before: v_t/(μ v_n)", ylabel="after: v_t/(μ v_n)", title="Tangential velocity of the contact"
    )
    right.legend(fontsize=7)
