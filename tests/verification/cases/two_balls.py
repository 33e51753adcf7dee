# SPDX-License-Identifier: BSD-2-Clause
"""Two steel balls of 10 mm radius meet at 0.3 m/s (`meshes/hertz/two-balls.toml`), slowly enough for Hertz's quasi-static law. Their meshes
do not match. The reference is the law m δ̈ = −k δ^(3/2): its closed form for the duration of contact and the peak force, and its
step-by-step solution for the figure."""
import numpy as np

import hertz_theory as hertz
from case import BLUE
from ricochet.programs import ROOT

TITLE = "Hertz in impact: two balls"
SOURCE = "Hertz 1882 as in Johnson 1985, *Contact Mechanics*, section 11.4; waves: Hunter 1957, J. Mech. Phys. Solids 5, 162."
RESTS_ON = "theory"
LONG = False
SPEED = 0.3


def ideal_force(mass, modulus, curvature, duration):
    """Time and force by Hertz's law, integrated with Verlet's method in 4000 steps."""
    k = 4 / 3 * modulus * np.sqrt(curvature)
    step, x, v = duration / 4000, 0.0, SPEED
    out = [x]
    while x >= 0:
        before, x = x, x + step * (v - step / 2 * k / mass * x**1.5)
        v -= step / 2 * k / mass * (max(before, 0) ** 1.5 + max(x, 0) ** 1.5)
        out.append(x)
    return step * np.arange(len(out)), k * np.maximum(out, 0) ** 1.5


def run(bench):
    result = bench.impact(ROOT / "meshes" / "hertz" / "two-balls.toml")
    summary = result.summary
    mass, modulus, curvature = (
        hertz.DENSITY * 4 / 3 * np.pi * hertz.RADIUS**3 / 2,
        hertz.MODULUS / 2,
        hertz.RADIUS / 2,
    )
    duration, peak = hertz.impact(mass, SPEED, modulus, curvature)
    reason = "Hertz's half-spaces are stiffer than balls by about a/R = 0.01, and the patches are coarse at the edge"
    bench.compare("episodes of contact", len(summary["episodes"]), 1, 0, "a count")
    bench.compare(
        "duration of contact (µs)",
        1e6 * (summary["contact_end_s"] - summary["contact_start_s"]),
        1e6 * duration,
        0.03,
        reason,
    )
    bench.compare("peak force (N)", hertz.QUARTERS * summary["peak_force_n"], peak, 0.03, reason)
    bench.compare(
        "impulse (N s)",
        hertz.QUARTERS * summary["impulse_ns"],
        2 * mass * SPEED,
        0.01,
        "waves retain less than a thousandth of the energy (Hunter)",
    )
    for body, sign in (("upper", 1), ("lower", -1)):
        bench.compare(
            f"{body} ball leaves at (m/s)",
            summary["exit_velocity"][body][2],
            sign * SPEED / 2,
            2e-3,
            "waves retain less than a thousandth of the energy (Hunter), and the steps lose less than that",
        )
    bench.below(
        "drift of the energy ledger",
        summary["energy_drift"],
        1e-10,
        "round-off of the steps",
        rests_on="construction",
    )
    figure, ax = bench.figure()
    ideal = ideal_force(mass, modulus, curvature, duration)
    time, force = result.time, result.total_force
    ax.plot(time * 1e6, hertz.QUARTERS * force, color=BLUE, linewidth=2, label="two balls")
    ax.plot(ideal[0] * 1e6, ideal[1], color="black", linewidth=1, linestyle="--", label="Hertz")
    ax.set(
        xlabel="time (µs)",
        ylabel="force (N)",
        xlim=(0, None),
        ylim=(0, None),
        title="Two steel balls of 10 mm meet at 0.3 m/s",
    )
    ax.legend()
    bench.save(figure, "Force of the impact and Hertz's law")
