# SPDX-License-Identifier: BSD-2-Clause
"""Stress under Hertz's contact: the ball of `ball_at_rest` under a thousandth of its weight, so that the contact radius is a five-hundredth of the
ball's, and Hertz's half-space is a good reference: with the whole weight, the tension beside the contact is 15 % lower. Gauges lie on the axis
below the contact, where the largest shear stress is, and on the surface beside it, where a ring is under radial tension.

At the edge of the contact, the radial tension is largest, (1 − 2ν) p₀/3. Outside, it falls with a²/r²; inside, with a vertical
tangent, so that elements of an eighth of the contact radius blur it to an eighth of its value. At one place of the edge, elements are therefore
0.015 contact radii wide within 0.05 of it. The tension there is that of the next gauges outside."""
import numpy as np

import hertz_theory as hertz
from case import BLUE, ORANGE
from ricochet.programs import ROOT

TITLE = "Stress under Hertz's contact"
SOURCE = "Johnson 1985, *Contact Mechanics*, section 3.4: (3.45) on the axis, (3.46) on the surface; figure 4.3 and table 4.1."
RESTS_ON = "theory"
LONG = False
SHARE = 0.1  # of the contact radius of `ball_at_rest`
RADIUS, SIZE, REACH = SHARE * 2e-4, SHARE * 2.5e-5, SHARE * 4.5e-4
DEPTHS = np.arange(0.3, 0.71, 0.05)
RINGS = (1.25, 1.5, 1.75, 2.0)
FINE, FINE_REACH = 0.015 * RADIUS, 0.05 * RADIUS  # elements at one place of the edge
EDGE = (1.0, 1.005, 1.01, 1.015, 1.02, 1.03, 1.05, 1.1)  # gauges beside this place
ANGLES = np.radians([0, 15, 30, 45, 60, 75, 90])


def on_axis(z):
    """Radial and vertical stress at the depth z over the contact radius, divided by the peak pressure."""
    vertical = -1 / (1 + z**2)
    return -(1 + hertz.POISSON) * (1 - z * np.arctan(1 / z)) - vertical / 2, vertical


def gauge(name, x, y, z):
    return f'[[output.gauge]]\nname = "{name}"\nbody = "ball"\nat_body = [{x!r}, {y!r}, {z!r}]\n'


def height(r):
    """Of the surface over the centre of the ball, at a distance from the axis over the contact radius."""
    return float(-np.sqrt(hertz.RADIUS**2 - (r * RADIUS) ** 2))


def refined(text):
    """The scene with fine elements at the edge."""
    at = [RADIUS, 0.0, height(1)]
    ball = f"[[bodies.ball.refine]]\nat = {at}\nradius = {FINE_REACH!r}\nsize = {FINE!r}\n\n"
    return text.replace("[obstacles", ball + "[obstacles")


def gauges():
    text = ""
    for depth in DEPTHS:
        text += gauge(f"axis {depth:.2f}", 0.0, 0.0, float(depth * RADIUS - hertz.RADIUS))
    for r in EDGE:
        text += gauge(f"edge {r}", float(r * RADIUS), 0.0, height(r))
    for r in RINGS:
        for k, angle in enumerate(ANGLES):
            x, y = float(r * RADIUS * np.cos(angle)), float(r * RADIUS * np.sin(angle))
            text += gauge(f"ring {r:.2f} {k}", x, y, height(r))
    return text


def radial(result, r):
    """Mean radial stress on a ring [Pa]."""
    total = 0
    for k, angle in enumerate(ANGLES):
        xx, yy, _, _, _, xy = result.gauges[f"ring {r:.2f} {k}"].stress[-1]
        c, s = np.cos(angle), np.sin(angle)
        total += c * c * xx + s * s * yy + 2 * c * s * xy
    return total / len(ANGLES)


def run(bench):
    text = (ROOT / "meshes" / "hertz" / "resting-ball.toml").read_text()
    text = text.replace('"ball.geo"', f'"{ROOT}/meshes/hertz/ball.geo"')
    scene = bench.write("ball.toml", refined(text) + gauges())
    result = bench.impact(
        scene,
        f"bodies.ball.geometry={{size={SIZE},reach={REACH}}}",
        f"loads.gravity=[0,0,{-7485.97 * SHARE**3}]",
    )
    force = hertz.Contact(result.path, "ball").total
    scale = hertz.radius(force) / RADIUS  # the places are those of the nominal radius
    peak = hertz.pressure(0, force)
    depth = DEPTHS / scale
    stress = np.array([result.gauges[f"axis {z:.2f}"].stress[-1] for z in DEPTHS]) / peak
    shear = (stress[:, 0] - stress[:, 2]) / 2
    fine = np.linspace(depth[0], depth[-1], 1001)
    ideal = np.subtract(*on_axis(fine)) / 2
    ours = np.polyval(np.polyfit(depth, shear, 4), fine)
    why = "a quartic through nine gauges; elements of an eighth of the contact radius"
    bench.compare("largest shear stress over the peak pressure", ours.max(), ideal.max(), 0.03, why)
    bench.compare("its depth over the contact radius", fine[ours.argmax()], fine[ideal.argmax()], 0.05, why)
    bench.below(
        "shear stress on the axis over the peak pressure, largest error at a gauge",
        np.abs(shear - np.subtract(*on_axis(depth)) / 2).max(),
        0.005,
        why,
    )
    edge = (1 - 2 * hertz.POISSON) / 3
    found = {r: result.gauges[f"edge {r}"].stress[-1][0] / peak for r in EDGE}
    why = "elements of 0.015 contact radii"
    bench.compare(
        "largest radial tension beside the edge over the peak pressure", max(found.values()), edge, 0.03, why
    )
    outside = np.array([r for r in EDGE if r > 1.01])
    ideal_outside = edge / (outside / scale) ** 2
    bench.below(
        "radial tension from 1.015 to 1.1 contact radii, largest relative error at a gauge",
        np.abs([found[r] for r in outside] / ideal_outside - 1).max(),
        0.03,
        why,
    )
    found |= {r: radial(result, r) / peak for r in RINGS}
    bench.below(
        "radial tension from 1.25 to 2 contact radii, largest relative error on a ring",
        max(abs(found[r] * (r / scale) ** 2 / edge - 1) for r in RINGS),
        0.03,
        "means of seven gauges on each ring",
    )
    bench.table(
        ["place over the contact radius", "radial stress over the peak pressure", "Hertz"],
        [[f"{r:g}", f"{found[r]:.4f}", f"{edge / r**2:.4f}"] for r in found],
    )
    figure, axes = bench.figure(2)
    axes[0].plot(fine, ideal, color="black", linewidth=0.9, linestyle="--", label="Hertz")
    axes[0].plot(depth, shear, "o", color=BLUE, markersize=4, label="gauges")
    axes[0].set(
        xlabel="depth over the contact radius",
        ylabel="shear stress over the peak pressure",
        title="Below the contact",
    )
    axes[0].legend()
    r = np.linspace(1, 2, 101)
    axes[1].plot(r, edge / r**2, color="black", linewidth=0.9, linestyle="--", label="Hertz")
    axes[1].plot(list(found), list(found.values()), "o", color=ORANGE, markersize=4, label="gauges")
    axes[1].set(
        xlabel="distance over the contact radius",
        ylabel="radial stress over the peak pressure",
        title="Beside the contact",
    )
    axes[1].legend()
    bench.save(
        figure, "Shear stress on the axis below the contact, and radial stress on the surface beside it"
    )
