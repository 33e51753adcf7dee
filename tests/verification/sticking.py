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


def draw(axes, names, colours, measured, incidents, after):
    """Left, β₀ of each pair, measured and ours; right, tangential velocities before and after. `after` has one array for each pair."""
    left, right = axes
    places = np.arange(len(names))
    left.errorbar(
        places - 0.1,
        [pair.sticking for pair in measured],
        yerr=[pair.sticking_error for pair in measured],
        fmt="o",
        color=ORANGE,
        markersize=5,
        capsize=3,
        label="measured, with the authors' error",
    )
    ours = [slope(*velocities) for velocities in zip(incidents, after)]
    left.plot(places + 0.1, ours, "s", color=BLUE, markersize=5, label="ours, not fitted")
    left.set_xticks(places, [name.replace(" ", "\n") for name in names])
    left.set(ylim=(0, 0.85), ylabel="β₀", title="Tangential restitution of impacts that stick")
    left.legend(loc="upper right")
    for name, colour, pair, incident, velocity in zip(names, colours, measured, incidents, after):
        fine = np.linspace(0, 1.1 * pair.limit(), 200)
        right.plot(
            fine / pair.friction, pair.described(fine) / pair.friction, "--", color=colour, linewidth=0.9
        )
        right.plot(
            incident / pair.friction,
            velocity / pair.friction,
            "s-",
            color=colour,
            markersize=3.5,
            label=name,
        )
    right.plot([], [], "--", color=GREY, linewidth=0.9, label="authors' fit")
    right.set(
        xlabel="before: v_t/(μ v_n)", ylabel="after: v_t/(μ v_n)", title="Tangential velocity of the contact"
    )
    right.legend(fontsize=7)
